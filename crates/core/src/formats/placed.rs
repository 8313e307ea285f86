//! What a file of several objects gives: meshes, and where its mesh nodes place them.

use super::length_unit::LengthUnit;
use crate::scene::MeshData;
use glam::DAffine3;

/// Meshes and the nodes that place them.
#[derive(Debug, Default)]
pub(super) struct Placed {
    /// Each mesh that a node has, once.
    pub(super) meshes: Vec<MeshData>,
    /// The mesh nodes, depth first.
    pub(super) nodes: Vec<PlacedMesh>,
    /// The unit that the file says it is in.
    pub(super) unit: Option<LengthUnit>,
    /// What is not shown, or not as the file has it.
    pub(super) warnings: Vec<String>,
    /// What the file says of itself, and holds that is not used: a line each, without the file.
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

/// The most mesh nodes of one file: each is an object, with a name and a place of its own.
pub(super) const NODE_LIMIT: usize = 1 << 20;
