//! A whole report, from scenes to files.

use crate::budget::ReportBudget;
use crate::cases::time::TIMED_CASES;
use crate::embree::{Embree, EmbreeError};
use crate::machine::Machine;
use crate::progress::ReportProgress;
use crate::sections::{
    Section, breaking, density, feature_cost, filters, hard, levels, meshes, numerics, samples,
    shape, time,
};
use crate::subject::{Input, Subject};
use crate::table::ReportError;
use std::sync::Arc;

/// A file of a report: its name and its contents.
pub type ReportFile = (String, Vec<u8>);

/// Measures everything on the current workers, and makes the files of the report: `report.md`, and its pictures and
/// tables.
///
/// # Errors
/// An invalid scene; a plot that cannot be drawn.
pub fn report(
    inputs: &[Input],
    budget: &ReportBudget,
    command: &str,
    progress: &dyn ReportProgress,
) -> Result<Vec<ReportFile>, ReportError> {
    let machine = Machine::this(rayon::current_num_threads());
    let library = Embree::load(machine.threads);
    let mut figures = Vec::with_capacity(inputs.len());
    for input in inputs {
        progress.begin("building", 1);
        let subject = Subject::new(input, budget.simd, library.as_ref().ok())?;
        figures.push(meshes::measure(&subject, budget, progress)?);
    }

    let embree = library.as_ref().ok();
    let sections = [
        introduction(&machine, &library),
        speed_against_errors(&figures, &machine, budget, embree, progress)?,
        meshes::show(&figures, budget),
        breaking_points(budget, embree, progress)?,
        speed_against_size(budget, embree, progress)?,
        ray_density(inputs, budget, progress)?,
        feature_costs(budget, progress)?,
        traversal_levels(inputs, budget, progress)?,
        reproduction(command),
    ];
    files(sections, progress)
}

/// The machine, and the casters that are compared.
fn introduction(machine: &Machine, library: &Result<Arc<Embree>, EmbreeError>) -> Section {
    let mut section = Section::default();
    section.paragraph("# RayCast: speed against error");
    section.paragraph(format!("Measured on: {machine}."));
    section.paragraph(match library {
        Ok(library) => format!("Embree: version {}.", library.version()),
        Err(error) => format!("Embree is left out: {error}."),
    });
    section.paragraph(
        "Two references, never mixed. **Wrong triangles** and errors of `t`, `u`, `v` are against exact \
         rational arithmetic on the same vertices and the very rays that a caster was given (for casters in \
         single precision: rays rounded to it). **Errors of pictures** are against the same picture \
         with 256 rays a pixel. Speeds are of casters taken in turn, ray set-up and the writing of hits \
         included; medians.",
    );
    section.paragraph("The casters:");
    section.paragraph(CASTERS);
    section
}

/// Speed against wrong triangles, over ordinary meshes and hard cases.
fn speed_against_errors(
    figures: &[meshes::MeshFigures],
    machine: &Machine,
    budget: &ReportBudget,
    embree: Option<&Arc<Embree>>,
    progress: &dyn ReportProgress,
) -> Result<Section, ReportError> {
    let mut section = Section::default();
    section.paragraph("## A. Speed against wrong triangles");
    let names: Vec<&str> = figures.iter().map(|mesh| mesh.name.as_str()).collect();
    section.paragraph(format!(
        "Over {}: speeds are geometric means, wrong triangles are added up.",
        names.join(", ")
    ));
    let mesh_summaries = numerics::summarize_meshes(figures);
    let outcomes = hard::measure(budget, embree, progress)?;
    let case_summaries = hard::summarize_cases(&outcomes);
    numerics::show(
        &mut section,
        "a-ordinary",
        "ordinary meshes",
        &mesh_summaries,
        machine.threads,
    );
    numerics::headline(&mut section, &mesh_summaries, &case_summaries);
    hard::show(&mut section, &outcomes, &case_summaries);
    time::show(
        &mut section,
        &time::measure(TIMED_CASES, budget.rounds.div_ceil(2), progress)?,
    );
    Ok(section)
}

/// The scales at which each caster breaks.
fn breaking_points(
    budget: &ReportBudget,
    embree: Option<&Arc<Embree>>,
    progress: &dyn ReportProgress,
) -> Result<Section, ReportError> {
    let mut section = Section::default();
    section.paragraph("## B. Where each caster breaks");
    for sweep in breaking::BreakingSweep::ALL {
        let curves = breaking::measure(sweep, budget, embree, progress)?;
        breaking::show(&mut section, sweep, &curves);
    }
    Ok(section)
}

/// Speed against mesh size and coverage.
fn speed_against_size(
    budget: &ReportBudget,
    embree: Option<&Arc<Embree>>,
    progress: &dyn ReportProgress,
) -> Result<Section, ReportError> {
    let mut section = Section::default();
    section.paragraph("## C. The shape of speed");
    section.paragraph(
        "All of one bumpy ball, seen so that it fills the frame where nothing else is said.",
    );
    for sweep in shape::SpeedSweep::ALL {
        let curves = shape::measure(sweep, budget, embree, progress)?;
        shape::show(&mut section, sweep, &curves);
    }
    Ok(section)
}

/// Speed against the density of rays.
fn ray_density(
    inputs: &[Input],
    budget: &ReportBudget,
    progress: &dyn ReportProgress,
) -> Result<Section, ReportError> {
    let mut section = Section::default();
    section.paragraph("## D. The density of rays");
    if let Some(input) = inputs.first() {
        let pictures = density::measure(&input.name, &input.scene, budget, progress)?;
        density::show(&mut section, &pictures)?;
    }
    let sampled = samples::measure(inputs, budget, progress)?;
    samples::show(&mut section, budget, &sampled);
    Ok(section)
}

/// The cost of optional features.
fn feature_costs(
    budget: &ReportBudget,
    progress: &dyn ReportProgress,
) -> Result<Section, ReportError> {
    let mut section = Section::default();
    section.paragraph("## E. Pay for what is used");
    feature_cost::show(&mut section, &feature_cost::measure(budget, progress)?);
    filters::show(&mut section, budget, &filters::measure(budget, progress)?);
    Ok(section)
}

/// A tile's traversal of the tree.
fn traversal_levels(
    inputs: &[Input],
    budget: &ReportBudget,
    progress: &dyn ReportProgress,
) -> Result<Section, ReportError> {
    let mut section = Section::default();
    // One mesh is clearer than many.
    let single = inputs.iter().find(|input| input.scene.objects.len() == 1);
    if let Some(input) = single.or(inputs.first()) {
        progress.begin("levels", 1);
        if let Some(shown) = levels::measure(input, budget.simd)? {
            levels::show(&mut section, shown);
        }
        progress.step();
    }
    Ok(section)
}

/// How to repeat the measurements.
fn reproduction(command: &str) -> Section {
    let mut section = Section::default();
    section.paragraph("## To measure this again");
    section.paragraph(format!("```sh\n{command}\n```"));
    section
}

/// The meaning of the names in plots and tables.
const CASTERS: &str = "\
- **RayCast tiles**: a tile of a camera's rays at once, as pictures are made; *exact*, or *fast* (rounded \
where doubles cannot tell). With the name of an instruction set where it is not this machine's widest.
- **RayCast single rays**: one ray after another, as `raycast cast` answers them.
- **plane, then inside**: where the ray meets the plane, and whether that is inside; every triangle for \
every ray. The renderer that RayCast replaces.
- **Möller–Trumbore**: their test of 1997, over boxes that lose no ray.
- **watertight**: the test of Woop, Benthin and Wald of 2013, over the same boxes.
- **obvhs BVH2, CWBVH**: obvhs's own trees with its triangle test, medium build.
- **Embree 1, 8, 16**: so many rays at a time; *robust* with its flag for watertight tests.

f32 is single precision, f64 double.";

/// Encodes all files.
fn files(
    sections: impl IntoIterator<Item = Section>,
    progress: &dyn ReportProgress,
) -> Result<Vec<ReportFile>, ReportError> {
    let mut text = String::new();
    let mut files = Vec::new();
    for section in sections {
        progress.begin("drawing", section.charts.len() as u64);
        text.push_str(&section.text);
        for (name, chart) in section.charts {
            files.push((format!("{name}.svg"), chart.svg()?.into_bytes()));
            files.push((format!("{name}.png"), chart.png()?));
            progress.step();
        }
        for (name, table) in section.tables {
            files.push((format!("{name}.csv"), table.csv()?));
        }
        files.extend(section.pictures);
    }
    files.push(("report.md".to_owned(), text.into_bytes()));
    Ok(files)
}
