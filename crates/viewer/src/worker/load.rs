//! Reading files as one scene and building its tree, on a thread of its own.

use super::demo;
use super::tasks::{Progress, Shared, lock};
use crate::failure::Failure;
use crate::state::arrival::Loaded;
use crate::state::document::{Document, Tree};
use crate::state::effect::Keep;
use crate::state::news::News;
use crate::{memory, setup};
use raycast_core::Accel;
use raycast_core::formats::{self, FormatError, Limits, SceneFile};
use raycast_core::picture::{ImageFile, Recipe};
use raycast_core::render::Cancel;
use raycast_core::scene::{Object, Scene};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// The name of a scene of these files.
pub(super) fn scene_name(paths: &[PathBuf]) -> String {
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

/// A load in progress, on its thread.
pub(super) struct Load<'a> {
    pub(super) shared: &'a Shared,
    pub(super) ticket: u64,
    pub(super) progress: &'a Progress,
}

/// The scene of the files that could be read, and the errors of the others.
struct ReadFiles {
    file: SceneFile,
    paths: Vec<PathBuf>,
    errors: Vec<String>,
}

impl Load<'_> {
    /// Sets another name.
    pub(super) fn rename(&self, name: String) {
        for (load, called, _) in lock(&self.shared.loads).iter_mut() {
            if *load == self.ticket {
                called.clone_from(&name);
            }
        }
    }

    /// Whether another load, or a person, has cancelled this one.
    fn is_over(&self) -> bool {
        self.shared.newest_load.load(Ordering::Relaxed) != self.ticket
    }

    pub(super) fn document(
        &self,
        paths: Vec<PathBuf>,
        limits: Limits,
        keep: Keep,
    ) -> Result<News, String> {
        let started = Instant::now();
        let read = self.read(paths, limits)?;
        let mut loaded = self.finish(read.file, read.paths, started.elapsed())?;
        loaded.keep = keep;
        loaded.errors = read.errors;
        Ok(News::Loaded(Box::new(loaded)))
    }

    /// The recipe of a picture, once its scene is open; the picture as a texture, if it has no recipe.
    pub(super) fn picture(
        &self,
        path: &Path,
        scene: Option<&Scene>,
        among: Vec<PathBuf>,
        limits: Limits,
    ) -> Result<News, String> {
        let budget = memory::budget(limits);
        let Some(recipe) = recipe(path)? else {
            lock(&self.shared.opened).push(path.to_owned());
            let texture = formats::read_texture_within(path, &budget);
            let texture = Arc::new(texture.map_err(|error| error.to_string())?);
            return Ok(News::Texture {
                number: None,
                path: path.to_owned(),
                found: Ok(texture),
            });
        };
        let recipe = Box::new(recipe);
        if scene.is_some_and(|scene| recipe.is_of(scene)) {
            return Ok(News::Recipe(recipe));
        }
        let count = among.len();
        for (index, file) in among.into_iter().enumerate() {
            if self.is_over() {
                return Err("it was let go".to_owned());
            }
            self.progress.read(index as f32 / count as f32);
            (self.shared.wake)();
            let read = formats::read_scene_within(&file, &memory::budget(limits), &|_| {});
            let Ok(read) = read else {
                continue;
            };
            if recipe.is_of(&read.scene) {
                lock(&self.shared.opened).extend(read.opened.iter().cloned());
                lock(&self.shared.opened).push(file.clone());
                let mut loaded = self.finish(read, vec![file], Duration::ZERO)?;
                loaded.recipe = Some(recipe);
                return Ok(News::Loaded(Box::new(loaded)));
            }
        }
        Err(format!(
            "{}: the scene that this picture was made of is neither open nor among the recent files. Open its \
             meshes, and drop the picture again.",
            path.display()
        ))
    }

    pub(super) fn objects(&self, paths: Vec<PathBuf>, limits: Limits) -> Result<News, String> {
        let ReadFiles {
            file,
            paths,
            errors,
        } = self.read(paths, limits)?;
        Ok(News::Added {
            objects: file.scene.objects,
            opened: file.opened,
            unit: file.unit,
            paths,
            notes: file.warnings,
            errors,
        })
    }

    /// Reads all files that can be read into one scene; camera and settings are the first file's that has any. An
    /// error if none could be read.
    fn read(&self, paths: Vec<PathBuf>, limits: Limits) -> Result<ReadFiles, String> {
        lock(&self.shared.opened).extend_from_slice(&paths);
        let (mut file, mut read, mut errors) = (SceneFile::default(), Vec::new(), Vec::new());
        if paths.is_empty() {
            file = demo::scene().map_err(|error| error.to_string())?;
        }
        let cancel = Cancel::default();
        let budget = memory::budget(limits).cancelled_by(cancel.clone());
        let count = paths.len();
        for (index, path) in paths.into_iter().enumerate() {
            if self.is_over() {
                return Err("it was let go".to_owned());
            }
            let share = |share: f32| {
                if self.is_over() {
                    cancel.cancel();
                }
                self.progress.read((index as f32 + share) / count as f32);
                (self.shared.wake)();
            };
            match formats::read_scene_within(&path, &budget, &share) {
                Ok(next) => {
                    file.append(next);
                    read.push(path);
                }
                Err(error) => errors.push(message(&error)),
            }
        }
        lock(&self.shared.opened).extend(file.opened.iter().cloned());
        if read.is_empty() && count > 0 {
            // Each message is shown by itself: all but the last are sent at once.
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

    /// Builds the tree of the scene.
    pub(super) fn finish(
        &self,
        file: SceneFile,
        paths: Vec<PathBuf>,
        load_time: Duration,
    ) -> Result<Loaded, String> {
        if self.is_over() {
            return Err("it was let go".to_owned());
        }
        self.progress.build();
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
        // Computed here, so that the window does not wait for them.
        scene.objects.iter().for_each(|object| {
            object.bounds();
        });
        // Filters that need mip levels can be chosen at any time.
        let triangles = Accel::stored_triangles(&scene);
        memory::check_scene(&called, triangles, scene.level_bytes())
            .map_err(|error| error.to_string())?;
        let has_hidden = scene.objects.iter().any(Object::is_partly_hidden);
        let accel =
            setup::tree_to_edit(&scene).and_then(|accel| match has_hidden || !accel.is_empty() {
                // A scene with nothing visible may be intended, and what is scaled to nothing can be scaled again.
                true => Ok(accel),
                false => setup::visible(&called, &scene, accel),
            });
        let accel = accel.map_err(|error| error.to_string())?;
        let tree = Tree {
            bounds: setup::bounds(&scene, &accel),
            accel: Arc::new(accel),
            build_time: started.elapsed(),
        };
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
        let number = self.shared.documents.fetch_add(1, Ordering::Relaxed) + 1;
        let document = Document {
            paths,
            opened: file.opened,
            unit: file.unit,
            size: file.image.size,
            animation: file.animation,
            shading: file.shading,
            file: own,
            load_time,
            ..Document::new(number, name, scene, tree)
        };
        Ok(Loaded {
            camera: file.camera,
            image: file.image,
            clip: file.clip,
            notes,
            ..Loaded::new(document)
        })
    }

    fn name(&self) -> String {
        let loads = lock(&self.shared.loads);
        let own = loads.iter().find(|(load, ..)| *load == self.ticket);
        own.map_or_else(String::new, |(_, name, _)| name.clone())
    }
}

/// An error of reading, for people.
fn message(error: &FormatError) -> String {
    match error {
        FormatError::Io { position, source } if source.kind() == ErrorKind::NotFound => {
            format!("{position}: there is no such file")
        }
        _ => error.to_string(),
    }
}

/// The recipe of a picture, if it has one.
fn recipe(path: &Path) -> Result<Option<Recipe>, String> {
    let cannot = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let bytes = std::fs::read(path).map_err(|error| cannot(&error))?;
    // Pixels are decoded only if the file has a recipe.
    let name = b"raycast-recipe";
    if !bytes.windows(name.len()).any(|part| part == name) {
        return Ok(None);
    }
    let file = ImageFile::decode(&bytes).map_err(|error| cannot(&error))?;
    Ok(file.recipe)
}

/// The tree over a scene, updated from `before`, and the box around what is visible.
pub(super) fn tree(scene: &Scene, before: &Accel) -> Result<Tree, Failure> {
    let started = Instant::now();
    let accel = before.updated(scene)?;
    Ok(Tree {
        bounds: setup::bounds(scene, &accel),
        accel: Arc::new(accel),
        build_time: started.elapsed(),
    })
}
