//! Makes a scene in code, three pyramids of three colours, and renders it with lines over flat shading:
//! `cargo run --release -p raycast-core --example scene -- OUT.png`.

use raycast_core::Accel;
use raycast_core::camera::{Camera, Grid, Orbit};
use raycast_core::glam::DVec3;
use raycast_core::picture::Format;
use raycast_core::render::{Cancel, Settings, View};
use raycast_core::scene::{Color, ColorRule, Mesh, MeshData, Object, Scene};
use raycast_core::shade::{Mode, Shading, Wireframe};
use std::sync::Arc;
use std::time::Duration;

/// A pyramid over a square of side 2, its tip at height 2; corners run counter-clockwise from outside.
fn pyramid() -> Mesh {
    let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    Mesh::new(MeshData {
        positions: vec![
            corner(-1.0, 0.0, -1.0),
            corner(1.0, 0.0, -1.0),
            corner(1.0, 0.0, 1.0),
            corner(-1.0, 0.0, 1.0),
            corner(0.0, 2.0, 0.0),
        ],
        triangles: vec![
            [0, 1, 2],
            [0, 2, 3],
            [1, 0, 4],
            [2, 1, 4],
            [3, 2, 4],
            [0, 3, 4],
        ],
        ..MeshData::default()
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let out = std::env::args_os().nth(1).ok_or("name a picture")?;
    // One mesh, kept once, in three places.
    let mesh = Arc::new(pyramid());
    let colors = [[220, 80, 60], [240, 180, 60], [70, 130, 200]];
    let objects = colors.iter().zip([-2.5, 0.0, 2.5]).map(|(&color, x)| {
        let mut object = Object::new(format!("pyramid at {x}"), Arc::clone(&mesh));
        object.transform.translate = DVec3::X * x;
        object.transform.rotate = DVec3::Y * (x * 20.0);
        object.color = ColorRule::Uniform(Color(color));
        object
    });
    let scene = Scene {
        objects: objects.collect(),
    };

    let view = View {
        camera: Camera::fitting(&scene.bounds(), Orbit::DEFAULT_ANGLES, (960, 540))?,
        accel: Arc::new(Accel::build(&scene)?),
        scene: Arc::new(scene),
        settings: Settings {
            shading: Shading {
                mode: Mode::Flat,
                wireframe: Some(Wireframe::default()),
                ..Shading::default()
            },
            samples: 4,
            ..Settings::default()
        },
    };
    let no_clock = || Duration::ZERO;
    let picture = view.render(Grid::default(), &no_clock, &Cancel::default(), &|_| ());
    let picture = picture.ok_or("nobody cancels")?;
    std::fs::write(out, picture.encode(Format::Png)?)?;
    Ok(())
}
