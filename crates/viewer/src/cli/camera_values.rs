//! Values of the options of a camera.

use super::values::{Names, list, number, point};
use raycast_core::camera::{
    BrownConrady, LensError, Panorama, Pose, Projection, StereoKind, check_step,
};
use raycast_core::ranges;

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

/// Parses a camera's eye, target and optional up direction.
pub(super) fn pose(text: &str) -> Result<Pose, String> {
    let points: Vec<_> = text.split('/').collect();
    let pose = match points[..] {
        [eye, target] => Pose::towards(point(eye)?, point(target)?),
        [eye, target, up] => Pose {
            eye: point(eye)?,
            target: point(target)?,
            up: point(up)?,
        },
        _ => return Err("expected points as EYE/TARGET[/UP]".to_owned()),
    };
    pose.check().map_err(|error| error.to_string())?;
    Ok(pose)
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

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_core::ranges::OutOfRange;

    #[test]
    fn lenses_and_eyes_are_refused_in_the_words_of_their_ranges() {
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
        ] {
            assert_eq!(refused, Some(expected));
        }
        assert!(super::lens("-10,0,0,0,0").is_ok() && convergence("inf").is_ok());
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
