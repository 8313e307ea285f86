use super::Layers;
use std::ops::Range;

/// Neighbouring samples of a row of [`Layers`]: as many values of each layer.
#[derive(Debug)]
pub struct LayerRow<'p> {
    /// As [`Layers::color`].
    pub color: &'p mut [[f32; 4]],
    /// As [`Layers::depth`].
    pub depth: &'p mut [f32],
    /// As [`Layers::object`].
    pub object: &'p mut [u32],
    /// As [`Layers::triangle`].
    pub triangle: &'p mut [u32],
    /// As [`Layers::normal`].
    pub normal: &'p mut [[f32; 3]],
    /// As [`Layers::uv`].
    pub uv: &'p mut [[f32; 2]],
}

impl Layers {
    /// All samples, one row after another.
    pub(super) fn all(&mut self) -> LayerRow<'_> {
        LayerRow {
            color: &mut self.color,
            depth: &mut self.depth,
            object: &mut self.object,
            triangle: &mut self.triangle,
            normal: &mut self.normal,
            uv: &mut self.uv,
        }
    }

    /// The rows, of so many columns.
    pub(crate) fn rows(&mut self, columns: usize) -> impl Iterator<Item = LayerRow<'_>> {
        let mut left = self.all();
        std::iter::from_fn(move || (!left.depth.is_empty()).then(|| left.split_off(columns.max(1))))
    }
}

impl<'p> LayerRow<'p> {
    /// Splits off the first samples, or as many as there are.
    pub(super) fn split_off(&mut self, columns: usize) -> Self {
        fn first<'p, T>(values: &mut &'p mut [T], columns: usize) -> &'p mut [T] {
            let count = columns.min(values.len());
            values.split_off_mut(..count).unwrap_or_default()
        }
        Self {
            color: first(&mut self.color, columns),
            depth: first(&mut self.depth, columns),
            object: first(&mut self.object, columns),
            triangle: first(&mut self.triangle, columns),
            normal: first(&mut self.normal, columns),
            uv: first(&mut self.uv, columns),
        }
    }

    /// Some of the samples; none where the row has not all of them.
    pub(super) fn part(&mut self, columns: Range<usize>) -> LayerRow<'_> {
        fn part<T>(values: &mut [T], columns: Range<usize>) -> &mut [T] {
            values.get_mut(columns).unwrap_or_default()
        }
        LayerRow {
            color: part(self.color, columns.clone()),
            depth: part(self.depth, columns.clone()),
            object: part(self.object, columns.clone()),
            triangle: part(self.triangle, columns.clone()),
            normal: part(self.normal, columns.clone()),
            uv: part(self.uv, columns),
        }
    }

    /// Copies samples, from one of [`Layers`] on, into those from `column` on: as many as `count`. Copies nothing where
    /// either has not as many.
    pub(super) fn copy(&mut self, column: usize, layers: &Layers, from: usize, count: usize) {
        fn copy<T: Copy>(to: &mut [T], to_range: Range<usize>, from: &[T], range: Range<usize>) {
            if let (Some(to), Some(from)) = (to.get_mut(to_range), from.get(range)) {
                to.copy_from_slice(from);
            }
        }
        let (to, from) = (column..column + count, from..from + count);
        copy(self.color, to.clone(), &layers.color, from.clone());
        copy(self.depth, to.clone(), &layers.depth, from.clone());
        copy(self.object, to.clone(), &layers.object, from.clone());
        copy(self.triangle, to.clone(), &layers.triangle, from.clone());
        copy(self.normal, to.clone(), &layers.normal, from.clone());
        copy(self.uv, to, &layers.uv, from);
    }
}
