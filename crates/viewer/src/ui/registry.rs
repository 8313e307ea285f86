//! The registry of commands: what each is called, its keys, when it can be used, what it does. Menus, keys,
//! palette, help and tooltips are all read from here.

mod action;
mod chord;
mod list;

pub use action::{Action, Menu};
pub use chord::Chord;
pub use list::ACTIONS;

use crate::state::State;
use crate::state::command::Command;
use egui::Key;

/// The entry of this id.
///
/// # Panics
/// Where there is none: ids are written in this program alone, and a test asks for each.
pub fn action(id: &str) -> &'static Action {
    ACTIONS
        .iter()
        .find(|action| action.id == id)
        .unwrap_or_else(|| panic!("there is no command {id}"))
}

/// What a key asks for; while a person types, only keys that cannot be meant for the text do.
pub fn pressed(
    state: &State,
    is_typing: bool,
    key: Key,
    modifiers: egui::Modifiers,
) -> Option<Command> {
    let is_it =
        |chord: &&Chord| chord.is(key, modifiers) && (!is_typing || chord.works_while_typing());
    let action = ACTIONS
        .iter()
        .find(|action| action.keys.iter().any(|chord| is_it(&chord)))?;
    (action.applies)(state).then(|| (action.command)(state))
}

/// Entries whose names have every word of `text`, those that begin with it first.
pub fn found(text: &str) -> Vec<&'static Action> {
    let text = text.trim().to_lowercase();
    let words: Vec<_> = text.split_whitespace().collect();
    let mut found: Vec<_> = ACTIONS
        .iter()
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
        for (number, one) in ACTIONS.iter().enumerate() {
            for other in &ACTIONS[number + 1..] {
                assert_ne!(one.id, other.id);
                for chord in one.keys {
                    // Shift does not tell symbols apart.
                    let modifiers = Modifiers {
                        alt: chord.alt,
                        ctrl: chord.ctrl,
                        command: chord.ctrl,
                        shift: chord.shift,
                        ..Modifiers::NONE
                    };
                    let clash = other
                        .keys
                        .iter()
                        .any(|other| other.is(chord.key, modifiers));
                    assert!(!clash, "{}: {} and {}", chord.name(), one.id, other.id);
                }
            }
        }
    }

    #[test]
    fn every_command_says_what_it_does_and_has_its_menu() {
        for action in ACTIONS {
            assert!(
                !action.name.is_empty() && action.does.len() > 4,
                "{}",
                action.id
            );
            assert!(Menu::ALL.contains(&action.menu));
        }
        // Menus are read off in order: each is in one piece.
        let mut menus: Vec<_> = ACTIONS.iter().map(|action| action.menu).collect();
        menus.dedup();
        assert_eq!(menus, Menu::ALL);
    }

    #[test]
    fn keys_ask_for_what_the_registry_says() {
        let mut state = State::default();
        let press = |state: &State, key, modifiers| pressed(state, false, key, modifiers);
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
        assert_eq!(pressed(&state, true, Key::W, Modifiers::NONE), None);
        assert_eq!(
            pressed(&state, true, Key::O, Modifiers::COMMAND),
            Some(Command::Ask(PromptKind::Open))
        );
    }

    #[test]
    fn commands_are_found_by_words_of_their_names() {
        assert_eq!(found("fit")[0].id, "view.fit");
        assert_eq!(found("save pic")[0].id, "file.picture");
        assert_eq!(found("").len(), ACTIONS.len());
        assert!(found("no such thing").is_empty());
    }
}
