//! From files and options to what a command works on: scene, camera, shading.

mod nothing_to_see;

pub use nothing_to_see::NothingToSee;

use crate::cli::{CameraArgs, ReadingArgs, ShadingArgs, TextureProjectionArgs, WireframeArg};
use crate::failure::Failure;
use crate::memory;
use raycast_core::camera::{
    Camera, Orbit, Placement, PlaneRequest, Projection, fit_distance, frame_to_fov,
};
use raycast_core::formats::{self, CameraFile, FormatError, Progress, SceneFile};
use raycast_core::scene::{Bounds, ColorRule, ColorScale, Dropped, Projector, Quantity, Scene};
use raycast_core::shade::{Shading, Wireframe};
use raycast_core::{Accel, Simd, ranges};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

/// The picture's size where nobody says another.
pub const DEFAULT_SIZE: (u32, u32) = (1280, 720);

/// Reads files into one scene, their objects in the order of the files, with the camera, image and
/// shading of the first scene file that has them.
///
/// # Errors
/// The first file that cannot be read.
pub fn load(
    files: &[PathBuf],
    reading: &ReadingArgs,
    progress: Progress<'_>,
) -> Result<SceneFile, FormatError> {
    let budget = memory::budget(reading.limits());
    let mut all = SceneFile::default();
    for (index, file) in files.iter().enumerate() {
        let share = |share: f32| progress((index as f32 + share) / files.len() as f32);
        all.append(formats::read_scene_within(file, &budget, &share)?);
    }
    Ok(all)
}

/// The environment variable that forces an instruction set on the casting of tiles.
pub const SIMD_VARIABLE: &str = "RAYCAST_SIMD";

/// The instruction set that [`SIMD_VARIABLE`] names, else the machine's widest.
///
/// # Errors
/// A variable that names no instruction set that this machine has.
pub fn instruction_set() -> Result<Simd, Failure> {
    let Some(name) = std::env::var_os(SIMD_VARIABLE) else {
        return Ok(Simd::best());
    };
    let name = name.to_string_lossy();
    let simd: Simd = name
        .parse()
        .map_err(|expected| Failure::usage(format!("{SIMD_VARIABLE}: {expected}")))?;
    if simd > Simd::best() {
        return Err(Failure::usage(format!(
            "{SIMD_VARIABLE}: this machine has no {name}; its widest is {}",
            Simd::best().name()
        )));
    }
    Ok(simd)
}

/// How many times as many triangles a scene must show as are stored with instances for a command to have those.
/// Fewer save little memory; with more, scenes of some repetition take memory and time to build for all that they
/// show. Casting takes longer with instances, the more so where objects overlap: many frames make up for the build.
const INSTANCES_SAVE: usize = 4;

/// Whether objects share meshes to such a degree that a tree for each mesh is worth its while.
pub fn has_instances(scene: &Scene) -> bool {
    Accel::stored_triangles(scene).saturating_mul(INSTANCES_SAVE) <= scene.triangle_count()
        && scene.triangle_count() > 0
}

/// How many triangles the tree stores that [`tree`] builds over a scene, to hold against the memory that there is.
pub fn stored_triangles(scene: &Scene) -> usize {
    match has_instances(scene) {
        true => Accel::stored_triangles(scene),
        false => scene.triangle_count(),
    }
}

/// The tree over a scene, for the instruction set of [`instruction_set`]: one over all triangles, or one for each mesh
/// where that stores a quarter of them at most. Both answer every ray alike.
///
/// # Errors
/// As [`Accel::build`], as [`instruction_set`].
pub fn tree(scene: &Scene) -> Result<Accel, Failure> {
    let simd = instruction_set()?;
    let accel = match has_instances(scene) {
        true => Accel::build_instances(scene)?,
        false => Accel::build(scene)?,
    };
    Ok(accel.with_simd(simd))
}

/// One tree over all triangles of a scene: for what looks at them one by one.
///
/// # Errors
/// As [`tree`].
pub fn single_tree(scene: &Scene) -> Result<Accel, Failure> {
    let simd = instruction_set()?;
    Ok(Accel::build(scene)?.with_simd(simd))
}

/// The tree over a scene whose objects may come to be moved and hidden: of more than one object, a tree for each
/// mesh.
///
/// # Errors
/// As [`tree`].
pub fn tree_to_edit(scene: &Scene) -> Result<Accel, Failure> {
    let simd = instruction_set()?;
    Ok(match &scene.objects[..] {
        [] | [_] => Accel::build(scene)?,
        _ => Accel::build_instances(scene)?,
    }
    .with_simd(simd))
}

/// The tree over a scene of which something can be seen; `name` is what an error calls it.
///
/// # Errors
/// As [`tree`]; [`NothingToSee`] where no triangle is left.
pub fn visible_tree(name: &str, scene: &Scene) -> Result<Accel, Failure> {
    visible(name, scene, tree(scene)?)
}

/// A tree of which something can be seen.
///
/// # Errors
/// [`NothingToSee`] where no triangle is left.
pub fn visible(name: &str, scene: &Scene, accel: Accel) -> Result<Accel, Failure> {
    if accel.is_empty() {
        return Err(NothingToSee {
            name: name.to_owned(),
            triangles: scene.triangle_count(),
            dropped: dropped(scene, &accel),
        }
        .into());
    }
    Ok(accel)
}

/// The box around what can be seen: a triangle that its transform moved out of range is not.
pub fn bounds(scene: &Scene, accel: &Accel) -> Bounds {
    match accel.out_of_range() {
        0 => scene.bounds(),
        _ => accel.bounds(),
    }
}

/// What a scene of these files is called in an error.
pub fn name_of(files: &[PathBuf]) -> String {
    match files {
        [] => "the scene".to_owned(),
        [file] => file.display().to_string(),
        [first, rest @ ..] => format!("{} and {} more", first.display(), rest.len()),
    }
}

/// Gives every object the texture and the colours that were asked for.
///
/// # Errors
/// A texture that cannot be read, a crop that leaves it.
pub fn paint(scene: &mut Scene, args: &ShadingArgs, reading: &ReadingArgs) -> Result<(), Failure> {
    if let Some(path) = &args.texture {
        let mut texture = formats::read_texture_within(path, &memory::budget(reading.limits()))?;
        if let Some(crop) = args.crop {
            texture = texture.cropped(crop).ok_or_else(|| {
                Failure::usage(format!(
                    "the crop {},{},{},{} leaves {}, which is {}x{}",
                    crop.x,
                    crop.y,
                    crop.width,
                    crop.height,
                    path.display(),
                    texture.width(),
                    texture.height()
                ))
            })?;
        }
        if let Some(wrap) = args.wrap {
            texture = texture.wrapped(wrap);
        }
        let texture = Arc::new(texture);
        for object in &mut scene.objects {
            object.texture = Some(Arc::clone(&texture));
        }
    }
    if let Some(rule) = &args.color {
        check_scalar(scene, rule)?;
        for object in &mut scene.objects {
            object.color = rule.clone();
        }
    }
    place_textures(scene, &args.projection)
}

/// Whether an object has the scalar that a rule names.
fn check_scalar(scene: &Scene, rule: &ColorRule) -> Result<(), Failure> {
    let ColorRule::Value(Quantity::Scalar(name)) = rule else {
        return Ok(());
    };
    let mut meshes = scene.objects.iter().map(|object| &object.mesh);
    if meshes.any(|mesh| mesh.scalar(name).is_some()) {
        return Ok(());
    }
    let meshes = scene.objects.iter().map(|object| &object.mesh);
    let names: BTreeSet<_> = meshes
        .flat_map(|mesh| mesh.scalars().iter().map(|scalar| scalar.name.as_str()))
        .collect();
    let names: Vec<_> = names.into_iter().collect();
    Err(Failure::usage(match names[..] {
        [] => format!("--color scalar:{name}: the files have no scalars"),
        _ => format!(
            "--color scalar:{name}: the files have no such scalar, but {}",
            names.join(", ")
        ),
    }))
}

/// Gives every object's texture the projection and the place that were asked for.
///
/// # Errors
/// A place without directions or size.
fn place_textures(scene: &mut Scene, args: &TextureProjectionArgs) -> Result<(), Failure> {
    if args.kind.is_some() {
        for object in &mut scene.objects {
            object.mapping.projection = None;
        }
    }
    let directions = [args.center, args.front, args.up];
    if directions == [None; 3] && args.size.is_none() {
        return Ok(());
    }
    for object in &mut scene.objects {
        let about = || Projector::about(&object.mesh.bounds());
        let old = object.mapping.projector.unwrap_or_else(about);
        let [center, front, up] = directions;
        let projector = Projector {
            center: center.unwrap_or(old.center),
            front: front.unwrap_or(old.front),
            up: up.unwrap_or(old.up),
            size: args.size.unwrap_or(old.size),
        };
        if let Err(error) = projector.axes() {
            return Err(Failure::usage(error.to_string()));
        }
        object.mapping.projector = Some(projector);
    }
    Ok(())
}

/// The shading that was asked for, over the scene file's, over the defaults.
pub fn shading(args: &ShadingArgs, file: Option<Shading>) -> Shading {
    let base = file.unwrap_or_default();
    let wireframe = match args.wireframe {
        None => base.wireframe,
        Some(WireframeArg::None) => None,
        Some(WireframeArg::Width(width)) => {
            let lines = base.wireframe.unwrap_or_default();
            Some(Wireframe {
                width,
                color: args.wireframe_color.unwrap_or(lines.color),
            })
        }
    };
    Shading {
        mode: args.mode.unwrap_or(base.mode),
        wireframe,
        background: args.background.unwrap_or(base.background),
        blend: args.blend.unwrap_or(base.blend),
        filter: args.filter.unwrap_or(base.filter),
        projection: args.projection.kind.unwrap_or(base.projection),
        scale: scale(args, base.scale),
    }
}

/// The colour scale that was asked for, over the scene file's.
fn scale(args: &ShadingArgs, file: Option<ColorScale>) -> Option<ColorScale> {
    if args.color_map.is_none() && args.color_range.is_none() && !args.legend {
        return file;
    }
    let base = file.unwrap_or_default();
    Some(ColorScale {
        map: args.color_map.unwrap_or(base.map),
        range: args.color_range.or(base.range),
        legend: args.legend || base.legend,
    })
}

/// The camera that was asked for, over the scene file's, over one that has all of `bounds` in view.
///
/// # Errors
/// A placement that says no direction or no up; size, step and field of view out of range or at
/// odds.
pub fn camera(
    args: &CameraArgs,
    file: Option<&CameraFile>,
    file_size: Option<(u32, u32)>,
    bounds: &Bounds,
) -> Result<Camera, Failure> {
    let projection = args
        .projection
        .or(file.map(|file| file.projection))
        .unwrap_or_default();
    // A field of view and a shape mean something else in another kind of picture.
    let alike = file.filter(|file| file.projection.panorama() == projection.panorama());
    let rows = file_size.map_or(DEFAULT_SIZE.1, |(_, rows)| rows);
    let default_size = match (projection.panorama(), alike) {
        (Some(panorama), None) => panorama.size(rows),
        _ => file_size.unwrap_or(DEFAULT_SIZE),
    };
    // A file's own was checked when it was read.
    if let Some(fov) = args.fov
        && let Err(error) = projection.check_fov(fov)
    {
        return Err(Failure::usage(format!("--fov {fov}: {error}")));
    }
    let fov = args.fov.or(alike.map(fov_of));
    let fov = fov.unwrap_or(projection.default_fov());
    let (columns, rows) = args.size.unwrap_or(default_size);
    let aspect = f64::from(columns) / f64::from(rows);

    let placement = placement(args, file, bounds, |orbit| {
        fit_distance(bounds, orbit, projection, fov, aspect)
    });
    placement.check()?;
    let distance = placement.eye.distance(placement.target);
    let frame = match file {
        // As the file says it: through an angle and back it would be rounded.
        Some(file)
            if file.projection == Projection::Orthographic
                && projection == Projection::Orthographic
                && placement == file.placement
                && args.fov.is_none() =>
        {
            file.frame
        }
        _ => projection.frame(fov, distance),
    };
    let plane = PlaneRequest {
        size: args.size,
        step: args.step,
        frame_height: args.fov.map(|fov| projection.frame(fov, distance)),
    }
    .resolve(default_size, frame)?;
    if let (Some(step), Projection::Perspective) = (args.step, projection) {
        let fov = frame_to_fov(f64::from(plane.rows) * step, distance);
        if let Err(error) = ranges::fov(fov) {
            return Err(Failure::usage(format!("a step of {step}: {error}")));
        }
    }
    Ok(Camera::new(placement, projection, plane))
}

/// Why there is no camera: bad usage, if anything was asked of it; else the fault of the files.
pub fn no_camera(args: &CameraArgs, name: &str, failure: Failure) -> Failure {
    let was_asked = args.size.is_some()
        || args.step.is_some()
        || args.fov.is_some()
        || args.eye.is_some()
        || args.target.is_some()
        || args.up.is_some()
        || args.orbit.is_some();
    if was_asked {
        failure
    } else {
        Failure::could_not(format!("{name}: its camera cannot be used: {failure}"))
    }
}

/// A scene file's vertical field of view, or the one that its orthographic frame has from its eye.
fn fov_of(file: &CameraFile) -> f64 {
    match file.projection {
        Projection::Perspective | Projection::Panoramic(_) => file.frame,
        Projection::Orthographic => {
            let distance = file.placement.eye.distance(file.placement.target);
            frame_to_fov(file.frame, distance)
        }
    }
}

/// Where the camera stands; `fit` says how far from its pivot an orbit must be.
fn placement(
    args: &CameraArgs,
    file: Option<&CameraFile>,
    bounds: &Bounds,
    fit: impl Fn(&Orbit) -> f64,
) -> Placement {
    let orbit = |yaw: f64, pitch: f64, distance: Option<f64>| {
        let mut orbit = Orbit {
            pivot: args.target.unwrap_or(bounds.center()),
            yaw,
            pitch,
            distance: 1.0,
        };
        orbit.distance = distance.unwrap_or_else(|| fit(&orbit));
        let placement = orbit.placement();
        Placement {
            up: args.up.unwrap_or(placement.up),
            ..placement
        }
    };
    let file = file.map(|file| file.placement);
    if let Some(asked) = args.orbit {
        orbit(asked.yaw, asked.pitch, asked.distance)
    } else if let Some(eye) = args.eye.or(file.map(|file| file.eye)) {
        let target = args
            .target
            .or(file.map(|file| file.target))
            .unwrap_or(bounds.center());
        let towards = Placement::towards(eye, target);
        Placement {
            up: args.up.or(file.map(|file| file.up)).unwrap_or(towards.up),
            ..towards
        }
    } else {
        let (yaw, pitch) = Orbit::DEFAULT_ANGLES;
        orbit(yaw, pitch, None)
    }
}

/// What was dropped from a scene, by reason: from its meshes, and by their transforms.
pub fn dropped(scene: &Scene, accel: &Accel) -> Dropped {
    let mut sum = Dropped {
        too_far: accel.out_of_range(),
        ..Dropped::default()
    };
    for object in &scene.objects {
        let dropped = object.mesh.dropped();
        sum.not_finite += dropped.not_finite;
        sum.too_far += dropped.too_far;
        sum.bad_index += dropped.bad_index;
        sum.zero_area += dropped.zero_area;
        sum.rounded_away += dropped.rounded_away;
    }
    sum
}

/// The reasons why triangles were dropped, in words: `3 without area, 1 not finite`.
pub fn reasons(dropped: &Dropped) -> String {
    let counts = [
        (dropped.zero_area, "without area"),
        (dropped.rounded_away, "rounded away by single precision"),
        (dropped.not_finite, "not finite"),
        (dropped.too_far, "too far away"),
        (dropped.bad_index, "with a vertex that is not there"),
    ];
    let told: Vec<_> = counts
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, reason)| format!("{count} {reason}"))
        .collect();
    told.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::OrbitArg;
    use raycast_core::glam::DVec3;
    use raycast_core::scene::{Mesh, Object, Shape};
    use raycast_core::shade::Mode;

    const UNIT: Bounds = Bounds {
        min: DVec3::new(0.0, 1.0, 2.0),
        max: DVec3::new(1.0, 2.0, 3.0),
    };

    fn made(args: &CameraArgs) -> Camera {
        camera(args, None, None, &UNIT).expect("a camera")
    }

    #[test]
    fn the_whole_scene_is_in_view_by_default() {
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let camera = made(&CameraArgs {
                projection: Some(projection),
                ..CameraArgs::default()
            });
            assert_eq!((camera.plane().columns, camera.plane().rows), DEFAULT_SIZE);
            assert_eq!(camera.placement().target, UNIT.center());
            for corner in UNIT.corners() {
                let (x, y) = camera.project(corner).expect("in front");
                assert!((0.0..=1280.0).contains(&x) && (0.0..=720.0).contains(&y));
            }
        }
    }

    #[test]
    fn commands_have_instances_where_they_save_memory() {
        let ball = Shape::Sphere {
            radius: 1.0,
            segments: 256,
            rings: 128,
        };
        let mesh = Arc::new(Mesh::new(ball.mesh().expect("a shape")));
        let triangles = mesh.triangles().len();
        let scene = |count: u32| {
            let objects = (0..count).map(|number| {
                let mut object = Object::new("ball", Arc::clone(&mesh));
                object.transform.translate.x = f64::from(number);
                object
            });
            Scene {
                objects: objects.collect(),
            }
        };
        assert!(3 * triangles < 1 << 20 && 1 << 20 < 17 * triangles);
        for (count, expected) in [(0, false), (1, false), (3, false), (17, true)] {
            let scene = scene(count);
            assert_eq!(has_instances(&scene), expected, "{count}");
            let stored = if expected { 1 } else { count as usize };
            assert_eq!(stored_triangles(&scene), stored * triangles, "{count}");
        }
        let scene = scene(17);
        let accel = tree(&scene).expect("a tree");
        assert!(accel.has_instances());
        // The view by default is that of one tree.
        assert_eq!(bounds(&scene, &accel), scene.bounds());
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
        let refused = camera(&at_odds, None, None, &UNIT);
        assert!(refused.is_err_and(|failure| failure.to_string().contains("at odds")));
        let agreed = CameraArgs {
            fov: Some(fov),
            ..at_odds
        };
        assert!(camera(&agreed, None, None, &UNIT).is_ok());
    }

    #[test]
    fn an_eye_looks_at_the_centre_unless_told_otherwise() {
        let eye = DVec3::new(5.0, -3.0, 2.0);
        let args = CameraArgs {
            eye: Some(eye),
            ..CameraArgs::default()
        };
        let placement = made(&args).placement();
        assert_eq!((placement.eye, placement.target), (eye, UNIT.center()));
        let args = CameraArgs {
            target: Some(DVec3::X),
            up: Some(DVec3::Z),
            ..args
        };
        let placement = made(&args).placement();
        assert_eq!((placement.target, placement.up), (DVec3::X, DVec3::Z));
    }

    #[test]
    fn a_camera_that_looks_nowhere_is_refused() {
        let center = UNIT.center();
        let above = CameraArgs {
            eye: Some(center + DVec3::Y * 3.0),
            ..CameraArgs::default()
        };
        // Nobody said what is up: it gives way.
        assert_eq!(made(&above).placement().up, DVec3::NEG_Z);
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
            let failure = camera(&args, None, None, &UNIT).expect_err(why);
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
        let eye = made(&args).placement().eye;
        assert!(
            eye.distance(UNIT.center() + DVec3::X * 4.0) < 1e-12,
            "{eye}"
        );
    }

    #[test]
    fn a_scene_file_gives_defaults_and_options_override_them() {
        let file = CameraFile {
            placement: Placement {
                eye: DVec3::new(0.0, 0.0, 8.0),
                target: DVec3::ZERO,
                up: DVec3::X,
            },
            projection: Projection::Orthographic,
            frame: 3.0,
        };
        let made =
            |args: &CameraArgs| camera(args, Some(&file), Some((30, 60)), &UNIT).expect("a camera");
        let as_it_is = made(&CameraArgs::default());
        assert_eq!(as_it_is.placement(), file.placement);
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
        assert_eq!(elsewhere.placement().target, DVec3::ZERO);
        assert!((elsewhere.plane().frame_height() - 1.5).abs() < 1e-12);
    }

    #[test]
    fn shading_options_override_one_by_one() {
        let file = Shading {
            mode: Mode::Depth,
            blend: 0.25,
            ..Shading::default()
        };
        let args = ShadingArgs {
            wireframe: Some(WireframeArg::Width(2.0)),
            blend: Some(0.5),
            ..ShadingArgs::default()
        };
        let made = shading(&args, Some(file));
        assert_eq!((made.mode, made.blend), (Mode::Depth, 0.5));
        assert_eq!(made.wireframe.map(|lines| lines.width), Some(2.0));
        assert_eq!(shading(&ShadingArgs::default(), None), Shading::default());
        let none = ShadingArgs {
            wireframe: Some(WireframeArg::None),
            ..ShadingArgs::default()
        };
        assert_eq!(shading(&none, Some(made)).wireframe, None);
    }

    #[test]
    fn reasons_are_told_where_there_are_any() {
        let dropped = Dropped {
            zero_area: 3,
            not_finite: 1,
            ..Dropped::default()
        };
        assert_eq!(reasons(&dropped), "3 without area, 1 not finite");
        assert_eq!(reasons(&Dropped::default()), "");
    }
}
