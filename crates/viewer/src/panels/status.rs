//! The status line: what is under the cursor, and the picture's progress.

use super::Status;
use super::render::pass_name;
use crate::state::State;
use crate::state::document::Document;
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
            let hint = "What the ray under the cursor meets: t is the distance, u and v the weights of the triangle's second and third corners. Elsewhere what is open, and the size of the box around all that is visible";
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
    if let Some(speed) = state.walk {
        let lengths = state.lengths();
        let speed = format::short(lengths.converted(speed * state.extent(), 1));
        let unit = lengths.suffix(1);
        return format!(
            "Walk, Esc ends: W A S D go, E Q up and down, a drag looks around, Shift is faster, the wheel changes \
             {speed}{unit} a second"
        );
    }
    if let Some((tool, hint)) = state.measuring.tool.zip(state.measuring.hint()) {
        return format!("{}: {hint}. Esc ends", tool.name());
    }
    if let Some(points) = &state.cutting {
        return format!("Cut: {}. Esc ends", super::cut::points_left(points));
    }
    let Some((x, y)) = state.hover else {
        return contents(state, document);
    };
    // The ray through the pixel's centre, as in the picture.
    let pixel = (x.floor(), y.floor());
    let Some(pick) = state.pick(pixel.0 + 0.5, pixel.1 + 0.5) else {
        return contents(state, document);
    };
    let hit = pick.hit;
    let object = document.scene.objects.get(hit.object as usize);
    let name = object.map_or("?", |object| object.name.as_str());
    let group = object.and_then(|object| object.mesh.groups().of(hit.triangle));
    let group = group.filter(|group| *group != name);
    let group = group.map_or_else(String::new, |group| format!(" ({group})"));
    let [x, y, z] = format::point(pick.point.to_array(), state.extent());
    // The most asked for first: a narrow window cuts off the end.
    format!(
        "{name}{group}   at {x}, {y}, {z}   t {}   triangle {}   u {:.3}   v {:.3}   pixel {}, {}",
        format::length(hit.t),
        format::count(hit.triangle.into()),
        hit.u,
        hit.v,
        pixel.0,
        pixel.1,
    )
}

/// What is open: its name, how much it is and how large.
fn contents(state: &State, document: &Document) -> String {
    let objects = &document.scene.objects;
    let triangles: usize = objects
        .iter()
        .map(|object| object.mesh.triangles().len())
        .sum();
    let counted = |count: usize, what: &str| {
        let plural = if count == 1 { "" } else { "s" };
        format!("   {} {what}{plural}", format::count(count as u64))
    };
    let mut text = document.name.clone();
    if objects.len() > 1 {
        text.push_str(&counted(objects.len(), "object"));
    }
    text.push_str(&counted(triangles, "triangle"));
    if !document.bounds.is_empty() {
        let lengths = state.lengths();
        let [x, y, z] = (document.bounds.size().to_array())
            .map(|side| format::short(lengths.converted(side, 1)));
        text.push_str(&format!("   {x} × {y} × {z}{}", lengths.suffix(1)));
    }
    text
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
