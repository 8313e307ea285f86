//! Paths, questions and errors.

use crate::bench::{click, open, open_two, open_with};
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use raycast_viewer::state::effect::{Effect, Keep};
use raycast_viewer::state::listing::Listing;
use raycast_viewer::state::news::{News, receive};
use raycast_viewer::state::{PromptKind, Replacing, State};
use raycast_viewer::worker::files::Activity;
use std::path::PathBuf;
use std::time::Duration;

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
    let whole = std::path::absolute("mesh.obj").expect("a path");
    let effect = Effect::Open(vec![whole], Keep::Nothing);
    assert_eq!(harness.state().effects.last(), Some(&effect));
    assert!(harness.state().state.prompt.is_none());
}

#[test]
fn a_typed_path_is_completed_by_the_names_in_its_folder() {
    let mut harness = open();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::O);
    harness.run();
    harness.event(egui::Event::Text("mo".to_owned()));
    harness.run();
    let lists = |folder: &str| Effect::List(folder.to_owned(), PromptKind::Open);
    assert_eq!(harness.state().effects.last(), Some(&lists("")));
    let read = |state: &mut State, folder: &str, names: &[&str]| {
        let names = names.iter().map(|&name| name.to_owned()).collect();
        let folder = folder.to_owned();
        let listing = News::Listed(Listing { folder, names });
        receive(state, listing, Duration::ZERO);
    };
    read(&mut harness.state_mut().state, "", &["cube.obj", "models/"]);
    harness.run();
    assert!(harness.query_by_label("cube.obj").is_none());
    harness.get_by_label("models/");
    harness.key_press(Key::Tab);
    harness.run();
    assert_eq!(harness.state().effects.last(), Some(&lists("models/")));
    read(
        &mut harness.state_mut().state,
        "models/",
        &["a.obj", "b.obj"],
    );
    harness.run();
    harness.key_press(Key::ArrowDown);
    harness.run();
    // A file that Enter accepts is opened; Tab, and a folder, leave the line open.
    harness.key_press(Key::Enter);
    harness.run();
    assert!(harness.state().state.prompt.is_none());
    let whole = std::path::absolute("models/b.obj").expect("a path");
    let effect = Effect::Open(vec![whole], Keep::Nothing);
    assert_eq!(harness.state().effects.last(), Some(&effect));
}

/// A slow machine gets the key that opens a text field and what is typed into it in one frame.
#[test]
fn letters_typed_with_the_key_that_opens_a_text_field_are_text_and_no_commands() {
    let mut harness = open_two();
    let at_once = |harness: &mut egui_kittest::Harness<'_, crate::bench::Bench>,
                   key,
                   typed: &[(Key, &str)]| {
        let press = |key, modifiers| egui::Event::Key {
            key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers,
        };
        let mut events = vec![press(key, Modifiers::COMMAND)];
        for (key, text) in typed {
            events.push(press(*key, Modifiers::NONE));
            events.push(egui::Event::Text((*text).to_owned()));
        }
        harness.input_mut().events.extend(events);
        harness.run();
    };
    let borders = harness.state().state.overlay.borders;
    at_once(&mut harness, Key::P, &[(Key::T, "t"), (Key::W, "w")]);
    harness.event(egui::Event::Text("x".to_owned()));
    harness.run();
    let state = &harness.state().state;
    assert_eq!(
        state.palette.as_ref().map(|palette| &*palette.text),
        Some("twx")
    );
    assert_eq!(state.overlay.borders, borders, "T is a letter there");
    harness.key_press(Key::Escape);
    harness.run();
    // Text and Enter in one frame run what the text finds.
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run();
    harness.event(egui::Event::Text("tile borders".to_owned()));
    harness.key_press(Key::Enter);
    harness.run();
    let state = &harness.state().state;
    assert_ne!(state.overlay.borders, borders);
    assert!(state.palette.is_none() && state.prompt.is_none());

    let text = |harness: &egui_kittest::Harness<'_, crate::bench::Bench>| {
        let prompt = harness.state().state.prompt.as_ref();
        prompt.map(|prompt| prompt.text.clone())
    };
    at_once(&mut harness, Key::O, &[(Key::A, "a")]);
    harness.event(egui::Event::Text("b".to_owned()));
    harness.run();
    assert_eq!(text(&harness).as_deref(), Some("ab"));
    harness.key_press(Key::Escape);
    harness.run();
    at_once(&mut harness, Key::E, &[(Key::A, "a")]);
    harness.event(egui::Event::Text("b".to_owned()));
    harness.run();
    assert_eq!(
        text(&harness).as_deref(),
        Some("ab.png"),
        "the ending stays"
    );
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
fn a_line_for_a_file_to_be_written_names_the_folder_and_does_not_offer_to_drop_one() {
    const DROP: &str = "type a path, or drop a file on the window:";
    let folder = std::env::current_dir().expect("a folder");
    let writes = format!("type a path, or a name in {}:", folder.display());
    let mut harness = open_two();
    for (key, drops) in [(Key::E, false), (Key::O, true)] {
        harness.key_press_modifiers(Modifiers::COMMAND, key);
        harness.run();
        // There is no desktop that opens a dialog.
        let prompt = harness.state_mut().state.prompt.as_mut();
        prompt.expect("a path line").dialog = false;
        harness.run();
        assert_eq!(harness.query_by_label(DROP).is_some(), drops);
        assert_eq!(harness.query_by_label(&writes).is_some(), !drops);
        harness.key_press(Key::Escape);
        harness.run();
    }
}

#[test]
fn files_that_are_held_over_the_window_are_told_what_a_drop_does() {
    let mut harness = open_two();
    let mut held = |count: usize, modifiers: Modifiers, text: &str| {
        harness.input_mut().hovered_files = vec![egui::HoveredFile::default(); count];
        harness.event(egui::Event::ModifiersChanged(modifiers));
        // While files are held the window is painted all the time.
        harness.run_steps(3);
        assert_eq!(harness.query_by_label(text).is_some(), count > 0, "{text}");
    };
    let opens = "Drop to open the file, or hold Shift to add to what is open";
    held(1, Modifiers::NONE, opens);
    held(2, Modifiers::SHIFT, "Drop to add the files to what is open");
    held(0, Modifiers::NONE, opens);
}

#[test]
fn the_question_about_replacing_a_file_is_answered_by_keys() {
    let mut harness = open_two();
    let ask = || Replacing {
        path: PathBuf::from("a.png"),
        by: PromptKind::Picture,
    };
    for (to_replace, effects) in [(false, 0), (true, 1)] {
        harness.state_mut().state.replacing = Some(ask());
        harness.run();
        if to_replace {
            harness.key_press_modifiers(Modifiers::SHIFT, Key::Tab);
            harness.run();
        }
        harness.key_press(Key::Enter);
        harness.run();
        assert!(harness.state().state.replacing.is_none());
        assert_eq!(harness.state().effects.len(), effects);
    }
    let replaces = Effect::SavePicture {
        path: PathBuf::from("a.png"),
        replace: true,
    };
    assert_eq!(harness.state().effects, [replaces]);
}
