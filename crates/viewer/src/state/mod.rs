//! What the window shows and how: plain values, no user interface.
//!
//! Four kinds, apart from one another: the *document* (objects, look, picture), which commands change and undo
//! brings back; the *view*, which navigation changes and which has a history of its own; the *session*
//! (selection, questions, messages), which is never kept; and the *preferences*.

mod as_command;
mod bookmarks;
pub mod command;
pub mod cut;
pub mod document;
pub mod effect;
mod files;
mod framing;
pub mod handle;
pub mod history;
pub mod insertion;
mod inspect;
pub mod inspection;
pub mod lengths;
mod list_order;
pub mod manipulator;
pub mod measure;
pub mod motion;
mod names;
mod navigate;
pub mod news;
mod objects;
pub mod parents;
pub mod pick;
pub mod picks;
mod plane;
pub mod preferences;
mod renumbering;
mod session;
pub mod shapes;
pub mod turn;
pub mod update;
pub mod viewpoint;

pub use session::{Answer, Palette, Pending, Prompt, PromptKind, Replacing, Toast};

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
use std::sync::Arc;
use std::time::Duration;
use turn::Turning;
use viewpoint::Viewpoint;

/// The most pixels of a picture in the window: 4 bytes each, held a few times over.
pub const WINDOW_PIXELS: u64 = 1 << 25;
/// The most samples a pixel.
pub const SAMPLES_LIMIT: u32 = raycast_core::ranges::MOST_SAMPLES;
/// Rays a pixel of a picture that nobody touches.
pub const REST_SAMPLES: u32 = 16;
/// The most tiles a picture is split into.
pub const TILES_LIMIT: u64 = 1 << 16;

/// Where the picture's columns and rows come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// The window's own pixels, times a density: 1 is a ray a pixel, ½ a ray for 2 × 2 of them.
    Window {
        /// Rays along a side for each pixel of the screen.
        density: f64,
    },
    /// So many columns and rows, whatever the window's size.
    Fixed(u32, u32),
}

/// What colours tiles by their statistics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tint {
    /// Nothing does.
    #[default]
    None,
    /// How long each took.
    Time,
    /// Which worker made it.
    Worker,
}

/// What is drawn over the picture about its tiles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overlay {
    /// Lines between tiles.
    pub borders: bool,
    /// The place of each tile in the order of arrival.
    pub order: bool,
    /// Colour by statistics.
    pub tint: Tint,
}

/// All that a person can change, and what there is to see.
#[derive(Clone, Debug)]
pub struct State {
    /// The window's clock.
    pub now: Duration,

    /// The scene on screen; `None` until the first one is there.
    pub document: Option<Document>,
    /// Where columns and rows come from.
    pub resolution: Resolution,
    /// How far the frame is off the view axis, as the scene's file says: to the right and up, in its heights.
    pub shift: [f64; 2],
    /// How the scene's file has its picture for two eyes: kept, and not shown.
    pub stereo: Option<Stereo>,
    /// Rays a pixel, where a person or the scene has set them.
    pub samples: Option<u32>,
    /// Shading and culling.
    pub settings: Settings,
    /// What can be undone.
    pub history: History,

    /// Where it is seen from.
    pub viewpoint: Viewpoint,
    /// Where it was seen from at first.
    pub home: Viewpoint,
    /// How fast one walks, in sizes of the scene a second; not at all, for `None`.
    pub walk: Option<f64>,
    /// Views that were kept, for this scene.
    pub bookmarks: Vec<Viewpoint>,
    /// A change of view under way.
    pub motion: Option<Motion>,
    /// The camera's history.
    pub trail: Trail,

    /// The picture's place in the window, in device pixels.
    pub viewport: (u32, u32),
    /// The longest side that the window's graphics can hold.
    pub side_limit: u32,
    /// The marked object.
    pub selected: Option<usize>,
    /// Which objects are locked, as far as any is.
    pub locked: Arc<Vec<bool>>,
    /// How objects are turned and scaled.
    pub turning: Turning,
    /// The handles in the picture.
    pub manipulating: Manipulating,
    /// The object whose name is being typed.
    pub naming: Option<usize>,
    /// What is being measured, and what was.
    pub measuring: Measuring,
    /// The points so far of a clipping plane through three, while they are clicked.
    pub cutting: Option<Vec<DVec3>>,
    /// What was found out about meshes.
    pub inspection: Inspection,
    /// What the colours of the picture on screen stand for.
    pub legend: Option<Arc<Legend>>,
    /// What was clicked on.
    pub picks: Picks,
    /// Whether the keys are shown.
    pub help: bool,
    /// The list of commands, if open.
    pub palette: Option<Palette>,
    /// The path line, if open.
    pub prompt: Option<Prompt>,
    /// The path line that was taken last, until it is known whether its file could be read.
    pub typed: Option<Prompt>,
    /// What waits for an answer about unsaved changes.
    pub question: Option<Pending>,
    /// What follows once the scene is saved.
    pub after_saving: Option<Pending>,
    /// The file that would be replaced, while the person is asked.
    pub replacing: Option<Replacing>,
    /// Errors that were not dismissed yet, oldest first.
    pub errors: Vec<String>,
    /// Messages that go by themselves, oldest first.
    pub toasts: Vec<Toast>,
    /// The point of the picture under the cursor, in its pixels.
    pub hover: Option<(f64, f64)>,
    /// How far along the view axis the point is that a pan holds on to.
    pub grabbed_depth: f64,

    /// What stays when the step changes.
    pub lock: FrameLock,
    /// How the picture is split.
    pub grid: Grid,
    /// What is drawn over it.
    pub overlay: Overlay,
    /// Render threads.
    pub threads: usize,
    /// How much reading files may take.
    pub limits: Limits,
    /// Whether the side panel is open.
    pub panel: bool,
    /// How a person likes to work.
    pub preferences: Preferences,
}

/// The settings of pictures whose files say none.
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
            question: None,
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
            preferences: Preferences::default(),
        }
    }
}

/// As many threads as the machine runs at once.
pub fn default_threads() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

impl State {
    /// What undo would bring back; `None` while there is no scene.
    pub fn snapshot(&self) -> Option<Snapshot> {
        Some(Snapshot {
            scene: Arc::clone(&self.document.as_ref()?.scene),
            locked: Arc::clone(&self.locked),
            settings: self.settings,
            samples: self.samples,
            resolution: self.resolution,
            shift: self.shift,
        })
    }

    /// Whether an object is not to be changed by hand.
    pub fn is_locked(&self, object: usize) -> bool {
        self.locked.get(object).copied().unwrap_or(false)
    }

    /// Whether there are changes that a person would miss: of a scene that has a file, or of objects that could
    /// be saved. Another mode alone, while one looks through meshes, is none.
    pub fn has_unsaved(&self) -> bool {
        let Some(document) = &self.document else {
            return false;
        };
        let is_changed = match document.file {
            Some(_) => self.history.is_changed(),
            None => !Arc::ptr_eq(&document.scene, &document.read),
        };
        is_changed && document.can_be_saved()
    }

    /// Shows an error once.
    pub(super) fn report(&mut self, message: String) {
        // The same fault twice is one banner.
        self.errors.retain(|error| *error != message);
        self.errors.push(message);
    }

    /// Shows a short message for a while.
    pub(super) fn tell(&mut self, text: impl Into<String>) {
        let since = self.now;
        self.toasts.push(Toast {
            text: text.into(),
            since,
        });
    }

    /// Whether a field for text is open that takes the keyboard, or is about to.
    pub fn is_typing(&self) -> bool {
        self.prompt.is_some() || self.palette.is_some()
    }

    /// The scene as its file holds it; `None` while there is none.
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
                // The camera's field of view says it.
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

/// A setting that a scene file tells: one that is not the usual one.
fn unusual<T: Default + PartialEq>(setting: T) -> Option<T> {
    (setting != T::default()).then_some(setting)
}
