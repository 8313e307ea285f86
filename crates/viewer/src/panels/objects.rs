//! What is in the scene.

use super::widgets::section;
use super::{Commands, format};
use crate::app::state::State;
use crate::app::theme;
use egui::{Align, Layout, RichText, ScrollArea, Ui};

pub(super) fn show(ui: &mut Ui, state: &State, _out: &mut Commands) {
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
    });
}
