//! Triangles projected into packets of panoramas, at rays that their edges and corners lie on, against exact arithmetic.

use super::place_box::PlaceBox;
use super::ray_bounds::CornerProjector;
use super::setup_tests::{camera, lanes_of, space};
use super::triangles_at_places::{SmallTriangle, TrianglesAtPlaces};
use crate::camera::{Camera, ImagePlane, Pose, Projection};
use crate::hit::Cull;
use crate::math;
use crate::num::simd::{LANES, Plain};
use crate::random::Random;
use crate::triangle::exact::{self, OffsetTriangle};
use glam::{DVec3, Vec3};

const AROUND: PlaceBox = PlaceBox {
    left: 0.0,
    right: 31.0,
    top: 0.0,
    bottom: 31.0,
};

/// Counts of what was compared.
#[derive(Debug, Default)]
struct Tally {
    hits: usize,
    culled: usize,
    inside: usize,
    outside: usize,
    coarse: usize,
}

/// A triangle, and the place of a ray that it is checked at.
type Aimed = ([Vec3; 3], [f64; 2]);

/// A triangle of about this `size`, some five units away, with an edge through a ray or a corner on it, except for
/// rounding, or next to it. Some are nearly edge-on. Corners are relative to `tree_origin`.
fn aimed(random: &mut Random, camera: &Camera, tree_origin: DVec3, size: f64) -> Aimed {
    let [x, y] = [(); 2].map(|()| random.unit() * 31.0);
    let ray = camera.ray(x + 0.5, y + 0.5);
    let aside = random.point() * (size * [0.0, 0.0, 0.3][(random.unit() * 3.0) as usize % 3]);
    let point = ray.at(4.0 + random.unit()) - tree_origin + aside;
    let along = random.point() * size;
    let (a, b) = (point + along, point - along * random.signed().max(0.0));
    let thickness = size * 0.1f64.powi((random.signed() * 7.0).max(0.0) as i32);
    let away = camera.forward() * (1.5 * size * random.signed());
    let c = a + (b - a) * random.unit() + away + random.point() * thickness;
    ([a, b, c].map(DVec3::as_vec3), [x, y])
}

/// Edge functions and depth key at a place, as packets compute them.
fn values(triangle: &SmallTriangle<'_>, [x, y]: [f32; 2]) -> ([f32; 3], f32) {
    let values = triangle.edges().map(|f| (f[0] + f[2] * y) + f[1] * x);
    let [base, by_third, by_first] = triangle.depth_key();
    (values, base + (values[2] * by_third + values[0] * by_first))
}

/// What triangles are projected into.
struct Packet {
    camera: Camera,
    projector: CornerProjector,
    tree_origin: DVec3,
    cull: Cull,
    /// How many columns and rows beside their places rays may be.
    ray_error: f64,
}

/// Projects eight triangles into a packet, and checks each at a ray beside its place.
fn check_eight(
    packet: &Packet,
    triangles: &[Aimed; LANES],
    random: &mut Random,
    tally: &mut Tally,
) {
    let Packet {
        camera,
        projector,
        tree_origin,
        cull,
        ray_error,
    } = packet;
    let corners = lanes_of(triangles.map(|(triangle, _)| triangle));
    let mut found = TrianglesAtPlaces::NONE;
    if !found.project(Plain, projector, &corners, LANES, &AROUND) {
        assert_eq!((found.bounds.seen, found.small), (0, 0));
        tally.coarse += 1;
        return;
    }
    for (l, &(corners, place)) in triangles.iter().enumerate() {
        let [i, j] = [(); 2].map(|()| ray_error * random.signed());
        let ray = camera.ray(place[0] + 0.5 + i, place[1] + 0.5 + j);
        let place = place.map(|at| at as f32);
        let triangle = OffsetTriangle {
            corners,
            origin: *tree_origin,
        };
        let truth = exact::hit(&ray, &triangle, *cull, 0);
        let key = truth.map(|hit| 1.0 / (hit.t * ray.direction.dot(camera.forward())));
        let case = format!("{camera:?}: {corners:?} at {place:?}");
        let bounds = found.bounds.of(l);
        let is_seen = found.bounds.seen >> l & 1 != 0
            && (bounds.left..=bounds.right).contains(&place[0])
            && (bounds.top..=bounds.bottom).contains(&place[1]);
        tally.culled += usize::from(!is_seen);
        if let Some(key) = key {
            tally.hits += 1;
            assert!(is_seen, "hit and culled: {case}");
            // The truth is rounded too.
            let nearest = f64::from(found.bounds.nearest[l]) * (1.0 + 1e-14);
            assert!(key <= nearest, "{key} beyond {nearest}: {case}");
        }
        if !is_seen || found.small >> l & 1 == 0 {
            continue;
        }
        let triangle = found.small(l);
        let (values, near) = values(&triangle, place);
        let least = values.into_iter().fold(f32::INFINITY, f32::min);
        if least > triangle.edge_error() {
            assert!(truth.is_some(), "inside and missed: {case}");
            tally.inside += 1;
        }
        if least < -triangle.edge_error() {
            assert!(truth.is_none(), "outside and hit: {case}");
            tally.outside += 1;
        }
        if let Some(key) = key {
            let off = (f64::from(near) - key).abs() - 1e-14 * key;
            let bound = f64::from(triangle.depth_key_error());
            assert!(off <= bound, "{near} off by {off} of {bound}: {case}");
        }
    }
}

/// `depth` is what the projector assumes of the scene.
fn check(pitch: f64, tree_origin: DVec3, depth: f32, tally: &mut Tally) {
    let mut random = Random(61);
    for round in 0..1500 {
        let camera = camera(&mut random, tree_origin, Projection::Perspective, pitch);
        let cull = [Cull::None, Cull::Back][round % 2];
        let packet = Packet {
            camera,
            projector: CornerProjector::new(&space(&camera, tree_origin, cull), depth),
            tree_origin,
            cull,
            ray_error: 0.0,
        };
        let triangles: [Aimed; LANES] = std::array::from_fn(|_| {
            let size = pitch * [0.2, 1.0, 2.0, 12.0][(random.unit() * 4.0) as usize];
            aimed(&mut random, &camera, tree_origin, size)
        });
        check_eight(&packet, &triangles, &mut random, tally);
    }
}

#[test]
fn triangles_at_places_keep_the_rays_that_hit_them() {
    let far = DVec3::new(148_376.0, 1234.5, -223_423.25);
    let mut tally = Tally::default();
    for depth in [5.0, 1.0, 1e4] {
        for pitch in [1e-1, 1e-3, 1e-5, 1e-7, 1e-9] {
            check(pitch, DVec3::ZERO, depth, &mut tally);
        }
    }
    for pitch in [1e-3, 1e-7, 1e-8] {
        check(pitch, far, 5.0, &mut tally);
    }
    assert!(tally.hits > 5000 && tally.culled > 5000, "{tally:?}");
    assert!(tally.inside > 100 && tally.outside > 100, "{tally:?}");
}

/// Rays beside their places by as much as they may be.
#[test]
fn rays_beside_their_places_are_within_the_bounds_of_triangles_at_places() {
    let mut random = Random(62);
    let mut tally = Tally::default();
    for _ in 0..3000 {
        let camera = camera(&mut random, DVec3::ZERO, Projection::Perspective, 1e-3);
        let mut space = space(&camera, DVec3::ZERO, Cull::None);
        space.ray_error = 0.02;
        let triangles: [Aimed; LANES] =
            std::array::from_fn(|_| aimed(&mut random, &camera, DVec3::ZERO, 2e-3));
        let packet = Packet {
            camera,
            projector: CornerProjector::new(&space, 5.0),
            tree_origin: DVec3::ZERO,
            cull: Cull::None,
            ray_error: space.ray_error,
        };
        check_eight(&packet, &triangles, &mut random, &mut tally);
    }
    assert!(tally.hits > 2000, "{tally:?}");
}

/// Triangles at the far end of a wide packet, and much nearer than the projector's depth, where a place is off by many times
/// what depths are.
#[test]
fn nearby_triangles_of_a_wide_packet_keep_the_rays_that_hit_them() {
    let mut random = Random(63);
    let mut tally = Tally::default();
    for _ in 0..10_000 {
        let eye = random.point();
        let plane = ImagePlane::new(32, 32, 1.5 / 31.0).expect("a good plane");
        let pose = Pose::towards(eye, eye + random.point().normalize());
        let camera = Camera::new(pose, Projection::Perspective, plane);
        let space = space(&camera, DVec3::ZERO, Cull::None);
        let near = math::pow(10.0, -2.0 + 2.0 * random.unit());
        let depth = (near * (3.0 + 600.0 * random.unit())) as f32;
        let packet = Packet {
            camera,
            projector: CornerProjector::new(&space, depth),
            tree_origin: DVec3::ZERO,
            cull: Cull::None,
            ray_error: 0.0,
        };
        let triangles = std::array::from_fn(|_| {
            let [x, y] = [(); 2].map(|()| 20.0 + random.unit() * 11.0);
            let point = camera.ray(x + 0.5, y + 0.5).at(near);
            let size = near * [0.02, 0.1, 1.0][(random.unit() * 3.0) as usize];
            let mut aside = || point + random.point() * size;
            ([point, aside(), aside()].map(DVec3::as_vec3), [x, y])
        });
        check_eight(&packet, &triangles, &mut random, &mut tally);
    }
    assert!(tally.hits > 1000, "{tally:?}");
}
