//! The camera.

use super::action::{Action, Menu};
use super::chord::{alt, ctrl, plain, shift};
use super::when::has_scene;
use crate::state::State;
use crate::state::command::Command;
use crate::state::update::middle;
use crate::state::viewpoint::StandardView;
use egui::Key;
use raycast_core::camera::Projection;

macro_rules! view {
    ($id:literal, $name:literal, $view:ident, $keys:expr) => {
        Action::of(
            Menu::View,
            $id,
            $name,
            concat!("Look from this side: ", $name),
            $keys,
            |_| Command::Look(StandardView::$view),
        )
        .when(has_scene)
        .on(|state| look(state, StandardView::$view))
    };
}

/// In the order of their menu.
pub(super) static ACTIONS: &[Action] = &[
    Action::of(
        Menu::View,
        "view.fit",
        "Fit",
        "Bring all that is visible into view",
        &[plain(Key::F), plain(Key::Home)],
        |_| Command::Fit,
    )
    .also("frame all center")
    .when(has_scene),
    Action::of(
        Menu::View,
        "view.reset",
        "Reset",
        "The view that the scene was first shown from",
        &[plain(Key::R)],
        |_| Command::ResetView,
    )
    .also("home")
    .when(has_scene),
    Action::of(
        Menu::View,
        "view.back",
        "Back",
        "The view before",
        &[alt(Key::ArrowLeft)],
        |_| Command::ViewBack,
    )
    .when(|state| state.trail.has_past())
    .lacks("There is no earlier view"),
    Action::of(
        Menu::View,
        "view.forward",
        "Forward",
        "The view that was come back from",
        &[alt(Key::ArrowRight)],
        |_| Command::ViewForward,
    )
    .when(|state| state.trail.has_future())
    .lacks("There is no later view"),
    Action::of(
        Menu::View,
        "view.walk",
        "Walk",
        "Walk through the scene: W A S D, E and Q, a drag looks around, the wheel changes speed",
        &[shift(Key::W)],
        |state| Command::SetWalk(state.walk.is_none()),
    )
    .also("fly first person interior")
    .when(has_scene)
    .on(|state| state.walk.is_some())
    .apart(),
    Action::of(
        Menu::View,
        "view.bookmark",
        "Keep view",
        "Keep this view in the list of the panel's part Camera",
        &[plain(Key::B)],
        |_| Command::AddBookmark,
    )
    .also("bookmark")
    .when(has_scene)
    .apart(),
    Action::of(
        Menu::View,
        "view.copy",
        "Copy camera",
        "Copy the camera as options of raycast render; Ctrl+C does the same, and Ctrl+V goes to one",
        &[],
        |_| Command::CopyCamera,
    )
    .when(has_scene),
    view!("view.front", "Front", Front, &[plain(Key::Num1)]).apart(),
    view!("view.back_side", "Back side", Back, &[ctrl(Key::Num1)]),
    view!("view.right", "Right", Right, &[plain(Key::Num3)]),
    view!("view.left", "Left", Left, &[ctrl(Key::Num3)]),
    view!("view.top", "Top", Top, &[plain(Key::Num7)]),
    view!("view.bottom", "Bottom", Bottom, &[ctrl(Key::Num7)]),
    view!(
        "view.isometric",
        "Isometric",
        Isometric,
        &[plain(Key::Num0)]
    ),
    Action::of(
        Menu::View,
        "view.opposite",
        "Opposite",
        "Look from the other side",
        &[plain(Key::Num9)],
        |_| Command::LookBack,
    )
    .when(has_scene),
    Action::of(
        Menu::View,
        "view.orthographic",
        "Orthographic",
        "Rays side by side, or all from the eye",
        &[plain(Key::Num5), plain(Key::O)],
        |state| {
            Command::SetProjection(match state.viewpoint.projection {
                Projection::Perspective => Projection::Orthographic,
                Projection::Orthographic | Projection::Panoramic(_) => Projection::Perspective,
            })
        },
    )
    .also("perspective parallel projection")
    .on(|state| state.viewpoint.projection == Projection::Orthographic)
    .apart(),
    Action::of(
        Menu::View,
        "view.orbit_left",
        "Orbit left",
        "Turn about the pivot by 5°",
        &[plain(Key::ArrowLeft), plain(Key::Num4)],
        |_| turn(-5.0, 0.0),
    )
    .apart(),
    Action::of(
        Menu::View,
        "view.orbit_right",
        "Orbit right",
        "Turn about the pivot by 5°",
        &[plain(Key::ArrowRight), plain(Key::Num6)],
        |_| turn(5.0, 0.0),
    ),
    Action::of(
        Menu::View,
        "view.orbit_up",
        "Orbit up",
        "Turn about the pivot by 5°",
        &[plain(Key::ArrowUp), plain(Key::Num8)],
        |_| turn(0.0, 5.0),
    ),
    Action::of(
        Menu::View,
        "view.orbit_down",
        "Orbit down",
        "Turn about the pivot by 5°",
        &[plain(Key::ArrowDown), plain(Key::Num2)],
        |_| turn(0.0, -5.0),
    ),
    Action::of(
        Menu::View,
        "view.roll_left",
        "Roll left",
        "Roll the camera by 15°",
        &[plain(Key::Comma)],
        |_| Command::Roll(-15.0),
    ),
    Action::of(
        Menu::View,
        "view.roll_right",
        "Roll right",
        "Roll the camera by 15°",
        &[plain(Key::Period)],
        |_| Command::Roll(15.0),
    ),
    Action::of(
        Menu::View,
        "view.nearer",
        "Nearer",
        "Zoom in on the middle",
        &[plain(Key::PageUp)],
        |state| Command::Zoom {
            at: middle(state),
            factor: 0.8,
        },
    ),
    Action::of(
        Menu::View,
        "view.further",
        "Further",
        "Zoom out",
        &[plain(Key::PageDown)],
        |state| Command::Zoom {
            at: middle(state),
            factor: 1.25,
        },
    ),
];

fn look(state: &State, view: StandardView) -> bool {
    let orbit = &state.viewpoint.orbit;
    let (yaw, pitch) = view.angles();
    state.viewpoint.roll == 0.0 && (orbit.yaw, orbit.pitch) == (yaw, pitch)
}

fn turn(yaw: f64, pitch: f64) -> Command {
    Command::Orbit { yaw, pitch }
}
