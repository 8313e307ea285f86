//! Bounds of the places of a packet's rays: of its cells, and of the rows of eight rays in each.

use super::{ALL_CELLS, Places, ROUNDED, TANGENT_ERROR};
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};
use crate::packet::frustum::Window;
use crate::packet::params::{CELLS, ROW, SIDE};
use crate::packet::place_box::PlaceBox;

/// The most cells touched by a triangle's bounds whose rays are tested against these bounds before set-up. Triangles
/// smaller than the ray spacing touch one cell, or four at a corner: with fewer some are set up that no ray hits; with
/// more, rays are tested for triangles large enough to have one within.
const FEW_CELLS: u32 = 4;

/// Eight boxes of places.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct PlaceBoxes {
    left: [f32; LANES],
    right: [f32; LANES],
    top: [f32; LANES],
    bottom: [f32; LANES],
}

impl PlaceBoxes {
    pub(super) const NONE: Self = Self {
        left: [0.0; LANES],
        right: [0.0; LANES],
        top: [0.0; LANES],
        bottom: [0.0; LANES],
    };

    /// Those of the eight, as bits, that a box touches.
    #[inline(always)]
    fn touched(&self, lanes: impl Lanes, by: &PlaceBox) -> u32 {
        let beside = lanes.load(&self.right).lt(lanes.splat(by.left))
            | lanes.splat(by.right).lt(lanes.load(&self.left));
        let above = lanes.load(&self.bottom).lt(lanes.splat(by.top))
            | lanes.splat(by.bottom).lt(lanes.load(&self.top));
        !(beside | above).bits() & ((1 << LANES) - 1)
    }
}

/// Centres and half extents of eight cells.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(in crate::packet) struct CellCentres {
    pub(in crate::packet) x: [f32; LANES],
    pub(in crate::packet) y: [f32; LANES],
    pub(in crate::packet) half_x: [f32; LANES],
    pub(in crate::packet) half_y: [f32; LANES],
}

impl Places {
    /// Bounds of rows and cells.
    #[inline(always)]
    pub(super) fn bound<L: Lanes>(&mut self, lanes: L) {
        for cell in 0..ALL_CELLS {
            let [mut left, mut right, mut top, mut bottom] = [lanes.splat(0.0); 4];
            for (places, least, most) in [
                (&self.x, &mut left, &mut right),
                (&self.y, &mut top, &mut bottom),
            ] {
                let mut rows = [lanes.splat(0.0); ROW];
                for (row, places_of_row) in rows.iter_mut().enumerate() {
                    let first = first_of(cell, row);
                    if let Some(eight) = places.get(first..).and_then(|rest| rest.first_chunk()) {
                        *places_of_row = lanes.load(eight);
                    }
                }
                let [a, b, c, d, e, f, g, h] = lanes.transpose(rows);
                *least = a.min(b).min(c.min(d)).min(e.min(f).min(g.min(h)));
                *most = a.max(b).max(c.max(d)).max(e.max(f).max(g.max(h)));
            }
            let rows = &mut self.rows[cell];
            left.store(&mut rows.left);
            right.store(&mut rows.right);
            top.store(&mut rows.top);
            bottom.store(&mut rows.bottom);
            let zero = lanes.splat(0.0);
            let (half, lane) = (cell / LANES, cell % LANES);
            let cells = &mut self.cells[half];
            cells.left[lane] = left.reduce_min();
            cells.right[lane] = -(zero - right).reduce_min();
            cells.top[lane] = top.reduce_min();
            cells.bottom[lane] = -(zero - bottom).reduce_min();
        }
        self.around = PlaceBox::EMPTY;
        for cell in 0..ALL_CELLS {
            let cell = self.cell(cell);
            self.around.left = self.around.left.min(cell.left);
            self.around.right = self.around.right.max(cell.right);
            self.around.top = self.around.top.min(cell.top);
            self.around.bottom = self.around.bottom.max(cell.bottom);
        }
        for (cells, centres) in self.cells.iter().zip(&mut self.centres) {
            // The rounding is covered by the bound in `interval_zbuffer::at_places`.
            let half = |least: f32, most: f32| (most - least) * 0.5;
            for lane in 0..LANES {
                centres.x[lane] = (cells.left[lane] + cells.right[lane]) * 0.5;
                centres.y[lane] = (cells.top[lane] + cells.bottom[lane]) * 0.5;
                centres.half_x[lane] = half(cells.left[lane], cells.right[lane]);
                centres.half_y[lane] = half(cells.top[lane], cells.bottom[lane]);
            }
        }
    }

    /// Windows of the packet's four columns of cells (to the right) and four rows of cells (upwards), in pairs.
    pub(in crate::packet) fn cell_windows(&self) -> [Window; CELLS] {
        let step = self.view.plane().step;
        std::array::from_fn(|index| {
            let mut all = PlaceBox::EMPTY;
            for other in 0..CELLS {
                let column = self.cell(other * CELLS + index);
                let row = self.cell(index * CELLS + other);
                all.left = all.left.min(column.left);
                all.right = all.right.max(column.right);
                all.top = all.top.min(row.top);
                all.bottom = all.bottom.max(row.bottom);
            }
            self.window_of(&all)
                .grown(ROUNDED * step + TANGENT_ERROR + self.beside)
        })
    }

    fn cell(&self, cell: usize) -> PlaceBox {
        let (cells, lane) = (&self.cells[cell / LANES], cell % LANES);
        PlaceBox {
            left: cells.left[lane],
            right: cells.right[lane],
            top: cells.top[lane],
            bottom: cells.bottom[lane],
        }
    }

    /// The cells that a box touches, as bits.
    #[inline(always)]
    pub(in crate::packet) fn cells_touched(&self, lanes: impl Lanes, by: &PlaceBox) -> u32 {
        let mut touched = 0;
        for (half, cells) in self.cells.iter().enumerate() {
            touched |= cells.touched(lanes, by) << (half * LANES);
        }
        touched
    }

    /// The rows of a cell that a box touches, as bits.
    #[inline(always)]
    pub(in crate::packet) fn rows_touched(
        &self,
        lanes: impl Lanes,
        cell: usize,
        by: &PlaceBox,
    ) -> u32 {
        self.rows[cell % ALL_CELLS].touched(lanes, by)
    }

    /// Whether a ray of these cells (as bits) lies within a box; always where there are many cells.
    #[inline(always)]
    pub(in crate::packet) fn has_ray_within(
        &self,
        lanes: impl Lanes,
        mut cells: u32,
        by: &PlaceBox,
    ) -> bool {
        if cells.count_ones() > FEW_CELLS {
            return true;
        }
        let (left, right) = (lanes.splat(by.left), lanes.splat(by.right));
        let (top, bottom) = (lanes.splat(by.top), lanes.splat(by.bottom));
        while cells != 0 {
            let cell = cells.trailing_zeros() as usize;
            cells &= cells - 1;
            let mut rows = self.rows_touched(lanes, cell, by);
            while rows != 0 {
                let first = first_of(cell, rows.trailing_zeros() as usize);
                rows &= rows - 1;
                let (x, y) = self.eight(first);
                let (x, y) = (lanes.load(x), lanes.load(y));
                let beside = x.lt(left) | right.lt(x) | y.lt(top) | bottom.lt(y);
                if beside.bits() & ((1 << LANES) - 1) != (1 << LANES) - 1 {
                    return true;
                }
            }
        }
        false
    }

    /// The centres of eight cells, the first eight or the last.
    #[inline(always)]
    pub(in crate::packet) fn centres(&self, half: usize) -> &CellCentres {
        &self.centres[half % (ALL_CELLS / LANES)]
    }
}

/// The first ray of a cell's row.
#[inline(always)]
pub(in crate::packet) fn first_of(cell: usize, row: usize) -> usize {
    (cell / CELLS * ROW + row) * SIDE + cell % CELLS * ROW
}
