//! `raycast cast`: files of rays, answered as exact arithmetic answers them.

#![allow(
    clippy::print_stdout,
    reason = "tests tell what they checked and what they skipped"
)]

use raycast_core::Cull;
use raycast_core::camera::Ray;
use raycast_core::formats::read_mesh;
use raycast_core::glam::{DVec3, Vec3};
use raycast_oracle::random::Random;
use raycast_tests::arguments;
use raycast_tests::binary::{refuse, succeed};
use raycast_tests::check::{Check, Stage};
use raycast_tests::files::{FileRay, asset, bytes, folder, write, write_rays};
use raycast_tests::models;
use std::path::Path;

/// t, object, triangle, u, v.
fn read_hits(path: &Path) -> Vec<(f32, u32, u32, f32, f32)> {
    let bytes = bytes(path);
    assert_eq!(bytes.len() % 20, 0, "hits of 20 bytes");
    let hits = bytes.chunks_exact(20);
    hits.map(|hit| {
        let word = |i: usize| [hit[4 * i], hit[4 * i + 1], hit[4 * i + 2], hit[4 * i + 3]];
        (
            f32::from_le_bytes(word(0)),
            u32::from_le_bytes(word(1)),
            u32::from_le_bytes(word(2)),
            f32::from_le_bytes(word(3)),
            f32::from_le_bytes(word(4)),
        )
    })
    .collect()
}

fn random_rays(stage: &Stage, count: usize) -> Vec<FileRay> {
    let (center, radius) = stage.scene.bounding_sphere();
    let mut random = Random::new(count as u64);
    (0..count)
        .map(|i| {
            let origin = (center + random.direction() * radius * 2.0).as_vec3();
            let target = match i % 3 {
                0 => (center + random.in_cube() * radius).as_vec3(),
                _ => {
                    let primitive = random.below(stage.accel.len() as u32);
                    let corner = stage.accel.corners(primitive)[i % 2].as_dvec3();
                    (stage.accel.origin() + corner).as_vec3()
                }
            };
            let direction = target - origin;
            let Vec3 { x, y, z } = origin;
            let [dx, dy, dz] = direction.to_array();
            [x, y, z, 0.0, dx, dy, dz, f32::MAX]
        })
        .collect()
}

/// `cast` answers what exact arithmetic answers.
fn assert_cast_is_exact(mesh: &Path, count: usize) {
    let folder = folder();
    let (rays_path, hits_path) = (folder.path().join("rays"), folder.path().join("hits"));
    let read = read_mesh(mesh, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
    let stage = Stage::from_meshes([read]);
    let rays = random_rays(&stage, count);
    write_rays(&rays_path, &rays);
    succeed(arguments![
        "cast", mesh, "--rays", &rays_path, "--hits", &hits_path
    ]);
    let hits = read_hits(&hits_path);
    assert_eq!(hits.len(), rays.len());
    let mut met = 0;
    for (file_ray, &(t, object, triangle, u, v)) in rays.iter().zip(&hits) {
        let [x, y, z, t_min, dx, dy, dz, t_max] = file_ray.map(f64::from);
        let ray = Ray {
            origin: DVec3::new(x, y, z),
            direction: DVec3::new(dx, dy, dz),
            t_min,
            t_max,
        };
        let Some(truth) = stage.truth(&ray, Cull::None) else {
            assert_eq!((t, object, triangle), (f32::INFINITY, u32::MAX, u32::MAX));
            continue;
        };
        met += 1;
        assert_eq!(
            (object, triangle),
            (truth.object, truth.triangle),
            "{ray:?}"
        );
        if truth.cosine > 0.1 {
            let bound = 4.0 * 2f64.powi(-23);
            assert!((f64::from(t) - truth.t).abs() <= bound * truth.t, "{ray:?}");
            let error = (f64::from(u) - truth.u)
                .abs()
                .max((f64::from(v) - truth.v).abs());
            assert!(error <= bound, "{ray:?}");
        }
    }
    println!("{}: {count} rays, {met} hits, none wrong", mesh.display());
    assert!(met > count / 2, "only {met} of {count} hit");
}

#[test]
fn cast_is_exact_on_the_demo_assets() {
    for name in ["cube.obj", "monkey.obj", "dahlia.obj"] {
        assert_cast_is_exact(&asset(name), 20_000);
    }
}

#[test]
fn cast_is_exact_on_real_meshes() {
    for mesh in models::meshes() {
        assert_cast_is_exact(&mesh, 30_000);
    }
}

#[test]
fn rays_that_are_no_rays_are_counted_misses() {
    let folder = folder();
    let (rays_path, hits_path) = (folder.path().join("rays"), folder.path().join("hits"));
    let good: FileRay = [0.1, 0.2, 9.0, 0.0, 0.0, 0.0, -1.0, 1e30];
    let mut rays = vec![good];
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for place in 0..8 {
            // A ray that ends nowhere is an ordinary one.
            if (bad, place) != (f32::INFINITY, 7) {
                let mut ray = good;
                ray[place] = bad;
                rays.push(ray);
            }
        }
    }
    let mut still = good;
    still[6] = 0.0;
    let mut endless = good;
    endless[7] = f32::INFINITY;
    rays.extend([still, endless]);
    write_rays(&rays_path, &rays);
    let message = succeed(arguments![
        "cast",
        asset("cube.obj"),
        "--rays",
        &rays_path,
        "--hits",
        &hits_path
    ]);
    assert!(message.errors.contains("24 of 26"), "{}", message.errors);
    let hits = read_hits(&hits_path);
    assert_eq!(hits.len(), rays.len());
    let (first, last) = (hits[0], hits[rays.len() - 1]);
    assert!(first.0.is_finite() && first == last);
    for hit in &hits[1..rays.len() - 1] {
        assert_eq!((hit.0, hit.1, hit.2), (f32::INFINITY, u32::MAX, u32::MAX));
        assert!(hit.3 == 0.0 && hit.4 == 0.0);
    }
}

#[test]
fn bad_ray_files_are_one_line_and_leave_no_hits() {
    let folder = folder();
    let hits = folder.path().join("hits");
    let cast = |rays: &Path| {
        let mesh = asset("cube.obj");
        let line = refuse(1, arguments!["cast", mesh, "--rays", rays, "--hits", &hits]);
        assert!(line.contains(&rays.display().to_string()), "{line}");
        assert!(!hits.exists());
    };
    cast(&folder.path().join("none"));
    cast(&write(folder.path(), "truncated", [0; 32 * 3 + 5]));
    cast(folder.path());
    // No rays at all are no error.
    let none = write(folder.path(), "no-rays", b"");
    succeed(arguments![
        "cast",
        asset("cube.obj"),
        "--rays",
        none,
        "--hits",
        &hits
    ]);
    assert_eq!(bytes(&hits).len(), 0);
}
