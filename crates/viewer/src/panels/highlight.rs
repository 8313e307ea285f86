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
    let mut edges = Vec::new();
    for (i, &from) in corners.iter().enumerate() {
        // Corners are numbered by bits, one an axis: an edge changes one of them.
        let others = [1, 2, 4].map(|bit| i | bit);
        for to in others.into_iter().filter(|&to| to != i) {
            if let [from, to, ..] = before(camera, &[from, corners[to]])[..] {
                edges.push([from, to]);
            }
        }
    }
    let parts = parts(state, camera, &edges);
    // What is seen comes last, over what is not.
    for (ends, _) in parts.iter().filter(|part| part.1) {
        faint_line(painter, camera, *ends, &place, accent);
    }
    for (ends, _) in parts.iter().filter(|part| !part.1) {
        let color = accent.gamma_multiply(0.8);
        line(painter, camera, *ends, &place, color, 1.0);
    }
}

/// Pixels of an edge for each test whether it is hidden: shorter steps are not noticed on a thin line.
const STEP: f64 = 6.0;
/// The most tests of an edge: the box's twelve edges then take 576 rays a frame.
const MOST_STEPS: f64 = 48.0;

/// Lines before the eye, cut where they go behind something or come out again; whether each part is hidden.
fn parts(state: &State, camera: &Camera, lines: &[[DVec3; 2]]) -> Vec<([DVec3; 2], bool)> {
    let count = |[from, to]: [DVec3; 2]| {
        let (a, b) = camera.project(from).zip(camera.project(to))?;
        let (across, down) = (a.0 - b.0, a.1 - b.1);
        let steps = ((across * across + down * down).sqrt() / STEP).ceil();
        Some(steps.clamp(1.0, MOST_STEPS) as usize)
    };
    let counts = lines.iter().map(|&line| count(line).unwrap_or(0));
    let counts: Vec<usize> = counts.collect();
    let at = |line: usize, step: f64| {
        let [from, to] = lines[line];
        from.lerp(to, step / counts[line] as f64)
    };
    let steps = counts.iter().enumerate();
    let middles = steps.flat_map(|(line, &count)| (0..count).map(move |step| (line, step)));
    let middles: Vec<DVec3> = middles
        .map(|(line, step)| at(line, step as f64 + 0.5))
        .collect();
    let mut hidden = &state.hidden(&middles)[..];
    let mut parts = Vec::new();
    for (line, &count) in counts.iter().enumerate() {
        let (own, rest) = hidden.split_at(count);
        hidden = rest;
        let mut start = 0;
        for run in own.chunk_by(|a, b| a == b) {
            let end = start + run.len();
            parts.push(([at(line, start as f64), at(line, end as f64)], run[0]));
            start = end;
        }
    }
    parts
}

/// A line that something hides.
fn faint_line(
    painter: &Painter,
    camera: &Camera,
    ends: [DVec3; 2],
    place: impl Fn((f64, f64)) -> Pos2,
    color: Color32,
) {
    let ends = ends.map(|end| camera.project(end).map(&place).map(bounded));
    if let [Some(a), Some(b)] = ends {
        painter.line_segment([a, b], Stroke::new(1.0, color.gamma_multiply(0.3)));
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
    let depth = |p: DVec3| (p - camera.pose().eye).dot(camera.forward()) - near;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::arrival::Loaded;
    use crate::state::command::Command;
    use crate::state::document::{Document, Tree};
    use crate::state::news::{News, receive};
    use crate::state::update::update;
    use crate::state::viewpoint::StandardView;
    use raycast_core::Accel;
    use raycast_core::scene::{Mesh, MeshData, Object, Scene};
    use std::sync::Arc;
    use std::time::Duration;

    #[test]
    fn a_line_is_cut_where_it_goes_behind_a_surface() {
        let mesh = Mesh::new(MeshData {
            positions: [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(|[x, y]| DVec3::new(x, y, 0.0))
                .to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..MeshData::default()
        });
        let scene = Arc::new(Scene {
            objects: vec![Object::new("screen", Arc::new(mesh))],
        });
        let tree = Tree {
            accel: Arc::new(Accel::build(&scene).expect("a scene")),
            bounds: scene.bounds(),
            build_time: Duration::ZERO,
        };
        let mut state = State::default();
        state.preferences.smooth = false;
        let loaded = Loaded::new(Document::new(1, "screen", scene, tree));
        receive(&mut state, News::Loaded(Box::new(loaded)), Duration::ZERO);
        for command in [Command::Look(StandardView::Front), Command::Fit] {
            update(&mut state, command);
        }
        state.viewpoint.projection = raycast_core::camera::Projection::Orthographic;
        let camera = state.camera().expect("a camera");
        let line = |z: f64| [DVec3::new(-2.0, 0.1, z), DVec3::new(2.0, 0.1, z)];
        let hidden: Vec<bool> = parts(&state, &camera, &[line(-1.0)])
            .iter()
            .map(|part| part.1)
            .collect();
        assert_eq!(hidden, [false, true, false]);
        let behind = parts(&state, &camera, &[line(-1.0)])[1].0;
        // To a step of the line, which is 4 long.
        for (found, expected) in behind.map(|end| end.x).into_iter().zip([-1.0, 1.0]) {
            assert!((found - expected).abs() < 4.0 / MOST_STEPS, "{found}");
        }
        // Before it, and upon it.
        for z in [1.0, 0.0] {
            assert_eq!(parts(&state, &camera, &[line(z)]), [(line(z), false)]);
        }
    }
}
