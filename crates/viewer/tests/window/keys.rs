//! Keys, palette and help.

use crate::bench::{Bench, click, open, open_two};
use egui::{Key, Modifiers, accesskit::Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use raycast_core::camera::Projection;
use raycast_core::shade::Mode;
use raycast_viewer::panels::menu;
use raycast_viewer::state::command::Command;
use raycast_viewer::state::effect::Effect;
use raycast_viewer::state::part::Part;
use raycast_viewer::state::preferences::Mouse;
use raycast_viewer::state::update::update;
use raycast_viewer::ui::input::gestures;
use raycast_viewer::ui::registry::{KeysFile, Menu, actions};

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
fn the_palette_opens_a_part_of_the_panel_and_leads_the_keyboard_there() {
    let mut harness = open_two();
    harness.state_mut().state.panel = false;
    harness.run();
    assert!(harness.query_by_label("Projection").is_none());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run();
    harness.event(egui::Event::Text("fisheye".to_owned()));
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
    // A list that is open closes.
    click(&mut harness, "Projection");
    harness.get_by_label("Fisheye");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run();
    assert!(harness.query_by_label("Fisheye").is_none());
    harness.event(egui::Event::Text("panel: picture".to_owned()));
    harness.key_press(Key::Enter);
    harness.run();
    assert!(harness.get_by_label("Picture").is_focused());
    // Once: the part can be closed again.
    harness.key_press(Key::Space);
    harness.run();
    assert!(harness.query_by_label("Projection").is_none());
}

#[test]
fn an_entry_of_a_list_is_chosen_by_keys_and_the_list_closes() {
    let mut harness = open_two();
    update(
        &mut harness.state_mut().state,
        Command::OpenPart(Part::Picture),
    );
    harness.run();
    harness.get_by_label("Projection").focus();
    harness.run();
    for key in [Key::Enter, Key::ArrowDown, Key::ArrowDown, Key::Enter] {
        harness.key_press(key);
        harness.run();
    }
    assert_ne!(
        harness.state().state.viewpoint.projection,
        Projection::Perspective
    );
    assert!(harness.query_by_label("Fisheye").is_none());
    assert!(harness.get_by_label("Projection").is_focused());
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
fn the_palette_lists_all_commands_again_after_few_were_found() {
    let mut harness = open();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run();
    harness.event(egui::Event::Text("wireframe".to_owned()));
    harness.run();
    harness.key_press(Key::Escape);
    harness.run();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run();
    // The sixth line is seen, and not only laid out: a click on its place reaches it.
    let watch = "Reload when changed";
    let at = harness.get_by(|node| node.label().is_some_and(|label| label.starts_with(watch)));
    let at = at.rect().center();
    let before = harness.state().state.preferences.watch;
    harness.event(egui::Event::PointerMoved(at));
    harness.run();
    for pressed in [true, false] {
        harness.event(egui::Event::PointerButton {
            pos: at,
            button: egui::PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
    }
    harness.run();
    assert_ne!(harness.state().state.preferences.watch, before);
}

#[test]
fn a_menu_that_is_open_takes_the_keys_and_all_of_it_can_be_reached_in_a_low_window() {
    let mut harness = open_two();
    harness.set_size(egui::vec2(640.0, 400.0));
    harness.run();
    click(&mut harness, "View");
    let before = harness.state().asked.len();
    for key in [Key::ArrowLeft, Key::W, Key::F] {
        harness.key_press(key);
        harness.run();
    }
    assert_eq!(harness.state().asked.len(), before);
    // Its entries are in the window, or scroll into it.
    let state = &harness.state().state;
    let actions = actions().filter(|action| action.menu == Menu::View && (action.applies)(state));
    let last = actions.last().expect("a menu has entries").name;
    let window = harness.ctx.content_rect();
    let is_seen = |harness: &Harness<'_, Bench>| {
        let mut entries = harness.query_all_by_label_contains(last);
        entries.any(|entry| window.contains_rect(entry.rect()))
    };
    assert!(!is_seen(&harness), "the menu is longer than the window");
    for _ in 0..60 {
        harness.key_press(Key::Tab);
        harness.run();
        if is_seen(&harness) {
            return;
        }
    }
    panic!("{last} was not reached");
}

#[test]
fn the_menu_bar_is_opened_by_a_key() {
    let mut harness = open_two();
    harness.key_press(Key::F10);
    harness.run();
    assert!(harness.state().effects.contains(&Effect::FocusMenu));
    menu::focus(&harness.ctx);
    harness.run();
    assert!(harness.get_by_label("File").is_focused());
    harness.key_press(Key::Enter);
    harness.run();
    // All entries are seen without scrolling where the window has room.
    let entries: Vec<_> = harness.query_all_by_label_contains("Quit").collect();
    let window = harness.ctx.content_rect();
    assert!(
        entries
            .iter()
            .any(|entry| window.contains_rect(entry.rect()))
    );
    let open: Vec<_> = harness.query_all_by_label_contains("Open…").collect();
    let height = entries[0].rect().bottom() - open[0].rect().top();
    assert!(height > 300.0, "{height}");
}

#[test]
fn arrows_open_menus_and_go_from_one_to_the_next() {
    let mut harness = open_two();
    let press = |harness: &mut Harness<'_, Bench>, keys: &[Key]| {
        for key in keys {
            harness.key_press(*key);
            harness.run();
        }
    };
    let has_focus = |harness: &Harness<'_, Bench>, entry: &str| {
        let mut entries = harness.query_all_by_label_contains(entry);
        entries.any(|entry| entry.is_focused())
    };
    menu::focus(&harness.ctx);
    harness.run();
    press(&mut harness, &[Key::ArrowDown]);
    assert!(has_focus(&harness, "Open…"));
    press(&mut harness, &[Key::ArrowLeft]);
    assert!(has_focus(&harness, "All commands…"), "the last menu");
    press(&mut harness, &[Key::ArrowRight]);
    assert!(has_focus(&harness, "Open…"), "and the first again");
    press(&mut harness, &[Key::ArrowRight, Key::ArrowRight]);
    assert!(has_focus(&harness, "Cube"));
    press(&mut harness, &[Key::Enter]);
    let added = harness.state().asked.last();
    assert!(matches!(added, Some(Command::AddShape(_))), "{added:?}");
    // Right and left of a submenu lead into it and out of it.
    menu::focus(&harness.ctx);
    harness.run();
    let left = [Key::ArrowDown, Key::ArrowLeft, Key::ArrowLeft];
    press(&mut harness, &left);
    assert!(has_focus(&harness, "Panel"));
    press(&mut harness, &[Key::ArrowDown, Key::ArrowRight]);
    assert!(has_focus(&harness, "Objects"));
    press(&mut harness, &[Key::ArrowLeft]);
    assert!(has_focus(&harness, "Part of the panel"));
    press(&mut harness, &[Key::ArrowLeft]);
    assert!(has_focus(&harness, "Measure distance"));
}

#[test]
fn a_key_fills_the_screen() {
    let mut harness = open_two();
    harness.key_press(Key::F11);
    harness.run();
    assert!(harness.state().effects.contains(&Effect::ToggleFullScreen));
}

#[test]
fn recent_files_are_found_in_the_palette() {
    let mut harness = open_two();
    let file = std::path::PathBuf::from("/models/heap of things.obj");
    harness.state_mut().state.preferences.remember(&file);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run();
    harness.event(egui::Event::Text("heap".to_owned()));
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
    assert!(harness.state().asked.contains(&Command::Open(vec![file])));
    assert!(harness.state().state.palette.is_none());
}
