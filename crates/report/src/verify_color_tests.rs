//! Verification of colours: photographs, materials, colour rules and colour maps.

use super::{Made, furnished, views};
use crate::meshes;
use crate::stage::Stage;
use raycast_core::glam::{DVec3, Vec2};
use raycast_core::scene::{
    Alpha, Attribute, Color, ColorMap, ColorScale, Groups, Material, Mesh, MeshData, Object,
    Opacity, Photograph, Reflectance, Scalar, ScalarAt, Scene, Texture, TextureProjection,
};
use raycast_core::shade::{Background, Filter, LightSet, Mode, Shading};
use std::sync::Arc;

/// Photographs on objects with and without transform; some surfaces are hidden from them, some are outside their
/// frame.
#[test]
fn photographs_are_checked() {
    let mut scene = Scene::clone(&furnished().scene);
    for (number, object) in scene.objects.iter_mut().enumerate() {
        object.mapping.photograph = Some(Photograph {
            eye: DVec3::new(-2.0, 1.0, 2.5),
            target: DVec3::new(0.2, 0.1, 0.0),
            up: DVec3::new(0.1, 1.0, 0.0),
            fov: [35.0, 60.0][number % 2],
            shift: [0.0, 0.1 * number as f64],
            lens: None,
        });
    }
    let stage = Stage::new(scene).expect("a valid scene");
    for (at, camera) in views().into_iter().enumerate() {
        let shading = Shading {
            mode: [Mode::Texture, Mode::Smooth][at],
            filter: [Filter::Nearest, Filter::Bilinear][at],
            projection: TextureProjection::Camera,
            ..Shading::default()
        };
        let mut made = Made::of(&stage, camera, shading, 1, true);
        let found = made.checked(&stage, 100_000);
        assert_eq!(found.wrong, 0, "{:?}", found.first_wrong);
        let color = found.channels.color;
        assert!(color > 4800 * 9 / 10, "{color}");
        // The picture as if the photograph saw everything.
        let everywhere = Shading {
            projection: TextureProjection::Triplanar,
            ..shading
        };
        let other = Made::of(&stage, camera, everywhere, 1, true);
        let differs = |(a, b): &(&[u8; 4], &[u8; 4])| a != b;
        let pairs = made.picture.pixels.iter().zip(&other.picture.pixels);
        let different = pairs.filter(differs).count();
        made.picture = other.picture;
        let found = made.checked(&stage, 100_000);
        assert!(
            found.wrong > different * 9 / 10,
            "{} of {different}",
            found.wrong
        );
    }
}

/// A ball of six materials: metals and dielectrics, smooth and rough, with images, with emission, and without
/// reflectance.
fn material_ball() -> Stage {
    let ball = meshes::sphere(DVec3::ZERO, 1.0, 24);
    let positions = || ball.positions().iter();
    let image = |step: usize| {
        let byte = move |i: usize, by: usize| (i * by * step % 251) as u8;
        let texels = (0..64).map(|i| [byte(i, 37), byte(i, 61), byte(i, 83), 255]);
        Texture::new(8, 8, texels.collect()).map(Arc::new)
    };
    let rough = |metallic, roughness| Reflectance {
        metallic,
        roughness,
        ..Reflectance::default()
    };
    let known = [
        rough(0.0, 0.3),
        rough(1.0, 0.6),
        Reflectance {
            texture: image(1),
            ..rough(1.0, 1.0)
        },
        Reflectance {
            emission: [0.2, 1.5, 0.0],
            emission_texture: image(2),
            ..rough(0.5, 0.2)
        },
        Reflectance {
            is_unlit: true,
            ..rough(1.0, 0.0)
        },
    ];
    let mut materials: Vec<Material> = known
        .into_iter()
        .map(|known| Material {
            reflectance: Some(Arc::new(known)),
            texture: image(3),
            ..Material::new("known", Color([210, 120, 60]))
        })
        .collect();
    materials.push(Material::new("unknown", Color([90, 160, 210])));
    materials[0].texture = None;
    materials[1].by_vertex = true;
    let triangles = ball.triangles().to_vec();
    let mesh = Mesh::new(MeshData {
        positions: positions().map(|p| p.as_dvec3()).collect(),
        uvs: Some(Attribute {
            values: positions()
                .map(|p| Vec2::new(p.x * 1.5, p.y - 0.25 * p.z))
                .collect(),
            indices: None,
        }),
        colors: (0..ball.positions().len())
            .map(|i| Some(Color([1, 2, 3].map(|by| (60 + i * by * 7 % 190) as u8))))
            .collect(),
        material_of_triangle: (0..triangles.len() as u32).map(|i| i % 6).collect(),
        triangles,
        materials,
        ..MeshData::default()
    });
    let cube = meshes::cuboid(DVec3::new(-2.0, -1.3, -2.0), DVec3::new(2.0, -1.1, 2.0));
    Stage::new(Scene {
        objects: vec![
            Object::new("ball", Arc::new(mesh)),
            Object::new("floor", Arc::new(cube)),
        ],
    })
    .expect("a good scene")
}

/// Every material under every light: nothing is wrong, nearly everything is checked, and a wrong brightness is found.
#[test]
fn materials_are_checked() {
    let stage = material_ball();
    for camera in views() {
        for lights in [LightSet::Soft, LightSet::Headlight, LightSet::ThreePoint] {
            for filter in [Filter::Bilinear, Filter::Nearest] {
                let shading = Shading {
                    mode: Mode::Material,
                    lights,
                    filter,
                    crease: 60.0,
                    ..Shading::default()
                };
                let mut made = Made::of(&stage, camera, shading, 1, true);
                let found = made.checked(&stage, 100_000);
                let place = format!("{lights:?} {filter:?} {:?}", camera.projection());
                assert_eq!(found.wrong, 0, "{place}: {:?}", found.first_wrong);
                let least = 4800 * 9 / 10;
                assert!(
                    found.channels.color > least,
                    "{place}: {}",
                    found.channels.color
                );
                if let Some(layers) = &mut made.picture.layers {
                    for color in &mut layers.color {
                        color[1] = color[1] * 1.02 + 1e-2;
                    }
                }
                let found = made.checked(&stage, 100_000);
                assert!(found.wrong > least, "{place}: {}", found.wrong);
            }
        }
    }
}

/// Two objects with scalars, groups and this colour rule.
fn ruled(rule: &str) -> Stage {
    let scalars = |vertices: usize, triangles: usize| {
        let scalar = |name: &str, at, count: usize| Scalar {
            name: name.to_owned(),
            at,
            values: (0..count)
                .map(|i| (i * 37 % 101) as f32 * 0.3 - 7.0)
                .collect(),
        };
        vec![
            scalar("vertex", ScalarAt::Vertices, vertices),
            scalar("face", ScalarAt::Triangles, triangles),
        ]
    };
    let groups = |triangles: usize| {
        let of =
            (0..triangles).map(|at| [None, Some(0), Some(1)].get(at / 5 % 3).copied().flatten());
        Groups::of_triangles(vec!["a".to_owned(), "b".to_owned()], of).expect("good groups")
    };
    let object = |mesh: &Mesh, x: f64| {
        let positions = mesh.positions().iter();
        let mut object = Object::new(
            "object",
            Arc::new(Mesh::new(MeshData {
                positions: positions.map(|p| p.as_dvec3() + mesh.offset()).collect(),
                groups: groups(mesh.triangles().len()),
                triangles: mesh.triangles().to_vec(),
                scalars: scalars(mesh.positions().len(), mesh.triangles().len()),
                ..MeshData::default()
            })),
        );
        object.color = rule.parse().expect("a rule");
        object.transform.translate.x = x;
        object.transform.rotate = DVec3::new(10.0, 20.0, 30.0);
        object
    };
    let objects = vec![
        object(&meshes::sphere(DVec3::ZERO, 1.0, 12), -0.9),
        object(&meshes::cuboid(DVec3::splat(-0.7), DVec3::splat(0.7)), 1.2),
    ];
    Stage::new(Scene { objects }).expect("a valid scene")
}

#[test]
fn every_color_rule_except_curvature_is_checked() {
    let rules = [
        "object",
        "group",
        "normal",
        "area",
        "distance",
        "distance:1,2,-3",
        "scalar:vertex",
        "scalar:face",
        "curvature",
    ];
    let least = 4800 * 18 / 20;
    for (index, rule) in rules.into_iter().enumerate() {
        let stage = ruled(rule);
        for camera in views() {
            for range in [None, Some([-2.0, 5.0])] {
                let shading = Shading {
                    mode: [Mode::Color, Mode::Smooth, Mode::Flat][index % 3],
                    scale: Some(ColorScale {
                        map: ColorMap::ALL[index % 5],
                        range,
                        legend: false,
                    }),
                    ..Shading::default()
                };
                let mut made = Made::of(&stage, camera, shading, 1, true);
                let found = made.checked(&stage, 100_000);
                let place = format!("{rule} {range:?} {:?}", camera.projection());
                assert_eq!(found.wrong, 0, "{place}: {:?}", found.first_wrong);
                if rule == "curvature" {
                    assert!(found.channels.color < least, "{place}");
                    continue;
                }
                assert!(
                    found.channels.color > least,
                    "{place}: {}",
                    found.channels.color
                );
                for color in &mut made.layers().color {
                    color[2] += 2e-2;
                }
                let found = made.checked(&stage, 100_000);
                assert!(found.wrong > least, "{place}: {}", found.wrong);
            }
        }
    }
}

#[test]
fn depth_through_a_color_map_is_checked_outside_the_legend() {
    let stage = ruled("file");
    for camera in views() {
        for (range, legend) in [(None, false), (Some([1.0, 4.0]), true)] {
            let shading = Shading {
                mode: Mode::Depth,
                scale: Some(ColorScale {
                    map: ColorMap::Turbo,
                    range,
                    legend,
                }),
                ..Shading::default()
            };
            let made = Made::of(&stage, camera, shading, 1, true);
            let found = made.checked(&stage, 100_000);
            assert_eq!(found.wrong, 0, "{range:?}: {:?}", found.first_wrong);
            assert!(
                found.channels.color > 4800 * 18 / 20,
                "{}",
                found.channels.color
            );
        }
    }
}

/// A ball of three materials, of which two are blended, one with the alpha of an image, around an opaque box; in front of
/// another such ball.
fn glass() -> Stage {
    let ball = meshes::sphere(DVec3::ZERO, 1.0, 24);
    let texels = (0..64u8).map(|i| [i * 4, 255 - i, (i % 8) * 30, 60 + 3 * i]);
    let image = Texture::new(8, 8, texels.collect()).map(Arc::new);
    let blended = |factor, image| Material {
        opacity: Opacity::Blend(Alpha { factor, image }),
        ..Material::new("glass", Color([120, 160, 210]))
    };
    let materials = vec![
        blended(0.375, None),
        blended(0.875, image),
        Material::new("solid", Color([210, 120, 60])),
    ];
    let triangles = ball.triangles().to_vec();
    let positions = || ball.positions().iter();
    let mesh = Mesh::new(MeshData {
        positions: positions().map(|p| p.as_dvec3()).collect(),
        uvs: Some(Attribute {
            values: positions().map(|p| Vec2::new(p.x * 1.5, p.y)).collect(),
            indices: None,
        }),
        material_of_triangle: (0..triangles.len() as u32).map(|at| at / 7 % 3).collect(),
        triangles,
        materials,
        ..MeshData::default()
    });
    let mesh = Arc::new(mesh);
    let mut behind = Object::new("behind", Arc::clone(&mesh));
    behind.transform.translate = DVec3::new(-0.7, -1.5, -2.0);
    let cube = meshes::cuboid(DVec3::splat(-0.4), DVec3::splat(0.5));
    let objects = vec![
        Object::new("ball", mesh),
        behind,
        Object::new("box", Arc::new(cube)),
    ];
    Stage::new(Scene { objects }).expect("a valid scene")
}

/// The layers of x-ray pictures and of blended materials, in their order; a picture of which layers have another opacity is
/// wrong nearly everywhere where any is seen.
#[test]
fn layers_are_checked() {
    for (stage, modes) in [
        (furnished(), &[Mode::XRay][..]),
        (
            glass(),
            &[
                Mode::XRay,
                Mode::Smooth,
                Mode::Flat,
                Mode::Color,
                Mode::Material,
            ],
        ),
    ] {
        for (camera, has_layers) in views().into_iter().zip([true, false]) {
            for &mode in modes {
                let shading = Shading {
                    mode,
                    x_ray_opacity: 0.25,
                    background: match mode {
                        Mode::Flat => Background::Transparent,
                        _ => Background::default(),
                    },
                    back_faces: (mode == Mode::Color).then_some(Color([90, 30, 30])),
                    ..Shading::default()
                };
                let mut made = Made::of(&stage, camera, shading, 1, has_layers);
                let found = made.checked(&stage, 100_000);
                let place = format!("{mode:?} {:?}", camera.projection());
                assert_eq!(found.wrong, 0, "{place}: {:?}", found.first_wrong);
                let color = found.channels.color;
                assert!(color > 4800 * 3 / 4, "{place}: {color}");
                // As if x-ray's surfaces were fainter, and blended ones opaque.
                made.shading.x_ray_opacity = 0.125;
                let found = made.checked(&stage, 100_000);
                let is_wrong = mode != Mode::XRay || found.wrong > 500;
                assert!(is_wrong, "{place}: {}", found.wrong);
                made.shading.x_ray_opacity = 0.25;
                for pixel in &mut made.picture.pixels {
                    pixel[1] = pixel[1].wrapping_add(2);
                }
                if let Some(layers) = &mut made.picture.layers {
                    for color in &mut layers.color {
                        color[2] += 2e-3;
                    }
                }
                let found = made.checked(&stage, 100_000);
                assert!(
                    found.wrong > color * 9 / 10,
                    "{place}: {} of {color}",
                    found.wrong
                );
            }
        }
    }
}
