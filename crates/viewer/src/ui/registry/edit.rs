//! Undo, and objects.

use super::action::{Action, Menu};
use super::chord::{alt, ctrl, ctrl_shift, plain, shift};
use super::when::has_scene;
use crate::state::command::Command;
use crate::state::groups;
use crate::state::handle::Tool;
use crate::state::insertion::Insertion;
use crate::state::turn::Turning;
use crate::state::{PromptKind, State};
use egui::Key;
use raycast_core::glam::DAffine3;
use raycast_core::scene::{Object, Transform};

macro_rules! handles {
    ($id:literal, $name:literal, $does:literal, $tool:ident, $keys:expr) => {
        Action::of(Menu::Edit, $id, $name, $does, $keys, |state| {
            let is_on = state.manipulating.tool == Some(Tool::$tool);
            Command::SetManipulator((!is_on).then_some(Tool::$tool))
        })
        .when(has_scene)
        .on(|state| state.manipulating.tool == Some(Tool::$tool))
    };
}

macro_rules! step {
    ($id:literal, $name:literal, $does:literal, $key:expr, $down:literal) => {
        Action::of(Menu::Edit, $id, $name, $does, &[alt($key)], |state| {
            // There is one, or the action would not apply.
            let to = step(state, $down).unwrap_or(Insertion {
                before: usize::MAX,
                parent: None,
            });
            Command::Reorder(selected(state), to)
        })
        .when(|state| step(state, $down).is_some())
    };
}

/// In the order of their menu.
pub(super) static ACTIONS: &[Action] = &[
    Action::of(
        Menu::Edit,
        "edit.undo",
        "Undo",
        "Take the last change back",
        &[ctrl(Key::Z)],
        |_| Command::Undo,
    )
    .also("history")
    .when(|state| state.history.undo_name().is_some())
    .lacks("There is nothing to undo"),
    Action::of(
        Menu::Edit,
        "edit.redo",
        "Redo",
        "Make again what was taken back",
        &[ctrl_shift(Key::Z), ctrl(Key::Y)],
        |_| Command::Redo,
    )
    .also("history")
    .when(|state| state.history.redo_name().is_some())
    .lacks("There is nothing to redo"),
    Action::of(
        Menu::Edit,
        "object.visible",
        "Visible",
        "Show the marked object, or hide it",
        &[plain(Key::H)],
        |state| Command::SetVisible(selected(state), !is_visible(state)),
    )
    .also("visibility")
    .when(has_selected)
    .lacks(UNMARKED)
    .on(is_visible)
    .apart(),
    Action::of(
        Menu::Edit,
        "object.isolate",
        "Isolate",
        "Show the marked object alone; once more shows all",
        &[plain(Key::I)],
        |state| Command::Isolate(selected(state)),
    )
    .when(has_selected)
    .lacks(UNMARKED),
    Action::of(
        Menu::Edit,
        "object.show_all",
        "Show all",
        "Show every object, and every group of its mesh",
        &[shift(Key::H)],
        |_| Command::ShowAll,
    )
    .when(|state| {
        let document = state.document.as_ref();
        document.is_some_and(|d| d.scene.objects.iter().any(Object::is_partly_hidden))
    })
    .lacks("Nothing is hidden"),
    Action::of(
        Menu::Edit,
        "group.hide",
        "Hide group",
        "Hide the group of the picked triangle",
        &[ctrl(Key::H)],
        |state| {
            let (object, group) = group(state);
            Command::SetGroupVisible {
                object,
                group,
                visible: false,
            }
        },
    )
    .also("visibility part")
    .when(has_group)
    .lacks(NO_GROUP)
    .apart(),
    Action::of(
        Menu::Edit,
        "group.isolate",
        "Isolate group",
        "Show the group of the picked triangle alone; once more shows all of the object's",
        &[ctrl(Key::I)],
        |state| {
            let (object, group) = group(state);
            Command::IsolateGroup { object, group }
        },
    )
    .also("part")
    .when(has_group)
    .lacks(NO_GROUP),
    Action::of(
        Menu::Edit,
        "object.rename",
        "Rename…",
        "Give the marked object another name",
        &[plain(Key::F2)],
        |state| Command::EditName(state.selected),
    )
    .when(has_selected)
    .lacks(UNMARKED),
    Action::of(
        Menu::Edit,
        "object.duplicate",
        "Duplicate",
        "Put a copy beside the marked object",
        &[ctrl(Key::D)],
        |state| Command::Duplicate(selected(state)),
    )
    .also("clone")
    .when(has_selected)
    .lacks(UNMARKED),
    Action::of(
        Menu::Edit,
        "object.lock",
        "Lock",
        "Keep the marked object as it is until it is unlocked",
        &[plain(Key::L)],
        |state| Command::SetLocked(selected(state), !state.is_locked(selected(state))),
    )
    .when(has_selected)
    .lacks(UNMARKED)
    .on(|state| state.is_locked(selected(state))),
    Action::of(
        Menu::Edit,
        "object.texture",
        "Texture…",
        "Put an image on the marked object",
        &[],
        |state| Command::Ask(PromptKind::TextureOf(selected(state))),
    )
    .when(has_selected)
    .lacks(UNMARKED),
    handles!(
        "object.move",
        "Move by handles",
        "Arrows and squares in the picture move the marked object; Ctrl snaps, Esc gives up",
        Move,
        &[plain(Key::G)]
    )
    .also("translate gizmo drag")
    .apart(),
    handles!(
        "object.turn",
        "Turn by handles",
        "Rings in the picture turn the marked object about its middle; Ctrl snaps, Esc gives up",
        Turn,
        &[shift(Key::R)]
    )
    .also("rotate gizmo"),
    handles!(
        "object.scale",
        "Scale by handles",
        "Handles in the picture scale the marked object; Ctrl snaps, Esc gives up",
        Scale,
        &[shift(Key::S)]
    )
    .also("resize gizmo"),
    Action::of(
        Menu::Edit,
        "object.own_axes",
        "Its own axes",
        "Move and turn along the marked object's own axes, or along the scene's",
        &[plain(Key::X)],
        |state| {
            Command::SetTurning(Turning {
                own: !state.turning.own,
                ..state.turning
            })
        },
    )
    .when(has_scene)
    .on(|state| state.turning.own),
    Action::of(
        Menu::Edit,
        "object.reset",
        "Put back",
        "Undo every move, turn and scale of the marked object",
        &[],
        |state| Command::SetTransform(selected(state), rest(state)),
    )
    .when(|state| has_selected(state) && transform(state) != Some(rest(state))),
    step!(
        "object.up",
        "Up in the list",
        "Put the marked object one row up",
        Key::ArrowUp,
        false
    )
    .apart(),
    step!(
        "object.down",
        "Down in the list",
        "Put the marked object one row down",
        Key::ArrowDown,
        true
    ),
    Action::of(
        Menu::Edit,
        "object.delete",
        "Delete",
        "Take the marked object away",
        &[plain(Key::Delete)],
        |state| Command::Delete(selected(state)),
    )
    .also("remove erase")
    .when(has_selected)
    .lacks(UNMARKED),
];

/// What actions on the selected object lack without one.
const UNMARKED: &str = "No object is marked: click one in the picture or in the list";

/// What actions on the picked group lack without one.
const NO_GROUP: &str = "No triangle of a mesh with groups is picked: click one in the picture";

/// The object and the group of the current pick.
fn picked_group(state: &State) -> Option<(usize, &str)> {
    groups::picked(state, state.picks.current()?)
}

fn has_group(state: &State) -> bool {
    picked_group(state).is_some()
}

/// The picked group; actions on it apply only if there is one.
fn group(state: &State) -> (usize, String) {
    let picked = picked_group(state);
    picked.map_or((usize::MAX, String::new()), |(object, name)| {
        (object, name.to_owned())
    })
}

fn has_selected(state: &State) -> bool {
    state.selected.is_some()
}

/// The selected object; actions on it apply only if there is one.
fn selected(state: &State) -> usize {
    state.selected.unwrap_or(usize::MAX)
}

/// The position of the selected object after a move by one row.
fn step(state: &State, down: bool) -> Option<Insertion> {
    let objects = &state.document.as_ref()?.scene.objects;
    Insertion::step(objects, state.selected?, down)
}

fn is_visible(state: &State) -> bool {
    let document = state.document.as_ref();
    let object = document.and_then(|d| d.scene.objects.get(selected(state)));
    object.is_some_and(|object| object.visible)
}

fn transform(state: &State) -> Option<Transform> {
    let document = state.document.as_ref()?;
    let object = document.scene.objects.get(selected(state))?;
    Some(object.transform)
}

/// The transform of the selected object in its file.
fn rest(state: &State) -> Transform {
    let matrix = transform(state).map_or(DAffine3::IDENTITY, |transform| transform.matrix);
    Transform::from_matrix(matrix)
}
