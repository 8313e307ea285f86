//! The split into tiles, and what is drawn over them.

use super::overlay::{LEAST_FOR_NUMBERS, ramp};
use super::widgets::{Number, choice, row, section, tick};
use super::{Commands, Status};
use crate::state::command::Command;
use crate::state::{State, Tint};
use crate::ui::format;
use crate::ui::icons::Icon;
use egui::{Ui, vec2};
use raycast_core::camera::Grid;

pub(super) fn show(ui: &mut Ui, state: &State, status: &Status, out: &mut Commands) {
    section(ui, (Icon::Grid3x3, "Tiles"), false, |ui| {
        split(ui, state, out);
        row(ui, "Show", "What is drawn over the picture", |ui, _| {
            let overlay = state.overlay;
            out.extend(
                tick(ui, overlay.borders, "Borders", "Lines between tiles (T)")
                    .map(Command::SetBorders),
            );
            out.extend(
                tick(
                    ui,
                    overlay.order,
                    "Order",
                    "Numbers: the order in which tiles arrived",
                )
                .map(Command::SetOrder),
            );
        });
        if state.overlay.order && tile_height(ui, state) < LEAST_FOR_NUMBERS {
            row(ui, "", "", |ui, _| {
                ui.weak("Tiles are too small for numbers");
            });
        }
        row(ui, "Color by", "What colors the tiles", |ui, _| {
            let options = [
                (Tint::None, "Nothing", "The picture as it is"),
                (
                    Tint::Time,
                    "Time",
                    "How long each tile took: dark is quick, bright is slow",
                ),
                (Tint::Worker, "Worker", "Which thread made each tile"),
            ];
            out.extend(choice(ui, state.overlay.tint, &options).map(Command::SetTint));
        });
        if state.overlay.tint == Tint::Time {
            legend(ui, status);
        }
    });
}

/// A tile's height on the screen, in points.
fn tile_height(ui: &Ui, state: &State) -> f32 {
    let (_, rows) = state.tile_counts();
    state.viewport.1 as f32 / ui.ctx().pixels_per_point() / rows.max(1) as f32
}

fn split(ui: &mut Ui, state: &State, out: &mut Commands) {
    let (columns, rows) = state.tile_counts();
    let by_size = matches!(state.grid, Grid::Size(_));
    row(
        ui,
        "Split",
        "How the picture is split into sub-cameras",
        |ui, _| {
            let options = [
                (true, "By size", "Square tiles of so many pixels"),
                (false, "Grid", "So many columns and rows of tiles"),
            ];
            if let Some(by_size) = choice(ui, by_size, &options) {
                out.push(Command::SetGrid(if by_size {
                    Grid::default()
                } else {
                    Grid::Count {
                        columns: 6,
                        rows: 4,
                    }
                }));
            }
        },
    );
    match state.grid {
        Grid::Size(size) => row(
            ui,
            "Tile size",
            "Pixels along a tile's side",
            |ui, label| {
                let number = Number {
                    value: f64::from(size),
                    range: 4.0..=4096.0,
                    speed: 0.5,
                    decimals: Some(0),
                    suffix: " px",
                    width: 58.0,
                    hint: "Pixels along a tile's side",
                };
                out.extend(
                    number
                        .show(ui, label)
                        .map(|n| Command::SetGrid(Grid::Size(n as u32))),
                );
                ui.weak(format!("{columns} × {rows}"))
                    .on_hover_text(tile_count(columns, rows));
            },
        ),
        Grid::Count { columns, rows } => {
            row(ui, "Grid", "Columns × rows of tiles", |ui, label| {
                let side = |value: u32, hint| Number {
                    value: f64::from(value),
                    range: 1.0..=256.0,
                    speed: 0.1,
                    decimals: Some(0),
                    suffix: "",
                    width: 44.0,
                    hint,
                };
                if let Some(columns) = side(columns, "Tiles side by side").show(ui, label) {
                    let columns = columns as u32;
                    out.push(Command::SetGrid(Grid::Count { columns, rows }));
                }
                ui.weak("×");
                if let Some(rows) = side(rows, "Tiles one above the other").show(ui, label) {
                    let rows = rows as u32;
                    out.push(Command::SetGrid(Grid::Count { columns, rows }));
                }
                ui.weak(tile_count(columns, rows));
            })
        }
    }
}

fn tile_count(columns: u32, rows: u32) -> String {
    match u64::from(columns) * u64::from(rows) {
        1 => "1 tile".to_owned(),
        tiles => format!("{} tiles", format::count(tiles)),
    }
}

/// The colours of the heat map, with its ends.
fn legend(ui: &mut Ui, status: &Status) {
    let Some((least, most)) = status.tile_times else {
        return;
    };
    row(ui, "", "", |ui, _| {
        ui.weak(format::time(least));
        let text_room = 52.0;
        let size = vec2((ui.available_width() - text_room).max(20.0), 8.0);
        let (rect, response) = ui.allocate_exact_size(size, egui::Sense::hover());
        response.on_hover_text("The quickest tile to the slowest");
        let steps = 24;
        for step in 0..steps {
            let share = |step: i32| rect.left() + rect.width() * step as f32 / steps as f32;
            let part = egui::Rect::from_x_y_ranges(share(step)..=share(step + 1), rect.y_range());
            let color = ramp(step as f32 / (steps - 1) as f32, 255);
            ui.painter().rect_filled(part, 0.0, color);
        }
        ui.weak(format::time(most));
    });
}
