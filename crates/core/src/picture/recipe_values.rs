//! The values of a recipe's lines: for each type its text, and the value of a text.

use crate::camera::Stereo;
use crate::hit::{Cull, Precision};
use crate::scene::{Color, ColorMap, ColorScale, TextureProjection};
use crate::shade::{Background, EdgeKinds, Filter, LightSet, Mode, Wireframe};
use glam::DVec3;
use std::fmt::LowerExp;
use std::str::FromStr;

/// A number with the fewest digits that read back as the same number.
pub(super) fn float(number: &impl LowerExp) -> String {
    format!("{number:e}")
}

pub(super) fn vector(vector: DVec3) -> String {
    let [x, y, z] = vector.to_array().map(|number| float(&number));
    format!("[{x}, {y}, {z}]")
}

/// The text between quotes.
pub(super) fn unquoted(value: &str) -> Option<&str> {
    value.strip_prefix('"')?.strip_suffix('"')
}

/// The items between brackets.
fn items(value: &str) -> Option<std::str::Split<'_, &'static str>> {
    Some(value.strip_prefix('[')?.strip_suffix(']')?.split(", "))
}

/// The numbers between brackets.
pub(super) fn parse_list<T: FromStr, const N: usize>(value: &str) -> Option<[T; N]> {
    let items: Option<Vec<T>> = items(value)?.map(|item| item.parse().ok()).collect();
    items?.try_into().ok()
}

pub(super) fn parse_color(value: &str) -> Option<Color> {
    unquoted(value)?.parse().ok()
}

/// What [`parse_wireframe`] expects, for messages; likewise below.
pub(super) const WIREFRAME: &str = "a width, a colour and perhaps edges, or \"none\"";

/// The types of edges and the strength of hidden lines are written where they are not the defaults.
pub(super) fn wireframe_text(lines: Option<&Wireframe>) -> String {
    let Some(lines) = lines else {
        return "\"none\"".to_owned();
    };
    let Wireframe {
        width,
        color,
        edges,
        hidden,
    } = lines;
    let more = match (*edges, *hidden) {
        (EdgeKinds::ALL, 0.0) => String::new(),
        _ => format!(", \"{edges}\", {}", float(hidden)),
    };
    format!("[{}, \"{color}\"{more}]", float(width))
}

pub(super) fn parse_wireframe(value: &str) -> Option<Option<Wireframe>> {
    if value == "\"none\"" {
        return Some(None);
    }
    let mut items = items(value)?;
    let (width, color) = (items.next()?, unquoted(items.next()?)?);
    let lines = Wireframe {
        width: width.parse().ok()?,
        color: color.parse().ok()?,
        edges: EdgeKinds::ALL,
        hidden: 0.0,
    };
    Some(Some(match (items.next(), items.next()) {
        (Some(edges), Some(hidden)) => Wireframe {
            edges: unquoted(edges)?.parse().ok()?,
            hidden: hidden.parse().ok()?,
            ..lines
        },
        _ => lines,
    }))
}

pub(super) const BACKGROUND: &str = "two colours, or \"transparent\"";

pub(super) fn background_text(background: &Background) -> String {
    match background {
        Background::Transparent => "\"transparent\"".to_owned(),
        Background::Gradient(top, bottom) => format!("[\"{top}\", \"{bottom}\"]"),
    }
}

pub(super) fn parse_background(value: &str) -> Option<Background> {
    if value == "\"transparent\"" {
        return Some(Background::Transparent);
    }
    let mut colors = items(value)?.map(parse_color);
    Some(Background::Gradient(colors.next()??, colors.next()??))
}

pub(super) const SCALE: &str = "a color map, \"fitted\" or two numbers, and perhaps \"legend\"";

pub(super) fn scale_text(ColorScale { map, range, legend }: &ColorScale) -> String {
    let range = match range {
        None => "\"fitted\"".to_owned(),
        Some([low, high]) => format!("{}, {}", float(low), float(high)),
    };
    let legend = if *legend { ", \"legend\"" } else { "" };
    format!("[\"{}\", {range}{legend}]", color_map_word(*map))
}

pub(super) fn parse_scale(value: &str) -> Option<ColorScale> {
    let mut items = items(value)?;
    let map = parse_color_map(unquoted(items.next()?)?)?;
    let range = match items.next()? {
        "\"fitted\"" => None,
        low => Some([low.parse().ok()?, items.next()?.parse().ok()?]),
    };
    let legend = items.next().is_some();
    Some(ColorScale { map, range, legend })
}

pub(super) const STEREO: &str = "a kind of picture for two eyes, and one or two distances";

pub(super) fn stereo_text(stereo: &Stereo) -> String {
    let distances = [Some(stereo.eye_distance), stereo.convergence];
    let distances = distances.iter().flatten().map(float);
    let kind = format!("\"{}\"", stereo.kind);
    let items: Vec<_> = std::iter::once(kind).chain(distances).collect();
    format!("[{}]", items.join(", "))
}

pub(super) fn parse_stereo(value: &str) -> Option<Stereo> {
    let mut items = items(value)?;
    Some(Stereo {
        kind: unquoted(items.next()?)?.parse().ok()?,
        eye_distance: items.next()?.parse().ok()?,
        convergence: items.next().map(str::parse).transpose().ok()?,
    })
}

/// The word for each of an enum's variants, and back. A variant without a word does not compile.
macro_rules! words {
    ($word:ident, $parse:ident: $kind:ident { $($variant:ident = $text:literal),+ $(,)? }) => {
        pub(super) fn $word(value: $kind) -> &'static str {
            match value { $($kind::$variant => $text),+ }
        }

        pub(super) fn $parse(word: &str) -> Option<$kind> {
            match word { $($text => Some($kind::$variant),)+ _ => None }
        }
    };
}

words!(color_map_word, parse_color_map: ColorMap {
    Viridis = "viridis",
    Magma = "magma",
    Turbo = "turbo",
    Cividis = "cividis",
    Diverging = "diverging",
});
words!(cull_word, parse_cull: Cull { None = "none", Back = "back" });
words!(precision_word, parse_precision: Precision { Fast = "fast", Exact = "exact" });
words!(mode_word, parse_mode: Mode {
    Color = "color",
    Flat = "flat",
    Smooth = "smooth",
    Material = "material",
    Normals = "normals",
    Depth = "depth",
    Barycentric = "barycentric",
    Uv = "uv",
    Texture = "texture",
    Wireframe = "wireframe",
    XRay = "x-ray",
});
words!(lights_word, parse_lights: LightSet {
    Soft = "soft",
    Headlight = "headlight",
    ThreePoint = "three-point",
});
words!(filter_word, parse_filter: Filter {
    Nearest = "nearest",
    Bilinear = "bilinear",
    Trilinear = "trilinear",
    Ewa = "ewa",
});
words!(texture_projection_word, parse_texture_projection: TextureProjection {
    Uv = "uv",
    Triplanar = "triplanar",
    PerTriangle = "per-triangle",
    Plane = "plane",
    Sphere = "sphere",
    Cylinder = "cylinder",
    Camera = "camera",
});
