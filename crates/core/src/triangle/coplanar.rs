//! Triangles that lie in exactly one plane: decided once for every ray that hits both.
//!
//! A ray's line crosses a plane in one point, so it hits all triangles of the plane at one distance, and the lowest
//! primitive id is the closest hit.

use super::componentwise::is_off_plane;
use super::exact::lies_in_plane;
use crate::hit::MISS;
use glam::Vec3;

/// The most triangles in the cache, 128 kB, allocated where triangles may share a plane. Triangles whose indices have the
/// same low bits evict one another, and are compared again: with a quarter, casting 12,000 triangles of one plane
/// took nearly twice as long. With more it would fill a core's second-level cache.
const CACHED: usize = 1 << 14;

/// Whether two triangles lie in exactly one plane. Neither must be degenerate.
pub(crate) fn are_coplanar(a: [Vec3; 3], b: [Vec3; 3]) -> bool {
    if share_plane_of_axis(a, b) {
        return true;
    }
    let sure = b.map(|corner| is_off_plane(corner, a));
    if sure.contains(&Some(true)) {
        return false;
    }
    let mut corners = b.into_iter().zip(sure);
    corners.all(|(corner, sure)| sure == Some(false) || lies_in_plane(corner.as_dvec3(), a))
}

/// Whether two triangles lie in one plane perpendicular to an axis.
pub(crate) fn share_plane_of_axis(a: [Vec3; 3], b: [Vec3; 3]) -> bool {
    // Named one by one: chained iterators took a tenth of the time of casting thousands of triangles of one plane.
    let in_plane_of_axis = |axis: usize| {
        let level = a[0][axis];
        let is_of_a = (a[1][axis] == level) & (a[2][axis] == level);
        is_of_a & (b[0][axis] == level) & (b[1][axis] == level) & (b[2][axis] == level)
    };
    in_plane_of_axis(0) || in_plane_of_axis(1) || in_plane_of_axis(2)
}

/// Triangles that are known to share a plane with another.
#[derive(Debug)]
pub(crate) struct Coplanar {
    /// A primitive index, and that of a triangle in the same plane: the same one for all that were found to share it.
    planes: Vec<[u32; 2]>,
    /// The entries of the cache, a power of two.
    entries: usize,
}

impl Coplanar {
    /// For a tree of so many triangles.
    pub(crate) fn new(triangles: usize) -> Self {
        Self {
            planes: Vec::new(),
            entries: triangles.clamp(1, CACHED).next_power_of_two(),
        }
    }

    /// Whether two triangles lie in one plane; `corners` gives those of a primitive index. Neither must be degenerate.
    pub(crate) fn are(&mut self, a: u32, b: u32, corners: impl Fn(u32) -> [Vec3; 3]) -> bool {
        if self.are_known(a, b) {
            return true;
        }
        let are_coplanar = are_coplanar(corners(a), corners(b));
        if are_coplanar {
            self.join(a, b);
        }
        are_coplanar
    }

    /// Records that two triangles lie in one plane.
    pub(crate) fn join(&mut self, a: u32, b: u32) {
        if self.planes.is_empty() {
            self.planes.resize(self.entries, [MISS; 2]);
        }
        let plane = self.plane_of(a);
        for triangle in [a, b] {
            let entry = self.entry(triangle);
            self.planes[entry] = [triangle, plane];
        }
    }

    /// Whether two triangles were found to lie in one plane before.
    pub(crate) fn are_known(&self, a: u32, b: u32) -> bool {
        !self.planes.is_empty() && self.plane_of(a) == self.plane_of(b)
    }

    /// A triangle of the same plane.
    fn plane_of(&self, triangle: u32) -> u32 {
        let [known, plane] = self.planes[self.entry(triangle)];
        if known == triangle { plane } else { triangle }
    }

    /// A tree's neighbours have neighbouring indices.
    fn entry(&self, triangle: u32) -> usize {
        triangle as usize & (self.entries - 1)
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
    fn planes_are_distinguished_through_others() {
        let corners = |primitive: u32| {
            let height = (primitive % 3) as f32;
            [Vec3::X, Vec3::Y, Vec3::ONE].map(|corner| corner.with_z(height + corner.x))
        };
        let mut coplanar = Coplanar::new(4 * CACHED);
        for _ in 0..2 {
            // More than the cache holds, so that entries evict one another.
            for a in 0..2 * CACHED as u32 {
                for b in [a + 1, a + 3, a / 2, a / 7 * 3] {
                    assert_eq!(coplanar.are(a, b, corners), a % 3 == b % 3, "{a} {b}");
                }
            }
        }
    }
}
