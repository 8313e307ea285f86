//! A model part of a 3MF file: objects, their colours, and what is to be built.

use crate::scene::MeshData;
use glam::DAffine3;
use std::collections::HashMap;

/// What a model part holds.
#[derive(Debug, Default)]
pub(super) struct Model {
    /// The word for its unit.
    pub(super) unit: String,
    /// By their numbers.
    pub(super) objects: HashMap<u32, ModelObject>,
    /// What is to be built, in order.
    pub(super) items: Vec<Instance>,
    /// What there is and is not shown, by how often it is there.
    pub(super) unused: Vec<(&'static str, usize)>,
    /// Triangles whose corners have different colours.
    pub(super) mixed: usize,
}

#[derive(Debug)]
pub(super) struct ModelObject {
    pub(super) name: Option<String>,
    pub(super) shape: Shape,
}

#[derive(Debug)]
pub(super) enum Shape {
    /// Taken when it is first placed.
    Mesh(Box<MeshData>),
    Components(Vec<Instance>),
    /// It was placed before.
    Taken(usize),
}

/// An object that another one, or the build, has somewhere.
#[derive(Clone, Debug)]
pub(super) struct Instance {
    /// The part that has the object; `None` for this one.
    pub(super) part: Option<String>,
    pub(super) object: u32,
    pub(super) outer_from_object: DAffine3,
    /// Where it is named.
    pub(super) line: usize,
}
