//! The picture as a command line.

use super::effect::Effect;
use super::names::suggested_name;
use super::{Pending, PromptKind, State};
use crate::cli::render_command;
use raycast_core::scene::{Object, Scene};
use raycast_core::shade::Shading;
use std::sync::Arc;

/// Whether textures are projected in a way that was chosen for some objects and is not for others: no option says
/// so, a scene file does.
fn is_mixed(state: &State, scene: &Scene) -> bool {
    let has_own = |object: &Object| object.mapping.projection.is_some();
    let is_chosen = state.settings.shading.projection != Shading::default().projection;
    is_chosen && scene.objects.iter().any(has_own)
}

/// Copies the command that makes the picture which would be saved, byte for byte. Where no file has the scene as
/// it is, asks whether it is to be saved first.
pub(super) fn copy(state: &mut State) -> Option<Effect> {
    let document = state.document.as_ref()?;
    let is_on_disk = match document.file {
        Some(_) => !state.history.is_changed(),
        None => Arc::ptr_eq(&document.scene, &document.read) && !is_mixed(state, &document.scene),
    };
    if !is_on_disk && document.can_be_saved() {
        state.question = Some(Pending::CopyCommand);
        return None;
    }
    if !is_on_disk || document.paths.is_empty() {
        let message = "No command can make this picture: its meshes are in the program, and in no file. Open \
                       meshes from files (Ctrl+O) first.";
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
