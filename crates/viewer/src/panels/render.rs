//! Threads, and statistics of the picture.

use super::widgets::{Number, fact, row, section};
use super::{Commands, Status};
use crate::state::command::Command;
use crate::state::document::Document;
use crate::state::{State, default_threads};
use crate::ui::canvas::PictureProgress;
use crate::ui::format;
use crate::ui::icons::Icon;
use egui::Ui;
use raycast_core::render::Pass;

pub(super) fn show(ui: &mut Ui, state: &State, status: &Status, out: &mut Commands) {
    section(ui, (Icon::Gauge, "Rendering"), false, |ui| {
        threads(ui, state, out);
        passes(ui, &status.progress);
        if let Some(document) = &state.document {
            tree(ui, document);
        }
    });
}

fn threads(ui: &mut Ui, state: &State, out: &mut Commands) {
    row(ui, "Threads", "Render threads", |ui, label| {
        let cores = default_threads();
        let number = Number {
            value: state.threads as f64,
            range: 1.0..=(cores as f64 * 4.0).min(256.0),
            speed: 0.05,
            decimals: Some(0),
            suffix: "",
            width: 44.0,
            hint: "Threads that cast rays; the picture is the same with any number",
        };
        let threads = number.show(ui, label);
        out.extend(threads.map(|n| Command::SetThreads(n.round() as usize)));
        let plural = if cores == 1 { "" } else { "s" };
        ui.weak(format!("of {cores} core{plural}"));
    });
}

/// Facts about the picture's passes; dashes before the first is finished.
fn passes(ui: &mut Ui, progress: &PictureProgress) {
    let report = progress.report;
    let counts = report.map(|report| report.stats.counts);
    let hits = report.filter(|report| report.stats.rays > 0).map(|report| {
        let share = report.stats.counts.hits as f64 / report.stats.rays as f64 * 100.0;
        format!("{share:.1} % of rays")
    });
    let time = (progress.complete).then(|| format::time(progress.elapsed));
    let facts = [
        (
            "Pass",
            "The last pass that was finished",
            report.map(|report| pass_name(report.pass)),
        ),
        (
            "Rays",
            "Rays cast for this picture",
            Some(format::count(progress.rays)),
        ),
        (
            "Speed",
            "Rays a second in the last pass, shading included",
            report.map(|report| format::rate(report.stats.rays, report.time)),
        ),
        ("Hits", "Rays of the last pass that met something", hits),
        (
            "Nodes",
            "Nodes of the tree that the last pass went through",
            counts.map(|counts| format::count(counts.nodes)),
        ),
        (
            "Set up",
            "Triangles that the last pass tested against rays, counted once a packet of rays",
            counts.map(|counts| format::count(counts.triangles)),
        ),
        (
            "Doubles",
            "Rays of the last pass that single precision left open, and doubles decided",
            counts.map(|counts| format::count(counts.double_rays)),
        ),
        (
            "Exact",
            "Rays of the last pass that exact arithmetic had to decide",
            counts.map(|counts| format::count(counts.exact_rays)),
        ),
        (
            "Time",
            "From the request to the full picture; at rest, to the last of its samples",
            time,
        ),
    ];
    for (name, hint, value) in facts {
        fact(ui, name, hint, value.as_deref().unwrap_or("–"));
    }
}

/// Facts about the tree over the triangles.
fn tree(ui: &mut Ui, document: &Document) {
    let accel = &document.accel;
    let bytes = format::bytes(accel.retained_bytes());
    let facts = [
        (
            "SIMD",
            "The instruction set that tiles are cast with; it changes no pixel",
            accel.simd().name().to_owned(),
        ),
        (
            "Triangles",
            "Triangles that rays can meet",
            format::count(accel.len() as u64),
        ),
        (
            "Tree",
            "Memory for the tree and its triangles, and how long it took to build",
            format!("{bytes}, {}", format::time(document.build_time)),
        ),
        (
            "Reading",
            "How long the files took to read",
            format::time(document.load_time),
        ),
    ];
    for (name, hint, value) in facts {
        fact(ui, name, hint, &value);
    }
}

/// A pass's name for people.
pub(super) fn pass_name(pass: Pass) -> String {
    match (pass.stride, pass.samples) {
        (1, 1) => "every ray".to_owned(),
        (1, samples) => format!("{samples} samples a pixel"),
        (2, _) => "every 2nd ray".to_owned(),
        (3, _) => "every 3rd ray".to_owned(),
        (stride, _) => format!("every {stride}th ray"),
    }
}
