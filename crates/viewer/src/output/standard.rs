//! Standard output and standard error.

use crate::failure::Failure;
use std::io::{self, Write};
use std::process::ExitCode;

/// Writes to standard output. A reader that has closed it has seen enough: that is no failure.
///
/// # Errors
/// Any other write error.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    written(
        stdout
            .write_all(text.as_bytes())
            .and_then(|()| stdout.flush()),
    )
}

/// The result of writing to standard output, as of [`print()`].
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

/// Writes a line to standard error, after the program's name. A failure to do so is ignored.
pub fn print_error(text: &str) {
    let _ = writeln!(io::stderr().lock(), "raycast: {text}");
}

impl Failure {
    /// Writes the failure to standard error; returns the exit status.
    pub fn report(&self) -> ExitCode {
        print_error(&self.to_string());
        self.exit_code()
    }
}
