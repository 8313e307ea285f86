//! Triangles that lie in exactly one plane: decided once a pair, for every ray that hits both.
//!
//! A ray's line crosses a plane in one point, so it hits all triangles of the plane at one distance, and the lowest
//! primitive id is the closest hit.

use super::componentwise::is_off_plane;
use super::exact::lies_in_plane;
use crate::hit::MISS;
use glam::Vec3;

/// Pairs of triangles in the cache: 12 kB, beside the packet in the first-level cache. Pairs with the same hash evict
/// one another: fewer entries decide pairs again, more push the packet out.
const CACHED: usize = 1024;

/// Whether two triangles lie in exactly one plane. Neither must be degenerate.
pub(super) fn are_coplanar(a: [Vec3; 3], b: [Vec3; 3]) -> bool {
    let in_plane_of_axis = |axis: usize| {
        let mut all = a.iter().chain(&b).map(|corner| corner[axis]);
        all.all(|coordinate| coordinate == a[0][axis])
    };
    if in_plane_of_axis(0) || in_plane_of_axis(1) || in_plane_of_axis(2) {
        return true;
    }
    let sure = b.map(|corner| is_off_plane(corner, a));
    if sure.contains(&Some(true)) {
        return false;
    }
    let mut corners = b.into_iter().zip(sure);
    corners.all(|(corner, sure)| sure == Some(false) || lies_in_plane(corner.as_dvec3(), a))
}

/// A cache of pairs of triangles, and whether each pair lies in one plane.
#[derive(Debug)]
pub(crate) struct Coplanar {
    /// Pairs of primitive indices, the lower first, and whether each is coplanar.
    decided: Vec<([u32; 2], bool)>,
}

impl Coplanar {
    pub(crate) fn new() -> Self {
        Self {
            decided: Vec::new(),
        }
    }

    /// Whether two triangles lie in exactly one plane; `corners` gives those of a primitive index.
    pub(crate) fn are(&mut self, a: u32, b: u32, corners: impl Fn(u32) -> [Vec3; 3]) -> bool {
        // Allocated on first use, since most pictures need no cache.
        if self.decided.is_empty() {
            self.decided.resize(CACHED, ([MISS; 2], false));
        }
        let pair = [a.min(b), a.max(b)];
        // Multiplying by an odd constant spreads neighbouring indices (Knuth, "The Art of Computer Programming",
        // 6.4).
        let hash = pair[0].wrapping_mul(0x9e37_79b1) ^ pair[1].wrapping_mul(0x85eb_ca6b);
        let decided = &mut self.decided[(hash >> 22) as usize % CACHED];
        if decided.0 != pair {
            *decided = (pair, are_coplanar(corners(a), corners(b)));
        }
        decided.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Planes through integer points scaled by powers of two; corners on them or a rounding away. The truth is by
    /// construction: a corner that moves along an axis which the plane is not parallel to leaves the plane.
    #[test]
    fn one_plane_and_two_a_rounding_apart_are_distinguished() {
        let mut random = Random(31);
        for round in 0..2000usize {
            let whole = |random: &mut Random, most: f64| (random.signed() * most).round();
            let vector = |random: &mut Random| [(); 3].map(|()| whole(random, 60.0) as f32);
            let (origin, u, v) = (
                vector(&mut random),
                vector(&mut random),
                vector(&mut random),
            );
            let [origin, u, v] = [origin, u, v].map(Vec3::from_array);
            let normal = u.as_dvec3().cross(v.as_dvec3());
            if normal == glam::DVec3::ZERO {
                continue;
            }
            // Up to exponents at which 128-bit integers overflow.
            let scale = crate::math::pow(2.0, (round % 40) as f64) as f32;
            let mut corner = |far: f32| {
                let [s, t] = [(); 2].map(|()| whole(&mut random, 50.0) as f32);
                (origin + u * s + v * t) * far
            };
            let (a, mut b) = (
                [corner(1.0), corner(1.0), corner(1.0)],
                [corner(1.0), corner(1.0), corner(1.0)],
            );
            assert!(are_coplanar(a, b), "{a:?} {b:?}");
            let through_zero = [u * scale, v, u + v];
            assert!(are_coplanar(through_zero, [v * scale, u, u - v]));
            let axis = (0..3).find(|&axis| normal[axis] != 0.0).unwrap_or(0);
            b[round % 3][axis] = b[round % 3][axis].next_up();
            let spanned = (a[1] - a[0]).as_dvec3().cross((a[2] - a[0]).as_dvec3());
            if spanned != glam::DVec3::ZERO {
                assert!(!are_coplanar(a, b), "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn decisions_are_cached_by_pair() {
        let corners = |primitive: u32| {
            let height = (primitive % 3) as f32;
            [Vec3::X, Vec3::Y, Vec3::ONE].map(|corner| corner.with_z(height + corner.x))
        };
        let mut coplanar = Coplanar::new();
        for _ in 0..2 {
            for a in 0..80 {
                for b in 0..80 {
                    assert_eq!(coplanar.are(a, b, corners), a % 3 == b % 3, "{a} {b}");
                }
            }
        }
    }
}
