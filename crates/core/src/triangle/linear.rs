//! t, u and v of eight rays that share an eye, from functions that are linear over the image plane: one division
//! and one square root a ray (Olano and Greer, "Triangle Scan Conversion using 2D Homogeneous Coordinates", 1997).
//!
//! With corners a, b and c relative to the eye and a ray's direction D, not of unit length, the plane's normal is
//! N = (b−a) × (c−a), and
//!
//! > u = D·((c−a) × a) / D·N,  v = D·(a × (b−a)) / D·N,  t = |D| · a·N / D·N
//!
//! D is linear in the ray's place. The results must be those of [`PreparedRay`](super::PreparedRay), which computes
//! them differently: a lane is sure only where all numbers within the bounds of either path round to one
//! single-precision number.
//!
//! # Error bound
//! ε = 2⁻⁵³ (notation: `docs/error-bounds.md`); m the greatest coordinate of a corner relative to the eye, e that of
//! an edge, at most 2m; η the error of the eye; R at least each coordinate of D.
//!
//! * **These functions.** A corner is off by εm + η, an edge by εe, and a coordinate of (c−a) × a by 8εem + 2η·e with
//!   its own rounding. Its product with D, in whose six roundings each term is at most R·2em, is off by R·e(63εm +
//!   9η). D itself is off by 5εR a coordinate on either path, which is 60εRem. D·N is off by less than 120εRem. So u
//!   and v are off by R·e(250εm + 9η)/|D·N| and 3ε.
//! * **The single ray.** Its edge functions' bound is E = 2δ(Σ|x| + Σ|y| + δ) with δ = 8εm + 3η. The ray passes
//!   inside: no sheared coordinate is beyond a sheared edge, 2e, and its error. While δ ≤ 2⁻¹⁰e, E ≤ 25δe. The
//!   determinant is D·N over D's coordinate along the major axis, so E is at most 25δe·R/|D·N| of it, and u and v are
//!   off by four times that and 3ε.
//! * **Together** K/|D·N| + 8ε, with K = R·e(1100εm + 320η).
//! * **t.** The single ray's depth is off by 4E·e/|determinant| + 2δ, less than K·e/|D·N| + 2δ, and t by √3 times
//!   that, since a unit vector's longest coordinate is at least 1/√3. The functions' a·N is off by 54εme² + 6ηe², t by
//!   less than a tenth of K·e/|D·N| for that, and as much for D·N. With the roundings of t and |D|: 2K·e/|D·N| + 4δ +
//!   32εt.
//! * **Dominated terms.** |D·N| ≤ 6Re², so K/|D·N| ≥ 183εm/e. Then t's first term is more than 366εm, and covers 4δ and
//!   the roundings: t ≤ √3·m. As e ≤ 2m, a weight's 8ε are covered too. Where K/|D·N| ≤ 2⁻²⁸, δ is less than 2⁻³²e.
//! * **The same path.** Where K/|D·N| ≤ 2⁻²⁸ and each weight is greater than its bound, the single ray's edge functions
//!   are beyond E and well conditioned; where t's bound is at most 2⁻²⁸t, its t is good to single precision.

use super::interpolate::{LANES, RowHits};
use crate::camera::{Lattice, Projection};
use crate::num::roundoff::EPSILON;
use crate::ray::relative_origin;
use glam::{DVec3, Vec3};

/// The largest relative error that is accurate to single precision: a sixteenth of its unit roundoff, half of the
/// single ray's limit.
const SINGLE: f64 = 1.0 / (1u64 << 28) as f64;

/// The error bound of a weight in a triangle's middle beyond which the linear functions are not tried. Eight rays
/// have 24 numbers, and a number with an error of 2⁻³³ straddles the border between two single-precision numbers
/// about once in a hundred: with a larger bound most attempts would be in vain, with a smaller one triangles would be
/// interpolated slowly that need not be.
const HOPELESS: f64 = 1.0 / (1u64 << 33) as f64;

/// Lengths, and products of lengths, for which nothing overflows, and nothing underflows by as much as the bounds.
const REACHES: std::ops::RangeInclusive<f64> = 1e-60..=1e60;

/// Rays through one eye (in projective geometry, the lines through a point).
pub(crate) struct Pencil {
    /// The eye relative to the tree's origin.
    eye: DVec3,
    /// Bound on the error of its coordinates.
    eye_error: f64,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// An upper bound of the coordinates of directions.
    reach: f64,
}

/// A row of a pencil's rays; their directions are `first + right · across`.
pub(crate) struct PencilRow {
    first: DVec3,
    /// The square of a direction's length as a polynomial in `across`.
    square: [f64; 3],
}

impl Pencil {
    /// The rays of a lattice; `None` unless they share an eye.
    pub(crate) fn new(lattice: &Lattice, tree_origin: DVec3) -> Option<Self> {
        let camera = &lattice.camera;
        if camera.projection() != Projection::Perspective || lattice.is_empty() {
            return None;
        }
        let (eye, eye_error) = relative_origin(camera.pose().eye, tree_origin);
        let [first, last] =
            [(0, 0), (lattice.columns - 1, lattice.rows - 1)].map(|(column, row)| {
                let (x, y) = lattice.place(column, row);
                camera.across_and_along(x, y)
            });
        let across = first.0.abs().max(last.0.abs());
        let along = first.1.abs().max(last.1.abs());
        Some(Self {
            eye,
            eye_error,
            right: camera.right(),
            up: camera.up(),
            forward: camera.forward() * camera.distance(),
            reach: across + along + camera.distance(),
        })
    }

    /// The row at a height `along` above the view axis.
    #[inline(always)]
    pub(crate) fn row(&self, along: f64) -> PencilRow {
        let first = self.up * along + self.forward;
        let square = [
            first.dot(first),
            2.0 * first.dot(self.right),
            self.right.dot(self.right),
        ];
        PencilRow { first, square }
    }
}

/// The linear functions of a triangle that rays of a pencil are known to hit.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LinearHit {
    /// For u, v and the determinant, the vector whose product with D is its numerator.
    normals: [DVec3; 3],
    /// The change of these products along `right`.
    slopes: [f64; 3],
    /// a·N.
    numerator: f64,
    /// K.
    error: f64,
    /// 2e and 4δ.
    t_error: [f64; 2],
    /// Whether the bounds hold, and rays in the triangle's middle are likely sure.
    is_useful: bool,
}

impl LinearHit {
    /// For the triangle with these corners, relative to the tree's origin.
    #[inline(never)]
    pub(crate) fn new(pencil: &Pencil, corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac);
        let from_eye = [a, b, c].map(|corner| corner - pencil.eye);
        let [a, b, c] = from_eye;
        let normals = [ac.cross(a), a.cross(ab), normal];
        let m = (a.abs().max(b.abs()).max(c.abs())).max_element();
        let e = (ab.abs().max(ac.abs()).max((c - b).abs())).max_element();
        let (reach, eye_error) = (pencil.reach, pencil.eye_error);
        let delta = 8.0 * EPSILON * m + 3.0 * eye_error;
        let error = reach * e * (1100.0 * EPSILON * m + 320.0 * eye_error);
        let numerator = a.dot(normal);
        // A ray through the middle, scaled so that D·N equals a·N.
        let middle = (a + b + c).abs().max_element() / 3.0;
        let is_useful = REACHES.contains(&reach)
            && REACHES.contains(&e)
            && delta * 1024.0 <= e
            && error * middle <= HOPELESS * reach * numerator.abs();
        Self {
            normals,
            slopes: normals.map(|normal| normal.dot(pencil.right)),
            numerator,
            error,
            t_error: [2.0 * e, 4.0 * delta],
            is_useful,
        }
    }

    /// Whether the bounds of [`LinearHit::interpolate`] hold, and its lanes are likely sure.
    #[inline(always)]
    pub(crate) fn is_useful(&self) -> bool {
        self.is_useful
    }

    /// Interpolates eight rays of a row, at these distances to the right of the view axis: t where `T`, u and v where
    /// `WEIGHTS`. Values that are not asked for make no lane unsure.
    #[inline(always)]
    #[allow(
        clippy::needless_range_loop,
        reason = "a lane is an index into all the arrays at once"
    )]
    pub(crate) fn interpolate<const T: bool, const WEIGHTS: bool>(
        &self,
        row: &PencilRow,
        across: &[f64; LANES],
    ) -> RowHits {
        let [u, v, w] = self.normals.map(|normal| normal.dot(row.first));
        let [u_slope, v_slope, w_slope] = self.slopes;
        let [per_weight, fixed] = self.t_error;
        let [constant, linear, quadratic] = row.square;
        let mut hits = RowHits::NONE;
        // Plain loops over arrays, which the compiler vectorises.
        for lane in 0..LANES {
            let x = across[lane];
            let inverse = 1.0 / (w + w_slope * x);
            let u = (u + u_slope * x) * inverse;
            let v = (v + v_slope * x) * inverse;
            let spread = (self.error * inverse).abs();
            let weight_error = spread + 8.0 * EPSILON;
            let one = |number: f64, error: f64| (number - error) as f32 == (number + error) as f32;
            let mut sure = (spread <= SINGLE)
                & (u > weight_error)
                & (v > weight_error)
                & (1.0 - u - v > weight_error);
            if T {
                let length = (constant + (linear + quadratic * x) * x).sqrt();
                let t = self.numerator * inverse * length;
                let t_error = per_weight * spread + fixed + 32.0 * EPSILON * t;
                sure = sure & (t_error <= SINGLE * t) & one(t, t_error);
                hits.t[lane] = t as f32;
            }
            if WEIGHTS {
                sure = sure & one(u, weight_error) & one(v, weight_error);
                hits.u[lane] = u as f32;
                hits.v[lane] = v as f32;
            }
            hits.sure[lane] = sure;
        }
        hits
    }
}

#[cfg(test)]
mod tests {
    use super::super::PreparedRay;
    use super::super::interpolate::RowPlaces;
    use super::super::row_tests::{SCENES, triangle_and_rays};
    use super::*;
    use crate::hit::{Cull, Precision};
    use crate::random::Random;

    /// Counts of what became of the rays.
    #[derive(Debug, Default)]
    struct Tally {
        sure: u32,
        unsure: u32,
        wrong: u32,
    }

    /// Casts rows of eight rays at triangles, with error terms changed.
    fn tally(
        scene: (DVec3, f64),
        change_eye: impl Fn(&mut Pencil),
        change: impl Fn(&mut LinearHit),
    ) -> Tally {
        let mut random = Random(7);
        let mut tally = Tally::default();
        for _ in 0..4000 {
            let (corners, lattice) = triangle_and_rays(&mut random, scene);
            let mut pencil = Pencil::new(&lattice, scene.0).expect("rays of one eye");
            change_eye(&mut pencil);
            let mut hit = LinearHit::new(&pencil, corners);
            change(&mut hit);
            for row in 0..lattice.rows {
                let (_, y) = lattice.place(0, row);
                let across = RowPlaces::new(&lattice, 0, row).across(&lattice.camera);
                let pencil_row = pencil.row(lattice.camera.across_and_along(0.0, y).1);
                let found = hit.interpolate::<true, true>(&pencil_row, &across);
                for column in 0..LANES {
                    if !found.sure[column] {
                        tally.unsure += 1;
                        continue;
                    }
                    tally.sure += 1;
                    let ray = lattice.ray(column as u32, row);
                    let ray = PreparedRay::new(&ray, scene.0, Cull::None, Precision::Exact);
                    let ray = ray.expect("a valid ray");
                    let expected = ray.hit_on(0, corners).to_primitive_hit();
                    let numbers = [found.t[column], found.u[column], found.v[column]];
                    let is_same = numbers == [expected.t, expected.u, expected.v];
                    tally.wrong += u32::from(!is_same);
                }
            }
        }
        tally
    }

    #[test]
    fn sure_lanes_have_the_bits_of_the_single_ray() {
        for scene in SCENES {
            let tally = tally(scene, |_| {}, |_| {});
            assert_eq!(tally.wrong, 0, "{tally:?}");
            assert!(tally.sure > 5_000 && tally.unsure > 5_000, "{tally:?}");
        }
    }

    /// For each term that no other covers, with that term at zero: the eye's error, K, and t's.
    #[test]
    fn with_any_term_of_the_bound_at_zero_sure_lanes_have_wrong_bits() {
        let without_eye_error = tally(SCENES[2], |pencil| pencil.eye_error = 0.0, |_| {});
        assert!(without_eye_error.wrong > 0, "{without_eye_error:?}");
        let without_k = tally(SCENES[0], |_| {}, |hit| hit.error = 0.0);
        assert!(without_k.wrong > 0, "{without_k:?}");
        let without_t = tally(SCENES[0], |_| {}, |hit| hit.t_error[0] = 0.0);
        assert!(without_t.wrong > 0, "{without_t:?}");
    }
}
