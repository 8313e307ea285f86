//! What the picture's colours stand for, over the picture; nothing where the picture itself has its legend.

use crate::state::State;
use egui::{Align2, Color32, FontId, Mesh, Painter, Rect, pos2, vec2};
use raycast_core::scene::COLOR_MAP_STEPS;

const MOST_WIDTH: f32 = 136.0;
const HEIGHTS: std::ops::RangeInclusive<f32> = 110.0..=220.0;
/// Above it are the axes; below it is as much left.
const MARGINS: [f32; 2] = [100.0, 40.0];
const PADDING: f32 = 10.0;
const BAR: f32 = 16.0;

/// Shows it at the right of the picture, where there is room.
pub(super) fn show(painter: &Painter, state: &State, room: Rect) {
    let legend = state.shown_legend();
    let Some(legend) = legend.filter(|legend| !legend.scale.legend) else {
        return;
    };
    let ink = Color32::from_gray(236);
    let line = |text: String, size| painter.layout_no_wrap(text, FontId::proportional(size), ink);
    let title = line(legend.title.clone(), 13.0);
    let marks = legend.marks();
    let marks: Vec<_> = marks
        .into_iter()
        .map(|(share, number)| (share, line(number, 12.0)))
        .collect();
    let widest = marks.iter().map(|(_, number)| number.size().x);
    let width = title.size().x.max(BAR + 8.0 + widest.fold(0.0, f32::max)) + 2.0 * PADDING;
    let Some(around) = place(room, width.min(MOST_WIDTH)) else {
        return;
    };
    painter.rect_filled(around, 6.0, Color32::from_black_alpha(168));
    let inside = around.shrink(PADDING);
    painter
        .with_clip_rect(inside.intersect(painter.clip_rect()))
        .galley(inside.min, title, ink);
    let bar = Rect::from_min_max(
        inside.min + vec2(0.0, 26.0),
        pos2(inside.left() + BAR, inside.bottom() - 4.0),
    );
    let mut mesh = Mesh::default();
    let colors = legend.scale.map.colors();
    for (step, color) in colors.iter().enumerate() {
        let [r, g, b] = color.0;
        let y = bar.bottom() - bar.height() * step as f32 / (COLOR_MAP_STEPS - 1) as f32;
        let color = Color32::from_rgb(r, g, b);
        mesh.colored_vertex(pos2(bar.left(), y), color);
        mesh.colored_vertex(pos2(bar.right(), y), color);
        if step > 0 {
            let last = 2 * step as u32;
            mesh.add_triangle(last - 2, last - 1, last);
            mesh.add_triangle(last - 1, last, last + 1);
        }
    }
    painter.add(mesh);
    for (share, number) in marks {
        let y = bar.bottom() - bar.height() * share as f32;
        let at = pos2(bar.right() + 4.0, y);
        painter.hline(bar.right()..=at.x, y, egui::Stroke::new(1.0, ink));
        let corner = at + vec2(4.0, -number.size().y * 0.5);
        painter.galley(corner, number, ink);
    }
}

/// Its place at the right of `room`, lower in a low window; `None` where there is no room.
fn place(room: Rect, width: f32) -> Option<Rect> {
    let [above, below] = MARGINS;
    let height = (room.height() - above - below).min(*HEIGHTS.end());
    if room.width() < 2.0 * MOST_WIDTH || height < *HEIGHTS.start() {
        return None;
    }
    let middle = room.center().y + (above - below) * 0.5;
    let right = pos2(room.right() - 14.0, middle);
    Some(Align2::RIGHT_CENTER.anchor_size(right, vec2(width, height)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_windows_have_a_legend_too() {
        // The picture's places in windows of 640x400 and of 1280x720 at scale 2, and one that is too low.
        for (size, height) in [
            (vec2(352.0, 348.0), Some(208.0)),
            (vec2(352.0, 308.0), Some(168.0)),
            (vec2(992.0, 668.0), Some(220.0)),
            (vec2(352.0, 200.0), None),
            (vec2(200.0, 348.0), None),
        ] {
            let room = Rect::from_min_size(pos2(0.0, 26.0), size);
            let place = place(room, MOST_WIDTH);
            assert_eq!(place.map(|place| place.height()), height, "{size}");
            let free = room.with_min_y(room.top() + MARGINS[0]);
            assert!(
                place.is_none_or(|place| free.contains_rect(place)),
                "{size}"
            );
        }
    }
}
