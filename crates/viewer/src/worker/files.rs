//! Reading scenes and textures, building trees, asking for paths: a named thread for each task.

use super::dialog::{DIALOG_ENDINGS, dialog};
use super::load::{Load, scene_name, tree};
use super::names::names;
use super::tasks::{ANY, LoadStage, Progress, Shared, lock};
use super::thumbnail::{part_of, thumbnail};
use super::{Wake, case, keys, neighbors, panic_text};
use crate::memory;
use crate::state::PromptKind;
use crate::state::effect::Keep;
use crate::state::news::News;
use crate::state::thumbnail::TexturePart;
use raycast_core::Accel;
use raycast_core::formats::{self, Limits};
use raycast_core::scene::Scene;
use std::cell::Cell;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

pub use super::save::Saving;

/// A task in progress.
#[derive(Clone, Debug, PartialEq)]
pub struct Activity {
    /// What it does, for people.
    pub label: String,
    /// The fraction that is done, if known.
    pub share: Option<f32>,
    /// Whether it can be cancelled.
    pub can_cancel: bool,
}

/// The file tasks of a window.
#[derive(Debug)]
pub struct Files {
    limits: Cell<Limits>,
    pub(super) shared: Arc<Shared>,
    news: Receiver<(u64, News)>,
}

impl Files {
    /// No tasks yet.
    pub fn new(wake: Wake) -> Self {
        // A hidden window may not fetch news for long; tasks then wait here when they finish.
        let (send, news) = sync_channel(64);
        Self {
            limits: Cell::default(),
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

    /// The same with other limits of reading.
    pub fn within(self, limits: Limits) -> Self {
        self.set_limits(limits);
        self
    }

    /// Sets the limits of what is read from now on.
    pub fn set_limits(&self, limits: Limits) {
        self.limits.set(limits);
    }

    /// News since the last call, without those of loads that a newer one replaced.
    pub fn fetch(&self) -> Vec<News> {
        let newest = self.shared.newest_load.load(Ordering::Relaxed);
        self.news
            .try_iter()
            .filter(|(load, _)| *load == ANY || *load == newest)
            .map(|(_, news)| news)
            .collect()
    }

    /// A callback by which other workers report faults.
    pub fn fault(&self) -> Box<dyn Fn(String) + Send + Sync> {
        let shared = Arc::clone(&self.shared);
        Box::new(move |message| shared.tell(ANY, News::Failed(message)))
    }

    /// The task in progress: the newest load, unless it was cancelled, else building a tree, else saving.
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
        let limits = self.limits.get();
        let name = scene_name(&paths);
        self.load(name, move |load| load.document(paths, limits, keep));
    }

    /// Reads the file that is `step` files after `path` in its folder, and replaces the scene.
    pub fn open_neighbor(&self, path: PathBuf, step: i32) {
        let limits = self.limits.get();
        let name = "the next file".to_owned();
        self.load(name, move |load| {
            let path = neighbors::neighbor(&path, step, DIALOG_ENDINGS)?;
            load.rename(scene_name(std::slice::from_ref(&path)));
            load.document(vec![path], limits, Keep::Look)
        });
    }

    /// Reads files and adds them to the scene.
    pub fn add(&self, paths: Vec<PathBuf>) {
        let limits = self.limits.get();
        self.load(scene_name(&paths), move |load| load.objects(paths, limits));
    }

    /// Opens the hard case of this name as a scene.
    pub fn open_case(&self, name: &'static str) {
        self.load(name.replace('_', " "), move |load| {
            let file = case::scene(name).ok_or_else(|| format!("{name}: there is no such case"))?;
            let loaded = load.finish(file, Vec::new(), Duration::ZERO)?;
            Ok(News::Loaded(Box::new(loaded)))
        });
    }

    /// Cancels the current load, or else the current check: its results are dropped, and it ends before its next
    /// step.
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

    /// Builds the tree over a scene's visible objects, updating `before`. The newest call wins.
    pub fn build(&self, scene: Arc<Scene>, before: Arc<Accel>) {
        let ticket = self.shared.newest_tree.fetch_add(1, Ordering::Relaxed) + 1;
        self.shared.building.fetch_add(1, Ordering::Relaxed);
        self.shared.spawn("raycast-tree", ANY, move |shared| {
            // One at a time: of waiting calls only the newest is executed.
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

    /// Reads a picture's recipe. If its scene is not `scene`, the open one, it is searched `among` other files. A
    /// picture without a recipe is used as a texture.
    pub fn open_picture(&self, path: PathBuf, scene: Option<Arc<Scene>>, among: Vec<PathBuf>) {
        let limits = self.limits.get();
        let name = scene_name(std::slice::from_ref(&path));
        self.load(name, move |load| {
            load.picture(&path, scene.as_deref(), among, limits)
        });
    }

    /// Reads a part of an image as the texture of a request.
    pub fn load_texture(&self, number: u64, path: PathBuf, part: TexturePart) {
        let budget = memory::budget(self.limits.get());
        self.shared.spawn("raycast-texture", ANY, move |shared| {
            lock(&shared.opened).push(path.clone());
            let texture = formats::read_texture_within(&path, &budget);
            let found = match texture.map(|image| part_of(image, part)) {
                Ok(Some(texture)) => Ok(Arc::new(texture)),
                Ok(None) => Err(format!("{}: the image is smaller now", path.display())),
                Err(error) => Err(error.to_string()),
            };
            Ok(News::Texture {
                number: Some(number),
                path,
                found,
            })
        });
    }

    /// Reads an image's thumbnail.
    pub fn read_thumbnail(&self, path: PathBuf) {
        let budget = memory::budget(self.limits.get());
        self.shared.spawn("raycast-thumbnail", ANY, move |_| {
            let image = formats::read_texture_within(&path, &budget);
            let found = image.map(|image| Arc::new(thumbnail(&image)));
            Ok(News::Thumbnail(
                path,
                found.map_err(|error| error.to_string()),
            ))
        });
    }

    /// Reads the key bindings file.
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

    /// Opens the key bindings file in the desktop's editor; writes `template` first if there is none.
    pub fn open_keys(&self, path: PathBuf, template: String) {
        self.shared.spawn("raycast-keys", ANY, move |shared| {
            keys::write(&path, &template)?;
            let said = format!("Keys are changed in {}", path.display());
            shared.tell(ANY, News::Done(said));
            // The file is watched from now on.
            let text = keys::read(&path)?.unwrap_or_default();
            shared.tell(ANY, News::Keys { text, asked: false });
            keys::edit(&path).map(|()| News::Nothing)
        });
    }

    /// Reads the names in a folder.
    pub fn list(&self, folder: String, kind: PromptKind) {
        self.shared.spawn("raycast-names", ANY, move |_| {
            Ok(News::Listed(names(folder, kind)))
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
#[path = "files_tests.rs"]
mod tests;
