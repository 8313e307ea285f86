//! The look of the picture.

use super::action::{Action, Menu};
use super::chord::{alt, plain, shift};
use super::when::has_scene;
use crate::state::command::Command;
use crate::state::{PromptKind, State};
use crate::ui::modes::MODES;
use egui::Key;
use raycast_core::shade::Ground;

macro_rules! mode {
    ($number:literal, $key:ident, $words:literal) => {
        Action::of(
            Menu::Look,
            concat!("look.mode.", $number),
            MODES[$number - 1].1,
            MODES[$number - 1].2,
            &[alt(Key::$key)],
            |_| Command::SetMode(MODES[$number - 1].0),
        )
        .also($words)
        .on(|state| state.settings.shading.mode == MODES[$number - 1].0)
    };
}

/// In the order of their menu.
pub(super) static ACTIONS: &[Action] = &[
    mode!(1, Num1, "unlit"),
    mode!(2, Num2, "faceted shaded"),
    mode!(3, Num3, "shaded"),
    mode!(4, Num4, ""),
    mode!(5, Num5, ""),
    mode!(6, Num6, ""),
    mode!(7, Num7, "uvs"),
    mode!(8, Num8, "unlit image"),
    mode!(9, Num9, "wireframe edges"),
    mode!(10, Num0, "pbr metallic roughness"),
    mode!(11, X, "xray transparent transparency ghost"),
    Action::of(
        Menu::Look,
        "look.next_mode",
        "Next mode",
        "Show the next mode",
        &[plain(Key::M)],
        |state| mode_after(state, 1),
    )
    .apart(),
    Action::of(
        Menu::Look,
        "look.previous_mode",
        "Previous mode",
        "Show the mode before",
        &[shift(Key::M)],
        |state| mode_after(state, MODES.len() - 1),
    ),
    Action::of(
        Menu::Look,
        "look.wireframe",
        "Wireframe",
        "Lines along the triangles' edges, over any mode",
        &[plain(Key::W)],
        |state| Command::SetWireframe(state.settings.shading.wireframe.is_none()),
    )
    .also("edges")
    .on(|state| state.settings.shading.wireframe.is_some())
    .apart(),
    Action::of(
        Menu::Look,
        "look.ground",
        "Ground grid",
        "Lines on a level plane at the scene's lowest point: x in red, z in blue",
        &[shift(Key::G)],
        |state| {
            let is_shown = state.settings.shading.ground.is_some();
            Command::SetGround((!is_shown).then(Ground::default))
        },
    )
    .also("floor axes")
    .on(|state| state.settings.shading.ground.is_some()),
    Action::of(
        Menu::Look,
        "look.borders",
        "Tile borders",
        "Lines between tiles",
        &[plain(Key::T)],
        |state| Command::SetBorders(!state.overlay.borders),
    )
    .on(|state| state.overlay.borders),
    Action::of(
        Menu::Look,
        "look.texture",
        "Load texture…",
        "Put an image on every object",
        &[],
        |_| Command::Ask(PromptKind::Texture),
    )
    .when(has_scene),
    Action::of(
        Menu::Look,
        "look.denser",
        "Halve the step",
        "Half the step: denser rays",
        &[plain(Key::Plus), plain(Key::Equals)],
        |_| Command::ScaleStep(0.5),
    )
    .apart(),
    Action::of(
        Menu::Look,
        "look.sparser",
        "Double the step",
        "Double the step: sparser rays",
        &[plain(Key::Minus)],
        |_| Command::ScaleStep(2.0),
    ),
    Action::of(
        Menu::Look,
        "look.refine",
        "More samples at rest",
        "16 rays a pixel when nothing moves, so that edges are clean",
        &[],
        |state| Command::SetRefine(!state.preferences.refine),
    )
    .on(|state| state.preferences.refine),
];

/// The mode so many places after the present one.
fn mode_after(state: &State, step: usize) -> Command {
    let now = MODES
        .iter()
        .position(|(mode, ..)| *mode == state.settings.shading.mode)
        .unwrap_or(0);
    Command::SetMode(MODES[(now + step) % MODES.len()].0)
}
