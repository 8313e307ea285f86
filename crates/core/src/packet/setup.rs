//! Triangle set-up: eight triangles at once become linear functions of a ray's place in a packet, with bounds on
//! their errors.
//!
//! All rays of a packet share an eye, or a direction. A linear map T takes world space, relative to the eye, to
//! **packet space**, in which the ray in column i and row j runs along (i, j, 1); for orthographic packets it
//! starts at (i, j, 0) and runs along (0, 0, 1). There, for a triangle with corners P₀, P₁, P₂, the edge functions
//! (i, j, 1)·(P₁×P₂), (i, j, 1)·(P₂×P₀) and (i, j, 1)·(P₀×P₁) are linear in i and j, and so is the inverse depth,
//! (i, j, 1)·n / P₀·n with n = (P₁−P₀)×(P₂−P₀) (Olano and Greer, "Triangle Scan Conversion Using 2D Homogeneous
//! Coordinates", 1997). Orthographic packets use the corners' (X, Y, 1) in the edge functions, and the depth itself
//! is linear.
//!
//! # Error bounds
//! ε = 2⁻⁵³ (notation and lemmas: `docs/error-bounds.md`). All bounds are to first order in ε; each constant is rounded up
//! by more than the higher orders.
//!
//! * **T.** Perspective: a and b are the steps from ray to ray along columns and rows, s their length, d the
//!   direction at (0, 0), D the distance to the target, and B = greater(|across| + |along| + D) over the packet. T is
//!   D times the inverse of the matrix (a, b, d). Its rows are D·(b×d), D·(d×a) and D·(a×b) over the determinant
//!   s²D: the first two at most K = B/s long, the third 1. The camera's axes need be perpendicular only to
//!   10⁻⁶. A component of d is off by 6εB, of a cross product by 6εsB, the quotient by 3ε of itself: rows are off
//!   by 20εK a component (the third by 20ε). Orthographic: (a, b, forward), K = 1/s, and the same.
//! * **Corners.** Relative to the origin they are off by εr + η a coordinate, r the greatest coordinate and η the
//!   origin's own error. Mapped: 3·20εKr from T, 6εKr from products and sums, 2K(εr + η) from before: below Kδ
//!   with δ = 72(εr + η) for X and Y, and below δ for Z. In reverse, r ≤ (2A·s + Z·B)/D, with A the greatest |X|
//!   or |Y| and Z the greatest |Z| (orthographic: 2A·s + Z).
//! * **Edge functions.** With W the greatest third coordinate (Z, or 1 and exact), the cross product m of two corners
//!   is off by 2KδW + 2Aδ + 4εAW in its first two components and by 4KδA + 4εA² in the third. Moving to a place in the
//!   packet rounds twice more (lemma 5). At places up to h ([`REACH`]): E = (A + hW)·(4(K + h)δ + 32εA); orthographic: 4K for
//!   4(K + h), since W is exact.
//! * **Rays.** A ray's direction is rounded on its way to unit length by 8εB a component, which T makes
//!   14εK·B/D, and its place on the plane by εK: below 32εK·B/D columns or rows, so edge functions and n are off
//!   by that times |m₁| + |m₂|, or |n₁| + |n₂|. Orthographic rays' origins are rounded instead, which η includes.
//! * **Plane.** With L and M twice the greatest difference of a corner from P₀ in X or Y, and in Z: P₀·n is off by half
//!   of F = (A·M + Z·L)·(16(K + h)δ + 24εL) + 12δ·A·L. Orthographic depths are (P₀·n − n₁i − n₂j)/n₃, whose numerator
//!   is off by F with A + h for A, and n₃ by 8KδL + 8εL².
//! * **Depth key.** A quotient whose denominator is off by a quarter of itself at most is off by 4/3 of what its
//!   parts are off by, relative to itself (lemma 6): we take 2. The key is made relative to the packet's reference
//!   (`depth_reference`) after that: these errors are as large as the whole key makes them, and only
//!   [`LINEAR_ERROR`], with the difference's rounding in it, goes by what is left. A reference that is a plane is moved to
//!   the triangle's first ray: four roundings, for which 8ε of its greatest magnitude are taken.
//! * **Dominated terms.** δ ≥ 72ε·2.1·A/K' with K' = D/s (orthographic: 1/s), and δ ≥ 79ε·Z·B/D. So Kδ ≥ 151εA, and
//!   as L ≤ 4A every term with ε and A or L is covered by the one with δ beside it. Inverse and product round the key
//!   by 4ε of itself at most; since |P₀·n| ≤ (A·M + Z·L)·L and |n₃| ≤ L², a key is off by 16Kδ/L ≥ 600ε of itself
//!   through its denominator. Rays of a lattice move edge functions by 128εK(B/D)AZ at most: E has 316 of these. An
//!   orthographic eye is off by less than its rays' origins are.
//! * **Dominated: the key's numerator in perspective.** It is off by (L + iM)·4(K + h)δ at a place i. Keys count
//!   where rays hit the triangle: a hit of depth z is a mean of the corners, so z ≤ Z and i ≤ A/z, and the numerator
//!   is off by a quarter of F/z. A lattice's rays move it by 32εK(B/D)LM, a tenth of F/z as M ≤ 4Z. The key is 1/z,
//!   and of the 2F/z that are taken of its denominator's error 4/3·(1/2 + 1/4 + 1/10) are needed. Rays at places of
//!   their own are off by more, and their share is added.

pub(super) mod place_bounds;
mod space;

pub(super) use super::linear::{FunctionDomain, Linear, REACH};
use super::ray_box::RayBox;
use crate::hit::Cull;
use crate::num::choice::{greater, lesser};
use crate::num::roundoff::EPSILON;
use crate::num::simd::LANES;
use crate::triangle::CornerLanes;
use glam::Vec3;
pub(crate) use space::PacketSpace;
pub(super) use space::origin_error;

/// Relative error of a linear function of the place evaluated in single precision, in units of the sum of its
/// terms' greatest magnitudes, M = |f₀| + |f_x|·w + |f_y|·h.
///
/// With u = 2⁻²⁴: the three coefficients are rounded, and moving to a cell's corner takes two products and two
/// sums (7u); a place in a row takes a product and a sum (2u); the rows below add a step each, at most [`SIDE`],
/// and round each time (32u). Comparing two such values adds the bound to each (2u). 48u covers these and the
/// higher orders.
pub(super) const LINEAR_ERROR: f64 = 48.0 / (1u64 << 24) as f64;

/// The least share of a function's greatest magnitude that a term contributes, 2⁻¹² of [`LINEAR_ERROR`]; what is less is
/// stored as zero, and the thousandth by which errors are enlarged covers three such terms.
///
/// Functions of planes that are nearly perpendicular to the rays, or of edges along rows, have slopes that are subnormal
/// numbers of single precision otherwise, and many processors multiply these a hundred times more slowly. With a greater
/// share the thousandth does not suffice; with a lesser one more such slopes stay.
pub(super) const NEGLIGIBLE: f64 = LINEAR_ERROR / (1 << 12) as f64;

/// The least ratio between the greatest magnitudes of two of a triangle's edge functions at which all three share a
/// scale.
///
/// A triangle with a corner next to the eye is below it: in the scale of the opposite edge's function the other two are
/// within [`LINEAR_ERROR`] of zero, and leave all rays undecided. At this limit an edge function leaves 48·2⁻²⁴ / 2⁻¹²,
/// 1.2 % of its range, undecided. With a lesser limit that share grows; with a greater one more triangles are set up
/// twice.
const UNBALANCED: f64 = 1.0 / (1 << 12) as f64;

/// The error of a function, as a share of its greatest magnitude, up to which componentwise bounds gain little: errors
/// of double precision up to 1.5 times those of single precision. With a lower limit triangles are set up twice that
/// componentwise bounds hardly improve; with a higher one more rays stay undecided.
const MOST_SMOOTH: f64 = 2.5 * LINEAR_ERROR;

/// Whether componentwise bounds of a triangle's edge functions gain little: `least` and `magnitude` are the greatest
/// magnitudes of the least and of the greatest of them.
#[inline(always)]
fn are_edges_smooth(error: f64, least: f64, magnitude: f64) -> bool {
    (error < MOST_SMOOTH) & (least > UNBALANCED * magnitude)
}

/// Whether an edge function relative to a span's first ray is surely negative everywhere in the span.
#[inline(always)]
pub(super) fn is_negative(function: Linear, error: f64, span: &FunctionDomain) -> bool {
    let across = greater(function.x * span.across, 0.0);
    let along = greater(function.y * span.along, 0.0);
    function.constant + across + along < -error
}

/// Edge functions over a whole packet, positive inside, each with the bound on its error.
pub(super) type Edges = [(Linear, f64); 3];

/// Eight triangles set up for a packet.
///
/// Functions are relative to a triangle's own first ray, (`column`, `row`).
#[derive(Clone, Debug)]
pub(crate) struct TriangleSetup {
    /// Edge functions: value at the first ray, step per column, step per row. All three are positive inside.
    pub(crate) edges: [[[f32; LANES]; 3]; 3],
    /// Bounds on the error of the edge functions.
    pub(crate) edge_error: [f32; LANES],
    /// The numbers that edge functions were divided by, but for a factor that all three share.
    pub(crate) edge_scales: [[f64; LANES]; 3],
    /// Depth key: inverse depth, or negated depth for orthographic packets, so that it grows towards the
    /// eye, relative to the packet's reference.
    pub(crate) depth_key: [[f32; LANES]; 3],
    /// Bounds on its error.
    pub(crate) depth_key_error: [f32; LANES],
    /// Column and row of the first ray.
    pub(crate) column: [i32; LANES],
    pub(crate) row: [i32; LANES],
    /// Bounds of the rays that may hit the triangle; empty if it is culled.
    pub(crate) boxes: [RayBox; LANES],
    /// Edge-on or ill-conditioned: it is undecided which side faces the eye.
    pub(crate) ill_conditioned: [bool; LANES],
    /// Whether a depth key overflows single precision although the triangle is not ill-conditioned otherwise.
    pub(crate) overflows: bool,
    /// Where componentwise bounds decide more: errors of double precision exceed 1.5 times those of single precision,
    /// or edge functions are [`UNBALANCED`].
    pub(crate) is_rough: [bool; LANES],
}

impl TriangleSetup {
    /// An upper bound of a triangle's depth key at the places of a lattice's rays within its bounds; infinite where
    /// nothing is sure.
    pub(super) fn nearest_key(&self, l: usize) -> f32 {
        if self.ill_conditioned[l] {
            return f32::INFINITY;
        }
        let [constant, x, y] = self.depth_key.map(|coefficient| coefficient[l]);
        let RayBox { right, bottom, .. } = self.boxes[l];
        let across = (x * (right - self.column[l]) as f32).max(0.0);
        let along = (y * (bottom - self.row[l]) as f32).max(0.0);
        constant + across + along + self.depth_key_error[l]
    }

    /// Stores the edge functions of lane `l`, if it is selected, each in a scale of its own; times `sign` they are
    /// positive inside. Whether they have scales, and whether one is surely negative in all of the span.
    #[inline(always)]
    pub(super) fn store_edges(
        &mut self,
        edges: &Edges,
        sign: f64,
        (l, is_selected): (usize, bool),
        span: &FunctionDomain,
    ) -> (bool, bool) {
        let mut greatest_error = 0.0;
        let (mut are_sound, mut is_missed) = (true, false);
        for (edge, (function, error)) in edges.iter().enumerate() {
            let function = function.moved(span);
            let magnitude = function.size(span);
            let unit = sign / magnitude;
            let function = function.times(unit);
            let error = error / magnitude;
            is_missed |= is_negative(function, error, span);
            let error = (error + LINEAR_ERROR) * 1.001;
            // If it is not, the other two may still have different signs.
            let is_sound = (magnitude > 0.0) & (magnitude < f64::INFINITY) & (error < 1.0);
            are_sound &= is_sound;
            let is_greater = is_sound & (error > greatest_error);
            greatest_error = if is_greater { error } else { greatest_error };
            let function = function.without_terms_below(NEGLIGIBLE, span);
            let terms = [function.constant, function.x, function.y];
            for (out, term) in self.edges[edge].iter_mut().zip(terms) {
                let term = if is_sound { term as f32 } else { 0.0 };
                out[l] = if is_selected { term } else { out[l] };
            }
            let scales = &mut self.edge_scales[edge];
            scales[l] = if is_selected { magnitude } else { scales[l] };
        }
        let edge_error = &mut self.edge_error[l];
        *edge_error = if is_selected {
            greatest_error as f32
        } else {
            *edge_error
        };
        (are_sound, is_missed)
    }

    /// Sets a triangle's depth key to zero, as it is relative to the triangle's own plane, unless the triangle is
    /// ill-conditioned, or componentwise bounds of its edge functions decide more. Whether it is set.
    pub(super) fn set_key_to_zero(&mut self, l: usize, span: &FunctionDomain) -> bool {
        let sizes = self.edges.map(|edge| {
            let [constant, x, y] = edge.map(|term| f64::from(term[l]));
            Linear { constant, x, y }.size(span)
        });
        let magnitude = greater(greater(sizes[0], sizes[1]), sizes[2]);
        let least = lesser(lesser(sizes[0], sizes[1]), sizes[2]);
        let error = f64::from(self.edge_error[l]);
        let is_fine = !self.ill_conditioned[l] && are_edges_smooth(error, least, magnitude);
        if is_fine {
            self.depth_key.iter_mut().for_each(|term| term[l] = 0.0);
            self.depth_key_error[l] = f32::MIN_POSITIVE;
            self.is_rough[l] = false;
        }
        is_fine
    }

    /// Whether a triangle's depth key may reach a value between two somewhere in the packet.
    #[inline(always)]
    pub(super) fn may_touch(&self, l: usize, [least, most]: [f32; 2]) -> bool {
        let [constant, x, y] = self.depth_key.map(|coefficient| coefficient[l]);
        let swing = (x.abs() + y.abs()) * REACH as f32 + self.depth_key_error[l];
        constant + swing >= least && constant - swing <= most
    }
}

impl PacketSpace {
    /// A triangle's edge functions in double precision. `None` where it is not sure which side of the triangle the packet
    /// sees.
    pub(super) fn edges_in_double(&self, corners: [Vec3; 3]) -> Option<Edges> {
        let triangle = self.map_triangle(corners);
        let size = self.size_of(&triangle);
        let plane = self.plane(&triangle, &size);
        // NaN fails this comparison.
        let is_clear = plane.facing.abs() > plane.facing_error;
        if !is_clear {
            return None;
        }
        let [e, f, g] = self.edge_functions(&triangle, plane.facing.signum());
        let steepest = greater(greater(e.slope(), f.slope()), g.slope());
        let error = self.edge_error(&size) + self.ray_error * steepest;
        Some([(e, error), (f, error), (g, error)])
    }

    /// A triangle in packet space.
    fn map_triangle(&self, [a, b, c]: [Vec3; 3]) -> PacketTriangle {
        PacketTriangle::new(self.map_point(a), self.map_point(b), self.map_point(c))
    }

    /// A triangle's absolute depth key in double precision, over the whole packet, and the bound on its error. `None`
    /// where it is not sure which side of the triangle the packet sees.
    pub(super) fn depth_key_in_double(&self, corners: [Vec3; 3]) -> Option<(Linear, f64)> {
        let triangle = self.map_triangle(corners);
        let plane = self.plane(&triangle, &self.size_of(&triangle));
        // NaN fails this comparison.
        let is_clear = plane.facing.abs() > 4.0 * plane.facing_error;
        is_clear.then(|| {
            let inverse = 1.0 / plane.facing;
            let key = self.depth_key(&triangle, &FunctionDomain::PACKET, inverse);
            let error = key.reach() * plane.facing_error + plane.numerator_error;
            (key, 2.0 * error * inverse.abs())
        })
    }

    /// Sets up eight triangles, each for the rays of its bounds.
    #[inline(always)]
    pub(crate) fn set_up(&self, corners: &CornerLanes, boxes: &[RayBox; LANES]) -> TriangleSetup {
        let corners = self.map(corners);
        let mut out = TriangleSetup {
            edges: [[[0.0; LANES]; 3]; 3],
            edge_error: [0.0; LANES],
            edge_scales: [[1.0; LANES]; 3],
            depth_key: [[0.0; LANES]; 3],
            depth_key_error: [0.0; LANES],
            column: [0; LANES],
            row: [0; LANES],
            boxes: *boxes,
            ill_conditioned: [false; LANES],
            overflows: false,
            is_rough: [false; LANES],
        };
        for l in 0..LANES {
            let triangle = PacketTriangle::of(&corners, l);
            let size = self.size_of(&triangle);
            let plane = self.plane(&triangle, &size);
            // NaN fails this comparison and is ill-conditioned.
            let clear = plane.facing.abs() > 4.0 * plane.facing_error;
            let culled = (self.cull == Cull::Back) & clear & (plane.facing > 0.0);
            let span = FunctionDomain::of(&boxes[l]);
            out.column[l] = span.column;
            out.row[l] = span.row;
            out.boxes[l].right = if culled { -1 } else { boxes[l].right };

            let sign = if plane.facing < 0.0 { -1.0 } else { 1.0 };
            let edges = self.edge_functions(&triangle, sign);
            let edges = edges.map(|edge| edge.moved(&span));
            let [e0, e1, e2] = edges;
            let sizes = [e0.size(&span), e1.size(&span), e2.size(&span)];
            let magnitude = greater(greater(sizes[0], sizes[1]), sizes[2]);
            let least = lesser(lesser(sizes[0], sizes[1]), sizes[2]);
            let steepest = greater(greater(e0.slope(), e1.slope()), e2.slope());
            let unit = 1.0 / magnitude;
            let edge_error = self.edge_error(&size) + self.ray_error * steepest;
            let edge_error = (edge_error * unit + LINEAR_ERROR) * 1.001;
            out.edge_error[l] = edge_error as f32;
            for (out, edge) in out.edges.iter_mut().zip(edges) {
                let edge = edge.times(unit).without_terms_below(NEGLIGIBLE, &span);
                out[0][l] = edge.constant as f32;
                out[1][l] = edge.x as f32;
                out[2][l] = edge.y as f32;
            }

            let inverse = self.key_factor / plane.facing;
            let key = self.depth_key(&triangle, &span, inverse);
            let greatest = key.size(&span);
            let key = key.less(self.reference.moved(&span));
            let spread = key.size(&span);
            let key_error = spread * LINEAR_ERROR
                + self.reference_error
                + 2.0 * (greatest * plane.facing_error + plane.numerator_error) * inverse.abs();
            let key = key.without_terms_below(spread * NEGLIGIBLE, &span);
            out.depth_key[0][l] = key.constant as f32;
            out.depth_key[1][l] = key.x as f32;
            out.depth_key[2][l] = key.y as f32;
            out.depth_key_error[l] = (key_error * 1.001) as f32 + f32::MIN_POSITIVE;
            // Overflow of single precision and NaN count as ill-conditioned too.
            let sound = (magnitude < f64::INFINITY)
                & (magnitude > 0.0)
                & (edge_error < 1.0)
                & (key_error < f64::from(f32::MAX))
                & (spread < f64::from(f32::MAX));
            out.ill_conditioned[l] = !(clear & sound);
            let smooth =
                are_edges_smooth(edge_error, least, magnitude) & (key_error < MOST_SMOOTH * spread);
            out.is_rough[l] = !(clear & sound & smooth);
        }
        out
    }

    /// The magnitudes that a triangle's error bounds are made of.
    #[inline(always)]
    fn size_of(&self, triangle: &PacketTriangle) -> Magnitudes {
        let PacketTriangle { a, b, c, u, v, .. } = *triangle;
        let reach = greater(
            greatest_of_three(a[0], b[0], c[0]),
            greatest_of_three(a[1], b[1], c[1]),
        );
        let depth = greatest_of_three(a[2], b[2], c[2]);
        Magnitudes {
            reach,
            depth,
            // Differences of b and c are at most the sum of these.
            wide: 2.0
                * greater(
                    greater(u[0].abs(), u[1].abs()),
                    greater(v[0].abs(), v[1].abs()),
                ),
            deep: 2.0 * greater(u[2].abs(), v[2].abs()),
            delta: self.delta(reach, depth),
        }
    }

    /// Which side of the triangle the packet sees, and the errors of its plane.
    #[inline(always)]
    fn plane(&self, triangle: &PacketTriangle, size: &Magnitudes) -> Facing {
        let Magnitudes {
            reach,
            depth,
            wide,
            deep,
            delta,
        } = *size;
        let (kh, n) = (self.stretch_and_reach, triangle.n);
        let plane_error = |reach: f64| {
            (reach * deep + depth * wide) * (16.0 * kh * delta + 24.0 * EPSILON * wide)
                + 12.0 * delta * reach * wide
        };
        if self.perspective {
            Facing {
                facing: triangle.a_n,
                facing_error: plane_error(reach),
                numerator_error: self.ray_error * (n[0].abs() + n[1].abs()),
            }
        } else {
            Facing {
                facing: n[2],
                facing_error: 8.0 * (kh * delta + EPSILON * wide) * wide,
                numerator_error: plane_error(reach + REACH),
            }
        }
    }

    /// E, before rays' own errors.
    #[inline(always)]
    fn edge_error(&self, size: &Magnitudes) -> f64 {
        let weight = if self.perspective { size.depth } else { 1.0 };
        (size.reach + REACH * weight)
            * (4.0 * self.stretch_and_reach * size.delta + 32.0 * EPSILON * size.reach)
    }

    /// The triangle's edge functions, times `sign`.
    #[inline(always)]
    fn edge_functions(&self, triangle: &PacketTriangle, sign: f64) -> [Linear; 3] {
        let weighted = |[x, y, z]: [f64; 3]| [x, y, if self.perspective { z } else { 1.0 }];
        let edge = |[px, py, pw]: [f64; 3], [qx, qy, qw]: [f64; 3]| Linear {
            constant: (px * qy - py * qx) * sign,
            x: (py * qw - pw * qy) * sign,
            y: (pw * qx - px * qw) * sign,
        };
        let (a, b, c) = (
            weighted(triangle.a),
            weighted(triangle.b),
            weighted(triangle.c),
        );
        [edge(b, c), edge(c, a), edge(a, b)]
    }

    /// The depth key at the span's first ray, and its steps; `inverse` is the reciprocal of [`Facing::facing`].
    #[inline(always)]
    fn depth_key(&self, triangle: &PacketTriangle, span: &FunctionDomain, inverse: f64) -> Linear {
        let [nx, ny, nz] = triangle.n;
        let constant = if self.perspective {
            nz + nx * span.i + ny * span.j
        } else {
            nx * span.i + ny * span.j - triangle.a_n
        };
        Linear {
            constant: constant * inverse,
            x: nx * inverse,
            y: ny * inverse,
        }
    }
}

/// A triangle in packet space: its corners, two edges from the first, their cross product n, and P₀·n.
#[derive(Clone, Copy)]
struct PacketTriangle {
    a: [f64; 3],
    b: [f64; 3],
    c: [f64; 3],
    u: [f64; 3],
    v: [f64; 3],
    n: [f64; 3],
    a_n: f64,
}

impl PacketTriangle {
    #[inline(always)]
    fn of(corners: &[[f64; LANES]; 9], l: usize) -> Self {
        let corner = |k: usize| [corners[k][l], corners[k + 1][l], corners[k + 2][l]];
        Self::new(corner(0), corner(3), corner(6))
    }

    #[inline(always)]
    fn new(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> Self {
        let from_a = |p: [f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
        let (u, v) = (from_a(b), from_a(c));
        let n = [
            u[1] * v[2] - u[2] * v[1],
            u[2] * v[0] - u[0] * v[2],
            u[0] * v[1] - u[1] * v[0],
        ];
        let a_n = a[0] * n[0] + a[1] * n[1] + a[2] * n[2];
        Self {
            a,
            b,
            c,
            u,
            v,
            n,
            a_n,
        }
    }
}

/// A, Z, L, M and δ of a triangle.
#[derive(Clone, Copy)]
struct Magnitudes {
    reach: f64,
    depth: f64,
    wide: f64,
    deep: f64,
    delta: f64,
}

/// A triangle's plane as a packet sees it.
#[derive(Clone, Copy)]
struct Facing {
    /// The depth key's denominator, P₀·n or n₃: negative where the triangle's front faces the eye.
    facing: f64,
    facing_error: f64,
    /// The error of the depth key's numerator, without what `facing_error` covers.
    numerator_error: f64,
}

/// The greatest magnitude of three.
#[inline(always)]
fn greatest_of_three(a: f64, b: f64, c: f64) -> f64 {
    greater(greater(a.abs(), b.abs()), c.abs())
}
