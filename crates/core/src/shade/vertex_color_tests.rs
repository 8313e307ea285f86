//! Vertex colours of files.

use super::*;
use crate::camera::{Camera, ImagePlane, Pose, Projection, Rect};
use crate::hit::{Cull, Detail, Precision};
use crate::scene::{Color, ColorRule, Material, Mesh, MeshData, Object, Scene};
use crate::{Accel, Hits, PrimitiveHit};
use glam::DVec3;
use std::sync::Arc;

const RED: Color = Color([255, 0, 0]);
const GREEN: Color = Color([0, 255, 0]);
const GREY: Color = Color([100, 100, 100]);

/// A triangle that fills the picture, and one beside it with a corner without colour.
fn data() -> MeshData {
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    MeshData {
        positions: vec![
            corner(-9.0, -9.0),
            corner(9.0, -9.0),
            corner(0.0, 9.0),
            corner(90.0, 9.0),
        ],
        triangles: vec![[0, 1, 2], [1, 3, 2]],
        colors: vec![Some(RED), Some(GREEN), Some(GREY)],
        ..MeshData::default()
    }
}

fn object(data: MeshData) -> Object {
    Object::new("triangle", Arc::new(Mesh::new(data)))
}

fn camera() -> Camera {
    let pose = Pose {
        eye: DVec3::new(0.0, 0.0, 5.0),
        target: DVec3::ZERO,
        up: DVec3::Y,
    };
    let plane = ImagePlane::new(33, 17, 0.1).expect("a good plane");
    Camera::new(pose, Projection::Perspective, plane)
}

fn color(object: Object, triangle: u32, mode: Mode, (u, v): (f32, f32)) -> [u8; 4] {
    let scene = Scene {
        objects: vec![object],
    };
    let accel = Accel::build(&scene).expect("a good scene");
    let shading = Shading {
        mode,
        ..Shading::default()
    };
    let shader = Shader::new(&scene, &accel, camera(), shading);
    let primitive = (0..2).find(|&primitive| accel.identify(primitive) == (0, triangle));
    // The target lies in the triangles' plane, where a pixel is a step wide.
    let [a, b, c] = data().triangles[triangle as usize];
    let [a, b, c] = [a, b, c].map(|corner| data().positions[corner as usize]);
    let point = a + (b - a) * f64::from(u) + (c - a) * f64::from(v);
    let (x, y) = (16.5 + point.x / 0.1, 8.5 - point.y / 0.1);
    let hit = PrimitiveHit {
        primitive: primitive.expect("a triangle"),
        u,
        v,
        ..PrimitiveHit::NONE
    };
    shader.shade_pixel8(x, y, &hit)
}

#[test]
fn colours_between_vertices_are_mixed_in_linear_light() {
    let at = |u, v| color(object(data()), 0, Mode::Color, (u, v));
    assert_eq!(at(0.0, 0.0), [255, 0, 0, 255]);
    assert_eq!(at(1.0, 0.0), [0, 255, 0, 255]);
    assert_eq!(at(0.0, 1.0), [100, 100, 100, 255]);
    // Half of full light is 188 in sRGB.
    assert_eq!(at(0.5, 0.0), [188, 188, 0, 255]);
    let default = Color::DEFAULT.0;
    let uncolored = color(object(data()), 1, Mode::Color, (0.2, 0.2));
    assert_eq!(uncolored[..3], default, "a corner has none");
}

#[test]
fn rules_and_materials_go_before_colours_of_vertices() {
    let mut uniform = object(data());
    uniform.color = ColorRule::Uniform(GREY);
    let shown = color(uniform, 0, Mode::Color, (0.0, 0.0));
    assert_eq!(shown, [100, 100, 100, 255]);
    let material = Material::new("grey", GREY);
    let with_material = object(MeshData {
        materials: vec![material],
        material_of_triangle: vec![0, u32::MAX],
        ..data()
    });
    let shown = color(with_material, 0, Mode::Color, (0.0, 0.0));
    assert_eq!(shown, [100, 100, 100, 255]);
}

/// Pictures are shaded tile by tile, and equal the shading of single pixels.
#[test]
fn pictures_show_what_single_pixels_do() {
    for mode in [Mode::Color, Mode::Flat, Mode::Smooth, Mode::Texture] {
        let scene = Scene {
            objects: vec![object(data())],
        };
        let accel = Accel::build(&scene).expect("a good scene");
        let shading = Shading {
            mode,
            ..Shading::default()
        };
        let shader = Shader::new(&scene, &accel, camera(), shading);
        assert_eq!(shader.detail(), Detail::Triangle);
        let rect = Rect {
            x: 0,
            y: 0,
            width: 33,
            height: 17,
        };
        let places = (0..33 * 17).map(|i| (f64::from(i % 33) + 0.5, f64::from(i / 33) + 0.5));
        let hits: Hits = places
            .map(|(x, y)| accel.cast_primitive(&camera().ray(x, y), Cull::None, Precision::Exact))
            .collect();
        let mut pixels = vec![[0; 4]; 33 * 17];
        let rows = pixels.chunks_mut(33);
        shader.tile().shade_primitives(rect, &hits.primitives, rows);
        let mut shown = std::collections::HashSet::new();
        for (index, pixel) in pixels.iter().enumerate() {
            let (x, y) = (index % 33, index / 33);
            let single = shader.shade_pixel8(x as f64 + 0.5, y as f64 + 0.5, &hits.get(index));
            assert_eq!(*pixel, single, "{mode:?} at {x}, {y}");
            shown.insert(*pixel);
        }
        assert!(shown.len() > 100, "{mode:?}: {} colours", shown.len());
    }
}
