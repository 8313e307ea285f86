//! A window on a bench: its parts without eframe around them.

use egui::{Modifiers, PointerButton, Pos2, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use raycast_core::Accel;
use raycast_core::glam::DVec3;
use raycast_core::scene::{Groups, Mesh, MeshData, Object, Scene};
use raycast_viewer::panels::overlay::TileOverlay;
use raycast_viewer::panels::{Commands, Status, window};
use raycast_viewer::state::State;
use raycast_viewer::state::arrival::Loaded;
use raycast_viewer::state::command::Command;
use raycast_viewer::state::document::{Document, Tree};
use raycast_viewer::state::effect::Effect;
use raycast_viewer::state::news::{News, receive};
use raycast_viewer::state::update::update;
use raycast_viewer::ui::canvas::Canvas;
use raycast_viewer::ui::theme;
use std::sync::Arc;
use std::time::Duration;

/// A window without the eframe around it.
#[derive(Default)]
pub(crate) struct Bench {
    pub(crate) state: State,
    pub(crate) status: Status,
    pub(crate) canvas: Canvas,
    pub(crate) overlay: TileOverlay,
    pub(crate) asked: Vec<Command>,
    pub(crate) effects: Vec<Effect>,
}

pub(crate) fn open() -> Harness<'static, Bench> {
    open_with(State::default())
}

pub(crate) fn open_with(state: State) -> Harness<'static, Bench> {
    let bench = Bench {
        state,
        ..Bench::default()
    };
    let mut styled = false;
    let mut harness = Harness::builder()
        .with_size([1200.0, 1400.0])
        .build_ui_state(
            move |ui, bench: &mut Bench| {
                if !std::mem::replace(&mut styled, true) {
                    theme::apply(ui.ctx());
                }
                let mut commands = Commands::new();
                let place = window::show(
                    ui,
                    &bench.state,
                    &bench.status,
                    &mut bench.canvas,
                    &mut bench.overlay,
                    &mut commands,
                );
                bench.state.set_viewport(place.pixels);
                bench.state.hover = place.hover;
                for command in commands {
                    bench.asked.push(command.clone());
                    bench.effects.extend(update(&mut bench.state, command));
                    ui.ctx().request_repaint();
                }
            },
            bench,
        );
    harness.run();
    harness
}

pub(crate) fn click(harness: &mut Harness<'_, Bench>, name: &str) {
    harness.get_by_label(name).click();
    harness.run();
}

/// Presses a button of the mouse over the picture and moves it.
pub(crate) fn drag(harness: &mut Harness<'_, Bench>, button: PointerButton, modifiers: Modifiers) {
    let way = [pos2(300.0, 300.0), pos2(340.0, 320.0)];
    drag_along(harness, button, modifiers, way, |_| {});
}

/// The same along this way; before the button is let go of, `then`.
pub(crate) fn drag_along(
    harness: &mut Harness<'_, Bench>,
    button: PointerButton,
    modifiers: Modifiers,
    [from, to]: [Pos2; 2],
    then: impl FnOnce(&mut Harness<'_, Bench>),
) {
    let press = |pos: Pos2, pressed| egui::Event::PointerButton {
        pos,
        button,
        pressed,
        modifiers,
    };
    harness.event(egui::Event::ModifiersChanged(modifiers));
    harness.event(egui::Event::PointerMoved(from));
    harness.run();
    harness.event(press(from, true));
    harness.run();
    for share in [0.5, 1.0] {
        harness.event(egui::Event::PointerMoved(from + (to - from) * share));
        harness.run();
    }
    then(harness);
    harness.event(press(to, false));
    harness.run();
    harness.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    harness.run();
}

/// A window on two triangles beside one another, an object each, that came from a file.
pub(crate) fn open_two() -> Harness<'static, Bench> {
    let mesh = Arc::new(Mesh::new(MeshData {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
        triangles: vec![[0, 1, 2]],
        groups: Groups::of_triangles(vec!["flat".to_owned()], [Some(0)]).expect("a group"),
        ..MeshData::default()
    }));
    let object = |name: &str, x: f64| {
        let mut object = Object::new(name, Arc::clone(&mesh));
        object.transform.translate = DVec3::X * x;
        object.source = Some(std::env::temp_dir().join("mesh.obj"));
        object
    };
    open_objects(vec![object("left one", 0.0), object("right one", 2.0)])
}

/// A window on one mesh, an object of the name "mesh".
pub(crate) fn open_mesh(mesh: Mesh) -> Harness<'static, Bench> {
    open_objects(vec![Object::new("mesh", Arc::new(mesh))])
}

fn open_objects(objects: Vec<Object>) -> Harness<'static, Bench> {
    let scene = Arc::new(Scene { objects });
    let mut state = State::default();
    state.preferences.smooth = false;
    let tree = Tree {
        accel: Arc::new(Accel::build_instances(&scene).expect("a valid scene")),
        bounds: scene.bounds(),
        build_time: Duration::ZERO,
    };
    let loaded = Loaded::new(Document {
        paths: vec!["mesh.obj".into()],
        ..Document::new(1, "mesh.obj", scene, tree)
    });
    receive(&mut state, News::Loaded(Box::new(loaded)), Duration::ZERO);
    open_with(state)
}
