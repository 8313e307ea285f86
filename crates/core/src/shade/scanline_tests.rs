//! Rows of samples against single ones, where a row is longer than what is shaded at once and some of its triangles have
//! no accurate linear functions.

use super::facet::Interpolation;
use super::{Filter, Mode, Shader, Shading};
use crate::bvh::Accel;
use crate::camera::{Camera, ImagePlane, Pose, Projection, Rect};
use crate::hit::{Cull, Precision};
use crate::hits::Hits;
use crate::num::simd::Simd;
use crate::random::Random;
use crate::scene::{Attribute, ColorRule, Mesh, MeshData, Object, Scene, Texture};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;

/// A square about the origin, of two triangles, between these corners.
fn quad(corners: [DVec3; 4], has_uvs: bool) -> Object {
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
        uvs: has_uvs.then(|| Attribute {
            values: vec![Vec2::ZERO, Vec2::X * 7.0, Vec2::ONE, Vec2::Y],
            indices: None,
        }),
        ..MeshData::default()
    });
    let mut object = Object::new("quad", Arc::new(mesh));
    object.color = ColorRule::PerTriangle { seed: 5 };
    object
}

/// Seen from two thousandths above, from a thousand units to a thousand units away.
const FLOOR: [DVec3; 4] = [
    DVec3::new(-1e3, -2e-3, 1e3),
    DVec3::new(1e3, -2e-3, 1e3),
    DVec3::new(1e3, -2e-3, -1e3),
    DVec3::new(-1e3, -2e-3, -1e3),
];

const WALL: [DVec3; 4] = [
    DVec3::new(-2.0, -1.0, 0.0),
    DVec3::new(1.5, -1.0, 0.0),
    DVec3::new(1.5, 1.0, 0.5),
    DVec3::new(-2.0, 1.0, 0.0),
];

/// A floor and a wall with textures, the floor's by texture coordinates and the wall's from three sides; before the wall
/// a square with another texture and one without.
fn textured_scene() -> Scene {
    let mut random = Random(31);
    let mut texture = |is_opaque: bool| {
        let mut byte = || (random.unit() * 256.0) as u8;
        let texel = |_| {
            let [r, g, b, a] = [(); 4].map(|()| byte());
            [r, g, b, if is_opaque { 255 } else { a }]
        };
        Texture::new(16, 8, (0..16 * 8).map(texel).collect()).map(Arc::new)
    };
    let mut floor = quad(FLOOR, true);
    floor.texture = texture(true);
    let mut wall = quad(WALL, false);
    wall.texture = texture(false);
    let before = |x: f64, texture: Option<Arc<Texture>>| {
        let mut object = quad(WALL, texture.is_none());
        object.transform.translate = DVec3::new(x, 0.2, 0.6);
        object.transform.scale = DVec3::splat(0.4);
        object.texture = texture;
        object
    };
    let patch = before(0.6, texture(true));
    let plain = before(-0.7, None);
    Scene {
        objects: vec![floor, wall, patch, plain],
    }
}

#[test]
fn long_rows_have_the_colours_of_their_samples() {
    let modes = [
        Mode::Smooth,
        Mode::Normals,
        Mode::Depth,
        Mode::Barycentric,
        Mode::Uv,
    ];
    let shadings = modes.map(|mode| Shading {
        mode,
        ..Shading::default()
    });
    let objects = [FLOOR, WALL].map(|corners| quad(corners, true));
    let scene = Scene {
        objects: objects.to_vec(),
    };
    check(&scene, &shadings);
}

#[test]
fn long_rows_have_the_textures_of_their_samples() {
    let mut shadings = Vec::new();
    for mode in [Mode::Texture, Mode::Flat, Mode::Smooth] {
        for (filter, blend) in [(Filter::Nearest, 1.0), (Filter::Bilinear, 0.7)] {
            shadings.push(Shading {
                mode,
                filter,
                blend,
                ..Shading::default()
            });
        }
    }
    check(&textured_scene(), &shadings);
}

/// Compares rows with single samples.
fn check(scene: &Scene, shadings: &[Shading]) {
    let at = DVec3::new;
    let accel = Accel::build(scene).expect("a good scene");
    let plane = ImagePlane::new(150, 30, 0.06).expect("a good plane");
    let pose = Pose {
        eye: at(0.0, 0.0, 5.0),
        target: DVec3::ZERO,
        up: DVec3::Y,
    };
    let camera = Camera::new(pose, Projection::Perspective, plane);
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
    for simd in Simd::available() {
        let accel = accel.clone().with_simd(simd);
        for &shading in shadings {
            let mode = shading.mode;
            let shader = Shader::new(scene, &accel, camera, shading);
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
