//! The view.

use crate::bench::{click, drag, open, open_two};
use egui::{Key, Modifiers, PointerButton};
use egui_kittest::kittest::Queryable;
use raycast_core::glam::DVec3;

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
    harness.event(wheel(Modifiers::NONE));
    harness.run();
    assert!(harness.state().state.viewpoint.orbit.distance < before.distance);
}

fn wheel(modifiers: Modifiers) -> egui::Event {
    egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: egui::vec2(0.0, 1.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers,
    }
}

#[test]
fn with_ctrl_the_wheel_goes_through_what_is_under_the_cursor_and_without_it_does_not() {
    // Towards a triangle in the plane z = 0.
    let behind = |modifiers| {
        let mut harness = open_two();
        harness.event(egui::Event::Paste(
            "--eye 0.2,0.2,2 --target 0.2,0.2,0".to_owned(),
        ));
        harness.run();
        let camera = harness.state().state.camera().expect("a camera");
        let (x, y) = camera.project(DVec3::new(0.2, 0.2, 0.0)).expect("in front");
        let picture = harness.get_by_label("The picture").rect();
        let at = picture.min + egui::vec2(x as f32, y as f32);
        harness.event(egui::Event::PointerMoved(at));
        harness.event(egui::Event::ModifiersChanged(modifiers));
        harness.run();
        for _ in 0..60 {
            harness.event(wheel(modifiers));
            harness.run();
        }
        harness.state().state.viewpoint.pose().eye.z < 0.0
    };
    assert!(behind(Modifiers::COMMAND | Modifiers::CTRL));
    assert!(!behind(Modifiers::NONE));
}

#[test]
fn a_line_says_what_the_mouse_does_until_it_is_used_in_the_picture() {
    let mut harness = open_two();
    let is_shown = |harness: &egui_kittest::Harness<'_, _>| {
        harness.query_by_label_contains("Drag to orbit").is_some()
    };
    assert!(is_shown(&harness));
    harness.key_press(Key::M);
    harness.run();
    assert!(is_shown(&harness), "a key is no mouse");
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE);
    assert!(!is_shown(&harness));
    assert!(harness.state().state.preferences.knows_mouse);
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
