//! What lies over the picture: progress, the path line, errors, short messages, and what to do where
//! there is none.

use super::{Commands, Status};
use crate::state::PromptKind;
use crate::state::command::Command;
use crate::state::{Prompt, State};
use crate::ui::theme;
use egui::{Align2, Area, Context, Frame, Id, Margin, Order, RichText, Stroke, Ui, vec2};
use std::path::Path;

/// What an empty window says.
const HINT: &str = "Open a mesh (Ctrl+O) or drop one here";

/// Shows them over `room`, the picture's place.
pub(super) fn show(
    context: &Context,
    room: egui::Rect,
    state: &State,
    status: &Status,
    out: &mut Commands,
) {
    if state.document.is_none() && status.activity.is_none() && state.prompt.is_none() {
        Area::new(Id::unique("hint"))
            .order(Order::Middle)
            .pivot(Align2::CENTER_CENTER)
            .fixed_pos(room.center())
            .interactable(false)
            .show(context, |ui| {
                let text = RichText::new(HINT).color(theme::QUIET).size(15.0);
                ui.add(egui::Label::new(text).extend());
            });
    }
    let width = (room.width() - 24.0).clamp(160.0, 620.0);
    let top = Area::new(Id::unique("banners"))
        .order(Order::Middle)
        .fixed_pos(room.center_top() + vec2(-width * 0.5, 12.0));
    let anything = state.prompt.is_some()
        || state.replacing.is_some()
        || !state.errors.is_empty()
        || status.activity.is_some();
    if anything {
        top.show(context, |ui| {
            ui.set_width(width);
            activity(ui, status);
            if let Some(prompt) = &state.prompt {
                path_line(ui, prompt, out);
            }
            if let Some(path) = &state.replacing {
                question(ui, path, out);
            }
            for (index, error) in state.errors.iter().enumerate().rev().take(4) {
                error_banner(ui, index, error, out);
            }
        });
    }
    if !state.toasts.is_empty() {
        Area::new(Id::unique("toasts"))
            .order(Order::Middle)
            .pivot(Align2::CENTER_BOTTOM)
            .fixed_pos(room.center_bottom() - vec2(0.0, 14.0))
            .interactable(false)
            .show(context, |ui| {
                for toast in &state.toasts {
                    card(theme::LINE).show(ui, |ui| ui.label(&toast.text));
                }
            });
    }
}

fn card(line: egui::Color32) -> Frame {
    Frame::new()
        .fill(egui::Color32::from_rgba_unmultiplied(
            0x20, 0x24, 0x2b, 0xf4,
        ))
        .stroke(Stroke::new(1.0, line))
        .corner_radius(6.0)
        .inner_margin(Margin::symmetric(12, 8))
}

fn activity(ui: &mut Ui, status: &Status) {
    let Some(activity) = &status.activity else {
        return;
    };
    card(theme::LINE).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal(|ui| {
            match activity.share {
                Some(share) => {
                    ui.add(
                        egui::ProgressBar::new(share)
                            .desired_width(140.0)
                            .show_percentage(),
                    );
                }
                None => {
                    ui.add(egui::Spinner::new().size(14.0));
                }
            }
            ui.label(format!("{}…", activity.label));
        });
    });
}

fn path_line(ui: &mut Ui, prompt: &Prompt, out: &mut Commands) {
    let (title, action, hint) = match prompt.kind {
        PromptKind::Open => (
            "Open a mesh or a scene",
            "Open",
            "path of a mesh or a .raycast.toml",
        ),
        PromptKind::Save => (
            "Save the picture",
            "Save",
            "a name ending in .png, .ppm, .jpg or .exr",
        ),
        PromptKind::Texture => ("Load a texture", "Load", "path of an image"),
    };
    card(theme::ACCENT).show(ui, |ui| {
        ui.set_width(ui.available_width());
        let mut label = None;
        ui.horizontal(|ui| {
            label = Some(ui.label(RichText::new(title).strong()).id);
            ui.weak(if prompt.dialog {
                "choose in the dialog, or type a path:"
            } else {
                "type a path, or drop a file on the window:"
            });
        });
        ui.horizontal(|ui| {
            let mut text = prompt.text.clone();
            let room = ui.available_width() - 122.0;
            let edit = egui::TextEdit::singleline(&mut text)
                .id(Id::unique("path"))
                .hint_text(hint)
                .desired_width(room);
            let mut response = ui.add(edit);
            if let Some(label) = label {
                response = response.labelled_by(label);
            }
            if response.changed() {
                out.push(Command::TypePath(text));
            }
            let entered =
                response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            let escaped =
                response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Escape));
            if !response.has_focus()
                && !entered
                && !escaped
                && ui.memory(|memory| memory.focused().is_none())
            {
                response.request_focus();
            }
            let spoken = |response: egui::Response, name: String| {
                response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
                response
            };
            let confirm = spoken(ui.button(action), format!("{action} this path"));
            if confirm.clicked() || entered {
                out.push(Command::ConfirmPath);
            }
            if ui.button("Cancel").clicked() || escaped {
                out.push(Command::Dismiss);
            }
        });
    });
}

/// Whether a picture may replace the file at `path`.
fn question(ui: &mut Ui, path: &Path, out: &mut Commands) {
    card(theme::ACCENT).show(ui, |ui| {
        ui.set_width(ui.available_width());
        let text = format!("{} is there already.", path.display());
        ui.add(egui::Label::new(RichText::new(text).strong()).wrap());
        ui.horizontal(|ui| {
            if ui.button("Replace it").clicked() {
                out.push(Command::ReplacePicture(path.to_owned()));
            }
            if ui.button("Keep it").on_hover_text("Close (Esc)").clicked() {
                out.push(Command::Dismiss);
            }
        });
    });
}

fn error_banner(ui: &mut Ui, index: usize, error: &str, out: &mut Commands) {
    card(theme::ERROR).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal_top(|ui| {
            let room = ui.available_width() - 64.0;
            ui.vertical(|ui| {
                ui.set_width(room);
                let text = RichText::new(error).color(theme::ERROR);
                // The whole of it, to read and to copy.
                ui.add(egui::Label::new(text).wrap().selectable(true));
            });
            if ui.button("Dismiss").on_hover_text("Close (Esc)").clicked() {
                out.push(Command::DismissError(index));
            }
        });
    });
}
