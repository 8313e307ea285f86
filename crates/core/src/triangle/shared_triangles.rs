//! What the rays of one lattice share of triangles: of those that one eye sees, and of pairs of which a ray hits both.

use super::exact;
use super::eye_triangle::{EyeTriangle, EyeTriangles};
use glam::Vec3;
use std::cell::RefCell;

/// Pairs in the cache, 160 kB, allocated when the first is asked for. With fewer, the pairs that a row of rays hits
/// evict one another; with more, entries that are not asked for again fill the second-level cache.
const CACHED: usize = 4096;

/// What rays share of triangles. Nothing depends on it but the time that is taken.
#[derive(Debug)]
pub(crate) struct SharedTriangles {
    from_eye: Option<EyeTriangles>,
    /// Exact distances of a triangle's corners from another's plane, with the primitive indices of both, by a sum of
    /// these.
    distances: RefCell<Vec<([u32; 2], [f64; 3])>>,
}

impl SharedTriangles {
    /// For rays that all start at one eye, or for others.
    pub(crate) fn new(have_eye: bool) -> Self {
        Self {
            from_eye: have_eye.then(EyeTriangles::default),
            distances: RefCell::default(),
        }
    }

    /// Whether the rays all start at one eye.
    pub(super) fn have_eye(&self) -> bool {
        self.from_eye.is_some()
    }

    /// Calls a function with what the rays share of the triangle of this primitive index as their eye sees it.
    pub(super) fn with<T>(&self, primitive: u32, function: impl FnOnce(&EyeTriangle) -> T) -> T {
        match &self.from_eye {
            Some(from_eye) => from_eye.with(primitive, function),
            None => function(&EyeTriangle::default()),
        }
    }

    /// [`exact::distances_from_plane`] of two triangles, each given by its primitive index and its corners.
    pub(super) fn distances_from_plane(
        &self,
        (triangle, points): (u32, [Vec3; 3]),
        (plane, corners): (u32, [Vec3; 3]),
    ) -> [f64; 3] {
        let Ok(mut cached) = self.distances.try_borrow_mut() else {
            return exact::distances_from_plane(points, corners);
        };
        if cached.is_empty() {
            cached.resize(CACHED, ([u32::MAX; 2], [0.0; 3]));
        }
        let of = [triangle, plane];
        // Multiplied, so that neighbours of two triangles that are neighbours have entries of their own.
        let entry = triangle.wrapping_mul(61).wrapping_add(plane) as usize % CACHED;
        let known = &mut cached[entry];
        if known.0 != of {
            *known = (of, exact::distances_from_plane(points, corners));
        }
        known.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_of_one_entry_are_told_apart() {
        let triangle = |z: f32| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| corner + Vec3::Z * z);
        let shared = SharedTriangles::new(false);
        let distances = |pair: [u32; 2], z: f32| {
            shared.distances_from_plane((pair[0], triangle(z)), (pair[1], triangle(0.0)))
        };
        assert_eq!(distances([1, 2], 1.0), [1.0; 3]);
        // What is known is kept, until another pair takes its place.
        assert_eq!(distances([1, 2], 2.0), [1.0; 3]);
        assert_eq!(distances([1, 2 + CACHED as u32], 3.0), [3.0; 3]);
        assert_eq!(distances([2, 1], 4.0), [4.0; 3]);
        assert_eq!(distances([1, 2], 2.0), [2.0; 3]);
    }
}
