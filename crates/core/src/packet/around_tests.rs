//! Packets of panoramas against single rays, on random and hostile meshes, from eyes anywhere.

use super::clip_tests::planes;
use crate::bvh::Accel;
use crate::camera::{BrownConrady, Camera, ImagePlane, Lattice, Panorama, Pose, Projection, Rect};
use crate::hit::{Cull, Detail, Precision};
use crate::math;
use crate::num::simd::Simd;
use crate::packet::CastCounts;
use crate::random::Random;
use crate::scene::{Mesh, MeshData, Object, Scene};
use glam::DVec3;
use std::sync::Arc;

pub(super) fn scene(corners: Vec<[DVec3; 3]>) -> Scene {
    let count = corners.len() as u32;
    let mesh = Mesh::new(MeshData {
        positions: corners.into_iter().flatten().collect(),
        triangles: (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        ..MeshData::default()
    });
    Scene {
        objects: vec![Object::new("mesh", Arc::new(mesh))],
    }
}

pub(super) fn accel(corners: Vec<[DVec3; 3]>) -> Accel {
    Accel::build(&scene(corners)).expect("a valid scene")
}

/// Triangles of one size, in all directions.
fn soup(random: &mut Random, count: usize, size: f64) -> Vec<[DVec3; 3]> {
    let one = |_| {
        let middle = random.point();
        [0; 3].map(|_| middle + random.point() * size)
    };
    (0..count).map(one).collect()
}

/// A room around the origin, its walls of `side²` quads each.
fn room(side: usize, half: f64) -> Vec<[DVec3; 3]> {
    let mut all = Vec::new();
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let at = |i: usize, j: usize| {
                let share = |k: usize| (k as f64 / side as f64) * 2.0 - 1.0;
                let mut point = [0.0; 3];
                point[axis] = sign;
                point[(axis + 1) % 3] = share(i);
                point[(axis + 2) % 3] = share(j);
                DVec3::from_array(point) * half
            };
            for cell in 0..side * side {
                let (i, j) = (cell % side, cell / side);
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                all.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    all
}

/// A panorama's camera at an eye; `fov` is the angle that the picture's height covers. Some pixels lie outside the
/// projection.
fn camera(panorama: Panorama, eye: DVec3, way: DVec3, rows: u32, fov: f64) -> Camera {
    let pose = Pose::towards(eye, eye + way);
    let projection = Projection::Panoramic(panorama);
    let distance = pose.target.distance(pose.eye);
    let columns = panorama.size(rows).0 + 7;
    let step = projection.frame(fov, distance) / f64::from(rows);
    let plane = ImagePlane::new(columns, rows, step).expect("a good plane");
    Camera::new(pose, projection, plane)
}

fn all() -> impl Iterator<Item = Panorama> {
    Panorama::ALL.into_iter().map(|(_, panorama)| panorama)
}

/// Lattices of a camera that begin and end within packets: all of its pixels, and every third pixel at a sample's
/// position.
fn lattices(camera: Camera) -> [Lattice; 2] {
    let plane = camera.plane();
    let rect = Rect {
        x: 0,
        y: 0,
        width: plane.columns,
        height: plane.rows,
    };
    let mut sparse = camera.sub_camera(rect).sparse_lattice(3, (2, 1));
    sparse.offset = (0.137, 0.791);
    [camera.sub_camera(rect).lattice(), sparse]
}

/// Counts of rays, hits and the work they took.
#[derive(Default)]
pub(super) struct Sum {
    pub(super) rays: usize,
    pub(super) hits: usize,
    pub(super) counts: CastCounts,
}

impl Sum {
    fn undecided(&self) -> u64 {
        self.counts.double_rays + self.counts.exact_rays
    }
}

/// Compares a lattice's packets with single rays, on each instruction set.
pub(super) fn check(accel: &Accel, lattice: &Lattice, cull: Cull, sum: &mut Sum) {
    let plain = accel.clone().with_simd(Simd::Plain);
    let mut hits = [Vec::new(), Vec::new()];
    for (accel, hits) in [accel, &plain].into_iter().zip(&mut hits) {
        accel.cast_lattice(lattice, cull, Precision::Exact, Detail::Full, hits);
    }
    let mut primitives = Vec::new();
    let counts = accel.find_closest(lattice, cull, Precision::Exact, &mut primitives);
    let mut found = 0;
    for (at, hit) in hits[0].iter().enumerate() {
        let (column, row) = (at as u32 % lattice.columns, at as u32 / lattice.columns);
        let ray = lattice.ray(column, row);
        let expected = accel.cast_primitive(&ray, cull, Precision::Exact);
        let at = (column, row, lattice.camera);
        assert_eq!(*hit, expected, "{at:?}");
        found += usize::from(!hit.is_miss());
    }
    assert_eq!(hits[0], hits[1], "{:?}", lattice.camera);
    assert_eq!(counts.hits as usize, found, "{:?}", lattice.camera);
    sum.rays += hits[0].len();
    sum.hits += found;
    sum.counts += counts;
}

fn check_views(accel: &Accel, eye: DVec3, way: DVec3, sum: &mut Sum) {
    for panorama in all() {
        let camera = camera(panorama, eye, way, 75, panorama.default_fov());
        for (index, lattice) in lattices(camera).iter().enumerate() {
            let cull = [Cull::None, Cull::Back][index];
            check(accel, lattice, cull, sum);
        }
    }
}

#[test]
fn packets_of_panoramas_answer_as_single_rays_do() {
    let mut random = Random(71);
    for (count, size) in [(3, 1.0), (60, 0.6), (3000, 0.1)] {
        let mut corners = soup(&mut random, count, size);
        corners.extend(room(3, 1.7));
        let accel = accel(corners);
        let mut sum = Sum::default();
        for _ in 0..3 {
            let (eye, way) = (random.point() * 0.8, random.point());
            check_views(&accel, eye, way, &mut sum);
        }
        assert!(sum.hits > sum.rays / 2, "{} {}", sum.hits, sum.rays);
        // Most rays must be decided by packets, or the test would compare single rays with themselves.
        let (undecided, rays) = (sum.undecided(), sum.rays as u64);
        assert!(undecided < rays / 20, "{undecided} of {rays}");
    }
}

/// A calibrated lens, a strong one, and one that folds back within the picture; pictures of one packet to many.
#[test]
fn packets_through_lenses_answer_as_single_rays_do() {
    let mut random = Random(74);
    for (count, size) in [(3, 1.0), (60, 0.6), (3000, 0.1)] {
        let mut corners = soup(&mut random, count, size);
        corners.extend(room(3, 1.7));
        let accel = accel(corners);
        let mut sum = Sum::default();
        for coefficients in [
            [0.0; 5],
            [-0.28, 0.07, 0.0002, 0.00002, 0.0],
            [0.3, 0.1, -0.02, 0.01, 0.05],
            [-0.6, 0.0, 0.01, 0.0, 0.0],
        ] {
            let lens = BrownConrady::new(coefficients).expect("finite numbers");
            let (eye, way) = (random.point() * 0.8, random.point());
            for (rows, fov) in [(40, 20.0), (150, 60.0), (110, 130.0)] {
                let camera = camera(Panorama::Lens(lens), eye, way, rows, fov);
                for (index, lattice) in lattices(camera).iter().enumerate() {
                    let cull = [Cull::None, Cull::Back][index];
                    check(&accel, lattice, cull, &mut sum);
                }
            }
        }
        assert!(sum.hits > sum.rays / 3, "{} {}", sum.hits, sum.rays);
        let (undecided, rays) = (sum.undecided(), sum.rays as u64);
        assert!(undecided < rays / 20, "{undecided} of {rays}");
    }
}

/// The truth is brute force: each ray tests every triangle.
#[test]
fn packets_of_panoramas_answer_as_brute_force_does() {
    let mut random = Random(72);
    let accel = accel(soup(&mut random, 200, 0.4));
    for panorama in all() {
        let camera = camera(panorama, random.point() * 0.3, random.point(), 40, 80.0);
        for lattice in lattices(camera) {
            let mut hits = Vec::new();
            accel.cast_lattice(
                &lattice,
                Cull::None,
                Precision::Exact,
                Detail::Full,
                &mut hits,
            );
            for (at, hit) in hits.iter().enumerate().step_by(3) {
                let (column, row) = (at as u32 % lattice.columns, at as u32 / lattice.columns);
                let truth = accel.cast_brute_force(&lattice.ray(column, row), Cull::None);
                let found = (!hit.is_miss()).then(|| accel.identify(hit.primitive));
                assert_eq!(found, truth.map(|hit| (hit.object, hit.triangle)));
            }
        }
    }
}

/// Slivers, layers that coincide or nearly do, an eye at a corner, on an edge and in a plane, all of them tiny, huge,
/// or far.
#[test]
fn hostile_meshes_are_seen_as_single_rays_see_them() {
    let mut random = Random(73);
    for decade in [-12, 0, 9] {
        let size = math::pow(10.0, f64::from(decade));
        for place in [DVec3::ZERO, DVec3::new(3e6, -2e5, 7e6) * size] {
            let mut corners = soup(&mut random, 40, 0.5);
            for _ in 0..40 {
                // A thousand times as long as wide.
                let (from, way) = (random.point(), random.point());
                corners.push([from, from + way, from + way * 0.4 + random.point() * 1e-3]);
            }
            for layer in 0..6 {
                let lift = DVec3::new(0.0, 0.0, f64::from(layer / 2) * 1e-9);
                let [a, b, c] = [DVec3::new(-1.0, -1.0, 0.4), DVec3::X, DVec3::Y];
                corners.push([a + lift, a + b * 2.0 + lift, a + c * 2.0 + lift]);
            }
            let known = corners[3];
            for corner in corners.iter_mut().flatten() {
                *corner = *corner * size + place;
            }
            let accel = accel(corners);
            let [a, b, c] = known;
            let mut sum = Sum::default();
            for eye in [
                a,
                (a + b) * 0.5,
                (a + b + c) / 3.0,
                DVec3::new(0.1, 0.3, 0.4),
            ] {
                // The corner as it is stored.
                let eye =
                    accel.origin() + ((eye * size + place) - accel.origin()).as_vec3().as_dvec3();
                let panorama = Panorama::ALL[(random.unit() * 7.0) as usize % 7].1;
                let camera = camera(panorama, eye, random.point() * size, 60, 90.0);
                let [dense, sparse] = lattices(camera);
                check(&accel, &dense, Cull::None, &mut sum);
                check(&accel, &sparse, Cull::Back, &mut sum);
            }
            assert!(sum.hits > 500, "{size} {place}: {}", sum.hits);
        }
    }
}

/// Through a long lens, at a scene that is thin compared with its distance: depth keys are relative to a reference.
#[test]
fn distant_meshes_are_seen_as_single_rays_see_them() {
    let mut random = Random(74);
    for distance in [30.0f64, 1e4, 1e6] {
        let accel = accel(soup(&mut random, 400, 0.2));
        let way = random.point().normalize();
        let mut sum = Sum::default();
        for panorama in all().take(5) {
            let fov = (2.0 / distance).to_degrees();
            let camera = camera(panorama, way * -distance, way * distance, 70, fov);
            for lattice in lattices(camera) {
                check(&accel, &lattice, Cull::None, &mut sum);
            }
        }
        assert!(sum.hits > 4000, "{distance}: {}", sum.hits);
    }
}

/// Pixels so large that few rays of a rectangle share a plane, and so small that all rays of a packet are one except
/// for roundings.
#[test]
fn packets_of_any_pixel_size_answer_as_single_rays_do() {
    let mut random = Random(75);
    let accel = accel([soup(&mut random, 100, 0.4), room(1, 1.5)].concat());
    for panorama in all() {
        for step in [1e-17, 1e-13, 1e-8, 0.02, 0.1, 0.4, 3.0] {
            let pose = Pose::towards(random.point() * 0.2, random.point() * 5.0);
            let plane = ImagePlane::new(41, 33, step).expect("a good plane");
            let camera = Camera::new(pose, Projection::Panoramic(panorama), plane);
            for lattice in lattices(camera) {
                check(&accel, &lattice, Cull::None, &mut Sum::default());
            }
        }
    }
}

/// Planes through corners, edges, triangles and the eye.
#[test]
fn clipped_panoramas_equal_clipped_single_rays() {
    let mut random = Random(77);
    let (mut kept, mut rays) = (0, 0);
    for triangles in [8, 300] {
        let accel = accel([soup(&mut random, triangles, 0.7), room(2, 1.5)].concat());
        for panorama in all() {
            let camera = camera(panorama, random.point() * 0.5, random.point(), 60, 85.0);
            for (count, lattice) in (1..).zip(lattices(camera)) {
                let planes = planes(&mut random, &accel, camera.pose().eye, count);
                let single = accel.clipped(&planes);
                for simd in Simd::available() {
                    let accel = accel.clone().with_simd(simd);
                    let packets = accel.clipped(&planes);
                    let mut hits = Vec::new();
                    let (cull, precision) = (Cull::None, Precision::Exact);
                    packets.cast_lattice(&lattice, cull, precision, Detail::Full, &mut hits);
                    for (at, hit) in hits.iter().enumerate() {
                        let at = at as u32;
                        let ray = lattice.ray(at % lattice.columns, at / lattice.columns);
                        let expected = single.cast_primitive(&ray, cull, precision);
                        assert_eq!(*hit, expected, "{at} {camera:?} {planes:?}");
                        kept += usize::from(!hit.is_miss());
                        rays += 1;
                    }
                }
            }
        }
    }
    assert!(kept > rays / 4, "{kept} of {rays}");
}

/// One tree and instances give the same answers.
#[test]
fn instances_are_seen_as_one_tree_is() {
    let mut random = Random(76);
    let mut scene = scene(soup(&mut random, 300, 0.2));
    for turn in 0..3 {
        let mut copy = scene.objects[0].clone();
        copy.transform.translate = random.point();
        copy.transform.rotate = DVec3::splat(40.0 * f64::from(turn));
        scene.objects.push(copy);
    }
    let one = Accel::build(&scene).expect("a valid scene");
    let instances = Accel::build_instances(&scene).expect("a valid scene");
    let mut sum = Sum::default();
    for panorama in all() {
        let camera = camera(panorama, random.point() * 0.5, random.point(), 66, 90.0);
        for lattice in lattices(camera) {
            check(&instances, &lattice, Cull::None, &mut sum);
            let [mut hits, mut expected] = [Vec::new(), Vec::new()];
            let (cull, precision, detail) = (Cull::None, Precision::Exact, Detail::Full);
            instances.cast_lattice(&lattice, cull, precision, detail, &mut hits);
            one.cast_lattice(&lattice, cull, precision, detail, &mut expected);
            for (hit, expected) in hits.iter().zip(&expected) {
                assert_eq!((hit.t, hit.u, hit.v), (expected.t, expected.u, expected.v));
            }
        }
    }
    assert!(sum.hits > 4000, "{}", sum.hits);
}

/// A packet of one ray is no wider than roundings are: it must still contain a triangle that the ray runs along
/// except for roundings.
#[test]
fn a_packet_of_one_ray_contains_triangles_along_the_ray() {
    let triangle = [(-1.0, -2.0), (1.0, -2.0), (0.0, 2.0)].map(|(y, z)| DVec3::new(0.0, y, z));
    let accel = accel(vec![triangle]);
    let mut random = Random(98);
    let mut sum = Sum::default();
    for round in 0..4000 {
        let panorama = Panorama::ALL[round % Panorama::ALL.len()].1;
        // Of a binade in which the eye's position below is not rounded when it is added.
        let sine = (0.26 + 0.23 * random.unit()) * [-1.0, 1.0][(random.unit() * 2.0) as usize % 2];
        let camera = |x: f64| {
            let eye = DVec3::new(x, 0.0, -3.0);
            let pose = Pose::towards(eye, eye + DVec3::new(sine, 0.0, 1.0));
            let plane = ImagePlane::new(1, 1, 1e-3).expect("a good plane");
            Camera::new(pose, Projection::Panoramic(panorama), plane)
        };
        // The pixel that looks along +Z.
        let first = camera(0.0);
        let axes = [first.right(), first.up(), first.forward()];
        let Some((a, b)) = panorama.place(DVec3::from_array(axes.map(|axis| axis.z))) else {
            continue;
        };
        let lattice = |x: f64| {
            let mut lattice = camera(x).whole().lattice();
            let pixels = first.distance() / 1e-3;
            lattice.offset = (0.5 + a * pixels, 0.5 - b * pixels);
            lattice
        };
        // The ray reaches the triangle's plane some two units on.
        let slope = lattice(0.0).ray(0, 0).direction.x;
        let unit = f64::EPSILON / 4.0;
        let lattice = lattice(-(slope * 2.0 / unit).round() * unit);
        check(&accel, &lattice, Cull::None, &mut sum);
    }
    assert!(sum.hits > 1000, "{} of {}", sum.hits, sum.rays);
}
