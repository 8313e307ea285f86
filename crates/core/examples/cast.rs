//! Casts one ray at a mesh: `cargo run --release -p raycast-core --example cast -- MESH.obj`.

#![allow(clippy::print_stdout, reason = "an example tells its findings")]

use raycast_core::glam::DVec3;
use raycast_core::scene::Scene;
use raycast_core::{Accel, Cull, Ray, formats};
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path: PathBuf = std::env::args_os().nth(1).ok_or("name a mesh")?.into();
    let scene: Scene = formats::read_scene(&path, &|_| ())?.scene;
    let accel = Accel::build(&scene)?;

    // From above, down through the middle of everything.
    let bounds = scene.bounds();
    let origin = bounds
        .center()
        .with_y(bounds.max.y + bounds.size().length());
    let ray = Ray::new(origin, DVec3::NEG_Y);
    match accel.cast(&ray, Cull::None) {
        Some(hit) => println!(
            "object {}, triangle {} at {}: t = {}, u = {}, v = {}",
            hit.object,
            hit.triangle,
            ray.at(hit.t),
            hit.t,
            hit.u,
            hit.v
        ),
        None => println!("nothing is hit"),
    }
    Ok(())
}
