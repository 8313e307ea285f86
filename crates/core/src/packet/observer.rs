//! Observing a packet's traversal.

use std::ops::Range;

/// Receives the events of a packet's traversal.
pub(super) trait Observer {
    /// A leaf with these primitive indices was reached.
    fn reached(&mut self, primitives: Range<u32>);

    /// These triangles were set up, or merged as small ones.
    fn set_up(&mut self, primitives: &[u32]);
}

/// Ignores all events, at no cost.
impl Observer for () {
    #[inline(always)]
    fn reached(&mut self, _: Range<u32>) {}

    #[inline(always)]
    fn set_up(&mut self, _: &[u32]) {}
}
