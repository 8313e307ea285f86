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

/// A sample of a triangle: its place, the triangle's corners relative to the tree's origin, the normals there, and its own
/// unit normal on the side of the eye.
#[derive(Clone, Copy)]
pub(super) struct SmoothSample {
    pub(super) place: (f64, f64),
    pub(super) corners: [Vec3; 3],
    pub(super) normals: [Vec3; 3],
    pub(super) flat: Vec3,
}

impl PlanarRays {
    /// The direction of parallel rays.
    pub(super) fn parallel(&self) -> Option<DVec3> {
        self.parallel
    }

    /// The normal of a sample, not of unit length, and whether it is what the triangle's [`LinearNormal`] has there: else
    /// there is none. Without a branch, so that loops over it are vectorised. `parallel` as
    /// [`PlanarRays::parallel`] says, known before such a loop.
    #[inline(always)]
    pub(super) fn normal_of(&self, parallel: Option<DVec3>, sample: &SmoothSample) -> (Vec3, bool) {
        let SmoothSample {
            place: (x, y),
            corners,
            normals,
            flat,
        } = *sample;
        let (interpolants, is_accurate) = match parallel {
            None => Interpolants::from_one_eye(self, corners, LARGEST_ERROR),
            Some(forward) => Interpolants::along(forward, self, corners, LARGEST_ERROR),
        };
        let (linear, has_length) = interpolants.normal_between(normals, flat);
        let normal = linear.unturned_at(x, y);
        let is_away = linear.turns & (normal.dot(flat) < 0.0);
        let side = if is_away { -1.0 } else { 1.0 };
        (normal * side, is_accurate & has_length)
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
    fn at(&self, x: f64, y: f64) -> f32 {
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
    fn between([u, v, w]: &[Self; 3], (a, b, c): (f32, f32, f32)) -> Self {
        let (a, b, c) = (f64::from(a), f64::from(b), f64::from(c));
        w.times(a).plus(u.times(b - a)).plus(v.times(c - a))
    }

    #[inline(always)]
    fn times(self, factor: f64) -> Self {
        let [corner, right, down] = self.0;
        Self([corner * factor, right * factor, down * factor])
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a + x, b + y, c + z])
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

/// A triangle as its interpolants see it.
struct Triangle {
    /// The first corner, relative to the eye, and the edges from it.
    a: DVec3,
    ab: DVec3,
    ac: DVec3,
    /// N, and a·N.
    normal: DVec3,
    volume: f64,
    /// m and e.
    m: f64,
    e: f64,
    /// Whether these and the rays are within [`LENGTHS`].
    is_in_range: bool,
}

impl Triangle {
    #[inline(always)]
    fn new(rays: &PlanarRays, [a, b, c]: [Vec3; 3]) -> Self {
        let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
        let (ab, ac, bc) = (b - a, c - a, c - b);
        let normal = ab.cross(ac);
        let (a, b, c) = (a - rays.eye, b - rays.eye, c - rays.eye);
        let m = a.abs().max(b.abs()).max(c.abs()).max_element();
        let e = ab.abs().max(ac.abs()).max(bc.abs()).max_element();
        Self {
            a,
            ab,
            ac,
            normal,
            volume: a.dot(normal),
            m,
            e,
            is_in_range: is_usual(e) & is_usual(m) & is_usual(rays.reach),
        }
    }

    /// K, with these for R and m.
    #[inline(always)]
    fn error(&self, rays: &PlanarRays, reach: f64, m: f64) -> f64 {
        reach * self.e * (512.0 * EPSILON * m + 8.0 * rays.eye_error)
    }
}

/// Whether a length is within [`LENGTHS`].
#[inline(always)]
fn is_usual(length: f64) -> bool {
    (*LENGTHS.start() <= length) & (length <= *LENGTHS.end())
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
        let (interpolants, is_accurate) = match rays.parallel {
            None => Self::from_one_eye(rays, corners, largest_error),
            Some(forward) => Self::along(forward, rays, corners, largest_error),
        };
        is_accurate.then_some(interpolants)
    }

    /// Those of rays from one eye, and whether they are accurate. Without a branch, so that loops over it are vectorised;
    /// so is all that it calls.
    #[inline(always)]
    fn from_one_eye(rays: &PlanarRays, corners: [Vec3; 3], largest_error: f64) -> (Self, bool) {
        let triangle = Triangle::new(rays, corners);
        let Triangle { a, ab, ac, m, .. } = triangle;
        let volume = triangle.volume;
        // W is positive where the triangle is hit, m/(λR): at least 1/(√3·R), and no more than 2²², since what is
        // accurate has λ ≥ 2⁻²¹m/√3.
        let scale = m / (rays.reach * volume);
        let error = triangle.error(rays, rays.reach, m) * (m * 3f64.sqrt());
        let interpolants = Self {
            u: rays.linear(0.0, ac.cross(a)).times(scale),
            v: rays.linear(0.0, a.cross(ab)).times(scale),
            w: rays.linear(0.0, triangle.normal).times(scale),
            t: Linear([volume * scale, 0.0, 0.0]),
        };
        let is_accurate = error <= largest_error * volume.abs();
        (interpolants, is_accurate & triangle.is_in_range)
    }

    /// Those of parallel rays, and whether they are accurate, without a branch likewise.
    #[inline(always)]
    fn along(
        forward: DVec3,
        rays: &PlanarRays,
        corners: [Vec3; 3],
        largest_error: f64,
    ) -> (Self, bool) {
        let triangle = Triangle::new(rays, corners);
        let Triangle { a, ab, ac, m, .. } = triangle;
        let normal = triangle.normal;
        let w = forward.dot(normal);
        let scale = 1.0 / w;
        let (u, v) = (forward.dot(ac.cross(a)), forward.dot(a.cross(ab)));
        let interpolants = Self {
            u: rays.linear(u, ac.cross(forward)).times(scale),
            v: rays.linear(v, forward.cross(ab)).times(scale),
            w: Linear([1.0, 0.0, 0.0]),
            t: rays.linear(triangle.volume, -normal).times(scale),
        };
        let is_accurate = triangle.error(rays, 1.0, m + rays.reach) <= largest_error * w.abs();
        (interpolants, is_accurate & triangle.is_in_range)
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
        let (normal, has_length) = self.normal_between(normals, flat);
        has_length.then_some(normal)
    }

    /// [`Interpolants::normals`], and whether they cannot cancel, without a branch.
    #[inline(always)]
    fn normal_between(&self, [a, b, c]: [Vec3; 3], flat: Vec3) -> (LinearNormal, bool) {
        let have_length = (a != Vec3::ZERO) & (b != Vec3::ZERO) & (c != Vec3::ZERO);
        let are_close =
            (a.dot(b) >= LEAST_COSINE) & (b.dot(c) >= LEAST_COSINE) & (c.dot(a) >= LEAST_COSINE);
        let (a_away, b_away, c_away) = (a.dot(flat) < 0.0, b.dot(flat) < 0.0, c.dot(flat) < 0.0);
        let (all, any) = (a_away & b_away & c_away, a_away | b_away | c_away);
        let side = if all { -1.0 } else { 1.0 };
        let (a, b, c) = (a * side, b * side, c * side);
        let weights = [self.u, self.v, self.w];
        let normal = LinearNormal {
            xyz: [
                Linear::between(&weights, (a.x, b.x, c.x)),
                Linear::between(&weights, (a.y, b.y, c.y)),
                Linear::between(&weights, (a.z, b.z, c.z)),
            ],
            turns: any & !all,
        };
        (normal, have_length & are_close)
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

    /// The normal at a place, not of unit length nor turned to a side.
    #[inline(always)]
    fn unturned_at(&self, x: f64, y: f64) -> Vec3 {
        let [nx, ny, nz] = &self.xyz;
        Vec3::new(nx.at(x, y), ny.at(x, y), nz.at(x, y))
    }

    /// The unit normal at a place, on the side of `flat`.
    pub(super) fn at(&self, x: f64, y: f64, flat: Vec3) -> Vec3 {
        let normal = self.unturned_at(x, y);
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
