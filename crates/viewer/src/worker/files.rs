//! Reading scenes and textures, writing pictures, asking for paths: a named thread for each task.

use super::{Wake, case, demo, panic_text};
use crate::app::command::PromptKind;
use crate::app::state::Document;
use crate::app::update::{DialogAnswer, Loaded, News};
use crate::{memory, setup};
use raycast_core::camera::Grid;
use raycast_core::formats::{self, SceneFile};
use raycast_core::image::{Format, Picture, Recipe};
use raycast_core::render::{Cancel, View};
use std::io::Write;
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
            shared: Arc::new(Shared {
                send,
                wake,
                newest_load: AtomicU64::new(0),
                documents: AtomicU64::new(0),
                loads: Mutex::default(),
                saves: AtomicU32::new(0),
            }),
            news,
        }
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

    /// Reads files as one scene; the demo scene if there are none. The newest call wins.
    pub fn open(&self, paths: Vec<PathBuf>) {
        self.load(scene_name(&paths), paths, read);
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
        self.shared.spawn("raycast-texture", ANY, move |_| {
            let texture = formats::read_texture(&path).map_err(|error| error.to_string())?;
            Ok(News::Texture(Arc::new(texture)))
        });
    }

    /// Renders the picture once more, with all that the file's kind holds, and writes it.
    pub fn save(&self, view: View, grid: Grid, threads: usize, path: PathBuf) {
        self.shared.saves.fetch_add(1, Ordering::Relaxed);
        self.shared.spawn("raycast-save", ANY, move |shared| {
            let saved = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                save(view, grid, threads, &path)
            }));
            shared.saves.fetch_sub(1, Ordering::Relaxed);
            saved.map_err(|panic| panic_text(&*panic))??;
            Ok(News::Saved(path))
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
    let file = read(&|share| {
        progress.read(share);
        (shared.wake)();
    })?;
    let load_time = started.elapsed();
    progress.0.store(BUILDING, Ordering::Relaxed);
    (shared.wake)();
    let started = Instant::now();
    let accel = setup::tree(&file.scene).map_err(|error| error.to_string())?;
    let build_time = started.elapsed();
    if accel.is_empty() {
        return Err(match paths.first() {
            Some(path) => format!("{}: no triangle in it can be seen", path.display()),
            None => format!("{name}: no triangle in it can be seen"),
        });
    }
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
    let bounds = file.scene.bounds();
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
fn read(paths: &[PathBuf], progress: &(dyn Fn(f32) + Sync)) -> Result<SceneFile, String> {
    if paths.is_empty() {
        return demo::scene().map_err(|error| error.to_string());
    }
    let mut whole = SceneFile::default();
    for (index, path) in paths.iter().enumerate() {
        let share = |share: f32| progress((index as f32 + share) / paths.len() as f32);
        let file = formats::read_scene(path, &share).map_err(|error| error.to_string())?;
        let first = whole.scene.objects.len();
        whole
            .scene
            .objects
            .extend(file.scene.objects.into_iter().map(|mut object| {
                object.parent = object.parent.map(|parent| parent + first);
                object
            }));
        whole.warnings.extend(file.warnings);
        whole.camera = whole.camera.or(file.camera);
        whole.image.samples = whole.image.samples.or(file.image.samples);
        whole.shading = whole.shading.or(file.shading);
    }
    Ok(whole)
}

fn save(mut view: View, grid: Grid, threads: usize, path: &Path) -> Result<(), String> {
    let format = Format::from_name(&path.to_string_lossy()).map_err(|error| error.to_string())?;
    view.settings.layers = format == Format::Exr;
    let plane = view.camera.plane();
    let memory_for = |columns, rows| format.memory_for(columns, rows);
    memory::check_picture(path, (plane.columns, plane.rows), memory_for, "")
        .map_err(|failure| failure.to_string())?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|index| format!("raycast-save-{index}"))
        .start_handler(|_| super::priority::give_way())
        .build()
        .map_err(|error| error.to_string())?;
    let clock = || Duration::ZERO;
    let picture = pool
        .install(|| view.render(grid, &clock, &Cancel::default(), &|_| {}))
        .ok_or("the render was cancelled")?;
    let recipe = Recipe::of(&view);
    write(&picture, format, Some(&recipe), path)
}

/// Writes all of a picture, or nothing: beside its place first, then into it.
fn write(
    picture: &Picture,
    format: Format,
    recipe: Option<&Recipe>,
    path: &Path,
) -> Result<(), String> {
    let bytes = picture
        .encode_with(format, recipe)
        .map_err(|error| error.to_string())?;
    let describe = |error: std::io::Error| format!("{}: {error}", path.display());
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".raycast-");
    #[cfg(unix)]
    {
        // The usual rights of a new file, before the person's umask; a temporary file's are fewer.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder).map_err(describe)?;
    file.write_all(&bytes).map_err(describe)?;
    file.persist(path).map_err(|error| describe(error.error))?;
    Ok(())
}

fn dialog(kind: PromptKind, suggested: &str) -> DialogAnswer {
    let dialog = rfd::FileDialog::new();
    let started = Instant::now();
    let path = match kind {
        PromptKind::Open => dialog
            .set_title("Open a mesh or a scene")
            .add_filter("Meshes and scenes", &["obj", "txt", "tri", "toml"])
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

    #[test]
    fn a_picture_that_cannot_be_written_leaves_no_file() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("missing").join("a.png");
        let picture = Picture::blank(2, 2, false);
        // Whether the encoder or the folder refuses, nothing may be left behind.
        let outcome = std::panic::catch_unwind(|| write(&picture, Format::Png, None, &path));
        assert!(!matches!(outcome, Ok(Ok(()))));
        assert_eq!(
            std::fs::read_dir(folder.path()).map(Iterator::count).ok(),
            Some(0)
        );
    }
}
