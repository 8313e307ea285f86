//! Actions: commands with a name, keys and a place in the menus.

use super::chord::Chord;
use crate::state::State;
use crate::state::command::Command;

/// A menu, in the order of the menu bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Menu {
    /// Opening and saving.
    File,
    /// Undo and objects.
    Edit,
    /// Adding files and shapes.
    Add,
    /// The camera.
    View,
    /// The look of the picture.
    Look,
    /// Measuring, cutting, and checking meshes.
    Tools,
    /// The window, and preferences.
    Window,
    /// Help.
    Help,
}

impl Menu {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::File,
        Self::Edit,
        Self::Add,
        Self::View,
        Self::Look,
        Self::Tools,
        Self::Window,
        Self::Help,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::Add => "Add",
            Self::View => "View",
            Self::Look => "Look",
            Self::Tools => "Tools",
            Self::Window => "Window",
            Self::Help => "Help",
        }
    }
}

/// An action: a command that needs no further input.
pub struct Action {
    /// What it is called in files and tests: `menu.word`.
    pub id: &'static str,
    /// Its name in menus.
    pub name: &'static str,
    /// Its description, for tooltips and help.
    pub does: &'static str,
    /// Other words for it, by which it is found.
    pub words: &'static str,
    /// Its default keys, which the key bindings file may change.
    pub keys: &'static [Chord],
    /// Its menu.
    pub menu: Menu,
    /// Whether a separator is above it there.
    pub is_first_of_group: bool,
    /// Whether it applies now.
    pub applies: fn(&State) -> bool,
    /// What is missing where it does not apply; empty where that is plain to see.
    pub lacks: &'static str,
    /// Whether it is on, for an action that switches something.
    pub is_on: Option<fn(&State) -> bool>,
    /// Its command.
    pub command: fn(&State) -> Command,
}

impl Action {
    pub(super) const fn of(
        menu: Menu,
        id: &'static str,
        name: &'static str,
        does: &'static str,
        keys: &'static [Chord],
        command: fn(&State) -> Command,
    ) -> Self {
        Self {
            id,
            name,
            does,
            words: "",
            keys,
            menu,
            is_first_of_group: false,
            applies: |_| true,
            lacks: "",
            is_on: None,
            command,
        }
    }

    pub(super) const fn when(self, applies: fn(&State) -> bool) -> Self {
        Self { applies, ..self }
    }

    /// What is missing where it does not apply.
    pub(super) const fn lacks(self, lacks: &'static str) -> Self {
        Self { lacks, ..self }
    }

    pub(super) const fn on(self, is_on: fn(&State) -> bool) -> Self {
        Self {
            is_on: Some(is_on),
            ..self
        }
    }

    pub(super) const fn also(self, words: &'static str) -> Self {
        Self { words, ..self }
    }

    pub(super) const fn apart(self) -> Self {
        Self {
            is_first_of_group: true,
            ..self
        }
    }
}
