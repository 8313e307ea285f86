use super::Failure;
use crate::cli::StitchArgs;
use crate::memory;
use crate::output::Output;
use crate::progress::TerminalProgress;
use raycast_core::picture::{self, Format, Fragment};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The largest fragment that is read: 4 GiB.
const BYTE_LIMIT: u64 = 4 << 30;

/// What a PNG and an EXR begin with.
const SIGNATURES: [&[u8]; 2] = [b"\x89PNG\r\n\x1a\n", b"\x76\x2f\x31\x01"];

/// Puts fragments together.
pub(super) fn run(args: &StitchArgs) -> Result<(), Failure> {
    let format = Format::from_name(&args.output.to_string_lossy())?;
    let inputs: Vec<&Path> = args.fragments.iter().map(AsRef::as_ref).collect();
    let output = Output::at(&args.output, &inputs)?;

    let progress = TerminalProgress::new();
    progress.counting("reading", inputs.len() as u64);
    let mut fragments = Vec::with_capacity(inputs.len());
    for path in inputs {
        let name = path.display().to_string();
        let fragment = Fragment::decode(&name, &read(path)?)?;
        if format == Format::Exr && fragment.picture.layers.is_none() {
            return Err(Failure::usage(format!(
                "{name}: an .exr is stitched from fragments that are .exr: this one has colours alone"
            )));
        }
        if fragments.is_empty() {
            let layers = fragment.picture.layers.is_some();
            let memory_for = |columns, rows| format.memory_to_stitch(columns, rows, layers);
            memory::check_picture(&args.output, fragment.full_size(), memory_for, "")?;
        }
        fragments.push((name, fragment));
        progress.done(1);
    }
    let picture = picture::stitch(&fragments)?;
    let recipe = fragments.first().map(|(_, first)| &first.recipe);
    output
        .write(&picture.encode_with(format, recipe)?)?
        .finish()
}

/// A fragment's bytes; of a file that is none at all, no more than it takes to tell.
fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let cannot = |error: std::io::Error| Failure::could_not(format!("{}: {error}", path.display()));
    let mut file = File::open(path).map_err(cannot)?;
    let mut bytes = Vec::new();
    file.by_ref()
        .take(8)
        .read_to_end(&mut bytes)
        .map_err(cannot)?;
    if SIGNATURES
        .iter()
        .any(|signature| bytes.starts_with(signature))
    {
        file.take(BYTE_LIMIT + 1 - 8)
            .read_to_end(&mut bytes)
            .map_err(cannot)?;
    }
    if bytes.len() as u64 > BYTE_LIMIT {
        return Err(Failure::could_not(format!(
            "{}: is larger than {BYTE_LIMIT} bytes, the most that a fragment may have",
            path.display()
        )));
    }
    Ok(bytes)
}
