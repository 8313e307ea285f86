//! Welding: equal corners become one vertex, numbered by first occurrence.

use crate::num::simd::prefetch;
use glam::DVec3;
use rayon::prelude::*;
use std::hash::{BuildHasher, RandomState};
use std::ops::Range;

/// A set of distinct vertices.
#[derive(Debug)]
pub(super) struct Vertices {
    positions: Vec<DVec3>,
    /// A hash table with linear probing (Knuth, "The Art of Computer Programming", volume 3, 1973): the upper half of
    /// a vertex's hash, and its number; [`EMPTY`] where there is none. The length is a power of two.
    slots: Vec<u64>,
    /// Recently used vertices, indexed by their hashes' lower bits: most corners are found here, in a few pages of
    /// memory that stay in the cache.
    recent: Vec<u32>,
    /// Random for each table, so that no file can be made whose corners all collide. Results do not depend on it.
    seeds: [u64; 3],
}

const EMPTY: u64 = u64::MAX;

/// The length of `recent`: twice the vertices of two rows of a mesh of some millions of triangles. A power of two.
const RECENT: usize = 1 << 13;

/// Vertices that are looked up together. More fill the first-level cache, fewer leave memory idle.
const BLOCK: usize = 96;

impl Vertices {
    /// An empty set with room for `vertices` vertices.
    pub(super) fn with_capacity(vertices: usize) -> Self {
        let random = RandomState::new();
        Self {
            positions: Vec::with_capacity(vertices),
            slots: vec![EMPTY; (vertices + vertices / 2).next_power_of_two().max(4)],
            recent: vec![u32::MAX; RECENT],
            seeds: [0, 1, 2].map(|number: u64| random.hash_one(number)),
        }
    }

    /// The number of the vertex at a position, minus zero being zero; a new vertex if there is none.
    #[inline]
    pub(super) fn number(&mut self, position: DVec3) -> u32 {
        let (position, hash) = self.hashed(position);
        self.number_with_hash(position, hash)
    }

    /// The numbers of many vertices, in order.
    fn numbers(&mut self, positions: &[DVec3], numbers: &mut Vec<u32>) {
        numbers.clear();
        let mut hashed = [(DVec3::ZERO, 0, None); BLOCK];
        for block in positions.chunks(BLOCK) {
            for (hashed, position) in hashed.iter_mut().zip(block) {
                let (position, hash) = self.hashed(*position);
                let recent = self.recent(position, hash);
                if recent.is_none() {
                    prefetch(&self.slots, first_slot(hash, self.slots.len()));
                }
                *hashed = (position, hash, recent);
            }
            let block = &hashed[..block.len()];
            let number = |&(position, hash, recent): &(DVec3, u64, Option<u32>)| {
                recent.unwrap_or_else(|| self.number_with_hash(position, hash))
            };
            numbers.extend(block.iter().map(number));
        }
    }

    /// The number of a vertex that was used recently.
    #[inline]
    fn recent(&self, position: DVec3, hash: u64) -> Option<u32> {
        let recent = self.recent[hash as usize % RECENT];
        let known = self.positions.get(recent as usize);
        known
            .is_some_and(|known| bits(*known) == bits(position))
            .then_some(recent)
    }

    /// Appends those of other vertices, all distinct, that are not among these, and answers the numbers of all; the set
    /// is of no use afterwards.
    fn append(&mut self, others: &[DVec3]) -> Vec<u32> {
        let mut numbers = vec![u32::MAX; others.len()];
        let tasks = numbers
            .par_chunks_mut(MIN_TASK)
            .zip(others.par_chunks(MIN_TASK));
        tasks.for_each(|(numbers, others)| self.find_all(others, numbers));
        self.positions.reserve_exact(others.len());
        for (number, position) in numbers.iter_mut().zip(others) {
            if *number == u32::MAX {
                *number = self.positions.len() as u32;
                self.positions.push(*position);
            }
        }
        numbers
    }

    /// The numbers of those of some vertices that are in the set.
    fn find_all(&self, positions: &[DVec3], numbers: &mut [u32]) {
        let mut hashes = [0; BLOCK];
        for (positions, numbers) in positions.chunks(BLOCK).zip(numbers.chunks_mut(BLOCK)) {
            for (hash, position) in hashes.iter_mut().zip(positions) {
                *hash = self.hash(bits(*position));
                prefetch(&self.slots, first_slot(*hash, self.slots.len()));
            }
            for ((number, position), &hash) in numbers.iter_mut().zip(positions).zip(&hashes) {
                if let Ok(found) = self.find(bits(*position), hash) {
                    *number = found;
                }
            }
        }
    }

    /// A position without minus zeros, and its hash.
    #[inline]
    fn hashed(&self, position: DVec3) -> (DVec3, u64) {
        // Adding zero makes minus zero positive.
        let position = position + DVec3::ZERO;
        (position, self.hash(bits(position)))
    }

    #[inline]
    fn number_with_hash(&mut self, position: DVec3, hash: u64) -> u32 {
        if let Some(recent) = self.recent(position, hash) {
            return recent;
        }
        let number = self.look_up(position, bits(position), hash);
        self.recent[hash as usize % RECENT] = number;
        number
    }

    /// The number of the vertex with this key, or the slot where it is to be entered.
    #[inline]
    fn find(&self, key: [u64; 3], hash: u64) -> Result<u32, usize> {
        let mask = self.slots.len() - 1;
        let mut slot = first_slot(hash, self.slots.len());
        loop {
            let entry = self.slots[slot];
            if entry == EMPTY {
                return Err(slot);
            }
            // Compares positions only where hashes are equal, since positions lie elsewhere in memory.
            let number = entry as u32;
            if (entry ^ hash) >> 32 == 0 && bits(self.positions[number as usize]) == key {
                return Ok(number);
            }
            slot = (slot + 1) & mask;
        }
    }

    fn look_up(&mut self, position: DVec3, key: [u64; 3], hash: u64) -> u32 {
        let slot = match self.find(key, hash) {
            Ok(number) => return number,
            Err(slot) => slot,
        };
        let number = self.positions.len() as u32;
        self.slots[slot] = entry(hash, number);
        self.positions.push(position);
        if self.positions.len() > self.slots.len() / 4 * 3 {
            self.grow();
        }
        number
    }

    /// The vertices by number.
    pub(super) fn into_positions(self) -> Vec<DVec3> {
        self.positions
    }

    /// The number of vertices.
    pub(super) fn len(&self) -> usize {
        self.positions.len()
    }

    #[cold]
    fn grow(&mut self) {
        let count = 2 * self.slots.len();
        let mut slots = vec![EMPTY; count];
        for &entry in self.slots.iter().filter(|entry| **entry != EMPTY) {
            let mut slot = first_slot(entry, count);
            while slots[slot] != EMPTY {
                slot = (slot + 1) & (count - 1);
            }
            slots[slot] = entry;
        }
        self.slots = slots;
    }

    /// Folded multiplication (Wang Yi, "wyhash", 2019).
    #[inline]
    fn hash(&self, [x, y, z]: [u64; 3]) -> u64 {
        let fold = |a: u64, b: u64| {
            let product = u128::from(a) * u128::from(b);
            (product as u64) ^ (product >> 64) as u64
        };
        let [a, b, c] = self.seeds;
        fold(fold(x ^ a, y ^ b) ^ z, c | 1)
    }
}

/// The first slot to probe, by the upper half of a hash; at most 2³² slots.
#[inline]
fn first_slot(hash: u64, slots: usize) -> usize {
    ((hash >> 32) as usize) >> (32 - slots.trailing_zeros())
}

#[inline]
fn entry(hash: u64, number: u32) -> u64 {
    hash >> 32 << 32 | u64::from(number)
}

fn bits(position: DVec3) -> [u64; 3] {
    position.to_array().map(f64::to_bits)
}

/// The least number of triangles in one parallel task.
const MIN_TASK: usize = 1 << 12;

/// Welds `count` triangles; returns vertices and triangles. Each thread makes itself a `reader` that appends the corners of
/// a range of triangles to a list. `progress` is called, from any thread, with the number of triangles that are done.
///
/// Halves are welded in parallel, and the second half's vertices are then looked up among the first's, in parallel too where
/// no others follow: the order of vertices is that of welding sequentially.
///
/// # Errors
/// Those of reading.
pub(super) fn weld<Read, Error>(
    count: usize,
    reader: &(impl Fn() -> Read + Sync),
    progress: &(impl Fn(usize) + Sync),
) -> Result<(Vec<DVec3>, Vec<[u32; 3]>), Error>
where
    Read: FnMut(Range<usize>, &mut Vec<DVec3>) -> Result<(), Error>,
    Error: Send,
{
    let mut triangles = vec![[0; 3]; count];
    let leaf = count.div_ceil(rayon::current_num_threads()).max(MIN_TASK);
    let part = Part {
        leaf,
        reader,
        progress,
    };
    let vertices = part.weld(0, &mut triangles, true)?;
    Ok((vertices.into_positions(), triangles))
}

struct Part<'a, R, P> {
    leaf: usize,
    reader: &'a R,
    progress: &'a P,
}

impl<R: Sync, P: Fn(usize) + Sync> Part<'_, R, P> {
    /// `are_all` says that nothing else will be welded to these.
    fn weld<Read, Error>(
        &self,
        first: usize,
        triangles: &mut [[u32; 3]],
        are_all: bool,
    ) -> Result<Vertices, Error>
    where
        R: Fn() -> Read,
        Read: FnMut(Range<usize>, &mut Vec<DVec3>) -> Result<(), Error>,
        Error: Send,
    {
        if triangles.len() <= self.leaf {
            // A closed mesh has half as many vertices as triangles, and a part of one has some more.
            let mut vertices = Vertices::with_capacity(triangles.len() / 8 * 5 + 2);
            let (mut corners, mut numbers) = (Vec::new(), Vec::new());
            let (mut read, mut first) = ((self.reader)(), first);
            for triangles in triangles.chunks_mut(MIN_TASK) {
                corners.clear();
                read(first..first + triangles.len(), &mut corners)?;
                vertices.numbers(&corners, &mut numbers);
                triangles.as_flattened_mut().copy_from_slice(&numbers);
                (self.progress)(triangles.len());
                first += triangles.len();
            }
            return Ok(vertices);
        }
        let half = triangles.len() / 2;
        let (left, right) = triangles.split_at_mut(half);
        let (vertices, others) = rayon::join(
            || self.weld(first, left, false),
            || self.weld(first + half, right, false),
        );
        let (mut vertices, others) = (vertices?, others?.into_positions());
        let numbers = if are_all {
            vertices.append(&others)
        } else {
            let mut numbers = Vec::new();
            vertices.numbers(&others, &mut numbers);
            numbers
        };
        right
            .par_iter_mut()
            .with_min_len(MIN_TASK)
            .for_each(|triangle| *triangle = triangle.map(|other| numbers[other as usize]));
        Ok(vertices)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use std::collections::HashMap;

    #[test]
    fn vertices_are_in_the_order_of_sequential_welding() {
        let mut random = Random(7);
        // Few positions, so that most corners coincide with others.
        let mut coordinate = || (random.unit() * 200.0).floor() * 0.5 - 50.0;
        let corners: Vec<[DVec3; 3]> = (0..8 * MIN_TASK)
            .map(|_| [0; 3].map(|_| DVec3::new(coordinate(), coordinate(), -0.0)))
            .collect();
        // One part, two, and eight.
        let welded = [1, 2, 5].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.expect("threads can be started");
            let reader = || {
                |range: Range<usize>, to: &mut Vec<DVec3>| {
                    to.extend(corners[range].as_flattened());
                    Ok::<(), ()>(())
                }
            };
            pool.install(|| weld(corners.len(), &reader, &|_| ()))
        });
        assert!(welded[0] == welded[1] && welded[0] == welded[2]);
        let [Ok((positions, triangles)), ..] = welded else {
            panic!("nothing failed");
        };
        let mut numbers = HashMap::new();
        let mut expected = Vec::new();
        for corner in corners.iter().flatten() {
            let key = (*corner + DVec3::ZERO).to_array().map(f64::to_bits);
            let next = numbers.len() as u32;
            expected.push(*numbers.entry(key).or_insert(next));
        }
        assert_eq!(triangles.as_flattened(), expected);
        assert_eq!(positions.len(), numbers.len());
        for (corners, triangle) in corners.iter().zip(&triangles) {
            assert_eq!(*corners, triangle.map(|i| positions[i as usize]));
        }
        assert!(positions.iter().all(|p| p.z.is_sign_positive()));
    }

    #[test]
    fn nan_corners_equal_themselves() {
        let mut vertices = Vertices::with_capacity(0);
        let nan = DVec3::NAN;
        assert_eq!([nan, DVec3::X, nan].map(|p| vertices.number(p)), [0, 1, 0]);
        assert_eq!(vertices.len(), 2);
    }
}
