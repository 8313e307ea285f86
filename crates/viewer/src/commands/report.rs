use super::{Failure, warn_of_reading, workers};
use crate::cli::ReportArgs;
use crate::output::Folder;
use crate::progress::TerminalProgress;
use crate::worker::demo;
use crate::{memory, setup};
use raycast_core::formats;
use raycast_core::scene::Scene;
use raycast_report::{Input, ReportBudget, ReportError, ReportProgress, scenes, stage};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// The extensions of a report's files.
const KINDS: [&str; 4] = [".md", ".csv", ".png", ".svg"];

/// Measures speed against error, and writes a report.
pub(super) fn run(args: &ReportArgs) -> Result<(), Failure> {
    let budget = ReportBudget {
        simd: setup::instruction_set()?,
        ..if args.quick {
            ReportBudget::QUICK
        } else {
            ReportBudget::FULL
        }
    };
    let folder = Folder::at(&args.output, args.force)?;
    let inputs: Vec<&Path> = args.files.iter().map(AsRef::as_ref).collect();
    // Failing now is better than after minutes.
    folder.file("report.md", &inputs)?;
    let pool = workers(args.threads)?;
    let progress = TerminalProgress::new();
    let (scenes, opened) = if args.files.is_empty() {
        (own_scenes(&budget)?, Vec::new())
    } else {
        read_scenes(args, &progress)?
    };
    let inputs: Vec<&Path> = inputs
        .into_iter()
        .chain(opened.iter().map(PathBuf::as_path))
        .collect();
    // Inputs that the report might overwrite are found now as well.
    for name in inputs.iter().filter_map(|input| input.file_name()) {
        let name = name.to_string_lossy();
        if KINDS.iter().any(|kind| name.ends_with(kind)) {
            folder.file(&name, &inputs)?;
        }
    }
    let files =
        pool.install(|| raycast_report::report(&scenes, &budget, &command_line(args), &progress))?;
    // The marker first: from then on an interrupted command can be repeated.
    let marker = (Folder::MARKER, Folder::MARKER_TEXT.as_bytes());
    let files = files
        .iter()
        .map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
    let written = std::iter::once(marker)
        .chain(files)
        .map(|(name, bytes)| folder.file(name, &inputs)?.write(bytes))
        .collect::<Result<Vec<_>, _>>()?;
    for file in written {
        file.finish()?;
    }
    Ok(())
}

impl ReportProgress for TerminalProgress {
    fn begin(&self, what: &'static str, steps: u64) {
        self.counting(what, steps);
    }

    fn step(&self) {
        self.done(1);
    }
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        Self::could_not(error.to_string())
    }
}

/// The scene of each file, and all files that were opened.
fn read_scenes(
    args: &ReportArgs,
    progress: &TerminalProgress,
) -> Result<(Vec<Input>, Vec<PathBuf>), Failure> {
    let mut opened = Vec::new();
    let read = |path: &PathBuf| {
        progress.loading();
        let started = Instant::now();
        let file =
            formats::read_scene_within(path, &memory::budget(args.reading.limits()), &|share| {
                progress.loaded(share)
            })?;
        let parsing = started.elapsed();
        let accel = setup::visible(
            &path.display().to_string(),
            &file.scene,
            setup::single_tree(&file.scene)?,
        )?;
        warn_of_reading(&file.warnings, &file.scene, &accel);
        opened.extend(file.opened);
        let name = path.file_stem().unwrap_or(path.as_os_str());
        Ok(Input {
            name: name.to_string_lossy().into_owned(),
            scene: Arc::new(file.scene),
            parsing: Some(parsing),
        })
    };
    let inputs = args
        .files
        .iter()
        .map(read)
        .collect::<Result<_, Failure>>()?;
    Ok((inputs, opened))
}

/// The scenes of a report without files: the demo's meshes, the demo itself, and a bumpy ball of few and of many
/// triangles.
fn own_scenes(budget: &ReportBudget) -> Result<Vec<Input>, Failure> {
    let demo = demo::scene()?.scene;
    let in_memory = |name: String, scene: Scene| Input {
        name,
        scene: Arc::new(scene),
        parsing: None,
    };
    let mut inputs = vec![in_memory("demo scene".to_owned(), demo.clone())];
    for object in &demo.objects {
        let name = object.source.as_deref().and_then(Path::file_stem);
        let name = name.map_or(object.name.clone(), |name| {
            name.to_string_lossy().into_owned()
        });
        if ["monkey", "dahlia", "torus"].contains(&name.as_str()) {
            let mesh = object.mesh.as_ref().clone();
            inputs.push(in_memory(name, stage::scene_of([mesh])));
        }
    }
    for triangles in [10_000, 100_000, 1_000_000] {
        if triangles <= budget.largest {
            let name = format!("bumpy ball of {} k", triangles / 1000);
            let scene = stage::scene_of([scenes::bumpy_sphere(triangles)]);
            inputs.push(in_memory(name, scene));
        }
    }
    Ok(inputs)
}

/// The command that repeats the report.
fn command_line(args: &ReportArgs) -> String {
    let mut words = vec!["raycast report".to_owned()];
    words.extend(args.files.iter().map(|file| file.display().to_string()));
    words.push(format!("-o {}", args.output.display()));
    if args.quick {
        words.push("--quick".to_owned());
    }
    if args.threads > 0 {
        words.push(format!("--threads {}", args.threads));
    }
    words.join(" ")
}
