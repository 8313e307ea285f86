//! The sizes that the packet kernel is built around.

/// Rays along the side of a large packet, which finds entry points for its packets. A larger one shares the upper
/// levels of the tree among more rays, but its wider frustum touches more subtrees.
pub(crate) const LARGE_SIDE: u32 = 64;

/// Rays along the side of a packet. A larger one sets each triangle up fewer times, but its depth bounds and
/// primitive indices, 12 bytes a ray, must stay in the first-level cache.
pub(crate) const SIDE: usize = 32;

/// Rays along the side of a cell, and in a row that is tested at once: one vector register.
pub(crate) const ROW: usize = 8;

/// Rays in a packet.
pub(crate) const RAYS: usize = SIDE * SIDE;

/// Columns of a row of rays.
pub(crate) const COLUMNS: [f32; ROW] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// Cells along the side of a packet.
pub(crate) const CELLS: usize = SIDE / ROW;

/// The largest bounds, in columns or rows, of a small triangle, which is tested ray by ray without set-up. With the
/// margin of an eighth on each side they hold at most 5 rays in each direction, as many as `SmallCoverage` has room
/// for; with a smaller limit more triangles are set up.
pub(crate) const SMALL_SIDE: f32 = 4.75;
