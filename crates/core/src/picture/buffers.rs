//! Buffers that may not be had.

/// Memory that could not be had.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{bytes} bytes of memory for a picture could not be had")]
pub struct OutOfMemory {
    /// How many bytes were asked for at once.
    pub bytes: u64,
}

/// An empty list with room for so many.
pub(super) fn reserved<T>(count: usize) -> Result<Vec<T>, OutOfMemory> {
    let mut list = Vec::new();
    match list.try_reserve_exact(count) {
        Ok(()) => Ok(list),
        Err(_) => Err(OutOfMemory {
            bytes: count as u64 * size_of::<T>() as u64,
        }),
    }
}

/// So many of one value.
pub(super) fn filled<T: Clone>(value: T, count: usize) -> Result<Vec<T>, OutOfMemory> {
    // Asked for first, and given back: memory that the system hands out zeroed is not written to fill it
    // with zeros, and the list that is kept is made at once, where there was as much a moment before.
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
