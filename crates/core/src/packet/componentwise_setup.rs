//! Set-up of triangles with componentwise error bounds, for the few that [`setup`](super::setup) leaves undecided
//! because its bounds are proportional to the greatest coordinate: triangles with a corner close to the eye, with
//! coordinates of very different magnitudes, or whose distance is many times their size.
//!
//! Nothing is mapped to packet space. With P and Q two corners relative to the eye, in world space, and
//! d(i, j) = d + i·a + j·b the direction of a ray, its edge function is d(i, j)·(P×Q), and the inverse depth is
//! d(i, j)·n / (D·P₀·(P₁×P₂)). Orthographic rays run along d from o + i·a + j·b, with P and Q relative to o; there the
//! edge function is d·(P×Q) + (i·a + j·b)·(d×(Q−P)), and the depth P₀·n/(d·n) less (i·a + j·b)·n/(d·n).
//!
//! # Error bounds
//! ε = 2⁻⁵³ (notation and lemmas: `docs/error-bounds.md`); products of magnitudes are taken component by component, and |x|×|y|
//! is the cross product with all its terms added.
//!
//! * **Cross products.** P is off by ε|P| and by η, the origin's own error, which is the same for all corners; a
//!   difference of corners u = Q − P, taken from the stored ones, by ε|u| alone. P×Q is P×u and Q×u too, and each
//!   component is that of the three whose bound is least: off by 4ε of |P|×|Q|, |P|×|u| or |Q|×|u|, and by the
//!   origin's error times the sum of the two components of |u|, with second orders 1.01η.
//! * **Directions.** A direction is the sum of f, along the view axis, which is the same number for the packet and for all
//!   rays, and of terms of a place, G by component with those of the place's own coordinates (`Camera::greatest_terms`).
//!   The last sum rounds by ε(|f| + G), division by the length by as much, and what comes before rounds the place's
//!   terms by 5ε: a ray's direction is off by 2ε|f| + 7εG, d by ε|f| + 6εG, and i·a + j·b by 2εG.
//! * **Functions.** m·d rounds by 3ε(|f| + G)·|m|; steps round three times, and three more where a function is moved to
//!   another place: 6εG·|m|. Moving rounds the sum by 2ε of itself too, and its scale by ε: far less than what is
//!   left of [`LINEAR_ERROR`]. Together with 2ε for closer factors (below) (8ε|f| + 26εG)·|m| is taken.
//!   Orthographic rays run along d itself: 3ε|d|, and the steps' roundings are taken for eight.
//! * **Depth.** The product of a corner and a vector is off by the vector's error by |P| + η, by η times the vector, and by
//!   three roundings, which are taken for eight ([`ROUNDINGS`]). P₀·n is taken at the corner where that is least; where it is
//!   not clear, P₀·(P₁×P₂) is tried too. The key's numerator is a function as above, of n; a quotient whose denominator is
//!   off by a quarter of itself at most is off by 4/3 of what its parts are off by, relative to itself (lemma 6): we take 2.
//!   Inverse, products and sums round a key by 6ε of itself; its denominator's bound is 12ε of itself at least, of which it
//!   needs 7, and is taken twice. All this is of the whole key; it is made relative to the packet's reference
//!   afterwards, as in `setup`. Units of depth are powers of two, and round nothing.
//!
//! * **Closer factors.** From an eye that is not off, P₀·n is computed again where its sign is not clear, and P×Q where an
//!   edge function is off by more than [`RECOMPUTE_ABOVE`] of itself, and than rays' own roundings move it: planes, or
//!   edges' lines, that pass the eye within roundings. In double-double arithmetic, or exactly where that does not
//!   suffice, P×Q is off by 2ε of itself, which is counted along rays. Untested, because dominated: P₀·n's error is far
//!   below [`LINEAR_ERROR`], by which the key is off too.
//! * **Untested:** roundings of products with corners, with parallel rays' direction and with steps. Where they are
//!   largest, what cross products' own errors leave has covered them in all tests.
//!
//! An edge function that is surely negative in all of a triangle's bounds ends the set-up: no ray hits the triangle.
//!
//! Numbers that are zero or within 2^±200 keep products of four in double precision's range.

use super::setup::{
    Edges, FunctionDomain, LINEAR_ERROR, Linear, NEGLIGIBLE, PacketSpace, REACH, TriangleSetup,
    is_negative,
};
use crate::hit::Cull;
use crate::num::roundoff::EPSILON;
use crate::num::simd::{LANES, Lanes, Work};
use crate::triangle::exact::OffsetTriangle;
use crate::triangle::plane::distance_of_eye;
use crate::triangle::{CornerLanes, Determinant, cross_from};
use glam::{DVec3, Vec3, Vec3Swizzles};

/// The greatest magnitude of a number, and the reciprocal of the least one other than zero.
const NUMBER_RANGE: f64 = f64::from_bits((1023 + 200) << 52);

/// The error of an edge function, as a share of its greatest magnitude, from which on its cross product is computed
/// again, unless rays' own roundings move the function by as much: the edge's line passes the eye as closely as
/// roundings. With a lesser limit products are computed again that leave few rays undecided; with a greater one all
/// rays of such an edge are.
const RECOMPUTE_ABOVE: f64 = 1.0 / (1 << 12) as f64;

/// Roundings of a product with a vector: at most eight.
const ROUNDINGS: f64 = 8.0 * EPSILON;

/// A vector, and for each component a bound on its error.
#[derive(Clone, Copy)]
pub(super) struct Bounded {
    value: DVec3,
    error: DVec3,
}

impl Bounded {
    #[inline(always)]
    pub(super) fn cross_of(p: DVec3, q: DVec3) -> Self {
        let (plus, minus) = (p.yzx() * q.zxy(), p.zxy() * q.yzx());
        Self {
            value: plus - minus,
            error: (plus.abs() + minus.abs()) * (4.0 * EPSILON),
        }
    }

    /// The cross product of two corners, `u` from the first to the second: of P×Q, P×u and Q×u, in each component,
    /// the one with the least bound.
    #[inline(always)]
    fn cross(from: DVec3, to: DVec3, u: DVec3) -> Self {
        let direct = Self::cross_of(from, to);
        let [by_first, by_second] = [Self::cross_of(from, u), Self::cross_of(to, u)];
        direct.or_better(by_first).or_better(by_second)
    }

    #[inline(always)]
    fn or_better(self, other: Self) -> Self {
        let better = other.error.cmplt(self.error);
        Self {
            value: DVec3::select(better, other.value, self.value),
            error: DVec3::select(better, other.error, self.error),
        }
    }

    /// Adds the effect of an origin that is off by `origin_error`; the difference of the corners is not affected.
    #[inline(always)]
    fn moved(self, u: DVec3, origin_error: f64) -> Self {
        let u = u.abs();
        Self {
            error: self.error + (u.yzx() + u.zxy()) * (1.01 * origin_error),
            ..self
        }
    }

    /// The sum of the components' errors, weighted.
    #[inline(always)]
    fn error_by(&self, weights: DVec3) -> f64 {
        weights.dot(self.error) * 1.001
    }

    /// The effect of errors of the weights.
    #[inline(always)]
    fn error_of_weights(&self, errors: DVec3) -> f64 {
        (self.value.abs() + self.error).dot(errors) * 1.001
    }

    /// The product with a corner, and the bound on its error.
    #[inline(always)]
    fn dot(&self, corner: DVec3, origin_error: f64) -> (f64, f64) {
        let corner_error = corner.abs() * ROUNDINGS + origin_error;
        let error =
            self.error_by(corner.abs() + origin_error) + self.error_of_weights(corner_error);
        (corner.dot(self.value), error)
    }

    /// The error of products with a vector that is not off, roundings included.
    #[inline(always)]
    fn product_error(&self, by: DVec3) -> f64 {
        self.error_by(by.abs()) + self.error_of_weights(by.abs() * ROUNDINGS)
    }
}

/// The value with the lesser bound.
#[inline(always)]
fn better(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    if b.1 < a.1 { b } else { a }
}

/// Whether a number exceeds its bound by so much that its sign is sure and its reciprocal is off by a third at most.
#[inline(always)]
pub(super) fn is_clear((value, error): (f64, f64)) -> bool {
    value.abs() > 4.0 * error
}

/// What the functions of a triangle are computed from.
pub(super) struct Factors {
    /// Corners relative to the eye.
    relative: [DVec3; 3],
    normal: Bounded,
    /// For each edge its corners P and Q relative to the eye, and u = Q − P.
    edges: [(DVec3, DVec3, DVec3); 3],
    /// Whether all numbers are zero or within [`NUMBER_RANGE`].
    pub(super) in_range: bool,
}

impl Factors {
    #[inline(always)]
    pub(super) fn new([a, b, c]: [DVec3; 3], origin: DVec3) -> Self {
        let (p, q, r) = (a - origin, b - origin, c - origin);
        let (ab, bc, ca) = (b - a, c - b, a - c);
        let in_range = is_in_range(p)
            & is_in_range(q)
            & is_in_range(r)
            & is_in_range(ab)
            & is_in_range(bc)
            & is_in_range(ca);
        Self {
            relative: [p, q, r],
            normal: Bounded::cross(ab, -ca, bc),
            edges: [(q, r, bc), (r, p, ca), (p, q, ab)],
            in_range,
        }
    }
}

#[inline(always)]
pub(super) fn is_in_range(vector: DVec3) -> bool {
    is_number_in_range(vector.x) & is_number_in_range(vector.y) & is_number_in_range(vector.z)
}

#[inline(always)]
fn is_number_in_range(x: f64) -> bool {
    let size = x.abs();
    let is_too_small = (size < 1.0 / NUMBER_RANGE) & (size != 0.0);
    // NaN counts as out of range.
    !is_too_small & (size <= NUMBER_RANGE)
}

/// The functions of one triangle over the whole packet.
pub(super) struct Functions {
    /// The numerator of the depth key, and the bound on its error.
    numerator: (Linear, f64),
    /// Its denominator without D, which is negative where the front faces the eye, and the bound on its error.
    pub(super) facing: (f64, f64),
    /// Edge functions, not yet positive inside, and the bounds on their errors.
    pub(super) edges: [(Linear, f64); 3],
    /// Whether products in double precision do not suffice, or did not: of edges alone in [`PacketSpace::functions`].
    are_rounded: bool,
}

/// Triangles that are set up again with componentwise bounds.
pub(super) struct ComponentwiseSetup<'a> {
    pub(super) space: &'a PacketSpace,
    pub(super) corners: &'a CornerLanes,
    /// Lanes of the eight triangles, as bits.
    pub(super) which: u32,
    pub(super) out: &'a mut TriangleSetup,
    /// Whether they are set up one by one: written for those to come. No answer depends on it.
    pub(super) one_by_one: &'a mut bool,
}

impl Work for ComponentwiseSetup<'_> {
    #[inline(always)]
    fn run(self, _: impl Lanes) {
        let Self {
            space,
            corners,
            which,
            out,
            one_by_one,
        } = self;
        let alone = match *one_by_one {
            true => which,
            false => space.set_up_together(*corners, which, out),
        };
        // Those that gain nothing from the others.
        let mut gain_nothing = 0;
        for l in 0..LANES {
            if which >> l & 1 == 0 {
                continue;
            }
            let mut is_rounded = alone >> l & 1 != 0;
            if is_rounded && out.boxes[l].right >= 0 {
                is_rounded = space.set_up_closely(corners_in_lane(corners, l), l, out);
            }
            gain_nothing += u32::from(is_rounded || out.boxes[l].right < 0);
        }
        *one_by_one = 2 * gain_nothing > which.count_ones();
    }
}

#[inline(always)]
pub(super) fn corners_in_lane(
    [ax, ay, az, bx, by, bz, cx, cy, cz]: &CornerLanes,
    l: usize,
) -> [DVec3; 3] {
    [
        Vec3::new(ax[l], ay[l], az[l]).as_dvec3(),
        Vec3::new(bx[l], by[l], bz[l]).as_dvec3(),
        Vec3::new(cx[l], cy[l], cz[l]).as_dvec3(),
    ]
}

impl PacketSpace {
    /// Sets up those of eight triangles that `which` selects, from products in double precision. Returns, as bits,
    /// those for which these do not suffice.
    ///
    /// The space and the set-up are copied, and what is true of any lane is collected afterwards: the compiler turns the
    /// loop into vectors only if nothing in it may overlap and no iteration writes where another does.
    #[inline(always)]
    fn set_up_together(&self, corners: CornerLanes, which: u32, out: &mut TriangleSetup) -> u32 {
        let (space, mut set_up) = (self.clone(), out.clone());
        let (mut alone, mut overflow) = ([false; LANES], [false; LANES]);
        for l in 0..LANES {
            let factors = Factors::new(corners_in_lane(&corners, l), space.origin);
            let functions = space.functions(&factors);
            let is_selected = (which >> l & 1 != 0) & factors.in_range;
            alone[l] = is_selected & space.are_rounded(&functions);
            overflow[l] = space.store(&functions, (l, is_selected), &mut set_up);
        }
        set_up.overflows |= overflow.contains(&true);
        *out = set_up;
        (alone.into_iter().enumerate()).fold(0, |bits, (l, is)| bits | u32::from(is) << l)
    }

    /// Stores a triangle's functions as those of lane `l`, if it is selected. If no ray hits the triangle its ray
    /// bounds are emptied. Returns whether its depth key alone overflows single precision.
    #[inline(always)]
    fn store(&self, functions: &Functions, lane: (usize, bool), out: &mut TriangleSetup) -> bool {
        let (facing, facing_error) = functions.facing;
        let span = FunctionDomain::of(&out.boxes[lane.0]);
        let inverse = self.key_factor / (facing * self.rays.distance * self.units);
        let (numerator, numerator_error) = functions.numerator;
        let key = numerator.times(inverse).moved(&span);
        let greatest = key.size(&span);
        let key = key.less(self.reference.moved(&span));
        let error = self.reference_error
            + 2.0 * greatest * (facing_error / facing.abs())
            + 2.0 * numerator_error * inverse.abs();
        self.store_with_key(functions, (key, error), &span, lane, out)
    }

    /// [`Self::store`] with a depth key relative to the packet's reference and to the span's first ray, whose error is
    /// bounded but for its roundings in single precision.
    #[inline(always)]
    pub(super) fn store_with_key(
        &self,
        functions: &Functions,
        (key, error): (Linear, f64),
        span: &FunctionDomain,
        (l, is_selected): (usize, bool),
        out: &mut TriangleSetup,
    ) -> bool {
        let facing = functions.facing.0;
        let clear = is_clear(functions.facing);
        let mut culled = (self.cull == Cull::Back) & (facing > 0.0);
        let sign = if facing < 0.0 { -1.0 } else { 1.0 };
        let (is_sound, is_missed) = out.store_edges(&functions.edges, sign, (l, is_selected), span);
        culled |= is_missed;
        let spread = key.size(span);
        let key_error = spread * LINEAR_ERROR + error;
        let key = key.without_terms_below(spread * NEGLIGIBLE, span);
        for (out, term) in out.depth_key.iter_mut().zip([key.constant, key.x, key.y]) {
            out[l] = if is_selected { term as f32 } else { out[l] };
        }
        let error = (key_error * 1.001) as f32 + f32::MIN_POSITIVE;
        let depth_key_error = &mut out.depth_key_error[l];
        *depth_key_error = if is_selected { error } else { *depth_key_error };
        let is_in_range = (key_error < f64::from(f32::MAX)) & (spread < f64::from(f32::MAX));
        let ill_conditioned = !(clear & is_sound & is_in_range);
        out.ill_conditioned[l] = if is_selected {
            ill_conditioned
        } else {
            out.ill_conditioned[l]
        };
        out.is_rough[l] &= !is_selected;
        culled &= clear & is_selected;
        out.boxes[l].right = if culled { -1 } else { out.boxes[l].right };
        is_selected & !culled & clear & is_sound & !is_in_range
    }

    /// Sets up lane `l` again, from closer factors where double precision does not suffice, and ends as soon as it is
    /// known that no ray hits the triangle. Whether closer factors were needed.
    #[inline(always)]
    fn set_up_closely(&self, corners: [DVec3; 3], l: usize, out: &mut TriangleSetup) -> bool {
        let span = FunctionDomain::of(&out.boxes[l]);
        let mut is_missed = false;
        let functions = self.functions_closely(corners, |facing, (edge, error)| {
            let sign = if facing < 0.0 { -1.0 } else { 1.0 };
            is_missed = is_negative(edge.moved(&span).times(sign), *error, &span);
            is_missed
        });
        if is_missed {
            out.boxes[l].right = -1;
        }
        let Some(functions) = functions else {
            return false;
        };
        out.overflows |= self.store(&functions, (l, true), out);
        functions.are_rounded
    }

    /// A triangle's edge functions with componentwise bounds. `None` where it is not sure which side of the triangle the
    /// packet sees.
    pub(super) fn edges_componentwise(&self, corners: [Vec3; 3]) -> Option<Edges> {
        let Functions { facing, edges, .. } =
            self.functions_closely(corners.map(Vec3::as_dvec3), |_, _| false)?;
        let sign = facing.0.signum();
        is_clear(facing).then(|| edges.map(|(function, error)| (function.times(sign), error)))
    }

    /// Upper bounds of the components of i·a + j·b.
    #[inline(always)]
    fn reach(&self) -> DVec3 {
        let [a, b] = self.rays.steps;
        (a.abs() + b.abs()) * REACH
    }

    /// A triangle's functions, from products in double precision.
    #[inline(always)]
    pub(super) fn functions(&self, factors: &Factors) -> Functions {
        let [e, f, g] = factors.edges;
        let [(e, is_e_rounded), (f, is_f_rounded), (g, is_g_rounded)] =
            [self.edge(e), self.edge(f), self.edge(g)];
        let (numerator, facing) = self.depth_function(factors);
        Functions {
            numerator,
            facing,
            edges: [e, f, g],
            are_rounded: is_e_rounded | is_f_rounded | is_g_rounded,
        }
    }

    /// The numerator of the depth key and its denominator without D, each with the bound on its error.
    #[inline(always)]
    fn depth_function(&self, factors: &Factors) -> ((Linear, f64), (f64, f64)) {
        let (d, [a, b]) = (self.rays.direction, self.rays.steps);
        let Factors {
            relative: [p, q, r],
            normal,
            ..
        } = factors;
        let n = normal.value;
        let mut product = normal.dot(*p, self.origin_error);
        product = better(product, normal.dot(*q, self.origin_error));
        product = better(product, normal.dot(*r, self.origin_error));
        let (constant, error, facing) = if self.perspective {
            (d.dot(n), self.error_along_rays(normal), product)
        } else {
            let error = product.1 + normal.product_error(self.reach());
            (-product.0, error, (d.dot(n), normal.product_error(d)))
        };
        let numerator = Linear {
            constant,
            x: a.dot(n),
            y: b.dot(n),
        };
        ((numerator, error), facing)
    }

    /// An edge function with the bound on its error, and whether it [is rounded](PacketSpace::is_rounded).
    #[inline(always)]
    fn edge(&self, (from, to, u): (DVec3, DVec3, DVec3)) -> ((Linear, f64), bool) {
        let product = Bounded::cross(from, to, u);
        let function = self.edge_function(&product, u);
        (function, self.is_rounded(&product, function.0.reach()))
    }

    /// Whether the error of a cross product, by which a perspective packet's edge function is off, exceeds both a share
    /// of the function's greatest magnitude and what rays' own roundings move it by. NaN does.
    #[inline(always)]
    fn is_rounded(&self, product: &Bounded, reach: f64) -> bool {
        let error = product.error_by(self.rays.direction.abs() + self.reach());
        let by_rays = product.error_of_weights(self.rays.error);
        !((error <= RECOMPUTE_ABOVE * reach) | (error <= by_rays))
    }

    /// Whether closer factors would make the functions more accurate where it matters.
    #[inline(always)]
    pub(super) fn are_rounded(&self, functions: &Functions) -> bool {
        let edges = functions.are_rounded & (self.origin_error == 0.0);
        self.perspective & (edges | !is_clear(functions.facing))
    }

    /// A triangle's functions, from closer factors where double precision does not suffice. `None` where a number is
    /// out of [`NUMBER_RANGE`], or `misses` says of the denominator and an edge function that nothing more is needed;
    /// it is called where the denominator is clear.
    #[inline(always)]
    pub(super) fn functions_closely(
        &self,
        corners: [DVec3; 3],
        mut misses: impl FnMut(f64, &(Linear, f64)) -> bool,
    ) -> Option<Functions> {
        let factors = Factors::new(corners, self.origin);
        if !factors.in_range {
            return None;
        }
        let corners = corners.map(DVec3::as_vec3);
        let (numerator, mut facing) = self.depth_function(&factors);
        let is_facing_rounded = self.perspective && !is_clear(facing);
        if is_facing_rounded {
            facing = self.facing_closely(facing, &factors, corners);
        }
        let mut functions = Functions {
            numerator,
            facing,
            edges: [(Linear::ZERO, 0.0); 3],
            are_rounded: is_facing_rounded,
        };
        let [a, b, c] = corners;
        let ends = [[b, c], [c, a], [a, b]];
        let may_be_closer = self.perspective && self.origin_error == 0.0;
        for (edge, (from, to, u)) in factors.edges.into_iter().enumerate() {
            let product = Bounded::cross(from, to, u);
            let mut function = self.edge_function(&product, u);
            if may_be_closer && self.is_rounded(&product, function.0.reach()) {
                functions.are_rounded = true;
                let closer = Bounded {
                    value: cross_from(self.origin, ends[edge]),
                    error: DVec3::ZERO,
                };
                function = self.edge_function(&closer, u);
            }
            if is_clear(facing) && misses(facing.0, &function) {
                return None;
            }
            functions.edges[edge] = function;
        }
        Some(functions)
    }

    /// The product of a corner and the normal, where that of [`Self::depth_function`] is not clear.
    fn facing_closely(
        &self,
        mut product: (f64, f64),
        factors: &Factors,
        corners: [Vec3; 3],
    ) -> (f64, f64) {
        // A corner and the edge opposite to it have the same product.
        for (corner, (from, to, u)) in factors.relative.into_iter().zip(factors.edges) {
            let across = Bounded::cross(from, to, u).moved(u, self.origin_error);
            product = better(product, across.dot(corner, self.origin_error));
        }
        if is_clear(product) || self.origin_error != 0.0 {
            return product;
        }
        // Planes that pass the eye more closely than roundings, with no corner next to it.
        let origin = DVec3::ZERO;
        let Determinant { value, error } =
            distance_of_eye(self.origin, &OffsetTriangle { corners, origin });
        (value, error)
    }

    /// An edge function of the place in the packet, and a bound on its error: `product` is the cross product of two
    /// corners, `u` is the second less the first.
    #[inline(always)]
    pub(super) fn edge_function(&self, product: &Bounded, u: DVec3) -> (Linear, f64) {
        let (d, [a, b]) = (self.rays.direction, self.rays.steps);
        if self.perspective {
            let product = product.moved(u, self.origin_error);
            let function = Linear {
                constant: d.dot(product.value),
                x: a.dot(product.value),
                y: b.dot(product.value),
            };
            (function, self.error_along_rays(&product))
        } else {
            let slope = Bounded::cross_of(d, u);
            let function = Linear {
                constant: d.dot(product.value),
                x: a.dot(slope.value),
                y: b.dot(slope.value),
            };
            let error = product.error_by(d.abs())
                + product.error_of_weights(self.rays.error)
                + slope.product_error(self.reach())
                + slope.error_of_weights(DVec3::splat(self.origin_error));
            (function, error)
        }
    }

    /// Bound on the error of a vector's product with the direction of any ray of a perspective packet.
    #[inline(always)]
    fn error_along_rays(&self, vector: &Bounded) -> f64 {
        vector.error_by(self.rays.direction.abs() + self.reach())
            + vector.error_of_weights(self.rays.error)
    }
}
