//! Rows of samples against single ones, where a row is longer than what is shaded at once and some of its triangles have
//! no accurate linear functions.

use super::facet::Interpolation;
use super::{Mode, Shader, Shading};
use crate::bvh::Accel;
use crate::camera::{Camera, ImagePlane, Placement, Projection, Rect};
use crate::hit::{Cull, Precision};
use crate::hits::Hits;
use crate::num::simd::Simd;
use crate::scene::{Attribute, ColorRule, Mesh, MeshData, Object, Scene};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;

/// A square about the origin, of two triangles, between these corners.
fn quad(corners: [DVec3; 4]) -> Object {
    let mesh = Mesh::new(MeshData {
        positions: corners.to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        normals: Some(Attribute {
            values: vec![
                Vec3::Y,
                Vec3::new(0.6, 0.0, 0.8),
                Vec3::Z,
                Vec3::new(0.0, 0.6, 0.8),
            ],
            indices: None,
        }),
        uvs: Some(Attribute {
            values: vec![Vec2::ZERO, Vec2::X * 7.0, Vec2::ONE, Vec2::Y],
            indices: None,
        }),
        ..MeshData::default()
    });
    let mut object = Object::new("quad", Arc::new(mesh));
    object.color = ColorRule::PerTriangle { seed: 5 };
    object
}

#[test]
fn long_rows_have_the_colours_of_their_samples() {
    let at = DVec3::new;
    // Seen from two thousandths above, from a thousand units to a thousand units away.
    let floor = quad([
        at(-1e3, -2e-3, 1e3),
        at(1e3, -2e-3, 1e3),
        at(1e3, -2e-3, -1e3),
        at(-1e3, -2e-3, -1e3),
    ]);
    let wall = quad([
        at(-2.0, -1.0, 0.0),
        at(1.5, -1.0, 0.0),
        at(1.5, 1.0, 0.5),
        at(-2.0, 1.0, 0.0),
    ]);
    let scene = Scene {
        objects: vec![floor, wall],
    };
    let accel = Accel::build(&scene).expect("a good scene");
    let plane = ImagePlane::new(150, 30, 0.06).expect("a good plane");
    let placement = Placement {
        eye: at(0.0, 0.0, 5.0),
        target: DVec3::ZERO,
        up: DVec3::Y,
    };
    let camera = Camera::new(placement, Projection::Perspective, plane);
    let rect = Rect {
        x: 1,
        y: 0,
        width: 147,
        height: 30,
    };
    let mut lattice = camera.sub_camera(rect).lattice();
    let places = |offset: (f64, f64)| {
        let rows = 0..rect.height;
        let place = move |x, y| (f64::from(x) + offset.0, f64::from(y) + offset.1);
        rows.flat_map(move |y| (rect.x..rect.right()).map(move |x| place(x, y)))
    };
    let hit = |(x, y)| accel.cast_primitive(&camera.ray(x, y), Cull::None, Precision::Exact);
    let hits: Hits = places((0.5, 0.5)).map(hit).collect();
    let (mut lines, mut alone, mut misses) = (0, 0, 0);
    for simd in [Simd::Plain, Simd::best()] {
        let accel = accel.clone().with_simd(simd);
        for mode in [
            Mode::Smooth,
            Mode::Normals,
            Mode::Depth,
            Mode::Barycentric,
            Mode::Uv,
        ] {
            let shading = Shading {
                mode,
                ..Shading::default()
            };
            let shader = Shader::new(&scene, &accel, camera, shading);
            let mut tile = shader.tile();
            let mut pixels = vec![[0; 4]; rect.area()];
            let rows = pixels.chunks_mut(rect.width as usize);
            tile.shade_primitives(rect, &hits.primitives, rows);
            for (((x, y), hit), pixel) in places((0.5, 0.5)).zip(hits.iter()).zip(&pixels) {
                let expected = shader.shade_pixel8(x, y, &hit);
                assert_eq!(*pixel, expected, "{mode:?} {simd:?} at {x}, {y}");
                if hit.is_miss() {
                    misses += 1;
                    continue;
                }
                match tile.facet(hit.primitive, x).interpolation {
                    Interpolation::Linear(_) => lines += 1,
                    _ => alone += 1,
                }
            }
            lattice.offset = (0.3, 0.8);
            let hits: Hits = places(lattice.offset).map(hit).collect();
            let mut light = Vec::new();
            shader.tile().light(&lattice, &hits, &mut light);
            for (((x, y), hit), found) in places(lattice.offset).zip(hits.iter()).zip(&light) {
                assert_eq!(*found, shader.color(x, y, &hit), "{mode:?} {simd:?}");
            }
        }
    }
    assert!(
        lines > 1000 && alone > 1000 && misses > 1000,
        "{lines} {alone} {misses}"
    );
}
