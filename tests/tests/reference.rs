//! Small pictures of scenes of our own, compared exactly with those in `reference/`.
//!
//! `RAYCAST_BLESS=1 cargo test -p raycast-tests --release --test reference` writes them anew; look
//! at each that changed before you commit it.

use raycast_core::Cull;
use raycast_core::camera::{Camera, Grid, Projection};
use raycast_core::formats::{read_mesh, read_scene};
use raycast_core::glam::DVec3;
use raycast_core::picture::{Format, Picture};
use raycast_core::scene::{Color, ColorRule, Object, Scene, Texture, Transform};
use raycast_core::shade::{Background, Filter, Mode, Shading, Wireframe};
use raycast_report::cameras::camera;
use raycast_report::meshes;
use raycast_tests::check::{Check, Stage, render};
use raycast_tests::files::asset;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const SIZE: (u32, u32) = (64, 48);

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("reference")
}

/// Compares a picture with the reference of that name, pixel by pixel; both are left to look at
/// where they differ.
fn compare(name: &str, picture: &Picture) {
    let path = folder().join(format!("{name}.png"));
    let png = picture.encode(Format::Png).expect("a picture");
    if std::env::var_os("RAYCAST_BLESS").is_some() {
        std::fs::create_dir_all(folder()).expect("the folder can be made");
        std::fs::write(&path, &png).expect("a reference can be written");
        return;
    }
    let reference = image::open(&path)
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
        .into_rgba8();
    assert_eq!(reference.dimensions(), (picture.width, picture.height));
    let differ = reference
        .pixels()
        .zip(&picture.pixels)
        .filter(|(expected, found)| expected.0 != **found)
        .count();
    if differ > 0 {
        let found = std::env::temp_dir().join(format!("{name}.found.png"));
        std::fs::write(&found, &png).expect("a picture can be left to look at");
        panic!(
            "{name}: {differ} pixels are not those of {}; found {}",
            path.display(),
            found.display()
        );
    }
}

fn shoot(stage: &Stage, camera: Camera, shading: Shading, samples: u32) -> Picture {
    let mut view = stage.view(camera, Cull::None);
    view.settings.shading = shading;
    view.settings.samples = samples;
    view.settings.layers = false;
    render(&view, Grid::default())
}

fn read(name: &str) -> Object {
    let path = asset(name);
    let mesh = read_mesh(&path, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
    Object::new(name, Arc::new(mesh))
}

/// A ball over a board, made in code.
fn ball_over_board() -> Stage {
    let board = meshes::grid(6, 6, |x, z| {
        DVec3::new(f64::from(x) - 3.0, -1.0, 3.0 - f64::from(z))
    });
    let ball = Object {
        transform: Transform {
            rotate: DVec3::new(20.0, 30.0, 0.0),
            ..Transform::IDENTITY
        },
        color: ColorRule::PerTriangle { seed: 0 },
        ..Object::new("ball", Arc::new(meshes::sphere(DVec3::ZERO, 1.0, 12)))
    };
    let board = Object {
        color: ColorRule::Uniform(Color([0x90, 0xa0, 0x70])),
        ..Object::new("board", Arc::new(board))
    };
    Stage::from_scene(Scene {
        objects: vec![board, ball],
    })
}

fn above(projection: Projection, height: f64) -> Camera {
    camera(
        DVec3::new(2.0, 2.5, 5.0),
        DVec3::new(0.0, -0.2, 0.0),
        projection,
        SIZE,
        height,
    )
}

fn shading(mode: Mode) -> Shading {
    Shading {
        mode,
        ..Shading::default()
    }
}

#[test]
fn colors() {
    let stage = ball_over_board();
    let camera = above(Projection::Perspective, 4.5);
    compare("colors", &shoot(&stage, camera, shading(Mode::Color), 1));
}

#[test]
fn flat_orthographic() {
    let stage = ball_over_board();
    let camera = above(Projection::Orthographic, 5.0);
    compare(
        "flat-orthographic",
        &shoot(&stage, camera, shading(Mode::Flat), 1),
    );
}

#[test]
fn depth() {
    let stage = ball_over_board();
    let camera = above(Projection::Perspective, 4.5);
    compare("depth", &shoot(&stage, camera, shading(Mode::Depth), 1));
}

#[test]
fn barycentric() {
    let stage = ball_over_board();
    let camera = above(Projection::Perspective, 4.5);
    compare(
        "barycentric",
        &shoot(&stage, camera, shading(Mode::Barycentric), 1),
    );
}

#[test]
fn wireframe_with_samples() {
    let stage = ball_over_board();
    let camera = above(Projection::Perspective, 4.5);
    let shading = Shading {
        wireframe: Some(Wireframe::default()),
        background: Background::Transparent,
        ..shading(Mode::Wireframe)
    };
    compare("wireframe", &shoot(&stage, camera, shading, 4));
}

#[test]
fn normals_of_the_torus() {
    let stage = Stage::from_scene(Scene {
        objects: vec![read("torus.obj")],
    });
    let (center, radius) = stage.scene.bounding_sphere();
    let eye = center + DVec3::new(0.5, 0.7, 1.0) * radius * 2.0;
    let camera = camera(eye, center, Projection::Perspective, SIZE, radius * 1.8);
    compare("normals", &shoot(&stage, camera, shading(Mode::Normals), 1));
}

#[test]
fn texture_on_the_cube() {
    // Few texels, so that what lies between them shows.
    let texels = (0..36u8)
        .map(|i| [40 * (i % 6), 40 * (i / 6), 200 * ((i + i / 6) % 2), 255])
        .collect();
    let texture = Texture::new(6, 6, texels).expect("36 texels");
    let cube = Object {
        texture: Some(Arc::new(texture)),
        ..read("cube.obj")
    };
    let stage = Stage::from_scene(Scene {
        objects: vec![cube],
    });
    let (center, radius) = stage.scene.bounding_sphere();
    let eye = center + DVec3::new(0.6, 0.5, 1.0) * radius * 2.5;
    let camera = camera(eye, center, Projection::Perspective, SIZE, radius * 2.0);
    for (name, filter) in [
        ("texture-nearest", Filter::Nearest),
        ("texture-bilinear", Filter::Bilinear),
    ] {
        let shading = Shading {
            filter,
            ..shading(Mode::Texture)
        };
        compare(name, &shoot(&stage, camera, shading, 1));
    }
}

#[test]
fn demo_scene() {
    let path = asset("demo.raycast.toml");
    let file = read_scene(&path, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
    let shading = file.shading.unwrap_or_default();
    let placed = file.camera.expect("the demo scene has a camera");
    let stage = Stage::from_scene(file.scene);
    let distance = (placed.pose.target - placed.pose.eye).length();
    let height = match placed.projection {
        Projection::Perspective | Projection::Panoramic(_) => {
            raycast_core::camera::fov_to_frame(placed.frame, distance)
        }
        Projection::Orthographic => placed.frame,
    };
    let camera = camera(
        placed.pose.eye,
        placed.pose.target,
        placed.projection,
        (96, 64),
        height,
    );
    compare("demo", &shoot(&stage, camera, shading, 4));
}
