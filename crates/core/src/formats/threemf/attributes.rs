//! Attributes of an XML element, parsed with errors that name the part and the line.

use super::package::{Package, Part};
use crate::formats::error::{FormatError, quote, shorten};
use glam::{DAffine3, DMat3, DVec3};
use quick_xml::XmlVersion;
use quick_xml::events::BytesStart;
use std::str::FromStr;

/// Parses attributes on a line of a model part.
pub(super) struct Attributes<'r, 'b> {
    pub(super) package: &'r Package<'b>,
    pub(super) part: &'r Part<'b>,
    /// The current line, from 1.
    pub(super) line: usize,
}

impl Attributes<'_, '_> {
    /// An error on the current line.
    pub(super) fn fault(&self, reason: &str) -> FormatError {
        self.package.fault(&self.part.name, Some(self.line), reason)
    }

    /// The error that something other than `expected` was found.
    pub(super) fn unexpected(&self, expected: &str, found: &str) -> FormatError {
        self.fault(&format!("expected {expected}, found {found}"))
    }

    /// Twelve numbers: the images of the three axes, and the translation.
    pub(super) fn transform(&self, text: &str) -> Result<DAffine3, FormatError> {
        let mut numbers = [0.0; 12];
        let mut words = text.split_ascii_whitespace();
        for number in &mut numbers {
            let word = words.next().unwrap_or_default();
            *number = word
                .parse()
                .ok()
                .filter(|number: &f64| number.is_finite())
                .ok_or_else(|| self.unexpected("twelve numbers as a transform", &quote(text)))?;
        }
        if words.next().is_some() {
            return Err(self.unexpected("twelve numbers as a transform", "more"));
        }
        let [x, y, z, t] = [0, 3, 6, 9].map(|at| DVec3::from_slice(&numbers[at..]));
        Ok(DAffine3 {
            matrix3: DMat3::from_cols(x, y, z),
            translation: t,
        })
    }

    /// An attribute's value, parsed.
    pub(super) fn parse<T: FromStr>(&self, value: &[u8], expected: &str) -> Result<T, FormatError> {
        let text = std::str::from_utf8(value).ok().map(str::trim);
        text.and_then(|text| text.parse().ok())
            .ok_or_else(|| self.unexpected(expected, &quote(&String::from_utf8_lossy(value))))
    }

    /// An attribute's text, by its name without a prefix.
    pub(super) fn text(
        &self,
        tag: &BytesStart<'_>,
        key: &[u8],
    ) -> Result<Option<String>, FormatError> {
        for attribute in tag.attributes().with_checks(false) {
            let attribute = attribute.map_err(|error| self.fault(&error.to_string()))?;
            if attribute.key.local_name().as_ref() == key {
                let value = attribute.normalized_value(XmlVersion::Implicit1_0);
                let value = value.map_err(|error| self.fault(&shorten(&error.to_string())))?;
                return Ok(Some(value.into_owned()));
            }
        }
        Ok(None)
    }

    /// An attribute's integer, if the attribute is there.
    pub(super) fn number(
        &self,
        tag: &BytesStart<'_>,
        key: &[u8],
    ) -> Result<Option<u32>, FormatError> {
        let text = self.text(tag, key)?;
        text.map(|text| self.parse(text.as_bytes(), "a whole number"))
            .transpose()
    }

    /// The integer of a required attribute.
    pub(super) fn need(&self, tag: &BytesStart<'_>, key: &[u8]) -> Result<u32, FormatError> {
        self.number(tag, key)?.ok_or_else(|| {
            let key = String::from_utf8_lossy(key);
            let name = String::from_utf8_lossy(tag.name().as_ref()).into_owned();
            self.unexpected(
                &format!("`{key}` of an element"),
                &format!("{} without", quote(&name)),
            )
        })
    }
}
