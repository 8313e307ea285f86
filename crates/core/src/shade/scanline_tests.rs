//! Rows of samples against single ones, where a row is longer than what is shaded at once and some of its triangles
//! have no accurate linear functions.

use super::eight_colors::{EightColors, RowColors};
use super::facet::Interpolation;
use super::spans::{COLUMNS, Span, spans};
use super::{Filter, LightSet, Mode, Shader, Shading, Wireframe, short_spans};
use crate::bvh::Accel;
use crate::camera::{Camera, ImagePlane, Pose, Projection, Rect};
use crate::hit::{Cull, MISS, Precision};
use crate::hits::Hits;
use crate::num::simd::{Plain, Simd};
use crate::random::Random;
use crate::scene::{Attribute, Color, ColorRule, Mesh, MeshData, Object, Scene, Texture};
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

/// A floor and a wall with textures, the floor's by texture coordinates and the wall's from three sides; before the
/// wall a square with another texture and one without.
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
    let scene = textured_scene();
    check(&scene, &shadings);
    // The first bilinear pictures looked up bytes, the others interpolated light that was kept.
    let mut textures = scene.textures();
    assert!(textures.all(|texture| texture.light().is_some()));
}

/// Triangles as small as samples: with area and without, edge-on, and with normals that are zero, that cancel
/// and that lie on both sides.
fn crumbs(random: &mut Random, has_normals: bool) -> Arc<Mesh> {
    let mut data = MeshData::default();
    let mut normals = Vec::new();
    let mut vector = |size: f64| {
        let mut number = || (random.unit() * 2.0 - 1.0) * size;
        DVec3::new(number(), number(), number())
    };
    for number in 0..12_000 {
        let corner = vector(1.0) * DVec3::new(5.0, 1.2, 1.0);
        let towards = (vector(1.0) + DVec3::Z * 2.0).as_vec3().normalize();
        let mut corners = [corner, corner + vector(0.08), corner + vector(0.08)];
        let mut at_corners = [towards; 3].map(|all| (all + vector(0.3).as_vec3()).normalize());
        match number % 20 {
            // Without area, and edge-on.
            0 => corners[2] = corners[1],
            1 => corners[2] = corners[0] + (corners[0] - DVec3::Z * 5.0) * 1e-3,
            3 => at_corners[0] = Vec3::ZERO,
            4 => at_corners[1] = -at_corners[1],
            5 => at_corners = at_corners.map(|normal| -normal),
            6 | 7 => at_corners[2] = Vec3::new(0.9, 0.4, -0.2),
            _ => {}
        }
        let first = data.positions.len() as u32;
        data.positions.extend(corners);
        data.triangles.push([first, first + 1, first + 2]);
        normals.extend(at_corners);
    }
    data.normals = has_normals.then_some(Attribute {
        values: normals,
        indices: None,
    });
    Arc::new(Mesh::new(data))
}

#[test]
fn rows_of_small_triangles_have_the_colours_of_their_samples() {
    let mut random = Random(77);
    let mut with = Object::new("with normals", crumbs(&mut random, true));
    with.color = ColorRule::PerTriangle { seed: 2 };
    let mut turned = with.clone();
    turned.transform.rotate = DVec3::new(10.0, 20.0, 30.0);
    turned.transform.scale = DVec3::new(0.8, 1.0, 1.3);
    let without = Object::new("without normals", crumbs(&mut random, false));
    let floor = quad(FLOOR, false);
    let instances = vec![with.clone(), turned, without.clone(), floor.clone()];
    let mut of_one_color = vec![with.clone(), without.clone(), floor.clone()];
    for object in &mut of_one_color {
        object.color = ColorRule::Uniform(Color([30, 200, 90]));
    }
    let scenes = [vec![with, without, floor], instances, of_one_color];
    // Far from zero the eye is rounded by so much that some of the triangles have no linear functions.
    for (objects, x) in scenes.into_iter().zip([0.0, 3e5, 0.0]) {
        let mut scene = Scene { objects };
        for object in &mut scene.objects {
            object.transform.translate.x = x;
        }
        let mut shadings = Vec::new();
        for mode in [Mode::Smooth, Mode::Normals] {
            for crease in [0.0, 30.0] {
                shadings.push(Shading {
                    mode,
                    crease,
                    ..Shading::default()
                });
            }
        }
        shadings.push(Shading {
            mode: Mode::Smooth,
            back_faces: Some(Color([200, 30, 90])),
            ..Shading::default()
        });
        for lights in [LightSet::Soft, LightSet::Headlight, LightSet::ThreePoint] {
            shadings.push(Shading {
                mode: Mode::Flat,
                lights,
                back_faces: (lights == LightSet::Headlight).then_some(Color([200, 30, 90])),
                ..Shading::default()
            });
        }
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let counts = compare(&scene, (projection, x), &shadings);
            assert!(counts.short > 10_000 && counts.lines > 5_000, "{counts:?}");
        }
    }
}

/// Meshes without normals in the smooth mode.
#[test]
fn rows_of_facets_under_light_have_the_colours_of_their_samples() {
    let crumbs = Object::new("crumbs", crumbs(&mut Random(78), false));
    let wall = Mesh::new(MeshData {
        positions: WALL.to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshData::default()
    });
    let of_one_color = Scene {
        objects: vec![crumbs, Object::new("wall", Arc::new(wall))],
    };
    let mut of_many = of_one_color.clone();
    of_many.objects[0].color = ColorRule::PerTriangle { seed: 2 };
    of_many.objects[1].transform.rotate = DVec3::new(0.0, 0.0, 3.0);
    let mut shadings = Vec::new();
    for lights in [LightSet::Soft, LightSet::Headlight, LightSet::ThreePoint] {
        for (back_faces, wireframe) in [
            (None, None),
            (Some(Color([200, 30, 90])), None),
            (None, Some(Wireframe::default())),
        ] {
            shadings.push(Shading {
                mode: Mode::Smooth,
                lights,
                back_faces,
                wireframe,
                ..Shading::default()
            });
        }
    }
    for (scene, projection) in [
        (&of_one_color, Projection::Perspective),
        (&of_one_color, Projection::Orthographic),
        (&of_many, Projection::Perspective),
        (&of_many, Projection::Orthographic),
    ] {
        let accel = Accel::build(scene).expect("a good scene");
        let camera = camera(projection, 0.0);
        for &shading in &shadings {
            let shader = Shader::new(scene, &accel, camera, shading);
            let way = shader.row_colors(EightColors::Smooth);
            assert!(matches!(way, Some((RowColors::Facets, _))), "{shading:?}");
        }
        let counts = compare(scene, (projection, 0.0), &shadings);
        assert!(
            counts.alone > 30_000 && counts.misses > 10_000,
            "{counts:?}"
        );
    }
}

/// Compares rows with single samples, and sees that both kinds of triangles occur.
fn check(scene: &Scene, shadings: &[Shading]) {
    let counts = compare(scene, (Projection::Perspective, 0.0), shadings);
    assert!(
        counts.lines > 1000 && counts.alone > 1000 && counts.misses > 1000,
        "{counts:?}"
    );
}

/// Of the samples that were compared.
#[derive(Debug, Default)]
struct Counts {
    /// Those whose triangles have linear functions.
    lines: usize,
    /// Those whose triangles have none.
    alone: usize,
    misses: usize,
    /// Those of short spans in rows of such.
    short: usize,
}

fn camera(projection: Projection, x: f64) -> Camera {
    let plane = ImagePlane::new(150, 30, 0.06).expect("a good plane");
    let pose = Pose {
        eye: DVec3::new(x, 0.0, 5.0),
        target: DVec3::new(x, 0.0, 0.0),
        up: DVec3::Y,
    };
    Camera::new(pose, projection, plane)
}

/// Compares rows with single samples, seen from before a point of the x axis.
fn compare(scene: &Scene, (projection, x): (Projection, f64), shadings: &[Shading]) -> Counts {
    let accel = Accel::build(scene).expect("a good scene");
    let camera = camera(projection, x);
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
    let mut counts = Counts::default();
    for row in hits.primitives.chunks(rect.width as usize) {
        for some in row.chunks(COLUMNS) {
            let spans = spans(Plain, some);
            if short_spans::are_worth_it(spans.len(), some.len()) {
                let short = |span: &Span| span.end - span.first <= short_spans::LONGEST;
                let short = spans.filter(|span| span.primitive != MISS && short(span));
                counts.short += short.map(|span| span.end - span.first).sum::<usize>();
            }
        }
    }
    counts.short *= shadings.len() * Simd::available().count();
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
                    counts.misses += 1;
                    continue;
                }
                match tile.facet(hit.primitive, x).interpolation {
                    Interpolation::Linear(_) => counts.lines += 1,
                    _ => counts.alone += 1,
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
    counts
}
