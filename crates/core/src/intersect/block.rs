//! Many triangles against a block of 8 × 8 rays of one camera, in single precision with bounds: what
//! the bounds leave open is marked, and left to the single-ray path.
//!
//! All rays of a block share an eye (or a direction), so for a triangle (a, b, c) relative to the eye
//! the edge functions d·(b×c), d·(c×a) and d·(a×b) are linear in the ray's place in the block, and so
//! is the inverse of its depth, d·n / a·n with n = (b−a)×(c−a) (Olano and Greer, "Triangle Scan
//! Conversion Using 2D Homogeneous Coordinates", 1997). An orthographic block shares a direction f
//! instead: its functions f·((b−p)×(c−p)) are linear in the ray's origin p, and so is the depth
//! n·(a−p) / n·f itself.

use super::Cull;
use crate::accel::MISS;
use crate::camera::{Camera, Projection};
use glam::{DVec3, Vec3};

/// Rays along a block's side.
pub(crate) const SIDE: usize = 8;
/// Rays in a block.
pub(crate) const RAYS: usize = SIDE * SIDE;
/// Triangles that are set up together.
pub(crate) const BATCH: usize = 8;

/// Half a unit in the last place of 1 in double precision.
const EPSILON: f64 = f64::EPSILON / 2.0;

/// Error bound of a linear function of the place in a block, evaluated in single precision, as a
/// share of M = |f₀| + |f_x|·h + |f_y|·h, with h half the block's side.
///
/// With u = 2⁻²⁴: the three coefficients are rounded (u each), f_x·i and f_y·j are products (u each),
/// and two sums follow (u each): at most 4u·M to first order. Comparing two such values takes a sum
/// of each with its bound, u each. 8u covers these, the higher orders and the rounding of M.
const LINEAR_ERROR: f32 = 8.0 / (1 << 24) as f32;

/// What marks a ray that the block could not decide, in place of how near its hit is.
const OPEN: f32 = f32::INFINITY;

/// Each ray's column and row, counted from the block's middle.
const COLUMNS: [f32; RAYS] = places(1);
const ROWS: [f32; RAYS] = places(SIDE);

const fn places(stride: usize) -> [f32; RAYS] {
    let mut places = [0.0; RAYS];
    let mut ray = 0;
    while ray < RAYS {
        places[ray] = (ray / stride % SIDE) as f32 - (SIDE as f32 - 1.0) * 0.5;
        ray += 1;
    }
    places
}

/// A linear function of the place in the block: `constant + x·i + y·j`, with i and j counted in rays
/// from the block's middle.
#[derive(Clone, Copy, Debug, Default)]
struct Linear {
    constant: f32,
    x: f32,
    y: f32,
}

/// The rays of a block.
#[derive(Clone, Debug)]
pub(crate) struct BlockRays {
    projection: Projection,
    /// Perspective: the eye. Orthographic: the origin of the ray in the block's middle. Relative to
    /// what corners are relative to.
    origin: DVec3,
    /// Error of each coordinate of the origin.
    origin_error: f64,
    /// Perspective: the direction in the middle. Orthographic: that of all.
    direction: DVec3,
    /// From one ray to the next in a row: of directions, or of origins.
    x: DVec3,
    /// From one row to the next.
    y: DVec3,
    cull: Cull,
}

/// The nearest triangle of each ray of a block so far.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// How near the hit is at least: inverse depth, or for orthographic blocks depth negated, so
    /// that it grows towards the eye. −∞ where nothing is met yet, [`OPEN`] where it cannot be told.
    low: [f32; RAYS],
    /// How near it is at most.
    high: [f32; RAYS],
    slots: [u32; RAYS],
}

/// Triangles waiting to be set up together, corner coordinates side by side.
#[derive(Clone, Debug)]
pub(crate) struct Batch {
    corners: [[f32; BATCH]; 9],
    slots: [u32; BATCH],
    len: usize,
}

/// Triangles set up for a block.
struct SetUp {
    edges: [[[f32; BATCH]; 3]; 3],
    edge_error: [f32; BATCH],
    nearness: [[f32; BATCH]; 3],
    nearness_error: [f32; BATCH],
    /// Cannot be met by any ray of the block.
    rejected: [bool; BATCH],
    /// Seen from its edge, or too badly conditioned: rays that it may touch are left open.
    awkward: [bool; BATCH],
}

impl BlockRays {
    /// The block whose middle is at (x, y) of the picture, its rays `stride` pixels apart. `eye` is
    /// the camera's relative to what corners are relative to, off by at most `eye_error`.
    pub(crate) fn new(
        camera: &Camera,
        eye: DVec3,
        eye_error: f64,
        (x, y): (f64, f64),
        stride: f64,
        cull: Cull,
    ) -> Self {
        let step = camera.plane().step * stride;
        let (right, down) = (camera.right() * step, camera.up() * -step);
        let middle = camera.direction(x, y);
        let (origin, direction) = match camera.projection() {
            Projection::Perspective => (eye, middle),
            Projection::Orthographic => (eye + camera.on_plane(x, y), camera.forward()),
        };
        // The sum of eye and place is rounded where the single ray's is, but not alike.
        let origin_error = match camera.projection() {
            Projection::Perspective => eye_error,
            Projection::Orthographic => {
                let world = camera.placement().eye.abs().max_element() + origin.abs().max_element();
                eye_error + 8.0 * EPSILON * world
            }
        };
        Self {
            projection: camera.projection(),
            origin,
            origin_error,
            direction,
            x: right,
            y: down,
            cull,
        }
    }

    /// Sets a batch up.
    ///
    /// Error bounds in double precision, with ε = 2⁻⁵³, R the largest coordinate of the corners
    /// relative to the origin, L that of their differences, and D that of the rays' directions over
    /// the block (origins' steps for orthographic blocks are included in R):
    ///
    /// * A relative corner is off by ε·R + η, η the origin's error; a difference of corners by ε·L.
    ///   a×b is had as ½(a+b)×(b−a), whose second factor is small for a small triangle: each of its
    ///   components is off by at most 2·((2εR + 2η + εR)·L + 2R·εL + 3·2εRL)/2 < (13εR + 2η)·L.
    /// * A dot product with a direction adds 3 products: 3·(13εR + 2η)·L·D + 3·4ε·RLD, and the rays'
    ///   true directions differ from linear ones by 8ε·D at most (their own rounding, before and
    ///   after they are made unit length): with all of it below 96(εR + η)·L·D. 128 is used.
    /// * a·n likewise, its second factor from two differences: below 64(εR + η)·L².
    #[inline(always)]
    fn set_up(&self, batch: &Batch) -> SetUp {
        let mut out = SetUp {
            edges: [[[0.0; BATCH]; 3]; 3],
            edge_error: [0.0; BATCH],
            nearness: [[0.0; BATCH]; 3],
            nearness_error: [0.0; BATCH],
            rejected: [false; BATCH],
            awkward: [false; BATCH],
        };
        let half = (SIDE as f64 - 1.0) * 0.5;
        let perspective = self.projection == Projection::Perspective;
        let direction_size =
            (self.direction.abs() + (self.x.abs() + self.y.abs()) * half).max_element();
        let swing = ((self.x.abs() + self.y.abs()) * half).max_element();
        let o = self.origin;
        for l in 0..BATCH {
            let load = |k: usize| f64::from(batch.corners[k][l]);
            let (ax, ay, az) = (load(0) - o.x, load(1) - o.y, load(2) - o.z);
            let (bx, by, bz) = (load(3) - o.x, load(4) - o.y, load(5) - o.z);
            let (cx, cy, cz) = (load(6) - o.x, load(7) - o.y, load(8) - o.z);
            let (abx, aby, abz) = (load(3) - load(0), load(4) - load(1), load(5) - load(2));
            let (bcx, bcy, bcz) = (load(6) - load(3), load(7) - load(4), load(8) - load(5));
            let (cax, cay, caz) = (load(0) - load(6), load(1) - load(7), load(2) - load(8));

            let max3 = |x: f64, y: f64, z: f64| max(max(x.abs(), y.abs()), z.abs());
            let reach = max(max(max3(ax, ay, az), max3(bx, by, bz)), max3(cx, cy, cz));
            let length = max(
                max(max3(abx, aby, abz), max3(bcx, bcy, bcz)),
                max3(cax, cay, caz),
            );

            // n = ab × bc = (b−a)×(c−b), the same as (b−a)×(c−a).
            let (nx, ny, nz) = (
                aby * bcz - abz * bcy,
                abz * bcx - abx * bcz,
                abx * bcy - aby * bcx,
            );
            let a_n = ax * nx + ay * ny + az * nz;
            let dot = |v: DVec3, x: f64, y: f64, z: f64| v.x * x + v.y * y + v.z * z;
            let d_n = dot(self.direction, nx, ny, nz);

            let reach = if perspective { reach } else { reach + swing };
            let unit_error = 128.0 * (EPSILON * reach + self.origin_error) * length;
            // What decides on which side the triangle faces the block: a·n, or n·f.
            let (facing, facing_error) = if perspective {
                (a_n, unit_error * length)
            } else {
                (d_n, 128.0 * EPSILON * length * length * direction_size)
            };
            let sign = if facing < 0.0 { -1.0 } else { 1.0 };
            // Beyond this the nearness is good to 2^-26 of itself, all told.
            let clear = facing.abs() > facing_error * (1u64 << 27) as f64;
            let awkward = !clear;

            // Edge functions in the middle, and their steps.
            let mut constants = [0.0; 3];
            let mut steps_x = [0.0; 3];
            let mut steps_y = [0.0; 3];
            let corners = [
                (bx, by, bz, cx, cy, cz, bcx, bcy, bcz),
                (cx, cy, cz, ax, ay, az, cax, cay, caz),
                (ax, ay, az, bx, by, bz, abx, aby, abz),
            ];
            for e in 0..3 {
                let (px, py, pz, qx, qy, qz, ex, ey, ez) = corners[e];
                let (sx, sy, sz) = (
                    (px + qx) * (0.5 * sign),
                    (py + qy) * (0.5 * sign),
                    (pz + qz) * (0.5 * sign),
                );
                let (mx, my, mz) = (sy * ez - sz * ey, sz * ex - sx * ez, sx * ey - sy * ex);
                constants[e] = dot(self.direction, mx, my, mz);
                if perspective {
                    steps_x[e] = dot(self.x, mx, my, mz);
                    steps_y[e] = dot(self.y, mx, my, mz);
                } else {
                    // f·((p−s)×(q−s)) = f·(p×q) − s·((q−p)×f).
                    let f = self.direction;
                    let (wx, wy, wz) = (
                        ey * f.z - ez * f.y,
                        ez * f.x - ex * f.z,
                        ex * f.y - ey * f.x,
                    );
                    steps_x[e] = -sign * dot(self.x, wx, wy, wz);
                    steps_y[e] = -sign * dot(self.y, wx, wy, wz);
                }
            }
            let size = |e: usize| constants[e].abs() + (steps_x[e].abs() + steps_y[e].abs()) * half;
            let magnitude = max(max(size(0), size(1)), size(2));
            // Powers of two would do as well; what counts is that nothing leaves single precision.
            let unit = 1.0 / magnitude;
            let edge_error = f64::from(LINEAR_ERROR) + unit_error * direction_size * unit;
            let edge_error = edge_error * (1.0 + 1e-6);
            let mut rejected = false;
            for e in 0..3 {
                // The greatest value over the block.
                let greatest = (constants[e] + (steps_x[e].abs() + steps_y[e].abs()) * half) * unit;
                rejected |= greatest < -edge_error;
                out.edges[e][0][l] = (constants[e] * unit) as f32;
                out.edges[e][1][l] = (steps_x[e] * unit) as f32;
                out.edges[e][2][l] = (steps_y[e] * unit) as f32;
            }
            // An awkward triangle's side is not known: it is rejected only where the functions have
            // both signs for sure, the other way round too.
            let mut rejected_turned = false;
            for e in 0..3 {
                let least = (constants[e] - (steps_x[e].abs() + steps_y[e].abs()) * half) * unit;
                rejected_turned |= least > edge_error;
            }
            let (n0, n1, n2) = if perspective {
                let inverse = 1.0 / a_n;
                (
                    d_n * inverse,
                    dot(self.x, nx, ny, nz) * inverse,
                    dot(self.y, nx, ny, nz) * inverse,
                )
            } else {
                let inverse = -1.0 / d_n;
                (
                    a_n * inverse,
                    -dot(self.x, nx, ny, nz) * inverse,
                    -dot(self.y, nx, ny, nz) * inverse,
                )
            };
            let spread = n0.abs() + (n1.abs() + n2.abs()) * half;
            // Orthographic depths are off by the error of a·n over d·n, too.
            let depth_error = unit_error * length / d_n.abs();
            // What may cancel in d·n, which the conditioning above says nothing about.
            let cancelled = 128.0 * EPSILON * length * length * direction_size / a_n.abs();
            let own_error = if perspective { cancelled } else { depth_error };
            let nearness_error =
                spread * (f64::from(LINEAR_ERROR) + 1.0 / (1 << 25) as f64) + own_error;
            out.nearness[0][l] = n0 as f32;
            out.nearness[1][l] = n1 as f32;
            out.nearness[2][l] = n2 as f32;
            out.nearness_error[l] = (nearness_error * (1.0 + 1e-6)) as f32 + f32::MIN_POSITIVE;
            out.edge_error[l] = edge_error as f32;
            let culled = self.cull == Cull::Back && facing > 0.0 && !awkward;
            out.rejected[l] = culled
                || if awkward {
                    rejected && rejected_turned
                } else {
                    rejected
                };
            out.awkward[l] = awkward;
        }
        out
    }
}

impl Batch {
    pub(crate) fn new() -> Self {
        Self {
            corners: [[0.0; BATCH]; 9],
            slots: [0; BATCH],
            len: 0,
        }
    }

    /// Adds a triangle; `true` when the batch is full.
    #[inline(always)]
    pub(crate) fn push(&mut self, slot: u32, corners: &[Vec3; 3]) -> bool {
        let lane = self.len;
        for (corner, at) in corners.iter().zip([0, 3, 6]) {
            self.corners[at][lane] = corner.x;
            self.corners[at + 1][lane] = corner.y;
            self.corners[at + 2][lane] = corner.z;
        }
        self.slots[lane] = slot;
        self.len += 1;
        self.len == BATCH
    }
}

impl Block {
    /// A block of `columns × rows` rays, at most [`SIDE`] each; the rest of it takes no part.
    pub(crate) fn new(columns: usize, rows: usize) -> Self {
        let mut block = Self {
            low: [f32::NEG_INFINITY; RAYS],
            high: [f32::NEG_INFINITY; RAYS],
            slots: [MISS; RAYS],
        };
        if rows < SIDE || columns < SIDE {
            for ray in (0..RAYS).filter(|ray| ray / SIDE >= rows || ray % SIDE >= columns) {
                block.low[ray] = OPEN;
                block.high[ray] = OPEN;
            }
        }
        block
    }

    /// The nearest triangle of a ray; `None` if the block could not tell.
    #[inline(always)]
    pub(crate) fn slot(&self, ray: usize) -> Option<u32> {
        (self.low[ray] != OPEN).then_some(self.slots[ray])
    }

    /// What every ray's hit is at least as near as: anything surely further is of no use.
    #[inline(always)]
    pub(crate) fn horizon(&self) -> f32 {
        // In strands, so that sixteen comparisons are one.
        const STRANDS: usize = 16;
        let mut least = [f32::INFINITY; STRANDS];
        for part in self.low.as_chunks::<STRANDS>().0 {
            for strand in 0..STRANDS {
                let low = part[strand];
                least[strand] = if low < least[strand] {
                    low
                } else {
                    least[strand]
                };
            }
        }
        least.into_iter().fold(f32::INFINITY, f32::min)
    }

    /// Meets every triangle of a batch, and empties it.
    #[inline(always)]
    pub(crate) fn meet(&mut self, rays: &BlockRays, batch: &mut Batch) {
        let count = batch.len;
        batch.len = 0;
        let set_up = rays.set_up(batch);
        // Orthographic rays begin at the image plane, where the negated depth is zero.
        let begin = if rays.projection == Projection::Perspective {
            f32::INFINITY
        } else {
            0.0
        };
        for l in 0..count {
            if set_up.rejected[l] {
                continue;
            }
            let linear = |f: &[[f32; BATCH]; 3]| Linear {
                constant: f[0][l],
                x: f[1][l],
                y: f[2][l],
            };
            let edges = [
                linear(&set_up.edges[0]),
                linear(&set_up.edges[1]),
                linear(&set_up.edges[2]),
            ];
            let nearness = linear(&set_up.nearness);
            if set_up.awkward[l] {
                self.leave_open(edges, set_up.edge_error[l]);
            } else {
                self.meet_one(
                    batch.slots[l],
                    edges,
                    set_up.edge_error[l],
                    nearness,
                    set_up.nearness_error[l],
                    begin,
                );
            }
        }
    }

    /// One triangle against all rays. Comparisons are such that NaN leaves a ray open.
    #[inline(always)]
    fn meet_one(
        &mut self,
        slot: u32,
        edges: [Linear; 3],
        edge_error: f32,
        nearness: Linear,
        nearness_error: f32,
        begin: f32,
    ) {
        let [e, f, g] = edges;
        let Self { low, high, slots } = self;
        for ray in 0..RAYS {
            let (i, j) = (COLUMNS[ray], ROWS[ray]);
            let a = (e.constant + e.y * j) + e.x * i;
            let b = (f.constant + f.y * j) + f.x * i;
            let c = (g.constant + g.y * j) + g.x * i;
            let near = (nearness.constant + nearness.y * j) + nearness.x * i;
            let (near_low, near_high) = (near - nearness_error, near + nearness_error);
            let outside = (a < -edge_error) | (b < -edge_error) | (c < -edge_error);
            let inside = (a > edge_error) & (b > edge_error) & (c > edge_error);
            let further = (near_high < low[ray]) | (near_low > begin);
            let nearer = (near_low > high[ray]) & (near_high < begin);
            let wins = inside & nearer;
            let open = !(outside | further | wins);
            let (next_low, next_high) = if wins {
                (near_low, near_high)
            } else {
                (low[ray], high[ray])
            };
            low[ray] = if open { OPEN } else { next_low };
            high[ray] = if open { OPEN } else { next_high };
            slots[ray] = if wins { slot } else { slots[ray] };
        }
    }

    /// Leaves every ray open that an awkward triangle may touch: those where its edge functions do
    /// not surely have both signs.
    #[inline(always)]
    fn leave_open(&mut self, edges: [Linear; 3], edge_error: f32) {
        let [e, f, g] = edges;
        for ray in 0..RAYS {
            let (i, j) = (COLUMNS[ray], ROWS[ray]);
            let a = (e.constant + e.y * j) + e.x * i;
            let b = (f.constant + f.y * j) + f.x * i;
            let c = (g.constant + g.y * j) + g.x * i;
            let below = (a < -edge_error) | (b < -edge_error) | (c < -edge_error);
            let above = (a > edge_error) | (b > edge_error) | (c > edge_error);
            if !(below & above) {
                self.low[ray] = OPEN;
                self.high[ray] = OPEN;
            }
        }
    }
}

#[inline(always)]
fn max(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
