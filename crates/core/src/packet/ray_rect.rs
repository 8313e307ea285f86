use crate::camera::{Lattice, Rect};

/// A rectangle of a lattice's rays.
#[derive(Clone, Copy)]
pub(super) struct RayRect {
    pub(super) column: u32,
    pub(super) row: u32,
    pub(super) columns: u32,
    pub(super) rows: u32,
}

impl RayRect {
    /// All rays of a lattice.
    #[inline(always)]
    pub(super) fn all(lattice: &Lattice) -> Self {
        Self {
            column: 0,
            row: 0,
            columns: lattice.columns,
            rows: lattice.rows,
        }
    }

    /// Splits it into rectangles of at most `side × side` rays.
    #[inline(always)]
    pub(super) fn split(self, side: u32) -> impl Iterator<Item = Self> {
        let (right, bottom) = (self.column + self.columns, self.row + self.rows);
        (self.row..bottom)
            .step_by(side as usize)
            .flat_map(move |row| {
                (self.column..right)
                    .step_by(side as usize)
                    .map(move |column| Self {
                        column,
                        row,
                        columns: side.min(right - column),
                        rows: side.min(bottom - row),
                    })
            })
    }

    /// The same rectangle as pixels of the lattice.
    pub(super) fn rect(&self) -> Rect {
        Rect {
            x: self.column,
            y: self.row,
            width: self.columns,
            height: self.rows,
        }
    }

    /// Splits it before these columns and rows.
    pub(super) fn split_at(self, [columns, rows]: [Vec<u32>; 2]) -> impl Iterator<Item = Self> {
        let ends = |cuts: Vec<u32>, first: u32, count: u32| {
            let end = first + count;
            let cuts = cuts
                .into_iter()
                .filter(move |cut| (first + 1..end).contains(cut));
            let mut from = first;
            let ranges = cuts
                .chain([end])
                .map(move |to| (std::mem::replace(&mut from, to), to));
            ranges.collect::<Vec<_>>()
        };
        let columns = ends(columns, self.column, self.columns);
        let rows = ends(rows, self.row, self.rows);
        rows.into_iter().flat_map(move |(top, bottom)| {
            let part = move |&(left, right): &(u32, u32)| Self {
                column: left,
                row: top,
                columns: right - left,
                rows: bottom - top,
            };
            columns.iter().map(part).collect::<Vec<_>>()
        })
    }
}
