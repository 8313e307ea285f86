//! The order of the list of objects.

use super::State;
use super::effect::Effect;
use super::insertion::Insertion;
use super::renumbering::follow_picks;
use super::{objects, parents};
use raycast_core::scene::Object;
use std::sync::Arc;

/// Moves an object in the list; it keeps its place in the scene. Refused with a message where its new parent is not
/// possible.
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

/// Reorders the objects; `order` has their old indices.
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
