//! The selected object's transform, in numbers.

use super::Commands;
use super::widgets::{Number, choice, row};
use crate::state::State;
use crate::state::command::Command;
use crate::state::turn::Turning;
use crate::ui::format;
use crate::ui::registry::{self, action};
use egui::{Button, Ui, vec2};
use raycast_core::glam::DVec3;
use raycast_core::scene::{Object, Transform};

const AXES: [&str; 3] = ["X", "Y", "Z"];

pub(super) fn show(ui: &mut Ui, state: &State, number: usize, object: &Object, out: &mut Commands) {
    ui.add_enabled_ui(!state.is_locked(number), |ui| {
        let transform = object.transform;
        let mut put = |transform| out.push(Command::SetTransform(number, transform));
        // Dragging by a point changes a position by a thousandth of the scene's size.
        let speed = state.extent() * 1e-3;
        let hint = "Where it is put, in scene units";
        let moved = three(
            ui,
            ("Move", hint),
            (transform.translate, state.negligible()),
            speed,
            None,
            "",
        );
        if let Some((_, translate)) = moved {
            put(Transform {
                translate,
                ..transform
            });
        }
        let hint = "Angles about x, then y, then z, in degrees";
        let turned = three(
            ui,
            ("Rotate", hint),
            (transform.rotate, 0.0),
            0.5,
            Some(1),
            "°",
        );
        if let Some((_, rotate)) = turned {
            put(Transform {
                rotate,
                ..transform
            });
        }
        let hint = "Factors along its axes; a negative one mirrors";
        let scaled = three(
            ui,
            ("Scale", hint),
            (transform.scale, 0.0),
            0.01,
            Some(3),
            "",
        );
        if let Some((axis, scale)) = scaled {
            let factor = scale[axis] / transform.scale[axis];
            let scale = match state.turning.keeps_shape {
                true => transform.scale * factor,
                false => scale,
            };
            put(Transform { scale, ..transform });
        }
        turn(ui, state, number, out);
    });
    handles(ui, state, out);
}

/// Buttons for the handles in the picture.
fn handles(ui: &mut Ui, state: &State, out: &mut Commands) {
    row(ui, "Handles", "Handles in the picture, to drag", |ui, _| {
        ui.spacing_mut().item_spacing.x = 2.0;
        let width = (ui.available_width() - 4.0) / 3.0;
        for (name, id) in [
            ("Move", "object.move"),
            ("Turn", "object.turn"),
            ("Scale", "object.scale"),
        ] {
            let action = action(id);
            let is_on = action.is_on.is_some_and(|is_on| is_on(state));
            let button = Button::new(name).selected(is_on).min_size(vec2(width, 0.0));
            let response = ui.add_enabled((action.applies)(state), button);
            response.widget_info(|| {
                egui::WidgetInfo::selected(egui::Role::Button, true, is_on, action.name)
            });
            let hint = registry::hint(ui.ctx(), id);
            if response.on_hover_text(hint).clicked() {
                out.push((action.command)(state));
            }
        }
    });
}

fn turn(ui: &mut Ui, state: &State, number: usize, out: &mut Commands) {
    let turning = state.turning;
    row(ui, "Turn by", "Turn it about its middle", |ui, label| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let degrees = Number {
            value: turning.degrees,
            range: -360.0..=360.0,
            speed: 0.5,
            decimals: Some(1),
            suffix: "°",
            width: 54.0,
            hint: "How far a click turns",
        };
        if let Some(degrees) = degrees.show(ui, label) {
            out.push(Command::SetTurning(Turning { degrees, ..turning }));
        }
        let width = (ui.available_width() - 6.0) / 3.0;
        for (axis, name) in AXES.iter().enumerate() {
            let whose = if turning.own {
                "its own"
            } else {
                "the scene's"
            };
            let spoken = format!("Turn about {whose} {name}");
            let response = ui.add(Button::new(*name).min_size(vec2(width, 0.0)));
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &spoken));
            if response.on_hover_text(spoken.as_str()).clicked() {
                out.push(Command::Turn(number, axis));
            }
        }
    });
    row(ui, "About", "Whose axes it is turned about", |ui, _| {
        let options = [
            (
                false,
                "Scene's axes",
                "Turn about the axes in the corner of the picture",
            ),
            (
                true,
                "Its own",
                "Turn about the axes of the object as it stands",
            ),
        ];
        if let Some(own) = choice(ui, turning.own, &options) {
            out.push(Command::SetTurning(Turning { own, ..turning }));
        }
    });
    row(
        ui,
        "Scaling",
        "What a change of one factor does to the others",
        |ui, _| {
            let options = [
                (true, "Keeps shape", "All three factors change alike"),
                (false, "Each axis", "Each factor by itself"),
            ];
            if let Some(keeps_shape) = choice(ui, turning.keeps_shape, &options) {
                out.push(Command::SetTurning(Turning {
                    keeps_shape,
                    ..turning
                }));
            }
        },
    );
}

/// Three numbers, 0 where they are `negligible`; returns the index of the changed one, and all three with the change.
pub(super) fn three(
    ui: &mut Ui,
    (name, hint): (&str, &str),
    (value, negligible): (DVec3, f64),
    speed: f64,
    decimals: Option<usize>,
    suffix: &str,
) -> Option<(usize, DVec3)> {
    let mut changed = None;
    row(ui, name, hint, |ui, _| {
        ui.spacing_mut().item_spacing.x = 3.0;
        ui.spacing_mut().button_padding.x = 2.0;
        let width = (ui.available_width() - 6.0) / 3.0;
        for (axis, letter) in AXES.iter().enumerate() {
            let number = Number {
                value: format::coordinate(value[axis], negligible),
                range: f64::MIN..=f64::MAX,
                speed,
                decimals,
                suffix,
                width,
                hint: &format!("{hint}: {letter}. Drag, or click to type"),
            };
            if let Some(number) = number.show_as(ui, &format!("{name} {letter}")) {
                let mut next = value;
                next[axis] = number;
                changed = Some((axis, next));
            }
        }
    });
    changed
}
