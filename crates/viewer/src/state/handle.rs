//! Handles to move, rotate and scale an object, and the progress of a drag.

use raycast_core::glam::DVec3;

/// What the handles do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tool {
    /// Move the object.
    Move,
    /// Turn it.
    Turn,
    /// Scale it.
    Scale,
}

impl Tool {
    /// The name of the undo step of a drag.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Move => "Move",
            Self::Turn => "Turn",
            Self::Scale => "Scale",
        }
    }
}

/// A handle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handle {
    /// For one axis (0 to 2).
    Axis(usize),
    /// For the two other axes.
    Across(usize),
    /// For the plane of the view, the view's axis, or all axes uniformly.
    All,
}

/// The progress of a drag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// A translation along the axes, in scene units.
    Moved(DVec3),
    /// A rotation in degrees.
    Turned(f64),
    /// Scale factors along the axes.
    Scaled(DVec3),
}
