use super::{Failure, warn, warn_of_reading};
use crate::cli::SectionArgs;
use crate::output::Output;
use crate::progress::TerminalProgress;
use crate::{memory, setup};
use raycast_core::formats::{DrawingFormat, write_section};
use raycast_core::section::{SectionAxes, section};
use std::path::Path;

/// Draws the section of a scene with a plane.
pub(super) fn run(args: &SectionArgs) -> Result<(), Failure> {
    let name = args.output.to_string_lossy();
    let format = DrawingFormat::from_name(&name).ok_or_else(|| {
        Failure::usage(format!("{name}: expected a name that ends in .svg or .dxf"))
    })?;
    let inputs: Vec<&Path> = args.files.iter().map(AsRef::as_ref).collect();
    let output = Output::at(&args.output, &inputs)?;
    let progress = TerminalProgress::new();
    progress.loading();
    let file = setup::load(&args.files, &args.reading, &|share| progress.loaded(share))?;
    output.check_against(&file.opened)?;
    let planes = args.clip.planes(file.clip)?.only_enabled();
    let [plane] = planes.all() else {
        return Err(Failure::usage(format!(
            "a section is through one plane, found {}: give --clip once",
            planes.all().len()
        )));
    };
    progress.building();
    let scene_name = setup::name_of(&args.files);
    memory::check_tree(&scene_name, file.scene.triangle_count())?;
    // Where more than two polylines join, their order is that of the tree.
    let accel = setup::single_tree(&file.scene)?;
    let accel = setup::visible(&scene_name, &file.scene, accel)?;
    let lines = section(&accel, plane).map_err(|error| Failure::usage(error.to_string()))?;
    progress.clear();
    warn_of_reading(&file.warnings, &file.scene, &accel);
    let open = lines.iter().filter(|line| !line.is_closed).count();
    if lines.is_empty() {
        warn(&format!(
            "{name}: the plane cuts nothing: the drawing is empty"
        ));
    } else if open > 0 {
        let all = lines.len();
        warn(&format!(
            "{name}: {open} of {all} lines are not closed: the mesh is open there"
        ));
    }
    let mut bytes = Vec::new();
    write_section(&lines, &SectionAxes::of(plane), format, &mut bytes)
        .map_err(|error| Failure::could_not(format!("{name}: {error}")))?;
    output.write(&bytes)?.finish()
}
