//! The window's state and what its commands do to it.
//!
//! [`State`] is plain values; panels make [commands](crate::state::command::Command); [`update`]
//! carries them out and is the only one that changes the state. Here is what ties that to eframe: once a
//! frame it takes in scenes and messages, shows the panels, carries out what was asked, asks for a new
//! picture if anything that decides it has changed, and takes in the tiles of the last one. Nothing
//! here waits.

pub mod frames;
mod keys;
pub mod log;
pub mod open;
pub mod settings;

use crate::panels::{self, Commands, Status, overlay::TileOverlay};
use crate::state::command::Command;
use crate::state::effect::{Effect, Keep};
use crate::state::news::{self, News};
use crate::state::{PromptKind, State, update};
use crate::ui::canvas::{self, Canvas};
use crate::ui::{present, theme};
use crate::worker::files::{Files, Saving};
use crate::worker::outbox::Outbox;
use crate::worker::render::{Renderer, Request};
use crate::worker::watch::Watch;
use crate::worker::{SharedClock, Wake};
use log::{FrameLine, FrameLog};
use raycast_core::camera::{Camera, Grid};
use raycast_core::formats::Limits;
use raycast_core::render::Settings;
use settings::Remembered;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Everything that decides the picture.
#[derive(Clone, Copy, PartialEq)]
struct Wanted {
    document: u64,
    edits: u64,
    camera: Camera,
    settings: Settings,
    rest_samples: u32,
    grid: Grid,
    threads: usize,
}

/// What the window shares with the loop that decides [when it is painted](frames).
pub struct Link {
    /// Where its pictures come through.
    pub outbox: Arc<Outbox>,
    /// Its clock.
    pub clock: SharedClock,
    /// What makes the loop look.
    pub nudge: Wake,
    /// How much reading files may take.
    pub limits: Limits,
}

/// The window.
pub struct App {
    state: State,
    canvas: Canvas,
    overlay: TileOverlay,
    renderer: Renderer,
    files: Files,
    /// What is watched, and the files that it watches.
    watch: Option<Watch>,
    watched: Vec<PathBuf>,
    /// Whether the person has said that the window may close.
    may_close: bool,
    clock: SharedClock,
    log: Option<FrameLog>,
    remembers: bool,
    commands: Commands,
    wanted: Option<Wanted>,
    generation: u64,
    frame_started: Duration,
    title: String,
}

impl App {
    /// A window on `files`.
    ///
    /// # Errors
    /// The system's refusal to start a thread.
    pub fn new(
        creation: &eframe::CreationContext<'_>,
        files: Vec<PathBuf>,
        log: Option<FrameLog>,
        link: Link,
    ) -> std::io::Result<Self> {
        let Link {
            outbox,
            clock,
            nudge,
            limits,
        } = link;
        let context = &creation.egui_ctx;
        theme::apply(context);
        let wake: Wake = {
            let context = context.clone();
            Arc::new(move || {
                context.request_repaint();
                nudge();
            })
        };
        let mut state = State::default();
        let remembers = log.is_none();
        if remembers
            && let Some(storage) = creation.storage
            && let Some(remembered) = eframe::get_value::<Remembered>(storage, settings::KEY)
        {
            remembered.restore(&mut state);
        }
        let tasks = Files::new(Arc::clone(&wake)).within(limits);
        let renderer =
            Renderer::start(Arc::clone(&clock), Arc::clone(&wake), outbox, tasks.fault())?;
        state.limits = limits;
        if remembers && let Some(path) = keys::path() {
            tasks.read_keys(path, false);
        }
        tasks.open(files, Keep::Nothing);
        Ok(Self {
            state,
            canvas: Canvas::with_presenter(
                creation.gl.as_deref().and_then(present::Presenter::new),
            ),
            overlay: TileOverlay::default(),
            renderer,
            files: tasks,
            watch: Watch::start(wake),
            watched: Vec::new(),
            may_close: false,
            clock,
            log,
            remembers,
            commands: Commands::new(),
            wanted: None,
            generation: 0,
            frame_started: Duration::ZERO,
            title: String::new(),
        })
    }

    /// Takes in what workers sent since the last frame, but for tiles of this size.
    fn take_in(&mut self, context: &egui::Context) {
        let now = (self.clock)();
        self.state.now = now;
        let mut news = self.files.fetch();
        if let Some(watch) = &self.watch {
            news.extend(watch.changes().into_iter().map(News::Changed));
        }
        for news in news {
            if let News::Loaded(loaded) = &news {
                // The same scene once more stays in view until it can be seen anew.
                if loaded.keep != Keep::All {
                    self.canvas.clear(self.generation + 1);
                }
                self.begin_log(now);
            }
            let effect = news::receive(&mut self.state, news, now);
            self.carry_out(context, effect);
        }
        if update::advance(&mut self.state) {
            context.request_repaint();
        }
        self.watch_files();
        self.hold_closing(context);
        self.take_in_tiles(|size, shown| size != shown);
        if let Some(next) = news::expire_toasts(&mut self.state, now) {
            context.request_repaint_after(next);
        }
        self.state.side_limit = context.input(|input| input.max_texture_side as u32).max(1);
        let dropped = context.input(|input| input.raw.dropped_files.clone());
        let paths: Vec<_> = dropped
            .into_iter()
            .map(|file| file.path().to_path_buf())
            .collect();
        let adds = context.input(|input| input.modifiers.shift);
        self.drop_in(context, paths, adds);
    }

    /// Watches the files of the scene that is open.
    fn watch_files(&mut self) {
        let (Some(watch), Some(document)) = (&self.watch, &self.state.document) else {
            return;
        };
        let files = if document.opened.is_empty() {
            &document.paths
        } else {
            &document.opened
        };
        if *files != self.watched {
            self.watched.clone_from(files);
            watch.watch(files.clone());
        }
    }

    /// Keeps the window open while a person is asked about unsaved changes.
    fn hold_closing(&mut self, context: &egui::Context) {
        let is_closing = context.input(|input| input.viewport().close_requested());
        if is_closing && !self.may_close && self.state.has_unsaved() {
            context.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            update::update(&mut self.state, Command::Close);
        }
    }

    /// Lets the log be written, now that it is known which files are not to be touched.
    fn begin_log(&mut self, now: Duration) {
        if let Some(log) = &mut self.log
            && let Err(failure) = log.begin(&self.files.opened())
        {
            let news = News::Failed(failure.to_string());
            news::receive(&mut self.state, news, now);
        }
    }

    /// Takes in tiles of pictures of a size that fits what is shown. Returns whether they begin or end one.
    fn take_in_tiles(&mut self, fits: impl Fn((u32, u32), (u32, u32)) -> bool) -> bool {
        let (now, shown) = ((self.clock)(), self.canvas.size());
        let mut turns = false;
        for batch in self.renderer.outbox().fetch(now, |size| fits(size, shown)) {
            turns |= batch.complete || batch.generation > self.canvas.generation();
            self.canvas.take_in(batch);
            self.state.legend = self.canvas.legend().cloned();
        }
        turns
    }

    /// Takes in tiles at the end of the frame, when the next picture is already under way: cores that
    /// cast rays do not wait for pixels to be copied. A picture of another size has been taken in at the
    /// beginning, before its place was laid out.
    fn take_in_late(&mut self, context: &egui::Context) {
        if self.take_in_tiles(|size, shown| size == shown) {
            // What the panels say of it. While a picture gets finer the worker says when to look.
            context.request_repaint();
        }
        self.canvas.hand_over();
    }

    /// Opens what was dropped: an image becomes the texture, anything else the scene, or a part of it.
    fn drop_in(&mut self, context: &egui::Context, paths: Vec<PathBuf>, adds: bool) {
        let (images, scenes): (Vec<_>, Vec<_>) = paths.into_iter().partition(|path| is_image(path));
        let command = match images.into_iter().next() {
            _ if !scenes.is_empty() && adds => Command::Add(scenes),
            _ if !scenes.is_empty() => Command::Open(scenes),
            Some(image) => Command::DropPicture(image),
            None => return,
        };
        let effect = update::update(&mut self.state, command);
        self.carry_out(context, effect);
    }

    fn carry_out(&mut self, context: &egui::Context, effect: Option<Effect>) {
        match effect {
            None => {}
            Some(Effect::Open(paths, keep)) => self.files.open(paths, keep),
            Some(Effect::Add(paths)) => self.files.add(paths),
            Some(Effect::OpenNeighbor(path, step)) => self.files.open_neighbor(path, step),
            Some(Effect::OpenCase(name)) => self.files.open_case(name),
            Some(Effect::CancelLoad) => self.files.cancel_load(),
            Some(Effect::Build) => {
                if let Some(document) = &self.state.document {
                    let (scene, accel) = (&document.scene, &document.accel);
                    self.files.build(Arc::clone(scene), Arc::clone(accel));
                }
            }
            Some(Effect::LoadTexture(path, which)) => self.files.load_texture(path, which),
            Some(Effect::Dialog(kind)) => {
                let suggested = match kind.saves() {
                    true => update::suggested_name(&self.state, kind),
                    false => String::new(),
                };
                self.files.ask(kind, suggested);
            }
            Some(Effect::OpenPicture(path, among)) => {
                let scene = self.state.document.as_ref();
                let scene = scene.map(|document| Arc::clone(&document.scene));
                self.files.open_picture(path, scene, among);
            }
            Some(Effect::SavePicture { path, replace }) => self.save_picture(path, replace),
            Some(Effect::SaveScene { path, replace }) => self.save_scene(path, replace),
            Some(Effect::SaveMeasurements { path, replace }) => {
                let text = self.state.measuring.csv(&self.state.lengths());
                self.files
                    .save_text(text, path, PromptKind::Measurements, replace);
            }
            Some(Effect::SaveOutline {
                plane: index,
                path,
                replace,
            }) => {
                let plane = self.state.settings.clip.all().get(index);
                if let Some((document, plane)) = self.state.document.as_ref().zip(plane) {
                    let cut = (Arc::clone(&document.accel), *plane);
                    let by = PromptKind::Outline(index);
                    self.files.save_outline(cut, path, by, replace);
                }
            }
            Some(Effect::Weigh(object)) => self.weigh(object),
            Some(Effect::Check(objects)) => self.check(&objects),
            Some(Effect::OpenKeysFile) => keys::open(&mut self.state, &self.files),
            Some(Effect::ReadKeysFile) => keys::read_again(&mut self.state, &self.files),
            Some(Effect::SetKeys { text, asked }) => {
                keys::set(&mut self.state, context, &text, asked);
            }
            Some(Effect::Copy(text)) => context.copy_text(text),
            Some(Effect::Close) => {
                self.may_close = true;
                context.send_viewport_cmd(egui::ViewportCommand::Close);
            }
        }
    }

    /// Works out the size of an object, if it is not known.
    fn weigh(&self, number: usize) {
        let scene = self.state.document.as_ref().map(|document| &document.scene);
        let Some((scene, transforms)) =
            scene.and_then(|scene| Some((scene, scene.world_from_objects().ok()?)))
        else {
            return;
        };
        if let (Some(object), Some(place)) = (scene.objects.get(number), transforms.get(number))
            && self.state.inspection.size(&object.mesh, place).is_none()
        {
            self.files.weigh(Arc::clone(&object.mesh), *place);
        }
    }

    fn check(&self, numbers: &[usize]) {
        let Some(document) = &self.state.document else {
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
        self.files.check(name, meshes.collect());
    }

    fn save_picture(&self, path: PathBuf, replace: bool) {
        if let Some(view) = self.state.view_at_rest() {
            let state = &self.state;
            let picture = Saving {
                view,
                grid: state.grid,
                threads: state.threads,
            };
            self.files.save(picture, path, replace);
        }
    }

    fn save_scene(&self, path: PathBuf, replace: bool) {
        let state = &self.state;
        if let (Some(document), Some(scene)) = (&state.document, state.scene_file()) {
            let own = document.file.clone();
            let revision = state.history.revision();
            self.files.save_scene(scene, (path, own), revision, replace);
        }
    }

    fn show(&mut self, ui: &mut egui::Ui) {
        let context = ui.ctx().clone();
        let preferences = &self.state.preferences;
        theme::prefer(&context, preferences.theme, preferences.scale);
        let mut commands = std::mem::take(&mut self.commands);
        let status = Status {
            progress: self.progress(),
            activity: self.files.activity(),
            tile_times: self.overlay.times(),
        };
        let place = panels::window::show(
            ui,
            &self.state,
            &status,
            &mut self.canvas,
            &mut self.overlay,
            &mut commands,
        );
        self.state.viewport = place.pixels;
        self.state.hover = place.hover;
        for command in commands.drain(..) {
            if !command.moves_camera() {
                // Controls show what was changed in the next frame, which must therefore come. A
                // camera that moves is seen when its picture comes, which wakes the window.
                context.request_repaint();
            }
            let effect = update::update(&mut self.state, command);
            self.carry_out(&context, effect);
        }
        self.commands = commands;
    }

    /// How far the newest picture is: not at all while an older one is on screen.
    fn progress(&self) -> canvas::PictureProgress {
        let mut progress = self.canvas.progress();
        progress.complete &= self.canvas.generation() == self.generation;
        progress
    }

    /// Asks for a new picture if anything that decides it has changed.
    fn request(&mut self) {
        let Some(view) = self.state.view() else {
            return;
        };
        let Some(document) = &self.state.document else {
            return;
        };
        let wanted = Wanted {
            document: document.number,
            edits: document.edits,
            camera: view.camera,
            settings: view.settings,
            rest_samples: self.state.rest_samples(),
            grid: self.state.grid,
            threads: self.state.threads,
        };
        // While nothing of the last picture can be seen, the next one waits for a frame that knows where
        // the camera has got to by then. That frame comes with the last picture.
        if self.wanted == Some(wanted) || self.renderer.outbox().is_busy() {
            return;
        }
        self.wanted = Some(wanted);
        self.generation += 1;
        if let Some(log) = &mut self.log {
            let now = (self.clock)();
            log.request(now, self.generation, self.state.size(), wanted.threads);
        }
        self.renderer.request(Request {
            generation: self.generation,
            document: wanted.document,
            view,
            rest_samples: wanted.rest_samples,
            grid: wanted.grid,
            threads: wanted.threads,
        });
    }

    fn set_title(&mut self, context: &egui::Context) {
        let title = match &self.state.document {
            Some(document) => {
                let mark = if self.state.has_unsaved() { " *" } else { "" };
                format!("{}{mark} – RayCast", document.name)
            }
            None => "RayCast".to_owned(),
        };
        if title != self.title {
            context.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }
}

impl eframe::App for App {
    fn logic(&mut self, context: &egui::Context, _frame: &mut eframe::Frame) {
        self.frame_started = (self.clock)();
        self.take_in(context);
    }

    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        self.show(ui);
        self.request();
        self.set_title(ui.ctx());
        self.take_in_late(ui.ctx());
        let now = (self.clock)();
        let line = FrameLine {
            now,
            frame: now.saturating_sub(self.frame_started),
            last_with_painting: frame.info().cpu_usage,
            asked: self.generation,
            shown: self.canvas.generation(),
            progress: self.canvas.progress(),
        };
        if let Some(log) = &mut self.log {
            log.frame(line);
        }
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        if self.remembers {
            eframe::set_value(storage, settings::KEY, &Remembered::of(&self.state));
        }
    }

    fn persist_egui_memory(&self) -> bool {
        self.remembers
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        theme::of(visuals).panel.to_normalized_gamma_f32()
    }
}

/// Whether a file is an image by its name.
fn is_image(path: &Path) -> bool {
    path.extension()
        .map(|extension| extension.to_string_lossy().to_ascii_lowercase())
        .is_some_and(|extension| ["png", "jpg", "jpeg", "ppm", "exr"].contains(&extension.as_str()))
}
