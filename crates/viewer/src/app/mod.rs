//! The window: state, workers and panels, connected to eframe.
//!
//! [`State`] is plain values; panels emit [commands](crate::state::command::Command); [`update`] executes them. Each
//! frame applies news from workers, shows the panels, executes their commands, requests a new picture if anything that
//! decides it has changed, and stores the tiles of the last one. Nothing here blocks.

pub mod effects;
pub mod frames;
mod keys;
pub mod log;
pub mod open;
pub mod settings;

use crate::panels::{self, Commands, Status, overlay::TileOverlay};
use crate::state::command::Command;
use crate::state::effect::{Effect, Keep};
use crate::state::news::{self, News};
use crate::state::{State, update};
use crate::ui::canvas::{self, Canvas};
use crate::ui::{mode_pictures, present, theme};
use crate::worker::files::Files;
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

/// What the window shares with the event loop that decides [when it is painted](frames).
pub struct Link {
    /// The outbox of the render thread.
    pub outbox: Arc<Outbox>,
    /// Its clock.
    pub clock: SharedClock,
    /// Wakes the event loop.
    pub nudge: Wake,
    /// The limits of reading files.
    pub limits: Limits,
}

/// The window.
pub struct App {
    state: State,
    canvas: Canvas,
    overlay: TileOverlay,
    renderer: Renderer,
    files: Files,
    /// The file watch, and the files that it watches.
    watch: Option<Watch>,
    watched: Vec<PathBuf>,
    /// The key bindings file, once it has been read.
    keys_file: Option<PathBuf>,
    /// Whether the user has confirmed closing the window.
    may_close: bool,
    clock: SharedClock,
    log: Option<FrameLog>,
    remembers: bool,
    commands: Commands,
    wanted: Option<Wanted>,
    generation: u64,
    /// How many scenes were shown: the picture is of the last.
    scenes: u64,
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
        mode_pictures::install(context);
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
        let limits = state.preferences.limits(limits);
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
            keys_file: None,
            may_close: false,
            clock,
            log,
            remembers,
            commands: Commands::new(),
            wanted: None,
            generation: 0,
            scenes: 0,
            frame_started: Duration::ZERO,
            title: String::new(),
        })
    }

    /// Applies what workers sent since the last frame, except tiles of a picture of the present size.
    fn take_in(&mut self, context: &egui::Context) {
        let now = (self.clock)();
        self.state.now = now;
        let mut news = self.files.fetch();
        if let Some(watch) = &self.watch {
            for path in watch.changes() {
                match self.keys_file.as_ref() == Some(&path) {
                    true if self.state.preferences.watch => {
                        keys::read_again(&mut self.state, &self.files);
                    }
                    true => {}
                    false => news.push(News::Changed(path)),
                }
            }
        }
        for news in news {
            if matches!(news, News::Loaded(_)) {
                self.begin_log(now);
            }
            let effect = news::receive(&mut self.state, news, now);
            self.carry_out(context, effect);
        }
        self.clear_for_another_scene();
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

    /// Watches the files of the open scene, and the key bindings file.
    fn watch_files(&mut self) {
        let Some(watch) = &self.watch else {
            return;
        };
        let files = match &self.state.document {
            Some(document) if document.opened.is_empty() => &document.paths[..],
            Some(document) => &document.opened,
            None => &[],
        };
        // Images that could not be opened may come.
        let objects = self.state.document.iter().flat_map(|d| &d.scene.objects);
        let missing = objects.filter(|object| object.has_stand_in());
        let missing = missing.filter_map(|object| object.texture_source.as_ref());
        let files = files.iter().chain(missing).chain(&self.keys_file);
        if !self.watched.iter().eq(files.clone()) {
            self.watched = files.cloned().collect();
            watch.watch(self.watched.clone());
        }
    }

    /// Keeps the window open for the question about unsaved changes.
    fn hold_closing(&mut self, context: &egui::Context) {
        let is_closing = context.input(|input| input.viewport().close_requested());
        if is_closing && !self.may_close && self.state.has_unsaved() {
            context.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            update::update(&mut self.state, Command::Close);
        }
    }

    /// Clears the picture of the scene before. A scene that is read again stays on screen until its new picture comes,
    /// and one that waits for an answer changes nothing.
    fn clear_for_another_scene(&mut self) {
        if self.scenes != self.state.scenes {
            self.scenes = self.state.scenes;
            self.canvas.clear(self.generation + 1);
        }
    }

    /// Starts writing the log, now that the files of the scene are known.
    fn begin_log(&mut self, now: Duration) {
        if let Some(log) = &mut self.log
            && let Err(failure) = log.begin(&self.files.opened())
        {
            let news = News::Failed(failure.to_string());
            news::receive(&mut self.state, news, now);
        }
    }

    /// Stores tiles of pictures whose size `fits` the one on screen. Returns whether a picture starts or ends with
    /// them.
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

    /// Stores tiles at the end of the frame, after the next picture was requested: the render threads do not wait while
    /// pixels are copied. Pictures of another size were stored at the start, before layout.
    fn take_in_late(&mut self, context: &egui::Context) {
        if self.take_in_tiles(|size, shown| size == shown) {
            // The panels show its progress. While a picture is refined the worker wakes the window.
            context.request_repaint();
        }
        self.canvas.hand_over();
    }

    /// Opens the dropped files.
    fn drop_in(&mut self, context: &egui::Context, paths: Vec<PathBuf>, adds: bool) {
        let Some(command) = command_of_drop(paths, adds) else {
            return;
        };
        let effect = update::update(&mut self.state, command);
        self.carry_out(context, effect);
    }

    fn carry_out(&mut self, context: &egui::Context, effect: Option<Effect>) {
        match effect {
            None => {}
            Some(Effect::SetKeys { text, asked }) => {
                keys::set(&mut self.state, context, &text, asked);
                // In the form in which the watch reports it.
                self.keys_file = keys::path().and_then(|path| path.canonicalize().ok());
            }
            Some(Effect::Copy(text)) => context.copy_text(text),
            Some(Effect::CopyImage(copied)) => {
                let (columns, rows) = copied.size;
                let size = [columns as usize, rows as usize];
                let pixels = copied.pixels.as_flattened();
                context.copy_image(egui::ColorImage::from_rgba_unmultiplied(size, pixels));
            }
            Some(Effect::ToggleFullScreen) => {
                let is_full = context.input(|input| input.viewport().fullscreen.unwrap_or(false));
                context.send_viewport_cmd(egui::ViewportCommand::Fullscreen(!is_full));
            }
            Some(Effect::FocusMenu) => panels::menu::focus(context),
            Some(Effect::Close) => {
                self.may_close = true;
                context.send_viewport_cmd(egui::ViewportCommand::Close);
            }
            Some(effect) => effects::hand_out(&mut self.state, &self.files, effect),
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
        self.state.is_loading = (status.activity.as_ref()).is_some_and(|task| task.can_cancel);
        let place = panels::window::show(
            ui,
            &self.state,
            &status,
            &mut self.canvas,
            &mut self.overlay,
            &mut commands,
        );
        self.state.set_viewport(place.pixels);
        self.state.hover = place.hover;
        for command in commands.drain(..) {
            if !command.moves_camera() {
                // Controls show the change in the next frame, which must therefore be requested. A moving camera shows
                // when its picture arrives, which wakes the window.
                context.request_repaint();
            }
            let effect = update::update(&mut self.state, command);
            self.carry_out(&context, effect);
        }
        self.commands = commands;
    }

    /// The newest picture's progress; incomplete while an older one is on screen.
    fn progress(&self) -> canvas::PictureProgress {
        let mut progress = self.canvas.progress();
        progress.complete &= self.canvas.generation() == self.generation;
        progress
    }

    /// Requests a new picture if anything that decides it has changed.
    fn request(&mut self) {
        self.clear_for_another_scene();
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
        // Until the last picture can be shown the next one waits: the frame that shows the last one will have a newer
        // camera.
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

/// The command for dropped files. Meshes and scenes replace the scene, or are added to it. An image alone becomes the
/// texture, or, if it has a recipe, restores its camera and look.
fn command_of_drop(paths: Vec<PathBuf>, adds: bool) -> Option<Command> {
    let (images, scenes): (Vec<_>, Vec<_>) = paths.into_iter().partition(|path| is_image(path));
    match (scenes.is_empty(), adds) {
        (false, true) => Some(Command::Add(scenes)),
        (false, false) => Some(Command::Open(scenes)),
        (true, _) => images.into_iter().next().map(Command::DropPicture),
    }
}

/// Whether a file is an image by its name.
fn is_image(path: &Path) -> bool {
    path.extension()
        .map(|extension| extension.to_string_lossy().to_ascii_lowercase())
        .is_some_and(|extension| {
            ["png", "jpg", "jpeg", "ppm", "exr", "tif", "tiff"].contains(&extension.as_str())
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dropped_meshes_scenes_and_prepared_files_are_opened_or_added_and_images_are_textures() {
        let paths = |names: &[&str]| names.iter().map(PathBuf::from).collect::<Vec<_>>();
        let meshes = ["a.obj", "b.raycast", "c.raycast.toml"];
        let dropped = |names: &[&str], adds| command_of_drop(paths(names), adds);
        assert_eq!(dropped(&meshes, false), Some(Command::Open(paths(&meshes))));
        assert_eq!(dropped(&meshes, true), Some(Command::Add(paths(&meshes))));
        let image = Some(Command::DropPicture("wood.PNG".into()));
        assert_eq!(dropped(&["wood.PNG", "more.jpg"], false), image);
        // An image beside a mesh is most likely one that the mesh names.
        let with_image = ["wood.PNG", "a.obj"];
        assert_eq!(
            dropped(&with_image, false),
            Some(Command::Open(paths(&["a.obj"])))
        );
        assert_eq!(dropped(&[], true), None);
    }
}
