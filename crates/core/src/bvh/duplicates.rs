//! Duplicate triangles: triangles that coincide with another one in the same winding order. No ray hits them first.

use super::corner_hash::bits;
use super::flatten::World;
use crate::num::simd::prefetch;
use rayon::prelude::*;
use std::collections::HashSet;
use std::sync::atomic::{AtomicU64, Ordering};

/// Bits of the first hash filter for each triangle. About one in so many triangles without a copy shares its bit with
/// another one: with fewer bits the second filter has more hashes, with more the first takes more memory.
const BITS_EACH: usize = 32;

/// Bits of the second hash filter for each hash in it. About one in so many of the other triangles shares its bit with one
/// of these, and is compared corner by corner. With more bits the filter does not fit a processor's cache.
const BITS_EACH_AGAIN: usize = 64;

/// The fewest triangles for which two threads are used: with fewer, starting a task takes longer than it saves; with
/// more, threads idle.
const TOGETHER: usize = 1 << 12;

/// Hashes whose bits are fetched from memory together. One by one, each is waited for, since setting a bit that other
/// threads set too lets nothing overtake it: that took three times as long.
const BLOCK: usize = 64;

/// The triangles that are duplicates: another triangle with a lower number has the same three corners in the same winding
/// order. `numbers` ascend; the result are indices into them, ascending.
///
/// A ray hits both at the same distance or neither, so the lowest number wins, whichever faces are culled. Deciding
/// that here saves every ray the comparison. A triangle of the other winding order is no copy, since culling
/// distinguishes the two; nor is a copy of a triangle that is not opaque, which may let rays through.
///
/// `hashes` are those of [`hash`](super::corner_hash::hash). Without duplicates this takes a few nanoseconds a triangle.
pub(super) fn duplicates(world: &World<'_>, numbers: &[u32], hashes: &[u32]) -> Vec<u32> {
    let suspects = suspects(hashes);
    let runs = suspects.chunk_by(|a, b| a.0 == b.0);
    let mut duplicates: Vec<u32> = runs
        .filter(|run| run.len() > 1)
        .flat_map(|run| {
            let mut seen = HashSet::new();
            run.iter().filter_map(move |&(_, at)| {
                let number = numbers[at as usize];
                let corners = world.triangle(number).corners;
                let corners = turned(bits(corners.map(|c| c.to_array())));
                let is_copy = seen.contains(&corners);
                if !is_copy && world.is_opaque(number) {
                    seen.insert(corners);
                }
                is_copy.then_some(at)
            })
        })
        .collect();
    duplicates.sort_unstable();
    duplicates
}

/// The corners rotated so that the least comes first, in the same winding order.
fn turned(corners: [[u32; 3]; 3]) -> [[u32; 3]; 3] {
    let [a, b, c] = corners;
    [[a, b, c], [b, c, a], [c, a, b]]
        .into_iter()
        .min()
        .unwrap_or(corners)
}

/// Hashes that occur more than once, and a few others, each with its index: equal ones together, indices ascending.
fn suspects(hashes: &[u32]) -> Vec<(u32, u32)> {
    let seen = HashFilter::with_room(hashes.len() * BITS_EACH);
    let blocks = hashes.par_chunks(BLOCK).with_min_len(TOGETHER / BLOCK);
    let again: Vec<u32> = blocks
        .flat_map_iter(|block| {
            block.iter().for_each(|&hash| seen.prefetch(hash));
            block.iter().copied().filter(|&hash| seen.insert(hash))
        })
        .collect();
    if again.is_empty() {
        return Vec::new();
    }
    // Which of several equal hashes came first depends on the threads; that there are several does not.
    let twice = HashFilter::with_room(again.len() * BITS_EACH_AGAIN);
    for &hash in &again {
        twice.insert(hash);
    }
    let all = hashes.par_iter().copied().with_min_len(TOGETHER);
    let mut suspects: Vec<(u32, u32)> = all
        .enumerate()
        .filter(|&(_, hash)| twice.may_contain(hash))
        .map(|(place, hash)| (hash, place as u32))
        .collect();
    suspects.par_sort_unstable();
    suspects
}

/// A set of hashes to which several threads add, with a bit for each (Bloom, "Space/Time Trade-offs in Hash Coding with
/// Allowable Errors", 1970).
struct HashFilter {
    bits: Vec<AtomicU64>,
}

impl HashFilter {
    /// Empty, with so many bits or up to twice as many.
    fn with_room(bits: usize) -> Self {
        let words = bits.next_power_of_two().max(64) / 64;
        Self {
            bits: (0..words).map(|_| AtomicU64::new(0)).collect(),
        }
    }

    /// A hash's word, and its bit in it.
    #[inline]
    fn place(&self, hash: u32) -> (usize, u64) {
        // The highest bits are the best mixed.
        let place = (u64::from(hash) * (64 * self.bits.len() as u64)) >> u32::BITS;
        ((place / 64) as usize, 1 << (place % 64))
    }

    #[inline]
    fn prefetch(&self, hash: u32) {
        prefetch(&self.bits, self.place(hash).0);
    }

    /// Adds a hash; returns whether it, or one with the same bit, was there before.
    #[inline]
    fn insert(&self, hash: u32) -> bool {
        let (word, bit) = self.place(hash);
        self.bits[word].fetch_or(bit, Ordering::Relaxed) & bit != 0
    }

    #[inline]
    fn may_contain(&self, hash: u32) -> bool {
        let (word, bit) = self.place(hash);
        self.bits[word].load(Ordering::Relaxed) & bit != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::scene::{Mesh, MeshData, Object, Scene};
    use glam::DVec3;
    use std::sync::Arc;

    /// The duplicates among triangles with corners at a few points.
    fn found(positions: &[DVec3], triangles: Vec<[u32; 3]>) -> Vec<u32> {
        let mesh = Mesh::new(MeshData {
            positions: positions.to_vec(),
            triangles,
            ..MeshData::default()
        });
        let scene = Scene {
            objects: vec![Object::new("mesh", Arc::new(mesh))],
        };
        let world = World::of(&scene).expect("a valid scene");
        let reachable = world.reachable();
        duplicates(&world, &reachable.numbers, &reachable.hashes)
    }

    #[test]
    fn copies_have_the_same_winding_order() {
        let [x, y, z] = DVec3::AXES;
        let positions = [DVec3::ZERO, x, y, z, -DVec3::ZERO];
        let triangles = vec![
            [0, 1, 2],
            [1, 2, 0],
            [2, 1, 0],
            [0, 1, 3],
            [1, 2, 4],
            [0, 2, 1],
            [1, 2, 3],
        ];
        assert_eq!(found(&positions, triangles), [1, 4, 5]);
    }

    #[test]
    fn exactly_the_copies_among_many_triangles_are_found() {
        let mut random = Random(9);
        for (points, triangles, least) in [(2000, 100_000, 0), (40, 100_000, 50_000)] {
            let positions: Vec<DVec3> = (0..points).map(|_| random.point()).collect();
            let mut corner = || (random.unit() * f64::from(points)) as u32;
            let triangles: Vec<[u32; 3]> = (0..triangles)
                .map(|_| [corner(), corner(), corner()])
                .filter(|[a, b, c]| a != b && b != c && c != a)
                .collect();
            let mut seen = HashSet::new();
            let turned = |[a, b, c]: [u32; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
            let expected: Vec<u32> = (0..)
                .zip(&triangles)
                .filter(|(_, triangle)| !seen.insert(turned(**triangle)))
                .map(|(place, _)| place)
                .collect();
            assert!(expected.len() >= least, "{}", expected.len());
            assert_eq!(found(&positions, triangles), expected);
        }
    }
}
