//! The picture as a command line.

use super::document::Document;
use super::effect::Effect;
use super::names::suggested_name;
use super::{Pending, PromptKind, State};
use crate::cli::{has_own_projection, render_command};
use std::sync::Arc;

/// Whether options cannot express the shading, given the files': texture projections that differ between objects and
/// were chosen in the window; a colour scale of the file, or its range or legend, that was removed.
fn is_beyond_options(state: &State, document: &Document) -> bool {
    let files = document.shading.unwrap_or_default();
    let shown = &state.settings.shading;
    let is_mixed = has_own_projection(&document.scene) && shown.projection != files.projection;
    let takes_away = files.scale.is_some_and(|file| match shown.scale {
        None => true,
        Some(shown) => {
            file.range.is_some() && shown.range.is_none() || file.legend && !shown.legend
        }
    });
    is_mixed || takes_away
}

/// Copies the command that makes the same bytes as saving the picture. If the scene has unsaved changes, asks whether
/// to save it first.
pub(super) fn copy(state: &mut State) -> Option<Effect> {
    let document = state.document.as_ref()?;
    let has_objects = match document.file {
        Some(_) => !state.history.is_changed(),
        None => Arc::ptr_eq(&document.scene, &document.read),
    };
    let is_on_disk = has_objects && !is_beyond_options(state, document);
    if !is_on_disk && document.can_be_saved() {
        state.forget_pending();
        state.question = Some(Pending::CopyCommand);
        return None;
    }
    if !is_on_disk || document.paths.is_empty() {
        let message = "No command can make this picture: its meshes are in the program, and in no file. Open \
                       meshes from files (File, Open) first.";
        state.report(message.to_owned());
        return None;
    }
    let view = state.view_at_rest()?;
    let output = suggested_name(state, PromptKind::Picture);
    let paths = &document.paths;
    let line = render_command(paths, &output, &view, &state.limits);
    match line {
        Some(line) => {
            state.tell("Copied the command that makes this picture");
            Some(Effect::Copy(line))
        }
        None => {
            let message =
                "The path of a file is not valid Unicode: no command line can be written for it.";
            state.report(message.to_owned());
            None
        }
    }
}
