//! All parts of the window in their places.

use super::overlay::TileOverlay;
use super::viewport::{self, Place};
use super::{Commands, Status, banner, help, side, status};
use crate::state::State;
use crate::ui::canvas::Canvas;
use crate::ui::input;
use egui::{CentralPanel, Frame, Margin, Panel, Ui};

/// Shows everything, and puts what a person asked for, by mouse, keys or controls, into `out`.
pub fn show(
    ui: &mut Ui,
    state: &State,
    news: &Status,
    canvas: &mut Canvas,
    overlay: &mut TileOverlay,
    out: &mut Commands,
) -> Place {
    let context = ui.ctx().clone();
    out.extend(input::keys(&context, state));
    // The window is cleared to the panels' colour: filling them again would cost what drawing them does.
    let frame = Frame::new();
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
        help::show(&context, out);
    }
    place
}
