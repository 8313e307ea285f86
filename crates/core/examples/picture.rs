//! Renders a mesh to a PNG: `cargo run --release -p raycast-core --example picture -- MESH.obj OUT.png`.

use raycast_core::camera::{Camera, Orbit};
use raycast_core::formats;
use raycast_core::picture::Format;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut paths = std::env::args_os().skip(1).map(PathBuf::from);
    let (Some(mesh), Some(out)) = (paths.next(), paths.next()) else {
        return Err("name a mesh and a picture".into());
    };
    let scene = formats::read_scene(&mesh, &|_| ())?.scene;
    let camera = Camera::fitting(&scene.bounds(), Orbit::DEFAULT_ANGLES, (1280, 720))?;
    let picture = raycast_core::render(&scene, &camera)?;
    std::fs::write(out, picture.encode(Format::Png)?)?;
    Ok(())
}
