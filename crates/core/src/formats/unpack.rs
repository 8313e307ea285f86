//! Compressed files, recognised by their first bytes: gzip (RFC 1952), Zstandard (RFC 8878), and UTF-16.

use super::Progress;
use super::error::{FormatError, shorten};
use super::files::{Contents, Filling};
use super::guard::guarded;
use super::limits::Budget;
use super::stl;
use flate2::read::MultiGzDecoder;
use ruzstd::decoding::StreamingDecoder;
use ruzstd::decoding::errors::{FrameDecoderError, ReadFrameHeaderError};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Extensions of compressed files.
const EXTENSIONS: [&str; 2] = ["gz", "zst"];

/// A file's name without the extension of its compression.
pub(super) fn inner_name(path: &Path) -> PathBuf {
    let is_compressed = path.extension().is_some_and(|extension| {
        EXTENSIONS
            .iter()
            .any(|known| extension.eq_ignore_ascii_case(known))
    });
    if is_compressed {
        path.with_extension("")
    } else {
        path.to_owned()
    }
}

/// The contents of a compressed file, and the name of the compression; `None` for any other file. UTF-16 text becomes
/// UTF-8, with invalid characters replaced.
///
/// # Errors
/// Damaged data; an exhausted budget.
pub(super) fn unpack<'b>(
    path: &Path,
    bytes: &[u8],
    budget: &'b Budget,
    progress: Progress<'_>,
) -> Result<Option<(Contents<'b>, &'static str)>, FormatError> {
    // A binary STL may start with any bytes.
    if stl::is_binary(bytes) {
        return Ok(None);
    }
    let name = match bytes {
        [0x1f, 0x8b, ..] => "gzip",
        [0x28, 0xb5, 0x2f, 0xfd, ..] => "Zstandard",
        [0xff, 0xfe, text @ ..] => {
            return utf_16(path, text, u16::from_le_bytes, budget).map(Some);
        }
        [0xfe, 0xff, text @ ..] => {
            return utf_16(path, text, u16::from_be_bytes, budget).map(Some);
        }
        _ => return Ok(None),
    };
    let mut filling = Filling::new(path, budget)?;
    let damaged = |error: &io::Error| {
        let reason = format!(
            "its {name} data cannot be unpacked: {}",
            shorten(&error.to_string())
        );
        FormatError::refused(path, None, &reason)
    };
    let length = bytes.len() as f32;
    let filled = if name == "gzip" {
        let mut decoder = MultiGzDecoder::new(bytes);
        filling.read(&mut |space: &mut Vec<u8>, most| {
            let read = (&mut decoder).take(most).read_to_end(space)?;
            progress(1.0 - decoder.get_ref().len() as f32 / length);
            Ok(read)
        })
    } else {
        guarded(path, || {
            let mut rest = bytes;
            while !rest.is_empty() {
                let mut decoder = match StreamingDecoder::new(&mut rest) {
                    Ok(decoder) => decoder,
                    Err(FrameDecoderError::ReadFrameHeaderError(
                        ReadFrameHeaderError::SkipFrame { length, .. },
                    )) => {
                        rest = rest.get(length as usize..).unwrap_or_default();
                        continue;
                    }
                    Err(error) => return Ok(Err(io::Error::other(error.to_string()))),
                };
                let read = filling.read(&mut |space: &mut Vec<u8>, most| {
                    let read = (&mut decoder).take(most).read_to_end(space)?;
                    progress(1.0 - decoder.get_ref().len() as f32 / length);
                    Ok(read)
                })?;
                if read.is_err() {
                    return Ok(read);
                }
            }
            Ok(Ok(()))
        })?
    };
    filled?.map_err(|error| damaged(&error))?;
    Ok(Some((filling.into_contents(), name)))
}

fn utf_16<'b>(
    path: &Path,
    text: &[u8],
    unit: fn([u8; 2]) -> u16,
    budget: &'b Budget,
) -> Result<(Contents<'b>, &'static str), FormatError> {
    let (pairs, _) = text.as_chunks::<2>();
    // At most three bytes a UTF-16 unit.
    let share = budget.share(path, "the file", 3 * pairs.len() as u64)?;
    let mut bytes = String::with_capacity(3 * pairs.len());
    let units = pairs.iter().map(|pair| unit(*pair));
    let characters = char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER));
    bytes.extend(characters);
    Ok((Contents::new(bytes.into_bytes(), share), "UTF-16"))
}

#[cfg(test)]
mod tests {
    use super::super::limits::Limits;
    use super::*;
    use flate2::Compression;
    use flate2::write::GzEncoder;
    use ruzstd::encoding::{CompressionLevel, compress_to_vec};
    use std::io::Write;

    fn gzip(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(bytes).expect("a list takes all");
        encoder.finish().expect("a list takes all")
    }

    fn zstd(bytes: &[u8]) -> Vec<u8> {
        compress_to_vec(bytes, CompressionLevel::Fastest)
    }

    fn unpacked(bytes: &[u8], most: u64) -> Result<Option<(Vec<u8>, &'static str)>, String> {
        let budget = Budget::new(Limits {
            bytes: most,
            ..Limits::default()
        });
        unpack(Path::new("a.obj.gz"), bytes, &budget, &|_| ())
            .map(|all| all.map(|(contents, name)| (contents.to_vec(), name)))
            .map_err(|error| error.to_string())
    }

    #[test]
    fn compressed_files_are_decompressed() {
        let text: Vec<u8> = (0..3_000_000u32)
            .flat_map(|n| (n / 7).to_le_bytes())
            .collect();
        let both = [text.clone(), text[..9].to_vec()].concat();
        let skipped = [
            &[0x50, 0x2a, 0x4d, 0x18, 2, 0, 0, 0, 7, 7],
            &zstd(&text[..9])[..],
        ]
        .concat();
        for (bytes, name) in [
            ([gzip(&text), gzip(&text[..9])].concat(), "gzip"),
            ([zstd(&text), zstd(&text[..9])].concat(), "Zstandard"),
            ([zstd(&text), skipped].concat(), "Zstandard"),
        ] {
            let found = unpacked(&bytes, 1 << 30).expect("good data").expect(name);
            assert!(found.0 == both && found.1 == name);
        }
        assert_eq!(unpacked(b"v 0 0 0\n", 1 << 30), Ok(None));
    }

    #[test]
    fn compression_bombs_are_refused_at_the_limits() {
        let zeros = vec![0; 64 << 20];
        for bytes in [gzip(&zeros), zstd(&zeros)] {
            assert!(bytes.len() < 1 << 20);
            let message = unpacked(&bytes, 16 << 20).expect_err("too much");
            assert!(message.starts_with("a.obj.gz: "), "{message}");
            assert!(message.ends_with("(limit `bytes`)"), "{message}");
        }
    }

    #[test]
    fn damaged_data_are_refused() {
        let text: Vec<u8> = (0..9999u32).flat_map(|n| (n * n).to_le_bytes()).collect();
        for (bytes, name) in [(gzip(&text), "gzip"), (zstd(&text), "Zstandard")] {
            let message = unpacked(&bytes[..bytes.len() / 2], 1 << 30).expect_err("half of it");
            let start = format!("a.obj.gz: its {name} data cannot be unpacked: ");
            assert!(message.starts_with(&start), "{message}");
            for at in (0..bytes.len()).step_by(97) {
                let mut bytes = bytes.clone();
                bytes[at] ^= 0x55;
                let _ = unpacked(&bytes, 1 << 30);
            }
        }
    }

    #[test]
    fn utf_16_text_is_read() {
        let text = "v 0 0 0\u{e9}\u{1d11e}";
        for (mark, bytes) in [
            ([0xff, 0xfe], u16::to_le_bytes as fn(u16) -> [u8; 2]),
            ([0xfe, 0xff], u16::to_be_bytes),
        ] {
            let mut packed = mark.to_vec();
            packed.extend(text.encode_utf16().flat_map(bytes));
            let found = unpacked(&packed, 1 << 20).expect("good data");
            assert_eq!(found, Some((text.as_bytes().to_vec(), "UTF-16")));
            assert!(unpacked(&packed, 20).is_err());
        }
    }

    #[test]
    fn inner_names_lose_the_extension_of_compression() {
        for (name, inner) in [
            ("a.obj.gz", "a.obj"),
            ("b/a.ZST", "b/a"),
            ("a.obj", "a.obj"),
        ] {
            assert_eq!(inner_name(Path::new(name)), Path::new(inner));
        }
    }
}
