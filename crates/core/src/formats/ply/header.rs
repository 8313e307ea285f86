//! The header of a PLY file (Turk, "The PLY Polygon File Format", 1994): the layout of its body.

use crate::formats::error::{FormatError, quote};
use std::path::Path;

/// The encoding of the body's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A type of number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Its size in bytes.
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// A property of an element: a number, or a list of numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Scalar,
    /// The type of a list's length; `None` for a single number.
    pub(super) length: Option<Scalar>,
}

/// A type of element, and the number of elements.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    /// The line that declares it.
    pub(super) line: usize,
}

impl Element {
    /// The names of its properties, for messages.
    pub(super) fn property_names(&self) -> String {
        let names: Vec<&str> = self.properties.iter().map(|p| p.name.as_str()).collect();
        match names[..] {
            [] => "none".to_owned(),
            _ => quote(&names.join(" ")),
        }
    }
}

/// A header.
#[derive(Clone, Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// The image that a comment of VCGLIB names.
    pub(super) texture: Option<String>,
    /// The number of lines that belong to no header.
    pub(super) odd_lines: usize,
    /// The offset of the body.
    pub(super) body: usize,
}

/// The most properties of all elements together: each costs time for each of its elements.
const PROPERTY_LIMIT: usize = 1000;

/// Whether these are the bytes of a PLY.
pub(in crate::formats) fn is_ply(bytes: &[u8]) -> bool {
    bytes.strip_prefix(b"ply").is_some_and(|rest| {
        let line = rest.split(|byte| matches!(byte, b'\n' | b'\r')).next();
        line.is_some_and(|line| line.len() < rest.len() && line.trim_ascii().is_empty())
    })
}

/// The byte that ends each line. All lines end as the first one does: the body may start with a byte that looks like part of
/// a line end.
fn line_end(bytes: &[u8]) -> u8 {
    let first = bytes.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
    let first = first.unwrap_or(bytes.len());
    match bytes.get(first..) {
        Some([b'\r', b'\n', ..]) | None => b'\n',
        Some(rest) => rest.first().copied().unwrap_or(b'\n'),
    }
}

/// An element from what follows its keyword on a line; else what is expected.
fn element<'w>(mut words: impl Iterator<Item = &'w str>, line: usize) -> Result<Element, String> {
    let name = words.next().map(str::to_owned);
    let count = words.next().and_then(|count| count.parse().ok());
    let Some((name, count)) = name.zip(count) else {
        return Err("`element`, a name and a count".to_owned());
    };
    Ok(Element {
        name,
        count,
        properties: Vec::new(),
        line,
    })
}

/// A property from what follows its keyword on a line.
fn property<'w>(words: impl Iterator<Item = &'w str>) -> Option<Property> {
    let words: Vec<&str> = words.collect();
    let (length, kind, name) = match words[..] {
        ["list", length, kind, name] => (Some(Scalar::named(length)?), kind, name),
        [kind, name] => (None, kind, name),
        _ => return None,
    };
    Some(Property {
        name: name.to_owned(),
        kind: Scalar::named(kind)?,
        length,
    })
}

/// Parses a header.
///
/// # Errors
/// The first invalid line.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Header, FormatError> {
    let end = line_end(bytes);
    let mut header = Header {
        encoding: Encoding::Ascii,
        elements: Vec::new(),
        texture: None,
        odd_lines: 0,
        body: 0,
    };
    let mut has_format = false;
    let mut properties = 0;
    let mut number = 0;
    loop {
        let rest = &bytes[header.body..];
        let Some(length) = memchr::memchr(end, rest) else {
            let found = "the file's end: it is cut short";
            let line = Some(number + 1);
            return Err(FormatError::unexpected(path, line, "`end_header`", found));
        };
        number += 1;
        header.body += length + 1;
        let line = String::from_utf8_lossy(&rest[..length]);
        let fault = |expected: &str| {
            let found = quote(line.trim());
            Err(FormatError::unexpected(path, Some(number), expected, found))
        };
        let mut words = line.split_whitespace();
        let word = words.next().unwrap_or_default();
        match word {
            "" | "obj_info" => {}
            "ply" if number == 1 => {}
            "comment" => {
                if words.next() == Some("TextureFile") {
                    let name = line.split_once("TextureFile").map(|(_, name)| name.trim());
                    header.texture = name.filter(|name| !name.is_empty()).map(str::to_owned);
                }
            }
            "format" => {
                header.encoding = match words.next() {
                    Some("ascii") => Encoding::Ascii,
                    Some("binary_little_endian") => Encoding::LittleEndian,
                    Some("binary_big_endian") => Encoding::BigEndian,
                    _ => {
                        return fault(
                            "`format` with ascii, binary_little_endian or binary_big_endian",
                        );
                    }
                };
                has_format = true;
            }
            "element" => {
                let element = element(words, number).and_then(|element| {
                    match header
                        .elements
                        .iter()
                        .any(|known| known.name == element.name)
                    {
                        true => Err("one element of a name".to_owned()),
                        false => Ok(element),
                    }
                });
                match element {
                    Ok(element) => header.elements.push(element),
                    Err(expected) => return fault(&expected),
                }
            }
            "property" => {
                properties += 1;
                if properties > PROPERTY_LIMIT {
                    return fault(&format!("at most {PROPERTY_LIMIT} properties"));
                }
                let Some(property) = property(words) else {
                    return fault(
                        "`property`, a type and a name, or `list`, two types and a name (types being \
                         char, uchar, short, ushort, int, uint, float and double)",
                    );
                };
                let Some(element) = header.elements.last_mut() else {
                    return fault("`element` before its properties");
                };
                element.properties.push(property);
            }
            "end_header" => break,
            _ => header.odd_lines += 1,
        }
    }
    if !has_format {
        let expected = "a line `format`";
        return Err(FormatError::unexpected(path, None, expected, "none"));
    }
    Ok(header)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(text: &str) -> Result<Header, String> {
        assert!(is_ply(text.as_bytes()), "{text}");
        read(Path::new("a.ply"), text.as_bytes()).map_err(|error| error.to_string())
    }

    const TEXT: &str = "ply\nformat binary_big_endian 1.0\ncomment TextureFile a b.png\n\
        made by hand\nelement vertex 2\nproperty float x\nelement face 0\n\
        property list uint8 int32 vertex_indices\nend_header\n\nrest";

    #[test]
    fn lines_end_as_the_first_does() {
        for end in ["\n", "\r\n", "\r"] {
            let text = TEXT.replace('\n', end);
            let header = header(&text).expect("a good header");
            assert_eq!(&text[header.body..], format!("{end}rest"));
            assert_eq!(header.encoding, Encoding::BigEndian);
            assert_eq!(header.texture.as_deref(), Some("a b.png"));
            assert_eq!(header.odd_lines, 1);
            assert_eq!(header.elements[1].properties[0].length, Some(Scalar::U8));
        }
    }

    #[test]
    fn says_where_and_what() {
        for (from, to, message) in [
            ("big", "middle", "a.ply:2: expected `format` with ascii"),
            (
                "vertex 2",
                "vertex -2",
                "a.ply:5: expected `element`, a name and a count",
            ),
            (
                "float x",
                "half x",
                "a.ply:6: expected `property`, a type and a name",
            ),
            (
                "element face 0",
                "element vertex 3",
                "a.ply:7: expected one element of a name",
            ),
            (
                "element vertex 2\n",
                "",
                "a.ply:5: expected `element` before its properties",
            ),
            (
                "end_header",
                "end",
                "a.ply:11: expected `end_header`, found the file's end",
            ),
            (
                "format",
                "comment",
                "a.ply: expected a line `format`, found none",
            ),
        ] {
            let error = header(&TEXT.replace(from, to)).expect_err(message);
            assert!(error.starts_with(message), "{error}");
        }
        for text in ["ply", "plywood\n", "Ply\n"] {
            assert!(!is_ply(text.as_bytes()), "{text}");
        }
    }
}
