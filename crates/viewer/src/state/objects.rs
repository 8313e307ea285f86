//! Edits of the scene's objects.

use super::State;
use super::effect::Effect;
use super::handle::Tool;
use super::history::Snapshot;
use super::picks::Picks;
use super::renumbering;
use super::turn::{Turning, axis_in, turned};
use raycast_core::camera::{DEFAULT_FOV, Pose};
use raycast_core::glam::DVec3;
use raycast_core::ranges;
use raycast_core::scene::{Object, Photograph, Scene, Texture, Transform};
use std::collections::HashMap;
use std::sync::Arc;

/// Edits a copy of the list of objects, with the meshes shared; requests a tree where the old one is no longer valid.
/// An edit that changes nothing keeps the scene itself, so that there is nothing to undo or to save.
pub(super) fn edit(state: &mut State, edit: impl FnOnce(&mut Vec<Object>)) -> Option<Effect> {
    let document = state.document.as_mut()?;
    let mut scene = Scene::clone(&document.scene);
    edit(&mut scene.objects);
    let old = &document.scene.objects;
    let is_same_list = scene.objects.len() == old.len()
        && scene
            .objects
            .iter()
            .zip(old)
            .all(|(new, old)| is_same(new, old));
    if is_same_list {
        return None;
    }
    set_scene(state, Arc::new(scene))
}

/// Whether two objects are equal; meshes and textures are compared by address.
fn is_same(a: &Object, b: &Object) -> bool {
    let Object {
        name,
        mesh,
        transform,
        parent,
        color,
        texture,
        mapping,
        blend_by,
        source,
        up_axis,
        texture_source,
        node,
        visible,
        hidden_groups,
        shape,
    } = a;
    let address = |texture: &Option<Arc<Texture>>| texture.as_ref().map(Arc::as_ptr);
    *name == b.name
        && Arc::ptr_eq(mesh, &b.mesh)
        && *transform == b.transform
        && *parent == b.parent
        && *color == b.color
        && address(texture) == address(&b.texture)
        && *mapping == b.mapping
        && *blend_by == b.blend_by
        && *source == b.source
        && *up_axis == b.up_axis
        && *texture_source == b.texture_source
        && *node == b.node
        && *visible == b.visible
        && *hidden_groups == b.hidden_groups
        && *shape == b.shape
}

/// Edits each object.
pub(super) fn edit_each(
    state: &mut State,
    mut edit_one: impl FnMut(usize, &mut Object),
) -> Option<Effect> {
    edit(state, |objects| {
        for (number, object) in objects.iter_mut().enumerate() {
            edit_one(number, object);
        }
    })
}

/// Edits one object, if it exists.
pub(super) fn edit_one(
    state: &mut State,
    which: usize,
    edit_it: impl FnOnce(&mut Object),
) -> Option<Effect> {
    has(state, which).then(|| {
        edit(state, |objects| {
            if let Some(object) = objects.get_mut(which) {
                edit_it(object);
            }
        })
    })?
}

/// Whether an object may be edited; shows a message if it is locked.
pub(super) fn is_free(state: &mut State, which: usize) -> bool {
    let is_free = !state.is_locked(which);
    if !is_free && let Some(document) = &state.document {
        let name = document.scene.objects.get(which).map_or("It", |o| &o.name);
        let text = format!("{name} is locked: Edit, Lock unlocks it");
        state.tell(text);
    }
    is_free
}

/// Edits one object, if it exists and is not locked; all that are not locked, for `None`.
pub(super) fn change(
    state: &mut State,
    which: Option<usize>,
    mut change_it: impl FnMut(&mut Object),
) -> Option<Effect> {
    match which {
        Some(which) if is_free(state, which) => edit_one(state, which, change_it),
        Some(_) => None,
        None => {
            let locked = Arc::clone(&state.locked);
            edit_each(state, |number, object| {
                if !locked.get(number).copied().unwrap_or(false) {
                    change_it(object);
                }
            })
        }
    }
}

/// Projects the textures of the objects that `is_meant` selects as photographs from the present camera.
pub(super) fn take_photographs(
    state: &mut State,
    is_meant: impl Fn(&Object) -> bool,
) -> Option<Effect> {
    let viewpoint = state.viewpoint;
    let shift = if state.can_shift() {
        state.shift
    } else {
        [0.0; 2]
    };
    let Pose { eye, target, up } = viewpoint.pose();
    let fov = ranges::fov(viewpoint.fov).unwrap_or(DEFAULT_FOV);
    let photograph = Photograph {
        eye,
        target,
        up,
        fov,
        shift,
        lens: viewpoint.projection.lens().map(|lens| lens.coefficients()),
    };
    change(state, None, |object| {
        if object.has_texture() && is_meant(object) {
            object.mapping.photograph = Some(photograph);
        }
    })
}

/// Locks or unlocks an object.
pub(super) fn lock(state: &mut State, which: usize, locked: bool) {
    if has(state, which) {
        let locks = Arc::make_mut(&mut state.locked);
        locks.resize(locks.len().max(which + 1), false);
        locks[which] = locked;
    }
}

/// Sets an object's transform, if it is finite and scales no axis to zero.
pub(super) fn set_transform(
    state: &mut State,
    which: usize,
    transform: Transform,
) -> Option<Effect> {
    let is_place = transform.is_finite() && transform.scale.to_array().iter().all(|s| *s != 0.0);
    if !is_place {
        return None;
    }
    change(state, Some(which), |object| object.transform = transform)
}

/// Rotates an object about the centre of its box.
pub(super) fn turn(state: &mut State, which: usize, axis: usize) -> Option<Effect> {
    let Turning { degrees, own, .. } = state.turning;
    let scene = &state.document.as_ref()?.scene;
    let object = scene.objects.get(which)?;
    let mut axis = *DVec3::AXES.get(axis)?;
    if !own && let Some(parent) = object.parent {
        axis = axis_in(&scene.world_from_object(parent).ok()?, axis);
    }
    let middle = object.mesh.bounds().center();
    let transform = turned(&object.transform, axis, own, degrees, middle);
    set_transform(state, which, transform)
}

fn has(state: &State, which: usize) -> bool {
    let document = state.document.as_ref();
    document.is_some_and(|document| which < document.scene.objects.len())
}

fn set_scene(state: &mut State, scene: Arc<Scene>) -> Option<Effect> {
    let count = scene.objects.len();
    let document = state.document.as_mut()?;
    if document.scene.objects.len() != count {
        // Indices now belong to other objects.
        state.picks = Picks::default();
        state.naming = None;
    }
    state.selected = state.selected.filter(|&selected| selected < count);
    let before = Arc::clone(&document.accel);
    if !document.set_scene(scene) {
        return Some(Effect::Build);
    }
    if Arc::ptr_eq(&before, &document.accel) {
        return None;
    }
    state.picks.renew(document);
    state.selected.map(Effect::Weigh)
}

/// Restores the document from a snapshot.
pub(super) fn restore(state: &mut State, to: Snapshot) -> Option<Effect> {
    state.settings = to.settings;
    state.samples = to.samples;
    state.resolution = to.resolution;
    state.shift = to.shift;
    state.locked = to.locked;
    state.measuring.list = to.measurements;
    let before = Arc::clone(&state.document.as_ref()?.scene);
    let number = |old| renumbering::number_after(&before.objects, &to.scene.objects, old);
    state.selected = state.selected.and_then(number);
    if let Some(back) = come_back(&before.objects, &to.scene.objects) {
        state.selected = Some(back);
    }
    let picks = std::mem::take(&mut state.picks);
    let effect = set_scene(state, Arc::clone(&to.scene));
    renumbering::follow_picks(state, picks, number);
    effect
}

/// The first object of the list `after` that is not in the list `before`, if that is shorter: one that a step of the
/// history brings back, before its descendants.
fn come_back(before: &[Object], after: &[Object]) -> Option<usize> {
    let count = after
        .len()
        .checked_sub(before.len())
        .filter(|&count| count > 0)?;
    let key = |object: &Object| (Arc::as_ptr(&object.mesh), object.name.clone());
    let mut here: HashMap<_, usize> = HashMap::new();
    before
        .iter()
        .for_each(|object| *here.entry(key(object)).or_default() += 1);
    let mut new = Vec::with_capacity(count);
    for (number, object) in after.iter().enumerate() {
        match here.get_mut(&key(object)) {
            Some(left) if *left > 0 => *left -= 1,
            _ => new.push(number),
        }
    }
    let is_first = |&&number: &&usize| after[number].parent.is_none_or(|p| !new.contains(&p));
    new.iter().find(is_first).copied()
}

/// The name of the step that gives an object this transform.
pub(super) fn step_to(state: &State, which: usize, to: &Transform) -> Option<&'static str> {
    let from = state.document.as_ref()?.scene.objects.get(which)?.transform;
    let tool = match to {
        _ if to.scale != from.scale => Tool::Scale,
        _ if to.rotate != from.rotate => Tool::Turn,
        _ => Tool::Move,
    };
    Some(tool.name())
}

/// Isolates an object; shows all if it is isolated already.
pub(super) fn isolate(state: &mut State, which: usize) -> Option<Effect> {
    if !has(state, which) {
        return None;
    }
    edit(state, |objects| {
        let is_alone = objects
            .iter()
            .enumerate()
            .all(|(number, object)| object.visible == (number == which));
        for (number, object) in objects.iter_mut().enumerate() {
            object.visible = is_alone || number == which;
        }
    })
}

/// Duplicates an object: the copy is next in the list, and beside it in the scene along x.
pub(super) fn duplicate(state: &mut State, which: usize) -> Option<Effect> {
    let object = state.document.as_ref()?.scene.objects.get(which)?;
    let mut copy = object.clone();
    copy.name = format!("{} copy", object.name);
    copy.visible = true;
    let alone = Scene {
        objects: vec![Object {
            parent: None,
            ..copy.clone()
        }],
    };
    let width = alone.bounds().size().x * 1.1;
    if width.is_finite() {
        copy.transform.translate += DVec3::X * width;
    }
    let place = which + 1;
    if state.locked.len() > place {
        Arc::make_mut(&mut state.locked).insert(place, false);
    }
    let effect = edit(state, |objects| {
        for other in objects.iter_mut() {
            other.parent = other.parent.map(|p| if p >= place { p + 1 } else { p });
        }
        // The copy's parent index dates from before it was inserted.
        copy.parent = copy.parent.map(|p| if p >= place { p + 1 } else { p });
        objects.insert(place, copy);
    });
    state.selected = Some(place);
    effect
}

/// Deletes an object and its descendants.
pub(super) fn delete(state: &mut State, which: usize) -> Option<Effect> {
    if !has(state, which) {
        return None;
    }
    let objects = &state.document.as_ref()?.scene.objects;
    let mut goes = vec![false; objects.len()];
    goes[which] = true;
    // A parent may come after its children in the list: repeat until nothing changes.
    loop {
        let more: Vec<usize> = (0..objects.len())
            .filter(|&i| !goes[i] && objects[i].parent.is_some_and(|p| goes[p]))
            .collect();
        if more.is_empty() {
            break;
        }
        more.into_iter().for_each(|i| goes[i] = true);
    }
    if let Some(locked) = (0..goes.len()).find(|&i| goes[i] && state.is_locked(i)) {
        is_free(state, locked);
        return None;
    }
    let mut left = goes.iter().map(|goes| !goes);
    let locks = Arc::make_mut(&mut state.locked);
    locks.retain(|_| left.next().unwrap_or(true));
    let effect = edit(state, |objects| {
        let mut next = 0;
        let places: Vec<usize> = goes
            .iter()
            .map(|&goes| {
                next += usize::from(!goes);
                next.saturating_sub(1)
            })
            .collect();
        let mut number = 0;
        objects.retain_mut(|object| {
            object.parent = object.parent.map(|parent| places[parent]);
            number += 1;
            !goes[number - 1]
        });
    });
    state.selected = None;
    effect
}
