/// Words separated by ASCII or Unicode white space.
#[derive(Clone, Debug)]
pub(super) struct Words<'t> {
    rest: &'t str,
}

impl<'t> Words<'t> {
    pub(super) fn of(text: &'t str) -> Self {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_end_at_any_white_space() {
        let words: Vec<_> = Words::of(" a\tbc \u{a0}d\u{2003}é f\u{a0}").collect();
        assert_eq!(words, ["a", "bc", "d", "é", "f"]);
        assert_eq!(Words::of("\u{a0}").next(), None);
    }
}
