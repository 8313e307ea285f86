//! A position in the list of objects.

use raycast_core::scene::Object;

/// The position to which an object is moved in the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Insertion {
    /// The index of the object that it is inserted before, counted before the move; the number of objects for the end.
    pub before: usize,
    /// Its new parent.
    pub parent: Option<usize>,
}

impl Insertion {
    /// One row up or down among the objects with the same parent. `None` at the end.
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
