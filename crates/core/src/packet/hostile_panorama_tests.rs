//! Packets of panoramas where they are most likely to go wrong: at the ends of the picture, at the borders of a cube
//! map's faces, with few rays, close to the eye. Scenes have few triangles, so that most rays miss and a packet that
//! skips too much is noticed. The truth is the single ray, and brute force for some rays.

use super::around_tests::{Sum, accel, check, scene};
use crate::bvh::Accel;
use crate::camera::{Camera, ImagePlane, Lattice, Panorama, Pose, Projection, Rect};
use crate::hit::{Cull, Detail, Precision};
use crate::math;
use crate::random::Random;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

fn any(random: &mut Random, count: usize) -> usize {
    (random.unit() * count as f64) as usize % count
}

/// A number of a random magnitude between two powers of ten.
/// A position where a picture ends, folds, or is stitched.
fn odd_place(random: &mut Random, panorama: Panorama) -> (f64, f64) {
    let sign = [-1.0, 1.0][any(random, 2)];
    match panorama {
        Panorama::Equirectangular => [
            (sign * PI, random.signed() * FRAC_PI_2),
            (random.signed() * PI, sign * FRAC_PI_2),
            (sign * FRAC_PI_2, 0.0),
        ][any(random, 3)],
        Panorama::Cylindrical => [
            (sign * PI, random.signed() * 2.0),
            (random.signed() * PI, sign * random.decades(0.0, 4.0)),
        ][any(random, 2)],
        Panorama::Equidistant | Panorama::Equisolid | Panorama::Stereographic => {
            let radius = match panorama {
                Panorama::Equidistant => [PI, FRAC_PI_2][any(random, 2)],
                Panorama::Equisolid => [2.0, 2f64.sqrt()][any(random, 2)],
                _ => [2.0, 1e3][any(random, 2)],
            };
            let (sin, cos) = math::sin_cos(random.signed() * PI);
            [(radius * cos, radius * sin), (0.0, sign * radius)][any(random, 2)]
        }
        Panorama::CubeStrip => {
            let border = [-6.0, -4.0, -2.0, 0.0, 2.0, 4.0, 6.0][any(random, 7)];
            [(border, random.signed()), (random.signed() * 6.0, sign)][any(random, 2)]
        }
        Panorama::CubeCross => {
            let border = [-4.0, -2.0, 0.0, 2.0, 4.0][any(random, 5)];
            [(border, random.signed()), (random.signed(), sign)][any(random, 2)]
        }
        // Past the corners of a wide frame.
        Panorama::Lens(_) => (random.signed() * 2.0, random.signed() * 2.0),
    }
}

/// A lattice of few rays around a position; one of its rays goes through it, except for rounding, at times exactly.
fn lattice(random: &mut Random, pose: Pose, panorama: Panorama) -> Lattice {
    let (a, b) = match any(random, 3) {
        0 => panorama.place(random.point()).unwrap_or((0.0, 0.0)),
        _ => odd_place(random, panorama),
    };
    let distance = pose.eye.distance(pose.target);
    // Powers of two make positions exact.
    let step = match any(random, 2) {
        0 => math::pow(2.0, -1.0 - (random.unit() * 9.0).floor()),
        _ => random.decades(-7.0, -0.3),
    };
    let half = |place: f64| ((place.abs() / step).ceil() as u32).min(1 << 30) + 20;
    let odd = any(random, 2) as u32;
    let (columns, rows) = (2 * half(a) + odd, 2 * half(b) + odd);
    // Larger than pictures may be: few of its pixels are cast.
    let plane = ImagePlane {
        columns,
        rows,
        step: step * distance,
    };
    let camera = Camera::new(pose, Projection::Panoramic(panorama), plane);
    let at = |place: f64, count: u32| {
        let middle = place / step + f64::from(count) * 0.5;
        (middle.floor().max(0.0) as u32).min(count - 1)
    };
    let size = |random: &mut Random| [1, 2, 9, 33, 70][any(random, 5)];
    let (width, height) = (size(random).min(columns), size(random).min(rows));
    let before = |random: &mut Random, size: u32| (random.unit() * f64::from(size)) as u32;
    let rect = Rect {
        x: (at(a, columns).saturating_sub(before(random, width))).min(columns - width),
        y: (at(-b, rows).saturating_sub(before(random, height))).min(rows - height),
        width,
        height,
    };
    let mut lattice = camera.sub_camera(rect).lattice();
    if any(random, 3) == 0 {
        lattice.offset = (random.unit(), random.unit());
    }
    lattice
}

/// Triangles where a lattice's rays look, of the shapes that ray casters get wrong.
fn triangle(random: &mut Random, lattice: &Lattice) -> [DVec3; 3] {
    let camera = &lattice.camera;
    let eye = camera.pose().eye;
    let [column, row] = [lattice.columns, lattice.rows].map(|count| any(random, count as usize));
    let ray = lattice.ray(column as u32, row as u32);
    let pitch = camera.plane().step / camera.distance();
    let depth = random.decades(-2.0, 2.0);
    let at = eye + ray.direction * depth;
    let size = depth * (pitch * random.decades(-1.0, 1.5)).min(1.0);
    let near = |random: &mut Random| at + random.point() * size;
    match any(random, 8) {
        // About as large as a pixel, or with a corner on a ray.
        0 => [near(random), near(random), near(random)],
        1 => [at, near(random), near(random)],
        // With an edge through a ray.
        2 => {
            let way = random.point() * size;
            [at - way, at + way * random.unit(), near(random)]
        }
        // A needle.
        3 => {
            let way = random.point() * depth;
            let aside = random.point() * (size * 1e-3);
            [at - way, at + way * random.unit(), at + way * 0.3 + aside]
        }
        // Around the eye, or far beyond the scene.
        4 => {
            let far = random.decades(0.0, 6.0);
            [(); 3].map(|()| eye + random.point() * far)
        }
        // In a plane through the eye except for rounding.
        5 => {
            let other = random.point() * depth;
            let mean = (at - eye) * random.signed() + other * random.signed();
            [at, eye + other, eye + mean]
        }
        // Beside the eye, or around it.
        6 => {
            let close = random.decades(-9.0, -1.0);
            [(); 3].map(|()| eye + random.point() * close)
        }
        // From behind the eye to in front of it.
        _ => [at, eye - ray.direction * depth, near(random)],
    }
}

/// A camera, placed sensibly or not.
fn pose(random: &mut Random) -> Pose {
    let frame = [DVec3::ZERO, random.point() * 1e6][any(random, 2)];
    let way = match any(random, 3) {
        0 => [DVec3::X, DVec3::NEG_Z, DVec3::NEG_Y][any(random, 3)],
        _ => random.point() * random.decades(-3.0, 3.0),
    };
    Pose::towards(frame, frame + way)
}

#[test]
fn hostile_triangles_are_seen_as_single_rays_and_brute_force_see_them() {
    let mut random = Random(97);
    let mut sum = Sum::default();
    for round in 0..ROUNDS {
        let panorama = Panorama::ALL[round % Panorama::ALL.len()].1;
        let pose = pose(&mut random);
        let lattice = lattice(&mut random, pose, panorama);
        let count = [1, 2, 7, 40][any(&mut random, 4)];
        let corners: Vec<_> = (0..count)
            .map(|_| triangle(&mut random, &lattice))
            .collect();
        let Ok(accel) = Accel::build(&scene(corners)) else {
            continue;
        };
        let cull = [Cull::None, Cull::Back][any(&mut random, 2)];
        check(&accel, &lattice, cull, &mut sum);
        let mut hits = Vec::new();
        accel.cast_lattice(&lattice, cull, Precision::Exact, Detail::Full, &mut hits);
        for (at, hit) in hits.iter().enumerate().step_by(41) {
            let (column, row) = (at as u32 % lattice.columns, at as u32 / lattice.columns);
            let ray = lattice.ray(column, row);
            let truth = accel.cast_brute_force(&ray, cull);
            let found = (!hit.is_miss()).then(|| accel.identify(hit.primitive));
            let truth = truth.map(|hit| (hit.object, hit.triangle));
            assert_eq!(found, truth, "round {round}: {ray:?}");
        }
    }
    assert!(sum.hits > sum.rays / 20, "{} of {}", sum.hits, sum.rays);
}

const ROUNDS: usize = 2400;

/// The eye in a plane that corners are in, or beside it by the least number: inverse depths overflow single precision in
/// the scene's own unit, in which packets would leave every ray to single rays.
#[test]
fn planes_a_subnormal_number_from_the_eye_are_ordered_by_packets() {
    let mut random = Random(98);
    let least = f64::from(f32::from_bits(1));
    let mut corner = || {
        let at = random.point() * 3.0;
        at.with_y(if random.unit() < 0.5 { 0.0 } else { least })
    };
    let corners: Vec<_> = (0..200).map(|_| [(); 3].map(|()| corner())).collect();
    let accel = accel(corners);
    let pose = Pose::towards(DVec3::new(1.0, 0.0, 2.0), DVec3::new(0.0, 0.0, 0.5));
    let plane = ImagePlane::new(64, 48, 0.03).expect("a good plane");
    let panorama = Projection::Panoramic(Panorama::Equidistant);
    for projection in [Projection::Perspective, panorama] {
        let camera = Camera::new(pose, projection, plane);
        let lattice = camera.whole().lattice();
        let mut sum = Sum::default();
        check(&accel, &lattice, Cull::None, &mut sum);
        let undecided = sum.counts.double_rays + sum.counts.exact_rays;
        assert!(sum.hits > sum.rays / 4, "{} of {}", sum.hits, sum.rays);
        assert!(undecided < 30, "{undecided} of {}", sum.rays);
    }
}

/// A border between two faces of a cube map belongs to one of them; in a strip that face may look elsewhere than its
/// neighbour in the picture. The scenes are visible to rays of the border alone, among triangles elsewhere, so that
/// entry points leave some out. Where a border is assigned to the face on its other side, this fails.
#[test]
fn rays_at_the_borders_of_faces_belong_to_one_face() {
    let mut sum = Sum::default();
    for panorama in [Panorama::CubeStrip, Panorama::CubeCross] {
        // A width with a pixel at each border; large packets are narrow enough to have a cone.
        let across = 128;
        let (columns, rows) = match panorama {
            Panorama::CubeStrip => (across * 12 + 1, across * 2 + 1),
            _ => (across * 8 + 1, across * 6 + 1),
        };
        // With integer lengths, so that borders are exactly at pixels. Seen along the second direction, a packet
        // contains rays of two faces.
        for (x, y, z, length) in [(0, 0, -1, 1), (-1, 4, 8, 9)] {
            let way = DVec3::from([x, y, z].map(f64::from));
            let step = f64::from(length) / f64::from(across);
            let plane = ImagePlane::new(columns, rows, step).expect("a good plane");
            let pose = Pose::towards(DVec3::ZERO, way);
            let camera = Camera::new(pose, Projection::Panoramic(panorama), plane);
            check_borders(&camera, across, &mut sum);
        }
    }
    assert!(sum.hits > 60, "{}", sum.hits);
}

/// Checks the rays at the borders of faces, at some distance from the faces' middles, each in a scene of its own.
fn check_borders(camera: &Camera, across: u32, sum: &mut Sum) {
    let ImagePlane { columns, rows, .. } = camera.plane();
    for x in (0..columns).step_by(across as usize * 2) {
        for y in (0..rows).step_by(across as usize / 2) {
            // Packets of one row may contain rays of two faces; higher ones see too wide and are split.
            for (left, top, height) in [(0, 0, 9), (5, 5, 9), (0, 0, 1)] {
                let rect = Rect {
                    x: x.saturating_sub(left),
                    y: y.saturating_sub(top),
                    width: (columns - x).min(33),
                    height: (rows - y).min(height),
                };
                let lattice = camera.sub_camera(rect).lattice();
                let ray = lattice.ray(x - rect.x, y - rect.y);
                if !ray.is_valid() || x - rect.x >= rect.width || y - rect.y >= rect.height {
                    continue;
                }
                let side = ray.direction.any_orthonormal_vector() * 0.02;
                let up = ray.direction.cross(side);
                let around = [side, up - side, -up - side];
                // More than a leaf has, so that they have a subtree of their own.
                let layers = (0..8).map(|layer| ray.direction * (5.0 + f64::from(layer)));
                let elsewhere = DVec3::AXES
                    .into_iter()
                    .flat_map(|axis| [1.0, 1.1, -1.0, -1.1].map(|share| axis * (share * 1000.0)));
                let corners = layers.chain(elsewhere);
                let corners = corners.map(|at| around.map(|way| at + way)).collect();
                check(&accel(corners), &lattice, Cull::None, sum);
            }
        }
    }
}
