//! The desktop's own dialogs for paths.

use crate::state::PromptKind;
use crate::state::news::DialogAnswer;
use std::path::PathBuf;

/// Extensions of files that can be opened.
pub(super) const DIALOG_ENDINGS: &[&str] = &[
    "obj", "gltf", "glb", "ply", "stl", "off", "3mf", "txt", "tri", "raycast", "toml", "gz", "zst",
];

/// Extensions of images.
pub(super) const IMAGE_ENDINGS: &[&str] = &["png", "jpg", "jpeg", "ppm"];

pub(super) fn dialog(kind: PromptKind, suggested: &str) -> DialogAnswer {
    let dialog = rfd::FileDialog::new();
    let files = |title| {
        let dialog = rfd::FileDialog::new()
            .set_title(title)
            .add_filter("Meshes and scenes", DIALOG_ENDINGS)
            .add_filter("All files", &["*"]);
        dialog.pick_files()
    };
    let one = |path: Option<PathBuf>| path.map(|path| vec![path]);
    let paths = match kind {
        PromptKind::Open => files("Open meshes or a scene"),
        PromptKind::Add => files("Add meshes or a scene"),
        PromptKind::Texture | PromptKind::TextureOf(_) => one(dialog
            .set_title("Open a texture")
            .add_filter("Images", IMAGE_ENDINGS)
            .add_filter("All files", &["*"])
            .pick_file()),
        PromptKind::Picture => one(dialog
            .set_title("Save the picture")
            .set_file_name(suggested)
            .save_file()),
        PromptKind::Measurements => one(dialog
            .set_title("Save the measurements")
            .set_file_name(suggested)
            .save_file()),
        PromptKind::Outline(_) => one(dialog
            .set_title("Save the outline")
            .set_file_name(suggested)
            .save_file()),
        PromptKind::Meshes => one(dialog
            .set_title("Save the meshes")
            .set_file_name(suggested)
            .save_file()),
        PromptKind::SceneCopy => one(dialog
            .set_title("Save a copy of the scene")
            .set_file_name(suggested)
            .save_file()),
        PromptKind::Scene => one(dialog
            .set_title("Save the scene")
            .set_file_name(suggested)
            .save_file()),
    };
    // Both a dialog that is cancelled and a desktop without one give nothing.
    paths.map_or(DialogAnswer::Nothing, DialogAnswer::Paths)
}
