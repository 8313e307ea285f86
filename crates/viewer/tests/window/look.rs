//! The look, the picture and its tiles.

use crate::bench::{click, open, open_two};
use egui::{Key, Modifiers, accesskit::Role};
use egui_kittest::kittest::Queryable;
use raycast_core::camera::{FrameLock, Grid};
use raycast_core::glam::DVec3;
use raycast_core::render::{Pass, TileStats};
use raycast_core::scene::{Color, ColorRule};
use raycast_core::shade::Mode;
use raycast_viewer::state::command::Command;
use raycast_viewer::state::update::update;
use raycast_viewer::state::{Resolution, Tint};
use raycast_viewer::ui::modes::MODES;
use raycast_viewer::worker::outbox::PassReport;
use std::time::Duration;

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
fn in_a_narrow_window_the_values_under_the_cursor_come_before_the_progress() {
    let mut harness = open_two();
    harness.key_press(Key::Num1);
    harness.key_press(Key::F);
    harness.run();
    let bench = harness.state_mut();
    bench.status.progress.complete = true;
    bench.status.progress.report = Some(PassReport {
        pass: Pass {
            stride: 1,
            samples: 16,
        },
        stats: TileStats::default(),
        time: Duration::from_millis(20),
    });
    // Between a window that is too narrow for any of it and one with room for all there is one for the first part.
    harness.event(egui::Event::PointerGone);
    let has_first_part = (500..1280).step_by(10).any(|width| {
        harness.set_size(egui::vec2(width as f32, 400.0));
        harness.run();
        harness.query_by_label("16 samples a pixel").is_some()
    });
    assert!(has_first_part);
    let whole = "16 samples a pixel   0 rays   0.00 krays/s";
    for (width, hovers, shown) in [
        (1280.0, true, Some(whole)),
        (1280.0, false, Some(whole)),
        (640.0, true, None),
    ] {
        harness.set_size(egui::vec2(width, 400.0));
        harness.run();
        let picture = harness.get_by_label("The picture").rect();
        harness.event(egui::Event::PointerGone);
        if hovers {
            let camera = harness.state().state.camera().expect("a camera");
            let place = camera.project(DVec3::new(0.3, 0.3, 0.0));
            let (x, y) = place.expect("in front");
            let at = picture.min + egui::vec2(x as f32, y as f32);
            harness.event(egui::Event::PointerMoved(at));
        }
        harness.run();
        for text in [whole, "16 samples a pixel"] {
            let is_shown = harness.query_by_label(text).is_some();
            assert_eq!(is_shown, shown == Some(text), "{width} {hovers}: {text}");
        }
        for node in harness.query_all_by_label_contains("   at 0.3") {
            assert!(node.rect().right() <= picture.right());
        }
    }
}

#[test]
fn a_color_can_be_typed() {
    let mut harness = open_two();
    let rule = ColorRule::Uniform(Color([1, 2, 3]));
    let state = &mut harness.state_mut().state;
    update(state, Command::SetColorRule(Some(0), rule));
    update(state, Command::Select(Some(0)));
    harness.run();
    harness
        .get_by_role_and_label(Role::Button, "Its color")
        .click();
    harness.run();
    harness
        .get_all_by_role(Role::TextInput)
        .find(|field| field.value().as_deref() == Some("#010203"))
        .expect("the color as text")
        .focus();
    harness.run();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.event(egui::Event::Text("#f80".to_owned()));
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
    let document = harness.state().state.document.as_ref().expect("a scene");
    let color = &document.scene.objects[0].color;
    assert_eq!(*color, ColorRule::Uniform(Color([0xff, 0x88, 0x00])));
}
