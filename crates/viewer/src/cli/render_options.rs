//! Writing views and cameras as options of `raycast render`, and reading cameras back.

use super::camera_values::{self, PROJECTIONS, STEREO, StereoArg};
use super::clip;
use super::shading_values::{COLOR_MAPS, FILTERS, LIGHTS, MODES, TEXTURE_PROJECTIONS};
use super::shell::quoted;
use super::values::{self, CULLS, Names, PIXEL_FILTERS, PRECISIONS};
use raycast_core::camera::{Pose, Projection, frame_to_fov};
use raycast_core::formats::{CameraFile, Limits};
use raycast_core::glam::DVec3;
use raycast_core::render::View;
use raycast_core::scene::{Scene, UpAxis};
use raycast_core::shade::{Background, Mode};
use std::path::PathBuf;

/// The `raycast render` command that gives a view's bytes, whatever camera and shading a scene file among `files` has.
/// Exception: where an object has a texture projection of its own, `--texture-projection` is left out, since it would
/// apply to all objects; the files' shading must then have the view's projection.
///
/// Numbers have the fewest digits that read back as the same; arguments are quoted for the shell. `None` if a path is
/// not Unicode.
pub fn render_command(
    files: &[PathBuf],
    output: &str,
    view: &View,
    limits: &Limits,
) -> Option<String> {
    let (camera, settings) = (&view.camera, &view.settings);
    let mut words = vec!["raycast".to_owned(), "render".to_owned()];
    for file in files {
        // The command may be run in any folder.
        let file = std::path::absolute(file).ok()?;
        words.push(file.to_str()?.to_owned());
    }
    let mut option = |name: &str, value: String| words.extend([name.to_owned(), value]);
    option("-o", output.to_owned());
    let (plane, pose) = (camera.plane(), camera.pose());
    option("--size", format!("{}x{}", plane.columns, plane.rows));
    option("--step", plane.step.to_string());
    option("--projection", camera.projection().name().to_owned());
    if let Some(lens) = camera.projection().lens() {
        option("--lens", lens.to_string());
    }
    // Defaults are written as well: a scene file may have other values.
    let [right, up] = camera.shift();
    option("--shift", format!("{right},{up}"));
    option(
        "--stereo",
        name_of(STEREO, StereoArg(camera.stereo().map(|stereo| stereo.kind))),
    );
    if let Some(stereo) = camera.stereo() {
        option("--eye-distance", stereo.eye_distance.to_string());
        if let Some(convergence) = stereo.convergence {
            option("--convergence", convergence.to_string());
        }
    }
    option("--eye", point(pose.eye));
    option("--target", point(pose.target));
    option("--up", point(pose.up));
    let shading = &settings.shading;
    option("--mode", name_of(MODES, shading.mode));
    option(
        "--background",
        match shading.background {
            Background::Transparent => "transparent".to_owned(),
            Background::Gradient(top, bottom) => format!("{top},{bottom}"),
        },
    );
    option("--blend", shading.blend.to_string());
    option("--filter", name_of(FILTERS, shading.filter));
    option("--crease", shading.crease.to_string());
    option("--lights", name_of(LIGHTS, shading.lights));
    option("--plain-color", shading.plain_color.to_string());
    if !has_own_projection(&view.scene) {
        let projection = name_of(TEXTURE_PROJECTIONS, shading.projection);
        option("--texture-projection", projection);
    }
    if let Some(scale) = shading.scale {
        option("--color-map", name_of(COLOR_MAPS, scale.map));
        if let Some([low, high]) = scale.range {
            option("--color-range", format!("{low},{high}"));
        }
    }
    option("--samples", settings.samples.max(1).to_string());
    option(
        "--pixel-filter",
        name_of(PIXEL_FILTERS, settings.pixel_filter),
    );
    option("--cull", name_of(CULLS, settings.cull));
    option("--precision", name_of(PRECISIONS, settings.precision));
    let planes = clip::words(&settings.clip);
    if planes.is_empty() {
        // A scene file may have some.
        option("--clip", "none".to_owned());
    }
    for plane in planes {
        option("--clip", plane);
    }
    let back_faces = shading.back_faces.map(|color| color.to_string());
    option(
        "--back-faces",
        back_faces.unwrap_or_else(|| "none".to_owned()),
    );
    words.push(match shading.ground {
        Some(ground) => format!("--ground={ground}"),
        None => "--ground=none".to_owned(),
    });
    let mut option = |name: &str, value: String| words.extend([name.to_owned(), value]);
    if shading.mode == Mode::XRay {
        option("--x-ray-opacity", shading.x_ray_opacity.to_string());
    }
    match shading.wireframe {
        Some(lines) => {
            option("--wireframe-color", lines.color.to_string());
            option("--wireframe-edges", lines.edges.to_string());
            words.push(format!("--wireframe={}", lines.width));
            words.push(format!("--wireframe-hidden={}", lines.hidden));
        }
        None => words.push("--wireframe=none".to_owned()),
    }
    if shading.scale.is_some_and(|scale| scale.legend) {
        words.push("--legend".to_owned());
    }
    words.extend(reading(limits));
    let words: Vec<_> = words.iter().map(|word| quoted(word)).collect();
    Some(words.join(" "))
}

/// Whether an object has a texture projection of its own.
pub fn has_own_projection(scene: &Scene) -> bool {
    let mut objects = scene.objects.iter();
    objects.any(|object| object.mapping.projection.is_some())
}

/// A camera as options of `raycast render`, which [`parse_camera_options`] reads. An orthographic frame is written as the field of
/// view of that height at the target's distance.
pub fn camera_options(camera: &CameraFile) -> String {
    let CameraFile {
        pose,
        projection,
        frame,
    } = camera;
    let fov = match projection {
        Projection::Orthographic => frame_to_fov(*frame, pose.eye.distance(pose.target)),
        Projection::Perspective | Projection::Panoramic(_) => *frame,
    };
    let lens = projection.lens().map(|lens| format!(" --lens {lens}"));
    format!(
        "--eye {} --target {} --up {} --fov {fov} --projection {}{}",
        point(pose.eye),
        point(pose.target),
        point(pose.up),
        projection.name(),
        lens.unwrap_or_default(),
    )
}

/// The camera in options of `raycast render`, among any other text. `None` without an eye or a target, or if the camera
/// is invalid. Defaults: the up direction of [`Pose::towards`], perspective, the projection's field of view.
pub fn parse_camera_options(text: &str) -> Option<CameraFile> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let option = |name: &str| {
        let at = words.iter().position(|word| *word == name)?;
        words.get(at + 1).copied()
    };
    let read = |name: &str| option(name).map(values::point).transpose().ok();
    let (eye, target) = (read("--eye")??, read("--target")??);
    let towards = Pose::towards(eye, target);
    let pose = Pose {
        up: read("--up")?.unwrap_or(towards.up),
        ..towards
    };
    pose.check().ok()?;
    let projection = match option("--projection") {
        Some(name) => PROJECTIONS.iter().find(|(known, _)| *known == name)?.1,
        None => Projection::Perspective,
    };
    let projection = match option("--lens") {
        Some(lens) if projection == Projection::Perspective => {
            Projection::through(camera_values::lens(lens).ok()?)
        }
        _ => projection,
    };
    let distance = eye.distance(target);
    let fov = option("--fov").map(camera_values::fov).transpose().ok()?;
    let rows = option("--size").map(values::size).transpose().ok()?;
    let step = option("--step").map(camera_values::step).transpose().ok()?;
    let fov = fov.map(|fov| projection.check_fov(fov)).transpose().ok()?;
    let frame = match (fov, step.zip(rows)) {
        (Some(fov), _) => projection.frame(fov, distance),
        (None, Some((step, (_, rows)))) => step * f64::from(rows),
        (None, None) => projection.frame(projection.default_fov(), distance),
    };
    Some(CameraFile {
        pose,
        projection,
        frame: match fov {
            _ if projection.is_parallel() => frame,
            Some(fov) => fov,
            None => projection.fov_degrees(frame, distance),
        },
    })
}

/// The options of reading that are not at their defaults.
fn reading(limits: &Limits) -> Vec<String> {
    let mut words = Vec::new();
    let usual = Limits::default();
    for (name, most, usual) in [
        ("bytes", limits.bytes, usual.bytes),
        ("pixels", limits.pixels, usual.pixels),
        ("triangles", limits.triangles, usual.triangles),
    ] {
        if most != usual {
            words.extend(["--limit".to_owned(), format!("{name}={most}")]);
        }
    }
    if limits.follow_anywhere {
        words.push("--follow-anywhere".to_owned());
    }
    if limits.up_axis == UpAxis::Z {
        words.extend(["--up-axis".to_owned(), "z".to_owned()]);
    }
    words
}

fn name_of<T: PartialEq>(names: Names<T>, value: T) -> String {
    let name = names.iter().find(|(_, named)| *named == value);
    name.map_or_else(String::new, |(name, _)| (*name).to_owned())
}

fn point(point: DVec3) -> String {
    format!("{},{},{}", point.x, point.y, point.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_reads_back_as_it_was_written_and_nonsense_is_none() {
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let camera = CameraFile {
                pose: Pose {
                    eye: DVec3::new(1.0 / 3.0, -2e-7, 5e9),
                    target: DVec3::new(0.5, 0.0, -1.0),
                    up: DVec3::new(0.1, 1.0, 0.0),
                },
                projection,
                frame: 33.0,
            };
            let read = parse_camera_options(&camera_options(&camera)).expect("a camera");
            assert_eq!((read.pose, read.projection), (camera.pose, projection));
            assert!((read.frame / 33.0 - 1.0).abs() < 1e-6, "{read:?}");
        }
        let line =
            "raycast render a.obj -o a.png --size 40x30 --step 0.1 --eye 0,0,9 --target 0,0,0";
        let read = parse_camera_options(line).expect("a camera");
        assert!((raycast_core::camera::fov_to_frame(read.frame, 9.0) - 3.0).abs() < 1e-12);
        for text in [
            "",
            "hello",
            "--eye 0,0,0",
            "--eye 1,2,3 --target 1,2,3",
            "--eye a --target b",
        ] {
            assert_eq!(parse_camera_options(text), None, "{text}");
        }
    }

    #[test]
    fn options_of_reading_are_written_where_they_differ() {
        assert!(reading(&Limits::default()).is_empty());
        let limits = Limits {
            pixels: 5,
            follow_anywhere: true,
            up_axis: UpAxis::Z,
            ..Limits::default()
        };
        let words = ["--limit", "pixels=5", "--follow-anywhere", "--up-axis", "z"];
        assert_eq!(reading(&limits), words);
    }
}
