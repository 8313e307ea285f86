//! Pictures and fragments as EXR files.

use super::fragment_png::stitches;
use super::reading::is_message;
use raycast_core::picture::{Format, Fragment, Picture};

/// What must hold of an EXR.
///
/// # Errors
/// What does not.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    let picture = match Picture::decode_exr(bytes) {
        Ok(picture) => picture,
        Err(refusal) => {
            if Fragment::decode("fragment", bytes).is_ok_and(|f| f.picture.layers.is_some()) {
                return Err(format!("a fragment, and no picture: {refusal}"));
            }
            return is_message(&refusal.to_string());
        }
    };
    let written = picture.encode(Format::Exr);
    let written = written.map_err(|error| format!("it cannot be written: {error}"))?;
    let again = Picture::decode_exr(&written);
    let again = again.map_err(|error| format!("written, it is refused: {error}"))?;
    are_equal(&picture, &again)?;
    match Fragment::decode("fragment", bytes) {
        Err(refusal) => is_message(&refusal.to_string()),
        Ok(fragment) => {
            are_equal(&picture, &fragment.picture)?;
            let written = fragment.encode(Format::Exr);
            let written = written.map_err(|error| format!("it cannot be written: {error}"))?;
            let again = Fragment::decode("fragment", &written);
            let again = again.map_err(|error| format!("written, it is refused: {error}"))?;
            // As text, for numbers that are none are not equal to themselves.
            if format!("{again:?}") != format!("{fragment:?}") {
                return Err("written, it is another".to_owned());
            }
            stitches(fragment)
        }
    }
}

/// Bit for bit: numbers that are none are equal to themselves.
fn are_equal(a: &Picture, b: &Picture) -> Result<(), String> {
    let bits = |picture: &Picture| {
        picture.layers.as_ref().map(|layers| {
            let floats = layers.color.as_flattened().iter();
            let floats = floats.chain(&layers.depth);
            let floats = floats.chain(layers.normal.as_flattened());
            let floats = floats.chain(layers.uv.as_flattened());
            let floats: Vec<u32> = floats.map(|value| value.to_bits()).collect();
            (floats, layers.object.clone(), layers.triangle.clone())
        })
    };
    let size = |picture: &Picture| (picture.width, picture.height);
    if size(a) != size(b) || a.pixels != b.pixels || bits(a) != bits(b) {
        return Err("the same EXR is read as another picture".to_owned());
    }
    Ok(())
}
