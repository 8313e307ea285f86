//! All of a report, from scenes to files.

use crate::cases::time::RACES;
use crate::effort::Effort;
use crate::embree::Embree;
use crate::machine::Machine;
use crate::sections::{
    Section, breaking, density, filters, hard, levels, meshes, numerics, pay, shape, time,
};
use crate::subject::{Input, Subject};
use crate::table::ReportError;
use crate::watch::Watch;

/// A file of a report: its name, and all of it.
pub type ReportFile = (String, Vec<u8>);

/// Measures everything on the current workers, and makes the files of the report: `report.md`, and
/// what it shows.
///
/// # Errors
/// A scene that cannot be cast at, a plot that cannot be drawn.
pub fn report(
    inputs: &[Input],
    effort: &Effort,
    command: &str,
    watch: &dyn Watch,
) -> Result<Vec<ReportFile>, ReportError> {
    let machine = Machine::this(rayon::current_num_threads());
    let library = Embree::load(machine.threads);
    let mut figures = Vec::with_capacity(inputs.len());
    for input in inputs {
        watch.begin("building", 1);
        let subject = Subject::new(input, effort.simd, library.as_ref().ok())?;
        figures.push(meshes::measure(&subject, effort, watch)?);
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
         rational arithmetic on the same vertices and the very rays that a way was given (for ways in \
         single precision: rays rounded to it). **Errors of pictures** are against the same picture \
         with 256 rays a pixel. Speeds are of ways taken in turn, ray set-up and the writing of hits \
         included; medians.",
    );
    opening.say("The ways of casting:");
    opening.say(WAYS);
    let embree = library.as_ref().ok();
    let mut ordinary = Section::default();
    ordinary.say("## A. Speed against wrong triangles");
    let names: Vec<&str> = figures.iter().map(|mesh| mesh.name.as_str()).collect();
    ordinary.say(format!(
        "Over {}: speeds are geometric means, wrong triangles are added up.",
        names.join(", ")
    ));
    let over_meshes = numerics::over_meshes(&figures);
    let outcomes = hard::measure(effort, embree, watch)?;
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
        &time::measure(RACES, effort.rounds.div_ceil(2), watch)?,
    );
    let mut breaks = Section::default();
    breaks.say("## B. Where each way breaks");
    for sweep in breaking::Sweep::ALL {
        let curves = breaking::measure(sweep, effort, embree, watch)?;
        breaking::show(&mut breaks, sweep, &curves);
    }
    let mut speed = Section::default();
    speed.say("## C. The shape of speed");
    speed.say("All of one bumpy ball, seen so that it fills the frame where nothing else is said.");
    for sweep in shape::Sweep::ALL {
        let curves = shape::measure(sweep, effort, embree, watch)?;
        shape::show(&mut speed, sweep, &curves);
    }
    let mut dense = Section::default();
    dense.say("## D. The density of rays");
    if let Some(input) = inputs.first() {
        let pictures = density::measure(&input.name, &input.scene, effort, watch)?;
        density::show(&mut dense, &pictures)?;
    }
    let mut paid = Section::default();
    paid.say("## E. Pay for what is used");
    pay::show(&mut paid, &pay::measure(effort, watch)?);
    filters::show(&mut paid, effort, &filters::measure(effort, watch)?);
    let mut way_down = Section::default();
    // One mesh shows more than many.
    let single = inputs.iter().find(|input| input.scene.objects.len() == 1);
    if let Some(input) = single.or(inputs.first()) {
        watch.begin("levels", 1);
        if let Some(shown) = levels::measure(input, effort.simd)? {
            levels::show(&mut way_down, shown);
        }
        watch.step();
    }
    let mut closing = Section::default();
    closing.say("## To measure this again");
    closing.say(format!("```sh\n{command}\n```"));
    let sections = [
        opening,
        ordinary,
        meshes::show(&figures, effort),
        breaks,
        speed,
        dense,
        paid,
        way_down,
        closing,
    ];
    files(sections, watch)
}

/// What the names in plots and tables mean.
const WAYS: &str = "\
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
    watch: &dyn Watch,
) -> Result<Vec<ReportFile>, ReportError> {
    let mut text = String::new();
    let mut files = Vec::new();
    for section in sections {
        watch.begin("drawing", section.charts.len() as u64);
        text.push_str(&section.text);
        for (name, chart) in section.charts {
            files.push((format!("{name}.svg"), chart.svg()?.into_bytes()));
            files.push((format!("{name}.png"), chart.png()?));
            watch.step();
        }
        for (name, table) in section.tables {
            files.push((format!("{name}.csv"), table.csv()?));
        }
        files.extend(section.pictures);
    }
    files.push(("report.md".to_owned(), text.into_bytes()));
    Ok(files)
}
