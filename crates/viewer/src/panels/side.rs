//! The side panel: everyday parts first; parts for experts are closed at first.

use super::widgets::{changed_from, open_part};
use super::{
    Commands, Status, camera, cut, health, look, measure, objects, pick, picture, render, surface,
    tiles,
};
use crate::state::State;
use crate::state::part::Part;
use egui::{ScrollArea, Ui, UiBuilder};

/// The panel's width, in points.
pub(super) const WIDTH: f32 = 288.0;

/// Shows it.
pub(super) fn show(ui: &mut Ui, state: &State, status: &Status, out: &mut Commands) {
    let asked = changed_from(ui, "part", state.part, Default::default());
    if asked.is_some() {
        open_part(ui, state.part.0.map(Part::title));
    }
    // A child cannot widen the panel: the picture, whose width is the rest, would move under the cursor.
    let room = ui.available_rect_before_wrap();
    let mut content = ui.new_child(UiBuilder::new().max_rect(room));
    ui.advance_cursor_after_rect(room);
    ScrollArea::vertical()
        .auto_shrink([false, false])
        .show(&mut content, |ui| {
            objects::show(ui, state, out);
            pick::show(ui, state, out);
            look::show(ui, state, out);
            measure::show(ui, state, out);
            cut::show(ui, state, out);
            health::show(ui, state, out);
            surface::show(ui, state, out);
            camera::show(ui, state, out);
            picture::show(ui, state, out);
            tiles::show(ui, state, status, out);
            render::show(ui, state, status, out);
        });
    open_part(ui, None);
}
