//! Which of two triangles the rays of a packet hit first, by the [`Plane`] of one and the corners of the other.
//!
//! A ray hits the second triangle at the mean Σ Eₖbₖ / ΣEₖ of its corners, with Eₖ its edge functions at the ray's
//! place (i, j), none of which is negative there. With sₖ the signed distances of the corners from the plane of the
//! first, its normal turned to the side that rays go to,
//!
//! F(i, j) = Σ sₖEₖ(i, j)
//!
//! is positive where the first triangle is hit before the second, and negative where it is hit after. F is linear in i
//! and j. So triangles that lie closer together than single precision distinguishes are ordered eight rays at once, or
//! a cell at once, where depth intervals would leave each ray to be decided on its own. Where all sₖ have one sign this
//! is the plane test of Newell, Newell, Sancha, "A Solution to the Hidden Surface Problem", 1972. Where all sₖ may be
//! zero they are computed exactly: if they are zero, both triangles lie in one plane, and the lower primitive id is hit
//! first.
//!
//! # Error bound
//! ε = 2⁻⁵³. Where Eₖ is off by δ ([`PacketSpace::edges_in_double`]) and at most Mₖ over the packet, F is off by
//! Σ(|sₖ|δ + δsₖ(Mₖ + δ)), and by 6ε of Σ|sₖ|Mₖ through its own roundings. Places of panoramas, and the centre and half the
//! extent of cells, are in single precision: F moves by its slope times [`SINGLE_PLACE_ERROR`].
//!
//! Next to the eye, planes may be closer together than the errors of sₖ in double precision, although far apart
//! compared with their distance from the eye; then the sₖ are computed in double-double arithmetic, and exactly where
//! that does not tell them from zero. And where coordinates differ by many magnitudes, δ, proportional to the greatest,
//! exceeds the Eₖ; then each has a componentwise bound of its own ([`PacketSpace::edges_componentwise`]).

use super::params::{CELLS, ROW};
use super::setup::{Edges, Linear, PacketSpace, REACH};
use crate::hit::MISS;
use crate::num::roundoff::EPSILON;
use crate::num::simd::LANES;
use crate::triangle::coplanar::{are_coplanar, share_plane_of_axis};
use crate::triangle::exact::distances_from_plane;
use crate::triangle::plane::{LEAST_SURE, Plane};
use glam::Vec3;
use std::cmp::Ordering;

/// The error of places in single precision, 4u of the furthest: a place, a cell's centre and half of its extent are
/// each rounded by u of at most [`REACH`], and one u is for higher orders.
const SINGLE_PLACE_ERROR: f64 = 4.0 * REACH / (1u64 << 24) as f64;

/// The error of an order, as a share of the greatest |F| in the packet, up to which it is not computed again more
/// closely. F is linear, so that about this share of a packet's 2¹⁰ rays stays undecided: less than one ray. With a
/// larger share rays are cast one by one; with a smaller one pairs are computed again for rays that do not exist.
const ACCURATE: f64 = 1.0 / (1u64 << 16) as f64;

/// Pairs of triangles, and planes, in the caches: 4 and 8 kB. A cell seldom shows more triangles at once. With a
/// quarter, the planes that a few cells show evict one another; with four times as many nothing is gained.
const CACHED: usize = 64;

/// A triangle's plane, its normal turned to the side that rays go to; `None` where it is not sure how rays cross it.
type TurnedPlane = Option<Plane>;

/// The edge functions of a triangle over a packet, each with the bound on its error; `None` where it is not sure which
/// side of the triangle the packet sees.
type BoundedEdges = Option<Edges>;

/// A triangle's plane as the rays of a packet cross it. For a perspective packet they go from the eye to the plane, as
/// hits lie in front of the eye.
pub(super) fn turned(space: &PacketSpace, corners: [Vec3; 3]) -> TurnedPlane {
    if !space.perspective {
        return Plane::new(corners).turned_along(space.rays.direction, 0.0);
    }
    // From the corner next to the eye: from others the distance of a plane that all but holds the eye cancels.
    let [a, b, c] = corners;
    let [to_a, to_b, to_c] =
        corners.map(|corner| (corner.as_dvec3() - space.origin).length_squared());
    let from_nearest = if to_a <= to_b && to_a <= to_c {
        [a, b, c]
    } else if to_b <= to_c {
        [b, c, a]
    } else {
        [c, a, b]
    };
    let plane = Plane::new(from_nearest);
    let turned = plane.turned_from(space.origin, space.origin_error);
    if turned.is_none() && space.origin_error == 0.0 {
        return plane.turned_exactly_from(space.origin, from_nearest);
    }
    turned
}

/// The order of two triangles along the rays of a packet.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneOrder {
    /// F: positive where the first triangle is nearer.
    function: Linear,
    /// Bound on its error; NaN or infinite where nothing is known.
    error: f64,
    /// Whether both lie in one plane.
    pub(super) in_one_plane: bool,
}

impl PlaneOrder {
    pub(super) const UNKNOWN: Self = Self {
        function: Linear::ZERO,
        error: f64::INFINITY,
        in_one_plane: false,
    };

    /// The order along rays that all hit one of two triangles first: 1.0 for the first one, −1.0 for the second.
    const fn constant(sign: f64) -> Self {
        Self {
            function: Linear {
                constant: sign,
                ..Linear::ZERO
            },
            error: 0.0,
            in_one_plane: false,
        }
    }

    /// The order of two triangles of one plane, the first of which has the lower primitive id or not.
    pub(super) const fn in_one_plane(is_first: bool) -> &'static Self {
        const fn of_one_plane(sign: f64) -> PlaneOrder {
            PlaneOrder {
                in_one_plane: true,
                ..PlaneOrder::constant(sign)
            }
        }
        const FIRST: &PlaneOrder = &of_one_plane(1.0);
        const SECOND: &PlaneOrder = &of_one_plane(-1.0);
        if is_first { FIRST } else { SECOND }
    }

    /// Sets the order of two triangles: by the plane of the first, and the edge functions of the second in double
    /// precision, or with componentwise bounds. `is_first` says whether the first is hit first if the two lie in one
    /// plane.
    #[inline(always)]
    fn set(&mut self, plane: &TurnedPlane, edges: &mut PairEdges<'_>, is_first: bool) {
        *self = Self::UNKNOWN;
        let Some(plane) = plane else {
            let [first, second] = edges.corners;
            if are_coplanar(*first, *second) {
                *self = *Self::in_one_plane(is_first);
            }
            return;
        };
        let [p, q, r] = *edges.corners[1];
        let distances = [plane.distance(p), plane.distance(q), plane.distance(r)];
        let distances = unless_shared(edges.corners, distances);
        let order = Self::by_distances(distances, || edges.in_double());
        *self = match order.is_accurate() {
            true => order,
            false => Self::closer(plane, edges, distances, is_first),
        };
    }

    /// The same where distances in double precision do not decide it.
    #[inline(never)]
    fn closer(
        plane: &Plane,
        edges: &mut PairEdges<'_>,
        distances: [(f64, f64); 3],
        is_first: bool,
    ) -> Self {
        let [first, second] = edges.corners;
        let may_lie_in_plane =
            (distances.iter()).all(|(distance, error)| distance.abs() <= error + LEAST_SURE);
        if may_lie_in_plane && share_plane_of_axis(*first, *second) {
            return *Self::in_one_plane(is_first);
        }
        let mut distances = distances;
        if !may_lie_in_plane {
            distances = plane.distances_in_double_double(*first, *second);
            distances = unless_shared(edges.corners, distances);
            let closer = Self::by_distances(distances, || edges.in_double());
            if closer.is_accurate() {
                return closer;
            }
        }
        if may_lie_in_plane || !are_accurate(distances) {
            let exact = distances_from_plane(*second, *first);
            if exact == [0.0; 3] {
                return *Self::in_one_plane(is_first);
            }
            distances = plane.with_bounds(exact);
        }
        let closer = Self::by_distances(distances, || edges.in_double());
        if closer.is_accurate() {
            return closer;
        }
        let closest = Self::by_distances(distances, || edges.componentwise());
        if closest.uncertainty() < closer.uncertainty() {
            closest
        } else {
            closer
        }
    }

    /// Whether [`PlaneOrder::uncertainty`] is at most [`ACCURATE`].
    fn is_accurate(&self) -> bool {
        self.error <= ACCURATE * self.function.reach()
    }

    /// The error as a share of the greatest |F| in the packet.
    fn uncertainty(&self) -> f64 {
        self.error / self.function.reach()
    }

    /// The order by the distances of the second triangle's corners from the plane, each with its error; and by its edge
    /// functions where those have no common sign.
    #[inline(always)]
    fn by_distances<'e>(
        distances: [(f64, f64); 3],
        edges: impl FnOnce() -> &'e BoundedEdges,
    ) -> Self {
        // Without branches: which corner decides differs from pair to pair.
        let are_all = |sign: f64| {
            let is = |(distance, error): (f64, f64)| distance * sign > error + LEAST_SURE;
            is(distances[0]) & is(distances[1]) & is(distances[2])
        };
        for sign in [1.0, -1.0] {
            if are_all(sign) {
                return Self::constant(sign);
            }
        }
        let Some(edges) = edges() else {
            return Self::UNKNOWN;
        };
        let (function, error) = weighted_sum(distances, edges);
        Self {
            function,
            error: error + SINGLE_PLACE_ERROR * function.slope() * 1.01,
            in_one_plane: false,
        }
    }

    /// Of eight rays that hit both triangles, as bits, those for which the first is surely nearer, and those for which
    /// the second is.
    pub(super) fn of_eight(&self, (x, y): (&[f32; LANES], &[f32; LANES])) -> [u32; 2] {
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

    /// [`PlaneOrder::of_eight`] for eight neighbours in a row of a lattice, the first of which is at this place.
    pub(super) fn of_row(&self, first: (f64, f64)) -> [u32; 2] {
        self.function.signs_in_row(first, self.error)
    }

    /// Which of the two is surely nearer for all rays of a box of places that hit both: `Less` for the first.
    pub(super) fn within(&self, places: &PlacesWithin) -> Option<Ordering> {
        let Linear { constant, x, y } = self.function;
        let PlacesWithin { centre, half } = *places;
        let value = constant + x * centre[0] + y * centre[1];
        // NaN fails this comparison.
        let is_sure = value.abs() - (x.abs() * half[0] + y.abs() * half[1]) > self.error;
        is_sure.then_some(match value > 0.0 {
            true => Ordering::Less,
            false => Ordering::Greater,
        })
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

/// Distances of the second triangle's corners from the plane of the first, each with its error: exactly zero for a
/// corner that both have, of which the bound would leave nothing sure where the hits are next to it.
#[inline(always)]
pub(super) fn unless_shared(
    [first, second]: [&[Vec3; 3]; 2],
    [p, q, r]: [(f64, f64); 3],
) -> [(f64, f64); 3] {
    let [a, b, c] = second;
    let of = |corner, distance| match first.contains(corner) {
        true => (0.0, 0.0),
        false => distance,
    };
    [of(a, p), of(b, q), of(c, r)]
}

/// F of distances, each with its error, and edge functions; and the bound on its error but for places' roundings.
#[inline(always)]
pub(super) fn weighted_sum(distances: [(f64, f64); 3], edges: &Edges) -> (Linear, f64) {
    let mut function = Linear::ZERO;
    let mut error = 0.0;
    for ((distance, distance_error), (edge, edge_error)) in distances.into_iter().zip(*edges) {
        function.constant += distance * edge.constant;
        function.x += distance * edge.x;
        function.y += distance * edge.y;
        let most = edge.reach();
        error += distance.abs() * (edge_error + 6.0 * EPSILON * most)
            + distance_error * (most + edge_error);
    }
    (function, error * 1.01 + LEAST_SURE)
}

/// Whether distances are known within [`ACCURATE`] of the greatest of them.
pub(super) fn are_accurate(distances: [(f64, f64); 3]) -> bool {
    let greatest = |of: fn((f64, f64)) -> f64| distances.into_iter().map(of).fold(0.0, f64::max);
    greatest(|(_, error)| error) <= ACCURATE * greatest(|(distance, _)| distance.abs())
}

/// Two triangles, and the edge functions of the second.
struct PairEdges<'p> {
    space: &'p PacketSpace,
    packet: u32,
    corners: [&'p [Vec3; 3]; 2],
    second: u32,
    known: &'p mut KnownEdges,
}

impl PairEdges<'_> {
    fn in_double(&mut self) -> &BoundedEdges {
        let Self { space, corners, .. } = self;
        let edges = || space.edges_in_double(*corners[1]);
        self.known.in_double.get(self.second, self.packet, edges)
    }

    fn componentwise(&mut self) -> &BoundedEdges {
        let Self { space, corners, .. } = self;
        let edges = || space.edges_componentwise(*corners[1]);
        self.known
            .componentwise
            .get(self.second, self.packet, edges)
    }
}

/// The edge functions of the triangle that was last ordered with others.
#[derive(Debug)]
struct KnownEdges {
    in_double: Cached<u32, BoundedEdges>,
    componentwise: Cached<u32, BoundedEdges>,
}

impl KnownEdges {
    const NONE: Self = {
        const NOTHING: Cached<u32, BoundedEdges> = Cached {
            of: MISS,
            packet: 0,
            known: None,
        };
        Self {
            in_double: NOTHING,
            componentwise: NOTHING,
        }
    };
}

/// The orders of pairs of triangles along the rays of a packet.
#[derive(Debug)]
pub(super) struct PlaneOrders {
    /// The packet's rays; `None` before the first packet.
    space: Option<PacketSpace>,
    /// Counts packets: what is cached along another packet's rays is of no use.
    packet: u32,
    /// By the low bits of the primitive index. Empty before the first use, since most pictures need none.
    planes: Vec<Cached<u32, TurnedPlane>>,
    edges: KnownEdges,
    /// By the low bits of a sum of both primitive indices.
    orders: Vec<Cached<[u32; 2], PlaneOrder>>,
}

/// What is known of a triangle, or of two, along the rays of a packet.
#[derive(Clone, Debug)]
struct Cached<K, V> {
    of: K,
    packet: u32,
    known: V,
}

impl<K: PartialEq, V> Cached<K, V> {
    /// What is known, or what `find` says.
    #[inline(always)]
    fn get(&mut self, of: K, packet: u32, find: impl FnOnce() -> V) -> &V {
        if self.of != of || self.packet != packet {
            self.known = find();
            self.of = of;
            self.packet = packet;
        }
        &self.known
    }
}

impl PlaneOrders {
    pub(super) fn new() -> Self {
        Self {
            space: None,
            packet: 0,
            planes: Vec::new(),
            edges: KnownEdges::NONE,
            orders: Vec::new(),
        }
    }

    /// Sets the rays that triangles are ordered along.
    pub(super) fn set_rays(&mut self, space: &PacketSpace) {
        self.space = Some(space.clone());
        self.packet = self.packet.wrapping_add(1);
    }

    /// Whether the order of two triangles is known.
    #[inline(always)]
    pub(super) fn knows(&self, pair: [u32; 2]) -> bool {
        let order = self.orders.get(entry(pair));
        order.is_some_and(|order| order.of == pair && order.packet == self.packet)
    }

    /// The order of two triangles, if it is known.
    #[inline(always)]
    pub(super) fn order(&self, pair: [u32; 2]) -> &PlaneOrder {
        match self.orders.get(entry(pair)) {
            Some(order) if self.knows(pair) => &order.known,
            _ => &PlaneOrder::UNKNOWN,
        }
    }

    /// Finds the order of two triangles. `is_first` says whether the first is hit first if the two lie in one plane.
    #[inline(always)]
    pub(super) fn find(&mut self, pair: [u32; 2], corners: [&[Vec3; 3]; 2], is_first: bool) {
        let Self {
            space: Some(space),
            packet,
            planes,
            edges,
            orders,
        } = self
        else {
            return;
        };
        if orders.is_empty() {
            let no_plane = Cached {
                of: MISS,
                packet: 0,
                known: None,
            };
            let no_order = Cached {
                of: [MISS; 2],
                packet: 0,
                known: PlaneOrder::UNKNOWN,
            };
            planes.resize(CACHED, no_plane);
            orders.resize(CACHED, no_order);
        }
        let [first, second] = pair;
        let plane = &mut planes[first as usize % CACHED];
        let plane = plane.get(first, *packet, || turned(space, *corners[0]));
        let mut edges = PairEdges {
            space,
            packet: *packet,
            corners,
            second,
            known: edges,
        };
        let order = &mut orders[entry(pair)];
        order.of = pair;
        order.packet = *packet;
        order.known.set(plane, &mut edges, is_first);
    }
}

/// The cache index of a pair. Multiplied, so that neighbours of two triangles that are neighbours have entries of their
/// own.
fn entry([first, second]: [u32; 2]) -> usize {
    first.wrapping_mul(5).wrapping_add(second) as usize % CACHED
}

#[cfg(test)]
mod tests;
