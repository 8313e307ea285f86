//! The lights, and defaults for meshes without normals or colors.

use super::Commands;
use super::widgets::{Number, color, row, select, tick};
use crate::state::State;
use crate::state::command::Command;
use egui::Ui;
use raycast_core::shade::{LightSet, Shading};

pub(super) fn rows(ui: &mut Ui, state: &State, out: &mut Commands) {
    let shading = &state.settings.shading;
    row(
        ui,
        "Lights",
        "Lights that move with the camera",
        |ui, label| {
            let options = [
                (
                    LightSet::ThreePoint,
                    "Key, fill and rim",
                    "A photographer's: warm from the left, cool from the right, and from behind",
                ),
                (
                    LightSet::Soft,
                    "Soft",
                    "One light from the upper left with a soft shadow side",
                ),
                (
                    LightSet::Headlight,
                    "Headlight",
                    "One light at the eye: brightness tells the angle of the surface",
                ),
            ];
            out.extend(
                select(ui, "lights", label, shading.lights, &options).map(Command::SetLights),
            );
        },
    );
    row(
        ui,
        "Edges",
        "How edges look in meshes without normals",
        |ui, label| {
            let hint = "Round off edges whose triangles are nearly in one plane; else each triangle is flat";
            let is_smooth = shading.crease > 0.0;
            out.extend(
                tick(ui, is_smooth, "Smooth", hint)
                    .map(|on| Command::SetCrease(if on { Shading::studio().crease } else { 0.0 })),
            );
            if is_smooth {
                let number = Number {
                    value: f64::from(shading.crease),
                    range: 1.0..=180.0,
                    speed: 0.5,
                    decimals: Some(0),
                    suffix: "°",
                    width: 52.0,
                    hint: "The angle between two triangles above which their edge stays sharp",
                };
                let changed = number.show(ui, label);
                out.extend(changed.map(|degrees| Command::SetCrease(degrees as f32)));
            }
        },
    );
    row(
        ui,
        "Plain color",
        "The color of what has none of its own",
        |ui, label| {
            let hint = "The color of what has none of its own";
            out.extend(color(ui, shading.plain_color, label, hint).map(Command::SetPlainColor));
        },
    );
}
