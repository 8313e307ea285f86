//! The parameters of an object that is a shape.

use super::Commands;
use super::widgets::{Number, row};
use crate::state::State;
use crate::state::command::Command;
use egui::Ui;
use raycast_core::scene::Shape;

/// The most segments or rings that the fields accept.
const MOST_PARTS: f64 = 512.0;

pub(super) fn show(
    ui: &mut Ui,
    state: &State,
    (number, shape): (usize, Shape),
    out: &mut Commands,
) {
    let mut new = shape;
    ui.add_enabled_ui(!state.is_locked(number), |ui| match &mut new {
        Shape::Cube { size } => {
            let [x, y, z] = size.as_mut();
            let sides = [(x, "Side X"), (y, "Side Y"), (z, "Side Z")];
            lengths(ui, "Sides", "Its sides along x, y and z", sides);
        }
        Shape::Plane { size } => {
            let [x, z] = size.as_mut();
            let sides = [(x, "Side X"), (z, "Side Z")];
            lengths(ui, "Sides", "Its sides along x and z", sides);
        }
        Shape::Sphere {
            radius,
            segments,
            rings,
        } => {
            lengths(ui, "Radius", "From its middle", [(radius, "Its radius")]);
            parts(ui, [(segments, 3, "Segments"), (rings, 2, "Rings")]);
        }
        Shape::Cone {
            radius,
            height,
            segments,
        }
        | Shape::Cylinder {
            radius,
            height,
            segments,
        } => {
            lengths(ui, "Radius", "Of its base", [(radius, "Its radius")]);
            lengths(ui, "Height", "Along y", [(height, "Its height")]);
            parts(ui, [(segments, 3, "Segments")]);
        }
        Shape::Torus {
            radius,
            tube,
            segments,
            rings,
        } => {
            lengths(
                ui,
                "Radius",
                "To the middle of its tube",
                [(radius, "Its radius")],
            );
            lengths(ui, "Tube", "The tube's own radius", [(tube, "Its tube")]);
            parts(ui, [(segments, 3, "Segments"), (rings, 3, "Rings")]);
        }
        Shape::Disc { radius, segments } => {
            lengths(ui, "Radius", "From its middle", [(radius, "Its radius")]);
            parts(ui, [(segments, 3, "Segments")]);
        }
        Shape::Monkey { size } => {
            lengths(ui, "Size", "Half its skull's width", [(size, "Its size")]);
        }
        Shape::Dahlia { size, petals } => {
            lengths(ui, "Size", "The bloom's radius", [(size, "Its size")]);
            parts_named(ui, "Petals", "Of the bloom", [(petals, 1, "Petals")]);
        }
    });
    if new != shape {
        out.push(Command::SetShape(number, new));
    }
}

/// A row of lengths above zero.
fn lengths<const N: usize>(ui: &mut Ui, name: &str, hint: &str, of: [(&mut f64, &str); N]) {
    row(ui, name, hint, |ui, _| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let width = (ui.available_width() - 3.0 * (N - 1) as f32) / N as f32;
        for (length, spoken) in of {
            let number = Number {
                value: *length,
                range: f64::MIN_POSITIVE..=f64::INFINITY,
                speed: (*length * 0.01).max(f64::MIN_POSITIVE),
                decimals: None,
                suffix: "",
                width,
                hint,
            };
            if let Some(new) = number.show_as(ui, spoken) {
                *length = new;
            }
        }
    });
}

/// A row of segments and rings, each with its least number.
fn parts<const N: usize>(ui: &mut Ui, of: [(&mut u32, u32, &str); N]) {
    parts_named(ui, "Parts", "How many parts it has around, and across", of);
}

/// A row of numbers of parts, each with its least one.
fn parts_named<const N: usize>(
    ui: &mut Ui,
    name: &str,
    hint: &str,
    of: [(&mut u32, u32, &str); N],
) {
    row(ui, name, hint, |ui, _| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let width = (ui.available_width() - 3.0 * (N - 1) as f32) / N as f32;
        for (parts, least, spoken) in of {
            let number = Number {
                value: f64::from(*parts),
                range: f64::from(least)..=MOST_PARTS.max(f64::from(*parts)),
                speed: 0.5,
                decimals: Some(0),
                suffix: "",
                width,
                hint,
            };
            if let Some(new) = number.show_as(ui, spoken) {
                *parts = new as u32;
            }
        }
    });
}
