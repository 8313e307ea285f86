//! The triangle that was clicked on, lit up in the picture.

use crate::state::State;
use crate::ui::theme;
use egui::{Color32, Painter, Pos2, Shape, Stroke};
use raycast_core::camera::{Camera, Projection};
use raycast_core::glam::DVec3;

/// Draws it. `place` maps a point of the picture to the window.
pub(super) fn show(painter: &Painter, state: &State, place: impl Fn((f64, f64)) -> Pos2) {
    let (Some(pinned), Some(camera)) = (&state.pinned, state.camera()) else {
        return;
    };
    let accent = theme::of(&egui::Visuals::dark()).accent;
    let outline: Vec<Pos2> = before(&camera, &pinned.corners)
        .into_iter()
        .filter_map(|corner| camera.project(corner))
        .map(&place)
        // Further away than any line can be drawn: it would only overflow.
        .map(|p| p.clamp(Pos2::new(-1e5, -1e5), Pos2::new(1e5, 1e5)))
        .collect();
    if outline.len() >= 3 {
        let fill = accent.gamma_multiply(0.25);
        painter.add(Shape::convex_polygon(outline.clone(), fill, Stroke::NONE));
        // A dark line below a light one is seen on any picture.
        let dark = Stroke::new(3.5, Color32::from_black_alpha(150));
        painter.add(Shape::closed_line(outline.clone(), dark));
        painter.add(Shape::closed_line(outline, Stroke::new(1.5, accent)));
    }
    let seen = before(&camera, &[pinned.pick.point]);
    if let Some(&point) = seen.first()
        && let Some(at) = camera.project(point).map(place)
    {
        painter.circle(at, 3.5, Color32::WHITE, Stroke::new(1.5, Color32::BLACK));
    }
}

/// The part of a polygon that lies before the eye (Sutherland and Hodgman, "Reentrant polygon clipping", 1974).
fn before(camera: &Camera, corners: &[DVec3]) -> Vec<DVec3> {
    if camera.projection() == Projection::Orthographic {
        return corners.to_vec();
    }
    // A thousandth of the way to the target: what is nearer lies far outside of the picture, or fills it.
    let near = camera.distance() * 1e-3;
    let depth = |p: DVec3| (p - camera.placement().eye).dot(camera.forward()) - near;
    let mut kept = Vec::new();
    for (i, &corner) in corners.iter().enumerate() {
        let next = corners[(i + 1) % corners.len()];
        let (here, there) = (depth(corner), depth(next));
        if here >= 0.0 {
            kept.push(corner);
        }
        if (here < 0.0) != (there < 0.0) {
            kept.push(corner + (next - corner) * (here / (here - there)));
        }
    }
    kept
}
