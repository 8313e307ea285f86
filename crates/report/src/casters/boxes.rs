//! A plain tree of boxes that loses no ray, so that what goes wrong is the triangle test's doing.
//!
//! Leaves are runs of [`RUN`] triangles in the order of RayCast's own leaves, where neighbours lie
//! together; above them each box holds the next two below. Boxes are tested in double precision with
//! their far ends moved out (Ize, "Robust BVH Ray Traversal", JCGT 2013).

use super::one_ray::{OneRay, OwnRay};
use super::triangle::{ClosestHit, TriangleTest};
use super::vector::Vector;
use raycast_core::glam::{DVec3, Vec3};
use raycast_core::{Accel, PrimitiveHit};

/// Triangles in a leaf.
const RUN: usize = 4;

/// More than two roundings can take from a distance along a ray: (1 + 2⁻⁵³)³ and its inverse, for
/// the difference, the inverse direction and the product, on both ends.
const OUTWARDS: f64 = 1.0 + 8.0 * f64::EPSILON;

/// Levels that 2³² triangles can have.
const DEPTH: usize = 40;

pub(super) struct Boxes<T> {
    /// In the order of the primitive indices.
    triangles: Vec<T>,
    /// Lowest and highest coordinates, from the leaves up to the root.
    levels: Vec<Vec<[Vec3; 2]>>,
}

impl<T: TriangleTest> Boxes<T> {
    pub(super) fn new(accel: &Accel) -> Self {
        let corners: Vec<[Vec3; 3]> = (0..accel.len() as u32).map(|s| accel.corners(s)).collect();
        let join = |a: [Vec3; 2], b: [Vec3; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        let empty = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let around = |run: &[[Vec3; 3]]| {
            let corners = run.iter().flatten();
            corners.fold(empty, |all, &corner| join(all, [corner; 2]))
        };
        let mut levels = vec![corners.chunks(RUN).map(around).collect::<Vec<_>>()];
        while let Some(below) = levels.last().filter(|level| level.len() > 1) {
            let above = below
                .chunks(2)
                .map(|pair| pair.iter().copied().fold(empty, join));
            let above = above.collect();
            levels.push(above);
        }
        let prepare = |corners: [Vec3; 3]| T::new(corners.map(T::V::corner));
        Self {
            triangles: corners.into_iter().map(prepare).collect(),
            levels,
        }
    }
}

impl<T: TriangleTest> OneRay for Boxes<T> {
    type V = T::V;

    fn nearest(&self, ray: &OwnRay<T::V>) -> PrimitiveHit {
        let mut nearest = ClosestHit::none(ray);
        let prepared = T::prepare(ray);
        let origin = ray.origin.to_double();
        let inverse = ray.direction.to_double().recip();
        let mut stack = [(0u8, 0u32, 0.0f64); DEPTH];
        let mut depth = 0;
        let top = self.levels.len() - 1;
        if let Some([low, high]) = self.levels[top].first()
            && let Some(near) = enter(origin, inverse, *low, *high)
        {
            stack[0] = (top as u8, 0, near);
            depth = 1;
        }
        while depth > 0 {
            depth -= 1;
            let (level, index, near) = stack[depth];
            if near > nearest.limit() {
                continue;
            }
            if level == 0 {
                let first = index as usize * RUN;
                for primitive in first..(first + RUN).min(self.triangles.len()) {
                    nearest.offer(
                        primitive as u32,
                        self.triangles[primitive].intersect(&prepared),
                    );
                }
                continue;
            }
            let below = &self.levels[usize::from(level) - 1];
            let child = |index: u32| {
                let [low, high] = *below.get(index as usize)?;
                enter(origin, inverse, low, high).map(|near| (level - 1, index, near))
            };
            let (a, b) = (child(2 * index), child(2 * index + 1));
            let (first, second) = match (a, b) {
                (Some(a), Some(b)) if b.2 < a.2 => (Some(b), Some(a)),
                nearer_first => nearer_first,
            };
            for entry in [second, first].into_iter().flatten() {
                stack[depth] = entry;
                depth += 1;
            }
        }
        nearest.to_primitive_hit()
    }
}

/// Where the line enters a box (no later than it truly does), if it may touch it, before the origin or behind.
#[inline(always)]
fn enter(origin: DVec3, inverse: DVec3, low: Vec3, high: Vec3) -> Option<f64> {
    let to_low = (low.as_dvec3() - origin) * inverse;
    let to_high = (high.as_dvec3() - origin) * inverse;
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        // A ray in a face's plane gives 0 · ∞: no number, and no limit.
        let (a, b) = (to_low[axis], to_high[axis]);
        if !(a.is_nan() || b.is_nan()) {
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
    }
    let near = near - near.abs() * (OUTWARDS - 1.0);
    let far = far + far.abs() * (OUTWARDS - 1.0);
    (near <= far).then_some(near)
}
