//! The list of all commands, found by their names.

use super::Commands;
use super::widgets::explained;
use crate::state::command::Command;
use crate::state::{Palette, State};
use crate::ui::registry::{self, Action, Keymap};
use crate::ui::theme;
use egui::{
    Align2, Area, Button, Frame, Id, Key, Order, Popup, RichText, ScrollArea, TextEdit, Ui, vec2,
};
use std::path::{Path, PathBuf};

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
    let mut found: Vec<Entry<'_>> = registry::found(&text)
        .into_iter()
        .map(Entry::Action)
        .collect();
    found.extend(recent(state, &text).map(Entry::Recent));
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
    let mut run = |entry: &Entry<'_>| match entry {
        Entry::Action(action) if (action.applies)(state) => {
            out.push(Command::TogglePalette);
            out.push((action.command)(state));
        }
        Entry::Action(action) if action.lacks.is_empty() => {}
        Entry::Action(action) => out.push(Command::Tell(action.lacks)),
        Entry::Recent(file) => {
            out.push(Command::TogglePalette);
            out.push(Command::Open(vec![file.to_path_buf()]));
        }
    };
    if enter && let Some(entry) = found.get(marked) {
        run(entry);
    }
    if found.is_empty() {
        ui.weak("No command has such a name");
    }
    let keymap = Keymap::of(ui.ctx());
    ScrollArea::vertical()
        .max_height(room)
        .auto_shrink([false, true])
        .show(ui, |ui| {
            for (number, entry) in found.iter().enumerate() {
                let (response, hint) = entry.show(ui, state, &keymap, number == marked);
                if number == marked && (up || down) {
                    response.scroll_to_me(None);
                }
                if response.on_hover_text(hint).clicked() {
                    run(entry);
                }
            }
        });
}

/// A line of the palette.
enum Entry<'s> {
    Action(&'static Action),
    /// A file to open that was open before.
    Recent(&'s Path),
}

impl Entry<'_> {
    /// The line as a button, and what it says when pointed at.
    fn show(
        &self,
        ui: &mut Ui,
        state: &State,
        keymap: &Keymap,
        is_marked: bool,
    ) -> (egui::Response, String) {
        let quiet = theme::colors(ui).quiet;
        let (name, beside, key, hint, lacks, applies) = match self {
            Entry::Action(action) => (
                action.name.to_owned(),
                action.menu.name().to_owned(),
                keymap.key(action),
                action.does.to_owned(),
                action.lacks,
                (action.applies)(state),
            ),
            Entry::Recent(file) => {
                let folder = file.parent().unwrap_or(file).display().to_string();
                let hint = file.display().to_string();
                (open_name(file), folder, String::new(), hint, "", true)
            }
        };
        let beside = RichText::new(beside).color(quiet).small();
        let button = Button::new((RichText::new(name), beside))
            .selected(is_marked)
            .frame_when_inactive(is_marked)
            .right_text(RichText::new(key).color(quiet))
            .truncate()
            .min_size(vec2(ui.available_width(), 0.0));
        (explained(ui.add_enabled(applies, button), lacks), hint)
    }
}

/// The recent files whose names have all words of a text; none for an empty text.
fn recent<'s>(state: &'s State, text: &str) -> impl Iterator<Item = &'s Path> {
    let text = text.to_lowercase();
    let is_found = move |file: &&Path| {
        let name = open_name(file).to_lowercase();
        let mut words = text.split_whitespace().peekable();
        words.peek().is_some() && words.all(|word| name.contains(word))
    };
    let recent = state.preferences.recent.iter();
    recent.map(PathBuf::as_path).filter(is_found)
}

fn open_name(file: &Path) -> String {
    let name = file.file_name().unwrap_or(file.as_os_str());
    format!("Open {}", name.to_string_lossy())
}
