//! Conditions that several actions share.

use crate::state::State;

pub(super) fn has_scene(state: &State) -> bool {
    state.document.is_some()
}
