//! From files and options to what a command works on: scene, camera, shading.

mod camera;
mod dropped;
mod nothing_to_see;
mod shading;
mod tree;

pub use camera::{DEFAULT_SIZE, camera, camera_failure, check_camera};
pub use dropped::{dropped, reasons};
pub use nothing_to_see::NothingToSee;
pub use shading::{apply_textures_and_colors, shading};
pub use tree::{
    SIMD_VARIABLE, bounds, has_instances, instruction_set, single_tree, stored_triangles, tree,
    tree_to_edit, visible, visible_tree,
};

use crate::cli::ReadingArgs;
use crate::memory;
use raycast_core::formats::{self, FormatError, Progress, SceneFile};
use std::path::PathBuf;

/// Reads files into one scene, their objects in the order of the files, with the camera, image and
/// shading of the first scene file that has them.
///
/// # Errors
/// The first file that cannot be read.
pub fn load(
    files: &[PathBuf],
    reading: &ReadingArgs,
    progress: Progress<'_>,
) -> Result<SceneFile, FormatError> {
    let budget = memory::budget(reading.limits());
    let mut all = SceneFile::default();
    for (index, file) in files.iter().enumerate() {
        let share = |share: f32| progress((index as f32 + share) / files.len() as f32);
        all.append(formats::read_scene_within(file, &budget, &share)?);
    }
    Ok(all)
}

/// What [`load`] reads beside objects, without reading any: see [`formats::read_scene_settings`].
///
/// # Errors
/// The first file that cannot be read.
pub fn load_settings(files: &[PathBuf], reading: &ReadingArgs) -> Result<SceneFile, FormatError> {
    let budget = memory::budget(reading.limits());
    let mut all = SceneFile::default();
    for file in files {
        all.append(formats::read_scene_settings(file, &budget)?);
    }
    Ok(all)
}

/// What a scene of these files is called in an error.
pub fn name_of(files: &[PathBuf]) -> String {
    match files {
        [] => "the scene".to_owned(),
        [file] => file.display().to_string(),
        [first, rest @ ..] => format!("{} and {} more", first.display(), rest.len()),
    }
}
