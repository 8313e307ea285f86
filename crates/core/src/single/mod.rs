//! Casting single rays: the reference that packets agree with.

mod clipped;
mod ordered_hits;
mod seen;
mod slab;
#[cfg(test)]
mod tie_tests;
mod traversal;

use crate::bvh::Accel;
use crate::hit::{Cull, Hit, Precision, PrimitiveHit};
use crate::ray::Ray;
use crate::triangle::clip::Clip;
use crate::triangle::{BoundedHit, PreparedRay};
pub use clipped::Clipped;
pub(crate) use ordered_hits::{MOST_HITS, OrderedHits};
pub(crate) use traversal::nearest;

impl Accel {
    /// The closest hit of `ray` by exact arithmetic; ties go to the lowest object, then the lowest triangle.
    ///
    /// A ray that is not valid hits nothing.
    pub fn cast(&self, ray: &Ray, cull: Cull) -> Option<Hit> {
        self.to_hit(self.nearest(ray, cull, Precision::Exact))
    }

    /// As [`Accel::cast`], with a primitive index in place of object and triangle numbers, in single precision: for
    /// loops over many rays.
    pub fn cast_primitive(&self, ray: &Ray, cull: Cull, precision: Precision) -> PrimitiveHit {
        self.nearest(ray, cull, precision).to_primitive_hit()
    }

    /// As [`Accel::cast`], by testing every triangle: for tests.
    pub fn cast_brute_force(&self, ray: &Ray, cull: Cull) -> Option<Hit> {
        let ray = self.prepare(ray, cull, Precision::Exact)?;
        let mut nearest = BoundedHit::NONE;
        for primitive in self.primitives() {
            self.intersect(&ray, primitive, &mut nearest);
        }
        self.to_hit(nearest)
    }

    fn nearest(&self, ray: &Ray, cull: Cull, precision: Precision) -> BoundedHit {
        match self.prepare(ray, cull, precision) {
            Some(ray) => traversal::nearest(self, &Clip::NONE, &ray),
            None => BoundedHit::NONE,
        }
    }

    /// Prepares a ray for this scene's triangles. `None` if it is not valid.
    pub(crate) fn prepare(
        &self,
        ray: &Ray,
        cull: Cull,
        precision: Precision,
    ) -> Option<PreparedRay> {
        let ray = PreparedRay::new(ray, self.origin, cull, precision)?;
        Some(ray.close_to(self.tree.bounds.corners()))
    }

    /// Intersects a ray with a triangle: see [`PreparedRay::intersect`].
    pub(crate) fn intersect(&self, ray: &PreparedRay, primitive: u32, nearest: &mut BoundedHit) {
        ray.intersect(
            primitive,
            |primitive| self.corners(primitive),
            |primitive| self.id(primitive),
            nearest,
        );
    }

    fn to_hit(&self, nearest: BoundedHit) -> Option<Hit> {
        if nearest.is_miss() {
            return None;
        }
        let (object, triangle) = self.identify(nearest.primitive);
        Some(Hit {
            object,
            triangle,
            t: nearest.t,
            u: nearest.u,
            v: nearest.v,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::scene::{Mesh, MeshData, Object, Scene};
    use glam::DVec3;
    use std::sync::Arc;

    fn accel(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Accel {
        let mesh = Mesh::new(MeshData {
            positions,
            triangles,
            ..MeshData::default()
        });
        let scene = Scene {
            objects: vec![Object::new("mesh", Arc::new(mesh))],
        };
        Accel::build(&scene).expect("a valid scene")
    }

    #[test]
    fn the_tree_answers_as_brute_force_does() {
        let mut random = Random(1);
        for count in [0, 1, 2, 3, 4, 9, 100, 1000] {
            for decade in [-9, 0, 9] {
                let size = 10f64.powi(decade);
                let positions = (0..count).flat_map(|_| {
                    let center = random.point();
                    [0; 3].map(|_| (center + random.point() * 0.3) * size)
                });
                let positions: Vec<DVec3> = positions.collect();
                let triangles = (0..count as u32)
                    .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
                    .collect();
                let accel = accel(positions.clone(), triangles);
                let mut hits = 0;
                for i in 0..500 {
                    let origin = random.point() * 2.0 * size;
                    let target = match positions.get(i % positions.len().max(1)) {
                        Some(&vertex) if i % 2 == 0 => vertex,
                        _ => random.point() * size,
                    };
                    let ray = Ray::new(origin, target - origin);
                    for cull in [Cull::None, Cull::Back] {
                        let hit = accel.cast(&ray, cull);
                        assert_eq!(hit, accel.cast_brute_force(&ray, cull), "{ray:?}");
                        hits += u32::from(hit.is_some());
                    }
                }
                assert!(count < 100 || hits > 300, "{count} {hits}");
            }
        }
    }

    #[test]
    fn placed_triangles_out_of_range_are_counted_and_the_others_are_hit() {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE * 1e10];
        let mesh = |triangles| {
            Arc::new(Mesh::new(MeshData {
                positions: corners.clone(),
                triangles,
                ..MeshData::default()
            }))
        };
        let mut far = Object::new("far", mesh(vec![[0, 1, 2], [0, 1, 3], [0, 1, 2]]));
        far.transform.scale = DVec3::splat(1e9);
        let nothing = Object::new("nothing", mesh(vec![]));
        let scene = Scene {
            objects: vec![
                nothing.clone(),
                far,
                nothing.clone(),
                nothing,
                Object::new("near", mesh(vec![[0, 1, 2]])),
            ],
        };
        let accel = Accel::build(&scene).expect("a valid scene");
        // The third triangle coincides with the first.
        assert_eq!((accel.out_of_range(), accel.len()), (1, 2));
        let hit = |x: f64, y: f64| {
            let ray = Ray::new(DVec3::new(x, y, 1.0), DVec3::NEG_Z);
            let hit = accel.cast(&ray, Cull::None);
            hit.map(|hit| (hit.object, hit.triangle))
        };
        assert_eq!(hit(0.25, 0.25), Some((1, 0)));
        assert_eq!(hit(5e8, 2e8), Some((1, 0)));
        assert_eq!(hit(6e8, 6e8), None);
        let above = Ray::new(DVec3::new(0.25, 0.25, 1.0), DVec3::Z);
        assert_eq!(accel.cast(&above, Cull::None), None);
    }

    #[test]
    fn copies_go_to_the_lowest_number() {
        for copies in [2, 7, 1000, 100_000] {
            let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
            let accel = accel(corners, vec![[0, 1, 2]; copies]);
            let ray = Ray::new(DVec3::new(0.2, 0.3, 1.0), DVec3::NEG_Z);
            assert_eq!(
                accel.cast(&ray, Cull::None).map(|hit| hit.triangle),
                Some(0)
            );
        }
    }

    #[test]
    fn rays_in_the_planes_of_boxes_are_not_lost() {
        let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let (a, b, c, d) = (
            corner(-1., -1., 1.),
            corner(1., -1., 1.),
            corner(1., 1., 1.),
            corner(-1., 1., 1.),
        );
        let accel = accel(
            vec![a, b, c, d, a - DVec3::Z, c - DVec3::Z],
            vec![[0, 1, 2], [0, 2, 3], [0, 4, 5]],
        );
        for direction in [
            DVec3::NEG_Z,
            DVec3::new(-0.0, 0.0, -1.0),
            DVec3::new(0.0, -0.0, -1e-9),
            DVec3::NEG_Z * 1e9,
        ] {
            let ray = Ray::new(DVec3::new(1.0, 0.25, 5.0), direction);
            let hit = accel.cast(&ray, Cull::None).expect("the edge");
            assert_eq!(hit.t, 4.0 / direction.length());
        }
    }

    #[test]
    fn hits_stay_within_the_range() {
        let accel = accel(
            vec![
                DVec3::new(-5.89e11, -5.89e11, 0.0),
                DVec3::new(5.89e11, -5.89e11, 0.0),
                DVec3::new(0.0, 5.89e11, 0.0),
            ],
            vec![[0, 1, 2]],
        );
        let ray = Ray {
            origin: DVec3::new(0.5, 0.25, 500.0),
            direction: DVec3::NEG_Z,
            t_min: 500f64.next_down(),
            t_max: 500.0,
        };
        assert_eq!(accel.cast(&ray, Cull::None).map(|hit| hit.t), Some(500.0));
        assert_eq!(
            accel.cast(
                &Ray {
                    t_min: 500.0,
                    t_max: f64::INFINITY,
                    ..ray
                },
                Cull::None
            ),
            None
        );
        assert_eq!(
            accel.cast(
                &Ray {
                    t_min: -1.0,
                    t_max: 500.0f64.next_down(),
                    ..ray
                },
                Cull::None
            ),
            None
        );
        let behind = Ray {
            direction: DVec3::Z,
            t_min: -1e6,
            t_max: 0.0,
            ..ray
        };
        let found = accel.cast(&behind, Cull::None).expect("a hit behind");
        assert_eq!(found.t as f32, -500.0);
        assert_eq!(
            accel.cast(
                &Ray {
                    t_min: -501.0,
                    t_max: f64::INFINITY,
                    ..behind
                },
                Cull::None
            ),
            accel.cast(&behind, Cull::None)
        );
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(accel.cast(&Ray { t_min: bad, ..ray }, Cull::None), None);
            for t_max in [f64::NAN, f64::NEG_INFINITY] {
                assert_eq!(accel.cast(&Ray { t_max, ..ray }, Cull::None), None);
            }
            assert_eq!(
                accel.cast(
                    &Ray {
                        origin: DVec3::splat(bad),
                        ..ray
                    },
                    Cull::None
                ),
                None
            );
        }
    }
}
