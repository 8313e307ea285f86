//! Reading scenes and textures, building trees, asking for paths: a named thread for each task.

use super::dialog::{DIALOG_ENDINGS, dialog};
use super::load::{Load, scene_name, tree};
use super::tasks::{ANY, LoadStage, Progress, Shared, lock};
use super::{Wake, case, keys, neighbors, panic_text};
use crate::memory;
use crate::state::PromptKind;
use crate::state::effect::Keep;
use crate::state::news::News;
use raycast_core::Accel;
use raycast_core::formats::{self, Limits};
use raycast_core::scene::Scene;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

pub use super::save::Saving;

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
    pub(super) shared: Arc<Shared>,
    news: Receiver<(u64, News)>,
}

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
                newest_size: AtomicU64::new(0),
                newest_check: AtomicU64::new(0),
                check: Mutex::default(),
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
                LoadStage::Reading(share) => {
                    (format!("Reading {name}"), (share > 0.0).then_some(share))
                }
                LoadStage::Building => (format!("Building the tree of {name}"), None),
            };
            return Some(Activity {
                label,
                share,
                can_cancel: true,
            });
        }
        if let Some((_, name, progress)) = &*lock(&self.shared.check) {
            let LoadStage::Reading(share) = progress.stage() else {
                return None;
            };
            return Some(Activity {
                label: format!("Checking {name}"),
                share: Some(share),
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

    /// Lets what is being read, or else looked over, go: nothing more is heard of it, and it ends before its
    /// next step.
    pub fn cancel_load(&self) {
        let newest = self.shared.newest_load.load(Ordering::Relaxed);
        if !lock(&self.shared.loads)
            .iter()
            .any(|(load, ..)| *load == newest)
        {
            self.shared.newest_check.fetch_add(1, Ordering::Relaxed);
            *lock(&self.shared.check) = None;
        }
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

    /// Builds the tree over a scene's visible objects, which was `before`. The newest call wins.
    pub fn build(&self, scene: Arc<Scene>, before: Arc<Accel>) {
        let ticket = self.shared.newest_tree.fetch_add(1, Ordering::Relaxed) + 1;
        self.shared.building.fetch_add(1, Ordering::Relaxed);
        self.shared.spawn("raycast-tree", ANY, move |shared| {
            // One at a time: of those that wait only the newest is built.
            let built = {
                let _turn = lock(&shared.building_turn);
                let is_newest = shared.newest_tree.load(Ordering::Relaxed) == ticket;
                is_newest.then(|| {
                    let build = || tree(&scene, &before);
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

    /// Reads what a picture was made of. Where that is not `scene`, the one that is open, it is looked for
    /// `among` other files. A picture that does not tell is a texture.
    pub fn open_picture(&self, path: PathBuf, scene: Option<Arc<Scene>>, among: Vec<PathBuf>) {
        let limits = self.limits;
        let name = scene_name(std::slice::from_ref(&path));
        self.load(name, move |load| {
            load.picture(&path, scene.as_deref(), among, limits)
        });
    }

    /// Reads an image as a texture of an object, or of all.
    pub fn load_texture(&self, path: PathBuf, which: Option<usize>) {
        let budget = memory::budget(self.limits);
        self.shared.spawn("raycast-texture", ANY, move |shared| {
            lock(&shared.opened).push(path.clone());
            let texture = formats::read_texture_within(&path, &budget);
            let texture = texture.map_err(|error| error.to_string())?;
            Ok(News::Texture(Arc::new(texture), path, which))
        });
    }

    /// Reads the file that changes keys.
    pub fn read_keys(&self, path: PathBuf, asked: bool) {
        self.shared.spawn("raycast-keys", ANY, move |_| {
            let text = keys::read(&path)?;
            Ok(match text {
                None if !asked => News::Nothing,
                text => News::Keys {
                    text: text.unwrap_or_default(),
                    asked,
                },
            })
        });
    }

    /// Opens the file that changes keys in the desktop's editor; writes this one first if there is none.
    pub fn open_keys(&self, path: PathBuf, template: String) {
        self.shared.spawn("raycast-keys", ANY, move |shared| {
            keys::write(&path, &template)?;
            let said = format!("Keys are changed in {}", path.display());
            shared.tell(ANY, News::Done(said));
            // From now on it is watched.
            let text = keys::read(&path)?.unwrap_or_default();
            shared.tell(ANY, News::Keys { text, asked: false });
            keys::edit(&path).map(|()| News::Nothing)
        });
    }

    /// Shows the desktop's dialog for a path.
    pub fn ask(&self, kind: PromptKind, suggested: String) {
        self.shared.spawn("raycast-dialog", ANY, move |_| {
            Ok(News::Dialog(kind, dialog(kind, &suggested)))
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup;
    use crate::worker::demo;
    use raycast_core::camera::Grid;
    use raycast_core::formats::SceneFile;
    use raycast_core::render::View;
    use raycast_core::scene::ClippingPlane;
    use std::path::Path;

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
    fn a_check_that_panics_is_told_and_no_longer_under_way() {
        let is_first = std::sync::atomic::AtomicBool::new(true);
        let files = Files::new(Arc::new(move || {
            assert!(!is_first.swap(false, Ordering::Relaxed), "on purpose");
        }));
        let file = demo::scene().expect("the demo scene");
        let mesh = Arc::clone(&file.scene.objects[0].mesh);
        files.check("a mesh".to_owned(), vec![(0, mesh)], false);
        assert!(matches!(wait(&files), News::Failed(text) if text.contains("on purpose")));
        assert_eq!(files.activity(), None);
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
    fn an_outline_is_written_and_replaces_nothing_unasked() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("cut.svg");
        let file = demo::scene().expect("the demo scene");
        let accel = Arc::new(Accel::build(&file.scene).expect("a valid scene"));
        let (files, by) = (files(), PromptKind::Outline(0));
        let save = |offset, replace| {
            let plane = ClippingPlane::new(raycast_core::glam::DVec3::Y, offset);
            let cut = (Arc::clone(&accel), plane.expect("a plane"));
            files.save_outline(cut, path.clone(), by, replace);
            wait(&files)
        };
        assert!(matches!(save(1.5, false), News::PictureSaved(_)));
        let text = std::fs::read_to_string(&path).expect("written");
        assert!(text.starts_with("<svg") && text.contains("<path"), "{text}");
        assert!(matches!(save(0.5, false), News::Taken(taken) if taken.by == by));
        assert_eq!(std::fs::read_to_string(&path).expect("as it was"), text);
        assert!(matches!(save(0.5, true), News::PictureSaved(_)));
        assert_ne!(std::fs::read_to_string(&path).expect("another"), text);
        assert!(
            matches!(save(1e6, true), News::Failed(text) if text.contains("cuts nothing")),
            "beside everything"
        );
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
        assert!(
            matches!(save(&other, None, false), News::Taken(there) if there.by == PromptKind::Scene)
        );
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
        let image = formats::ImageSettings {
            size: Some((16, 9)),
            ..formats::ImageSettings::default()
        };
        let camera = demo.camera.as_ref();
        let camera = setup::camera(&Default::default(), camera, image, &demo.scene.bounds());
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
        files.load_texture(path.clone(), None);
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
