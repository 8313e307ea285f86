//! The scene that is open.

use raycast_core::Accel;
use raycast_core::camera::CameraPath;
use raycast_core::formats::LengthUnit;
use raycast_core::scene::{Bounds, ClippingPlanes, Mesh, Object, Scene};
use raycast_core::shade::Shading;
use std::collections::{HashMap, VecDeque};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// A scene, and the tree that rays are cast into.
#[derive(Clone, Debug)]
pub struct Document {
    /// Counts scenes opened in this window.
    pub number: u64,
    /// The name in the window's title.
    pub name: String,
    /// The files it came from; none for the demo scene.
    pub paths: Vec<PathBuf>,
    /// Every file that was read for it.
    pub opened: Vec<PathBuf>,
    /// The scene file that it came from or was saved as.
    pub file: Option<PathBuf>,
    /// The unit that its files say their coordinates are in.
    pub unit: Option<LengthUnit>,
    /// The size of the picture that they ask for.
    pub size: Option<(u32, u32)>,
    /// The camera's keyframes, which are saved as they were read.
    pub animation: Option<CameraPath>,
    /// The shading that its files tell.
    pub shading: Option<Shading>,
    /// The clipping planes that its files have.
    pub clip: ClippingPlanes,
    /// The objects with all edits.
    pub scene: Arc<Scene>,
    /// The objects as they were read.
    pub read: Arc<Scene>,
    /// The objects that the tree contains: those before the last edit while a new tree is being built.
    pub built: Arc<Scene>,
    /// Counts changes of what `built` and the tree show.
    pub edits: u64,
    /// The tree over the visible triangles of `built`.
    pub accel: Arc<Accel>,
    /// The box around everything visible, in world space.
    pub bounds: Bounds,
    /// How long reading took.
    pub load_time: Duration,
    /// How long the tree took.
    pub build_time: Duration,
}

impl Document {
    /// A scene of no file, and the tree over it.
    pub fn new(number: u64, name: impl Into<String>, scene: Arc<Scene>, tree: Tree) -> Self {
        Self {
            number,
            name: name.into(),
            paths: Vec::new(),
            opened: Vec::new(),
            file: None,
            unit: None,
            size: None,
            animation: None,
            shading: None,
            clip: ClippingPlanes::NONE,
            read: Arc::clone(&scene),
            built: Arc::clone(&scene),
            scene,
            edits: 0,
            accel: tree.accel,
            bounds: tree.bounds,
            load_time: Duration::ZERO,
            build_time: tree.build_time,
        }
    }

    /// Whether the tree is over the objects as they are.
    pub fn is_built(&self) -> bool {
        Arc::ptr_eq(&self.scene, &self.built)
    }

    /// Sets new objects. If the present tree is valid for them, or can be updated at once, they are shown immediately;
    /// otherwise it returns `false`: a tree must be built, and the old objects stay on screen until then.
    pub fn set_scene(&mut self, scene: Arc<Scene>) -> bool {
        self.scene = scene;
        let holds = has_same_triangles(&self.scene, &self.built);
        if !holds {
            let Some(accel) = self.accel.updated_at_once(&self.scene) else {
                return false;
            };
            self.bounds = accel.bounds();
            self.accel = Arc::new(accel);
        }
        self.built = Arc::clone(&self.scene);
        self.edits += 1;
        true
    }

    /// Takes a tree over `scene`; returns `false` if the objects have changed since the tree was requested.
    pub fn take_tree(&mut self, scene: &Scene, tree: Tree) -> bool {
        let is_wanted = has_same_triangles(&self.scene, scene);
        if is_wanted {
            self.built = Arc::clone(&self.scene);
            self.edits += 1;
            self.accel = tree.accel;
            self.bounds = tree.bounds;
            self.build_time = tree.build_time;
        }
        is_wanted
    }

    /// For each object its index as it was read, if exactly the objects that were read are present. Objects are
    /// identified by their meshes.
    pub fn as_read(&self) -> Option<Vec<usize>> {
        let mut read: HashMap<*const Mesh, VecDeque<usize>> = HashMap::new();
        for (number, object) in self.read.objects.iter().enumerate() {
            let of_mesh = read.entry(Arc::as_ptr(&object.mesh)).or_default();
            of_mesh.push_back(number);
        }
        let objects = &self.scene.objects;
        let numbers = objects.iter().map(|object| {
            let of_mesh = read.get_mut(&Arc::as_ptr(&object.mesh))?;
            of_mesh.pop_front()
        });
        let numbers: Option<Vec<usize>> = numbers.collect();
        numbers.filter(|numbers| numbers.len() == self.read.objects.len())
    }

    /// Whether every object can be named by a scene file: its mesh came from a file on the disk, or is a shape.
    pub fn can_be_saved(&self) -> bool {
        let objects = &self.scene.objects;
        let is_named = |object: &Object| match &object.source {
            Some(path) => path.is_absolute(),
            None => object.shape.is_some(),
        };
        !objects.is_empty() && objects.iter().all(is_named)
    }
}

/// A tree and what comes with it.
#[derive(Clone, Debug)]
pub struct Tree {
    /// The tree over the visible triangles.
    pub accel: Arc<Accel>,
    /// The box around them.
    pub bounds: Bounds,
    /// How long it took.
    pub build_time: Duration,
}

/// Whether two scenes have the same triangles at the same places under the same numbers.
fn has_same_triangles(a: &Scene, b: &Scene) -> bool {
    std::ptr::eq(a, b)
        || a.objects.len() == b.objects.len()
            && a.objects.iter().zip(&b.objects).all(|(a, b)| {
                Arc::ptr_eq(&a.mesh, &b.mesh)
                    && a.transform == b.transform
                    && a.parent == b.parent
                    && a.visible == b.visible
                    && a.hidden_groups == b.hidden_groups
            })
}
