//! Parents of objects.

use super::State;
use super::effect::Effect;
use super::objects;
use super::turn::angles;
use raycast_core::glam::{DAffine3, DMat3, DVec3};
use raycast_core::scene::{Object, Transform};

/// Sets or removes an object's parent. The object keeps its place in the scene, except for angles rounded to 10⁻⁹
/// degrees.
///
/// Refused with a message where this would make a cycle, or where the parent is scaled to nothing along an axis: then
/// no transform of the child gives its present place.
pub(super) fn set(state: &mut State, which: usize, parent: Option<usize>) -> Option<Effect> {
    let objects = &state.document.as_ref()?.scene.objects;
    let object = objects.get(which)?;
    if object.parent == parent || parent.is_some_and(|parent| parent >= objects.len()) {
        return None;
    }
    if let Some(parent) = parent
        && moves_with(objects, parent, which)
    {
        let text = match parent == which {
            true => format!("{} cannot move with itself", object.name),
            false => format!("{} moves with {}", objects[parent].name, object.name),
        };
        state.tell(text);
        return None;
    }
    if !objects::is_free(state, which) {
        return None;
    }
    let document = state.document.as_ref()?;
    let objects = &document.scene.objects;
    let world_from_object = document.scene.world_from_object(which).ok()?;
    let world_from_parent = match parent {
        Some(parent) => document.scene.world_from_object(parent).ok()?,
        None => DAffine3::IDENTITY,
    };
    let transform = match world_from_parent == DAffine3::IDENTITY {
        true => within(world_from_object, &objects[which]),
        false => {
            let parent_from_world = world_from_parent.inverse();
            within(parent_from_world * world_from_object, &objects[which])
        }
    };
    if !transform.is_finite() {
        let name = parent.map_or("", |parent| &objects[parent].name);
        let text = format!("{name} is flat: nothing can move with it and stay where it is");
        state.tell(text);
        return None;
    }
    objects::edit_one(state, which, |object| {
        object.parent = parent;
        object.transform = transform;
    })
}

/// Whether an object is `ancestor` or one of its descendants.
pub fn moves_with(objects: &[Object], which: usize, ancestor: usize) -> bool {
    let mut next = Some(which);
    // At most as many steps as there are objects: a file may have a cycle.
    for _ in 0..=objects.len() {
        match next {
            Some(object) if object == ancestor => return true,
            Some(object) => next = objects.get(object).and_then(|object| object.parent),
            None => return false,
        }
    }
    false
}

/// The transform that gives an object this placement. Where a translation, rotation and scale can express it they are
/// used, and not a matrix: these are the numbers that a person edits.
fn within(parent_from_object: DAffine3, object: &Object) -> Transform {
    let now = object.transform.parent_from_object();
    if now.matrix3 == parent_from_object.matrix3 {
        let way = parent_from_object.translation - now.translation;
        return Transform {
            translate: object.transform.translate + way,
            ..object.transform
        };
    }
    let matrix = object.transform.matrix;
    let placed = match matrix == DAffine3::IDENTITY {
        true => parent_from_object,
        false => parent_from_object * matrix.inverse(),
    };
    match without_shear(placed.matrix3) {
        Some((rotate, scale)) => Transform {
            translate: placed.translation,
            rotate,
            scale,
            matrix,
        },
        None => Transform::from_matrix(parent_from_object),
    }
}

/// The rotation and scale of a map; `None` if it has a shear.
fn without_shear(map: DMat3) -> Option<(DVec3, DVec3)> {
    let columns = [map.x_axis, map.y_axis, map.z_axis];
    let mut scale = DVec3::from_array(columns.map(DVec3::length));
    let [x, y, z] = columns.map(DVec3::normalize_or_zero);
    // A product of matrices rounds each entry some ten times: right angles are off by as many 2⁻⁵².
    let is_right = |cosine: f64| cosine.abs() <= 64.0 * f64::EPSILON;
    let is_made_of = is_right(x.dot(y)) && is_right(y.dot(z)) && is_right(z.dot(x));
    let mut rotation = DMat3::from_cols(x, y, z);
    if rotation.determinant() < 0.0 {
        rotation.x_axis = -x;
        scale.x = -scale.x;
    }
    (is_made_of && scale.is_finite() && scale.min_element() != 0.0)
        .then(|| (angles(rotation), scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_and_factors_are_found_where_there_is_no_shear() {
        let transform = Transform {
            rotate: DVec3::new(20.0, -30.0, 70.0),
            scale: DVec3::new(-2.0, 0.5, 3.0),
            ..Transform::IDENTITY
        };
        let map = transform.parent_from_object().matrix3;
        let (rotate, scale) = without_shear(map).expect("no shear");
        let again = Transform {
            rotate,
            scale,
            ..Transform::IDENTITY
        };
        let again = again.parent_from_object().matrix3;
        assert!((again.x_axis - map.x_axis).length() < 1e-10);
        assert!((again.z_axis - map.z_axis).length() < 1e-10);
        let sheared = DMat3::from_cols(DVec3::X, DVec3::new(0.1, 1.0, 0.0), DVec3::Z);
        assert_eq!(without_shear(sheared), None);
        assert_eq!(without_shear(DMat3::ZERO), None);
    }
}
