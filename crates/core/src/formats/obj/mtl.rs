use crate::formats::lines::{Lines, text};
use crate::quote::{self, quote};
use crate::scene::{Alpha, Color, Material, Opacity};
use std::path::Path;

/// A material, and what else its library says of it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MtlMaterial {
    pub(super) material: Material,
    /// The image for its diffuse colour, as the library names it.
    pub(super) texture: Option<String>,
    /// The image for its opacity.
    pub(super) opacity: Option<String>,
}

/// Reads a material library. What cannot be read is left out, and told in `warnings`.
pub(super) fn read(path: &Path, bytes: &[u8], warnings: &mut Vec<String>) -> Vec<MtlMaterial> {
    let text = text(bytes);
    // `tobj` may panic on short colours and gives up at the first fault: it gets what is used here,
    // checked.
    let mut clean = String::new();
    for line in Lines::of(&text) {
        let words = line.text.trim();
        let (keyword, rest) = words.split_once(char::is_whitespace).unwrap_or((words, ""));
        let rest = rest.trim();
        let mut warn = |expected: &str| {
            let (path, found) = (quote::path(path), quote(words));
            let place = format!("{path}:{}", line.number);
            warnings.push(format!("{place}: expected {expected}, found {found}"));
        };
        match keyword {
            "newmtl" if rest.is_empty() => warn("a name behind `newmtl`"),
            "map_Kd" if image_name(rest).is_none() => warn("a file behind `map_Kd`"),
            "map_d" if image_name(rest).is_none() => warn("a file behind `map_d`"),
            "d" | "Tr" => match opacity(rest) {
                Some(number) => clean.push_str(&format!("{keyword} {number}\n")),
                None => warn("a number from 0 to 1"),
            },
            "newmtl" | "map_Kd" | "map_d" => clean.push_str(&format!("{keyword} {rest}\n")),
            "Kd" => match diffuse(rest) {
                Some([r, g, b]) => clean.push_str(&format!("Kd {r} {g} {b}\n")),
                None => warn("one or three numbers behind `Kd`"),
            },
            _ => {}
        }
    }
    match tobj::load_mtl_buf(&mut clean.as_bytes()) {
        Ok((materials, _)) => materials.into_iter().map(convert).collect(),
        Err(error) => {
            warnings.push(format!("{}: {error}", quote::path(path)));
            Vec::new()
        }
    }
}

fn convert(material: tobj::Material) -> MtlMaterial {
    let color = material.diffuse.map_or(Color::DEFAULT, |diffuse| {
        Color(diffuse.map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8))
    });
    // `Tr` is one less `d`, which goes before it.
    let transparency = material.unknown_param.get("Tr");
    let transparency = transparency.and_then(|text| text.parse::<f64>().ok());
    let factor = (material.dissolve).or(transparency.map(|transparency| 1.0 - transparency));
    let factor = factor.unwrap_or(1.0);
    let name = |map: &Option<String>| map.as_deref().and_then(image_name).map(str::to_owned);
    MtlMaterial {
        texture: name(&material.diffuse_texture),
        opacity: name(&material.dissolve_texture),
        material: Material {
            opacity: match factor < 1.0 {
                true => Opacity::Blend(Alpha {
                    factor: factor as f32,
                    image: None,
                }),
                false => Opacity::Opaque,
            },
            ..Material::new(material.name, color)
        },
    }
}

/// The number of an opacity, which may follow `-halo`.
fn opacity(text: &str) -> Option<f32> {
    let text = text.split('#').next()?.trim();
    let text = text.strip_prefix("-halo").unwrap_or(text).trim();
    let number: f32 = text.parse().ok()?;
    (0.0..=1.0).contains(&number).then_some(number)
}

/// The numbers of a diffuse colour: one stands for all three.
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

/// The file's name behind the options of a texture map, as in `-s 1 1 1 wood.png`.
fn image_name(text: &str) -> Option<&str> {
    let mut rest = text.trim();
    while rest.starts_with('-') {
        let (option, mut after) = rest.split_once(char::is_whitespace)?;
        // `-o`, `-s` and `-t` have up to three numbers.
        let (least, most) = match option {
            "-o" | "-s" | "-t" => (1, 3),
            "-mm" => (2, 2),
            _ => (1, 1),
        };
        for taken in 0..most {
            after = after.trim_start();
            let (value, next) = after.split_once(char::is_whitespace)?;
            if taken >= least && value.parse::<f64>().is_err() {
                break;
            }
            after = next;
        }
        rest = after.trim_start();
    }
    (!rest.is_empty()).then_some(rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_colors_and_maps() {
        let text = b"\xef\xbb\xbf# caf\xe9\nKd 1 1 1\nnewmtl red one\n Kd 1.0 0.5 -3 \nKs 1\n\
            newmtl grey\r\nKd 0.2\nnewmtl plain\nmap_Kd -s 1 1 1 -bm 0.3 my wood.png\n";
        let mut warnings = Vec::new();
        let materials = read(Path::new("a.mtl"), text, &mut warnings);
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
        assert_eq!(materials[2].texture.as_deref(), Some("my wood.png"));
        assert!(warnings.is_empty(), "{warnings:?}");
    }

    #[test]
    fn leaves_out_what_it_cannot_read() {
        let text =
            b"newmtl a\nKd 1 0\nKd spectral x.rfl\nKd nan 0 0\nmap_Kd\nmap_Kd -s 1\nnewmtl\n";
        let mut warnings = Vec::new();
        let materials = read(Path::new("a.mtl"), text, &mut warnings);
        assert_eq!(materials.len(), 1);
        assert_eq!(materials[0].material.color, Color::DEFAULT);
        assert_eq!(materials[0].texture, None);
        assert_eq!(warnings.len(), 6, "{warnings:?}");
        assert_eq!(
            warnings[0],
            "a.mtl:2: expected one or three numbers behind `Kd`, found \"Kd 1 0\""
        );
    }
}
