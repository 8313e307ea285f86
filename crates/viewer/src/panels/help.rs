//! All keys and gestures.

use super::Commands;
use crate::state::command::Command;
use crate::ui::input::{GESTURES, KEYS, KeyHelp};
use crate::ui::theme;
use egui::{Grid, Id, Modal, RichText, Ui};

/// Shows them over the window; a click beside them, Esc or F1 closes them.
pub(super) fn show(context: &egui::Context, out: &mut Commands) {
    let frame = egui::Frame::popup(&context.global_style()).inner_margin(18.0);
    let modal = Modal::new(Id::unique("help")).frame(frame);
    let response = modal.show(context, |ui| {
        ui.set_width(500.0);
        ui.heading("Keys and gestures");
        ui.add_space(6.0);
        table(ui, "Mouse", GESTURES);
        table(ui, "Keys", KEYS);
        ui.add_space(10.0);
        if ui.button("Close").clicked() {
            out.push(Command::ToggleHelp);
        }
    });
    if response.backdrop_response.clicked() {
        out.push(Command::ToggleHelp);
    }
}

fn table(ui: &mut Ui, title: &str, entries: &[KeyHelp]) {
    ui.add_space(6.0);
    ui.label(RichText::new(title).strong().color(theme::ACCENT));
    Grid::new(title)
        .num_columns(2)
        .min_col_width(184.0)
        .spacing([16.0, 4.0])
        .show(ui, |ui| {
            for entry in entries {
                ui.label(RichText::new(entry.key).color(egui::Color32::WHITE));
                ui.label(RichText::new(entry.does).color(theme::QUIET));
                ui.end_row();
            }
        });
}
