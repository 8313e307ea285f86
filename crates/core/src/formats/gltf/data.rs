//! A glTF file's bytes: buffers, buffer views, and accessors.

use super::json::{Accessor, Root, Sparse};
use crate::formats::Progress;
use crate::formats::error::{FormatError, quote};
use crate::formats::files::{Contents, Files, NamedBy, beside};
use crate::formats::limits::Share;
use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;
use rayon::prelude::*;
use std::cell::OnceCell;
use std::ops::Deref;
use std::path::{Path, PathBuf};

/// Base64 as in data URIs; padding is optional, since some writers omit it.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// The fewest elements for which two threads are used: with fewer, starting a task takes longer than it saves.
pub(super) const TOGETHER: usize = 1 << 13;

/// A glTF file and the resources that it names, each read on first use.
pub(super) struct Data<'d> {
    pub(super) path: &'d Path,
    pub(super) root: &'d Root<'d>,
    pub(super) files: &'d dyn Files,
    /// A GLB's binary chunk.
    binary: Option<&'d [u8]>,
    buffers: Vec<OnceCell<Bytes<'d>>>,
}

/// Borrowed or owned bytes.
pub(super) enum Bytes<'d> {
    Binary(&'d [u8]),
    File(Contents<'d>, PathBuf),
    Decoded { bytes: Vec<u8>, _share: Share<'d> },
}

impl Deref for Bytes<'_> {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::Binary(bytes) => bytes,
            Self::File(contents, _) => contents,
            Self::Decoded { bytes, .. } => bytes,
        }
    }
}

/// The message for an index out of range.
fn no_such(index: u32, count: usize, what: &str) -> String {
    format!("number {index}, of {count} {what}")
}

impl<'d> Data<'d> {
    pub(super) fn new(
        path: &'d Path,
        root: &'d Root<'d>,
        binary: Option<&'d [u8]>,
        files: &'d dyn Files,
    ) -> Self {
        Self {
            path,
            root,
            files,
            binary,
            buffers: root.buffers.iter().map(|_| OnceCell::new()).collect(),
        }
    }

    /// An error at a position in the JSON.
    pub(super) fn fault(&self, location: &str, expected: &str, found: &str) -> FormatError {
        let reason = format!("{location}: expected {expected}, found {found}");
        FormatError::refused(self.path, None, &reason)
    }

    /// An item of one of the file's lists, by index.
    pub(super) fn one<'l, T>(
        &self,
        list: &'l [T],
        index: u32,
        location: &str,
        what: &str,
    ) -> Result<&'l T, FormatError> {
        list.get(index as usize).ok_or_else(|| {
            let found = no_such(index, list.len(), what);
            self.fault(location, &format!("one of the file's {what}"), &found)
        })
    }

    /// The bytes of a URI: embedded, or of a file beside this one.
    pub(super) fn resource(&self, location: &str, uri: &str) -> Result<Bytes<'d>, FormatError> {
        let budget = self.files.budget();
        if let Some(data) = uri.strip_prefix("data:") {
            let Some((kind, data)) = data.split_once(',') else {
                return Err(self.fault(location, "`,` in a data URI", &quote(data)));
            };
            let share = budget.share(self.path, "a data URI", data.len() as u64)?;
            let bytes = if kind.ends_with(";base64") {
                BASE64
                    .decode(data)
                    .map_err(|error| self.fault(location, "base64", &error.to_string()))?
            } else {
                percent_decode_str(data).collect()
            };
            return Ok(Bytes::Decoded {
                bytes,
                _share: share,
            });
        }
        if uri.contains("://") {
            let found = format!("{}, which is not fetched", quote(uri));
            return Err(self.fault(location, "a file", &found));
        }
        let path = self.path_of(uri);
        let none: Progress<'_> = &|_| ();
        let contents = self.files.read(&path, NamedBy::Mesh(self.path), none)?;
        Ok(Bytes::File(contents, path))
    }

    /// Remembers the files of all buffers and images, whether they are shown or not.
    pub(super) fn name_files(&self) {
        let buffers = self.root.buffers.iter().map(|buffer| &*buffer.uri);
        let images = self.root.images.iter().map(|image| &*image.uri);
        let is_file =
            |uri: &&str| !uri.is_empty() && !uri.starts_with("data:") && !uri.contains("://");
        for uri in buffers.chain(images).filter(is_file) {
            self.files.name(&self.path_of(uri));
        }
    }

    /// The file that a URI names.
    fn path_of(&self, uri: &str) -> PathBuf {
        beside(self.path, &percent_decode_str(uri).decode_utf8_lossy())
    }

    /// A buffer's bytes.
    fn buffer(&self, index: u32, location: &str) -> Result<&[u8], FormatError> {
        let buffer = self.one(&self.root.buffers, index, location, "buffers")?;
        let location = format!("buffers[{index}]");
        let cell = self.one(&self.buffers, index, &location, "buffers")?;
        if cell.get().is_none() {
            let bytes = match (&*buffer.uri, self.binary) {
                ("", Some(binary)) if index == 0 => Bytes::Binary(binary),
                ("", _) => {
                    return Err(self.fault(&location, "a URI, or a GLB's binary chunk", "none"));
                }
                (uri, _) => self.resource(&location, uri).map_err(|error| match error {
                    FormatError::Io { .. } => {
                        let reason = format!("{location}: {error}");
                        FormatError::refused(self.path, None, &reason)
                    }
                    error => error,
                })?,
            };
            // The cell was empty, and no other thread has it.
            let _ = cell.set(bytes);
        }
        let bytes: &[u8] = cell.get().map_or(&[], |bytes| bytes);
        match usize::try_from(buffer.byte_length) {
            Ok(length) if length <= bytes.len() => Ok(&bytes[..length]),
            _ => {
                let expected = format!("{} bytes", buffer.byte_length);
                Err(self.fault(&location, &expected, &bytes.len().to_string()))
            }
        }
    }

    /// A buffer view's bytes and stride.
    pub(super) fn view(
        &self,
        index: u32,
        location: &str,
    ) -> Result<(&[u8], Option<u64>), FormatError> {
        let view = self.one(&self.root.buffer_views, index, location, "buffer views")?;
        let location = format!("bufferViews[{index}]");
        let buffer = self.buffer(view.buffer, &location)?;
        let bytes = part(buffer, view.byte_offset, view.byte_length).ok_or_else(|| {
            let expected = format!("a part of the buffer's {} bytes", buffer.len());
            let found = format!("{} from {}", view.byte_length, view.byte_offset);
            self.fault(&location, &expected, &found)
        })?;
        Ok((bytes, view.byte_stride))
    }

    /// An accessor, after checking every offset, stride and count. `shapes` are the expected types.
    pub(super) fn accessor(
        &self,
        index: u32,
        location: &str,
        shapes: &[&str],
    ) -> Result<Numbers<'_>, FormatError> {
        let accessor = self.one(&self.root.accessors, index, location, "accessors")?;
        let location = format!("accessors[{index}]");
        let Accessor {
            component_type,
            normalized,
            count,
            ..
        } = *accessor;
        if !shapes.contains(&&*accessor.shape) {
            return Err(self.fault(&location, &shapes.join(" or "), &quote(&accessor.shape)));
        }
        let component = self.component(component_type, &location)?;
        let width = match &*accessor.shape {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            _ => 4,
        };
        let size = component.size() * width;
        let (bytes, stride) = match accessor.buffer_view {
            Some(view) => {
                let (bytes, stride) = self.view(view, &location)?;
                let stride = stride.unwrap_or(size as u64);
                if stride < size as u64 {
                    let expected = format!("a stride of {size} bytes or more");
                    return Err(self.fault(&location, &expected, &stride.to_string()));
                }
                let strided = (count, stride, size);
                let bytes = self.elements(&location, bytes, accessor.byte_offset, strided)?;
                (bytes, stride)
            }
            None => {
                self.check_zeros(&location, count)?;
                (&[][..], 0)
            }
        };
        let sparse = accessor.sparse.as_ref();
        let sparse = sparse.map(|sparse| self.sparse(sparse, &location, (count, size)));
        Ok(Numbers {
            bytes,
            stride: stride as usize,
            component,
            normalized,
            count: count as usize,
            width,
            sparse: sparse.transpose()?,
        })
    }

    /// Limits the count of an accessor of zeros, which takes no bytes in the file, to the length of the file's buffers.
    fn check_zeros(&self, location: &str, count: u64) -> Result<(), FormatError> {
        let mut most = 0;
        for buffer in 0..self.buffers.len() as u32 {
            most += self.buffer(buffer, location)?.len() as u64;
        }
        if count <= most {
            return Ok(());
        }
        let expected = format!("at most {most} elements, one for each byte of the buffers");
        Err(self.fault(location, &expected, &count.to_string()))
    }

    /// The elements, of `count` of `size` bytes each, that have other values: their indices, and the bytes of the values.
    fn sparse(
        &self,
        sparse: &Sparse,
        location: &str,
        (count, size): (u64, usize),
    ) -> Result<(Vec<u32>, &[u8]), FormatError> {
        let location = format!("{location}.sparse");
        if sparse.count > count {
            let expected = format!("at most {count} elements");
            return Err(self.fault(&location, &expected, &sparse.count.to_string()));
        }
        let indices = &sparse.indices;
        let kind = self.component(indices.component_type, &location)?;
        let bytes = self.view(indices.buffer_view, &location)?.0;
        let packed = (sparse.count, kind.size() as u64, kind.size());
        let at = Numbers {
            bytes: self.elements(&location, bytes, indices.byte_offset, packed)?,
            stride: kind.size(),
            component: kind,
            normalized: false,
            count: sparse.count as usize,
            width: 1,
            sparse: None,
        };
        let at = self.indices(&at, &location)?;
        if let Some(&outside) = at.iter().find(|&&at| u64::from(at) >= count) {
            let expected = format!("indices below {count}");
            return Err(self.fault(&location, &expected, &outside.to_string()));
        }
        let bytes = self.view(sparse.values.buffer_view, &location)?.0;
        let packed = (sparse.count, size as u64, size);
        let values = self.elements(&location, bytes, sparse.values.byte_offset, packed)?;
        Ok((at, values))
    }

    /// The bytes of `count` elements of `size` bytes, `stride` apart.
    fn elements<'b>(
        &self,
        location: &str,
        bytes: &'b [u8],
        offset: u64,
        (count, stride, size): (u64, u64, usize),
    ) -> Result<&'b [u8], FormatError> {
        let length = match count.checked_sub(1) {
            None => Some(0),
            Some(before) => before
                .checked_mul(stride)
                .and_then(|before| before.checked_add(size as u64)),
        };
        length
            .and_then(|length| part(bytes, offset, length))
            .ok_or_else(|| {
                let expected = format!("{count} elements {stride} bytes apart, from byte {offset}");
                let found = format!("a view of {} bytes", bytes.len());
                self.fault(location, &expected, &found)
            })
    }

    fn component(&self, number: u32, location: &str) -> Result<Component, FormatError> {
        Ok(match number {
            5120 => Component::I8,
            5121 => Component::U8,
            5122 => Component::I16,
            5123 => Component::U16,
            5125 => Component::U32,
            5126 => Component::F32,
            other => {
                let expected = "a component type (5120 to 5123, 5125 or 5126)";
                return Err(self.fault(location, expected, &other.to_string()));
            }
        })
    }

    /// An accessor's integers, as indices.
    pub(super) fn indices(
        &self,
        numbers: &Numbers<'_>,
        location: &str,
    ) -> Result<Vec<u32>, FormatError> {
        if !matches!(
            numbers.component,
            Component::U8 | Component::U16 | Component::U32
        ) {
            let found = "signed ones or fractions";
            return Err(self.fault(location, "unsigned numbers", found));
        }
        Ok(numbers.values([0.0], |[index]| index as u32))
    }
}

/// `length` bytes from an offset, if they exist.
fn part(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(offset).ok()?;
    let end = usize::try_from(offset.checked_add(length)?).ok()?;
    bytes.get(start..end)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The number in its bytes, of which there must be enough.
    #[inline(always)]
    fn read(self, bytes: &[u8], normalized: bool) -> f64 {
        let unsigned = |value: u32, most: u32| match normalized {
            true => f64::from(value) / f64::from(most),
            false => f64::from(value),
        };
        let signed = |value: i32, most: i32| match normalized {
            true => (f64::from(value) / f64::from(most)).max(-1.0),
            false => f64::from(value),
        };
        match (self, bytes) {
            (Self::I8, &[a, ..]) => signed((a as i8).into(), i8::MAX.into()),
            (Self::U8, &[a, ..]) => unsigned(a.into(), u8::MAX.into()),
            (Self::I16, &[a, b, ..]) => signed(i16::from_le_bytes([a, b]).into(), i16::MAX.into()),
            (Self::U16, &[a, b, ..]) => {
                unsigned(u16::from_le_bytes([a, b]).into(), u16::MAX.into())
            }
            (Self::U32, &[a, b, c, d, ..]) => unsigned(u32::from_le_bytes([a, b, c, d]), u32::MAX),
            (Self::F32, &[a, b, c, d, ..]) => f32::from_le_bytes([a, b, c, d]).into(),
            _ => 0.0,
        }
    }
}

/// An accessor's data: `count` elements of `width` numbers.
pub(super) struct Numbers<'d> {
    /// From the first element to the last; empty where all are zero.
    bytes: &'d [u8],
    stride: usize,
    component: Component,
    normalized: bool,
    pub(super) count: usize,
    width: usize,
    /// Sparse values: their indices, and the values.
    sparse: Option<(Vec<u32>, &'d [u8])>,
}

impl Numbers<'_> {
    /// The elements as `make` converts them; numbers that an element lacks are taken from `default`.
    pub(super) fn values<const N: usize, T: Clone + Send>(
        &self,
        default: [f64; N],
        make: impl Fn([f64; N]) -> T + Sync,
    ) -> Vec<T> {
        let width = self.width.min(N);
        let size = self.component.size();
        let element = |bytes: &[u8]| {
            let mut numbers = default;
            for (number, bytes) in numbers[..width].iter_mut().zip(bytes.chunks(size)) {
                *number = self.component.read(bytes, self.normalized);
            }
            make(numbers)
        };
        let mut values: Vec<T> = if self.bytes.is_empty() {
            let mut zero = default;
            zero[..width].fill(0.0);
            vec![make(zero); self.count]
        } else {
            let at = |index: usize| &self.bytes[index * self.stride..];
            let indices = (0..self.count).into_par_iter().with_min_len(TOGETHER);
            indices.map(|index| element(at(index))).collect()
        };
        if let Some((at, replaced)) = &self.sparse {
            let replaced = replaced.chunks_exact(size * self.width);
            for (&location, bytes) in at.iter().zip(replaced) {
                if let Some(value) = values.get_mut(location as usize) {
                    *value = element(bytes);
                }
            }
        }
        values
    }
}
