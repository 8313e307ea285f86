//! The window's state: plain values, without user interface.
//!
//! Four kinds, apart from one another: the *document* (objects, look, picture), which commands change and undo
//! brings back; the *view*, which navigation changes and which has a history of its own; the *session*
//! (selection, questions, messages), which is never kept; and the *preferences*.

pub mod arrival;
mod as_command;
mod bookmarks;
mod change;
pub mod command;
pub mod cut;
pub mod document;
pub mod effect;
mod files;
mod framing;
pub mod groups;
pub mod handle;
pub mod history;
pub mod insertion;
mod inspect;
pub mod inspection;
pub mod lengths;
mod list_order;
pub mod listing;
pub mod manipulator;
pub mod measure;
pub mod motion;
mod names;
pub mod navigate;
pub mod news;
mod objects;
pub mod parents;
pub mod part;
pub mod pick;
pub mod picks;
mod plane;
pub mod preferences;
mod renumbering;
mod session;
pub mod shapes;
pub mod texture_requests;
pub mod thumbnail;
pub mod turn;
pub mod update;
pub mod viewpoint;

pub use session::{Answer, Palette, Pending, Prompt, PromptKind, Replacing, Toast};

use arrival::Loaded;
use document::Document;
use history::{History, Snapshot};
use inspection::Inspection;
use manipulator::Manipulating;
use measure::Measuring;
use motion::{Motion, Trail};
use picks::Picks;
use preferences::Preferences;
use raycast_core::camera::{FrameLock, Grid, Stereo};
use raycast_core::formats::{ImageSettings, Limits, SceneFile};
use raycast_core::glam::DVec3;
use raycast_core::render::Settings;
use raycast_core::shade::{Legend, Shading};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use texture_requests::TextureRequests;
use thumbnail::ShownImage;
use turn::Turning;
use viewpoint::Viewpoint;

/// The most pixels of a picture in the window: each takes 4 bytes, several times.
pub const WINDOW_PIXELS: u64 = 1 << 25;
/// The most samples a pixel.
pub const SAMPLES_LIMIT: u32 = raycast_core::ranges::MOST_SAMPLES;
/// Samples a pixel of a still picture.
pub const REST_SAMPLES: u32 = 16;
/// The most tiles a picture is split into.
pub const TILES_LIMIT: u64 = 1 << 16;

/// What determines the picture's columns and rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// The window's own pixels, times a density: 1 is a ray a pixel, ½ a ray for 2 × 2 of them.
    Window {
        /// Rays along a side for each pixel of the screen.
        density: f64,
    },
    /// Fixed columns and rows, independent of the window's size.
    Fixed(u32, u32),
}

/// The statistic that colours tiles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tint {
    /// None.
    #[default]
    None,
    /// The time that each took.
    Time,
    /// The worker that rendered each.
    Worker,
}

/// What is drawn over the tiles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overlay {
    /// Lines between tiles.
    pub borders: bool,
    /// The number of each tile in the order of arrival.
    pub order: bool,
    /// Colour by statistics.
    pub tint: Tint,
}

/// The whole state of the window.
#[derive(Clone, Debug)]
pub struct State {
    /// The window's clock.
    pub now: Duration,

    /// The scene on screen; `None` until the first one is there.
    pub document: Option<Document>,
    /// What determines the picture's columns and rows.
    pub resolution: Resolution,
    /// The frame's shift off the view axis, to the right and up, in heights of the frame.
    pub shift: [f64; 2],
    /// The stereo settings of the scene's file: saved again, but not displayed.
    pub stereo: Option<Stereo>,
    /// Samples a pixel, if the user or the scene has set them.
    pub samples: Option<u32>,
    /// Shading and culling.
    pub settings: Settings,
    /// The steps of undo.
    pub history: History,

    /// The viewpoint.
    pub viewpoint: Viewpoint,
    /// The viewpoint when the scene was opened.
    pub home: Viewpoint,
    /// The walking speed in sizes of the scene a second; `None` while not walking.
    pub walk: Option<f64>,
    /// The scene's bookmarks.
    pub bookmarks: Vec<Viewpoint>,
    /// The smooth change of view in progress.
    pub motion: Option<Motion>,
    /// The camera's history.
    pub trail: Trail,

    /// The size of the picture's place in the window, in device pixels.
    pub viewport: (u32, u32),
    /// The longest side of a texture that the graphics can hold.
    pub side_limit: u32,
    /// The selected object.
    pub selected: Option<usize>,
    /// Which objects are locked, by index; those beyond its end are not.
    pub locked: Arc<Vec<bool>>,
    /// The settings by which objects are rotated and scaled.
    pub turning: Turning,
    /// The image file whose thumbnail is shown.
    pub image: Option<ShownImage>,
    /// The textures that are being read.
    pub textures: TextureRequests,
    /// The handles in the picture.
    pub manipulating: Manipulating,
    /// The object whose name is being edited.
    pub naming: Option<usize>,
    /// The measuring tool, and the measurements.
    pub measuring: Measuring,
    /// The points so far while a clipping plane through three points is being clicked.
    pub cutting: Option<Vec<DVec3>>,
    /// Results of measuring and checking meshes.
    pub inspection: Inspection,
    /// The legend of the picture on screen.
    pub legend: Option<Arc<Legend>>,
    /// The picks.
    pub picks: Picks,
    /// Whether the help is open.
    pub help: bool,
    /// The command palette, if open.
    pub palette: Option<Palette>,
    /// The path line, if open.
    pub prompt: Option<Prompt>,
    /// The path line that was accepted last, until its file is read or written: on failure it opens again.
    pub typed: Option<Prompt>,
    /// Whether files are being read, which can be cancelled.
    pub is_loading: bool,
    /// How many files after the open one, in its folder, the last was that was tried; zero once a scene is there.
    pub neighbor: i32,
    /// The action that waits for an answer about unsaved changes.
    pub question: Option<Pending>,
    /// Counts scenes that took the place of what was open; one that is read again does not.
    pub scenes: u64,
    /// The scene that has been read, until the question about unsaved changes is answered.
    pub arrived: Option<Box<Loaded>>,
    /// The action that follows when the scene has been saved.
    pub after_saving: Option<Pending>,
    /// The existing file that the user is asked about replacing.
    pub replacing: Option<Replacing>,
    /// Errors that have not been dismissed, oldest first.
    pub errors: Vec<String>,
    /// Short messages that disappear by themselves, oldest first.
    pub toasts: Vec<Toast>,
    /// The point of the picture under the cursor, in its pixels.
    pub hover: Option<(f64, f64)>,
    /// The depth along the view axis of the point that a pan moves.
    pub grabbed_depth: f64,

    /// What stays when the step changes.
    pub lock: FrameLock,
    /// The split into tiles.
    pub grid: Grid,
    /// What is drawn over the tiles.
    pub overlay: Overlay,
    /// Render threads.
    pub threads: usize,
    /// The limits of reading files.
    pub limits: Limits,
    /// Whether the side panel is open.
    pub panel: bool,
    /// The part of it that was asked for last, and how often one was.
    pub part: (Option<part::Part>, u64),
    /// The user's preferences.
    pub preferences: Preferences,
}

/// The settings for files without any.
fn first_settings() -> Settings {
    Settings {
        shading: Shading::studio(),
        ..Settings::default()
    }
}

impl Default for State {
    fn default() -> Self {
        Self {
            now: Duration::ZERO,
            document: None,
            resolution: Resolution::Window { density: 1.0 },
            shift: [0.0; 2],
            stereo: None,
            samples: None,
            settings: first_settings(),
            history: History::default(),
            viewpoint: Viewpoint::default(),
            home: Viewpoint::default(),
            walk: None,
            bookmarks: Vec::new(),
            motion: None,
            trail: Trail::default(),
            viewport: (1280, 720),
            side_limit: 8192,
            selected: None,
            locked: Arc::default(),
            turning: Turning::default(),
            image: None,
            textures: TextureRequests::default(),
            manipulating: Manipulating::default(),
            naming: None,
            measuring: Measuring::default(),
            cutting: None,
            inspection: Inspection::default(),
            legend: None,
            picks: Picks::default(),
            help: false,
            palette: None,
            prompt: None,
            typed: None,
            is_loading: false,
            neighbor: 0,
            question: None,
            scenes: 0,
            arrived: None,
            after_saving: None,
            replacing: None,
            errors: Vec::new(),
            toasts: Vec::new(),
            hover: None,
            grabbed_depth: 1.0,
            lock: FrameLock::KeepFrame,
            grid: Grid::default(),
            overlay: Overlay::default(),
            threads: default_threads(),
            limits: Limits::default(),
            panel: true,
            part: (None, 0),
            preferences: Preferences::default(),
        }
    }
}

/// The number of threads that the machine runs at once.
pub fn default_threads() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

impl State {
    /// What undo would restore; `None` while there is no scene.
    pub fn snapshot(&self) -> Option<Snapshot> {
        Some(Snapshot {
            scene: Arc::clone(&self.document.as_ref()?.scene),
            locked: Arc::clone(&self.locked),
            settings: self.settings,
            samples: self.samples,
            resolution: self.resolution,
            shift: self.shift,
            measurements: Arc::clone(&self.measuring.list),
        })
    }

    /// Whether an object is locked.
    pub fn is_locked(&self, object: usize) -> bool {
        self.locked.get(object).copied().unwrap_or(false)
    }

    /// Whether there are unsaved changes to ask about: any change of a scene that has a file; without one, changes of
    /// objects that can be saved, and clipping planes. Another mode while looking through meshes does not count.
    pub fn has_unsaved(&self) -> bool {
        let Some(document) = &self.document else {
            return false;
        };
        let is_changed = match document.file {
            Some(_) => self.history.is_changed(),
            None => {
                let is_cut = self.settings.clip != document.clip;
                is_cut || !Arc::ptr_eq(&document.scene, &document.read)
            }
        };
        is_changed && document.can_be_saved()
    }

    /// Drops the action that waits for the scene to be saved, and the scene that waits to be shown.
    pub(super) fn forget_pending(&mut self) {
        self.after_saving = None;
        self.arrived = None;
    }

    /// Takes away the errors of files that were read or written since.
    pub(super) fn forget_errors_of<'p>(&mut self, paths: impl IntoIterator<Item = &'p PathBuf>) {
        for path in paths {
            let name = path.display().to_string();
            let is_of_it = |error: &String| {
                let rest = error.strip_prefix(&name);
                rest.is_some_and(|rest| rest.starts_with(':'))
            };
            self.errors.retain(|error| !is_of_it(error));
        }
    }

    /// Shows an error. One that is shown already moves to the end.
    pub(super) fn report(&mut self, message: String) {
        // Each message has one banner.
        self.errors.retain(|error| *error != message);
        self.errors.push(message);
    }

    /// Shows a short message for a while.
    pub(super) fn tell(&mut self, text: impl Into<String>) {
        let (text, since) = (text.into(), self.now);
        self.toasts.retain(|toast| toast.text != text);
        self.toasts.push(Toast { text, since });
    }

    /// Whether a text field has the keyboard, or is about to get it.
    pub fn is_typing(&self) -> bool {
        self.prompt.is_some() || self.palette.is_some()
    }

    /// The scene as it is saved; `None` while there is none.
    pub fn scene_file(&self) -> Option<SceneFile> {
        let document = self.document.as_ref()?;
        Some(SceneFile {
            scene: document.scene.as_ref().clone(),
            camera: Some(self.viewpoint.to_file()),
            animation: document.animation.clone(),
            image: ImageSettings {
                size: match self.resolution {
                    Resolution::Fixed(columns, rows) => Some((columns, rows)),
                    Resolution::Window { .. } => document.size,
                },
                samples: self.samples,
                cull: unusual(self.settings.cull),
                precision: unusual(self.settings.precision),
                pixel_filter: unusual(self.settings.pixel_filter),
                shift: unusual(self.shift).filter(|_| self.can_shift()),
                stereo: self.stereo,
                // It follows from the size and the camera's field of view.
                step: None,
            },
            shading: Some(self.settings.shading),
            clip: self.settings.clip,
            ..SceneFile::default()
        })
    }
}

#[cfg(test)]
mod tests;

/// A setting for a scene file, which omits defaults.
fn unusual<T: Default + PartialEq>(setting: T) -> Option<T> {
    (setting != T::default()).then_some(setting)
}
