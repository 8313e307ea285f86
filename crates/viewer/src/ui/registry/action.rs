//! What a command is called, its keys, when it can be used, what it does.

use super::chord::Chord;
use crate::state::State;
use crate::state::command::Command;

/// A menu, in the order of the menu bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Menu {
    /// Opening and saving.
    File,
    /// Undo, and objects.
    Edit,
    /// Files and shapes beside what is open.
    Add,
    /// The camera.
    View,
    /// What the picture shows.
    Look,
    /// Measuring, and looking meshes over.
    Tools,
    /// The window and how it works.
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

/// An entry: something that can be asked for without more being said.
pub struct Action {
    /// What it is called in files and tests: `menu.word`.
    pub id: &'static str,
    /// What it is called in menus.
    pub name: &'static str,
    /// What it does, in a sentence for tooltips and help.
    pub does: &'static str,
    /// Its usual keys, which a person may change.
    pub keys: &'static [Chord],
    /// Its menu.
    pub menu: Menu,
    /// Whether a line is drawn above it there.
    pub is_first_of_group: bool,
    /// Whether it can be used now.
    pub applies: fn(&State) -> bool,
    /// Whether it is on, if it is something that is on or off.
    pub is_on: Option<fn(&State) -> bool>,
    /// What it asks for.
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
            keys,
            menu,
            is_first_of_group: false,
            applies: |_| true,
            is_on: None,
            command,
        }
    }

    pub(super) const fn when(self, applies: fn(&State) -> bool) -> Self {
        Self { applies, ..self }
    }

    pub(super) const fn on(self, is_on: fn(&State) -> bool) -> Self {
        Self {
            is_on: Some(is_on),
            ..self
        }
    }

    pub(super) const fn apart(self) -> Self {
        Self {
            is_first_of_group: true,
            ..self
        }
    }
}
