//! Reading scenes and textures, writing pictures, asking for paths: a named thread for each task.

use super::{Wake, case, demo, panic_text};
use crate::failure::Failure;
use crate::output::Output;
use crate::state::Document;
use crate::state::PromptKind;
use crate::state::update::{DialogAnswer, Loaded, News};
use crate::{memory, setup};
use raycast_core::camera::Grid;
use raycast_core::formats::{self, Budget, Limits, SceneFile};
use raycast_core::picture::{Format, Recipe};
use raycast_core::render::{Cancel, View};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// What a loader is at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stage {
    /// Reading; the share that is done.
    Reading(f32),
    /// Building the tree.
    Building,
}

/// A task that is under way.
#[derive(Clone, Debug, PartialEq)]
pub struct Activity {
    /// What, for a person.
    pub label: String,
    /// The share that is done, where that is known.
    pub share: Option<f32>,
}

/// The file tasks of a window.
#[derive(Debug)]
pub struct Files {
    limits: Limits,
    shared: Arc<Shared>,
    news: Receiver<(u64, News)>,
}

struct Shared {
    send: SyncSender<(u64, News)>,
    wake: Wake,
    newest_load: AtomicU64,
    documents: AtomicU64,
    loads: Mutex<Vec<(u64, String, Arc<Progress>)>>,
    saves: AtomicU32,
    /// Every file that was opened: no picture is written over one.
    opened: Mutex<Vec<PathBuf>>,
}

/// A picture that is to be saved.
#[derive(Clone, Debug)]
pub struct Saving {
    /// What it shows.
    pub view: View,
    /// How it is split.
    pub grid: Grid,
    /// On how many threads it is rendered.
    pub threads: usize,
}

impl std::fmt::Debug for Shared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shared").finish_non_exhaustive()
    }
}

/// News that belongs to no load in particular.
const ANY: u64 = u64::MAX;
/// A share that says that the tree is being built.
const BUILDING: u32 = u32::MAX;

#[derive(Debug, Default)]
struct Progress(AtomicU32);

impl Files {
    /// No task yet.
    pub fn new(wake: Wake) -> Self {
        // A window that is hidden for long fetches no news: then tasks wait here at their end.
        let (send, news) = sync_channel(64);
        Self {
            limits: Limits::default(),
            shared: Arc::new(Shared {
                send,
                wake,
                newest_load: AtomicU64::new(0),
                documents: AtomicU64::new(0),
                loads: Mutex::default(),
                saves: AtomicU32::new(0),
                opened: Mutex::default(),
            }),
            news,
        }
    }

    /// These tasks, with other limits of reading.
    pub fn within(self, limits: Limits) -> Self {
        Self { limits, ..self }
    }

    /// News since the last call. What an overtaken load brings is left out.
    pub fn fetch(&self) -> Vec<News> {
        let newest = self.shared.newest_load.load(Ordering::Relaxed);
        self.news
            .try_iter()
            .filter(|(load, _)| *load == ANY || *load == newest)
            .map(|(_, news)| news)
            .collect()
    }

    /// A way for other workers to tell of a fault.
    pub fn fault(&self) -> Box<dyn Fn(String) + Send + Sync> {
        let shared = Arc::clone(&self.shared);
        Box::new(move |message| shared.tell(ANY, News::Failed(message)))
    }

    /// What is under way, newest load first.
    pub fn activity(&self) -> Option<Activity> {
        let loads = lock(&self.shared.loads);
        if let Some((_, name, progress)) = loads.last() {
            return Some(match progress.stage() {
                Stage::Reading(share) => Activity {
                    label: format!("Reading {name}"),
                    share: (share > 0.0).then_some(share),
                },
                Stage::Building => Activity {
                    label: format!("Building the tree of {name}"),
                    share: None,
                },
            });
        }
        (self.shared.saves.load(Ordering::Relaxed) > 0).then(|| Activity {
            label: "Saving the picture".to_owned(),
            share: None,
        })
    }

    /// Every file that was opened so far.
    pub fn opened(&self) -> Vec<PathBuf> {
        lock(&self.shared.opened).clone()
    }

    /// Reads files as one scene; the demo scene if there are none. The newest call wins.
    pub fn open(&self, paths: Vec<PathBuf>) {
        let limits = self.limits;
        self.load(scene_name(&paths), paths, move |paths, share| {
            read(paths, limits, share)
        });
    }

    /// Puts up the hard case of this name as a scene. The newest call of this or [`Files::open`] wins.
    pub fn open_case(&self, name: &'static str) {
        self.load(name.replace('_', " "), Vec::new(), move |_, _| {
            case::scene(name).ok_or_else(|| format!("{name}: there is no such case"))
        });
    }

    fn load(
        &self,
        name: String,
        paths: Vec<PathBuf>,
        read: impl FnOnce(&[PathBuf], &(dyn Fn(f32) + Sync)) -> Result<SceneFile, String>
        + Send
        + 'static,
    ) {
        let ticket = self.shared.newest_load.fetch_add(1, Ordering::Relaxed) + 1;
        let progress = Arc::new(Progress::default());
        lock(&self.shared.loads).push((ticket, name.clone(), Arc::clone(&progress)));
        self.shared.spawn("raycast-load", ticket, move |shared| {
            let read = |share: &(dyn Fn(f32) + Sync)| read(&paths, share);
            let news = load(&paths, name, read, &progress, shared)
                .map(|loaded| News::Loaded(Box::new(loaded)));
            lock(&shared.loads).retain(|(load, ..)| *load != ticket);
            news
        });
    }

    /// Reads an image as a texture.
    pub fn load_texture(&self, path: PathBuf) {
        let budget = Budget::new(self.limits);
        self.shared.spawn("raycast-texture", ANY, move |shared| {
            lock(&shared.opened).push(path.clone());
            let texture = formats::read_texture_within(&path, &budget);
            let texture = texture.map_err(|error| error.to_string())?;
            Ok(News::Texture(Arc::new(texture)))
        });
    }

    /// Renders the picture once more, with all that the file's kind holds, and writes it; not where a
    /// file is there, unless it may `replace` that.
    pub fn save(&self, picture: Saving, path: PathBuf, replace: bool) {
        self.shared.saves.fetch_add(1, Ordering::Relaxed);
        self.shared.spawn("raycast-save", ANY, move |shared| {
            let saved = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                save(picture, &path, replace, shared)
            }));
            shared.saves.fetch_sub(1, Ordering::Relaxed);
            match saved.map_err(|panic| panic_text(&*panic))? {
                Ok(true) => Ok(News::Saved(path)),
                Ok(false) => Ok(News::Taken(path)),
                Err(failure) => Err(failure.to_string()),
            }
        });
    }

    /// Shows the desktop's dialog for a path.
    pub fn ask(&self, kind: PromptKind, suggested: String) {
        self.shared.spawn("raycast-dialog", ANY, move |_| {
            Ok(News::Dialog(kind, dialog(kind, &suggested)))
        });
    }
}

impl Shared {
    fn tell(&self, load: u64, news: News) {
        // The only failure is a window that is gone: then nobody wants to know.
        let _ = self.send.send((load, news));
        (self.wake)();
    }

    /// Runs a task on a thread of its own; its error, or its panic, becomes a message.
    fn spawn(
        self: &Arc<Self>,
        name: &str,
        load: u64,
        task: impl FnOnce(&Self) -> Result<News, String> + Send + 'static,
    ) {
        let shared = Arc::clone(self);
        let run = move || {
            let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| task(&shared)));
            let news = match outcome {
                Ok(Ok(news)) => news,
                Ok(Err(message)) => News::Failed(message),
                Err(panic) => {
                    lock(&shared.loads).retain(|(ticket, ..)| *ticket != load);
                    News::Failed(format!("A fault in this program: {}", panic_text(&*panic)))
                }
            };
            shared.tell(load, news);
        };
        let spawned = std::thread::Builder::new().name(name.to_owned()).spawn(run);
        if let Err(error) = spawned {
            lock(&self.loads).retain(|(ticket, ..)| *ticket != load);
            // The channel may be full, and this is the window's thread: it must not wait.
            let message = format!("No thread could be started: {error}");
            let _ = self.send.try_send((ANY, News::Failed(message)));
        }
    }
}

impl Progress {
    fn read(&self, share: f32) {
        let share = (share.clamp(0.0, 1.0) * 1e6) as u32;
        self.0.store(share, Ordering::Relaxed);
    }

    fn stage(&self) -> Stage {
        match self.0.load(Ordering::Relaxed) {
            BUILDING => Stage::Building,
            share => Stage::Reading(share as f32 * 1e-6),
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What a scene of these files is called.
fn scene_name(paths: &[PathBuf]) -> String {
    let Some(first) = paths.first() else {
        return "Demo scene".to_owned();
    };
    let name = first.file_name().unwrap_or(first.as_os_str());
    let name = name.to_string_lossy();
    match paths.len() {
        1 => name.into_owned(),
        more => format!("{name} and {} more", more - 1),
    }
}

fn load(
    paths: &[PathBuf],
    name: String,
    read: impl FnOnce(&(dyn Fn(f32) + Sync)) -> Result<SceneFile, String>,
    progress: &Progress,
    shared: &Shared,
) -> Result<Loaded, String> {
    let started = Instant::now();
    lock(&shared.opened).extend_from_slice(paths);
    let file = read(&|share| {
        progress.read(share);
        (shared.wake)();
    })?;
    lock(&shared.opened).extend(file.opened);
    let load_time = started.elapsed();
    progress.0.store(BUILDING, Ordering::Relaxed);
    (shared.wake)();
    let started = Instant::now();
    let called = match paths {
        [] => name.clone(),
        paths => setup::name_of(paths),
    };
    let accel = setup::visible_tree(&called, &file.scene).map_err(|error| error.to_string())?;
    let build_time = started.elapsed();
    let dropped: u64 = file
        .scene
        .objects
        .iter()
        .map(|object| u64::from(object.mesh.dropped().total()))
        .sum();
    let mut notes = file.warnings;
    if dropped > 0 {
        let plural = if dropped == 1 { "" } else { "s" };
        notes.push(format!("{dropped} degenerate triangle{plural} left out"));
    }
    let bounds = setup::bounds(&file.scene, &accel);
    Ok(Loaded {
        document: Document {
            number: shared.documents.fetch_add(1, Ordering::Relaxed) + 1,
            name,
            paths: paths.to_vec(),
            scene: Arc::new(file.scene),
            edits: 0,
            accel: Arc::new(accel),
            bounds,
            load_time,
            build_time,
        },
        camera: file.camera,
        samples: file.image.samples,
        shading: file.shading,
        notes,
    })
}

/// Reads every file into one scene; camera and settings are the first file's that has any.
fn read(
    paths: &[PathBuf],
    limits: Limits,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<SceneFile, String> {
    if paths.is_empty() {
        return demo::scene().map_err(|error| error.to_string());
    }
    let budget = Budget::new(limits);
    let mut whole = SceneFile::default();
    for (index, path) in paths.iter().enumerate() {
        let share = |share: f32| progress((index as f32 + share) / paths.len() as f32);
        let file = formats::read_scene_within(path, &budget, &share);
        whole.append(file.map_err(|error| error.to_string())?);
    }
    Ok(whole)
}

/// Whether the picture was written: not where a file is there that it may not replace.
fn save(saving: Saving, path: &Path, replace: bool, shared: &Shared) -> Result<bool, Failure> {
    let Saving {
        mut view,
        grid,
        threads,
    } = saving;
    let format = Format::from_name(&path.to_string_lossy())?;
    let opened = || lock(&shared.opened).clone();
    let output = Output::at(path, &[])?;
    output.check_against(opened())?;
    if output.is_taken() && !replace {
        return Ok(false);
    }
    view.settings.layers = format == Format::Exr;
    let plane = view.camera.plane();
    let memory_for = |columns, rows| format.memory_for(columns, rows);
    memory::check_picture(path, (plane.columns, plane.rows), memory_for, "")?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|index| format!("raycast-save-{index}"))
        .start_handler(|_| super::priority::give_way())
        .build()
        .map_err(|error| Failure::could_not(error.to_string()))?;
    let clock = || Duration::ZERO;
    let picture = pool
        .install(|| view.render(grid, &clock, &Cancel::default(), &|_| {}))
        .ok_or_else(|| Failure::could_not("the render was cancelled"))?;
    let recipe = Recipe::of(&view);
    let file = output.write(&picture.encode_with(format, Some(&recipe))?)?;
    // Another scene may have been opened meanwhile.
    output.check_against(opened())?;
    file.finish()?;
    Ok(true)
}

fn dialog(kind: PromptKind, suggested: &str) -> DialogAnswer {
    let dialog = rfd::FileDialog::new();
    let started = Instant::now();
    let path = match kind {
        PromptKind::Open => dialog
            .set_title("Open a mesh or a scene")
            .add_filter(
                "Meshes and scenes",
                &[
                    "obj", "gltf", "glb", "ply", "stl", "off", "3mf", "txt", "tri", "toml", "gz",
                    "zst",
                ],
            )
            .add_filter("All files", &["*"])
            .pick_file(),
        PromptKind::Texture => dialog
            .set_title("Open a texture")
            .add_filter("Images", &["png", "jpg", "jpeg", "ppm"])
            .add_filter("All files", &["*"])
            .pick_file(),
        PromptKind::Save => dialog
            .set_title("Save the picture")
            .set_file_name(suggested)
            .save_file(),
    };
    match path {
        Some(path) => DialogAnswer::Path(path),
        // Nobody closes a dialog this soon: it never came up.
        None if started.elapsed() < Duration::from_millis(700) => DialogAnswer::Unavailable,
        None => DialogAnswer::Cancelled,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files() -> Files {
        Files::new(Arc::new(|| {}))
    }

    fn wait(files: &Files) -> News {
        for _ in 0..500 {
            if let Some(news) = files.fetch().pop() {
                return news;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        panic!("no news came");
    }

    #[test]
    fn a_panic_in_a_task_is_told() {
        let files = files();
        files.shared.spawn("test", ANY, |_| panic!("on purpose"));
        assert!(matches!(wait(&files), News::Failed(text) if text.contains("on purpose")));
    }

    #[test]
    fn news_of_an_overtaken_load_is_left_out() {
        let files = files();
        files.shared.newest_load.store(2, Ordering::Relaxed);
        files.shared.tell(1, News::Failed("old".to_owned()));
        files.shared.tell(2, News::Failed("new".to_owned()));
        let news = files.fetch();
        assert!(matches!(&news[..], [News::Failed(text)] if text == "new"));
    }

    #[test]
    fn names_of_scenes() {
        assert_eq!(scene_name(&[]), "Demo scene");
        assert_eq!(scene_name(&["a/b.obj".into()]), "b.obj");
        assert_eq!(
            scene_name(&["a/b.obj".into(), "c.obj".into()]),
            "b.obj and 1 more"
        );
    }

    fn picture() -> Saving {
        let demo = demo::scene().expect("the demo scene");
        let accel = setup::tree(&demo.scene).expect("a tree");
        let size = Some((16, 9));
        let camera = demo.camera.as_ref();
        let camera = setup::camera(&Default::default(), camera, size, &demo.scene.bounds());
        Saving {
            view: View {
                scene: Arc::new(demo.scene),
                accel: Arc::new(accel),
                camera: camera.expect("a camera"),
                settings: Default::default(),
            },
            grid: Grid::default(),
            threads: 1,
        }
    }

    #[test]
    fn a_picture_replaces_a_file_only_where_it_may() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.png");
        let files = files();
        let save = |replace| {
            files.save(picture(), path.clone(), replace);
            wait(&files)
        };
        assert!(matches!(save(false), News::Saved(_)));
        let whole = std::fs::read(&path).expect("a picture");
        std::fs::write(&path, "a letter").expect("written");
        assert!(matches!(save(false), News::Taken(there) if there == path));
        assert_eq!(std::fs::read(&path).expect("a file"), b"a letter");
        assert!(matches!(save(true), News::Saved(_)));
        assert!(std::fs::read(&path).expect("a picture") == whole);
        assert_eq!(files.activity(), None);
    }

    #[test]
    fn a_picture_is_not_written_over_what_was_opened() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("skin.png");
        std::fs::write(&path, "P3\n1 1\n255\n1 2 3\n").expect("written");
        let files = files();
        files.load_texture(path.clone());
        assert!(matches!(wait(&files), News::Texture(_)));
        files.save(picture(), path.clone(), true);
        assert!(matches!(wait(&files), News::Failed(text) if text.contains("skin.png")));
        assert!(std::fs::read(&path).expect("a file").starts_with(b"P3"));
    }

    #[test]
    fn a_picture_that_cannot_be_written_leaves_no_file() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let files = files();
        let path = folder.path().join("missing").join("a.png");
        files.save(picture(), path, true);
        assert!(matches!(wait(&files), News::Failed(text) if text.contains("a.png")));
        assert_eq!(
            std::fs::read_dir(folder.path()).map(Iterator::count).ok(),
            Some(0)
        );
    }
}
