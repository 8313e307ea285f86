//! PPM: a line of text and the bytes.

use super::Picture;
use super::encode::over_black;

pub(super) fn encode(picture: &Picture) -> Vec<u8> {
    let mut bytes = format!("P6\n{} {}\n255\n", picture.width, picture.height).into_bytes();
    bytes.extend(over_black(&picture.pixels));
    bytes
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
