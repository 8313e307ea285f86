//! What panels are made with: the theme, keys and gestures, the picture on screen, numbers as text.

pub mod canvas;
pub mod format;
pub mod input;
pub mod present;
pub mod theme;
