//! Single rays where error bounds are tight: ties exactly at the traversal's limit, and boxes that are touched only
//! within the origin's error.

use super::slab::SlabRay;
use crate::bvh::Accel;
use crate::bvh::tree::{Box32, BoxPair};
use crate::hit::{Cull, Precision};
use crate::math;
use crate::random::Random;
use crate::ray::Ray;
use crate::scene::{Mesh, MeshData, Object, Scene};
use crate::triangle::PreparedRay;
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Hits at t = 0 leave no slack between the start of a box and the nearest hit: a box that starts there may still
/// contain a lower number.
#[test]
fn ties_at_t_zero_go_to_the_lowest_number() {
    let count = 60;
    let around = |step: u32| {
        let (sin, cos) = math::sin_cos(std::f64::consts::TAU * f64::from(step) / f64::from(count));
        DVec3::new(cos, sin, 0.0)
    };
    for first in 0..count {
        // A fan around the origin, each time with its first triangle in another direction.
        let mut positions = vec![DVec3::ZERO];
        positions.extend((0..=count).map(|step| around(step * 7 + first)));
        positions.extend((0..=count).map(|step| around(step * 7 + first + 1)));
        let triangles = (1..=count).map(|i| [0, i, i + count + 1]).collect();
        let mesh = Mesh::new(MeshData {
            positions,
            triangles,
            ..MeshData::default()
        });
        let scene = Scene {
            objects: vec![Object::new("fan", Arc::new(mesh))],
        };
        let accel = Accel::build(&scene).expect("a valid scene");
        for direction in [DVec3::NEG_Z, DVec3::new(0.3, 0.1, 1.0)] {
            let ray = Ray {
                t_min: -1.0,
                ..Ray::new(DVec3::ZERO, direction)
            };
            let hit = accel.cast(&ray, Cull::None);
            assert_eq!(hit.map(|hit| (hit.triangle, hit.t)), Some((0, 0.0)));
            assert_eq!(hit, accel.cast_brute_force(&ray, Cull::None));
            let from_there = Ray { t_min: 0.0, ..ray };
            assert_eq!(accel.cast(&from_there, Cull::None), None);
        }
    }
}

/// The origin relative to the tree's origin is rounded to double precision, a nanometre beside the truth. The ray crosses
/// that nanometre over a hundredth of a unit, and hits a box that is a single point there.
#[test]
fn boxes_touched_within_the_origins_error_are_entered() {
    let far = f64::from(1 << 25);
    let point = Vec3::new(far as f32, 0.01, 0.0);
    let slope = 1e-9 / f64::from(point.y);
    for sign in [1.0, -1.0] {
        let tree_origin = DVec3::X * (1e-9 * sign);
        let ray = Ray::new(DVec3::X * far, DVec3::new(slope * sign, 1.0, 0.0));
        let prepared = PreparedRay::new(&ray, tree_origin, Cull::None, Precision::Exact);
        let prepared = prepared.expect("a valid ray");
        assert_eq!(prepared.origin.x, far);
        let bounds = Box32 {
            min: point - 1.0,
            max: point + 1.0,
        };
        let slab = SlabRay::new(&prepared, prepared.ray.t_min, &bounds);
        let only = Box32 {
            min: point,
            max: point,
        };
        let entered = slab.enter(&BoxPair::of([only, only]), f32::INFINITY);
        assert!(entered[0].1 && entered[1].1, "{entered:?}");
    }
}

/// From far away distances are measured from a start close to the scene: of two boxes of 1e-12 at a distance of 5,
/// the one that is hit is entered and the other is not, whatever the range.
#[test]
fn of_far_tiny_boxes_only_those_that_are_hit_are_entered() {
    let size = 1e-12;
    let eye = DVec3::new(3.0, 2.0, 4.0);
    let bounds = Box32 {
        min: Vec3::splat(-8.0 * size as f32),
        max: Vec3::splat(8.0 * size as f32),
    };
    let target = DVec3::new(2.0, -3.0, 1.0) * size;
    for length in [1.0, 1e-6, 1e9] {
        let ray = Ray::new(eye, (target - eye) * length);
        let around = |center: DVec3| {
            let half = DVec3::splat(0.25 * size);
            Box32 {
                min: (center - half).as_vec3(),
                max: (center + half).as_vec3(),
            }
        };
        let aside = DVec3::new(-3.0, 3.0, 0.0) * size;
        let pair = BoxPair::of([around(target), around(target + aside)]);
        let enter = |ray: &Ray| {
            let prepared = PreparedRay::new(ray, DVec3::ZERO, Cull::None, Precision::Exact);
            let prepared = prepared.expect("a valid ray").close_to(bounds.corners());
            let slab = SlabRay::new(&prepared, prepared.ray.t_min, &bounds);
            let limit = slab.limit(ray.t_max, 0.0);
            slab.enter(&pair, limit).map(|(_, is_hit)| is_hit)
        };
        assert_eq!(enter(&ray), [true, false], "{length}");
        let backwards = Ray {
            direction: -ray.direction,
            ..ray
        };
        assert_eq!(enter(&backwards), [false; 2]);
        let t = 1.0 / length;
        for (t_min, t_max, is_hit) in [
            (0.0, t * 1.000001, true),
            (t * 0.999999, f64::INFINITY, true),
            (0.0, t * 0.999, false),
            (t * 1.001, f64::MAX, false),
            (-t, f64::MAX, true),
        ] {
            let ranged = Ray {
                t_min,
                t_max,
                ..ray
            };
            assert_eq!(enter(&ranged)[0], is_hit, "{t_min} {t_max}");
        }
    }
}

/// Rays start 2³⁰ units away, where doubles are 2⁻²² apart, and go exactly through a box that is a single point: the
/// start close to the scene is within its error bound.
#[test]
fn starts_close_to_the_scene_are_within_their_error_bound() {
    let step = 2f64.powi(-22);
    let bounds = Box32 {
        min: Vec3::splat(-1e-3),
        max: Vec3::splat(1e-3),
    };
    let mut random = Random(61);
    for round in 0..2000 {
        let mut whole = |most: f64| (random.point() * most).round();
        let origin = whole(1e9);
        // The difference has at most 53 bits, so it is exactly the direction.
        let target = whole(1000.0) * step;
        let ray = Ray::new(origin, target - origin);
        assert_eq!(ray.origin + ray.direction, target);
        let prepared = PreparedRay::new(&ray, DVec3::ZERO, Cull::None, Precision::Exact);
        let prepared = prepared.expect("a valid ray").close_to(bounds.corners());
        let slab = SlabRay::new(&prepared, prepared.ray.t_min, &bounds);
        let point = target.as_vec3();
        assert_eq!(point.as_dvec3(), target);
        let only = Box32 {
            min: point,
            max: point,
        };
        let entered = slab.enter(&BoxPair::of([only, only]), f32::INFINITY);
        assert!(entered[0].1 && entered[1].1, "{round}: {ray:?}");
    }
}

/// A ray that moves by 2⁻²⁵ across a slab while it crosses the scene enters a box at its far side.
#[test]
fn boxes_beside_a_nearly_parallel_ray_are_entered() {
    for sign in [1.0, -1.0] {
        let slope = sign * 2f64.powi(-25);
        let ray = Ray::new(DVec3::NEG_Y, DVec3::new(slope, 1.0, 0.0));
        let prepared = PreparedRay::new(&ray, DVec3::ZERO, Cull::None, Precision::Exact);
        let bounds = Box32 {
            min: Vec3::NEG_ONE,
            max: Vec3::ONE,
        };
        let slab = SlabRay::new(&prepared.expect("a valid ray"), 0.0, &bounds);
        let point = (DVec3::NEG_Y + ray.direction * 2.0).as_vec3();
        let only = Box32 {
            min: point,
            max: point,
        };
        let entered = slab.enter(&BoxPair::of([only, only]), f32::INFINITY);
        assert!(entered[0].1 && entered[1].1, "{sign}");
        let limit = slab.limit(1.0, 0.5);
        assert!(limit >= 1.5, "what may be nearer lies within {limit}");
    }
}
