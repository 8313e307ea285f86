//! RayCast's window and command line over the pure core.
//!
//! [`cli`] says what a command line may hold, [`commands`] are the headless ones, and [`app`] is
//! the window: [`panels`] show state and emit commands, [`app`] carries them out, [`worker`] loads,
//! builds and renders away from the window's thread.

pub mod app;
pub mod cli;
pub mod commands;
pub mod panels;
pub mod worker;
