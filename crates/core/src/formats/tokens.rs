//! Words and numbers of a text, as byte slices without copies.

use super::error::{FormatError, quote};
use std::path::Path;

/// A position in a text.
#[derive(Clone, Debug)]
pub(super) struct Tokens<'t> {
    bytes: &'t [u8],
    at: usize,
    /// The start of the last word.
    start: usize,
    /// The character that starts a comment, which reaches to the end of its line.
    comment: Option<u8>,
}

impl<'t> Tokens<'t> {
    /// The words from byte `at` on.
    pub(super) fn new(bytes: &'t [u8], at: usize, comment: Option<u8>) -> Self {
        Self {
            bytes,
            at,
            start: at,
            comment,
        }
    }

    /// The offset after the last word.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// The next word, on any line.
    #[inline]
    pub(super) fn next(&mut self) -> Option<&'t [u8]> {
        loop {
            if let Some(word) = self.next_in_line() {
                return Some(word);
            }
            if !self.next_line() {
                return None;
            }
        }
    }

    /// The next word on the current line.
    #[inline]
    pub(super) fn next_in_line(&mut self) -> Option<&'t [u8]> {
        let rest = &self.bytes[self.at..];
        let blank = rest.iter().take_while(|byte| is_blank(**byte)).count();
        let rest = &rest[blank..];
        self.at += blank;
        self.start = self.at;
        if rest.first().is_some_and(|&byte| Some(byte) == self.comment) {
            self.at += memchr::memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
            return None;
        }
        let end = rest
            .iter()
            .position(|&byte| is_blank(byte) || is_end(byte) || Some(byte) == self.comment)
            .unwrap_or(rest.len());
        self.at += end;
        (end > 0).then(|| &rest[..end])
    }

    /// Moves to the next line; returns whether there is one.
    pub(super) fn next_line(&mut self) -> bool {
        let rest = &self.bytes[self.at..];
        let Some(end) = memchr::memchr2(b'\n', b'\r', rest) else {
            self.at = self.bytes.len();
            self.start = self.at;
            return false;
        };
        let both = rest[end..].starts_with(b"\r\n");
        self.at += end + if both { 2 } else { 1 };
        self.start = self.at;
        self.at < self.bytes.len()
    }

    /// The rest of the current line, trimmed.
    pub(super) fn rest_of_line(&mut self) -> &'t [u8] {
        let rest = &self.bytes[self.at..];
        let end = memchr::memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        self.at += end;
        rest[..end].trim_ascii()
    }

    /// The line, from 1, of the last word; at the end, the last line that has a word.
    pub(super) fn line(&self) -> usize {
        let before = self.bytes[..self.start].trim_ascii_end();
        // Line ends between the last word and the one before it count as well.
        let before = if self.start < self.bytes.len() {
            &self.bytes[..self.start]
        } else {
            before
        };
        let returns = memchr::memchr_iter(b'\r', before)
            .filter(|&at| self.bytes.get(at + 1) != Some(&b'\n'))
            .count();
        1 + returns + memchr::memchr_iter(b'\n', before).count()
    }

    /// The next word as a number.
    ///
    /// # Errors
    /// What was found instead, for [`Tokens::fault`].
    #[inline]
    pub(super) fn number(&mut self) -> Result<f64, Found> {
        let word = self.next().ok_or(Found::End)?;
        parse(word).ok_or_else(|| Found::word(word))
    }

    /// Three numbers.
    ///
    /// # Errors
    /// As [`Tokens::number`].
    #[inline]
    pub(super) fn point(&mut self) -> Result<glam::DVec3, Found> {
        Ok(glam::DVec3::new(
            self.number()?,
            self.number()?,
            self.number()?,
        ))
    }

    /// The error that the last word is something other than `expected`.
    #[cold]
    pub(super) fn fault(&self, path: &Path, expected: &str, found: &Found) -> FormatError {
        FormatError::unexpected(path, Some(self.line()), expected, found.to_string())
    }
}

/// What was found instead of an expected word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Found {
    /// A word, quoted.
    Word(String),
    /// The end of the text.
    End,
}

impl Found {
    /// A word of a file.
    #[cold]
    pub(super) fn word(word: &[u8]) -> Self {
        Self::Word(quote(&String::from_utf8_lossy(word)))
    }

    /// A word, or the end for `None`.
    pub(super) fn next(word: Option<&[u8]>) -> Self {
        word.map_or(Self::End, Self::word)
    }
}

impl std::fmt::Display for Found {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Word(word) => f.write_str(word),
            Self::End => f.write_str("the file's end: it is cut short"),
        }
    }
}

/// The number that a whole word represents, rounded to nearest.
#[inline]
pub(super) fn parse(word: &[u8]) -> Option<f64> {
    fast_float2::parse(word).ok()
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\x0b' | b'\x0c')
}

fn is_end(byte: u8) -> bool {
    matches!(byte, b'\n' | b'\r')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_lines_and_comments() {
        let mut tokens = Tokens::new(b"a\tb # c\r\n\r d#e\nf", 0, Some(b'#'));
        let mut found = Vec::new();
        while let Some(word) = tokens.next() {
            found.push((String::from_utf8_lossy(word).into_owned(), tokens.line()));
        }
        let expected = [("a", 1), ("b", 1), ("d", 3), ("f", 4)];
        assert_eq!(found, expected.map(|(word, line)| (word.to_owned(), line)));
        assert_eq!(tokens.next(), None);
        assert_eq!(tokens.line(), 4);

        let mut tokens = Tokens::new(b"x 1\n2\n\n", 0, None);
        assert_eq!(tokens.next_in_line(), Some(&b"x"[..]));
        assert_eq!(tokens.rest_of_line(), b"1");
        assert_eq!(tokens.next_in_line(), None);
        assert_eq!(tokens.number(), Ok(2.0));
        assert_eq!(tokens.number(), Err(Found::End));
        assert_eq!(tokens.line(), 2);
    }

    #[test]
    fn numbers_are_whole_words() {
        for (word, number) in [("1e3", 1000.0), ("-.5", -0.5), ("+2", 2.0), ("1.", 1.0)] {
            assert_eq!(parse(word.as_bytes()), Some(number), "{word}");
        }
        for word in ["", "1x", "0x10", "1,5", "--1", "e5"] {
            assert_eq!(parse(word.as_bytes()), None, "{word}");
        }
    }
}
