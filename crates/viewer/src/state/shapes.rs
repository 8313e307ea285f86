//! Adding shapes, and changing their parameters.

use super::State;
use super::effect::Effect;
use super::objects;
use raycast_core::glam::DVec3;
use raycast_core::scene::{Mesh, Object, Shape};
use std::sync::Arc;

/// The most triangles of a shape that is made here, between two frames. More would make a frame wait: `raycast info`
/// takes 0.4 µs of processor time a triangle for a sphere of 4 M and its tree, so these take 6 ms at most. Scene files
/// may have more.
const MOST_TRIANGLES: u64 = 1 << 14;

/// Adds a shape at the pivot, last in the list, of a round size near a tenth of the scene's.
pub(super) fn add(state: &mut State, shape: Shape) -> Option<Effect> {
    let mesh = mesh(state, &shape)?;
    let objects = &state.document.as_ref()?.scene.objects;
    let is_taken = |name: &str| objects.iter().any(|object| object.name == name);
    let numbered = (2..).map(|number| format!("{} {number}", shape.name()));
    let name = std::iter::once(shape.name().to_owned())
        .chain(numbered)
        .find(|name| !is_taken(name))?;
    let mut object = Object::new(name, mesh);
    object.shape = Some(shape);
    object.transform.translate = state.viewpoint.orbit.pivot;
    object.transform.scale = DVec3::splat(round(state.extent() * 0.1));
    let place = objects.len();
    let effect = objects::edit(state, |objects| objects.push(object));
    state.selected = Some(place);
    effect
}

/// Changes the parameters of an object that is a shape.
pub(super) fn set(state: &mut State, which: usize, shape: Shape) -> Option<Effect> {
    let object = state.document.as_ref()?.scene.objects.get(which)?;
    object.shape?;
    if !objects::is_free(state, which) {
        return None;
    }
    let mesh = mesh(state, &shape)?;
    objects::edit_one(state, which, |object| {
        object.shape = Some(shape);
        object.mesh = mesh;
    })
}

/// Its mesh; `None`, with a message, if it has too many triangles.
fn mesh(state: &mut State, shape: &Shape) -> Option<Arc<Mesh>> {
    if shape.check().is_ok() && shape.triangles() > MOST_TRIANGLES {
        state.tell("More triangles than a shape is given here: a scene file can");
        return None;
    }
    let mesh = shape.mesh().ok()?;
    Some(Arc::new(Mesh::new(mesh)))
}

/// The greatest of …, 0.1, 0.2, 0.5, 1, … that is not above a length.
fn round(length: f64) -> f64 {
    if !length.is_normal() || length < 0.0 {
        return 1.0;
    }
    let mut power = 1.0;
    while power > length {
        power *= 0.1;
    }
    while power * 10.0 <= length {
        power *= 10.0;
    }
    let digit = [5.0, 2.0].into_iter().find(|d| d * power <= length);
    digit.unwrap_or(1.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shape_is_made_and_small_enough() {
        for shape in Shape::ALL {
            assert_eq!(shape.check(), Ok(()));
            assert!(shape.triangles() <= MOST_TRIANGLES);
        }
    }

    #[test]
    fn sizes_are_round_and_no_larger() {
        for (length, rounded) in [
            (1.0, 1.0),
            (0.37, 0.2),
            (7.0, 5.0),
            (0.0021, 0.002),
            (999.0, 500.0),
            (0.0, 1.0),
            (f64::INFINITY, 1.0),
        ] {
            let found = round(length);
            assert!((found - rounded).abs() < 1e-9, "{length}: {found}");
        }
    }
}
