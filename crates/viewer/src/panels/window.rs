//! All parts of the window in their places.

use super::overlay::TileOverlay;
use super::viewport::{self, PicturePlace};
use super::{Commands, Status, banner, help, menu, palette, side, status};
use crate::state::State;
use crate::ui::canvas::Canvas;
use crate::ui::input;
use crate::ui::theme;
use egui::{CentralPanel, Frame, Margin, Panel, Ui};

/// Shows everything, and appends the commands of mouse, keys and controls to `out`.
pub fn show(
    ui: &mut Ui,
    state: &State,
    news: &Status,
    canvas: &mut Canvas,
    overlay: &mut TileOverlay,
    out: &mut Commands,
) -> PicturePlace {
    let context = ui.ctx().clone();
    out.extend(input::keys(&context, state));
    // The window is cleared to the panels' colour: filling them again would cost what drawing them does.
    let frame = Frame::new();
    Panel::top("menu")
        .resizable(false)
        .exact_size(26.0)
        .frame(frame.inner_margin(Margin::symmetric(4, 2)))
        .show(ui, |ui| menu::show(ui, state, out));
    if state.panel {
        Panel::right("side")
            .resizable(false)
            .exact_size(side::WIDTH)
            .frame(frame.inner_margin(Margin::symmetric(10, 6)))
            .show(ui, |ui| side::show(ui, state, news, out));
    }
    Panel::bottom("status")
        .resizable(false)
        .exact_size(26.0)
        .frame(frame.inner_margin(Margin::symmetric(10, 2)))
        .show(ui, |ui| status::show(ui, state, news));
    let central = CentralPanel::no_frame().show(ui, |ui| {
        let room = ui.max_rect();
        (room, viewport::show(ui, state, canvas, overlay, out))
    });
    let (room, place) = central.inner;
    banner::show(&context, room, state, news, out);
    if state.help {
        help::show(&context, state, out);
    }
    palette::show(&context, state, out);
    ring(&context);
    place
}

/// A line around the control with the keyboard focus: egui's own mark is faint on some controls and missing on others.
fn ring(context: &egui::Context) {
    let Some(id) = context.memory(|memory| memory.focused()) else {
        return;
    };
    let Some(response) = context.read_response(id) else {
        return;
    };
    let rect = response.interact_rect.expand(1.5);
    let layer = egui::LayerId::new(egui::Order::Tooltip, egui::Id::unique("focus"));
    let stroke = egui::Stroke::new(1.5, theme::of(&context.global_style().visuals).accent);
    let painter = context.layer_painter(layer);
    painter.rect_stroke(rect, 4.0, stroke, egui::StrokeKind::Outside);
}
