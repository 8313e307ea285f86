//! The hard cases: which casters fail in which.

use super::Section;
use super::numerics::{self, CasterSummary};
use crate::budget::ReportBudget;
use crate::cases::{self, Case, CaseTheme, Setting};
use crate::casters::{Caster, Rays};
use crate::embree::Embree;
use crate::errors::Errors;
use crate::known_answers::{KnownAnswers, random_pixels};
use crate::progress::ReportProgress;
use crate::subject::{self, Input, Subject};
use crate::table::{ReportError, Table, grouped};
use raycast_core::Cull;
use raycast_core::camera::Lattice;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The results of one caster for one case.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Wrong hits, compared with the oracle.
    pub errors: Errors,
    /// Rays that were cast to measure its speed.
    pub timed_rays: usize,
    /// The time for these rays.
    pub time: Duration,
}

/// The results of all casters for all cases.
#[derive(Clone, Debug, Default)]
pub struct Outcomes {
    /// The names of the casters, in the order of [`Subject::casters`].
    pub casters: Vec<String>,
    /// Each case with the results by caster. A caster that did not run has none.
    pub cases: Vec<(Case, BTreeMap<String, Outcome>)>,
}

/// Checks every caster with every case.
///
/// # Errors
/// A case whose scene cannot be built.
pub fn measure(
    budget: &ReportBudget,
    library: Option<&Arc<Embree>>,
    progress: &dyn ReportProgress,
) -> Result<Outcomes, ReportError> {
    // These would take other casters unbounded time: `time` measures RayCast alone.
    let mut all = cases::all();
    all.retain(|case| case.theme != CaseTheme::Time);
    progress.begin("hard cases", all.len() as u64);
    let mut outcomes = Outcomes::default();
    for case in all {
        let mut by_caster: BTreeMap<String, Outcome> = BTreeMap::new();
        let open = case.settings().filter(|setting| setting.cull == Cull::None);
        for mut setting in open.take(budget.variants) {
            setting.cameras.truncate(budget.cameras);
            let rays = setting.rays(budget.hard, 1);
            let subject = Subject::new(&input(&case, &setting), budget.simd, library)?;
            let each = budget.hard / setting.cameras.len().max(1);
            let pictures = setting.cameras.iter();
            let pictures = pictures.map(|camera| (*camera, random_pixels(camera, each)));
            let checked = KnownAnswers::new(&subject.stage, rays, pictures.collect());
            for caster in &subject.casters {
                let caster = caster.as_ref();
                let outcome = by_caster.entry(caster.name().to_owned()).or_default();
                let errors = checked.errors(caster, budget.tests / 20);
                outcome.errors = Errors::sum([std::mem::take(&mut outcome.errors), errors]);
                let (rays, time) = speed(caster, &checked, &setting, budget);
                outcome.timed_rays += rays;
                outcome.time += time;
                if !outcomes.casters.iter().any(|name| name == caster.name()) {
                    outcomes.casters.push(caster.name().to_owned());
                }
            }
        }
        outcomes.cases.push((case, by_caster));
        progress.step();
    }
    Ok(outcomes)
}

fn input(case: &Case, setting: &Setting) -> Input {
    Input {
        name: case.name.to_owned(),
        scene: Arc::new(setting.scene.clone()),
        parsing: None,
    }
}

/// The number of rays that a caster casts on one thread, and the least time of several repetitions.
fn speed(
    caster: &dyn Caster,
    checked: &KnownAnswers<'_>,
    setting: &Setting,
    budget: &ReportBudget,
) -> (usize, Duration) {
    let mut hits = Vec::new();
    let mut least = Duration::MAX;
    let mut count = 0;
    let tiles: Vec<Lattice> = match caster.rays() {
        Rays::Camera => {
            let cameras = setting.cameras.iter();
            cameras
                .flat_map(|camera| subject::tiles(camera, 1))
                .collect()
        }
        _ => Vec::new(),
    };
    let rays = checked.rays(caster);
    let affordable = match caster.tests_per_ray() {
        0 => rays.len(),
        each => rays.len().min((budget.tests / 100 / each).max(1)),
    };
    for _ in 0..budget.rounds.div_ceil(3) {
        let started = Instant::now();
        if caster.rays() == Rays::Camera {
            for tile in &tiles {
                caster.cast_lattice(tile, &mut hits);
            }
            count = tiles.iter().map(Lattice::len).sum();
        } else {
            caster.cast(&rays[..affordable], &mut hits);
            count = affordable;
        }
        least = least.min(started.elapsed());
    }
    (count, least)
}

/// The results of each caster over all cases.
pub fn summarize_cases(outcomes: &Outcomes) -> Vec<CasterSummary> {
    let casters = outcomes.casters.iter();
    casters.map(|caster| summary(outcomes, caster)).collect()
}

/// Adds plot A for the hard cases, whose `summaries` are those of [`summarize_cases`], and a table of which casters fail
/// where.
pub fn show(section: &mut Section, outcomes: &Outcomes, summaries: &[CasterSummary]) {
    section.paragraph("### Hard cases");
    let rays: u64 = outcomes
        .cases
        .iter()
        .filter_map(|(_, casters)| casters.values().map(|outcome| outcome.errors.rays).max())
        .sum();
    section.paragraph(format!(
        "{} places where known ray casters go wrong, {} rays at most: aimed at edges and corners, far \
         from the origin, at slivers, ties, zeros and huge numbers. A share of wrong answers here is \
         no rate that ordinary pictures have; that there are any is what counts. Speeds are of one \
         thread, mostly at tiny scenes.",
        outcomes.cases.len(),
        grouped(rays)
    ));
    numerics::show(section, "a-hard", "hard cases", summaries, 1);
    let mut summary = Table::new(&[
        "caster",
        "leaks",
        "wrong",
        "of rays",
        "wrong in these cases",
    ]);
    for caster in &outcomes.casters {
        let errors = outcomes_of(outcomes, caster).map(|(_, outcome)| outcome.errors.clone());
        let errors = Errors::sum(errors);
        let wrong: Vec<String> = outcomes_of(outcomes, caster)
            .filter(|(_, outcome)| outcome.errors.wrong() > 0)
            .map(|(case, outcome)| {
                let (wrong, rays) = (outcome.errors.wrong(), outcome.errors.rays);
                format!("{} ({} of {})", case.title(), grouped(wrong), grouped(rays))
            })
            .collect();
        summary.row(vec![
            caster.as_str().into(),
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
    section.table("hard-casters", summary);
    let mut numbers = Table::new(&[
        "case",
        "difficulty",
        "caster",
        "rays",
        "leaks",
        "wrong",
        "ties",
    ]);
    for (case, casters) in &outcomes.cases {
        for (caster, outcome) in casters {
            let errors = &outcome.errors;
            numbers.row(vec![
                case.name.into(),
                case.difficulty.into(),
                caster.as_str().into(),
                errors.rays.into(),
                errors.leaks.into(),
                errors.wrong().into(),
                errors.ties.into(),
            ]);
        }
    }
    section.numbers("hard-cases", numbers);
}

fn outcomes_of<'a>(
    outcomes: &'a Outcomes,
    caster: &'a str,
) -> impl Iterator<Item = (&'a Case, &'a Outcome)> {
    let cases = outcomes.cases.iter();
    cases.filter_map(move |(case, casters)| Some((case, casters.get(caster)?)))
}

fn summary(outcomes: &Outcomes, caster: &str) -> CasterSummary {
    let (mut rays, mut seconds) = (0, 0.0);
    let mut errors = Errors::default();
    for (_, outcome) in outcomes_of(outcomes, caster) {
        rays += outcome.timed_rays;
        seconds += outcome.time.as_secs_f64();
        errors = Errors::sum([errors, outcome.errors.clone()]);
    }
    CasterSummary {
        name: caster.to_owned(),
        mrays: rays as f64 / seconds / 1e6,
        wrong: errors.wrong(),
        rays: errors.rays,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write;

    /// How often each of the other casters fails in each case. A changed line means that a caster, a case or the
    /// oracle has changed; find out which before you update the file.
    const EXPECTED: &str = include_str!("hard_failures.txt");

    fn failures(outcomes: &Outcomes) -> String {
        let mut failures = String::new();
        for caster in outcomes
            .casters
            .iter()
            .filter(|caster| !caster.starts_with("RayCast"))
        {
            for (case, outcome) in outcomes_of(outcomes, caster) {
                let errors = &outcome.errors;
                if errors.wrong() > 0 {
                    let (wrong, rays) = (errors.wrong(), errors.rays);
                    let _ = writeln!(failures, "{caster}: {}: {wrong} of {rays}", case.name);
                }
            }
        }
        failures
    }

    #[test]
    fn every_caster_fails_where_it_is_expected_to_and_nowhere_else() {
        let budget = ReportBudget {
            hard: 100,
            ..ReportBudget::QUICK
        };
        let outcomes = measure(&budget, None, &()).expect("scenes that can be built");
        let exact = outcomes
            .casters
            .iter()
            .filter(|caster| caster.contains("exact"));
        assert!(exact.clone().count() >= 2);
        for caster in exact {
            let errors = outcomes_of(&outcomes, caster).map(|(_, outcome)| outcome.errors.clone());
            assert_eq!(Errors::sum(errors).wrong(), 0, "{caster}");
        }
        let failures = failures(&outcomes);
        let is_known = |line: &&str| EXPECTED.lines().any(|known| known == *line);
        let unexpected: Vec<&str> = failures.lines().filter(|line| !is_known(line)).collect();
        let missing = EXPECTED
            .lines()
            .filter(|known| !failures.lines().any(|line| line == *known));
        let missing: Vec<&str> = missing.collect();
        assert!(
            unexpected.is_empty() && missing.is_empty(),
            "new: {unexpected:#?}\ngone: {missing:#?}"
        );
    }
}
