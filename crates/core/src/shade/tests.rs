//! Whole shaders over small scenes.

use super::*;
use crate::bvh::Accel;
use crate::camera::{Camera, ImagePlane, Lattice, Pose, Projection, Rect};
use crate::hit::{Cull, Detail, Precision, PrimitiveHit};
use crate::hits::Hits;
use crate::scene::{
    Attribute, ClippingPlanes, Color, ColorRule, Material, Mesh, MeshData, Object, Photograph,
    Scalar, ScalarAt, Scene, Texture, TextureProjection, Transform,
};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;

const COLUMNS: u32 = 40;
const ROWS: u32 = 30;

/// A square from −1 to 1 at z = 0, of two triangles, with texture coordinates over it.
fn square() -> MeshData {
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    MeshData {
        positions: vec![
            corner(-1.0, -1.0),
            corner(1.0, -1.0),
            corner(1.0, 1.0),
            corner(-1.0, 1.0),
        ],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        uvs: Some(Attribute {
            values: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
            indices: None,
        }),
        ..MeshData::default()
    }
}

fn object(data: MeshData) -> Object {
    let mut object = Object::new("square", Arc::new(Mesh::new(data)));
    object.color = ColorRule::Uniform(Color([200, 100, 50]));
    object
}

fn camera(projection: Projection, eye: DVec3) -> Camera {
    let plane = ImagePlane::new(COLUMNS, ROWS, 0.1).expect("a good plane");
    let pose = Pose {
        eye,
        target: DVec3::ZERO,
        up: DVec3::Y,
    };
    Camera::new(pose, projection, plane)
}

fn front() -> Camera {
    camera(Projection::Perspective, DVec3::new(0.0, 0.0, 5.0))
}

/// A scene with a shader, for the colours of samples.
struct Bench {
    scene: Scene,
    accel: Accel,
    camera: Camera,
}

impl Bench {
    fn new(objects: Vec<Object>, camera: Camera) -> Self {
        let scene = Scene { objects };
        let accel = Accel::build(&scene).expect("a good scene");
        Self {
            scene,
            accel,
            camera,
        }
    }

    fn shader(&self, shading: Shading) -> Shader<'_> {
        Shader::new(&self.scene, &self.accel, self.camera, shading)
    }

    fn hit(&self, x: f64, y: f64) -> PrimitiveHit {
        self.accel
            .cast_primitive(&self.camera.ray(x, y), Cull::None, Precision::Exact)
    }

    fn color(&self, shading: Shading, x: f64, y: f64) -> [f32; 4] {
        self.shader(shading).color(x, y, &self.hit(x, y))
    }
}

fn mode(mode: Mode) -> Shading {
    Shading {
        mode,
        ..Shading::default()
    }
}

fn linear(bytes: [u8; 3]) -> [f32; 4] {
    let [r, g, b] = srgb::linear(Color(bytes)).to_array();
    [r, g, b, 1.0]
}

#[test]
fn colors_are_the_triangles_own() {
    let bench = Bench::new(vec![object(square())], front());
    assert_eq!(
        bench.color(mode(Mode::Color), 20.5, 15.5),
        linear([200, 100, 50])
    );
    // Without a texture that mode shows the object's colours as well.
    assert_eq!(
        bench.color(mode(Mode::Texture), 20.5, 15.5),
        linear([200, 100, 50])
    );
    let shader = bench.shader(mode(Mode::Color));
    assert_eq!(
        shader.shade_pixel8(20.5, 15.5, &bench.hit(20.5, 15.5)),
        [200, 100, 50, 255]
    );
}

#[test]
fn the_background_runs_from_top_to_bottom() {
    let bench = Bench::new(vec![object(square())], front());
    let (top, bottom) = (Color([0, 50, 255]), Color([255, 200, 0]));
    let mut shading = mode(Mode::Flat);
    shading.background = Background::Gradient(top, bottom);
    assert_eq!(bench.color(shading, 0.5, 0.0), linear(top.0));
    assert_eq!(bench.color(shading, 0.5, f64::from(ROWS)), linear(bottom.0));
    shading.background = Background::Transparent;
    assert_eq!(bench.color(shading, 0.5, 0.5), [0.0; 4]);
}

/// Frames are wider than the panoramas, so that rows cross their rims.
#[test]
fn what_lies_behind_a_row_lies_behind_each_of_its_places() {
    for (name, projection) in Projection::all() {
        let eye = DVec3::new(0.0, 0.0, 0.5);
        let bench = Bench::new(vec![object(square())], camera(projection, eye));
        let mut shading = mode(Mode::Flat);
        shading.background = Background::Gradient(Color([0, 50, 255]), Color([255, 200, 0]));
        let shader = bench.shader(shading);
        let (mut shared, mut outside) = (0, 0);
        for row in 0..ROWS {
            let y = f64::from(row) + 0.25;
            for (left, right) in [(0, COLUMNS), (15, 25), (3, 11)] {
                let mut places = (left..right).map(|column| f64::from(column) + 0.75);
                let ends = (f64::from(left) + 0.75, f64::from(right) - 0.25);
                match shader.backdrop_between(ends.0, ends.1, y) {
                    Some(behind) => {
                        assert!(
                            places.all(|x| shader.behind(x, y) == behind),
                            "{name} {row}"
                        );
                        shared += 1;
                    }
                    None => outside += u32::from(places.any(|x| shader.behind(x, y) == [0.0; 4])),
                }
            }
        }
        assert!(shared > 10, "{name}: {shared}");
        let is_bounded = !["perspective", "orthographic", "fisheye:stereographic"].contains(&name);
        assert_eq!(outside > 0, is_bounded, "{name}");
    }
}

#[test]
fn backs_are_lit_as_fronts() {
    for shown in [Mode::Flat, Mode::Smooth, Mode::Normals] {
        let mut turned = square();
        for triangle in &mut turned.triangles {
            triangle.swap(1, 2);
        }
        let normals = Some(Attribute {
            values: vec![Vec3::Z; 4],
            indices: None,
        });
        turned.normals = normals.clone();
        let mut straight = square();
        straight.normals = normals;
        let front_colors = Bench::new(vec![object(straight)], front());
        let back_colors = Bench::new(vec![object(turned)], front());
        assert_eq!(
            front_colors.color(mode(shown), 18.5, 15.5),
            back_colors.color(mode(shown), 18.5, 15.5),
            "{shown:?}"
        );
    }
}

#[test]
fn normals_follow_a_transform_as_planes_do() {
    // The mesh's own normal is at 45° in the xy plane; stretched by two along x, a plane with that normal has (1/2,
    // 1, 0) by its equation.
    let mut data = square();
    data.normals = Some(Attribute {
        values: vec![Vec3::new(1.0, 1.0, 0.5).normalize(); 4],
        indices: None,
    });
    let mut stretched = object(data);
    stretched.transform = Transform {
        scale: DVec3::new(2.0, 1.0, 1.0),
        translate: DVec3::new(0.3, 0.0, 0.0),
        ..Transform::IDENTITY
    };
    let bench = Bench::new(vec![stretched], front());
    let (normal, uv) = bench
        .shader(mode(Mode::Color))
        .surface(20.0, 15.0, &bench.hit(20.0, 15.0));
    let expected = Vec3::new(0.5, 1.0, 0.5).normalize();
    assert!(
        (Vec3::from(normal) - expected).length() < 1e-6,
        "{normal:?}"
    );
    // The middle of the picture sees x = 0, which is −0.3 / 2 in the square.
    assert!((uv[0] - (0.5 - 0.075)).abs() < 1e-5 && (uv[1] - 0.5).abs() < 1e-5);
    let miss = bench
        .shader(mode(Mode::Color))
        .surface(0.0, 0.0, &PrimitiveHit::NONE);
    assert_eq!(miss, ([0.0; 3], [0.0; 2]));
}

#[test]
fn normals_and_texture_coordinates_are_shown_as_they_are() {
    let bench = Bench::new(vec![object(square())], front());
    assert_eq!(
        bench.color(mode(Mode::Normals), 20.5, 15.5),
        linear([128, 128, 255])
    );
    // Half a step to the right of the middle and half a step below: 0.05 of two units.
    let [r, g, _, _] = bench.color(mode(Mode::Uv), 20.5, 15.5);
    assert_eq!(
        (r, g),
        (
            linear([(0.525f32 * 255.0 + 0.5) as u8; 3])[0],
            linear([(0.475f32 * 255.0 + 0.5) as u8; 3])[0]
        )
    );
}

#[test]
fn near_is_lighter_than_far() {
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let mut far = object(square());
        far.transform.translate = DVec3::new(1.0, 0.0, -2.0);
        let bench = Bench::new(
            vec![object(square()), far],
            camera(projection, DVec3::new(0.0, 0.0, 5.0)),
        );
        let near = bench.color(mode(Mode::Depth), 15.5, 15.5)[0];
        let far = bench.color(mode(Mode::Depth), 32.5, 15.5)[0];
        assert!(near > 0.8 && far < 0.4, "{projection:?}: {near} {far}");
    }
}

/// A photograph of a square that is half as high as the image.
const FROM_THE_FRONT: Photograph = Photograph {
    eye: DVec3::new(0.0, 0.0, 5.0),
    target: DVec3::ZERO,
    up: DVec3::Y,
    fov: 45.0,
    shift: [0.0; 2],
    lens: None,
};

#[test]
fn textures_mix_with_colors_in_linear_light() {
    let texture = Texture::new(1, 1, vec![[0, 200, 255, 255]]).expect("a good texture");
    let mut textured = object(square());
    textured.texture = Some(Arc::new(texture));
    textured.mapping.photograph = Some(FROM_THE_FRONT);
    let bench = Bench::new(vec![textured], front());
    let (own, image) = (linear([200, 100, 50]), linear([0, 200, 255]));
    for projection in TextureProjection::ALL {
        for blend in [0.0, 0.25, 1.0] {
            let shading = Shading {
                blend,
                projection,
                ..mode(Mode::Texture)
            };
            let found = bench.color(shading, 22.5, 12.5);
            for channel in 0..4 {
                let expected = own[channel] * (1.0 - blend) + image[channel] * blend;
                assert!(
                    (found[channel] - expected).abs() < 1e-6,
                    "{found:?} at {blend}"
                );
            }
        }
    }
}

/// One of two triangles has a material with an image. An object's own image takes precedence, and colour rules other
/// than the file's hide the material's.
#[test]
fn a_materials_texture_shows_on_its_triangles_only() {
    let texture = |texel: [u8; 3]| {
        let [r, g, b] = texel;
        Texture::new(1, 1, vec![[r, g, b, 255]]).map(Arc::new)
    };
    let plain = Material::new("plain", Color([9, 8, 7]));
    let image = Material {
        texture: texture([0, 200, 255]),
        ..Material::new("image", Color([200, 100, 50]))
    };
    let of = |color: ColorRule, own: Option<Arc<Texture>>| {
        let mut textured = object(MeshData {
            materials: vec![plain.clone(), image.clone()],
            material_of_triangle: vec![1, 0],
            ..square()
        });
        textured.color = color;
        textured.texture = own;
        let bench = Bench::new(vec![textured], front());
        // Below the diagonal is the first triangle, above it the second.
        [(22.5, 17.5), (17.5, 12.5)].map(|(x, y)| bench.color(mode(Mode::Texture), x, y))
    };
    let near = |found: [[f32; 4]; 2], expected: [[u8; 3]; 2]| {
        for (found, expected) in found.iter().zip(expected.map(linear)) {
            for channel in 0..4 {
                let off = (found[channel] - expected[channel]).abs();
                assert!(off < 1e-6, "{found:?}, not {expected:?}");
            }
        }
    };
    near(of(ColorRule::File, None), [[0, 200, 255], [9, 8, 7]]);
    near(of(ColorRule::File, texture([1, 2, 3])), [[1, 2, 3]; 2]);
    let grey = Color([50; 3]);
    near(of(ColorRule::Uniform(grey), None), [[50; 3]; 2]);
}

#[test]
fn a_texture_stands_upright() {
    // Red above, green below; the square's top is v = 1.
    let texture = Texture::new(1, 2, vec![[255, 0, 0, 255], [0, 255, 0, 255]]);
    let mut textured = object(square());
    textured.texture = texture.map(Arc::new);
    textured.mapping.photograph = Some(FROM_THE_FRONT);
    let bench = Bench::new(vec![textured], front());
    // The square's diagonal is the bottom of a triangle that is laid into the image.
    let upright = TextureProjection::ALL
        .iter()
        .filter(|p| **p != TextureProjection::PerTriangle);
    for &projection in upright {
        let shading = Shading {
            filter: Filter::Nearest,
            projection,
            ..mode(Mode::Texture)
        };
        assert_eq!(bench.color(shading, 20.5, 8.5), [1.0, 0.0, 0.0, 1.0]);
        assert_eq!(bench.color(shading, 20.5, 21.5), [0.0, 1.0, 0.0, 1.0]);
    }
}

/// The truth is the line between the two colours, at the interpolated number.
#[test]
fn a_scalar_blends_the_texture_in() {
    let with = |values: [f32; 4]| {
        let mut object = object(MeshData {
            scalars: vec![Scalar {
                name: "share".to_owned(),
                at: ScalarAt::Vertices,
                values: values.to_vec(),
            }],
            ..square()
        });
        object.texture = Texture::new(1, 1, vec![[0, 255, 0, 255]]).map(Arc::new);
        object.blend_by = Some("share".to_owned());
        Bench::new(vec![object], front())
    };
    let shading = Shading {
        blend: 0.5,
        ..mode(Mode::Texture)
    };
    let (own, image) = (linear([200, 100, 50]), linear([0, 255, 0]));
    // From 0 on the left to 1 on the right, clamped beyond.
    for (values, least) in [([0.0, 1.0, 1.0, 0.0], 0.0), ([-9.0, 1.0, 1.0, -9.0], -9.0)] {
        let bench = with(values);
        for x in [10.5, 15.5, 20.5, 29.5] {
            let found = bench.color(shading, x, 15.3);
            let share = least + (1.0 - least) * (x as f32 - 10.0) / 20.0;
            let blend = 0.5 * share.clamp(0.0, 1.0);
            for channel in 0..3 {
                let expected = own[channel] * (1.0 - blend) + image[channel] * blend;
                assert!((found[channel] - expected).abs() < 1e-5, "{found:?} at {x}");
            }
        }
    }
    // Without a number, all of the picture's blend shows.
    let mut plain = with([f32::NAN; 4]);
    let none = plain.color(shading, 15.5, 15.3);
    plain.scene.objects[0].blend_by = None;
    assert_eq!(none, plain.color(shading, 15.5, 15.3));
}

#[test]
fn lines_lie_on_edges_alone() {
    let bench = Bench::new(vec![object(square())], front());
    let line = Wireframe {
        width: 1.5,
        color: Color([255, 0, 255]),
        ..Wireframe::default()
    };
    let shading = Shading {
        wireframe: Some(line),
        background: Background::Transparent,
        ..mode(Mode::Wireframe)
    };
    // The square reaches from column 10 to 30 and from row 5 to 25.
    let within = bench.color(shading, 24.5, 19.5);
    assert_eq!(within, [0.0; 4]);
    let on_edge = bench.color(shading, 10.25, 15.5);
    assert_eq!(on_edge, linear([255, 0, 255]));
    let over = Shading {
        mode: Mode::Color,
        ..shading
    };
    assert_eq!(bench.color(over, 24.5, 19.5), linear([200, 100, 50]));
    assert_eq!(bench.color(over, 10.25, 15.5), linear([255, 0, 255]));
    // The mode draws lines even if none are set.
    let bare = Shading {
        wireframe: None,
        ..shading
    };
    assert!(bench.color(bare, 10.25, 15.5)[3] > 0.5);
}

#[test]
fn tiles_remember_without_a_trace() {
    check_tiles(false);
}

/// One object has normals and a texture, the one beside it has neither.
#[test]
fn cached_triangles_keep_their_own_objects_normals_and_textures() {
    check_tiles(true);
}

fn check_tiles(with_normals: bool) {
    // More triangles than a tile caches, so that entries are reused.
    let size = 20;
    let mut data = MeshData::default();
    for y in 0..=size {
        for x in 0..=size {
            let (x, y) = (f64::from(x) / 10.0 - 1.0, f64::from(y) / 10.0 - 1.0);
            data.positions.push(DVec3::new(x, y, x * y * 0.5));
        }
    }
    for y in 0..size {
        for x in 0..size {
            let at = (y * (size + 1) + x) as u32;
            let above = at + size as u32 + 1;
            data.triangles
                .extend([[at, at + 1, above], [at + 1, above + 1, above]]);
        }
    }
    if with_normals {
        let normal = |p: &DVec3| DVec3::new(-p.y, -p.x, 2.0).normalize().as_vec3();
        data.normals = Some(Attribute {
            values: data.positions.iter().map(normal).collect(),
            indices: None,
        });
        data.uvs = Some(Attribute {
            values: data
                .positions
                .iter()
                .map(|p| p.as_vec3().truncate() * 1.7)
                .collect(),
            indices: None,
        });
    }
    let mut colorful = object(data);
    colorful.color = ColorRule::PerTriangle { seed: 3 };
    colorful.texture = Texture::new(2, 1, vec![[9, 80, 200, 255], [250, 3, 7, 100]]).map(Arc::new);
    let eye = DVec3::new(2.0, 1.0, 4.0);
    let mut beside = object(square());
    if with_normals {
        let texels = (0..15).map(|i| [i * 16, 255 - i * 9, i * i, 255 - i]);
        beside.texture = Texture::new(5, 3, texels.collect()).map(Arc::new);
    }
    let bench = Bench::new(vec![colorful, beside], camera(Projection::Perspective, eye));
    let rect = Rect {
        x: 3,
        y: 2,
        width: 33,
        height: 27,
    };
    let places: Vec<(f64, f64)> = (rect.y..rect.bottom())
        .flat_map(|y| (rect.x..rect.right()).map(move |x| (f64::from(x) + 0.5, f64::from(y) + 0.5)))
        .collect();
    let hits: Hits = places.iter().map(|&(x, y)| bench.hit(x, y)).collect();
    let mut lattice = bench.camera.sub_camera(rect).lattice();
    lattice.offset = (0.3, 0.8);
    let samples: Vec<(f64, f64)> = (0..lattice.rows)
        .flat_map(|row| (0..lattice.columns).map(move |column| lattice.place(column, row)))
        .collect();
    let sample_hits: Hits = samples.iter().map(|&(x, y)| bench.hit(x, y)).collect();
    let outlined = |edges: &str, hidden: f32| {
        Some(Wireframe {
            edges: edges.parse().expect("kinds of edges"),
            hidden,
            ..Wireframe::default()
        })
    };
    for shown in Mode::ALL {
        for (wireframe, ground) in [
            (None, None),
            (Some(Wireframe::default()), None),
            (None, Some(Ground::Lowest)),
            (None, Some(Ground::At(0.1))),
            (outlined("all", 0.3), None),
            (outlined("silhouette", 0.0), None),
            (outlined("silhouette,boundary", 0.5), Some(Ground::At(0.1))),
        ] {
            let filters = [
                Filter::Nearest,
                Filter::Bilinear,
                Filter::Trilinear,
                Filter::Ewa,
            ];
            for (index, projection) in TextureProjection::ALL.into_iter().enumerate() {
                let shading = Shading {
                    wireframe,
                    ground,
                    blend: if index == 0 { 0.0 } else { 0.7 },
                    projection,
                    filter: filters[index % 4],
                    ..mode(shown)
                };
                let shader = bench.shader(shading).with_overlay(&ClippingPlanes::NONE);
                let mut pixels = vec![[0; 4]; rect.area()];
                let columns = rect.width as usize;
                shader.tile().shade(rect, &hits, pixels.chunks_mut(columns));
                if shader.detail() == Detail::Triangle {
                    let mut from_primitives = vec![[0; 4]; rect.area()];
                    shader.tile().shade_primitives(
                        rect,
                        &hits.primitives,
                        from_primitives.chunks_mut(columns),
                    );
                    assert_eq!(pixels, from_primitives, "{shading:?}");
                }
                let mut tile = shader.tile();
                for ((&(x, y), hit), pixel) in places.iter().zip(hits.iter()).zip(&pixels) {
                    assert_eq!(*pixel, shader.shade_pixel8(x, y, &hit), "{shading:?}");
                    assert_eq!(*pixel, tile.pixel8(x, y, &hit), "{shading:?}");
                    let color = shader.color(x, y, &hit);
                    assert_eq!(color, tile.color(x, y, &hit), "{shading:?}");
                    assert!(color.iter().all(|channel| (0.0..=1.0).contains(channel)));
                }
                let mut light = Vec::new();
                shader.tile().light(&lattice, &sample_hits, &mut light);
                for ((&(x, y), hit), found) in samples.iter().zip(sample_hits.iter()).zip(&light) {
                    assert_eq!(*found, shader.color(x, y, &hit), "{shading:?}");
                }
                if shown == Mode::XRay {
                    check_opacities(&bench, &shader, &lattice, &sample_hits);
                }
            }
        }
    }
    channels_are_those_of_single_samples(&bench, &lattice, &sample_hits);
}

/// Opacities of thin shells against those of the layers' normals and the rays' directions.
fn check_opacities(bench: &Bench, shader: &Shader<'_>, lattice: &Lattice, hits: &Hits) {
    let mut opacities = Vec::new();
    shader.tile().opacities(lattice, hits, &mut opacities);
    let alpha = f64::from(Shading::default().x_ray_opacity);
    let mut sum = 0.0;
    for (at, (hit, opacity)) in (0..).zip(hits.iter().zip(&opacities)) {
        if hit.is_miss() {
            continue;
        }
        let (x, y) = lattice.place(at % lattice.columns, at / lattice.columns);
        let (normal, _) = shader.surface(x, y, &hit);
        let direction = bench.camera.ray(x, y).direction.normalize();
        let cosine = Vec3::from(normal).as_dvec3().dot(direction).abs();
        let expected = alpha / (alpha + (1.0 - alpha) * cosine);
        assert!((f64::from(*opacity) - expected).abs() < 1e-6, "{at}");
        sum += expected;
    }
    assert!(sum > 10.0, "{sum}");
}

fn channels_are_those_of_single_samples(bench: &Bench, lattice: &Lattice, hits: &Hits) {
    let count = hits.len();
    let mut depth = vec![-1.0; count];
    let (mut object, mut triangle) = (vec![77; count], vec![78; count]);
    let (mut normal, mut uv) = (vec![[2.0; 3]; count], vec![[3.0; 2]; count]);
    let shader = bench.shader(mode(Mode::Depth));
    let columns = lattice.columns as usize;
    let numbers = depth.chunks_mut(columns).zip(object.chunks_mut(columns));
    let numbers = numbers.zip(triangle.chunks_mut(columns));
    let vectors = normal.chunks_mut(columns).zip(uv.chunks_mut(columns));
    let rows = numbers.zip(vectors);
    let rows = rows.map(|(((depth, object), triangle), (normal, uv))| Channels {
        depth,
        object,
        triangle,
        normal,
        uv,
    });
    shader.tile().channels(lattice, hits, rows);
    let mut shown = 0;
    for (at, hit) in hits.iter().enumerate() {
        let found = (depth[at], object[at], triangle[at], normal[at], uv[at]);
        if hit.is_miss() {
            let nothing = (f32::INFINITY, u32::MAX, u32::MAX, [0.0; 3], [0.0; 2]);
            assert_eq!(found, nothing);
            continue;
        }
        shown += 1;
        let numbers = bench.accel.identify(hit.primitive);
        let (x, y) = lattice.place(at as u32 % lattice.columns, at as u32 / lattice.columns);
        let surface = shader.surface(x, y, &hit);
        assert_eq!(found, (hit.t, numbers.0, numbers.1, surface.0, surface.1));
    }
    assert!(shown > 100 && shown < count, "{shown} of {count}");
}

/// Depths and weights of triangles of a few pixels are interpolated from the corners.
#[test]
fn depths_of_small_triangles_come_from_hits() {
    let pose = Pose {
        eye: DVec3::new(0.0, 0.0, 5.0),
        target: DVec3::ZERO,
        up: DVec3::Y,
    };
    for (side, expected) in [(5, Detail::Full), (6, Detail::Triangle)] {
        let plane = ImagePlane::new(side, side, 0.1).expect("a good plane");
        let camera = Camera::new(pose, Projection::Perspective, plane);
        let bench = Bench::new(vec![object(square())], camera);
        for shown in [Mode::Depth, Mode::Barycentric] {
            assert_eq!(bench.shader(mode(shown)).detail(), expected, "{shown:?}");
        }
    }
}
