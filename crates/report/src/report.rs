//! All of a report, from scenes to files.

use crate::budget::ReportBudget;
use crate::cases::time::RACES;
use crate::embree::Embree;
use crate::machine::Machine;
use crate::progress::ReportProgress;
use crate::sections::{
    Section, breaking, density, feature_cost, filters, hard, levels, meshes, numerics, shape, time,
};
use crate::subject::{Input, Subject};
use crate::table::ReportError;

/// A file of a report: its name, and all of it.
pub type ReportFile = (String, Vec<u8>);

/// Measures everything on the current workers, and makes the files of the report: `report.md`, and
/// what it shows.
///
/// # Errors
/// A scene that cannot be cast at, a plot that cannot be drawn.
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

    let mut opening = Section::default();
    opening.say("# RayCast: speed against error");
    opening.say(format!("Measured on: {machine}."));
    opening.say(match &library {
        Ok(library) => format!("Embree: version {}.", library.version()),
        Err(error) => format!("Embree is left out: {error}."),
    });
    opening.say(
        "Two references, never mixed. **Wrong triangles** and errors of `t`, `u`, `v` are against exact \
         rational arithmetic on the same vertices and the very rays that a caster was given (for casters in \
         single precision: rays rounded to it). **Errors of pictures** are against the same picture \
         with 256 rays a pixel. Speeds are of casters taken in turn, ray set-up and the writing of hits \
         included; medians.",
    );
    opening.say("The casters:");
    opening.say(CASTERS);
    let embree = library.as_ref().ok();
    let mut ordinary = Section::default();
    ordinary.say("## A. Speed against wrong triangles");
    let names: Vec<&str> = figures.iter().map(|mesh| mesh.name.as_str()).collect();
    ordinary.say(format!(
        "Over {}: speeds are geometric means, wrong triangles are added up.",
        names.join(", ")
    ));
    let over_meshes = numerics::over_meshes(&figures);
    let outcomes = hard::measure(budget, embree, progress)?;
    let over_cases = hard::over_cases(&outcomes);
    numerics::show(
        &mut ordinary,
        "a-ordinary",
        "ordinary meshes",
        &over_meshes,
        machine.threads,
    );
    numerics::headline(&mut ordinary, &over_meshes, &over_cases);
    hard::show(&mut ordinary, &outcomes, &over_cases);
    time::show(
        &mut ordinary,
        &time::measure(RACES, budget.rounds.div_ceil(2), progress)?,
    );
    let mut breaks = Section::default();
    breaks.say("## B. Where each caster breaks");
    for sweep in breaking::BreakingSweep::ALL {
        let curves = breaking::measure(sweep, budget, embree, progress)?;
        breaking::show(&mut breaks, sweep, &curves);
    }
    let mut speed = Section::default();
    speed.say("## C. The shape of speed");
    speed.say("All of one bumpy ball, seen so that it fills the frame where nothing else is said.");
    for sweep in shape::SpeedSweep::ALL {
        let curves = shape::measure(sweep, budget, embree, progress)?;
        shape::show(&mut speed, sweep, &curves);
    }
    let mut dense = Section::default();
    dense.say("## D. The density of rays");
    if let Some(input) = inputs.first() {
        let pictures = density::measure(&input.name, &input.scene, budget, progress)?;
        density::show(&mut dense, &pictures)?;
    }
    let mut paid = Section::default();
    paid.say("## E. Pay for what is used");
    feature_cost::show(&mut paid, &feature_cost::measure(budget, progress)?);
    filters::show(&mut paid, budget, &filters::measure(budget, progress)?);
    let mut descent = Section::default();
    // One mesh shows more than many.
    let single = inputs.iter().find(|input| input.scene.objects.len() == 1);
    if let Some(input) = single.or(inputs.first()) {
        progress.begin("levels", 1);
        if let Some(shown) = levels::measure(input, budget.simd)? {
            levels::show(&mut descent, shown);
        }
        progress.step();
    }
    let mut closing = Section::default();
    closing.say("## To measure this again");
    closing.say(format!("```sh\n{command}\n```"));
    let sections = [
        opening,
        ordinary,
        meshes::show(&figures, budget),
        breaks,
        speed,
        dense,
        paid,
        descent,
        closing,
    ];
    files(sections, progress)
}

/// What the names in plots and tables mean.
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

/// Writes everything down.
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
