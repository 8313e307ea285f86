//! The camera in numbers, and the bookmarks.

use super::Commands;
use super::transform::three;
use super::widgets::section;
use crate::state::State;
use crate::state::command::Command;
use crate::ui::icons::Icon;
use crate::ui::registry::{self, action};
use egui::{Button, RichText, Ui, vec2};

pub(super) fn show(ui: &mut Ui, state: &State, out: &mut Commands) {
    if state.document.is_none() {
        return;
    }
    section(ui, (Icon::Video, "Camera"), false, |ui| {
        let pose = state.viewpoint.pose();
        let speed = state.viewpoint.orbit.distance * 2e-3;
        let (eye, target) = (pose.eye, pose.target);
        let negligible = state.negligible();
        let hint = "Where the camera stands, in scene units";
        if let Some((_, eye)) = three(ui, ("Eye", hint), (eye, negligible), speed, None, "") {
            out.push(Command::SetPose { eye, target });
        }
        let hint = "What it looks at and turns about, in scene units";
        if let Some((_, target)) =
            three(ui, ("Target", hint), (target, negligible), speed, None, "")
        {
            out.push(Command::SetPose { eye, target });
        }
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 3.0;
            for id in ["view.bookmark", "view.copy"] {
                let action = action(id);
                let response = ui.add(Button::new(action.name).small());
                if response
                    .on_hover_text(registry::hint(ui.ctx(), action.id))
                    .clicked()
                {
                    out.push((action.command)(state));
                }
            }
            ui.add(egui::Label::new(RichText::new("Ctrl+V pastes").weak()).truncate());
        });
        for (number, view) in state.bookmarks.iter().enumerate() {
            ui.horizontal(|ui| {
                let name = format!("View {}", number + 1);
                let width = ui.available_width() - 30.0;
                let button = Button::new(&name)
                    .selected(*view == state.viewpoint)
                    .min_size(vec2(width, 0.0));
                if ui.add(button).on_hover_text("Go to this view").clicked() {
                    out.push(Command::GoToBookmark(number));
                }
                let remove = ui.add(Button::new("×").small());
                remove.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Forget {name}"))
                });
                if remove.on_hover_text("Forget it").clicked() {
                    out.push(Command::RemoveBookmark(number));
                }
            });
        }
    });
}
