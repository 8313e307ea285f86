//! Brute force: every triangle for every ray.

use super::one_ray::{OneRay, OwnRay};
use super::triangle::{Nearest, TriangleTest};
use super::vector::Vector;
use raycast_core::accel::{Accel, SlotHit};

/// Triangles in the order of their numbers: of equal distances the lowest number is met.
pub(super) struct List<T> {
    triangles: Vec<(T, u32)>,
}

impl<T: TriangleTest> List<T> {
    pub(super) fn new(accel: &Accel) -> Self {
        let mut slots: Vec<u32> = (0..accel.len() as u32).collect();
        slots.sort_by_key(|&slot| accel.identify(slot));
        let prepare = |slot| (T::new(accel.corners(slot).map(T::V::corner)), slot);
        Self {
            triangles: slots.into_iter().map(prepare).collect(),
        }
    }
}

impl<T: TriangleTest> OneRay for List<T> {
    type V = T::V;

    fn tries(&self) -> usize {
        self.triangles.len()
    }

    fn nearest(&self, ray: &OwnRay<T::V>) -> SlotHit {
        let mut nearest = Nearest::none(ray);
        let ray = T::prepare(ray);
        for (triangle, slot) in &self.triangles {
            nearest.offer(*slot, triangle.meet(&ray));
        }
        nearest.to_slot_hit()
    }
}
