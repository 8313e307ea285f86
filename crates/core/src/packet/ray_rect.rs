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

    /// The rays of a lattice through a rectangle of its pixels.
    pub(super) fn of(rect: Rect) -> Self {
        Self {
            column: rect.x,
            row: rect.y,
            columns: rect.width,
            rows: rect.height,
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
}
