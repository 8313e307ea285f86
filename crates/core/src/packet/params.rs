//! The sizes that the kernel is built around.

/// Rays along the side of a block that walks down the tree first.
pub(crate) const LARGE_SIDE: u32 = 64;

/// Rays along the side of the largest block.
pub(crate) const SIDE: usize = 32;

/// Rays that are met side by side in a row.
pub(crate) const ROW: usize = 8;

/// Sub-blocks along a side.
pub(crate) const SUBS: usize = SIDE / ROW;

/// How large a box of few rays is at most.
pub(crate) const FEW_SIDE: f32 = 4.75;
