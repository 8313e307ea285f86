//! Plot A: speed against errors.

use super::Section;
use super::meshes::{MeshFigures, wrong_of_rays};
use crate::chart::{Axis, Better, Chart, Form, Ink, Series, number};
use crate::errors::Errors;
use crate::pareto::front;
use crate::table::{Cell, Table, grouped};
use crate::timing::geometric_mean;

/// The results of a caster over several scenes.
#[derive(Clone, Debug)]
pub struct CasterSummary {
    /// The caster's name.
    pub name: String,
    /// Millions of rays per second.
    pub mrays: f64,
    /// The number of wrong triangles.
    pub wrong: u64,
    /// Rays that were checked.
    pub rays: u64,
}

impl CasterSummary {
    fn per_million(&self) -> f64 {
        self.wrong as f64 / self.rays.max(1) as f64 * 1e6
    }
}

/// The results of each caster over all meshes: the sum of errors, and the geometric mean of speeds. Casters that
/// have no results for some mesh are left out.
pub fn summarize_meshes(meshes: &[MeshFigures]) -> Vec<CasterSummary> {
    let Some(first) = meshes.first() else {
        return Vec::new();
    };
    let named = |name: &str| {
        let of = |mesh: &MeshFigures| {
            mesh.casters
                .iter()
                .find(|caster| caster.name == name)
                .cloned()
        };
        let casters = meshes.iter().map(of).collect::<Option<Vec<_>>>()?;
        let mrays = geometric_mean(casters.iter().map(|caster| caster.mrays.median));
        let errors = Errors::sum(casters.into_iter().map(|caster| caster.errors));
        Some(CasterSummary {
            name: name.to_owned(),
            mrays,
            wrong: errors.wrong(),
            rays: errors.rays,
        })
    };
    first
        .casters
        .iter()
        .filter_map(|caster| named(&caster.name))
        .collect()
}

/// Adds the main table: how fast each caster is, and how often it is wrong on ordinary meshes and on hard cases.
pub fn headline(section: &mut Section, ordinary: &[CasterSummary], hard: &[CasterSummary]) {
    let mut table = Table::new(&[
        "caster",
        "Mrays/s",
        "wrong triangles, ordinary meshes",
        "wrong triangles, hard cases",
    ]);
    let counts =
        |caster: &CasterSummary| format!("{} of {}", grouped(caster.wrong), grouped(caster.rays));
    for caster in ordinary {
        let hard_summary = hard.iter().find(|hard| hard.name == caster.name);
        table.row(vec![
            caster.name.as_str().into(),
            Cell::short(caster.mrays),
            counts(caster).into(),
            hard_summary.map_or(Cell::Empty, |hard| counts(hard).into()),
        ]);
    }
    section.table("a-headline", table);
}

/// Adds a chart of some casters, its numbers, and the conclusion.
pub fn show(
    section: &mut Section,
    name: &str,
    scenes: &str,
    summaries: &[CasterSummary],
    threads: usize,
) {
    let points: Vec<(f64, f64)> = summaries
        .iter()
        .map(|caster| (caster.per_million(), caster.mrays))
        .collect();
    let mut series = vec![Series {
        label: String::new(),
        points: front(&points).into_iter().map(|at| points[at]).collect(),
        ink: Ink::Black,
        form: Form::Front,
    }];
    let most = summaries
        .iter()
        .map(|caster| caster.rays)
        .max()
        .unwrap_or(0);
    for (caster, &point) in summaries.iter().zip(&points) {
        let label = if caster.wrong == 0 && caster.rays != most {
            format!("{}: 0 of {}", caster.name, grouped(caster.rays))
        } else {
            caster.name.clone()
        };
        series.push(Series::dot(label, point, Ink::for_caster(&caster.name)));
    }
    let best = fastest_correct(summaries);
    let rates = Axis::log(
        "wrong triangles in a million rays, against exact arithmetic",
        points.iter().map(|point| point.0),
    );
    let (low, high) = (rates.low.min(0.7), rates.high.max(100.0) * 3.0);
    let chart = Chart {
        title: match best {
            Some(best) => format!(
                "{}: the fastest caster on {scenes} that was never wrong",
                best.name
            ),
            None => format!("Every caster was wrong somewhere on {scenes}"),
        },
        subtitle: "A dot is a ray caster. Left: wrong triangles are rare. Up: many rays a \
                   second. Grey band: no other dot is better in both."
            .to_owned(),
        x: rates.from_to(low, high).with_roomy_zero(&format!(
            "0 of {} (< 3/N: below {} in a million)",
            grouped(most),
            number(3e6 / most.max(1) as f64)
        )),
        y: Axis::log(
            &match threads {
                1 => "million rays a second, one thread".to_owned(),
                _ => format!("million rays a second, {threads} threads"),
            },
            points.iter().map(|point| point.1),
        ),
        series,
        better: Better::HigherLeft,
    };
    section.chart(name, chart);
    if let Some(best) = best {
        section.paragraph(format!(
            "**To choose from this:** {} is the fastest caster without a wrong triangle ({}), at {} \
             million rays a second. {}",
            best.name,
            wrong_of_rays(best.wrong, best.rays),
            number(best.mrays),
            faster_with_errors(summaries, best),
        ));
    }
    section.numbers(name, numbers(summaries));
}

/// The fastest caster without errors among those checked with more than half of the most rays that any was checked
/// with. Speeds that differ by less than 5 % are taken as equal, since that is noise; the first of equals wins.
fn fastest_correct(summaries: &[CasterSummary]) -> Option<&CasterSummary> {
    let most = summaries.iter().map(|caster| caster.rays).max()?;
    let right = || {
        summaries
            .iter()
            .filter(|caster| caster.wrong == 0 && caster.rays * 2 > most)
    };
    let fastest = right().map(|caster| caster.mrays).fold(0.0, f64::max);
    right().find(|caster| caster.mrays >= 0.95 * fastest)
}

fn faster_with_errors(summaries: &[CasterSummary], best: &CasterSummary) -> String {
    let faster: Vec<String> = summaries
        .iter()
        .filter(|caster| caster.mrays > best.mrays * 1.05 && caster.wrong > 0)
        .map(|caster| {
            format!(
                "{} (wrong in {})",
                caster.name,
                wrong_of_rays(caster.wrong, caster.rays)
            )
        })
        .collect();
    if faster.is_empty() {
        "No caster that was ever wrong is faster.".to_owned()
    } else {
        format!("Faster, but not always right: {}.", faster.join("; "))
    }
}

fn numbers(summaries: &[CasterSummary]) -> Table {
    let mut table = Table::new(&["caster", "Mrays/s", "wrong", "rays", "wrong per million"]);
    for caster in summaries {
        table.row(vec![
            caster.name.as_str().into(),
            Cell::short(caster.mrays),
            caster.wrong.into(),
            caster.rays.into(),
            Cell::short(caster.per_million()),
        ]);
    }
    table
}
