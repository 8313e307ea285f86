//! News from other threads, and its effect on the state.

use super::bookmarks;
use super::document::{Document, Tree};
use super::effect::{Effect, Keep};
use super::files;
use super::history::{History, Renewed};
use super::inspection::{Checked, Inspection, Sized};
use super::manipulator;
use super::measure::Measuring;
use super::navigate;
use super::objects;
use super::plane;
use super::viewpoint::{DEFAULT_FOV, Viewpoint};
use super::{Pending, PromptKind, Replacing, Resolution, SAMPLES_LIMIT, State, first_settings};
use raycast_core::camera::{Orbit, Projection};
use raycast_core::formats::{CameraFile, ImageSettings, LengthUnit};
use raycast_core::picture::Recipe;
use raycast_core::scene::{ClippingPlanes, Object, Scene, Texture};
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
    /// A texture was read, for an object or for all.
    Texture(Arc<Texture>, PathBuf, Option<usize>),
    /// A picture, or measurements, were written.
    PictureSaved(PathBuf),
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
    /// A dialog has ended.
    Dialog(PromptKind, DialogAnswer),
}

/// How a desktop dialog ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DialogAnswer {
    /// The user chose paths.
    Paths(Vec<PathBuf>),
    /// The user cancelled it.
    Cancelled,
    /// The desktop has no dialogs.
    Unavailable,
}

/// A scene with its file's camera and settings.
#[derive(Debug)]
pub struct Loaded {
    /// The scene.
    pub document: Document,
    /// What stays of the scene before.
    pub keep: Keep,
    /// The file's camera.
    pub camera: Option<CameraFile>,
    /// The file's image settings.
    pub image: ImageSettings,
    /// The file's clipping planes.
    pub clip: ClippingPlanes,
    /// Warnings of files that could be read in part.
    pub notes: Vec<String>,
    /// Errors of files that could not be read, while others could.
    pub errors: Vec<String>,
}

impl Loaded {
    /// A scene without warnings, whose files have neither camera nor settings.
    pub fn new(document: Document) -> Self {
        Self {
            document,
            keep: Keep::Nothing,
            camera: None,
            image: ImageSettings::default(),
            clip: ClippingPlanes::NONE,
            notes: Vec::new(),
            errors: Vec::new(),
        }
    }
}

/// Applies news from another thread; `now` is the window's clock.
pub fn receive(state: &mut State, news: News, now: Duration) -> Option<Effect> {
    state.now = now;
    match news {
        News::Loaded(loaded) => {
            show(state, *loaded);
            let document = state.document.as_ref()?;
            return (!document.is_built()).then_some(Effect::Build);
        }
        News::Added {
            objects,
            opened,
            unit,
            paths,
            notes,
            errors,
        } => {
            state.typed = None;
            files::remember(state, &paths);
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
            return change(state, "Look of a picture", |state| {
                apply(state, &recipe);
                None
            });
        }
        News::Nothing => {}
        News::NotOpened(message) => {
            state.report(message);
            // The path can be corrected.
            if state.prompt.is_none() {
                state.prompt = state.typed.take();
            }
        }
        News::Built(scene, tree) => {
            if let Some(document) = &mut state.document
                && document.take_tree(&scene, tree)
            {
                state.picks.renew(document);
            }
            return state.selected.map(Effect::Weigh);
        }
        News::Texture(texture, path, which) => {
            let path = std::path::absolute(&path).unwrap_or(path);
            return change(state, "Texture", |state| {
                state.settings.shading.mode = Mode::Texture;
                objects::change(state, which, |object| {
                    object.texture = Some(Arc::clone(&texture));
                    object.texture_source = Some(path.clone());
                })
            });
        }
        News::PictureSaved(path) => state.tell(format!("Saved {}", path.display())),
        News::SceneSaved(path, revision) => {
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
            files::remember(state, &[path]);
            let pending = state.after_saving.take()?;
            return files::proceed(state, pending);
        }
        News::Taken(replacing) => state.replacing = Some(replacing),
        News::NotSaved(message) => {
            state.after_saving = None;
            state.report(message);
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
            return files::proceed(state, Pending::Reload);
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

/// Makes a change that can be undone.
fn change(
    state: &mut State,
    name: &'static str,
    change: impl FnOnce(&mut State) -> Option<Effect>,
) -> Option<Effect> {
    // A drag in progress becomes a step of its own.
    manipulator::release(state);
    let before = state.snapshot();
    let effect = change(state);
    let now = state.now;
    if let Some((before, after)) = before.zip(state.snapshot()) {
        state.history.record(name, None, (before, &after), now);
    }
    effect
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
        DialogAnswer::Cancelled => {
            state.prompt = None;
            state.after_saving = None;
            None
        }
        DialogAnswer::Unavailable => {
            prompt.dialog = false;
            None
        }
    }
}

/// Shows a loaded scene.
fn show(state: &mut State, loaded: Loaded) {
    let Loaded {
        mut document,
        keep,
        camera,
        image,
        clip,
        notes,
        errors,
    } = loaded;
    let last = state.document.take();
    let keeps_all = keep == Keep::All && last.is_some();
    let mut renewed = None;
    if keeps_all && let Some(last) = &last {
        renewed = keep_looks(&mut document, last);
    }
    let paths = document.paths.clone();
    let shading = document.shading;
    state.document = Some(document);
    match renewed {
        Some(meshes) => state.history.renew(&meshes),
        None => state.history = History::default(),
    }
    state.inspection = Inspection::default();
    state.hover = None;
    state.picks = Default::default();
    state.manipulating.drag = None;
    state.naming = None;
    state.selected = state.selected.filter(|_| keeps_all);
    state.typed = None;
    state.question = None;
    state.motion = None;
    notes.into_iter().for_each(|note| state.tell(note));
    errors.into_iter().for_each(|error| state.report(error));
    files::remember(state, &paths);
    if keeps_all {
        state.tell("Read again");
        return;
    }
    state.trail = Default::default();
    bookmarks::recall(state);
    state.locked = Arc::default();
    state.cutting = None;
    state.measuring = Measuring {
        snaps: state.measuring.snaps,
        ..Measuring::default()
    };
    match shading {
        Some(shading) => state.settings.shading = shading,
        None if keep == Keep::Nothing => state.settings = first_settings(),
        None => {}
    }
    state.settings.clip = clip;
    if keep == Keep::Nothing {
        let settings = &mut state.settings;
        settings.cull = Default::default();
        settings.precision = Default::default();
        settings.pixel_filter = Default::default();
        state.shift = [0.0; 2];
        state.stereo = None;
        state.resolution = Resolution::Window { density: 1.0 };
    }
    state.samples = image.samples.map(|samples| samples.clamp(1, SAMPLES_LIMIT));
    state.shift = image.shift.unwrap_or(state.shift);
    state.stereo = image.stereo.or(state.stereo);
    let settings = &mut state.settings;
    settings.cull = image.cull.unwrap_or(settings.cull);
    settings.precision = image.precision.unwrap_or(settings.precision);
    settings.pixel_filter = image.pixel_filter.unwrap_or(settings.pixel_filter);
    state.viewpoint = match camera {
        Some(camera) => Viewpoint::of(&camera),
        None => {
            let direction = match keep {
                Keep::Nothing => Orbit::DEFAULT_ANGLES,
                _ => (state.viewpoint.orbit.yaw, state.viewpoint.orbit.pitch),
            };
            let lens = Viewpoint {
                fov: DEFAULT_FOV,
                ..Viewpoint::default()
            };
            state.fitted(lens.turned_to(direction))
        }
    };
    state.home = navigate::destination(state);
}

/// Carries the edits over to reloaded objects, if they are the same objects. Not for scene files, which define their
/// objects themselves.
///
/// Returns the old meshes with their new versions, for the history; `None` if the objects are others.
fn keep_looks(document: &mut Document, last: &Document) -> Option<Renewed> {
    let numbers = last.as_read().filter(|_| document.file.is_none())?;
    let new = &document.scene.objects;
    let pairs = numbers.iter().zip(&last.scene.objects);
    let pairs = pairs.map(|(&number, old)| Some((new.get(number)?, old)));
    let pairs: Vec<(&Object, &Object)> = pairs.collect::<Option<_>>()?;
    let are_same = new.len() == pairs.len() && pairs.iter().all(|(a, b)| a.source == b.source);
    if !are_same {
        return None;
    }
    // The old mesh is kept alive, so that its address stays unique.
    let meshes = pairs
        .iter()
        .map(|(new, old)| (Arc::clone(&old.mesh), Arc::clone(&new.mesh)));
    let meshes: Renewed = meshes.collect();
    let objects = pairs.iter().map(|(new, old)| Object {
        mesh: Arc::clone(&new.mesh),
        // A texture that came with the mesh was reloaded as well.
        texture: match old.texture_source == new.texture_source {
            true => new.texture.clone(),
            false => old.texture.clone(),
        },
        ..(*old).clone()
    });
    let scene = Scene {
        objects: objects.collect(),
    };
    // The tree was built without the edits, such as hidden or moved objects.
    document.set_scene(Arc::new(scene));
    Some(meshes)
}

/// Restores the camera and look of a recipe.
fn apply(state: &mut State, recipe: &Recipe) {
    let plane = recipe.camera.plane();
    let projection = recipe.camera.projection();
    let frame = match projection {
        Projection::Orthographic => plane.frame_height(),
        _ => recipe
            .camera
            .fov_degrees()
            .unwrap_or(projection.default_fov()),
    };
    let camera = CameraFile {
        placement: recipe.camera.placement(),
        projection,
        frame,
    };
    if plane::set_resolution(state, Resolution::Fixed(plane.columns, plane.rows)) {
        state.samples = Some(recipe.samples.clamp(1, SAMPLES_LIMIT));
    }
    state.settings.shading = recipe.shading;
    state.shift = recipe.camera.shift();
    state.stereo = recipe.camera.stereo();
    state.settings.cull = recipe.cull;
    state.settings.precision = recipe.precision;
    state.settings.pixel_filter = recipe.pixel_filter;
    state.settings.clip = recipe.clip;
    navigate::go(state, Viewpoint::of(&camera));
    state.tell("Shown as that picture was made");
}

/// Removes expired messages; returns the time until the next expires.
pub fn expire_toasts(state: &mut State, now: Duration) -> Option<Duration> {
    const SHOWN: Duration = Duration::from_secs(5);
    state.toasts.retain(|toast| now < toast.since + SHOWN);
    let next = state.toasts.iter().map(|toast| toast.since + SHOWN).min()?;
    Some(next.saturating_sub(now))
}
