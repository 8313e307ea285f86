//! The directions of a packet's rays in the camera's axes.

use super::{Places, fill};
use crate::camera::{LensRegion, PanoramaRays, Rect};
use crate::num::simd::LANES;
use crate::packet::params::{ROW, SIDE};

/// The most rectangles of a packet through a lens that wait to be examined: three beside each of its quarters, eighths
/// and cells.
const MOST_RECTS: usize = 10;

const ONES: [f64; LANES] = [1.0; LANES];

impl Places {
    /// Computes the directions of all rays, in the camera's axes. Returns whether there are any rays.
    #[inline(always)]
    pub(super) fn find_directions(
        &mut self,
        rays: &PanoramaRays,
        packet: Rect,
        region: Option<LensRegion>,
    ) -> bool {
        self.has_ray = [0; SIDE];
        if rays.are_through_a_lens() {
            self.find_directions_through_lens(rays, packet, region);
        } else {
            self.find_directions_exactly(rays, packet, (0, 0));
        }
        let Some(row) = self.has_ray.iter().rposition(|&has| has != 0) else {
            return false;
        };
        let column = self.has_ray[row].trailing_zeros() as usize;
        let [x, y, z] = &mut self.directions;
        fill(&self.has_ray, row * SIDE + column, [x, y, z]);
        true
    }

    /// Computes the directions of some of the packet's rays, the first of which is in this column and row of it.
    #[inline(always)]
    fn find_directions_exactly(
        &mut self,
        rays: &PanoramaRays,
        rect: Rect,
        (column, row): (u32, u32),
    ) {
        let mut eight = [[0.0; LANES]; 3];
        let expansion = rays.expansion(rect);
        for y in 0..rect.height {
            for x in (0..rect.width).step_by(ROW) {
                let at = (rect.x + x, rect.y + y);
                let has = rays.nearly_eight(expansion.as_ref(), at, &mut eight);
                self.keep_eight(eight, has, (column + x, row + y), rect.width - x);
            }
        }
    }

    /// Keeps directions of eight rays, or of as many as `count`, and which of them there are, as bits.
    #[inline(always)]
    fn keep_eight(
        &mut self,
        eight: [[f64; LANES]; 3],
        has: u32,
        (column, row): (u32, u32),
        count: u32,
    ) {
        let at = row as usize * SIDE + column as usize;
        for (all, eight) in self.directions.iter_mut().zip(&eight) {
            if let Some(all) = all.get_mut(at..at + LANES) {
                all.copy_from_slice(eight);
            }
        }
        let in_rect = (1 << count.min(LANES as u32)) - 1;
        self.has_ray[row as usize % SIDE] |= (has & in_rect) << column;
    }

    /// Computes directions through a lens. A rectangle of which not all is known is quartered: of smaller ones more is.
    #[inline(always)]
    fn find_directions_through_lens(
        &mut self,
        rays: &PanoramaRays,
        packet: Rect,
        region: Option<LensRegion>,
    ) {
        let mut rest = [(packet, (0, 0), region); MOST_RECTS];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (rect, place, region) = rest[count];
            if let Some(region) = region {
                self.find_directions_of_region((rays, &region), rect, place);
                continue;
            }
            if rays.has_surely_none(rect) {
                continue;
            }
            let half = rect.width.max(rect.height).div_ceil(2);
            if half < ROW as u32 {
                self.find_directions_exactly(rays, rect, place);
                continue;
            }
            // Whole eights of columns.
            let half = half.next_multiple_of(ROW as u32);
            for (x, y) in [(0, 0), (half, 0), (0, half), (half, half)] {
                if x < rect.width && y < rect.height {
                    let quarter = Rect {
                        x: rect.x + x,
                        y: rect.y + y,
                        width: (rect.width - x).min(half),
                        height: (rect.height - y).min(half),
                    };
                    let place = (place.0 + x, place.1 + y);
                    rest[count] = (quarter, place, rays.lens_region(quarter));
                    count += 1;
                }
            }
        }
    }

    /// Directions of rays through a lens, of which all is known in the whole rectangle. Newton's method starts from the
    /// quadratic extrapolation of the three rows above; in the first row from the linear one of the rays beside.
    #[inline(always)]
    fn find_directions_of_region(
        &mut self,
        (rays, region): (&PanoramaRays, &LensRegion),
        rect: Rect,
        (column, row): (u32, u32),
    ) {
        let mut beside = None;
        for x in (0..rect.width).step_by(ROW) {
            let mut above = [[[0.0; LANES]; 2]; 3];
            for y in 0..rect.height {
                let at = (rect.x + x, rect.y + y);
                let start = match y {
                    0 => beside,
                    1 | 2 => Some(above[0]),
                    _ => Some(extrapolated(&above)),
                };
                let near = match start {
                    Some(start) => rays.eight_through_lens(region, at.0, at.1, start),
                    None => None,
                };
                let found = match near {
                    Some(found) => found,
                    None => {
                        let mut exact = [[0.0; LANES]; 3];
                        rays.nearly_eight(None, at, &mut exact);
                        [exact[0], exact[1]]
                    }
                };
                let eight = [found[0], found[1], ONES];
                self.keep_eight(eight, u32::MAX, (column + x, row + y), rect.width - x);
                if y == 0 {
                    beside = Some(extrapolated_to_the_right(&found));
                }
                above = [found, above[0], above[1]];
            }
        }
    }
}

/// The quadratic extrapolation of three values at equal steps, the last one first.
#[inline(always)]
fn extrapolated([a, b, c]: &[[[f64; LANES]; 2]; 3]) -> [[f64; LANES]; 2] {
    let mut next = [[0.0; LANES]; 2];
    for axis in 0..2 {
        for lane in 0..LANES {
            next[axis][lane] = 3.0 * (a[axis][lane] - b[axis][lane]) + c[axis][lane];
        }
    }
    next
}

/// The linear extrapolation of the last two of eight values of a row to the eight after them.
#[inline(always)]
fn extrapolated_to_the_right(eight: &[[f64; LANES]; 2]) -> [[f64; LANES]; 2] {
    let mut next = [[0.0; LANES]; 2];
    for axis in 0..2 {
        let [before, last] = [eight[axis][LANES - 2], eight[axis][LANES - 1]];
        for (lane, next) in next[axis].iter_mut().enumerate() {
            *next = last + (last - before) * (lane + 1) as f64;
        }
    }
    next
}
