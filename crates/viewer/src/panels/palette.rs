//! The list of all commands, found by their names.

use super::Commands;
use crate::state::command::Command;
use crate::state::{Palette, State};
use crate::ui::registry::{self, Action, Keymap};
use crate::ui::theme;
use egui::{
    Align2, Area, Button, Frame, Id, Key, Order, Popup, RichText, ScrollArea, TextEdit, Ui, vec2,
};

/// Shows it over the window, if it is open.
pub(super) fn show(context: &egui::Context, state: &State, out: &mut Commands) {
    let Some(palette) = &state.palette else {
        return;
    };
    // A list that is open would be over it.
    if context.read_response(Id::unique("palette")).is_none() {
        Popup::close_all(context);
    }
    let window = context.content_rect();
    let width = (window.width() - 40.0).min(460.0);
    Area::new(Id::unique("palette area"))
        .order(Order::Foreground)
        .pivot(Align2::CENTER_TOP)
        .fixed_pos(window.center_top() + vec2(0.0, 44.0))
        .show(context, |ui| {
            Frame::popup(ui.style()).inner_margin(10.0).show(ui, |ui| {
                ui.set_width(width);
                let room = (window.height() - 150.0).clamp(80.0, 380.0);
                // Otherwise an area offers the height that it had: the list would stay as short as that of the last search.
                ui.set_max_height(window.height());
                contents(ui, state, palette, room, out);
            });
        });
}

fn contents(ui: &mut Ui, state: &State, palette: &Palette, room: f32, out: &mut Commands) {
    let mut text = palette.text.clone();
    let id = Id::unique("palette");
    // Before the field is shown: it takes what is typed in this frame.
    ui.memory_mut(|memory| memory.request_focus(id));
    let field = TextEdit::singleline(&mut text)
        .id(id)
        .hint_text("Find a command")
        .desired_width(f32::INFINITY);
    let (up, down, enter) = ui.input(|input| {
        (
            input.key_pressed(Key::ArrowUp),
            input.key_pressed(Key::ArrowDown),
            input.key_pressed(Key::Enter),
        )
    });
    // Enter runs what the text finds that is there by now, not what the last frame showed.
    let is_changed = ui.add(field).changed();
    let found = registry::found(&text);
    if is_changed {
        out.push(Command::TypePalette(text));
    }
    let last = found.len().saturating_sub(1);
    let marked = if is_changed {
        0
    } else {
        palette.marked.min(last)
    };
    if down && marked < last {
        out.push(Command::MarkPalette(marked + 1));
    } else if up && marked > 0 {
        out.push(Command::MarkPalette(marked - 1));
    }
    let mut run = |action: &Action| {
        if (action.applies)(state) {
            out.push(Command::TogglePalette);
            out.push((action.command)(state));
        }
    };
    if enter && let Some(action) = found.get(marked) {
        run(action);
    }
    if found.is_empty() {
        ui.weak("No command has such a name");
    }
    let keymap = Keymap::of(ui.ctx());
    ScrollArea::vertical()
        .max_height(room)
        .auto_shrink([false, true])
        .show(ui, |ui| {
            for (number, action) in found.iter().enumerate() {
                let name = RichText::new(action.name);
                let quiet = theme::colors(ui).quiet;
                let key = RichText::new(keymap.key(action)).color(quiet);
                let menu = RichText::new(action.menu.name()).color(quiet).small();
                let button = Button::new((name, menu))
                    .selected(number == marked)
                    .frame_when_inactive(number == marked)
                    .right_text(key)
                    .min_size(vec2(ui.available_width(), 0.0));
                let response = ui.add_enabled((action.applies)(state), button);
                if number == marked && (up || down) {
                    response.scroll_to_me(None);
                }
                if response.on_hover_text(action.does).clicked() {
                    run(action);
                }
            }
        });
}
