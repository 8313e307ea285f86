use super::{Failure, warn, workers};
use crate::cli::PrepareArgs;
use crate::output::Output;
use crate::progress::TerminalProgress;
use crate::{memory, setup};
use raycast_core::formats::{PrepareError, write_prepared};
use std::path::Path;

/// Writes meshes as a prepared file.
pub(super) fn run(args: &PrepareArgs) -> Result<(), Failure> {
    let name = args.output.to_string_lossy();
    let extension = args.output.extension();
    if !extension.is_some_and(|extension| extension.eq_ignore_ascii_case("raycast")) {
        return Err(Failure::usage(format!(
            "{name}: expected a name that ends in .raycast"
        )));
    }
    let inputs: Vec<&Path> = args.files.iter().map(AsRef::as_ref).collect();
    let output = Output::at(&args.output, &inputs)?;
    workers(args.threads)?.install(|| {
        let progress = TerminalProgress::new();
        progress.loading();
        let file = setup::load(&args.files, &args.reading, &|share| progress.loaded(share))?;
        output.check_against(&file.opened)?;
        progress.clear();
        for warning in &file.warnings {
            warn(warning);
        }
        memory::check_tree(
            &setup::name_of(&args.files),
            setup::stored_triangles(&file.scene),
        )?;
        let mut out = output.create()?;
        let written = write_prepared(&file, &args.output, &mut out);
        written.map_err(|error| match error {
            PrepareError::Io(error) => {
                Failure::could_not(format!("{name}: cannot be written: {error}"))
            }
            refusal => Failure::could_not(format!("{}: {refusal}", setup::name_of(&args.files))),
        })?;
        out.finish()
    })
}
