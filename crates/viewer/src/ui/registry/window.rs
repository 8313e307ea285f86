//! The window, and preferences.

use super::action::{Action, Menu};
use super::chord::{ctrl, plain};
use crate::state::command::Command;
use crate::state::part::Part;
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

macro_rules! part {
    ($id:literal, $part:ident, $does:literal, $words:literal) => {
        Action::of(
            Menu::Window,
            concat!("panel.", $id),
            concat!("Panel: ", stringify!($part)),
            $does,
            &[],
            |_| Command::OpenPart(Part::$part),
        )
        .also($words)
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
        "window.full_screen",
        "Full screen",
        "Fill the screen with the window, or no longer",
        &[plain(Key::F11)],
        |_| Command::ToggleFullScreen,
    )
    .also("fullscreen maximize presentation"),
    part!(
        "objects",
        Objects,
        "The list of objects, and the marked one's color, texture and place",
        "move translate rotate scale transform parent group"
    ),
    part!(
        "look",
        Look,
        "Mode, lines, colors, texture and background",
        "transparent background color map legend range shading lighting opacity"
    ),
    part!(
        "measure",
        Measure,
        "Measurements, the unit, and the marked object's size",
        "area volume bounding box dimensions csv"
    ),
    part!("cut", Cut, "Clipping planes", "section slice offset flip"),
    part!("health", Health, "Faults of meshes", "open manifold holes"),
    part!(
        "surface",
        Surface,
        "Which faces are seen, and how textures lie on them",
        "culling back faces texture filter mapping"
    ),
    part!(
        "camera",
        Camera,
        "Eye and target in numbers, and bookmarks",
        "position views"
    ),
    part!(
        "picture",
        Picture,
        "Resolution, step, field of view, projection and samples",
        "size width height fov panorama 360 fisheye equirectangular cylindrical cube map stereo vr anaglyph shift lens filter quality antialiasing projection"
    ),
    part!(
        "tiles",
        Tiles,
        "How the picture is split, and what is drawn over it",
        "overlay borders order grid tint sub-cameras"
    ),
    part!(
        "rendering",
        Rendering,
        "Threads, and the work that a picture took",
        "speed rays time statistics performance"
    ),
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
    .also("interface scale zoom dpi font size")
    .apart(),
    Action::of(
        Menu::Window,
        "window.smaller",
        "Smaller interface",
        "Smaller text and buttons",
        &[ctrl(Key::Minus)],
        |state| Command::SetScale(state.preferences.scale / SCALE_STEP),
    )
    .also("interface scale zoom dpi font size"),
    Action::of(
        Menu::Window,
        "window.scale",
        "Interface as the system has it",
        "Text and buttons of the size that the desktop asks for",
        &[ctrl(Key::Num0)],
        |_| Command::SetScale(1.0),
    )
    .also("interface scale zoom dpi font size"),
];

/// The factor of one step of the interface's scale.
const SCALE_STEP: f32 = 1.1;
