//! Picking, measuring, cutting, looking meshes over.

use crate::bench::{Bench, click, open_two};
use egui::{Key, Modifiers, PointerButton, Pos2, accesskit::Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use raycast_core::formats::LengthUnit;
use raycast_core::glam::DVec3;
use raycast_core::scene::{ClippingPlane, ClippingPlanes};
use raycast_viewer::state::arrival::Loaded;
use raycast_viewer::state::command::Command;
use raycast_viewer::state::cut::PlaneBy;
use raycast_viewer::state::effect::Effect;
use raycast_viewer::state::inspection::Checked;
use raycast_viewer::state::measure::{Kind, Measurement};
use raycast_viewer::state::news::{News, receive};
use raycast_viewer::state::update::update;
use std::sync::Arc;
use std::time::Duration;

#[test]
fn lengths_are_told_in_the_unit_of_the_file_or_the_chosen_one() {
    let mut harness = open_two();
    let state = &mut harness.state_mut().state;
    Arc::make_mut(&mut state.measuring.list).push(Measurement {
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
        .picks
        .current()
        .cloned()
        .unwrap_or_else(|| panic!("{at}: {:?}", harness.state().asked));
    assert_eq!(pinned.object, "left one");
    assert!(pinned.pick.point.distance(DVec3::new(0.3, 0.3, 0.0)) < 0.02);
    click(&mut harness, "Copy all");
    let Some(Effect::Copy(text)) = harness.state().effects.last() else {
        panic!("{:?}", harness.state().effects);
    };
    assert!(
        text.starts_with("Object: left one\nGroup: flat\nTriangle: 0\nPoint: 0."),
        "{text}"
    );
    // A second beside it: the list shows both, and each is looked at again by a click.
    let ctrl = Modifiers::COMMAND;
    let beside = at + egui::vec2(4.0, 0.0);
    harness.event(egui::Event::ModifiersChanged(ctrl));
    harness.event(egui::Event::PointerMoved(beside));
    for pressed in [true, false] {
        harness.event(egui::Event::PointerButton {
            pos: beside,
            button: PointerButton::Primary,
            pressed,
            modifiers: ctrl,
        });
    }
    harness.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    harness.run();
    assert_eq!(harness.state().state.picks.list().len(), 2);
    click(&mut harness, "1  left one · 0");
    assert_eq!(harness.state().state.picks.current(), Some(&pinned));
    click(&mut harness, "Copy as CSV");
    let Some(Effect::Copy(text)) = harness.state().effects.last() else {
        panic!("{:?}", harness.state().effects);
    };
    let lines: Vec<_> = text.lines().collect();
    let columns = |line: &str| line.split(',').count();
    assert_eq!(lines.len(), 3, "{text}");
    assert!(lines[1].starts_with("1,\"left one\",0,0."), "{text}");
    assert!(lines[1].ends_with(",\"flat\""), "{text}");
    assert!(lines.iter().all(|line| columns(line) == 19), "{text}");
    click(&mut harness, "Let go of pick 2");
    assert_eq!(harness.state().state.picks.list().len(), 1);
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(harness.state().state.picks.current(), None);
}

#[test]
fn a_distance_is_measured_by_two_clicks_and_copied() {
    let mut harness = open_two();
    harness.key_press(Key::Num1);
    harness.key_press(Key::F);
    harness.key_press(Key::D);
    harness.run();
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
        if harness.state().state.measuring.list.is_empty() {
            harness.get_by_label("Click the second point");
        }
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
        Some(&Effect::Check {
            objects: vec![0],
            deep: false
        })
    );
    let document = harness.state().state.document.as_ref().expect("a scene");
    let mesh = Arc::clone(&document.scene.objects[0].mesh);
    let health = Arc::new(raycast_core::health::check(&mesh, &|_| true).expect("it goes on"));
    let checked = vec![Checked {
        object: 0,
        mesh,
        health,
        intersections: None,
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

#[test]
fn parts_of_the_panel_open_when_their_tool_is_begun_elsewhere() {
    let mut harness = open_two();
    let snaps = "Snap to vertices";
    assert!(harness.query_by_label(snaps).is_none());
    harness.key_press(Key::D);
    harness.run();
    harness.get_by_label(snaps);
    harness.key_press(Key::Escape);
    harness.run();
    click(&mut harness, "Measure");
    assert!(harness.query_by_label(snaps).is_none());

    let across = "Cut across Y";
    assert!(harness.query_by_label(across).is_none());
    let palette = |harness: &mut Harness<'_, Bench>, name: &str| {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
        harness.run();
        harness.event(egui::Event::Text(name.to_owned()));
        harness.run();
        harness.key_press(Key::Enter);
        harness.run();
    };
    palette(&mut harness, "Cut across X");
    harness.get_by_label(across);
    // What a person closes stays closed until there is another plane.
    click(&mut harness, "Cut");
    assert!(harness.query_by_label(across).is_none());
    palette(&mut harness, "Cut through three points");
    harness.get_by_label(across);
    harness.get_by_label("Cut: Click 3 more points of the plane. Esc ends");
}

#[test]
fn a_scene_with_clipping_planes_opens_at_the_top_of_the_panel() {
    let mut harness = open_two();
    let shows_planes = |harness: &Harness<'_, Bench>| {
        let offset = harness.query_by_label("Offset of clipping plane 1");
        offset.is_some()
    };
    let state = &mut harness.state_mut().state;
    let document = state.document.clone().expect("a scene");
    let clip = ClippingPlanes::new(&[ClippingPlane {
        normal: DVec3::X,
        offset: 0.5,
        enabled: true,
    }]);
    let loaded = Loaded {
        clip: clip.expect("one plane"),
        ..Loaded::new(document)
    };
    receive(state, News::Loaded(Box::new(loaded)), Duration::ZERO);
    harness.run();
    assert_eq!(harness.state().state.settings.clip.all().len(), 1);
    assert!(!shows_planes(&harness));
    let add = Command::AddPlane(PlaneBy::Axis(1));
    update(&mut harness.state_mut().state, add);
    harness.run();
    assert!(shows_planes(&harness));
}
