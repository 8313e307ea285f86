//! Measurements and faults of meshes, drawn over the picture.

use super::highlight::{before, line};
use super::measure::text;
use crate::state::State;
use crate::state::lengths::Lengths;
use crate::state::measure::{Circle, Kind, Measurement};
use crate::ui::theme;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, Vec2, vec2};
use raycast_core::camera::Camera;
use raycast_core::glam::DVec3;
use raycast_core::math;
use std::cell::RefCell;

/// The most faults of a kind that are drawn: more would hide the mesh, and take longer than a frame.
const MOST_FAULTS: usize = 1000;
/// Sides of the polygon that a circle is drawn as.
const SIDES: u32 = 64;

/// The painter, and the map from the scene to the window.
struct Pen<'a, P> {
    painter: &'a Painter,
    camera: &'a Camera,
    place: P,
    /// Labels, and the points that they are for: they lie over all lines.
    labels: RefCell<Vec<(Pos2, String)>>,
}

impl<P: Fn((f64, f64)) -> Pos2> Pen<'_, P> {
    fn at(&self, point: DVec3) -> Option<Pos2> {
        let seen = before(self.camera, &[point]);
        let at = self.camera.project(*seen.first()?)?;
        Some((self.place)(at))
    }

    fn line(&self, ends: [DVec3; 2], color: Color32, width: f32) {
        line(self.painter, self.camera, ends, &self.place, color, width);
    }

    fn dot(&self, point: DVec3, color: Color32, radius: f32) {
        if let Some(at) = self.at(point) {
            let around = Stroke::new(1.0, Color32::BLACK);
            self.painter.circle(at, radius, color, around);
        }
    }

    /// Text above a point.
    fn label(&self, point: DVec3, words: String) {
        if let Some(at) = self.at(point) {
            self.labels.borrow_mut().push((at, words));
        }
    }

    /// Draws the labels beside one another, on a dark background, so that they are readable on any picture.
    fn draw_labels(&self) {
        let room = self.painter.clip_rect();
        let mut taken = Vec::new();
        for (at, words) in self.labels.take() {
            let font = FontId::proportional(13.0);
            let words = self.painter.layout_no_wrap(words, font, Color32::WHITE);
            let size = words.size() + vec2(10.0, 4.0);
            let rect = Rect::from_center_size(at - vec2(0.0, 14.0), size);
            let rect = free(rect, room, &taken);
            taken.push(rect);
            let background = Color32::from_black_alpha(190);
            self.painter.rect_filled(rect, 4.0, background);
            let corner = Align2::CENTER_CENTER
                .align_size_within_rect(words.size(), rect)
                .min;
            self.painter.galley(corner, words, Color32::WHITE);
        }
    }
}

/// A label moved into a room, and as little as needed up or down so that it covers none of those already placed; not
/// moved up or down where there is no room.
fn free(label: Rect, room: Rect, taken: &[Rect]) -> Rect {
    let inside = |rect: Rect| {
        let low = (room.min - rect.min).max(Vec2::ZERO);
        let high = (room.max - rect.max).min(Vec2::ZERO);
        rect.translate(low + high)
    };
    let is_free = |rect: &Rect| {
        let covers = |other: &Rect| other.expand(1.0).intersects(*rect);
        room.contains_rect(*rect) && !taken.iter().any(covers)
    };
    let label = inside(label);
    // Above and below each of the others.
    let beside = taken.iter().flat_map(|other| {
        let above = other.min.y - label.max.y - 2.0;
        let below = other.max.y - label.min.y + 2.0;
        [above, below]
    });
    let mut moves: Vec<f32> = std::iter::once(0.0).chain(beside).collect();
    moves.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let mut places = moves
        .into_iter()
        .map(|down| label.translate(vec2(0.0, down)));
    places.find(is_free).unwrap_or(label)
}

/// Draws them. `place` maps a point of the picture to the window.
pub(super) fn show(painter: &Painter, state: &State, place: impl Fn((f64, f64)) -> Pos2) {
    let Some(camera) = &state.camera() else {
        return;
    };
    let pen = Pen {
        painter,
        camera,
        place,
        labels: RefCell::default(),
    };
    faults(&pen, state);
    let accent = theme::of(&egui::Visuals::dark()).accent;
    let lengths = state.lengths();
    for measurement in &*state.measuring.list {
        measured(&pen, measurement, &lengths, accent);
    }
    under_way(&pen, state);
    pen.draw_labels();
}

fn measured<P: Fn((f64, f64)) -> Pos2>(
    pen: &Pen<'_, P>,
    of: &Measurement,
    lengths: &Lengths,
    color: Color32,
) {
    let points = &of.points;
    if let Some(circle) = of.circle() {
        round(pen, &circle, color);
        pen.line([circle.center, points[0]], color.gamma_multiply(0.7), 1.0);
        pen.dot(circle.center, color, 2.5);
    } else {
        for ends in points.windows(2) {
            pen.line([ends[0], ends[1]], color, 1.5);
        }
    }
    for &point in points {
        pen.dot(point, Color32::WHITE, 3.0);
    }
    let middle = match (of.kind, &points[..]) {
        (Kind::Angle, [_, corner, _]) => Some(*corner),
        (Kind::Radius, _) => of.circle().map(|circle| circle.center),
        (_, [a, b]) => Some((*a + *b) * 0.5),
        (_, points) => points.last().copied(),
    };
    if let Some(middle) = middle.or(points.first().copied()) {
        pen.label(middle, text(of, lengths));
    }
}

fn round<P: Fn((f64, f64)) -> Pos2>(pen: &Pen<'_, P>, circle: &Circle, color: Color32) {
    let across = circle.normal.any_orthonormal_vector() * circle.radius;
    let along = circle.normal.cross(across);
    let at = |side: u32| {
        let (sin, cos) = math::sin_cos(f64::from(side) * std::f64::consts::TAU / f64::from(SIDES));
        circle.center + across * cos + along * sin
    };
    for side in 0..SIDES {
        pen.line([at(side), at(side + 1)], color, 1.5);
    }
}

/// The measurement in progress: its points so far, and the one that a click would add.
fn under_way<P: Fn((f64, f64)) -> Pos2>(pen: &Pen<'_, P>, state: &State) {
    let measuring = &state.measuring;
    let Some(kind) = measuring.tool else {
        return;
    };
    let color = Color32::from_rgb(0xff, 0xc8, 0x3d);
    for ends in measuring.points.windows(2) {
        pen.line([ends[0], ends[1]], color, 1.5);
    }
    for &point in &measuring.points {
        pen.dot(point, color, 3.5);
    }
    let Some(target) = state.hover.and_then(|(x, y)| state.target(x, y)) else {
        return;
    };
    if let Some(&last) = measuring.points.last() {
        pen.line([last, target.point], color.gamma_multiply(0.8), 1.0);
        let mut points = measuring.points.clone();
        points.push(target.point);
        let so_far = Measurement { kind, points };
        if so_far.value().is_some() {
            pen.label(target.point, text(&so_far, &state.lengths()));
        }
    }
    if let Some(at) = pen.at(target.point) {
        let radius = if target.is_vertex { 6.0 } else { 3.0 };
        pen.painter
            .circle_stroke(at, radius, Stroke::new(3.0, Color32::from_black_alpha(120)));
        pen.painter
            .circle_stroke(at, radius, Stroke::new(1.5, color));
    }
}

/// All faults of the displayed kind, and the current one among them.
fn faults<P: Fn((f64, f64)) -> Pos2>(pen: &Pen<'_, P>, state: &State) {
    let Some((shown, document)) = state.inspection.shown.zip(state.document.as_ref()) else {
        return;
    };
    let scene = &document.scene;
    let checked = state.inspection.of(scene, shown.object);
    let (Some(checked), Ok(world_from_object)) = (checked, scene.world_from_object(shown.object))
    else {
        return;
    };
    let count = checked.count(shown.fault);
    // The current one comes last, over the others.
    let others = (0..count.min(MOST_FAULTS)).filter(|index| *index != shown.index);
    for index in others.chain([shown.index]) {
        let (color, width) = match index == shown.index {
            true => (Color32::from_rgb(0xff, 0xe0, 0x4a), 3.0),
            false => (Color32::from_rgb(0xff, 0x52, 0x52), 1.5),
        };
        let corners = checked.corners(shown.fault, index);
        let corners: Vec<DVec3> = corners
            .into_iter()
            .map(|corner| world_from_object.transform_point3(corner))
            .collect();
        match corners[..] {
            [point] => pen.dot(point, color, 1.5 + width),
            [a, b] => pen.line([a, b], color, width),
            _ => {
                let (triangles, _) = corners.as_chunks::<3>();
                let sides = triangles
                    .iter()
                    .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
                sides.for_each(|ends| pen.line(ends, color, width));
            }
        }
    }
    if count > MOST_FAULTS {
        let corner = pen.painter.clip_rect().left_bottom() + vec2(10.0, -10.0);
        let words = format!("{MOST_FAULTS} of {count} are drawn");
        let font = FontId::proportional(12.0);
        pen.painter
            .text(corner, Align2::LEFT_BOTTOM, words, font, Color32::WHITE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn labels_lie_beside_one_another_and_inside_the_picture() {
        let room = Rect::from_min_max(pos2(0.0, 0.0), pos2(200.0, 100.0));
        let label = |x: f32, y: f32| Rect::from_center_size(pos2(x, y), vec2(60.0, 20.0));
        assert_eq!(free(label(100.0, 50.0), room, &[]), label(100.0, 50.0));
        assert_eq!(free(label(10.0, 99.0), room, &[]), label(30.0, 90.0));
        let mut taken = Vec::new();
        for _ in 0..4 {
            taken.push(free(label(100.0, 50.0), room, &taken));
        }
        let centers: Vec<f32> = taken.iter().map(|rect| rect.center().y).collect();
        assert_eq!(centers, [50.0, 28.0, 72.0, 50.0], "no room for a fourth");
        // One far to the side is in nobody's way.
        assert_eq!(free(label(170.0, 50.0), room, &taken), label(170.0, 50.0));
    }
}
