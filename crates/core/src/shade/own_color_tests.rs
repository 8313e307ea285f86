//! Pictures of each colour rule, against values computed by hand.

use super::own_color::{OwnColors, own_color};
use super::ramp::NO_NUMBER;
use super::*;
use crate::bvh::Accel;
use crate::camera::{Camera, ImagePlane, Pose, Projection, Rect};
use crate::hit::{Cull, Hit, Precision, PrimitiveHit};
use crate::hits::Hits;
use crate::scene::{
    Color, ColorMap, ColorRule, ColorScale, Curvature, Groups, Material, Mesh, MeshData, Object,
    Quantity, Scalar, ScalarAt, Scene, Shape, Transform,
};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Two triangles from −1 to 1 at z = 0, with a scalar x + 10 at vertices, and one of 5 and 7 on triangles; the
/// second triangle is in a group.
fn square(rule: &str) -> Object {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let scalar = |name: &str, at, values: &[f32]| Scalar {
        name: name.to_owned(),
        at,
        values: values.to_vec(),
    };
    let mesh = Mesh::new(MeshData {
        positions: corners.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        groups: Groups::of_triangles(vec!["upper".to_owned()], [None, Some(0)]).expect("a group"),
        scalars: vec![
            scalar("x", ScalarAt::Vertices, &[9.0, 11.0, 11.0, 9.0]),
            scalar("part", ScalarAt::Triangles, &[5.0, 7.0]),
            scalar("some", ScalarAt::Triangles, &[f32::NAN, 7.0]),
        ],
        ..MeshData::default()
    });
    let mut object = Object::new("square", Arc::new(mesh));
    object.color = rule.parse().expect("a rule");
    object
}

fn camera(projection: Projection) -> Camera {
    let plane = ImagePlane::new(40, 30, 0.1).expect("a good plane");
    let pose = Pose {
        eye: DVec3::new(0.0, 0.0, 5.0),
        target: DVec3::ZERO,
        up: DVec3::Y,
    };
    Camera::new(pose, projection, plane)
}

struct Picture {
    scene: Scene,
    accel: Accel,
    camera: Camera,
    shading: Shading,
}

impl Picture {
    fn of(objects: Vec<Object>, projection: Projection, scale: ColorScale) -> Self {
        let scene = Scene { objects };
        Self {
            accel: Accel::build(&scene).expect("a good scene"),
            scene,
            camera: camera(projection),
            shading: Shading {
                mode: Mode::Color,
                scale: Some(scale),
                ..Shading::default()
            },
        }
    }

    fn shader(&self) -> Shader<'_> {
        Shader::new(&self.scene, &self.accel, self.camera, self.shading)
    }

    fn at(&self, x: f64, y: f64) -> Vec3 {
        let ray = self.camera.ray(x, y);
        let hit: PrimitiveHit = self
            .accel
            .cast_primitive(&ray, Cull::None, Precision::Exact);
        let [r, g, b, _] = self.shader().color(x, y, &hit);
        Vec3::new(r, g, b)
    }
}

fn scale(low: f64, high: f64) -> ColorScale {
    ColorScale {
        range: Some([low, high]),
        ..ColorScale::default()
    }
}

fn viridis(share: f64) -> Vec3 {
    let colors = ColorMap::Viridis.colors().map(srgb::linear);
    let place = share * 255.0;
    let step = (place as usize).min(254);
    colors[step].lerp(colors[step + 1], (place - step as f64) as f32)
}

fn is_near(found: Vec3, expected: Vec3) {
    assert!(found.distance(expected) < 2e-5, "{found} {expected}");
}

#[test]
fn scalars_of_vertices_are_interpolated_and_of_triangles_are_not() {
    let of = |rule: &str, scale| Picture::of(vec![square(rule)], Projection::Perspective, scale);
    // Pixel (25, 18) shows the point (0.5, −0.3): the step is 0.1 at the target.
    is_near(
        of("scalar:x", scale(9.0, 13.0)).at(25.0, 18.0),
        viridis(1.5 / 4.0),
    );
    is_near(
        of("scalar:x", ColorScale::default()).at(25.0, 18.0),
        viridis(0.75),
    );
    is_near(
        of("scalar:part", ColorScale::default()).at(25.0, 18.0),
        viridis(0.0),
    );
    is_near(
        of("scalar:part", scale(3.0, 8.0)).at(15.0, 12.0),
        viridis(4.0 / 5.0),
    );
    // Where there is no number.
    let grey = srgb::linear(NO_NUMBER);
    is_near(of("scalar:some", scale(3.0, 8.0)).at(25.0, 18.0), grey);
    is_near(of("scalar:none", scale(3.0, 8.0)).at(25.0, 18.0), grey);
}

#[test]
fn areas_are_the_meshs_own_and_objects_have_colors_of_their_own() {
    let mut large = square("area");
    large.transform = Transform {
        scale: DVec3::splat(3.0),
        ..Transform::IDENTITY
    };
    let picture = Picture::of(vec![large], Projection::Perspective, scale(1.0, 5.0));
    is_near(picture.at(20.0, 15.0), viridis(0.25));
    let picture = Picture::of(
        vec![square("object")],
        Projection::Perspective,
        scale(0.0, 1.0),
    );
    assert_eq!(
        picture.at(25.0, 18.0),
        srgb::linear(ColorRule::of_object(0))
    );
    assert_eq!(
        picture.at(15.0, 12.0),
        srgb::linear(ColorRule::of_object(0))
    );
}

#[test]
fn groups_have_colors_of_their_own_and_other_triangles_the_plain_one() {
    let mut picture = Picture::of(
        vec![square("group")],
        Projection::Perspective,
        scale(0.0, 1.0),
    );
    picture.shading.plain_color = Color([9, 80, 200]);
    assert_eq!(picture.at(15.0, 12.0), srgb::linear(ColorRule::of_group(0)));
    assert_eq!(picture.at(25.0, 18.0), srgb::linear(Color([9, 80, 200])));
}

#[test]
fn distances_are_from_the_eye_along_orthographic_rays_or_from_a_point() {
    let of = |rule: &str, projection| {
        Picture::of(vec![square(rule)], projection, scale(0.0, 10.0)).at(25.0, 18.0)
    };
    let from_eye = DVec3::new(0.5, -0.3, 5.0).length();
    is_near(
        of("distance", Projection::Perspective),
        viridis(from_eye / 10.0),
    );
    is_near(of("distance", Projection::Orthographic), viridis(0.5));
    let from_point = DVec3::new(0.5 - 1.0, -0.3 - 2.0, -3.0).length();
    for projection in [Projection::Perspective, Projection::Orthographic] {
        is_near(of("distance:1,2,3", projection), viridis(from_point / 10.0));
    }
}

#[test]
fn normals_are_those_of_corners_that_turn_left() {
    let shown = |picture: &Picture| {
        srgb::encode(
            [&picture.at(25.0, 18.0).to_array()[..], &[1.0]]
                .concat()
                .try_into()
                .expect("four"),
        )
    };
    let of = |turn: f64| {
        let mut object = square("normal");
        object.transform.rotate.y = turn;
        Picture::of(vec![object], Projection::Perspective, scale(0.0, 1.0))
    };
    assert_eq!(shown(&of(0.0)), [128, 128, 255, 255]);
    // Back faces point away.
    assert_eq!(shown(&of(180.0)), [128, 128, 0, 255]);
}

#[test]
fn curvature_of_a_ball_is_one_color() {
    let ball = Shape::Sphere {
        radius: 2.0,
        segments: 64,
        rings: 32,
    };
    let mut object = Object::new("ball", Arc::new(Mesh::new(ball.mesh().expect("a shape"))));
    object.color = ColorRule::Value(Quantity::Curvature(Curvature::Mean));
    let picture = Picture::of(vec![object], Projection::Perspective, scale(0.0, 1.0));
    let (found, expected) = (picture.at(22.0, 17.0), viridis(0.5));
    assert!(found.distance(expected) < 0.02, "{found} {expected}");
}

#[test]
fn tiles_show_what_single_samples_do() {
    for rule in [
        "scalar:x",
        "scalar:part",
        "area",
        "distance",
        "distance:1,2,3",
        "normal",
        "curvature",
        "group",
    ] {
        for mode in [Mode::Color, Mode::Flat, Mode::Smooth, Mode::Texture] {
            let objects = vec![square(rule)];
            let mut picture = Picture::of(objects, Projection::Perspective, ColorScale::default());
            picture.shading.mode = mode;
            let shader = picture.shader();
            let rect = Rect {
                x: 0,
                y: 0,
                width: 40,
                height: 30,
            };
            let lattice = picture.camera.sub_camera(rect).lattice();
            let mut hits = Hits::default();
            let (cull, precision) = (Cull::None, Precision::Exact);
            picture
                .accel
                .find_closest(&lattice, cull, precision, &mut hits.primitives);
            let mut pixels = vec![[0; 4]; 1200];
            let only_triangles = shader.detail() == crate::hit::Detail::Triangle;
            if only_triangles {
                shader
                    .tile()
                    .shade_primitives(rect, &hits.primitives, pixels.chunks_mut(40));
            } else {
                picture
                    .accel
                    .interpolate(&lattice, cull, precision, &mut hits);
                shader.tile().shade(rect, &hits, pixels.chunks_mut(40));
            }
            for (at, pixel) in pixels.iter().enumerate() {
                let (x, y) = lattice.place(at as u32 % 40, at as u32 / 40);
                let hit = picture
                    .accel
                    .cast_primitive(&picture.camera.ray(x, y), cull, precision);
                assert_eq!(
                    *pixel,
                    shader.shade_pixel8(x, y, &hit),
                    "{rule} {mode:?} {at}"
                );
            }
        }
    }
}

#[test]
fn a_legend_names_the_quantity_and_its_range() {
    let of = |rule: &str, mode, scale| {
        let mut picture = Picture::of(vec![square(rule)], Projection::Perspective, scale);
        picture.shading.mode = mode;
        picture.shader().legend()
    };
    let told = of("scalar:x", Mode::Smooth, ColorScale::default()).expect("a legend");
    assert_eq!((&*told.title, told.scale.range), ("x", Some([9.0, 11.0])));
    let told = of("area", Mode::Flat, scale(1.0, 2.0)).expect("a legend");
    assert_eq!((&*told.title, told.scale.range), ("area", Some([1.0, 2.0])));
    assert_eq!(of("area", Mode::Normals, scale(1.0, 2.0)), None);
    assert_eq!(of("file", Mode::Smooth, scale(1.0, 2.0)), None);
    let told = of("file", Mode::Depth, scale(1.0, 2.0)).expect("a legend");
    assert_eq!(
        (&*told.title, told.scale.range),
        ("distance", Some([1.0, 2.0]))
    );
}

#[test]
fn one_color_rules_stay_as_they_were() {
    let mut object = square("#102030");
    let of = |object: &Object| {
        Picture::of(
            vec![object.clone()],
            Projection::Perspective,
            ColorScale::default(),
        )
        .at(25.0, 18.0)
    };
    assert_eq!(of(&object), srgb::linear(Color([0x10, 0x20, 0x30])));
    object.color = ColorRule::PerTriangle { seed: 3 };
    let expected = object.color.color(0).expect("a color");
    assert_eq!(of(&object), srgb::linear(expected));
}

#[test]
fn a_hits_own_color_is_what_a_picture_without_light_shows() {
    let rules = [
        "file",
        "group",
        "#12c0a0",
        "per-triangle:5",
        "object",
        "normal",
        "area",
        "distance",
        "distance:1,2,3",
        "curvature",
        "curvature:gaussian",
        "scalar:x",
        "scalar:part",
    ];
    for (rule, projection) in rules
        .into_iter()
        .flat_map(|rule| [Projection::Perspective, Projection::Orthographic].map(|p| (rule, p)))
    {
        let mut aside = square(rule);
        aside.transform.translate = DVec3::new(20.0, 0.0, 0.0);
        let mut ball = square(rule);
        let shape = Shape::Sphere {
            radius: 1.0,
            segments: 16,
            rings: 8,
        };
        ball.mesh = Arc::new(Mesh::new(shape.mesh().expect("a ball")));
        let objects = match rule.starts_with("scalar") {
            true => vec![aside, square(rule)],
            false => vec![aside, ball],
        };
        let mut picture = Picture::of(objects, projection, ColorScale::default());
        picture.shading.scale = None;
        let Picture {
            scene,
            accel,
            camera,
            shading,
        } = &picture;
        let seen = |x: f64, y: f64| {
            let hit = accel.cast(&camera.ray(x, y), Cull::None)?;
            own_color(scene, camera, shading, &hit)
        };
        let is_computed = ["area", "curvature", "curvature:gaussian"].contains(&rule);
        if is_computed || ["scalar:x", "scalar:part"].contains(&rule) {
            assert_eq!(seen(21.5, 16.5), None, "{rule}: its range is not known");
        }
        // A picture computes what is missing.
        let _ = picture.shader();
        for (x, y) in [(21.5, 16.5), (18.25, 13.0), (20.0, 11.5)] {
            let color = seen(x, y).expect("a color");
            let [r, g, b, _] = srgb::encode(picture.at(x, y).extend(1.0).to_array());
            let near = |(a, b): (u8, u8)| a.abs_diff(b) <= 1;
            let shown = color.0.into_iter().zip([r, g, b]);
            assert!(shown.clone().all(near), "{rule}: {color} {:?}", [r, g, b]);
        }
    }
}

/// The colour that a picture takes for that of all triangles, against those of the triangles.
#[test]
fn one_color_of_all_triangles_is_that_of_each() {
    let of_mesh = |change: &dyn Fn(&mut MeshData)| {
        let mut data = MeshData {
            positions: [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE].to_vec(),
            triangles: vec![[0, 1, 2], [1, 3, 2]],
            ..MeshData::default()
        };
        change(&mut data);
        Object::new("a", Arc::new(Mesh::new(data)))
    };
    let red = Color([255, 0, 0]);
    let file = of_mesh(&|_| {});
    let with_material = of_mesh(&|data| data.materials = vec![Material::new("red", red)]);
    let with_colors = of_mesh(&|data| data.colors = vec![Some(red); 4]);
    let ruled = |rule: &str| {
        let mut object = file.clone();
        object.color = rule.parse().expect("a rule");
        object
    };
    let plain = Shading::default().plain_color;
    let [r, g, b] = plain.0;
    let as_plain = ruled(&format!("#{r:02x}{g:02x}{b:02x}"));
    let hidden = |mut object: Object| {
        object.visible = false;
        object
    };
    for (objects, mode, expected) in [
        (vec![file.clone()], Mode::Flat, Some(plain)),
        (vec![file.clone()], Mode::Color, None),
        (
            vec![file.clone(), as_plain.clone()],
            Mode::Smooth,
            Some(plain),
        ),
        (vec![file.clone(), ruled("#f00")], Mode::Flat, None),
        (
            vec![ruled("#f00"), ruled("#ff0000")],
            Mode::Color,
            Some(red),
        ),
        (vec![with_material], Mode::Flat, None),
        (vec![as_plain, with_colors], Mode::Flat, None),
        (vec![ruled("object")], Mode::Flat, None),
        (vec![ruled("per-triangle")], Mode::Flat, None),
        (vec![ruled("normal")], Mode::Flat, None),
        (vec![ruled("area")], Mode::Flat, None),
        (vec![hidden(ruled("#0f0")), ruled("#f00")], Mode::Flat, None),
        (vec![], Mode::Flat, None),
    ] {
        let scene = Scene { objects };
        let shading = Shading {
            mode,
            ..Shading::default()
        };
        let camera = camera(Projection::Perspective);
        let colors = OwnColors::new(&scene, &camera, &shading, true);
        assert_eq!(colors.only, expected.map(srgb::linear), "{mode:?}");
        let Some(expected) = expected else {
            continue;
        };
        for (number, triangle) in (0..scene.objects.len() as u32).flat_map(|n| [(n, 0), (n, 1)]) {
            let hit = Hit {
                t: 1.0,
                u: 0.3,
                v: 0.3,
                object: number,
                triangle,
            };
            assert_eq!(own_color(&scene, &camera, &shading, &hit), Some(expected));
        }
    }
    assert!(
        OwnColors::new(
            &Scene::default(),
            &camera(Projection::Perspective),
            &Shading::default(),
            false
        )
        .only
        .is_none()
    );
}
