//! Results of measuring and checking meshes: their size and their faults.

use raycast_core::glam::{DAffine3, DVec3};
use raycast_core::health::{Health, Intersections, Size};
use raycast_core::scene::{Mesh, Scene};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The size of an object under one pose.
#[derive(Clone, Debug)]
pub struct Sized {
    /// The mesh that was measured.
    pub mesh: Arc<Mesh>,
    /// Its pose when it was measured.
    pub world_from_object: DAffine3,
    /// The box, the area and the volume.
    pub size: Size,
}

/// The faults of an object's mesh.
#[derive(Clone, Debug)]
pub struct Checked {
    /// The object's index.
    pub object: usize,
    /// The mesh that was checked.
    pub mesh: Arc<Mesh>,
    /// Its topology and its faults.
    pub health: Arc<Health>,
    /// Its self-intersections, if they were searched for.
    pub intersections: Option<Arc<Intersections>>,
}

/// A kind of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Edges that belong to one face only.
    OpenEdges,
    /// Edges that more than two faces share.
    NonManifoldEdges,
    /// Triangles oriented against their neighbours.
    Flipped,
    /// Triangles that no ray can meet.
    Degenerate,
    /// Triangles with the same corners as an earlier one.
    Duplicates,
    /// Vertices that no triangle uses.
    UnusedVertices,
    /// Pairs of triangles that pass through one another.
    SelfIntersections,
}

impl Fault {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::OpenEdges,
        Self::NonManifoldEdges,
        Self::Flipped,
        Self::Degenerate,
        Self::Duplicates,
        Self::UnusedVertices,
        Self::SelfIntersections,
    ];

    /// Its name, and its description for tooltips.
    pub fn name(self) -> (&'static str, &'static str) {
        match self {
            Self::OpenEdges => (
                "Open edges",
                "Edges that one triangle has: a boundary, or a hole",
            ),
            Self::NonManifoldEdges => (
                "Non-manifold edges",
                "Edges that more than two triangles have",
            ),
            Self::Flipped => (
                "Flipped triangles",
                "Triangles that turn the other way than most of those that they hang together with",
            ),
            Self::Degenerate => (
                "Degenerate triangles",
                "Triangles without area, or with a corner that is nowhere: no ray meets them",
            ),
            Self::Duplicates => (
                "Duplicate triangles",
                "Triangles at the same three places as another",
            ),
            Self::UnusedVertices => ("Unused vertices", "Vertices that no triangle has"),
            Self::SelfIntersections => (
                "Self-intersections",
                "Pairs of triangles that meet elsewhere than at a corner or an edge of both",
            ),
        }
    }
}

impl Checked {
    /// The number of faults of a kind; 0 for a kind that was not searched for.
    pub fn count(&self, fault: Fault) -> usize {
        let health = &self.health;
        match fault {
            Fault::OpenEdges => health.open_edges.len(),
            Fault::NonManifoldEdges => health.non_manifold_edges.len(),
            Fault::Flipped => health.flipped.len(),
            Fault::Degenerate => health.degenerate.len(),
            Fault::Duplicates => health.duplicates.len(),
            Fault::UnusedVertices => health.unused_vertices.len(),
            Fault::SelfIntersections => self.pairs().len(),
        }
    }

    /// Whether the search stopped before all faults of a kind were counted.
    pub fn has_more(&self, fault: Fault) -> bool {
        let found = self.intersections.as_ref();
        fault == Fault::SelfIntersections && found.is_some_and(|found| found.has_more)
    }

    /// Whether no fault was found.
    pub fn is_sound(&self) -> bool {
        self.health.is_sound() && self.pairs().is_empty()
    }

    fn pairs(&self) -> &[[u32; 2]] {
        self.intersections
            .as_ref()
            .map_or(&[], |found| &found.pairs)
    }

    /// The number by which a person finds one fault in the mesh's file.
    pub fn number(&self, fault: Fault, index: usize) -> Option<String> {
        let edge = |[a, b]: &[u32; 2]| format!("vertices {a} and {b}");
        let triangle = |number: &u32| format!("triangle {number}");
        let health = &self.health;
        match fault {
            Fault::OpenEdges => health.open_edges.get(index).map(edge),
            Fault::NonManifoldEdges => health.non_manifold_edges.get(index).map(edge),
            Fault::Flipped => health.flipped.get(index).map(triangle),
            Fault::Degenerate => health.degenerate.get(index).map(triangle),
            Fault::Duplicates => health.duplicates.get(index).map(triangle),
            Fault::UnusedVertices => {
                let vertex = health.unused_vertices.get(index);
                vertex.map(|number| format!("vertex {number}"))
            }
            Fault::SelfIntersections => {
                let pair = self.pairs().get(index);
                pair.map(|[a, b]| format!("triangles {a} and {b}"))
            }
        }
    }

    /// The corners of one fault in the mesh's space: of a vertex, an edge, a triangle, or of one triangle and then
    /// another. A corner that is not finite is left out.
    pub fn corners(&self, fault: Fault, index: usize) -> Vec<DVec3> {
        let triangles = |numbers: &[u32]| -> Vec<u32> {
            let triangles = numbers.iter();
            let triangles = triangles.filter_map(|n| self.mesh.triangles().get(*n as usize));
            triangles.flatten().copied().collect()
        };
        let triangle = |list: &[u32]| triangles(list.get(index..=index).unwrap_or_default());
        let edge = |list: &[[u32; 2]]| list.get(index).map(|edge| edge.to_vec());
        let health = &self.health;
        let vertices = match fault {
            Fault::OpenEdges => edge(&health.open_edges).unwrap_or_default(),
            Fault::NonManifoldEdges => edge(&health.non_manifold_edges).unwrap_or_default(),
            Fault::Flipped => triangle(&health.flipped),
            Fault::Degenerate => triangle(&health.degenerate),
            Fault::Duplicates => triangle(&health.duplicates),
            Fault::UnusedVertices => health
                .unused_vertices
                .get(index)
                .copied()
                .into_iter()
                .collect(),
            Fault::SelfIntersections => {
                let pair = self.pairs().get(index);
                pair.map(|pair| triangles(pair)).unwrap_or_default()
            }
        };
        let place = |vertex: u32| self.mesh.positions().get(vertex as usize);
        let places = vertices.into_iter().filter_map(place);
        places
            .map(|p| self.mesh.offset() + p.as_dvec3())
            .filter(|p| p.is_finite())
            .collect()
    }
}

/// One fault among those of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shown {
    /// The object that was checked.
    pub object: usize,
    /// Which kind.
    pub fault: Fault,
    /// Which of them.
    pub index: usize,
}

/// All results, and the fault that is displayed.
#[derive(Clone, Debug, Default)]
pub struct Inspection {
    /// The size of the selected object.
    pub sized: Option<Sized>,
    /// The objects that were checked.
    pub checked: Vec<Checked>,
    /// The number of checks so far: the panel opens when it changes.
    pub rounds: u64,
    /// The fault that is highlighted, together with the others of its kind.
    pub shown: Option<Shown>,
}

impl Inspection {
    /// The result for an object, if it still has the mesh that was checked.
    pub fn of(&self, scene: &Scene, object: usize) -> Option<&Checked> {
        let mesh = &scene.objects.get(object)?.mesh;
        let mut checked = self.checked.iter();
        checked.find(|checked| checked.object == object && Arc::ptr_eq(&checked.mesh, mesh))
    }

    /// Stores new results in place of the objects' earlier ones. Where a mesh was not searched for intersections this
    /// time, those found before stay.
    pub(super) fn take(&mut self, checked: Vec<Checked>) {
        let known = self
            .checked
            .drain(..)
            .map(|checked| (checked.object, checked));
        let mut known: BTreeMap<usize, Checked> = known.collect();
        for mut new in checked {
            if let Some(old) = known.remove(&new.object)
                && Arc::ptr_eq(&old.mesh, &new.mesh)
            {
                new.intersections = new.intersections.or(old.intersections);
            }
            known.insert(new.object, new);
        }
        self.checked = known.into_values().collect();
        self.rounds += 1;
    }

    /// Renumbers the results; `new` lists each object's new index by its old one.
    pub(super) fn renumber(&mut self, numbers: &[usize]) {
        let new = |old: usize| numbers.get(old).copied().unwrap_or(old);
        for checked in &mut self.checked {
            checked.object = new(checked.object);
        }
        self.checked.sort_by_key(|checked| checked.object);
        if let Some(shown) = &mut self.shown {
            shown.object = new(shown.object);
        }
    }

    /// The size of a mesh under a pose, if that was measured last.
    pub fn size(&self, mesh: &Arc<Mesh>, world_from_object: &DAffine3) -> Option<&Size> {
        let sized = self.sized.as_ref()?;
        let is_it = Arc::ptr_eq(&sized.mesh, mesh) && sized.world_from_object == *world_from_object;
        is_it.then_some(&sized.size)
    }
}
