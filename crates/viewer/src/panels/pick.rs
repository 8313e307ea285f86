//! What was clicked on: each value is copied by a click.

use super::Commands;
use super::widgets::{row, section};
use crate::state::State;
use crate::state::command::Command;
use crate::state::pick::Pinned;
use crate::ui::format;
use egui::{Button, RichText, Ui};
use raycast_core::glam::DVec3;

pub(super) fn show(ui: &mut Ui, state: &State, out: &mut Commands) {
    let Some(pinned) = &state.pinned else {
        return;
    };
    section(ui, "Pick", true, |ui| {
        for Value {
            name,
            hint,
            shown,
            copied,
        } in values(pinned)
        {
            row(ui, name, hint, |ui, label| {
                let text = RichText::new(shown).monospace();
                let button = Button::new(text).frame(false).truncate();
                let response = ui.add(button).labelled_by(label);
                let hint = format!("{hint}. Click to copy: {copied}");
                if response.on_hover_text(hint).clicked() {
                    out.push(Command::Copy(copied));
                }
            });
        }
        row(ui, "", "", |ui, _| {
            let all = values(pinned)
                .into_iter()
                .map(|value| format!("{}: {}", value.name, value.copied));
            if ui.button("Copy all").clicked() {
                out.push(Command::Copy(all.collect::<Vec<_>>().join("\n")));
            }
            if ui.button("Let go").on_hover_text("Let go (Esc)").clicked() {
                out.push(Command::Unpin);
            }
        });
    });
}

/// A value as it is shown, and as it is copied: all its digits.
struct Value {
    name: &'static str,
    hint: &'static str,
    shown: String,
    copied: String,
}

fn values(pinned: &Pinned) -> Vec<Value> {
    let value = |name, hint, shown: String, copied: String| Value {
        name,
        hint,
        shown,
        copied,
    };
    let hit = &pinned.pick.hit;
    let point = |p: DVec3| format!("{} {} {}", p.x, p.y, p.z);
    let short = |p: DVec3| {
        let [x, y, z] = p.to_array().map(format::length);
        format!("{x} {y} {z}")
    };
    let direction = |n: DVec3| {
        // No minus before what is shown as zero.
        let [x, y, z] = n.to_array().map(|c| (c * 1e4).round() * 1e-4 + 0.0);
        format!("{x:.4} {y:.4} {z:.4}")
    };
    let mut values = vec![
        value(
            "Object",
            "The object's name",
            pinned.object.clone(),
            pinned.object.clone(),
        ),
        value(
            "Triangle",
            "The triangle's number in its file",
            format::count(hit.triangle.into()),
            hit.triangle.to_string(),
        ),
        value(
            "Point",
            match pinned.has_moved {
                true => "Where it is now, in the scene's coordinates",
                false => "Where the ray met it, in the scene's coordinates",
            },
            short(pinned.pick.point),
            point(pinned.pick.point),
        ),
        value(
            "Normal",
            "The direction of the triangle's plane",
            direction(pinned.normal),
            point(pinned.normal),
        ),
        value(
            "Weights",
            "u and v: the weights of the second and the third corner",
            format!("{:.5} {:.5}", hit.u, hit.v),
            format!("{} {}", hit.u, hit.v),
        ),
    ];
    if !pinned.has_moved {
        let distance = value(
            "Distance",
            "From the eye to the point",
            format::length(hit.t),
            hit.t.to_string(),
        );
        values.insert(4, distance);
    }
    if let Some(uv) = pinned.uv {
        values.push(value(
            "UV",
            "Texture coordinates",
            format!("{:.5} {:.5}", uv.x, uv.y),
            format!("{} {}", uv.x, uv.y),
        ));
    }
    values.push(value(
        "Color",
        "The triangle's own color",
        pinned.color.to_string(),
        pinned.color.to_string(),
    ));
    values
}
