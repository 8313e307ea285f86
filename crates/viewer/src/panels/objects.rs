//! What is in the scene, and what may be put there to see where ray casters go wrong.

use super::Commands;
use super::widgets::section;
use crate::state::State;
use crate::state::command::Command;
use crate::ui::format;
use crate::ui::theme;
use egui::{Align, Layout, RichText, ScrollArea, Ui};
use raycast_report::cases::{self, Theme};

pub(super) fn show(ui: &mut Ui, state: &State, out: &mut Commands) {
    let Some(document) = &state.document else {
        return;
    };
    let objects = &document.scene.objects;
    let title = format!("Objects ({})", format::count(objects.len() as u64));
    section(ui, &title, true, |ui| {
        let height = ui.spacing().interact_size.y;
        ScrollArea::vertical()
            .id_salt("objects")
            .max_height(150.0)
            .auto_shrink([false, true])
            .show_rows(ui, height - 3.0, objects.len(), |ui, rows| {
                for object in &objects[rows] {
                    let mesh = &object.mesh;
                    let dropped = mesh.dropped();
                    ui.horizontal(|ui| {
                        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                            let count = format::count(mesh.triangles().len() as u64);
                            ui.weak(count).on_hover_text("Triangles");
                            if dropped.total() > 0 {
                                let text = format!("−{}", format::count(dropped.total().into()));
                                ui.label(RichText::new(text).color(theme::ERROR)).on_hover_text(
                                    format!(
                                        "Left out, because no ray could meet them: {} not finite, {} out of range, {} with an index that there is not, {} without area",
                                        dropped.not_finite, dropped.too_far, dropped.bad_index, dropped.zero_area
                                    ),
                                );
                            }
                            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                                ui.add(egui::Label::new(&object.name).truncate())
                                    .on_hover_text(&object.name);
                            });
                        });
                    });
                }
            });
        hard_cases(ui, out);
    });
}

/// A menu of the hard cases, theme by theme.
fn hard_cases(ui: &mut Ui, out: &mut Commands) {
    let menu = ui.menu_button("Open hard case…", |ui| {
        for theme in Theme::ALL {
            ui.menu_button(theme.name(), |ui| {
                for case in cases::all().iter().filter(|case| case.theme == theme) {
                    let item = ui.button(case.title()).on_hover_text(case.trouble);
                    if item.clicked() {
                        out.push(Command::OpenCase(case.name));
                        ui.close();
                    }
                }
            });
        }
    });
    menu.response
        .on_hover_text("Scenes at which known ray casters go wrong");
}
