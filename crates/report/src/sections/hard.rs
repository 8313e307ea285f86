//! The hard cases: which ways are wrong in which.

use super::Section;
use super::numerics::{self, Standing};
use crate::cases::{self, Case, Setting, Theme};
use crate::checked::{Checked, pixels_by_lot};
use crate::effort::Effort;
use crate::embree::Embree;
use crate::errors::Errors;
use crate::subject::{self, Input, Subject};
use crate::table::{ReportError, Table, grouped};
use crate::watch::Watch;
use crate::ways::{Rays, Way};
use raycast_core::Cull;
use raycast_core::camera::Lattice;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What a way made of a case.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Against the truth.
    pub errors: Errors,
    /// Rays that were cast to measure its speed.
    pub timed_rays: usize,
    /// The time that they took.
    pub time: Duration,
}

/// What ways made of the cases: by the way's name, then by the case's.
#[derive(Clone, Debug, Default)]
pub struct Outcomes {
    /// Names, in the order of [`Subject::ways`].
    pub ways: Vec<String>,
    /// A case, and what each way made of it, in the order of `ways`; `None` for a way that was not
    /// there.
    pub cases: Vec<(Case, BTreeMap<String, Outcome>)>,
}

/// Asks every way about every case.
///
/// # Errors
/// A case whose scene cannot be built.
pub fn measure(
    effort: &Effort,
    library: Option<&Arc<Embree>>,
    watch: &dyn Watch,
) -> Result<Outcomes, ReportError> {
    // What takes other ways time without bound is not asked of them: `time` measures RayCast's own.
    let mut all = cases::all();
    all.retain(|case| case.theme != Theme::Time);
    watch.begin("hard cases", all.len() as u64);
    let mut outcomes = Outcomes::default();
    for case in all {
        let mut by_way: BTreeMap<String, Outcome> = BTreeMap::new();
        let open = case.settings().filter(|setting| setting.cull == Cull::None);
        for mut setting in open.take(effort.variants) {
            setting.cameras.truncate(effort.cameras);
            let rays = setting.rays(effort.hard, 1);
            let subject = Subject::new(&as_input(&case, &setting), effort.simd, library)?;
            let each = effort.hard / setting.cameras.len().max(1);
            let pictures = setting.cameras.iter();
            let pictures = pictures.map(|camera| (*camera, pixels_by_lot(camera, each)));
            let checked = Checked::new(&subject.stage, rays, pictures.collect());
            for way in &subject.ways {
                let way = way.as_ref();
                let outcome = by_way.entry(way.name().to_owned()).or_default();
                let errors = checked.errors(way, effort.tests / 20);
                outcome.errors = Errors::sum([std::mem::take(&mut outcome.errors), errors]);
                let (rays, time) = speed(way, &checked, &setting, effort);
                outcome.timed_rays += rays;
                outcome.time += time;
                if !outcomes.ways.iter().any(|name| name == way.name()) {
                    outcomes.ways.push(way.name().to_owned());
                }
            }
        }
        outcomes.cases.push((case, by_way));
        watch.step();
    }
    Ok(outcomes)
}

fn as_input(case: &Case, setting: &Setting) -> Input {
    Input {
        name: case.name.to_owned(),
        scene: Arc::new(setting.scene.clone()),
        parsing: None,
    }
}

/// How many rays a way has cast on one worker, and the least time of a few that it took.
fn speed(
    way: &dyn Way,
    checked: &Checked<'_>,
    setting: &Setting,
    effort: &Effort,
) -> (usize, Duration) {
    let mut hits = Vec::new();
    let mut least = Duration::MAX;
    let mut count = 0;
    let tiles: Vec<Lattice> = match way.rays() {
        Rays::Camera => {
            let cameras = setting.cameras.iter();
            cameras
                .flat_map(|camera| subject::tiles(camera, 1))
                .collect()
        }
        _ => Vec::new(),
    };
    let rays = checked.rays(way);
    let affordable = match way.tries() {
        0 => rays.len(),
        tries => rays.len().min((effort.tests / 100 / tries).max(1)),
    };
    for _ in 0..effort.rounds.div_ceil(3) {
        let started = Instant::now();
        if way.rays() == Rays::Camera {
            for tile in &tiles {
                way.cast_lattice(tile, &mut hits);
            }
            count = tiles.iter().map(Lattice::len).sum();
        } else {
            way.cast(&rays[..affordable], &mut hits);
            count = affordable;
        }
        least = least.min(started.elapsed());
    }
    (count, least)
}

/// Each way over all cases.
pub fn over_cases(outcomes: &Outcomes) -> Vec<Standing> {
    let ways = outcomes.ways.iter();
    ways.map(|way| standing(outcomes, way)).collect()
}

/// Plot A over the hard cases (`standings` being those of [`over_cases`]), and who is wrong where.
pub fn show(section: &mut Section, outcomes: &Outcomes, standings: &[Standing]) {
    section.say("### Hard cases");
    let rays: u64 = outcomes
        .cases
        .iter()
        .filter_map(|(_, ways)| ways.values().map(|outcome| outcome.errors.rays).max())
        .sum();
    section.say(format!(
        "{} places where known ray casters go wrong, {} rays at most: aimed at edges and corners, far \
         from the origin, at slivers, ties, zeros and huge numbers. A share of wrong answers here is \
         no rate that ordinary pictures have; that there are any is what counts. Speeds are of one \
         thread, mostly at tiny scenes.",
        outcomes.cases.len(),
        grouped(rays)
    ));
    numerics::show(section, "a-hard", "hard cases", standings, 1);
    let mut summary = Table::new(&["way", "leaks", "wrong", "of rays", "wrong in these cases"]);
    for way in &outcomes.ways {
        let errors = of_way(outcomes, way).map(|(_, outcome)| outcome.errors.clone());
        let errors = Errors::sum(errors);
        let wrong: Vec<String> = of_way(outcomes, way)
            .filter(|(_, outcome)| outcome.errors.wrong() > 0)
            .map(|(case, outcome)| {
                let (wrong, rays) = (outcome.errors.wrong(), outcome.errors.rays);
                format!("{} ({} of {})", case.title(), grouped(wrong), grouped(rays))
            })
            .collect();
        summary.row(vec![
            way.as_str().into(),
            errors.leaks.into(),
            errors.wrong().into(),
            errors.rays.into(),
            if wrong.is_empty() {
                "none".into()
            } else {
                wrong.join(", ").into()
            },
        ]);
    }
    section.table("hard-ways", summary);
    let mut numbers = Table::new(&["case", "trouble", "way", "rays", "leaks", "wrong", "ties"]);
    for (case, ways) in &outcomes.cases {
        for (way, outcome) in ways {
            let errors = &outcome.errors;
            numbers.row(vec![
                case.name.into(),
                case.trouble.into(),
                way.as_str().into(),
                errors.rays.into(),
                errors.leaks.into(),
                errors.wrong().into(),
                errors.ties.into(),
            ]);
        }
    }
    section.numbers("hard-cases", numbers);
}

fn of_way<'a>(
    outcomes: &'a Outcomes,
    way: &'a str,
) -> impl Iterator<Item = (&'a Case, &'a Outcome)> {
    let cases = outcomes.cases.iter();
    cases.filter_map(move |(case, ways)| Some((case, ways.get(way)?)))
}

fn standing(outcomes: &Outcomes, way: &str) -> Standing {
    let (mut rays, mut seconds) = (0, 0.0);
    let mut errors = Errors::default();
    for (_, outcome) in of_way(outcomes, way) {
        rays += outcome.timed_rays;
        seconds += outcome.time.as_secs_f64();
        errors = Errors::sum([errors, outcome.errors.clone()]);
    }
    Standing {
        name: way.to_owned(),
        mrays: rays as f64 / seconds / 1e6,
        wrong: errors.wrong(),
        rays: errors.rays,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write;

    /// Which of other people's ways is wrong where, and how often: a line that changes is a change of a
    /// way, of a case, or of the oracle, and wants to be understood.
    const EXPECTED: &str = include_str!("hard_failures.txt");

    fn told(outcomes: &Outcomes) -> String {
        let mut told = String::new();
        for way in outcomes
            .ways
            .iter()
            .filter(|way| !way.starts_with("RayCast"))
        {
            for (case, outcome) in of_way(outcomes, way) {
                let errors = &outcome.errors;
                if errors.wrong() > 0 {
                    let (wrong, rays) = (errors.wrong(), errors.rays);
                    let _ = writeln!(told, "{way}: {}: {wrong} of {rays}", case.name);
                }
            }
        }
        told
    }

    #[test]
    fn every_way_fails_where_it_is_expected_to_and_nowhere_else() {
        let effort = Effort {
            hard: 100,
            ..Effort::QUICK
        };
        let outcomes = measure(&effort, None, &()).expect("scenes that can be built");
        let exact = outcomes.ways.iter().filter(|way| way.contains("exact"));
        assert!(exact.clone().count() >= 2);
        for way in exact {
            let errors = of_way(&outcomes, way).map(|(_, outcome)| outcome.errors.clone());
            assert_eq!(Errors::sum(errors).wrong(), 0, "{way}");
        }
        let told = told(&outcomes);
        let is_known = |line: &&str| EXPECTED.lines().any(|known| known == *line);
        let news: Vec<&str> = told.lines().filter(|line| !is_known(line)).collect();
        let gone = EXPECTED
            .lines()
            .filter(|known| !told.lines().any(|line| line == *known));
        let gone: Vec<&str> = gone.collect();
        assert!(
            news.is_empty() && gone.is_empty(),
            "new: {news:#?}\ngone: {gone:#?}"
        );
    }
}
