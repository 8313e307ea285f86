//! RayCast's window and command line over the pure core.
//!
//! [`cli`] says what a command line may hold, [`commands`] are the headless ones, and [`app`] is
//! the window: [`panels`] show state and emit commands, [`app`] carries them out, [`worker`] loads,
//! builds and renders away from the window's thread.
//!
//! What the headless commands share: [`setup`] turns files and options into a view, [`output`]
//! writes files whole or not at all, [`progress`] shows how far they are, [`stats`] what it took, [`memory`]
//! refuses what it could not take.

pub mod app;
pub mod cli;
pub mod commands;
pub mod failure;
pub mod memory;
pub mod output;
pub mod panels;
pub mod progress;
pub mod setup;
pub mod state;
pub mod stats;
pub mod ui;
pub mod worker;
