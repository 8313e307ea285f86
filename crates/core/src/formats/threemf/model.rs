//! A model part of a 3MF file: objects, their colours, and build items.

use crate::scene::MeshData;
use glam::DAffine3;
use std::collections::HashMap;

/// A model part.
#[derive(Debug, Default)]
pub(super) struct Model {
    /// The word of its unit.
    pub(super) unit: String,
    /// Objects by id.
    pub(super) objects: HashMap<u32, ModelObject>,
    /// The build items, in order.
    pub(super) items: Vec<Instance>,
    /// Contents that are not shown, and how often each occurs.
    pub(super) unused: Vec<(&'static str, usize)>,
    /// Triangles whose corners have different base materials.
    pub(super) mixed: usize,
}

#[derive(Debug)]
pub(super) struct ModelObject {
    pub(super) name: Option<String>,
    pub(super) shape: Shape,
}

#[derive(Debug)]
pub(super) enum Shape {
    /// A mesh, until it is first placed.
    Mesh(Box<MeshData>),
    Components(Vec<Instance>),
    /// A mesh that was placed before, by its index.
    Taken(usize),
}

/// A use of an object, as a component or a build item.
#[derive(Clone, Debug)]
pub(super) struct Instance {
    /// The part that contains the object; `None` for this one.
    pub(super) part: Option<String>,
    pub(super) object: u32,
    pub(super) outer_from_object: DAffine3,
    /// The line that names it.
    pub(super) line: usize,
}
