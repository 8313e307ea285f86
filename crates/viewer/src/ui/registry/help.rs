//! Help.

use super::action::{Action, Menu};
use super::chord::{ctrl, plain};
use crate::state::command::Command;
use egui::Key;

/// In the order of their menu.
pub(super) static ACTIONS: &[Action] = &[
    Action::of(
        Menu::Help,
        "help.palette",
        "All commands…",
        "Find a command by its name",
        &[ctrl(Key::P)],
        |_| Command::TogglePalette,
    )
    .also("palette search"),
    Action::of(
        Menu::Help,
        "help.keys",
        "Keys and gestures…",
        "All keys and gestures of the mouse",
        &[plain(Key::F1), plain(Key::Questionmark)],
        |_| Command::ToggleHelp,
    )
    .also("shortcuts hotkeys"),
    Action::of(
        Menu::Help,
        "help.menu",
        "Menu bar",
        "Give the keyboard to the menu bar: arrows, Enter and Esc",
        &[plain(Key::F10)],
        |_| Command::FocusMenu,
    ),
    Action::of(
        Menu::Help,
        "help.keys_file",
        "Open keys file",
        "Open the file in which commands are given other keys; Reload keys takes it in",
        &[],
        |_| Command::OpenKeysFile,
    )
    .also("shortcuts hotkeys bindings settings preferences")
    .apart(),
    Action::of(
        Menu::Help,
        "help.reload_keys",
        "Reload keys",
        "Take in what the keys file says now",
        &[],
        |_| Command::ReloadKeys,
    ),
    Action::of(
        Menu::Help,
        "help.about",
        "About RayCast",
        "Tell the version and the license",
        &[],
        |_| Command::About,
    )
    .apart(),
];
