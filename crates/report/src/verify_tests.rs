//! Verification of pictures: good ones pass, and each fault is found.

use super::*;
use crate::cameras::{PROJECTIONS, camera};
use crate::meshes;
use crate::stage::scene_of;
use raycast_core::camera::{Grid, PixelFilter};
use raycast_core::glam::{DVec3, Vec2, Vec3};
use raycast_core::render::Cancel;
use raycast_core::scene::{
    Attribute, Color, ColorRule, Mesh, MeshData, Object, Scalar, ScalarAt, Scene, Texture,
    TextureProjection, Transform,
};
use raycast_core::shade::{Background, Filter, LightSet, Mode, Wireframe};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

#[path = "verify_color_tests.rs"]
mod color_tests;

const SIZE: (u32, u32) = (80, 60);

const WHOLE: Rect = Rect {
    x: 0,
    y: 0,
    width: SIZE.0,
    height: SIZE.1,
};

/// A picture with the claim about it.
struct Made {
    picture: Picture,
    camera: Camera,
    shading: Shading,
    samples: u32,
    pixel_filter: PixelFilter,
}

impl Made {
    fn of(stage: &Stage, camera: Camera, shading: Shading, samples: u32, layers: bool) -> Self {
        let mut view = stage.view(camera, Cull::None);
        view.settings.shading = shading;
        view.settings.samples = samples;
        view.settings.layers = layers;
        let no_clock = || Duration::ZERO;
        let picture = view.render(Grid::default(), &no_clock, &Cancel::default(), &|_| ());
        Self {
            picture: picture.expect("nothing cancelled it"),
            camera,
            shading,
            samples,
            pixel_filter: PixelFilter::Box,
        }
    }

    fn checked(&self, stage: &Stage, most: usize) -> Verification {
        let claim = Claim {
            camera: self.camera,
            rect: WHOLE,
            cull: Cull::None,
            shading: self.shading,
            samples: self.samples,
            pixel_filter: self.pixel_filter,
            picture: &self.picture,
        };
        let counted = AtomicU64::new(0);
        let found = verify(stage, &claim, most, 1, &|more| {
            counted.fetch_add(more, Ordering::Relaxed);
        });
        assert_eq!(counted.into_inner(), found.checked as u64);
        found
    }

    fn layers(&mut self) -> &mut Layers {
        self.picture.layers.as_mut().expect("layers")
    }
}

fn plain() -> Shading {
    Shading {
        mode: Mode::Color,
        ..Shading::default()
    }
}

/// A ball with normals, texture coordinates, vertex colours and a texture, and the same ball rotated and scaled; a
/// box without any of these, and one with a texture but without texture coordinates.
fn furnished() -> Stage {
    let ball = meshes::sphere(DVec3::ZERO, 1.0, 24);
    let normals = ball
        .positions()
        .iter()
        .map(|p| p.normalize_or_zero())
        .collect();
    let uvs = ball
        .positions()
        .iter()
        .map(|p| Vec2::new(p.x * 1.5, p.y - 0.25 * p.z));
    // Every seventh vertex has no colour: its triangles have the object's.
    let colors = (0..ball.positions().len()).map(|i| {
        let byte = |step: usize| (i * step % 256) as u8;
        (i % 7 > 0).then(|| Color([byte(3), byte(50), byte(91)]))
    });
    let shares = ball.positions().iter().map(|p| p.x + 0.5);
    let shares = Scalar {
        name: "share".to_owned(),
        at: ScalarAt::Vertices,
        values: shares.collect(),
    };
    let ball = Arc::new(Mesh::new(MeshData {
        scalars: vec![shares],
        colors: colors.collect(),
        positions: ball.positions().iter().map(|p| p.as_dvec3()).collect(),
        triangles: ball.triangles().to_vec(),
        normals: Some(Attribute {
            values: normals,
            indices: None,
        }),
        uvs: Some(Attribute {
            values: uvs.collect(),
            indices: None,
        }),
        ..MeshData::default()
    }));
    let texels = (0..64u8).map(|i| {
        [
            i * 4,
            255 - i,
            (i % 8) * 30,
            if i % 5 == 0 { 90 } else { 255 },
        ]
    });
    let texture = Texture::new(8, 8, texels.collect()).map(Arc::new);
    let cube = Arc::new(meshes::cuboid(DVec3::splat(-0.4), DVec3::splat(0.4)));
    let object = |mesh: &Arc<Mesh>, translate: DVec3| Object {
        transform: Transform {
            translate,
            rotate: DVec3::new(20.0, 30.0, 40.0),
            scale: DVec3::new(1.0, 0.5, 0.8),
            ..Transform::IDENTITY
        },
        ..Object::new("object", mesh.clone())
    };
    Stage::new(Scene {
        objects: vec![
            Object {
                texture: texture.clone(),
                color: ColorRule::Uniform(Color([200, 40, 90])),
                ..Object::new("ball", ball.clone())
            },
            Object {
                texture: texture.clone(),
                blend_by: Some("share".to_owned()),
                ..object(&ball, DVec3::new(1.5, 0.0, -0.5))
            },
            object(&cube, DVec3::new(-1.2, 0.4, 0.3)),
            Object {
                texture,
                ..object(&cube, DVec3::new(0.2, -1.1, 0.4))
            },
        ],
    })
    .expect("a valid scene")
}

fn views() -> [Camera; 2] {
    PROJECTIONS.map(|projection| {
        let eye = DVec3::new(1.0, 2.0, 3.0);
        camera(eye, DVec3::ZERO, projection, SIZE, 3.6)
    })
}

#[test]
fn a_good_picture_passes_and_each_fault_is_found() {
    let stage = Stage::new(scene_of([
        meshes::sphere(DVec3::ZERO, 1.0, 24),
        meshes::octahedron(),
    ]))
    .expect("a valid scene");
    for projection in PROJECTIONS {
        let eye = DVec3::new(1.0, 2.0, 3.0);
        let camera = camera(eye, DVec3::ZERO, projection, SIZE, 2.4);
        let good = Made::of(&stage, camera, plain(), 1, true);
        let all = good.checked(&stage, 100_000);
        assert_eq!((all.pixels, all.checked, all.wrong), (4800, 4800, 0));
        assert!(all.silhouettes > 100 && all.edges > 500);
        assert_eq!((all.channels.numbers, all.channels.color), (4800, 4800));
        assert!(all.channels.depth > 4000 && all.channels.normal > 4000);
        let some = good.checked(&stage, 300);
        assert_eq!((some.checked, some.wrong), (300, 0));
        assert!(some.silhouettes >= 100 && some.edges >= 100);

        let middle = 30 * 80 + 40;
        let mut bad = good;
        let good = bad.layers().clone();
        for spoil in [
            (|layers, i| layers.triangle[i] += 1) as fn(&mut Layers, usize),
            |layers, i| layers.object[i] = 1 - layers.object[i],
            |layers, i| layers.depth[i] *= 1.000_001,
            |layers, i| layers.depth[i] = f32::NAN,
            |layers, i| layers.depth[i] = f32::INFINITY,
            |layers, i| {
                layers.object[i] = u32::MAX;
                layers.triangle[i] = u32::MAX;
                layers.depth[i] = f32::INFINITY;
            },
            |layers, i| layers.normal[i][1] += 1e-5,
            |layers, i| layers.normal[i] = layers.normal[i].map(|n| -n),
            |layers, i| layers.normal[i][0] = f32::NAN,
            |layers, i| layers.uv[i][0] = 1e-6,
            |layers, i| layers.color[i][2] += 1e-4,
            |layers, i| layers.color[i] = [0.5, 0.5, 0.5, 1.0],
            |layers, i| layers.color[i][3] = 0.999,
        ] {
            *bad.layers() = good.clone();
            spoil(bad.layers(), middle);
            let found = bad.checked(&stage, 4800);
            assert_eq!(found.wrong, 1);
            let first = &found.first_wrong[0];
            assert_eq!((first.x, first.y), (40, 30));
        }
        // Where no ray hits anything: a hit, a colour, a normal.
        for spoil in [
            (|layers| (layers.object[0], layers.triangle[0], layers.depth[0]) = (0, 0, 3.0))
                as fn(&mut Layers),
            |layers| layers.color[0][0] += 1e-4,
            |layers| layers.normal[0][0] = 1e-6,
            |layers| layers.uv[0][1] = 1e-6,
        ] {
            *bad.layers() = good.clone();
            spoil(bad.layers());
            assert_eq!(bad.checked(&stage, 4800).wrong, 1);
        }
    }
}

/// The shader and the independent computation agree on every channel in every mode, with layers and without, and
/// nearly everything is checked; colours that are overwritten everywhere are found nearly everywhere.
#[test]
fn every_mode_is_checked() {
    let stage = furnished();
    let modes = Mode::ALL
        .into_iter()
        .filter(|mode| !matches!(mode, Mode::Wireframe | Mode::XRay));
    for camera in views() {
        for (index, mode) in modes.clone().enumerate() {
            for layers in [true, false] {
                let shading = Shading {
                    mode,
                    blend: [1.0, 0.6][index % 2],
                    filter: [Filter::Bilinear, Filter::Nearest][usize::from(layers)],
                    projection: match index % 3 {
                        0 => TextureProjection::Triplanar,
                        _ => TextureProjection::Uv,
                    },
                    crease: [0.0, 50.0, 100.0][index % 3],
                    lights: [LightSet::Headlight, LightSet::Soft, LightSet::ThreePoint][index % 3],
                    plain_color: Color([200, 190, 120]),
                    background: match index % 4 {
                        0 => Background::Transparent,
                        _ => Background::default(),
                    },
                    ..Shading::default()
                };
                let mut made = Made::of(&stage, camera, shading, 1, layers);
                let found = made.checked(&stage, 100_000);
                let place = format!("{mode:?} {layers} {:?}", camera.projection());
                assert_eq!(found.wrong, 0, "{place}: {:?}", found.first_wrong);
                let Channels {
                    numbers,
                    depth,
                    normal,
                    uv,
                    color,
                } = found.channels;
                // All but grazed triangles.
                let least = 4800 * 19 / 20;
                assert!(color > least, "{place}: {color}");
                let expected = if layers { 4800 } else { 0 };
                assert_eq!(numbers, expected, "{place}");
                for count in [depth, normal, uv] {
                    assert_eq!(count > least, layers, "{place}: {count}");
                }
                // Another colour, two steps of a byte or as much light away.
                for pixel in &mut made.picture.pixels {
                    pixel[1] = pixel[1].wrapping_add(2);
                    pixel[3] = pixel[3].wrapping_add(2);
                }
                if let Some(layers) = &mut made.picture.layers {
                    for color in &mut layers.color {
                        color[2] += 2e-2;
                    }
                }
                let found = made.checked(&stage, 100_000);
                assert!(found.wrong > least, "{place}: {}", found.wrong);
            }
        }
    }
}

#[test]
fn means_of_samples_are_checked() {
    let stage = furnished();
    for (camera, layers) in views().into_iter().zip([true, false]) {
        let mut made = Made::of(&stage, camera, Shading::default(), 5, layers);
        let found = made.checked(&stage, 100_000);
        assert_eq!(found.wrong, 0, "{:?}", found.first_wrong);
        assert!(found.channels.color > 4000, "{}", found.channels.color);
        // With fewer samples, edges have other colours.
        made.samples = 4;
        let found = made.checked(&stage, 100_000);
        assert!(found.wrong > 200, "{}", found.wrong);
    }
}

#[test]
fn filters_are_checked() {
    let stage = furnished();
    for ((name, filter), camera) in PixelFilter::ALL
        .into_iter()
        .zip(views().into_iter().cycle())
    {
        let mut view = stage.view(camera, Cull::None);
        view.settings.shading = Shading::default();
        view.settings.samples = 6;
        view.settings.pixel_filter = filter;
        let picture = view.render(
            Grid::default(),
            &|| Duration::ZERO,
            &Cancel::default(),
            &|_| (),
        );
        let mut made = Made {
            picture: picture.expect("nothing cancelled it"),
            camera,
            shading: Shading::default(),
            samples: 6,
            pixel_filter: filter,
        };
        let found = made.checked(&stage, 100_000);
        assert_eq!(found.wrong, 0, "{name} {:?}", found.first_wrong);
        assert!(
            found.channels.color > 4000,
            "{name} {}",
            found.channels.color
        );
        // With another filter, edges have other colours.
        made.pixel_filter = match filter {
            PixelFilter::Gaussian => PixelFilter::Box,
            _ => PixelFilter::Gaussian,
        };
        let found = made.checked(&stage, 100_000);
        assert!(found.wrong > 100, "{name} {}", found.wrong);
    }
}

#[test]
fn under_lines_no_color_is_checked() {
    let stage = furnished();
    for (mode, wireframe) in [
        (Mode::Flat, Some(Wireframe::default())),
        (Mode::Wireframe, None),
    ] {
        let shading = Shading {
            mode,
            wireframe,
            ..Shading::default()
        };
        let made = Made::of(&stage, views()[0], shading, 1, true);
        let found = made.checked(&stage, 100_000);
        assert_eq!((found.wrong, found.channels.numbers), (0, 4800));
        let layers = made.picture.layers.as_ref().expect("layers");
        let misses = layers.object.iter().filter(|&&object| object == u32::MAX);
        assert_eq!(found.channels.color, misses.count());
    }
}

/// Normals that cancel, have length zero, or point the other way: the picture shows the triangle's own, or the normal
/// is not checked.
#[test]
fn odd_normals_are_no_fault() {
    let normals = [
        [Vec3::X, Vec3::NEG_X, Vec3::ZERO],
        [Vec3::ZERO; 3],
        [Vec3::NEG_Z, Vec3::NEG_Z, Vec3::NEG_Z],
        [Vec3::Z * 1e-30, Vec3::X * 1e30, Vec3::Y],
    ];
    for values in normals {
        let mesh = Mesh::new(MeshData {
            positions: vec![
                DVec3::new(-2.0, -2.0, 0.0),
                DVec3::new(2.0, -2.0, 0.0),
                DVec3::new(0.0, 2.0, 0.0),
            ],
            triangles: vec![[0, 1, 2]],
            normals: Some(Attribute {
                values: values.to_vec(),
                indices: None,
            }),
            ..MeshData::default()
        });
        let stage = Stage::new(scene_of([mesh])).expect("a valid scene");
        let made = Made::of(&stage, views()[0], Shading::default(), 1, true);
        let found = made.checked(&stage, 100_000);
        assert_eq!(found.wrong, 0, "{values:?}: {:?}", found.first_wrong);
    }
}

#[test]
fn only_a_few_wrong_pixels_are_listed_and_all_are_counted() {
    let stage = Stage::new(scene_of([meshes::octahedron()])).expect("a valid scene");
    let camera = camera(DVec3::Z * 3.0, DVec3::ZERO, PROJECTIONS[0], SIZE, 1.0);
    let made = Made {
        picture: Picture::blank(SIZE.0, SIZE.1, true),
        camera,
        shading: plain(),
        samples: 1,
        pixel_filter: PixelFilter::Box,
    };
    let found = made.checked(&stage, 1000);
    assert!(found.wrong > 500 && found.first_wrong.len() == MAX_LISTED);
    let misses = |pixel: &&WrongPixel| pixel.fault == WrongAnswer::Miss;
    assert!(found.first_wrong.iter().filter(misses).count() > 0);
}
