//! PPM: a text header and the bytes.

/// The header.
pub(super) fn head((columns, rows): (u32, u32)) -> Vec<u8> {
    format!("P6\n{columns} {rows}\n255\n").into_bytes()
}

#[cfg(test)]
mod tests {
    use super::super::{Format, Picture};

    #[test]
    fn holds_the_bytes_over_black() {
        let mut picture = Picture::blank(2, 1, false);
        picture.pixels = vec![[1, 2, 255, 255], [255, 255, 255, 0]];
        let bytes = picture.encode(Format::Ppm).expect("encodes");
        assert_eq!(bytes, b"P6\n2 1\n255\n\x01\x02\xff\x00\x00\x00");
    }

    #[test]
    fn alpha_is_laid_over_in_linear_light() {
        let mut picture = Picture::blank(1, 1, false);
        picture.pixels = vec![[255, 255, 255, 128]];
        let bytes = picture.encode(Format::Ppm).expect("encodes");
        // Half of white's light is sRGB 188 by the standard's formula.
        assert_eq!(bytes[bytes.len() - 3..], [188, 188, 188]);
    }
}
