//! The key bindings file: reading it, writing a template, opening it in the desktop's editor.

use crate::output::Output;
use std::io::{ErrorKind, Read};
use std::path::Path;
use std::process::{Command, Stdio};

/// The most bytes that are read: all commands with ten keys each take half of it. The window parses them between two
/// frames, so the limit also bounds that time.
const MOST_BYTES: u64 = 1 << 16;

/// The file's text; `None` where there is none. Invalid UTF-8 becomes characters that the parser refuses.
pub(super) fn read(path: &Path) -> Result<Option<String>, String> {
    let name = path.display();
    // Reading a pipe would block.
    let is_other = std::fs::metadata(path).is_ok_and(|at| !at.is_file());
    if is_other {
        return Err(format!("{name}: expected a file"));
    }
    let file = match std::fs::File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(format!("{name}: {error}")),
    };
    let mut bytes = Vec::new();
    file.take(MOST_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| format!("{name}: {error}"))?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(format!("{name}: expected at most {MOST_BYTES} bytes"));
    }
    Ok(Some(String::from_utf8_lossy(&bytes).into_owned()))
}

/// Writes a file with this text, unless there is one.
pub(super) fn write(path: &Path, text: &str) -> Result<(), String> {
    if path.symlink_metadata().is_ok() {
        return Ok(());
    }
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    let written = Output::at(path, &[]).and_then(|output| output.write(text.as_bytes())?.finish());
    written.map_err(|failure| failure.to_string())
}

/// Opens the file in the desktop's text editor.
pub(super) fn edit(path: &Path) -> Result<(), String> {
    let (program, before): (_, &[&str]) = if cfg!(target_os = "macos") {
        ("open", &["-t"])
    } else if cfg!(windows) {
        ("notepad", &[])
    } else {
        ("xdg-open", &[])
    };
    let opened = Command::new(program)
        .args(before)
        .arg(path)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    let why = match opened {
        Ok(status) if status.success() => return Ok(()),
        Ok(status) => status.to_string(),
        Err(error) => error.to_string(),
    };
    let path = path.display();
    Err(format!(
        "{path}: {program} does not open it ({why}): change it in any editor, then Help, Reload keys"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_written_once_and_read_as_far_as_it_is_text() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("settings/keys.toml");
        assert_eq!(read(&path), Ok(None));
        write(&path, "version = 1\n").expect("written");
        write(&path, "another").expect("left alone");
        assert_eq!(read(&path), Ok(Some("version = 1\n".to_owned())));
        std::fs::write(&path, b"ok \xff").expect("written");
        assert_eq!(read(&path), Ok(Some("ok \u{fffd}".to_owned())));
        let long = vec![b' '; MOST_BYTES as usize + 1];
        std::fs::write(&path, long).expect("written");
        assert!(read(&path).is_err_and(|error| error.contains("keys.toml: expected at most")));
    }
}
