//! Clipping planes of a command line.

use super::values::{list, number};
use crate::failure::Failure;
use clap::Args;
use raycast_core::glam::DVec3;
use raycast_core::scene::{ClippingPlane, ClippingPlanes};
use std::str::FromStr;

/// The clipping planes.
#[derive(Clone, Debug, Default, Args)]
pub struct ClipArgs {
    /// Clip the scene by a plane: `x:0.5` keeps x >= 0.5, `-x:0.5` keeps x <= 0.5 (y and z likewise); NX,NY,NZ,D keeps
    /// the points p with N·p >= D, in world coordinates. Up to 8, with an option for each; they replace the scene
    /// file's; `none` for none
    #[arg(
        long,
        value_name = "PLANE",
        allow_hyphen_values = true,
        help_heading = "Casting"
    )]
    pub clip: Vec<ClipArg>,
}

/// One `--clip`: a plane, or `None` for none at all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipArg(Option<ClippingPlane>);

impl ClipArgs {
    /// The planes of the options; without any, the scene file's.
    ///
    /// # Errors
    /// Too many planes, or none beside some.
    pub fn planes(&self, file: ClippingPlanes) -> Result<ClippingPlanes, Failure> {
        match self.clip[..] {
            [] => Ok(file),
            [ClipArg(None)] => Ok(ClippingPlanes::NONE),
            _ => {
                let planes: Option<Vec<_>> =
                    self.clip.iter().map(|ClipArg(plane)| *plane).collect();
                let planes = planes.ok_or_else(|| {
                    Failure::usage("--clip none stands alone: it is for no planes at all")
                })?;
                ClippingPlanes::new(&planes).map_err(|error| Failure::usage(error.to_string()))
            }
        }
    }
}

impl FromStr for ClipArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const EXPECTED: &str = "a plane as AXIS:OFFSET, NX,NY,NZ,D or none";
        if text == "none" {
            return Ok(Self(None));
        }
        let plane = match text.split_once(':') {
            Some((axis, offset)) => {
                let offset: f64 = number(offset)?;
                let normal = match axis.trim_start_matches(['+', '-']) {
                    "x" | "X" => DVec3::X,
                    "y" | "Y" => DVec3::Y,
                    "z" | "Z" => DVec3::Z,
                    _ => return Err(format!("expected {EXPECTED}")),
                };
                let plane = ClippingPlane::new(normal, offset);
                plane.map(|plane| match axis.starts_with('-') {
                    true => plane.flipped(),
                    false => plane,
                })
            }
            None => {
                let [x, y, z, offset] = list(text, EXPECTED)?;
                ClippingPlane::new(DVec3::new(x, y, z), offset)
            }
        };
        plane
            .map(|plane| Self(Some(plane)))
            .map_err(|error| error.to_string())
    }
}

/// The values of `--clip` that read back as the enabled ones of these planes.
pub(super) fn words(planes: &ClippingPlanes) -> Vec<String> {
    let plane = |&ClippingPlane { normal, offset, .. }: &ClippingPlane| {
        for (axis, name) in [(DVec3::X, 'x'), (DVec3::Y, 'y'), (DVec3::Z, 'z')] {
            if normal == axis {
                return format!("{name}:{offset}");
            }
            if normal == -axis {
                return format!("-{name}:{}", 0.0 - offset);
            }
        }
        format!("{},{},{},{offset}", normal.x, normal.y, normal.z)
    };
    planes.enabled().map(plane).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Option<ClippingPlane> {
        let ClipArg(plane) = text.parse().expect("a plane");
        plane
    }

    #[test]
    fn planes_read_back_as_they_were_written() {
        for (text, normal, offset) in [
            ("x:0.5", DVec3::X, 0.5),
            ("-x:0.5", DVec3::NEG_X, -0.5),
            ("-z:-1e-300", DVec3::NEG_Z, 1e-300),
            ("1,2,-0.25,7", DVec3::new(1.0, 2.0, -0.25), 7.0),
        ] {
            let plane = ClippingPlane::new(normal, offset).expect("a plane");
            assert_eq!(read(text), Some(plane), "{text}");
            let off = ClippingPlane {
                enabled: false,
                ..plane
            };
            let planes = ClippingPlanes::new(&[off, plane]).expect("two");
            let written = words(&planes);
            assert_eq!(written.len(), 1);
            assert_eq!(read(&written[0]), Some(plane), "{written:?}");
        }
        assert_eq!(read("+y:3"), read("0,1,0,3"));
        assert_eq!(read("none"), None);
        for bad in [
            "",
            "x",
            "x:",
            "w:1",
            "x:nan",
            "0,0,0,1",
            "1,2,3",
            "1,2,3,inf",
        ] {
            assert!(bad.parse::<ClipArg>().is_err(), "{bad}");
        }
    }

    #[test]
    fn options_go_before_the_files_planes() {
        let file = ClippingPlane::new(DVec3::Y, 1.0).expect("a plane");
        let file = ClippingPlanes::new(&[file]).expect("one");
        let parsed = |words: &[&str]| {
            let clip = words.iter().map(|word| word.parse().expect("a plane"));
            let args = ClipArgs {
                clip: clip.collect(),
            };
            args.planes(file)
        };
        assert_eq!(parsed(&[]), Ok(file));
        assert_eq!(parsed(&["none"]), Ok(ClippingPlanes::NONE));
        assert_eq!(
            parsed(&["x:1", "x:2"]).map(|planes| planes.all().len()),
            Ok(2)
        );
        assert!(parsed(&["x:1", "none"]).is_err());
        assert!(parsed(&["x:1"; 9]).is_err());
    }
}
