//! The status line: what is under the cursor, and the picture's progress.

use super::Status;
use super::render::pass_name;
use crate::state::State;
use crate::ui::format;
use crate::ui::theme;
use egui::{Align, Label, Layout, RichText, Ui};

/// Shows it.
pub(super) fn show(ui: &mut Ui, state: &State, status: &Status) {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let colors = theme::colors(ui);
        let under_cursor = under_cursor(state);
        let (parts, color, hint) = progress(state, status, colors);
        // In a narrow window values and instructions come before the progress.
        let room = ui.available_width() - width(ui, &under_cursor) - 2.0 * ui.spacing().item_spacing.x;
        let texts = (1..=parts.len()).rev().map(|count| parts[..count].join("   "));
        if let Some(text) = texts.into_iter().find(|text| width(ui, text) <= room) {
            ui.label(RichText::new(text).color(color)).on_hover_text(hint);
        }
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            let hint = "What the ray under the cursor meets: t is the distance, u and v the weights of the triangle's second and third corners";
            ui.add(Label::new(RichText::new(under_cursor).color(colors.quiet)).truncate())
                .on_hover_text(hint);
        });
    });
}

/// The width of a line of text, in points.
fn width(ui: &Ui, text: &str) -> f32 {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let line = ui
        .painter()
        .layout_no_wrap(text.to_owned(), font, ui.visuals().text_color());
    line.size().x
}

/// The hit of the ray under the cursor, or an instruction, in words.
fn under_cursor(state: &State) -> String {
    let Some(document) = &state.document else {
        return String::new();
    };
    if state.walk.is_some() {
        let hint =
            "Walk: W A S D go, E Q up and down, a drag looks around, the wheel changes speed";
        return format!("{hint}. Esc ends");
    }
    if let Some((tool, hint)) = state.measuring.tool.zip(state.measuring.hint()) {
        return format!("{}: {hint}. Esc ends", tool.name());
    }
    if let Some(points) = &state.cutting {
        return format!("Cut: {}. Esc ends", super::cut::points_left(points));
    }
    let Some((x, y)) = state.hover else {
        return document.name.clone();
    };
    // The ray through the pixel's centre, as in the picture.
    let pixel = (x.floor(), y.floor());
    let place = format!("{}, {}", pixel.0, pixel.1);
    match state.pick(pixel.0 + 0.5, pixel.1 + 0.5) {
        Some(pick) => {
            let hit = pick.hit;
            let object = document
                .scene
                .objects
                .get(hit.object as usize)
                .map_or("?", |object| object.name.as_str());
            format!(
                "{place}   {object}   triangle {}   t {}   u {:.3}   v {:.3}   at {}, {}, {}",
                format::count(hit.triangle.into()),
                format::length(hit.t),
                hit.u,
                hit.v,
                format::length(pick.point.x),
                format::length(pick.point.y),
                format::length(pick.point.z),
            )
        }
        None => format!("{place}   nothing"),
    }
}

/// The picture's progress: its parts, the most important first.
fn progress(
    state: &State,
    status: &Status,
    colors: &theme::Colors,
) -> (Vec<String>, egui::Color32, &'static str) {
    let progress = status.progress;
    match progress.report {
        _ if state.document.is_none() => (Vec::new(), colors.quiet, ""),
        Some(report) if progress.complete => (
            vec![
                pass_name(report.pass),
                format!("{} rays", format::count(progress.rays)),
                format::rate(report.stats.rays, report.time),
            ],
            colors.done,
            "The full picture: its last pass, rays cast for it, speed of that pass",
        ),
        Some(report) => (
            vec![format!("{}…", pass_name(report.pass))],
            colors.accent,
            "The picture is getting finer",
        ),
        None => (
            vec!["first rays…".to_owned()],
            colors.accent,
            "The picture is under way",
        ),
    }
}
