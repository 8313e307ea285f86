//! The tree's answer, brute force's and the oracle's are the same: on random rays, and on rays
//! aimed at what is hardest, at random meshes and at real ones.
//!
//! How the truth is known: rational arithmetic on the vertices as stored (`raycast-oracle`).

#![allow(
    clippy::print_stdout,
    reason = "tests report what they checked and what they skipped"
)]

use raycast_core::Cull;
use raycast_core::camera::Ray;
use raycast_core::glam::DVec3;
use raycast_core::picture::Picture;
use raycast_core::scene::{Mesh, Object, Scene, Transform};
use raycast_oracle::random::Random;
use raycast_report::cameras::{PROJECTIONS, camera};
use raycast_report::meshes;
use raycast_tests::check::{Check, Stage};
use raycast_tests::models;
use std::sync::Arc;

/// A ray at the scene: random, or aimed at a corner, an edge or a face, or within two units in the
/// last place of one.
fn ray(random: &mut Random, stage: &Stage, (center, radius): (DVec3, f64)) -> Ray {
    let origin = match random.below(8) {
        0 => point(random, stage),
        1 => center + random.in_cube() * radius,
        _ => center + random.direction() * radius * random.decade(0.0, 3.0),
    };
    let target = match random.below(4) {
        0 => center + random.in_cube() * radius,
        1 => {
            let target = point(random, stage);
            random.nudge(target, 2)
        }
        _ => point(random, stage),
    };
    let direction = match random.below(16) {
        // Along an axis: rays hit planes, boxes and edges of grids head on.
        0 => DVec3::AXES[random.below(3) as usize] * (target - origin).length(),
        _ => target - origin,
    };
    let t_max = match random.below(8) {
        // Ends at the target, more or less.
        0 => 1.0,
        _ => f64::MAX,
    };
    Ray {
        t_max,
        ..Ray::new(origin, direction)
    }
}

/// A corner of the scene, or a point on an edge or a face.
fn point(random: &mut Random, stage: &Stage) -> DVec3 {
    let accel = &stage.accel;
    let [a, b, c] = accel
        .corners(random.below(accel.len() as u32))
        .map(|corner| accel.origin() + corner.as_dvec3());
    match random.below(4) {
        0 => a,
        1 => (b + c) * 0.5,
        2 => b + (c - b) * random.between(0.0, 1.0),
        _ => (a + b + c) / 3.0,
    }
}

fn rays(seed: u64, count: usize, stage: &Stage) -> Vec<Ray> {
    let mut random = Random::new(seed);
    let sphere = stage.scene.bounding_sphere();
    (0..count)
        .map(|_| ray(&mut random, stage, sphere))
        .collect()
}

/// Checks `count` rays, one in `brute` of them by brute force too.
fn check(name: &str, stage: &Stage, count: usize, brute: usize) {
    let rays = rays(count as u64, count, stage);
    for cull in [Cull::None, Cull::Back] {
        let hits = stage.check_all_quickly(&rays, cull);
        stage.check_all(&rays[..count / brute], cull);
        println!("{name}: {count} rays, {cull:?}, {hits} hits, none wrong");
        assert!(hits > count / 5, "{name}: only {hits} hits");
    }
}

#[test]
fn random_meshes_over_many_decades() {
    let mut random = Random::new(11);
    let mut checked = 0;
    let mut hits = 0;
    for round in 0..250 {
        let scale = random.decade(-15.0, 15.0);
        let middle = match round % 3 {
            0 => DVec3::ZERO,
            _ => random.direction() * scale * random.decade(0.0, 5.0),
        };
        let size = random.decade(-3.0, 0.0);
        let count = 1 + random.below(60);
        let stage =
            Stage::from_meshes([meshes::random_soup(&mut random, count, middle, scale, size)]);
        if stage.accel.is_empty() {
            continue;
        }
        let rays = rays(round, 200, &stage);
        hits += stage.check_all(&rays, Cull::None);
        hits += stage.check_all(&rays, Cull::Back);
        checked += 2 * rays.len();
    }
    println!("random meshes: {checked} rays, {hits} hits, none wrong");
    assert!(hits > checked / 4, "only {hits} hits of {checked}");
}

#[test]
fn directions_of_any_length() {
    let mut random = Random::new(12);
    let stage = Stage::from_meshes([meshes::random_soup(&mut random, 60, DVec3::ZERO, 1.0, 0.5)]);
    let rays: Vec<Ray> = rays(12, 4000, &stage)
        .into_iter()
        .map(|ray| Ray {
            direction: ray.direction * random.decade(-20.0, 20.0),
            t_max: f64::MAX,
            ..ray
        })
        .collect();
    assert!(stage.check_all(&rays, Cull::None) > 2000);
}

#[test]
fn height_field() {
    let stage = Stage::from_meshes([meshes::integer_heights(64, 5)]);
    check("height field", &stage, 100_000, 50);
}

#[test]
fn far_sphere() {
    let center = DVec3::new(148_376.0, 1234.0, -223_423.0);
    let stage = Stage::from_meshes([meshes::sphere(center, 2.0, 60)]);
    check("far sphere", &stage, 100_000, 50);
}

#[test]
fn several_objects_in_their_places() {
    let mut random = Random::new(13);
    let mut objects: Vec<Object> = (0..6)
        .map(|i| {
            let mesh = match i % 3 {
                0 => meshes::sphere(DVec3::ZERO, 1.0, 24),
                1 => meshes::cuboid(DVec3::splat(-1.0), DVec3::ONE),
                _ => meshes::octahedron(),
            };
            Object {
                transform: Transform {
                    translate: random.in_cube() * 2.0,
                    rotate: random.in_cube() * 180.0,
                    scale: DVec3::ONE + random.in_cube() * 1.5,
                    ..Transform::IDENTITY
                },
                parent: (i > 3).then_some(i - 2),
                ..Object::new(format!("object {i}"), Arc::new(mesh))
            }
        })
        .collect();
    // Two in the same place: the lower number shows.
    objects.push(objects[0].clone());
    let stage = Stage::from_scene(Scene { objects });
    check("several objects", &stage, 100_000, 25);
}

/// The tiles' way through the tree: random meshes over many decades, from random eyes, every pixel.
#[test]
fn pictures_of_random_meshes_over_many_decades() {
    let mut random = Random::new(14);
    let mut covered = 0;
    for round in 0..120 {
        let scale = random.decade(-12.0, 12.0);
        let middle = match round % 3 {
            0 => DVec3::ZERO,
            _ => random.direction() * scale * random.decade(0.0, 5.0),
        };
        let size = random.decade(-2.0, 0.0);
        let count = 1 + random.below(400);
        let stage =
            Stage::from_meshes([meshes::random_soup(&mut random, count, middle, scale, size)]);
        if stage.accel.is_empty() {
            continue;
        }
        let target = middle + random.in_cube() * scale * 0.5;
        let eye = middle + random.direction() * scale * random.decade(-1.0, 1.5);
        // Wide and narrow, of odd sizes; down to pixels much smaller than the triangles.
        let height = (eye - target).length() * random.decade(-4.0, 1.0);
        let pixels = (20 + random.below(60), 20 + random.below(60));
        let cull = [Cull::None, Cull::Back][round % 2];
        for projection in PROJECTIONS {
            let camera = camera(eye, target, projection, pixels, height);
            let picture = stage.check_picture(camera, cull, 1);
            covered += covered_pixels(&picture);
        }
    }
    println!("pictures of random meshes: {covered} pixels covered, none wrong");
    assert!(covered > 80_000, "{covered}");
}

/// Vertices and edges on the pixels' own lattice, triangles in one plane over one another, duplicates:
/// every ray hits borders, and ties abound.
#[test]
fn pictures_on_a_lattice() {
    let mut random = Random::new(15);
    let mut covered = 0;
    for round in 0..30 {
        let corners: Vec<[DVec3; 3]> = (0..40)
            .map(|_| {
                let z = [0.0, 4.0, -8.0, -24.0][random.below(4) as usize];
                std::array::from_fn(|_| {
                    let mut whole = || f64::from(random.below(17)) - 8.0;
                    DVec3::new(
                        whole(),
                        whole(),
                        if round % 2 == 0 { z } else { z * 0.5 + whole() },
                    )
                })
            })
            .collect();
        let shift = match round % 3 {
            0 => DVec3::ZERO,
            1 => DVec3::new(1000.0, -2000.0, 0.0),
            _ => DVec3::new(65_536.0, 0.0, -1e6),
        };
        let moved: Vec<[DVec3; 3]> = corners.iter().map(|c| c.map(|p| p + shift)).collect();
        let stage = Stage::from_meshes([meshes::soup(&moved)]);
        // Half a pixel aside, so that centres lie on multiples of an eighth at the target.
        let aside = shift + DVec3::new(1.0 / 16.0, -1.0 / 16.0, 0.0);
        for projection in PROJECTIONS {
            for back in [8.0, 16.0] {
                let eye = aside + DVec3::Z * back;
                let camera = camera(eye, aside, projection, (128, 128), 16.0);
                let picture = stage.check_picture(camera, Cull::None, 3);
                covered += covered_pixels(&picture);
            }
        }
    }
    println!("pictures on a lattice: {covered} pixels covered, none wrong");
    assert!(covered > 400_000, "{covered}");
}

fn covered_pixels(picture: &Picture) -> usize {
    let layers = picture.layers.as_ref().expect("layers were requested");
    layers.depth.iter().filter(|z| z.is_finite()).count()
}

/// What a mesh holds is what is cast at: no rounding on the way.
#[test]
fn a_mesh_at_rest_is_cast_at_as_stored() {
    let far = DVec3::new(1e7, -3e5, 40.0);
    for mesh in [
        meshes::sphere(DVec3::ZERO, 1.0, 12),
        meshes::sphere(far, 1.0, 12),
    ] {
        let stage = Stage::from_meshes([mesh.clone()]);
        assert_eq!(stage.accel.len(), mesh.kept().len());
        for primitive in 0..stage.accel.len() as u32 {
            let (object, triangle) = stage.accel.identify(primitive);
            assert_eq!(object, 0);
            assert_eq!(stage.accel.origin(), mesh.offset());
            assert_eq!(Some(stage.accel.corners(primitive)), mesh.corners(triangle));
        }
    }
}

fn read(path: &std::path::Path) -> Mesh {
    raycast_core::formats::read_mesh(path, &|_| ())
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn demo_assets() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets");
    for name in [
        "cube.obj",
        "monkey.obj",
        "dahlia.obj",
        "torus.obj",
        "plinth.obj",
    ] {
        check(
            name,
            &Stage::from_meshes([read(&folder.join(name))]),
            10_000,
            20,
        );
    }
}

#[test]
fn real_meshes() {
    for path in models::meshes() {
        let stage = Stage::from_meshes([read(&path)]);
        let name = path
            .file_name()
            .expect("a file")
            .to_string_lossy()
            .into_owned();
        check(&name, &stage, 100_000, 200);
    }
}
