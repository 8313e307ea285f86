//! The axes in the picture's corner; a click on one looks along it.

use super::Commands;
use crate::state::State;
use crate::state::command::Command;
use crate::state::viewpoint::StandardView;
use crate::ui::registry;
use egui::{Align2, Color32, FontId, Id, Rect, Sense, Stroke, Ui, pos2, vec2};
use raycast_core::glam::DVec3;

/// The axes' length, in points.
const LENGTH: f32 = 30.0;
/// The radius of the discs at their ends, in points.
const RADIUS: f32 = 9.0;

/// The ends of the axes: direction, name, and the view from there.
const ENDS: [(DVec3, &str, StandardView, &str); 6] = [
    (DVec3::X, "X", StandardView::Right, "view.right"),
    (DVec3::Y, "Y", StandardView::Top, "view.top"),
    (DVec3::Z, "Z", StandardView::Front, "view.front"),
    (DVec3::NEG_X, "−X", StandardView::Left, "view.left"),
    (DVec3::NEG_Y, "−Y", StandardView::Bottom, "view.bottom"),
    (DVec3::NEG_Z, "−Z", StandardView::Back, "view.back_side"),
];

/// Shows it in the upper right corner of the picture, where there is room.
pub(super) fn show(ui: &Ui, room: Rect, state: &State, out: &mut Commands) {
    if state.document.is_none() || room.width() < 240.0 || room.height() < 180.0 {
        return;
    }
    let middle = room.right_top() + vec2(-LENGTH - 18.0, LENGTH + 18.0);
    let viewpoint = &state.viewpoint;
    let (right, up, back) = (viewpoint.right(), viewpoint.up(), viewpoint.orbit.back());
    let mut ends = ENDS.map(|(axis, name, view, id)| {
        let (x, y) = (axis.dot(right) as f32, -axis.dot(up) as f32);
        (axis.dot(back), middle + vec2(x, y) * LENGTH, name, view, id)
    });
    // From far to near, so that nearer discs cover those behind.
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let painter = ui.painter_at(room);
    painter.circle_filled(middle, LENGTH + RADIUS + 4.0, Color32::from_black_alpha(46));
    for (depth, place, name, view, id) in ends {
        let is_positive = name.len() == 1;
        let around = Rect::from_center_size(place, vec2(2.0, 2.0) * RADIUS);
        let response = ui.interact(around, Id::unique(("axis", id)), Sense::click());
        let letter = &name[name.len() - 1..];
        let color = axis_color(letter).gamma_multiply(if depth < -0.01 { 0.65 } else { 1.0 });
        let is_lit = response.hovered() || response.has_focus();
        if is_positive {
            painter.line_segment([middle, place], Stroke::new(2.0, color));
            painter.circle_filled(place, RADIUS, color);
        } else {
            painter.circle_filled(place, RADIUS - 1.0, color.gamma_multiply(0.35));
            painter.circle_stroke(place, RADIUS - 1.0, Stroke::new(1.0, color));
        }
        if is_lit {
            painter.circle_stroke(place, RADIUS + 1.0, Stroke::new(1.5, Color32::WHITE));
        }
        if is_positive || is_lit {
            let at = pos2(place.x, place.y);
            let ink = if is_positive {
                Color32::from_gray(16)
            } else {
                Color32::WHITE
            };
            let font = FontId::proportional(11.0);
            painter.text(at, Align2::CENTER_CENTER, name, font, ink);
        }
        response.widget_info(|| {
            let name = format!("Look from {name}");
            egui::WidgetInfo::labeled(egui::Role::Button, true, name)
        });
        let hint = |ui: &mut Ui| {
            ui.label(registry::hint(ui.ctx(), id));
        };
        if response.on_hover_ui(hint).clicked() {
            out.push(Command::Look(view));
        }
    }
}

/// Red, green and blue for x, y and z.
pub(super) fn axis_color(letter: &str) -> Color32 {
    match letter {
        "X" => Color32::from_rgb(0xf0, 0x6a, 0x6a),
        "Y" => Color32::from_rgb(0x86, 0xd0, 0x5a),
        _ => Color32::from_rgb(0x6a, 0xa8, 0xf5),
    }
}
