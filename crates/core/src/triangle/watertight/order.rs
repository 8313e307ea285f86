//! Which of two hits of a ray comes first, where their errors overlap.

use super::{PreparedRay, Verdict};
use crate::hit::Precision;
use crate::triangle::BoundedHit;
use crate::triangle::coplanar::are_coplanar;
use crate::triangle::exact;
use crate::triangle::plane::Plane;
use glam::Vec3;
use std::cmp::Ordering;

impl PreparedRay {
    /// Which of two hits comes first along the ray; of two at one distance, the lower primitive id.
    pub(crate) fn order(
        &self,
        first: &BoundedHit,
        second: &BoundedHit,
        corners: impl Fn(u32) -> [Vec3; 3],
        id: impl Fn(u32) -> u32,
    ) -> Ordering {
        if first.is_surely_before(second) {
            return Ordering::Less;
        }
        if second.is_surely_before(first) {
            return Ordering::Greater;
        }
        let by_id = || id(first.primitive).cmp(&id(second.primitive));
        self.compare(first, second, corners).then_with(by_id)
    }

    /// Which of two hits is nearer, where their errors overlap.
    pub(super) fn compare(
        &self,
        candidate: &BoundedHit,
        nearest: &BoundedHit,
        corners: impl Fn(u32) -> [Vec3; 3],
    ) -> Ordering {
        if self.precision == Precision::Fast {
            return candidate.t.total_cmp(&nearest.t);
        }
        if same_corners(corners(candidate.primitive), corners(nearest.primitive)) {
            return Ordering::Equal;
        }
        let [first, second] =
            [candidate, nearest].map(|hit| (hit.primitive, corners(hit.primitive)));
        if let Some(order) = self.compare_by_planes(candidate, nearest, first.1, second.1) {
            return order;
        }
        let closely =
            [first, second].map(|(primitive, at)| self.intersect_componentwise(primitive, at));
        if let Some(order) = order_of(closely) {
            return order;
        }
        if are_coplanar(first.1, second.1) {
            self.was_exact.set(true);
            return Ordering::Equal;
        }
        let more =
            [first, second].map(|(primitive, at)| self.intersect_in_double_double(primitive, at));
        if let Some(order) = order_of(more) {
            return order;
        }
        self.was_exact.set(true);
        let [candidate, nearest] =
            [candidate, nearest].map(|hit| self.placed(corners(hit.primitive)));
        // Both are known to be hits.
        exact::compare(&self.ray, &candidate, &nearest, self.cull).unwrap_or(Ordering::Greater)
    }

    /// Which of two hits is nearer, by the plane of either triangle and the corners of the other; `None` where that is
    /// not sure.
    fn compare_by_planes(
        &self,
        candidate: &BoundedHit,
        nearest: &BoundedHit,
        first: [Vec3; 3],
        second: [Vec3; 3],
    ) -> Option<Ordering> {
        let behind = |hit: &BoundedHit, corners: [Vec3; 3], of: [Vec3; 3]| {
            let plane = Plane::new(of).turned_along(self.ray.direction, 0.0)?;
            Some(plane.side_of(hit, corners)? > 0.0)
        };
        match behind(candidate, first, second) {
            Some(true) => Some(Ordering::Greater),
            Some(false) => Some(Ordering::Less),
            None => match behind(nearest, second, first)? {
                true => Some(Ordering::Less),
                false => Some(Ordering::Greater),
            },
        }
    }
}

/// Which of two hits is surely nearer; `None` where their intervals overlap.
fn order_of(verdicts: [Verdict; 2]) -> Option<Ordering> {
    let [Verdict::Hit(a), Verdict::Hit(b)] = verdicts else {
        return None;
    };
    if a.is_surely_before(&b) {
        Some(Ordering::Less)
    } else if b.is_surely_before(&a) {
        Some(Ordering::Greater)
    } else {
        None
    }
}

/// Whether two triangles have the same corners, in any order.
fn same_corners(a: [Vec3; 3], b: [Vec3; 3]) -> bool {
    a.iter().all(|p| b.contains(p)) && b.iter().all(|p| a.contains(p))
}
