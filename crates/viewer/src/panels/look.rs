//! The everyday settings of the look: mode, lines, colours, texture, background.

use super::widgets::{Number, color, row, section, select, tick};
use super::{Commands, colors};
use crate::state::PromptKind;
use crate::state::State;
use crate::state::command::Command;
use crate::ui::icons::Icon;
use crate::ui::mode_pictures;
use crate::ui::modes::MODES;
use crate::ui::registry;
use egui::{Button, Image, RichText, Ui, vec2};
use raycast_core::ranges::{FURTHEST_GROUND, WIDEST_LINE};
use raycast_core::shade::{Background, EdgeKinds, Ground, Mode, Wireframe};

pub(super) fn show(ui: &mut Ui, state: &State, out: &mut Commands) {
    section(ui, (Icon::Palette, "Look"), true, |ui| {
        modes(ui, state, out);
        if state.settings.shading.mode == Mode::XRay {
            x_ray(ui, state, out);
        }
        lines(ui, state, out);
        colors::show(ui, state, out);
        texture(ui, state, out);
        background(ui, state, out);
        ground(ui, state, out);
    });
}

/// Columns of the modes' buttons, and the gap between them in points.
const COLUMNS: usize = 3;
const GAP: f32 = 2.0;
/// The picture of a mode, its name's letters, and the space between the two, in points: the longest name leaves a
/// margin on both sides.
const PICTURE: f32 = 17.0;
const TEXT: f32 = 11.0;
const BESIDE: f32 = 3.0;

/// The width of a mode's button in a panel of this width.
fn mode_width(room: f32) -> f32 {
    (room - GAP * (COLUMNS - 1) as f32) / COLUMNS as f32
}

/// Three columns of buttons, each with a small picture of what it shows.
fn modes(ui: &mut Ui, state: &State, out: &mut Commands) {
    const HEIGHT: f32 = 20.0;
    let width = mode_width(ui.available_width());
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing = vec2(GAP, GAP);
        ui.spacing_mut().button_padding = vec2(2.0, 0.0);
        ui.spacing_mut().icon_spacing = BESIDE;
        for (line, modes) in MODES.chunks(COLUMNS).enumerate() {
            ui.horizontal(|ui| {
                for (column, &(mode, name, _)) in modes.iter().enumerate() {
                    let picture = mode_pictures::of(ui.ctx(), mode).map(|texture| {
                        Image::from_texture(&texture).fit_to_exact_size(vec2(PICTURE, PICTURE))
                    });
                    let name = RichText::new(name).size(TEXT);
                    let button = Button::opt_image_and_text(picture, Some(name.into()))
                        .selected(state.settings.shading.mode == mode)
                        .truncate()
                        .min_size(vec2(width, HEIGHT));
                    let id = format!("look.mode.{}", line * COLUMNS + column + 1);
                    let hint = registry::hint(ui.ctx(), &id);
                    if ui.add(button).on_hover_text(hint).clicked() {
                        out.push(Command::SetMode(mode));
                    }
                }
            });
        }
    });
}

fn x_ray(ui: &mut Ui, state: &State, out: &mut Commands) {
    row(
        ui,
        "Opacity",
        "How much of what lies behind it a surface covers",
        |ui, label| {
            let number = Number {
                value: f64::from(state.settings.shading.x_ray_opacity),
                range: 0.0..=1.0,
                speed: 0.01,
                decimals: Some(2),
                suffix: "",
                width: 52.0,
                hint: "Of a surface seen from above; at a slant it covers more",
            };
            out.extend(
                number
                    .show(ui, label)
                    .map(|share| Command::SetXRayOpacity(share as f32)),
            );
        },
    );
}

fn lines(ui: &mut Ui, state: &State, out: &mut Commands) {
    let shading = &state.settings.shading;
    let lines = shading.wireframe;
    let alone = (shading.mode == Mode::Wireframe).then_some(Wireframe::ALONE);
    let shown = lines.or(alone);
    row(
        ui,
        "Lines",
        "Lines along the triangles' edges",
        |ui, label| {
            out.extend(
                tick(
                    ui,
                    lines.is_some(),
                    "Wireframe",
                    &registry::hint(ui.ctx(), "look.wireframe"),
                )
                .map(Command::SetWireframe),
            );
            if let Some(lines) = shown {
                let number = Number {
                    value: f64::from(lines.width),
                    range: 0.25..=f64::from(WIDEST_LINE),
                    speed: 0.05,
                    decimals: Some(2),
                    suffix: " px",
                    width: 52.0,
                    hint: "The lines' width in pixels, the same near and far",
                };
                out.extend(
                    number
                        .show(ui, label)
                        .map(|w| Command::SetWireframeWidth(w as f32)),
                );
                let hint = "The lines' color";
                out.extend(color(ui, lines.color, label, hint).map(Command::SetWireframeColor));
            }
        },
    );
    if let Some(lines) = shown {
        edges(ui, lines, out);
    }
}

/// Which edges have lines, and whether hidden ones show.
fn edges(ui: &mut Ui, lines: Wireframe, out: &mut Commands) {
    const NONE: EdgeKinds = EdgeKinds::NONE;
    const POLYGONS: EdgeKinds = EdgeKinds {
        polygon: true,
        ..NONE
    };
    const FEATURES: EdgeKinds = EdgeKinds {
        feature: Some(EdgeKinds::FEATURE),
        boundary: true,
        ..NONE
    };
    const OUTLINE: EdgeKinds = EdgeKinds {
        silhouette: true,
        ..FEATURES
    };
    const FAULTS: EdgeKinds = EdgeKinds {
        boundary: true,
        non_manifold: true,
        ..NONE
    };
    row(ui, "Edges", "Which edges have lines", |ui, label| {
        let mut options = vec![
            (EdgeKinds::ALL, "All", "Every triangle's edges"),
            (
                POLYGONS,
                "Polygons",
                "The edges of the file's polygons: no diagonals",
            ),
            (
                FEATURES,
                "Features",
                "Where the surface turns by 30° or more, and where it ends",
            ),
            (OUTLINE, "Outline", "Features and silhouettes"),
            (
                FAULTS,
                "Faults",
                "Edges of one triangle (orange) and of more than two (red)",
            ),
        ];
        if !options.iter().any(|(kinds, ..)| *kinds == lines.edges) {
            options.push((lines.edges, "Custom", "As the scene file has them"));
        }
        let hint = "Show lines faintly through what hides them";
        out.extend(
            tick(ui, lines.hidden > 0.0, "Hidden", hint)
                .map(|on| Command::SetWireframeHidden(if on { Wireframe::FAINT } else { 0.0 })),
        );
        out.extend(
            select(ui, "edges", label, lines.edges, &options).map(Command::SetWireframeEdges),
        );
    });
}

fn texture(ui: &mut Ui, state: &State, out: &mut Commands) {
    let removable = state.document.as_ref().is_some_and(|document| {
        let mut objects = document.scene.objects.iter();
        objects.any(|object| object.texture.is_some())
    });
    row(ui, "Texture", "An image on the surface", |ui, _| {
        let load = Button::new("Load…").min_size(vec2(60.0, 0.0));
        let hint = registry::hint(ui.ctx(), "look.texture");
        if ui
            .add_enabled(state.document.is_some(), load)
            .on_hover_text(hint)
            .clicked()
        {
            out.push(Command::Ask(PromptKind::Texture));
        }
        if removable
            && ui
                .button("Remove")
                .on_hover_text("Take all textures off")
                .clicked()
        {
            out.push(Command::RemoveTexture(None));
        }
    });
}

fn background(ui: &mut Ui, state: &State, out: &mut Commands) {
    row(
        ui,
        "Background",
        "What lies behind everything",
        |ui, label| {
            let current = state.settings.shading.background;
            if let Background::Gradient(top, bottom) = current {
                if let Some(top) = color(ui, top, label, "At the top of the picture") {
                    out.push(Command::SetBackground(Background::Gradient(top, bottom)));
                }
                if let Some(bottom) = color(ui, bottom, label, "At the bottom of the picture") {
                    out.push(Command::SetBackground(Background::Gradient(top, bottom)));
                }
            }
            let clear = current == Background::Transparent;
            if let Some(clear) = tick(
                ui,
                clear,
                "Transparent",
                "Nothing: saved pictures are clear there",
            ) {
                out.push(Command::SetBackground(if clear {
                    Background::Transparent
                } else {
                    Background::default()
                }));
            }
        },
    );
}

fn ground(ui: &mut Ui, state: &State, out: &mut Commands) {
    let current = state.settings.shading.ground;
    row(
        ui,
        "Ground",
        "Lines on a level plane, of which ten make a stronger one",
        |ui, label| {
            let hint = registry::hint(ui.ctx(), "look.ground");
            if let Some(is_shown) = tick(ui, current.is_some(), "Ground grid", &hint) {
                out.push(Command::SetGround(is_shown.then(Ground::default)));
            }
            let Some(ground) = current else {
                return;
            };
            let is_lowest = ground == Ground::Lowest;
            let hint = "At the scene's lowest point, wherever that is";
            if let Some(is_lowest) = tick(ui, is_lowest, "Lowest", hint) {
                let height = state.bounds().min.y;
                let ground = match is_lowest || !height.is_finite() {
                    true => Ground::Lowest,
                    false => Ground::At(height),
                };
                out.push(Command::SetGround(Some(ground)));
            }
            if let Ground::At(height) = ground {
                let number = Number {
                    value: height,
                    range: -FURTHEST_GROUND..=FURTHEST_GROUND,
                    speed: state.bounds().size().max_element() * 0.002,
                    decimals: None,
                    suffix: "",
                    width: 58.0,
                    hint: "How high it lies: its y",
                };
                let chosen = number.show(ui, label);
                out.extend(chosen.map(|height| Command::SetGround(Some(Ground::At(height)))));
            }
        },
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::theme;

    #[test]
    fn every_modes_name_and_picture_leave_a_margin_in_their_button() {
        const MARGIN: f32 = 4.0;
        let context = egui::Context::default();
        let mut widths = Vec::new();
        let _ = context.run_ui(egui::RawInput::default(), |ui| {
            theme::apply(ui.ctx());
            let font = egui::FontId::proportional(TEXT);
            widths = MODES
                .map(|(_, name, _)| {
                    let galley = ui.painter().layout_no_wrap(
                        name.to_owned(),
                        font.clone(),
                        egui::Color32::WHITE,
                    );
                    (name, galley.size().x)
                })
                .to_vec();
        });
        // Beside the panel's margins and its scroll bar.
        let room = mode_width(super::super::side::WIDTH - 20.0);
        for (name, width) in widths {
            let needed = PICTURE + BESIDE + width + 2.0 * MARGIN;
            assert!(needed <= room, "{name}: {needed} of {room}");
        }
    }
}
