//! What clipping planes keep of triangles and of hits, by exact signs.
//!
//! Planes are given in world coordinates, corners relative to a tree's origin O: a corner V is kept where
//! n·(V + O) − c ≥ 0. In double precision that is n·V + k, with k = n·O − c worked out once; a sign within its bound
//! is decided by exact arithmetic on n, c, O and V as they are, so that moving the origin rounds nothing away.
//!
//! # Error bounds
//! ε = 2⁻⁵³ (notation: `docs/error-bounds.md`).
//!
//! * **k** has three products and three sums, so no term is rounded more than four times: it is off by less than
//!   4.1ε(Σ|nᵢOᵢ| + |c|), higher orders included.
//! * **Corners.** n·V + k likewise: 4.1ε(Σ|nᵢVᵢ| + |k|), and what k is off by. A normal that is an axis, of length
//!   one, needs no products: where k is not rounded the sum of two numbers has the sign that it must, and no bound.
//! * **Corners next to a plane.** In double-double arithmetic V + O is exact, a product with nᵢ is off by 5ε² of itself and
//!   a sum by 3.1ε²: 14.4ε²(Σ|nᵢ|(|Vᵢ| + |Oᵢ|) + |c|).
//! * **Hits.** At t ± τ along a ray o + t·d it is (n·o − c) + t·(n·d). A term is rounded at most six times in all:
//!   6.1ε(Σ|nᵢoᵢ| + |c| + (|t| + τ)·Σ|nᵢdᵢ|), and τ·Σ|nᵢdᵢ| for τ itself.
//! * **Hits next to the eye**, at a small part of its coordinates. In double-double arithmetic products are exact, and
//!   the three sums of f = n·o − c are off by less than 3.1ε² of partial sums, which are at most Σ|nᵢoᵢ| + |c| and a
//!   little: 9.4ε²(Σ|nᵢoᵢ| + |c|). Its higher part and the sum with t·(n·d) are rounded once each: ε|f| each, and
//!   6.1ε(|t| + τ)·Σ|nᵢdᵢ| as above.
//!
//! * **Ranges of rays.** n·o − c as above, and n·d, whose products and sums are off by 3.1ε·Σ|nᵢdᵢ|. Where its sign is
//!   sure, the parameter at which a ray meets the plane is bounded by their quotient with both errors on the safe side.
//!   Four roundings, 4.1ε of the quotient, are counted as the slope's: 7.2ε·Σ|nᵢdᵢ|.
//!
//! Products below the range of normal numbers lose 2⁻¹⁰⁷⁵ each, those with t that times |t| + τ; [`TINY`] times
//! 1 + |t| + τ is more than all of these. What leaves the range at the other end is infinite or NaN, and so is its
//! bound: comparisons fail, and exact arithmetic decides.

use super::BoundedHit;
use crate::num::double_double::DoubleDouble;
use crate::num::exact::{
    Scale, Vector, compare_scaled, comparison_digits, cross, decompose, dot, sized, subtract,
};
use crate::num::integer::Integer;
use crate::num::roundoff::{EPSILON, U32};
use crate::ray::Ray;
use crate::scene::{ClippingPlane, ClippingPlanes};
use glam::{DVec3, Vec3};
use num_bigint::BigInt;
use std::cmp::Ordering;

/// The least normal number, which is more than what underflow loses (above).
const TINY: f64 = f64::MIN_POSITIVE;

/// The clipping planes, prepared for triangles whose corners are relative to `origin`.
#[derive(Clone, Debug)]
pub(crate) struct Clip {
    planes: Vec<PreparedPlane>,
    origin: DVec3,
}

/// How much of a triangle the planes keep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kept {
    All,
    Some,
    Nothing,
}

/// A plane's function n·p − c at a triangle's corners, divided by its greatest magnitude there, and a bound on the
/// error. The plane keeps the points where the mean of the three, weighted by the barycentrics, is not negative.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AtCorners {
    /// The plane's index.
    pub(crate) plane: usize,
    pub(crate) values: [f32; 3],
    pub(crate) error: f32,
}

/// A plane's function n·p − c at an eye, and a bound on its error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AtEye {
    pub(crate) normal: DVec3,
    pub(crate) value: f64,
    pub(crate) error: f64,
}

#[derive(Clone, Copy, Debug)]
struct PreparedPlane {
    normal: DVec3,
    /// c.
    offset: f64,
    /// k, and the bound on its error.
    constant: f64,
    constant_error: f64,
    /// The relative error of n·V + k, and the absolute one.
    relative: f64,
    absolute: f64,
}

/// A plane's function at a corner: rounded, a bound on its error, and its exact sign.
#[derive(Clone, Copy)]
struct AtCorner {
    value: f64,
    error: f64,
    sign: Ordering,
}

impl AtCorners {
    /// From the function's values at the corners, each with a bound on its error.
    fn of(plane: usize, at: [(f64, f64); 3]) -> Self {
        let greatest = (at.iter()).fold(TINY, |most, (value, _)| value.abs().max(most));
        let error = at.iter().fold(0.0, |most: f64, (_, error)| error.max(most));
        Self {
            plane,
            values: at.map(|(value, _)| (value / greatest) as f32),
            // The quotient is rounded as well.
            error: (error / greatest * 1.001 + 2.0 * EPSILON) as f32,
        }
    }
}

impl Clip {
    /// No clipping planes.
    pub(crate) const NONE: Self = Self {
        planes: Vec::new(),
        origin: DVec3::ZERO,
    };

    /// The enabled planes, for corners relative to `origin`.
    pub(crate) fn new(planes: &ClippingPlanes, origin: DVec3) -> Self {
        Self {
            planes: planes
                .enabled()
                .map(|plane| PreparedPlane::new(plane, origin))
                .collect(),
            origin,
        }
    }

    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.planes.is_empty()
    }

    /// How much of a triangle is kept. Where several planes together remove all of it, and none does alone, the
    /// answer is [`Kept::Some`].
    pub(crate) fn of(&self, corners: [Vec3; 3]) -> Kept {
        let mut kept = Kept::All;
        for plane in &self.planes {
            let signs = corners.map(|corner| self.at(plane, corner).sign);
            if !signs.contains(&Ordering::Less) {
                continue;
            }
            if signs == [Ordering::Less; 3] {
                return Kept::Nothing;
            }
            kept = Kept::Some;
        }
        kept
    }

    /// The exact signs of the first plane's function at the corners; all positive where there is no plane.
    pub(crate) fn signs(&self, corners: [Vec3; 3]) -> [Ordering; 3] {
        corners.map(|corner| match self.planes.first() {
            Some(plane) => self.at(plane, corner).sign,
            None => Ordering::Greater,
        })
    }

    /// The functions of the planes that cut a triangle. Where the plane is next to all corners, so that the bounds in
    /// double precision are more than rounding to single precision, in double-double arithmetic.
    pub(crate) fn through(&self, corners: [Vec3; 3]) -> impl Iterator<Item = AtCorners> {
        self.planes
            .iter()
            .enumerate()
            .filter_map(move |(number, plane)| {
                let at = corners.map(|corner| self.at(plane, corner));
                if !at.iter().any(|at| at.sign == Ordering::Less) {
                    return None;
                }
                let found = AtCorners::of(number, at.map(|at| (at.value, at.error)));
                if found.error <= U32 {
                    return Some(found);
                }
                let closely = |corner: Vec3| plane.at_sum_closely(corner.as_dvec3(), self.origin);
                Some(AtCorners::of(number, corners.map(closely)))
            })
    }

    /// The planes' functions at an eye in world space: zero, without an error, where it lies on a plane.
    pub(crate) fn at_eye(&self, eye: DVec3) -> impl Iterator<Item = AtEye> {
        self.planes.iter().map(move |plane| {
            let is_on = plane.sign_at_sum(eye, DVec3::ZERO) == Ordering::Equal;
            let (value, error) = match is_on {
                true => (0.0, 0.0),
                false => plane.at_point(eye),
            };
            AtEye {
                normal: plane.normal,
                value,
                error,
            }
        })
    }

    /// Whether the planes surely remove all points of a box: whether a plane removes the box's corner that is
    /// furthest along its normal.
    #[inline]
    pub(crate) fn removes(&self, min: [f32; 3], max: [f32; 3]) -> bool {
        self.planes.iter().any(|plane| {
            let normal = plane.normal.to_array();
            let furthest = std::array::from_fn(|axis| {
                if normal[axis] > 0.0 {
                    max[axis]
                } else {
                    min[axis]
                }
            });
            let (value, error) = plane.at(Vec3::from_array(furthest));
            value < -error
        })
    }

    /// A range of a ray's parameter, within its own, that holds all points that the planes keep. Its end may lie before
    /// its beginning: then they keep none.
    pub(crate) fn range_along(&self, ray: &Ray) -> [f64; 2] {
        let (mut begin, mut end) = (ray.t_min, ray.t_max);
        for plane in &self.planes {
            let [after, before] = plane.bounds_along(ray);
            begin = begin.max(after);
            end = end.min(before);
        }
        [begin, end]
    }

    /// Whether the planes keep the point where a ray hits a triangle.
    pub(crate) fn keeps(&self, ray: &Ray, corners: [Vec3; 3], hit: &BoundedHit) -> bool {
        self.planes.iter().all(|plane| {
            plane.sign_along(ray, hit).unwrap_or_else(|| {
                let signs = corners.map(|corner| self.at(plane, corner).sign);
                if !signs.contains(&Ordering::Less) {
                    Ordering::Greater
                } else if signs == [Ordering::Less; 3] {
                    Ordering::Less
                } else {
                    self.exact_sign_at_hit(plane, ray, corners)
                }
            }) != Ordering::Less
        })
    }

    fn at(&self, plane: &PreparedPlane, corner: Vec3) -> AtCorner {
        let (value, error) = plane.at(corner);
        let sign = if value > error {
            Ordering::Greater
        } else if value < -error {
            Ordering::Less
        } else if error == 0.0 {
            Ordering::Equal
        } else {
            self.exact_sign(plane, corner)
        };
        AtCorner { value, error, sign }
    }

    /// The exact sign of n·(V + O) − c.
    #[inline(never)]
    fn exact_sign(&self, plane: &PreparedPlane, corner: Vec3) -> Ordering {
        plane.sign_at_sum(corner.as_dvec3(), self.origin)
    }

    /// The exact sign of n·p − c at the point p where a ray hits a triangle.
    #[inline(never)]
    fn exact_sign_at_hit(&self, plane: &PreparedPlane, ray: &Ray, corners: [Vec3; 3]) -> Ordering {
        let query = self.at_hit(plane, ray, corners);
        let AtHit {
            lengths,
            directions,
            normals,
            ..
        } = query;
        // The sign's longest number is a weight times n·p, below 2^(2L + D + 9) and 2^(N + L + 4): shorter than what
        // a comparison of hits needs if N is no longer than 2L.
        if normals.bits <= 2 * lengths.bits {
            sized!(comparison_digits(lengths, directions), sign_at_hit(&query))
        } else {
            sign_at_hit::<BigInt>(&query)
        }
    }

    fn at_hit<'a>(&self, plane: &'a PreparedPlane, ray: &'a Ray, corners: [Vec3; 3]) -> AtHit<'a> {
        let corners = corners.map(Vec3::as_dvec3);
        AtHit {
            plane,
            ray,
            corners,
            origin: self.origin,
            lengths: Scale::of_vectors(corners.iter().chain([&self.origin, &ray.origin])),
            directions: Scale::of_vectors([&ray.direction]),
            normals: Scale::of_vectors([&plane.normal]),
        }
    }
}

/// A plane, and a ray that hits a triangle with `corners` relative to `origin`; with the scales of their numbers.
struct AtHit<'a> {
    plane: &'a PreparedPlane,
    ray: &'a Ray,
    corners: [DVec3; 3],
    origin: DVec3,
    lengths: Scale,
    directions: Scale,
    normals: Scale,
}

/// The sign of n·p − c where p is the mean of the corners weighted by d·(B×C), d·(C×A) and d·(A×B), with corners
/// relative to the ray's origin. If the weights sum to zero there is no hit.
fn sign_at_hit<I: Integer>(query: &AtHit<'_>) -> Ordering {
    let AtHit {
        lengths,
        directions,
        normals,
        ..
    } = *query;
    let origin = lengths.vector::<I>(query.origin);
    let points = query
        .corners
        .map(|corner| add(&lengths.vector(corner), &origin));
    let eye = lengths.vector::<I>(query.ray.origin);
    let [a, b, c] = [0, 1, 2].map(|i| subtract(&points[i], &eye));
    let direction = directions.vector::<I>(query.ray.direction);
    let weights = [(&b, &c), (&c, &a), (&a, &b)].map(|(p, q)| dot(&direction, &cross(p, q)));
    let sum = weights[0].plus(&weights[1]).plus(&weights[2]);
    let normal = normals.vector::<I>(query.plane.normal);
    let [x, y, z] = [0, 1, 2].map(|i| weights[i].times(&dot(&normal, &points[i])));
    let (mantissa, exponent) = decompose(query.plane.offset);
    let order = compare_scaled(
        &x.plus(&y).plus(&z),
        normals.exponent + lengths.exponent,
        &sum.times(&I::shifted(mantissa, 0)),
        exponent,
    );
    match sum.sign() {
        Ordering::Greater => order,
        Ordering::Less => order.reverse(),
        Ordering::Equal => Ordering::Less,
    }
}

impl PreparedPlane {
    fn new(plane: &ClippingPlane, origin: DVec3) -> Self {
        let ClippingPlane { normal, offset, .. } = *plane;
        let constant = normal.dot(origin) - offset;
        let is_axis = [DVec3::X, DVec3::Y, DVec3::Z].contains(&normal.abs());
        // The difference a − b is exact where adding b restores a and subtracting it from a restores b.
        let along = normal.dot(origin);
        let is_exact = constant + offset == along && along - constant == offset;
        let (constant_error, relative, absolute) = match is_axis {
            true if is_exact => (0.0, 0.0, 0.0),
            _ => {
                let size = (normal * origin).abs().element_sum() + offset.abs();
                (4.1 * EPSILON * size, 4.1 * EPSILON, TINY)
            }
        };
        Self {
            normal,
            offset,
            constant,
            constant_error,
            relative,
            absolute,
        }
    }

    /// n·V + k, and a bound on its error.
    #[inline(always)]
    fn at(&self, corner: Vec3) -> (f64, f64) {
        let terms = self.normal * corner.as_dvec3();
        let value = terms.x + terms.y + terms.z + self.constant;
        let size = terms.x.abs() + terms.y.abs() + terms.z.abs() + self.constant.abs();
        let error = size * self.relative + self.constant_error * 1.001 + self.absolute;
        (value, error)
    }

    /// Lower and upper bounds of the parameters at which the plane keeps a ray's points; infinite where there are none,
    /// or none is sure.
    fn bounds_along(&self, ray: &Ray) -> [f64; 2] {
        let (value, error) = self.at_point(ray.origin);
        let most = value + error;
        let along = self.normal * ray.direction;
        let slope = along.element_sum();
        let off = 7.2 * EPSILON * along.abs().element_sum() + TINY;
        let steep = match most < 0.0 {
            true => slope.abs() + off,
            false => slope.abs() - off,
        };
        let mut bounds = [f64::NEG_INFINITY, f64::INFINITY];
        if slope > off && most < 0.0 {
            bounds[0] = -most / steep;
        } else if slope < -off {
            bounds[1] = most / steep;
        }
        bounds
    }

    /// The sign of n·p − c at a hit of a ray, where a bound decides it.
    fn sign_along(&self, ray: &Ray, hit: &BoundedHit) -> Option<Ordering> {
        let before = self.normal * ray.origin;
        let along = self.normal * ray.direction;
        let steep = along.abs().element_sum();
        let size = before.abs().element_sum() + self.offset.abs();
        let far = hit.t.abs() + hit.t_error;
        let of_hit = 6.1 * EPSILON * far * steep + 1.001 * hit.t_error * steep + TINY * (1.0 + far);
        let further = hit.t * along.element_sum();

        let at_eye = before.element_sum() - self.offset;
        let sign = sign_of(at_eye + further, 6.1 * EPSILON * size + of_hit);
        sign.or_else(|| {
            let (at_eye, of_eye) = self.at_point(ray.origin);
            sign_of(
                at_eye + further,
                of_eye + 1.1 * EPSILON * at_eye.abs() + of_hit,
            )
        })
    }

    /// n·p − c from double-double arithmetic, and a bound on its error.
    fn at_point(&self, p: DVec3) -> (f64, f64) {
        let size = self.normal.abs().dot(p.abs()) + self.offset.abs();
        let value = self.at_sum(p, DVec3::ZERO);
        let rounding = 1.1 * EPSILON * value.abs();
        (value, 9.5 * EPSILON * EPSILON * size + rounding + TINY)
    }

    /// n·(p + q) − c in double-double arithmetic, rounded.
    #[inline(never)]
    fn at_sum(&self, p: DVec3, q: DVec3) -> f64 {
        let product = |axis: usize| {
            DoubleDouble::from(self.normal[axis]) * DoubleDouble::difference(p[axis], -q[axis])
        };
        (product(0) + product(1) + product(2) - self.offset.into()).high
    }

    /// The exact sign of n·(p + q) − c.
    fn sign_at_sum(&self, p: DVec3, q: DVec3) -> Ordering {
        self.sign_at_sum_closely(p, q).unwrap_or_else(|| {
            let lengths = Scale::of_vectors([&p, &q]);
            let normals = Scale::of_vectors([&self.normal]);
            sized!(
                comparison_digits(lengths, normals),
                integer_sign_at_sum(self, [p, q], (lengths, normals))
            )
        })
    }

    /// n·(p + q) − c from double-double arithmetic, and a bound on its error.
    fn at_sum_closely(&self, p: DVec3, q: DVec3) -> (f64, f64) {
        let (value, error) = (self.at_sum(p, q), self.error_at_sum(p, q));
        (value, error + 1.1 * EPSILON * value.abs())
    }

    /// The bound on the error of double-double arithmetic before it is rounded.
    fn error_at_sum(&self, p: DVec3, q: DVec3) -> f64 {
        let size = self.normal.abs().dot(p.abs() + q.abs()) + self.offset.abs();
        14.5 * EPSILON * EPSILON * size + TINY
    }

    /// That sign, where double-double arithmetic decides it.
    fn sign_at_sum_closely(&self, p: DVec3, q: DVec3) -> Option<Ordering> {
        sign_of(self.at_sum(p, q), self.error_at_sum(p, q))
    }
}

/// The exact sign of n·(p + q) − c.
fn integer_sign_at_sum<I: Integer>(
    plane: &PreparedPlane,
    [p, q]: [DVec3; 2],
    (lengths, normals): (Scale, Scale),
) -> Ordering {
    let point = add(&lengths.vector(p), &lengths.vector(q));
    let (mantissa, exponent) = decompose(plane.offset);
    compare_scaled(
        &dot(&normals.vector::<I>(plane.normal), &point),
        normals.exponent + lengths.exponent,
        &I::shifted(mantissa, 0),
        exponent,
    )
}

/// The sign of a value that is off by at most `error`, where that decides it.
fn sign_of(value: f64, error: f64) -> Option<Ordering> {
    if value > error {
        Some(Ordering::Greater)
    } else if value < -error {
        Some(Ordering::Less)
    } else {
        None
    }
}

fn add<I: Integer>(a: &Vector<I>, b: &Vector<I>) -> Vector<I> {
    std::array::from_fn(|i| a[i].plus(&b[i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hit::Cull;
    use crate::random::Random;
    use crate::triangle::exact::{self, OffsetTriangle};

    fn integers(plane: &PreparedPlane, corner: Vec3, origin: DVec3) -> Ordering {
        let points = [corner.as_dvec3(), origin];
        let scales = (
            Scale::of_vectors(&points),
            Scale::of_vectors([&plane.normal]),
        );
        integer_sign_at_sum::<BigInt>(plane, points, scales)
    }

    /// Planes through corners except for the roundings of double-double arithmetic. The truth is integer arithmetic;
    /// without the bound this fails.
    #[test]
    fn what_double_double_decides_about_corners_is_what_integers_decide() {
        let mut random = Random(73);
        let [mut sure, mut close] = [0; 2];
        for round in 0..30_000 {
            let origin = random.point() * [0.0, 1e3, 1e9][round % 3];
            let corner = random.point().as_vec3();
            let way = corner.as_dvec3() + origin;
            // The sum of the products is some 2⁻⁵³ of them, and the offset all of that but 2⁻⁵³.
            let mut normal = random.point();
            normal -= way * (normal.dot(way) / way.length_squared());
            let product = |axis: usize| {
                DoubleDouble::from(normal[axis])
                    * DoubleDouble::difference(corner[axis].into(), -origin[axis])
            };
            let rest = product(0) + product(1) + product(2);
            let offset = rest.high * (1.0 + 60.0 * random.signed() * EPSILON);
            let plane = ClippingPlane::new(normal, offset).expect("a plane");
            let plane = PreparedPlane::new(&plane, origin);
            let truth = integers(&plane, corner, origin);
            let closely = plane.sign_at_sum_closely(corner.as_dvec3(), origin);
            assert!(
                closely.is_none_or(|sign| sign == truth),
                "{plane:?} {corner}"
            );
            let (value, error) = plane.at_sum_closely(corner.as_dvec3(), origin);
            let sign = sign_of(value, error);
            assert!(sign.is_none_or(|sign| sign == truth), "{plane:?} {corner}");
            sure += usize::from(closely.is_some());
            close += usize::from(closely.is_none());
        }
        assert!(sure > 1000 && close > 1000, "{sure} {close}");
    }

    /// Planes through corners and hits except for rounding, with products that underflow. The truth is integer
    /// arithmetic, and double-double arithmetic on scaled numbers. Without [`TINY`] this fails, for corners and for
    /// hits.
    #[test]
    fn underflow_is_decided_exactly() {
        let mut random = Random(72);
        let [mut close, mut sure] = [0; 2];
        for _ in 0..3000 {
            let mut normal = random.point() * 1e-300;
            normal.x = 1e-150;
            let point = (random.point() * 1e-20).as_vec3().with_x(0.0);
            let least = f64::from_bits(1);
            let offset = normal.dot(point.as_dvec3()) + least * (3.0 * random.signed()).round();
            let plane = ClippingPlane::new(normal, offset).expect("a plane");
            let planes = ClippingPlanes::new(&[plane]).expect("one plane");
            let clip = Clip::new(&planes, DVec3::ZERO);
            let plane = &clip.planes[0];
            let truth = integers(plane, point, DVec3::ZERO);
            assert_eq!(clip.at(plane, point).sign, truth, "{plane:?} {point}");
            close += usize::from(plane.at(point).0.abs() < 10.0 * least);

            let direction = random.point().with_x(0.0) * 1e-20;
            let hit = BoundedHit {
                primitive: 0,
                t: 1.0 + random.unit(),
                ..BoundedHit::NONE
            };
            let ray = Ray::new(point.as_dvec3() - direction * hit.t, direction);
            let Some(sign) = plane.sign_along(&ray, &hit) else {
                continue;
            };
            sure += 1;
            let large = crate::math::pow(2.0, 800.0);
            let product = |axis: usize| {
                let place = DoubleDouble::from(ray.direction[axis]) * hit.t.into();
                DoubleDouble::from(normal[axis] * large) * (place + ray.origin[axis].into())
            };
            let truth = product(1) + product(2) - (offset * large).into();
            assert_eq!(truth.high.total_cmp(&0.0), sign, "{plane:?} {ray:?}");
        }
        assert!(close > 1000, "{close} {sure}");
    }

    /// Planes that cut rays close to where they start, except for roundings, planes nearly parallel to rays, and
    /// products that underflow. The truth is integer arithmetic; without any term of the bounds this fails.
    #[test]
    fn ranges_along_rays_hold_all_kept_points() {
        // No double has a bit below 2⁻¹⁰⁷⁴; mantissas are moved up by 52 more.
        const AT: u64 = 1130;
        let integer = |x: f64| {
            let (mantissa, exponent) = decompose(x);
            BigInt::from(mantissa) << (AT as i32 + exponent)
        };
        // The sign of n·(o + t·d) − c.
        let sign_at = |plane: &PreparedPlane, ray: &Ray, t: f64| {
            let mut sum = -(integer(plane.offset) << (2 * AT));
            for axis in 0..3 {
                let place =
                    (integer(ray.origin[axis]) << AT) + integer(t) * integer(ray.direction[axis]);
                sum += integer(plane.normal[axis]) * place;
            }
            sum.cmp(&BigInt::ZERO)
        };
        let mut random = Random(74);
        let [mut begun, mut ended, mut close] = [0; 3];
        for round in 0..30_000 {
            let (origin, mut normal) = (random.point(), random.point());
            let mut direction = random.point();
            if round % 3 != 0 {
                // The products along the ray cancel.
                let lean = [1e-8, 1e-15][round % 2] * random.signed();
                direction += normal * (lean - normal.dot(direction) / normal.length_squared());
            }
            let mut offset = normal.dot(origin);
            if round % 4 == 0 {
                // So do those at the origin.
                normal -= origin * (normal.dot(origin) / origin.length_squared());
                let product = |axis: usize| DoubleDouble::from(normal[axis]) * origin[axis].into();
                offset = (product(0) + product(1) + product(2)).high;
            }
            if round % 7 == 0 {
                let scale = crate::math::pow(10.0, -15.0 * random.unit());
                (normal, offset) = (normal * 1e-150, offset * 1e-150);
                direction *= 1e-150 * scale;
            }
            offset *= 1.0
                + [40.0 * EPSILON * EPSILON, 4.0 * EPSILON, 1.0][round % 5 % 3] * random.signed();
            let plane = ClippingPlane::new(normal, offset).expect("a plane");
            let plane = PreparedPlane::new(&plane, DVec3::ZERO);
            let ray = Ray::new(origin, direction);
            let [after, before] = plane.bounds_along(&ray);
            for bound in [after, before]
                .into_iter()
                .filter(|bound| bound.is_finite())
            {
                let sign = sign_at(&plane, &ray, bound);
                assert_ne!(sign, Ordering::Greater, "{plane:?} {ray:?} {bound}");
                // A little further they are kept.
                let slope = (plane.normal * ray.direction).element_sum();
                let inside = bound * (1.0 + 1e-6 * slope.signum() * bound.signum());
                close += usize::from(sign_at(&plane, &ray, inside) == Ordering::Greater);
            }
            begun += usize::from(after.is_finite());
            ended += usize::from(before.is_finite());
        }
        assert!(begun > 4000 && ended > 4000, "{begun} {ended}");
        assert!(
            close > (begun + ended) / 2,
            "{close} of {begun} and {ended}"
        );
    }

    /// Planes through corners except for rounding, near the origin and far from it. The truth is integer arithmetic,
    /// and double-double arithmetic. With any term of the bounds but the underflow's at zero this fails.
    #[test]
    fn what_double_precision_decides_about_corners_is_what_integers_decide() {
        let mut random = Random(71);
        let [mut sure, mut exact] = [0; 2];
        for round in 0..30_000 {
            let far = [0.0, 1e6, 1e9][round % 3];
            let origin = random.point() * far;
            let corner = random.point().as_vec3();
            let mut normal = random.point();
            if round % 2 == 0 {
                // The products cancel, and the offset is small.
                let way = corner.as_dvec3() + origin;
                normal -= way * (normal.dot(way) / way.length_squared());
            }
            let way = corner.as_dvec3() + origin;
            let beside = way.length() * 1e-17 * crate::math::pow(10.0, 3.0 * random.unit());
            let offset = normal.dot(way) + beside * random.signed();
            let plane = ClippingPlane::new(normal, offset).expect("a plane");
            let planes = ClippingPlanes::new(&[plane]).expect("one plane");
            let clip = Clip::new(&planes, origin);
            let (value, error) = clip.planes[0].at(corner);
            let truth = integers(&clip.planes[0], corner, origin);
            assert_eq!(clip.exact_sign(&clip.planes[0], corner), truth);
            if value.abs() > error {
                assert_eq!(value.total_cmp(&0.0), truth, "{plane:?} {corner} {origin}");
                sure += 1;
            } else {
                exact += 1;
            }
            let others = [corner, Vec3::X, Vec3::Y].map(|other| corner + (other - corner) * 1e-7);
            for at in clip.through(others) {
                let values = others.map(|corner| {
                    let product = |axis: usize| {
                        let place =
                            DoubleDouble::difference(origin[axis], -f64::from(corner[axis]));
                        DoubleDouble::from(normal[axis]) * place
                    };
                    (product(0) + product(1) + product(2) - plane.offset.into()).high
                });
                // That of the values that were found is off by as much as these.
                let greatest = values
                    .iter()
                    .fold(TINY, |most, value| value.abs().max(most));
                for (value, found) in values.into_iter().zip(at.values) {
                    let off = (value / greatest - f64::from(found)).abs();
                    let rounding = f64::from(f32::EPSILON) * f64::from(found.abs());
                    assert!(off <= 2.0 * f64::from(at.error) + rounding, "{off} {at:?}");
                }
            }
        }
        assert!(sure > 5_000 && exact > 5_000, "{sure} {exact}");
    }

    /// Planes through all corners of a triangle except for rounding, as through three picks. The truth is integer
    /// arithmetic; with values in double precision this fails.
    #[test]
    fn planes_next_to_all_corners_have_close_values() {
        let mut random = Random(75);
        let mut cut = 0;
        for round in 0..6000 {
            let origin = random.point() * [0.0, 10.0, 1e6][round % 3];
            let mut corners = [(); 3].map(|()| random.point().as_vec3());
            if round % 2 == 0 {
                // Far along the plane from a small triangle's corners, products are large.
                let [a, b, c] = corners;
                corners = [a, a + (b - a) * 1e-4, a + (c - a) * 1e-4];
            }
            let [a, b, c] = corners.map(|corner| corner.as_dvec3() + origin);
            let normal = (b - a).cross(c - a).normalize_or(DVec3::X);
            let plane = ClippingPlane::new(normal, normal.dot(a)).expect("a plane");
            let planes = ClippingPlanes::new(&[plane]).expect("one plane");
            let clip = Clip::new(&planes, origin);
            for at in clip.through(corners) {
                cut += 1;
                assert!(at.error < 1e-6, "{at:?}");
                for (corner, value) in corners.into_iter().zip(at.values) {
                    let truth = integers(&clip.planes[0], corner, origin);
                    let sign = sign_of(value.into(), at.error.into());
                    assert!(sign.is_none_or(|sign| sign == truth), "{at:?} {corners:?}");
                }
            }
        }
        assert!(cut > 2000, "{cut}");
    }

    /// A triangle, a ray from next to its first corner and a plane through the hit, except for 10⁻³²: the corner's
    /// products with the normal cancel to some 10⁻²⁴, and the hit is as far away.
    fn hit_next_to_a_corner(random: &mut Random) -> (OffsetTriangle, Ray, ClippingPlane) {
        let normal = random.point();
        // Products of unlike magnitudes: those of like ones have sums that double-double numbers hold.
        let origin = random.point() * DVec3::new(1.0, 1e-6, 0.0);
        let product = |axis: usize, x: f64| DoubleDouble::from(normal[axis]) * x.into();
        let in_plane = product(0, origin.x) + product(1, origin.y);
        let offset = in_plane.high;
        let rest = in_plane - offset.into();
        let a = Vec3::Z * (-rest.high / normal.z) as f32;
        let at_corner = (rest + product(2, a.z.into())).high;
        let [b, c] = [(); 2].map(|()| random.point().as_vec3());
        let [ab, ac] = [b, c].map(|corner| (corner - a).as_dvec3());
        let along = at_corner.abs() * random.unit();
        let at_hit = 1e-32 * random.signed();
        let way = at_corner + along * normal.dot(ab) - at_hit;
        let way = ab * along - ac * (way / normal.dot(ac));
        // Next to zero, z has digits for so small a step.
        let step = at_corner * random.signed();
        let eye = origin.with_z(f64::from(a.z) + step);
        let direction = (way - DVec3::Z * step) / at_corner.abs();
        let triangle = OffsetTriangle {
            corners: [a, b, c],
            origin,
        };
        let plane = ClippingPlane::new(normal, offset).expect("a plane");
        (triangle, Ray::new(eye, direction), plane)
    }

    /// Hits and planes next to the eye, at a small part of its coordinates. The truth is integer arithmetic; without
    /// the bound on what double-double arithmetic rounds this fails.
    #[test]
    fn what_double_double_decides_about_hits_is_what_integers_decide() {
        let mut random = Random(74);
        let [mut sure, mut close] = [0; 2];
        for round in 0..40_000 {
            let (triangle, ray, plane) = if round % 4 == 0 {
                hit_next_to_a_corner(&mut random)
            } else {
                let middle = random.point() * [1.0, 1e3, 1e6][round % 3];
                let size = middle.length() * crate::math::pow(10.0, -16.0 * random.unit());
                let mut near = || middle + random.point() * size;
                let corners = [near(), near(), near()].map(|corner| corner.as_vec3());
                let eye = near();
                let target = corners.map(Vec3::as_dvec3).into_iter().sum::<DVec3>() / 3.0;
                let normal = random.point();
                let beside = size * crate::math::pow(10.0, -20.0 * random.unit());
                let offset = normal.dot(target) + beside * random.signed();
                let triangle = OffsetTriangle {
                    corners,
                    origin: DVec3::ZERO,
                };
                let plane = ClippingPlane::new(normal, offset).expect("a plane");
                (triangle, Ray::new(eye, target - eye), plane)
            };
            let OffsetTriangle { corners, origin } = triangle;
            let Some(hit) = exact::hit(&ray, &triangle, Cull::None, 0) else {
                continue;
            };
            let planes = ClippingPlanes::new(&[plane]).expect("one plane");
            let clip = Clip::new(&planes, origin);
            let plane = &clip.planes[0];
            let truth = sign_at_hit::<BigInt>(&clip.at_hit(plane, &ray, corners));
            assert_eq!(clip.exact_sign_at_hit(plane, &ray, corners), truth);
            let sign = plane.sign_along(&ray, &hit);
            assert!(
                sign.is_none_or(|sign| sign == truth),
                "{ray:?} {corners:?} {plane:?}"
            );
            sure += usize::from(sign.is_some());
            close += usize::from(sign.is_none());
        }
        assert!(sure > 1000 && close > 1000, "{sure} {close}");
    }

    /// A hit is off by as much as its bound allows: a plane that it may lie on either side of is left to exact
    /// arithmetic.
    #[test]
    fn planes_within_a_hits_error_are_undecided() {
        let ray = Ray::new(DVec3::ZERO, DVec3::X);
        let hit = BoundedHit {
            primitive: 0,
            t: 1.0,
            t_error: 0.25,
            ..BoundedHit::NONE
        };
        for (offset, sign) in [
            (0.5, Some(Ordering::Greater)),
            (0.875, None),
            (1.125, None),
            (1.5, Some(Ordering::Less)),
        ] {
            let plane = ClippingPlane::new(DVec3::X, offset).expect("a plane");
            let plane = PreparedPlane::new(&plane, DVec3::ZERO);
            assert_eq!(plane.sign_along(&ray, &hit), sign, "{offset}");
        }
    }
}
