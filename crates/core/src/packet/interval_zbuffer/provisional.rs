//! Small triangles, merged provisionally, without set-up. Where their coarse depths leave an order undecided they are
//! evicted and set up after all.

use super::{CELLS, IntervalZBuffer, PROVISIONAL, RAYS, ROW, SIDE, UNDECIDED};
use crate::hit::MISS;
use crate::packet::ray_box::RayBox;
use crate::packet::small_triangles::SmallCoverage;

/// The outcome of testing a small triangle.
pub(crate) enum SmallOutcome {
    /// Some ray hits the triangle first, so far.
    Merged,
    /// No ray hits the triangle, or all that do have nearer hits.
    Missed,
    /// Not merged: it cannot be decided without set-up.
    Undecided,
}

impl IntervalZBuffer {
    /// Tests a small triangle against the rays of its bounds and merges it. If the bounds leave undecided for any ray
    /// whether it hits the triangle, or which triangle is nearer, nothing is merged.
    ///
    /// One ray at a time: each triangle's rows begin at another column, and vector loads of rows that overlap earlier
    /// stores would stall on store forwarding.
    #[inline(always)]
    pub(crate) fn test_small(
        &mut self,
        coverage: &SmallCoverage,
        lane: usize,
        rays: &RayBox,
        primitive: u32,
    ) -> SmallOutcome {
        let mut inside = coverage.inside(lane);
        if inside != coverage.perhaps(lane) {
            return SmallOutcome::Undecided;
        }
        let (mut any, mut rivals) = (false, false);
        while inside != 0 {
            let ([x, y], [near_low, near_high]) = coverage.ray(lane, inside.trailing_zeros());
            inside &= inside - 1;
            let ray = (first_ray(rays) + y * SIDE + x) % RAYS;
            let (low, high, stored) = (
                &mut self.low[ray],
                &mut self.high[ray],
                &mut self.primitives[ray],
            );
            let wins = near_low > *high;
            any |= wins;
            rivals |= !wins & (near_high >= *low);
            if wins {
                (*low, *high, *stored) = (near_low, near_high, primitive | PROVISIONAL);
            }
        }
        if rivals {
            // The hits that it replaced are lost, but the triangle will be merged again after set-up and is surely
            // nearer than they were.
            self.evict(rays, primitive);
            return SmallOutcome::Undecided;
        }
        if !any {
            return SmallOutcome::Missed;
        }
        self.mark_dirty(rays);
        SmallOutcome::Merged
    }

    /// Evicts a provisional triangle whose order with a small triangle is undecided. Returns its primitive index and
    /// the bounds of its rays, for it to be set up and merged again.
    #[inline(never)]
    pub(crate) fn evict_rival(
        &mut self,
        coverage: &SmallCoverage,
        lane: usize,
        rays: &RayBox,
    ) -> Option<(u32, RayBox)> {
        let last = SIDE as i32 - 1;
        let mut perhaps = coverage.perhaps(lane);
        while perhaps != 0 {
            let ([x, y], [near_low, near_high]) = coverage.ray(lane, perhaps.trailing_zeros());
            perhaps &= perhaps - 1;
            let ray = (first_ray(rays) + y * SIDE + x) % RAYS;
            let stored = self.primitives[ray];
            let provisional = stored != MISS && stored != UNDECIDED && stored & PROVISIONAL != 0;
            if provisional && near_low <= self.high[ray] && near_high >= self.low[ray] {
                let reach = ROW as i32 - 1;
                let (x, y) = ((ray % SIDE) as i32, (ray / SIDE) as i32);
                let around = RayBox {
                    left: (x - reach).max(0),
                    right: (x + reach).min(last),
                    top: (y - reach).max(0),
                    bottom: (y + reach).min(last),
                };
                let primitive = stored & !PROVISIONAL;
                return self.evict(&around, primitive).map(|rays| (primitive, rays));
            }
        }
        None
    }

    /// Evicts a provisional triangle from the rays of a box; returns the bounds of the rays that it had won.
    ///
    /// Hi-z stays valid: the triangle will be merged again, and is surely as near as hi-z says.
    #[inline(never)]
    fn evict(&mut self, rays: &RayBox, primitive: u32) -> Option<RayBox> {
        let mut around: Option<RayBox> = None;
        for y in rays.top..=rays.bottom {
            for x in rays.left..=rays.right {
                let ray = (y as usize * SIDE + x as usize) % RAYS;
                if self.primitives[ray] == primitive | PROVISIONAL {
                    (self.low[ray], self.high[ray]) = (f32::NEG_INFINITY, f32::NEG_INFINITY);
                    self.primitives[ray] = MISS;
                    let all = around.get_or_insert(RayBox {
                        left: x,
                        right: x,
                        top: y,
                        bottom: y,
                    });
                    all.left = all.left.min(x);
                    all.right = all.right.max(x);
                    all.bottom = y;
                }
            }
        }
        around
    }

    /// Marks the cells of a box dirty: at most two in each direction.
    #[inline(always)]
    fn mark_dirty(&mut self, rays: &RayBox) {
        let columns = 1u32 << (rays.left as usize / ROW) | 1 << (rays.right as usize / ROW);
        self.dirty |= columns << (CELLS * (rays.top as usize / ROW));
        self.dirty |= columns << (CELLS * (rays.bottom as usize / ROW));
    }
}

/// The index of a box's first ray.
#[inline(always)]
fn first_ray(rays: &RayBox) -> usize {
    rays.top as usize * SIDE + rays.left as usize
}
