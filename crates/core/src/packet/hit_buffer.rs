//! The hits of a packet's rays with all triangles, unordered: an A-buffer (Carpenter, "The A-buffer, an antialiased hidden
//! surface method", 1984) with an interval of depth for each hit.

use super::interval_zbuffer::edge_functions::{EdgeFunctions, ForEachThatMayHit};
use super::interval_zbuffer::for_each_bit;
use super::occlusion::Occlusion;
use super::params::{COLUMNS, RAYS, ROW, SIDE};
use super::ray_box::RayBox;
use super::setup::TriangleSetup;
use crate::num::simd::{F32x8, Lanes, Mask8, Simd, dispatch};
use crate::single::MOST_HITS;

/// The most possible hits of a packet, four megabytes: [`MOST_HITS`] a ray, beyond which none counts. A packet with more is
/// cast ray by ray; with a smaller limit more packets are, with a larger one hostile scenes take memory.
const MOST: usize = MOST_HITS * RAYS;

/// What is known of a triangle before its hits are.
#[derive(Clone, Copy)]
pub(super) struct Surface {
    /// Whether it hides what lies behind it.
    pub(super) is_opaque: bool,
    /// Whether some of its hits may not count: clipping planes cut it, or it has a mask.
    pub(super) is_partial: bool,
}

impl Surface {
    pub(super) const OPAQUE: Self = Self {
        is_opaque: true,
        is_partial: false,
    };
}

/// A triangle that a ray may hit.
#[derive(Clone, Copy, Debug)]
pub(super) struct PossibleHit {
    /// The ray's number in the packet.
    ray: u16,
    /// Whether the ray surely hits it.
    is_sure: bool,
    pub(super) is_opaque: bool,
    pub(super) primitive: u32,
    /// Bounds of the hit's depth key, which grows towards the eye.
    low: f32,
    high: f32,
}

/// The possible hits of a packet's rays.
#[derive(Debug)]
pub(super) struct HitBuffer {
    hits: Vec<PossibleHit>,
    /// For each ray, a lower bound of the depth key of the nearest opaque triangle that it surely hits: hits that are surely
    /// further do not count. Infinite for rays that are not asked for.
    closed: [f32; RAYS],
    /// Whether `closed` is up to date in `hi_z`.
    is_dirty: bool,
    /// The least of `closed`.
    hi_z: f32,
    /// Bounds of the depth keys where orthographic rays start: no hit is nearer. Infinite for perspective packets.
    start_keys: [f32; 2],
    /// The hits ray by ray, and where those of each ray end.
    sorted: Vec<PossibleHit>,
    ends: [u32; RAYS],
}

/// The possible hits of a ray.
pub(super) struct RayHits<'h> {
    pub(super) column: u32,
    pub(super) row: u32,
    /// Nearest first, if `are_ordered`.
    pub(super) hits: &'h [PossibleHit],
    /// Whether all of them are sure, and their order too.
    pub(super) are_ordered: bool,
}

impl Default for HitBuffer {
    fn default() -> Self {
        Self {
            hits: Vec::new(),
            closed: [f32::INFINITY; RAYS],
            is_dirty: false,
            hi_z: f32::INFINITY,
            start_keys: [f32::INFINITY; 2],
            sorted: Vec::new(),
            ends: [0; RAYS],
        }
    }
}

impl HitBuffer {
    /// Clears it for a packet in which the hits of some rays, given as columns and rows, are asked for.
    pub(super) fn clear(&mut self, start_keys: [f32; 2], wanted: impl Iterator<Item = (u32, u32)>) {
        self.hits.clear();
        self.closed = [f32::INFINITY; RAYS];
        for (column, row) in wanted {
            self.closed[(row as usize * SIDE + column as usize) % RAYS] = f32::NEG_INFINITY;
        }
        self.hi_z = f32::NEG_INFINITY;
        self.is_dirty = false;
        self.start_keys = start_keys;
    }

    /// Whether it has more hits than it may have.
    pub(super) fn is_full(&self) -> bool {
        self.hits.len() > MOST
    }

    /// Adds the possible hits with triangles that are set up, each within its bounds.
    #[inline(always)]
    pub(super) fn rasterize(
        &mut self,
        (lanes, simd): (impl Lanes, Simd),
        set_up: &TriangleSetup,
        primitives: &[u32],
        surfaces: &[Surface],
    ) {
        for (l, (&primitive, &surface)) in primitives.iter().zip(surfaces).enumerate() {
            let bounds = &set_up.boxes[l];
            if bounds.right < bounds.left {
                continue;
            }
            if set_up.ill_conditioned[l] {
                self.add_each(simd, (set_up, l), primitive, surface);
            } else {
                self.add_rows(lanes, set_up, l, primitive, surface);
            }
        }
    }

    #[inline(always)]
    fn add_rows(
        &mut self,
        lanes: impl Lanes,
        set_up: &TriangleSetup,
        l: usize,
        primitive: u32,
        Surface {
            is_opaque,
            is_partial,
        }: Surface,
    ) {
        let functions = EdgeFunctions::of(set_up, l, primitive);
        let ([e, f, g], key) = (functions.edges, functions.depth_key);
        let (edge_error, key_error) = (functions.edge_error, functions.depth_key_error);
        let (error, minus_error) = (lanes.splat(edge_error), lanes.splat(-edge_error));
        let key_error = lanes.splat(key_error);
        let [in_front, behind] = self.start_keys;
        let (in_front, behind) = (lanes.splat(in_front), lanes.splat(behind));
        let RayBox {
            right, top, bottom, ..
        } = set_up.boxes[l];
        let (left, first_row) = (set_up.column[l], set_up.row[l]);
        let columns = lanes.load(&COLUMNS);
        for row in top..=bottom {
            let y = (row - first_row) as f32;
            let begin = |f: [f32; 3]| lanes.splat(f[0] + f[2] * y);
            let [e0, f0, g0, key0] = [begin(e), begin(f), begin(g), begin(key)];
            for column in (left..=right).step_by(ROW) {
                let x = columns + (column - left) as f32;
                let a = e0 + lanes.splat(e[1]) * x;
                let b = f0 + lanes.splat(f[1]) * x;
                let c = g0 + lanes.splat(g[1]) * x;
                let near = key0 + lanes.splat(key[1]) * x;
                let least = a.min(b).min(c);
                let (low, high) = (near - key_error, near + key_error);
                let first = row as usize * SIDE + column as usize;
                let closed = self
                    .closed
                    .get_mut(first..)
                    .and_then(|all| all.first_chunk_mut());
                let Some(closed) = closed else { return };
                let nearest = lanes.load(closed);
                let missed = least.lt(minus_error) | behind.lt(low) | high.lt(nearest);
                let possible = !missed.bits() & ((1 << ROW) - 1);
                if possible == 0 {
                    continue;
                }
                let sure = if is_partial {
                    0
                } else {
                    (error.lt(least) & high.lt(in_front)).bits()
                };
                let [mut lows, mut highs] = [[0.0; ROW]; 2];
                low.store(&mut lows);
                high.store(&mut highs);
                if is_opaque && possible & sure != 0 {
                    self.is_dirty = true;
                    for_each_bit(u64::from(possible & sure), |lane| {
                        closed[lane] = closed[lane].max(lows[lane]);
                    });
                }
                for_each_bit(u64::from(possible), |lane| {
                    self.hits.push(PossibleHit {
                        ray: (first + lane) as u16,
                        is_sure: sure >> lane & 1 != 0,
                        is_opaque,
                        primitive,
                        low: lows[lane],
                        high: highs[lane],
                    });
                });
            }
        }
    }

    /// Adds possible hits with an ill-conditioned triangle: of all rays within its bounds that may hit it.
    #[inline(never)]
    fn add_each(
        &mut self,
        simd: Simd,
        (set_up, l): (&TriangleSetup, usize),
        primitive: u32,
        surface: Surface,
    ) {
        let of_ray = |ray: usize| {
            if self.closed[ray] == f32::INFINITY {
                return;
            }
            self.hits.push(PossibleHit {
                ray: ray as u16,
                is_sure: false,
                is_opaque: surface.is_opaque,
                primitive,
                low: f32::NEG_INFINITY,
                high: f32::INFINITY,
            });
        };
        let adding = ForEachThatMayHit {
            functions: &EdgeFunctions::of(set_up, l, primitive),
            first: (set_up.column[l] as usize, set_up.row[l] as usize),
            bounds: set_up.boxes[l],
            of_ray,
        };
        dispatch(simd, adding);
    }

    /// Orders the possible hits of each ray as far as their bounds do, and hands over those of each ray that has any.
    pub(super) fn order(&mut self, mut of_ray: impl FnMut(RayHits<'_>)) {
        self.ends = [0; RAYS];
        for hit in &self.hits {
            self.ends[usize::from(hit.ray)] += 1;
        }
        let mut begin = 0;
        for end in &mut self.ends {
            begin += std::mem::replace(end, begin);
        }
        let Some(&any) = self.hits.first() else {
            return;
        };
        self.sorted.resize(self.hits.len(), any);
        for hit in &self.hits {
            let end = &mut self.ends[usize::from(hit.ray)];
            self.sorted[*end as usize] = *hit;
            *end += 1;
        }
        let mut begin = 0;
        for (ray, &end) in self.ends.iter().enumerate() {
            let hits = &mut self.sorted[begin..end as usize];
            begin = end as usize;
            if hits.is_empty() {
                continue;
            }
            hits.sort_unstable_by(|a, b| b.low.total_cmp(&a.low));
            let are_ordered = are_ordered(hits);
            of_ray(RayHits {
                column: (ray % SIDE) as u32,
                row: (ray / SIDE) as u32,
                hits,
                are_ordered,
            });
        }
    }
}

/// Whether hits, in order of their lower bounds, are all sure, and each is surely nearer than all after it.
fn are_ordered(hits: &[PossibleHit]) -> bool {
    let mut nearest_after = f32::NEG_INFINITY;
    for hit in hits.iter().rev() {
        if !hit.is_sure || hit.low <= nearest_after {
            return false;
        }
        nearest_after = nearest_after.max(hit.high);
    }
    true
}

impl Occlusion for HitBuffer {
    #[inline(always)]
    fn update(&mut self, lanes: impl Lanes) {
        if std::mem::take(&mut self.is_dirty) {
            let mut least = lanes.splat(f32::INFINITY);
            for closed in self.closed.as_chunks().0 {
                least = lanes.load(closed).min(least);
            }
            self.hi_z = least.reduce_min();
        }
    }

    #[inline(always)]
    fn hi_z(&self, _: impl Lanes) -> (f32, f32) {
        (self.hi_z, f32::NEG_INFINITY)
    }

    #[inline(always)]
    fn occludes_cells(&self, _: impl Lanes, _: u32, _: f32) -> bool {
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hits_are_ordered_where_all_are_sure_and_no_intervals_touch() {
        let hit = |low: f32, high: f32| PossibleHit {
            ray: 0,
            is_sure: true,
            is_opaque: false,
            primitive: 0,
            low,
            high,
        };
        let hits = [hit(5.0, 6.0), hit(3.0, 4.0), hit(1.0, 2.0)];
        assert!(are_ordered(&hits) && are_ordered(&[]));
        for (at, changed) in [
            (0, hit(4.0, 6.0)),
            (1, hit(3.0, 5.0)),
            // Beyond the next one's interval.
            (2, hit(1.0, 5.5)),
            (1, hit(2.0, 4.0)),
        ] {
            let mut hits = hits;
            hits[at] = changed;
            assert!(!are_ordered(&hits), "{at}");
        }
        for at in 0..3 {
            let mut hits = hits;
            hits[at].is_sure = false;
            assert!(!are_ordered(&hits), "{at}");
        }
    }
}
