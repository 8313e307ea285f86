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
//! * **Hits.** At t ± τ along a ray o + t·d it is (n·o − c) + t·(n·d). A term is rounded at most six times in all:
//!   6.1ε(Σ|nᵢoᵢ| + |c| + (|t| + τ)·Σ|nᵢdᵢ|), and τ·Σ|nᵢdᵢ| for τ itself.
//!
//! Products below the range of normal numbers lose 2⁻¹⁰⁷⁵ each, those with t that times |t| + τ; [`TINY`] times
//! 1 + |t| + τ is more than all of these. What leaves the range at the other end is infinite or NaN, and so is its
//! bound: comparisons fail, and exact arithmetic decides.

use super::BoundedHit;
use crate::num::exact::{Scale, Vector, compare_scaled, cross, decompose, dot, subtract};
use crate::num::integer::Integer;
use crate::num::roundoff::EPSILON;
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

    /// The functions of the planes that cut a triangle.
    pub(crate) fn through(&self, corners: [Vec3; 3]) -> impl Iterator<Item = AtCorners> {
        self.planes
            .iter()
            .enumerate()
            .filter_map(move |(number, plane)| {
                let at = corners.map(|corner| self.at(plane, corner));
                if !at.iter().any(|at| at.sign == Ordering::Less) {
                    return None;
                }
                let greatest = at.iter().fold(TINY, |most, at| at.value.abs().max(most));
                let error = at.iter().fold(0.0, |most, at| at.error.max(most));
                Some(AtCorners {
                    plane: number,
                    values: at.map(|at| (at.value / greatest) as f32),
                    // The quotient is rounded as well.
                    error: (error / greatest * 1.001 + 2.0 * EPSILON) as f32,
                })
            })
    }

    /// The planes' functions at an eye in world space: zero, without an error, where it lies on a plane.
    pub(crate) fn at_eye(&self, eye: DVec3) -> impl Iterator<Item = AtEye> {
        self.planes.iter().map(move |plane| {
            let terms = plane.normal * eye;
            let size = terms.abs().element_sum() + plane.offset.abs();
            let value = terms.element_sum() - plane.offset;
            let error = 4.1 * EPSILON * size + TINY;
            let is_on = value.abs() <= error
                && Self::exact_sign_of_sum(plane, eye, DVec3::ZERO) == Ordering::Equal;
            AtEye {
                normal: plane.normal,
                value: if is_on { 0.0 } else { value },
                error: if is_on { 0.0 } else { error },
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
        Self::exact_sign_of_sum(plane, corner.as_dvec3(), self.origin)
    }

    /// The exact sign of n·(p + q) − c.
    fn exact_sign_of_sum(plane: &PreparedPlane, p: DVec3, q: DVec3) -> Ordering {
        let lengths = Scale::of_vectors([&p, &q]);
        let normals = Scale::of_vectors([&plane.normal]);
        let point = add(&lengths.vector(p), &lengths.vector(q));
        let product = dot(&normals.vector::<BigInt>(plane.normal), &point);
        let (mantissa, exponent) = decompose(plane.offset);
        let offset = BigInt::from(mantissa);
        compare_scaled(
            &product,
            normals.exponent + lengths.exponent,
            &offset,
            exponent,
        )
    }

    /// The exact sign of n·p − c at the point p where a ray hits a triangle: the mean of the corners weighted by
    /// d·(B×C), d·(C×A) and d·(A×B), with corners relative to the ray's origin. If the weights sum to zero there is
    /// no hit.
    #[inline(never)]
    fn exact_sign_at_hit(&self, plane: &PreparedPlane, ray: &Ray, corners: [Vec3; 3]) -> Ordering {
        let corners = corners.map(Vec3::as_dvec3);
        let lengths = Scale::of_vectors(corners.iter().chain([&self.origin, &ray.origin]));
        let directions = Scale::of_vectors([&ray.direction]);
        let normals = Scale::of_vectors([&plane.normal]);
        let origin = lengths.vector::<BigInt>(self.origin);
        let points = corners.map(|corner| add(&lengths.vector(corner), &origin));
        let eye = lengths.vector::<BigInt>(ray.origin);
        let [a, b, c] = [0, 1, 2].map(|i| subtract(&points[i], &eye));
        let direction = directions.vector::<BigInt>(ray.direction);
        let weights = [(&b, &c), (&c, &a), (&a, &b)].map(|(p, q)| dot(&direction, &cross(p, q)));
        let sum = weights[0].plus(&weights[1]).plus(&weights[2]);
        let normal = normals.vector::<BigInt>(plane.normal);
        let [x, y, z] = [0, 1, 2].map(|i| weights[i].times(&dot(&normal, &points[i])));
        let (mantissa, exponent) = decompose(plane.offset);
        let order = compare_scaled(
            &x.plus(&y).plus(&z),
            normals.exponent + lengths.exponent,
            &sum.times(&BigInt::from(mantissa)),
            exponent,
        );
        match Integer::sign(&sum) {
            Ordering::Greater => order,
            Ordering::Less => order.reverse(),
            Ordering::Equal => Ordering::Less,
        }
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

    /// The sign of n·p − c at a hit of a ray, where the bound decides it.
    fn sign_along(&self, ray: &Ray, hit: &BoundedHit) -> Option<Ordering> {
        let before = self.normal * ray.origin;
        let along = self.normal * ray.direction;
        let value = before.element_sum() - self.offset + hit.t * along.element_sum();
        let steep = along.abs().element_sum();
        let size = before.abs().element_sum() + self.offset.abs();
        let size = size + (hit.t.abs() + hit.t_error) * steep;
        let error = 6.1 * EPSILON * size + 1.001 * hit.t_error * steep;
        let error = error + TINY * (1.0 + hit.t.abs() + hit.t_error);
        if value > error {
            Some(Ordering::Greater)
        } else if value < -error {
            Some(Ordering::Less)
        } else {
            None
        }
    }
}

fn add<I: Integer>(a: &Vector<I>, b: &Vector<I>) -> Vector<I> {
    std::array::from_fn(|i| a[i].plus(&b[i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::double_double::DoubleDouble;
    use crate::random::Random;

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
            let truth = clip.exact_sign(plane, point);
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
            let truth = clip.exact_sign(&clip.planes[0], corner);
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
                let greatest = others.map(|corner| clip.planes[0].at(corner).0.abs());
                let greatest = greatest.into_iter().fold(TINY, f64::max);
                for (value, found) in values.into_iter().zip(at.values) {
                    let off = (value / greatest - f64::from(found)).abs();
                    let rounding = f64::from(f32::EPSILON) * f64::from(found.abs());
                    assert!(off <= f64::from(at.error) + rounding, "{off} {at:?}");
                }
            }
        }
        assert!(sure > 5_000 && exact > 5_000, "{sure} {exact}");
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
