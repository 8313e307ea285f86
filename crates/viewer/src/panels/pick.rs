//! The picks and their values; a click on a value copies it.

use super::Commands;
use super::widgets::{row, section};
use crate::state::State;
use crate::state::command::Command;
use crate::state::pick::Pinned;
use crate::ui::format;
use crate::ui::icons::Icon;
use egui::{Align, Button, Layout, RichText, ScrollArea, Ui, vec2};
use raycast_core::glam::DVec3;
use raycast_core::scene::Color;

/// The height of the list of picks before it scrolls, in points.
const HEIGHT: f32 = 110.0;

pub(super) fn show(ui: &mut Ui, state: &State, out: &mut Commands) {
    let Some(pinned) = state.picks.current() else {
        return;
    };
    let count = state.picks.list().len();
    let title = match count {
        1 => "Pick".to_owned(),
        _ => format!("Picks ({count})"),
    };
    // The id does not depend on the title, which changes: the part stays open or closed.
    ui.push_id("picks", |ui| {
        section(ui, (Icon::Crosshair, &title), true, |ui| {
            if count > 1 {
                list(ui, state, out);
                let hint = "Every pick as comma-separated values";
                row(ui, "All of them", hint, |ui, _| {
                    if ui.button("Copy as CSV").on_hover_text(hint).clicked() {
                        out.push(Command::Copy(csv(state)));
                    }
                });
            }
            for Value {
                name,
                hint,
                shown,
                copied,
            } in values(state, pinned)
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
                if ui.button("Copy all").clicked() {
                    out.push(Command::Copy(all(state, pinned)));
                }
                if ui.button("Let go").on_hover_text("Let go (Esc)").clicked() {
                    out.push(Command::Unpin);
                }
            });
        });
    });
}

/// The list of picks; a click on one shows its values.
fn list(ui: &mut Ui, state: &State, out: &mut Commands) {
    let picks = state.picks.list();
    let height = ui.spacing().interact_size.y;
    let area = ScrollArea::vertical()
        .id_salt("list of picks")
        .max_height(HEIGHT)
        .auto_shrink([false, true]);
    area.show_rows(ui, height, picks.len(), |ui, rows| {
        for index in rows {
            let pinned = &picks[index];
            let number = index + 1;
            ui.push_id(index, |ui| {
                let layout = Layout::right_to_left(Align::Center);
                let size = vec2(ui.available_width(), height);
                ui.allocate_ui_with_layout(size, layout, |ui| {
                    let remove = Button::new("×").small();
                    let response = ui.add(remove);
                    let hint = format!("Let go of pick {number}");
                    response
                        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &hint));
                    if response.on_hover_text(&hint).clicked() {
                        out.push(Command::RemovePick(index));
                    }
                    let triangle = format::count(pinned.pick.hit.triangle.into());
                    let text = format!("{number}  {} · {triangle}", pinned.object);
                    let is_current = index == state.picks.current_index();
                    let button = Button::selectable(is_current, &text)
                        .truncate()
                        .right_text("")
                        .min_size(vec2(ui.available_width(), 0.0));
                    let response = ui.add(button);
                    response.widget_info(|| {
                        let role = egui::Role::Button;
                        egui::WidgetInfo::selected(role, true, is_current, &text)
                    });
                    if response.clicked() {
                        out.push(Command::ChoosePick(index));
                    }
                });
            });
        }
    });
}

fn all(state: &State, pinned: &Pinned) -> String {
    let values = values(state, pinned).into_iter();
    let lines = values.map(|value| format!("{}: {}", value.name, value.copied));
    lines.collect::<Vec<_>>().join("\n")
}

/// All picks as comma-separated values, numbers with all their digits; empty where a pick has no such value.
fn csv(state: &State) -> String {
    let mut text =
        "number,object,triangle,x,y,z,normal x,normal y,normal z,distance,weight u,weight v,\
                    texture u,texture v,texel column,texel row,texel color,color,group\n"
            .to_owned();
    for (number, pinned) in (1..).zip(state.picks.list()) {
        let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
        let name = quoted(&pinned.object);
        let group = pinned.group.as_deref().map(quoted).unwrap_or_default();
        let (hit, point, normal) = (&pinned.pick.hit, pinned.pick.point, pinned.normal);
        let distance = match pinned.has_moved {
            true => String::new(),
            false => hit.t.to_string(),
        };
        let uv = pinned
            .uv
            .map_or(",".to_owned(), |uv| format!("{},{}", uv.x, uv.y));
        let texel = state.texel(pinned).map_or(",,".to_owned(), |texel| {
            format!(
                "{},{},{}",
                texel.column,
                texel.row,
                hexadecimal(texel.color)
            )
        });
        let color = (state.color(pinned)).map_or(String::new(), |color| color.to_string());
        text.push_str(&format!(
            "{number},{name},{},{},{},{},{},{},{},{distance},{},{},{uv},{texel},{color},{group}\n",
            hit.triangle, point.x, point.y, point.z, normal.x, normal.y, normal.z, hit.u, hit.v,
        ));
    }
    text
}

/// `#rrggbb`, or with alpha where that is not 255.
fn hexadecimal([r, g, b, a]: [u8; 4]) -> String {
    match a {
        u8::MAX => Color([r, g, b]).to_string(),
        _ => format!("{}{a:02x}", Color([r, g, b])),
    }
}

/// A value as it is displayed, and as it is copied, with all its digits.
struct Value {
    name: &'static str,
    hint: &'static str,
    shown: String,
    copied: String,
}

fn values(state: &State, pinned: &Pinned) -> Vec<Value> {
    let value = |name, hint, shown: String, copied: String| Value {
        name,
        hint,
        shown,
        copied,
    };
    let hit = &pinned.pick.hit;
    let point = |p: DVec3| format!("{} {} {}", p.x, p.y, p.z);
    let short = |p: DVec3| format::point(p.to_array(), state.extent()).join(" ");
    let direction = |n: DVec3| {
        let [x, y, z] = n.to_array().map(|c| format::fixed(c, 4));
        format!("{x} {y} {z}")
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
    if let Some(group) = &pinned.group {
        let hint = "The triangle's group in its file";
        values.insert(1, value("Group", hint, group.clone(), group.clone()));
    }
    if !pinned.has_moved {
        let distance = value(
            "Distance",
            "From the eye to the point",
            format::length(hit.t),
            hit.t.to_string(),
        );
        values.insert(values.len() - 1, distance);
    }
    if let Some(uv) = pinned.uv {
        values.push(value(
            "UV",
            "Texture coordinates",
            format!("{:.5} {:.5}", uv.x, uv.y),
            format!("{} {}", uv.x, uv.y),
        ));
    }
    if let Some(texel) = state.texel(pinned) {
        let (column, row) = (texel.column, texel.row);
        let color = hexadecimal(texel.color);
        values.push(value(
            "Texel",
            "Column and row of its image from the top left, and the color there",
            format!("{column} {row} {color}"),
            format!("{column} {row} {color}"),
        ));
    }
    if let Some(color) = state.color(pinned) {
        let hint =
            "The surface's own color there, on the side that is seen, without light and texture";
        values.push(value("Color", hint, color.to_string(), color.to_string()));
    }
    values
}
