//! Size, step and field of view; two of them determine the third.

use super::Commands;
use super::widgets::{Number, choice, row, section, select};
use crate::state::command::Command;
use crate::state::viewpoint::fov_range;
use crate::state::{Resolution, SAMPLES_LIMIT, State};
use crate::ui::format;
use crate::ui::icons::Icon;
use crate::ui::registry::{self, action};
use egui::Ui;
use raycast_core::camera::{FrameLock, Panorama, PixelFilter, Projection};
use raycast_core::ranges::FURTHEST_SHIFT;

pub(super) fn show(ui: &mut Ui, state: &State, out: &mut Commands) {
    section(ui, (Icon::Image, "Picture"), false, |ui| {
        size(ui, state, out);
        step(ui, state, out);
        frame(ui, state, out);
        row(
            ui,
            "On new step",
            "What stays when the step changes",
            |ui, _| {
                let options = [
                    (
                        FrameLock::KeepFrame,
                        "Keep frame",
                        "Half the step doubles the resolution: the view stays",
                    ),
                    (
                        FrameLock::KeepResolution,
                        "Keep size",
                        "Half the step zooms in: the frame shrinks, the resolution stays",
                    ),
                ];
                out.extend(choice(ui, state.lock, &options).map(Command::SetLock));
            },
        );
        row(
            ui,
            "Projection",
            "How rays leave the camera",
            |ui, label| {
                let current = state.viewpoint.projection;
                let mut options = PROJECTIONS.to_vec();
                if current.lens().is_some() {
                    options.push((current, "Lens", "The calibrated lens of the scene's file"));
                }
                let projection = select(ui, "projection", label, current, &options);
                out.extend(projection.map(Command::SetProjection));
            },
        );
        shift(ui, state, out);
        row(
            ui,
            "Samples",
            "Rays a pixel: more make edges smooth",
            |ui, label| {
                let number = Number {
                    value: f64::from(state.rest_samples()),
                    range: 1.0..=f64::from(SAMPLES_LIMIT),
                    speed: 0.05,
                    decimals: Some(0),
                    suffix: "",
                    width: 58.0,
                    hint: "Rays a pixel: more make edges smooth",
                };
                out.extend(
                    number
                        .show(ui, label)
                        .map(|n| Command::SetSamples(Some(n.round() as u32))),
                );
                let is_automatic = state.samples.is_none();
                let button = egui::Button::new("Automatic")
                    .selected(is_automatic)
                    .min_size(egui::vec2(ui.available_width(), 0.0));
                let hint = "One while things move, 16 when nothing does and each pixel of the window has a ray, or the size was typed";
                if ui.add(button).on_hover_text(hint).clicked() && !is_automatic {
                    out.push(Command::SetSamples(None));
                }
            },
        );
        row(
            ui,
            "Pixel filter",
            "How a pixel's samples are weighed by their place",
            |ui, label| {
                let filter = state.settings.pixel_filter;
                let chosen = select(ui, "pixel filter", label, filter, &PIXEL_FILTERS);
                out.extend(chosen.map(Command::SetPixelFilter));
            },
        );
    });
}

const PIXEL_FILTERS: [(PixelFilter, &str, &str); 4] = [
    (
        PixelFilter::Box,
        "Box",
        "The pixel's square, all of it alike",
    ),
    (
        PixelFilter::Tent,
        "Tent",
        "Less towards the neighbours' middles: soft",
    ),
    (
        PixelFilter::Mitchell,
        "Mitchell",
        "Two pixels wide: sharp edges with little ringing",
    ),
    (
        PixelFilter::Gaussian,
        "Gaussian",
        "A pixel and a half wide: the softest",
    ),
];

/// The frame's shift off the view axis. Panoramas have none: a scene's shift is kept, and a note says so.
fn shift(ui: &mut Ui, state: &State, out: &mut Commands) {
    let [right, up] = state.shift;
    let hint = "How far the frame is off the view axis, to the right and up, in heights of the frame: upright lines \
                stay upright in a picture that looks straight ahead and is shifted up";
    if !state.can_shift() {
        if state.shift != [0.0; 2] {
            row(ui, "Shift", hint, |ui, _| {
                ui.weak("Panoramas have none: left out");
            });
        }
        return;
    }
    row(ui, "Shift", hint, |ui, _| {
        let part = |value: f64, hint| Number {
            value,
            range: -FURTHEST_SHIFT..=FURTHEST_SHIFT,
            speed: 0.005,
            decimals: Some(3),
            suffix: "",
            width: 58.0,
            hint,
        };
        if let Some(right) = part(right, "To the right").show_as(ui, "Shift to the right") {
            out.push(Command::SetShift([right, up]));
        }
        if let Some(up) = part(up, "Up").show_as(ui, "Shift up") {
            out.push(Command::SetShift([right, up]));
        }
    });
}

fn size(ui: &mut Ui, state: &State, out: &mut Commands) {
    let (columns, rows) = state.size();
    row(ui, "Resolution", "Columns × rows of rays", |ui, label| {
        let side = |value: u32, hint| Number {
            value: f64::from(value),
            range: 1.0..=f64::from(state.side_limit),
            speed: 2.0,
            decimals: Some(0),
            suffix: "",
            width: 50.0,
            hint,
        };
        ui.spacing_mut().item_spacing.x = 4.0;
        if let Some(columns) = side(columns, "Columns of rays").show(ui, label) {
            out.push(Command::SetSize(columns.round() as u32, rows));
        }
        ui.weak("×");
        if let Some(rows) = side(rows, "Rows of rays").show(ui, label) {
            out.push(Command::SetSize(columns, rows.round() as u32));
        }
        let fits = state.resolution == Resolution::Window { density: 1.0 };
        let button = egui::Button::new("Fit")
            .selected(fits)
            .min_size(egui::vec2(ui.available_width(), 0.0));
        let hint = "A ray for each pixel of the window, whatever its size";
        let response = ui.add(button).on_hover_text(hint);
        response.widget_info(|| {
            egui::WidgetInfo::selected(egui::Role::Button, true, fits, "Fit the window")
        });
        if response.clicked() {
            out.push(Command::FitWindow);
        }
    });
}

fn step(ui: &mut Ui, state: &State, out: &mut Commands) {
    let Ok(plane) = state.plane() else {
        return;
    };
    row(
        ui,
        "Step",
        "The distance between neighbouring rays at the target, in scene units",
        |ui, label| {
            let number = Number {
                value: plane.step,
                range: f64::MIN_POSITIVE..=f64::MAX,
                speed: plane.step * 0.01,
                decimals: None,
                suffix: "",
                width: 90.0,
                hint: "The distance between neighbouring rays at the target, in scene units. Smaller is denser.",
            };
            out.extend(number.show(ui, label).map(Command::SetStep));
            let side = egui::vec2(24.0, 0.0);
            for (name, id) in [("÷2", "look.denser"), ("×2", "look.sparser")] {
                let action = action(id);
                let response = ui
                    .add(egui::Button::new(name).min_size(side))
                    .on_hover_text(registry::hint(ui.ctx(), id));
                let role = egui::Role::Button;
                response.widget_info(|| egui::WidgetInfo::labeled(role, true, action.name));
                if response.clicked() {
                    out.push((action.command)(state));
                }
            }
        },
    );
}

/// Projections, their names, and what they are.
const PROJECTIONS: [(Projection, &str, &str); 9] = [
    (
        Projection::Perspective,
        "Perspective",
        "All rays from the eye",
    ),
    (
        Projection::Orthographic,
        "Orthographic",
        "Rays side by side",
    ),
    (
        Projection::Panoramic(Panorama::Equirectangular),
        "Equirectangular",
        "All around: longitude to the right, latitude up",
    ),
    (
        Projection::Panoramic(Panorama::Cylindrical),
        "Cylindrical",
        "All around, on a cylinder: upright lines stay straight",
    ),
    (
        Projection::Panoramic(Panorama::Equidistant),
        "Fisheye",
        "By the angle from the middle",
    ),
    (
        Projection::Panoramic(Panorama::Equisolid),
        "Fisheye, equisolid",
        "True to area, as most lenses are",
    ),
    (
        Projection::Panoramic(Panorama::Stereographic),
        "Fisheye, stereographic",
        "True to shape",
    ),
    (
        Projection::Panoramic(Panorama::CubeStrip),
        "Cube map, strip",
        "Right, left, up, down, front and back side by side",
    ),
    (
        Projection::Panoramic(Panorama::CubeCross),
        "Cube map, cross",
        "Six faces around the front one",
    ),
];

fn frame(ui: &mut Ui, state: &State, out: &mut Commands) {
    match state.viewpoint.projection {
        projection @ (Projection::Perspective | Projection::Panoramic(_)) => {
            row(ui, "FOV", "The vertical field of view", |ui, label| {
                let (narrowest, widest) = fov_range(projection);
                let number = Number {
                    value: state.viewpoint.fov,
                    range: narrowest..=widest,
                    speed: 0.2,
                    decimals: Some(2),
                    suffix: "°",
                    width: 70.0,
                    hint: "The vertical field of view, in degrees",
                };
                out.extend(number.show(ui, label).map(Command::SetFov));
                ui.weak(format!("frame {}", format::length(state.frame_height())))
                    .on_hover_text("The frame's height at the target, in scene units: rows × step");
            })
        }
        Projection::Orthographic => {
            let height = state.frame_height();
            row(
                ui,
                "Frame",
                "The frame's height, in scene units",
                |ui, label| {
                    let number = Number {
                        value: height,
                        range: f64::MIN_POSITIVE..=f64::MAX,
                        speed: height * 0.01,
                        decimals: None,
                        suffix: "",
                        width: 90.0,
                        hint: "The frame's height, in scene units: rows × step",
                    };
                    out.extend(number.show(ui, label).map(Command::SetFrame));
                    ui.weak("high");
                },
            );
        }
    }
}
