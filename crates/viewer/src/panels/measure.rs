//! Measurements: tools, what was measured, and the size of the marked object.

use super::Commands;
use super::widgets::{fact, section, tick};
use crate::state::State;
use crate::state::command::Command;
use crate::state::measure::{Kind, Measurement};
use crate::ui::format;
use crate::ui::registry::action;
use egui::{Button, RichText, Ui, vec2};

pub(super) fn show(ui: &mut Ui, state: &State, out: &mut Commands) {
    let measuring = &state.measuring;
    section(ui, "Measure", false, |ui| {
        tools(ui, state, out);
        let hint = "Points jump to a triangle's vertex that is near the cursor";
        let snaps = tick(ui, measuring.snaps, "Snap to vertices", hint);
        out.extend(snaps.map(Command::SetSnaps));
        if let Some(tool) = measuring.tool {
            ui.weak(tool.hint());
        }
        for (number, measurement) in measuring.list.iter().enumerate() {
            measured(ui, number, measurement, out);
        }
        if !measuring.list.is_empty() {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 3.0;
                let copy = ui.add(Button::new("Copy as CSV").small());
                if copy
                    .on_hover_text("All of them, with all digits and the points")
                    .clicked()
                {
                    out.push(Command::Copy(measuring.csv()));
                }
                for id in ["measure.save", "measure.clear"] {
                    let action = action(id);
                    let response = ui.add(Button::new(action.name).small());
                    if response.on_hover_text(action.hint()).clicked() {
                        out.push((action.command)(state));
                    }
                }
            });
        }
        size(ui, state);
    });
}

fn tools(ui: &mut Ui, state: &State, out: &mut Commands) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        let width = (ui.available_width() - 6.0) / 4.0;
        for (kind, id) in Kind::ALL.into_iter().zip(TOOLS) {
            let action = action(id);
            let button = Button::new(kind.name())
                .selected(state.measuring.tool == Some(kind))
                .min_size(vec2(width, 0.0));
            let response = ui.add_enabled((action.applies)(state), button);
            if response.on_hover_text(action.hint()).clicked() {
                out.push((action.command)(state));
            }
        }
    });
}

/// The registry's names of the tools.
const TOOLS: [&str; 4] = [
    "measure.distance",
    "measure.angle",
    "measure.path",
    "measure.radius",
];

/// What a measurement says.
pub(super) fn text(measurement: &Measurement) -> String {
    match (measurement.kind, measurement.value()) {
        (Kind::Angle, Some(degrees)) => format!("{degrees:.3}°"),
        (Kind::Radius, Some(radius)) => format!("R {}", format::length(radius)),
        (_, Some(length)) => format::length(length),
        (Kind::Radius, None) => "on a line".to_owned(),
        (_, None) => "–".to_owned(),
    }
}

fn measured(ui: &mut Ui, number: usize, measurement: &Measurement, out: &mut Commands) {
    ui.horizontal(|ui| {
        let name = measurement.kind.name();
        ui.weak(format!("{} {name}", number + 1));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let remove = ui.add(Button::new("×").small());
            remove.widget_info(|| {
                let spoken = format!("Remove measurement {}", number + 1);
                egui::WidgetInfo::labeled(egui::Role::Button, true, spoken)
            });
            if remove.on_hover_text("Remove").clicked() {
                out.push(Command::RemoveMeasurement(number));
            }
            let shown = text(measurement);
            let button = Button::new(RichText::new(&shown).monospace()).frame(false);
            let copied = measurement.value().map(|value| value.to_string());
            let response = ui.add(button);
            if let Some(copied) = copied {
                let mut hint = format!("Click to copy: {copied}");
                if let (Kind::Distance, [a, b]) = (measurement.kind, &measurement.points[..]) {
                    let d = *b - *a;
                    hint = format!("Along x, y, z: {} {} {}\n{hint}", d.x, d.y, d.z);
                }
                if response.on_hover_text(hint).clicked() {
                    out.push(Command::Copy(copied));
                }
            }
        });
    });
}

/// The marked object's size; the whole scene's box where none is marked.
fn size(ui: &mut Ui, state: &State) {
    let Some(document) = &state.document else {
        return;
    };
    let numbers = |size: raycast_core::glam::DVec3| {
        let [x, y, z] = size.to_array().map(format::length);
        format!("{x} × {y} × {z}")
    };
    let scene = &document.scene;
    let marked = state.selected.and_then(|number| {
        let object = scene.objects.get(number)?;
        Some((
            number,
            object,
            *scene.world_from_objects().ok()?.get(number)?,
        ))
    });
    ui.add_space(2.0);
    let Some((number, object, world_from_object)) = marked else {
        if !document.bounds.is_empty() {
            let hint = "Of the box around all that is visible, along x, y and z, in scene units";
            fact(ui, "Scene's box", hint, &numbers(document.bounds.size()));
        }
        ui.weak("Mark an object for its area and volume");
        return;
    };
    ui.label(RichText::new(&object.name).strong());
    let Some(size) = state.inspection.size(&object.mesh, &world_from_object) else {
        ui.weak("working it out…");
        return;
    };
    if size.bounds.is_empty() {
        ui.weak("It has no triangle that can be seen");
        return;
    }
    let hint = "Of the box around it, along x, y and z, in scene units";
    fact(ui, "Box", hint, &numbers(size.bounds.size()));
    let hint = "Of all its triangles, in square scene units";
    fact(ui, "Area", hint, &format::length(size.area));
    let is_closed = state
        .inspection
        .of(scene, number)
        .map(|c| c.health.is_closed());
    let (volume, hint) = match is_closed {
        Some(false) => (
            "none: it is open".to_owned(),
            "An open mesh encloses nothing: see Health for its open edges",
        ),
        Some(true) => (
            format::length(size.volume.abs()),
            "What it encloses, in cubic scene units",
        ),
        None => (
            format!("{} if closed", format::length(size.volume.abs())),
            "What it encloses, in cubic scene units, if it is closed: Health tells whether it is",
        ),
    };
    fact(ui, "Volume", hint, &volume);
}
