//! Pictures of objects that share meshes: the same with a tree for each mesh as with one tree, byte for byte.

use super::{Cancel, Pass, Settings, View};
use crate::bvh::Accel;
use crate::camera::{Camera, Grid, ImagePlane, Pose, Projection};
use crate::picture::Picture;
use crate::scene::{
    ClippingPlane, ClippingPlanes, ColorRule, ColorScale, Curvature, Mesh, Object, Quantity, Scene,
    Shape,
};
use crate::shade::{Mode, Shading, Wireframe};
use glam::DVec3;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Two meshes in fourteen objects that overlap: rotated, mirrored, hidden, with parents, each with a colour rule.
fn scene() -> Scene {
    let torus = Shape::Torus {
        radius: 0.5,
        tube: 0.2,
        segments: 24,
        rings: 12,
    };
    let ball = Shape::Sphere {
        radius: 0.4,
        segments: 20,
        rings: 10,
    };
    let meshes = [torus, ball].map(|shape| Arc::new(Mesh::new(shape.mesh().expect("a shape"))));
    let rules = [
        ColorRule::File,
        ColorRule::ByObject,
        ColorRule::Normal,
        ColorRule::PerTriangle { seed: 3 },
        ColorRule::Value(Quantity::Area),
        ColorRule::Value(Quantity::Distance(None)),
        ColorRule::Value(Quantity::Curvature(Curvature::Gaussian)),
    ];
    let objects = (0..14).map(|number| {
        let mut object = Object::new(format!("{number}"), Arc::clone(&meshes[number % 2]));
        let along = number as f64;
        object.transform.translate =
            DVec3::new(along % 4.0 - 1.5, along % 3.0 - 1.0, along % 5.0 * 0.3);
        object.transform.rotate = DVec3::new(17.0, 31.0, 7.0) * along;
        object.transform.scale = match number % 4 {
            1 => DVec3::new(-1.0, 1.2, 0.8),
            2 => DVec3::new(0.7, 1.5, 1.0),
            _ => DVec3::ONE,
        };
        object.visible = number != 6;
        object.parent = (number == 9).then_some(3);
        object.color = rules[number % rules.len()].clone();
        object
    });
    Scene {
        objects: objects.collect(),
    }
}

fn render(view: &View) -> Picture {
    let clock = &|| Duration::ZERO;
    let picture = view.render(Grid::default(), clock, &Cancel::default(), &|_| ());
    picture.expect("not cancelled")
}

/// The pixels of a pass over every fourth ray.
fn coarse(view: &View) -> Vec<Vec<[u8; 4]>> {
    let plane = view.camera.plane();
    let tiles = Grid::default().tiles(plane.columns, plane.rows);
    let pass = Pass {
        stride: 4,
        samples: 1,
    };
    let made = Mutex::new(Vec::new());
    let sink = |_, tile: super::Tile| {
        made.lock()
            .expect("no panic")
            .push((tile.rect.x, tile.rect.y, tile.pixels))
    };
    view.render_progressively(
        &tiles,
        &[pass],
        &|| Duration::ZERO,
        &Cancel::default(),
        &sink,
    );
    let mut made = made.into_inner().expect("no panic");
    made.sort_by_key(|(x, y, _)| (*y, *x));
    made.into_iter().map(|(.., pixels)| pixels).collect()
}

#[test]
fn pictures_of_instances_are_those_of_one_tree() {
    let scene = scene();
    let one = Accel::build(&scene).expect("a valid scene");
    let placed = Accel::build_instances(&scene).expect("a valid scene");
    // Objects that have moved: their corners are placed when they are read.
    let mut elsewhere = scene.clone();
    for object in &mut elsewhere.objects {
        object.transform.translate.x += 0.01;
    }
    let before = Accel::build_instances(&elsewhere).expect("a valid scene");
    let moved = before.updated_at_once(&scene).expect("a small change");
    assert_eq!(one.bounds(), moved.bounds());
    let trees = [one, placed, moved].map(Arc::new);
    let scene = Arc::new(scene);
    let plane = ClippingPlane::new(DVec3::new(-0.3, 0.1, -1.0), -0.4).expect("a plane");
    let cut = ClippingPlanes::new(&[plane]).expect("one plane");
    for (number, mode) in Mode::ALL.into_iter().enumerate() {
        let settings = Settings {
            shading: Shading {
                mode,
                wireframe: (number % 3 == 1).then_some(Wireframe::ALONE),
                scale: (number % 2 == 0).then_some(ColorScale {
                    legend: true,
                    ..ColorScale::default()
                }),
                ..Shading::default()
            },
            clip: if number % 4 == 2 {
                cut
            } else {
                ClippingPlanes::NONE
            },
            samples: 1 + number as u32 % 2,
            layers: number % 3 == 0,
            ..Settings::default()
        };
        let projection = match number % 3 {
            0 => Projection::Orthographic,
            _ => Projection::Perspective,
        };
        let pose = Pose {
            eye: DVec3::new(1.0, 2.0, 5.0),
            target: DVec3::ZERO,
            up: DVec3::Y,
        };
        let plane = ImagePlane::new(350, 290, 0.016).expect("a good plane");
        let views = trees.each_ref().map(|accel| View {
            scene: Arc::clone(&scene),
            accel: Arc::clone(accel),
            camera: Camera::new(pose, projection, plane),
            settings,
        });
        let [one, placed, moved] = views.each_ref().map(render);
        let differs = one.pixels.iter().any(|pixel| *pixel != one.pixels[0]);
        assert!(differs, "{mode:?}");
        assert!(one == placed && one == moved, "{mode:?}");
        let [one, placed, moved] = views.each_ref().map(coarse);
        assert!(one == placed && one == moved, "{mode:?}");
    }
}
