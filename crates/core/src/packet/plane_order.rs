//! Which of two triangles the rays of a packet hit first, by the [`Plane`] of one and the corners of the other.
//!
//! A ray hits the second triangle at the mean Σ Eₖbₖ / ΣEₖ of its corners, with Eₖ its edge functions at the ray's place
//! (i, j), none of which is negative there. With sₖ the signed distances of the corners from the plane of the first, its
//! normal turned to the side that rays go to,
//!
//! F(i, j) = Σ sₖEₖ(i, j)
//!
//! is positive where the first triangle is hit before the second, and negative where it is hit after. F is linear in i
//! and j. So triangles that lie closer together than single precision distinguishes are ordered eight rays at once, or
//! a cell at once, where depth intervals would leave each ray to be decided on its own.
//!
//! # Error bound
//! ε = 2⁻⁵³. Where Eₖ is off by δ ([`PacketSpace::edges_in_double`]) and at most Mₖ over the packet, F is off by
//! Σ(|sₖ|δ + δsₖ(Mₖ + δ)), and by 6ε of Σ|sₖ|Mₖ through its own roundings. Places of panoramas, and the centre and half the
//! extent of cells, are in single precision: F moves by its slope times [`PLACE_ERROR`].
//!
//! Next to the eye, planes that are far apart compared with their distance from it may still be closer than sₖ in double
//! precision are to the truth; then the sₖ are computed in double-double arithmetic. And where coordinates differ by many
//! magnitudes, δ by the greatest of them is more than the Eₖ; then each has a componentwise bound of its own
//! ([`PacketSpace::edges_componentwise`]).

use super::params::{CELLS, ROW};
use super::setup::{Linear, PacketSpace, REACH};
use crate::hit::MISS;
use crate::num::simd::LANES;
use crate::triangle::plane::{LEAST, Plane};
use glam::Vec3;

/// The unit roundoff of double precision.
const EPSILON: f64 = f64::EPSILON / 2.0;

/// The error of places in single precision: of a ray's, or of a cell's centre and half of its extent.
const PLACE_ERROR: f64 = 4.0 * REACH / (1u64 << 24) as f64;

/// The error of an order, as a share of the greatest |F| in the packet, up to which distances in double precision
/// suffice: no more rays than this share of a packet lie next to where F is zero. With a smaller share more pairs are
/// computed again, in 10 times the time; with a larger one, more rays are cast one by one.
const ACCURATE: f64 = 1.0 / (1u64 << 16) as f64;

/// Pairs of triangles, and planes, in the cache. A cell seldom shows more triangles at once; more entries would push
/// the packet out of the first-level cache.
const CACHED: usize = 16;

/// A triangle's plane, its normal turned to the side that rays go to; `None` where it is not sure how rays cross it.
type TurnedPlane = Option<Plane>;

/// The edge functions of a triangle over a packet, each with the bound on its error; `None` where it is not sure which
/// side of the triangle the packet sees.
type Edges = Option<[(Linear, f64); 3]>;

/// A triangle's plane as the rays of a packet cross it. For a perspective packet they go from the eye to the plane, as
/// hits lie in front of the eye.
fn turned(space: &PacketSpace, corners: [Vec3; 3]) -> TurnedPlane {
    let plane = Plane::new(corners);
    if space.perspective {
        plane.turned_from(space.origin, space.origin_error)
    } else {
        plane.turned_along(space.rays.direction, 0.0)
    }
}

/// The order of two triangles along the rays of a packet.
#[derive(Clone, Copy, Debug)]
struct PlaneOrder {
    /// F: positive where the first triangle is nearer.
    function: Linear,
    /// Bound on its error; NaN or infinite where nothing is known.
    error: f64,
}

impl PlaneOrder {
    const UNKNOWN: Self = Self {
        function: Linear {
            constant: 0.0,
            x: 0.0,
            y: 0.0,
        },
        error: f64::INFINITY,
    };

    /// The order of two triangles: by the plane of the first, and the edge functions of the second in double precision,
    /// or with componentwise bounds.
    fn new(
        plane: &TurnedPlane,
        [first, second]: [[Vec3; 3]; 2],
        in_double: &Edges,
        componentwise: impl FnOnce() -> Edges,
    ) -> Self {
        let Some(plane) = plane else {
            return Self::UNKNOWN;
        };
        let order = Self::by_distances(second.map(|corner| plane.distance(corner)), in_double);
        if order.uncertainty() <= ACCURATE {
            return order;
        }
        let distance = |corner| plane.distance_in_double_double(first, corner);
        let distances = second.map(distance);
        let closer = Self::by_distances(distances, in_double);
        if closer.uncertainty() <= ACCURATE {
            return closer;
        }
        let closest = Self::by_distances(distances, &componentwise());
        if closest.uncertainty() < closer.uncertainty() {
            closest
        } else {
            closer
        }
    }

    /// The error as a share of the greatest |F| in the packet.
    fn uncertainty(&self) -> f64 {
        self.error / self.function.reach()
    }

    /// The order by the distances of the second triangle's corners from the plane, each with its error.
    fn by_distances(distances: [(f64, f64); 3], edges: &Edges) -> Self {
        let are_all = |sign: f64| {
            let mut all = distances.iter();
            all.all(|(distance, error)| distance * sign > error + LEAST)
        };
        for sign in [1.0, -1.0] {
            if are_all(sign) {
                return Self {
                    function: Linear {
                        constant: sign,
                        ..Self::UNKNOWN.function
                    },
                    error: 0.0,
                };
            }
        }
        let Some(edges) = edges else {
            return Self::UNKNOWN;
        };
        let mut function = Self::UNKNOWN.function;
        let mut error = 0.0;
        for ((distance, distance_error), (edge, edge_error)) in distances.into_iter().zip(edges) {
            function.constant += distance * edge.constant;
            function.x += distance * edge.x;
            function.y += distance * edge.y;
            let most = edge.reach();
            error += distance.abs() * (edge_error + 6.0 * EPSILON * most)
                + distance_error * (most + edge_error);
        }
        Self {
            function,
            error: (error + PLACE_ERROR * function.slope()) * 1.01 + LEAST,
        }
    }

    /// Rays, as bits, for which the first triangle is surely nearer, and those for which the second is.
    fn of_eight(&self, (x, y): (&[f32; LANES], &[f32; LANES])) -> [u32; 2] {
        let Linear {
            constant,
            x: right,
            y: down,
        } = self.function;
        let [mut first, mut second] = [0; 2];
        for lane in 0..LANES {
            let value = constant + right * f64::from(x[lane]) + down * f64::from(y[lane]);
            first |= u32::from(value > self.error) << lane;
            second |= u32::from(value < -self.error) << lane;
        }
        [first, second]
    }

    /// Whether the first triangle is surely nearer for all rays of a box of places.
    fn is_first_within(&self, places: &PlacesWithin) -> bool {
        let Linear { constant, x, y } = self.function;
        let PlacesWithin { centre, half } = *places;
        let value = constant + x * centre[0] + y * centre[1];
        value - (x.abs() * half[0] + y.abs() * half[1]) > self.error
    }
}

/// A box of places: its centre and half its extents.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacesWithin {
    pub(super) centre: [f64; 2],
    pub(super) half: [f64; 2],
}

impl PlacesWithin {
    /// Those of a cell of a lattice's packet.
    pub(super) fn of_cell(cell: usize) -> Self {
        let half = (ROW as f64 - 1.0) * 0.5;
        let first = [cell % CELLS, cell / CELLS].map(|at| (at * ROW) as f64);
        Self {
            centre: first.map(|first| first + half),
            half: [half; 2],
        }
    }
}

/// The orders of pairs of triangles along the rays of a packet.
#[derive(Debug)]
pub(super) struct PlaneOrders {
    /// The packet's rays; `None` before the first packet.
    space: Option<PacketSpace>,
    /// Whether the cache holds what is known along another packet's rays.
    is_stale: bool,
    /// Allocated on first use, since most pictures need none.
    cache: Option<Box<Cache>>,
}

/// What is known of the triangles that were ordered last.
#[derive(Debug)]
struct Cache {
    /// By the low bits of the primitive index.
    planes: [(u32, TurnedPlane); CACHED],
    /// Of the triangle that was last ordered with others.
    edges: (u32, Edges),
    /// By the low bits of the sum of both primitive indices.
    orders: [([u32; 2], PlaneOrder); CACHED],
}

impl Cache {
    const EMPTY: Self = Self {
        planes: [(MISS, None); CACHED],
        edges: (MISS, None),
        orders: [([MISS; 2], PlaneOrder::UNKNOWN); CACHED],
    };
}

impl PlaneOrders {
    pub(super) fn new() -> Self {
        Self {
            space: None,
            is_stale: false,
            cache: None,
        }
    }

    /// Sets the rays that triangles are ordered along.
    pub(super) fn set_rays(&mut self, space: &PacketSpace) {
        self.space = Some(space.clone());
        self.is_stale = true;
    }

    /// Of eight rays, as bits, those for which the first of two triangles is surely nearer where they hit both, and
    /// those for which the second is. `corners` gives those of a primitive index.
    pub(super) fn of_eight(
        &mut self,
        pair: [u32; 2],
        places: (&[f32; LANES], &[f32; LANES]),
        corners: impl Fn(u32) -> [Vec3; 3],
    ) -> [u32; 2] {
        self.order(pair, corners).of_eight(places)
    }

    /// Whether the first of two triangles is surely nearer for all rays of a box of places that hit both.
    pub(super) fn is_first_within(
        &mut self,
        pair: [u32; 2],
        places: &PlacesWithin,
        corners: impl Fn(u32) -> [Vec3; 3],
    ) -> bool {
        self.order(pair, corners).is_first_within(places)
    }

    fn order(&mut self, pair: [u32; 2], corners: impl Fn(u32) -> [Vec3; 3]) -> PlaneOrder {
        let Some(space) = &self.space else {
            return PlaneOrder::UNKNOWN;
        };
        let cache = self.cache.get_or_insert_with(|| Box::new(Cache::EMPTY));
        if std::mem::take(&mut self.is_stale) {
            **cache = Cache::EMPTY;
        }
        let [first, second] = pair;
        let (cached, order) = &mut cache.orders[first.wrapping_add(second) as usize % CACHED];
        if *cached != pair {
            let (of, plane) = &mut cache.planes[first as usize % CACHED];
            if *of != first {
                (*of, *plane) = (first, turned(space, corners(first)));
            }
            let of_second = corners(second);
            if cache.edges.0 != second {
                let edges = space.edges_in_double(of_second);
                let edges = edges.map(|(edges, error)| edges.map(|edge| (edge, error)));
                cache.edges = (second, edges);
            }
            let both = [corners(first), of_second];
            let componentwise = || space.edges_componentwise(of_second);
            *cached = pair;
            *order = PlaneOrder::new(plane, both, &cache.edges.1, componentwise);
        }
        *order
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Projection;
    use crate::hit::Cull;
    use crate::math;
    use crate::packet::params::SIDE;
    use crate::packet::setup_tests::{camera, space};
    use crate::random::Random;
    use crate::triangle::exact::{self, Placed};
    use glam::DVec3;
    use std::cmp::Ordering;

    /// Two triangles that are a few units in the last place apart, or cross at a small angle, or lie in exactly one plane,
    /// before a camera with rays `pitch` apart.
    fn near_pair(random: &mut Random, middle: DVec3, pitch: f64) -> [[Vec3; 3]; 2] {
        let size = pitch * 40.0;
        let is_one_plane = random.unit() < 0.2;
        // Whole multiples of a power of two.
        let grain = f64::from_bits(size.to_bits() >> 52 << 52) / 4096.0;
        let rounded = |point: DVec3| (point / grain).round() * grain;
        let first = [(); 3].map(|()| {
            let corner = random.point() * size;
            if is_one_plane {
                rounded(corner)
            } else {
                middle + corner
            }
        });
        let first = first.map(DVec3::as_vec3);
        let apart = size * math::pow(10.0, -4.0 - 5.0 * random.unit());
        let [a, b, c] = first.map(Vec3::as_dvec3);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        // Another triangle of the plane, its corners moved off it.
        let second = [(); 3].map(|()| {
            let (s, t) = (random.signed() * 2.0, random.signed() * 2.0);
            if is_one_plane {
                let (s, t) = ((s * 2.0).round(), (t * 2.0).round());
                return (a + (b - a) * s + (c - a) * t).as_vec3();
            }
            let off = normal * (apart * random.signed());
            (a + (b - a) * s + (c - a) * t + off).as_vec3()
        });
        [first, second]
    }

    /// Orders are those of exact arithmetic, for rays and for cells.
    #[test]
    fn pairs_a_rounding_apart_are_ordered_as_exact_arithmetic_orders_them() {
        let mut random = Random(73);
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let [mut hits, mut decided, mut cells] = [0; 3];
            for _ in 0..900 {
                // Next to zero single precision distinguishes corners at any distance of the eye.
                let is_at_zero = random.unit() < 0.5;
                let middle = if is_at_zero {
                    DVec3::ZERO
                } else {
                    random.point() * 3.0
                };
                let finest = if is_at_zero { 13.0 } else { 5.0 };
                let pitch = math::pow(10.0, -1.0 - finest * random.unit());
                let camera = camera(&mut random, middle, projection, pitch);
                let pair = near_pair(&mut random, middle, pitch);
                let space = space(&camera, DVec3::ZERO, Cull::None);
                let mut orders = PlaneOrders::new();
                orders.set_rays(&space);
                let corners = |primitive: u32| pair[primitive as usize];
                let placed = pair.map(|corners| Placed {
                    corners,
                    origin: DVec3::ZERO,
                });
                for _ in 0..12 {
                    let (x, y) = (
                        (random.unit() * SIDE as f64).floor(),
                        (random.unit() * SIDE as f64).floor(),
                    );
                    let ray = camera.ray(x + 0.5, y + 0.5);
                    let truth = exact::compare(&ray, &placed[0], &placed[1], Cull::None);
                    let Some(truth) = truth else { continue };
                    hits += 1;
                    let places = (&[x as f32; LANES], &[y as f32; LANES]);
                    let [first, second] = orders.of_eight([0, 1], places, corners);
                    assert!(first & second == 0);
                    assert!(first == 0 || truth == Ordering::Less, "{pair:?} {x} {y}");
                    assert!(
                        second == 0 || truth == Ordering::Greater,
                        "{pair:?} {x} {y}"
                    );
                    decided += u32::from(first | second != 0);
                    let cell = y as usize / ROW * CELLS + x as usize / ROW;
                    let within = PlacesWithin::of_cell(cell);
                    if orders.is_first_within([0, 1], &within, corners) {
                        assert_eq!(truth, Ordering::Less, "{pair:?} {cell}");
                        cells += 1;
                    }
                }
            }
            assert!(hits > 250 && cells > hits / 5, "{hits} {cells}");
            assert!(decided > hits / 2, "{decided} of {hits}");
        }
    }

    /// Of large triangles around the eye, a rounding of their corners away from it, those two whose planes are closest:
    /// closer than double precision tells distances from them. With those alone this fails.
    #[test]
    fn planes_next_to_the_eye_are_ordered_as_exact_arithmetic_orders_them() {
        let mut random = Random(77);
        let [mut hits, mut decided] = [0; 2];
        for _ in 0..600 {
            let camera = camera(&mut random, DVec3::ZERO, Projection::Perspective, 0.02);
            let eye = camera.placement().eye;
            let across = camera.forward().any_orthogonal_vector();
            let around = [across, camera.forward().cross(across)];
            let mut layer = || {
                [(-1.0, -1.0), (1.0, -1.0), (0.0, 1.0)].map(|(s, t)| {
                    let off = random.point() * 6e-8;
                    (eye + around[0] * s + around[1] * t + off).as_vec3()
                })
            };
            let mut layers: Vec<(f64, [Vec3; 3])> = (0..60)
                .map(|_| {
                    let corners = layer();
                    let [a, b, c] = corners.map(Vec3::as_dvec3);
                    ((b - a).cross(c - a).normalize().dot(a - eye), corners)
                })
                .collect();
            layers.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            let apart = |pair: &&[(f64, [Vec3; 3])]| pair[1].0 - pair[0].0;
            let closest = layers
                .windows(2)
                .filter(|pair| pair[0].1 != pair[1].1)
                .min_by(|a, b| apart(a).total_cmp(&apart(b)));
            let closest = closest.expect("layers differ");
            let pair = [closest[0].1, closest[1].1];
            let space = space(&camera, DVec3::ZERO, Cull::None);
            let mut orders = PlaneOrders::new();
            orders.set_rays(&space);
            let placed = pair.map(|corners| Placed {
                corners,
                origin: DVec3::ZERO,
            });
            for place in [2.0, 9.0, 20.0, 31.0] {
                let ray = camera.ray(place + 0.5, place + 0.5);
                let truth = exact::compare(&ray, &placed[0], &placed[1], Cull::None);
                let Some(truth) = truth.filter(|order| order.is_ne()) else {
                    continue;
                };
                hits += 1;
                let places = (&[place as f32; LANES], &[place as f32; LANES]);
                let order = orders.of_eight([0, 1], places, |primitive| pair[primitive as usize]);
                match order {
                    [0xff, 0] => assert_eq!(truth, Ordering::Less, "{pair:?} {eye} {place}"),
                    [0, 0xff] => assert_eq!(truth, Ordering::Greater, "{pair:?} {eye} {place}"),
                    _ => continue,
                }
                decided += 1;
            }
        }
        assert!(
            hits > 500 && decided * 100 > hits * 99,
            "{decided} of {hits}"
        );
    }

    /// Corners whose coordinates relative to the eye have random exponents. With the bounds of edge functions that go by
    /// the greatest coordinate alone this fails.
    #[test]
    fn triangles_of_many_magnitudes_are_ordered_as_exact_arithmetic_orders_them() {
        let mut random = Random(78);
        let [mut pairs, mut decided] = [0; 2];
        for _ in 0..150 {
            let camera = camera(&mut random, DVec3::ZERO, Projection::Perspective, 0.02);
            let eye = camera.placement().eye;
            let space = space(&camera, DVec3::ZERO, Cull::None);
            let mut orders = PlaneOrders::new();
            orders.set_rays(&space);
            let mut number = || random.signed() * math::pow(10.0, 18.0 * random.signed());
            let mut corner = || (eye + DVec3::new(number(), number(), number())).as_vec3();
            let triangles: Vec<[Vec3; 3]> = (0..40).map(|_| [(); 3].map(|()| corner())).collect();
            let placed = |triangle: u32| Placed {
                corners: triangles[triangle as usize],
                origin: DVec3::ZERO,
            };
            let ray = camera.ray(9.5, 9.5);
            let places = (&[9.0; LANES], &[9.0; LANES]);
            let hits: Vec<u32> = (0..triangles.len() as u32)
                .filter(|&at| exact::hit(&ray, &placed(at), Cull::None, 0).is_some())
                .collect();
            for pair in hits.windows(2).map(|pair| [pair[0], pair[1]]) {
                let [first, second] = pair.map(placed);
                let truth = exact::compare(&ray, &first, &second, Cull::None);
                let order = orders.of_eight(pair, places, |triangle| triangles[triangle as usize]);
                pairs += 1;
                match order {
                    [0xff, 0] => assert_eq!(truth, Some(Ordering::Less), "{first:?} {second:?}"),
                    [0, 0xff] => assert_eq!(truth, Some(Ordering::Greater), "{first:?} {second:?}"),
                    _ => continue,
                }
                decided += 1;
            }
        }
        assert!(
            pairs > 300 && decided * 100 > pairs * 90,
            "{decided} of {pairs}"
        );
    }

    /// Where two planes cross between a ray and its place in single precision, the place does not decide. With
    /// [`PLACE_ERROR`] at zero this fails.
    #[test]
    fn places_in_single_precision_do_not_decide_across_a_crossing() {
        let place = 17.0 + f64::from(f32::EPSILON);
        let crossing = 17.0 + f64::from(f32::EPSILON) / 2.0;
        assert_eq!(place as f32, 17.0);
        let edge = |x: f64, constant: f64| Linear {
            constant,
            x,
            y: 0.0,
        };
        // Distances of 1, −1 and 0 from the plane z = 0, and edge functions whose difference is x − crossing.
        let first = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let plane = Plane::new(first);
        let corners = [Vec3::Z, -Vec3::Z, Vec3::ZERO];
        let edges = [edge(1.0, 0.0), edge(0.0, crossing), edge(0.0, 1.0)];
        let order = PlaneOrder::new(&Some(plane), [first, corners], &off_by(edges, 0.0), || None);
        let of = |x: f64| order.of_eight((&[x as f32; LANES], &[0.0; LANES]));
        assert_eq!(of(place), [0, 0]);
        assert_eq!([of(18.0), of(16.0)], [[0xff, 0], [0, 0xff]]);
    }

    fn off_by(edges: [Linear; 3], error: f64) -> Edges {
        Some(edges.map(|edge| (edge, error)))
    }

    fn constant(constant: f64) -> Linear {
        Linear {
            constant,
            x: 0.0,
            y: 0.0,
        }
    }

    fn signs(order: &PlaneOrder) -> [u32; 2] {
        order.of_eight((&[0.0; LANES], &[0.0; LANES]))
    }

    /// With the error of edge functions at zero this fails.
    #[test]
    fn sums_within_the_error_of_edge_functions_decide_nothing() {
        let first = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let plane = Plane::new(first);
        let corners = [Vec3::Z, -Vec3::Z, Vec3::ZERO];
        let of = |more: f64| {
            let edges = [constant(1.0 + more), constant(1.0), constant(1.0)];
            let edges = off_by(edges, 1e-9);
            signs(&PlaneOrder::new(
                &Some(plane),
                [first, corners],
                &edges,
                || None,
            ))
        };
        assert_eq!([of(1.9e-9), of(-1.9e-9)], [[0; 2]; 2]);
        assert_eq!([of(2.1e-9), of(-2.1e-9)], [[0xff, 0], [0, 0xff]]);
    }

    /// Corners in exactly the plane, whose rounded distances are not zero. With the error of distances at zero this fails.
    #[test]
    fn corners_within_rounding_of_a_plane_decide_nothing() {
        let mut random = Random(76);
        let mut rounded = 0;
        for _ in 0..500 {
            let mut whole = || [(); 3].map(|()| (random.signed() * 1048576.0).round());
            let [a, b, c] = [whole(), whole(), whole()].map(DVec3::from_array);
            let at = |s: f64, t: f64| (a + (b - a) * s + (c - a) * t).as_vec3();
            let first = [a, b, c].map(|corner| corner.as_vec3());
            let plane = Plane::new(first);
            let corners = [at(2.0, -3.0), at(-1.0, 3.0), at(3.0, 2.0)];
            let edges = off_by([constant(1.0), constant(2.0), constant(0.5)], 0.0);
            let order = PlaneOrder::by_distances(corners.map(|c| plane.distance(c)), &edges);
            assert_eq!(signs(&order), [0, 0], "{a} {b} {c}");
            let wide = PlaneOrder::new(&Some(plane), [first, corners], &edges, || None);
            assert_eq!(signs(&wide), [0, 0], "{a} {b} {c}");
            rounded += u32::from(order.function.constant != 0.0);
        }
        assert!(rounded > 200, "{rounded}");
    }

    #[test]
    fn orders_of_another_packet_are_forgotten() {
        let mut random = Random(74);
        let pair = [
            [Vec3::ZERO, Vec3::X, Vec3::Y],
            [Vec3::Z, Vec3::X + Vec3::Z, Vec3::Y + Vec3::Z],
        ];
        let corners = |primitive: u32| pair[primitive as usize];
        let places = (&[0.0; LANES], &[0.0; LANES]);
        let mut orders = PlaneOrders::new();
        assert_eq!(orders.of_eight([0, 1], places, corners), [0, 0]);
        for _ in 0..40 {
            let camera = camera(&mut random, DVec3::ZERO, Projection::Perspective, 0.01);
            orders.set_rays(&space(&camera, DVec3::ZERO, Cull::None));
            let expected = match camera.placement().eye.z {
                z if z > 1.1 => [0, 0xff],
                z if z < -0.1 => [0xff, 0],
                _ => continue,
            };
            assert_eq!(orders.of_eight([0, 1], places, corners), expected);
        }
    }
}
