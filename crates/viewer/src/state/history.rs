//! Undo: the document before each change.
//!
//! Nothing large is copied: a step holds the list of objects, whose meshes and textures are shared with the document.
//! Trees are not kept; those of meshes that are still present are reused.

use super::Resolution;
use super::measure::Measurement;
use raycast_core::render::Settings;
use raycast_core::scene::{Mesh, Object, Scene, Texture};
use std::collections::HashSet;
use std::mem::size_of;
use std::sync::Arc;
use std::time::Duration;

/// The most bytes that steps may hold beyond what they share with the document. The newest step always stays.
const MOST_BYTES: usize = 256 << 20;
/// The most steps.
const MOST_STEPS: usize = 500;
/// Changes of the same number or colour within this time join one step.
const PAUSE: Duration = Duration::from_millis(800);

/// Everything that undo restores.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// The objects.
    pub scene: Arc<Scene>,
    /// Which of them are locked.
    pub locked: Arc<Vec<bool>>,
    /// Shading and culling.
    pub settings: Settings,
    /// Samples a pixel, if set.
    pub samples: Option<u32>,
    /// Columns and rows.
    pub resolution: Resolution,
    /// How far the frame is off the view axis.
    pub shift: [f64; 2],
    /// The measurements, which are not part of the document.
    pub measurements: Arc<Vec<Measurement>>,
}

impl Snapshot {
    /// Whether both are equal; scenes are compared by address.
    pub fn is(&self, other: &Self) -> bool {
        self.is_document(other) && self.measurements == other.measurements
    }

    /// Whether both have the same document: what a scene file holds.
    fn is_document(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene)
            && self.locked == other.locked
            && self.settings == other.settings
            && self.samples == other.samples
            && self.resolution == other.resolution
            && self.shift == other.shift
    }
}

/// Changes of the same kind of command and the same object may join one step.
pub type Continued = (
    std::mem::Discriminant<super::command::Command>,
    Option<usize>,
);

/// Pairs of a mesh and the same mesh after a reload.
pub type Renewed = Vec<(Arc<Mesh>, Arc<Mesh>)>;

#[derive(Clone, Debug)]
struct Step {
    name: &'static str,
    /// The document on the other side of the step.
    other: Snapshot,
    /// The revision of that document.
    revision: u64,
    bytes: usize,
}

/// The steps to undo and to redo.
#[derive(Clone, Debug, Default)]
pub struct History {
    undo: Vec<Step>,
    redo: Vec<Step>,
    /// The document's revision. Each of its changes gets a new one, one above `newest`; undo restores an old one.
    revision: u64,
    newest: u64,
    saved: u64,
    last: Option<(Continued, Duration)>,
}

impl History {
    /// Records a change from `before` to `after`. One with a `kind` may join the last step.
    pub fn record(
        &mut self,
        name: &'static str,
        kind: Option<Continued>,
        (before, after): (Snapshot, &Snapshot),
        now: Duration,
    ) {
        let goes_on = self.last.zip(kind).is_some_and(|((last, when), kind)| {
            last == kind
                && self.undo_name() == Some(name)
                && now < when + PAUSE
                && self.redo.is_empty()
                && self.revision != self.saved
        });
        self.last = kind.map(|kind| (kind, now));
        self.redo.clear();
        let left = self.revision;
        if !before.is_document(after) {
            self.newest += 1;
            self.revision = self.newest;
        }
        if goes_on && !self.undo.is_empty() {
            return;
        }
        self.undo.push(Step {
            name,
            bytes: held(&before.scene, &after.scene),
            other: before,
            revision: left,
        });
        self.trim();
    }

    fn trim(&mut self) {
        let mut bytes = 0;
        let kept = self.undo.iter().rev().take(MOST_STEPS).take_while(|step| {
            bytes += step.bytes;
            bytes <= MOST_BYTES
        });
        let kept = kept.count().max(1);
        self.undo.drain(..self.undo.len().saturating_sub(kept));
    }

    /// Undoes a step from `here`: returns its name, and the document before it.
    pub fn undo(&mut self, here: Snapshot) -> Option<(&'static str, Snapshot)> {
        let step = self.undo.pop()?;
        Some(Self::cross(
            step,
            here,
            &mut self.revision,
            &mut self.redo,
            &mut self.last,
        ))
    }

    /// Redoes a step, likewise.
    pub fn redo(&mut self, here: Snapshot) -> Option<(&'static str, Snapshot)> {
        let step = self.redo.pop()?;
        Some(Self::cross(
            step,
            here,
            &mut self.revision,
            &mut self.undo,
            &mut self.last,
        ))
    }

    fn cross(
        step: Step,
        here: Snapshot,
        revision: &mut u64,
        onto: &mut Vec<Step>,
        last: &mut Option<(Continued, Duration)>,
    ) -> (&'static str, Snapshot) {
        *last = None;
        let there = step.revision;
        onto.push(Step {
            revision: std::mem::replace(revision, there),
            bytes: held(&here.scene, &step.other.scene),
            other: here,
            ..step
        });
        (step.name, step.other)
    }

    /// Replaces meshes that were reloaded, in every step.
    pub fn renew(&mut self, meshes: &[(Arc<Mesh>, Arc<Mesh>)]) {
        self.last = None;
        for step in self.undo.iter_mut().chain(&mut self.redo) {
            let mut scene = Scene::clone(&step.other.scene);
            for object in &mut scene.objects {
                let new = meshes
                    .iter()
                    .find(|(old, _)| Arc::ptr_eq(old, &object.mesh));
                if let Some((_, new)) = new {
                    object.set_mesh(Arc::clone(new));
                }
            }
            step.other.scene = Arc::new(scene);
        }
    }

    /// The name of the step that undo would undo.
    pub fn undo_name(&self) -> Option<&'static str> {
        self.undo.last().map(|step| step.name)
    }

    /// The name of the step that redo would redo.
    pub fn redo_name(&self) -> Option<&'static str> {
        self.redo.last().map(|step| step.name)
    }

    /// The document's revision.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Records that a revision was saved.
    pub fn saved(&mut self, revision: u64) {
        self.saved = revision;
        self.last = None;
    }

    /// Whether there are unsaved changes.
    pub fn is_changed(&self) -> bool {
        self.revision != self.saved
    }
}

/// The bytes that `kept` holds beyond what it shares with `scene`: its list, and meshes and textures that `scene` does
/// not have.
fn held(kept: &Arc<Scene>, scene: &Arc<Scene>) -> usize {
    if Arc::ptr_eq(kept, scene) {
        return 0;
    }
    let list = kept.objects.len() * size_of::<Object>();
    let meshes: HashSet<_> = scene.objects.iter().map(|o| Arc::as_ptr(&o.mesh)).collect();
    let parts = scene
        .objects
        .iter()
        .filter_map(|o| o.hidden_groups.as_ref());
    let parts: HashSet<_> = parts.map(Arc::as_ptr).collect();
    let textures = scene.objects.iter().filter_map(|o| o.texture.as_ref());
    let textures: HashSet<_> = textures.map(Arc::as_ptr).collect();
    let mut seen = HashSet::new();
    let mut bytes = list;
    for object in &kept.objects {
        let mesh = Arc::as_ptr(&object.mesh);
        if !meshes.contains(&mesh) && seen.insert(mesh.cast::<()>()) {
            bytes += mesh_bytes(&object.mesh);
        }
        if let Some(hidden) = &object.hidden_groups
            && !parts.contains(&Arc::as_ptr(hidden))
            && seen.insert(Arc::as_ptr(hidden).cast())
        {
            bytes += size_of_val(hidden.kept());
        }
        if let Some(texture) = &object.texture
            && !textures.contains(&Arc::as_ptr(texture))
            && seen.insert(Arc::as_ptr(texture).cast())
        {
            bytes += texture_bytes(texture);
        }
    }
    bytes
}

fn mesh_bytes(mesh: &Mesh) -> usize {
    size_of_val(mesh.positions()) * 2 + size_of_val(mesh.triangles()) * 2 + size_of_val(mesh.kept())
}

fn texture_bytes(texture: &Texture) -> usize {
    size_of_val(texture.texels())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::command::Command;
    use raycast_core::scene::MeshData;
    use raycast_core::shade::Mode;

    fn snapshot(mode: Mode) -> Snapshot {
        let mut settings = Settings::default();
        settings.shading.mode = mode;
        Snapshot {
            scene: Arc::default(),
            locked: Arc::default(),
            settings,
            samples: None,
            resolution: Resolution::Window { density: 1.0 },
            shift: [0.0; 2],
            measurements: Arc::default(),
        }
    }

    #[test]
    fn steps_go_back_and_forth_with_their_names() {
        let [a, b, c] = [Mode::Flat, Mode::Uv, Mode::Depth].map(snapshot);
        let mut history = History::default();
        history.record("first", None, (a.clone(), &b), Duration::ZERO);
        history.record("second", None, (b.clone(), &c), Duration::ZERO);
        assert_eq!(history.undo_name(), Some("second"));
        assert!(history.is_changed());
        let (name, there) = history.undo(c.clone()).expect("a step");
        assert!(name == "second" && there.settings == b.settings);
        let (name, there) = history.undo(b.clone()).expect("a step");
        assert!(name == "first" && there.settings == a.settings);
        assert!(!history.is_changed(), "back at what was opened");
        assert!(history.undo(a.clone()).is_none());
        let (name, there) = history.redo(a.clone()).expect("a step");
        assert!(name == "first" && there.settings == b.settings);
        // Something else now: what was undone is gone.
        history.record("third", None, (b, &a), Duration::ZERO);
        assert_eq!(history.redo_name(), None);
    }

    #[test]
    fn a_change_that_goes_on_is_one_step() {
        let [a, b, c] = [Mode::Flat, Mode::Uv, Mode::Depth].map(snapshot);
        let kind = (std::mem::discriminant(&Command::Undo), None);
        let ms = Duration::from_millis;
        let mut history = History::default();
        history.record("drag", Some(kind), (a.clone(), &b), ms(0));
        history.record("drag", Some(kind), (b.clone(), &c), ms(100));
        let (_, there) = history.undo(c.clone()).expect("a step");
        assert_eq!(there.settings, a.settings);
        assert!(history.undo(a.clone()).is_none());

        history.record("drag", Some(kind), (a.clone(), &b), ms(5000));
        history.record("drag", Some(kind), (b, &c), ms(9000));
        assert!(history.undo(c).is_some() && history.undo(a).is_some());
    }

    #[test]
    fn steps_that_hold_much_push_the_oldest_out() {
        let scene = |texels: u32| {
            let pixels = vec![[0; 4]; (texels * texels) as usize];
            let mut object = Object::new("o", Arc::new(Mesh::new(MeshData::default())));
            object.texture = Texture::new(texels, texels, pixels).map(Arc::new);
            Snapshot {
                scene: Arc::new(Scene {
                    objects: vec![object],
                }),
                ..snapshot(Mode::Flat)
            }
        };
        let mut history = History::default();
        // 64 MiB each.
        let mut last = scene(4096);
        for _ in 0..6 {
            let next = scene(4096);
            history.record("paint", None, (last, &next), Duration::ZERO);
            last = next;
        }
        assert!(
            (2..=4).contains(&history.undo.len()),
            "{}",
            history.undo.len()
        );
    }
}
