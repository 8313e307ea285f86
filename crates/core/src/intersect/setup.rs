//! Eight triangles set up at once for a block of rays: linear functions of a ray's place in it, with
//! bounds on their errors.
//!
//! All rays of a block share an eye, or a direction. A linear map T takes world space, relative to
//! the eye, to **block space**, in which the ray in column i and row j runs along (i, j, 1); for
//! orthographic blocks it starts at (i, j, 0) and runs along (0, 0, 1). There, for a triangle with
//! corners A, B, C, the edge functions (i, j, 1)·(B×C), (i, j, 1)·(C×A) and (i, j, 1)·(A×B) are linear
//! in i and j, and so is the inverse of the depth, (i, j, 1)·n / A·n with n = (B−A)×(C−A) (Olano and
//! Greer, "Triangle Scan Conversion Using 2D Homogeneous Coordinates", 1997). Orthographic blocks use
//! the corners' (X, Y, 1) in the edge functions, and the depth itself is linear.
//!
//! # Error bounds
//! ε = 2⁻⁵³; all bounds to first order in ε, with constants rounded up by more than the rest.
//!
//! * **T.** Perspective: a and b the steps from ray to ray along columns and rows, s their length, d the
//!   direction at (0, 0), D the target's distance, and B = max(|across| + |along| + D) over the block.
//!   T is D times the inverse of the matrix (a, b, d), its rows D·(b×d), D·(d×a) and D·(a×b) over the
//!   determinant s²D: the first two at most K = B/s long, the third 1. Nothing is assumed of how
//!   perpendicular the camera's axes are, but that they are to 10⁻⁶. Each component of d is off by 6εB,
//!   a cross product's by 6εsB, the quotient by 3ε of itself: rows are off by 20εK a component (the
//!   third by 20ε). Orthographic: (a, b, forward), K = 1/s, and the same.
//! * **Corners.** Relative to the origin they are off by εr + η a coordinate, r the largest coordinate
//!   and η the origin's own error. Mapped: 3·20εKr from T, 6εKr from products and sums, 2K(εr + η) from
//!   before: below Kδ with δ = 72(εr + η) for X and Y, and below δ for Z.
//!   Backwards, r ≤ (2A·s + Z·B)/D, with A the largest |X| or |Y| and Z the largest |Z| (orthographic:
//!   2A·s + Z).
//! * **Edge functions.** With W the largest third coordinate (Z, or 1 and exact), m = P×Q has components
//!   off by 2KδW + 2Aδ + 4εAW in the first two and 4KδA + 4εA² in the third. Moving the function's zero
//!   to a place in the block rounds twice more. At places up to h:
//!   E = (A + hW)·(4(K + h)δ + 32εA); orthographic: 4K for 4(K + h), since W is exact.
//! * **Rays.** A ray's direction is rounded on its way to unit length: 8εB a component, which T makes
//!   14εK·B/D, and its place on the plane rounds by εK: below 32εK·B/D columns or rows, so that
//!   edge functions and n are off by that times |m₁| + |m₂|, or |n₁| + |n₂|. Orthographic rays' origins
//!   round instead, which η includes.
//! * **The plane.** With L and M the largest differences of corners in X or Y, and in Z:
//!   (i, j, 1)·n is off by N = (L + hM)·(8(K + h)δ + 16εL);
//!   A·n by F = (A·M + Z·L)·(16(K + h)δ + 24εL) + 12δ·A·L. Orthographic depths are (A·n − n₁i − n₂j)/n₃,
//!   whose numerator is off by F with A + h for A, and n₃ by 8KδL + 8εL².
//! * **Boxes.** A corner's place X/Z is off by (K + |X/Z|)δ/Z: below 2⁻¹¹ wherever it counts if
//!   Z ≥ 2¹¹(K + 2h)δ. The box is made 2⁻⁹ larger. Where a corner is not that far in front of the eye, the
//!   whole block is taken.

use super::Cull;
use crate::camera::{Camera, Projection};
use glam::{DVec3, Vec3};

/// Triangles that are set up together.
pub(crate) const LANES: usize = 8;

/// Rays along the side of the largest block.
pub(crate) const SIDE: usize = 32;

/// Rays that are met side by side in a row.
pub(crate) const ROW: usize = 8;

/// The furthest place from a block's first ray at which functions are evaluated: rows of rays may
/// stick out.
const REACH: f64 = (SIDE + ROW) as f64;

/// Half a unit in the last place of 1 in double precision.
const EPSILON: f64 = f64::EPSILON / 2.0;

/// Error bound of a linear function of the place, evaluated in single precision, as a share of the
/// sum of its terms' greatest magnitudes, M = |f₀| + |f_x|·w + |f_y|·h.
///
/// With u = 2⁻²⁴: the three coefficients are rounded, and moving to a sub-block's corner takes two
/// products and two sums (7u); a place in a row takes a product and a sum (2u), and the rows below
/// the first add a step each, [`SIDE`] at most, whose sum is rounded each time (32u). Comparing two
/// such values takes a sum of each with its bound (2u). 48u covers these and the higher orders.
const LINEAR_ERROR: f64 = 48.0 / (1u64 << 24) as f64;

/// By how much a triangle's box in the block is made larger: see above.
const BOX_MARGIN: f32 = 1.0 / 512.0;

/// Adding this to a single of at most 2²² rounds it to a whole number, which then stands in the low
/// bits.
const ROUNDER: f32 = 12_582_912.0;

/// The rays of a block, as far as triangles are concerned.
#[derive(Clone, Debug)]
pub(crate) struct BlockSpace {
    perspective: bool,
    /// What corners are taken relative to.
    origin: DVec3,
    /// T's rows.
    map: [DVec3; 3],
    cull: Cull,
    /// Columns and rows of the block, less one.
    last: (f32, f32),
    /// K.
    stretch: f64,
    /// K + h, or K for orthographic blocks.
    stretch_and_reach: f64,
    /// η.
    origin_error: f64,
    /// What r is of A and of Z.
    size: (f64, f64),
    /// 32εK·B/D; zero for orthographic blocks.
    ray_error: f64,
}

/// Triangles waiting to be set up together, corner coordinates side by side.
#[derive(Clone, Debug)]
pub(crate) struct Batch {
    corners: [[f32; LANES]; 9],
    pub(crate) slots: [u32; LANES],
    pub(crate) len: usize,
}

/// Triangles set up for a block.
///
/// Functions are of the place relative to a triangle's own first ray, (`column`, `row`).
#[derive(Clone, Debug)]
pub(crate) struct SetUp {
    /// Edge functions: at the first ray, from column to column, from row to row. All three are
    /// positive inside.
    pub(crate) edges: [[[f32; LANES]; 3]; 3],
    /// What the edge functions may be off by.
    pub(crate) edge_error: [f32; LANES],
    /// How near: inverse depth, or for orthographic blocks depth negated, so that it grows towards
    /// the eye.
    pub(crate) nearness: [[f32; LANES]; 3],
    /// What it may be off by.
    pub(crate) nearness_error: [f32; LANES],
    /// The first column and row that the functions are relative to.
    pub(crate) column: [i32; LANES],
    pub(crate) row: [i32; LANES],
    /// The box of rays that may meet the triangle.
    pub(crate) bounds: Bounds,
    /// Seen from its edge, or too badly conditioned: it cannot be told from which side.
    pub(crate) awkward: [bool; LANES],
}

/// Boxes of rays, both ends included; empty where an end is before the beginning.
#[derive(Clone, Debug)]
pub(crate) struct Bounds {
    pub(crate) left: [i32; LANES],
    pub(crate) right: [i32; LANES],
    pub(crate) top: [i32; LANES],
    pub(crate) bottom: [i32; LANES],
}

/// Corners in block space, and what is told from them alone.
pub(crate) struct Placed {
    corners: [[f64; LANES]; 9],
    bounds: Bounds,
    /// At least how near the nearest corner is, as [`SetUp::nearness`] counts; infinite where a corner
    /// is not surely in front.
    pub(crate) nearest: [f32; LANES],
}

impl Placed {
    /// Which rays may meet each triangle.
    #[inline(always)]
    pub(crate) fn bounds(&self) -> &Bounds {
        &self.bounds
    }
}

impl BlockSpace {
    /// The block whose first ray goes through (x, y) of the picture, its rays `stride` pixels apart.
    /// `eye` is the camera's relative to what corners are relative to, off by at most `eye_error`.
    pub(crate) fn new(
        camera: &Camera,
        eye: DVec3,
        eye_error: f64,
        (x, y): (f64, f64),
        stride: f64,
        (columns, rows): (u32, u32),
        cull: Cull,
    ) -> Self {
        let step = camera.plane().step * stride;
        let (across, along) = camera.across_and_along(x, y);
        let reach = (across.abs() + REACH * step) + (along.abs() + REACH * step);
        let (a, b) = (camera.right() * step, camera.up() * -step);
        let perspective = camera.projection() == Projection::Perspective;
        let (d, scale, origin, origin_error) = if perspective {
            let distance = camera.distance();
            (camera.direction(x, y), distance, eye, eye_error)
        } else {
            let origin = eye + camera.on_plane(x, y);
            // Each ray's own origin is rounded in world space, and its place on the plane before.
            let world = camera.placement().eye.abs().max_element()
                + origin.abs().max_element()
                + 2.0 * reach;
            (
                camera.forward(),
                1.0,
                origin,
                eye_error + 16.0 * EPSILON * world,
            )
        };
        let determinant = a.dot(b.cross(d));
        let scale = scale / determinant;
        let map = [b.cross(d) * scale, d.cross(a) * scale, a.cross(b) * scale];
        let (stretch, size, ray_error) = if perspective {
            let distance = camera.distance();
            let greatest = reach + distance;
            let stretch = greatest / step;
            let wide = greatest / distance;
            (
                stretch,
                (2.1 * step / distance, 1.1 * wide),
                32.0 * EPSILON * stretch * wide,
            )
        } else {
            (1.0 / step, (2.1 * step, 1.1), 0.0)
        };
        Self {
            perspective,
            origin,
            map,
            cull,
            last: (columns as f32 - 1.0, rows as f32 - 1.0),
            stretch,
            stretch_and_reach: if perspective {
                stretch + REACH
            } else {
                stretch
            },
            origin_error,
            size,
            ray_error,
        }
    }

    /// Maps a batch's corners to block space, and says which rays may meet each triangle.
    #[inline(always)]
    pub(crate) fn place(&self, batch: &Batch) -> Placed {
        let mut out = Placed {
            corners: [[0.0; LANES]; 9],
            bounds: Bounds {
                left: [0; LANES],
                right: [0; LANES],
                top: [0; LANES],
                bottom: [0; LANES],
            },
            nearest: [0.0; LANES],
        };
        let [tx, ty, tz] = self.map;
        let o = self.origin;
        for corner in 0..3 {
            for l in 0..LANES {
                let x = f64::from(batch.corners[3 * corner][l]) - o.x;
                let y = f64::from(batch.corners[3 * corner + 1][l]) - o.y;
                let z = f64::from(batch.corners[3 * corner + 2][l]) - o.z;
                out.corners[3 * corner][l] = x * tx.x + y * tx.y + z * tx.z;
                out.corners[3 * corner + 1][l] = x * ty.x + y * ty.y + z * ty.z;
                out.corners[3 * corner + 2][l] = x * tz.x + y * tz.y + z * tz.z;
            }
        }
        let far = (SIDE * 2) as f64;
        for l in 0..LANES {
            let c = |k: usize| out.corners[k][l];
            let (ax, ay, az) = (c(0), c(1), c(2));
            let (bx, by, bz) = (c(3), c(4), c(5));
            let (cx, cy, cz) = (c(6), c(7), c(8));
            let reach = max(max3(ax, bx, cx), max3(ay, by, cy));
            let depth = max3(az, bz, cz);
            let delta = self.delta(reach, depth);
            let front = min(min(az, bz), cz);
            let back = max(max(az, bz), cz);
            let (ia, ib, ic) = if self.perspective {
                (1.0 / az, 1.0 / bz, 1.0 / cz)
            } else {
                (1.0, 1.0, 1.0)
            };
            let safe = if self.perspective {
                front >= 2048.0 * (self.stretch + 2.0 * REACH) * delta
            } else {
                2048.0 * self.stretch * delta <= 1.0
            };
            // Behind the eye, or the plane that orthographic rays start from.
            let behind = back < -delta;
            let (xa, xb, xc) = (ax * ia, bx * ib, cx * ic);
            let (ya, yb, yc) = (ay * ia, by * ib, cy * ic);
            let (left, right) = (min(min(xa, xb), xc), max(max(xa, xb), xc));
            let (top, bottom) = (min(min(ya, yb), yc), max(max(ya, yb), yc));
            let (left, top) = if safe { (left, top) } else { (-far, -far) };
            let (right, bottom) = if safe { (right, bottom) } else { (far, far) };
            let right = if behind { -far } else { right };
            // The first whole number not before the box, the last not after it.
            let first = |x: f64| {
                let x = x as f32 - BOX_MARGIN + 0.5;
                whole(clamp(x, 0.0, (2 * SIDE) as f32))
            };
            let final_ = |x: f64, last: f32| {
                let x = x as f32 + BOX_MARGIN - 0.5;
                whole(clamp(x, -1.0, last))
            };
            out.bounds.left[l] = first(left);
            out.bounds.top[l] = first(top);
            out.bounds.right[l] = final_(right, self.last.0);
            out.bounds.bottom[l] = final_(bottom, self.last.1);
            let nearest = if self.perspective {
                max(max(ia, ib), ic)
            } else {
                -(front - delta)
            };
            // Rounding to single precision, and the corners' errors of less than 2⁻¹¹/K, in small.
            let nearest = (nearest + nearest.abs() * (1.0 / 1024.0)) as f32;
            out.nearest[l] = if safe { nearest } else { f32::INFINITY };
        }
        out
    }

    /// δ for corners whose X and Y are at most `reach` and Z at most `depth`.
    #[inline(always)]
    fn delta(&self, reach: f64, depth: f64) -> f64 {
        72.0 * (EPSILON * (reach * self.size.0 + depth * self.size.1) + self.origin_error)
    }

    /// Sets a batch up.
    #[inline(always)]
    pub(crate) fn set_up(&self, placed: Placed) -> SetUp {
        let mut out = SetUp {
            edges: [[[0.0; LANES]; 3]; 3],
            edge_error: [0.0; LANES],
            nearness: [[0.0; LANES]; 3],
            nearness_error: [0.0; LANES],
            column: [0; LANES],
            row: [0; LANES],
            bounds: placed.bounds,
            awkward: [false; LANES],
        };
        let h = REACH;
        let kh = self.stretch_and_reach;
        for l in 0..LANES {
            let c = |k: usize| placed.corners[k][l];
            let (ax, ay, az) = (c(0), c(1), c(2));
            let (bx, by, bz) = (c(3), c(4), c(5));
            let (cx, cy, cz) = (c(6), c(7), c(8));
            let (ux, uy, uz) = (bx - ax, by - ay, bz - az);
            let (vx, vy, vz) = (cx - ax, cy - ay, cz - az);
            let (nx, ny, nz) = (uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
            let a_n = ax * nx + ay * ny + az * nz;

            let reach = max(max3(ax, bx, cx), max3(ay, by, cy));
            let depth = max3(az, bz, cz);
            let delta = self.delta(reach, depth);
            // Differences of b and c are at most the sum of these.
            let wide = 2.0 * max(max(ux.abs(), uy.abs()), max(vx.abs(), vy.abs()));
            let deep = 2.0 * max(uz.abs(), vz.abs());
            let weight = if self.perspective { depth } else { 1.0 };

            let plane_error = |reach: f64| {
                (reach * deep + depth * wide) * (16.0 * kh * delta + 24.0 * EPSILON * wide)
                    + 12.0 * delta * reach * wide
            };
            let (facing, facing_error, numerator_error) = if self.perspective {
                (
                    a_n,
                    plane_error(reach),
                    (wide + h * deep) * (8.0 * kh * delta + 16.0 * EPSILON * wide)
                        + self.ray_error * (nx.abs() + ny.abs()),
                )
            } else {
                (
                    nz,
                    8.0 * (kh * delta + EPSILON * wide) * wide,
                    plane_error(reach + h),
                )
            };
            let sign = if facing < 0.0 { -1.0 } else { 1.0 };
            // Written so that NaN is awkward.
            let clear = facing.abs() > 4.0 * facing_error;
            let culled = (self.cull == Cull::Back) & clear & (facing > 0.0);

            // Where the functions begin: at the box's left, or for wide boxes at a whole multiple
            // of a row.
            let (left, right) = (out.bounds.left[l], out.bounds.right[l]);
            let (top, bottom) = (out.bounds.top[l], out.bounds.bottom[l]);
            let narrow = right - left < ROW as i32;
            let most = (SIDE - ROW) as i32;
            let column = if narrow {
                if left < most { left } else { most }
            } else {
                left & !(ROW as i32 - 1)
            };
            let row = if narrow { top } else { top & !(ROW as i32 - 1) };
            let (i, j) = (f64::from(column), f64::from(row));
            let across = f64::from(right - column + ROW as i32);
            let along = f64::from(bottom - row + ROW as i32);
            out.column[l] = column;
            out.row[l] = row;
            out.bounds.right[l] = if culled { -1 } else { right };

            let (aw, bw, cw) = if self.perspective {
                (az, bz, cz)
            } else {
                (1.0, 1.0, 1.0)
            };
            let edge = |px: f64, py: f64, pw: f64, qx: f64, qy: f64, qw: f64| {
                let x = (py * qw - pw * qy) * sign;
                let y = (pw * qx - px * qw) * sign;
                let constant = (px * qy - py * qx) * sign;
                (constant + x * i + y * j, x, y)
            };
            let (e0, e1, e2) = (
                edge(bx, by, bw, cx, cy, cw),
                edge(cx, cy, cw, ax, ay, aw),
                edge(ax, ay, aw, bx, by, bw),
            );
            let size = |(c, x, y): (f64, f64, f64)| c.abs() + x.abs() * across + y.abs() * along;
            let magnitude = max(max(size(e0), size(e1)), size(e2));
            let slope = |(_, x, y): (f64, f64, f64)| x.abs() + y.abs();
            let steepest = max(max(slope(e0), slope(e1)), slope(e2));
            let edge_error = (reach + h * weight) * (4.0 * kh * delta + 32.0 * EPSILON * reach)
                + self.ray_error * steepest;
            let unit = 1.0 / magnitude;
            let edge_error = (edge_error * unit + LINEAR_ERROR) * 1.001;
            out.edge_error[l] = edge_error as f32;
            out.edges[0][0][l] = (e0.0 * unit) as f32;
            out.edges[0][1][l] = (e0.1 * unit) as f32;
            out.edges[0][2][l] = (e0.2 * unit) as f32;
            out.edges[1][0][l] = (e1.0 * unit) as f32;
            out.edges[1][1][l] = (e1.1 * unit) as f32;
            out.edges[1][2][l] = (e1.2 * unit) as f32;
            out.edges[2][0][l] = (e2.0 * unit) as f32;
            out.edges[2][1][l] = (e2.1 * unit) as f32;
            out.edges[2][2][l] = (e2.2 * unit) as f32;

            let inverse = 1.0 / facing;
            let (n0, n1, n2) = if self.perspective {
                ((nz + nx * i + ny * j) * inverse, nx * inverse, ny * inverse)
            } else {
                (
                    (nx * i + ny * j - a_n) * inverse,
                    nx * inverse,
                    ny * inverse,
                )
            };
            let spread = n0.abs() + n1.abs() * across + n2.abs() * along;
            let relative = facing_error * inverse.abs();
            let nearness_error =
                spread * (LINEAR_ERROR + 2.0 * relative) + 2.0 * numerator_error * inverse.abs();
            out.nearness[0][l] = n0 as f32;
            out.nearness[1][l] = n1 as f32;
            out.nearness[2][l] = n2 as f32;
            out.nearness_error[l] = (nearness_error * 1.001) as f32 + f32::MIN_POSITIVE;
            // What leaves single precision, or was never a number, is awkward too.
            let sound = (magnitude < f64::INFINITY)
                & (magnitude > 0.0)
                & (edge_error < 1.0)
                & (nearness_error < f64::from(f32::MAX))
                & (spread < f64::from(f32::MAX));
            out.awkward[l] = !(clear & sound);
        }
        out
    }
}

impl Batch {
    pub(crate) fn new() -> Self {
        Self {
            corners: [[0.0; LANES]; 9],
            slots: [0; LANES],
            len: 0,
        }
    }

    /// Adds a triangle to a batch that is not full.
    #[inline(always)]
    pub(crate) fn push(&mut self, slot: u32, corners: &[Vec3; 3]) {
        let lane = self.len & (LANES - 1);
        for (corner, at) in corners.iter().zip([0, 3, 6]) {
            self.corners[at][lane] = corner.x;
            self.corners[at + 1][lane] = corner.y;
            self.corners[at + 2][lane] = corner.z;
        }
        self.slots[lane] = slot;
        self.len += 1;
    }
}

/// The whole number that a single of at most 2²² is rounded to.
#[inline(always)]
fn whole(x: f32) -> i32 {
    (x + ROUNDER).to_bits() as i32 - ROUNDER.to_bits() as i32
}

#[inline(always)]
fn max(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
fn min(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The greatest magnitude of three.
#[inline(always)]
fn max3(a: f64, b: f64, c: f64) -> f64 {
    max(max(a.abs(), b.abs()), c.abs())
}

#[inline(always)]
fn clamp(x: f32, least: f32, most: f32) -> f32 {
    let x = if x > least { x } else { least };
    if x < most { x } else { most }
}
