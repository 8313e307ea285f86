//! The key bindings file, beside the settings file.

use crate::state::State;
use crate::state::news::{News, receive};
use crate::ui::registry::KeysFile;
use crate::worker::files::Files;
use std::path::PathBuf;

const NAME: &str = "keys.toml";

/// Its path; `None` on a system without a folder for settings.
pub(super) fn path() -> Option<PathBuf> {
    Some(eframe::storage_dir("raycast")?.join(NAME))
}

/// Opens it; if there is none, writes a template first.
pub(super) fn open(state: &mut State, files: &Files) {
    match path() {
        Some(path) => files.open_keys(path, KeysFile::template()),
        None => tell(state, no_folder()),
    }
}

/// Reads it at the user's request.
pub(super) fn read_again(state: &mut State, files: &Files) {
    match path() {
        Some(path) => files.read_keys(path, true),
        None => tell(state, no_folder()),
    }
}

/// Applies its key bindings.
pub(super) fn set(state: &mut State, context: &egui::Context, text: &str, asked: bool) {
    let KeysFile {
        keymap,
        faults,
        taken,
    } = KeysFile::read(NAME, text);
    if asked {
        let changed = match keymap.changed() {
            0 => "Every command has its usual keys".to_owned(),
            1 => "1 command has other keys than usual".to_owned(),
            more => format!("{more} commands have other keys than usual"),
        };
        let said = std::iter::once(changed).chain(taken);
        said.for_each(|text| tell(state, News::Done(text)));
    }
    keymap.install(context);
    if !faults.is_empty() {
        let path = path().map_or_else(|| NAME.into(), |path| path.display().to_string());
        let faults = faults.join("\n");
        tell(state, News::Failed(format!("Faults in {path}:\n{faults}")));
    }
}

fn no_folder() -> News {
    News::Failed("This system has no folder for settings: keys cannot be changed".to_owned())
}

fn tell(state: &mut State, news: News) {
    let now = state.now;
    receive(state, news, now);
}
