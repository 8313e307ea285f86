//! Prefetching: the core's only `unsafe`.

#![allow(
    unsafe_code,
    reason = "prefetching takes an address that nothing lends"
)]

/// Prefetches an item of a slice; out of range it does nothing.
#[inline(always)]
pub(crate) fn prefetch<T>(from: &[T], index: usize) {
    let address = from.as_ptr().wrapping_add(index);
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch is a hint and never faults; the address is computed without dereferencing it.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(address.cast()) };
    }
    let _ = address;
}
