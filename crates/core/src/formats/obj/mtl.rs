use super::map_options::{MapOptions, MtlImage};
use crate::formats::lines::{Line, Lines, text};
use crate::quote::{self, quote, shorten};
use crate::scene::{Alpha, Color, Material, Opacity, Reflectance};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// A material, with properties that only OBJ has.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MtlMaterial {
    pub(super) material: Material,
    pub(super) images: MtlImages,
}

/// The images that a library names for a material.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MtlImages {
    /// `map_Kd`.
    pub(super) color: Option<MtlImage>,
    /// `map_d`.
    pub(super) opacity: Option<MtlImage>,
    /// `map_Pr`.
    pub(super) roughness: Option<MtlImage>,
    /// `map_Pm`.
    pub(super) metallic: Option<MtlImage>,
    /// `map_Ke`.
    pub(super) emission: Option<MtlImage>,
}

impl MtlImages {
    /// All of them, that of colour first.
    pub(super) fn by_keyword(&self) -> [(&'static str, Option<&MtlImage>); 5] {
        let Self {
            color,
            opacity,
            roughness,
            metallic,
            emission,
        } = self;
        [
            ("map_Kd", color.as_ref()),
            ("map_d", opacity.as_ref()),
            ("map_Pr", roughness.as_ref()),
            ("map_Pm", metallic.as_ref()),
            ("map_Ke", emission.as_ref()),
        ]
    }

    fn set(&mut self, keyword: &str, image: MtlImage) {
        let place = match keyword {
            "map_Kd" => &mut self.color,
            "map_d" => &mut self.opacity,
            "map_Pr" => &mut self.roughness,
            "map_Pm" => &mut self.metallic,
            _ => &mut self.emission,
        };
        *place = Some(image);
    }

    /// How the material's texture coordinates are moved: all its images share them.
    pub(super) fn options(&self) -> MapOptions {
        let mut all = self.by_keyword().into_iter();
        let first = all.find_map(|(_, image)| image);
        first.map_or_else(MapOptions::default, |image| image.options)
    }

    /// Whether any says how light is reflected.
    pub(super) fn reflect(&self) -> bool {
        [&self.roughness, &self.metallic, &self.emission]
            .iter()
            .any(|image| image.is_some())
    }
}

/// Keywords of a library and options of its images that are not shown, and the number of materials with each.
pub(super) type Unused = BTreeMap<String, usize>;

/// The most keywords that are listed by name.
const MAX_LISTED: usize = 12;

/// Reads a material library. Faulty lines are skipped and listed in `warnings`; properties that are not shown are
/// counted.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    warnings: &mut Vec<String>,
    unused: &mut Unused,
) -> Vec<MtlMaterial> {
    let text = text(bytes);
    // `tobj` may panic on short colours and gives up at the first fault, so it gets only the lines that are used,
    // after checking them.
    let mut clean = String::new();
    let mut looks: Vec<Look> = Vec::new();
    for line in Lines::new(&text) {
        let words = line.text.trim();
        let (keyword, rest) = words.split_once(char::is_whitespace).unwrap_or((words, ""));
        let rest = rest.trim();
        let mut warn = |expected: &str| {
            let (path, found) = (quote::path(path), quote(words));
            let location = format!("{path}:{}", line.number);
            warnings.push(format!("{location}: expected {expected}, found {found}"));
        };
        match keyword {
            "newmtl" if rest.is_empty() => warn("a name behind `newmtl`"),
            "map_Kd" | "map_d" | "map_Pr" | "map_Pm" | "map_Ke" => {
                let Some(image) = MtlImage::parse(rest) else {
                    warn(&format!("a file behind `{keyword}`"));
                    continue;
                };
                if let Some(look) = looks.last_mut() {
                    look.images.set(keyword, image);
                }
            }
            "d" | "Tr" => match opacity(rest) {
                Some(number) => clean.push_str(&format!("{keyword} {number}\n")),
                None => warn("a number from 0 to 1"),
            },
            "newmtl" => {
                clean.push_str(&format!("{keyword} {rest}\n"));
                looks.push(Look::default());
            }
            "Kd" => match diffuse(rest) {
                Some([r, g, b]) => clean.push_str(&format!("Kd {r} {g} {b}\n")),
                None => warn("one or three numbers behind `Kd`"),
            },
            "Ks" | "Ke" | "Ns" | "Pm" | "Pr" => {
                let Some(look) = looks.last_mut() else {
                    continue;
                };
                let number = || diffuse(rest).map(|[x, ..]| x);
                let is_read = match keyword {
                    "Ks" => diffuse(rest).map(|color| look.specular = Some(color)),
                    "Ke" => diffuse(rest).map(|color| look.emission = color),
                    "Ns" => number().map(|x| look.exponent = Some(x)),
                    "Pm" => number().map(|x| look.metallic = Some(x)),
                    _ => number().map(|x| look.roughness = Some(x)),
                };
                if is_read.is_none() {
                    warn(&format!("one or three numbers behind `{keyword}`"));
                }
            }
            // Ambient colour, index of refraction, illumination model and the like do not affect what is shown.
            "" | "Ka" | "Ni" | "illum" | "sharpness" | "Tf" => {}
            _ if keyword.starts_with('#') => {}
            // A damaged file may contain any words: only a few short ones are kept.
            _ if unused.contains_key(keyword) || unused.len() < MAX_LISTED => {
                *unused.entry(shorten(keyword)).or_default() += 1;
            }
            _ => {}
        }
    }
    match tobj::load_mtl_buf(&mut clean.as_bytes()) {
        Ok((materials, _)) => {
            let looks = looks.into_iter().chain(std::iter::repeat(Look::default()));
            let all = materials.into_iter().zip(looks);
            all.map(|(material, look)| {
                count_options(&look.images, unused);
                convert(material, look)
            })
            .collect()
        }
        Err(error) => {
            warnings.push(format!("{}: {error}", quote::path(path)));
            Vec::new()
        }
    }
}

/// Counts options of images that are not obeyed.
fn count_options(images: &MtlImages, unused: &mut Unused) {
    let moves = images.options();
    for (keyword, image) in images.by_keyword() {
        // A colour is read from all channels.
        let is_color = matches!(keyword, "map_Kd" | "map_Ke");
        let is_odd = |image: &MtlImage| {
            image.has_others
                || !image.options.moves_as(&moves)
                || is_color && image.options.channel.is_some()
        };
        if image.is_some_and(is_odd) {
            *unused.entry(format!("options of {keyword}")).or_default() += 1;
        }
    }
}

/// The images that a library names, those too that are not shown.
pub(super) fn images(bytes: &[u8]) -> Vec<String> {
    let text = text(bytes);
    let image = |line: Line<'_>| -> Option<String> {
        let (keyword, rest) = line.text.trim().split_once(char::is_whitespace)?;
        let keyword = keyword.to_ascii_lowercase();
        let is_image = keyword.starts_with("map_")
            || ["bump", "disp", "decal", "norm", "refl"].contains(&&*keyword);
        let image = MtlImage::parse(rest).filter(|_| is_image)?;
        Some(image.name)
    };
    Lines::new(&text).filter_map(image).collect()
}

/// The library's parameters of reflection.
#[derive(Clone, Debug, Default)]
struct Look {
    specular: Option<[f64; 3]>,
    /// Phong's exponent.
    exponent: Option<f64>,
    emission: [f64; 3],
    metallic: Option<f64>,
    roughness: Option<f64>,
    images: MtlImages,
}

impl Look {
    /// `None` where the library says nothing. Metallic is `Pm`, else 0. The roughness is `Pr`; else, where `Ks` is
    /// not black, the roughness whose GGX lobe is as wide as Phong's, α² = 2 / (Ns + 2) (Walter, Marschner, Li,
    /// Torrance, 2007); else 1.
    fn reflectance(&self) -> Option<Reflectance> {
        let Self {
            specular,
            exponent,
            emission,
            metallic,
            roughness,
            images,
        } = self;
        let numbers = [exponent, metallic, roughness];
        let says = images.reflect() || numbers.iter().any(|number| number.is_some());
        if !says && specular.is_none() && *emission == [0.0; 3] {
            return None;
        }
        let shines = specular.is_none_or(|color| color.iter().any(|channel| *channel > 0.0));
        let of_exponent = exponent.filter(|_| shines).map(|exponent| {
            // α is the square of the roughness.
            (2.0 / (exponent.max(0.0) + 2.0)).sqrt().sqrt()
        });
        let usual = Reflectance::default();
        let else_rough = if shines { usual.roughness.into() } else { 1.0 };
        let roughness = roughness.or(of_exponent).unwrap_or(else_rough);
        Some(Reflectance {
            metallic: metallic.unwrap_or(0.0).clamp(0.0, 1.0) as f32,
            roughness: roughness.clamp(0.0, 1.0) as f32,
            emission: emission.map(|light| light.clamp(0.0, MAX_EMISSION) as f32),
            ..usual
        })
    }
}

/// As in glTF: far beyond any picture.
const MAX_EMISSION: f64 = 1e30;

fn convert(material: tobj::Material, look: Look) -> MtlMaterial {
    let color = material.diffuse.map_or(Color::DEFAULT, |diffuse| {
        Color(diffuse.map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8))
    });
    // `Tr` is 1 − `d`; `d` takes precedence.
    let transparency = material.unknown_param.get("Tr");
    let transparency = transparency.and_then(|text| text.parse::<f64>().ok());
    let factor = (material.dissolve).or(transparency.map(|transparency| 1.0 - transparency));
    let factor = factor.unwrap_or(1.0);
    MtlMaterial {
        material: Material {
            opacity: match factor < 1.0 {
                true => Opacity::Blend(Alpha {
                    factor: factor as f32,
                    image: None,
                }),
                false => Opacity::Opaque,
            },
            reflectance: look.reflectance().map(Arc::new),
            ..Material::new(material.name, color)
        },
        images: look.images,
    }
}

/// An opacity, which may follow `-halo`.
fn opacity(text: &str) -> Option<f32> {
    let text = text.split('#').next()?.trim();
    let text = text.strip_prefix("-halo").unwrap_or(text).trim();
    let number: f32 = text.parse().ok()?;
    (0.0..=1.0).contains(&number).then_some(number)
}

/// A diffuse colour: a single number stands for all three.
fn diffuse(text: &str) -> Option<[f64; 3]> {
    let values: Option<Vec<f64>> = text
        .split('#')
        .next()?
        .split_whitespace()
        .map(|word| word.parse().ok().filter(|value: &f64| value.is_finite()))
        .collect();
    match values?[..] {
        [grey] => Some([grey; 3]),
        [r, g, b, ..] => Some([r, g, b]),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_colors_and_maps() {
        let text = b"\xef\xbb\xbf# caf\xe9\nKd 1 1 1\nnewmtl red one\n Kd 1.0 0.5 -3 \nKs 1\n\
            newmtl grey\r\nKd 0.2\nnewmtl plain\nmap_Kd -s 1 1 1 -bm 0.3 my wood.png\n";
        let mut warnings = Vec::new();
        let mut unused = Unused::new();
        let materials = read(Path::new("a.mtl"), text, &mut warnings, &mut unused);
        let colors: Vec<_> = materials
            .iter()
            .map(|m| (m.material.name.as_str(), m.material.color))
            .collect();
        assert_eq!(
            colors,
            [
                ("red one", Color([255, 128, 0])),
                ("grey", Color([51; 3])),
                ("plain", Color::DEFAULT)
            ]
        );
        let image = materials[2].images.color.as_ref().expect("an image");
        assert_eq!(image.name, "my wood.png");
        assert_eq!(unused, Unused::from([("options of map_Kd".to_owned(), 1)]));
        assert!(warnings.is_empty(), "{warnings:?}");
    }

    #[test]
    fn reads_how_materials_reflect_light() {
        let text = b"newmtl shiny\nKs 1 1 1\nNs 198\nmap_Bump b.png\nnewmtl matt\nKs 0 0 0\nNs 198\nbump b.png\n\
            newmtl steel\nPm 1\nPr 0.25\nKe 2 0 0\nmap_Bump c.png\nnewmtl nothing\nKd 1\nillum 2\n";
        let (mut warnings, mut unused) = (Vec::new(), Unused::new());
        let materials = read(Path::new("a.mtl"), text, &mut warnings, &mut unused);
        let looks: Vec<_> = materials
            .iter()
            .map(|m| m.material.reflectance.as_deref())
            .map(|look| look.map(|look| (look.metallic, look.roughness, look.emission)))
            .collect();
        let tenth = 0.1f32.sqrt();
        assert_eq!(
            looks,
            [
                Some((0.0, tenth, [0.0; 3])),
                Some((0.0, 1.0, [0.0; 3])),
                Some((1.0, 0.25, [2.0, 0.0, 0.0])),
                None
            ]
        );
        let unused: Vec<_> = unused.into_iter().collect();
        assert_eq!(unused, [("bump".to_owned(), 1), ("map_Bump".to_owned(), 2)]);
        assert!(warnings.is_empty(), "{warnings:?}");
    }

    #[test]
    fn unreadable_lines_are_skipped_with_a_warning() {
        let text =
            b"newmtl a\nKd 1 0\nKd spectral x.rfl\nKd nan 0 0\nmap_Kd\nmap_Kd -s 1\nnewmtl\n";
        let mut warnings = Vec::new();
        let materials = read(Path::new("a.mtl"), text, &mut warnings, &mut Unused::new());
        assert_eq!(materials.len(), 1);
        assert_eq!(materials[0].material.color, Color::DEFAULT);
        assert_eq!(materials[0].images, MtlImages::default());
        assert_eq!(warnings.len(), 6, "{warnings:?}");
        assert_eq!(
            warnings[0],
            "a.mtl:2: expected one or three numbers behind `Kd`, found \"Kd 1 0\""
        );
    }
}
