//! Pictures and fragments as command lines, for job schedulers.

use super::schedulers::{kubernetes, quote, slurm};
use super::{Failure, frames, render};
use crate::cli::{Cli, FrameArgs, FrameRange, PlanArgs, ReadingArgs, Subcommand, frame_path};
use crate::output::Output;
use crate::setup;
use clap::Parser;
use raycast_core::picture::Format;
use std::ffi::OsString;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Options of `raycast render` about the camera, each with a value. `raycast verify` takes them from a picture's
/// recipe.
const CAMERA: [&str; 13] = [
    "--size",
    "--step",
    "--fov",
    "--projection",
    "--eye",
    "--target",
    "--up",
    "--orbit",
    "--shift",
    "--lens",
    "--stereo",
    "--eye-distance",
    "--convergence",
];

/// The option of `raycast render` that names a file to be read.
const FILE_OPTION: &str = "--texture";

/// Options that a plan sets itself.
const OWN: [&str; 10] = [
    "--output",
    "-o",
    "--tiles",
    "--tile-size",
    "--sub-camera",
    "--unfinished",
    "--frames",
    "--turntable",
    "--stats",
    "--save-scene",
];

/// Writes a plan.
pub(super) fn run(args: &PlanArgs) -> Result<(), Failure> {
    let plan = Plan::new(args)?;
    let inputs: Vec<&Path> = args.files.iter().map(AsRef::as_ref).collect();
    let beside = |suffix: &str| {
        let mut name = plan.path.clone().into_os_string();
        name.push(suffix);
        PathBuf::from(name)
    };
    let jobs = plan.jobs()?;
    let stitching = plan.stitching()?;
    let files = [
        (plan.path.clone(), lines(&jobs)),
        (beside(".stitch"), lines(&stitching)),
        (
            beside(".slurm"),
            slurm(&plan.path, jobs.len(), stitching.len())?,
        ),
        (beside(".yaml"), kubernetes(&plan.path, "", jobs.len())?),
        (
            beside(".stitch.yaml"),
            kubernetes(&plan.path, ".stitch", stitching.len())?,
        ),
    ];
    let own = Output::at(&plan.path, &inputs)?;
    if own.is_taken() && !is_plan(&plan.path) {
        // It may be a file that a mesh names; no mesh is read here, so that cannot be checked.
        return Err(Failure::could_not(format!(
            "{}: is there already and is no plan: give the plan another name",
            plan.path.display()
        )));
    }
    // Jobs would refuse these as well; the plan's own files must not be among them either.
    let mut taken = inputs.clone();
    taken.extend(files.iter().map(|(path, _)| path.as_path()));
    for frame in plan.ends() {
        Output::at(&plan.picture(frame), &taken)?;
    }
    let mut outputs = Vec::new();
    for (path, text) in &files {
        let output = match *path == plan.path {
            true => own.clone(),
            false => own.beside(path, &inputs)?,
        };
        outputs.push((output, text));
    }
    if plan.args.tiles.is_some() {
        let parts = plan.parts();
        std::fs::create_dir_all(&parts).map_err(|error| {
            Failure::could_not(format!("{}: cannot be made: {error}", parts.display()))
        })?;
    }
    // The plan itself is written last, so that it exists only if all other files do.
    for (output, text) in outputs.into_iter().rev() {
        output.write(text.as_bytes())?.finish()?;
    }
    Ok(())
}

/// Whether a file is a plan, or empty.
fn is_plan(path: &Path) -> bool {
    const FIRST_LINE: u64 = 1 << 16;
    let mut start = Vec::new();
    let read = File::open(path).and_then(|file| file.take(FIRST_LINE).read_to_end(&mut start));
    let start = String::from_utf8_lossy(&start);
    let line = start.lines().next().unwrap_or_default();
    let is_job = line.contains(" render ") && line.contains(" -o ");
    read.is_ok() && (start.is_empty() || is_job)
}

/// The requested plan, with absolute paths: a job may start in any folder.
struct Plan<'a> {
    args: &'a PlanArgs,
    path: PathBuf,
    program: PathBuf,
    files: Vec<PathBuf>,
    pictures: PathBuf,
    /// The frames of an animation.
    range: Option<FrameRange>,
    /// The options of every render.
    options: Vec<OsString>,
}

impl<'a> Plan<'a> {
    fn new(args: &'a PlanArgs) -> Result<Self, Failure> {
        let absolute = |path: &Path| {
            std::path::absolute(path)
                .map_err(|error| Failure::could_not(format!("{}: {error}", path.display())))
        };
        let own = |option: &&OsString| {
            let text = option.to_string_lossy();
            let name = text.split('=').next().unwrap_or_default();
            OWN.contains(&name) || (text.starts_with("-o") && !text.starts_with("--"))
        };
        if let Some(option) = args.render.iter().find(own) {
            return Err(Failure::usage(format!(
                "{}: a plan says itself what its jobs write, and which part",
                option.display()
            )));
        }
        let named = FrameArgs {
            frames: args.frames,
            turntable: args.turntable,
            rate: None,
        }
        .range();
        let path = absolute(&args.output)?;
        let pictures = match &args.pictures {
            Some(pictures) => absolute(pictures)?,
            None => {
                let mut name = path.clone().into_os_string();
                name.push(if named.is_some() { "-%05d.png" } else { ".png" });
                PathBuf::from(name)
            }
        };
        let range = match (frame_path(&pictures, 0).is_some(), named) {
            (false, None) => None,
            (false, Some(_)) => {
                return Err(Failure::usage(format!(
                    "{}: expected a name with a place for the frame's number (%05d)",
                    pictures.display()
                )));
            }
            (true, Some(range)) => Some(range),
            (true, None) => {
                let file = setup::load_settings(&args.files, &ReadingArgs::default())?;
                Some(frames::range(None, &pictures, file.animation.as_ref())?)
            }
        };
        let program = match &args.program {
            // A bare name is looked up where the job runs.
            Some(program) if program.components().count() < 2 => program.clone(),
            Some(program) => absolute(program)?,
            None => std::env::current_exe()
                .map_err(|error| Failure::could_not(format!("this program: {error}")))?,
        };
        let files = args
            .files
            .iter()
            .map(|file| absolute(file))
            .collect::<Result<_, _>>()?;
        let options = with_absolute_files(&args.render, absolute)?;
        let plan = Self {
            args,
            path,
            program,
            files,
            pictures,
            range,
            options,
        };
        plan.check()?;
        Ok(plan)
    }

    /// Checks that this program accepts the command lines, as far as that is known before meshes are read.
    fn check(&self) -> Result<(), Failure> {
        Format::from_name(&self.pictures.to_string_lossy())?;
        // If there are the last frame and sub-camera, there are the others.
        let frame = self.range.map(|range| range.last);
        let cell = (self.args.tiles).map(|(columns, rows)| (columns - 1, rows - 1));
        for words in [self.render(frame, cell), self.verify(&self.picture(frame))] {
            let parsed = Cli::try_parse_from(&words).map_err(|error| {
                let message = error.to_string();
                let message = message.lines().next().unwrap_or_default().to_owned();
                Failure::usage(
                    message
                        .strip_prefix("error: ")
                        .unwrap_or(&message)
                        .to_owned(),
                )
            })?;
            let files = match &parsed.command {
                Some(Subcommand::Render(args)) => args.files.len(),
                Some(Subcommand::Verify(args)) => args.files.len() - 1,
                _ => {
                    return Err(Failure::usage("these options are none of `raycast render`"));
                }
            };
            if files != self.files.len() {
                return Err(Failure::usage(
                    "files are named before `--`, and options of `raycast render` behind it",
                ));
            }
            if let Some(Subcommand::Render(args)) = &parsed.command {
                match frames::are_requested(args) {
                    true => frames::check(args)?,
                    false => render::check(args)?,
                }
            }
        }
        Ok(())
    }

    /// The folder of the fragments.
    fn parts(&self) -> PathBuf {
        let mut name = self.path.clone().into_os_string();
        name.push(".parts");
        name.into()
    }

    /// A frame's picture.
    fn picture(&self, frame: Option<u32>) -> PathBuf {
        frame
            .and_then(|frame| frame_path(&self.pictures, frame))
            .unwrap_or_else(|| self.pictures.clone())
    }

    /// A fragment's file, with a placeholder for the frame's number. An .exr has .exr fragments, any other format
    /// PNG.
    fn part(&self, (column, row): (u32, u32)) -> PathBuf {
        let is_exr = Format::from_name(&self.pictures.to_string_lossy()).ok() == Some(Format::Exr);
        let end = if is_exr { "exr" } else { "png" };
        let frame = if self.range.is_some() { "%05d-" } else { "" };
        self.parts().join(format!("{frame}{column}-{row}.{end}"))
    }

    /// The frames, or the one picture.
    fn frames(&self) -> Vec<Option<u32>> {
        match self.range {
            Some(range) => range.numbers().map(Some).collect(),
            None => vec![None],
        }
    }

    /// The first frame and the last, or the one picture.
    fn ends(&self) -> Vec<Option<u32>> {
        match self.range {
            Some(range) => vec![Some(range.first), Some(range.last)],
            None => vec![None],
        }
    }

    fn cells(&self) -> Vec<(u32, u32)> {
        let (columns, rows) = self.args.tiles.unwrap_or_default();
        (0..rows)
            .flat_map(|row| (0..columns).map(move |column| (column, row)))
            .collect()
    }

    /// The command that renders a frame, or a sub-camera of it.
    fn render(&self, frame: Option<u32>, cell: Option<(u32, u32)>) -> Vec<OsString> {
        let mut words = vec![self.program.clone().into(), "render".into()];
        words.extend(self.files.iter().map(|file| file.clone().into()));
        words.extend(self.options.iter().cloned());
        if let Some(count) = self.args.turntable {
            words.extend(["--turntable".into(), count.to_string().into()]);
        }
        if let Some(frame) = frame {
            words.extend(["--frames".into(), format!("{frame}..{frame}").into()]);
        }
        words.push("-o".into());
        match (cell, self.args.tiles) {
            (Some((column, row)), Some((columns, rows))) => {
                words.push(self.part((column, row)).into());
                words.extend(["--tiles".into(), format!("{columns}x{rows}").into()]);
                words.extend(["--sub-camera".into(), format!("{column},{row}").into()]);
            }
            _ => words.push(self.pictures.clone().into()),
        }
        words
    }

    /// A line for each job.
    fn jobs(&self) -> Result<Vec<String>, Failure> {
        let mut jobs = Vec::new();
        for frame in self.frames() {
            if self.args.tiles.is_none() {
                jobs.push(line(&self.render(frame, None))?);
            }
            for cell in self.cells() {
                jobs.push(line(&self.render(frame, Some(cell)))?);
            }
        }
        Ok(jobs)
    }

    fn verify(&self, picture: &Path) -> Vec<OsString> {
        let mut words: Vec<OsString> = vec![self.program.clone().into(), "verify".into()];
        words.push(picture.into());
        words.extend(self.files.iter().map(|file| file.clone().into()));
        words.extend(without_camera(&self.options));
        words
    }

    /// A line for each picture: stitched if it is in tiles, and verified if its format allows it.
    fn stitching(&self) -> Result<Vec<String>, Failure> {
        let format = Format::from_name(&self.pictures.to_string_lossy())?;
        let can_verify = matches!(format, Format::Png | Format::Exr);
        let mut lines = Vec::new();
        for frame in self.frames() {
            let picture = self.picture(frame);
            let mut commands = Vec::new();
            if self.args.tiles.is_some() {
                let mut words: Vec<OsString> = vec![self.program.clone().into(), "stitch".into()];
                words.extend(self.cells().into_iter().map(|cell| {
                    let part = self.part(cell);
                    let part = frame
                        .and_then(|frame| frame_path(&part, frame))
                        .unwrap_or(part);
                    part.into()
                }));
                words.extend(["-o".into(), picture.clone().into()]);
                commands.push(line(&words)?);
            }
            if can_verify {
                commands.push(line(&self.verify(&picture))?);
            }
            match commands.as_slice() {
                [] => {}
                [one] => lines.push(one.clone()),
                // In a subshell: a failure before `&&` in a list does not end a shell with -e.
                both => lines.push(format!("({})", both.join(" && "))),
            }
        }
        Ok(lines)
    }
}

/// The options, with file names replaced by `absolute`.
fn with_absolute_files(
    options: &[OsString],
    absolute: impl Fn(&Path) -> Result<PathBuf, Failure>,
) -> Result<Vec<OsString>, Failure> {
    let mut made = Vec::new();
    let mut words = options.iter();
    while let Some(word) = words.next() {
        if word == FILE_OPTION {
            made.push(word.clone());
            if let Some(file) = words.next() {
                made.push(absolute(Path::new(file))?.into());
            }
            continue;
        }
        // A plan is Unicode; other words are refused where they are quoted.
        let file = word
            .to_str()
            .and_then(|word| word.strip_prefix(FILE_OPTION)?.strip_prefix('='));
        made.push(match file {
            Some(file) => {
                let mut word = OsString::from(format!("{FILE_OPTION}="));
                word.push(absolute(Path::new(file))?);
                word
            }
            None => word.clone(),
        });
    }
    Ok(made)
}

/// The options without those about the camera, and without `--resume`.
fn without_camera(options: &[OsString]) -> Vec<OsString> {
    let mut kept = Vec::new();
    let mut words = options.iter();
    while let Some(word) = words.next() {
        let text = word.to_string_lossy();
        if CAMERA.contains(&&*text) {
            words.next();
            continue;
        }
        let name = text.split('=').next().unwrap_or_default();
        if !CAMERA.contains(&name) && text != "--resume" {
            kept.push(word.clone());
        }
    }
    kept
}

fn lines(lines: &[String]) -> String {
    lines.iter().map(|line| format!("{line}\n")).collect()
}

/// A command line for a POSIX shell.
fn line(words: &[OsString]) -> Result<String, Failure> {
    let quoted: Result<Vec<_>, _> = words.iter().map(|word| quote(word)).collect();
    Ok(quoted?.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file that jobs can name, from this crate's folder, in which tests run.
    const MESH: &str = "../../assets/monkey.obj";

    /// A plan's lines; `MESH` stands for a mesh, by its whole path.
    fn plan(line: &str) -> Result<Vec<String>, Failure> {
        let line = line.replace("MESH", &at(MESH));
        let words = std::iter::once("raycast").chain(line.split_whitespace());
        let Some(Subcommand::Plan(args)) = Cli::try_parse_from(words).expect("it parses").command
        else {
            panic!("not a plan: {line}");
        };
        let plan = Plan::new(&args)?;
        let mut lines = plan.jobs()?;
        lines.extend(plan.stitching()?);
        let mesh = at(MESH);
        Ok(lines
            .iter()
            .map(|line| line.replace(&mesh, "MESH"))
            .collect())
    }

    fn at(name: &str) -> String {
        let path = std::path::absolute(name).expect("a folder");
        path.display().to_string()
    }

    #[test]
    fn a_plan_has_a_line_a_fragment_and_a_line_a_picture() {
        let lines = plan(
            "plan MESH -o /p --program /r --turntable 3 --tiles 2x1 -- --up-axis z --size 64x48 --mode=flat",
        );
        let lines = lines.expect("a plan");
        assert_eq!(lines.len(), 3 * 2 + 3);
        assert_eq!(
            lines[3],
            "/r render MESH --up-axis z --size 64x48 --mode=flat --turntable 3 --frames 1..1 \
             -o /p.parts/%05d-1-0.png --tiles 2x1 --sub-camera 1,0"
        );
        assert_eq!(
            lines[7],
            "(/r stitch /p.parts/00001-0-0.png /p.parts/00001-1-0.png -o /p-00001.png && \
             /r verify /p-00001.png MESH --up-axis z --mode=flat)"
        );
        let one = plan("plan MESH -o /p --program /r --pictures /x.tif").expect("a plan");
        assert_eq!(one, ["/r render MESH -o /x.tif"]);
    }

    #[test]
    fn what_a_render_would_refuse_is_refused_at_once() {
        for (bad, named) in [
            ("plan MESH -o /p -- --size 0x3", "--size"),
            ("plan MESH -o /p -- --colour red", "--colour"),
            ("plan MESH -o /p -- --tiles 2x2", "--tiles"),
            ("plan MESH -o /p -- -o x.png", "-o"),
            ("plan MESH -o /p --pictures /x-%05d.png", "--turntable"),
            ("plan MESH -o /p --frames 0..3", "[animation]"),
            ("plan MESH -o /p --turntable 3 --frames 0..3", "beyond 2"),
            ("plan MESH -o /p --turntable 3 --pictures /x.png", "%05d"),
            ("plan MESH -o /p --pictures /x.gif", "/x.gif"),
            ("plan MESH -o /p -- /b.obj", "before `--`"),
            (
                "plan MESH -o /p -- --projection fisheye --lens=0.1,0,0,0,0",
                "--lens is for",
            ),
            ("plan MESH -o /p -- --stereo pair", "--eye-distance"),
            (
                "plan MESH -o /p -- --projection cylindrical --fov 190",
                "--fov",
            ),
            ("plan MESH -o /p -- --clip none --clip x:1", "--clip none"),
            (
                "plan MESH -o /p -- --projection fisheye --shift 1,0",
                "--shift is for",
            ),
            ("plan MESH -o /p --tiles 9x9 -- --size 8x8", "8,8 in a grid"),
            ("plan MESH -o /p --tiles 2x2 -- --resume", "--resume"),
        ] {
            let refused = plan(bad).expect_err(bad);
            assert!(matches!(refused, Failure::Usage(_)), "{bad}: {refused}");
            assert!(refused.to_string().contains(named), "{bad}: {refused}");
        }
        let folder = at("../../assets");
        for (bad, named) in [
            ("plan /none.obj -o /p", "/none.obj"),
            ("plan MESH -o /p -- --texture /none.png", "/none.png"),
            (&*format!("plan {folder} -o /p"), "a folder"),
        ] {
            let refused = plan(bad).expect_err(bad);
            assert!(matches!(refused, Failure::CouldNot(_)), "{bad}: {refused}");
            assert!(refused.to_string().contains(named), "{bad}: {refused}");
        }
    }

    #[test]
    fn files_are_named_from_the_root_wherever_they_are_named() {
        const IMAGE: &str = "../../assets/leopard.png";
        for texture in ["--texture ", "--texture="] {
            let line =
                format!("plan {MESH} -o p --program bin/r -- {texture}{IMAGE} --mode texture");
            let lines = plan(&line).expect("a plan");
            let words: Vec<&str> = lines[0].split([' ', '=']).collect();
            assert_eq!(words[0], at("bin/r"));
            assert!(words.contains(&"MESH"), "{words:?}");
            assert!(words.contains(&at(IMAGE).as_str()), "{words:?}");
        }
        let line = format!("plan {MESH} -o p --program raycast");
        let bare = plan(&line).expect("a plan");
        assert!(bare[0].starts_with("raycast render MESH"), "{}", bare[0]);
    }
}
