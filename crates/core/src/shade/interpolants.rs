//! What varies over a triangle, as functions that are linear over the image plane (Olano and Greer, "Triangle Scan
//! Conversion using 2D Homogeneous Coordinates", 1997).
//!
//! With corners a, b and c relative to the eye, N = (b−a) × (c−a) and a ray's direction D, not of unit length,
//!
//! > U = D·((c−a) × a),  V = D·(a × (b−a)),  W = D·N,  u = U/W,  v = V/W,  t = |D| · a·N / W
//!
//! In a planar picture D is linear in the place, and so are U, V and W. A value with p, q and r at the corners is
//! (p·(W−U−V) + q·U + r·V) / W, whose numerator is linear too; a normal needs no division, since it is made unit length.
//! Parallel rays share D; their origins, relative to the camera's eye, are subtracted from the corners and linear likewise.
//!
//! # Error bound
//! ε = 2⁻⁵³ (notation: `docs/error-bounds.md`); m the greatest coordinate of a corner relative to the eye, e that of an
//! edge, at most 2m; η the error of the eye; D reaches the image plane at distance 1; R at least each coordinate of D, and
//! of each term that D is summed from, anywhere in the picture.
//!
//! * A corner is off by εm + η, an edge by εe, and a coordinate of (c−a) × a by 8εem + 2ηe with its own rounding. Times
//!   D, three coordinates: R·e(24εm + 6η). The coefficients of D are off by 8εR a coordinate and those of the ray that is
//!   cast by 5εR: 3·13εR·2em = 78εRem. A sum of three products, then of three terms of the place, each at most 3R·2em:
//!   eight roundings, 48εRem. So U and V are off by R·e(150εm + 6η), and W, whose N is off by 6εe², by as much.
//! * u = U/W ≤ 1 is off by the sum of both over |W|, with K = R·e(512εm + 8η) by less than K/|W|; and so is v, and t
//!   relative to itself, as a·N is off by 54εme² + 6ηe², and a·N = λW for the λ ≤ √3m at which D reaches the triangle,
//!   since its longest coordinate is at least 1/√3.
//! * So |W| ≥ |a·N|/(√3m) wherever the triangle is hit. [`Interpolants::new`] requires that K over this is at most 2⁻²⁵, a
//!   quarter of single precision's unit in the last place of a weight near 1.
//! * Parallel rays have |D| = 1, the same W everywhere, and origins up to R from the eye: K = e(512ε(m + R) + 8η). η has
//!   the rounding of those origins in it, two units of the eye's coordinates and R. t's numerator is off by less than
//!   Ke, so t by 2⁻²⁵e beside.
//!
//! U, V, W and t's numerator are then rounded to single precision. With one division and one product u, v and t are off
//! by at most four units in the last place, of 1 for u and v.

use super::vectors::{Row, Vectors};
use crate::camera::{Camera, Projection};
use crate::num::roundoff::EPSILON;
use crate::num::simd::{F32x8, LANES, Lanes};
use crate::ray::relative_origin;
use glam::{DVec3, Vec3};

/// The largest error of weights, and relative error of t, before rounding to single precision.
const LARGEST_ERROR: f64 = 1.0 / (1u64 << 25) as f64;

/// Lengths for which no product overflows, and none underflows by as much as the bounds.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-60..=1e60;

/// The least cosine between normals at a triangle's corners for which interpolated normals need no test for zero: where
/// all cosines are at least −0.4, the square of an interpolated normal is at least that of the mean of three, 1/15.
const LEAST_COSINE: f32 = -0.4;

/// The rays of a planar picture from one eye, as linear functions of the place.
#[derive(Debug)]
pub(super) struct PlanarRays {
    /// A direction, or a parallel ray's origin relative to the eye: at the picture's top left corner, and its changes a
    /// pixel along x and y.
    corner: DVec3,
    right: DVec3,
    down: DVec3,
    /// The direction of parallel rays.
    parallel: Option<DVec3>,
    /// R.
    reach: f64,
    /// The eye relative to the tree's origin, and η.
    eye: DVec3,
    eye_error: f64,
}

impl PlanarRays {
    /// Those of a camera with a tree's origin; `None` for panoramas and pictures for two eyes.
    pub(super) fn new(camera: &Camera, frame: DVec3) -> Option<Self> {
        if camera.projection().panorama().is_some() || camera.stereo().is_some() {
            return None;
        }
        let is_parallel = camera.projection() == Projection::Orthographic;
        let plane = camera.plane();
        let (unit, ahead) = match is_parallel {
            true => (1.0, 0.0),
            false => (1.0 / camera.distance(), 1.0),
        };
        let (across, along) = camera.across_and_along(0.0, 0.0);
        let (across, along, step) = (across * unit, along * unit, plane.step * unit);
        let (right, down) = (camera.right() * step, camera.up() * -step);
        let [width, height] = [plane.columns, plane.rows].map(f64::from);
        let reach = across.abs() + along.abs() + ahead + (width + height) * step;
        let in_world = camera.pose().eye;
        let (eye, mut eye_error) = relative_origin(in_world, frame);
        if is_parallel {
            eye_error += 2.0 * EPSILON * (in_world.abs().max_element() + reach);
        }
        Some(Self {
            corner: camera.right() * across + camera.up() * along + camera.forward() * ahead,
            right,
            down,
            parallel: is_parallel.then(|| camera.forward()),
            reach,
            eye,
            eye_error,
        })
    }

    #[cfg(test)]
    pub(super) fn set_eye_error(&mut self, error: f64) {
        self.eye_error = error;
    }

    /// The linear function `constant` + `vector`·(what is linear in the place).
    #[inline(always)]
    fn linear(&self, constant: f64, vector: DVec3) -> Linear {
        Linear([
            constant + vector.dot(self.corner),
            vector.dot(self.right),
            vector.dot(self.down),
        ])
    }

    /// t at eight places of a row, from its numerator without |D|, and W.
    #[inline(always)]
    pub(super) fn eight_distances_of<L: Lanes>(
        &self,
        lanes: L,
        (xs, y): (&[f64; LANES], f64),
        [t, w]: [L::F32; 2],
    ) -> L::F32 {
        let inverse = lanes.splat(1.0) / w;
        let [constant, linear, quadratic] = self.squared_lengths(y);
        let mut squares: Row = [0.0; LANES];
        for (square, x) in squares.iter_mut().zip(xs) {
            *square = (constant + (linear + quadratic * x) * x) as f32;
        }
        t * inverse * lanes.load(&squares).sqrt()
    }

    /// |D|², in terms of x, of the rays in a row.
    #[inline(always)]
    fn squared_lengths(&self, y: f64) -> [f64; 3] {
        if self.parallel.is_some() {
            return [1.0, 0.0, 0.0];
        }
        let first = self.corner + self.down * y;
        [
            first.dot(first),
            2.0 * first.dot(self.right),
            self.right.dot(self.right),
        ]
    }
}

/// u and v from U, V and W.
#[inline(always)]
pub(super) fn eight_weights_of<L: Lanes>(lanes: L, [u, v, w]: [L::F32; 3]) -> [L::F32; 2] {
    let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
    let inverse = one / w;
    let u = (u * inverse).max(zero).min(one);
    let v = (v * inverse).max(zero).min(one - u);
    [u, v]
}

/// A function that is linear over the image plane: its value at the picture's top left corner, and its changes a pixel
/// along x and y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Linear([f64; 3]);

impl Linear {
    #[inline(always)]
    fn at(self, x: f64, y: f64) -> f32 {
        let [corner, right, down] = self.0;
        ((corner + down * y) + right * x) as f32
    }

    /// Along a row of places.
    #[inline(always)]
    fn in_row(&self, y: f64) -> AlongRow {
        let [corner, right, down] = self.0;
        AlongRow {
            first: corner + down * y,
            right,
        }
    }

    /// At eight places of a row.
    #[inline(always)]
    fn eight<L: Lanes>(&self, lanes: L, xs: &[f64; LANES], y: f64) -> L::F32 {
        self.in_row(y).eight(lanes, xs)
    }

    /// Values at the corners, interpolated: numerators over W.
    #[inline(always)]
    fn between([u, v, w]: [Self; 3], [a, b, c]: [f32; 3]) -> Self {
        let [a, b, c] = [a, b, c].map(f64::from);
        Self(std::array::from_fn(|i| {
            w.0[i] * a + u.0[i] * (b - a) + v.0[i] * (c - a)
        }))
    }
}

/// A linear function along a row of places.
#[derive(Clone, Copy)]
pub(super) struct AlongRow {
    first: f64,
    right: f64,
}

impl AlongRow {
    /// At eight places.
    #[inline(always)]
    pub(super) fn eight<L: Lanes>(&self, lanes: L, xs: &[f64; LANES]) -> L::F32 {
        let mut all = [0.0; LANES];
        for (all, x) in all.iter_mut().zip(xs) {
            *all = (self.first + self.right * x) as f32;
        }
        lanes.load(&all)
    }
}

/// Three functions at eight places.
#[inline(always)]
pub(super) fn eight_along<L: Lanes>(
    lanes: L,
    [x, y, z]: &[AlongRow; 3],
    xs: &[f64; LANES],
) -> Vectors<L> {
    let xyz = [x.eight(lanes, xs), y.eight(lanes, xs), z.eight(lanes, xs)];
    Vectors::new(lanes, xyz)
}

/// A triangle's interpolants: t, u and v of the places that show it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interpolants {
    u: Linear,
    v: Linear,
    w: Linear,
    t: Linear,
}

/// t, u and v of a hit.
#[derive(Clone, Copy)]
pub(super) struct HitParameters {
    pub(super) t: f32,
    pub(super) u: f32,
    pub(super) v: f32,
}

impl Interpolants {
    /// Of a triangle with these corners, relative to the tree's origin; `None` where rounding may move a weight by more
    /// than 2⁻²⁵.
    pub(super) fn new(rays: &PlanarRays, corners: [Vec3; 3]) -> Option<Self> {
        Self::within(LARGEST_ERROR, rays, corners)
    }

    /// [`Interpolants::new`] whatever the error.
    #[cfg(test)]
    pub(super) fn unchecked(rays: &PlanarRays, corners: [Vec3; 3]) -> Option<Self> {
        Self::within(f64::INFINITY, rays, corners)
    }

    fn within(largest_error: f64, rays: &PlanarRays, corners: [Vec3; 3]) -> Option<Self> {
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let (ab, ac, bc) = (b - a, c - a, c - b);
        let normal = ab.cross(ac);
        let [a, b, c] = [a, b, c].map(|corner| corner - rays.eye);
        let volume = a.dot(normal);
        let m = a.abs().max(b.abs()).max(c.abs()).max_element();
        let e = ab.abs().max(ac.abs()).max(bc.abs()).max_element();
        let (reach, eta) = (rays.reach, rays.eye_error);
        if !(LENGTHS.contains(&e) && LENGTHS.contains(&m) && LENGTHS.contains(&reach)) {
            return None;
        }
        let error = |reach: f64, m: f64| reach * e * (512.0 * EPSILON * m + 8.0 * eta);
        let scaled = |linear: Linear, scale: f64| Linear(linear.0.map(|number| number * scale));
        match rays.parallel {
            None => {
                // W is positive where the triangle is hit, m/(λR): at least 1/(√3·R), and no more than 2²², since what is
                // accurate has λ ≥ 2⁻²¹m/√3.
                let scale = m / (reach * volume);
                let error = error(reach, m) * (m * 3f64.sqrt());
                let is_accurate = error <= largest_error * volume.abs();
                is_accurate.then(|| Self {
                    u: scaled(rays.linear(0.0, ac.cross(a)), scale),
                    v: scaled(rays.linear(0.0, a.cross(ab)), scale),
                    w: scaled(rays.linear(0.0, normal), scale),
                    t: Linear([volume * scale, 0.0, 0.0]),
                })
            }
            Some(forward) => {
                let w = forward.dot(normal);
                let is_accurate = error(1.0, m + reach) <= largest_error * w.abs();
                is_accurate.then(|| {
                    let [u, v] = [forward.dot(ac.cross(a)), forward.dot(a.cross(ab))];
                    Self {
                        u: scaled(rays.linear(u, ac.cross(forward)), 1.0 / w),
                        v: scaled(rays.linear(v, forward.cross(ab)), 1.0 / w),
                        w: Linear([1.0, 0.0, 0.0]),
                        t: scaled(rays.linear(volume, -normal), 1.0 / w),
                    }
                })
            }
        }
    }

    /// t, u and v at a place that shows the triangle.
    pub(super) fn at(&self, rays: &PlanarRays, x: f64, y: f64) -> HitParameters {
        let inverse = 1.0 / self.w.at(x, y);
        let u = (self.u.at(x, y) * inverse).clamp(0.0, 1.0);
        let v = (self.v.at(x, y) * inverse).max(0.0).min(1.0 - u);
        let [constant, linear, quadratic] = rays.squared_lengths(y);
        let length = (constant + (linear + quadratic * x) * x) as f32;
        let t = self.t.at(x, y) * inverse * length.sqrt();
        HitParameters { t, u, v }
    }

    /// U, V and W at eight places of a row.
    #[inline(always)]
    pub(super) fn eight_weights<L: Lanes>(
        &self,
        lanes: L,
        xs: &[f64; LANES],
        y: f64,
    ) -> [L::F32; 3] {
        [
            self.u.eight(lanes, xs, y),
            self.v.eight(lanes, xs, y),
            self.w.eight(lanes, xs, y),
        ]
    }

    /// t's numerator, without |D|, and W at eight places of a row.
    #[inline(always)]
    pub(super) fn eight_distances<L: Lanes>(
        &self,
        lanes: L,
        xs: &[f64; LANES],
        y: f64,
    ) -> [L::F32; 2] {
        [self.t.eight(lanes, xs, y), self.w.eight(lanes, xs, y)]
    }

    /// U, V and W along a row.
    #[inline(always)]
    pub(super) fn weights_in_row(&self, y: f64) -> [AlongRow; 3] {
        [self.u.in_row(y), self.v.in_row(y), self.w.in_row(y)]
    }

    /// t's numerator, without |D|, and W along a row.
    #[inline(always)]
    pub(super) fn distances_in_row(&self, y: f64) -> [AlongRow; 2] {
        [self.t.in_row(y), self.w.in_row(y)]
    }

    /// The normals at the corners, of unit length, interpolated on the side of `flat`; `None` where they may cancel.
    pub(super) fn normals(&self, normals: [Vec3; 3], flat: Vec3) -> Option<LinearNormal> {
        let [a, b, c] = normals;
        let cosines = [a.dot(b), b.dot(c), c.dot(a)];
        let have_length = normals.iter().all(|normal| *normal != Vec3::ZERO);
        if !have_length || !cosines.iter().all(|cosine| *cosine >= LEAST_COSINE) {
            return None;
        }
        let away = normals.map(|normal| normal.dot(flat) < 0.0);
        let side = if away == [true; 3] { -1.0 } else { 1.0 };
        let [a, b, c] = normals.map(|normal| (normal * side).to_array());
        let weights = [self.u, self.v, self.w];
        Some(LinearNormal {
            xyz: std::array::from_fn(|i| Linear::between(weights, [a[i], b[i], c[i]])),
            turns: away.contains(&true) && away.contains(&false),
        })
    }
}

/// A triangle's interpolated normal over the image plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinearNormal {
    /// Not of unit length.
    xyz: [Linear; 3],
    /// Whether it may be on either side of the triangle; else it is on the side of the triangle's own normal.
    turns: bool,
}

impl LinearNormal {
    /// The same unit normal everywhere.
    pub(super) fn constant(normal: Vec3) -> Self {
        Self {
            xyz: normal.to_array().map(|n| Linear([n.into(), 0.0, 0.0])),
            turns: false,
        }
    }

    /// The unit normal at a place, on the side of `flat`.
    pub(super) fn at(&self, x: f64, y: f64, flat: Vec3) -> Vec3 {
        let normal = Vec3::from(self.xyz.map(|linear| linear.at(x, y)));
        let inverse = 1.0 / normal.length();
        let is_away = self.turns && normal.dot(flat) < 0.0;
        normal * if is_away { -inverse } else { inverse }
    }

    /// Whether [`LinearNormal::eight`] may be on either side of the triangle.
    #[inline(always)]
    pub(super) fn turns(&self) -> bool {
        self.turns
    }

    /// Along a row, not of unit length.
    #[inline(always)]
    pub(super) fn in_row(&self, y: f64) -> [AlongRow; 3] {
        let [nx, ny, nz] = &self.xyz;
        [nx.in_row(y), ny.in_row(y), nz.in_row(y)]
    }

    /// At eight places of a row, not of unit length.
    #[inline(always)]
    pub(super) fn eight<L: Lanes>(&self, lanes: L, xs: &[f64; LANES], y: f64) -> Vectors<L> {
        let [nx, ny, nz] = &self.xyz;
        let xyz = [
            nx.eight(lanes, xs, y),
            ny.eight(lanes, xs, y),
            nz.eight(lanes, xs, y),
        ];
        Vectors::new(lanes, xyz)
    }
}
