use std::ops::Range;

/// What wants to know of a block's walk.
pub(super) trait Notice {
    /// It came to a leaf with these slots.
    fn reached(&mut self, slots: Range<u32>);

    /// It set these up.
    fn set_up(&mut self, slots: &[u32]);
}

/// Nobody.
impl Notice for () {
    #[inline(always)]
    fn reached(&mut self, _: Range<u32>) {}

    #[inline(always)]
    fn set_up(&mut self, _: &[u32]) {}
}
