//! Threads, and statistics of the picture.

use super::widgets::{Number, fact, row, section};
use super::{Commands, Status};
use crate::state::command::Command;
use crate::state::{State, default_threads};
use crate::ui::format;
use crate::ui::icons::Icon;
use egui::Ui;
use raycast_core::packet::CastCounts;
use raycast_core::render::Pass;

pub(super) fn show(ui: &mut Ui, state: &State, status: &Status, out: &mut Commands) {
    section(ui, (Icon::Gauge, "Rendering"), false, |ui| {
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
            out.extend(
                number
                    .show(ui, label)
                    .map(|n| Command::SetThreads(n.round() as usize)),
            );
            let plural = if cores == 1 { "" } else { "s" };
            ui.weak(format!("of {cores} core{plural}"));
        });
        let progress = status.progress;
        let dash = || "–".to_owned();
        let pass = progress
            .report
            .map_or_else(dash, |report| pass_name(report.pass));
        fact(ui, "Pass", "The last pass that was finished", &pass);
        fact(
            ui,
            "Rays",
            "Rays cast for this picture",
            &format::count(progress.rays),
        );
        let speed = progress
            .report
            .map_or_else(dash, |report| format::rate(report.stats.rays, report.time));
        fact(
            ui,
            "Speed",
            "Rays a second in the last pass, shading included",
            &speed,
        );
        let hits = progress
            .report
            .filter(|report| report.stats.rays > 0)
            .map_or_else(dash, |report| {
                let share = report.stats.counts.hits as f64 / report.stats.rays as f64 * 100.0;
                format!("{share:.1} % of rays")
            });
        fact(
            ui,
            "Hits",
            "Rays of the last pass that met something",
            &hits,
        );
        let counts = progress.report.map(|report| report.stats.counts);
        let mut counter = |name: &str, hint: &str, of: fn(&CastCounts) -> u64| {
            let counted = counts.map_or_else(dash, |counts| format::count(of(&counts)));
            fact(ui, name, hint, &counted);
        };
        counter(
            "Nodes",
            "Nodes of the tree that the last pass went through",
            |counts| counts.nodes,
        );
        counter(
            "Set up",
            "Triangles that the last pass tested against rays, counted once a packet of rays",
            |counts| counts.triangles,
        );
        counter(
            "Doubles",
            "Rays of the last pass that single precision left open, and doubles decided",
            |counts| counts.double_rays,
        );
        counter(
            "Exact",
            "Rays of the last pass that exact arithmetic had to decide",
            |counts| counts.exact_rays,
        );
        let time = if progress.complete {
            format::time(progress.elapsed)
        } else {
            dash()
        };
        fact(
            ui,
            "Time",
            "From the request to the full picture; at rest, to the last of its samples",
            &time,
        );
        if let Some(document) = &state.document {
            fact(
                ui,
                "SIMD",
                "The instruction set that tiles are cast with; it changes no pixel",
                document.accel.simd().name(),
            );
            fact(
                ui,
                "Triangles",
                "Triangles that rays can meet",
                &format::count(document.accel.len() as u64),
            );
            fact(
                ui,
                "Tree",
                "Memory for the tree and its triangles, and how long it took to build",
                &format!(
                    "{}, {}",
                    format::bytes(document.accel.retained_bytes()),
                    format::time(document.build_time)
                ),
            );
            fact(
                ui,
                "Reading",
                "How long the files took to read",
                &format::time(document.load_time),
            );
        }
    });
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
