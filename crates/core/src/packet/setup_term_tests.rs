//! The terms of the bounds of set-up, each on triangles where no other term covers it. The truth is integer
//! arithmetic on the rays as they are.

use super::componentwise_setup::ComponentwiseSetup;
use super::params::SIDE;
use super::ray_box::RayBox;
use super::setup::PacketSpace;
use super::setup_tests::{Tally, camera, check_aside, check_one, lanes_of, space};
use crate::camera::{Camera, ImagePlane, Pose, Projection};
use crate::hit::Cull;
use crate::num::double_double::DoubleDouble;
use crate::num::roundoff::EPSILON;
use crate::num::simd::{LANES, Plain, Work};
use crate::random::Random;
use crate::triangle::exact::OffsetTriangle;
use glam::{DVec3, Vec3};

const ALL: RayBox = RayBox {
    left: 0,
    right: SIDE as i32 - 1,
    top: 0,
    bottom: SIDE as i32 - 1,
};

/// 10 to a random power between two.
fn camera_at(eye: DVec3, target: DVec3, projection: Projection, pitch: f64) -> Camera {
    let plane = ImagePlane::new(32, 32, pitch).expect("a good plane");
    let up = DVec3::new(0.3, 1.0, 0.1);
    Camera::new(Pose { eye, target, up }, projection, plane)
}

/// Parallel rays start within a few roundings of a triangle's plane, far from the point that its corners are relative
/// to: the error of a depth is as large as the depth. With the error of the depth key's numerator at zero this fails,
/// with either set-up.
#[test]
fn depth_keys_next_to_the_image_plane_are_within_their_bounds() {
    let mut random = Random(86);
    let mut tally = Tally::default();
    let tree_origin = DVec3::new(1e-9, 2e-9, -1e-9);
    for _ in 0..2000 {
        let middle = DVec3::new(3e7, 2e7, -3e7);
        let corners = [(); 3].map(|()| (middle + random.point() * 1000.0).as_vec3());
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let inside = a + ((b - a) * random.unit() + (c - a) * random.unit()) * 0.5;
        let way = (b - a).cross(c - a).normalize() + random.point() * 0.3;
        let eye = tree_origin + inside + way * (random.decades(-9.0, -6.0) * random.signed());
        let pitch = random.decades(-11.0, -7.0);
        let camera = camera_at(eye, eye - way * 5.0, Projection::Orthographic, pitch);
        check_one(&mut random, &camera, tree_origin, corners, &mut tally);
    }
    assert!(tally.hits > 1000, "{tally:?}");
}

/// Checks a triangle, set up with bounds by the greatest coordinate or componentwise, at the packet's rays (i, i).
fn check_diagonal(
    space: &PacketSpace,
    camera: &Camera,
    corners: [Vec3; 3],
    by_component: bool,
    tally: &mut Tally,
) {
    let lanes = lanes_of([corners; LANES]);
    let mut set_up = space.set_up(&lanes, &[ALL; LANES]);
    if by_component {
        let mut one_by_one = corners[0].x < 0.0;
        let work = ComponentwiseSetup {
            space,
            corners: &lanes,
            which: 1,
            out: &mut set_up,
            one_by_one: &mut one_by_one,
        };
        work.run(Plain);
    }
    let triangle = OffsetTriangle {
        corners,
        origin: DVec3::ZERO,
    };
    let rays = (0..SIDE).map(|at| (at, at));
    let aside = (0.0, 0.0);
    check_aside(
        (&set_up, 0),
        camera,
        aside,
        Cull::None,
        &triangle,
        rays,
        tally,
    );
}

/// Planes that are perpendicular to parallel rays but for slopes of 10⁻²⁸, and rays 10⁻¹² apart: a step changes depth
/// keys by a subnormal number of single precision. With negligible terms stored as they are this fails.
#[test]
fn terms_that_single_precision_has_no_digits_for_are_zero() {
    let mut random = Random(92);
    let (mut tally, mut subnormal) = (Tally::default(), 0);
    for _ in 0..200 {
        let corners = [(-2.0, -1.0), (2.0, -1.0), (0.0, 2.0)].map(|(x, y)| {
            let place = DVec3::new(x, y, 0.0) + random.point() * 0.5;
            place.with_z(place.z * 1e-28).as_vec3()
        });
        let eye = DVec3::Z * random.decades(-17.0, -15.0);
        let camera = camera_at(eye, DVec3::ZERO, Projection::Orthographic, 1e-12);
        let space = space(&camera, DVec3::ZERO, Cull::None);
        for by_component in [false, true] {
            check_diagonal(&space, &camera, corners, by_component, &mut tally);
        }
        let (key, _) = (space.depth_key_in_double(corners)).expect("a side that is seen");
        subnormal += usize::from((key.x as f32).is_subnormal());
        let set_up = space.set_up(&lanes_of([corners; LANES]), &[ALL; LANES]);
        let mut terms = (set_up.edges.as_flattened().iter()).chain(&set_up.depth_key);
        assert!(
            terms.all(|of_eight| !of_eight[0].is_subnormal()),
            "{set_up:?}"
        );
    }
    assert!(
        subnormal > 150 && tally.hits > 10_000,
        "{subnormal} {tally:?}"
    );
}

/// A vector of few bits, perpendicular to z: single precision represents its multiples, so that points lie exactly on
/// a line.
fn line(random: &mut Random) -> DVec3 {
    let [x, y] = [(); 2].map(|()| 1.0 + (random.unit() * 30.0).floor());
    DVec3::new(x, y, 0.0)
}

/// Two corners are far away at the packet's first ray and one is close to the eye, which is off, at its last: there
/// the error of the close corner is as large as the length of the edge to a far one, in the packet's last row. With
/// h·W in E at zero this fails.
#[test]
fn edges_to_corners_of_very_different_depths_are_decided_only_where_it_is_sure() {
    let mut random = Random(87);
    let mut tally = Tally::default();
    for _ in 0..4000 {
        let forward = random.point().normalize();
        let right = forward.cross(random.point()).normalize();
        let up = right.cross(forward);
        let column = 1e-3;
        let ratio = random.decades(2.5, 3.3);
        let diagonal = right - up;
        // Rays start at the origin. The first one runs along the far corners.
        let far = forward * ratio;
        let beside = right * (column * ratio * (0.02 + 0.05 * random.unit()));
        let corners = [forward + diagonal * (31.0 * column), far, far + beside];
        let sight = forward + diagonal * ((15.5 + 3e-3 * random.signed()) * column);
        let step = column * sight.dot(forward);
        let plane = ImagePlane::new(32, 32, step).expect("a good plane");
        let pose = Pose {
            eye: DVec3::ZERO,
            target: sight,
            up,
        };
        let camera = Camera::new(pose, Projection::Perspective, plane);
        let off = column * random.decades(-4.0, -2.5);
        let eye = (right + up + forward * random.signed()) * (off * 0.5 * random.signed());
        let packet = (SIDE as u32, SIDE as u32);
        let space = PacketSpace::new(&camera, eye, off, (0.5, 0.5), 1.0, packet, Cull::None);
        let corners = corners.map(DVec3::as_vec3);
        check_diagonal(&space, &camera, corners, false, &mut tally);
    }
    assert!(tally.hits > 1000, "{tally:?}");
}

/// Slivers perpendicular to parallel rays, with a corner at the packet's first ray: depths are tiny, and their error
/// is that of the normal. With its error along the packet at zero this fails.
#[test]
fn depth_keys_of_slivers_square_to_the_rays_are_within_their_bounds() {
    let mut random = Random(95);
    let mut tally = Tally::default();
    for _ in 0..5000 {
        let line = line(&mut random);
        let length = line.length();
        let aside = DVec3::new(-line.y, line.x, 0.0);
        let long = (200.0 + 800.0 * random.unit()).round();
        let other = (long * (0.5 + 0.4 * random.unit())).round();
        let thin = random.decades(-6.0, -1.0);
        let at =
            |along: f64, turn: f64| -(aside * along + DVec3::Z * (length * along * (1.0 + turn)));
        // Differences from the first corner have more bits than single precision.
        let first = DVec3::Z * (length * 1e-7 * random.signed());
        let corners = [first, at(long, thin), at(other, -thin * random.unit())];
        let step = long * length / 64.0;
        let forward = line.normalize();
        let right = forward.cross(DVec3::Z);
        let eye = (right - DVec3::Z) * (15.5 * step);
        let plane = ImagePlane::new(32, 32, step).expect("a good plane");
        let pose = Pose {
            eye,
            target: eye + line,
            up: DVec3::Z,
        };
        let camera = Camera::new(pose, Projection::Orthographic, plane);
        let space = space(&camera, DVec3::ZERO, Cull::None);
        let corners = corners.map(DVec3::as_vec3);
        check_diagonal(&space, &camera, corners, true, &mut tally);
    }
    assert!(tally.hits > 1000, "{tally:?}");
}

/// The eye is close to one corner of a triangle and nearly in its plane, so that keys far away are small. With the
/// componentwise error of their numerator at zero this fails.
#[test]
fn depth_keys_of_planes_along_the_rays_are_within_their_bounds() {
    let mut random = Random(88);
    let mut tally = Tally::default();
    for _ in 0..3000 {
        let beside = random.decades(-14.0, -8.0);
        let eye = random.point() * beside;
        let a = random.point() * beside;
        let [b, c] = [(); 2].map(|()| random.point());
        let target = a + ((b - a) * random.unit() + (c - a) * random.unit()) * 0.5;
        let pitch = random.decades(-17.0, -10.0);
        let camera = camera_at(eye, target, Projection::Perspective, pitch);
        let corners = [a, b, c].map(DVec3::as_vec3);
        check_one(&mut random, &camera, DVec3::ZERO, corners, &mut tally);
    }
    assert!(tally.hits > 1000, "{tally:?}");
}

/// Deep triangles, nearly edge-on to parallel rays that are close together. With the componentwise error of the depth
/// key's denominator at zero this fails.
#[test]
fn depth_keys_along_parallel_rays_are_within_their_bounds() {
    let mut random = Random(89);
    let mut tally = Tally::default();
    for _ in 0..6000 {
        let line = line(&mut random);
        let wide = random.decades(-12.0, -3.0);
        let mut at = |along: f64| {
            let along = line * (random.unit() * along).round();
            (along + DVec3::Z * (wide * random.signed())).as_vec3()
        };
        let corners = [at(0.0), at(1000.0), at(1000.0)];
        // Rays start close to the first corner, and run almost along the others.
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let inside = (a + b + c) / 3.0;
        let off_edge = DVec3::new(-line.y, line.x, 0.0) * random.decades(-14.0, -6.0);
        let way = line + off_edge;
        let eye = inside - way * (inside.dot(line) / line.length_squared());
        let pitch = wide * random.decades(-16.0, -3.0);
        let camera = camera_at(eye, eye + way, Projection::Orthographic, pitch);
        check_one(&mut random, &camera, DVec3::ZERO, corners, &mut tally);
    }
    assert!(tally.hits > 1000, "{tally:?}");
}

/// All coordinates are so small that single precision has few bits for them, or none. Without the terms for underflow
/// this fails, with either set-up.
#[test]
fn depth_keys_that_underflow_are_within_their_bounds() {
    let mut random = Random(90);
    let mut tally = Tally::default();
    for _ in 0..2000 {
        let size = random.decades(-44.0, -38.0);
        let corners = [(); 3].map(|()| (random.point() * (size * 10.0)).as_vec3());
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let inside = a + ((b - a) * random.unit() + (c - a) * random.unit()) * 0.5;
        let way = random.point();
        let eye = inside - way * (size * random.unit());
        let camera = camera_at(eye, eye + way, Projection::Orthographic, size * 0.01);
        check_one(&mut random, &camera, DVec3::ZERO, corners, &mut tally);
    }
    assert!(tally.hits > 1000, "{tally:?}");
}

/// Rays beside their places by as much as they may be. With the rays' errors at zero in the edge functions, or in the
/// depth key, this fails.
#[test]
fn rays_beside_their_places_are_within_the_bounds() {
    let mut random = Random(91);
    let mut tally = Tally::default();
    for _ in 0..1000 {
        let pitch = random.decades(-4.0, -2.0);
        let camera = camera(&mut random, DVec3::ZERO, Projection::Perspective, pitch);
        let ray_error = random.decades(-3.0, -1.0);
        let mut space: PacketSpace = space(&camera, DVec3::ZERO, Cull::None);
        space.ray_error = ray_error;
        let aside = space.obliqueness * ray_error * pitch;
        space.rays.error = DVec3::splat(aside);
        let corners = [(); 3].map(|()| {
            let along = camera.forward() * (30.0 * pitch * random.signed());
            (along + random.point() * (20.0 * pitch)).as_vec3()
        });
        let lanes = lanes_of([corners; LANES]);
        let triangle = OffsetTriangle {
            corners,
            origin: DVec3::ZERO,
        };
        let mut set_up = space.set_up(&lanes, &[ALL; LANES]);
        for by_component in [false, true] {
            if by_component {
                let mut one_by_one = corners[0].x < 0.0;
                let work = ComponentwiseSetup {
                    space: &space,
                    corners: &lanes,
                    which: 1,
                    out: &mut set_up,
                    one_by_one: &mut one_by_one,
                };
                work.run(Plain);
            }
            for aside in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                let aside = (0.99 * ray_error * aside.0, 0.99 * ray_error * aside.1);
                let rays = (0..SIDE * SIDE).step_by(23);
                let rays = rays.map(|at| (at % SIDE, at / SIDE));
                check_aside(
                    (&set_up, 0),
                    &camera,
                    aside,
                    Cull::None,
                    &triangle,
                    rays,
                    &mut tally,
                );
            }
        }
    }
    assert!(tally.hits > 1000, "{tally:?}");
}

/// Components of directions, beside those that a packet has for them, of cameras along axes and of any. Where places
/// pass 2¹⁴ they are rounded anew, which moves rays in the middle of the picture: without the magnitudes of the places'
/// own coordinates this fails.
#[test]
fn components_of_directions_are_within_their_bounds() {
    let mut random = Random(92);
    let mut greatest = 0.0f64;
    for round in 0..3000 {
        let target = DVec3::Z * random.decades(-20.0, 3.0);
        let pose = Pose {
            eye: DVec3::ZERO,
            target: match round % 3 {
                0 => random.point(),
                _ => target,
            },
            up: DVec3::Y,
        };
        let side = [32, 1000, 1 << 15][round % 3];
        let plane = ImagePlane::new(side, side, random.decades(-9.0, -1.0)).expect("a good plane");
        let camera = Camera::new(pose, Projection::Perspective, plane);
        let mut place = || {
            let share = [random.unit(), 0.5][round % 2];
            (f64::from(side - 31) * share).floor() + random.unit()
        };
        let (x, y) = (place(), place());
        let stride = [1.0, 1.0, 3.0][round % 3];
        let last = (SIDE as u32, SIDE as u32);
        let space = PacketSpace::new(&camera, DVec3::ZERO, 0.0, (x, y), stride, last, Cull::None);
        let [i, j] = [(); 2].map(|()| (31.0 * random.unit()).floor());
        let direction = camera.direction(x + i * stride, y + j * stride);
        let [a, b] = space.rays.steps;
        for component in 0..3 {
            let of = |vector: DVec3, times: f64| {
                DoubleDouble::from(vector[component]) * DoubleDouble::from(times)
            };
            let on_plane = of(space.rays.direction, 1.0) + of(a, i) + of(b, j);
            let off = (on_plane - of(direction, 1.0)).high.abs();
            // Besides these roundings it bounds that to unit length, three of a product, and two of closer factors.
            let rest = 6.0 * EPSILON * direction[component].abs();
            let bound = space.rays.error[component] - rest;
            assert!(off <= bound, "{component}: {off:e} {bound:e}");
            greatest = greatest.max(off / bound);
        }
    }
    assert!(greatest > 0.1, "{greatest}");
}
