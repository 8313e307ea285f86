//! Measurements: tools, what was measured, and the size of the marked object.

use super::Commands;
use super::widgets::{changed_from, fact, row, section_that_opens, select, tick};
use crate::state::State;
use crate::state::command::Command;
use crate::state::lengths::Lengths;
use crate::state::measure::{Kind, Measurement};
use crate::ui::format;
use crate::ui::icons::Icon;
use crate::ui::registry::{self, action};
use egui::{Button, RichText, Ui, vec2};
use raycast_core::formats::LengthUnit;

pub(super) fn show(ui: &mut Ui, state: &State, out: &mut Commands) {
    let measuring = &state.measuring;
    // A tool may be started by a key or a menu, too: the part opens to show its results.
    let changed = changed_from(ui, "measuring tool", measuring.tool, None);
    let is_new = changed.is_some() && measuring.tool.is_some();
    section_that_opens(ui, (Icon::Ruler, "Measure"), false, is_new, |ui| {
        tools(ui, state, out);
        let lengths = state.lengths();
        unit(ui, state, out);
        let hint = "Points jump to a triangle's vertex that is near the cursor";
        let snaps = tick(ui, measuring.snaps, "Snap to vertices", hint);
        out.extend(snaps.map(Command::SetSnaps));
        if let Some(hint) = measuring.hint() {
            ui.weak(hint);
        }
        for (number, measurement) in measuring.list.iter().enumerate() {
            measured(ui, number, measurement, (&lengths, state.negligible()), out);
        }
        if !measuring.list.is_empty() {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 3.0;
                let copy = ui.add(Button::new("Copy as CSV").small());
                if copy
                    .on_hover_text("All of them, with all digits and the points")
                    .clicked()
                {
                    out.push(Command::Copy(measuring.csv(&state.lengths())));
                }
                for id in ["measure.save", "measure.clear"] {
                    let action = action(id);
                    let response = ui.add(Button::new(action.name).small());
                    if response
                        .on_hover_text(registry::hint(ui.ctx(), action.id))
                        .clicked()
                    {
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
            if response
                .on_hover_text(registry::hint(ui.ctx(), action.id))
                .clicked()
            {
                out.push((action.command)(state));
            }
        }
    });
}

/// The unit in which lengths are shown.
fn unit(ui: &mut Ui, state: &State, out: &mut Commands) {
    let scene = state.document.as_ref().and_then(|document| document.unit);
    let (files, hint) = match scene {
        Some(unit) => (
            format!("{} (as in the file)", unit.name()),
            "The file says what its coordinates are in: lengths are converted",
        ),
        None => (
            "scene units".to_owned(),
            "The file does not say what its coordinates are in: they are taken to be in this unit",
        ),
    };
    row(ui, "Unit", hint, |ui, label| {
        let mut options = vec![(None, files.as_str(), hint)];
        options.extend(LengthUnit::ALL.map(|unit| (Some(unit), unit.name(), unit.symbol())));
        let chosen = select(ui, "unit", label, state.preferences.unit, &options);
        out.extend(chosen.map(Command::SetUnit));
    });
}

/// The tools' ids in the registry.
const TOOLS: [&str; 4] = [
    "measure.distance",
    "measure.angle",
    "measure.path",
    "measure.radius",
];

/// A finished measurement, with its buttons.
pub(super) fn text(measurement: &Measurement, lengths: &Lengths) -> String {
    let length = |length| format!("{}{}", format::length(length), lengths.suffix(1));
    match (measurement.kind, measurement.told(lengths)) {
        (Kind::Angle, Some(degrees)) => format!("{degrees:.3}°"),
        (Kind::Radius, Some(radius)) => format!("R {}", length(radius)),
        (_, Some(along)) => length(along),
        (Kind::Radius, None) => "on a line".to_owned(),
        (_, None) => "–".to_owned(),
    }
}

fn measured(
    ui: &mut Ui,
    number: usize,
    measurement: &Measurement,
    (lengths, negligible): (&Lengths, f64),
    out: &mut Commands,
) {
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
            let shown = text(measurement, lengths);
            let button = Button::new(RichText::new(&shown).monospace()).frame(false);
            let copied = measurement.told(lengths).map(|value| value.to_string());
            let response = ui.add(button);
            if let Some(copied) = copied {
                let mut hint = format!("Click to copy: {copied}");
                if let (Kind::Distance, [a, b]) = (measurement.kind, &measurement.points[..]) {
                    let along = (*b - *a).to_array().map(|way| {
                        let way = format::coordinate(way, negligible);
                        format::length(lengths.converted(way, 1))
                    });
                    hint = format!("Along x, y, z: {}\n{hint}", along.join("  "));
                }
                if response.on_hover_text(hint).clicked() {
                    out.push(Command::Copy(copied));
                }
            }
        });
    });
}

/// The selected object's size; the scene's box if none is selected.
fn size(ui: &mut Ui, state: &State) {
    let Some(document) = &state.document else {
        return;
    };
    let lengths = state.lengths();
    let numbers = |size: raycast_core::glam::DVec3| {
        let sides = size.to_array().map(|side| lengths.converted(side, 1));
        let [x, y, z] = sides.map(format::length);
        format!("{x} × {y} × {z}{}", lengths.suffix(1))
    };
    let told = |value: f64, power| {
        let number = format::length(lengths.converted(value, power));
        format!("{number}{}", lengths.suffix(power))
    };
    let name = lengths.name();
    let scene = &document.scene;
    let marked = state.selected.and_then(|number| {
        let object = scene.objects.get(number)?;
        Some((number, object, scene.world_from_object(number).ok()?))
    });
    ui.add_space(2.0);
    let Some((number, object, world_from_object)) = marked else {
        if !document.bounds.is_empty() {
            let hint =
                format!("Of the box around all that is visible, along x, y and z, in {name}");
            fact(ui, "Scene's box", &hint, &numbers(document.bounds.size()));
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
    let hint = format!("Of the box around it, along x, y and z, in {name}");
    fact(ui, "Box", &hint, &numbers(size.bounds.size()));
    let hint = format!("Of all its triangles, in square {name}");
    fact(ui, "Area", &hint, &told(size.area, 2));
    let is_closed = state
        .inspection
        .of(scene, number)
        .map(|c| c.health.is_closed());
    let (volume, hint) = match is_closed {
        Some(false) => (
            "none: it is open".to_owned(),
            "An open mesh encloses nothing: see Health for its open edges".to_owned(),
        ),
        Some(true) => (
            told(size.volume.abs(), 3),
            format!("What it encloses, in cubic {name}"),
        ),
        None => (
            format!("{} if closed", told(size.volume.abs(), 3)),
            format!(
                "What it encloses, in cubic {name}, if it is closed: Health tells whether it is"
            ),
        ),
    };
    fact(ui, "Volume", &hint, &volume);
}
