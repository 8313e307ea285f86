use crate::cli::{CameraArgs, StereoArg};
use crate::failure::Failure;
use raycast_core::camera::{
    Camera, ImagePlane, Orbit, Panorama, PlaneRequest, Pose, Projection, Stereo, StereoKind,
    fit_distance, frame_to_fov,
};
use raycast_core::formats::{CameraFile, ImageSettings};
use raycast_core::ranges;
use raycast_core::scene::Bounds;

/// The default size of pictures.
pub const DEFAULT_SIZE: (u32, u32) = (1280, 720);

/// The requested camera, with defaults from the scene file, else one that has all of `bounds` in view.
///
/// # Errors
/// A pose without view direction or up direction; size, step and field of view out of range or inconsistent.
pub fn camera(
    args: &CameraArgs,
    file: Option<&CameraFile>,
    image: ImageSettings,
    bounds: &Bounds,
) -> Result<Camera, Failure> {
    let request = CameraRequest::new(args, file, image)?;
    let (projection, stereo) = (request.projection, request.stereo);
    let default_size = request.default_size();
    let fov = request.fov()?;
    let (columns, rows) = args.size.unwrap_or(default_size);
    let (across, down) = request.pictures();
    let aspect = f64::from(columns * down) / f64::from(rows * across);
    let pose = pose(args, file, bounds, |orbit| {
        fit_distance(bounds, orbit, projection, fov, aspect)
    });
    pose.check()?;
    let plane = request.plane(default_size, fov, &pose)?;
    let distance = pose.eye.distance(pose.target);
    let stereo = stereo.map(|stereo| converging(stereo, projection, distance));
    check_stereo(stereo.as_ref(), projection, Some(plane))?;
    let camera = Camera::new(pose, projection, plane);
    Ok(camera.shifted(request.shift).in_stereo(stereo))
}

/// Checks of the requested camera what does not depend on what there is to see. Returns the picture's size, unless that
/// does.
///
/// # Errors
/// As [`camera`].
pub fn check_camera(
    args: &CameraArgs,
    file: Option<&CameraFile>,
    image: ImageSettings,
) -> Result<Option<(u32, u32)>, Failure> {
    let request = CameraRequest::new(args, file, image)?;
    request.fov()?;
    Ok(match args.step {
        Some(_) => args.size,
        None => Some(args.size.unwrap_or(request.default_size())),
    })
}

/// What a camera is made from: options before the scene file's settings before defaults.
struct CameraRequest<'a> {
    args: &'a CameraArgs,
    file: Option<&'a CameraFile>,
    image: ImageSettings,
    projection: Projection,
    shift: [f64; 2],
    stereo: Option<Stereo>,
}

impl<'a> CameraRequest<'a> {
    fn new(
        args: &'a CameraArgs,
        file: Option<&'a CameraFile>,
        image: ImageSettings,
    ) -> Result<Self, Failure> {
        let projection = projection(args, file)?;
        let shift = shift(args, image, projection)?;
        let stereo = stereo(args, image.stereo)?;
        check_stereo(stereo.as_ref(), projection, None)?;
        Ok(Self {
            args,
            file,
            image,
            projection,
            shift,
            stereo,
        })
    }

    /// The numbers of pictures side by side and one above the other.
    fn pictures(&self) -> (u32, u32) {
        self.stereo.map_or((1, 1), |stereo| stereo.pictures())
    }

    /// The scene file's camera if it is of the same type: in another one a field of view and a shape have another
    /// meaning.
    fn alike(&self) -> Option<&'a CameraFile> {
        let kind = panorama(self.projection);
        self.file.filter(|file| panorama(file.projection) == kind)
    }

    /// The size of the whole picture where no option gives it.
    fn default_size(&self) -> (u32, u32) {
        let file_size = self.image.size;
        let alike = self.alike();
        let rows = file_size.map_or(DEFAULT_SIZE.1, |(_, rows)| rows);
        let size = match (panorama(self.projection), alike) {
            (Some(panorama), None) => panorama.size(rows),
            _ => file_size.unwrap_or(DEFAULT_SIZE),
        };
        let kind = |stereo: Option<Stereo>| stereo.map(|stereo| stereo.kind);
        let is_the_files_kind = kind(self.image.stereo) == kind(self.stereo);
        if alike.is_some() && is_the_files_kind && file_size.is_some() {
            return size;
        }
        let (across, down) = self.pictures();
        (size.0 * across, size.1 * down)
    }

    /// The vertical field of view, in degrees.
    fn fov(&self) -> Result<f64, Failure> {
        // The file's own was checked when it was read.
        if let Some(fov) = self.args.fov
            && let Err(error) = self.projection.check_fov(fov)
        {
            return Err(Failure::usage(format!("--fov {fov}: {error}")));
        }
        let fov = self.args.fov.or(self.alike().map(fov_of));
        Ok(fov.unwrap_or(self.projection.default_fov()))
    }

    /// The image plane of a camera at `pose`.
    fn plane(
        &self,
        default_size: (u32, u32),
        fov: f64,
        pose: &Pose,
    ) -> Result<ImagePlane, Failure> {
        let (args, projection) = (self.args, self.projection);
        let distance = pose.eye.distance(pose.target);
        let (_, down) = self.pictures();
        let frame_of = |fov| projection.frame(fov, distance) * f64::from(down);
        let frame = self.frame_of_file(pose).unwrap_or_else(|| frame_of(fov));
        let request = match self.step_of_file(pose) {
            Some(step) => PlaneRequest {
                size: self.image.size,
                step: Some(step),
                // A panorama may have more rows than its field of view.
                frame_height: projection.panorama().is_none().then_some(frame),
            },
            None => PlaneRequest {
                size: args.size,
                step: args.step,
                frame_height: args.fov.map(frame_of),
            },
        };
        let plane = request.resolve(default_size, frame)?;
        if let (Some(step), Projection::Perspective) = (args.step, projection) {
            let fov = frame_to_fov(f64::from(plane.rows) * step, distance);
            if let Err(error) = ranges::fov(fov) {
                return Err(Failure::usage(format!("a step of {step:?}: {error}")));
            }
        }
        Ok(plane)
    }

    /// An orthographic scene file's frame, if it is still valid: conversion to an angle and back would round it.
    fn frame_of_file(&self, pose: &Pose) -> Option<f64> {
        let is_valid = |file: &&CameraFile| {
            file.projection == Projection::Orthographic
                && self.projection == Projection::Orthographic
                && *pose == file.pose
                && self.args.fov.is_none()
        };
        self.file.filter(is_valid).map(|file| file.frame)
    }

    /// A scene file's step, if size and view are the file's.
    fn step_of_file(&self, pose: &Pose) -> Option<f64> {
        let args = self.args;
        let is_the_view =
            |file: &CameraFile| (file.pose, file.projection) == (*pose, self.projection);
        let is_the_size = |size| size == args.size.unwrap_or(size);
        let is_valid = args.step.is_none()
            && args.fov.is_none()
            && self.file.is_some_and(is_the_view)
            && self.image.size.is_some_and(is_the_size);
        self.image.step.filter(|_| is_valid)
    }
}

/// A projection's panorama; `None` for planes, also those behind a lens.
fn panorama(projection: Projection) -> Option<Panorama> {
    projection
        .panorama()
        .filter(|_| projection.lens().is_none())
}

/// The requested projection, through the requested lens.
fn projection(args: &CameraArgs, file: Option<&CameraFile>) -> Result<Projection, Failure> {
    let projection = args
        .projection
        .or(file.map(|file| file.projection))
        .unwrap_or_default();
    match args.lens {
        None => Ok(projection),
        Some(lens) if projection.name() == Projection::Perspective.name() => {
            Ok(Projection::through(lens))
        }
        Some(_) => Err(Failure::usage(format!(
            "--lens is for --projection perspective, not {projection}"
        ))),
    }
}

/// The requested shift of the frame.
fn shift(
    args: &CameraArgs,
    image: ImageSettings,
    projection: Projection,
) -> Result<[f64; 2], Failure> {
    let shift = args.shift.or(image.shift).unwrap_or_default();
    if shift != [0.0; 2] && panorama(projection).is_some() {
        return Err(Failure::usage(format!(
            "--shift is for perspective and orthographic pictures, not {projection}"
        )));
    }
    Ok(shift)
}

fn check_stereo(
    stereo: Option<&Stereo>,
    projection: Projection,
    plane: Option<ImagePlane>,
) -> Result<(), Failure> {
    let Some(stereo) = stereo else { return Ok(()) };
    let checked = stereo.check(projection, plane);
    checked.map_err(|error| Failure::usage(error.to_string()))
}

/// A pair of planar pictures converges at the target if nothing else is requested, other pairs at infinity.
fn converging(mut stereo: Stereo, projection: Projection, distance: f64) -> Stereo {
    if stereo.kind == StereoKind::Pair {
        let is_planar = panorama(projection).is_none();
        let usual = if is_planar { distance } else { f64::INFINITY };
        stereo.convergence.get_or_insert(usual);
    }
    stereo
}

/// The layout for two eyes, if requested.
fn stereo(args: &CameraArgs, file: Option<Stereo>) -> Result<Option<Stereo>, Failure> {
    let kind = match args.stereo {
        Some(StereoArg(kind)) => kind,
        None => file.map(|file| file.kind),
    };
    let Some(kind) = kind else {
        return match args.eye_distance.or(args.convergence) {
            Some(_) => Err(Failure::usage(
                "--eye-distance and --convergence are for pictures with --stereo",
            )),
            None => Ok(None),
        };
    };
    let Some(eye_distance) = args.eye_distance.or(file.map(|file| file.eye_distance)) else {
        return Err(Failure::usage(
            "--stereo needs --eye-distance, how far the eyes are apart in scene units",
        ));
    };
    let of_file = file.filter(|file| file.kind == kind);
    Ok(Some(Stereo {
        kind,
        eye_distance,
        convergence: (args.convergence).or(of_file.and_then(|file| file.convergence)),
    }))
}

/// The failure to make a camera: bad usage if any option concerned it, else a fault of the files.
pub fn camera_failure(args: &CameraArgs, name: &str, failure: Failure) -> Failure {
    let was_asked = args.size.is_some()
        || args.step.is_some()
        || args.fov.is_some()
        || args.eye.is_some()
        || args.target.is_some()
        || args.up.is_some()
        || args.orbit.is_some()
        || args.shift.is_some()
        || args.lens.is_some()
        || args.stereo.is_some()
        || args.eye_distance.is_some()
        || args.convergence.is_some();
    if was_asked {
        failure
    } else {
        Failure::could_not(format!("{name}: its camera cannot be used: {failure}"))
    }
}

/// A scene file's vertical field of view, or that of its orthographic frame as seen from its eye.
fn fov_of(file: &CameraFile) -> f64 {
    match file.projection {
        Projection::Perspective | Projection::Panoramic(_) => file.frame,
        Projection::Orthographic => {
            let distance = file.pose.eye.distance(file.pose.target);
            frame_to_fov(file.frame, distance)
        }
    }
}

/// The camera's pose; `fit` gives the distance from the pivot at which an orbit has everything in view.
fn pose(
    args: &CameraArgs,
    file: Option<&CameraFile>,
    bounds: &Bounds,
    fit: impl Fn(&Orbit) -> f64,
) -> Pose {
    let orbit = |yaw: f64, pitch: f64, distance: Option<f64>| {
        let mut orbit = Orbit {
            pivot: args.target.unwrap_or(bounds.center()),
            yaw,
            pitch,
            distance: 1.0,
        };
        orbit.distance = distance.unwrap_or_else(|| fit(&orbit));
        let pose = orbit.pose();
        Pose {
            up: args.up.unwrap_or(pose.up),
            ..pose
        }
    };
    let file = file.map(|file| file.pose);
    if let Some(orbit_arg) = args.orbit {
        orbit(orbit_arg.yaw, orbit_arg.pitch, orbit_arg.distance)
    } else if let Some(eye) = args.eye.or(file.map(|file| file.eye)) {
        let target = args
            .target
            .or(file.map(|file| file.target))
            .unwrap_or(bounds.center());
        let towards = Pose::towards(eye, target);
        Pose {
            up: args.up.or(file.map(|file| file.up)).unwrap_or(towards.up),
            ..towards
        }
    } else {
        let (yaw, pitch) = Orbit::DEFAULT_ANGLES;
        orbit(yaw, pitch, None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::OrbitArg;
    use raycast_core::glam::DVec3;

    const UNIT: Bounds = Bounds {
        min: DVec3::new(0.0, 1.0, 2.0),
        max: DVec3::new(1.0, 2.0, 3.0),
    };

    fn made(args: &CameraArgs) -> Camera {
        camera(args, None, ImageSettings::default(), &UNIT).expect("a camera")
    }

    #[test]
    fn the_whole_scene_is_in_view_by_default() {
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let camera = made(&CameraArgs {
                projection: Some(projection),
                ..CameraArgs::default()
            });
            assert_eq!((camera.plane().columns, camera.plane().rows), DEFAULT_SIZE);
            assert_eq!(camera.pose().target, UNIT.center());
            for corner in UNIT.corners() {
                let (x, y) = camera.project(corner).expect("in front");
                assert!((0.0..=1280.0).contains(&x) && (0.0..=720.0).contains(&y));
            }
        }
    }

    #[test]
    fn two_of_three() {
        let eye = Some(UNIT.center() + DVec3::new(0.0, 0.0, 10.0));
        let base = CameraArgs {
            eye,
            ..CameraArgs::default()
        };
        let by_size_and_step = made(&CameraArgs {
            size: Some((100, 50)),
            step: Some(0.1),
            ..base.clone()
        });
        let fov = by_size_and_step.fov_degrees().expect("perspective");
        assert!((fov - 2.0 * raycast_core::math::atan(0.25).to_degrees()).abs() < 1e-9);

        let by_step_and_fov = made(&CameraArgs {
            step: Some(0.1),
            fov: Some(fov),
            ..base.clone()
        });
        assert_eq!(by_step_and_fov.plane().rows, 50);

        let at_odds = CameraArgs {
            size: Some((100, 50)),
            step: Some(0.1),
            fov: Some(90.0),
            ..base.clone()
        };
        let refused = camera(&at_odds, None, ImageSettings::default(), &UNIT);
        assert!(refused.is_err_and(|failure| failure.to_string().contains("at odds")));
        let agreed = CameraArgs {
            fov: Some(fov),
            ..at_odds
        };
        assert!(camera(&agreed, None, ImageSettings::default(), &UNIT).is_ok());
    }

    #[test]
    fn an_eye_looks_at_the_centre_unless_told_otherwise() {
        let eye = DVec3::new(5.0, -3.0, 2.0);
        let args = CameraArgs {
            eye: Some(eye),
            ..CameraArgs::default()
        };
        let pose = made(&args).pose();
        assert_eq!((pose.eye, pose.target), (eye, UNIT.center()));
        let args = CameraArgs {
            target: Some(DVec3::X),
            up: Some(DVec3::Z),
            ..args
        };
        let pose = made(&args).pose();
        assert_eq!((pose.target, pose.up), (DVec3::X, DVec3::Z));
    }

    #[test]
    fn a_camera_that_looks_nowhere_is_refused() {
        let center = UNIT.center();
        let above = CameraArgs {
            eye: Some(center + DVec3::Y * 3.0),
            ..CameraArgs::default()
        };
        // Up is not given, so it yields.
        assert_eq!(made(&above).pose().up, DVec3::NEG_Z);
        let with_up = |up: DVec3| CameraArgs {
            up: Some(up),
            ..above.clone()
        };
        let in_target = CameraArgs {
            eye: Some(center),
            ..above.clone()
        };
        for (args, why) in [
            (with_up(DVec3::ZERO), "expected a direction"),
            (with_up(DVec3::NEG_Y), "lies along the view"),
            (in_target, "expected a target away from the eye"),
        ] {
            let failure = camera(&args, None, ImageSettings::default(), &UNIT).expect_err(why);
            assert!(failure.to_string().contains(why), "{failure}");
            assert!(matches!(failure, Failure::Usage(_)));
        }
    }

    #[test]
    fn an_orbit_is_about_the_centre() {
        let args = CameraArgs {
            orbit: Some(OrbitArg {
                yaw: 90.0,
                pitch: 0.0,
                distance: Some(4.0),
            }),
            ..CameraArgs::default()
        };
        let eye = made(&args).pose().eye;
        assert!(
            eye.distance(UNIT.center() + DVec3::X * 4.0) < 1e-12,
            "{eye}"
        );
    }

    #[test]
    fn a_scene_file_gives_defaults_and_options_override_them() {
        let file = CameraFile {
            pose: Pose {
                eye: DVec3::new(0.0, 0.0, 8.0),
                target: DVec3::ZERO,
                up: DVec3::X,
            },
            projection: Projection::Orthographic,
            frame: 3.0,
        };
        let image = ImageSettings {
            size: Some((30, 60)),
            ..ImageSettings::default()
        };
        let made = |args: &CameraArgs| camera(args, Some(&file), image, &UNIT).expect("a camera");
        let as_it_is = made(&CameraArgs::default());
        assert_eq!(as_it_is.pose(), file.pose);
        assert_eq!(as_it_is.plane().frame_height(), 3.0);
        assert_eq!((as_it_is.plane().columns, as_it_is.plane().rows), (30, 60));

        let perspective = made(&CameraArgs {
            projection: Some(Projection::Perspective),
            size: Some((10, 10)),
            ..CameraArgs::default()
        });
        assert!((perspective.plane().frame_height() - 3.0).abs() < 1e-12);
        assert_eq!(perspective.plane().rows, 10);

        let elsewhere = made(&CameraArgs {
            eye: Some(DVec3::new(0.0, 0.0, 4.0)),
            ..CameraArgs::default()
        });
        assert_eq!(elsewhere.pose().target, DVec3::ZERO);
        assert!((elsewhere.plane().frame_height() - 1.5).abs() < 1e-12);
    }

    #[test]
    fn a_scene_files_step_holds_for_its_own_size_and_view() {
        let step = 0.1 / 3.0;
        let file = |size: (u32, u32)| CameraFile {
            pose: Pose {
                eye: DVec3::new(0.0, 0.0, 8.0),
                target: DVec3::ZERO,
                up: DVec3::Y,
            },
            projection: Projection::Perspective,
            frame: frame_to_fov(f64::from(size.1) * step, 8.0),
        };
        let image = ImageSettings {
            size: Some((37, 29)),
            step: Some(step),
            ..ImageSettings::default()
        };
        let file = file((37, 29));
        let made = |args: &CameraArgs| camera(args, Some(&file), image, &UNIT);
        let as_it_is = made(&CameraArgs::default()).expect("a camera");
        assert_eq!(as_it_is.plane().step, step);
        let larger = made(&CameraArgs {
            size: Some((74, 58)),
            ..CameraArgs::default()
        });
        let larger = larger.expect("a camera").plane();
        assert!((larger.step - step / 2.0).abs() < 1e-12);
        // A step that the field of view cannot have is an error, wherever it is given.
        let odd = ImageSettings {
            step: Some(1.0),
            ..image
        };
        let refused = camera(&CameraArgs::default(), Some(&file), odd, &UNIT);
        assert!(refused.is_err_and(|failure| failure.to_string().contains("at odds")));
    }
}
