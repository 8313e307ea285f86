//! Bookmarked views, and cameras as text.

use super::State;
use super::effect::Effect;
use super::navigate;
use super::viewpoint::Viewpoint;
use crate::cli::{camera_options, parse_camera_options};

/// Bookmarks the view.
pub(super) fn add(state: &mut State) {
    let view = navigate::destination(state);
    if state.document.is_some() && !state.bookmarks.contains(&view) {
        state.bookmarks.push(view);
        keep(state);
        let count = state.bookmarks.len();
        state.tell(format!("Kept as View {count}"));
    }
}

/// Goes to a bookmarked view.
pub(super) fn go(state: &mut State, number: usize) {
    if let Some(view) = state.bookmarks.get(number) {
        navigate::go(state, *view);
    }
}

/// Removes a bookmark.
pub(super) fn remove(state: &mut State, number: usize) {
    if number < state.bookmarks.len() {
        state.bookmarks.remove(number);
        keep(state);
    }
}

/// Stores the bookmarks in the preferences, for when the file is opened again.
fn keep(state: &mut State) {
    if let Some([file]) = state.document.as_ref().map(|document| &document.paths[..]) {
        let views = state
            .bookmarks
            .iter()
            .map(|view| camera_options(&view.to_file()));
        state.preferences.keep_views(file, views.collect());
    }
}

/// Restores the bookmarks of the scene that was opened.
pub(super) fn recall(state: &mut State) {
    state.bookmarks = match state.document.as_ref().map(|document| &document.paths[..]) {
        Some([file]) => {
            let views = state.preferences.views_of(file).iter();
            views
                .filter_map(|text| Some(Viewpoint::of(&parse_camera_options(text)?)))
                .collect()
        }
        _ => Vec::new(),
    };
}

/// Copies the camera as options of the command line.
pub(super) fn copy(state: &mut State) -> Option<Effect> {
    let text = camera_options(&navigate::destination(state).to_file());
    state.tell("Copied the camera: Ctrl+V brings it back, and raycast render takes it");
    Some(Effect::Copy(text))
}

/// Goes to the camera that a text describes, if it describes one.
pub(super) fn paste(state: &mut State, text: &str) {
    match parse_camera_options(text) {
        Some(camera) => navigate::go(state, Viewpoint::of(&camera)),
        None => state.tell("What is on the clipboard is no camera (--eye X,Y,Z --target X,Y,Z …)"),
    }
}
