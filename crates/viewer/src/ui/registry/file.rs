//! Opening and saving.

use super::action::{Action, Menu};
use super::chord::{ctrl, ctrl_shift, plain};
use super::when::has_scene;
use crate::state::command::Command;
use crate::state::{PromptKind, State};
use egui::Key;

/// In the order of their menu.
pub(super) static ACTIONS: &[Action] = &[
    Action::of(
        Menu::File,
        "file.open",
        "Open…",
        "Open meshes or a scene",
        &[ctrl(Key::O)],
        |_| Command::Ask(PromptKind::Open),
    ),
    Action::of(
        Menu::File,
        "file.add",
        "Add…",
        "Put more meshes beside what is open",
        &[ctrl_shift(Key::O)],
        |_| Command::Ask(PromptKind::Add),
    ),
    Action::of(
        Menu::File,
        "file.next",
        "Next in folder",
        "Open the folder's next file",
        &[ctrl(Key::PageDown)],
        |_| Command::OpenNeighbor(1),
    )
    .when(has_files)
    .apart(),
    Action::of(
        Menu::File,
        "file.previous",
        "Previous in folder",
        "Open the file before this one in its folder",
        &[ctrl(Key::PageUp)],
        |_| Command::OpenNeighbor(-1),
    )
    .when(has_files),
    Action::of(
        Menu::File,
        "file.reload",
        "Reload",
        "Read the files once more; the camera stays",
        &[plain(Key::F5)],
        |_| Command::Reload,
    )
    .when(has_files),
    Action::of(
        Menu::File,
        "file.watch",
        "Reload when changed",
        "Read files again when they change on the disk",
        &[],
        |state| Command::SetWatch(!state.preferences.watch),
    )
    .on(|state| state.preferences.watch),
    Action::of(
        Menu::File,
        "file.save",
        "Save scene",
        "Write objects, camera and look to a scene file",
        &[ctrl(Key::S)],
        |_| Command::SaveScene,
    )
    .when(has_scene)
    .apart(),
    Action::of(
        Menu::File,
        "file.save_as",
        "Save scene as…",
        "Write the scene to another file",
        &[ctrl_shift(Key::S)],
        |_| Command::Ask(PromptKind::Scene),
    )
    .when(has_scene),
    Action::of(
        Menu::File,
        "file.picture",
        "Save picture…",
        "Write the picture as PNG, PPM, JPEG or EXR",
        &[ctrl(Key::E), plain(Key::S)],
        |_| Command::Ask(PromptKind::Picture),
    )
    .also("screenshot export image render")
    .when(has_scene),
    Action::of(
        Menu::File,
        "file.command",
        "Copy as command",
        "Copy the raycast render line that makes this very picture, byte for byte",
        &[ctrl_shift(Key::E)],
        |_| Command::CopyCommand,
    )
    .when(has_scene),
    Action::of(
        Menu::File,
        "file.quit",
        "Quit",
        "Close the window",
        &[ctrl(Key::Q)],
        |_| Command::Close,
    )
    .apart(),
];

fn has_files(state: &State) -> bool {
    let document = state.document.as_ref();
    document.is_some_and(|document| !document.paths.is_empty())
}
