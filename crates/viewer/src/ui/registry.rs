//! The registry of actions: name, keys, when each applies, and its command. Menus, keys, palette, help and tooltips are
//! made from it.

mod action;
mod add;
mod chord;
mod edit;
mod file;
mod help;
mod keymap;
mod keys_file;
mod look;
mod tools;
mod view;
mod when;
mod window;

pub use action::{Action, Menu};
pub use chord::Chord;
pub use keymap::Keymap;
pub use keys_file::KeysFile;

use crate::state::State;
use crate::state::command::Command;
use egui::Key;

/// All actions, in the order of their menus.
pub fn actions() -> impl Iterator<Item = &'static Action> + Clone {
    [
        file::ACTIONS,
        edit::ACTIONS,
        add::ACTIONS,
        view::ACTIONS,
        look::ACTIONS,
        tools::ACTIONS,
        window::ACTIONS,
        help::ACTIONS,
    ]
    .into_iter()
    .flatten()
}

/// The action with this id.
///
/// # Panics
/// If there is none: ids are constants of this program, and a test looks each up.
pub fn action(id: &str) -> &'static Action {
    actions()
        .find(|action| action.id == id)
        .unwrap_or_else(|| panic!("there is no command {id}"))
}

/// A tooltip: the name of the action with this id, its key, and its description.
pub fn hint(context: &egui::Context, id: &str) -> String {
    Keymap::of(context).hint(action(id))
}

/// The action of a key; while text is being typed, only of keys that a text field does not use.
pub fn pressed(
    keymap: &Keymap,
    state: &State,
    is_typing: bool,
    key: Key,
    modifiers: egui::Modifiers,
) -> Option<Command> {
    let action = actions().find(|action| keymap.has(action, is_typing, key, modifiers))?;
    match (action.applies)(state) {
        true => Some((action.command)(state)),
        false => (!action.lacks.is_empty()).then_some(Command::Tell(action.lacks)),
    }
}

/// Actions whose names, descriptions or other words contain every word of `text`: first those whose names begin with it, then
/// those whose names contain its words, then those that have them among their other words.
pub fn found(text: &str) -> Vec<&'static Action> {
    let text = text.trim().to_lowercase();
    let words: Vec<_> = text.split_whitespace().collect();
    let mut found: Vec<_> = actions()
        .filter(|action| {
            let Action {
                menu, name, does, ..
            } = action;
            let name = format!("{} {name} {does} {}", menu.name(), action.words);
            let name = name.to_lowercase();
            words.iter().all(|word| name.contains(word))
        })
        .collect();
    let rank = |action: &Action| {
        let name = action.name.to_lowercase();
        match name {
            _ if name.starts_with(&text) => 0,
            _ if words.iter().all(|word| name.contains(word)) => 1,
            _ if words
                .iter()
                .all(|&word| action.words.split(' ').any(|own| own == word)) =>
            {
                2
            }
            _ => 3,
        }
    };
    found.sort_by_key(|action| rank(action));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::PromptKind;
    use egui::Modifiers;
    use raycast_core::shade::Mode;

    #[test]
    fn no_two_commands_have_the_same_key_or_id() {
        let all: Vec<_> = actions().collect();
        for (number, one) in all.iter().enumerate() {
            for other in &all[number + 1..] {
                assert_ne!(one.id, other.id);
                for chord in one.keys {
                    let clash = other.keys.iter().any(|other| other.clashes(chord));
                    assert!(!clash, "{}: {} and {}", chord.name(), one.id, other.id);
                }
            }
        }
    }

    #[test]
    fn every_command_says_what_it_does_and_has_its_menu() {
        for action in actions() {
            assert!(
                !action.name.is_empty() && action.does.len() > 4,
                "{}",
                action.id
            );
            assert!(Menu::ALL.contains(&action.menu));
        }
        // The actions of a menu must be contiguous.
        let mut menus: Vec<_> = actions().map(|action| action.menu).collect();
        menus.dedup();
        assert_eq!(menus, Menu::ALL);
    }

    #[test]
    fn keys_ask_for_what_the_registry_says() {
        let mut state = State::default();
        let keymap = Keymap::default();
        let press = |state: &State, key, modifiers| pressed(&keymap, state, false, key, modifiers);
        assert_eq!(
            press(&state, Key::Num5, Modifiers::ALT),
            Some(Command::SetMode(Mode::Depth))
        );
        assert_eq!(
            press(&state, Key::W, Modifiers::NONE),
            Some(Command::SetWireframe(true))
        );
        state.settings.shading.wireframe = Some(Default::default());
        assert_eq!(
            press(&state, Key::W, Modifiers::NONE),
            Some(Command::SetWireframe(false))
        );
        assert_eq!(
            press(&state, Key::Plus, Modifiers::SHIFT),
            Some(Command::ScaleStep(0.5))
        );
        assert_eq!(
            press(&state, Key::Z, Modifiers::COMMAND),
            Some(Command::Tell("There is nothing to undo"))
        );
        let said = press(&state, Key::Delete, Modifiers::NONE);
        assert!(matches!(said, Some(Command::Tell(text)) if text.contains("marked")));
        assert_eq!(
            pressed(&keymap, &state, true, Key::W, Modifiers::NONE),
            None
        );
        assert_eq!(
            pressed(&keymap, &state, true, Key::O, Modifiers::COMMAND),
            Some(Command::Ask(PromptKind::Open))
        );
        let typed = |key| pressed(&keymap, &state, true, key, Modifiers::COMMAND);
        assert!(typed(Key::Num0).is_some() && typed(Key::Plus).is_some());
        assert!(typed(Key::Z).is_none() && typed(Key::A).is_none());
    }

    #[test]
    fn keys_are_read_as_they_are_written() {
        for chord in actions().flat_map(|action| action.keys) {
            assert_eq!(Chord::read(&chord.name()), Ok(*chord), "{}", chord.name());
        }
        assert_eq!(
            Chord::read("control + pagedown"),
            Chord::read("Ctrl+Page Down")
        );
        for text in ["", "Shift", "Ctrl+C", "Ctrl+Nothing", "Escape", "Hyper+A"] {
            assert!(Chord::read(text).is_err(), "{text}");
        }
    }

    #[test]
    fn commands_are_found_by_words_of_their_names() {
        assert_eq!(found("fit")[0].id, "view.fit");
        assert_eq!(found("save pic")[0].id, "file.picture");
        assert_eq!(found("").len(), actions().count());
        assert!(found("no such thing").is_empty());
        // Words of other programs, and of the manual.
        for (text, id) in [
            ("bookmark", "view.bookmark"),
            ("health", "tools.check"),
            ("screenshot", "file.picture"),
            ("interface scale", "window.larger"),
            ("fisheye", "panel.picture"),
            ("resolution", "panel.picture"),
            ("transparent", "look.mode.11"),
            ("transparent background", "panel.look"),
            ("slice", "cut.x"),
            ("clip", "cut.x"),
            ("ruler", "measure.distance"),
            ("hide", "object.visible"),
            ("clone", "object.duplicate"),
            ("remove", "object.delete"),
            ("import", "file.open"),
            ("export", "file.meshes"),
            ("home", "view.reset"),
            ("perspective", "view.orthographic"),
            ("xray", "look.mode.11"),
            ("pbr", "look.mode.10"),
            ("floor", "look.ground"),
            ("gizmo", "object.move"),
            ("shortcuts", "help.keys"),
            ("exit", "file.quit"),
            ("fullscreen", "window.full_screen"),
            ("bounding box", "panel.measure"),
            ("anaglyph", "panel.picture"),
            ("threads", "panel.rendering"),
            ("fly", "view.walk"),
        ] {
            let found = found(text);
            assert!(found.iter().any(|action| action.id == id), "{text}");
        }
    }
}
