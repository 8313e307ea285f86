//! Guarding against panics of parsing libraries: a panic becomes an error with the file's name.

use super::error::{FormatError, shorten};
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

thread_local! {
    static GUARDS: Cell<u32> = const { Cell::new(0) };
}

/// Whether a panic on this thread would now be caught by a reader and become its error.
///
/// A program's panic hook runs before a panic is caught. This tells the hook which panics it need not report. The
/// core installs no hook of its own, because hooks are global.
pub fn panic_is_caught() -> bool {
    GUARDS.get() > 0
}

/// Runs `read` on a file's bytes; an error where it panics.
pub(super) fn guarded<T>(file: &Path, read: impl FnOnce() -> T) -> Result<T, FormatError> {
    GUARDS.set(GUARDS.get() + 1);
    // What `read` left half done is dropped with it and never used.
    let done = catch_unwind(AssertUnwindSafe(read));
    GUARDS.set(GUARDS.get() - 1);
    done.map_err(|payload| {
        let text = match (
            payload.downcast_ref::<&str>(),
            payload.downcast_ref::<String>(),
        ) {
            (Some(text), _) => text,
            (_, Some(text)) => text.as_str(),
            _ => "without a word",
        };
        let reason = format!("reading it failed within a library: {}", shorten(text));
        FormatError::refused(file, None, &reason)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_an_error_with_the_file_in_it() {
        assert!(!panic_is_caught());
        let error = guarded(Path::new("a.png"), || -> u8 {
            assert!(panic_is_caught());
            panic!("index {} out of bounds\nbadly", 7)
        })
        .expect_err("a panic");
        assert_eq!(
            error.to_string(),
            "a.png: reading it failed within a library: index 7 out of bounds; badly"
        );
        assert!(!panic_is_caught());
        assert_eq!(guarded(Path::new("a.png"), || 7).ok(), Some(7));
    }
}
