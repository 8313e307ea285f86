//! Clipped packets against clipped single rays, brute force and each other.

use super::around_tests::accel;
use super::cast_tests::{cameras, waves, waves_mesh};
use crate::bvh::Accel;
use crate::camera::{Camera, ImagePlane, Panorama, Pose, Projection, Rect};
use crate::hit::{Cull, Detail, Precision, PrimitiveHit};
use crate::num::simd::Simd;
use crate::random::Random;
use crate::scene::{ClippingPlane, ClippingPlanes, Object, Scene};
use crate::single::Clipped;
use glam::DVec3;
use std::sync::Arc;

fn corners(accel: &Accel, primitive: u32) -> [DVec3; 3] {
    accel
        .corners(primitive)
        .map(|corner| accel.origin() + corner.as_dvec3())
}

/// A plane that is likely to go wrong: through a corner, an edge, a triangle or an eye; or any plane.
fn plane(random: &mut Random, accel: &Accel, eye: DVec3) -> ClippingPlane {
    let any = (random.unit() * accel.len() as f64) as u32;
    let [a, b, c] = corners(accel, any.min(accel.len() as u32 - 1));
    let axis = [DVec3::X, DVec3::NEG_Y, DVec3::Z][(random.unit() * 3.0) as usize % 3];
    let plane = match (random.unit() * 7.0) as usize {
        0 => ClippingPlane::through(a, axis),
        1 => ClippingPlane::through(a, (b - a).cross(random.point())),
        2 => ClippingPlane::through(a, (b - a).cross(c - a)),
        3 => ClippingPlane::through(eye, random.point()),
        4 => ClippingPlane::through(accel.origin(), axis),
        5 => ClippingPlane::through((a + b) * 0.5, random.point() * 1e-9),
        _ => ClippingPlane::through(b, random.point()),
    };
    plane.expect("a plane")
}

pub(super) fn planes(
    random: &mut Random,
    accel: &Accel,
    eye: DVec3,
    count: usize,
) -> ClippingPlanes {
    let planes: Vec<_> = (0..count).map(|_| plane(random, accel, eye)).collect();
    ClippingPlanes::new(&planes).expect("few planes")
}

#[test]
fn clipped_packets_equal_clipped_single_rays() {
    let mut random = Random(17);
    let (mut kept, mut cut) = (0, 0);
    for (side, size, offset) in [
        (3, 1.0, DVec3::ZERO),
        (40, 1.0, DVec3::ZERO),
        (24, 30.0, DVec3::new(148_376.0, 1234.0, -223_423.0)),
    ] {
        let accel = waves(side, size, offset);
        for camera in cameras(size, offset) {
            let rect = Rect {
                x: 3,
                y: 1,
                width: 90,
                height: 70,
            };
            let lattice = camera.sub_camera(rect).lattice();
            for count in [1, 2, 3] {
                let planes = planes(&mut random, &accel, camera.pose().eye, count);
                for cull in [Cull::None, Cull::Back] {
                    let mut all = Vec::new();
                    accel.cast_lattice(&lattice, cull, Precision::Exact, Detail::Full, &mut all);
                    let single = accel.clipped(&planes);
                    for simd in Simd::available() {
                        let accel = accel.clone().with_simd(simd);
                        let mut hits = Vec::new();
                        accel.clipped(&planes).cast_lattice(
                            &lattice,
                            cull,
                            Precision::Exact,
                            Detail::Full,
                            &mut hits,
                        );
                        for (at, hit) in hits.iter().enumerate() {
                            let at = at as u32;
                            let ray = lattice.ray(at % rect.width, at / rect.width);
                            let expected = single.cast_primitive(&ray, cull, Precision::Exact);
                            assert_eq!(*hit, expected, "{at} {planes:?} {camera:?}");
                            kept += usize::from(!hit.is_miss());
                            cut += usize::from(*hit != all[at as usize]);
                        }
                    }
                }
            }
        }
    }
    assert!(kept > 50_000 && cut > 50_000, "{kept} {cut}");
}

/// How many rays packets leave undecided, and how many hit anything; each sees what its single ray sees.
fn undecided_and_hits(clipped: &Clipped<'_>, camera: &Camera) -> (u64, u64) {
    let lattice = camera.whole().lattice();
    let mut primitives = Vec::new();
    let counts = clipped.find_closest(&lattice, Cull::None, Precision::Exact, &mut primitives);
    for (at, &primitive) in (0..).zip(&primitives) {
        let ray = lattice.ray(at % lattice.columns, at / lattice.columns);
        let expected = clipped.cast_primitive(&ray, Cull::None, Precision::Exact);
        assert_eq!(primitive, expected.primitive, "{camera:?} {at}");
    }
    (counts.double_rays + counts.exact_rays, counts.hits)
}

/// Triangles whose planes hold the eye but for roundings are set up by component, a scale for each edge function; packets
/// decide where they are cut too.
#[test]
fn cut_triangles_of_planes_next_to_the_eye_are_decided_by_packets() {
    let mut random = Random(20);
    let eye = DVec3::new(0.25, 0.5, 3.0);
    let mut corners = || {
        let [a, b] = [(); 2].map(|()| random.point() * 2.0);
        let c = eye + (a - eye) * (2.0 * random.signed()) + (b - eye) * (2.0 * random.signed());
        [a, b, c]
    };
    let accel = accel((0..200).map(|_| corners()).collect());
    let pose = Pose::towards(eye, DVec3::ZERO);
    let plane = ImagePlane::new(80, 60, 0.05).expect("a good plane");
    let panorama = Projection::Panoramic(Panorama::Equirectangular);
    // The second plane holds the eye.
    for (projection, offset) in [
        (Projection::Perspective, 0.0),
        (Projection::Perspective, 0.5),
        (panorama, 0.0),
        (panorama, 0.5),
    ] {
        let cut = ClippingPlane::new(DVec3::Y, offset).expect("a plane");
        let clipped = accel.clipped(&ClippingPlanes::new(&[cut]).expect("one"));
        let camera = Camera::new(pose, projection, plane);
        let (undecided, hits) = undecided_and_hits(&clipped, &camera);
        assert!(hits > 1000, "{projection:?}: {hits}");
        assert!(undecided < 100, "{projection:?}: {undecided} of {hits}");
    }
}

/// A fan's corner next to the eye, far from the origin, and a plane through the corner: what it keeps is decided at a
/// small part of the eye's coordinates.
#[test]
fn a_plane_next_to_the_eye_and_to_a_fans_corner_is_decided_by_packets() {
    let mut random = Random(21);
    let corner = DVec3::new(558_767.5, -6_113_849.0, -7_169_420.5);
    let mut outer = || (corner + random.point() * 1e6).as_vec3().as_dvec3();
    let fan: Vec<_> = (0..300).map(|_| [corner, outer(), outer()]).collect();
    let [_, b, c] = fan[0];
    let normal = (b - corner).cross(c - corner).normalize();
    let accel = accel(fan);
    let plane = ClippingPlane::new(normal, normal.dot(corner)).expect("a plane");
    let clipped = accel.clipped(&ClippingPlanes::new(&[plane]).expect("one"));
    let eye = corner.with_x(corner.x.next_up());
    let pose = Pose::towards(eye, corner + random.point() * 1e6);
    let plane = ImagePlane::new(80, 60, 2e4).expect("a good plane");
    let panorama = Projection::Panoramic(Panorama::Equirectangular);
    for projection in [Projection::Perspective, panorama] {
        let camera = Camera::new(pose, projection, plane);
        let (undecided, hits) = undecided_and_hits(&clipped, &camera);
        assert!(hits > 1000, "{projection:?}: {hits}");
        assert!(
            undecided < hits / 10,
            "{projection:?}: {undecided} of {hits}"
        );
    }
}

#[test]
fn the_clipped_tree_answers_as_brute_force_does() {
    let mut random = Random(18);
    let (mut kept, mut cut) = (0, 0);
    for offset in [DVec3::ZERO, DVec3::new(148_376.0, 1234.0, -223_423.0)] {
        let accel = waves(6, 1.0, offset);
        for camera in cameras(1.0, offset) {
            let planes = planes(&mut random, &accel, camera.pose().eye, 2);
            let clipped = accel.clipped(&planes);
            for _ in 0..400 {
                let (x, y) = (random.unit() * 101.0, random.unit() * 75.0);
                let ray = camera.ray(x, y);
                let hit = clipped.cast(&ray, Cull::None);
                assert_eq!(hit, clipped.cast_brute_force(&ray, Cull::None), "{ray:?}");
                kept += usize::from(hit.is_some());
                cut += usize::from(hit != accel.cast(&ray, Cull::None));
            }
        }
    }
    assert!(kept > 500 && cut > 500, "{kept} {cut}");
}

#[test]
fn clipped_instances_answer_as_a_clipped_tree_does() {
    let mut random = Random(19);
    let mesh = Arc::new(waves_mesh(9, 1.0, DVec3::ZERO));
    let objects = (0..12).map(|number| {
        let mut object = Object::new(format!("{number}"), Arc::clone(&mesh));
        object.transform.translate = random.point();
        object.transform.rotate = random.point() * 90.0;
        object.visible = number != 5;
        object
    });
    let scene = Scene {
        objects: objects.collect(),
    };
    let one = Accel::build(&scene).expect("a valid scene");
    let instances = Accel::build_instances(&scene).expect("a valid scene");
    let (mut kept, mut cut) = (0, 0);
    for camera in cameras(1.0, DVec3::ZERO) {
        let planes = planes(&mut random, &one, camera.pose().eye, 2);
        let (a, b) = (one.clipped(&planes), instances.clipped(&planes));
        let lattice = camera.whole().lattice();
        for cull in [Cull::None, Cull::Back] {
            let (mut expected, mut found, mut all) = (Vec::new(), Vec::new(), Vec::new());
            one.cast_lattice(&lattice, cull, Precision::Exact, Detail::Full, &mut all);
            a.cast_lattice(
                &lattice,
                cull,
                Precision::Exact,
                Detail::Full,
                &mut expected,
            );
            b.cast_lattice(&lattice, cull, Precision::Exact, Detail::Full, &mut found);
            for (at, (a, b)) in expected.iter().zip(&found).enumerate() {
                let hit = |accel: &Accel, hit: &PrimitiveHit| {
                    let place = (!hit.is_miss()).then(|| accel.identify(hit.primitive));
                    (place, [hit.t, hit.u, hit.v].map(f32::to_bits))
                };
                assert_eq!(
                    hit(&one, a),
                    hit(&instances, b),
                    "{at} {planes:?} {camera:?}"
                );
                kept += usize::from(!a.is_miss());
                cut += usize::from(*a != all[at]);
            }
        }
        for _ in 0..60 {
            let ray = camera.ray(random.unit() * 101.0, random.unit() * 75.0);
            let hit = a.cast(&ray, Cull::None);
            assert_eq!(b.cast(&ray, Cull::None), hit, "{ray:?}");
            assert_eq!(b.cast_brute_force(&ray, Cull::None), hit, "{ray:?}");
        }
    }
    assert!(kept > 10_000 && cut > 10_000, "{kept} {cut}");
}

/// A cube of integer coordinates with a face in the plane: points on a plane are kept, whichever way the face is
/// oriented.
#[test]
fn hits_on_a_plane_are_kept_and_hits_next_to_it_are_not() {
    let accel = waves(4, 1.0, DVec3::ZERO);
    let ray = crate::Ray::new(DVec3::new(0.125, 5.0, 0.0625), DVec3::NEG_Y);
    let hit = accel.cast(&ray, Cull::None).expect("a hit");
    // The ray's own x is exact, however its t is rounded.
    for (offset, is_kept) in [
        (0.125, true),
        (0.125f64.next_down(), true),
        (0.125f64.next_up(), false),
    ] {
        for (normal, offset, is_kept) in [
            (DVec3::X, offset, is_kept),
            (DVec3::NEG_X, -offset, offset >= 0.125),
            (DVec3::X * 3.0, offset * 3.0, is_kept),
        ] {
            let plane = ClippingPlane::new(normal, offset).expect("a plane");
            let planes = ClippingPlanes::new(&[plane]).expect("one");
            let found = accel.clipped(&planes).cast(&ray, Cull::None);
            assert_eq!(found, is_kept.then_some(hit), "{plane:?}");
        }
    }
}
