//! Set-up of triangles with depth keys from the distances of their corners from the reference plane, for those that
//! [`plane_keys`](super::plane_keys), which derives the keys, finds inaccurate.

use super::componentwise_setup::{Factors, Functions, corners_in_lane, is_clear};
use super::plane_order::weighted_sum;
use super::setup::{FunctionDomain, Linear, PacketSpace, TriangleSetup};
use crate::num::simd::{LANES, Lanes, Work};
use crate::triangle::CornerLanes;

/// Distances of a triangle's corners from a plane, each with the bound on its error.
pub(super) type CornerDistances = [(f64, f64); 3];

/// The distances of eight triangles' corners from a plane, and the bounds on their errors.
pub(super) struct DistanceLanes {
    values: [[f64; LANES]; 3],
    errors: [[f64; LANES]; 3],
}

impl DistanceLanes {
    pub(super) const ZERO: Self = Self {
        values: [[0.0; LANES]; 3],
        errors: [[0.0; LANES]; 3],
    };

    pub(super) fn set(&mut self, l: usize, of_corners: CornerDistances) {
        for (corner, (value, error)) in of_corners.into_iter().enumerate() {
            self.values[corner][l] = value;
            self.errors[corner][l] = error;
        }
    }

    #[inline(always)]
    fn get(&self, l: usize) -> CornerDistances {
        [0, 1, 2].map(|corner| (self.values[corner][l], self.errors[corner][l]))
    }
}

/// Triangles that are set up again. A key is kept only where it is more accurate than the one before.
pub(super) struct PlaneKeySetup<'a> {
    pub(super) space: &'a PacketSpace,
    pub(super) corners: &'a CornerLanes,
    /// Lanes of the eight triangles, as bits.
    pub(super) which: u32,
    pub(super) distances: &'a DistanceLanes,
    /// The factor of F/|P₀·n|, and its relative error.
    pub(super) factor: (f64, f64),
    pub(super) out: &'a mut TriangleSetup,
}

impl Work for PlaneKeySetup<'_> {
    #[inline(always)]
    fn run(mut self, _: impl Lanes) {
        let closely = self.set_up_together();
        for l in (0..LANES).filter(|l| closely >> l & 1 != 0) {
            let (space, corners) = (self.space, corners_in_lane(self.corners, l));
            if let Some(functions) = space.functions_closely(corners, |_, _| false)
                && is_clear(functions.facing)
            {
                let distances = self.distances.get(l);
                let overflows = store(
                    space,
                    &functions,
                    (distances, self.factor),
                    (l, true),
                    self.out,
                );
                self.out.overflows |= overflows;
            }
        }
    }
}

impl PlaneKeySetup<'_> {
    /// Sets up all eight, from products in double precision. Returns, as bits, those for which these do not suffice.
    ///
    /// Copies, and flags collected afterwards, as where triangles are
    /// [set up with componentwise bounds](super::componentwise_setup): for the compiler to turn the loop into vectors.
    #[inline(always)]
    fn set_up_together(&mut self) -> u32 {
        let (space, mut set_up, corners) = (self.space.clone(), self.out.clone(), *self.corners);
        let DistanceLanes { values, errors } = *self.distances;
        let distances = DistanceLanes { values, errors };
        let (mut closely, mut overflow) = ([false; LANES], [false; LANES]);
        for l in 0..LANES {
            let factors = Factors::new(corners_in_lane(&corners, l), space.origin);
            let functions = space.functions(&factors);
            let is_selected = self.which >> l & 1 != 0;
            let suffices =
                factors.in_range & is_clear(functions.facing) & !space.are_rounded(&functions);
            closely[l] = is_selected & !suffices;
            let of_plane = (distances.get(l), self.factor);
            let lane = (l, is_selected & suffices);
            overflow[l] = store(&space, &functions, of_plane, lane, &mut set_up);
        }
        set_up.overflows |= overflow.contains(&true);
        *self.out = set_up;
        (closely.into_iter().enumerate()).fold(0, |bits, (l, is)| bits | u32::from(is) << l)
    }
}

/// Stores a triangle's functions, and the depth key that its distances give, as those of lane `l` if it is selected and
/// the key is more accurate than before. Returns whether the key alone overflows single precision.
#[inline(always)]
fn store(
    space: &PacketSpace,
    functions: &Functions,
    (distances, factor): (CornerDistances, (f64, f64)),
    (l, is_selected): (usize, bool),
    out: &mut TriangleSetup,
) -> bool {
    let (key, error) = depth_key(space, functions, distances, factor);
    let span = FunctionDomain::of(&out.boxes[l]);
    let is_better = out.ill_conditioned[l] | (error < f64::from(out.depth_key_error[l]));
    // NaN and infinity are not better.
    let is_better = is_better & (error < f64::INFINITY);
    let lane = (l, is_selected & is_better);
    space.store_with_key(functions, (key.moved(&span), error), &span, lane, out)
}

/// The depth key of a triangle over the whole packet, with the bound on its error but for single precision's, from the
/// distances of its corners and its functions; `factor` is that of F/|P₀·n|, and its relative error.
#[inline(always)]
pub(super) fn depth_key(
    space: &PacketSpace,
    functions: &Functions,
    distances: CornerDistances,
    (factor, factor_error): (f64, f64),
) -> (Linear, f64) {
    let (facing, facing_error) = functions.facing;
    let facing_error = facing_error / facing.abs();
    let factor = factor / (facing.abs() * space.rays.distance * space.units);
    // The edge functions are positive inside where the denominator is.
    let (sum, error) = weighted_sum(distances, &functions.edges);
    let key = sum.times(-factor * facing.signum());
    let error = 2.0 * factor * error + 2.0 * key.reach() * (factor_error + facing_error);
    (key, error)
}
