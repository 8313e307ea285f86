//! Updating the state when objects get other indices.

use super::State;
use super::picks::Picks;
use raycast_core::scene::Object;
use std::sync::Arc;

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
        // It was renamed.
        (None, _) if before.len() == after.len() && has_mesh(&after[number]) => Some(number),
        _ => None,
    }
}
