//! Measuring, cutting, and checking meshes.

use super::action::{Action, Menu};
use super::chord::plain;
use super::when::has_scene;
use crate::state::command::Command;
use crate::state::cut::{PlaneBy, has_room};
use crate::state::measure::Kind;
use crate::state::{PromptKind, State};
use egui::Key;

macro_rules! tool {
    ($id:literal, $name:literal, $does:literal, $kind:ident, $keys:expr) => {
        Action::of(Menu::Tools, $id, $name, $does, $keys, |state| {
            let is_on = state.measuring.tool == Some(Kind::$kind);
            Command::SetTool((!is_on).then_some(Kind::$kind))
        })
        .when(has_scene)
        .on(|state| state.measuring.tool == Some(Kind::$kind))
    };
}

macro_rules! cut {
    ($id:literal, $name:literal, $does:literal, $by:expr) => {
        Action::of(Menu::Tools, $id, $name, $does, &[], |_| {
            Command::AddPlane($by)
        })
        .also("slice clip")
        .when(has_room)
    };
}

/// In the order of their menu.
pub(super) static ACTIONS: &[Action] = &[
    tool!(
        "measure.distance",
        "Measure distance",
        "Measure from a point to another",
        Distance,
        &[plain(Key::D)]
    )
    .also("ruler length dimension"),
    tool!(
        "measure.angle",
        "Measure angle",
        "Measure the angle at the second of three points",
        Angle,
        &[plain(Key::A)]
    )
    .also("protractor"),
    tool!(
        "measure.path",
        "Measure path",
        "Measure along points, one after another",
        Path,
        &[]
    )
    .also("length polyline"),
    tool!(
        "measure.radius",
        "Measure radius",
        "Measure the circle through three points",
        Radius,
        &[]
    )
    .also("diameter circle"),
    Action::of(
        Menu::Tools,
        "measure.end",
        "End path",
        "End the path that is being measured",
        &[plain(Key::Enter)],
        |_| Command::EndPath,
    )
    .when(|state| state.measuring.tool == Some(Kind::Path) && state.measuring.points.len() > 1),
    Action::of(
        Menu::Tools,
        "measure.back",
        "Take point back",
        "Take back the last point of what is being measured",
        &[plain(Key::Backspace)],
        |_| Command::TakePointBack,
    )
    .when(|state| !state.measuring.points.is_empty()),
    Action::of(
        Menu::Tools,
        "measure.save",
        "Save CSV…",
        "Write what was measured to a file",
        &[],
        |_| Command::Ask(PromptKind::Measurements),
    )
    .when(|state| !state.measuring.list.is_empty())
    .lacks("Nothing is measured")
    .apart(),
    Action::of(
        Menu::Tools,
        "measure.clear",
        "Clear",
        "Forget all that was measured",
        &[],
        |_| Command::ClearMeasurements,
    )
    .when(|state| !state.measuring.list.is_empty())
    .lacks("Nothing is measured"),
    cut!(
        "cut.x",
        "Cut across X",
        "Section by a clipping plane across the X axis: what is before it is cut away",
        PlaneBy::Axis(0)
    )
    .apart(),
    cut!(
        "cut.y",
        "Cut across Y",
        "Section by a clipping plane across the Y axis: what is before it is cut away",
        PlaneBy::Axis(1)
    ),
    cut!(
        "cut.z",
        "Cut across Z",
        "Section by a clipping plane across the Z axis: what is before it is cut away",
        PlaneBy::Axis(2)
    ),
    cut!(
        "cut.view",
        "Cut across the view",
        "Section by a clipping plane through the point that one turns about: what is before it is cut away",
        PlaneBy::View
    ),
    Action::of(
        Menu::Tools,
        "cut.points",
        "Cut through three points",
        "Click three points of a section: what is before the clipping plane through them is cut away",
        &[],
        |state| Command::SetCutting(state.cutting.is_none()),
    )
    .also("slice clip")
    .when(has_room)
    .on(|state| state.cutting.is_some()),
    Action::of(
        Menu::Tools,
        "cut.outline",
        "Save outline…",
        "Write the lines in which the newest clipping plane cuts all that is visible, as SVG or DXF",
        &[],
        |state| Command::Ask(PromptKind::Outline(newest_plane(state).unwrap_or(usize::MAX))),
    )
    .when(|state| newest_plane(state).is_some())
    .lacks("There is no clipping plane"),
    Action::of(
        Menu::Tools,
        "tools.check",
        "Check the mesh",
        "Look for holes and other faults in the marked object, or in all",
        &[],
        |_| Command::Check { deep: false },
    )
    .also("health manifold holes watertight")
    .when(has_scene)
    .apart(),
    Action::of(
        Menu::Tools,
        "tools.intersections",
        "Find self-intersections",
        "Check the marked object, or all, and look for triangles that pass through one another: exactly, so it takes longer",
        &[],
        |_| Command::Check { deep: true },
    )
    .when(has_scene),
];

/// The last clipping plane that is switched on.
fn newest_plane(state: &State) -> Option<usize> {
    let planes = state.settings.clip.all();
    planes.iter().rposition(|plane| plane.enabled)
}
