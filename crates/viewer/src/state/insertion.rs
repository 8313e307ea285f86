//! A place in the list of objects.

use raycast_core::scene::Object;

/// Where an object is put in the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Insertion {
    /// The object that it is put before, by its number while the object still is where it was; as many as
    /// there are for the end.
    pub before: usize,
    /// What it moves with from then on.
    pub parent: Option<usize>,
}

impl Insertion {
    /// One row up or down among the objects that move with the same one. `None` where there is none.
    pub fn step(objects: &[Object], which: usize, down: bool) -> Option<Self> {
        let parent = objects.get(which)?.parent;
        let is_sibling = |number: &usize| objects[*number].parent == parent;
        let before = match down {
            true => (which + 1..objects.len()).find(is_sibling)? + 1,
            false => (0..which).rev().find(is_sibling)?,
        };
        Some(Self { before, parent })
    }
}
