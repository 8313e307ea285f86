//! What both of obvhs's trees use: its triangle test, its rays, its hits.

use super::one_ray::CasterRay;
use obvhs::ray::{Ray, RayHit};
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use raycast_core::glam::{Vec3, Vec3A};
use raycast_core::{Accel, PrimitiveHit};

/// From this number of triangles on, fewer than a quarter may be duplicates: the time of obvhs's builder is
/// quadratic in their number. Smaller scenes are built whatever their duplicates.
const DUPLICATES_FROM: usize = 1000;

/// Triangles in leaf order.
pub(super) struct Triangles {
    pub(super) tests: Vec<RtTriangle>,
    primitives: Vec<u32>,
}

impl Triangles {
    /// A scene's triangles in obvhs's form. `None` if its builder cannot handle them: none at all, many duplicates,
    /// or coordinates so large or small that the areas of boxes overflow or underflow in single precision.
    pub(super) fn from_accel(accel: &Accel) -> Option<Vec<Triangle>> {
        let corners: Vec<[Vec3; 3]> = (0..accel.len() as u32).map(|s| accel.corners(s)).collect();
        let reach = corners.iter().flatten().map(|c| c.abs().max_element());
        let reach = reach.fold(0.0, f32::max);
        let mut distinct: Vec<[u32; 9]> = corners
            .iter()
            .map(|[a, b, c]| {
                let [a, b, c] = [a, b, c].map(|p| p.to_array().map(f32::to_bits));
                [a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]]
            })
            .collect();
        distinct.sort_unstable();
        distinct.dedup();
        let copies = corners.len() - distinct.len();
        let can = !corners.is_empty()
            && (1e-15..1e15).contains(&reach)
            && (corners.len() < DUPLICATES_FROM || copies < corners.len() / 4);
        can.then(|| {
            let triangle = |corners: [Vec3; 3]| {
                let [v0, v1, v2] = corners.map(Vec3A::from);
                Triangle { v0, v1, v2 }
            };
            corners.into_iter().map(triangle).collect()
        })
    }

    /// Precomputes the triangles in leaf order, as obvhs's examples recommend.
    pub(super) fn in_order(triangles: &[Triangle], order: &[u32]) -> Self {
        let tests = order
            .iter()
            .map(|&index| RtTriangle::from(&triangles[index as usize]))
            .collect();
        Self {
            tests,
            primitives: order.to_vec(),
        }
    }

    /// Completes a hit with t, u and v, which a renderer needs.
    pub(super) fn to_primitive_hit(&self, ray: &Ray, hit: &RayHit) -> PrimitiveHit {
        let Some(test) = self.tests.get(hit.primitive_id as usize) else {
            return PrimitiveHit::NONE;
        };
        let weights = test.compute_barycentric(ray);
        PrimitiveHit {
            primitive: self.primitives[hit.primitive_id as usize],
            t: hit.t,
            u: weights.x,
            v: weights.y,
        }
    }
}

/// A ray in obvhs's form.
pub(super) fn to_obvhs(ray: &CasterRay<Vec3>) -> Ray {
    Ray::new(
        ray.origin.into(),
        ray.direction.into(),
        ray.t_min,
        ray.t_max,
    )
}
