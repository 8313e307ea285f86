//! Clipping planes: a list with their numbers, and handles in the picture.

use super::Commands;
use super::highlight::{before, line};
use super::widgets::{Number, changed_from, section_that_opens};
use crate::state::command::Command;
use crate::state::cut::{at_distance, distance, outline, range};
use crate::state::{PromptKind, State};
use crate::ui::icons::Icon;
use crate::ui::registry::{self, action};
use crate::ui::theme;
use egui::{Button, Color32, Id, Pos2, Rect, Sense, Stroke, Ui, Vec2, vec2};
use raycast_core::glam::DVec3;
use raycast_core::scene::ClippingPlane;

/// Buttons that add a plane: their text, and the ids in the registry.
const ADD: [(&str, &str); 5] = [
    ("X", "cut.x"),
    ("Y", "cut.y"),
    ("Z", "cut.z"),
    ("View", "cut.view"),
    ("3 points", "cut.points"),
];

pub(super) fn show(ui: &mut Ui, state: &State, out: &mut Commands) {
    // A plane may be added from menus and the palette, too: the part opens to show its controls.
    let count = state.settings.clip.all().len() + usize::from(state.cutting.is_some());
    // Not for the planes of a scene that is opened: the list of objects would be scrolled out of view.
    let (scenes, before) = (state.scenes, (0, 0));
    let is_new = changed_from(ui, "planes", (scenes, count), before)
        .is_some_and(|(scene, last)| scene == scenes && last < count);
    section_that_opens(ui, (Icon::Scissors, "Cut"), false, is_new, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            let narrow = (ui.available_width() - 66.0 - 46.0 - 8.0) / 3.0;
            for ((name, id), width) in ADD.into_iter().zip([narrow, narrow, narrow, 46.0, 66.0]) {
                let action = action(id);
                let mut button = Button::new(name).min_size(vec2(width, 0.0));
                if let Some(is_on) = action.is_on {
                    button = button.selected(is_on(state));
                }
                let response = ui.add_enabled((action.applies)(state), button);
                response.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::Button, true, action.name)
                });
                if response
                    .on_hover_text(registry::hint(ui.ctx(), action.id))
                    .clicked()
                {
                    out.push((action.command)(state));
                }
            }
        });
        if let Some(points) = &state.cutting {
            ui.weak(points_left(points));
        }
        for (index, plane) in state.settings.clip.all().iter().enumerate() {
            planes(ui, state, index, plane, out);
        }
    });
}

/// An instruction while a plane through three points is being clicked.
pub(super) fn points_left(points: &[DVec3]) -> String {
    let left = 3_usize.saturating_sub(points.len());
    let points = if left == 1 { "point" } else { "points" };
    format!("Click {left} more {points} of the plane")
}

/// A plane's name: its axis, or its number.
fn name(index: usize, plane: &ClippingPlane) -> String {
    for (axis, name) in DVec3::AXES.into_iter().zip(["X", "Y", "Z"]) {
        if plane.normal == axis {
            return format!("{name} ≥");
        }
        if plane.normal == -axis {
            return format!("{name} ≤");
        }
    }
    format!("Plane {}", index + 1)
}

/// The factor from a plane's offset to the displayed number: planes across an axis show the axis's coordinate, also
/// where they keep the side below.
fn sign(plane: &ClippingPlane) -> f64 {
    match DVec3::AXES.contains(&-plane.normal) {
        true => -1.0,
        false => 1.0,
    }
}

fn planes(ui: &mut Ui, state: &State, index: usize, plane: &ClippingPlane, out: &mut Commands) {
    let spoken = format!("clipping plane {}", index + 1);
    let mut set = |plane| out.push(Command::SetPlane(index, plane));
    let mut is_removed = false;
    ui.horizontal(|ui| {
        let mut enabled = plane.enabled;
        let on = ui.checkbox(&mut enabled, name(index, plane));
        if on.on_hover_text("Whether it cuts").changed() {
            set(ClippingPlane { enabled, ..*plane });
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.spacing_mut().item_spacing.x = 3.0;
            let remove = ui.add(Button::new("×").small());
            remove.widget_info(|| {
                let spoken = format!("Remove {spoken}");
                egui::WidgetInfo::labeled(egui::Role::Button, true, spoken)
            });
            is_removed = remove.on_hover_text("Remove").clicked();
            let flip = ui.add(Button::new("Flip").small());
            flip.widget_info(|| {
                let spoken = format!("Flip {spoken}");
                egui::WidgetInfo::labeled(egui::Role::Button, true, spoken)
            });
            if flip.on_hover_text("Keep the other side").clicked() {
                set(plane.flipped());
            }
            let sign = sign(plane);
            let number = Number {
                value: sign * distance(plane),
                range: f64::MIN..=f64::MAX,
                speed: state.extent() * 0.002,
                decimals: None,
                suffix: "",
                width: 70.0,
                hint: "Where it lies along its normal, in scene units",
            };
            if let Some(value) = number.show_as(ui, &format!("Offset of {spoken}")) {
                set(at_distance(plane, sign * value));
            }
        });
    });
    let sign = sign(plane);
    let (least, most) = range(plane, &state.bounds());
    let (least, most) = if sign < 0.0 {
        (-most, -least)
    } else {
        (least, most)
    };
    let mut value = sign * distance(plane);
    ui.horizontal(|ui| {
        ui.spacing_mut().slider_width = ui.available_width() - 78.0;
        // A plane beyond the box stays where it is until the slider is moved.
        let reach = least.min(value)..=most.max(value);
        let slider = egui::Slider::new(&mut value, reach)
            .show_value(false)
            .step_by(0.0);
        let response = ui.add(slider);
        response
            .widget_info(|| egui::WidgetInfo::slider(true, value, format!("Position of {spoken}")));
        if response.changed() {
            out.push(Command::SetPlane(index, at_distance(plane, sign * value)));
        }
        let outline = ui.add(Button::new("Outline…").small());
        outline.widget_info(|| {
            let spoken = format!("Save the outline of {spoken}");
            egui::WidgetInfo::labeled(egui::Role::Button, true, spoken)
        });
        let hint = "Write the lines in which it cuts all that is visible as SVG or DXF";
        if outline.on_hover_text(hint).clicked() {
            out.push(Command::Ask(PromptKind::Outline(index)));
        }
    });
    if is_removed {
        out.push(Command::RemovePlane(index));
    }
}

/// Draws the intersections of planes with the scene's box, and a handle to move each. `place` maps a point of the
/// picture to the window, whose points are `scale` pixels of the picture wide.
pub(super) fn handles(
    ui: &Ui,
    room: Rect,
    state: &State,
    place: impl Fn((f64, f64)) -> Pos2,
    out: &mut Commands,
) {
    let camera = match state.camera() {
        Some(camera) if state.document.is_some() => camera,
        _ => return,
    };
    let painter = ui.painter_at(room);
    let bounds = state.bounds();
    let accent = theme::of(&egui::Visuals::dark()).accent;
    let at = |point: DVec3| {
        let seen = before(&camera, &[point]);
        Some(place(camera.project(*seen.first()?)?))
    };
    for &point in state.cutting.iter().flatten() {
        if let Some(at) = at(point) {
            painter.circle(at, 3.5, accent, Stroke::new(1.0, Color32::BLACK));
        }
    }
    let planes = state.settings.clip.all().iter().enumerate();
    for (index, plane) in planes.filter(|(_, plane)| plane.enabled) {
        let corners = outline(plane, &bounds);
        for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            let color = accent.gamma_multiply(0.7);
            line(&painter, &camera, [*from, *to], &place, color, 1.0);
        }
        let normal = plane.normal.normalize_or_zero();
        let center = bounds.center();
        let foot = center + normal * (distance(plane) - center.dot(normal));
        // Towards the side that is cut away, where the handle is free.
        let reach = state.extent() * 0.08;
        let Some((from, tip)) = at(foot).zip(at(foot - normal * reach)) else {
            continue;
        };
        let arrow = tip - from;
        let stroke = Stroke::new(2.0, accent);
        painter.line_segment(
            [from, tip],
            Stroke::new(4.0, Color32::from_black_alpha(150)),
        );
        painter.line_segment([from, tip], stroke);
        let around = Rect::from_center_size(tip, Vec2::splat(18.0));
        let response = ui.interact(around, Id::unique(("cut", index)), Sense::drag());
        response.widget_info(|| {
            let spoken = format!("Move clipping plane {}", index + 1);
            egui::WidgetInfo::labeled(egui::Role::Slider, true, spoken)
        });
        let is_lit = response.hovered() || response.dragged() || response.has_focus();
        let fill = if is_lit { Color32::WHITE } else { accent };
        painter.circle(tip, 6.0, fill, Stroke::new(1.5, Color32::BLACK));
        let dragged = response.drag_delta();
        let response = response.on_hover_cursor(egui::CursorIcon::Grab);
        let has_focus = response.has_focus();
        let presses = |key| f32::from(ui.input(|input| input.num_presses(key)) as u8);
        let steps = match has_focus {
            true => presses(egui::Key::ArrowUp) - presses(egui::Key::ArrowDown),
            false => 0.0,
        };
        // A plane seen along its normal moves with the cursor up and down.
        let moved = if arrow.length() > 12.0 {
            dragged.dot(arrow) / arrow.length_sq()
        } else {
            -dragged.y / 60.0
        };
        let moved = f64::from(moved + steps * 0.1) * reach;
        if moved != 0.0 {
            let there = at_distance(plane, distance(plane) - moved);
            out.push(Command::SetPlane(index, there));
        }
    }
}
