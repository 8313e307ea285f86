//! The view.

use crate::bench::{click, drag, open, open_two};
use egui::{Key, Modifiers, PointerButton};
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
