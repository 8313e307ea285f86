//! Parts of the window, one a file: each shows state and emits commands.

mod banner;
mod camera;
mod colors;
mod cut;
mod gizmo;
mod health;
mod help;
mod highlight;
mod legend;
mod light;
mod look;
mod manipulator;
mod marks;
mod measure;
mod menu;
mod object_tree;
mod objects;
#[allow(clippy::disallowed_methods, reason = "tints are no part of a picture")]
pub mod overlay;
mod palette;
mod pick;
mod picture;
mod render;
mod shape;
mod side;
mod status;
mod surface;
mod tiles;
mod transform;
pub mod viewport;
mod widgets;
pub mod window;

use crate::state::command::Command;
use crate::ui::canvas::PictureProgress;
use crate::worker::files::Activity;
use std::time::Duration;

/// Where panels put what a person asks for.
pub type Commands = Vec<Command>;

/// What panels show besides the state: news of the moment.
#[derive(Clone, Debug, Default)]
pub struct Status {
    /// How far the picture is.
    pub progress: PictureProgress,
    /// What is being read, built or written.
    pub activity: Option<Activity>,
    /// The least and the most that a tile took.
    pub tile_times: Option<(Duration, Duration)>,
}
