//! Which keys commands have: their own, or those that a person gave them.

use super::action::Action;
use super::chord::Chord;
use egui::Key;
use std::collections::HashMap;
use std::sync::Arc;

/// The keys of all commands.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Keymap {
    /// Keys of commands that have not their own, by the command's id.
    changed: HashMap<&'static str, Vec<Chord>>,
}

impl Keymap {
    /// The keys of this window.
    pub fn of(context: &egui::Context) -> Arc<Self> {
        let id = egui::Id::unique("keymap");
        context.data_mut(|data| Arc::clone(data.get_temp_mut_or_default::<Arc<Self>>(id)))
    }

    /// Makes them the keys of this window.
    pub fn install(self, context: &egui::Context) {
        let id = egui::Id::unique("keymap");
        context.data_mut(|data| data.insert_temp(id, Arc::new(self)));
    }

    /// A command's keys, the first of which is shown.
    pub fn keys(&self, action: &Action) -> &[Chord] {
        self.changed
            .get(action.id)
            .map_or(action.keys, Vec::as_slice)
    }

    /// A command's first key as text; empty where it has none.
    pub fn key(&self, action: &Action) -> String {
        self.keys(action)
            .first()
            .map(Chord::name)
            .unwrap_or_default()
    }

    /// For tooltips: a command's name, its key, and what it does.
    pub fn hint(&self, action: &Action) -> String {
        let name = action.name.trim_end_matches('…');
        match self.keys(action).first() {
            Some(key) => format!("{name} ({})\n{}", key.name(), action.does),
            None => format!("{name}\n{}", action.does),
        }
    }

    /// Whether a key that was pressed is a command's; while a person types, only one that cannot be meant for
    /// the text.
    pub fn has(
        &self,
        action: &Action,
        is_typing: bool,
        key: Key,
        modifiers: egui::Modifiers,
    ) -> bool {
        self.keys(action)
            .iter()
            .any(|chord| chord.is(key, modifiers) && (!is_typing || chord.works_while_typing()))
    }

    /// Gives a command other keys; its own again where they are those.
    pub(super) fn set(&mut self, action: &'static Action, keys: Vec<Chord>) {
        if keys == action.keys {
            self.changed.remove(action.id);
        } else {
            self.changed.insert(action.id, keys);
        }
    }

    /// How many commands have not their own keys.
    pub fn changed(&self) -> usize {
        self.changed.len()
    }
}
