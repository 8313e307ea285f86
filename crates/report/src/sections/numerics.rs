//! Plot A: speed against wrong triangles.

use super::Section;
use super::meshes::{MeshFigures, stated};
use crate::chart::{Axis, Better, Chart, Form, Ink, Series, number};
use crate::errors::Errors;
use crate::pareto::front;
use crate::table::{Cell, Table, grouped};
use crate::timing::geometric_mean;

/// A way, over several scenes.
#[derive(Clone, Debug)]
pub struct Standing {
    /// The way's name.
    pub name: String,
    /// Million rays a second.
    pub mrays: f64,
    /// Wrong triangles.
    pub wrong: u64,
    /// Rays that were checked.
    pub rays: u64,
}

impl Standing {
    fn per_million(&self) -> f64 {
        self.wrong as f64 / self.rays.max(1) as f64 * 1e6
    }
}

/// Each way over all meshes: errors together, speeds by their geometric mean. A way that some mesh
/// does without is left out.
pub fn over_meshes(meshes: &[MeshFigures]) -> Vec<Standing> {
    let Some(first) = meshes.first() else {
        return Vec::new();
    };
    let named = |name: &str| {
        let of = |mesh: &MeshFigures| mesh.ways.iter().find(|way| way.name == name).cloned();
        let ways = meshes.iter().map(of).collect::<Option<Vec<_>>>()?;
        let mrays = geometric_mean(ways.iter().map(|way| way.mrays.median));
        let errors = Errors::sum(ways.into_iter().map(|way| way.errors));
        Some(Standing {
            name: name.to_owned(),
            mrays,
            wrong: errors.wrong(),
            rays: errors.rays,
        })
    };
    first
        .ways
        .iter()
        .filter_map(|way| named(&way.name))
        .collect()
}

/// Adds the table that says it all: how fast each way is, and how often it is wrong on ordinary meshes
/// and on hard cases.
pub fn headline(section: &mut Section, ordinary: &[Standing], hard: &[Standing]) {
    let mut table = Table::new(&[
        "way",
        "Mrays/s",
        "wrong triangles, ordinary meshes",
        "wrong triangles, hard cases",
    ]);
    let stated = |way: &Standing| format!("{} of {}", grouped(way.wrong), grouped(way.rays));
    for way in ordinary {
        let of_hard = hard.iter().find(|hard| hard.name == way.name);
        table.row(vec![
            way.name.as_str().into(),
            Cell::short(way.mrays),
            stated(way).into(),
            of_hard.map_or(Cell::Empty, |hard| stated(hard).into()),
        ]);
    }
    section.table("a-headline", table);
}

/// Adds the plot of some ways, its numbers, and what is to be read from it.
pub fn show(
    section: &mut Section,
    name: &str,
    scenes: &str,
    standings: &[Standing],
    threads: usize,
) {
    let points: Vec<(f64, f64)> = standings
        .iter()
        .map(|way| (way.per_million(), way.mrays))
        .collect();
    let mut series = vec![Series {
        label: String::new(),
        points: front(&points).into_iter().map(|at| points[at]).collect(),
        ink: Ink::Black,
        form: Form::Front,
    }];
    let most = standings.iter().map(|way| way.rays).max().unwrap_or(0);
    for (way, &point) in standings.iter().zip(&points) {
        let label = if way.wrong == 0 && way.rays != most {
            format!("{}: 0 of {}", way.name, grouped(way.rays))
        } else {
            way.name.clone()
        };
        series.push(Series::dot(label, point, Ink::of_way(&way.name)));
    }
    let best = best_of_the_right(standings);
    let rates = Axis::log(
        "wrong triangles in a million rays, against exact arithmetic",
        points.iter().map(|point| point.0),
    );
    let (low, high) = (rates.low.min(0.7), rates.high.max(100.0) * 3.0);
    let chart = Chart {
        title: match best {
            Some(best) => format!(
                "{}: the fastest way on {scenes} that was never wrong",
                best.name
            ),
            None => format!("Every way was wrong somewhere on {scenes}"),
        },
        subtitle:
            "A dot is a way of casting rays. Left: wrong triangles are rare. Up: many rays a \
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
        section.say(format!(
            "**To choose from this:** {} is the fastest way without a wrong triangle ({}), at {} \
             million rays a second. {}",
            best.name,
            stated(best.wrong, best.rays),
            number(best.mrays),
            faster_but_wrong(standings, best),
        ));
    }
    section.numbers(name, numbers(standings));
}

/// The fastest of those that were never wrong in nearly as many rays as any was asked; of those that
/// are as fast to a twentieth, which is what a machine's mood changes, the first.
fn best_of_the_right(standings: &[Standing]) -> Option<&Standing> {
    let most = standings.iter().map(|way| way.rays).max()?;
    let right = || {
        standings
            .iter()
            .filter(|way| way.wrong == 0 && way.rays * 2 > most)
    };
    let fastest = right().map(|way| way.mrays).fold(0.0, f64::max);
    right().find(|way| way.mrays >= 0.95 * fastest)
}

fn faster_but_wrong(standings: &[Standing], best: &Standing) -> String {
    let faster: Vec<String> = standings
        .iter()
        .filter(|way| way.mrays > best.mrays * 1.05 && way.wrong > 0)
        .map(|way| format!("{} (wrong in {})", way.name, stated(way.wrong, way.rays)))
        .collect();
    if faster.is_empty() {
        "No way that was ever wrong is faster.".to_owned()
    } else {
        format!("Faster, but not always right: {}.", faster.join("; "))
    }
}

fn numbers(standings: &[Standing]) -> Table {
    let mut table = Table::new(&["way", "Mrays/s", "wrong", "rays", "wrong per million"]);
    for way in standings {
        table.row(vec![
            way.name.as_str().into(),
            Cell::short(way.mrays),
            way.wrong.into(),
            way.rays.into(),
            Cell::short(way.per_million()),
        ]);
    }
    table
}
