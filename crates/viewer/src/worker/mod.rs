//! Loading, building and rendering, away from the window's thread.
//!
//! Each worker is a named thread. What it makes it sends as owned values: tiles through
//! [`outbox::Outbox`], scenes, textures and messages as [`News`](crate::state::news::News).

pub mod case;
mod check;
pub mod demo;
mod dialog;
pub mod files;
mod inspecting;
mod keys;
pub mod layout;
mod load;
pub mod mailbox;
mod names;
mod neighbors;
pub mod outbox;
pub mod pace;
mod priority;
pub mod render;
mod save;
mod saving;
mod tasks;
mod thumbnail;
pub mod watch;

use std::sync::Arc;
use std::time::Duration;

/// Wakes the window's event loop; callable from any thread.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// The window's clock: time since it was opened.
pub type SharedClock = Arc<dyn Fn() -> Duration + Send + Sync>;

/// The message of a caught panic.
fn panic_text(panic: &(dyn std::any::Any + Send)) -> String {
    panic
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned())
        .or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "an unknown fault".to_owned())
}
