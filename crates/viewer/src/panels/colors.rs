//! The colour rule of objects, and the colour scale of numbers.

use super::Commands;
use super::widgets::{Number, color, is_chosen, list_height, list_shown, row, tick};
use crate::state::State;
use crate::state::command::Command;
use egui::Ui;
use raycast_core::quote;
use raycast_core::scene::{Color, ColorMap, ColorRule, ColorScale, Curvature, Object, Quantity};
use raycast_core::shade::Mode;
use std::collections::BTreeSet;

pub(super) fn show(ui: &mut Ui, state: &State, out: &mut Commands) {
    let Some(document) = &state.document else {
        return;
    };
    let objects = &document.scene.objects;
    rules(ui, state, objects, out);
    let shows_values = |object: &Object| matches!(object.color, ColorRule::Value(_));
    if state.settings.shading.mode == Mode::Depth || objects.iter().any(shows_values) {
        scale(ui, state, out);
    }
}

fn rules(ui: &mut Ui, state: &State, objects: &[Object], out: &mut Commands) {
    let Some(first) = objects.first().map(|object| &object.color) else {
        return;
    };
    // Where no file has colors, an unlit picture shows one a triangle.
    let shows_random = state.settings.shading.mode == Mode::Color
        && objects.iter().all(|object| {
            let mesh = &object.mesh;
            object.color.is_file() && mesh.materials().is_empty() && mesh.vertex_colors().is_empty()
        });
    let is_one = match first {
        ColorRule::Value(_) => objects.iter().all(|object| object.color == *first),
        _ => {
            let kind = std::mem::discriminant(first);
            let mut kinds = objects.iter().map(|o| std::mem::discriminant(&o.color));
            kinds.all(|other| other == kind)
        }
    };
    let random = ColorRule::PerTriangle { seed: 0 };
    let current = match (is_one, shows_random) {
        (true, true) => Some(&random),
        (true, false) => Some(first),
        (false, _) => None,
    };
    let mut offered = offered(objects);
    row(
        ui,
        "Colors",
        "How triangles get their colors",
        |ui, label| {
            let name = current.map_or_else(|| "Several".to_owned(), name_of);
            let list = egui::ComboBox::from_id_salt("colors")
                .height(list_height(ui))
                .width(ui.available_width())
                .selected_text(name)
                .show_ui(ui, |ui| {
                    for (rule, hint) in offered.drain(..) {
                        let name = name_of(&rule);
                        let is_it = current.is_some_and(|current| name_of(current) == name);
                        let entry = ui.selectable_label(is_it, name).on_hover_text(hint);
                        if is_chosen(ui, &entry) && !is_it {
                            out.push(Command::SetColorRule(None, rule));
                        }
                    }
                });
            list_shown(ui, &list.response.labelled_by(label));
        },
    );
    match current {
        Some(ColorRule::Uniform(current)) => row(ui, "", "", |ui, label| {
            let picked = color(ui, *current, label, "The color of every object");
            out.extend(picked.map(|c| Command::SetColorRule(None, ColorRule::Uniform(c))));
            ui.weak(current.to_string());
        }),
        Some(ColorRule::PerTriangle { seed }) => row(
            ui,
            "Seed",
            "Picks one of 2³² sets of colors",
            |ui, label| {
                let number = Number {
                    value: f64::from(*seed),
                    range: 0.0..=f64::from(u32::MAX),
                    speed: 0.1,
                    decimals: Some(0),
                    suffix: "",
                    width: 58.0,
                    hint: "The same seed gives the same colors",
                };
                let rule = |seed: f64| ColorRule::PerTriangle { seed: seed as u32 };
                out.extend(
                    number
                        .show(ui, label)
                        .map(|n| Command::SetColorRule(None, rule(n))),
                );
            },
        ),
        _ => {}
    }
}

/// The possible rules with their descriptions; a file's scalars come last.
fn offered(objects: &[Object]) -> Vec<(ColorRule, &'static str)> {
    let value = ColorRule::Value;
    let mut rules = vec![
        (ColorRule::File, "The file's own colors and materials"),
        (
            ColorRule::Uniform(Color::DEFAULT),
            "One color for every object",
        ),
        (
            ColorRule::PerTriangle { seed: 0 },
            "A color a triangle, from its number and a seed",
        ),
        (ColorRule::ByObject, "A color an object, from its number"),
        (
            ColorRule::Normal,
            "The direction of the surface: x red, y green, z blue",
        ),
        (value(Quantity::Area), "The areas of triangles"),
        (value(Quantity::Distance(None)), "The distance from the eye"),
        (
            value(Quantity::Curvature(Curvature::Mean)),
            "How much the surface bends, on average over directions: outwards is positive",
        ),
        (
            value(Quantity::Curvature(Curvature::Gaussian)),
            "The product of both bends: negative at saddles",
        ),
    ];
    if objects
        .iter()
        .any(|object| !object.mesh.groups().is_empty())
    {
        let hint = "A color a group of the file, from its number";
        rules.insert(4, (ColorRule::ByGroup, hint));
    }
    let scalars = objects.iter().flat_map(|object| object.mesh.scalars());
    let names: BTreeSet<&str> = scalars.map(|scalar| scalar.name.as_str()).collect();
    let of_file = |name: &str| (value(Quantity::Scalar(name.into())), "A number of the file");
    rules.extend(names.into_iter().map(of_file));
    rules
}

fn name_of(rule: &ColorRule) -> String {
    match rule {
        ColorRule::File => "File",
        ColorRule::Uniform(_) => "One",
        ColorRule::PerTriangle { .. } => "Triangle",
        ColorRule::ByObject => "Object",
        ColorRule::ByGroup => "Group",
        ColorRule::Normal => "Normal",
        ColorRule::Value(Quantity::Area) => "Area",
        ColorRule::Value(Quantity::Distance(None)) => "Distance",
        ColorRule::Value(Quantity::Distance(Some(_))) => "Distance from a point",
        ColorRule::Value(Quantity::Curvature(Curvature::Mean)) => "Mean curvature",
        ColorRule::Value(Quantity::Curvature(Curvature::Gaussian)) => "Gaussian curvature",
        ColorRule::Value(Quantity::Scalar(name)) => {
            return format!("“{}” of the file", quote::name(name));
        }
    }
    .to_owned()
}

fn scale(ui: &mut Ui, state: &State, out: &mut Commands) {
    let shading = &state.settings.shading;
    // Without a scale depth is grey; objects' numbers use the default one.
    let is_grey = shading.mode == Mode::Depth && shading.scale.is_none();
    let scale = shading.scale.unwrap_or_default();
    let mut set = |scale: ColorScale| out.push(Command::SetColorScale(Some(scale)));
    let mut chose_grey = false;
    row(
        ui,
        "Map",
        "The colors of numbers, from low to high",
        |ui, label| {
            let name = if is_grey { "grey" } else { scale.map.name() };
            let list = egui::ComboBox::from_id_salt("color map")
                .height(list_height(ui))
                .width(ui.available_width())
                .selected_text(name)
                .show_ui(ui, |ui| {
                    for map in ColorMap::ALL {
                        let is_it = !is_grey && scale.map == map;
                        let entry = ui.selectable_label(is_it, map.name());
                        if is_chosen(ui, &entry) && !is_it {
                            set(ColorScale { map, ..scale });
                        }
                    }
                    if shading.mode == Mode::Depth {
                        let hint = "Near is light, far is dark, over the scene's box";
                        let entry = ui.selectable_label(is_grey, "grey").on_hover_text(hint);
                        chose_grey = is_chosen(ui, &entry) && !is_grey;
                    }
                });
            list_shown(ui, &list.response.labelled_by(label));
        },
    );
    if !is_grey {
        range(ui, state, scale, &mut set);
        row(ui, "Legend", "What the colors stand for", |ui, _| {
            let hint = "Draw the legend into the picture, so that saved pictures have it";
            if let Some(legend) = tick(ui, scale.legend, "In pictures", hint) {
                set(ColorScale { legend, ..scale });
            }
        });
    }
    if chose_grey {
        out.push(Command::SetColorScale(None));
    }
}

/// The numbers at the ends of the map.
fn range(ui: &mut Ui, state: &State, scale: ColorScale, set: &mut impl FnMut(ColorScale)) {
    let mut set_range = |range| set(ColorScale { range, ..scale });
    row(ui, "Range", "The numbers at the map's ends", |ui, label| {
        let shown = state.shown_legend().map(|legend| legend.range());
        let hint = "Fitted to what there is";
        match tick(ui, scale.range.is_none(), "Fit", hint) {
            Some(true) => set_range(None),
            Some(false) => {
                let fitted = shown.filter(|[low, high]| low < high);
                set_range(Some(fitted.unwrap_or([0.0, 1.0])));
            }
            None => {}
        }
        if let Some([low, high]) = scale.range {
            let number = |value: f64, hint| Number {
                value,
                range: f64::MIN..=f64::MAX,
                speed: (high - low) * 0.005,
                decimals: None,
                suffix: "",
                width: 52.0,
                hint,
            };
            let lower = number(low, "What has the first color").show(ui, label);
            let higher = number(high, "What has the last color").show(ui, label);
            let range = [lower.unwrap_or(low), higher.unwrap_or(high)];
            if (lower.is_some() || higher.is_some()) && range[0] < range[1] {
                set_range(Some(range));
            }
        }
    });
}
