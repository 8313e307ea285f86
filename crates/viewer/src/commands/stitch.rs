use super::Failure;
use super::banded::Banded;
use crate::cli::StitchArgs;
use crate::memory;
use crate::output::Output;
use crate::progress::TerminalProgress;
use raycast_core::camera::Rect;
use raycast_core::formats;
use raycast_core::picture::{self, Format, Fragment, FragmentError, Part, Picture, RowReader};
use std::fs::File;
use std::io::{BufReader, ErrorKind, Read};
use std::path::Path;
use std::time::SystemTime;

/// The largest fragment that is read: 4 GiB.
const BYTE_LIMIT: u64 = 4 << 30;

/// The first bytes of PNG and EXR.
const SIGNATURES: [&[u8]; 2] = [b"\x89PNG\r\n\x1a\n", b"\x76\x2f\x31\x01"];

/// Stitches fragments.
pub(super) fn run(args: &StitchArgs) -> Result<(), Failure> {
    let format = Format::from_name(&args.output.to_string_lossy())?;
    let inputs: Vec<&Path> = args.fragments.iter().map(AsRef::as_ref).collect();
    let output = Output::at(&args.output, &inputs)?;
    check_all_there(&inputs)?;

    let progress = TerminalProgress::new();
    progress.counting("reading", inputs.len() as u64);
    // Fragments of a picture that is written in bands are checked here, and read again where they are needed.
    let mut is_banded = false;
    let mut fragments = Vec::new();
    let mut parts = Vec::new();
    for path in inputs {
        let name = path.display().to_string();
        let state = file_state(path);
        if parts.is_empty() {
            let reader = open_rows(path)?;
            let (columns, rows) = reader.full_size();
            let goes_back = matches!(format, Format::Tiff | Format::Exr);
            is_banded = format.is_banded(columns, rows) && (output.can_seek() || !goes_back);
            if !is_banded {
                let layers = reader.has_layers();
                let memory_for = |columns, rows| format.memory_to_stitch(columns, rows, layers);
                memory::check_picture(&args.output, (columns, rows), memory_for, "")?;
            }
        }
        let part = if is_banded {
            Part::check(&name, &mut open_rows(path)?)?
        } else {
            let fragment = Fragment::decode(&name, &read(path)?)?;
            let part = Part::new(&name, &fragment);
            fragments.push((name.clone(), fragment));
            part
        };
        if format == Format::Exr && !part.has_layers {
            return Err(Failure::usage(format!(
                "{name}: an .exr is stitched from fragments that are .exr: this one has colours alone"
            )));
        }
        parts.push((part, state));
        progress.done(1);
    }
    if !is_banded {
        let picture = picture::stitch(&fragments)?;
        let recipe = parts.first().map(|(first, _)| &first.recipe);
        let bytes = picture.encode_with(format, recipe)?;
        return output.write(&bytes)?.finish();
    }
    stitch_bands(args, format, &output, parts, &progress)
}

/// Stitches a picture band by band, from fragments that are read again.
fn stitch_bands(
    args: &StitchArgs,
    format: Format,
    output: &Output,
    parts: Vec<(Part, FileState)>,
    progress: &TerminalProgress,
) -> Result<(), Failure> {
    let (parts, states): (Vec<Part>, Vec<_>) = parts.into_iter().unzip();
    picture::check_parts(&parts)?;
    let Some(Part { recipe, .. }) = parts.first() else {
        return Err(FragmentError::None.into());
    };
    let Some(banded) = Banded::new(&args.output, format, (recipe, None), output, false)? else {
        return Err(Failure::could_not("the output is no longer what it was"));
    };
    let mut open: Vec<Option<RowReader<BufReader<File>>>> = parts.iter().map(|_| None).collect();
    let written = banded.write(progress, |band| {
        let mut picture = Picture::try_blank(band.width, band.height, format == Format::Exr)?;
        for ((part, state), open) in parts.iter().zip(&states).zip(&mut open) {
            let top = part.rect.y.max(band.y);
            let bottom = part.rect.bottom().min(band.bottom());
            if top >= bottom {
                continue;
            }
            let path = Path::new(&part.name);
            let mut reader = match open.take() {
                Some(reader) => reader,
                None => read_rows(path, *state)?,
            };
            let rows = reader.rows(bottom - top)?;
            let rect = Rect {
                x: part.rect.x,
                y: top - band.y,
                width: part.rect.width,
                height: bottom - top,
            };
            if !picture.paste(rect, &rows.pixels, rows.layers.as_ref()) {
                return Err(changed(path));
            }
            // Closed at its end: there may be more fragments than a process may have open files.
            *open = (bottom < part.rect.bottom()).then_some(reader);
        }
        Ok(picture)
    })?;
    written.finish()
}

/// Checks that all fragments are there, so that one failure names all that are not.
fn check_all_there(inputs: &[&Path]) -> Result<(), Failure> {
    /// The most that a message names; the others are counted.
    const NAMED: usize = 10;
    let is_missing = |path: &&&Path| {
        let found = std::fs::metadata(path);
        found.is_err_and(|error| error.kind() == ErrorKind::NotFound)
    };
    let missing: Vec<String> = (inputs.iter().filter(is_missing))
        .map(|path| path.display().to_string())
        .collect();
    let more = match missing.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    match missing.len() {
        0 => Ok(()),
        count => Err(Failure::could_not(format!(
            "{count} of {} fragments are missing: {}{more}",
            inputs.len(),
            missing[..count.min(NAMED)].join(", ")
        ))),
    }
}

/// A file's length and modification time, by which a change during reading is detected.
type FileState = Option<(u64, SystemTime)>;

fn file_state(path: &Path) -> FileState {
    let found = std::fs::metadata(path).ok()?;
    Some((found.len(), found.modified().ok()?))
}

fn changed(path: &Path) -> Failure {
    Failure::could_not(format!("{}: was changed while it was read", path.display()))
}

/// Opens a checked fragment again.
fn read_rows(path: &Path, state: FileState) -> Result<RowReader<BufReader<File>>, Failure> {
    let reader = open_rows(path)?;
    match state == file_state(path) {
        true => Ok(reader),
        false => Err(changed(path)),
    }
}

fn open_rows(path: &Path) -> Result<RowReader<BufReader<File>>, Failure> {
    let name = path.display().to_string();
    let cannot = |error: std::io::Error| Failure::could_not(format!("{name}: {error}"));
    let file = formats::open_regular(path)?;
    let length = file.metadata().map_err(cannot)?.len();
    RowReader::open(BufReader::new(file), length).map_err(|error| {
        FragmentError::NotAFragment {
            name: name.clone(),
            reason: error.to_string(),
        }
        .into()
    })
}

/// A fragment's bytes; of a file in another format, only as many as are needed to recognise it.
fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let cannot = |error: std::io::Error| Failure::could_not(format!("{}: {error}", path.display()));
    let mut file = formats::open_regular(path)?;
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
