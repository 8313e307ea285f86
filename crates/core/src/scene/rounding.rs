use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// How far rounding to single precision has moved the corners of a mesh's kept triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rounding {
    /// The largest distance, in the file's units; accurate to some 15 digits.
    pub distance: f64,
    /// The largest distance relative to the shortest edge, in the file, of a triangle at the corner.
    pub share_of_edge: f64,
    /// How many triangles have a corner that moved by more than [`BENT`] of their shortest edge.
    pub bent: u32,
}

/// The fraction of an edge by which a corner may move before a warning is worth it. At 2 % a right angle is off by
/// about a degree, which shading shows; with less, warnings would be about changes that nobody sees.
pub const BENT: f64 = 0.02;

/// Vertices in one parallel task.
const CHUNK: usize = 1 << 15;

/// How far rounding has moved each vertex.
pub(super) struct Moves<'m> {
    positions: &'m [DVec3],
    /// Squared distances; empty if no vertex moved.
    squared: Vec<f64>,
}

impl<'m> Moves<'m> {
    pub(super) fn new(positions: &'m [DVec3], stored: &[Vec3], offset: DVec3) -> Self {
        let moved = |(from, to): (&DVec3, &Vec3)| {
            // Both differences are exact or nearly so, since they are of numbers that are close.
            ((*from - offset) - to.as_dvec3()).length_squared()
        };
        let all = positions.par_iter().zip(stored).with_min_len(CHUNK);
        // NaN, from vertices that are not finite, counts as a move.
        let is_moved = all.clone().any(|pair| moved(pair) != 0.0);
        let squared = if is_moved {
            all.map(moved).collect()
        } else {
            Vec::new()
        };
        Self { positions, squared }
    }
}

/// Accumulates how far triangles' corners have moved.
pub(super) struct Measure<'m> {
    moves: &'m Moves<'m>,
    /// The largest distance, squared.
    distance: f64,
    /// The largest distance relative to an edge, squared.
    share: f64,
    bent: u32,
}

impl<'m> Measure<'m> {
    pub(super) fn new(moves: &'m Moves<'m>) -> Self {
        Self {
            moves,
            distance: 0.0,
            share: 0.0,
            bent: 0,
        }
    }

    /// Adds a kept triangle.
    #[inline]
    pub(super) fn add(&mut self, triangle: [u32; 3]) {
        let Moves { positions, squared } = self.moves;
        if squared.is_empty() {
            return;
        }
        let [a, b, c] = triangle.map(|i| positions[i as usize]);
        let [i, j, k] = triangle.map(|i| squared[i as usize]);
        let moved = i.max(j).max(k);
        let edge = |from: DVec3, to: DVec3| from.distance_squared(to);
        let edge = edge(a, b).min(edge(b, c)).min(edge(c, a));
        self.distance = self.distance.max(moved);
        self.share = self.share.max(moved / edge);
        self.bent += u32::from(moved > BENT * BENT * edge);
    }

    /// Merges another accumulator.
    pub(super) fn join(&mut self, other: &Self) {
        self.distance = self.distance.max(other.distance);
        self.share = self.share.max(other.share);
        self.bent += other.bent;
    }

    pub(super) fn rounding(&self) -> Rounding {
        Rounding {
            distance: self.distance.sqrt(),
            share_of_edge: self.share.sqrt(),
            bent: self.bent,
        }
    }
}
