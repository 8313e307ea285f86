//! Changes that no command makes, as steps of the history.

use super::State;
use super::effect::Effect;
use super::manipulator;

/// Makes a change that can be undone.
pub(super) fn change(
    state: &mut State,
    name: &'static str,
    change: impl FnOnce(&mut State) -> Option<Effect>,
) -> Option<Effect> {
    // A drag in progress becomes a step of its own.
    manipulator::release(state);
    let before = state.snapshot();
    let effect = change(state);
    let now = state.now;
    if let Some((before, after)) = before.zip(state.snapshot()) {
        state.history.record(name, None, (before, &after), now);
    }
    effect
}
