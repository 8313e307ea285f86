//! The truth: a ray's nearest triangle by arithmetic without rounding.
//!
//! It shares no code with what it checks. A filter in doubles, with bounds that are proven where
//! they stand, throws away triangles that a ray certainly misses; every triangle that is left is
//! decided exactly. So an answer never depends on a rounded number.

use crate::exact::{self, Dyadic, Vector};
use raycast_core::accel::Accel;
use raycast_core::camera::Ray;
use raycast_core::glam::{DAffine3, DVec3, Vec3};
use raycast_core::intersect::Cull;
use raycast_core::scene::{COORDINATE_LIMIT, Scene};
use std::cmp::Ordering;

/// The nearest triangle that a ray meets, in truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// The object's number.
    pub object: u32,
    /// The triangle's number in its object.
    pub triangle: u32,
    /// The ray's parameter, as the nearest double.
    pub t: f64,
    /// Weight of the second corner, as the nearest double.
    pub u: f64,
    /// Weight of the third corner, as the nearest double.
    pub v: f64,
    /// The cosine between the ray and the triangle's normal, 0 to 1 (rounded).
    pub cosine: f64,
}

/// A triangle as stored: each corner is exactly `base + corner`.
#[derive(Clone, Copy, Debug)]
struct Stored {
    object: u32,
    triangle: u32,
    base: DVec3,
    corners: [Vec3; 3],
}

impl Stored {
    /// The corners as the nearest doubles.
    fn rounded(&self) -> [DVec3; 3] {
        self.corners.map(|corner| self.base + corner.as_dvec3())
    }
}

/// Neighbouring triangles, and a ball around their exact corners.
#[derive(Clone, Debug)]
struct Cluster {
    center: DVec3,
    radius: f64,
    triangles: Vec<Stored>,
}

/// A hit with the exact numbers that decide which is nearest.
struct ExactHit {
    object: u32,
    triangle: u32,
    /// `w_b`, `w_c` and their sum with `w_a`: the weights' numerators and denominator.
    second: Dyadic,
    third: Dyadic,
    sum: Dyadic,
    /// `det(A, B, C)`: with `sum` as its denominator, `t`.
    depth: Dyadic,
}

impl ExactHit {
    /// Nearest first; equal distances by number.
    fn order(&self, other: &Self) -> Ordering {
        // depth / sum against depth' / sum': both sides times sum · sum', and its sign.
        let (left, right) = (&self.depth * &other.sum, &other.depth * &self.sum);
        let by_distance = if self.sum.signum() == other.sum.signum() {
            left.cmp(&right)
        } else {
            right.cmp(&left)
        };
        by_distance
            .then(self.object.cmp(&other.object))
            .then(self.triangle.cmp(&other.triangle))
    }
}

/// Half the distance from 1 to the next double: the bound of one rounding.
const HALF_ULP: f64 = f64::EPSILON * 0.5;

/// More than any rounding below the normal range can add up to in the filter, whose terms are
/// fewer than 1000 products of fewer than 4 factors, each below 1e40 where it matters; and far less
/// than anything that a filter should throw away.
const TINY: f64 = 1e-200;

/// Every triangle of a scene, ready to be asked.
#[derive(Clone, Debug)]
pub struct Oracle {
    clusters: Vec<Cluster>,
}

impl Oracle {
    /// The oracle of a scene and the tree that was built over it.
    ///
    /// Where all objects stand where their files put them, and their meshes share an offset,
    /// corners are taken from the meshes, as stored there. Otherwise they were rounded once, when
    /// they were placed in the world: they are taken from `accel`, as stored.
    pub fn new(scene: &Scene, accel: &Accel) -> Self {
        let placed = scene.world_from_objects().expect("a valid scene");
        let offsets = || scene.objects.iter().map(|object| object.mesh.offset());
        let is_at_rest = placed.iter().all(|&placed| placed == DAffine3::IDENTITY)
            && offsets().all(|offset| Some(offset) == offsets().next());
        if !is_at_rest {
            let stored = |slot| {
                let (object, triangle) = accel.identify(slot);
                Stored {
                    object,
                    triangle,
                    base: accel.origin(),
                    corners: accel.corners(slot),
                }
            };
            return Self::of_triangles((0..accel.len() as u32).map(stored).collect());
        }
        let mut triangles = Vec::new();
        for (number, object) in scene.objects.iter().enumerate() {
            let mesh = &object.mesh;
            for (triangle, indices) in mesh.triangles().iter().enumerate() {
                let position = |i: u32| mesh.positions().get(i as usize).copied();
                let [Some(a), Some(b), Some(c)] = indices.map(position) else {
                    continue;
                };
                triangles.push(Stored {
                    object: number as u32,
                    triangle: triangle as u32,
                    base: mesh.offset(),
                    corners: [a, b, c],
                });
            }
        }
        Self::of_triangles(triangles)
    }

    /// The oracle of triangles given by their corners, all of object 0, numbered by their order.
    pub fn of_corners(corners: &[[Vec3; 3]]) -> Self {
        Self::of_triangles(
            corners
                .iter()
                .enumerate()
                .map(|(triangle, &corners)| Stored {
                    object: 0,
                    triangle: triangle as u32,
                    base: DVec3::ZERO,
                    corners,
                })
                .collect(),
        )
    }

    fn of_triangles(mut triangles: Vec<Stored>) -> Self {
        // A vertex that is not finite or too far has no triangles: the contract of a mesh. A
        // triangle without area needs no rule of its own, all its determinants being zero.
        triangles.retain(|triangle| {
            triangle
                .rounded()
                .iter()
                .all(|corner| corner.is_finite() && corner.abs().max_element() <= COORDINATE_LIMIT)
        });
        let mut clusters = Vec::new();
        split(&mut triangles, &mut clusters);
        Self { clusters }
    }

    /// The nearest triangle that `ray` meets; ties go to the lowest object, then triangle.
    pub fn nearest(&self, ray: &Ray, cull: Cull) -> Option<Truth> {
        self.answer(ray, cull, true)
    }

    /// The same without the filter: every triangle is decided exactly.
    pub fn nearest_unfiltered(&self, ray: &Ray, cull: Cull) -> Option<Truth> {
        self.answer(ray, cull, false)
    }

    fn answer(&self, ray: &Ray, cull: Cull, filtered: bool) -> Option<Truth> {
        if !ray.is_valid() {
            return None;
        }
        let filter = Filter::new(ray);
        let exact_ray = ExactRay::new(ray);
        let mut nearest: Option<(ExactHit, &Stored)> = None;
        for cluster in &self.clusters {
            if filtered && filter.misses_ball(cluster.center, cluster.radius) {
                continue;
            }
            for triangle in &cluster.triangles {
                if filtered && filter.misses_triangle(triangle) {
                    continue;
                }
                if let Some(hit) = exact_ray.hit(triangle, cull)
                    && nearest
                        .as_ref()
                        .is_none_or(|(best, _)| hit.order(best) == Ordering::Less)
                {
                    nearest = Some((hit, triangle));
                }
            }
        }
        nearest.map(|(hit, triangle)| {
            let [a, b, c] = triangle.rounded();
            let normal = (b - a).cross(c - a).normalize_or_zero();
            Truth {
                object: hit.object,
                triangle: hit.triangle,
                t: hit.depth.quotient(&hit.sum),
                u: hit.second.quotient(&hit.sum),
                v: hit.third.quotient(&hit.sum),
                cosine: normal.dot(ray.direction.normalize_or_zero()).abs(),
            }
        })
    }
}

/// Splits triangles at the middle of their longest side until few are left together.
fn split(triangles: &mut [Stored], clusters: &mut Vec<Cluster>) {
    let centroid = |triangle: &Stored| triangle.rounded().iter().sum::<DVec3>() / 3.0;
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for triangle in triangles.iter() {
        low = low.min(centroid(triangle));
        high = high.max(centroid(triangle));
    }
    if triangles.len() > 16 {
        let axis = (high - low).max_position();
        let middle = triangles.len() / 2;
        triangles.select_nth_unstable_by(middle, |a, b| {
            centroid(a)[axis].total_cmp(&centroid(b)[axis])
        });
        let (left, right) = triangles.split_at_mut(middle);
        split(left, clusters);
        split(right, clusters);
    } else if !triangles.is_empty() {
        let center = (low + high) * 0.5;
        // Each coordinate of a rounded corner is within half an ulp of its own, its distance from
        // the centre is rounded once more, and so are the two sums: four roundings of at most
        // (largest coordinate + distance). The sum of the sides is no less than the diagonal.
        let mut radius: f64 = 0.0;
        for corner in triangles.iter().flat_map(Stored::rounded) {
            let distance = (corner - center).abs().element_sum();
            let size = corner.abs().element_sum() + center.abs().element_sum();
            radius = radius.max(distance + 16.0 * HALF_ULP * (distance + size));
        }
        clusters.push(Cluster {
            center,
            radius: radius + TINY,
            triangles: triangles.to_vec(),
        });
    }
}

/// What a ray certainly misses, in doubles.
struct Filter {
    origin: DVec3,
    /// The ray's direction times a power of two (which changes no hit), so that its largest
    /// coordinate is 1 to 2.
    direction: DVec3,
}

impl Filter {
    fn new(ray: &Ray) -> Self {
        // In two steps: 2^1074 is no double.
        let mut direction = ray.direction;
        while direction.abs().max_element() >= 2.0 {
            direction *= if direction.abs().max_element() >= 2f64.powi(100) {
                2f64.powi(-100)
            } else {
                0.5
            };
        }
        while direction.abs().max_element() < 1.0 {
            direction *= if direction.abs().max_element() < 2f64.powi(-100) {
                2f64.powi(100)
            } else {
                2.0
            };
        }
        Self {
            origin: ray.origin,
            direction,
        }
    }

    /// Whether the line along the ray certainly leaves the ball alone.
    ///
    /// The line's distance from the centre is |m × d| / |d|, with m = centre − origin. m is rounded
    /// once. Each coordinate of the product is a difference of two products of at most |m|∞ |d|∞,
    /// |d|∞ ≤ 2: five roundings of less than 4 |m|∞ each, coordinates of m included. Lengths add
    /// four roundings of their own. 64 half-ulps of 4 |m|∞ are more than all of that, three
    /// coordinates together. (A ball behind the ray is not thrown away; an infinity or NaN from
    /// overflow throws nothing away, since only a true comparison does.)
    fn misses_ball(&self, center: DVec3, radius: f64) -> bool {
        let to_center = center - self.origin;
        let distance = to_center.cross(self.direction).length();
        let reach = radius * self.direction.length();
        let slack = 64.0 * HALF_ULP * (4.0 * to_center.abs().max_element() + reach) + TINY;
        distance > reach + slack
    }

    /// Whether two of the ray's three determinants have certainly opposite signs.
    ///
    /// Let M bound the rounded relative corners' coordinates and P the rounded world corners'. A
    /// relative coordinate is off by at most E = h (P + M), h half an ulp: the sum `base + corner`
    /// is rounded once, to a number of at most P, and the difference from the origin once, to at
    /// most M; 2E below allows for the rounding of E and of P and M themselves. A determinant is
    /// six products d·B·C of at most 2 M²; two off coordinates move each by at most
    /// 2 (2 M E + E²), and evaluating it rounds each product twice, and each of its sums (two in
    /// the cross product's difference and the dot product), at most 8 h of 2 M² for each product.
    /// In all 6 · 2 · (2 M E + E² + 8 h M²), doubled again for good measure.
    fn misses_triangle(&self, triangle: &Stored) -> bool {
        let world = triangle.rounded();
        let [a, b, c] = world.map(|corner| corner - self.origin);
        let largest = |points: [DVec3; 3]| {
            let [a, b, c] = points.map(DVec3::abs);
            a.max(b).max(c).max_element()
        };
        let (p, m) = (largest(world), largest([a, b, c]));
        let e = 2.0 * HALF_ULP * (p + m);
        let bound = 24.0 * (2.0 * m * e + e * e + 8.0 * HALF_ULP * m * m) + TINY;
        let d = self.direction;
        let w = [d.dot(b.cross(c)), d.dot(c.cross(a)), d.dot(a.cross(b))];
        w.iter().any(|&w| w > bound) && w.iter().any(|&w| w < -bound)
    }
}

/// A ray without rounding.
struct ExactRay {
    origin: Vector,
    direction: Vector,
    t_min: Dyadic,
    t_max: Dyadic,
}

impl ExactRay {
    fn new(ray: &Ray) -> Self {
        Self {
            origin: exact::vector(ray.origin.to_array()),
            direction: exact::vector(ray.direction.to_array()),
            t_min: Dyadic::new(ray.t_min),
            t_max: Dyadic::new(ray.t_max),
        }
    }

    /// The rule: with corners A, B, C relative to the origin, w_a = d·(B × C), w_b = d·(C × A),
    /// w_c = d·(A × B) must all be ≥ 0 or all ≤ 0, and not all 0. Their sum is d·n, with
    /// n = (b − a) × (c − a) the side from which the corners run counter-clockwise: a ray meets
    /// the front where it goes against n. And t = A·(B × C) / (d·n), since n·A = A·(B × C).
    fn hit(&self, triangle: &Stored, cull: Cull) -> Option<ExactHit> {
        let base = exact::vector(triangle.base.to_array());
        let [a, b, c] = triangle.corners.map(|corner| {
            let corner = exact::vector(corner.as_dvec3().to_array());
            exact::difference(&exact::sum(&base, &corner), &self.origin)
        });
        let b_cross_c = exact::cross(&b, &c);
        let first = exact::dot(&self.direction, &b_cross_c);
        let second = exact::dot(&self.direction, &exact::cross(&c, &a));
        if first.signum() * second.signum() < 0 {
            return None;
        }
        let third = exact::dot(&self.direction, &exact::cross(&a, &b));
        let signs = [first.signum(), second.signum(), third.signum()];
        if signs.contains(&1) == signs.contains(&-1) {
            return None;
        }
        let sum = &(&first + &second) + &third;
        if cull == Cull::Back && sum.signum() > 0 {
            return None;
        }
        let depth = exact::dot(&a, &b_cross_c);
        // t_min ≤ depth / sum ≤ t_max, times the sum.
        let (low, high) = if sum.signum() > 0 {
            (&self.t_min * &sum, &self.t_max * &sum)
        } else {
            (&self.t_max * &sum, &self.t_min * &sum)
        };
        (low <= depth && depth <= high).then_some(ExactHit {
            object: triangle.object,
            triangle: triangle.triangle,
            second,
            third,
            sum,
            depth,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    const UNIT: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

    fn down(x: f64, y: f64) -> Ray {
        Ray::new(DVec3::new(x, y, 5.0), DVec3::NEG_Z)
    }

    #[test]
    fn a_triangle_that_pencil_and_paper_solve() {
        let oracle = Oracle::of_corners(&[UNIT]);
        let hit = oracle
            .nearest(&down(0.25, 0.5), Cull::None)
            .expect("a hit inside");
        assert_eq!((hit.object, hit.triangle), (0, 0));
        assert_eq!((hit.t, hit.u, hit.v), (5.0, 0.25, 0.5));
        assert_eq!(hit.cosine, 1.0);
        for (x, y, met) in [
            (0.0, 0.0, true),
            (1.0, 0.0, true),
            (0.5, 0.5, true),
            (0.0, 0.3, true),
            (0.5, 0.5f64.next_up(), false),
            (-f64::from_bits(1), 0.5, false),
            (1.0, f64::from_bits(1), false),
            (2.0, 2.0, false),
        ] {
            let hit = oracle.nearest(&down(x, y), Cull::None);
            assert_eq!(hit.is_some(), met, "{x} {y}");
        }
    }

    #[test]
    fn the_range_is_inclusive_and_behind_is_not_met() {
        let oracle = Oracle::of_corners(&[UNIT]);
        let hit = |t_min, t_max| {
            let ray = Ray {
                t_min,
                t_max,
                ..down(0.2, 0.2)
            };
            oracle.nearest(&ray, Cull::None).is_some()
        };
        assert!(hit(5.0, 5.0));
        assert!(!hit(5f64.next_up(), 9.0));
        assert!(!hit(0.0, 5f64.next_down()));
        let away = Ray::new(DVec3::new(0.2, 0.2, 5.0), DVec3::Z);
        assert_eq!(oracle.nearest(&away, Cull::None), None);
    }

    #[test]
    fn fronts_run_counter_clockwise_to_the_ray() {
        // Seen from +Z, looking down with X to the right and Y up, 0 → X → Y is counter-clockwise.
        let [a, b, c] = UNIT;
        let front = Oracle::of_corners(&[[a, b, c]]);
        let back = Oracle::of_corners(&[[a, c, b]]);
        let ray = down(0.2, 0.2);
        assert!(front.nearest(&ray, Cull::Back).is_some());
        assert!(back.nearest(&ray, Cull::Back).is_none());
        let from_below = Ray::new(DVec3::new(0.2, 0.2, -5.0), DVec3::Z);
        assert!(front.nearest(&from_below, Cull::Back).is_none());
        assert!(back.nearest(&from_below, Cull::Back).is_some());
    }

    #[test]
    fn equal_distances_go_to_the_lowest_number_and_nearer_wins() {
        let [a, b, c] = UNIT;
        let nearer = UNIT.map(|p| p + Vec3::Z * f32::EPSILON);
        let oracle = Oracle::of_corners(&[UNIT, [b, a, c], nearer, [c, b, a]]);
        let hit = oracle.nearest(&down(0.2, 0.2), Cull::None).expect("a hit");
        assert_eq!(hit.triangle, 2);
        let from_below = Ray::new(DVec3::new(0.2, 0.2, -5.0), DVec3::Z);
        let hit = oracle.nearest(&from_below, Cull::None).expect("a hit");
        assert_eq!(hit.triangle, 0);
    }

    #[test]
    fn a_ray_in_the_plane_and_a_triangle_without_area_are_misses() {
        let oracle = Oracle::of_corners(&[UNIT]);
        let along = Ray::new(DVec3::new(-1.0, 0.2, 0.0), DVec3::X);
        assert_eq!(oracle.nearest(&along, Cull::None), None);
        let flat = Oracle::of_corners(&[[Vec3::ZERO, Vec3::X, Vec3::X * 2.0], [Vec3::ONE; 3]]);
        assert_eq!(flat.nearest(&down(0.5, 0.0), Cull::None), None);
        assert_eq!(flat.nearest(&down(1.0, 1.0), Cull::None), None);
    }

    /// The filter throws away nothing that counts: over many decades, with rays aimed at what is
    /// hardest. The truth is the same rule without the filter.
    #[test]
    fn the_filter_changes_nothing() {
        let mut random = Random::new(3);
        let mut hits = 0;
        for round in 0..300 {
            let scale = random.decade(-12.0, 12.0);
            let middle = random.in_cube() * scale * random.decade(-3.0, 4.0);
            let size = random.decade(-4.0, 0.0);
            let corners: Vec<[Vec3; 3]> = (0..40)
                .map(|_| {
                    let place = random.in_cube() * scale + middle;
                    std::array::from_fn(|_| (place + random.in_cube() * scale * size).as_vec3())
                })
                .collect();
            let oracle = Oracle::of_corners(&corners);
            for _ in 0..10 {
                let origin = middle + random.in_cube() * scale * random.decade(-1.0, 2.0);
                let [a, b, c] = corners[random.below(40) as usize].map(|p| p.as_dvec3());
                let target = match random.below(4) {
                    0 => a,
                    1 => (a + b) * 0.5,
                    2 => (a + b + c) / 3.0,
                    _ => middle + random.in_cube() * scale,
                };
                let direction = (random.nudge(target, 2) - origin) * random.decade(-9.0, 9.0);
                let ray = Ray::new(origin, direction);
                let plain = oracle.nearest_unfiltered(&ray, Cull::None);
                assert_eq!(oracle.nearest(&ray, Cull::None), plain, "{round}: {ray:?}");
                hits += u32::from(plain.is_some());
            }
        }
        assert!(hits > 1000, "only {hits} hits");
    }
}
