//! Fragments as PNG files.

use super::reading::is_message;
use raycast_core::picture::{Format, Fragment, FragmentError, stitch};

/// What must hold of a fragment as PNG.
///
/// # Errors
/// What does not.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    let fragment = match Fragment::decode("fragment", bytes) {
        Ok(fragment) => fragment,
        Err(refusal) => return is_message(&refusal.to_string()),
    };
    if fragment.picture.layers.is_none() {
        let written = fragment.encode(Format::Png);
        let written = written.map_err(|error| format!("it cannot be written: {error}"))?;
        let again = Fragment::decode("fragment", &written);
        let again = again.map_err(|error| format!("written, it is refused: {error}"))?;
        if again != fragment {
            return Err("written, it is another".to_owned());
        }
    }
    stitches(fragment)
}

/// Whether a fragment that is a whole picture stitches to itself, and any other is refused with what is
/// missing; and that two in one place are refused.
///
/// # Errors
/// What does not hold.
pub(super) fn stitches(fragment: Fragment) -> Result<(), String> {
    let picture = fragment.picture.clone();
    let named = |name: &str| (name.to_owned(), fragment.clone());
    match stitch(&[named("a")]) {
        // As text, for numbers that are none are not equal to themselves.
        Ok(whole) if format!("{whole:?}") == format!("{picture:?}") => {}
        Err(FragmentError::Gap(gaps))
            if (gaps.width, gaps.height) != (picture.width, picture.height) =>
        {
            is_message(&gaps.to_string())?;
        }
        other => return Err(format!("alone it stitches to {other:?}")),
    }
    match stitch(&[named("a"), named("b")]) {
        Err(FragmentError::Overlap { .. }) => Ok(()),
        other => Err(format!("twice in one place it stitches to {other:?}")),
    }
}
