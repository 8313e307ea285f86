//! Key bindings: default keys, and those of the key bindings file.

use super::action::Action;
use super::chord::Chord;
use egui::Key;
use std::collections::HashMap;
use std::sync::Arc;

/// The keys of all actions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Keymap {
    /// Keys that differ from the default ones, by action id.
    changed: HashMap<&'static str, Vec<Chord>>,
}

impl Keymap {
    /// The window's key bindings.
    pub fn of(context: &egui::Context) -> Arc<Self> {
        let id = egui::Id::unique("keymap");
        context.data_mut(|data| Arc::clone(data.get_temp_mut_or_default::<Arc<Self>>(id)))
    }

    /// Sets the window's key bindings.
    pub fn install(self, context: &egui::Context) {
        let id = egui::Id::unique("keymap");
        context.data_mut(|data| data.insert_temp(id, Arc::new(self)));
    }

    /// An action's keys; the first one is displayed.
    pub fn keys(&self, action: &Action) -> &[Chord] {
        self.changed
            .get(action.id)
            .map_or(action.keys, Vec::as_slice)
    }

    /// An action's first key as text; empty if it has none.
    pub fn key(&self, action: &Action) -> String {
        self.keys(action)
            .first()
            .map(Chord::name)
            .unwrap_or_default()
    }

    /// A tooltip: an action's name, key and description.
    pub fn hint(&self, action: &Action) -> String {
        let name = action.name.trim_end_matches('…');
        match self.keys(action).first() {
            Some(key) => format!("{name} ({})\n{}", key.name(), action.does),
            None => format!("{name}\n{}", action.does),
        }
    }

    /// Whether a pressed key belongs to an action; while text is being typed, only keys that a text field does not use.
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

    /// Sets an action's keys.
    pub(super) fn set(&mut self, action: &'static Action, keys: Vec<Chord>) {
        if keys == action.keys {
            self.changed.remove(action.id);
        } else {
            self.changed.insert(action.id, keys);
        }
    }

    /// The number of actions whose keys differ from the default ones.
    pub fn changed(&self) -> usize {
        self.changed.len()
    }
}
