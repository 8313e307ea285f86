//! The groups of the marked object's mesh.

use super::Commands;
use super::widgets::eye;
use crate::state::State;
use crate::state::command::Command;
use crate::state::groups;
use crate::ui::format;
use crate::ui::theme;
use egui::{Align, Button, CollapsingHeader, Id, Layout, RichText, ScrollArea, Ui, vec2};
use raycast_core::scene::Object;

/// The most rows before the list scrolls.
const ROWS: f32 = 6.0;

/// What the triangles in no group are called.
const NONE: &str = "In no group";

pub(super) fn show(
    ui: &mut Ui,
    state: &State,
    (number, object): (usize, &Object),
    out: &mut Commands,
) {
    let all = groups::sizes(object);
    let hidden = (object.hidden_groups.as_ref()).map_or(0, |hidden| hidden.names().len());
    // A group of all triangles is the object.
    if all.len() < 2 && hidden == 0 {
        return;
    }
    let count = format::count(all.len() as u64);
    let title = match hidden {
        0 => format!("Groups ({count})"),
        _ => format!("Groups ({count}, {} hidden)", format::count(hidden as u64)),
    };
    // The id does not depend on the title, which changes: the list stays open or closed.
    let header = CollapsingHeader::new(title).id_salt("groups");
    header.show(ui, |ui| {
        let height = ui.spacing().interact_size.y;
        let row = height + ui.spacing().item_spacing.y;
        let most = ROWS * row - ui.spacing().item_spacing.y;
        let mut list = ScrollArea::vertical()
            .id_salt("list of groups")
            .max_height(most)
            .auto_shrink([false, true]);
        let picked = state.picks.current();
        let picked = picked.and_then(|pinned| groups::picked(state, pinned));
        let picked = picked.filter(|(of, _)| *of == number).map(|(_, name)| name);
        // The group that was picked last is scrolled into view.
        let last = Id::unique("picked group");
        let now = picked.map(|name| (number, name.to_owned()));
        if ui.data(|data| data.get_temp(last)) != Some(now.clone()) {
            ui.data_mut(|data| data.insert_temp(last, now));
            let at = all.iter().position(|(name, _)| Some(*name) == picked);
            if let Some(at) = at {
                list = list.vertical_scroll_offset((at as f32 * row - most * 0.4).max(0.0));
            }
        }
        list.show_rows(ui, height, all.len(), |ui, rows| {
            for row in rows {
                ui.push_id(row, |ui| {
                    let is_picked = picked == Some(all[row].0);
                    group_row(ui, (number, object), all[row], is_picked, out);
                });
            }
        });
    });
}

fn group_row(
    ui: &mut Ui,
    (number, object): (usize, &Object),
    (name, triangles): (&str, usize),
    is_picked: bool,
    out: &mut Commands,
) {
    let colors = theme::colors(ui);
    let is_visible = !groups::is_hidden(object, name);
    let shown = if name.is_empty() { NONE } else { name };
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let hint = if is_visible { "Hide" } else { "Show" };
        if eye(ui, is_visible, &format!("{hint} {shown}")) {
            out.push(Command::SetGroupVisible {
                object: number,
                group: name.to_owned(),
                visible: !is_visible,
            });
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.weak(format::count(triangles as u64))
                .on_hover_text("Triangles");
            let color = if is_visible {
                colors.text
            } else {
                colors.quiet
            };
            let button = Button::new(RichText::new(shown).color(color))
                .selected(is_picked)
                .frame_when_inactive(is_picked)
                .truncate()
                // Aligns the name to the left.
                .right_text("")
                .min_size(vec2(ui.available_width(), 0.0));
            let response = ui.add(button);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, shown));
            let hint = "Show this group alone; once more shows all";
            if response.on_hover_text(hint).clicked() {
                out.push(Command::IsolateGroup {
                    object: number,
                    group: name.to_owned(),
                });
            }
        });
    });
}
