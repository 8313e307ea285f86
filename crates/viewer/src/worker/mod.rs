//! Loading, building and rendering, away from the window's thread.
