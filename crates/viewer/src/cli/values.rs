//! Parsers for the values of options. Their errors say in words what was expected.

use clap::builder::{PossibleValuesParser, RangedI64ValueParser, TypedValueParser};
use raycast_core::Cull;
use raycast_core::camera::{
    BrownConrady, ImagePlane, LensError, Panorama, PixelFilter, Placement, Projection, StereoKind,
    check_step,
};
use raycast_core::glam::{DVec2, DVec3};
use raycast_core::ranges;
use raycast_core::render::Precision;
use raycast_core::scene::{Color, ColorMap, ColorRule, Crop, TextureProjection, UpAxis, Wrap};
use raycast_core::shade::{Background, Filter, Ground, GroundError, LightSet, Mode};
use std::str::FromStr;

/// `--orbit`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrbitArg {
    /// Degrees about +Y.
    pub yaw: f64,
    /// Degrees above the horizon.
    pub pitch: f64,
    /// The distance from the centre to the eye in scene units; `None` for the one at which the whole scene is in view.
    pub distance: Option<f64>,
}

/// `--color`: the rule for every object.
pub type SceneColor = ColorRule;

/// Names and their values, in the order in which help lists them.
pub(super) type Names<T> = &'static [(&'static str, T)];

pub(super) const PROJECTIONS: Names<Projection> = &[
    ("perspective", Projection::Perspective),
    ("orthographic", Projection::Orthographic),
    (
        "equirectangular",
        Projection::Panoramic(Panorama::Equirectangular),
    ),
    ("cylindrical", Projection::Panoramic(Panorama::Cylindrical)),
    ("fisheye", Projection::Panoramic(Panorama::Equidistant)),
    (
        "fisheye:equisolid",
        Projection::Panoramic(Panorama::Equisolid),
    ),
    (
        "fisheye:stereographic",
        Projection::Panoramic(Panorama::Stereographic),
    ),
    ("cubemap", Projection::Panoramic(Panorama::CubeStrip)),
    ("cubemap:cross", Projection::Panoramic(Panorama::CubeCross)),
];

/// `--stereo`; `None` is a picture for one eye, whatever the scene file says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StereoArg(pub Option<StereoKind>);

pub(super) const STEREO: Names<StereoArg> = &[
    ("none", StereoArg(None)),
    ("pair", StereoArg(Some(StereoKind::Pair))),
    ("ods", StereoArg(Some(StereoKind::Ods))),
];

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

pub(super) const PIXEL_FILTERS: Names<PixelFilter> = &PixelFilter::ALL;

pub(super) const COLOR_MAPS: Names<ColorMap> = &[
    ("viridis", ColorMap::Viridis),
    ("magma", ColorMap::Magma),
    ("turbo", ColorMap::Turbo),
    ("cividis", ColorMap::Cividis),
    ("diverging", ColorMap::Diverging),
];

pub(super) const PRECISIONS: Names<Precision> =
    &[("fast", Precision::Fast), ("exact", Precision::Exact)];

pub(super) const UP_AXES: Names<UpAxis> = &[("y", UpAxis::Y), ("z", UpAxis::Z)];

pub(super) const CULLS: Names<Cull> = &[("none", Cull::None), ("back", Cull::Back)];

/// Parses one of `names`.
pub(super) fn named<T: Copy + Send + Sync + 'static>(
    names: Names<T>,
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(names.iter().map(|(name, _)| *name)).map(move |given| {
        names
            .iter()
            .find(|(name, _)| *name == given)
            .map(|(_, value)| *value)
            .expect("clap lets only listed names through")
    })
}

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

/// Parses a count of workers.
pub(super) fn threads() -> RangedI64ValueParser<u16> {
    clap::value_parser!(u16).range(0..=256)
}

/// Parses a picture's size.
pub(super) fn size(text: &str) -> Result<(u32, u32), String> {
    let (columns, rows) = by(text, "a size as WIDTHxHEIGHT")?;
    ImagePlane::new(columns, rows, 1.0).map_err(|error| error.to_string())?;
    Ok((columns, rows))
}

/// Parses a shift of the frame off the view axis, in heights of the frame.
pub(super) fn shift(text: &str) -> Result<[f64; 2], String> {
    let parts = text.split(',').map(|part| number(part.trim()));
    let parts = parts.collect::<Result<Vec<f64>, _>>()?;
    let shift = parts
        .try_into()
        .map_err(|_| "expected two numbers, X,Y".to_owned())?;
    ranges::shift(shift).map_err(|error| error.to_string())
}

/// Parses a lens's coefficients.
pub(super) fn lens(text: &str) -> Result<BrownConrady, String> {
    text.parse().map_err(|error: LensError| error.to_string())
}

/// Parses the distance between the eyes of a stereo picture.
pub(super) fn eye_distance(text: &str) -> Result<f64, String> {
    ranges::eye_distance(number(text)?).map_err(|error| error.to_string())
}

/// Parses the distance at which the views of a stereo pair coincide.
pub(super) fn convergence(text: &str) -> Result<f64, String> {
    ranges::convergence(number(text)?).map_err(|error| error.to_string())
}

/// Parses a grid's counts of columns and rows, at least 1.
pub(super) fn counts(text: &str) -> Result<(u32, u32), String> {
    match by(text, "a grid as COLUMNSxROWS")? {
        (0, _) | (_, 0) => Err("a grid needs at least one column and one row".to_owned()),
        counts => Ok(counts),
    }
}

/// Parses a column and row of a grid, from 0.
pub(super) fn cell(text: &str) -> Result<(u32, u32), String> {
    let [column, row] = list(text, "a sub-camera as COLUMN,ROW")?;
    Ok((column, row))
}

/// Parses a point or a direction.
pub(super) fn point(text: &str) -> Result<DVec3, String> {
    let point = DVec3::from_array(list(text, "three numbers as X,Y,Z")?);
    if point.is_finite() {
        Ok(point)
    } else {
        Err("expected three finite numbers".to_owned())
    }
}

/// Parses a camera's eye, target and optional up direction.
pub(super) fn placement(text: &str) -> Result<Placement, String> {
    let points: Vec<_> = text.split('/').collect();
    let placement = match points[..] {
        [eye, target] => Placement::towards(point(eye)?, point(target)?),
        [eye, target, up] => Placement {
            eye: point(eye)?,
            target: point(target)?,
            up: point(up)?,
        },
        _ => return Err("expected points as EYE/TARGET[/UP]".to_owned()),
    };
    placement.check().map_err(|error| error.to_string())?;
    Ok(placement)
}

/// Parses the distance between rays.
pub(super) fn step(text: &str) -> Result<f64, String> {
    let step = number(text)?;
    check_step(step).map_err(|error| error.to_string())?;
    Ok(step)
}

/// Parses a field of view in degrees that some projection can have: at most 360.
pub(super) fn fov(text: &str) -> Result<f64, String> {
    let degrees = number(text)?;
    if (ranges::FOV_END..=360.0).contains(&degrees) {
        return Ok(degrees);
    }
    planar_fov(text)
}

/// Parses a planar picture's field of view in degrees.
pub(super) fn planar_fov(text: &str) -> Result<f64, String> {
    ranges::fov(number(text)?).map_err(|error| error.to_string())
}

/// Parses a count of samples.
pub(super) fn samples(text: &str) -> Result<u32, String> {
    ranges::samples(number(text)?).map_err(|error| error.to_string())
}

/// Parses a number of any size.
pub(super) fn number<T: FromStr>(text: &str) -> Result<T, String> {
    text.parse().map_err(|_| "expected a number".to_owned())
}

/// Parses yaw, pitch and an optional distance.
pub(super) fn orbit(text: &str) -> Result<OrbitArg, String> {
    const EXPECTED: &str = "YAW,PITCH or YAW,PITCH,DISTANCE";
    let (yaw, pitch, distance) = match text.split(',').count() {
        3 => {
            let [yaw, pitch, distance] = list::<f64, 3>(text, EXPECTED)?;
            (yaw, pitch, Some(distance))
        }
        _ => {
            let [yaw, pitch] = list(text, EXPECTED)?;
            (yaw, pitch, None)
        }
    };
    if !yaw.is_finite() || !(-90.0..=90.0).contains(&pitch) {
        return Err("expected a finite yaw and a pitch of -90 to 90 degrees".to_owned());
    }
    if distance.is_some_and(|distance: f64| !(distance.is_finite() && distance > 0.0)) {
        return Err("expected a positive distance".to_owned());
    }
    Ok(OrbitArg {
        yaw,
        pitch,
        distance,
    })
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

/// Parses two whole numbers separated by `x`.
fn by(text: &str, expected: &str) -> Result<(u32, u32), String> {
    text.split_once(['x', 'X'])
        .and_then(|(left, right)| Some((left.parse().ok()?, right.parse().ok()?)))
        .ok_or_else(|| format!("expected {expected}"))
}

/// Parses `N` values separated by commas.
pub(super) fn list<T: FromStr, const N: usize>(
    text: &str,
    expected: &str,
) -> Result<[T; N], String> {
    text.split(',')
        .map(|part| part.trim().parse().ok())
        .collect::<Option<Vec<T>>>()
        .and_then(|values| values.try_into().ok())
        .ok_or_else(|| format!("expected {expected}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_core::ranges::OutOfRange;

    #[test]
    fn sizes_have_limits() {
        assert_eq!(size("1280x720"), Ok((1280, 720)));
        assert_eq!(size("65536x65536"), Ok((65_536, 65_536)));
        for bad in ["0x5", "5x0", "-1x5", "65537x1", "5", "x", "1x2x3", "1.5x2"] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn lenses_eyes_and_the_ground_are_refused_in_the_words_of_their_ranges() {
        let lens = |k1: f64| OutOfRange::Lens {
            found: [k1, 0.0, 0.0, 0.0, 0.0],
        };
        for (refused, expected) in [
            (super::lens("1e308,0,0,0,0").err(), lens(1e308).to_string()),
            (super::lens("1,2").err(), LensError::Count.to_string()),
            (
                eye_distance("-1").err(),
                OutOfRange::EyeDistance(-1.0).to_string(),
            ),
            (
                convergence("0").err(),
                OutOfRange::Convergence(0.0).to_string(),
            ),
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
        assert!(super::lens("-10,0,0,0,0").is_ok() && convergence("inf").is_ok());
    }

    #[test]
    fn lists_have_their_length() {
        assert_eq!(point("1,-2, 3e2"), Ok(DVec3::new(1.0, -2.0, 300.0)));
        assert!(point("1,2,3,4").is_err() && point("1,2").is_err() && point("1,2,x").is_err());
        assert!(point("1,2,NaN").is_err());
        assert_eq!(cell("2,0"), Ok((2, 0)));
        assert!(cell("-1,0").is_err());
        assert_eq!(
            crop("1,2,3,4").map(|c| (c.x, c.y, c.width, c.height)),
            Ok((1, 2, 3, 4))
        );
        assert!(crop("1,2,0,4").is_err());
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

    #[test]
    fn orbits() {
        let with_distance = OrbitArg {
            yaw: -400.0,
            pitch: 90.0,
            distance: Some(2.0),
        };
        assert_eq!(orbit("-400,90,2"), Ok(with_distance));
        for bad in ["1", "1,2,3,4", "0,90.1", "0,0,-1", "inf,0", "0,nan"] {
            assert!(orbit(bad).is_err(), "{bad}");
        }
    }
}
