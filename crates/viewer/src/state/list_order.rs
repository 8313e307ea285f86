//! The order of the list of objects.

use super::State;
use super::effect::Effect;
use super::picks::Picks;
use super::{objects, parents};
use raycast_core::scene::Object;
use std::sync::Arc;

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

/// Puts an object elsewhere in the list; it stays where it is in the scene. Refused, with a message, where it
/// cannot move with what it would then move with.
pub(super) fn insert(state: &mut State, which: usize, to: Insertion) -> Option<Effect> {
    let objects = &state.document.as_ref()?.scene.objects;
    let count = objects.len();
    if to.before > count || which >= count {
        return None;
    }
    let mut effect = None;
    if objects[which].parent != to.parent {
        effect = parents::set(state, which, to.parent);
        if state.document.as_ref()?.scene.objects[which].parent != to.parent {
            return None;
        }
    }
    let mut order: Vec<usize> = (0..count).filter(|&number| number != which).collect();
    order.insert(to.before - usize::from(to.before > which), which);
    match order.is_sorted() {
        true => effect,
        false => renumber(state, &order).or(effect),
    }
}

/// Lists the objects in this order of their numbers.
fn renumber(state: &mut State, order: &[usize]) -> Option<Effect> {
    let mut numbers = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        numbers[old] = new;
    }
    if !state.locked.is_empty() {
        let locks = order.iter().map(|&old| state.is_locked(old));
        state.locked = Arc::new(locks.collect());
    }
    let new = |old: usize| numbers.get(old).copied();
    state.selected = state.selected.and_then(new);
    state.naming = state.naming.and_then(new);
    state.inspection.renumber(&numbers);
    let picks = std::mem::take(&mut state.picks);
    let effect = objects::edit(state, |objects| {
        let renumbered = order.iter().map(|&old| Object {
            parent: objects[old].parent.and_then(new),
            ..objects[old].clone()
        });
        *objects = renumbered.collect();
    });
    follow_picks(state, picks, new);
    effect
}

/// Puts picks back, of objects that have these `new` numbers now. Until a tree is built for them the picture has the
/// old numbers: then picks are let go of.
pub(super) fn follow_picks(
    state: &mut State,
    mut picks: Picks,
    new: impl Fn(usize) -> Option<usize>,
) {
    let differs = picks.renumber(new);
    let Some(document) = &state.document else {
        return;
    };
    if document.is_built() {
        picks.renew(document);
    }
    if document.is_built() || !differs {
        state.picks = picks;
    }
}

/// The number in the list `after` of the object that has this one `before`: there it has the same mesh and name.
/// `None` where none has, or several at other numbers.
pub(super) fn number_after(before: &[Object], after: &[Object], number: usize) -> Option<usize> {
    let object = before.get(number)?;
    let has_mesh = |other: &Object| Arc::ptr_eq(&object.mesh, &other.mesh);
    let is_it = |other: &Object| has_mesh(other) && object.name == other.name;
    if after.get(number).is_some_and(is_it) {
        return Some(number);
    }
    let mut others = (0..after.len()).filter(|&other| is_it(&after[other]));
    match (others.next(), others.next()) {
        (Some(other), None) => Some(other),
        // It has another name.
        (None, _) if before.len() == after.len() && has_mesh(&after[number]) => Some(number),
        _ => None,
    }
}
