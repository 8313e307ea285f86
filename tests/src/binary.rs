//! The real program, run as a person runs it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

/// Where the `raycast` binary is, built once, as these tests were; or the one that `RAYCAST_BINARY`
/// names, which is then what is tested.
///
/// Cargo builds a package's binaries for that package's own tests alone, so this asks for it.
pub fn path() -> &'static Path {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(|| {
        if let Some(path) = std::env::var_os("RAYCAST_BINARY") {
            return std::path::absolute(path).expect("a path is not empty");
        }
        // target/<profile>/deps/<this test>
        let test = std::env::current_exe().expect("a test knows its own path");
        let profile = test
            .ancestors()
            .nth(2)
            .expect("tests lie in target/<profile>/deps");
        let mut build = Command::new(env!("CARGO"));
        build
            .args(["build", "--quiet", "--workspace", "--bin", "raycast"])
            .arg("--target-dir")
            .arg(
                profile
                    .parent()
                    .expect("tests lie in target/<profile>/deps"),
            )
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .stdin(Stdio::null());
        if !cfg!(debug_assertions) {
            build.arg("--release");
        }
        let status = build.status().expect("cargo can be started");
        assert!(status.success(), "the binary does not build");
        let path = profile.join(format!("raycast{}", std::env::consts::EXE_SUFFIX));
        assert!(path.is_file(), "{} was not built", path.display());
        path
    })
}

/// The program with these arguments, its input closed.
pub fn command<I, S>(arguments: I) -> Command
where
    I: IntoIterator<Item = S>,
    S: AsRef<std::ffi::OsStr>,
{
    let mut command = Command::new(path());
    command.args(arguments).stdin(Stdio::null());
    command
}

/// What it said and how it ended. A panic is a failed test, whatever the exit status.
#[derive(Clone, Debug)]
pub struct ProgramOutput {
    /// The exit status; `None` where a signal ended it.
    pub status: Option<i32>,
    /// Standard output.
    pub output: Vec<u8>,
    /// Standard error.
    pub errors: String,
}

/// Runs a command to its end.
pub fn run(command: &mut Command) -> ProgramOutput {
    let all = run_to_any_end(command);
    let errors = &all.errors;
    assert!(!errors.contains("panicked"), "{command:?}: {errors}");
    all
}

/// [`run`], where a panic is one of the ends to expect: the standard library's own, before the program begins.
pub fn run_to_any_end(command: &mut Command) -> ProgramOutput {
    let Output {
        status,
        stdout,
        stderr,
    } = command.output().expect("the program can be started");
    let errors = String::from_utf8(stderr).expect("messages are UTF-8");
    ProgramOutput {
        status: status.code(),
        output: stdout,
        errors,
    }
}

/// Runs the program, which must succeed.
pub fn succeed<I, S>(arguments: I) -> ProgramOutput
where
    I: IntoIterator<Item = S>,
    S: AsRef<std::ffi::OsStr>,
{
    let mut command = command(arguments);
    let message = run(&mut command);
    assert_eq!(message.status, Some(0), "{command:?}: {}", message.errors);
    message
}

/// Runs the program, which must refuse with this exit status and one line on standard error, and
/// nothing on standard output. The line.
pub fn refuse<I, S>(status: i32, arguments: I) -> String
where
    I: IntoIterator<Item = S>,
    S: AsRef<std::ffi::OsStr>,
{
    let mut command = command(arguments);
    let message = run(&mut command);
    assert_eq!(
        message.status,
        Some(status),
        "{command:?}: {}",
        message.errors
    );
    let lines: Vec<&str> = message.errors.lines().collect();
    assert!(
        lines.len() == 1 && lines[0].len() > 20,
        "{command:?}: not one clear line: {lines:#?}"
    );
    assert!(
        message.output.is_empty(),
        "{command:?}: something on output"
    );
    lines[0].to_owned()
}
