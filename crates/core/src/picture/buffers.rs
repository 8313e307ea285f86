//! Buffers whose allocation may fail.

/// An allocation that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{bytes} bytes of memory for a picture could not be had")]
pub struct OutOfMemory {
    /// The size of the allocation in bytes.
    pub bytes: u64,
}

/// An empty list with room for `count` items.
pub(super) fn reserved<T>(count: usize) -> Result<Vec<T>, OutOfMemory> {
    let mut list = Vec::new();
    match list.try_reserve_exact(count) {
        Ok(()) => Ok(list),
        Err(_) => Err(OutOfMemory {
            bytes: count as u64 * size_of::<T>() as u64,
        }),
    }
}

/// `count` copies of a value.
pub(super) fn filled<T: Clone>(value: T, count: usize) -> Result<Vec<T>, OutOfMemory> {
    // The memory is requested first and returned: `vec!` then gets zeroed memory from the system without writing it,
    // and succeeds since as much memory was free a moment before.
    drop(reserved::<T>(count)?);
    Ok(vec![value; count])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_that_is_not_there_is_an_error() {
        let too_many = usize::MAX / 64;
        let error = filled([0u32; 4], too_many).expect_err("there is no such machine");
        assert_eq!(error.bytes, too_many as u64 * 16);
        assert_eq!(filled(7u8, 3), Ok(vec![7; 3]));
    }
}
