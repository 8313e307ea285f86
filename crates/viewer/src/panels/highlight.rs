//! The picked triangles, and the box of the selected object, highlighted in the picture.

use crate::state::State;
use crate::state::pick::Pinned;
use crate::ui::theme;
use egui::{Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, vec2};
use raycast_core::camera::Camera;
use raycast_core::glam::DVec3;

/// Draws it. `place` maps a point of the picture to the window.
pub(super) fn show(painter: &Painter, state: &State, place: impl Fn((f64, f64)) -> Pos2) {
    let Some(camera) = state.camera() else {
        return;
    };
    let accent = theme::of(&egui::Visuals::dark()).accent;
    box_of_marked(painter, state, &camera, accent, &place);
    let picks = state.picks.list();
    let current = state.picks.current_index();
    // The current one comes last, over the others.
    let others = (0..picks.len()).filter(|index| *index != current);
    for index in others.chain([current]) {
        let Some(pinned) = picks.get(index) else {
            return;
        };
        let color = match index == current {
            true => accent,
            false => accent.gamma_multiply(0.6),
        };
        triangle(painter, &camera, pinned, color, &place);
        let seen = before(&camera, &[pinned.pick.point]);
        if let Some(&point) = seen.first()
            && let Some(at) = camera.project(point).map(&place)
        {
            painter.circle(at, 3.5, Color32::WHITE, Stroke::new(1.5, Color32::BLACK));
            if picks.len() > 1 {
                number(painter, at, index + 1);
            }
        }
    }
}

fn triangle(
    painter: &Painter,
    camera: &Camera,
    pinned: &Pinned,
    color: Color32,
    place: impl Fn((f64, f64)) -> Pos2,
) {
    let outline: Vec<Pos2> = before(camera, &pinned.corners)
        .into_iter()
        .filter_map(|corner| camera.project(corner))
        .map(place)
        .map(bounded)
        .collect();
    if outline.len() >= 3 {
        let fill = color.gamma_multiply(0.25);
        painter.add(Shape::convex_polygon(outline.clone(), fill, Stroke::NONE));
        // A dark line below a light one is visible on any picture.
        let dark = Stroke::new(3.5, Color32::from_black_alpha(150));
        painter.add(Shape::closed_line(outline.clone(), dark));
        painter.add(Shape::closed_line(outline, Stroke::new(1.5, color)));
    }
}

/// A pick's number in the list, beside it.
fn number(painter: &Painter, at: Pos2, number: usize) {
    let font = FontId::proportional(12.0);
    let words = painter.layout_no_wrap(number.to_string(), font, Color32::WHITE);
    let corner = at + vec2(7.0, -7.0 - words.size().y);
    let ground = Rect::from_min_size(corner, words.size()).expand2(vec2(4.0, 1.0));
    painter.rect_filled(ground, 4.0, Color32::from_black_alpha(190));
    painter.galley(corner, words, Color32::WHITE);
}

/// The box of the marked object where it is put, which is seen at once: its picture comes when its tree is built.
fn box_of_marked(
    painter: &Painter,
    state: &State,
    camera: &Camera,
    accent: Color32,
    place: impl Fn((f64, f64)) -> Pos2,
) {
    let found = state.selected.zip(state.document.as_ref());
    let Some((object, world_from_object)) = found.and_then(|(number, document)| {
        let object = document.scene.objects.get(number)?;
        let world_from_object = document.scene.world_from_object(number).ok()?;
        Some((object, world_from_object))
    }) else {
        return;
    };
    let bounds = object.mesh.bounds();
    // It would cover what is being measured or inspected.
    let is_in_the_way = state.measuring.tool.is_some() || state.inspection.shown.is_some();
    if bounds.is_empty() || !object.visible || is_in_the_way {
        return;
    }
    let corners = bounds
        .corners()
        .map(|c| world_from_object.transform_point3(c));
    for (i, &from) in corners.iter().enumerate() {
        // Corners are numbered by bits, one an axis: an edge changes one of them.
        for to in [1, 2, 4]
            .map(|bit| i | bit)
            .into_iter()
            .filter(|&to| to != i)
        {
            line(
                painter,
                camera,
                [from, corners[to]],
                &place,
                accent.gamma_multiply(0.8),
                1.0,
            );
        }
    }
}

/// A line between two points of the scene, dark around so that it is seen on any picture.
pub(super) fn line(
    painter: &Painter,
    camera: &Camera,
    ends: [DVec3; 2],
    place: impl Fn((f64, f64)) -> Pos2,
    color: Color32,
    width: f32,
) {
    let seen = before(camera, &ends);
    let ends = seen
        .iter()
        .filter_map(|&end| camera.project(end))
        .map(place);
    let ends: Vec<Pos2> = ends.map(bounded).collect();
    if let [a, b, ..] = ends[..] {
        let dark = Color32::from_black_alpha(110);
        painter.line_segment([a, b], Stroke::new(width + 1.5, dark));
        painter.line_segment([a, b], Stroke::new(width, color));
    }
}

/// Points beyond any line that can be drawn would overflow.
fn bounded(point: Pos2) -> Pos2 {
    point.clamp(Pos2::new(-1e5, -1e5), Pos2::new(1e5, 1e5))
}

/// Whether the sides of a polygon are short enough in a panorama to be drawn straight, and none goes round its seam: a
/// radian at the most.
fn is_short(camera: &Camera, corners: &[DVec3]) -> bool {
    let radian = camera.distance() / camera.plane().step;
    let places: Option<Vec<_>> = corners.iter().map(|&c| camera.project(c)).collect();
    places.is_some_and(|places| {
        (0..places.len()).all(|i| {
            let (a, b) = (places[i], places[(i + 1) % places.len()]);
            (a.0 - b.0).abs().max((a.1 - b.1).abs()) <= radian
        })
    })
}

/// The part of a polygon that lies before the eye (Sutherland and Hodgman, "Reentrant polygon clipping", 1974).
pub(super) fn before(camera: &Camera, corners: &[DVec3]) -> Vec<DVec3> {
    if camera.projection().is_parallel() {
        return corners.to_vec();
    }
    if camera.projection().panorama().is_some() {
        return if is_short(camera, corners) {
            corners.to_vec()
        } else {
            Vec::new()
        };
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
