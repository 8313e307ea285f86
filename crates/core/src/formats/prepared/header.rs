//! The header of a prepared file.

use super::checksum;
use super::encoder::Encoder;
use crate::formats::error::{FormatError, quote};
use std::io;
use std::path::Path;

/// Identifies a prepared file. As in PNG's signature, the first byte is not ASCII, so that the file is not taken
/// for text, and the line ends reveal a transfer that converted them.
const MAGIC: &[u8; 12] = b"\x89RAYCAST\r\n\x1a\n";

/// The version of the format; files of another version are rejected. Raise it with every change of the layout, of
/// the meaning of a field, or of an assumption of the reader.
const VERSION: u32 = 2;

/// The version of the program, as stored in the header.
const PROGRAM: &str = env!("CARGO_PKG_VERSION");
const PROGRAM_BYTES: usize = 20;

/// Bytes of the header: magic, version, program, length.
pub(super) const HEADER_BYTES: usize = MAGIC.len() + 4 + PROGRAM_BYTES + 8;

/// Whether these are the first bytes of a prepared file, of any version.
pub(in crate::formats) fn is_prepared(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Writes the header of a file of `length` bytes.
pub(super) fn write(length: u64, to: &mut Encoder<'_>) -> io::Result<()> {
    to.bytes(MAGIC)?;
    to.number(VERSION)?;
    let mut program = [0; PROGRAM_BYTES];
    for (to, byte) in program.iter_mut().zip(PROGRAM.bytes()) {
        *to = byte;
    }
    to.bytes(&program)?;
    to.long(length)
}

/// Checks version and length. `first` is the file's first [`HEADER_BYTES`], or all of a shorter file; `length` is
/// its actual length.
///
/// # Errors
/// Another version; another length than the header states.
pub(super) fn check(path: &Path, first: &[u8], length: u64) -> Result<(), FormatError> {
    let unexpected =
        |expected: String, found: String| Err(FormatError::unexpected(path, None, expected, found));
    let cut = || {
        let expected = "the end of a prepared mesh";
        unexpected(
            expected.to_owned(),
            format!("that it is cut short at byte {length}"),
        )
    };
    let rest = first.strip_prefix(MAGIC).unwrap_or_default();
    let Some((version, rest)) = rest.split_first_chunk() else {
        return cut();
    };
    let version = u32::from_le_bytes(*version);
    let Some((program, rest)) = rest.split_first_chunk::<PROGRAM_BYTES>() else {
        return cut();
    };
    if version != VERSION {
        let program = program.split(|&byte| byte == 0).next().unwrap_or_default();
        let program = quote(&String::from_utf8_lossy(program));
        return unexpected(
            format!("a prepared mesh of version {VERSION}, which this program ({PROGRAM}) reads"),
            format!(
                "version {version}, written by program {program}: run `raycast prepare` of this program on the \
                 mesh again"
            ),
        );
    }
    let Some((expected, _)) = rest.split_first_chunk() else {
        return cut();
    };
    let expected = u64::from_le_bytes(*expected);
    if length < expected {
        return unexpected(
            format!("{expected} bytes"),
            format!("a file cut short at {length}"),
        );
    }
    if length > expected {
        return unexpected(format!("{expected} bytes"), format!("{length}"));
    }
    match length < (HEADER_BYTES + checksum::BYTES) as u64 {
        true => cut(),
        false => Ok(()),
    }
}
