use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// How far storing a mesh in single precision has moved its corners: those of kept triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rounding {
    /// The furthest, in the file's units; to some 15 digits.
    pub distance: f64,
    /// The furthest as a share of the shortest edge, in the file, of a triangle that has the corner.
    pub share_of_edge: f64,
    /// How many triangles have a corner that was moved by more than [`BENT`] of their shortest edge.
    pub bent: u32,
}

/// The share of an edge by which rounding may move a corner before that is worth a warning: at 2 % a
/// right angle is off by a degree or so, which shading shows.
pub const BENT: f64 = 0.02;

/// Vertices that are worth a task of their own.
const CHUNK: usize = 1 << 15;

/// By how much storing each vertex moves it.
pub(super) struct Moves<'m> {
    positions: &'m [DVec3],
    /// Squared; empty if none was moved.
    squared: Vec<f64>,
}

impl<'m> Moves<'m> {
    pub(super) fn new(positions: &'m [DVec3], stored: &[Vec3], offset: DVec3) -> Self {
        let moved = |(from, to): (&DVec3, &Vec3)| {
            // Both differences are exact or nearly: of numbers that are close.
            ((*from - offset) - to.as_dvec3()).length_squared()
        };
        let all = positions.par_iter().zip(stored).with_min_len(CHUNK);
        // NaN is a move, as of what is not finite.
        let is_moved = all.clone().any(|pair| moved(pair) != 0.0);
        let squared = if is_moved {
            all.map(moved).collect()
        } else {
            Vec::new()
        };
        Self { positions, squared }
    }
}

/// Measures how far corners were moved.
pub(super) struct Measure<'m> {
    moves: &'m Moves<'m>,
    /// The furthest, squared.
    distance: f64,
    /// The furthest as a share of an edge, squared.
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

    /// Takes note of a kept triangle.
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

    /// Takes over what another has noted.
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
