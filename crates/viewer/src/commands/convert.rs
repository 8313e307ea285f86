use super::{Failure, warn};
use crate::cli::ConvertArgs;
use crate::output::MeshFile;
use crate::progress::TerminalProgress;
use crate::setup;
use raycast_core::formats::SceneFile;
use std::path::Path;

/// Writes the meshes of files in another format.
pub(super) fn run(args: &ConvertArgs) -> Result<(), Failure> {
    let inputs: Vec<&Path> = args.files.iter().map(AsRef::as_ref).collect();
    let output = MeshFile::at(&args.output, args.ascii, &inputs)?;

    let progress = TerminalProgress::new();
    progress.loading();
    let SceneFile {
        scene,
        warnings,
        opened,
        ..
    } = setup::load(&args.files, &args.reading, &|share| progress.loaded(share))?;
    progress.clear();
    for warning in &warnings {
        warn(warning);
    }
    let name = args.output.display();
    for loss in output.write(&scene, || opened.clone())? {
        warn(&format!("{name}: {loss}"));
    }
    Ok(())
}
