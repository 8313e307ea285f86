//! Opening and saving.

use super::action::{Action, Menu};
use super::chord::{alt, ctrl, ctrl_shift, plain};
use super::when::has_scene;
use crate::state::command::Command;
use crate::state::{PromptKind, State};
use egui::Key;
use raycast_core::scene::UpAxis;

/// In the order of their menu.
pub(super) static ACTIONS: &[Action] = &[
    Action::of(
        Menu::File,
        "file.open",
        "Open…",
        "Open meshes or a scene",
        &[ctrl(Key::O)],
        |_| Command::Ask(PromptKind::Open),
    )
    .also("import load"),
    Action::of(
        Menu::File,
        "file.add",
        "Add…",
        "Put more meshes beside what is open",
        &[ctrl_shift(Key::O)],
        |_| Command::Ask(PromptKind::Add),
    )
    .also("import load"),
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
    .also("refresh")
    .when(has_files),
    Action::of(
        Menu::File,
        "file.z_up",
        "Z is up in meshes",
        "Read meshes that do not say which axis is up as having z up, as in much of CAD, scanning and 3D printing",
        &[],
        |state| Command::SetZUp(state.limits.up_axis != UpAxis::Z),
    )
    .also("axis upright turn rotate stand lying stl")
    .on(|state| state.limits.up_axis == UpAxis::Z),
    Action::of(
        Menu::File,
        "file.watch",
        "Reload when changed",
        "Read files again when they change on the disk",
        &[],
        |state| Command::SetWatch(!state.preferences.watch),
    )
    .also("automatic")
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
        "file.save_copy",
        "Save a copy…",
        "Write the scene to another file; what is open stays the file that it was",
        &[],
        |_| Command::Ask(PromptKind::SceneCopy),
    )
    .when(can_save),
    Action::of(
        Menu::File,
        "file.meshes",
        "Save meshes…",
        "Write the objects that are shown as GLB, OBJ, PLY, STL or triangle text",
        &[],
        |_| Command::Ask(PromptKind::Meshes),
    )
    .when(has_scene)
    .also("export convert glb gltf obj ply stl"),
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
        "file.copy_picture",
        "Copy picture",
        "Put the picture on the clipboard, of the size and quality that it is saved with",
        &[alt(Key::C)],
        |_| Command::CopyPicture,
    )
    .also("screenshot clipboard image")
    .when(has_scene),
    Action::of(
        Menu::File,
        "file.command",
        "Copy as command",
        "Copy the raycast render line that makes this very picture, byte for byte",
        &[ctrl_shift(Key::E)],
        |_| Command::CopyCommand,
    )
    .also("terminal shell")
    .when(has_scene),
    Action::of(
        Menu::File,
        "file.quit",
        "Quit",
        "Close the window",
        &[ctrl(Key::Q)],
        |_| Command::Close,
    )
    .also("exit")
    .apart(),
];

fn can_save(state: &State) -> bool {
    let document = state.document.as_ref();
    document.is_some_and(|document| document.can_be_saved())
}

fn has_files(state: &State) -> bool {
    let document = state.document.as_ref();
    document.is_some_and(|document| !document.paths.is_empty())
}
