//! Where parallel rays start in the plane of a triangle, except for rounding: which of them start in front of it,
//! decided exactly, once for all triangles of the plane.
//!
//! Single precision leaves every ray of every such triangle undecided, and thousands of triangles may lie in one plane.
//! Most rays are decided in double precision, where their distance from the plane is a linear function of their place.
//!
//! # Error bound
//! ε = 2⁻⁵³. The first ray's distance is off by what it is for an origin that is off by the packet's error
//! ([`Plane::distance_of_origin`]), and a step's product with the normal by its own bound ([`Plane::along`]), up to
//! [`SIDE`] times. Two products and two sums round by 4ε of the sum of their magnitudes.

use super::params::{ROW, SIDE};
use super::ray_rect::RayRect;
use super::setup::{Linear, PacketSpace};
use crate::bvh::Accel;
use crate::camera::{Lattice, Projection};
use crate::hit::{Cull, MISS, Precision};
use crate::num::roundoff::EPSILON;
use crate::num::simd::LANES;
use crate::ray::{Ray, relative_origin, rounded_origin};
use crate::triangle::coplanar::Coplanar;
use crate::triangle::plane::{LEAST_SURE, Plane};
use glam::{DVec3, Vec3};

/// Planes in the cache, each some 400 bytes, allocated when the first is needed. Rays start in few planes at once; with
/// fewer, planes that alternate are decided again, with more, a triangle is compared with more planes for nothing.
const CACHED: usize = 8;

/// Distances in the cache, allocated when the first is needed: those of twice as many triangles as wait for
/// rasterisation at once.
const RECENT: usize = 2 * LANES;

/// Rows of eight rays in a packet.
const ROWS: usize = SIDE * SIDE / ROW;

/// Which rays of a packet start in front of a plane.
#[derive(Clone, Debug)]
struct PlaneStarts {
    /// A triangle of the plane.
    primitive: u32,
    /// The one that was last found to lie in it.
    last: u32,
    /// Turned to the side that rays go to; `None` where that is not sure.
    plane: Option<Plane>,
    /// The rays' distances from it.
    distance: BoundedDistance,
    /// For each eight rays, as bits, those that are decided.
    decided: [u8; ROWS],
    /// Those of them that start in front of the plane.
    in_front: [u8; ROWS],
}

/// The distances of a packet's rays from a plane, positive behind it, and the bound on their errors, which is infinite
/// where nothing is known.
type BoundedDistance = (Linear, f64);

/// Of eight rays from the packet's ray `first` on, as bits, those that surely start in front of a plane, and those that
/// surely start behind it.
fn in_front_or_behind((distance, error): &BoundedDistance, first: usize) -> [u32; 2] {
    let place = ((first % SIDE) as f64, (first / SIDE) as f64);
    let [behind, in_front] = distance.signs_in_row(place, *error);
    [in_front, behind]
}

/// The origins of a packet's parallel rays.
#[derive(Clone, Copy, Debug)]
struct RayOrigins {
    first: DVec3,
    /// The steps from ray to ray, along columns and rows.
    steps: [DVec3; 2],
    /// Bound on how far an origin is off, by coordinate; infinite where nothing is known.
    error: f64,
}

impl RayOrigins {
    const UNKNOWN: Self = Self {
        first: DVec3::ZERO,
        steps: [DVec3::ZERO; 2],
        error: f64::INFINITY,
    };

    fn of(space: &PacketSpace) -> Self {
        if space.perspective {
            return Self::UNKNOWN;
        }
        Self {
            first: space.origin,
            steps: space.rays.steps,
            error: space.origin_error,
        }
    }

    /// Their distances from a plane.
    fn distance_from(&self, plane: &Plane) -> BoundedDistance {
        let (constant, error) = plane.distance_of_origin(self.first, self.error);
        let [(x, error_x), (y, error_y)] = self.steps.map(|step| plane.along(step));
        let side = SIDE as f64;
        let sizes = constant.abs() + side * (x.abs() + y.abs());
        let error = error + side * (error_x + error_y) + 4.0 * EPSILON * sizes;
        (Linear { x, y, constant }, error * 1.01 + LEAST_SURE)
    }
}

/// The starts of a packet's rays, by plane.
#[derive(Debug)]
pub(super) struct RayStarts {
    /// The rays, where they are parallel. Boxed, since it is large and next to what every triangle needs.
    lattice: Option<Box<Lattice>>,
    /// The packet's first ray in it.
    first: (u32, u32),
    origins: RayOrigins,
    /// The reference of the packet's depth keys, and the bound on its error.
    reference: (Linear, f64),
    /// The rays' distances from the planes of triangles that they were computed for last, by the low bits of the
    /// primitive index, each with that index.
    recent: Vec<(u32, BoundedDistance)>,
    planes: Vec<PlaneStarts>,
    /// The plane that the next one replaces.
    oldest: usize,
}

impl RayStarts {
    pub(super) fn new(lattice: &Lattice) -> Self {
        let is_parallel = lattice.camera.projection() == Projection::Orthographic;
        Self {
            lattice: is_parallel.then(|| Box::new(*lattice)),
            first: (0, 0),
            origins: RayOrigins::UNKNOWN,
            reference: (Linear::ZERO, 0.0),
            recent: Vec::new(),
            planes: Vec::new(),
            oldest: 0,
        }
    }

    /// Begins a packet.
    pub(super) fn set_rays(&mut self, packet: &RayRect, space: &PacketSpace) {
        self.first = (packet.column, packet.row);
        self.origins = RayOrigins::of(space);
        self.reference = (space.reference, space.reference_error);
        self.recent.clear();
        self.planes.clear();
        self.oldest = 0;
    }

    /// The distances of the packet's rays from a triangle's plane.
    fn distances(
        &mut self,
        primitive: u32,
        corners: impl FnOnce() -> [Vec3; 3],
    ) -> BoundedDistance {
        const UNKNOWN: BoundedDistance = (Linear::ZERO, f64::INFINITY);
        let Some(lattice) = &self.lattice else {
            return UNKNOWN;
        };
        if self.recent.is_empty() {
            self.recent.resize(RECENT, (MISS, UNKNOWN));
        }
        let recent = &mut self.recent[primitive as usize % RECENT];
        if recent.0 != primitive {
            let plane = Plane::new(corners()).turned_along(lattice.camera.forward(), 0.0);
            let distances = plane.map(|plane| self.origins.distance_from(&plane));
            *recent = (primitive, distances.unwrap_or(UNKNOWN));
        }
        recent.1
    }

    /// Of eight rays from the packet's ray `first` on, as bits, those that surely start in front of a triangle's plane, and
    /// those that surely start behind it.
    pub(super) fn by_distance(
        &mut self,
        primitive: u32,
        first: usize,
        corners: impl FnOnce() -> [Vec3; 3],
    ) -> [u32; 2] {
        in_front_or_behind(&self.distances(primitive, corners), first)
    }

    /// Of eight rays from the packet's ray `first` on, as bits, those that surely start in front of a triangle whose
    /// depth keys are within these bounds, relative to the packet's reference, and those that surely start behind it. A
    /// ray starts at an absolute key of zero.
    pub(super) fn by_depth_keys(&self, first: usize, [low, high]: [&[f32; ROW]; 2]) -> [u32; 2] {
        let (Linear { constant, x, y }, error) = self.reference;
        let [mut in_front, mut behind] = [0; 2];
        for lane in 0..ROW {
            let (column, row) = ((first % SIDE + lane) as f64, (first / SIDE) as f64);
            let reference = constant + x * column + y * row;
            in_front |= u32::from(f64::from(high[lane]) + reference < -error) << lane;
            behind |= u32::from(f64::from(low[lane]) + reference > error) << lane;
        }
        [in_front, behind]
    }

    /// Whether all rays of the packet start in front of a triangle's plane, or all behind it; `None` where neither is sure.
    pub(super) fn all_in_front(
        &mut self,
        primitive: u32,
        corners: impl FnOnce() -> [Vec3; 3],
    ) -> Option<bool> {
        let (Linear { constant, x, y }, error) = self.distances(primitive, corners);
        let last = SIDE as f64 - 1.0;
        let nearest = constant + last * (x.min(0.0) + y.min(0.0));
        let furthest = constant + last * (x.max(0.0) + y.max(0.0));
        (furthest < -error || nearest > error).then_some(furthest < 0.0)
    }

    /// Of eight rays from the packet's ray `first` on, those of `rays`, as bits, that start in front of a triangle. All
    /// of `rays` must cross its plane inside it.
    pub(super) fn in_front(
        &mut self,
        accel: &Accel,
        coplanar: &mut Coplanar,
        primitive: u32,
        (first, rays): (usize, u32),
    ) -> u32 {
        let corners = |primitive: u32| accel.corners(primitive);
        let distance = self.distances(primitive, || corners(primitive));
        let Some(lattice) = &self.lattice else {
            return rays;
        };
        // A triangle's rows come one after another.
        let mut planes = self.planes.iter();
        let same = planes.position(|plane| plane.last == primitive);
        let known = same.or_else(|| {
            let mut planes = self.planes.iter();
            planes.position(|plane| coplanar.are(plane.primitive, primitive, corners))
        });
        let plane = known.unwrap_or_else(|| {
            let plane = PlaneStarts {
                primitive,
                last: primitive,
                plane: Plane::new(corners(primitive)).turned_along(lattice.camera.forward(), 0.0),
                distance,
                decided: [0; ROWS],
                in_front: [0; ROWS],
            };
            let at = self.oldest;
            match self.planes.get_mut(at) {
                Some(replaced) => *replaced = plane,
                None => self.planes.push(plane),
            }
            self.oldest = (at + 1) % CACHED;
            at
        });
        let plane = &mut self.planes[plane];
        plane.last = primitive;
        let [in_front, behind] = in_front_or_behind(&plane.distance, first);
        let undecided = rays & !(in_front | behind | eight(&plane.decided, first));
        for lane in (0..ROW).filter(|lane| undecided >> lane & 1 != 0) {
            let ray = first + lane;
            let (byte, bit) = (ray / ROW % ROWS, 1 << (ray % ROW));
            plane.decided[byte] |= bit;
            let (column, row) = ((ray % SIDE) as u32, (ray / SIDE) as u32);
            let ray = lattice.ray(self.first.0 + column, self.first.1 + row);
            let sure = plane
                .plane
                .and_then(|plane| starts_before(&plane, &ray, accel.origin));
            let is_in_front = sure.unwrap_or_else(|| {
                let ray = accel.prepare(&ray, Cull::None, Precision::Exact);
                ray.is_some_and(|ray| !ray.hit_on(primitive, corners(primitive)).is_miss())
            });
            if is_in_front {
                plane.in_front[byte] |= bit;
            }
        }
        rays & (in_front | eight(&plane.in_front, first) & !behind)
    }
}

/// Whether a ray that goes to the side that a plane's normal points to starts on the other side of it; `None` where
/// that is not sure in double precision.
fn starts_before(plane: &Plane, ray: &Ray, tree_origin: DVec3) -> Option<bool> {
    let is_before = |(origin, error)| {
        let (distance, error) = plane.distance_of_origin(origin, error);
        (distance.abs() > error + LEAST_SURE).then_some(distance < 0.0)
    };
    // Whether the difference is exact is of use next to the plane alone.
    is_before(rounded_origin(ray.origin, tree_origin))
        .or_else(|| is_before(relative_origin(ray.origin, tree_origin)))
}

/// The bits of eight rays from any one on.
fn eight(bits: &[u8; ROWS], first: usize) -> u32 {
    let byte = |at: usize| u32::from(bits[at % ROWS]);
    (byte(first / ROW) | byte(first / ROW + 1) << ROW) >> (first % ROW) & 0xff
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, ImagePlane, Pose};
    use crate::packet::around_tests::accel;
    use crate::random::Random;

    /// A camera with 70 × 40 parallel rays that starts in the plane z = 2x − 3y and looks along its normal, and
    /// triangles of this plane: around all rays, or with random corners.
    fn rays_in_a_plane(extra: usize) -> (Lattice, Vec<[DVec3; 3]>) {
        let mut random = Random(94);
        let pose = Pose {
            eye: DVec3::new(0.5, 0.5, -0.5),
            target: DVec3::new(2.5, -2.5, -1.5),
            up: DVec3::Y,
        };
        let plane = ImagePlane::new(70, 40, 0.25).expect("a good plane");
        let lattice = Camera::new(pose, Projection::Orthographic, plane)
            .whole()
            .lattice();
        let in_plane = |x: f64, y: f64| DVec3::new(x, y, 2.0 * x - 3.0 * y);
        let large = [
            in_plane(-200.0, -200.0),
            in_plane(200.0, -200.0),
            in_plane(0.0, 300.0),
        ];
        let mut whole = || (random.signed() * 8.0).round();
        let mut corner = || in_plane(whole(), whole());
        let triangles = (0..extra).map(|_| [corner(), corner(), corner()]);
        let triangles = std::iter::once(large).chain(triangles).collect();
        (lattice, triangles)
    }

    /// Ten parallel planes, so that they evict one another: only in the first do rays start on either side. The truth
    /// is brute force. With the error of distances at zero this fails.
    #[test]
    fn rays_that_start_in_front_of_planes_are_distinguished() {
        let (lattice, triangles) = rays_in_a_plane(0);
        let moved = |k: usize| triangles[0].map(|corner| corner + DVec3::Z * (k as f64 / 64.0));
        let planes = (0..CACHED + 2).map(|k| match k % 2 {
            0 => moved(k),
            _ => moved(0).map(|corner| corner - DVec3::Z * (k as f64 / 64.0)),
        });
        let planes: Vec<[DVec3; 3]> = planes.collect();
        let alone: Vec<Accel> = planes.iter().map(|&corners| accel(vec![corners])).collect();
        let all = accel(planes);
        let (mut starts, mut coplanar) = (RayStarts::new(&lattice), Coplanar::new(all.len()));
        let (mut both, mut sure, mut random) = ([0; 2], 0, Random(95));
        for (column, row) in [(0, 0), (32, 0), (32, 8)] {
            let packet = RayRect {
                column,
                row,
                columns: 32,
                rows: 32,
            };
            let space = PacketSpace::new(
                &lattice.camera,
                lattice.camera.pose().eye,
                0.0,
                lattice.place(column, row),
                1.0,
                (32, 32),
                Cull::None,
            );
            starts.set_rays(&packet, &space);
            for _ in 0..2000 {
                let primitive = (random.unit() * 10.0) as u32;
                let alone = &alone[all.id(primitive) as usize];
                // Eight rays from any column on.
                let first =
                    (random.unit() * 31.0) as usize * SIDE + (random.unit() * 25.0) as usize;
                let asked = (random.unit() * 256.0) as u32;
                let found = starts.in_front(&all, &mut coplanar, primitive, (first, asked));
                let all_in_front = starts.all_in_front(primitive, || all.corners(primitive));
                assert_eq!(all_in_front.is_none(), all.id(primitive) == 0);
                let corners = || all.corners(primitive);
                let [in_front, behind] = starts.by_distance(primitive, first, corners);
                assert_eq!(found & behind, 0);
                assert_eq!(found & in_front, asked & in_front);
                sure += ((in_front | behind) & asked).count_ones();
                for lane in (0..ROW).filter(|lane| asked >> lane & 1 != 0) {
                    let ray = first + lane;
                    let at = (column + (ray % SIDE) as u32, row + (ray / SIDE) as u32);
                    let truth = alone.cast_brute_force(&lattice.ray(at.0, at.1), Cull::None);
                    assert_eq!(
                        found >> lane & 1 != 0,
                        truth.is_some(),
                        "{at:?} {primitive}"
                    );
                    assert_eq!(all_in_front.unwrap_or(truth.is_some()), truth.is_some());
                    if all.id(primitive) == 0 {
                        both[usize::from(truth.is_some())] += 1;
                    }
                }
                assert_eq!(found & !asked, 0);
            }
        }
        assert!(both[0] > 1000 && both[1] > 1000, "{both:?}");
        assert!(sure > 10_000, "{sure}");
    }

    /// Of hundreds of triangles that the rays start in except for rounding, the packets find what single rays do, and
    /// few rays are left to those.
    #[test]
    fn rays_that_start_in_many_triangles_find_the_nearest() {
        let (lattice, triangles) = rays_in_a_plane(600);
        let accel = accel(triangles);
        let mut primitives = Vec::new();
        let counts = accel.find_closest(&lattice, Cull::None, Precision::Exact, &mut primitives);
        let mut found = 0;
        for (at, &primitive) in primitives.iter().enumerate() {
            let ray = lattice.ray(at as u32 % lattice.columns, at as u32 / lattice.columns);
            let truth = accel.cast_primitive(&ray, Cull::None, Precision::Exact);
            assert_eq!(primitive, truth.primitive, "{at}");
            found += usize::from(primitive != MISS);
        }
        assert!(found > 500 && found < lattice.len() - 500, "{found}");
        assert!(counts.double_rays + counts.exact_rays < 500, "{counts:?}");
    }
}
