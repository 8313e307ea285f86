//! Hiding groups of an object's mesh.

use super::State;
use super::effect::Effect;
use super::objects;
use super::pick::Pinned;
use raycast_core::scene::Object;
use std::collections::BTreeSet;

/// The groups of an object's mesh by name, with the numbers of their triangles. The last is that of the triangles in no
/// group, which has no name, if there are any.
pub fn sizes(object: &Object) -> Vec<(&str, usize)> {
    let groups = object.mesh.groups();
    let triangles = object.mesh.triangles().len();
    let names = groups.names().iter().map(String::as_str);
    let mut all: Vec<_> = names.zip(groups.sizes(triangles)).collect();
    let others = triangles - all.iter().map(|(_, size)| size).sum::<usize>();
    if others > 0 && !all.is_empty() {
        all.push(("", others));
    }
    all
}

/// Whether a group is hidden in an object.
pub fn is_hidden(object: &Object, name: &str) -> bool {
    let hidden = object.hidden_groups.as_ref();
    hidden.is_some_and(|hidden| hidden.names().contains(name))
}

/// The object and the group of a pick, if its mesh has groups.
pub fn picked<'s>(state: &'s State, pinned: &'s Pinned) -> Option<(usize, &'s str)> {
    let number = pinned.pick.hit.object as usize;
    let object = state.document.as_ref()?.scene.objects.get(number)?;
    let has_groups = !object.mesh.groups().is_empty();
    has_groups.then_some((number, pinned.group.as_deref().unwrap_or_default()))
}

/// Hides a group of an object, or shows it.
pub(super) fn set_visible(
    state: &mut State,
    which: usize,
    name: &str,
    visible: bool,
) -> Option<Effect> {
    objects::edit_one(state, which, |object| {
        let mut hidden = names(object);
        let has_changed = match visible {
            true => hidden.remove(name),
            false => hidden.insert(name.to_owned()),
        };
        if has_changed {
            object.hide_groups(hidden);
        }
    })
}

/// Shows a group of an object alone; all of its groups if it is alone already.
pub(super) fn isolate(state: &mut State, which: usize, name: &str) -> Option<Effect> {
    objects::edit_one(state, which, |object| {
        let all = sizes(object).into_iter().map(|(other, _)| other);
        let others = all.filter(|other| *other != name).map(str::to_owned);
        let others: BTreeSet<String> = others.collect();
        let is_alone = names(object) == others;
        object.hide_groups(if is_alone { BTreeSet::new() } else { others });
    })
}

fn names(object: &Object) -> BTreeSet<String> {
    let hidden = object.hidden_groups.as_ref();
    hidden.map_or_else(BTreeSet::new, |hidden| hidden.names().clone())
}
