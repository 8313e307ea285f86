//! Widgets that the panels share.

use super::Commands;
use crate::state::State;
use crate::ui::format;
use crate::ui::icons::{self, Icon};
use crate::ui::registry::{Action, Keymap};
use crate::ui::theme;
use egui::collapsing_header::paint_default_icon;
use egui::color_picker::{Alpha, color_picker_color32};
use egui::{
    Button, CollapsingHeader, Color32, DragValue, Id, Popup, PopupCloseBehavior, Response,
    RichText, Sense, TextEdit, Ui, vec2,
};
use raycast_core::scene::Color;
use std::ops::{Range, RangeInclusive};

/// The height of an icon, and the width that a title leaves for one, in points.
const ICON_SIZE: f32 = 14.0;
const ICON_WIDTH: f32 = 20.0;
/// The width of a row's label, in points.
const LABEL_WIDTH: f32 = 78.0;

/// A menu entry with an action's name and key; a click emits its command.
pub(super) fn item(ui: &mut Ui, state: &State, action: &Action, out: &mut Commands) {
    let mut name = action.name.to_owned();
    // Undo and redo name the step.
    let what = match action.id {
        "edit.undo" => state.history.undo_name(),
        "edit.redo" => state.history.redo_name(),
        _ => None,
    };
    if let Some(what) = what {
        name = format!("{name}: {what}");
    }
    let mut button = Button::new(name);
    let key = Keymap::of(ui.ctx()).key(action);
    if !key.is_empty() {
        button = button.shortcut_text(key);
    }
    if let Some(is_on) = action.is_on {
        button = button.selected(is_on(state));
    }
    let response = ui.add_enabled((action.applies)(state), button);
    if response.gained_focus() {
        response.scroll_to_me(None);
    }
    let response = explained(response, action.lacks);
    if response.on_hover_text(action.does).clicked() {
        out.push((action.command)(state));
        ui.close();
    }
}

/// Says of what cannot be chosen what it lacks.
pub(super) fn explained(response: Response, lacks: &str) -> Response {
    match lacks {
        "" => response,
        lacks => response.on_disabled_hover_text(lacks),
    }
}

/// Selects characters of a text field, before it is shown.
pub(super) fn select_text(context: &egui::Context, id: Id, characters: Range<usize>) {
    use egui::text::{CCursor, CCursorRange};
    let mut field = egui::text_edit::TextEditState::load(context, id).unwrap_or_default();
    let range = CCursorRange::two(CCursor::new(characters.start), CCursor::new(characters.end));
    field.cursor.set_char_range(Some(range));
    field.store(context, id);
}

/// Opens the part of the panel with this title when it is shown next.
pub(super) fn open_part(ui: &Ui, title: Option<&'static str>) {
    ui.data_mut(|data| data.insert_temp(Id::unique(TO_OPEN), title));
}

const TO_OPEN: &str = "part to open";

/// A collapsible part of the panel.
pub(super) fn section(
    ui: &mut Ui,
    (icon, title): (Icon, &str),
    open: bool,
    body: impl FnOnce(&mut Ui),
) {
    section_that_opens(ui, (icon, title), open, false, body);
}

/// The same; it opens and scrolls into view in a frame with `is_new`.
pub(super) fn section_that_opens(
    ui: &mut Ui,
    (icon, title): (Icon, &str),
    open: bool,
    is_new: bool,
    body: impl FnOnce(&mut Ui),
) {
    ui.add(egui::Separator::default().spacing(2.0));
    let to_open = Id::unique(TO_OPEN);
    let asked: Option<&str> = ui.data(|data| data.get_temp(to_open)).flatten();
    // Titles may go on with a count.
    let is_asked = asked.is_some_and(|asked| title.starts_with(asked));
    let is_new = is_new || is_asked;
    if is_new {
        ui.scroll_to_cursor(Some(egui::Align::Min));
    }
    // The title begins where the indent ends.
    let indent = ui.spacing().indent;
    ui.spacing_mut().indent = indent + ICON_WIDTH;
    let header = CollapsingHeader::new(RichText::new(title).strong())
        .default_open(open)
        .open(is_new.then_some(true))
        .icon(|ui, openness, response| {
            // In the middle of the old indent.
            let mut response = response.clone();
            response.rect = response.rect.translate(vec2(-ICON_WIDTH * 0.5, 0.0));
            paint_default_icon(ui, openness, &response);
        })
        .show_unindented(ui, |ui| {
            ui.spacing_mut().indent = indent;
            body(ui);
            ui.add_space(1.0);
        })
        .header_response;
    if is_asked {
        header.request_focus();
    }
    ui.spacing_mut().indent = indent;
    let center = header.rect.left_center() + vec2(indent + ICON_WIDTH * 0.5, 0.0);
    let color = theme::colors(ui).quiet;
    icons::paint(ui.painter(), center, icon, ICON_SIZE, color);
}

/// The value in the last frame that called this with the same `id`, if it was another; `at_first` in the first frame.
pub(super) fn changed_from<T: Clone + PartialEq + Send + Sync + 'static>(
    ui: &Ui,
    id: &'static str,
    now: T,
    at_first: T,
) -> Option<T> {
    let id = Id::unique(id);
    let last = ui.data(|data| data.get_temp(id)).unwrap_or(at_first);
    (last != now).then(|| {
        ui.data_mut(|data| data.insert_temp(id, now));
        last
    })
}

/// A label and its controls; `body` gets the label's id, for screen readers.
pub(super) fn row(ui: &mut Ui, name: &str, hint: &str, body: impl FnOnce(&mut Ui, Id)) {
    ui.horizontal(|ui| {
        let text = RichText::new(name).color(theme::colors(ui).quiet);
        let height = ui.spacing().interact_size.y;
        let layout = egui::Layout::left_to_right(egui::Align::Center);
        let label = ui
            .allocate_ui_with_layout(vec2(LABEL_WIDTH, height), layout, |ui| {
                ui.set_min_width(LABEL_WIDTH);
                ui.label(text).on_hover_text(hint)
            })
            .inner;
        body(ui, label.id);
    });
}

/// A label and a value that cannot be changed.
pub(super) fn fact(ui: &mut Ui, name: &str, hint: &str, value: &str) {
    row(ui, name, hint, |ui, _| {
        ui.add(egui::Label::new(value).truncate())
            .on_hover_text(hint);
    });
}

const CHOSEN: &str = "chosen by a key";

/// Whether an entry of a drop-down list was chosen. Then the list closes, which after a click it does by itself, but not
/// after a key.
pub(super) fn is_chosen(ui: &Ui, entry: &Response) -> bool {
    let is_chosen = entry.clicked();
    if is_chosen {
        ui.close();
        let by_key = !ui.input(|input| input.pointer.any_click());
        ui.data_mut(|data| data.insert_temp(Id::unique(CHOSEN), by_key));
    }
    is_chosen
}

/// Gives the keyboard back to a drop-down list after an entry was chosen by a key.
pub(super) fn list_shown(ui: &Ui, list: &Response) {
    let by_key = ui.data_mut(|data| data.remove_temp(Id::unique(CHOSEN)));
    if by_key == Some(true) {
        list.request_focus();
    }
}

/// The greatest height of a drop-down list: with fewer entries than a dozen it does not scroll, unless the window is low.
pub(super) fn list_height(ui: &Ui) -> f32 {
    (ui.ctx().content_rect().height() * 0.45).min(340.0)
}

/// A drop-down list, named by a label; returns the option that was chosen.
pub(super) fn select<T: PartialEq + Copy>(
    ui: &mut Ui,
    id: &str,
    label: Id,
    current: T,
    options: &[(T, &str, &str)],
) -> Option<T> {
    let name = options.iter().find(|(value, ..)| *value == current);
    let mut chosen = None;
    let list = egui::ComboBox::from_id_salt(id)
        .width(ui.available_width())
        .height(list_height(ui))
        .selected_text(name.map_or("", |(_, name, _)| name))
        .show_ui(ui, |ui| {
            for &(value, name, hint) in options {
                let entry = ui
                    .selectable_label(value == current, name)
                    .on_hover_text(hint);
                if is_chosen(ui, &entry) && value != current {
                    chosen = Some(value);
                }
            }
        });
    list_shown(ui, &list.response.labelled_by(label));
    chosen
}

/// A number field that can be dragged.
pub(super) struct Number<'a> {
    pub(super) value: f64,
    pub(super) range: RangeInclusive<f64>,
    pub(super) speed: f64,
    pub(super) decimals: Option<usize>,
    pub(super) suffix: &'a str,
    pub(super) width: f32,
    pub(super) hint: &'a str,
}

impl Number<'_> {
    /// Shows it; returns the new value if it was changed.
    pub(super) fn show(self, ui: &mut Ui, label: Id) -> Option<f64> {
        self.add(ui, format::length, |response| response.labelled_by(label))
    }

    /// The same in less room, with a name of its own where one label has several fields.
    pub(super) fn show_as(self, ui: &mut Ui, name: &str) -> Option<f64> {
        self.add(ui, format::short, |response| {
            response.ctx.accesskit_node_builder(response.id, |node| {
                node.set_label(name);
            });
            response
        })
    }

    fn add(
        self,
        ui: &mut Ui,
        written: fn(f64) -> String,
        named: impl FnOnce(Response) -> Response,
    ) -> Option<f64> {
        let mut value = self.value;
        let text = match self.decimals {
            Some(decimals) => format::fixed(value, decimals),
            None => written(value),
        };
        let drag = DragValue::new(&mut value)
            .range(self.range)
            .speed(self.speed)
            .suffix(self.suffix)
            .custom_parser(format::parse)
            .update_while_editing(false)
            .min_size(vec2(self.width, 0.0));
        let drag = match self.decimals {
            Some(decimals) => drag
                .fixed_decimals(decimals)
                .custom_formatter(move |value, _| format::fixed(value, decimals)),
            None => drag.custom_formatter(move |value, _| written(value)),
        };
        let response = named(ui.add(drag)).on_hover_text(self.hint);
        // A field that is clicked and left must not round the number to its displayed digits.
        let is_as_shown = format::parse(&text) == Some(value);
        (response.changed() && value != self.value && !is_as_shown).then_some(value)
    }
}

/// Options side by side, of equal width where their names have room; returns the one that was clicked.
pub(super) fn choice<T: PartialEq + Copy>(
    ui: &mut Ui,
    current: T,
    options: &[(T, &str, &str)],
) -> Option<T> {
    let (gap, padding) = (2.0, 3.0);
    let room = ui.available_width() - gap * (options.len() - 1) as f32;
    let least = |name: &str| {
        let font = egui::TextStyle::Button.resolve(ui.style());
        let color = ui.visuals().text_color();
        let line = ui.painter().layout_no_wrap(name.to_owned(), font, color);
        line.size().x + 2.0 * padding
    };
    let least: Vec<f32> = options.iter().map(|(_, name, _)| least(name)).collect();
    let equal = room / options.len() as f32;
    let spare = (room - least.iter().sum::<f32>()) / options.len() as f32;
    let is_equal = least.iter().all(|least| *least <= equal);
    let mut chosen = None;
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.x = gap;
        ui.spacing_mut().button_padding.x = padding;
        for (&(value, name, hint), least) in options.iter().zip(least) {
            let width = if is_equal {
                equal
            } else {
                least + spare.max(0.0)
            };
            let button = Button::new(name)
                .selected(value == current)
                .min_size(vec2(width, 0.0));
            if ui.add(button).on_hover_text(hint).clicked() && value != current {
                chosen = Some(value);
            }
        }
    });
    chosen
}

/// A checkbox; returns its new state if it was clicked.
pub(super) fn tick(ui: &mut Ui, on: bool, name: &str, hint: &str) -> Option<bool> {
    let mut now = on;
    ui.checkbox(&mut now, name)
        .on_hover_text(hint)
        .changed()
        .then_some(now)
}

/// An open or closed eye; returns whether it was clicked.
pub(super) fn eye(ui: &mut Ui, is_open: bool, spoken: &str) -> bool {
    let (rect, response) = ui.allocate_exact_size(vec2(18.0, 16.0), Sense::click());
    response
        .widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, is_open, spoken));
    let colors = theme::colors(ui);
    let color = match (response.hovered() || response.has_focus(), is_open) {
        (true, _) => colors.accent,
        (false, true) => colors.text,
        (false, false) => colors.quiet.gamma_multiply(0.6),
    };
    let icon = if is_open { Icon::Eye } else { Icon::EyeClosed };
    icons::paint(ui.painter(), rect.center(), icon, 14.0, color);
    response.on_hover_text(spoken).clicked()
}

/// A colour button, which opens a picker and the colour as text; returns the new colour if it was changed.
pub(super) fn color(ui: &mut Ui, current: Color, label: Id, hint: &str) -> Option<Color> {
    let [r, g, b] = current.0;
    let shown = Color32::from_rgb(r, g, b);
    // With an outline: a dark colour would not be visible on the dark panel.
    let line = egui::Stroke::new(1.0, theme::colors(ui).quiet.gamma_multiply(0.5));
    let button = Button::new("")
        .fill(shown)
        .stroke(line)
        .min_size(ui.spacing().interact_size);
    let button = ui.add(button).labelled_by(label).on_hover_text(hint);
    let picked = Popup::from_toggle_button_response(&button)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .show(|ui| {
            let mut now = shown;
            ui.spacing_mut().slider_width = 275.0;
            let is_picked = color_picker_color32(ui, &mut now, Alpha::Opaque);
            let [r, g, b, _] = now.to_array();
            let typed = color_text(ui, button.id.with("text"), current, label);
            typed.or(is_picked.then_some(Color([r, g, b])))
        });
    picked
        .and_then(|shown| shown.inner)
        .filter(|picked| *picked != current)
}

/// A colour as text, `#rrggbb` or `#rgb`; returns the new colour once another one was typed.
fn color_text(ui: &mut Ui, id: Id, current: Color, label: Id) -> Option<Color> {
    let typed: Option<String> = ui.data(|data| data.get_temp(id));
    let mut text = typed.unwrap_or_else(|| current.to_string());
    let parsed: Option<Color> = text.trim().parse().ok();
    let mut field = TextEdit::singleline(&mut text).id(id).desired_width(64.0);
    if parsed.is_none() {
        field = field.text_color(theme::colors(ui).error);
    }
    let field = ui.add(field).labelled_by(label);
    let field = field.on_hover_text("The color as #rrggbb or #rgb");
    if field.lost_focus() {
        ui.data_mut(|data| data.remove::<String>(id));
        return parsed.filter(|color| *color != current);
    }
    if field.changed() {
        ui.data_mut(|data| data.insert_temp(id, text));
    }
    None
}

/// The frame of a message over the picture.
pub(super) fn card(ui: &Ui, line: egui::Color32) -> egui::Frame {
    egui::Frame::new()
        .fill(theme::colors(ui).card)
        .stroke(egui::Stroke::new(1.0, line))
        .corner_radius(6.0)
        .inner_margin(egui::Margin::symmetric(12, 8))
}
