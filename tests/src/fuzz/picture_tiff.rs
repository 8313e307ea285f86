//! Pictures as TIFF files.

use super::reading::is_message;
use raycast_core::picture::{Format, ImageFile, RowReader};
use std::io::Cursor;

/// What must hold of a picture as TIFF.
///
/// # Errors
/// What does not.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    let file = match ImageFile::decode(bytes) {
        Ok(file) => file,
        Err(refusal) => return is_message(&refusal.to_string()),
    };
    let read = Cursor::new(bytes);
    let reader = RowReader::open(read, bytes.len() as u64);
    let mut reader = reader.map_err(|error| format!("by rows it is refused: {error}"))?;
    for (y, row) in (file.picture.pixels)
        .chunks_exact(file.picture.width as usize)
        .enumerate()
    {
        let read = reader.rows(1);
        let read = read.map_err(|error| format!("row {y} is refused: {error}"))?;
        if read.pixels != row {
            return Err(format!("row {y} is another by itself"));
        }
    }
    let written = file
        .picture
        .encode_with(Format::Tiff, file.recipe.as_ref())
        .map_err(|error| format!("it cannot be written: {error}"))?;
    let again = ImageFile::decode(&written);
    let again = again.map_err(|error| format!("written, it is refused: {error}"))?;
    if again.recipe != file.recipe {
        return Err("written, it has another recipe".to_owned());
    }
    // The recipe of an opaque picture leaves no room for alpha.
    let is_opaque = (file.picture.pixels.iter()).all(|pixel| pixel[3] == u8::MAX);
    if (is_opaque || file.recipe.is_none()) && again.picture != file.picture {
        return Err("written, it is another".to_owned());
    }
    Ok(())
}
