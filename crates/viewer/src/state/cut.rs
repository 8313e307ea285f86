//! Creating and moving clipping planes.

use super::State;
use raycast_core::glam::DVec3;
use raycast_core::scene::{Bounds, CLIPPING_PLANES, ClippingPlane};

/// The position of a new clipping plane. The side of the eye is cut away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaneBy {
    /// Across this axis (0 to 2), through the middle of what is visible.
    Axis(usize),
    /// Across the view, through the pivot.
    View,
    /// Through three points.
    Points([DVec3; 3]),
}

/// Whether another plane can be added.
pub fn has_room(state: &State) -> bool {
    state.document.is_some() && state.settings.clip.all().len() < CLIPPING_PLANES
}

pub(super) fn add(state: &mut State, by: PlaneBy) {
    if !has_room(state) {
        return state.tell(format!(
            "There are {CLIPPING_PLANES} clipping planes already"
        ));
    }
    let viewpoint = &state.viewpoint;
    let back = viewpoint.orbit.back();
    let (point, normal) = match by {
        PlaneBy::Axis(axis) => (state.bounds().center(), DVec3::AXES[axis % 3]),
        PlaneBy::View => (viewpoint.orbit.pivot, back),
        PlaneBy::Points([a, b, c]) => (a, (b - a).cross(c - a).normalize_or_zero()),
    };
    let towards_eye = match by {
        PlaneBy::View => 1.0,
        _ => normal.dot(viewpoint.pose().eye - point),
    };
    let Ok(plane) = ClippingPlane::through(point, normal) else {
        return state.tell("These points lie on a line: no plane is through them alone");
    };
    let plane = match towards_eye > 0.0 {
        true => plane.flipped(),
        false => plane,
    };
    if let Err(error) = state.settings.clip.push(plane) {
        state.tell(error.to_string());
    }
}

/// Adds one of the three points; returns all three once they are complete.
pub(super) fn take(state: &mut State, point: DVec3) -> Option<[DVec3; 3]> {
    let points = state.cutting.as_mut()?;
    points.push(point);
    let all = <[DVec3; 3]>::try_from(&points[..]).ok()?;
    state.cutting = None;
    Some(all)
}

/// Replaces a plane; an invalid one changes nothing.
pub(super) fn set(state: &mut State, index: usize, plane: ClippingPlane) {
    replace(state, |at, old| Some(if at == index { plane } else { old }));
}

pub(super) fn remove(state: &mut State, index: usize) {
    replace(state, |at, old| (at != index).then_some(old));
}

fn replace(state: &mut State, of: impl Fn(usize, ClippingPlane) -> Option<ClippingPlane>) {
    let planes = state.settings.clip.all().iter().enumerate();
    let planes: Vec<_> = planes.filter_map(|(at, &old)| of(at, old)).collect();
    if let Ok(clip) = raycast_core::scene::ClippingPlanes::new(&planes) {
        state.settings.clip = clip;
    }
}

/// A plane's distance from the origin along its unit normal, in scene units.
pub fn distance(plane: &ClippingPlane) -> f64 {
    plane.offset / plane.normal.length()
}

/// The parallel plane at another distance.
pub fn at_distance(plane: &ClippingPlane, distance: f64) -> ClippingPlane {
    ClippingPlane {
        offset: distance * plane.normal.length(),
        ..*plane
    }
}

/// The range of a box along a plane's unit normal.
pub fn range(plane: &ClippingPlane, bounds: &Bounds) -> (f64, f64) {
    let normal = plane.normal.normalize_or_zero();
    let along = bounds.corners().map(|corner| corner.dot(normal));
    let (least, most) = (f64::INFINITY, f64::NEG_INFINITY);
    along.iter().fold((least, most), |(least, most), &at| {
        (least.min(at), most.max(at))
    })
}

/// The intersection of a plane and a box: the corners of a convex polygon in order, or none.
pub fn outline(plane: &ClippingPlane, bounds: &Bounds) -> Vec<DVec3> {
    let normal = plane.normal.normalize_or_zero();
    let corners = bounds.corners();
    let height = corners.map(|corner| corner.dot(normal) - distance(plane));
    let mut points = Vec::new();
    for from in 0..corners.len() {
        // Corners are numbered by bits, one an axis: an edge changes one of them.
        for to in [1, 2, 4].map(|bit| from | bit) {
            let (a, b) = (height[from], height[to]);
            if to != from && (a < 0.0) != (b < 0.0) {
                points.push(corners[from].lerp(corners[to], a / (a - b)));
            }
        }
    }
    let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    let across = normal.any_orthonormal_vector();
    let along = normal.cross(across);
    let angle = |point: &DVec3| {
        let from_middle = *point - middle;
        raycast_core::math::atan2(from_middle.dot(along), from_middle.dot(across))
    };
    points.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_through_a_box_has_an_outline_and_a_range() {
        let bounds = Bounds::around([DVec3::ZERO, DVec3::new(1.0, 2.0, 4.0)]);
        let plane = ClippingPlane::new(DVec3::new(0.0, -2.0, 0.0), -1.0).expect("a plane");
        assert_eq!(
            (distance(&plane), range(&plane, &bounds)),
            (-0.5, (-2.0, 0.0))
        );
        let moved = at_distance(&plane, -1.5);
        assert_eq!((moved.offset, moved.normal), (-3.0, plane.normal));
        let outline = outline(&plane, &bounds);
        assert_eq!(outline.len(), 4);
        assert!(outline.iter().all(|point| point.y == 0.5));
        // In order: each differs from the next along one axis.
        let sides = outline.iter().zip(outline.iter().cycle().skip(1));
        let around: f64 = sides.map(|(a, b)| a.distance(*b)).sum();
        assert!((around - 10.0).abs() < 1e-12, "{around}");
        let diagonal = ClippingPlane::new(DVec3::new(4.0, 2.0, 1.0), 6.0).expect("a plane");
        assert_eq!(super::outline(&diagonal, &bounds).len(), 6);
        let beside = ClippingPlane::new(DVec3::X, 3.0).expect("a plane");
        assert!(super::outline(&beside, &bounds).is_empty());
    }
}
