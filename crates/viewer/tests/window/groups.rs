//! The groups of an object's mesh.

use crate::bench::{Bench, click, open_mesh};
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use raycast_core::glam::DVec3;
use raycast_core::scene::{Groups, Mesh, MeshData};
use raycast_viewer::state::command::Command;
use raycast_viewer::state::update::{middle, update};

/// A window on two triangles before one another: the near one in the group "lid", the far one in none.
fn open() -> Harness<'static, Bench> {
    let corners = |z: f64| [DVec3::NEG_ONE, DVec3::X, DVec3::Y].map(|p| DVec3::new(p.x, p.y, z));
    open_mesh(Mesh::new(MeshData {
        positions: [corners(0.0), corners(-0.2)].concat(),
        triangles: vec![[0, 1, 2], [3, 4, 5]],
        groups: Groups::of_triangles(vec!["lid".to_owned()], [Some(0), None]).expect("a group"),
        ..MeshData::default()
    }))
}

fn kept(harness: &Harness<'_, Bench>) -> Vec<u32> {
    let document = harness.state().state.document.as_ref().expect("a scene");
    document.scene.objects[0].kept().to_vec()
}

#[test]
fn groups_are_listed_hidden_by_their_eyes_and_shown_alone_by_a_click() {
    let mut harness = open();
    assert!(harness.query_by_label("Groups (2)").is_none(), "not marked");
    click(&mut harness, "mesh");
    click(&mut harness, "Groups (2)");
    click(&mut harness, "Hide lid");
    assert_eq!(kept(&harness), [1]);
    harness.get_by_label("Groups (2, 1 hidden)");
    harness.get_by_label("A group of it is hidden");
    click(&mut harness, "Show lid");
    assert_eq!(kept(&harness), [0, 1]);
    click(&mut harness, "In no group");
    assert_eq!(kept(&harness), [1]);
    click(&mut harness, "In no group");
    assert_eq!(kept(&harness), [0, 1]);
}

#[test]
fn a_picture_of_which_all_is_hidden_says_how_to_show_it() {
    const HINT: &str = "All is hidden: Show all (Shift+H)";
    let mut harness = open();
    assert!(harness.query_by_label(HINT).is_none());
    click(&mut harness, "Hide mesh");
    assert!(harness.query_by_label(HINT).is_some());
    click(&mut harness, "Show mesh");
    click(&mut harness, "mesh");
    click(&mut harness, "Groups (2)");
    click(&mut harness, "Hide lid");
    assert!(harness.query_by_label(HINT).is_none(), "one group is shown");
    click(&mut harness, "Hide In no group");
    assert!(harness.query_by_label(HINT).is_some());
    harness.key_press_modifiers(Modifiers::SHIFT, Key::H);
    harness.run();
    assert_eq!(kept(&harness), [0, 1]);
    assert!(harness.query_by_label(HINT).is_none());
}

#[test]
fn the_picked_group_is_hidden_and_isolated_by_keys() {
    let mut harness = open();
    let press = |harness: &mut Harness<'_, Bench>, modifiers: Modifiers, key: Key| {
        harness.key_press_modifiers(modifiers, key);
        harness.run();
    };
    press(&mut harness, Modifiers::COMMAND, Key::H);
    assert_eq!(kept(&harness), [0, 1], "nothing is picked");
    let state = &mut harness.state_mut().state;
    let at = middle(state);
    update(state, Command::Pin { at, beside: false });
    assert!(state.picks.current().is_some());
    press(&mut harness, Modifiers::COMMAND, Key::I);
    assert_eq!(kept(&harness), [0]);
    press(&mut harness, Modifiers::COMMAND, Key::I);
    press(&mut harness, Modifiers::COMMAND, Key::H);
    assert_eq!(kept(&harness), [1]);
    press(&mut harness, Modifiers::SHIFT, Key::H);
    assert_eq!(kept(&harness), [0, 1]);
}
