//! Writes the demo assets into this package's directory, or checks those that are there.
//!
//! ```text
//! cargo run -p raycast-assets --release              write every file
//! cargo run -p raycast-assets --release -- --check   exit with 1 if a file would change
//! ```

use std::path::Path;
use std::process::ExitCode;
use std::{env, fs};

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let check = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => false,
        ["--check"] => true,
        _ => {
            eprintln!("usage: raycast-assets [--check]");
            return ExitCode::from(2);
        }
    };
    let directory = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut good = true;
    for (name, content) in raycast_assets::all() {
        let path = directory.join(&name);
        if fs::read(&path).is_ok_and(|existing| existing == content) {
            continue;
        }
        if check {
            eprintln!("{name} is not what the program makes");
            good = false;
        } else if let Err(error) = fs::write(&path, &content) {
            eprintln!("{}: {error}", path.display());
            good = false;
        } else {
            eprintln!("{name}: {} bytes", content.len());
        }
    }
    if good {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(1)
    }
}
