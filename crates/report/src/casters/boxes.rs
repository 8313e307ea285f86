//! A simple binary BVH whose box tests lose no ray, so that every error is the triangle test's.
//!
//! Leaves are runs of [`LEAF_SIZE`] triangles in RayCast's leaf order, in which neighbours are close in space; each box
//! above contains the next two boxes below. Boxes are tested in double precision with conservative rounding (Ize,
//! "Robust BVH Ray Traversal", JCGT 2013).

use super::one_ray::{CasterRay, SingleRay};
use super::triangle::{ClosestHit, TriangleTest};
use super::vector::Vector;
use raycast_core::glam::{DVec3, Vec3};
use raycast_core::{Accel, PrimitiveHit};

/// Triangles of a leaf.
const LEAF_SIZE: usize = 4;

/// Factor by which both ends of a box's interval are moved apart. Each end has three roundings (difference,
/// reciprocal, product), so it is off by a factor of at most (1 + 2⁻⁵³)³ or its inverse. With a smaller factor rays
/// could pass between boxes.
const WIDENING: f64 = 1.0 + 8.0 * f64::EPSILON;

/// Stack size: more than the levels of a binary tree over 2³² triangles in leaves of [`LEAF_SIZE`].
const STACK_SIZE: usize = 40;

pub(super) struct Boxes<T> {
    /// In leaf order.
    triangles: Vec<T>,
    /// Minimum and maximum of each box, level by level from the leaves to the root.
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
        let mut levels = vec![corners.chunks(LEAF_SIZE).map(around).collect::<Vec<_>>()];
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

impl<T: TriangleTest> SingleRay for Boxes<T> {
    type V = T::V;

    fn nearest(&self, ray: &CasterRay<T::V>) -> PrimitiveHit {
        let mut nearest = ClosestHit::none(ray);
        let prepared = T::prepare(ray);
        let origin = ray.origin.to_double();
        let inverse = ray.direction.to_double().recip();
        let mut stack = [(0u8, 0u32, 0.0f64); STACK_SIZE];
        let mut depth = 0;
        let top = self.levels.len() - 1;
        if let Some([low, high]) = self.levels[top].first()
            && let Some(near) = enter_box(origin, inverse, *low, *high)
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
                let first = index as usize * LEAF_SIZE;
                for primitive in first..(first + LEAF_SIZE).min(self.triangles.len()) {
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
                enter_box(origin, inverse, low, high).map(|near| (level - 1, index, near))
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

/// A lower bound of the parameter at which the line enters a box; `None` if it misses the box. Negative if it does
/// so behind the origin.
#[inline(always)]
fn enter_box(origin: DVec3, inverse: DVec3, low: Vec3, high: Vec3) -> Option<f64> {
    let to_low = (low.as_dvec3() - origin) * inverse;
    let to_high = (high.as_dvec3() - origin) * inverse;
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        // A ray in the plane of a face gives 0 · ∞ = NaN: that axis does not limit the interval.
        let (a, b) = (to_low[axis], to_high[axis]);
        if !(a.is_nan() || b.is_nan()) {
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
    }
    let near = near - near.abs() * (WIDENING - 1.0);
    let far = far + far.abs() * (WIDENING - 1.0);
    (near <= far).then_some(near)
}
