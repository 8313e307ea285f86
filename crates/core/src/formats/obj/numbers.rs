//! Numbers of an OBJ file.

use super::words::Words;
use crate::formats::tokens::parse;
use glam::DVec3;

/// An integer with an optional sign; `None` also beyond 64 bits.
pub(super) fn integer(word: &[u8]) -> Option<i64> {
    // So many digits are below 2^63.
    const DIGITS: usize = 18;
    if word.is_empty() || word.len() > DIGITS || !word[0].is_ascii_digit() {
        return std::str::from_utf8(word).ok()?.parse().ok();
    }
    let mut value = 0;
    for byte in word {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        value = value * 10 + i64::from(digit);
    }
    Some(value)
}

/// Three numbers separated by ASCII blanks, at the start of `words`; `None`, without consuming anything, where they
/// have another form.
pub(super) fn plain_vector(words: &mut Words<'_>) -> Option<DVec3> {
    let bytes = words.rest().as_bytes();
    let mut at = 0;
    let mut next = || {
        while bytes.get(at).is_some_and(u8::is_ascii_whitespace) {
            at += 1;
        }
        let (value, length) = fast_float2::parse_partial(&bytes[at..]).ok()?;
        at += length;
        let is_end = bytes.get(at).is_none_or(u8::is_ascii_whitespace);
        is_end.then_some(value)
    };
    let vector = DVec3::new(next()?, next()?, next()?);
    words.skip(at);
    Some(vector)
}

/// Three numbers.
pub(super) fn vector(words: &mut Words<'_>) -> Option<DVec3> {
    let mut next = || parse(words.next()?.as_bytes());
    Some(DVec3::new(next()?, next()?, next()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_parse_as_in_the_standard_library() {
        for word in [
            "0",
            "7",
            "-7",
            "+7",
            "0012",
            "123456789012345678",
            "1234567890123456789",
            "9223372036854775807",
            "9223372036854775808",
            "-9223372036854775808",
            "",
            "-",
            "+",
            "1x",
            "x1",
            "1 ",
            "1.0",
            "1-2",
            "é",
        ] {
            assert_eq!(integer(word.as_bytes()), word.parse().ok(), "{word:?}");
        }
    }
}
