//! Reading scenes and textures, building trees, writing pictures and scenes, asking for paths: a named thread
//! for each task.

use super::{Wake, case, demo, neighbors, panic_text};
use crate::failure::Failure;
use crate::output::Output;
use crate::state::document::{Document, Tree};
use crate::state::effect::Keep;
use crate::state::news::{DialogAnswer, Loaded, News};
use crate::state::{PromptKind, Replacing};
use crate::{memory, setup};
use raycast_core::camera::Grid;
use raycast_core::formats::{self, Budget, Limits, SceneFile};
use raycast_core::picture::{Format, Recipe};
use raycast_core::render::{Cancel, View};
use raycast_core::scene::Scene;
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
    /// Whether it can be let go.
    pub can_cancel: bool,
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
    newest_tree: AtomicU64,
    building: AtomicU32,
    building_turn: Mutex<()>,
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
                newest_tree: AtomicU64::new(0),
                building: AtomicU32::new(0),
                building_turn: Mutex::new(()),
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

    /// What is under way: the newest load, unless it was let go, else a tree, else saving.
    pub fn activity(&self) -> Option<Activity> {
        let newest = self.shared.newest_load.load(Ordering::Relaxed);
        let loads = lock(&self.shared.loads);
        if let Some((_, name, progress)) = loads.iter().find(|(load, ..)| *load == newest) {
            let (label, share) = match progress.stage() {
                Stage::Reading(share) => {
                    (format!("Reading {name}"), (share > 0.0).then_some(share))
                }
                Stage::Building => (format!("Building the tree of {name}"), None),
            };
            return Some(Activity {
                label,
                share,
                can_cancel: true,
            });
        }
        let is_any = |count: &AtomicU32| count.load(Ordering::Relaxed) > 0;
        let label = if is_any(&self.shared.building) {
            "Building the tree"
        } else if is_any(&self.shared.saves) {
            "Saving"
        } else {
            return None;
        };
        Some(Activity {
            label: label.to_owned(),
            share: None,
            can_cancel: false,
        })
    }

    /// Every file that was opened so far.
    pub fn opened(&self) -> Vec<PathBuf> {
        lock(&self.shared.opened).clone()
    }

    /// Reads files as one scene; the demo scene if there are none. The newest load wins.
    pub fn open(&self, paths: Vec<PathBuf>, keep: Keep) {
        let limits = self.limits;
        let name = scene_name(&paths);
        self.load(name, move |load| load.document(paths, limits, keep));
    }

    /// Reads the file that comes `step` files behind `path` in its folder, in place of that.
    pub fn open_neighbor(&self, path: PathBuf, step: i32) {
        let limits = self.limits;
        let name = "the next file".to_owned();
        self.load(name, move |load| {
            let path = neighbors::neighbor(&path, step, DIALOG_ENDINGS)?;
            load.rename(scene_name(std::slice::from_ref(&path)));
            load.document(vec![path], limits, Keep::Look)
        });
    }

    /// Reads files to put beside what is open.
    pub fn add(&self, paths: Vec<PathBuf>) {
        let limits = self.limits;
        self.load(scene_name(&paths), move |load| load.objects(paths, limits));
    }

    /// Puts up the hard case of this name as a scene.
    pub fn open_case(&self, name: &'static str) {
        self.load(name.replace('_', " "), move |load| {
            let file = case::scene(name).ok_or_else(|| format!("{name}: there is no such case"))?;
            let loaded = load.finish(file, Vec::new(), Duration::ZERO)?;
            Ok(News::Loaded(Box::new(loaded)))
        });
    }

    /// Lets what is being read go: nothing more is heard of it, and it ends before its tree is built.
    pub fn cancel_load(&self) {
        self.shared.newest_load.fetch_add(1, Ordering::Relaxed);
    }

    fn load(
        &self,
        name: String,
        read: impl FnOnce(&Load<'_>) -> Result<News, String> + Send + 'static,
    ) {
        let ticket = self.shared.newest_load.fetch_add(1, Ordering::Relaxed) + 1;
        let progress = Arc::new(Progress::default());
        lock(&self.shared.loads).push((ticket, name.clone(), Arc::clone(&progress)));
        self.shared.spawn("raycast-load", ticket, move |shared| {
            let load = Load {
                shared,
                ticket,
                progress: &progress,
            };
            let news = read(&load);
            lock(&shared.loads).retain(|(load, ..)| *load != ticket);
            Ok(news.unwrap_or_else(News::NotOpened))
        });
    }

    /// Builds the tree over a scene's visible objects. The newest call wins.
    pub fn build(&self, scene: Arc<Scene>) {
        let ticket = self.shared.newest_tree.fetch_add(1, Ordering::Relaxed) + 1;
        self.shared.building.fetch_add(1, Ordering::Relaxed);
        self.shared.spawn("raycast-tree", ANY, move |shared| {
            // One at a time: of those that wait only the newest is built.
            let built = {
                let _turn = lock(&shared.building_turn);
                let is_newest = shared.newest_tree.load(Ordering::Relaxed) == ticket;
                is_newest.then(|| {
                    let build = || tree(&scene);
                    std::panic::catch_unwind(std::panic::AssertUnwindSafe(build))
                })
            };
            shared.building.fetch_sub(1, Ordering::Relaxed);
            match built {
                None => Ok(News::Nothing),
                Some(Ok(Ok(tree))) => Ok(News::Built(scene, tree)),
                Some(Ok(Err(failure))) => Err(failure.to_string()),
                Some(Err(panic)) => Err(panic_text(&*panic)),
            }
        });
    }

    /// Reads an image as a texture.
    pub fn load_texture(&self, path: PathBuf) {
        let budget = Budget::new(self.limits);
        self.shared.spawn("raycast-texture", ANY, move |shared| {
            lock(&shared.opened).push(path.clone());
            let texture = formats::read_texture_within(&path, &budget);
            let texture = texture.map_err(|error| error.to_string())?;
            Ok(News::Texture(Arc::new(texture), path))
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
                Ok(true) => Ok(News::PictureSaved(path)),
                Ok(false) => Ok(News::Taken(Replacing { path, scene: false })),
                Err(failure) => Err(failure.to_string()),
            }
        });
    }

    /// Writes a scene file, of this revision of the document; not where a file is there, unless it may
    /// `replace` that, and over a file that was opened only if that is its `own`.
    pub fn save_scene(
        &self,
        scene: SceneFile,
        (path, own): (PathBuf, Option<PathBuf>),
        revision: u64,
        replace: bool,
    ) {
        self.shared.spawn("raycast-save", ANY, move |shared| {
            let saved = save_scene(&scene, &path, own.as_deref(), replace, shared);
            Ok(match saved {
                Ok(true) => News::SceneSaved(path, revision),
                Ok(false) => News::Taken(Replacing { path, scene: true }),
                Err(failure) => News::NotSaved(failure.to_string()),
            })
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
                Ok(Ok(News::Nothing)) => return,
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

/// A load under way, on its thread.
struct Load<'a> {
    shared: &'a Shared,
    ticket: u64,
    progress: &'a Progress,
}

/// Files that were read as one, and what was wrong with the others.
struct ReadFiles {
    file: SceneFile,
    paths: Vec<PathBuf>,
    errors: Vec<String>,
}

impl Load<'_> {
    /// Gives it another name.
    fn rename(&self, name: String) {
        for (load, called, _) in lock(&self.shared.loads).iter_mut() {
            if *load == self.ticket {
                called.clone_from(&name);
            }
        }
    }

    /// Whether another load, or a person, has put an end to this one.
    fn is_over(&self) -> bool {
        self.shared.newest_load.load(Ordering::Relaxed) != self.ticket
    }

    fn document(&self, paths: Vec<PathBuf>, limits: Limits, keep: Keep) -> Result<News, String> {
        let started = Instant::now();
        let read = self.read(paths, limits)?;
        let mut loaded = self.finish(read.file, read.paths, started.elapsed())?;
        loaded.keep = keep;
        loaded.errors = read.errors;
        Ok(News::Loaded(Box::new(loaded)))
    }

    fn objects(&self, paths: Vec<PathBuf>, limits: Limits) -> Result<News, String> {
        let ReadFiles {
            file,
            paths,
            errors,
        } = self.read(paths, limits)?;
        Ok(News::Added {
            objects: file.scene.objects,
            opened: file.opened,
            paths,
            notes: file.warnings,
            errors,
        })
    }

    /// Reads every file that can be read into one scene; camera and settings are the first file's that has
    /// any. An error where none could be.
    fn read(&self, paths: Vec<PathBuf>, limits: Limits) -> Result<ReadFiles, String> {
        lock(&self.shared.opened).extend_from_slice(&paths);
        let (mut file, mut read, mut errors) = (SceneFile::default(), Vec::new(), Vec::new());
        if paths.is_empty() {
            file = demo::scene().map_err(|error| error.to_string())?;
        }
        let budget = Budget::new(limits);
        let count = paths.len();
        for (index, path) in paths.into_iter().enumerate() {
            if self.is_over() {
                return Err("it was let go".to_owned());
            }
            let share = |share: f32| {
                self.progress.read((index as f32 + share) / count as f32);
                (self.shared.wake)();
            };
            match formats::read_scene_within(&path, &budget, &share) {
                Ok(next) => {
                    file.append(next);
                    read.push(path);
                }
                Err(error) => errors.push(error.to_string()),
            }
        }
        lock(&self.shared.opened).extend(file.opened.iter().cloned());
        if read.is_empty() && count > 0 {
            // Each message stands for itself: all but the last are told at once.
            let last = errors.pop().unwrap_or_default();
            for error in errors {
                self.shared.tell(self.ticket, News::Failed(error));
            }
            return Err(last);
        }
        Ok(ReadFiles {
            file,
            paths: read,
            errors,
        })
    }

    /// Builds the tree of what was read.
    fn finish(
        &self,
        file: SceneFile,
        paths: Vec<PathBuf>,
        load_time: Duration,
    ) -> Result<Loaded, String> {
        if self.is_over() {
            return Err("it was let go".to_owned());
        }
        self.progress.0.store(BUILDING, Ordering::Relaxed);
        (self.shared.wake)();
        let started = Instant::now();
        let name = match &paths[..] {
            [] => self.name(),
            paths => scene_name(paths),
        };
        let called = match &paths[..] {
            [] => name.clone(),
            paths => setup::name_of(paths),
        };
        let scene = Arc::new(file.scene);
        let has_hidden = scene.objects.iter().any(|object| !object.visible);
        let accel = match has_hidden {
            // It may be that nothing is to be seen, on purpose.
            true => setup::tree(&scene),
            false => setup::visible_tree(&called, &scene),
        };
        let accel = accel.map_err(|error| error.to_string())?;
        let build_time = started.elapsed();
        let objects = scene.objects.iter();
        let dropped: u64 = objects.map(|o| u64::from(o.mesh.dropped().total())).sum();
        let mut notes = file.warnings;
        if dropped > 0 {
            let plural = if dropped == 1 { "" } else { "s" };
            notes.push(format!("{dropped} degenerate triangle{plural} left out"));
        }
        let is_scene = |path: &&PathBuf| {
            let name = path.to_string_lossy().to_ascii_lowercase();
            name.ends_with(".toml")
        };
        let own = match &paths[..] {
            [path] => Some(path).filter(is_scene).cloned(),
            _ => None,
        };
        Ok(Loaded {
            document: Document {
                number: self.shared.documents.fetch_add(1, Ordering::Relaxed) + 1,
                name,
                paths,
                opened: file.opened,
                animation: file.animation,
                file: own,
                bounds: setup::bounds(&scene, &accel),
                read: Arc::clone(&scene),
                built: Arc::clone(&scene),
                scene,
                edits: 0,
                accel: Arc::new(accel),
                load_time,
                build_time,
            },
            keep: Keep::Nothing,
            camera: file.camera,
            samples: file.image.samples,
            shading: file.shading,
            notes,
            errors: Vec::new(),
        })
    }

    fn name(&self) -> String {
        let loads = lock(&self.shared.loads);
        let own = loads.iter().find(|(load, ..)| *load == self.ticket);
        own.map_or_else(String::new, |(_, name, _)| name.clone())
    }
}

/// The tree over a scene, and the box around what can be seen of it.
fn tree(scene: &Scene) -> Result<Tree, Failure> {
    let started = Instant::now();
    let accel = setup::tree(scene)?;
    Ok(Tree {
        bounds: setup::bounds(scene, &accel),
        accel: Arc::new(accel),
        build_time: started.elapsed(),
    })
}

/// Whether the scene was written: not where a file is there that it may not replace.
fn save_scene(
    scene: &SceneFile,
    path: &Path,
    own: Option<&Path>,
    replace: bool,
    shared: &Shared,
) -> Result<bool, Failure> {
    let output = Output::at(path, &[])?;
    let is_own = own.is_some_and(|own| output.check_against([own]).is_err());
    if !is_own {
        output.check_against(lock(&shared.opened).clone())?;
        if output.is_taken() && !replace {
            return Ok(false);
        }
    }
    let folder = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let folder = folder.parent().unwrap_or(Path::new("."));
    let text = scene
        .to_toml(folder)
        .map_err(|error| Failure::could_not(error.to_string()))?;
    output.write(text.as_bytes())?.finish()?;
    // Nothing else is to be written over it, as over anything that is open.
    lock(&shared.opened).push(path.to_owned());
    Ok(true)
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

/// Endings of the files that can be opened.
const DIALOG_ENDINGS: &[&str] = &[
    "obj", "gltf", "glb", "ply", "stl", "off", "3mf", "txt", "tri", "toml", "gz", "zst",
];

fn dialog(kind: PromptKind, suggested: &str) -> DialogAnswer {
    let dialog = rfd::FileDialog::new();
    let started = Instant::now();
    let files = |title| {
        let dialog = rfd::FileDialog::new()
            .set_title(title)
            .add_filter("Meshes and scenes", DIALOG_ENDINGS)
            .add_filter("All files", &["*"]);
        dialog.pick_files()
    };
    let one = |path: Option<PathBuf>| path.map(|path| vec![path]);
    let paths = match kind {
        PromptKind::Open => files("Open meshes or a scene"),
        PromptKind::Add => files("Add meshes or a scene"),
        PromptKind::Texture => one(dialog
            .set_title("Open a texture")
            .add_filter("Images", &["png", "jpg", "jpeg", "ppm"])
            .add_filter("All files", &["*"])
            .pick_file()),
        PromptKind::Picture => one(dialog
            .set_title("Save the picture")
            .set_file_name(suggested)
            .save_file()),
        PromptKind::Scene => one(dialog
            .set_title("Save the scene")
            .set_file_name(suggested)
            .save_file()),
    };
    match paths {
        Some(paths) => DialogAnswer::Paths(paths),
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
    fn good_files_open_beside_bad_ones_which_are_told() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).expect("written");
            path
        };
        let good = write("good.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        let bad = write("bad.obj", "v 0 0 x\n");
        let files = files();
        files.open(vec![bad.clone(), good.clone()], Keep::Nothing);
        let News::Loaded(loaded) = wait(&files) else {
            panic!("the good one opens");
        };
        assert_eq!(loaded.document.scene.objects.len(), 1);
        assert_eq!(loaded.document.paths, std::slice::from_ref(&good));
        assert!(loaded.errors.len() == 1 && loaded.errors[0].contains("bad.obj:1"));
        assert_eq!(files.activity(), None);

        files.open(vec![bad.clone()], Keep::Nothing);
        assert!(matches!(wait(&files), News::NotOpened(text) if text.contains("bad.obj:1")));
        files.add(vec![good, bad]);
        assert!(matches!(
            wait(&files),
            News::Added { objects, errors, .. } if objects.len() == 1 && errors.len() == 1
        ));
    }

    #[test]
    fn nothing_is_heard_of_a_load_that_was_let_go() {
        let files = files();
        files.open(Vec::new(), Keep::Nothing);
        files.cancel_load();
        assert_eq!(files.activity(), None, "its bar goes at once");
        // It ends by itself.
        while !lock(&files.shared.loads).is_empty() {
            std::thread::sleep(Duration::from_millis(5));
        }
        std::thread::sleep(Duration::from_millis(20));
        assert!(files.fetch().is_empty());
    }

    #[test]
    fn a_scene_is_saved_over_itself_and_over_no_other_open_file() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mesh = folder.path().join("mesh.obj");
        std::fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("written");
        let files = files();
        files.open(vec![mesh.clone()], Keep::Nothing);
        let News::Loaded(loaded) = wait(&files) else {
            panic!("it is a good mesh");
        };
        let mut scene = SceneFile {
            scene: loaded.document.scene.as_ref().clone(),
            ..SceneFile::default()
        };
        scene.scene.objects[0].visible = false;
        let path = folder.path().join("scene.raycast.toml");
        let save = |to: &Path, own: Option<&Path>, replace| {
            let paths = (to.to_owned(), own.map(Path::to_owned));
            files.save_scene(scene.clone(), paths, 7, replace);
            wait(&files)
        };
        assert!(matches!(save(&path, None, false), News::SceneSaved(_, 7)));
        let read = formats::read_scene(&path, &|_| ()).expect("a scene");
        assert!(!read.scene.objects[0].visible && read.scene.objects[0].name == "mesh");

        assert!(matches!(
            save(&path, Some(&path), false),
            News::SceneSaved(..)
        ));
        for own in [None, Some(path.as_path())] {
            assert!(matches!(save(&mesh, own, true), News::NotSaved(_)));
        }
        assert!(std::fs::read(&mesh).expect("the mesh").starts_with(b"v 0"));
        let other = folder.path().join("other.toml");
        std::fs::write(&other, "a letter").expect("written");
        assert!(matches!(save(&other, None, false), News::Taken(there) if there.scene));
        assert!(matches!(save(&other, None, true), News::SceneSaved(..)));
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
        assert!(matches!(save(false), News::PictureSaved(_)));
        let whole = std::fs::read(&path).expect("a picture");
        std::fs::write(&path, "a letter").expect("written");
        assert!(matches!(save(false), News::Taken(there) if there.path == path));
        assert_eq!(std::fs::read(&path).expect("a file"), b"a letter");
        assert!(matches!(save(true), News::PictureSaved(_)));
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
        assert!(matches!(wait(&files), News::Texture(..)));
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
