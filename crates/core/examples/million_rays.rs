//! A million rays that share nothing, on all cores:
//! `cargo run --release -p raycast-core --example million_rays -- MESH.obj`.

#![allow(clippy::print_stdout, reason = "an example tells its findings")]

use raycast_core::glam::DVec3;
use raycast_core::{Accel, Cull, Ray, formats, math};
use rayon::prelude::*;
use std::path::PathBuf;
use std::time::Instant;

const RAYS: u64 = 1_000_000;

/// The `index`-th of many directions spread evenly over the sphere (Saff and Kuijlaars, "Distributing
/// Many Points on a Sphere", 1997).
fn direction(index: u64) -> DVec3 {
    let y = 1.0 - (2 * index + 1) as f64 / RAYS as f64;
    let around = index as f64 * std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let across = (1.0 - y * y).sqrt();
    let (sin, cos) = math::sin_cos(around);
    DVec3::new(across * cos, y, across * sin)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path: PathBuf = std::env::args_os().nth(1).ok_or("name a mesh")?.into();
    let scene = formats::read_scene(&path, &|_| ())?.scene;
    let accel = Accel::build(&scene)?;
    let eye = scene.bounds().center();
    let started = Instant::now();
    let hits = (0..RAYS)
        .into_par_iter()
        .filter(|&index| {
            accel
                .cast(&Ray::new(eye, direction(index)), Cull::None)
                .is_some()
        })
        .count();
    let seconds = started.elapsed().as_secs_f64();
    println!(
        "{hits} of {RAYS} rays from the middle hit something, {:.2} million rays a second",
        RAYS as f64 / seconds / 1e6
    );
    Ok(())
}
