//! Pictures for formats without alpha.

use super::OutOfMemory;
use super::buffers::reserved;

/// The pixels composited over black, as red, green and blue, appended to some other bytes.
pub(super) fn over_black(before: &[u8], pixels: &[[u8; 4]]) -> Result<Vec<u8>, OutOfMemory> {
    let mut bytes = reserved(before.len() + pixels.len() * 3)?;
    bytes.extend_from_slice(before);
    for &[r, g, b, a] in pixels {
        bytes.extend(match a {
            u8::MAX => [r, g, b],
            _ => crate::shade::over_black([r, g, b, a]),
        });
    }
    Ok(bytes)
}
