//! Events of a packet's traversal, to be recorded.

use std::ops::Range;

/// Observes a packet's traversal.
pub(super) trait Observer {
    /// It reached a leaf with these primitive indices.
    fn reached(&mut self, primitives: Range<u32>);

    /// It set these triangles up, or merged them as small ones.
    fn set_up(&mut self, primitives: &[u32]);
}

/// Observes nothing, and costs nothing.
impl Observer for () {
    #[inline(always)]
    fn reached(&mut self, _: Range<u32>) {}

    #[inline(always)]
    fn set_up(&mut self, _: &[u32]) {}
}
