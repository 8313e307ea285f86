//! Checking meshes, and showing their faults.

use super::State;
use super::effect::Effect;
use super::inspection::Shown;
use super::navigate;
use raycast_core::glam::DVec3;
use raycast_core::math;
use raycast_core::scene::Bounds;

/// The height of the picture that shows a fault, in sizes of the fault, so that its surroundings are seen.
const AROUND: f64 = 12.0;

/// Checks the selected object, or all if none is selected.
pub(super) fn check(state: &mut State, deep: bool) -> Option<Effect> {
    let count = state.document.as_ref()?.scene.objects.len();
    let objects: Vec<usize> = match state.selected {
        Some(marked) => vec![marked],
        None => (0..count).collect(),
    };
    state.inspection.shown = None;
    (!objects.is_empty()).then_some(Effect::Check { objects, deep })
}

/// Highlights a fault and brings it into view.
pub(super) fn show(state: &mut State, shown: Option<Shown>) {
    state.inspection.shown = shown;
    let Some((middle, size)) = shown.and_then(|shown| around(state, shown)) else {
        return;
    };
    let mut to = navigate::destination(state);
    let slope = math::tan(to.fov.to_radians() * 0.5);
    // Within the zoom's limit, and no further away than now.
    let nearest = state.extent() * 1e-4;
    let distance = (size.max(nearest) * AROUND / (2.0 * slope)).min(to.orbit.distance);
    to.orbit.pivot = middle;
    to.orbit.distance = distance;
    navigate::go(state, to);
}

/// The centre of a fault in the scene, and its size.
fn around(state: &State, shown: Shown) -> Option<(DVec3, f64)> {
    let scene = &state.document.as_ref()?.scene;
    let checked = state.inspection.of(scene, shown.object)?;
    let world_from_object = scene.world_from_object(shown.object).ok()?;
    let corners = checked.corners(shown.fault, shown.index).into_iter();
    let bounds = Bounds::around(corners.map(|corner| world_from_object.transform_point3(corner)));
    (!bounds.is_empty()).then(|| (bounds.center(), bounds.size().length()))
}
