use super::Quantity;
use std::str::FromStr;

/// A colour as people choose it: sRGB, 8 bits a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Color(pub [u8; 3]);

impl Color {
    /// Light grey: the colour of triangles to which neither their file nor a rule gives one, unless the picture's
    /// shading sets another.
    pub const DEFAULT: Self = Self([0xc8, 0xcc, 0xd2]);
}

impl FromStr for Color {
    type Err = String;

    /// Parses `#rrggbb` or `#rgb` (each digit doubled): hexadecimal, the `#` optional.
    fn from_str(text: &str) -> Result<Self, String> {
        let digits = text.strip_prefix('#').unwrap_or(text);
        let value = u32::from_str_radix(digits, 16)
            .ok()
            .filter(|_| digits.bytes().all(|b| b.is_ascii_hexdigit()));
        match (value, digits.len()) {
            (Some(value), 6) => Ok(Self([(value >> 16) as u8, (value >> 8) as u8, value as u8])),
            (Some(value), 3) => Ok(Self(
                [8, 4, 0].map(|shift| (value >> shift & 15) as u8 * 17),
            )),
            _ => Err(format!(
                "expected a colour as #rrggbb or #rgb, found {text:?}"
            )),
        }
    }
}

impl std::fmt::Display for Color {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [r, g, b] = self.0;
        write!(f, "#{r:02x}{g:02x}{b:02x}")
    }
}

/// How an object's triangles get their colours.
#[derive(Clone, Debug, PartialEq)]
pub enum ColorRule {
    /// One colour for the whole object.
    Uniform(Color),
    /// A pseudorandom colour a triangle, from its number and the seed.
    PerTriangle {
        /// The seed; each selects another assignment of colours.
        seed: u32,
    },
    /// The file's materials and vertex colours; the shading's plain colour where it gives none. In unlit pictures of a
    /// mesh without any materials or vertex colours, a colour a triangle.
    File,
    /// A colour an object, from its number.
    ByObject,
    /// A colour a [group](super::Groups) of the mesh's triangles, from its number in the file; the shading's plain
    /// colour for triangles in none.
    ByGroup,
    /// The direction of the surface normal in the world (x red, y green, z blue): by the mesh's own normals, else of
    /// the triangle's front side.
    Normal,
    /// A quantity at each point, through the picture's [`ColorScale`](super::ColorScale).
    Value(Quantity),
}

impl std::fmt::Display for ColorRule {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Uniform(color) => color.fmt(f),
            Self::PerTriangle { seed: 0 } => f.write_str("per-triangle"),
            Self::PerTriangle { seed } => write!(f, "per-triangle:{seed}"),
            Self::File => f.write_str("file"),
            Self::ByObject => f.write_str("object"),
            Self::ByGroup => f.write_str("group"),
            Self::Normal => f.write_str("normal"),
            Self::Value(quantity) => quantity.fmt(f),
        }
    }
}

impl FromStr for ColorRule {
    type Err = String;

    /// Parses what [`ColorRule`] displays, and `per-triangle:0`, `curvature:mean` and colours as [`Color`] parses them.
    fn from_str(text: &str) -> Result<Self, String> {
        let (kind, of) = match text.split_once(':') {
            Some((kind, of)) => (kind, Some(of)),
            None => (text, None),
        };
        match (kind, of) {
            ("file", None) => Ok(Self::File),
            ("object", None) => Ok(Self::ByObject),
            ("group", None) => Ok(Self::ByGroup),
            ("normal", None) => Ok(Self::Normal),
            ("per-triangle", None) => Ok(Self::PerTriangle { seed: 0 }),
            ("per-triangle", Some(seed)) => match seed.parse() {
                Ok(seed) => Ok(Self::PerTriangle { seed }),
                Err(_) => Err(format!("expected a seed from 0 to {}, found {seed:?}", u32::MAX)),
            },
            ("area" | "distance" | "curvature" | "scalar", _) => text.parse().map(Self::Value),
            _ => text.parse().map(Self::Uniform).map_err(|_| {
                format!(
                    "expected file, per-triangle, per-triangle:SEED, object, group, normal, area, \
                     distance, distance:X,Y,Z, curvature, curvature:gaussian, scalar:NAME, #rrggbb or #rgb, found {text:?}"
                )
            }),
        }
    }
}

impl ColorRule {
    /// The colour of `triangle`, where the rule and the triangle's number alone decide it; `None` for other rules.
    pub fn color(&self, triangle: u32) -> Option<Color> {
        match *self {
            Self::Uniform(color) => Some(color),
            Self::PerTriangle { seed } => Some(triangle_color(seed, triangle)),
            _ => None,
        }
    }

    /// Whether the file decides.
    #[inline]
    pub fn is_file(&self) -> bool {
        matches!(self, Self::File)
    }

    /// The colour that [`ColorRule::ByObject`] gives the object of this number.
    pub fn of_object(number: u32) -> Color {
        triangle_color(OBJECTS, number)
    }

    /// The colour that [`ColorRule::ByGroup`] gives the group of this number.
    pub fn of_group(number: u32) -> Color {
        triangle_color(GROUPS, number)
    }
}

/// The seed of objects' colours, so that they differ from those of triangles with seed 0.
const OBJECTS: u32 = 1;

/// The seed of groups' colours.
const GROUPS: u32 = 2;

/// A pseudorandom colour of any hue that is neither dark nor grey.
fn triangle_color(seed: u32, triangle: u32) -> Color {
    let bits = mix(triangle.wrapping_add(mix(seed.wrapping_add(0x9e37_79b9))));
    let hue = (bits & 0xffff) as f32 / 65536.0 * 6.0;
    let low = 0.25 + ((bits >> 16) & 0xff) as f32 / 255.0 * 0.3;
    let high = 0.8 + (bits >> 24) as f32 / 255.0 * 0.2;
    // Without the library's remainder and rounding, which took most of the time: differences of 6 from up to twice that, and
    // of a number and its whole part, are exact.
    let channel = |shift: f32| {
        let turned = hue + shift;
        let turned = if turned < 6.0 { turned } else { turned - 6.0 };
        let ramp = (turned - 3.0).abs() - 1.0;
        let value = (low + (high - low) * ramp.clamp(0.0, 1.0)) * 255.0;
        let whole = value as u8;
        whole + u8::from(value - f32::from(whole) >= 0.5)
    };
    Color([channel(0.0), channel(4.0), channel(2.0)])
}

/// A 32-bit integer hash with good avalanche (Ettinger, "Hash function prospector", 2018:
/// `lowbias32`).
fn mix(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn displayed_colors_parse_to_themselves() {
        let color = Color([1, 0xab, 255]);
        assert_eq!(color.to_string().parse(), Ok(color));
        assert_eq!("#0aF".parse(), Ok(Color([0, 0xaa, 255])));
        assert_eq!("fff".parse(), "#ffffff".parse::<Color>());
        for bad in [
            "", "#12", "#1234", "#ggg", "+12", "#12345", "#1234567", "#gg0000", "+12345",
        ] {
            assert!(bad.parse::<Color>().is_err(), "{bad}");
        }
    }

    #[test]
    fn displayed_rules_parse_to_themselves() {
        for text in [
            "file",
            "per-triangle",
            "per-triangle:7",
            "object",
            "group",
            "normal",
            "area",
            "distance",
            "distance:1,-2.5,3",
            "curvature",
            "curvature:gaussian",
            "scalar:quality",
            "scalar:a:b",
            "#0102ff",
        ] {
            let rule: ColorRule = text.parse().expect(text);
            assert_eq!(rule.to_string(), text);
        }
        for bad in [
            "",
            "per-triangle:",
            "per-triangle:-1",
            "file:1",
            "#12345",
            "area:2",
            "distance:1,2",
            "distance:1,2,inf",
            "curvature:odd",
            "scalar",
            "scalar:",
            "object:1",
        ] {
            assert!(bad.parse::<ColorRule>().is_err(), "{bad}");
        }
    }

    /// Against the formula with the library's remainder and rounding.
    #[test]
    fn channels_are_rounded_to_the_nearest() {
        for triangle in 0..200_000_u32 {
            let bits = mix(triangle.wrapping_add(mix(0x9e37_79b9)));
            let hue = (bits & 0xffff) as f32 / 65536.0 * 6.0;
            let low = 0.25 + ((bits >> 16) & 0xff) as f32 / 255.0 * 0.3;
            let high = 0.8 + (bits >> 24) as f32 / 255.0 * 0.2;
            let expected = [0.0, 4.0, 2.0].map(|shift: f32| {
                let ramp = ((hue + shift).rem_euclid(6.0) - 3.0).abs() - 1.0;
                ((low + (high - low) * ramp.clamp(0.0, 1.0)) * 255.0).round() as u8
            });
            assert_eq!(triangle_color(0, triangle), Color(expected), "{triangle}");
        }
    }

    #[test]
    fn triangle_colors_repeat_and_differ() {
        let colors: Vec<_> = (0..1000).map(|i| triangle_color(7, i)).collect();
        assert_eq!(
            colors,
            (0..1000).map(|i| triangle_color(7, i)).collect::<Vec<_>>()
        );
        let distinct: std::collections::HashSet<_> = colors.iter().collect();
        assert!(distinct.len() > 950, "{}", distinct.len());
        assert_ne!(triangle_color(7, 0), triangle_color(8, 0));
        assert!(colors.iter().all(|c| c.0.iter().max() >= Some(&200)));
    }
}
