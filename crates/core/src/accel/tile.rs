//! A tile of rays against the tree: the seam where a kernel for whole tiles plugs in.

use super::{Accel, SlotHit};
use crate::camera::Lattice;
use crate::intersect::{Cull, Precision};

impl Accel {
    /// Casts every ray of a lattice: its hits row by row, in place of what `hits` held.
    ///
    /// Each is what [`Accel::cast_slot`] answers for that ray.
    pub fn cast_lattice(
        &self,
        lattice: &Lattice,
        cull: Cull,
        _precision: Precision,
        hits: &mut Vec<SlotHit>,
    ) {
        hits.clear();
        hits.reserve(lattice.len());
        for row in 0..lattice.rows {
            for column in 0..lattice.columns {
                hits.push(self.cast_slot(&lattice.ray(column, row), cull));
            }
        }
    }
}
