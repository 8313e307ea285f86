//! The split seen from outside: each sub-camera's frustum around the scene.

use super::Failure;
use crate::setup;
use raycast_core::camera::{Camera, Grid, Orbit, Rect};
use raycast_core::glam::DVec3;
use raycast_core::render::View;
use raycast_core::scene::{Bounds, ColorRule, Mesh, MeshData, Object, Scene};
use std::sync::Arc;

/// The most sub-cameras that are drawn; with more a picture would be unreadable.
const MAX_SUB_CAMERAS: usize = 4096;

/// By how much a frustum is drawn narrower than it is, on each side, to separate neighbours.
const SHRINK: f64 = 0.01;

/// Half the width of an edge, relative to the extent of the view.
const EDGE: f64 = 0.0012;

/// The direction of the outside camera relative to the shown one, in degrees to the side and up.
const ASIDE: (f64, f64) = (62.0, 24.0);

/// The straight pieces that a side of a panorama's tile is drawn with: its rays' ends lie on a sphere.
const PIECES: u32 = 16;

/// A piece of a frustum's outline.
type Edge = (DVec3, DVec3);

/// A view of the same scene with the frusta of a camera's sub-cameras, seen from outside in as many pixels. They reach from
/// their eye to the plane of the camera's target; those of panoramas, and through a lens, to the sphere through it.
///
/// # Errors
/// More sub-cameras than can be drawn; a picture for two eyes; a scene that cannot be put together.
pub(super) fn outside_view(view: &View, grid: Grid) -> Result<View, Failure> {
    let camera = view.camera;
    if camera.stereo().is_some() {
        return Err(Failure::usage(
            "--show-sub-cameras draws frusta from one eye: this picture is for two",
        ));
    }
    let plane = camera.plane();
    let (across, down) = grid.counts(plane.columns, plane.rows);
    if across as usize * down as usize > MAX_SUB_CAMERAS {
        return Err(Failure::usage(format!(
            "{across}x{down} sub-cameras cannot be told apart: ask for fewer with --tiles or --tile-size"
        )));
    }
    let tiles = grid.tiles(plane.columns, plane.rows);
    let outline = match camera.projection().panorama() {
        Some(_) => curved_outline,
        None => plane_outline,
    };
    let outlines: Vec<Vec<Edge>> = tiles.iter().map(|&tile| outline(&camera, tile)).collect();
    let ends = outlines.iter().flatten().flat_map(|&(from, to)| [from, to]);
    let bounds = setup::bounds(&view.scene, &view.accel);
    let all = Bounds::around(bounds.corners().into_iter().chain(ends));
    let half_width = EDGE * (all.max - all.min).length();
    let mut scene = Scene::clone(&view.scene);
    let lively = ColorRule::PerTriangle { seed: 1 };
    for (index, outline) in outlines.iter().enumerate() {
        let mut bars = MeshData::default();
        for &(from, to) in outline {
            bar(&mut bars, from, to, half_width);
        }
        let name = format!(
            "sub-camera {},{}",
            index as u32 % across,
            index as u32 / across
        );
        let mut object = Object::new(name, Arc::new(Mesh::new(bars)));
        object.color = lively
            .color(index as u32)
            .map_or_else(|| lively.clone(), ColorRule::Uniform);
        scene.objects.push(object);
    }
    let from = Orbit::from_placement(&camera.pose());
    let angles = (
        from.yaw + ASIDE.0,
        (from.pitch + ASIDE.1).clamp(-80.0, 80.0),
    );
    let outside = Camera::fitting(&all, angles, (plane.columns, plane.rows))?;
    let accel = setup::tree(&scene)?;
    Ok(View {
        scene: Arc::new(scene),
        accel: Arc::new(accel),
        camera: outside,
        settings: view.settings,
    })
}

/// A place of a tile, 0 to 1 across and down; its rim is drawn inside it.
fn place_in(tile: Rect, x: f64, y: f64) -> (f64, f64) {
    let within = |share: f64| share.clamp(SHRINK, 1.0 - SHRINK);
    (
        f64::from(tile.x) + f64::from(tile.width) * within(x),
        f64::from(tile.y) + f64::from(tile.height) * within(y),
    )
}

const CORNERS: [(f64, f64); 4] = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];

/// The frustum of a tile up to the plane of the camera's target.
fn plane_outline(camera: &Camera, tile: Rect) -> Vec<Edge> {
    let pose = camera.pose();
    let forward = pose.target - pose.eye;
    let rays = CORNERS.map(|(x, y)| {
        let (x, y) = place_in(tile, x, y);
        let ray = camera.ray(x, y);
        // A camera's ray is never parallel to the plane of the target.
        let t = (pose.target - ray.origin).dot(forward) / ray.direction.dot(forward);
        (ray.origin, ray.origin + ray.direction * t)
    });
    let mut outline = Vec::new();
    for corner in 0..CORNERS.len() {
        let ((from, to), (beside, next)) = (rays[corner], rays[(corner + 1) % CORNERS.len()]);
        outline.extend([(from, to), (to, next)]);
        // Parallel rays start on the image plane.
        if from != beside {
            outline.push((from, beside));
        }
    }
    outline
}

/// What a tile of a panorama sees, up to the sphere through the camera's target: without the parts that are outside the
/// picture's domain.
fn curved_outline(camera: &Camera, tile: Rect) -> Vec<Edge> {
    let pose = camera.pose();
    let distance = pose.eye.distance(pose.target);
    let end = |(x, y): (f64, f64)| {
        let (x, y) = place_in(tile, x, y);
        let direction = camera.ray(x, y).direction.normalize_or_zero();
        (direction != DVec3::ZERO).then_some(pose.eye + direction * distance)
    };
    let mut outline = Vec::new();
    for corner in 0..CORNERS.len() {
        let (from, to) = (CORNERS[corner], CORNERS[(corner + 1) % CORNERS.len()]);
        outline.extend(end(from).map(|to| (pose.eye, to)));
        let between = |piece: u32| {
            let share = f64::from(piece) / f64::from(PIECES);
            end((
                from.0 + (to.0 - from.0) * share,
                from.1 + (to.1 - from.1) * share,
            ))
        };
        let pieces = (0..PIECES).filter_map(|piece| Some((between(piece)?, between(piece + 1)?)));
        // At a pole all of a row is one point.
        outline.extend(pieces.filter(|(from, to)| from != to));
    }
    outline
}

/// Adds a bar of three sides between two points.
fn bar(mesh: &mut MeshData, from: DVec3, to: DVec3, half_width: f64) {
    let along = (to - from).normalize_or_zero();
    let side = along.any_orthonormal_vector() * half_width;
    let other = along.cross(side);
    let first = mesh.positions.len() as u32;
    // An equilateral triangle around each end: sines and cosines of thirds of a turn.
    let (half, root) = (-0.5, 0.75f64.sqrt());
    for end in [from, to] {
        mesh.positions.extend([
            end + side,
            end + side * half + other * root,
            end + side * half - other * root,
        ]);
    }
    for i in 0..3 {
        let (a, b) = (first + i, first + (i + 1) % 3);
        mesh.triangles.extend([[a, b, b + 3], [a, b + 3, a + 3]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_core::camera::{ImagePlane, Panorama, Pose, Projection};
    use std::f64::consts::TAU;

    #[test]
    fn a_frustum_reaches_from_the_eye_to_its_tiles_corners_on_the_targets_plane() {
        let pose = Pose {
            eye: DVec3::new(0.0, 0.0, 4.0),
            target: DVec3::ZERO,
            up: DVec3::Y,
        };
        let plane = ImagePlane::new(8, 4, 0.5).expect("a plane");
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let camera = Camera::new(pose, projection, plane);
            let tile = Rect {
                x: 4,
                y: 0,
                width: 4,
                height: 2,
            };
            let [(from, to), (_, right), ..] = plane_outline(&camera, tile)[..] else {
                panic!("a corner, and the edge to the next");
            };
            let shrunk = 4.0 * 0.5 * SHRINK;
            assert!(
                to.distance(DVec3::new(shrunk, 1.0 - shrunk / 2.0, 0.0)) < 1e-12,
                "{to}"
            );
            assert!(
                right.distance(DVec3::new(2.0 - shrunk, to.y, 0.0)) < 1e-12,
                "{right}"
            );
            match projection {
                Projection::Perspective | Projection::Panoramic(_) => {
                    assert_eq!(from, pose.eye)
                }
                Projection::Orthographic => assert!(from.distance(to + DVec3::Z * 4.0) < 1e-12),
            }
        }
    }

    /// The top left quarter of the sphere has four corners, that of a full fisheye's square three: one is outside the disc.
    #[test]
    fn a_panoramas_tile_reaches_the_sphere_through_the_target() {
        let pose = Pose {
            eye: DVec3::new(0.0, 0.0, 4.0),
            target: DVec3::ZERO,
            up: DVec3::Y,
        };
        for (panorama, (columns, rows), corners) in [
            (Panorama::Equirectangular, (8, 4), 4),
            (Panorama::Equidistant, (8, 8), 3),
        ] {
            let plane = ImagePlane::new(columns, rows, 4.0 * TAU / 8.0).expect("a plane");
            let camera = Camera::new(pose, Projection::Panoramic(panorama), plane);
            let quarter = Rect {
                x: 0,
                y: 0,
                width: columns / 2,
                height: rows / 2,
            };
            let outline = curved_outline(&camera, quarter);
            let from_eye = outline.iter().filter(|(from, _)| *from == pose.eye);
            assert_eq!(from_eye.count(), corners, "{panorama:?}");
            for (_, to) in &outline {
                assert!((to.distance(pose.eye) - 4.0).abs() < 1e-12, "{to}");
            }
            // The corner in the picture's middle, all but the shrinking.
            let nearest = outline.iter().map(|(_, to)| to.distance(pose.target));
            assert!(nearest.fold(f64::INFINITY, f64::min) < 4.0 * TAU * SHRINK);
        }
    }

    #[test]
    fn a_bar_is_a_closed_tube_but_for_its_ends() {
        let mut mesh = MeshData::default();
        bar(&mut mesh, DVec3::ZERO, DVec3::new(0.0, 3.0, 0.0), 0.1);
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (6, 6));
        for position in &mesh.positions {
            let from_axis = DVec3::new(position.x, 0.0, position.z).length();
            assert!((from_axis - 0.1).abs() < 1e-12);
        }
    }
}
