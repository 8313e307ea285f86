//! All keys and gestures.

use super::Commands;
use crate::state::State;
use crate::state::command::Command;
use crate::ui::input;
use crate::ui::registry::{Chord, Keymap, Menu, actions};
use crate::ui::theme;
use egui::{Grid, Id, Label, Modal, RichText, ScrollArea, Ui};

/// Shows them over the window; a click beside them, Esc or F1 closes them.
pub(super) fn show(context: &egui::Context, state: &State, out: &mut Commands) {
    let frame = egui::Frame::popup(&context.global_style()).inner_margin(18.0);
    let modal = Modal::new(Id::unique("help")).frame(frame);
    let window = context.content_rect();
    let response = modal.show(context, |ui| {
        ui.set_width((window.width() - 80.0).min(520.0));
        // Otherwise an area offers the height that it had at first.
        ui.set_max_height(window.height());
        ui.horizontal(|ui| {
            ui.heading("Keys and gestures");
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button("Close").clicked() {
                    out.push(Command::ToggleHelp);
                }
            });
        });
        ui.add_space(4.0);
        ScrollArea::vertical()
            .max_height(window.height() - 130.0)
            .auto_shrink([false, true])
            .show(ui, |ui| {
                let gestures = input::gestures(state.preferences.mouse);
                let gestures = gestures.map(|g| (g.gesture.to_owned(), g.does));
                table(ui, "Mouse and clipboard", gestures);
                let keymap = Keymap::of(context);
                for menu in Menu::ALL {
                    let keys = |keys: &[Chord]| {
                        let names: Vec<_> = keys.iter().map(Chord::name).collect();
                        names.join("   ")
                    };
                    let actions = actions().filter(|action| action.menu == menu);
                    let keys = actions.map(|action| (keys(keymap.keys(action)), action.name));
                    table(ui, menu.name(), keys.filter(|(keys, _)| !keys.is_empty()));
                }
            });
    });
    if response.backdrop_response.clicked() {
        out.push(Command::ToggleHelp);
    }
}

fn table(ui: &mut Ui, title: &str, entries: impl Iterator<Item = (String, &'static str)>) {
    let colors = theme::colors(ui);
    ui.add_space(6.0);
    ui.label(RichText::new(title).strong().color(colors.accent));
    const KEYS: f32 = 184.0;
    const GAP: f32 = 16.0;
    // Text that is too long for a narrow window wraps.
    let room = (ui.available_width() - KEYS - GAP).max(KEYS);
    Grid::new(title)
        .num_columns(2)
        .min_col_width(KEYS)
        .max_col_width(room)
        .spacing([GAP, 4.0])
        .show(ui, |ui| {
            for (key, does) in entries {
                ui.label(RichText::new(key).color(colors.strong));
                let does = RichText::new(does).color(colors.quiet);
                ui.add(Label::new(does).wrap());
                ui.end_row();
            }
        });
}
