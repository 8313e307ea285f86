//! Asking for paths, opening and saving, and the question about unsaved changes.

use super::arrival;
use super::as_command;
use super::effect::{Effect, Keep};
use super::listing::{Listing, folder_of, in_working_folder, path_of};
use super::names::suggested_name;
use super::texture_requests;
use super::thumbnail::TexturePart;
use super::{Answer, Pending, Prompt, PromptKind, Replacing, State};
use crate::output::MESH_ENDINGS;
use raycast_core::formats::{DrawingFormat, MeshFormat};
use raycast_core::picture::Format;
use std::path::{Path, PathBuf};

/// Opens the path line, and the desktop's dialog.
pub(super) fn ask(state: &mut State, kind: PromptKind) -> Effect {
    let text = match kind.saves() {
        true => suggested_name(state, kind),
        false => String::new(),
    };
    state.palette = None;
    state.prompt = Some(Prompt {
        kind,
        text,
        dialog: true,
        has_lost_keyboard: false,
        listing: None,
    });
    Effect::Dialog(kind)
}

/// Sets the path line's text; reads the names in its folder, if that is another one.
pub(super) fn type_path(state: &mut State, text: String) -> Option<Effect> {
    let prompt = state.prompt.as_mut()?;
    prompt.text = text;
    let folder = folder_of(prompt.text.trim_start());
    if (prompt.listing.as_ref()).is_some_and(|listing| listing.folder == folder) {
        return None;
    }
    let (folder, kind) = (folder.to_owned(), prompt.kind);
    prompt.listing = Some(Listing {
        folder: folder.clone(),
        names: Vec::new(),
    });
    Some(Effect::List(folder, kind))
}

/// Begins the path line's text; of a suggested name the ending stays.
pub(super) fn type_ahead(state: &mut State, typed: String) -> Option<Effect> {
    let suggested = &state.prompt.as_ref()?.text;
    let ending = suggested.find('.').map_or("", |at| &suggested[at..]);
    type_path(state, format!("{typed}{ending}"))
}

/// Accepts the path line's text.
pub(super) fn confirm(state: &mut State) -> Option<Effect> {
    let prompt = state.prompt.clone()?;
    let mut text = prompt.text.trim();
    if text.is_empty() {
        return None;
    }
    if prompt.kind.saves() {
        text = with_one_ending(text, &suggested_name(state, prompt.kind));
    }
    let mut path = path_of(text);
    // Kept until the file is read or written: if it cannot be, the path can be corrected.
    state.typed = Some(prompt.clone());
    if !prompt.kind.saves() {
        path = in_working_folder(path);
    }
    take(state, prompt.kind, vec![path], false)
}

/// Opens the path line again with the path that was accepted last, to be corrected.
pub(super) fn ask_again(state: &mut State) {
    if state.prompt.is_none() {
        state.prompt = state.typed.take();
    }
}

/// The path without the suggested ending, if it has another one before that: a whole name that is typed over the
/// selected stem of the suggestion leaves the suggested ending behind it.
fn with_one_ending<'t>(text: &'t str, suggested: &str) -> &'t str {
    let ending = suggested.find('.').map_or("", |at| &suggested[at..]);
    let shorter = text.strip_suffix(ending).unwrap_or(text);
    let name = shorter.rsplit(['/', '\\']).next().unwrap_or(shorter);
    let is_one_of = |endings: [&str; 2]| {
        let own = Path::new(name).extension();
        own.is_some_and(|own| {
            endings
                .iter()
                .any(|ending| own.eq_ignore_ascii_case(ending))
        })
    };
    let has_ending = Format::from_name(name).is_ok()
        || DrawingFormat::from_name(name).is_some()
        || MeshFormat::from_name(name, false).is_some()
        || is_one_of(["csv", "toml"]);
    if has_ending { shorter } else { text }
}

/// Executes what the paths were requested for. `asked` is whether a dialog has already asked about replacing a file.
pub(super) fn take(
    state: &mut State,
    kind: PromptKind,
    mut paths: Vec<PathBuf>,
    asked: bool,
) -> Option<Effect> {
    match kind {
        PromptKind::Open => open(state, paths),
        PromptKind::Add => add(state, paths),
        PromptKind::Picture => save_picture(state, paths.pop()?, asked),
        PromptKind::Scene => save_scene_as(state, paths.pop()?, asked),
        PromptKind::SceneCopy => Some(save_scene_copy(state, paths.pop()?, asked)),
        PromptKind::Measurements => Some(save_measurements(state, paths.pop()?, asked)),
        PromptKind::Meshes => save_meshes(state, paths.pop()?, asked),
        PromptKind::Outline(plane) => save_outline(state, plane, paths.pop()?, asked),
        PromptKind::Texture | PromptKind::TextureOf(_) => {
            state.prompt = None;
            let which = match kind {
                PromptKind::TextureOf(which) => Some(which),
                _ => None,
            };
            texture_requests::ask(state, paths.pop()?, which, TexturePart::default())
        }
    }
}

pub(super) fn open(state: &mut State, paths: Vec<PathBuf>) -> Option<Effect> {
    state.prompt = None;
    Some(Effect::Open(paths, Keep::Nothing))
}

pub(super) fn add(state: &mut State, paths: Vec<PathBuf>) -> Option<Effect> {
    if state.document.is_none() {
        return open(state, paths);
    }
    state.prompt = None;
    Some(Effect::Add(paths))
}

/// Closes the window, or asks first if unsaved changes would be lost.
pub(super) fn close(state: &mut State) -> Option<Effect> {
    if state.has_unsaved() {
        state.forget_pending();
        state.question = Some(Pending::Close);
        return None;
    }
    Some(Effect::Close)
}

/// Reads the scene's files again.
pub(super) fn reload(state: &State) -> Option<Effect> {
    let paths = &state.document.as_ref()?.paths;
    (!paths.is_empty()).then(|| Effect::Open(paths.clone(), Keep::All))
}

/// Reads the scene's meshes again after another axis was said to be up. A scene file says it of each of its objects.
pub(super) fn read_turned(state: &mut State) -> Option<Effect> {
    let document = state.document.as_ref()?;
    if document.file.is_some() {
        state
            .tell("A scene file keeps its own axes: meshes that are opened from now on are turned");
        return None;
    }
    let paths = document.paths.clone();
    (!paths.is_empty()).then_some(Effect::Open(paths, Keep::Look))
}

/// Whether edits can be carried over when the files are reloaded: not for a scene file, which defines its objects
/// itself.
pub(super) fn keeps_changes(state: &State) -> bool {
    let document = state.document.as_ref();
    document.is_some_and(|document| document.file.is_none() && document.as_read().is_some())
}

/// Continues without a question.
pub(super) fn proceed(state: &mut State, pending: Pending) -> Option<Effect> {
    match pending {
        Pending::Open => {
            let loaded = state.arrived.take()?;
            arrival::show(state, *loaded)
        }
        Pending::CopyCommand => as_command::copy(state),
        Pending::Close => Some(Effect::Close),
    }
}

/// Handles the answer to the question about unsaved changes.
pub(super) fn answer(state: &mut State, answer: Answer) -> Option<Effect> {
    let pending = state.question.take()?;
    match answer {
        Answer::Stay => {
            state.typed = None;
            state.forget_pending();
            None
        }
        // A command line cannot express unsaved changes.
        Answer::Discard if pending == Pending::CopyCommand => None,
        Answer::Discard => proceed(state, pending),
        Answer::Save => {
            state.after_saving = Some(pending);
            save_scene(state)
        }
    }
}

/// Saves the scene to its file, or asks for a path.
pub(super) fn save_scene(state: &mut State) -> Option<Effect> {
    let document = state.document.as_ref()?;
    if !document.can_be_saved() {
        let message = if document.scene.objects.is_empty() {
            "There is no object to save."
        } else {
            "This scene cannot be saved: its meshes are in the program, and in no file that a scene file \
             could name. Open meshes from files (File, Open) to make a scene of them."
        };
        state.forget_pending();
        state.report(message.to_owned());
        return None;
    }
    match document.file.clone() {
        Some(path) => Some(Effect::SaveScene {
            path,
            replace: true,
        }),
        None => Some(ask(state, PromptKind::Scene)),
    }
}

/// Saves the scene to a file; its name must have the ending of scene files.
pub(super) fn save_scene_as(state: &mut State, path: PathBuf, replace: bool) -> Option<Effect> {
    state.prompt = None;
    state.replacing = None;
    Some(Effect::SaveScene {
        path: as_scene_name(path),
        replace,
    })
}

/// Saves the scene to another file, likewise; what is open stays the file that it was.
fn save_scene_copy(state: &mut State, path: PathBuf, replace: bool) -> Effect {
    state.prompt = None;
    state.replacing = None;
    Effect::SaveSceneCopy {
        path: as_scene_name(path),
        replace,
    }
}

fn as_scene_name(path: PathBuf) -> PathBuf {
    let mut name = path.into_os_string();
    let text = name.to_string_lossy().to_ascii_lowercase();
    if !text.ends_with(".toml") {
        name.push(".raycast.toml");
    }
    name.into()
}

/// Saves the picture; a name with an unknown ending is refused while it can still be corrected.
pub(super) fn save_picture(state: &mut State, path: PathBuf, replace: bool) -> Option<Effect> {
    if let Err(error) = Format::from_name(&path.to_string_lossy()) {
        state.report(error.to_string());
        return None;
    }
    state.prompt = None;
    state.replacing = None;
    Some(Effect::SavePicture { path, replace })
}

/// Replaces the existing file that was asked about.
pub(super) fn replace(state: &mut State) -> Option<Effect> {
    let Replacing { path, by } = state.replacing.take()?;
    match by {
        PromptKind::Scene => save_scene_as(state, path, true),
        PromptKind::SceneCopy => Some(save_scene_copy(state, path, true)),
        PromptKind::Measurements => Some(save_measurements(state, path, true)),
        PromptKind::Meshes => save_meshes(state, path, true),
        PromptKind::Outline(plane) => save_outline(state, plane, path, true),
        _ => save_picture(state, path, true),
    }
}

/// Saves the measurements; a name without an ending gets one.
fn save_measurements(state: &mut State, mut path: PathBuf, replace: bool) -> Effect {
    state.prompt = None;
    state.replacing = None;
    if path.extension().is_none() {
        path.set_extension("csv");
    }
    Effect::SaveMeasurements { path, replace }
}

/// Saves the visible objects as a mesh file; a name without an ending gets one, and an unknown one is refused while it
/// can still be corrected.
fn save_meshes(state: &mut State, mut path: PathBuf, replace: bool) -> Option<Effect> {
    if path.extension().is_none() {
        path.set_extension("glb");
    }
    let name = path.to_string_lossy();
    if MeshFormat::from_name(&name, false).is_none() {
        state.report(format!(
            "{name}: expected a name that ends in {MESH_ENDINGS}"
        ));
        return None;
    }
    state.prompt = None;
    state.replacing = None;
    Some(Effect::SaveMeshes { path, replace })
}

/// Saves the outline that a clipping plane cuts; a name without an ending gets one, and an unknown one is refused while
/// it can still be corrected.
fn save_outline(
    state: &mut State,
    plane: usize,
    mut path: PathBuf,
    replace: bool,
) -> Option<Effect> {
    if path.extension().is_none() {
        path.set_extension("svg");
    }
    if DrawingFormat::from_name(&path.to_string_lossy()).is_none() {
        let name = path.display();
        state.report(format!("{name}: expected a name that ends in .svg or .dxf"));
        return None;
    }
    state.prompt = None;
    state.replacing = None;
    Some(Effect::SaveOutline {
        plane,
        path,
        replace,
    })
}
