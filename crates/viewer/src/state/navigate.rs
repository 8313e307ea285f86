//! Navigation: moving the camera.

use super::State;
use super::motion::Motion;
use super::viewpoint::{StandardView, Viewpoint};
use raycast_core::camera::{Orbit, Pose, Projection, Ray};
use raycast_core::glam::DVec3;
use raycast_core::math;

/// The greatest distance that navigation goes to, in sizes of the scene, so that a scene is not lost from view. A
/// file's camera may be further away.
const FURTHEST: f64 = 12.0;

/// The new distance over the old after a notch of the wheel.
pub const ZOOM: f64 = 0.85;

/// Called before the camera is moved by hand: a smooth change ends where it is, and the viewpoint goes into the
/// history.
pub(super) fn leave(state: &mut State) {
    state.motion = None;
    state.trail.leave(state.viewpoint, state.now, true);
}

/// Goes to another view, smoothly if preferred.
pub(super) fn go(state: &mut State, to: Viewpoint) {
    if !to.orbit.pivot.is_finite() {
        return;
    }
    let from = state.viewpoint;
    state.trail.leave(from, state.now, false);
    travel(state, to);
}

fn travel(state: &mut State, to: Viewpoint) {
    if state.preferences.smooth && state.document.is_some() && state.viewpoint != to {
        state.motion = Some(Motion::new(state.viewpoint, to, state.now));
    } else {
        state.motion = None;
        state.viewpoint = to;
    }
}

/// Advances a smooth change of view; returns whether it goes on.
pub(super) fn advance(state: &mut State) -> bool {
    let Some(motion) = state.motion else {
        return false;
    };
    let (viewpoint, is_over) = motion.at(state.now);
    state.viewpoint = viewpoint;
    if is_over {
        state.motion = None;
    }
    !is_over
}

/// The camera's viewpoint, or the one that it is moving to.
pub(super) fn destination(state: &State) -> Viewpoint {
    state.motion.map_or(state.viewpoint, |motion| motion.end())
}

/// Fits the scene, seen from the same direction.
pub(super) fn fit(state: &mut State) {
    go(state, state.fitted(destination(state)));
}

/// Goes to a standard view.
pub(super) fn look(state: &mut State, view: StandardView) {
    go(state, destination(state).turned_to(view.angles()));
}

/// Goes to the opposite side of the pivot.
pub(super) fn look_back(state: &mut State) {
    let here = destination(state);
    go(
        state,
        here.turned_to((here.orbit.yaw + 180.0, -here.orbit.pitch)),
    );
}

/// Looks from an eye at a target; does nothing where they coincide.
pub(super) fn place(state: &mut State, eye: DVec3, target: DVec3) {
    let pose = Pose::towards(eye, target);
    if pose.check().is_ok() {
        leave(state);
        let here = state.viewpoint;
        state.viewpoint = Viewpoint {
            orbit: Orbit::from_placement(&pose),
            ..here
        };
    }
}

/// Sets the projection. Between planar projections the picture at the pivot stays; a panorama starts with its default
/// field of view.
pub(super) fn set_projection(state: &mut State, projection: Projection) {
    let viewpoint = &mut state.viewpoint;
    if viewpoint.projection.panorama() != projection.panorama() {
        viewpoint.fov = projection.default_fov();
    }
    viewpoint.projection = projection;
}

/// The first, the least and the greatest walking speed, in sizes of the scene a second.
const WALK: f64 = 0.25;
const WALK_RANGE: (f64, f64) = (1e-3, 10.0);

/// Starts or stops walking. An orthographic projection becomes perspective: moving forward would not change its
/// picture.
pub(super) fn set_walk(state: &mut State, on: bool) {
    state.walk = on.then_some(WALK);
    if on {
        leave(state);
        if state.viewpoint.projection.is_parallel() {
            state.viewpoint.projection = Projection::Perspective;
        }
    }
}

/// Multiplies the walking speed.
pub(super) fn scale_walk(state: &mut State, factor: f64) {
    if let Some(speed) = &mut state.walk
        && factor.is_finite()
    {
        *speed = (*speed * factor).clamp(WALK_RANGE.0, WALK_RANGE.1);
    }
}

/// Walks for one frame: to the right, up in the picture and forwards.
pub(super) fn walk(state: &mut State, way: DVec3, seconds: f64) {
    let (Some(speed), true) = (state.walk, way.is_finite() && seconds.is_finite()) else {
        return;
    };
    leave(state);
    let length = speed * state.extent() * seconds;
    let viewpoint = &mut state.viewpoint;
    let (right, up, back) = (viewpoint.right(), viewpoint.up(), viewpoint.orbit.back());
    viewpoint.orbit.pivot += (right * way.x + up * way.y - back * way.z) * length;
}

/// Turns the view about the eye: the pivot moves around it.
pub(super) fn look_around(state: &mut State, yaw: f64, pitch: f64) {
    leave(state);
    let orbit = &mut state.viewpoint.orbit;
    let eye = orbit.pivot + orbit.back() * orbit.distance;
    orbit.turn(-yaw, -pitch);
    orbit.pivot = eye - orbit.back() * orbit.distance;
}

/// Rolls the camera.
pub(super) fn roll(state: &mut State, degrees: f64) {
    if degrees.is_finite() {
        let mut to = destination(state);
        to.roll = (to.roll + degrees + 180.0).rem_euclid(360.0) - 180.0;
        go(state, to);
    }
}

/// Goes back in the camera's history.
pub(super) fn back(state: &mut State) {
    let here = destination(state);
    if let Some(there) = state.trail.back(here) {
        travel(state, there);
    }
}

/// Goes forward in the camera's history.
pub(super) fn forward(state: &mut State) {
    let here = destination(state);
    if let Some(there) = state.trail.forward(here) {
        travel(state, there);
    }
}

pub(super) fn grab(state: &mut State, at: (f64, f64)) {
    let Some(camera) = state.camera() else {
        return;
    };
    state.grabbed_depth = match state.pick(at.0, at.1) {
        Some(pick) => {
            let sight = pick.point - camera.pose().eye;
            match camera.projection() {
                Projection::Panoramic(_) => sight.length(),
                _ => sight.dot(camera.forward()),
            }
        }
        None => camera.distance(),
    };
}

pub(super) fn pan(state: &mut State, dx: f64, dy: f64) {
    let Some(camera) = state.camera() else {
        return;
    };
    let scale = match camera.projection() {
        Projection::Orthographic => 1.0,
        // The step is measured at the target; the grabbed point may be nearer or farther.
        _ => state.grabbed_depth / camera.distance(),
    } * camera.plane().step;
    if scale.is_finite() && dx.is_finite() && dy.is_finite() {
        let viewpoint = &mut state.viewpoint;
        let (right, up) = (viewpoint.right(), viewpoint.up());
        viewpoint.orbit.pivot += right * (-dx * scale) + up * (dy * scale);
    }
}

pub(super) fn zoom(state: &mut State, at: (f64, f64), factor: f64) {
    let Some(camera) = state.camera() else {
        return;
    };
    let extent = state.extent();
    let distance = state.viewpoint.orbit.distance;
    let slope = state.viewpoint.slope();
    // The limit applies to the frame's height: with a narrow field of view the eye is far away.
    let furthest = (FURTHEST * extent / (2.0 * slope)).max(distance);
    let factor = (distance * factor).clamp((extent * 1e-5).min(furthest), furthest) / distance;
    if !factor.is_normal() {
        return;
    }
    let ray = camera.ray(at.0, at.1);
    let on_target_plane = |ray: &Ray| {
        let depth = (state.viewpoint.orbit.pivot - ray.origin).dot(camera.forward());
        ray.at(depth / ray.direction.dot(camera.forward()))
    };
    let anchor = match (camera.projection(), state.pick(at.0, at.1)) {
        (Projection::Perspective | Projection::Panoramic(_), Some(pick)) => pick.point,
        (Projection::Panoramic(_), None) => state.viewpoint.orbit.pivot,
        _ => on_target_plane(&ray),
    };
    state.viewpoint.orbit.dolly(factor, anchor);
}

/// The way of a notch of the wheel through surfaces, in seconds of walking.
const PUSH: f64 = 0.1;

/// Moves the eye along the ray at a place by steps of the same length, so that it passes surfaces, which zooming only
/// comes nearer to. The picture of parallel rays would stay: there it zooms.
pub(super) fn push(state: &mut State, at: (f64, f64), notches: f64) {
    let Some(camera) = state.camera() else {
        return;
    };
    if camera.projection().is_parallel() {
        return zoom(state, at, math::pow(ZOOM, notches));
    }
    let speed = state.walk.unwrap_or(WALK);
    let step = camera.ray(at.0, at.1).direction * (notches * PUSH * speed * state.extent());
    if step.is_finite() {
        state.viewpoint.orbit.pivot += step;
    }
}

pub(super) fn set_pivot(state: &mut State, at: (f64, f64)) {
    let (Some(camera), Some(pick)) = (state.camera(), state.pick(at.0, at.1)) else {
        return;
    };
    state.viewpoint.orbit.pivot = pick.point;
    if !camera.projection().is_parallel() {
        // The eye keeps its depth from the point, so that it does not grow or shrink.
        let depth = (pick.point - camera.pose().eye).dot(camera.forward());
        if depth.is_normal() && depth > 0.0 {
            state.viewpoint.orbit.distance = depth;
        }
    }
}
