//! The material library of an OBJ, and its images as PNG.

use super::parts::{Shortest, one_line};
use crate::scene::{
    Alpha, Color, Material, Object, Opacity, Reflectance, Scene, Texture, TextureProjection, Wrap,
};
use image::ExtendedColorType::{L8, Rgb8, Rgba8};
use image::ImageEncoder;
use image::codecs::png::PngEncoder;
use std::collections::{BTreeMap, HashMap};
use std::io;
use std::sync::Arc;

/// The files beside an OBJ: the library of its materials, and the images that this names.
#[derive(Clone, Debug, Default)]
pub struct MaterialLibrary {
    /// The library (MTL); empty where no object has a material or an image.
    pub text: String,
    /// PNG files by name, which belong beside the library.
    pub images: Vec<(String, Vec<u8>)>,
    /// What materials have and the library has not, in words.
    pub lost: Vec<String>,
    names: Vec<String>,
    /// For each visible object, indices into `names`: of the material of triangles that have none, and of its own materials.
    of_objects: Vec<(usize, Vec<usize>)>,
}

/// The name of the material of triangles without one.
const NONE: &str = "none";

impl MaterialLibrary {
    /// The materials of all visible objects, with unique names. `stem` begins the names of images.
    ///
    /// # Errors
    /// An image that PNG does not hold.
    pub fn new(scene: &Scene, stem: &str) -> io::Result<Self> {
        let mut writer = Writer {
            stem: one_line(stem),
            ..Writer::default()
        };
        let none = writer.add(NONE, color_line(Color::DEFAULT));
        let mut of_objects = Vec::new();
        for object in scene.objects.iter().filter(|object| object.visible) {
            let textured = || Material::new("textured", Color::DEFAULT);
            let plain = match &object.texture {
                None => none,
                Some(_) => writer.material(object, &textured())?,
            };
            let own = object.mesh.materials().iter();
            let own = own.map(|material| writer.material(object, material));
            of_objects.push((plain, own.collect::<io::Result<Vec<_>>>()?));
        }
        let is_empty = |(plain, own): &(usize, Vec<usize>)| *plain == none && own.is_empty();
        if of_objects.iter().all(is_empty) {
            return Ok(Self::default());
        }
        let lost = writer.lost.iter();
        let lost = lost.map(|(what, count)| format!("{what} ({count})"));
        Ok(Self {
            text: writer.text,
            images: writer.images,
            lost: lost.collect(),
            names: writer.names,
            of_objects,
        })
    }

    /// Whether no object has a material or an image: then no file is needed.
    pub fn is_empty(&self) -> bool {
        self.text.is_empty()
    }

    /// The name of an object's material, or of no material.
    pub(super) fn name(&self, object: usize, material: Option<u32>) -> &str {
        let number = self.of_objects.get(object).and_then(|(plain, own)| {
            let own = material.and_then(|material| own.get(material as usize));
            self.names.get(*own.unwrap_or(plain))
        });
        number.map_or(NONE, String::as_str)
    }
}

/// What was written so far.
#[derive(Default)]
struct Writer {
    stem: String,
    text: String,
    images: Vec<(String, Vec<u8>)>,
    names: Vec<String>,
    /// The materials by the name that they should have, and the lines that say what they are.
    known: HashMap<(String, String), usize>,
    /// How many materials should have a name.
    taken: HashMap<String, usize>,
    /// The numbers of images by their addresses and what is written of them.
    known_images: HashMap<(usize, Part), usize>,
    /// What the library has not, and of how many materials.
    lost: BTreeMap<&'static str, usize>,
}

impl Writer {
    /// Adds a material, if the same one is not there already; returns its number.
    fn add(&mut self, name: &str, lines: String) -> usize {
        let key = (name.to_owned(), lines);
        if let Some(&known) = self.known.get(&key) {
            return known;
        }
        let mut unique = name.to_owned();
        while self.taken.contains_key(&unique) {
            let count = self.taken.entry(name.to_owned()).or_default();
            *count += 1;
            unique = format!("{name} {count}");
        }
        self.taken.insert(unique.clone(), 1);
        self.text += &format!("newmtl {unique}\n{}", key.1);
        self.names.push(unique);
        self.known.insert(key, self.names.len() - 1);
        self.names.len() - 1
    }

    fn material(&mut self, object: &Object, material: &Material) -> io::Result<usize> {
        let name = match one_line(&material.name) {
            name if name.is_empty() => "unnamed".to_owned(),
            name => name,
        };
        let has_uvs = object.mesh.has_uvs();
        let mut lines = color_line(material.color);
        lines += &self.opacity(&material.opacity, has_uvs)?;
        if let Some(reflectance) = &material.reflectance {
            lines += &self.reflectance(reflectance, has_uvs)?;
        }
        let own = material.texture.as_ref();
        if let Some(image) = object.texture.as_ref().or(own) {
            let projection = object.mapping.projection.unwrap_or_default();
            let is_placed = has_uvs && projection == TextureProjection::Uv;
            lines += &self.image("map_Kd", (image, Part::Colors), is_placed)?;
            if object.blend_by.is_some() {
                self.lose("weights of images");
            }
        }
        Ok(self.add(&name, lines))
    }

    fn opacity(&mut self, opacity: &Opacity, has_uvs: bool) -> io::Result<String> {
        let mut lines = String::new();
        let Some(Alpha { factor, image }) = opacity.alpha() else {
            return Ok(lines);
        };
        match opacity {
            Opacity::Mask { cutoff, .. } => match image {
                None => self.lose("masks without an image"),
                Some(_) if *factor != 1.0 || *cutoff != Opacity::CUTOFF => {
                    self.lose("thresholds of masks");
                }
                Some(_) => {}
            },
            // An image of opacity alone is read as a mask: where it blends, the factor is the number before 1.
            _ => {
                let factor = match image {
                    Some(_) => factor.min(1f32.next_down()),
                    None => *factor,
                };
                if factor < 1.0 {
                    lines = format!("d {}\n", Shortest(factor));
                }
            }
        }
        if let Some(image) = image {
            lines += &self.image("map_d", (image, Part::channel(3, 1.0)), has_uvs)?;
        }
        Ok(lines)
    }

    fn reflectance(&mut self, reflectance: &Reflectance, has_uvs: bool) -> io::Result<String> {
        if reflectance.is_unlit {
            self.lose("that materials are unlit");
        }
        let Reflectance {
            metallic,
            roughness,
            emission,
            ..
        } = *reflectance;
        let [r, g, b] = emission.map(Shortest);
        let numbers = (Shortest(metallic), Shortest(roughness));
        let mut lines = format!("Pm {}\nPr {}\nKe {r} {g} {b}\n", numbers.0, numbers.1);
        if let Some(image) = &reflectance.texture {
            // Where there is an image, a library's number does not count.
            for (keyword, channel, factor) in [("map_Pr", 1, roughness), ("map_Pm", 2, metallic)] {
                if (image.texels().iter()).any(|texel| texel[channel] < u8::MAX) {
                    let part = Part::channel(channel, factor);
                    lines += &self.image(keyword, (image, part), has_uvs)?;
                }
            }
        }
        // A black emission is one without an image.
        let emits = emission != [0.0; 3];
        if let Some(image) = reflectance.emission_texture.as_ref().filter(|_| emits) {
            lines += &self.image("map_Ke", (image, Part::Colors), has_uvs)?;
        }
        Ok(lines)
    }

    /// The line of an image.
    fn image(
        &mut self,
        keyword: &str,
        (image, part): (&Arc<Texture>, Part),
        is_placed: bool,
    ) -> io::Result<String> {
        if !is_placed {
            self.lose("images that are not placed by texture coordinates");
            return Ok(String::new());
        }
        let options = match image.wrap() {
            [Wrap::Repeat, Wrap::Repeat] => "",
            [Wrap::Clamp, Wrap::Clamp] => "-clamp on ",
            [across, down] => {
                self.lose("what is beyond images");
                let repeats = |wrap| matches!(wrap, Wrap::Repeat | Wrap::Mirror);
                if repeats(across) || repeats(down) {
                    ""
                } else {
                    "-clamp on "
                }
            }
        };
        let key = (Arc::as_ptr(image) as usize, part);
        let number = match self.known_images.get(&key) {
            Some(&known) => known,
            None => {
                let name = format!("{}-{}.png", self.stem, self.images.len() + 1);
                self.images.push((name, encode(image, part)?));
                self.known_images.insert(key, self.images.len() - 1);
                self.images.len() - 1
            }
        };
        let name = &self.images[number].0;
        // A name that begins with a minus would be an option.
        let folder = if name.starts_with('-') { "./" } else { "" };
        Ok(format!("{keyword} {options}{folder}{name}\n"))
    }

    fn lose(&mut self, what: &'static str) {
        *self.lost.entry(what).or_default() += 1;
    }
}

fn color_line(Color(channels): Color) -> String {
    let [r, g, b] = channels.map(unit_channel);
    format!("Kd {r} {g} {b}\n")
}

/// A channel from 0 to 1, with enough digits to restore eight bits.
pub(super) fn unit_channel(channel: u8) -> Shortest<f64> {
    Shortest((f64::from(channel) / 255.0 * 1e4).round() / 1e4)
}

/// What is written of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Part {
    Colors,
    /// A channel as greys, times a factor from 0 to 1 with these bits.
    Channel(usize, u32),
}

impl Part {
    fn channel(channel: usize, factor: f32) -> Self {
        Self::Channel(channel, factor.to_bits())
    }
}

/// A PNG of an image, or of a part of it.
fn encode(image: &Texture, part: Part) -> io::Result<Vec<u8>> {
    let texels = image.texels();
    let is_opaque = texels.iter().all(|texel| texel[3] == u8::MAX);
    let (bytes, kind): (Vec<u8>, _) = match (part, is_opaque) {
        (Part::Channel(channel, factor), _) => {
            let factor = f32::from_bits(factor);
            let grey = |texel: &[u8; 4]| (f32::from(texel[channel]) * factor).round() as u8;
            (texels.iter().map(grey).collect(), L8)
        }
        (Part::Colors, true) => (
            texels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect(),
            Rgb8,
        ),
        (Part::Colors, false) => (texels.as_flattened().to_vec(), Rgba8),
    };
    let mut file = Vec::new();
    PngEncoder::new(&mut file)
        .write_image(&bytes, image.width(), image.height(), kind)
        .map_err(io::Error::other)?;
    Ok(file)
}
