//! The window's parts through their accessibility tree: found by name, clicked, typed into. No GPU
//! and no display. What a click asks for goes through the one place that carries commands out.

use egui::{Key, Modifiers, PointerButton, Pos2, accesskit::Role, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use raycast_core::Accel;
use raycast_core::camera::{FrameLock, Grid, Projection};
use raycast_core::formats::LengthUnit;
use raycast_core::glam::DVec3;
use raycast_core::scene::{Mesh, MeshData, Object, Scene};
use raycast_core::shade::Mode;
use raycast_viewer::panels::overlay::TileOverlay;
use raycast_viewer::panels::{Commands, Status, window};
use raycast_viewer::state::PromptKind;
use raycast_viewer::state::command::Command;
use raycast_viewer::state::document::{Document, Tree};
use raycast_viewer::state::effect::{Effect, Keep};
use raycast_viewer::state::inspection::Checked;
use raycast_viewer::state::measure::{Kind, Measurement};
use raycast_viewer::state::news::{Loaded, News, receive};
use raycast_viewer::state::preferences::Mouse;
use raycast_viewer::state::update::update;
use raycast_viewer::state::{Replacing, Resolution, State, Tint};
use raycast_viewer::ui::canvas::Canvas;
use raycast_viewer::ui::input::gestures;
use raycast_viewer::ui::modes::MODES;
use raycast_viewer::ui::registry::{KeysFile, actions};
use raycast_viewer::ui::theme;
use raycast_viewer::worker::files::Activity;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// A window without the eframe around it.
#[derive(Default)]
struct Bench {
    state: State,
    status: Status,
    canvas: Canvas,
    overlay: TileOverlay,
    asked: Vec<Command>,
    effects: Vec<Effect>,
}

fn open() -> Harness<'static, Bench> {
    open_with(State::default())
}

fn open_with(state: State) -> Harness<'static, Bench> {
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
                bench.state.viewport = place.pixels;
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

fn click(harness: &mut Harness<'_, Bench>, name: &str) {
    harness.get_by_label(name).click();
    harness.run();
}

/// Presses a button of the mouse over the picture and moves it.
fn drag(harness: &mut Harness<'_, Bench>, button: PointerButton, modifiers: Modifiers) {
    let way = [pos2(300.0, 300.0), pos2(340.0, 320.0)];
    drag_along(harness, button, modifiers, way, |_| {});
}

/// The same along this way; before the button is let go of, `then`.
fn drag_along(
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

#[test]
fn a_click_on_wireframe_asks_for_lines_and_another_for_none() {
    let mut harness = open();
    click(&mut harness, "Wireframe");
    assert_eq!(harness.state().asked, [Command::SetWireframe(true)]);
    assert!(harness.state().state.settings.shading.wireframe.is_some());
    click(&mut harness, "Wireframe");
    assert!(harness.state().state.settings.shading.wireframe.is_none());
}

#[test]
fn an_empty_window_says_what_to_do() {
    const HINT: &str = "Open a mesh (Ctrl+O) or drop one here";
    let mut harness = open();
    harness.state_mut().state.errors = vec!["broken.obj:2: expected faces, found none".to_owned()];
    harness.run();
    assert!(harness.query_by_label(HINT).is_some());
    harness.state_mut().status.activity = Some(Activity {
        label: "Reading a mesh".to_owned(),
        share: Some(0.5),
        can_cancel: true,
    });
    harness.run();
    assert!(harness.query_by_label(HINT).is_none());
}

#[test]
fn every_mode_has_a_button() {
    let mut harness = open();
    for (mode, name, _) in MODES {
        let another = if mode == Mode::Flat {
            Mode::Depth
        } else {
            Mode::Flat
        };
        harness.state_mut().state.settings.shading.mode = another;
        harness.run();
        let buttons: Vec<_> = harness
            .get_all_by_role_and_label(Role::Button, name)
            .collect();
        assert_eq!(buttons.len(), 1, "{name}");
        buttons[0].click();
        harness.run();
        assert_eq!(harness.state().state.settings.shading.mode, mode, "{name}");
    }
}

#[test]
fn half_the_step_doubles_the_resolution_or_zooms_as_the_lock_says() {
    let mut harness = open();
    click(&mut harness, "Picture");
    let before = harness.state().state.plane().expect("a plane");
    click(&mut harness, "Halve the step");
    let denser = harness.state().state.plane().expect("a plane");
    assert_eq!(
        (denser.columns, denser.rows),
        (before.columns * 2, before.rows * 2)
    );
    assert!((denser.frame_height() - before.frame_height()).abs() < 1e-9);

    click(&mut harness, "Keep size");
    assert_eq!(harness.state().state.lock, FrameLock::KeepResolution);
    click(&mut harness, "Halve the step");
    let nearer = harness.state().state.plane().expect("a plane");
    assert_eq!((nearer.columns, nearer.rows), (denser.columns, denser.rows));
    assert!((nearer.frame_height() * 2.0 - denser.frame_height()).abs() < 1e-9);
}

#[test]
fn a_resolution_can_be_typed_and_fitted_again() {
    let mut harness = open();
    click(&mut harness, "Picture");
    let columns = harness.state().state.size().0.to_string();
    let field = harness
        .get_all_by_role(Role::SpinButton)
        .find(|node| node.value().is_some_and(|value| value == columns))
        .expect("a field with the columns");
    field.click();
    harness.run();
    harness.event(egui::Event::Text("320".to_owned()));
    harness.key_press(Key::Enter);
    harness.run();
    let state = &harness.state().state;
    assert!(
        matches!(state.resolution, Resolution::Fixed(320, _)),
        "{:?}",
        state.resolution
    );
    click(&mut harness, "Fit the window");
    assert_eq!(harness.state().state.size(), harness.state().state.viewport);
}

#[test]
fn tiles_by_grid_with_borders_and_colors() {
    let mut harness = open();
    click(&mut harness, "Tiles");
    click(&mut harness, "Grid");
    assert!(matches!(harness.state().state.grid, Grid::Count { .. }));
    click(&mut harness, "Borders");
    click(&mut harness, "Order");
    click(&mut harness, "Worker");
    let overlay = harness.state().state.overlay;
    assert!(overlay.borders && overlay.order);
    assert_eq!(overlay.tint, Tint::Worker);
}

#[test]
fn the_help_lists_every_key_and_gesture() {
    let mut harness = open();
    assert!(harness.query_by_label("Keys and gestures").is_none());
    harness.key_press(Key::F1);
    harness.run();
    harness.get_by_label("Keys and gestures");
    let gestures = gestures(Mouse::Viewer).flat_map(|g| [g.gesture, g.does]);
    let with_keys = actions().filter(|action| !action.keys.is_empty());
    let names = with_keys.map(|action| action.name);
    for text in gestures.chain(names) {
        assert!(harness.query_all_by_label(text).next().is_some(), "{text}");
    }
    harness.key_press(Key::Escape);
    harness.run();
    assert!(!harness.state().state.help);
}

#[test]
fn changed_keys_work_and_are_shown_in_menus_palette_help_and_hints() {
    let file =
        "version = 1\n[keys]\nfile.open = \"Ctrl+K\"\nlook.wireframe = [\"Shift+J\", \"F7\"]\n";
    let file = KeysFile::read("keys.toml", file);
    assert_eq!(file.faults, [""; 0]);
    let mut harness = open();
    file.keymap.install(&harness.ctx);
    harness.run();
    harness.key_press(Key::W);
    harness.run();
    assert_eq!(harness.state().asked, [], "it was the old key");
    harness.key_press_modifiers(Modifiers::SHIFT, Key::J);
    harness.run();
    assert_eq!(harness.state().asked, [Command::SetWireframe(true)]);
    harness.get_by_label("Open a mesh (Ctrl+K) or drop one here");
    harness
        .get_by_role_and_label(Role::CheckBox, "Wireframe")
        .hover();
    harness.run_steps(60);
    let shows = |harness: &Harness<'_, Bench>, text: &str| {
        harness.query_all_by_label_contains(text).next().is_some()
    };
    assert!(shows(&harness, "Wireframe (Shift+J)"), "the tooltip");
    click(&mut harness, "File");
    assert!(shows(&harness, "Ctrl+K"), "the menu");
    harness.key_press(Key::Escape);
    harness.run();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run();
    harness.event(egui::Event::Text("wireframe".to_owned()));
    harness.run();
    assert!(shows(&harness, "Shift+J"), "the palette");
    harness.key_press(Key::Escape);
    harness.run();
    harness.key_press(Key::F1);
    harness.run();
    assert!(shows(&harness, "Shift+J   F7"), "the help");
}

#[test]
fn keys_work_and_stay_out_of_the_way_of_typing() {
    let mut harness = open();
    harness.key_press_modifiers(Modifiers::ALT, Key::Num5);
    harness.key_press(Key::Num5);
    harness.run();
    let state = &harness.state().state;
    assert_eq!(state.settings.shading.mode, Mode::Depth);
    assert_eq!(state.viewpoint.projection, Projection::Orthographic);

    harness.key_press_modifiers(Modifiers::COMMAND, Key::O);
    harness.run();
    harness.run();
    let asked = harness.state().asked.len();
    harness.key_press(Key::Num1);
    harness.event(egui::Event::Text("1.obj".to_owned()));
    harness.run();
    let typed = Command::TypePath("1.obj".to_owned());
    assert_eq!(harness.state().asked[asked..], [typed]);
}

#[test]
fn a_path_can_be_typed_where_the_desktop_has_no_dialog() {
    let mut harness = open();
    click(&mut harness, "File");
    click(&mut harness, "Open… Ctrl+O");
    assert_eq!(harness.state().effects, [Effect::Dialog(PromptKind::Open)]);
    harness.run();
    harness.event(egui::Event::Text("mesh.obj".to_owned()));
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
    let effect = Effect::Open(vec![PathBuf::from("mesh.obj")], Keep::Nothing);
    assert_eq!(harness.state().effects.last(), Some(&effect));
    assert!(harness.state().state.prompt.is_none());
}

#[test]
fn a_file_is_replaced_when_the_person_says_so() {
    let path = PathBuf::from("out/picture.png");
    for (button, effects) in [
        ("Keep it", vec![]),
        (
            "Replace it",
            vec![Effect::SavePicture {
                path: path.clone(),
                replace: true,
            }],
        ),
    ] {
        let mut harness = open_with(State {
            replacing: Some(Replacing {
                path: path.clone(),
                by: PromptKind::Picture,
            }),
            ..State::default()
        });
        harness.get_by_label("out/picture.png is there already.");
        click(&mut harness, button);
        assert_eq!(harness.state().effects, effects);
        assert_eq!(harness.state().state.replacing, None);
    }
}

#[test]
fn an_error_is_shown_in_full_until_it_is_dismissed() {
    let text = "models/bad.obj:17: expected a vertex index, found \"f 1 2 x\"";
    let mut harness = open_with(State {
        errors: vec![text.to_owned()],
        ..State::default()
    });
    harness.get_by_label(text);
    click(&mut harness, "Dismiss");
    assert!(harness.query_by_label(text).is_none());
}

#[test]
fn the_mouse_orbits_pans_and_zooms() {
    let mut harness = open();
    let before = harness.state().state.viewpoint.orbit;
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE);
    let turned = harness.state().state.viewpoint.orbit;
    assert!((turned.yaw - before.yaw).abs() > 1.0 && turned.pivot == before.pivot);

    for (button, modifiers) in [
        (PointerButton::Secondary, Modifiers::NONE),
        (PointerButton::Middle, Modifiers::NONE),
        (PointerButton::Primary, Modifiers::SHIFT),
    ] {
        let before = harness.state().state.viewpoint.orbit;
        drag(&mut harness, button, modifiers);
        let panned = harness.state().state.viewpoint.orbit;
        assert_eq!(panned.yaw, before.yaw, "{button:?}");
        assert_ne!(panned.pivot, before.pivot, "{button:?}");
    }

    let before = harness.state().state.viewpoint.orbit;
    harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: egui::vec2(0.0, 1.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    harness.run();
    assert!(harness.state().state.viewpoint.orbit.distance < before.distance);
}

#[test]
fn the_panel_makes_room_for_the_picture() {
    let mut harness = open();
    let before = harness.state().state.viewport.0;
    harness.key_press(Key::P);
    harness.run();
    let after = harness.state().state.viewport.0;
    assert!(after > before + 200, "{before} {after}");
    assert!(harness.query_by_label("Wireframe").is_none());
}

#[test]
fn handles_of_the_marked_object_move_it_and_escape_gives_up() {
    let mut harness = open_two();
    click(&mut harness, "right one");
    harness.key_press(Key::F);
    harness.key_press(Key::G);
    harness.run();
    let place = |state: &State| {
        let document = state.document.as_ref().expect("a scene");
        document.scene.objects[1].transform.translate
    };
    // A point of the window and the same of the picture: from where to where the picture lies.
    let here = pos2(300.0, 300.0);
    harness.event(egui::Event::PointerMoved(here));
    harness.run();
    let (x, y) = harness.state().state.hover.expect("over the picture");
    let corner = here - egui::vec2(x as f32, y as f32);
    let at = |state: &State, axis: usize, points: f64| {
        let manipulator = state.manipulator().expect("handles");
        let camera = state.camera().expect("a camera");
        let (x, y) = camera
            .project(manipulator.along(axis, points))
            .expect("before the eye");
        corner + egui::vec2(x as f32, y as f32)
    };
    let start = place(&harness.state().state);
    let view = harness.state().state.viewpoint;
    let way = |harness: &Harness<'_, Bench>| {
        let state = &harness.state().state;
        [at(state, 0, 70.0), at(state, 0, 130.0)]
    };
    let along = way(&harness);
    drag_along(
        &mut harness,
        PointerButton::Primary,
        Modifiers::NONE,
        along,
        |_| {},
    );
    let state = &harness.state().state;
    let moved = place(state) - start;
    let pixel = state.manipulator().expect("handles").pixel;
    assert!(
        (moved.x / (60.0 * pixel) - 1.0).abs() < 0.02,
        "{moved}: {:?}",
        harness.state().asked
    );
    assert_eq!((moved.y, moved.z), (0.0, 0.0));
    assert_eq!(state.viewpoint, view, "the view stays");
    assert!(
        state.selected == Some(1) && state.pinned.is_none(),
        "nothing is picked"
    );
    assert_eq!(state.history.undo_name(), Some("Move"));

    let there = place(state);
    let along = way(&harness);
    drag_along(
        &mut harness,
        PointerButton::Primary,
        Modifiers::NONE,
        along,
        |harness| {
            assert_ne!(place(&harness.state().state), there);
            harness.key_press(Key::Escape);
            harness.run();
            assert_eq!(place(&harness.state().state), there);
            harness.event(egui::Event::PointerMoved(pos2(500.0, 700.0)));
            harness.run();
        },
    );
    let state = &harness.state().state;
    assert_eq!((place(state), state.viewpoint), (there, view));
    assert!(!state.manipulating.is_held);

    // Beside the handles the hand orbits as ever, and the right button always does what it does.
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE);
    assert_ne!(harness.state().state.viewpoint, view);
    let view = harness.state().state.viewpoint;
    let along = way(&harness);
    drag_along(
        &mut harness,
        PointerButton::Secondary,
        Modifiers::NONE,
        along,
        |_| {},
    );
    assert_ne!(harness.state().state.viewpoint, view);
    assert_eq!(place(&harness.state().state), there);
}

#[test]
fn lengths_are_told_in_the_unit_of_the_file_or_the_chosen_one() {
    let mut harness = open_two();
    let state = &mut harness.state_mut().state;
    state.measuring.list.push(Measurement {
        kind: Kind::Distance,
        points: vec![DVec3::ZERO, DVec3::X * 2.5],
    });
    harness.run();
    click(&mut harness, "Measure");
    harness.get_by_label("2.5000");
    let state = &mut harness.state_mut().state;
    state.document.as_mut().expect("a scene").unit = Some(LengthUnit::Metre);
    harness.run();
    harness.get_by_label("2.5000\u{a0}m");
    harness
        .get_by_role_and_label(Role::ComboBox, "Unit")
        .click();
    harness.run();
    click(&mut harness, "millimetres");
    harness.get_by_label("2500.0\u{a0}mm");
    click(&mut harness, "Copy as CSV");
    let copied = harness.state().asked.last();
    let csv = "number,kind,value,unit,points\n1,Distance,2500,mm,0 0 0; 2.5 0 0\n";
    assert_eq!(copied, Some(&Command::Copy(csv.to_owned())));
}

/// A window on two triangles beside one another, an object each, that came from a file.
fn open_two() -> Harness<'static, Bench> {
    let mesh = Arc::new(Mesh::new(MeshData {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
        triangles: vec![[0, 1, 2]],
        ..MeshData::default()
    }));
    let object = |name: &str, x: f64| {
        let mut object = Object::new(name, Arc::clone(&mesh));
        object.transform.translate = DVec3::X * x;
        object.source = Some(std::env::temp_dir().join("mesh.obj"));
        object
    };
    let scene = Arc::new(Scene {
        objects: vec![object("left one", 0.0), object("right one", 2.0)],
    });
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

fn objects(harness: &Harness<'_, Bench>) -> Vec<(String, bool)> {
    let document = harness.state().state.document.as_ref().expect("a scene");
    let objects = document.scene.objects.iter();
    objects.map(|o| (o.name.clone(), o.visible)).collect()
}

#[test]
fn an_object_is_hidden_by_its_eye_and_undo_brings_it_back() {
    let mut harness = open_two();
    let shown = |harness: &Harness<'_, Bench>| {
        let document = harness.state().state.document.as_ref().expect("a scene");
        assert!(document.is_built(), "at once");
        (document.accel.len(), document.bounds.min.x)
    };
    click(&mut harness, "Hide left one");
    assert_eq!(objects(&harness)[0], ("left one".to_owned(), false));
    assert_eq!(shown(&harness), (1, 2.0));
    harness.get_by_label("Show left one");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run();
    assert!(objects(&harness)[0].1);
    assert_eq!(shown(&harness), (2, 0.0));
    assert!(!harness.state().effects.contains(&Effect::Build));
}

#[test]
fn an_object_is_renamed_in_the_list() {
    let mut harness = open_two();
    click(&mut harness, "right one");
    harness.key_press(Key::F2);
    harness.run();
    // The old name is marked: what is typed takes its place.
    harness.event(egui::Event::Text("lid".to_owned()));
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
    assert_eq!(objects(&harness)[1].0, "lid");
    assert_eq!(harness.state().state.naming, None);

    harness.key_press(Key::F2);
    harness.run();
    harness.event(egui::Event::Text("wrong".to_owned()));
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(objects(&harness)[1].0, "lid", "Esc keeps the name");
}

#[test]
fn the_palette_finds_a_command_and_runs_it() {
    let mut harness = open_two();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run();
    // Typed at once, and no key of the window's: w would be the wireframe.
    harness.event(egui::Event::Text("wirefr".to_owned()));
    harness.key_press(Key::W);
    harness.run();
    assert!(harness.state().state.settings.shading.wireframe.is_none());
    harness.key_press(Key::Enter);
    harness.run();
    let state = &harness.state().state;
    assert!(state.settings.shading.wireframe.is_some() && state.palette.is_none());
}

#[test]
fn a_click_pins_a_triangle_and_its_values_are_copied() {
    let mut harness = open_two();
    harness.key_press(Key::Num1);
    harness.key_press(Key::F);
    harness.run();
    let camera = harness.state().state.camera().expect("a camera");
    let (x, y) = camera.project(DVec3::new(0.3, 0.3, 0.0)).expect("in front");
    let picture = harness.get_by_label("The picture").rect();
    let at = picture.min + egui::vec2(x as f32, y as f32);
    harness.event(egui::Event::PointerMoved(at));
    harness.run();
    // In one frame: a harness takes long from one to the next, and that would be no click.
    for pressed in [true, false] {
        harness.event(egui::Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
    }
    harness.run();
    let pinned = harness
        .state()
        .state
        .pinned
        .clone()
        .unwrap_or_else(|| panic!("{at}: {:?}", harness.state().asked));
    assert_eq!(pinned.object, "left one");
    assert!(pinned.pick.point.distance(DVec3::new(0.3, 0.3, 0.0)) < 0.02);
    click(&mut harness, "Copy all");
    let Some(Effect::Copy(text)) = harness.state().effects.last() else {
        panic!("{:?}", harness.state().effects);
    };
    assert!(
        text.starts_with("Object: left one\nTriangle: 0\nPoint: 0."),
        "{text}"
    );
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(harness.state().state.pinned, None);
}

#[test]
fn the_axes_in_the_corner_are_clicked_to_look_along_one() {
    let mut harness = open_two();
    click(&mut harness, "Look from Y");
    let orbit = harness.state().state.viewpoint.orbit;
    assert_eq!((orbit.yaw, orbit.pitch), (0.0, 90.0));
    harness.key_press_modifiers(Modifiers::ALT, Key::ArrowLeft);
    harness.run();
    assert_ne!(harness.state().state.viewpoint.orbit.pitch, 90.0);
}

#[test]
fn the_suggested_name_is_marked_and_gives_way_to_what_is_typed_at_once() {
    let mut harness = open_two();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::E);
    harness.run();
    harness.event(egui::Event::Text("cover".to_owned()));
    harness.run();
    let prompt = harness.state().state.prompt.clone().expect("a path line");
    assert_eq!(prompt.text, "cover.png");
}

#[test]
fn unsaved_changes_are_asked_for_and_the_answer_is_a_button() {
    let mut harness = open_two();
    click(&mut harness, "Hide left one");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Q);
    harness.run();
    // Keys of the window's wait until there is an answer.
    harness.key_press(Key::Num7);
    harness.run();
    assert_ne!(harness.state().state.viewpoint.orbit.pitch, 90.0);
    click(&mut harness, "Don't save");
    assert_eq!(harness.state().effects.last(), Some(&Effect::Close));
}

#[test]
fn what_has_the_keyboard_can_be_reached_and_seen() {
    let mut harness = open_two();
    for _ in 0..3 {
        harness.key_press(Key::Tab);
        harness.run();
    }
    let focused = harness.ctx.memory(|memory| memory.focused());
    assert!(focused.is_some());
}

#[test]
fn the_marked_object_is_moved_turned_and_locked_by_numbers_and_buttons() {
    let mut harness = open_two();
    click(&mut harness, "right one");
    click(&mut harness, "Move Y");
    harness.event(egui::Event::Text("1.5".to_owned()));
    harness.key_press(Key::Enter);
    harness.run();
    let transform = |harness: &Harness<'_, Bench>| {
        let document = harness.state().state.document.as_ref().expect("a scene");
        document.scene.objects[1].transform
    };
    assert_eq!(transform(&harness).translate, DVec3::new(2.0, 1.5, 0.0));
    click(&mut harness, "Turn about the scene's Z");
    assert_eq!(transform(&harness).rotate, DVec3::Z * 90.0);
    // All three factors, as it keeps its shape.
    click(&mut harness, "Scale X");
    harness.event(egui::Event::Text("2".to_owned()));
    harness.key_press(Key::Enter);
    harness.run();
    assert_eq!(transform(&harness).scale, DVec3::splat(2.0));
    click(&mut harness, "Lock");
    let locked = transform(&harness);
    click(&mut harness, "Turn about the scene's Z");
    assert_eq!(transform(&harness), locked);
    click(&mut harness, "Unlock right one");
    click(&mut harness, "Put back");
    assert_eq!(transform(&harness).scale, DVec3::ONE);
    for _ in 0..6 {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        harness.run();
    }
    assert_eq!(transform(&harness).translate, DVec3::new(2.0, 0.0, 0.0));
}

#[test]
fn a_distance_is_measured_by_two_clicks_and_copied() {
    let mut harness = open_two();
    harness.key_press(Key::Num1);
    harness.key_press(Key::F);
    harness.key_press(Key::D);
    harness.run();
    click(&mut harness, "Measure");
    harness.get_by_label("Click two points");
    for point in [DVec3::new(0.98, 0.005, 0.0), DVec3::new(2.01, 0.01, 0.0)] {
        let camera = harness.state().state.camera().expect("a camera");
        let (x, y) = camera.project(point).expect("in front");
        let picture = harness.get_by_label("The picture").rect();
        let at = picture.min + egui::vec2(x as f32, y as f32);
        harness.event(egui::Event::PointerMoved(at));
        harness.run();
        for pressed in [true, false] {
            harness.event(egui::Event::PointerButton {
                pos: at,
                button: PointerButton::Primary,
                pressed,
                modifiers: Modifiers::NONE,
            });
        }
        harness.run();
    }
    let measuring = &harness.state().state.measuring;
    assert_eq!(measuring.list.len(), 1, "{measuring:?}");
    // From the corner (1, 0, 0) of the one to the corner (2, 0, 0) of the other.
    assert_eq!(measuring.list[0].value(), Some(1.0));
    click(&mut harness, "1.0000");
    let copied = Effect::Copy("1".to_owned());
    assert_eq!(harness.state().effects.last(), Some(&copied));
    click(&mut harness, "Remove measurement 1");
    assert!(harness.state().state.measuring.list.is_empty());
}

#[test]
fn the_health_of_a_mesh_is_asked_for_and_its_faults_are_clicked() {
    let mut harness = open_two();
    click(&mut harness, "left one");
    click(&mut harness, "Health");
    click(&mut harness, "Check the mesh");
    assert_eq!(
        harness.state().effects.last(),
        Some(&Effect::Check(vec![0]))
    );
    let document = harness.state().state.document.as_ref().expect("a scene");
    let mesh = Arc::clone(&document.scene.objects[0].mesh);
    let health = Arc::new(raycast_core::health::check(&mesh, &|_| true).expect("it goes on"));
    let checked = vec![Checked {
        object: 0,
        mesh,
        health,
    }];
    let state = &mut harness.state_mut().state;
    receive(state, News::Checked(checked), Duration::ZERO);
    harness.run();
    harness.get_by_label("not closed");
    click(&mut harness, "Open edges");
    click(&mut harness, "The next fault");
    let shown = harness.state().state.inspection.shown;
    assert_eq!(shown.map(|shown| shown.index), Some(1));
    click(&mut harness, "Open edges");
    assert_eq!(harness.state().state.inspection.shown, None);
}

#[test]
fn views_are_kept_and_gone_to_and_cameras_are_pasted() {
    let mut harness = open_two();
    click(&mut harness, "Camera");
    let here = harness.state().state.viewpoint;
    click(&mut harness, "Keep view");
    harness.key_press(Key::Num7);
    harness.run();
    click(&mut harness, "View 1");
    assert_eq!(harness.state().state.viewpoint, here);
    let text = "--eye 0,0,9 --target 0,0,1 --fov 30";
    harness.event(egui::Event::Paste(text.to_owned()));
    harness.run();
    let pasted = harness.state().state.viewpoint;
    assert_eq!((pasted.orbit.pivot, pasted.orbit.distance), (DVec3::Z, 8.0));
    assert_eq!(pasted.fov, 30.0);
    click(&mut harness, "Forget View 1");
    assert!(harness.state().state.bookmarks.is_empty());
}

#[test]
fn w_walks_while_one_walks_and_draws_lines_else() {
    let mut harness = open_two();
    harness.key_press_modifiers(Modifiers::SHIFT, Key::W);
    harness.run();
    assert!(harness.state().state.walk.is_some());
    let before = harness.state().state.viewpoint.orbit.pivot;
    harness.key_down(Key::W);
    harness.step();
    harness.step();
    harness.key_up(Key::W);
    harness.run();
    let state = &harness.state().state;
    assert_ne!(state.viewpoint.orbit.pivot, before);
    assert!(state.settings.shading.wireframe.is_none());
    harness.key_press(Key::Escape);
    harness.key_press(Key::W);
    harness.run();
    let state = &harness.state().state;
    assert!(state.walk.is_none() && state.settings.shading.wireframe.is_some());
}

#[test]
fn planes_are_added_moved_flipped_switched_off_and_removed_in_the_panel() {
    let mut harness = open_two();
    click(&mut harness, "Cut");
    click(&mut harness, "Cut across X");
    let planes = |harness: &Harness<'_, Bench>| harness.state().state.settings.clip.all().to_vec();
    let first = planes(&harness)[0];
    assert!(first.normal.abs() == DVec3::X && first.enabled);
    click(&mut harness, "Flip clipping plane 1");
    assert_eq!(planes(&harness), [first.flipped()]);
    let name = if first.normal.x > 0.0 {
        "X ≤"
    } else {
        "X ≥"
    };
    click(&mut harness, name);
    assert!(!planes(&harness)[0].enabled);
    click(&mut harness, name);
    let slider = harness.get_by_label("Position of clipping plane 1").rect();
    let at = slider.left_center() + (slider.right_center() - slider.left_center()) * 0.25;
    for pressed in [true, false] {
        harness.event(egui::Event::PointerMoved(at));
        harness.event(egui::Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
        harness.run();
    }
    let moved = planes(&harness)[0];
    assert!(moved.normal == first.flipped().normal && moved.offset != first.flipped().offset);
    click(&mut harness, "Remove clipping plane 1");
    assert!(planes(&harness).is_empty());
    click(&mut harness, "Cut through three points");
    assert!(harness.state().state.cutting.is_some());
    assert!(
        harness
            .query_by_label("Click 3 more points of the plane")
            .is_some()
    );
}

#[test]
fn a_plane_is_moved_by_its_handle_in_the_picture() {
    let mut harness = open_two();
    harness.state_mut().state.viewport = (800, 800);
    harness.run();
    click(&mut harness, "Cut");
    click(&mut harness, "Cut across X");
    let before = harness.state().state.settings.clip.all()[0];
    let handle = harness
        .get_by_label("Move clipping plane 1")
        .rect()
        .center();
    let press = |pos: Pos2, pressed| egui::Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    harness.event(egui::Event::PointerMoved(handle));
    harness.event(press(handle, true));
    harness.run();
    let view = harness.state().state.viewpoint;
    for step in 1..4 {
        let by = egui::vec2(12.0 * step as f32, 0.0);
        harness.event(egui::Event::PointerMoved(handle + by));
        harness.run();
    }
    harness.event(press(handle + egui::vec2(36.0, 0.0), false));
    harness.run();
    let after = harness.state().state.settings.clip.all()[0];
    assert_eq!(after.normal, before.normal);
    let x = |plane: &raycast_core::scene::ClippingPlane| plane.offset * plane.normal.x;
    assert!(x(&after) > x(&before) + 1e-3, "{before:?} {after:?}");
    assert_eq!(harness.state().state.viewpoint, view, "the camera stays");
}
