//! Tests of the one place that carries commands out, and of the news.

mod camera_tests;
mod cut_tests;
mod file_tests;
mod group_tests;
mod manipulator_tests;
mod object_tests;
mod pick_tests;
mod picture_tests;
mod texture_tests;

use super::command::Command;
use super::effect::Effect;
use super::update::{advance, middle, update};
use super::*;
use crate::state::arrival::Loaded;
use crate::state::document::{Document, Tree};
use crate::state::effect::Keep;
use crate::state::insertion::Insertion;
use crate::state::inspection::{Checked, Fault, Shown};
use crate::state::measure::{Kind, Measurement};
use crate::state::motion;
use crate::state::news::{DialogAnswer, News, expire_toasts, receive};
use crate::state::viewpoint::{DEFAULT_FOV, StandardView, Viewpoint};
use crate::state::{Answer, Replacing, TILES_LIMIT};
use raycast_core::camera::{
    FrameLock, Grid, Panorama, PixelFilter, Pose, Projection, Stereo, StereoKind,
};
use raycast_core::formats::{CameraFile, ImageSettings};
use raycast_core::glam::{DAffine3, DVec3};
use raycast_core::scene::{
    Color, ColorMap, ColorRule, ColorScale, Mesh, MeshData, Object, Quantity, Scene, Shape,
    Texture, TextureProjection, Transform,
};
use raycast_core::shade::Mode;
use raycast_core::{Accel, Cull, Precision};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

fn do_all(state: &mut State, commands: impl IntoIterator<Item = Command>) {
    for command in commands {
        update(state, command);
    }
}

/// A window on so many triangles beside one another, an object each, that came from files.
fn opened(count: usize) -> State {
    let mut state = State::default();
    state.preferences.smooth = false;
    receive(&mut state, loaded(count, None), Duration::ZERO);
    state
}

fn loaded(count: usize, camera: Option<CameraFile>) -> News {
    let mesh = Arc::new(Mesh::new(MeshData {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
        triangles: vec![[0, 1, 2]],
        ..MeshData::default()
    }));
    let object = |number: usize| {
        let mut object = Object::new(format!("object {number}"), Arc::clone(&mesh));
        object.transform.translate = DVec3::X * 2.0 * number as f64;
        object.source = Some(std::env::temp_dir().join("mesh.obj"));
        object
    };
    let scene = Arc::new(Scene {
        objects: (0..count).map(object).collect(),
    });
    let document = Document {
        paths: vec!["mesh.obj".into()],
        ..Document::new(1, "mesh.obj", Arc::clone(&scene), tree(&scene))
    };
    News::Loaded(Box::new(Loaded {
        camera,
        ..Loaded::new(document)
    }))
}

fn tree(scene: &Scene) -> Tree {
    Tree {
        accel: Arc::new(Accel::build(scene).expect("a valid scene")),
        bounds: scene.bounds(),
        build_time: Duration::ZERO,
    }
}

/// The same over a tree a mesh, as the window builds it for several objects.
fn opened_to_edit(count: usize) -> State {
    let mut state = opened(count);
    if let Some(document) = &mut state.document {
        let accel = Accel::build_instances(&document.scene).expect("a valid scene");
        document.accel = Arc::new(accel);
    }
    state
}

fn document(state: &State) -> &Document {
    state.document.as_ref().expect("a scene")
}

fn names(state: &State) -> Vec<&str> {
    let objects = document(state).scene.objects.iter();
    objects.map(|object| object.name.as_str()).collect()
}

fn visible(state: &State) -> Vec<bool> {
    let objects = document(state).scene.objects.iter();
    objects.map(|object| object.visible).collect()
}

/// Does what the worker does.
fn build(state: &mut State) {
    let scene = Arc::clone(&document(state).scene);
    let tree = tree(&scene);
    receive(state, News::Built(scene, tree), Duration::ZERO);
}

#[test]
fn a_picks_color_is_its_rules_in_the_present_settings() {
    let mut state = opened(2);
    do_all(
        &mut state,
        [Command::Look(StandardView::Front), Command::Fit],
    );
    let camera = state.camera().expect("a camera");
    let at = camera
        .project(DVec3::new(2.25, 0.25, 0.0))
        .expect("in view");
    update(&mut state, Command::Pin { at, beside: false });
    let pinned = state.picks.current().expect("a pick").clone();
    state.settings.shading.plain_color = Color([1, 2, 3]);
    assert_eq!(state.color(&pinned), Some(Color([1, 2, 3])));
    let mut colored = |rule: ColorRule| {
        update(&mut state, Command::SetColorRule(None, rule));
        state.color(&pinned)
    };
    assert_eq!(colored(ColorRule::ByObject), Some(ColorRule::of_object(1)));
    assert_eq!(colored(ColorRule::Normal), Some(Color([128, 128, 255])));
    let area = || ColorRule::Value(Quantity::Area);
    assert_eq!(colored(area()), None, "no picture has computed the range");
    let mesh = &document(&state).scene.objects[1].mesh;
    mesh.value_range(&Quantity::Area);
    assert!(state.color(&pinned).is_some());
    let shade = &mut state.settings.shading;
    shade.scale = Some(ColorScale {
        range: Some([0.0, 0.5]),
        ..ColorScale::default()
    });
    let brightest = *ColorMap::default().colors().last().expect("colors");
    assert_eq!(state.color(&pinned), Some(brightest), "its area is a half");
}

#[test]
fn a_picks_color_on_the_back_is_that_of_back_faces() {
    let mut state = opened(1);
    let red = Color([200, 0, 0]);
    state.settings.shading.back_faces = Some(red);
    for projection in [Projection::Perspective, Projection::Orthographic] {
        update(&mut state, Command::SetProjection(projection));
        for (view, is_back) in [(StandardView::Front, false), (StandardView::Back, true)] {
            do_all(&mut state, [Command::Look(view), Command::Fit]);
            let camera = state.camera().expect("a camera");
            let at = camera.project(DVec3::new(0.25, 0.25, 0.0));
            let at = at.expect("in front");
            update(&mut state, Command::Pin { at, beside: false });
            let pinned = state.picks.current().expect("a triangle");
            assert_eq!(state.color(pinned) == Some(red), is_back, "{projection:?}");
        }
    }
}

#[test]
fn what_a_scene_file_says_of_its_picture_is_shown_and_saved() {
    let image = ImageSettings {
        size: Some((320, 240)),
        samples: Some(4),
        pixel_filter: Some(PixelFilter::Gaussian),
        step: None,
        shift: Some([0.25, -0.5]),
        stereo: Some(Stereo {
            kind: StereoKind::Pair,
            eye_distance: 0.1,
            convergence: None,
        }),
        cull: Some(Cull::Back),
        precision: Some(Precision::Fast),
    };
    let mut state = State::default();
    let News::Loaded(mut news) = loaded(1, None) else {
        unreachable!("a scene");
    };
    news.image = image;
    news.document.size = image.size;
    receive(&mut state, News::Loaded(news), Duration::ZERO);
    let view = state.view().expect("a view");
    assert_eq!(view.camera.shift(), [0.25, -0.5]);
    assert_eq!(view.settings.pixel_filter, PixelFilter::Gaussian);
    assert_eq!(view.settings.precision, Precision::Fast);
    assert_eq!(state.scene_file().expect("a scene").image, image);
    // Another scene has nothing of it.
    receive(&mut state, loaded(1, None), Duration::ZERO);
    let nothing = ImageSettings::default();
    assert_eq!(state.scene_file().expect("a scene").image, nothing);
}
