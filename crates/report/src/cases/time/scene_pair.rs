//! A hostile scene and one of as many ordinary triangles, and what both are made of.

use crate::cameras::camera;
use crate::meshes::{self, soup};
use crate::stage::scene_of;
use raycast_core::camera::{Camera, Projection};
use raycast_core::glam::DVec3;
use raycast_core::scene::{Mesh, Scene};
use raycast_oracle::random::Random;

/// Eye, target, and the frame's height there.
pub(super) type View = (DVec3, DVec3, f64);

/// A scene, and where it is seen from.
pub struct SceneView {
    /// The scene.
    pub scene: Scene,
    pub(super) view: View,
}

impl SceneView {
    /// The view in a size, by a projection.
    pub fn camera(&self, projection: Projection, size: (u32, u32)) -> Camera {
        let (eye, target, height) = self.view;
        camera(eye, target, projection, size, height)
    }
}

/// A hostile scene, and some of as many ordinary triangles.
pub struct ScenePair {
    /// The scene that takes other kernels time without bound.
    pub hostile: SceneView,
    /// The scenes to compare it with, of which the one whose picture takes longest counts: one in the same place, and also one
    /// in an ordinary view where the hostile view may see little of that.
    pub ordinary: Vec<SceneView>,
}

/// Where most scenes are seen from.
pub(super) const EYE: DVec3 = DVec3::new(0.25, 0.5, 3.0);

/// Two scenes in one view.
fn pair_in(view: View, hostile: Scene, ordinary: Scene) -> ScenePair {
    let [hostile, ordinary] = [hostile, ordinary].map(|scene| SceneView { scene, view });
    ScenePair {
        hostile,
        ordinary: vec![ordinary],
    }
}

/// Two scenes around the origin, seen from an eye.
pub(super) fn pair(eye: DVec3, hostile: Scene, ordinary: Scene) -> ScenePair {
    pair_in((eye, DVec3::ZERO, 2.0), hostile, ordinary)
}

/// Two soups in one view.
pub(super) fn soups_in(view: View, hostile: &[[DVec3; 3]], ordinary: &[[DVec3; 3]]) -> ScenePair {
    let scene_of_soup = |corners| single_mesh(soup(corners));
    pair_in(view, scene_of_soup(hostile), scene_of_soup(ordinary))
}

/// A soup in a view, and as many ordinary triangles in an ordinary one.
pub(super) fn ordinary_pair(view: View, hostile: &[[DVec3; 3]]) -> ScenePair {
    ScenePair {
        hostile: SceneView {
            scene: single_mesh(soup(hostile)),
            view,
        },
        ordinary: vec![SceneView {
            scene: ordinary(hostile.len(), 0.5),
            view: (EYE, DVec3::ZERO, 2.0),
        }],
    }
}

/// A soup in a view, as many ordinary triangles in the same view and places, and as many in an ordinary one.
pub(super) fn pair_in_place(view: View, hostile: &[[DVec3; 3]]) -> ScenePair {
    let mut pair = ordinary_pair(view, hostile);
    pair.ordinary.push(SceneView {
        scene: single_mesh(soup(&in_the_places_of(hostile))),
        view,
    });
    pair
}

/// Triangles with random corners, each about the middle of one of these and about as large.
fn in_the_places_of(triangles: &[[DVec3; 3]]) -> Vec<[DVec3; 3]> {
    let mut random = Random::new(411);
    let ordinary = |&[a, b, c]: &[DVec3; 3]| {
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let middle = (a + b + c) / 3.0;
        [(); 3].map(|()| middle + random.in_cube() * (0.5 * longest))
    };
    triangles.iter().map(ordinary).collect()
}

pub(super) fn single_mesh(mesh: Mesh) -> Scene {
    scene_of([mesh])
}

/// A point that single precision represents exactly, so that an eye can be where a corner is.
pub(super) fn to_f32(point: DVec3) -> DVec3 {
    point.as_vec3().as_dvec3()
}

/// As many random triangles as this, of about this size, around the target.
pub(super) fn ordinary(count: usize, size: f64) -> Scene {
    let mut random = Random::new(410);
    single_mesh(meshes::random_soup(
        &mut random,
        count as u32,
        DVec3::ZERO,
        1.0,
        size,
    ))
}

/// A scene and one of as many ordinary triangles, seen from afar along the z axis so that rays meet z = 0 at multiples
/// of a power of two.
pub(super) fn pair_on_grid(hostile: &[[DVec3; 3]], ordinary: &[[DVec3; 3]]) -> ScenePair {
    let target = DVec3::new(0.5, 0.5, 0.0);
    soups_in((target + DVec3::Z * 16.0, target, 12.0), hostile, ordinary)
}

/// Triangles whose corners are random.
pub(super) fn triangles_on(count: usize, mut corner: impl FnMut() -> DVec3) -> Vec<[DVec3; 3]> {
    (0..count).map(|_| [(); 3].map(|()| corner())).collect()
}

/// A scene and one of as many ordinary triangles, seen from next to the origin.
pub(super) fn pair_from_the_origin(hostile: &[[DVec3; 3]], ordinary: &[[DVec3; 3]]) -> ScenePair {
    let eye = DVec3::Z * (2.0 * f64::from(f32::from_bits(1)));
    soups_in((eye, DVec3::new(0.25, -0.5, -1.0), 1.0), hostile, ordinary)
}
