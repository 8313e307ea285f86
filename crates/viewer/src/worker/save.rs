//! Writing pictures, scenes and text.

use super::tasks::{Shared, lock};
use crate::failure::Failure;
use crate::memory;
use crate::output::{MeshFile, Output, Unfinished};
use raycast_core::Accel;
use raycast_core::camera::Grid;
use raycast_core::formats::{DrawingFormat, SceneFile, write_section};
use raycast_core::picture::{Format, Picture, Recipe};
use raycast_core::render::{Cancel, View};
use raycast_core::scene::{ClippingPlane, Scene};
use raycast_core::section::{SectionAxes, section};
use std::path::Path;
use std::time::Duration;

/// A picture to be saved.
#[derive(Clone, Debug)]
pub struct Saving {
    /// What it shows.
    pub view: View,
    /// How it is split.
    pub grid: Grid,
    /// On how many threads it is rendered.
    pub threads: usize,
}

/// Writes a scene; returns false where a file exists that may not be replaced.
pub(super) fn save_scene(
    scene: &SceneFile,
    path: &Path,
    own: Option<&Path>,
    replace: bool,
    shared: &Shared,
) -> Result<bool, Failure> {
    let output = Output::at(path, &[])?;
    let is_own = own.is_some_and(|own| output.check_against([own]).is_err());
    if !is_own {
        output.check_against(lock(&shared.opened).clone())?;
        if output.is_taken() && !replace {
            return Ok(false);
        }
    }
    let file = unfinished_scene(scene, path, &output)?;
    if is_own {
        file.finish()?;
    } else {
        finish(file, &output, shared)?;
    }
    // No other output may overwrite it from now on, as with all open files.
    lock(&shared.opened).push(path.to_owned());
    Ok(true)
}

/// Writes a scene that stays another file's; returns false where a file exists that may not be replaced.
pub(super) fn save_scene_copy(
    scene: &SceneFile,
    path: &Path,
    replace: bool,
    shared: &Shared,
) -> Result<bool, Failure> {
    let Some(output) = place(path, replace, shared)? else {
        return Ok(false);
    };
    finish(unfinished_scene(scene, path, &output)?, &output, shared)?;
    Ok(true)
}

fn unfinished_scene(
    scene: &SceneFile,
    path: &Path,
    output: &Output,
) -> Result<Unfinished, Failure> {
    let folder = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let folder = folder.parent().unwrap_or(Path::new("."));
    let text = scene
        .to_toml(folder)
        .map_err(|error| Failure::could_not(error.to_string()))?;
    output.write(text.as_bytes())
}

/// Writes a picture; returns false where a file exists that may not be replaced.
pub(super) fn save(
    saving: Saving,
    path: &Path,
    replace: bool,
    shared: &Shared,
) -> Result<bool, Failure> {
    let mut saving = saving;
    let format = Format::from_name(&path.to_string_lossy())?;
    let Some(output) = place(path, replace, shared)? else {
        return Ok(false);
    };
    saving.view.settings.layers = format == Format::Exr;
    let plane = saving.view.camera.plane();
    let memory_for = |columns, rows| format.memory_for(columns, rows);
    memory::check_picture(path, (plane.columns, plane.rows), memory_for, "")?;
    let picture = rendered(&saving)?;
    let recipe = Recipe::of(&saving.view);
    let file = output.write(&picture.encode_with(format, Some(&recipe))?)?;
    finish(file, &output, shared)?;
    Ok(true)
}

/// The picture, rendered while the window goes on.
pub(super) fn rendered(saving: &Saving) -> Result<Picture, Failure> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(saving.threads)
        .thread_name(|index| format!("raycast-save-{index}"))
        .start_handler(|_| super::priority::give_way())
        .build()
        .map_err(|error| Failure::could_not(error.to_string()))?;
    let clock = || Duration::ZERO;
    pool.install(|| (saving.view).render(saving.grid, &clock, &Cancel::default(), &|_| {}))
        .ok_or_else(|| Failure::could_not("the render was cancelled"))
}

/// Whether the outline that a plane cuts was written, likewise; and how many of its lines are open, and of how many.
pub(super) fn save_outline(
    (accel, plane): (&Accel, &ClippingPlane),
    path: &Path,
    replace: bool,
    shared: &Shared,
) -> Result<Option<(usize, usize)>, Failure> {
    let name = path.display();
    let format = DrawingFormat::from_name(&path.to_string_lossy()).ok_or_else(|| {
        Failure::could_not(format!("{name}: expected a name that ends in .svg or .dxf"))
    })?;
    let Some(output) = place(path, replace, shared)? else {
        return Ok(None);
    };
    let lines = section(accel, plane).map_err(|error| Failure::could_not(error.to_string()))?;
    if lines.is_empty() {
        return Err(Failure::could_not(format!(
            "The plane cuts nothing that is visible: {name} was not written"
        )));
    }
    let mut bytes = Vec::new();
    write_section(&lines, &SectionAxes::of(plane), format, &mut bytes)
        .map_err(|error| Failure::could_not(format!("{name}: {error}")))?;
    finish(output.write(&bytes)?, &output, shared)?;
    let open = lines.iter().filter(|line| !line.is_closed).count();
    Ok(Some((open, lines.len())))
}

/// Writes the visible objects as a mesh file; returns what its format cannot represent, in sentences, or `None` where a
/// file exists that may not be replaced.
pub(super) fn save_meshes(
    scene: &Scene,
    path: &Path,
    replace: bool,
    shared: &Shared,
) -> Result<Option<Vec<String>>, Failure> {
    let output = MeshFile::at(path, false, &[])?;
    if output.is_taken() && !replace {
        return Ok(None);
    }
    output
        .write(scene, || lock(&shared.opened).clone())
        .map(Some)
}

/// Writes text; returns false where a file exists that may not be replaced.
pub(super) fn save_text(
    text: &str,
    path: &Path,
    replace: bool,
    shared: &Shared,
) -> Result<bool, Failure> {
    let Some(output) = place(path, replace, shared)? else {
        return Ok(false);
    };
    finish(output.write(text.as_bytes())?, &output, shared)?;
    Ok(true)
}

/// Replaces the output's file, unless it was opened while the new one was made.
fn finish(file: Unfinished, output: &Output, shared: &Shared) -> Result<(), Failure> {
    output.check_against(lock(&shared.opened).clone())?;
    file.finish()
}

/// An output that is no opened file; `None` where a file exists that may not be replaced.
fn place(path: &Path, replace: bool, shared: &Shared) -> Result<Option<Output>, Failure> {
    let output = Output::at(path, &[])?;
    output.check_against(lock(&shared.opened).clone())?;
    let may_write = replace || !output.is_taken();
    Ok(may_write.then_some(output))
}
