//! Textures that were asked for, until their files are read.

use super::State;
use super::effect::Effect;
use super::renumbering::number_after;
use super::thumbnail::TexturePart;
use raycast_core::scene::Scene;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A texture that is being read.
#[derive(Clone, Debug)]
struct Request {
    number: u64,
    path: PathBuf,
    part: TexturePart,
    /// The object's index; `None` for all.
    object: Option<usize>,
    /// The scene when it was asked for, whose objects have these indices.
    scene: Arc<Scene>,
}

/// The textures that are being read, at most one for each object: whoever asks again wants the last one.
#[derive(Clone, Debug, Default)]
pub struct TextureRequests {
    newest: u64,
    waiting: Vec<Request>,
}

impl TextureRequests {
    /// The part of this file that was asked for as an object's texture and is not there yet.
    pub fn part(&self, scene: &Scene, object: usize, path: &Path) -> Option<TexturePart> {
        let is_of_it = |request: &&Request| {
            request.path == path && request.object_in(scene) == Some(Some(object))
        };
        self.waiting.iter().rev().find(is_of_it).map(|it| it.part)
    }

    /// Asks for the same objects of a scene that was read again, which have the same indices.
    pub(super) fn renew(&mut self, old: &Scene, new: &Arc<Scene>) {
        self.waiting.retain_mut(|request| {
            let object = request.object_in(old);
            request.scene = Arc::clone(new);
            request.object = object.unwrap_or_default();
            object.is_some()
        });
    }

    /// Forgets all: another scene takes the place of theirs.
    pub(super) fn clear(&mut self) {
        self.waiting.clear();
    }

    /// Ends a request: the object's index now, or `None` for all objects; outer `None` where another request has
    /// replaced it, or the object is gone.
    pub(super) fn end(&mut self, number: u64, scene: &Scene) -> Option<Option<usize>> {
        let index = self.waiting.iter().position(|it| it.number == number)?;
        self.waiting.remove(index).object_in(scene)
    }
}

impl Request {
    /// Its object's index in a scene, or `None` for all objects; outer `None` where the object is gone.
    fn object_in(&self, scene: &Scene) -> Option<Option<usize>> {
        let Some(object) = self.object else {
            return Some(None);
        };
        number_after(&self.scene.objects, &scene.objects, object).map(Some)
    }
}

/// Asks for a part of an image as the texture of an object; of all, for `None`.
pub(super) fn ask(
    state: &mut State,
    path: PathBuf,
    object: Option<usize>,
    part: TexturePart,
) -> Option<Effect> {
    let scene = Arc::clone(&state.document.as_ref()?.scene);
    let requests = &mut state.textures;
    let is_replaced = |it: &Request| object.is_none() || it.object_in(&scene) == Some(object);
    requests.waiting.retain(|it| !is_replaced(it));
    requests.newest += 1;
    let number = requests.newest;
    requests.waiting.push(Request {
        number,
        path: path.clone(),
        part,
        object,
        scene,
    });
    Some(Effect::LoadTexture { number, path, part })
}
