//! The one place that carries commands out.

use super::command::Command;
use super::{
    DEFAULT_FOV, Document, FOV_RANGE, Prompt, PromptKind, Resolution, SAMPLES_LIMIT, State,
    TILES_LIMIT, Toast, WINDOW_PIXELS,
};
use raycast_core::camera::{FrameLock, Grid, ImagePlane, Orbit, Projection, frame_to_fov};
use raycast_core::formats::CameraFile;
use raycast_core::picture::Format;
use raycast_core::ranges::WIDEST_LINE;
use raycast_core::scene::Texture;
use raycast_core::shade::Wireframe;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// What a command leaves to do outside the state: work for other threads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Read files as a new scene.
    Open(Vec<PathBuf>),
    /// Put up a hard case as a new scene.
    OpenCase(&'static str),
    /// Read an image as a texture.
    LoadTexture(PathBuf),
    /// Write the picture, unless a file is there.
    Save(PathBuf),
    /// Write the picture, in place of what is there.
    Replace(PathBuf),
    /// Show the desktop's own dialog.
    Dialog(PromptKind),
}

/// News from other threads.
#[derive(Debug)]
pub enum News {
    /// A scene is ready; its file's camera and settings come along.
    Loaded(Box<Loaded>),
    /// A texture was read.
    Texture(Arc<Texture>),
    /// A picture was written.
    Saved(PathBuf),
    /// It was not: a file is there.
    Taken(PathBuf),
    /// Something could not be done: the whole message.
    Failed(String),
    /// A dialog was closed: with a path, by a person, or because the desktop has none.
    Dialog(PromptKind, DialogAnswer),
}

/// How a desktop dialog ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DialogAnswer {
    /// With a path.
    Path(PathBuf),
    /// Without.
    Cancelled,
    /// It never came up.
    Unavailable,
}

/// A scene with what its file says about showing it.
#[derive(Debug)]
pub struct Loaded {
    /// The scene.
    pub document: Document,
    /// The file's camera.
    pub camera: Option<CameraFile>,
    /// The file's samples a pixel.
    pub samples: Option<u32>,
    /// The file's shading.
    pub shading: Option<raycast_core::shade::Shading>,
    /// What could be read only in part, to be told.
    pub notes: Vec<String>,
}

/// Carries out one command.
pub fn update(state: &mut State, command: Command) -> Option<Effect> {
    match command {
        Command::Orbit { yaw, pitch } => state.orbit.turn(yaw, pitch),
        Command::Grab { at } => grab(state, at),
        Command::Pan { dx, dy } => pan(state, dx, dy),
        Command::Zoom { at, factor } => zoom(state, at, factor),
        Command::SetPivot { at } => set_pivot(state, at),
        Command::Fit => state.fit(),
        Command::ResetView => {
            (state.orbit.yaw, state.orbit.pitch) = Orbit::DEFAULT_ANGLES;
            state.fov = DEFAULT_FOV;
            state.fit();
        }

        Command::SetStep(step) => set_step(state, step),
        Command::ScaleStep(factor) => scale_step(state, factor),
        Command::SetSize(columns, rows) => {
            set_resolution(state, Resolution::Fixed(columns.max(1), rows.max(1)));
        }
        Command::FitWindow => state.resolution = Resolution::Window { density: 1.0 },
        Command::SetFov(fov) if fov.is_finite() => {
            state.fov = fov.clamp(FOV_RANGE.0, FOV_RANGE.1);
        }
        Command::SetFov(_) => {}
        Command::SetFrame(height) => set_frame(state, height),
        Command::SetLock(lock) => state.lock = lock,
        Command::SetProjection(projection) => state.projection = projection,
        Command::SetSamples(samples) => {
            state.settings.samples = samples.clamp(1, SAMPLES_LIMIT);
        }

        Command::SetGrid(grid) => state.grid = limited(grid, state.size()),
        Command::SetBorders(on) => state.overlay.borders = on,
        Command::SetOrder(on) => state.overlay.order = on,
        Command::SetTint(tint) => state.overlay.tint = tint,

        Command::SetMode(mode) => state.settings.shading.mode = mode,
        Command::SetWireframe(on) => {
            state.settings.shading.wireframe = on.then(Wireframe::default);
        }
        Command::SetWireframeWidth(width) => {
            wireframe(state).width = width.clamp(0.25, WIDEST_LINE);
        }
        Command::SetWireframeColor(color) => wireframe(state).color = color,
        Command::SetBlend(blend) => state.settings.shading.blend = blend.clamp(0.0, 1.0),
        Command::SetFilter(filter) => state.settings.shading.filter = filter,
        Command::SetTextureProjection(projection) => {
            state.settings.shading.projection = projection;
        }
        Command::SetCull(cull) => state.settings.cull = cull,
        Command::SetBackground(background) => state.settings.shading.background = background,
        Command::SetColorRule(which, rule) => edit_objects(state, |number, object| {
            if which.is_none_or(|which| which == number) {
                object.color = rule;
            }
        }),
        Command::RemoveTextures => edit_objects(state, |_, object| object.texture = None),

        Command::SetThreads(threads) => state.threads = threads.clamp(1, 256),

        Command::Ask(kind) => return Some(ask(state, kind)),
        Command::TypePath(text) => {
            if let Some(prompt) = &mut state.prompt {
                prompt.text = text;
            }
        }
        Command::ConfirmPath => return confirm(state),
        Command::Open(path) => {
            state.prompt = None;
            return Some(Effect::Open(vec![path]));
        }
        Command::OpenCase(name) => return Some(Effect::OpenCase(name)),
        Command::LoadTexture(path) => {
            state.prompt = None;
            return Some(Effect::LoadTexture(path));
        }
        Command::SavePicture(path) => {
            return can_be_saved(state, &path).then_some(Effect::Save(path));
        }
        Command::ReplacePicture(path) => {
            return can_be_saved(state, &path).then_some(Effect::Replace(path));
        }

        Command::TogglePanel => state.panel = !state.panel,
        Command::ToggleHelp => state.help = !state.help,
        Command::Dismiss => dismiss(state),
        Command::DismissError(index) => {
            if index < state.errors.len() {
                state.errors.remove(index);
            }
        }
    }
    None
}

/// Takes in news from another thread; `now` is the window's clock.
pub fn receive(state: &mut State, news: News, now: Duration) -> Option<Effect> {
    let toast = |text: String| Toast { text, since: now };
    match news {
        News::Loaded(loaded) => show(state, *loaded, now),
        News::Texture(texture) => {
            edit_objects(state, |_, object| {
                object.texture = Some(Arc::clone(&texture))
            });
            state.settings.shading.mode = raycast_core::shade::Mode::Texture;
        }
        News::Saved(path) => state
            .toasts
            .push(toast(format!("Saved {}", path.display()))),
        News::Taken(path) => state.replacing = Some(path),
        News::Failed(message) => {
            // The same fault twice is one banner.
            state.errors.retain(|error| *error != message);
            state.errors.push(message);
        }
        News::Dialog(kind, answer) => {
            let prompt = state.prompt.as_mut();
            let prompt = prompt.filter(|prompt| prompt.kind == kind)?;
            match answer {
                DialogAnswer::Path(path) => {
                    state.prompt = None;
                    let command = match kind {
                        // The desktop's dialog has asked whether it may.
                        PromptKind::Save => Command::ReplacePicture(path),
                        PromptKind::Open | PromptKind::Texture => path_command(kind, path),
                    };
                    return update(state, command);
                }
                DialogAnswer::Cancelled => state.prompt = None,
                DialogAnswer::Unavailable => prompt.dialog = false,
            }
        }
    }
    None
}

/// Puts a loaded scene on screen.
fn show(state: &mut State, loaded: Loaded, now: Duration) {
    let hidden_camera = loaded.camera.is_none();
    state.document = Some(loaded.document);
    state.hover = None;
    if let Some(shading) = loaded.shading {
        state.settings.shading = shading;
    }
    if let Some(samples) = loaded.samples {
        state.settings.samples = samples.clamp(1, SAMPLES_LIMIT);
    }
    if let Some(camera) = loaded.camera {
        state.orbit = Orbit::from_placement(&camera.placement);
        state.projection = camera.projection;
        match camera.projection {
            Projection::Perspective => {
                state.fov = camera.frame;
            }
            Projection::Orthographic => set_frame(state, camera.frame),
        }
    }
    if hidden_camera {
        (state.orbit.yaw, state.orbit.pitch) = Orbit::DEFAULT_ANGLES;
        state.fit();
    }
    for text in loaded.notes {
        state.toasts.push(Toast { text, since: now });
    }
}

/// The wireframe's settings, switched on if they were not.
fn wireframe(state: &mut State) -> &mut Wireframe {
    state
        .settings
        .shading
        .wireframe
        .get_or_insert_with(Wireframe::default)
}

fn grab(state: &mut State, at: (f64, f64)) {
    let Some(camera) = state.camera() else {
        return;
    };
    state.grabbed_depth = match state.pick(at.0, at.1) {
        Some(pick) => (pick.point - camera.placement().eye).dot(camera.forward()),
        None => camera.distance(),
    };
}

fn pan(state: &mut State, dx: f64, dy: f64) {
    let Some(camera) = state.camera() else {
        return;
    };
    let scale = match camera.projection() {
        // The step is measured at the target; what was grabbed may be nearer or farther.
        Projection::Perspective => state.grabbed_depth / camera.distance(),
        Projection::Orthographic => 1.0,
    } * camera.plane().step;
    if scale.is_finite() && dx.is_finite() && dy.is_finite() {
        state.orbit.pan(-dx * scale, dy * scale);
    }
}

fn zoom(state: &mut State, at: (f64, f64), factor: f64) {
    let Some(camera) = state.camera() else {
        return;
    };
    let extent = state.extent();
    let distance = state.orbit.distance;
    let factor = (distance * factor).clamp(extent * 1e-5, extent * 1e4) / distance;
    if !factor.is_normal() {
        return;
    }
    let ray = camera.ray(at.0, at.1);
    let on_target_plane = |ray: &raycast_core::camera::Ray| {
        let depth = (state.orbit.pivot - ray.origin).dot(camera.forward());
        ray.at(depth / ray.direction.dot(camera.forward()))
    };
    let anchor = match (camera.projection(), state.pick(at.0, at.1)) {
        (Projection::Perspective, Some(pick)) => pick.point,
        _ => on_target_plane(&ray),
    };
    state.orbit.dolly(factor, anchor);
}

fn set_pivot(state: &mut State, at: (f64, f64)) {
    let (Some(camera), Some(pick)) = (state.camera(), state.pick(at.0, at.1)) else {
        return;
    };
    state.orbit.pivot = pick.point;
    if camera.projection() == Projection::Perspective {
        // The eye keeps its depth from the point, so that it does not grow or shrink.
        let depth = (pick.point - camera.placement().eye).dot(camera.forward());
        if depth.is_normal() && depth > 0.0 {
            state.orbit.distance = depth;
        }
    }
}

/// Another step: the lock says whether resolution or frame follows.
fn set_step(state: &mut State, step: f64) {
    let Ok(plane) = state.plane() else {
        return;
    };
    match plane.with_step(step, state.lock) {
        Ok(next) => take_plane(state, plane, next),
        Err(error) => report(state, error.to_string()),
    }
}

/// A step so many times as long.
fn scale_step(state: &mut State, factor: f64) {
    match (state.lock, state.resolution) {
        // The density takes it all, without rounding: back again is where it came from.
        (FrameLock::KeepFrame, Resolution::Window { density }) if factor.is_normal() => {
            let least = 1.0 / f64::from(state.viewport.0.min(state.viewport.1).max(1));
            let density = (density / factor).max(least);
            set_resolution(state, Resolution::Window { density });
        }
        _ => {
            if let Ok(plane) = state.plane() {
                set_step(state, plane.step * factor);
            }
        }
    }
}

/// Makes `next` the picture's plane.
fn take_plane(state: &mut State, last: ImagePlane, next: ImagePlane) {
    if (last.columns, last.rows) != (next.columns, next.rows) {
        let resolution = match state.resolution {
            Resolution::Window { .. } => Resolution::Window {
                density: f64::from(next.rows) / f64::from(state.viewport.1.max(1)),
            },
            Resolution::Fixed(..) => Resolution::Fixed(next.columns, next.rows),
        };
        if !set_resolution(state, resolution) {
            return;
        }
    }
    set_frame(state, next.frame_height());
}

/// A frame of another height at the target: by the field of view, or the orthographic scale.
fn set_frame(state: &mut State, height: f64) {
    if !(height.is_normal() && height > 0.0) {
        return;
    }
    match state.projection {
        Projection::Perspective => {
            state.fov = frame_to_fov(height, state.orbit.distance).clamp(FOV_RANGE.0, FOV_RANGE.1);
        }
        Projection::Orthographic => {
            let now = state.frame_height();
            state.orbit.distance *= height / now;
        }
    }
}

/// Takes a resolution if the window can show it; says so if not.
fn set_resolution(state: &mut State, resolution: Resolution) -> bool {
    let (columns, rows) = match resolution {
        Resolution::Fixed(columns, rows) => (f64::from(columns), f64::from(rows)),
        Resolution::Window { density } => (
            f64::from(state.viewport.0) * density,
            f64::from(state.viewport.1) * density,
        ),
    };
    let limit = state.side_limit;
    if columns.max(rows) > f64::from(limit) || columns * rows > WINDOW_PIXELS as f64 {
        report(
            state,
            format!(
                "A picture of {columns:.0}×{rows:.0} is more than the window shows ({limit} a \
                 side, {} megapixels); `raycast render --size` makes larger ones.",
                WINDOW_PIXELS >> 20
            ),
        );
        return false;
    }
    state.resolution = resolution;
    state.grid = limited(state.grid, state.size());
    true
}

/// Shows an error once.
fn report(state: &mut State, message: String) {
    if !state.errors.contains(&message) {
        state.errors.push(message);
    }
}

/// A grid with no more tiles than the window can keep track of.
fn limited(grid: Grid, (columns, rows): (u32, u32)) -> Grid {
    match grid {
        Grid::Size(size) => {
            let pixels = u64::from(columns) * u64::from(rows);
            let least = (pixels.div_ceil(TILES_LIMIT) as f64).sqrt().ceil() as u32;
            Grid::Size(size.max(least).max(4))
        }
        Grid::Count {
            columns: across,
            rows: down,
        } => Grid::Count {
            columns: across.clamp(1, 256),
            rows: down.clamp(1, 256),
        },
    }
}

/// Changes objects' looks: a copy of the scene's list, with the meshes shared.
fn edit_objects(state: &mut State, mut edit: impl FnMut(usize, &mut raycast_core::scene::Object)) {
    if let Some(document) = &mut state.document {
        let scene = Arc::make_mut(&mut document.scene);
        for (number, object) in scene.objects.iter_mut().enumerate() {
            edit(number, object);
        }
        document.edits += 1;
    }
}

fn ask(state: &mut State, kind: PromptKind) -> Effect {
    let text = match kind {
        PromptKind::Save => suggested_name(state),
        PromptKind::Open | PromptKind::Texture => String::new(),
    };
    state.prompt = Some(Prompt {
        kind,
        text,
        dialog: true,
    });
    Effect::Dialog(kind)
}

/// A name for the picture after the scene's.
pub fn suggested_name(state: &State) -> String {
    let stem = state
        .document
        .as_ref()
        .map(|document| document.name.split('.').next().unwrap_or_default())
        .filter(|stem| !stem.is_empty())
        .unwrap_or("picture");
    format!("{stem}.png")
}

fn path_command(kind: PromptKind, path: PathBuf) -> Command {
    match kind {
        PromptKind::Open => Command::Open(path),
        PromptKind::Save => Command::SavePicture(path),
        PromptKind::Texture => Command::LoadTexture(path),
    }
}

fn confirm(state: &mut State) -> Option<Effect> {
    let prompt = state.prompt.as_ref()?;
    let text = prompt.text.trim();
    if text.is_empty() {
        return None;
    }
    let path = match text.strip_prefix("~/").zip(std::env::home_dir()) {
        Some((rest, home)) => home.join(rest),
        None => PathBuf::from(text),
    };
    let command = path_command(prompt.kind, path);
    update(state, command)
}

/// Whether a picture can have this name: then nothing more is asked.
fn can_be_saved(state: &mut State, path: &Path) -> bool {
    // A wrong name is told while the path can still be changed.
    if let Err(error) = Format::from_name(&path.to_string_lossy()) {
        report(state, error.to_string());
        return false;
    }
    state.prompt = None;
    state.replacing = None;
    true
}

fn dismiss(state: &mut State) {
    if state.help {
        state.help = false;
    } else if state.replacing.is_some() {
        state.replacing = None;
    } else if state.prompt.is_some() {
        state.prompt = None;
    } else {
        state.errors.pop();
    }
}

/// Drops toasts that were shown long enough; says when the next is due.
pub fn expire_toasts(state: &mut State, now: Duration) -> Option<Duration> {
    const SHOWN: Duration = Duration::from_secs(5);
    state.toasts.retain(|toast| now < toast.since + SHOWN);
    let next = state.toasts.iter().map(|toast| toast.since + SHOWN).min()?;
    Some(next.saturating_sub(now))
}

/// The middle of the picture, for keys that act on a place.
pub fn middle(state: &State) -> (f64, f64) {
    let (columns, rows) = state.size();
    (f64::from(columns) * 0.5, f64::from(rows) * 0.5)
}

#[cfg(test)]
#[path = "update_tests.rs"]
mod tests;
