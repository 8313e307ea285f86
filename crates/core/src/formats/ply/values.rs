//! The numbers of a PLY's body, in order.

use super::header::Scalar;
use super::layout::{Columns, Layout, Row, SCALAR, index};
use crate::formats::error::FormatError;
use crate::formats::tokens::{Found, Tokens};
use rayon::prelude::*;
use std::path::Path;

/// A source of numbers, with fast paths for many at once.
pub(super) trait Values {
    /// The next number.
    fn value(&mut self, kind: Scalar) -> Result<f64, Found>;

    /// The number of bytes left.
    fn left(&self) -> usize;

    /// The fewest bytes that a number takes.
    fn min_bytes(kind: Scalar) -> usize;

    /// The error that the last number is something other than `expected`.
    fn fault(&self, path: &Path, expected: &str, found: &Found) -> FormatError;

    /// The numbers of the next list.
    #[inline]
    fn list(
        &mut self,
        length: Scalar,
        kind: Scalar,
        mut each: impl FnMut(f64),
    ) -> Result<(), Found> {
        let length = self.value(length)?;
        if !(length >= 0.0 && length.fract() == 0.0) {
            return Err(Found::Word(format!("a list of length {length}")));
        }
        // An excessive length runs out of numbers.
        for _ in 0..length as u64 {
            each(self.value(kind)?);
        }
        Ok(())
    }

    /// As many vertices as the columns have room for.
    fn vertices(
        &mut self,
        layout: &Layout,
        columns: Columns<'_>,
        step: &dyn Fn(f32),
    ) -> Result<(), Found>
    where
        Self: Sized,
    {
        in_order(self, layout, columns, step)
    }

    /// `count` faces whose list at index `indices` has three vertices below `vertices`; their numbers go to
    /// `scalars`. `None`, without reading anything, where faces are different or there is no fast path.
    fn triangles(
        &mut self,
        _layout: &Layout,
        _indices: usize,
        _count: usize,
        _vertices: u32,
        _scalars: &mut [Vec<f32>],
    ) -> Option<Vec<[u32; 3]>> {
        None
    }
}

/// Vertices one after another.
fn in_order<V: Values>(
    values: &mut V,
    layout: &Layout,
    mut columns: Columns<'_>,
    step: &dyn Fn(f32),
) -> Result<(), Found> {
    let count = columns.len();
    for vertex in 0..count {
        let mut row = Row::default();
        for (property, role) in &layout.properties {
            match property.length {
                None => {
                    let value = values.value(property.kind)?;
                    match row.get_mut(*role) {
                        Some(place) => *place = value,
                        None => columns.set_scalar(vertex, *role, value),
                    }
                }
                Some(length) => values.list(length, property.kind, |_| ())?,
            }
        }
        columns.set(vertex, &row, layout);
        if vertex % 65_536 == 0 {
            step(vertex as f32 / count as f32);
        }
    }
    Ok(())
}

/// Numbers as text.
pub(super) struct Ascii<'t> {
    tokens: Tokens<'t>,
    bytes: usize,
}

impl<'t> Ascii<'t> {
    pub(super) fn new(bytes: &'t [u8], at: usize) -> Self {
        Self {
            tokens: Tokens::new(bytes, at, None),
            bytes: bytes.trim_ascii_end().len(),
        }
    }
}

impl Values for Ascii<'_> {
    #[inline]
    fn value(&mut self, _: Scalar) -> Result<f64, Found> {
        self.tokens.number()
    }

    fn left(&self) -> usize {
        self.bytes.saturating_sub(self.tokens.at())
    }

    /// A digit and a separator.
    fn min_bytes(_: Scalar) -> usize {
        2
    }

    fn fault(&self, path: &Path, expected: &str, found: &Found) -> FormatError {
        self.tokens.fault(path, expected, found)
    }
}

/// Binary numbers, big-endian if `BIG`.
pub(super) struct Binary<'t, const BIG: bool> {
    bytes: &'t [u8],
    at: usize,
}

/// Vertices or faces in one parallel task.
const TASK: usize = 1 << 14;

impl<'t, const BIG: bool> Binary<'t, BIG> {
    pub(super) fn new(bytes: &'t [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    #[inline]
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Found> {
        let bytes = self.bytes.get(self.at..).and_then(<[u8]>::first_chunk::<N>);
        let mut bytes = *bytes.ok_or(Found::End)?;
        self.at += N;
        if BIG {
            bytes.reverse();
        }
        Ok(bytes)
    }

    /// Vertices of a constant size, in parallel halves.
    fn all_vertices(bytes: &[u8], stride: usize, layout: &Layout, columns: Columns<'_>) {
        let count = columns.len();
        if count > TASK {
            let half = count / 2;
            let (first, others) = columns.split(half);
            let (left, right) = bytes.split_at(half * stride);
            rayon::join(
                || Self::all_vertices(left, stride, layout, first),
                || Self::all_vertices(right, stride, layout, others),
            );
            return;
        }
        // The number of bytes was checked.
        let _ = in_order(&mut Binary::<BIG>::new(bytes, 0), layout, columns, &|_| ());
    }
}

impl<const BIG: bool> Values for Binary<'_, BIG> {
    #[inline]
    fn value(&mut self, kind: Scalar) -> Result<f64, Found> {
        Ok(match kind {
            Scalar::I8 => i8::from_le_bytes(self.take()?).into(),
            Scalar::U8 => u8::from_le_bytes(self.take()?).into(),
            Scalar::I16 => i16::from_le_bytes(self.take()?).into(),
            Scalar::U16 => u16::from_le_bytes(self.take()?).into(),
            Scalar::I32 => i32::from_le_bytes(self.take()?).into(),
            Scalar::U32 => u32::from_le_bytes(self.take()?).into(),
            Scalar::F32 => f32::from_le_bytes(self.take()?).into(),
            Scalar::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    fn min_bytes(kind: Scalar) -> usize {
        kind.bytes()
    }

    fn fault(&self, path: &Path, expected: &str, found: &Found) -> FormatError {
        let expected = format!("{expected} at byte {}", self.at);
        FormatError::unexpected(path, None, expected, found.to_string())
    }

    fn vertices(
        &mut self,
        layout: &Layout,
        columns: Columns<'_>,
        step: &dyn Fn(f32),
    ) -> Result<(), Found> {
        let Some(stride) = layout.stride() else {
            // With lists, each vertex starts where the one before ends.
            return in_order(self, layout, columns, step);
        };
        let bytes = self.bytes[self.at..].get(..stride * columns.len());
        let bytes = bytes.ok_or(Found::End)?;
        self.at += bytes.len();
        Self::all_vertices(bytes, stride, layout, columns);
        Ok(())
    }

    fn triangles(
        &mut self,
        layout: &Layout,
        indices: usize,
        count: usize,
        vertices: u32,
        scalars: &mut [Vec<f32>],
    ) -> Option<Vec<[u32; 3]>> {
        let (property, _) = layout.properties.get(indices)?;
        let (kind, length) = (property.kind, property.length?);
        let fixed = |properties: &[(super::header::Property, usize)]| -> Option<usize> {
            let bytes = properties
                .iter()
                .map(|(property, _)| property.length.is_none().then(|| property.kind.bytes()));
            bytes.sum()
        };
        let before = fixed(&layout.properties[..indices])?;
        let after = fixed(&layout.properties[indices + 1..])?;
        let stride = before + length.bytes() + 3 * kind.bytes() + after;
        let bytes = self.bytes[self.at..].get(..stride.checked_mul(count)?)?;
        let mut triangles = vec![[0; 3]; count];
        let read = |triangle: &mut [u32; 3], record| -> Option<()> {
            let mut values = Self::new(record, before);
            let is_three = values.value(length).ok()? == 3.0;
            for corner in &mut *triangle {
                *corner = index(values.value(kind).ok()?);
            }
            let are_there = triangle.iter().all(|corner| *corner < vertices);
            (is_three && are_there).then_some(())
        };
        let are_triangles = triangles
            .par_chunks_mut(TASK)
            .zip(bytes.par_chunks(TASK * stride))
            .all(|(triangles, bytes)| {
                let records = bytes.chunks_exact(stride);
                let mut all = triangles.iter_mut().zip(records);
                all.all(|(triangle, record)| read(triangle, record).is_some())
            });
        if !are_triangles {
            return None;
        }
        let list = length.bytes() + 3 * kind.bytes();
        let mut offset = 0;
        for (number, (property, role)) in layout.properties.iter().enumerate() {
            if let Some(scalar) = role.checked_sub(SCALAR).and_then(|i| scalars.get_mut(i)) {
                let value = |record| {
                    let value = Self::new(record, offset).value(property.kind);
                    // The record is as long as all of its numbers.
                    value.map_or(f32::NAN, |value| value as f32)
                };
                let records = bytes.par_chunks_exact(stride).with_min_len(TASK);
                *scalar = records.map(value).collect();
            }
            offset += match number == indices {
                true => list,
                false => property.kind.bytes(),
            };
        }
        self.at += bytes.len();
        Some(triangles)
    }
}
