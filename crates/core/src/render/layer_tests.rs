//! Pictures with layers, pixel by pixel: tiles without hits among others, which are filled together.

use super::{Cancel, Settings, View};
use crate::bvh::Accel;
use crate::camera::{Camera, Grid, ImagePlane, Panorama, PixelFilter, Pose, Projection};
use crate::picture::Picture;
use crate::random::Random;
use crate::scene::{Attribute, Mesh, MeshData, Object, Scene};
use crate::shade::{self, Ground, Mode, Shader, Shading};
use crate::{Cull, Precision};
use glam::{DVec3, Vec2};
use std::sync::Arc;
use std::time::Duration;

/// Random triangles that cover a small part of the picture.
fn scene(has_uvs: bool, has_normals: bool) -> Scene {
    let mut random = Random(57);
    let corners = 3 * 20;
    let positions = (0..corners).map(|_| random.point() * 0.6).collect();
    let normals = (0..corners).map(|_| random.point().normalize_or(DVec3::X).as_vec3());
    let normals: Vec<_> = normals.collect();
    let uvs = (0..corners).map(|at| Vec2::new(at as f32, 0.5)).collect();
    let of = |values| Attribute {
        values,
        indices: None,
    };
    let mesh = Mesh::new(MeshData {
        positions,
        normals: has_normals.then(|| of(normals)),
        uvs: has_uvs.then_some(Attribute {
            values: uvs,
            indices: None,
        }),
        triangles: (0..corners / 3)
            .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
            .collect(),
        ..MeshData::default()
    });
    Scene {
        objects: vec![Object::new("mesh", Arc::new(mesh))],
    }
}

fn view(scene: Scene, projection: Projection, ground: Option<Ground>, mode: Mode) -> View {
    let pose = Pose {
        eye: DVec3::new(0.5, 1.0, 4.0),
        target: DVec3::ZERO,
        up: DVec3::Y,
    };
    // A fisheye's frame, which is 2π wide and high, leaves the picture's corners and sides to be transparent.
    let step = if projection == Projection::Perspective {
        0.025
    } else {
        0.05
    };
    let plane = ImagePlane::new(150, 90, step).expect("a good plane");
    View {
        accel: Arc::new(Accel::build(&scene).expect("a valid scene")),
        scene: Arc::new(scene),
        camera: Camera::new(pose, projection, plane),
        settings: Settings {
            shading: Shading {
                mode,
                ground,
                ..Shading::default()
            },
            layers: true,
            ..Settings::default()
        },
    }
}

fn render(view: &View) -> Picture {
    render_in_tiles(view, 16)
}

fn render_in_tiles(view: &View, size: u32) -> Picture {
    view.render(
        Grid::Size(size),
        &|| Duration::ZERO,
        &Cancel::default(),
        &|_| (),
    )
    .expect("nobody cancels")
}

/// Each pixel against the hit of its ray, shaded alone.
fn check(view: &View) {
    let picture = render(view);
    let layers = picture.layers.as_ref().expect("layers");
    let shading = view.settings.shading;
    let shader = Shader::new(&view.scene, &view.accel, view.camera, shading);
    let (mut hits, mut misses) = (0, 0);
    for at in 0..150 * 90 {
        let (x, y) = ((at % 150) as f64 + 0.5, (at / 150) as f64 + 0.5);
        let lattice = view.camera.sub_camera(crate::camera::Rect {
            x: at as u32 % 150,
            y: at as u32 / 150,
            width: 1,
            height: 1,
        });
        let lattice = lattice.lattice();
        let mut found = crate::Hits::default();
        view.accel.find_closest(
            &lattice,
            Cull::None,
            Precision::Exact,
            &mut found.primitives,
        );
        (view.accel).interpolate(&lattice, Cull::None, Precision::Exact, &mut found);
        let hit = found.get(0);
        let color = shade::premultiply(shader.color(x, y, &hit));
        assert_eq!(layers.color[at], color, "{at}");
        assert_eq!(
            picture.pixels[at],
            shade::encode_premultiplied(color),
            "{at}"
        );
        let (numbers, surface) = match hit.is_miss() {
            true => ((u32::MAX, u32::MAX), ([0.0; 3], [0.0; 2])),
            false => (
                view.accel.identify(hit.primitive),
                shader.surface(x, y, &hit),
            ),
        };
        let shown = (layers.object[at], layers.triangle[at]);
        assert_eq!(shown, numbers, "{at}");
        assert_eq!((layers.normal[at], layers.uv[at]), surface, "{at}");
        assert_eq!(layers.depth[at], hit.t, "{at}");
        match hit.is_miss() {
            true => misses += 1,
            false => hits += 1,
        }
    }
    assert!(hits > 100 && misses > 8000, "{hits} {misses}");
}

#[test]
fn pixels_of_layered_pictures_are_those_of_single_rays() {
    for (has_uvs, has_normals) in [(false, false), (true, false), (false, true), (true, true)] {
        for mode in [Mode::Smooth, Mode::Flat, Mode::Depth] {
            let scene = scene(has_uvs, has_normals);
            check(&view(scene, Projection::Perspective, None, mode));
        }
    }
}

/// A ground that shows beside the mesh, and frames that not all of the picture is in.
#[test]
fn what_is_seen_beside_surfaces_is_in_the_layers_as_well() {
    let ground = Some(Ground::Lowest);
    let fisheye = Projection::Panoramic(Panorama::Equidistant);
    check(&view(
        scene(false, false),
        Projection::Perspective,
        ground,
        Mode::Smooth,
    ));
    check(&view(scene(false, false), fisheye, None, Mode::Smooth));
    check(&view(scene(true, true), fisheye, None, Mode::Flat));
}

/// Tiles without hits add one colour a row to their sums of samples, where that is all they show; in one large tile
/// every sample is shaded.
#[test]
fn samples_beside_surfaces_are_the_same_in_tiles_without_hits() {
    for ground in [None, Some(Ground::Lowest)] {
        for layers in [false, true] {
            let mut view = view(
                scene(false, false),
                Projection::Perspective,
                ground,
                Mode::Smooth,
            );
            view.settings.samples = 32;
            // Some of its weights are negative.
            view.settings.pixel_filter = PixelFilter::Mitchell;
            view.settings.layers = layers;
            let (small, whole) = (render_in_tiles(&view, 8), render_in_tiles(&view, 256));
            assert_eq!(small.pixels, whole.pixels, "{ground:?}");
            let colors = |picture: &Picture| picture.layers.as_ref().map(|of| of.color.clone());
            assert_eq!(colors(&small), colors(&whole), "{ground:?}");
        }
    }
}

/// A picture drawn over another has nothing of it left.
#[test]
fn layers_are_written_over_those_of_another_picture() {
    let first = view(
        scene(true, true),
        Projection::Perspective,
        None,
        Mode::Smooth,
    );
    let mut second = view(
        scene(true, true),
        Projection::Perspective,
        None,
        Mode::Smooth,
    );
    second.camera = second.camera.shifted([0.2, 0.1]);
    let mut picture = render(&first);
    assert!(second.render_into(
        Grid::Size(16),
        &|| Duration::ZERO,
        &Cancel::default(),
        &|_| (),
        &mut picture
    ));
    assert_eq!(picture, render(&second));
}
