//! Values of the options of shading.

use super::values::{Names, list, number};
use raycast_core::glam::DVec2;
use raycast_core::ranges;
use raycast_core::scene::{Color, ColorMap, ColorRule, Crop, TextureProjection, Wrap};
use raycast_core::shade::{Background, Filter, Ground, GroundError, LightSet, Mode};

/// `--color`: the rule for every object.
pub type SceneColor = ColorRule;

pub(super) const MODES: Names<Mode> = &[
    ("color", Mode::Color),
    ("flat", Mode::Flat),
    ("smooth", Mode::Smooth),
    ("material", Mode::Material),
    ("normals", Mode::Normals),
    ("depth", Mode::Depth),
    ("barycentric", Mode::Barycentric),
    ("uv", Mode::Uv),
    ("texture", Mode::Texture),
    ("wireframe", Mode::Wireframe),
    ("x-ray", Mode::XRay),
];

pub(super) const TEXTURE_PROJECTIONS: Names<TextureProjection> = &[
    ("uv", TextureProjection::Uv),
    ("triplanar", TextureProjection::Triplanar),
    ("per-triangle", TextureProjection::PerTriangle),
    ("plane", TextureProjection::Plane),
    ("sphere", TextureProjection::Sphere),
    ("cylinder", TextureProjection::Cylinder),
    ("camera", TextureProjection::Camera),
];

pub(super) const LIGHTS: Names<LightSet> = &[
    ("soft", LightSet::Soft),
    ("headlight", LightSet::Headlight),
    ("three-point", LightSet::ThreePoint),
];

pub(super) const FILTERS: Names<Filter> = &[
    ("nearest", Filter::Nearest),
    ("bilinear", Filter::Bilinear),
    ("trilinear", Filter::Trilinear),
    ("ewa", Filter::Ewa),
];

pub(super) const COLOR_MAPS: Names<ColorMap> = &[
    ("viridis", ColorMap::Viridis),
    ("magma", ColorMap::Magma),
    ("turbo", ColorMap::Turbo),
    ("cividis", ColorMap::Cividis),
    ("diverging", ColorMap::Diverging),
];

/// Parses an x-ray opacity.
pub(super) fn opacity(text: &str) -> Result<f32, String> {
    ranges::opacity(number(text)?).map_err(|error| error.to_string())
}

/// `--back-faces`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BackFacesArg {
    /// The same colours as in front, whatever the scene file says.
    None,
    /// This colour.
    Color(Color),
}

/// Parses `--back-faces`.
pub(super) fn back_faces(text: &str) -> Result<BackFacesArg, String> {
    match text {
        "none" => Ok(BackFacesArg::None),
        _ => text
            .parse()
            .map(BackFacesArg::Color)
            .map_err(|_| "expected #rrggbb, #rgb or none".to_owned()),
    }
}

/// `--ground`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GroundArg {
    /// No grid, whatever the scene file says.
    None,
    /// A grid there.
    Some(Ground),
}

/// Parses `--ground`.
pub(super) fn ground(text: &str) -> Result<GroundArg, String> {
    match text {
        "none" => Ok(GroundArg::None),
        _ => text
            .parse()
            .map(GroundArg::Some)
            .map_err(|error| match error {
                GroundError::Word => format!("{error}, or none"),
                GroundError::Range(error) => error.to_string(),
            }),
    }
}

/// `--wireframe`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WireframeArg {
    /// No lines, whatever the scene file says.
    None,
    /// Lines of this width in pixels.
    Width(f32),
}

/// Parses a line's width in pixels, or `none`.
pub(super) fn wireframe(text: &str) -> Result<WireframeArg, String> {
    if text == "none" {
        return Ok(WireframeArg::None);
    }
    let width = number(text).map_err(|error| format!("{error}, or none"))?;
    let width = ranges::line_width(width).map_err(|error| error.to_string())?;
    Ok(WireframeArg::Width(width))
}

/// Parses how strongly hidden lines show, 0 to 1.
pub(super) fn hidden_lines(text: &str) -> Result<f32, String> {
    ranges::hidden_lines(number(text)?).map_err(|error| error.to_string())
}

/// Parses a line's width in pixels.
pub(super) fn line_width(text: &str) -> Result<f32, String> {
    ranges::line_width(number(text)?).map_err(|error| error.to_string())
}

/// Parses a blend factor, 0 to 1.
pub(super) fn blend(text: &str) -> Result<f32, String> {
    ranges::blend(number(text)?).map_err(|error| error.to_string())
}

/// Parses a crease angle in degrees.
pub(super) fn crease(text: &str) -> Result<f32, String> {
    ranges::crease(number(text)?).map_err(|error| error.to_string())
}

/// Parses a rectangle of an image, in pixels.
pub(super) fn crop(text: &str) -> Result<Crop, String> {
    let [x, y, width, height] = list(text, "four whole numbers as X,Y,WIDTH,HEIGHT")?;
    if width == 0 || height == 0 {
        return Err("a crop needs at least one pixel".to_owned());
    }
    Ok(Crop {
        x,
        y,
        width,
        height,
    })
}

/// Parses wrap modes: one for both axes, or two.
pub(super) fn wrap(text: &str) -> Result<[Wrap; 2], String> {
    let (u, v) = text.split_once(',').unwrap_or((text, text));
    Ok([u.parse()?, v.parse()?])
}

/// Parses a width and a height in scene units.
pub(super) fn extent(text: &str) -> Result<DVec2, String> {
    let extent = DVec2::from_array(list(text, "two numbers as WIDTH,HEIGHT")?);
    if extent.is_finite() && extent.min_element() > 0.0 {
        Ok(extent)
    } else {
        Err("expected a width and a height above 0".to_owned())
    }
}

/// Parses a colour rule.
pub(super) fn scene_color(text: &str) -> Result<SceneColor, String> {
    text.parse()
}

/// Parses the numbers at a colour scale's ends.
pub(super) fn color_range(text: &str) -> Result<[f64; 2], String> {
    ranges::color_range(list(text, "two numbers as LOW,HIGH")?).map_err(|error| error.to_string())
}

/// Parses a background.
pub(super) fn background(text: &str) -> Result<Background, String> {
    if text == "transparent" {
        return Ok(Background::Transparent);
    }
    let color = |text: &str| {
        text.parse::<Color>()
            .map_err(|_| "expected #top,#bottom, #rrggbb, #rgb or transparent".to_owned())
    };
    let (top, bottom) = text.split_once(',').unwrap_or((text, text));
    Ok(Background::Gradient(color(top)?, color(bottom)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_core::ranges::OutOfRange;

    #[test]
    fn a_crop_is_four_numbers_and_has_a_pixel() {
        assert_eq!(
            crop("1,2,3,4").map(|c| (c.x, c.y, c.width, c.height)),
            Ok((1, 2, 3, 4))
        );
        assert!(crop("1,2,0,4").is_err());
    }

    #[test]
    fn the_ground_and_lines_are_refused_in_the_words_of_their_ranges() {
        for (refused, expected) in [
            (ground("1e300").err(), OutOfRange::Ground(1e300).to_string()),
            (
                ground("x").err(),
                "expected lowest, or a height, or none".to_owned(),
            ),
            (
                wireframe("-1").err(),
                OutOfRange::LineWidth(-1.0).to_string(),
            ),
            (
                wireframe("x").err(),
                "expected a number, or none".to_owned(),
            ),
        ] {
            assert_eq!(refused, Some(expected));
        }
    }

    #[test]
    fn wraps_are_one_word_or_two() {
        assert_eq!(wrap("mirror"), Ok([Wrap::Mirror; 2]));
        let border = Wrap::Border(Some(Color([255, 0, 0])));
        assert_eq!(wrap("clamp,border:#f00"), Ok([Wrap::Clamp, border]));
        assert!(wrap("clamp,").is_err() && wrap("clamp,clamp,clamp").is_err());
        assert_eq!(extent("2,0.5"), Ok(DVec2::new(2.0, 0.5)));
        assert!(extent("2,0").is_err() && extent("inf,1").is_err() && extent("2").is_err());
    }

    #[test]
    fn color_rules() {
        assert_eq!(scene_color("file"), Ok(ColorRule::File));
        assert_eq!(
            scene_color("per-triangle"),
            Ok(ColorRule::PerTriangle { seed: 0 })
        );
        assert_eq!(
            scene_color("per-triangle:7"),
            Ok(ColorRule::PerTriangle { seed: 7 })
        );
        assert_eq!(
            scene_color("#0102ff"),
            Ok(ColorRule::Uniform(Color([1, 2, 255])))
        );
        assert_eq!(scene_color("#0af"), scene_color("#00aaff"));
        assert_eq!(color_range("-1,2.5"), Ok([-1.0, 2.5]));
        for bad in ["", "1", "2,1", "1,1", "0,inf", "a,b"] {
            assert!(color_range(bad).is_err(), "{bad}");
        }
        for bad in ["", "per-triangle:", "per-triangle:-1", "file:1", "#12345"] {
            assert!(scene_color(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn backgrounds() {
        let (black, white) = (Color([0; 3]), Color([255; 3]));
        assert_eq!(
            background("#000000,#ffffff"),
            Ok(Background::Gradient(black, white))
        );
        assert_eq!(
            background("#ffffff"),
            Ok(Background::Gradient(white, white))
        );
        assert_eq!(background("transparent"), Ok(Background::Transparent));
        assert!(background("#000000,").is_err());
    }
}
