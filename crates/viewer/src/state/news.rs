//! News from other threads, and its effect on the state.

use super::arrival::{self, Loaded};
use super::change::change;
use super::document::Tree;
use super::effect::{Copied, Effect};
use super::files;
use super::inspection::{Checked, Sized};
use super::listing::{Listing, in_working_folder};
use super::objects;
use super::thumbnail::Thumbnail;
use super::{PromptKind, Replacing, State};
use raycast_core::formats::LengthUnit;
use raycast_core::picture::Recipe;
use raycast_core::scene::{Object, Scene, Texture};
use raycast_core::shade::Mode;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// News from other threads.
#[derive(Debug)]
pub enum News {
    /// A scene was read, with its file's camera and settings.
    Loaded(Box<Loaded>),
    /// Objects were read that are to be added to the scene.
    Added {
        /// The objects; their parents are among them.
        objects: Vec<Object>,
        /// Every file that was read for them.
        opened: Vec<PathBuf>,
        /// The unit of their coordinates, if the files state one.
        unit: Option<LengthUnit>,
        /// The requested files.
        paths: Vec<PathBuf>,
        /// Warnings of files that could be read in part.
        notes: Vec<String>,
        /// Errors of files that could not be read.
        errors: Vec<String>,
    },
    /// Files could not be opened: the error.
    NotOpened(String),
    /// A tree over these objects was built.
    Built(Arc<Scene>, Tree),
    /// A picture's recipe was read; its scene is open.
    Recipe(Box<Recipe>),
    /// A task ended without a result.
    Nothing,
    /// A texture was read, or the error.
    Texture {
        /// The request's number; `None` for a picture without a recipe, which becomes the texture of all objects.
        number: Option<u64>,
        /// The image.
        path: PathBuf,
        /// The texture.
        found: Result<Arc<Texture>, String>,
    },
    /// An image's thumbnail, or why there is none.
    Thumbnail(PathBuf, Result<Arc<Thumbnail>, String>),
    /// A picture, or measurements, were written.
    PictureSaved(PathBuf),
    /// The picture for the clipboard was rendered.
    PictureCopied(Arc<Copied>),
    /// An object was measured.
    Sized(Sized),
    /// Objects were checked.
    Checked(Vec<Checked>),
    /// The scene was written, at this revision.
    SceneSaved(PathBuf, u64),
    /// Nothing was written, because the file exists.
    Taken(Replacing),
    /// The key bindings file was read.
    Keys {
        /// Its text; empty if there is none.
        text: String,
        /// Whether the user asked for it, and it is to be confirmed.
        asked: bool,
    },
    /// A task succeeded: a short message.
    Done(String),
    /// A task failed: the error.
    Failed(String),
    /// The scene could not be written: the error.
    NotSaved(String),
    /// A file of the scene has changed on the disk.
    Changed(PathBuf),
    /// The names in the folder of a path were read.
    Listed(Listing),
    /// A dialog has ended.
    Dialog(PromptKind, DialogAnswer),
}

/// How a desktop dialog ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DialogAnswer {
    /// The user chose paths.
    Paths(Vec<PathBuf>),
    /// The user cancelled it, or the desktop has no dialogs.
    Nothing,
}

/// Applies news from another thread; `now` is the window's clock.
pub fn receive(state: &mut State, news: News, now: Duration) -> Option<Effect> {
    state.now = now;
    match news {
        News::Loaded(loaded) => return arrival::arrive(state, loaded),
        News::Added {
            objects,
            opened,
            unit,
            paths,
            notes,
            errors,
        } => {
            state.typed = None;
            state.forget_errors_of(paths.iter().chain(&opened));
            state.preferences.remember_all(&paths);
            notes.into_iter().for_each(|note| state.tell(note));
            errors.into_iter().for_each(|error| state.report(error));
            if let Some(document) = &mut state.document {
                document.opened.extend(opened);
                // Files with different units leave the scene without one.
                document.unit = document.unit.filter(|own| unit == Some(*own));
            }
            state.tell(what_was_added(state, &objects));
            return change(state, "Add", |state| {
                objects::edit(state, |all| {
                    let shift = all.len();
                    all.extend(objects.into_iter().map(|object| Object {
                        parent: object.parent.map(|parent| parent + shift),
                        ..object
                    }));
                })
            });
        }
        News::Sized(sized) => state.inspection.sized = Some(sized),
        News::Checked(checked) => {
            state.inspection.take(checked);
        }
        News::Recipe(recipe) => {
            arrival::apply(state, &recipe);
        }
        News::Nothing => {}
        News::NotOpened(message) => not_opened(state, message),
        News::Built(scene, tree) => {
            if let Some(document) = &mut state.document
                && document.take_tree(&scene, tree)
            {
                state.picks.renew(document);
            }
            return state.selected.map(Effect::Weigh);
        }
        News::Texture {
            number,
            path,
            found,
        } => return texture(state, number, path, found),
        News::Thumbnail(path, found) => {
            if let Some(shown) = state.image.as_mut().filter(|shown| shown.path == path) {
                shown.found = found.map(Some);
            }
        }
        News::PictureSaved(path) => {
            let path = in_working_folder(path);
            state.typed = None;
            state.forget_errors_of([&path]);
            state.tell(format!("Saved {}", path.display()));
        }
        News::PictureCopied(copied) => {
            let (columns, rows) = copied.size;
            state.tell(format!("Copied the picture, {columns}×{rows} pixels"));
            return Some(Effect::CopyImage(copied));
        }
        News::SceneSaved(path, revision) => {
            state.typed = None;
            state.forget_errors_of([&path]);
            state.tell(format!("Saved {}", path.display()));
            state.history.saved(revision);
            if let Some(document) = &mut state.document {
                let name = path.file_name().unwrap_or(path.as_os_str());
                document.name = name.to_string_lossy().into_owned();
                document.paths = vec![path.clone()];
                // Also if it is listed already: a changed list makes the watch note the file's present state.
                document.opened.push(path.clone());
                document.file = Some(path.clone());
                document.shading = Some(state.settings.shading);
            }
            state.preferences.remember(&path);
            let pending = state.after_saving.take()?;
            // What was changed while the file was being written is not in it.
            if state.has_unsaved() {
                state.question = Some(pending);
                return None;
            }
            return files::proceed(state, pending);
        }
        News::Taken(replacing) => state.replacing = Some(replacing),
        News::NotSaved(message) => {
            state.forget_pending();
            state.report(message);
            files::ask_again(state);
        }
        News::Keys { text, asked } => return Some(Effect::SetKeys { text, asked }),
        News::Done(message) => state.tell(message),
        News::Failed(message) => state.report(message),
        News::Changed(path) => {
            let name = path
                .file_name()
                .unwrap_or(path.as_os_str())
                .to_string_lossy();
            if !state.preferences.watch {
                return None;
            }
            if state.has_unsaved() && !files::keeps_changes(state) {
                state.tell(format!(
                    "{name} has changed on the disk: File, Reload reads it again"
                ));
                return None;
            }
            return files::reload(state);
        }
        News::Listed(listing) => {
            let awaited = state
                .prompt
                .as_mut()
                .and_then(|prompt| prompt.listing.as_mut());
            if let Some(awaited) = awaited.filter(|awaited| awaited.folder == listing.folder) {
                *awaited = listing;
            }
        }
        News::Dialog(kind, answer) => return answered(state, kind, answer),
    }
    None
}

/// Names what was added, with a hint where the view, which stays as it is, does not show all of it.
fn what_was_added(state: &State, objects: &[Object]) -> String {
    let added = match objects {
        [one] => format!("Added {}", one.name),
        _ => format!("Added {} objects", objects.len()),
    };
    let scene = Scene {
        objects: objects.to_vec(),
    };
    let bounds = scene.bounds();
    let Some(camera) = state.camera() else {
        return added;
    };
    // Panoramas see all around.
    let can_miss = camera.projection().panorama().is_none();
    let (columns, rows) = state.size();
    let is_seen = |corner| {
        camera.project(corner).is_some_and(|(x, y)| {
            (0.0..=f64::from(columns)).contains(&x) && (0.0..=f64::from(rows)).contains(&y)
        })
    };
    match can_miss && !bounds.is_empty() && !bounds.corners().into_iter().all(is_seen) {
        true => format!("{added}, not all of it in view: View, Fit shows everything"),
        false => added,
    }
}

/// Handles the answer of a desktop dialog, if it is still awaited.
fn answered(state: &mut State, kind: PromptKind, answer: DialogAnswer) -> Option<Effect> {
    let opens = |kind| matches!(kind, PromptKind::Open | PromptKind::Add);
    let prompt = state.prompt.as_mut();
    let prompt = prompt.filter(|p| p.kind == kind || (opens(p.kind) && opens(kind)))?;
    match answer {
        DialogAnswer::Paths(paths) => {
            // The choice between opening and adding may have changed meanwhile.
            let kind = prompt.kind;
            files::take(state, kind, paths, true)
        }
        // A dialog that is shown takes the keyboard, at the latest when it is cancelled; where none came, the line stays.
        DialogAnswer::Nothing if prompt.has_lost_keyboard && prompt.listing.is_none() => {
            state.prompt = None;
            state.forget_pending();
            None
        }
        DialogAnswer::Nothing => {
            prompt.dialog = false;
            None
        }
    }
}

/// Removes expired messages; returns the time until the next expires.
pub fn expire_toasts(state: &mut State, now: Duration) -> Option<Duration> {
    const SHOWN: Duration = Duration::from_secs(5);
    state.toasts.retain(|toast| now < toast.since + SHOWN);
    let next = state.toasts.iter().map(|toast| toast.since + SHOWN).min()?;
    Some(next.saturating_sub(now))
}

fn not_opened(state: &mut State, message: String) {
    state.report(message);
    files::ask_again(state);
}

/// Lays a texture on the object that it was asked for.
fn texture(
    state: &mut State,
    number: Option<u64>,
    path: PathBuf,
    found: Result<Arc<Texture>, String>,
) -> Option<Effect> {
    let scene = Arc::clone(&state.document.as_ref()?.scene);
    let object = match number {
        Some(number) => state.textures.end(number, &scene)?,
        None => None,
    };
    let texture = match found {
        Ok(texture) => texture,
        Err(message) => {
            not_opened(state, message);
            return None;
        }
    };
    let path = in_working_folder(path);
    state.typed = None;
    state.forget_errors_of([&path]);
    let name = match texture.crop() {
        Some(_) => "Part of a texture",
        None => "Texture",
    };
    change(state, name, |state| {
        if !state.settings.shading.mode.shows().textures {
            state.settings.shading.mode = Mode::Smooth;
        }
        objects::change(state, object, |object| {
            object.texture = Some(Arc::clone(&texture));
            object.texture_source = Some(path.clone());
        })
    })
}
