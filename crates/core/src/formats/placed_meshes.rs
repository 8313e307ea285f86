//! The contents of a file of several objects: meshes, and the nodes that place them.

use super::length_unit::LengthUnit;
use crate::scene::MeshData;
use glam::DAffine3;

/// Meshes and the nodes that place them.
#[derive(Debug, Default)]
pub(super) struct PlacedMeshes {
    /// Each mesh that a node uses, once.
    pub(super) meshes: Vec<MeshData>,
    /// The mesh nodes, depth first.
    pub(super) nodes: Vec<PlacedMesh>,
    /// The unit that the file states.
    pub(super) unit: Option<LengthUnit>,
    /// Contents that are not shown, or not as the file has them.
    pub(super) warnings: Vec<String>,
    /// The file's metadata, and its contents that are not used: a line each, without the file.
    pub(super) notes: Vec<String>,
}

/// A mesh node.
#[derive(Clone, Debug)]
pub(super) struct PlacedMesh {
    pub(super) name: String,
    /// Its mesh, by index.
    pub(super) mesh: usize,
    pub(super) world_from_object: DAffine3,
}

/// The most mesh nodes of one file. Each becomes an object with a name and a transform.
pub(super) const NODE_LIMIT: usize = 1 << 20;
