//! The extent of a scene in a direction.

use super::Accel;
use super::tree::{Box32, DEPTH_LIMIT, Subtree};
use glam::DVec3;

impl Accel {
    /// The support function: the largest `direction · corner` over the corners of all triangles that rays can
    /// hit, in world coordinates and units of the direction's length. Rounded, by a few units in the last place
    /// of a coordinate. `None` for an empty tree.
    ///
    /// Branch and bound (Land and Doig, "An automatic method of solving discrete programming problems", 1960)
    /// over the tree's boxes: a subtree whose box reaches no further than a corner that was found is skipped.
    pub fn support(&self, direction: DVec3) -> Option<f64> {
        let mut stack = [Subtree::default(); DEPTH_LIMIT];
        let mut depth = 0;
        let mut subtree = self.tree.root?;
        let mut most = f64::NEG_INFINITY;
        loop {
            if let Some(index) = subtree.node() {
                let mut opened = None;
                let (boxes, [a, b]) = self.open_any(index, &mut opened);
                let reach = [0, 1].map(|which| reach(&boxes.get(which), direction));
                let (near, far) = if reach[0] >= reach[1] {
                    ((a, reach[0]), (b, reach[1]))
                } else {
                    ((b, reach[1]), (a, reach[0]))
                };
                if near.1 > most {
                    if far.1 > most {
                        stack[depth] = far.0;
                        depth += 1;
                    }
                    subtree = near.0;
                    continue;
                }
            } else {
                for primitive in subtree.primitives() {
                    for corner in self.corners(primitive) {
                        most = most.max(corner.as_dvec3().dot(direction));
                    }
                }
            }
            if depth == 0 {
                return Some(most + self.origin.dot(direction));
            }
            depth -= 1;
            subtree = stack[depth];
        }
    }
}

/// The largest `direction · point` over a box's points.
fn reach(around: &Box32, direction: DVec3) -> f64 {
    let (min, max) = (around.min.as_dvec3(), around.max.as_dvec3());
    let reach = (min * direction).max(max * direction);
    reach.x + reach.y + reach.z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::scene::{Mesh, MeshData, Object, Scene};
    use std::sync::Arc;

    #[test]
    fn reaches_as_far_as_the_furthest_corner() {
        let mut random = Random(3);
        for count in [1, 5, 700] {
            let positions: Vec<DVec3> = (0..3 * count)
                .map(|_| random.point() + DVec3::X * 9.0)
                .collect();
            let triangles = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let mesh = Mesh::new(MeshData {
                positions,
                triangles,
                ..MeshData::default()
            });
            let accel = Accel::build(&Scene::from(mesh)).expect("a valid scene");
            for _ in 0..50 {
                let direction = random.point();
                let furthest = (0..accel.len() as u32)
                    .flat_map(|primitive| accel.corners(primitive))
                    .map(|corner| (corner.as_dvec3() + accel.origin()).dot(direction))
                    .fold(f64::NEG_INFINITY, f64::max);
                let found = accel.support(direction).expect("triangles");
                assert!((found - furthest).abs() < 1e-12, "{found} {furthest}");
            }
        }
        let nothing = Accel::build(&Scene::default()).expect("a valid scene");
        assert_eq!(nothing.support(DVec3::X), None);
    }

    #[test]
    fn hidden_objects_are_not_hit_and_keep_their_numbers() {
        let mesh = Arc::new(Mesh::new(MeshData {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            triangles: vec![[0, 1, 2]],
            ..MeshData::default()
        }));
        let mut scene = Scene {
            objects: vec![Object::new("near", mesh.clone()), Object::new("far", mesh)],
        };
        scene.objects[1].transform.translate = DVec3::NEG_Z;
        let hit_and_top = |scene: &Scene| {
            let accel = Accel::build(scene).expect("a valid scene");
            let ray = crate::Ray::new(DVec3::new(0.25, 0.25, 2.0), DVec3::NEG_Z);
            let hit = accel.cast(&ray, crate::Cull::None);
            (hit.map(|hit| hit.object), accel.support(DVec3::Z))
        };
        assert_eq!(hit_and_top(&scene), (Some(0), Some(0.0)));
        let content = scene.content();
        scene.objects[0].visible = false;
        assert_eq!(hit_and_top(&scene), (Some(1), Some(-1.0)));
        assert_eq!(scene.bounds().max.z, -1.0);
        assert_ne!(scene.content(), content);
        scene.objects[1].visible = false;
        assert_eq!(hit_and_top(&scene), (None, None));
    }
}
