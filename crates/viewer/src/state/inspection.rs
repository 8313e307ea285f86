//! What was found out about meshes: their size, and what is wrong with them.

use raycast_core::glam::{DAffine3, DVec3};
use raycast_core::health::{Health, Size};
use raycast_core::scene::{Mesh, Scene};
use std::sync::Arc;

/// The size of an object, as it stood.
#[derive(Clone, Debug)]
pub struct Sized {
    /// Its triangles.
    pub mesh: Arc<Mesh>,
    /// Where they stood.
    pub world_from_object: DAffine3,
    /// How much there is.
    pub size: Size,
}

/// What is wrong with an object's mesh.
#[derive(Clone, Debug)]
pub struct Checked {
    /// Which object had it.
    pub object: usize,
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// What is wrong.
    pub health: Arc<Health>,
}

/// A kind of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Edges that one face has.
    OpenEdges,
    /// Edges that more than two have.
    NonManifoldEdges,
    /// Triangles that turn the other way than their neighbours.
    Flipped,
    /// Triangles that no ray can meet.
    Degenerate,
    /// Triangles that are there already.
    Duplicates,
    /// Vertices that no triangle has.
    UnusedVertices,
}

impl Fault {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::OpenEdges,
        Self::NonManifoldEdges,
        Self::Flipped,
        Self::Degenerate,
        Self::Duplicates,
        Self::UnusedVertices,
    ];

    /// What it is called, and what it is.
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
        }
    }

    /// How many there are.
    pub fn count(self, health: &Health) -> usize {
        match self {
            Self::OpenEdges => health.open_edges.len(),
            Self::NonManifoldEdges => health.non_manifold_edges.len(),
            Self::Flipped => health.flipped.len(),
            Self::Degenerate => health.degenerate.len(),
            Self::Duplicates => health.duplicates.len(),
            Self::UnusedVertices => health.unused_vertices.len(),
        }
    }

    /// The number of one of them in its file, by which people find it.
    pub fn number(self, health: &Health, index: usize) -> Option<String> {
        let edge = |[a, b]: &[u32; 2]| format!("vertices {a} and {b}");
        let triangle = |number: &u32| format!("triangle {number}");
        match self {
            Self::OpenEdges => health.open_edges.get(index).map(edge),
            Self::NonManifoldEdges => health.non_manifold_edges.get(index).map(edge),
            Self::Flipped => health.flipped.get(index).map(triangle),
            Self::Degenerate => health.degenerate.get(index).map(triangle),
            Self::Duplicates => health.duplicates.get(index).map(triangle),
            Self::UnusedVertices => {
                let vertex = health.unused_vertices.get(index);
                vertex.map(|number| format!("vertex {number}"))
            }
        }
    }
}

impl Checked {
    /// The corners of one fault in the mesh's space: one, two or three; none where a coordinate is not finite.
    pub fn corners(&self, fault: Fault, index: usize) -> Vec<DVec3> {
        let triangle = |list: &[u32]| -> Vec<u32> {
            let number = list.get(index).copied();
            let corners = number.and_then(|n| self.mesh.triangles().get(n as usize));
            corners.map(|corners| corners.to_vec()).unwrap_or_default()
        };
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

/// All that was found out.
#[derive(Clone, Debug, Default)]
pub struct Inspection {
    /// The size of the marked object.
    pub sized: Option<Sized>,
    /// Objects that were looked over.
    pub checked: Vec<Checked>,
    /// The fault that is lit up, and all of its kind with it.
    pub shown: Option<Shown>,
}

impl Inspection {
    /// What is known of an object, if it still has the mesh that was looked over.
    pub fn of(&self, scene: &Scene, object: usize) -> Option<&Checked> {
        let mesh = &scene.objects.get(object)?.mesh;
        let mut checked = self.checked.iter();
        checked.find(|checked| checked.object == object && Arc::ptr_eq(&checked.mesh, mesh))
    }

    /// The size of a mesh in a place, if that is what was worked out last.
    pub fn size(&self, mesh: &Arc<Mesh>, world_from_object: &DAffine3) -> Option<&Size> {
        let sized = self.sized.as_ref()?;
        let is_it = Arc::ptr_eq(&sized.mesh, mesh) && sized.world_from_object == *world_from_object;
        is_it.then_some(&sized.size)
    }
}
