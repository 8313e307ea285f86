//! The window's panels, one a file: each shows state and emits commands.

mod banner;
mod camera;
mod colors;
mod cut;
mod gizmo;
mod groups;
mod health;
mod help;
mod highlight;
mod legend;
mod light;
mod look;
mod manipulator;
mod marks;
mod measure;
pub mod menu;
mod object_tree;
mod objects;
#[allow(clippy::disallowed_methods, reason = "tints are no part of a picture")]
pub mod overlay;
mod palette;
mod path_line;
mod pick;
mod picture;
mod render;
mod shape;
mod side;
mod status;
mod surface;
mod texture_part;
mod tiles;
mod transform;
pub mod viewport;
mod widgets;
pub mod window;

use crate::state::command::Command;
use crate::ui::canvas::PictureProgress;
use crate::worker::files::Activity;
use std::time::Duration;

/// The commands that panels emit.
pub type Commands = Vec<Command>;

/// What panels show besides the state.
#[derive(Clone, Debug, Default)]
pub struct Status {
    /// The picture's progress.
    pub progress: PictureProgress,
    /// The file task in progress.
    pub activity: Option<Activity>,
    /// The least and the greatest time of a tile.
    pub tile_times: Option<(Duration, Duration)>,
}
