//! The groups of the marked object's mesh.

use super::Commands;
use super::widgets::eye;
use crate::state::State;
use crate::state::command::Command;
use crate::state::groups;
use crate::ui::format;
use crate::ui::theme;
use egui::{Align, Button, CollapsingHeader, Layout, RichText, ScrollArea, Ui, vec2};
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
    // A group of all triangles is the object.
    if all.len() < 2 && object.hidden_groups.is_none() {
        return;
    }
    let hidden = all.iter();
    let hidden = hidden.filter(|(name, _)| groups::is_hidden(object, name));
    let count = format::count(all.len() as u64);
    let title = match hidden.count() {
        0 => format!("Groups ({count})"),
        hidden => format!("Groups ({count}, {} hidden)", format::count(hidden as u64)),
    };
    // The id does not depend on the title, which changes: the list stays open or closed.
    let header = CollapsingHeader::new(title).id_salt("groups");
    header.show(ui, |ui| {
        let height = ui.spacing().interact_size.y;
        let spacing = ui.spacing().item_spacing.y;
        let list = ScrollArea::vertical()
            .id_salt("list of groups")
            .max_height(ROWS * (height + spacing) - spacing)
            .auto_shrink([false, true]);
        list.show_rows(ui, height, all.len(), |ui, rows| {
            for row in rows {
                ui.push_id(row, |ui| {
                    group_row(ui, state, (number, object), all[row], out);
                });
            }
        });
    });
}

fn group_row(
    ui: &mut Ui,
    state: &State,
    (number, object): (usize, &Object),
    (name, triangles): (&str, usize),
    out: &mut Commands,
) {
    let colors = theme::colors(ui);
    let is_visible = !groups::is_hidden(object, name);
    let shown = if name.is_empty() { NONE } else { name };
    let picked = state.picks.current();
    let picked = picked.and_then(|pinned| groups::picked(state, pinned));
    let is_picked = picked == Some((number, name));
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
