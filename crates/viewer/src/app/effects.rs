//! Starting the work that effects request from other threads.

use super::keys;
use crate::state::effect::Effect;
use crate::state::{PromptKind, State, update};
use crate::worker::files::{Files, Saving};
use std::path::PathBuf;
use std::sync::Arc;

/// Starts an effect's work on its thread. Effects of the window itself are not handled here: clipboard, keys, closing.
pub fn hand_out(state: &mut State, files: &Files, effect: Effect) {
    match effect {
        Effect::Open(paths, keep) => {
            files.set_limits(state.limits);
            files.open(paths, keep);
        }
        Effect::Add(paths) => files.add(paths),
        Effect::OpenNeighbor(path, step) => files.open_neighbor(path, step),
        Effect::OpenCase(name) => files.open_case(name),
        Effect::CancelLoad => files.cancel_load(),
        Effect::Build => {
            if let Some(document) = &state.document {
                let (scene, accel) = (&document.scene, &document.accel);
                files.build(Arc::clone(scene), Arc::clone(accel));
            }
        }
        Effect::LoadTexture { number, path, part } => files.load_texture(number, path, part),
        Effect::ReadThumbnail(path) => files.read_thumbnail(path),
        Effect::List(folder, kind) => files.list(folder, kind),
        Effect::Dialog(kind) => {
            let suggested = match kind.saves() {
                true => update::suggested_name(state, kind),
                false => String::new(),
            };
            files.ask(kind, suggested);
        }
        Effect::OpenPicture(path, among) => {
            let scene = state.document.as_ref();
            let scene = scene.map(|document| Arc::clone(&document.scene));
            files.open_picture(path, scene, among);
        }
        Effect::SavePicture { path, replace } => save_picture(state, files, path, replace),
        Effect::SaveScene { path, replace } => save_scene(state, files, path, replace),
        Effect::SaveSceneCopy { path, replace } => {
            if let Some(scene) = state.scene_file() {
                files.save_scene_copy(scene, path, replace);
            }
        }
        Effect::SaveMeasurements { path, replace } => {
            let text = state.measuring.csv(&state.lengths());
            files.save_text(text, path, PromptKind::Measurements, replace);
        }
        Effect::SaveMeshes { path, replace } => {
            if let Some(document) = &state.document {
                files.save_meshes(Arc::clone(&document.scene), path, replace);
            }
        }
        Effect::SaveOutline {
            plane: index,
            path,
            replace,
        } => {
            let plane = state.settings.clip.all().get(index);
            if let Some((document, plane)) = state.document.as_ref().zip(plane) {
                let cut = (Arc::clone(&document.accel), *plane);
                let by = PromptKind::Outline(index);
                files.save_outline(cut, path, by, replace);
            }
        }
        Effect::Weigh(object) => weigh(state, files, object),
        Effect::Check { objects, deep } => check(state, files, &objects, deep),
        Effect::OpenKeysFile => keys::open(state, files),
        Effect::ReadKeysFile => keys::read_again(state, files),
        Effect::RenderCopy => {
            if let Some(picture) = picture(state) {
                files.copy_picture(picture);
            }
        }
        Effect::SetKeys { .. }
        | Effect::Copy(_)
        | Effect::CopyImage(_)
        | Effect::FocusMenu
        | Effect::ToggleFullScreen
        | Effect::Close => {}
    }
}

/// Measures an object, if its size is not known.
fn weigh(state: &State, files: &Files, number: usize) {
    let Some(document) = &state.document else {
        return;
    };
    let scene = &document.scene;
    if let (Some(object), Ok(place)) = (scene.objects.get(number), scene.world_from_object(number))
        && state.inspection.size(&object.mesh, &place).is_none()
    {
        files.weigh(Arc::clone(&object.mesh), place);
    }
}

fn check(state: &State, files: &Files, numbers: &[usize], deep: bool) {
    let Some(document) = &state.document else {
        return;
    };
    let objects = &document.scene.objects;
    let name = match *numbers {
        [one] => objects.get(one).map(|object| object.name.clone()),
        _ => None,
    };
    let meshes = numbers
        .iter()
        .filter_map(|&number| Some((number, Arc::clone(&objects.get(number)?.mesh))));
    let name = name.unwrap_or_else(|| document.name.clone());
    files.check(name, meshes.collect(), deep);
}

fn save_picture(state: &State, files: &Files, path: PathBuf, replace: bool) {
    if let Some(picture) = picture(state) {
        files.save(picture, path, replace);
    }
}

/// The picture at rest.
fn picture(state: &State) -> Option<Saving> {
    Some(Saving {
        view: state.view_at_rest()?,
        grid: state.grid,
        threads: state.threads,
    })
}

fn save_scene(state: &State, files: &Files, path: PathBuf, replace: bool) {
    if let (Some(document), Some(scene)) = (&state.document, state.scene_file()) {
        let own = document.file.clone();
        let revision = state.history.revision();
        files.save_scene(scene, (path, own), revision, replace);
    }
}
