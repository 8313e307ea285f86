//! A scene that was read takes the place of what is open.

use super::bookmarks;
use super::change::change;
use super::document::Document;
use super::effect::{Effect, Keep};
use super::history::{History, Renewed};
use super::inspection::Inspection;
use super::measure::Measuring;
use super::navigate;
use super::plane;
use super::viewpoint::{DEFAULT_FOV, Viewpoint};
use super::{Pending, Resolution, SAMPLES_LIMIT, State, first_settings};
use raycast_core::camera::{Orbit, Projection};
use raycast_core::formats::{CameraFile, ImageSettings};
use raycast_core::picture::Recipe;
use raycast_core::scene::{ClippingPlanes, Object, Scene};
use raycast_core::shade::Shading;
use std::sync::Arc;

/// A scene with its file's camera and settings.
#[derive(Clone, Debug)]
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
    /// The recipe of the picture for which it was searched.
    pub recipe: Option<Box<Recipe>>,
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
            recipe: None,
        }
    }
}

/// Shows a scene that was read; where that would lose unsaved changes, keeps it until the person has answered.
///
/// The question comes after reading: a file that cannot be read asks nothing, and what is changed while a file is read
/// is not lost.
pub(super) fn arrive(state: &mut State, loaded: Box<Loaded>) -> Option<Effect> {
    if state.has_unsaved() && !keeps_changes(state, &loaded) {
        state.arrived = Some(loaded);
        state.question = Some(Pending::Open);
        return None;
    }
    show(state, *loaded)
}

/// Whether the edits are carried over to a scene that was read.
fn keeps_changes(state: &State, loaded: &Loaded) -> bool {
    let last = state.document.as_ref();
    let last = last.filter(|_| loaded.keep == Keep::All);
    last.is_some_and(|last| same_objects(&loaded.document, last).is_some())
}

/// Shows a scene that was read.
pub(super) fn show(state: &mut State, loaded: Loaded) -> Option<Effect> {
    let recipe = replace(state, loaded);
    if let Some(recipe) = recipe {
        apply(state, &recipe);
    }
    let document = state.document.as_ref()?;
    (!document.is_built()).then_some(Effect::Build)
}

/// Puts a scene in place of what is open; returns the recipe that comes with it.
fn replace(state: &mut State, loaded: Loaded) -> Option<Box<Recipe>> {
    let Loaded {
        mut document,
        keep,
        camera,
        image,
        clip,
        notes,
        errors,
        recipe,
    } = loaded;
    let last = state.document.take();
    let keeps_all = keep == Keep::All && last.is_some();
    let mut renewed = None;
    if keeps_all && let Some(last) = &last {
        renewed = keep_looks(&mut document, last);
    }
    let (paths, opened) = (document.paths.clone(), document.opened.clone());
    let shading = document.shading;
    document.clip = clip;
    match (&renewed, last) {
        (Some(_), Some(last)) => state.textures.renew(&last.scene, &document.scene),
        _ => state.textures.clear(),
    }
    state.document = Some(document);
    // Its file may be another now.
    state.image = None;
    match renewed {
        Some(meshes) => state.history.renew(&meshes),
        None => state.history = History::default(),
    }
    end_session(state, keeps_all);
    state.forget_errors_of(paths.iter().chain(&opened));
    notes.into_iter().for_each(|note| state.tell(note));
    errors.into_iter().for_each(|error| state.report(error));
    state.preferences.remember_all(&paths);
    if keeps_all {
        state.tell("Read again");
        return recipe;
    }
    state.scenes += 1;
    state.trail = Default::default();
    bookmarks::recall(state);
    state.locked = Arc::default();
    state.cutting = None;
    state.measuring = Measuring {
        snaps: state.measuring.snaps,
        ..Measuring::default()
    };
    take_settings(state, keep, shading, image);
    state.settings.clip = clip;
    take_view(state, keep, camera);
    state.home = navigate::destination(state);
    recipe
}

/// Ends what was going on in the scene before; the selected object stays where its list is the same.
fn end_session(state: &mut State, keeps_selection: bool) {
    state.inspection = Inspection::default();
    state.hover = None;
    state.picks = Default::default();
    state.manipulating.drag = None;
    state.naming = None;
    state.selected = state.selected.filter(|_| keeps_selection);
    state.typed = None;
    state.neighbor = 0;
    state.question = None;
    state.forget_pending();
    state.motion = None;
}

/// Takes a file's settings; what it does not say is as usual, or stays.
fn take_settings(state: &mut State, keep: Keep, shading: Option<Shading>, image: ImageSettings) {
    match shading {
        Some(shading) => state.settings.shading = shading,
        None if keep == Keep::Nothing => state.settings = first_settings(),
        None => {}
    }
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
}

/// Takes a file's camera, or fits the view.
fn take_view(state: &mut State, keep: Keep, camera: Option<CameraFile>) {
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
}

/// Carries the edits over to reloaded objects, if they are the same objects.
///
/// Returns the old meshes with their new versions, for the history; `None` if the objects are others.
fn keep_looks(document: &mut Document, last: &Document) -> Option<Renewed> {
    let pairs = same_objects(document, last)?;
    // The old mesh is kept alive, so that its address stays unique.
    let meshes = pairs
        .iter()
        .map(|(new, old)| (Arc::clone(&old.mesh), Arc::clone(&new.mesh)));
    let meshes: Renewed = meshes.collect();
    // Without edits there is nothing to carry over, and nothing that was not saved.
    if Arc::ptr_eq(&last.scene, &last.read) {
        return Some(meshes);
    }
    let objects = pairs.iter().map(|(new, old)| {
        let mut object = Object::clone(old);
        object.set_mesh(Arc::clone(&new.mesh));
        // A texture that came with the mesh was reloaded as well.
        if old.texture_source == new.texture_source {
            object.texture = new.texture.clone();
        }
        object
    });
    let scene = Scene {
        objects: objects.collect(),
    };
    // The tree was built without the edits, such as hidden or moved objects.
    document.set_scene(Arc::new(scene));
    Some(meshes)
}

/// The objects that were read again, each with its edited version; `None` if they are others. Not for scene files,
/// which define their objects themselves.
fn same_objects<'d>(
    document: &'d Document,
    last: &'d Document,
) -> Option<Vec<(&'d Object, &'d Object)>> {
    let numbers = last.as_read().filter(|_| document.file.is_none())?;
    let new = &document.scene.objects;
    let pairs = numbers.iter().zip(&last.scene.objects);
    let pairs = pairs.map(|(&number, old)| Some((new.get(number)?, old)));
    let pairs: Vec<(&Object, &Object)> = pairs.collect::<Option<_>>()?;
    let are_same = new.len() == pairs.len() && pairs.iter().all(|(a, b)| a.source == b.source);
    are_same.then_some(pairs)
}

/// Restores the camera and look of a recipe, as a step of the history.
pub(super) fn apply(state: &mut State, recipe: &Recipe) {
    change(state, "Look of a picture", |state| {
        look_as(state, recipe);
        None
    });
}

fn look_as(state: &mut State, recipe: &Recipe) {
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
        pose: recipe.camera.pose(),
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
