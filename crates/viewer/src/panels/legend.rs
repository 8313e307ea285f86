//! What the picture's colours stand for, over the picture; nothing where the picture itself has its legend.

use crate::state::State;
use egui::{Align2, Color32, FontId, Mesh, Painter, Rect, pos2, vec2};
use raycast_core::scene::COLOR_MAP_STEPS;

const WIDTH: f32 = 136.0;
const HEIGHTS: std::ops::RangeInclusive<f32> = 110.0..=220.0;
/// Above it are the axes; below it is as much left.
const MARGINS: [f32; 2] = [100.0, 40.0];
const PADDING: f32 = 10.0;
const BAR: f32 = 16.0;

/// Shows it at the right of the picture, where there is room.
pub(super) fn show(painter: &Painter, state: &State, room: Rect) {
    let Some(legend) = state.legend.as_ref().filter(|legend| !legend.scale.legend) else {
        return;
    };
    let Some(around) = place(room) else {
        return;
    };
    painter.rect_filled(around, 6.0, Color32::from_black_alpha(168));
    let ink = Color32::from_gray(236);
    let title = painter.layout_no_wrap(legend.title.clone(), FontId::proportional(13.0), ink);
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
    for (share, number) in legend.marks() {
        let y = bar.bottom() - bar.height() * share as f32;
        let at = pos2(bar.right() + 4.0, y);
        painter.hline(bar.right()..=at.x, y, egui::Stroke::new(1.0, ink));
        let font = FontId::proportional(12.0);
        painter.text(at + vec2(4.0, 0.0), Align2::LEFT_CENTER, number, font, ink);
    }
}

/// Its place at the right of `room`, lower in a low window; `None` where there is no room.
fn place(room: Rect) -> Option<Rect> {
    let [above, below] = MARGINS;
    let height = (room.height() - above - below).min(*HEIGHTS.end());
    if room.width() < 2.0 * WIDTH || height < *HEIGHTS.start() {
        return None;
    }
    let middle = room.center().y + (above - below) * 0.5;
    let right = pos2(room.right() - 14.0, middle);
    Some(Align2::RIGHT_CENTER.anchor_size(right, vec2(WIDTH, height)))
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
            let place = place(room);
            assert_eq!(place.map(|place| place.height()), height, "{size}");
            let free = room.with_min_y(room.top() + MARGINS[0]);
            assert!(
                place.is_none_or(|place| free.contains_rect(place)),
                "{size}"
            );
        }
    }
}
