//! The registry of commands: what each is called, its keys, when it can be used, what it does. Menus, keys,
//! palette, help and tooltips are all read from here.

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

/// All entries, in the order of their menus.
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

/// The entry of this id.
///
/// # Panics
/// Where there is none: ids are written in this program alone, and a test asks for each.
pub fn action(id: &str) -> &'static Action {
    actions()
        .find(|action| action.id == id)
        .unwrap_or_else(|| panic!("there is no command {id}"))
}

/// For tooltips: the name of the entry of this id, its key in this window, and what it does.
pub fn hint(context: &egui::Context, id: &str) -> String {
    Keymap::of(context).hint(action(id))
}

/// What a key asks for; while a person types, only keys that cannot be meant for the text do.
pub fn pressed(
    keymap: &Keymap,
    state: &State,
    is_typing: bool,
    key: Key,
    modifiers: egui::Modifiers,
) -> Option<Command> {
    let action = actions().find(|action| keymap.has(action, is_typing, key, modifiers))?;
    (action.applies)(state).then(|| (action.command)(state))
}

/// Entries whose names have every word of `text`, those that begin with it first.
pub fn found(text: &str) -> Vec<&'static Action> {
    let text = text.trim().to_lowercase();
    let words: Vec<_> = text.split_whitespace().collect();
    let mut found: Vec<_> = actions()
        .filter(|action| {
            let name = format!("{} {} {}", action.menu.name(), action.name, action.does);
            let name = name.to_lowercase();
            words.iter().all(|word| name.contains(word))
        })
        .collect();
    let rank = |action: &Action| {
        let name = action.name.to_lowercase();
        match name {
            _ if name.starts_with(&text) => 0,
            _ if words.iter().all(|word| name.contains(word)) => 1,
            _ => 2,
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
        // Menus are read off in order: each is in one piece.
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
            None,
            "nothing to undo"
        );
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
    }
}
