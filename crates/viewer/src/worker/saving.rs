//! Writing files on a thread of their own: not over another file, unless that was asked about.

use super::files::{Files, Saving};
use super::panic_text;
use super::save::{
    rendered, save, save_meshes, save_outline, save_scene, save_scene_copy, save_text,
};
use super::tasks::ANY;
use crate::failure::Failure;
use crate::state::effect::Copied;
use crate::state::news::News;
use crate::state::{PromptKind, Replacing};
use raycast_core::Accel;
use raycast_core::formats::SceneFile;
use raycast_core::scene::{ClippingPlane, Scene};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;

impl Files {
    /// Renders the picture once more, with all that the file's kind holds, and writes it; not where a
    /// file is there, unless it may `replace` that.
    pub fn save(&self, picture: Saving, path: PathBuf, replace: bool) {
        self.shared.saves.fetch_add(1, Ordering::Relaxed);
        self.shared.spawn("raycast-save", ANY, move |shared| {
            let saved = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                save(picture, &path, replace, shared)
            }));
            shared.saves.fetch_sub(1, Ordering::Relaxed);
            let saved = saved.map_err(|panic| panic_text(&*panic))?;
            Ok(news_of(saved, path, PromptKind::Picture))
        });
    }

    /// Renders the picture once more, for the clipboard.
    pub fn copy_picture(&self, picture: Saving) {
        self.shared.saves.fetch_add(1, Ordering::Relaxed);
        self.shared.spawn("raycast-save", ANY, move |shared| {
            let drawn =
                std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| rendered(&picture)));
            shared.saves.fetch_sub(1, Ordering::Relaxed);
            match drawn.map_err(|panic| panic_text(&*panic))? {
                Ok(drawn) => Ok(News::PictureCopied(Arc::new(Copied {
                    size: (drawn.width, drawn.height),
                    pixels: drawn.pixels,
                }))),
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
                Ok(false) => News::Taken(Replacing {
                    path,
                    by: PromptKind::Scene,
                }),
                Err(failure) => News::NotSaved(failure.to_string()),
            })
        });
    }

    /// Writes a scene file that does not become the open one; not over another file, unless it may `replace` that.
    pub fn save_scene_copy(&self, scene: SceneFile, path: PathBuf, replace: bool) {
        self.shared.spawn("raycast-save", ANY, move |shared| {
            let saved = save_scene_copy(&scene, &path, replace, shared);
            Ok(news_of(saved, path, PromptKind::SceneCopy))
        });
    }

    /// Writes text, likewise.
    pub fn save_text(&self, text: String, path: PathBuf, by: PromptKind, replace: bool) {
        self.shared.spawn("raycast-save", ANY, move |shared| {
            let saved = save_text(&text, &path, replace, shared);
            Ok(news_of(saved, path, by))
        });
    }

    /// Writes the visible objects as a mesh file, likewise, and tells what its format cannot represent.
    pub fn save_meshes(&self, scene: Arc<Scene>, path: PathBuf, replace: bool) {
        self.shared.saves.fetch_add(1, Ordering::Relaxed);
        self.shared.spawn("raycast-save", ANY, move |shared| {
            let saved = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                save_meshes(&scene, &path, replace, shared)
            }));
            shared.saves.fetch_sub(1, Ordering::Relaxed);
            let saved = saved.map_err(|panic| panic_text(&*panic))?;
            if let Ok(Some(losses)) = &saved {
                for loss in losses {
                    shared.tell(ANY, News::Done(format!("{}: {loss}", path.display())));
                }
            }
            Ok(news_of(
                saved.map(|losses| losses.is_some()),
                path,
                PromptKind::Meshes,
            ))
        });
    }

    /// Writes the outline that a plane cuts, likewise.
    pub fn save_outline(
        &self,
        (accel, plane): (Arc<Accel>, ClippingPlane),
        path: PathBuf,
        by: PromptKind,
        replace: bool,
    ) {
        self.shared.saves.fetch_add(1, Ordering::Relaxed);
        self.shared.spawn("raycast-save", ANY, move |shared| {
            let saved = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                save_outline((&accel, &plane), &path, replace, shared)
            }));
            shared.saves.fetch_sub(1, Ordering::Relaxed);
            let saved = saved.map_err(|panic| panic_text(&*panic))?;
            if let Ok(Some((open @ 1.., all))) = saved {
                let said = format!("{open} of {all} lines are not closed: the mesh is open there");
                shared.tell(ANY, News::Done(said));
            }
            Ok(news_of(saved.map(|lines| lines.is_some()), path, by))
        });
    }
}

/// The end of saving: whether the file was written, or is there already.
fn news_of(saved: Result<bool, Failure>, path: PathBuf, by: PromptKind) -> News {
    match saved {
        Ok(true) => News::PictureSaved(path),
        Ok(false) => News::Taken(Replacing { path, by }),
        Err(failure) => News::NotSaved(failure.to_string()),
    }
}
