//! The options of a material library's images, which stand before their names: `-s 2 2 -clamp on wood.png`.

use super::content::NONE;
use crate::formats::error::FormatError;
use crate::formats::limits::Budget;
use crate::scene::MeshData;
use glam::{DVec2, Vec2};
use std::collections::HashMap;
use std::path::Path;

/// The channel of an image that a scalar is read from (`-imfchan`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Channel {
    Red,
    Green,
    Blue,
    Alpha,
    Luminance,
}

impl Channel {
    /// That of an option's value. The depth of images (`z`), which no format that is read has, is none.
    fn parse(word: &str) -> Option<Self> {
        match word {
            "r" => Some(Self::Red),
            "g" => Some(Self::Green),
            "b" => Some(Self::Blue),
            "m" => Some(Self::Alpha),
            "l" => Some(Self::Luminance),
            _ => None,
        }
    }

    /// Its number in a texel. Luminance is that of ITU-R BT.709, of the numbers as they are stored: scalars are not
    /// colours.
    pub(super) fn of(self, [red, green, blue, alpha]: [u8; 4]) -> u8 {
        match self {
            Self::Red => red,
            Self::Green => green,
            Self::Blue => blue,
            Self::Alpha => alpha,
            Self::Luminance => {
                let [red, green, blue] = [red, green, blue].map(u32::from);
                ((red * 2126 + green * 7152 + blue * 722 + 5000) / 10_000) as u8
            }
        }
    }
}

/// What options say of where an image lies, and of which of its channels is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MapOptions {
    /// Texture coordinates are multiplied by this (`-s`),
    scale: DVec2,
    /// and moved by this (`-o`).
    offset: DVec2,
    /// Whether there is one copy of the image, whose outermost texels go on beyond it (`-clamp on`).
    pub(super) clamps: bool,
    /// The channel of a scalar (`-imfchan`); `None` where none is named.
    pub(super) channel: Option<Channel>,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self {
            scale: DVec2::ONE,
            offset: DVec2::ZERO,
            clamps: false,
            channel: None,
        }
    }
}

impl MapOptions {
    /// Takes an option; returns whether it is one of those that are obeyed.
    fn take(&mut self, option: &str, values: &[&str]) -> bool {
        let numbers = || -> Option<Vec<f64>> {
            let number = |word: &&str| word.parse().ok().filter(|number: &f64| number.is_finite());
            values.iter().map(number).collect()
        };
        let with = |mut usual: DVec2, numbers: Vec<f64>| {
            // The third is for textures of space.
            for (to, number) in [&mut usual.x, &mut usual.y].into_iter().zip(numbers) {
                *to = number;
            }
            usual
        };
        match (option, numbers(), values) {
            ("-s", Some(numbers), _) => self.scale = with(DVec2::ONE, numbers),
            ("-o", Some(numbers), _) => self.offset = with(DVec2::ZERO, numbers),
            ("-clamp", _, ["on" | "off"]) => self.clamps = values == ["on"],
            ("-imfchan", _, [channel]) => {
                self.channel = Channel::parse(channel);
                return self.channel.is_some();
            }
            _ => return false,
        }
        true
    }

    /// Whether texture coordinates are moved alike.
    pub(super) fn moves_as(&self, other: &Self) -> bool {
        self.scale == other.scale && self.offset == other.offset
    }

    /// A key that is the same for options that move coordinates alike.
    fn key(&self) -> [u64; 4] {
        let Self { scale, offset, .. } = self;
        [scale.x, scale.y, offset.x, offset.y].map(f64::to_bits)
    }

    /// `None` beyond the range of single precision.
    fn moved(&self, uv: Vec2) -> Option<Vec2> {
        let uv = (uv.as_dvec2() * self.scale + self.offset).as_vec2();
        uv.is_finite().then_some(uv)
    }
}

/// An image with its options.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MtlImage {
    /// Its path, as the library writes it.
    pub(super) name: String,
    pub(super) options: MapOptions,
    /// Whether it has options that are not obeyed.
    pub(super) has_others: bool,
}

impl MtlImage {
    /// Reads what follows a keyword. `None` without a name.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let mut options = MapOptions::default();
        let mut has_others = false;
        let mut rest = text.trim();
        while rest.starts_with('-') {
            let (option, mut after) = rest.split_once(char::is_whitespace)?;
            // `-o`, `-s` and `-t` have up to three numbers.
            let (least, most) = match option {
                "-o" | "-s" | "-t" => (1, 3),
                "-mm" => (2, 2),
                _ => (1, 1),
            };
            let mut values = Vec::with_capacity(most);
            // The last word is the name.
            while let Some((word, next)) = after.trim_start().split_once(char::is_whitespace) {
                let is_value = values.len() < least || word.parse::<f64>().is_ok();
                if values.len() == most || !is_value {
                    break;
                }
                values.push(word);
                after = next;
            }
            if values.len() < least {
                return None;
            }
            has_others |= !options.take(option, &values);
            rest = after.trim_start();
        }
        (!rest.is_empty()).then(|| Self {
            name: rest.to_owned(),
            options,
            has_others,
        })
    }
}

/// Moves the texture coordinates of triangles as the options of their materials say; `options` has those of each.
/// Coordinates that triangles of other options use as well are copied. A triangle with a coordinate beyond single
/// precision gets none.
///
/// # Errors
/// The copies would exceed the budget.
pub(super) fn move_coordinates(
    path: &Path,
    mesh: &mut MeshData,
    options: &[MapOptions],
    budget: &Budget,
) -> Result<(), FormatError> {
    let Some(uvs) = &mut mesh.uvs else {
        return Ok(());
    };
    // Materials with the same options share copies: their kind is the index of the first of them.
    let mut firsts: HashMap<[u64; 4], u32> = HashMap::new();
    let kinds: Vec<Option<(u32, MapOptions)>> = (0..)
        .zip(options)
        .map(|(number, options)| {
            let first = *firsts.entry(options.key()).or_insert(number);
            let moves = !options.moves_as(&MapOptions::default());
            moves.then_some((first, *options))
        })
        .collect();
    let moved = |material: u32| kinds.get(material as usize).copied().flatten();
    let corners = 3
        * (mesh.material_of_triangle.iter())
            .filter(|&&material| moved(material).is_some())
            .count();
    if corners == 0 {
        return Ok(());
    }
    // For each corner a copy and an entry of the table of copies; both grow by doubling.
    let entry = size_of::<Vec2>() + size_of::<((u32, u32), u32)>();
    let share = budget.share(path, "texture coordinates", (2 * corners * entry) as u64)?;
    let before = uvs.values.capacity();
    let mut known: HashMap<(u32, u32), u32> = HashMap::new();
    let indices = uvs.indices.get_or_insert_with(|| mesh.triangles.clone());
    for (triangle, &material) in indices.iter_mut().zip(&mesh.material_of_triangle) {
        let Some((kind, options)) = moved(material).filter(|_| triangle[0] != NONE) else {
            continue;
        };
        for index in triangle.iter_mut() {
            let values = &mut uvs.values;
            *index = *known.entry((kind, *index)).or_insert_with(|| {
                let uv = values
                    .get(*index as usize)
                    .and_then(|uv| options.moved(*uv));
                let Some(uv) = uv.filter(|_| values.len() < NONE as usize) else {
                    return NONE;
                };
                values.push(uv);
                (values.len() - 1) as u32
            });
        }
        if triangle.contains(&NONE) {
            *triangle = [NONE; 3];
        }
    }
    let grown = uvs.values.capacity() - before;
    share.keep((grown * size_of::<Vec2>()) as u64);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Attribute;

    #[test]
    fn options_stand_before_a_name() {
        let options = |scale: [f64; 2], offset: [f64; 2], clamps| MapOptions {
            scale: DVec2::from_array(scale),
            offset: DVec2::from_array(offset),
            clamps,
            channel: None,
        };
        for (text, expected, has_others, name) in [
            ("a.png", options([1.0; 2], [0.0; 2], false), false, "a.png"),
            (
                "-s 2 my wood.png",
                options([2.0, 1.0], [0.0; 2], false),
                false,
                "my wood.png",
            ),
            (
                "-o 0.5 -1 7 -s 2 3 1 -clamp on a.png",
                options([2.0, 3.0], [0.5, -1.0], true),
                false,
                "a.png",
            ),
            (
                "-clamp off -bm 0.3 a.png",
                options([1.0; 2], [0.0; 2], false),
                true,
                "a.png",
            ),
            (
                "-s x a.png",
                options([1.0; 2], [0.0; 2], false),
                true,
                "a.png",
            ),
            (
                "-s inf 1 a.png",
                options([1.0; 2], [0.0; 2], false),
                true,
                "a.png",
            ),
            (
                "-mm 0 2 a.png",
                options([1.0; 2], [0.0; 2], false),
                true,
                "a.png",
            ),
            (
                "-imfchan l -clamp on a.png",
                MapOptions {
                    channel: Some(Channel::Luminance),
                    ..options([1.0; 2], [0.0; 2], true)
                },
                false,
                "a.png",
            ),
            (
                "-imfchan z a.png",
                options([1.0; 2], [0.0; 2], false),
                true,
                "a.png",
            ),
        ] {
            let image = MtlImage::parse(text).expect(text);
            let MtlImage {
                name: found,
                options,
                has_others: others,
            } = image;
            assert_eq!(
                (found.as_str(), options, others),
                (name, expected, has_others),
                "{text}"
            );
        }
        for text in ["", "  ", "-s 1", "-clamp on", "-s"] {
            assert_eq!(MtlImage::parse(text), None, "{text}");
        }
    }

    #[test]
    fn coordinates_are_moved_once_for_each_kind_of_options() {
        let twice = MtlImage::parse("-s 2 2 -o 1 0 a.png")
            .expect("a name")
            .options;
        let far = MtlImage::parse("-s 1e300 1 a.png").expect("a name").options;
        let options = [MapOptions::default(), twice, twice, far];
        let values = vec![Vec2::ZERO, Vec2::new(0.5, 0.25), Vec2::ONE];
        let mut mesh = MeshData {
            triangles: vec![[0, 1, 2]; 6],
            material_of_triangle: vec![0, 1, 2, 3, NONE, 1],
            uvs: Some(Attribute {
                values: values.clone(),
                indices: Some(vec![
                    [0, 1, 2],
                    [0, 1, 2],
                    [2, 1, 0],
                    [0, 1, 2],
                    [1, 1, 1],
                    [NONE; 3],
                ]),
            }),
            ..MeshData::default()
        };
        move_coordinates(Path::new("a.obj"), &mut mesh, &options, &Budget::default())
            .expect("a good mesh");
        let uvs = mesh.uvs.expect("coordinates");
        let moved = [Vec2::X, Vec2::new(2.0, 0.5), Vec2::new(3.0, 2.0)];
        assert_eq!(uvs.values[..3], values[..], "those of others stay");
        assert_eq!(uvs.values[3..6], moved);
        let expected = [
            [0, 1, 2],
            [3, 4, 5],
            [5, 4, 3],
            [NONE; 3],
            [1, 1, 1],
            [NONE; 3],
        ];
        assert_eq!(uvs.indices.as_deref(), Some(&expected[..]));
    }
}
