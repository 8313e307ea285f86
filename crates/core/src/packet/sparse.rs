//! Sparse lattices: rays so far apart that most triangles lie between them, as in a coarse pass over millions of
//! triangles. A packet's frustum contains all of those; single rays visit only the few close to them.

use super::ray_rect::RayRect;
use super::traversal::Traversal;
use crate::camera::Lattice;
use crate::num::simd::Lanes;

/// The number of triangles in a large packet's frustum for each of its rays at and above which single rays take less
/// time. In one mesh of 4 million triangles every 4th ray has 100 and every 8th 400: single rays take twice as long as
/// packets at the former, and as long at the latter.
const TRIANGLES_PER_RAY: u32 = 400;

/// The same among instances, where packets enter many trees. With 7.7 million triangles in 1024 objects, every 8th ray has
/// 120 to 300 and takes a half to a quarter of the time one by one; every 4th ray close up has 30 and would take twice as
/// long.
const TRIANGLES_PER_RAY_OF_INSTANCES: u32 = 96;

/// The least [`stride`](crate::camera::Lattice::stride) at which rays may be cast one by one. Occluded triangles are
/// counted as well: close to the same objects packets skip them, and take half the time at every second ray.
const LEAST_STRIDE: u32 = 4;

/// The number of parts that the limit of triangles is divided into for counting. With fewer, more triangles outside
/// the frustum are counted; with more, more boxes are tested.
const PARTS: u32 = 64;

impl<const INSTANCES: bool> Traversal<'_, INSTANCES> {
    /// Whether a large packet, whose entry points were found, takes less time ray by ray.
    #[inline(always)]
    pub(super) fn is_sparse(&self, lanes: impl Lanes, lattice: &Lattice, large: &RayRect) -> bool {
        if lattice.stride < LEAST_STRIDE {
            return false;
        }
        let most_per_ray = match INSTANCES {
            true => TRIANGLES_PER_RAY_OF_INSTANCES,
            false => TRIANGLES_PER_RAY,
        };
        let most = most_per_ray * large.columns * large.rows;
        let frustum = self.frustum(large);
        let mut left: Vec<_> = self.entry_points.iter().map(|entry| entry.0).collect();
        let mut triangles = 0u32;
        while let Some(subtree) = left.pop() {
            let node = subtree.node().filter(|_| subtree.count > most / PARTS);
            let Some(index) = node else {
                triangles = triangles.saturating_add(subtree.count);
                if triangles > most {
                    return true;
                }
                continue;
            };
            let mut opened = None;
            let (boxes, children) = self.accel.open::<INSTANCES>(index, &mut opened);
            let entered = frustum.enter(lanes, boxes).into_iter().zip(children);
            left.extend(
                entered
                    .filter(|((_, is_inside), _)| *is_inside)
                    .map(|(_, child)| child),
            );
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::super::cast_tests::waves_mesh;
    use crate::bvh::Accel;
    use crate::camera::{Camera, ImagePlane, Pose, Projection};
    use crate::hit::{Cull, Precision};
    use crate::scene::{Object, Scene};
    use glam::DVec3;
    use std::sync::Arc;

    #[test]
    fn sparse_rays_are_cast_one_by_one_and_find_the_same() {
        let mesh = Arc::new(waves_mesh(400, 1.0, DVec3::ZERO));
        let mut scene = Scene {
            objects: vec![Object::new("", Arc::clone(&mesh)), Object::new("", mesh)],
        };
        scene.objects[1].transform.rotate.y = 33.0;
        let elsewhere = scene.clone();
        scene.objects[1].transform.translate.y = -0.2;
        let one = Accel::build(&scene).expect("a valid scene");
        let before = Accel::build_instances(&elsewhere).expect("a valid scene");
        let moved = before.updated_at_once(&scene).expect("a small change");
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let pose = Pose {
                eye: DVec3::new(0.7, 1.9, 2.1),
                target: DVec3::ZERO,
                up: DVec3::Y,
            };
            let plane = ImagePlane::new(320, 240, 0.004).expect("a good plane");
            let camera = Camera::new(pose, projection, plane);
            let mut found = [1, 8, 32].map(|stride| {
                let lattice = camera.whole().sparse_lattice(stride, (0, 0));
                [&one, &moved].map(|accel| {
                    let mut primitives = Vec::new();
                    let (cull, precision) = (Cull::None, Precision::Exact);
                    let counts = accel.find_closest(&lattice, cull, precision, &mut primitives);
                    let each = counts.double_rays + counts.exact_rays;
                    assert_eq!(each == lattice.len() as u64, stride > 1, "{stride}");
                    assert!(counts.hits * 4 > each, "{stride}");
                    let ids = primitives.iter().map(|&primitive| match primitive {
                        crate::MISS => None,
                        hit => Some(accel.identify(hit)),
                    });
                    ids.collect::<Vec<_>>()
                })
            });
            for ([a, b], stride) in found.iter().zip([1, 8, 32]) {
                assert!(a == b, "{stride}");
            }
            let all = std::mem::take(&mut found[0][0]);
            for ([sparse, _], stride) in found[1..].iter().zip([8, 32]) {
                let every = (0..240usize).step_by(stride).flat_map(|row| {
                    let row = &all[row * 320..row * 320 + 320];
                    row.iter().step_by(stride)
                });
                assert!(every.eq(sparse), "{stride}");
            }
        }
    }
}
