use crate::failure::Failure;
use crate::output;
use std::io::Write;
use std::process::ExitCode;

/// Reports what is wrong with a command line in one line on standard error; prints help and version to standard output.
/// Returns the exit status.
pub fn refuse(error: &clap::Error) -> ExitCode {
    if !error.use_stderr() {
        let printed = error.print().and_then(|()| std::io::stdout().flush());
        return match output::written(printed) {
            Ok(()) => ExitCode::SUCCESS,
            Err(failure) => failure.report(),
        };
    }
    Failure::usage(one_line(&error.to_string())).report()
}

/// clap's message in one line: without `error:`, usage and hints.
pub(super) fn one_line(message: &str) -> String {
    let line: Vec<_> = message
        .lines()
        .map(str::trim)
        .take_while(|line| {
            !["Usage:", "For more information", "tip: to pass"]
                .iter()
                .any(|hint| line.starts_with(hint))
        })
        .filter(|line| !line.is_empty())
        .collect();
    let line = line.join(" ");
    let line = line.strip_prefix("error: ").unwrap_or(&line);
    if line.is_empty() {
        "no such command line; see `raycast --help`".to_owned()
    } else {
        format!("{line} (see `raycast --help`)")
    }
}
