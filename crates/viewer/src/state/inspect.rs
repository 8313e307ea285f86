//! Checking meshes, and showing their faults.

use super::State;
use super::effect::Effect;
use super::inspection::Shown;
use super::navigate;
use super::viewpoint::Viewpoint;
use raycast_core::glam::DVec3;
use raycast_core::math;
use raycast_core::scene::Bounds;

/// The height of the picture that shows a fault, in sizes of the fault, so that its surroundings are seen.
const AROUND: f64 = 12.0;

/// Degrees between the sides from which a fault is looked at. With wider steps some are missed; with narrower ones more rays
/// are cast, a few hundred with this.
const TURN: f64 = 15.0;

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

/// Highlights a fault and brings it into view, from where nothing is before it, if there is such a side.
pub(super) fn show(state: &mut State, shown: Option<Shown>) {
    state.inspection.shown = shown;
    let Some(corners) = shown.and_then(|shown| corners(state, shown)) else {
        return;
    };
    let bounds = Bounds::around(corners.iter().copied());
    if bounds.is_empty() {
        return;
    }
    let mut to = navigate::destination(state);
    let slope = math::tan(to.fov.to_radians() * 0.5);
    // Within the zoom's limit, and no further away than now.
    let size = bounds.size().length().max(state.extent() * 1e-4);
    to.orbit.pivot = bounds.center();
    to.orbit.distance = (size * AROUND / (2.0 * slope)).min(to.orbit.distance);
    // Of two triangles that intersect, on the first.
    let first = &corners[..corners.len().min(3)];
    let on_it = first.iter().sum::<DVec3>() / first.len() as f64;
    let to = unhidden(state, to, on_it);
    navigate::go(state, to);
}

/// The corners of a fault in the scene.
fn corners(state: &State, shown: Shown) -> Option<Vec<DVec3>> {
    let scene = &state.document.as_ref()?.scene;
    let checked = state.inspection.of(scene, shown.object)?;
    let world_from_object = scene.world_from_object(shown.object).ok()?;
    let corners = checked.corners(shown.fault, shown.index).into_iter();
    let corners = corners.map(|corner| world_from_object.transform_point3(corner));
    Some(corners.collect())
}

/// The viewpoint turned about its pivot as little as it takes to see a point, in steps of [`TURN`]; the same where it is
/// seen from no side.
fn unhidden(state: &mut State, from: Viewpoint, point: DVec3) -> Viewpoint {
    let turned = |yaw: i32, pitch: i32| {
        let mut to = from;
        to.orbit.turn(f64::from(yaw) * TURN, 0.0);
        to.orbit.pitch = f64::from(pitch) * TURN;
        to
    };
    let yaws = (360.0 / TURN) as i32;
    let pitches = (90.0 / TURN) as i32;
    let sides = (-pitches..=pitches).flat_map(|pitch| (0..yaws).map(move |yaw| (yaw, pitch)));
    let mut sides: Vec<Viewpoint> = sides.map(|(yaw, pitch)| turned(yaw, pitch)).collect();
    let turn = |to: &Viewpoint| 1.0 - to.orbit.back().dot(from.orbit.back());
    sides.sort_by(|a, b| turn(a).total_cmp(&turn(b)));
    let own = state.viewpoint;
    let seen = std::iter::once(from).chain(sides).find(|&side| {
        state.viewpoint = side;
        state.hidden(&[point]) == [false]
    });
    state.viewpoint = own;
    seen.unwrap_or(from)
}
