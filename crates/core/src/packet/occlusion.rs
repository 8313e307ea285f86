//! What a descent skips because it is occluded.

use crate::num::simd::Lanes;

/// What a packet's hits so far occlude.
pub(super) trait Occlusion {
    /// Accounts for the hits since it was last called.
    fn update(&mut self, lanes: impl Lanes);

    /// The least and the greatest depth key of the cells' hi-z: what is surely further than the least is occluded for every
    /// ray; what is surely further than the greatest, in at least one cell.
    fn hi_z(&self, lanes: impl Lanes) -> (f32, f32);

    /// Whether nothing further than `nearest` counts for any ray of these cells (as bits).
    fn occludes_cells(&self, lanes: impl Lanes, cells: u32, nearest: f32) -> bool;
}
