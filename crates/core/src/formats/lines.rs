//! Lines of a text, with any line ends.

use std::borrow::Cow;

/// A file's text without its byte order mark; invalid UTF-8 is replaced.
pub(super) fn text(bytes: &[u8]) -> Cow<'_, str> {
    decode(without_mark(bytes))
}

/// The bytes without a UTF-8 byte order mark.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// A piece of a file's text; invalid UTF-8 is replaced.
pub(super) fn decode(bytes: &[u8]) -> Cow<'_, str> {
    // Validating the whole is several times as fast as decoding it sequence by sequence.
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => String::from_utf8_lossy(bytes),
    }
}

/// The lines of a text. Each ends in a line feed, a carriage return (old Macintosh), or both (Windows); one file may
/// mix them.
#[derive(Clone, Debug)]
pub(super) struct Lines<'t> {
    rest: &'t str,
    number: usize,
}

/// A line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Line<'t> {
    pub(super) text: &'t str,
    /// The line's number, from 1.
    pub(super) number: usize,
    /// Whether the text ends with the line, without a line end.
    pub(super) is_cut: bool,
}

impl<'t> Lines<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        Self {
            rest: text,
            number: 0,
        }
    }

    /// The number of bytes left.
    pub(super) fn left(&self) -> usize {
        self.rest.len()
    }
}

impl<'t> Iterator for Lines<'t> {
    type Item = Line<'t>;

    fn next(&mut self) -> Option<Line<'t>> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let bytes = self.rest.as_bytes();
        let end = memchr::memchr2(b'\n', b'\r', bytes);
        let (text, behind) = match end {
            None => (self.rest, ""),
            Some(end) => {
                let both = bytes[end..].starts_with(b"\r\n");
                let behind = end + if both { 2 } else { 1 };
                (&self.rest[..end], &self.rest[behind..])
            }
        };
        self.rest = behind;
        Some(Line {
            text,
            number: self.number,
            is_cut: end.is_none(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_three_ways() {
        let lines: Vec<_> = Lines::new("a\rb\n\r\nc\r\r\nd")
            .map(|line| (line.text, line.number, line.is_cut))
            .collect();
        let line = |text, number| (text, number, false);
        assert_eq!(
            lines,
            [
                line("a", 1),
                line("b", 2),
                line("", 3),
                line("c", 4),
                line("", 5),
                ("d", 6, true)
            ]
        );
        assert_eq!(Lines::new("").count(), 0);
        assert_eq!(Lines::new("a\n").count(), 1);
    }
}
