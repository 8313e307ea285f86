//! The picture, and the mouse over it.

use super::overlay::TileOverlay;
use super::{Commands, cut, gizmo, highlight, legend, manipulator, marks};
use crate::state::{Resolution, State};
use crate::ui::canvas::Canvas;
use crate::ui::input;
use crate::ui::theme;
use egui::{Color32, Pos2, Rect, Sense, Ui, pos2, vec2};
use raycast_core::shade::Background;

/// What the state needs to know of the picture's place in the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PicturePlace {
    /// Its size in device pixels.
    pub pixels: (u32, u32),
    /// The point of the picture under the cursor.
    pub hover: Option<(f64, f64)>,
}

/// Shows the picture in the available room.
pub fn show(
    ui: &mut Ui,
    state: &State,
    canvas: &mut Canvas,
    overlay: &mut TileOverlay,
    out: &mut Commands,
) -> PicturePlace {
    let points = ui.ctx().pixels_per_point();
    let room = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(room, Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "The picture"));
    let pixels = (
        (room.width() * points).round().max(1.0) as u32,
        (room.height() * points).round().max(1.0) as u32,
    );
    let painter = ui.painter_at(room);
    let rect = picture_rect(room, state, points);
    // One opaque pixel of the picture for each pixel of the window.
    let as_it_is = rect == room
        && canvas.size() == pixels
        && state.settings.shading.background != Background::Transparent;
    let copy = as_it_is.then(|| canvas.copy_to(rect)).flatten();
    if copy.is_none() {
        painter.rect_filled(room, 0.0, theme::BACKDROP);
    }
    if state.settings.shading.background == Background::Transparent {
        checkers(&painter, rect);
    }
    if let Some(copy) = copy {
        painter.add(copy);
        overlay.show(&painter, canvas, rect, state.overlay);
    } else if let Some(texture) = canvas.texture(ui.ctx()) {
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(texture, rect, uv, Color32::WHITE);
        overlay.show(&painter, canvas, rect, state.overlay);
    }
    let (columns, rows) = state.size();
    let scale = f64::from(columns) / f64::from(rect.width().max(1.0));
    let at = |position: Pos2| {
        (
            f64::from(position.x - rect.left()) * scale,
            f64::from(position.y - rect.top()) * scale,
        )
    };
    let place = |(x, y): (f64, f64)| rect.min + vec2((x / scale) as f32, (y / scale) as f32);
    highlight::show(&painter, state, place);
    marks::show(&painter, state, place);
    let is_taken = manipulator::show(ui, &response, state, scale, (&at, &place), out);
    out.extend(input::mouse(
        ui,
        &response,
        (state.preferences.mouse, state.walk.is_some()),
        !is_taken,
        scale,
        at,
    ));
    legend::show(&painter, state, rect);
    gizmo::show(ui, room, state, out);
    cut::handles(ui, room, state, place, out);
    if response.dragged()
        && !is_taken
        && let Some(camera) = state.camera()
        && let Some(pivot) = camera.project(state.viewpoint.orbit.pivot)
    {
        // The pivot.
        let at = place(pivot);
        painter.circle_stroke(
            at,
            4.0,
            egui::Stroke::new(3.0, Color32::from_black_alpha(120)),
        );
        painter.circle_stroke(at, 4.0, egui::Stroke::new(1.2, Color32::WHITE));
    }
    let hover = response.hover_pos().map(at).filter(|&(x, y)| {
        (0.0..f64::from(columns)).contains(&x) && (0.0..f64::from(rows)).contains(&y)
    });
    if response.dragged() && !is_taken {
        ui.ctx().set_cursor_icon(egui::CursorIcon::Grabbing);
    }
    PicturePlace { pixels, hover }
}

/// The picture's rectangle: all of the room, or the largest of the picture's shape in the middle.
fn picture_rect(room: Rect, state: &State, points: f32) -> Rect {
    match state.resolution {
        Resolution::Window { .. } => room,
        Resolution::Fixed(columns, rows) => {
            let size = vec2(columns as f32, rows as f32);
            let scale = (room.size() / size).min_elem();
            // Whole device pixels, so that blocks have sharp edges.
            let whole = |length: f32| (length * points).round().max(1.0) / points;
            let size = vec2(whole(size.x * scale), whole(size.y * scale));
            let corner = room.center() - size * 0.5;
            Rect::from_min_size(pos2(whole(corner.x), whole(corner.y)), size)
        }
    }
}

/// A checkerboard, behind a transparent picture.
fn checkers(painter: &egui::Painter, rect: Rect) {
    const SIDE: f32 = 12.0;
    painter.rect_filled(rect, 0.0, Color32::from_gray(46));
    let mut mesh = egui::Mesh::default();
    let (columns, rows) = (
        (rect.width() / SIDE).ceil() as usize,
        (rect.height() / SIDE).ceil() as usize,
    );
    for row in 0..rows {
        for column in (row % 2..columns).step_by(2) {
            let corner = rect.min + vec2(column as f32, row as f32) * SIDE;
            let square = Rect::from_min_size(corner, vec2(SIDE, SIDE)).intersect(rect);
            mesh.add_colored_rect(square, Color32::from_gray(58));
        }
    }
    painter.add(mesh);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fixed_picture_keeps_its_shape_in_the_middle() {
        let room = Rect::from_min_size(pos2(10.0, 20.0), vec2(400.0, 400.0));
        let state = State {
            resolution: Resolution::Fixed(200, 100),
            ..State::default()
        };
        let rect = picture_rect(room, &state, 1.0);
        assert_eq!(
            rect,
            Rect::from_min_size(pos2(10.0, 120.0), vec2(400.0, 200.0))
        );
        let fits = picture_rect(room, &State::default(), 1.0);
        assert_eq!(fits, room);
    }
}
