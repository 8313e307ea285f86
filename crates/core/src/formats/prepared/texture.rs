//! A texture: columns, rows, wrap along u and v (kind u32, colour), texels (a list of words: R, G, B, A).

use super::decoder::Decoder;
use super::encoder::Encoder;
use crate::formats::error::FormatError;
use crate::scene::{Color, Texture, Wrap};
use std::io;

/// The least number of bytes of a texture in the file.
pub(super) const MIN_BYTES: usize = 8 + 2 * 8 + 4;

pub(super) fn write(texture: &Texture, to: &mut Encoder<'_>) -> io::Result<()> {
    to.number(texture.width())?;
    to.number(texture.height())?;
    for wrap in texture.wrap() {
        let (kind, color) = match wrap {
            Wrap::Repeat => (0, None),
            Wrap::Mirror => (1, None),
            Wrap::Clamp => (2, None),
            Wrap::Border(None) => (3, None),
            Wrap::Border(color) => (4, color),
        };
        to.number(kind)?;
        to.number(color.map_or(0, word))?;
    }
    to.list(texture.texels(), |texel| [u32::from_le_bytes(texel)])
}

pub(super) fn read(from: &mut Decoder<'_>) -> Result<Texture, FormatError> {
    let (width, height) = (from.number("columns")?, from.number("rows")?);
    from.budget().check_pixels(from.path(), width, height)?;
    let mut wrap = [Wrap::Repeat; 2];
    for wrap in &mut wrap {
        let kind = from.below("a kind of wrapping", 5)?;
        let color = from.number("a colour")?;
        *wrap = match kind {
            0 => Wrap::Repeat,
            1 => Wrap::Mirror,
            2 => Wrap::Clamp,
            3 => Wrap::Border(None),
            _ => Wrap::Border(Some(color_from_word(color))),
        };
    }
    let texels = from.list("texels", |[texel]: [u32; 1]| texel.to_le_bytes())?;
    let count = texels.len();
    match Texture::new(width, height, texels) {
        Some(texture) => Ok(texture.wrapped(wrap)),
        None => Err(from.unexpected(&format!("{width} × {height} texels"), count)),
    }
}

/// A colour as a word: R, G, B, zero.
pub(super) fn word(Color([r, g, b]): Color) -> u32 {
    u32::from_le_bytes([r, g, b, 0])
}

pub(super) fn color_from_word(word: u32) -> Color {
    let [r, g, b, _] = word.to_le_bytes();
    Color([r, g, b])
}
