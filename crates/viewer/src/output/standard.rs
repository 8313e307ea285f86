//! Standard output and standard error.

use crate::failure::Failure;
use std::io::{self, Write};
use std::process::ExitCode;

/// Writes to standard output. A reader that went away has seen enough: that is no failure.
///
/// # Errors
/// Anything else that keeps it from being written.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    written(
        stdout
            .write_all(text.as_bytes())
            .and_then(|()| stdout.flush()),
    )
}

/// What became of writing to standard output, as [`print()`] has it.
///
/// # Errors
/// As [`print()`].
pub fn written(outcome: io::Result<()>) -> Result<(), Failure> {
    match outcome {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::could_not(
            format!("standard output could not be written: {error}"),
        )),
        _ => Ok(()),
    }
}

/// Says a line on standard error, after the program's name. Where that cannot be written either there
/// is nobody to be told.
pub fn say(text: &str) {
    let _ = writeln!(io::stderr().lock(), "raycast: {text}");
}

impl Failure {
    /// Says it on standard error; returns the exit status.
    pub fn tell(&self) -> ExitCode {
        say(&self.to_string());
        self.exit_code()
    }
}
