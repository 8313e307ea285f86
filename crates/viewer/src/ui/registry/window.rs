//! The window, and preferences.

use super::action::{Action, Menu};
use super::chord::{ctrl, plain};
use crate::state::command::Command;
use crate::state::preferences::{Mouse, Theme};
use egui::Key;

macro_rules! mouse {
    ($id:literal, $name:literal, $does:literal, $habits:ident) => {
        Action::of(Menu::Window, $id, $name, $does, &[], |_| {
            Command::SetMouse(Mouse::$habits)
        })
        .on(|state| state.preferences.mouse == Mouse::$habits)
    };
}

/// In the order of their menu.
pub(super) static ACTIONS: &[Action] = &[
    Action::of(
        Menu::Window,
        "window.panel",
        "Panel",
        "Show or hide the panel",
        &[plain(Key::P), plain(Key::N)],
        |_| Command::TogglePanel,
    )
    .on(|state| state.panel),
    Action::of(
        Menu::Window,
        "window.smooth",
        "Smooth camera",
        "The camera takes 200 ms from one view to another",
        &[],
        |state| Command::SetSmooth(!state.preferences.smooth),
    )
    .on(|state| state.preferences.smooth),
    mouse!(
        "window.mouse",
        "Mouse of a viewer",
        "Left drag orbits; right, middle or Shift+left drag pans",
        Viewer
    )
    .apart(),
    mouse!(
        "window.mouse_blender",
        "Mouse as in Blender",
        "Middle drag orbits, with Shift it pans, with Ctrl it zooms",
        Blender
    ),
    mouse!(
        "window.mouse_cad",
        "Mouse as in CAD",
        "Right drag orbits, middle drag pans",
        Cad
    ),
    Action::of(
        Menu::Window,
        "window.system_theme",
        "Theme of the system",
        "Light or dark, as the desktop is",
        &[],
        |_| Command::SetTheme(Theme::System),
    )
    .on(|state| state.preferences.theme == Theme::System)
    .apart(),
    Action::of(
        Menu::Window,
        "window.light_theme",
        "Light theme",
        "Light panels",
        &[],
        |_| Command::SetTheme(Theme::Light),
    )
    .on(|state| state.preferences.theme == Theme::Light),
    Action::of(
        Menu::Window,
        "window.dark_theme",
        "Dark theme",
        "Dark panels",
        &[],
        |_| Command::SetTheme(Theme::Dark),
    )
    .on(|state| state.preferences.theme == Theme::Dark),
    Action::of(
        Menu::Window,
        "window.larger",
        "Larger interface",
        "Larger text and buttons",
        &[ctrl(Key::Plus), ctrl(Key::Equals)],
        |state| Command::SetScale(state.preferences.scale * SCALE_STEP),
    )
    .apart(),
    Action::of(
        Menu::Window,
        "window.smaller",
        "Smaller interface",
        "Smaller text and buttons",
        &[ctrl(Key::Minus)],
        |state| Command::SetScale(state.preferences.scale / SCALE_STEP),
    ),
    Action::of(
        Menu::Window,
        "window.scale",
        "Interface as the system has it",
        "Text and buttons of the size that the desktop asks for",
        &[ctrl(Key::Num0)],
        |_| Command::SetScale(1.0),
    ),
];

/// The factor of one step of the interface's scale.
const SCALE_STEP: f32 = 1.1;
