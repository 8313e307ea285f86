/// Words separated by ASCII or Unicode white space.
#[derive(Clone, Debug)]
pub(super) struct Words<'t> {
    rest: &'t str,
}

impl<'t> Words<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        Self { rest: text }
    }

    /// The text after the last word.
    pub(super) fn rest(&self) -> &'t str {
        self.rest
    }

    /// Skips bytes, which must end at a character boundary.
    pub(super) fn skip(&mut self, bytes: usize) {
        self.rest = &self.rest[bytes..];
    }
}

impl<'t> Iterator for Words<'t> {
    type Item = &'t str;

    fn next(&mut self) -> Option<&'t str> {
        let bytes = self.rest.as_bytes();
        let start = bytes.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let length = bytes[start..]
            .iter()
            .position(|byte| byte.is_ascii_whitespace() || !byte.is_ascii());
        let end = length.map_or(bytes.len(), |length| start + length);
        if bytes.get(end).is_some_and(|byte| !byte.is_ascii()) {
            // The rare case: by characters.
            let rest = self.rest.trim_start();
            let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
            let word;
            (word, self.rest) = rest.split_at(end);
            return (!word.is_empty()).then_some(word);
        }
        let word = &self.rest[start..end];
        self.rest = &self.rest[end..];
        Some(word)
    }
}

/// A line's first word, and the rest.
pub(super) fn split_keyword(text: &str) -> (&str, &str) {
    let bytes = text.as_bytes();
    let is_end = |byte: &u8| byte.is_ascii_whitespace() || !byte.is_ascii();
    let end = match bytes.iter().position(is_end) {
        Some(end) if bytes[end].is_ascii() => Some(end),
        Some(_) => text.find(char::is_whitespace),
        None => None,
    };
    text.split_at(end.unwrap_or(text.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_end_at_any_white_space() {
        let words: Vec<_> = Words::new(" a\tbc \u{a0}d\u{2003}é f\u{a0}").collect();
        assert_eq!(words, ["a", "bc", "d", "é", "f"]);
        assert_eq!(Words::new("\u{a0}").next(), None);
    }

    #[test]
    fn keywords_end_at_any_white_space() {
        for text in ["f 1", "f", "f\t1 2", "fé 1", "f\u{a0}1", ""] {
            let end = text.find(char::is_whitespace).unwrap_or(text.len());
            assert_eq!(split_keyword(text), text.split_at(end), "{text:?}");
        }
    }
}
