//! Projected triangles at rays that their edges and corners lie on, against exact arithmetic: bounds leave out no ray
//! that hits, and decided coverage is right.

use super::params::SIDE;
use super::ray_bounds::{CornerProjector, ProjectedTriangles};
use super::setup::PacketSpace;
use super::setup_tests::{camera, lanes_of, space, triangle_at_ray};
use crate::camera::{Camera, ImagePlane, Pose, Projection};
use crate::hit::Cull;
use crate::math;
use crate::num::simd::{LANES, Plain};
use crate::random::Random;
use crate::ray::Ray;
use crate::triangle::exact::{self, OffsetTriangle};
use glam::{DVec3, Vec3};

/// Counts of what was compared.
#[derive(Debug, Default)]
struct Tally {
    hits: usize,
    culled: usize,
    small: usize,
}

/// `depth` is what the projector assumes of the scene; triangles are some 5 units away.
fn check(projection: Projection, pitch: f64, tree_origin: DVec3, depth: f32, tally: &mut Tally) {
    let mut random = Random(57);
    for round in 0..1500 {
        let camera = camera(&mut random, tree_origin, projection, pitch);
        let cull = [Cull::None, Cull::Back][round % 2];
        let projector = CornerProjector::new(&space(&camera, tree_origin, cull), depth);
        let triangles: [([Vec3; 3], (usize, usize)); LANES] = std::array::from_fn(|_| {
            let size = pitch * [0.2, 1.0, 2.0, 12.0][(random.unit() * 4.0) as usize];
            triangle_at_ray(&mut random, &camera, tree_origin, size)
        });
        check_eight(
            &projector,
            (&camera, 0),
            tree_origin,
            cull,
            &triangles,
            tally,
        );
    }
}

/// Projects eight triangles, and checks each at a ray of the packet that begins so many pixels right of and below a
/// camera's first.
fn check_eight(
    projector: &CornerProjector,
    (camera, first): (&Camera, u32),
    tree_origin: DVec3,
    cull: Cull,
    triangles: &[([Vec3; 3], (usize, usize)); LANES],
    tally: &mut Tally,
) {
    let projection = camera.projection();
    let corners = lanes_of(triangles.map(|(triangle, _)| triangle));
    let mut projected = ProjectedTriangles::NONE;
    projector.project(Plain, &corners, LANES, &mut projected);
    let begin = f64::from(first) + 0.5;
    for (l, &(corners, (x, y))) in triangles.iter().enumerate() {
        let ray = Ray {
            // Where orthographic rays start is tested elsewhere.
            t_min: match projection {
                Projection::Perspective | Projection::Panoramic(_) => 0.0,
                Projection::Orthographic => -1e9,
            },
            ..camera.ray(x as f64 + begin, y as f64 + begin)
        };
        let triangle = OffsetTriangle {
            corners,
            origin: tree_origin,
        };
        let truth = exact::hit(&ray, &triangle, cull, 0);
        let key = truth.map(|hit| {
            let depth = hit.t * ray.direction.dot(camera.forward());
            match projection {
                Projection::Perspective | Projection::Panoramic(_) => 1.0 / depth,
                Projection::Orthographic => -depth,
            }
        });
        let case = format!("{camera:?}: {corners:?} at ({x}, {y})");
        let rays = projected.rays(l);
        let (i, j) = (x as i32 - rays.left, y as i32 - rays.top);
        let is_seen = projected.seen >> l & 1 != 0
            && (0..=rays.right - rays.left).contains(&i)
            && (0..=rays.bottom - rays.top).contains(&j);
        tally.culled += usize::from(!is_seen);
        if let Some(key) = key {
            tally.hits += 1;
            assert!(is_seen, "hit and culled: {case}");
            // The truth is rounded too.
            let nearest = f64::from(projected.nearest[l]) + 1e-14 * key.abs();
            assert!(key <= nearest, "{key} beyond {nearest}: {case}");
        }
        if !is_seen || projected.small >> l & 1 == 0 {
            continue;
        }
        let coverage = &projected.coverage;
        let is_it = |at: &u32| coverage.ray(l, *at).0 == [i as usize, j as usize];
        let at = (0..25).find(is_it).expect("small bounds hold 25 rays");
        let holds = |rays: u32| rays >> at & 1 != 0;
        tally.small += 1;
        if holds(coverage.inside(l)) {
            assert!(truth.is_some(), "inside and missed: {case}");
        }
        if !holds(coverage.perhaps(l)) {
            assert!(truth.is_none(), "outside and hit: {case}");
        }
        if let Some(key) = key {
            let (_, [low, high]) = coverage.ray(l, at);
            let slack = 1e-14 * key.abs();
            let within = f64::from(low) - slack..=f64::from(high) + slack;
            assert!(within.contains(&key), "{key} not in {within:?}: {case}");
        }
    }
}

/// A picture so wide that a column is at least half as wide as its distance, and triangles much nearer than the
/// projector's depth: at the packet's far end a place is off by many times what depths are. With e_z at zero in the
/// bounds' margin this fails.
#[test]
fn nearby_triangles_at_the_rim_of_a_wide_picture_keep_the_rays_that_hit_them() {
    let mut random = Random(58);
    let mut tally = Tally::default();
    for _ in 0..20_000 {
        let eye = random.point();
        let target = eye + random.point().normalize() * 5.0;
        let step = 5.0 * math::pow(10.0, -0.3 + random.unit());
        let plane = ImagePlane::new(64, 64, step).expect("a good plane");
        let pose = Pose::towards(eye, target);
        let camera = Camera::new(pose, Projection::Perspective, plane);
        let size = (SIDE as u32, SIDE as u32);
        let first = (32.5, 32.5);
        let space = PacketSpace::new(&camera, eye, 0.0, first, 1.0, size, Cull::None);
        let near = 0.01 * math::pow(10.0, random.unit());
        let projector =
            CornerProjector::new(&space, (near * (300.0 + 600.0 * random.unit())) as f32);
        let triangles = std::array::from_fn(|_| {
            let [x, y] = [(); 2].map(|()| 20 + (random.unit() * 12.0) as usize);
            let ray = camera.ray(x as f64 + 32.5, y as f64 + 32.5);
            let depth = ray.direction.dot(camera.forward());
            let point = ray.at(near / depth);
            // Beyond its corner on the ray, along both sides of the picture.
            let aside = |random: &mut Random| {
                let out = camera.right() * random.unit() - camera.up() * random.unit();
                out * (near * 20.0) + camera.forward() * (near * random.unit())
            };
            let corners = [
                point,
                point + aside(&mut random),
                point + aside(&mut random),
            ];
            (corners.map(DVec3::as_vec3), (x, y))
        });
        let packet = (&camera, 32);
        check_eight(
            &projector,
            packet,
            DVec3::ZERO,
            Cull::None,
            &triangles,
            &mut tally,
        );
    }
    assert!(tally.hits > 1000, "{tally:?}");
}

/// Triangles in front of the eye's plane by no more than rounding: none is culled as lying behind. Without e_z there
/// this fails.
#[test]
fn triangles_within_rounding_of_the_eyes_plane_are_not_behind() {
    let mut random = Random(59);
    let mut tally = Tally::default();
    for round in 0..20_000 {
        let projection = [Projection::Perspective, Projection::Orthographic][round % 2];
        let eye = random.point();
        let way = random.point().normalize();
        let plane = ImagePlane::new(32, 32, 0.2).expect("a good plane");
        let pose = Pose::towards(eye, eye + way);
        let camera = Camera::new(pose, projection, plane);
        let projector = CornerProjector::new(&space(&camera, DVec3::ZERO, Cull::None), 1.0);
        let triangles = std::array::from_fn(|_| {
            let [x, y] = [(); 2].map(|()| (random.unit() * 32.0) as usize);
            let ray = camera.ray(x as f64 + 0.5, y as f64 + 0.5);
            let point = match projection {
                Projection::Orthographic => ray.origin,
                _ => ray.at(1e-8),
            };
            let corners = [(); 3].map(|()| {
                let out = camera.right() * random.signed() + camera.up() * random.signed();
                point + out * 1e-3 + camera.forward() * (1e-7 * random.unit())
            });
            (corners.map(DVec3::as_vec3), (x, y))
        });
        let packet = (&camera, 0);
        check_eight(
            &projector,
            packet,
            DVec3::ZERO,
            Cull::None,
            &triangles,
            &mut tally,
        );
    }
    assert!(tally.hits > 1000, "{tally:?}");
}

/// Rays beside their places by as much as they may be. With their error at zero in the bounds' margin this fails.
#[test]
fn rays_beside_their_places_are_within_the_bounds() {
    let mut random = Random(60);
    let mut hits = 0;
    for _ in 0..2000 {
        let plane = ImagePlane::new(32, 32, 1e-3).expect("a good plane");
        let pose = Pose::towards(random.point().normalize() * 5.0, DVec3::ZERO);
        let camera = Camera::new(pose, Projection::Perspective, plane);
        let mut space = space(&camera, DVec3::ZERO, Cull::None);
        space.ray_error = 0.05;
        let mut aimed = || {
            let [x, y] = [(); 2].map(|()| (random.unit() * 32.0).floor());
            let [i, j] = [(); 2].map(|()| space.ray_error * random.signed());
            let ray = camera.ray(x + 0.5 + i, y + 0.5 + j);
            let hit = ray.at(5.0);
            let corners = [(); 3].map(|()| (hit + random.point() * 1e-4).as_vec3());
            (corners, ray, [x as i32, y as i32])
        };
        let triangles: [_; LANES] = std::array::from_fn(|_| aimed());
        let corners = lanes_of(triangles.map(|(corners, ..)| corners));
        let mut projected = ProjectedTriangles::NONE;
        CornerProjector::new(&space, 5.0).project(Plain, &corners, LANES, &mut projected);
        for (l, (corners, ray, [x, y])) in triangles.into_iter().enumerate() {
            let triangle = OffsetTriangle {
                corners,
                origin: DVec3::ZERO,
            };
            if exact::hit(&ray, &triangle, Cull::None, 0).is_none() {
                continue;
            }
            let rays = projected.rays(l);
            let (i, j) = (x - rays.left, y - rays.top);
            assert!(projected.seen >> l & 1 != 0, "{corners:?} {ray:?}");
            assert!((rays.left..=rays.right).contains(&x), "{corners:?} {ray:?}");
            assert!((rays.top..=rays.bottom).contains(&y), "{corners:?} {ray:?}");
            if projected.small >> l & 1 != 0 {
                let coverage = &projected.coverage;
                let is_it = |at: &u32| coverage.ray(l, *at).0 == [i as usize, j as usize];
                let at = (0..25).find(is_it).expect("small bounds hold 25 rays");
                let perhaps = coverage.perhaps(l) >> at & 1 != 0;
                assert!(perhaps, "outside and hit: {corners:?} {ray:?}");
            }
            hits += 1;
        }
    }
    assert!(hits > 1000, "{hits}");
}

#[test]
fn projected_triangles_keep_the_rays_that_hit_them() {
    let far = DVec3::new(148_376.0, 1234.5, -223_423.25);
    let mut tally = Tally::default();
    for projection in [Projection::Perspective, Projection::Orthographic] {
        for depth in [5.0, 1.0, 1e4] {
            for pitch in [1e-1, 1e-3, 1e-5, 1e-7, 1e-9] {
                check(projection, pitch, DVec3::ZERO, depth, &mut tally);
            }
        }
        for pitch in [1e-3, 1e-7, 1e-8] {
            check(projection, pitch, far, 5.0, &mut tally);
        }
    }
    let Tally {
        hits,
        culled,
        small,
    } = tally;
    assert!(
        hits > 90_000 && culled > 10_000 && small > 10_000,
        "{tally:?}"
    );
}
