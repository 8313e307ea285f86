//! What panels share: theme, keys and gestures, the picture on screen, formatting of numbers.

pub mod canvas;
#[allow(clippy::disallowed_methods, reason = "numbers are shown to few digits")]
pub mod format;
pub mod icons;
pub mod input;
pub mod mode_pictures;
pub mod modes;
mod pixels;
pub mod present;
pub mod registry;
pub mod theme;
