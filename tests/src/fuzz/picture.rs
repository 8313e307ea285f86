//! What holds of the picture of every scene that was read.

use super::reading::is_message;
use raycast_core::Accel;
use raycast_core::camera::{Camera, ImagePlane, Orbit, Projection, Rect, fit_distance};
use raycast_core::formats::{CameraFile, SceneFile};
use raycast_core::picture::Layers;
use raycast_core::render::{Settings, Tile, View};
use raycast_core::scene::Masks;
use raycast_core::shade::Mode;
use std::sync::Arc;
use std::time::Duration;

/// Columns and rows: more than one row of eight, and no whole number of them.
const SIZE: (u32, u32) = (12, 9);

/// More samples change nothing in kind.
const SAMPLES: u32 = 3;

/// Whether a scene shows a small picture without a number that is none, every pixel of which shows
/// what its ray hits. The camera and shading are the file's; where it has none, all of the scene is in
/// view, in a mode that depends on how many triangles there are.
///
/// # Errors
/// What is wrong with the picture.
pub fn is_seen_soundly(file: &SceneFile) -> Result<(), String> {
    let accel = match Accel::build(&file.scene) {
        Ok(accel) => accel,
        Err(refusal) => return is_message(&refusal.to_string()),
    };
    let Some(camera) = camera(file) else {
        return Ok(());
    };
    let mut shading = file.shading.unwrap_or_default();
    if file.shading.is_none() {
        shading.mode = Mode::ALL[file.scene.triangle_count() % Mode::ALL.len()];
    }
    let view = View {
        scene: Arc::new(file.scene.clone()),
        accel: Arc::new(accel),
        camera,
        settings: Settings {
            shading,
            samples: file.image.samples.unwrap_or(1).min(SAMPLES),
            clip: file.clip,
            cull: file.image.cull.unwrap_or_default(),
            layers: true,
            ..Settings::default()
        },
    };
    let rect = Rect {
        x: 0,
        y: 0,
        width: SIZE.0,
        height: SIZE.1,
    };
    let tile = view.render_sub_camera(view.camera.sub_camera(rect), &|| Duration::ZERO);
    is_sound(&tile)?;
    shows_what_rays_meet(&view, &tile)
}

/// The file's camera, or one that has all of the scene in view; `None` where a frame is too large or
/// too small to have a step.
fn camera(file: &SceneFile) -> Option<Camera> {
    let (columns, rows) = SIZE;
    let camera = file.camera.unwrap_or_else(|| {
        let bounds = file.scene.bounds();
        let mut orbit = Orbit {
            pivot: bounds.center(),
            yaw: 22.0,
            pitch: 16.0,
            distance: 1.0,
        };
        let aspect = f64::from(columns) / f64::from(rows);
        let projection = Projection::Perspective;
        orbit.distance = fit_distance(&bounds, &orbit, projection, 45.0, aspect);
        CameraFile {
            pose: orbit.pose(),
            projection,
            frame: 45.0,
        }
    });
    let pose = camera.pose;
    let distance = (pose.target - pose.eye).length();
    let height = match camera.projection {
        Projection::Orthographic => camera.frame,
        other => other.frame(camera.frame, distance),
    };
    let plane = ImagePlane::new(columns, rows, height / f64::from(rows)).ok()?;
    Some(Camera::new(pose, camera.projection, plane))
}

fn is_sound(tile: &Tile) -> Result<(), String> {
    let none = || "a tile without layers".to_owned();
    let layers: &Layers = tile.layers.as_ref().ok_or_else(none)?;
    for pixel in 0..tile.pixels.len() {
        let (color, depth) = (layers.color[pixel], layers.depth[pixel]);
        let (normal, uv) = (layers.normal[pixel], layers.uv[pixel]);
        let is_hit = layers.object[pixel] != u32::MAX;
        let is_finite = |values: &[f32]| values.iter().all(|value| value.is_finite());
        let length = normal.iter().map(|n| n * n).sum::<f32>().sqrt();
        // A unit vector of three rounded numbers is one to within a few roundings.
        let expected = if is_hit { 1.0 } else { 0.0 };
        let holds = is_finite(&color)
            && is_finite(&uv)
            && (length - expected).abs() < 1e-5
            && is_hit == (layers.triangle[pixel] != u32::MAX)
            && if is_hit {
                depth >= 0.0
            } else {
                depth == f32::INFINITY
            };
        if !holds {
            return Err(format!(
                "pixel {pixel}, a {}: colour {color:?}, depth {depth}, normal {normal:?}, uv {uv:?}",
                if is_hit { "hit" } else { "miss" }
            ));
        }
    }
    Ok(())
}

fn shows_what_rays_meet(view: &View, tile: &Tile) -> Result<(), String> {
    let Some(layers) = &tile.layers else {
        return Ok(());
    };
    let masks = Masks::of(&view.scene);
    for (pixel, (&object, &triangle)) in layers.object.iter().zip(&layers.triangle).enumerate() {
        let (column, row) = (pixel as u32 % SIZE.0, pixel as u32 / SIZE.0);
        let ray = view
            .camera
            .ray(f64::from(column) + 0.5, f64::from(row) + 0.5);
        let Settings { cull, clip, .. } = &view.settings;
        let kept = view.accel.clipped(clip).masked(masks.as_ref());
        let hit = kept.cast(&ray, *cull);
        let met = hit.map_or((u32::MAX, u32::MAX), |hit| (hit.object, hit.triangle));
        if met != (object, triangle) {
            return Err(format!(
                "pixel ({column}, {row}) shows {:?}, its ray meets {met:?}",
                (object, triangle)
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::reading::{MESH, read_mesh};
    use super::*;
    use raycast_core::glam::DVec3;

    fn tile() -> Tile {
        let file = read_mesh("a.obj", MESH.as_bytes())
            .expect("fit messages")
            .expect("a good mesh");
        assert_eq!(is_seen_soundly(&file), Ok(()));
        let accel = Arc::new(Accel::build(&file.scene).expect("a good scene"));
        let view = View {
            camera: camera(&file).expect("a frame"),
            scene: Arc::new(file.scene),
            accel,
            settings: Settings {
                samples: 1,
                layers: true,
                ..Settings::default()
            },
        };
        let rect = Rect {
            x: 0,
            y: 0,
            width: SIZE.0,
            height: SIZE.1,
        };
        let tile = view.render_sub_camera(view.camera.sub_camera(rect), &|| Duration::ZERO);
        assert_eq!(shows_what_rays_meet(&view, &tile), Ok(()));
        let mut moved = view.clone();
        let mut pose = view.camera.pose();
        pose.eye += DVec3::X * 100.0;
        moved.camera = Camera::new(pose, Projection::Perspective, view.camera.plane());
        assert!(shows_what_rays_meet(&moved, &tile).is_err());
        tile
    }

    #[test]
    fn a_number_that_is_none_is_found() {
        let good = tile();
        let center = good.pixels.len() / 2;
        let spoil = |change: &dyn Fn(&mut Layers)| {
            let mut bad = good.clone();
            change(bad.layers.as_mut().expect("layers"));
            assert!(is_sound(&bad).is_err());
        };
        assert_eq!(is_sound(&good), Ok(()));
        spoil(&|layers| layers.color[center][1] = f32::NAN);
        spoil(&|layers| layers.depth[center] = f32::NAN);
        spoil(&|layers| layers.normal[center] = [0.0; 3]);
        spoil(&|layers| layers.uv[center][0] = f32::INFINITY);
        spoil(&|layers| layers.triangle[center] = u32::MAX);
    }
}
