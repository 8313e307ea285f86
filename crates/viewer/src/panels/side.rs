//! The side panel: what can be done on top, then everything that can be set.

use super::{Commands, Status, look, objects, picture, render, tiles};
use crate::state::PromptKind;
use crate::state::State;
use crate::state::command::Command;
use egui::{Button, ScrollArea, Ui, vec2};

/// How wide the panel is, in points.
pub(super) const WIDTH: f32 = 288.0;

/// Shows it.
pub(super) fn show(ui: &mut Ui, state: &State, status: &Status, out: &mut Commands) {
    actions(ui, state, out);
    ScrollArea::vertical()
        .auto_shrink([false, false])
        .show(ui, |ui| {
            picture::show(ui, state, out);
            look::show(ui, state, out);
            tiles::show(ui, state, status, out);
            objects::show(ui, state, out);
            render::show(ui, state, status, out);
        });
}

fn actions(ui: &mut Ui, state: &State, out: &mut Commands) {
    ui.add_space(2.0);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let actions = [
            (
                "Open…",
                "Open a mesh or a scene (Ctrl+O)",
                Command::Ask(PromptKind::Open),
                66.0,
            ),
            (
                "Save…",
                "Save the picture as PNG, PPM, JPEG or EXR (S)",
                Command::Ask(PromptKind::Save),
                66.0,
            ),
            (
                "Fit",
                "Bring the whole scene into view (F)",
                Command::Fit,
                44.0,
            ),
            (
                "Reset",
                "The view as it was at first (R)",
                Command::ResetView,
                50.0,
            ),
            ("?", "Keys and gestures (F1)", Command::ToggleHelp, 22.0),
        ];
        for (name, hint, command, width) in actions {
            let enabled =
                state.document.is_some() || !matches!(command, Command::Ask(PromptKind::Save));
            let button = Button::new(name).min_size(vec2(width, 24.0));
            if ui
                .add_enabled(enabled, button)
                .on_hover_text(hint)
                .clicked()
            {
                out.push(command);
            }
        }
    });
    ui.add_space(2.0);
}
