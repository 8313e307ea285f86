//! What lies over the picture: progress, the path line, questions, errors, short messages, and a hint where nothing is
//! shown.

use super::widgets::card;
use super::{Commands, Status, path_line};
use crate::state::command::Command;
use crate::state::effect::Keep;
use crate::state::preferences::Mouse;
use crate::state::{Answer, Pending, Replacing, State};
use crate::ui::registry::{Keymap, action};
use crate::ui::theme;
use egui::{Align2, Area, Button, Context, Id, Order, RichText, Stroke, Ui, vec2};
use raycast_core::scene::Object;

/// Shows them over `room`, the picture's place.
pub(super) fn show(
    context: &Context,
    room: egui::Rect,
    state: &State,
    status: &Status,
    out: &mut Commands,
) {
    if let Some(hint) = hint(context, state, status) {
        Area::new(Id::unique("hint"))
            .order(Order::Middle)
            .pivot(Align2::CENTER_CENTER)
            .fixed_pos(room.center())
            .interactable(false)
            .show(context, |ui| {
                // The backdrop is dark in either theme.
                let quiet = theme::of(&egui::Visuals::dark()).quiet;
                let text = RichText::new(hint).color(quiet).size(15.0);
                ui.add(egui::Label::new(text).extend());
            });
    }
    let width = width(room);
    let top = Area::new(Id::unique("banners"))
        .order(Order::Middle)
        .fixed_pos(room.center_top() + vec2(-width * 0.5, 12.0));
    let anything = state.prompt.is_some()
        || state.question.is_some()
        || state.replacing.is_some()
        || !state.errors.is_empty()
        || status.activity.is_some();
    if anything {
        top.show(context, |ui| {
            ui.set_width(width);
            activity(ui, status, out);
            if let Some(pending) = &state.question {
                unsaved(ui, state, pending, out);
            }
            if let Some(prompt) = &state.prompt {
                path_line::show(ui, prompt, out);
            }
            if let Some(replacing) = &state.replacing {
                question(ui, replacing, out);
            }
            for (index, error) in state.errors.iter().enumerate().rev().take(4) {
                error_banner(ui, index, error, out);
            }
        });
    }
    mouse_hint(context, room, state);
    if !state.toasts.is_empty() {
        Area::new(Id::unique("toasts"))
            .order(Order::Middle)
            .pivot(Align2::CENTER_BOTTOM)
            .fixed_pos(room.center_bottom() - vec2(0.0, 14.0))
            .interactable(false)
            .show(context, |ui| {
                // Otherwise an area offers the width that it had: the first message would decide where later ones wrap.
                ui.set_max_width(width);
                for toast in &state.toasts {
                    card(ui, theme::colors(ui).line).show(ui, |ui| ui.label(&toast.text));
                }
            });
    }
    held_files(context, room, state);
}

/// What to do where nothing is shown: without a scene, and where all of it is hidden.
fn hint(context: &Context, state: &State, status: &Status) -> Option<String> {
    if status.activity.is_some() || state.prompt.is_some() {
        return None;
    }
    let key_of = |id: &str| match Keymap::of(context).key(action(id)) {
        key if key.is_empty() => key,
        key => format!(" ({key})"),
    };
    let Some(document) = &state.document else {
        let key = key_of("file.open");
        return Some(format!("Open a mesh{key} or drop one here"));
    };
    let objects = &document.scene.objects;
    let all_hidden = !objects.is_empty() && objects.iter().all(Object::is_hidden);
    all_hidden.then(|| format!("All is hidden: Show all{}", key_of("object.show_all")))
}

/// What the mouse does in the picture, until it is used there for the first time.
fn mouse_hint(context: &Context, room: egui::Rect, state: &State) {
    let has_other = !state.toasts.is_empty() || state.prompt.is_some() || state.walk.is_some();
    if state.preferences.knows_mouse || state.document.is_none() || has_other {
        return;
    }
    let drags = match state.preferences.mouse {
        Mouse::Viewer => "Drag to orbit, right drag to pan",
        Mouse::Blender => "Middle drag to orbit, with Shift to pan",
        Mouse::Cad => "Right drag to orbit, middle drag to pan",
    };
    let keys = match Keymap::of(context).key(action("help.keys")) {
        key if key.is_empty() => "Help has the rest".to_owned(),
        key => format!("{key} for the rest"),
    };
    Area::new(Id::unique("mouse hint"))
        .order(Order::Middle)
        .pivot(Align2::CENTER_BOTTOM)
        .fixed_pos(room.center_bottom() - vec2(0.0, 14.0))
        .interactable(false)
        .show(context, |ui| {
            ui.set_max_width(width(room));
            let text = format!("{drags}, wheel to zoom, click to read values; {keys}");
            card(ui, theme::colors(ui).line).show(ui, |ui| ui.label(text));
        });
}

/// The width of what lies over the picture, in points.
fn width(room: egui::Rect) -> f32 {
    (room.width() - 24.0).clamp(160.0, 620.0)
}

/// While files are dragged over the window, what dropping them does.
fn held_files(context: &Context, room: egui::Rect, state: &State) {
    let (count, adds) = context.input(|input| {
        let held = input.raw.hovered_files.len();
        (held, input.modifiers.shift)
    });
    if count == 0 {
        return;
    }
    let layer = egui::LayerId::new(Order::Foreground, Id::unique("held files"));
    let painter = context.layer_painter(layer).with_clip_rect(room);
    let accent = theme::of(&egui::Visuals::dark()).accent;
    painter.rect_filled(room, 0.0, egui::Color32::from_black_alpha(150));
    let frame = room.shrink(6.0);
    let stroke = Stroke::new(2.0, accent);
    painter.rect_stroke(frame, 6.0, stroke, egui::StrokeKind::Inside);
    let files = if count == 1 { "file" } else { "files" };
    let text = match (adds, state.document.is_some()) {
        (true, true) => format!("Drop to add the {files} to what is open"),
        (false, true) => format!("Drop to open the {files}, or hold Shift to add to what is open"),
        (_, false) => format!("Drop to open the {files}"),
    };
    Area::new(Id::unique("held files' hint"))
        .order(Order::Tooltip)
        .pivot(Align2::CENTER_CENTER)
        .fixed_pos(frame.center())
        .interactable(false)
        .show(context, |ui| {
            ui.set_width(width(room));
            let text = RichText::new(text).color(egui::Color32::WHITE).size(15.0);
            ui.vertical_centered(|ui| ui.label(text));
        });
}

fn activity(ui: &mut Ui, status: &Status, out: &mut Commands) {
    let Some(activity) = &status.activity else {
        return;
    };
    card(ui, theme::colors(ui).line).show(ui, |ui| {
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
            // Cancel stays in its place, whatever is being done.
            let room = (ui.available_width() - 70.0).max(40.0);
            ui.allocate_ui(vec2(room, 18.0), |ui| {
                ui.set_min_width(room);
                ui.add(egui::Label::new(format!("{}…", activity.label)).truncate());
            });
            if activity.can_cancel {
                let stop = ui
                    .button("Cancel")
                    .on_hover_text("What is open stays (Esc)");
                if stop.clicked() {
                    out.push(Command::CancelLoad);
                }
            }
        });
    });
}

/// The question about unsaved changes.
fn unsaved(ui: &mut Ui, state: &State, pending: &Pending, out: &mut Commands) {
    let name = state
        .document
        .as_ref()
        .map_or("the scene", |document| &document.name);
    let before = match pending {
        Pending::Close => "closing".to_owned(),
        Pending::CopyCommand => "copying the command that makes the picture".to_owned(),
        Pending::Open => match &state.arrived {
            Some(arrived) if arrived.keep == Keep::All => {
                "showing the files as they are now".to_owned()
            }
            Some(arrived) => format!("opening {}", arrived.document.name),
            None => "opening another".to_owned(),
        },
    };
    card(ui, theme::colors(ui).accent).show(ui, |ui| {
        ui.set_width(ui.available_width());
        let text = format!("Changes of {name} are not saved. Save them before {before}?");
        ui.add(egui::Label::new(RichText::new(text).strong()).wrap());
        ui.horizontal(|ui| {
            let answers = [
                ("Save", "Save the scene, then go on", Answer::Save),
                ("Don't save", "Go on, and lose the changes", Answer::Discard),
                ("Cancel", "Stay with this scene (Esc)", Answer::Stay),
            ];
            // A command line cannot express unsaved changes.
            let can_discard = *pending != Pending::CopyCommand;
            let answers = answers.into_iter();
            for (name, hint, answer) in answers.filter(|a| can_discard || a.2 != Answer::Discard) {
                let is_new = ui.ctx().read_response(ui.next_auto_id()).is_none();
                let button = ui.add(Button::new(name)).on_hover_text(hint);
                if answer == Answer::Save {
                    take_focus(&button, is_new);
                }
                if button.clicked() {
                    out.push(Command::Answer(answer));
                }
            }
        });
    });
}

/// Gives a question's answer the keyboard: from whatever has it when the question appears, and later where nothing has.
fn take_focus(answer: &egui::Response, is_new: bool) {
    if is_new {
        egui::Popup::close_all(&answer.ctx);
    }
    if is_new || answer.ctx.memory(|memory| memory.focused().is_none()) {
        answer.request_focus();
    }
}

/// The question about replacing an existing file.
fn question(ui: &mut Ui, replacing: &Replacing, out: &mut Commands) {
    card(ui, theme::colors(ui).accent).show(ui, |ui| {
        ui.set_width(ui.available_width());
        let text = format!("{} is there already.", replacing.path.display());
        ui.add(egui::Label::new(RichText::new(text).strong()).wrap());
        ui.horizontal(|ui| {
            if ui.button("Replace it").clicked() {
                out.push(Command::Replace);
            }
            let is_new = ui.ctx().read_response(ui.next_auto_id()).is_none();
            let keep = ui.button("Keep it").on_hover_text("Close (Esc)");
            // Enter on a question that has just appeared does no harm; Shift+Tab or an arrow leads to the other answer.
            take_focus(&keep, is_new);
            if keep.clicked() {
                out.push(Command::Dismiss);
            }
        });
    });
}

fn error_banner(ui: &mut Ui, index: usize, error: &str, out: &mut Commands) {
    card(ui, theme::colors(ui).error).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal_top(|ui| {
            let room = ui.available_width() - 64.0;
            ui.vertical(|ui| {
                ui.set_width(room);
                let text = RichText::new(error).color(theme::colors(ui).error);
                // Selectable, so that it can be copied.
                ui.add(egui::Label::new(text).wrap().selectable(true));
            });
            if ui.button("Dismiss").on_hover_text("Close (Esc)").clicked() {
                out.push(Command::DismissError(index));
            }
        });
    });
}
