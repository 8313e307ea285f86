//! Handles by which an object is moved, turned and scaled, and how far one has come.

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
    /// What undo calls a drag.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Move => "Move",
            Self::Turn => "Turn",
            Self::Scale => "Scale",
        }
    }
}

/// What a hand takes hold of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handle {
    /// Along, or about, this axis (0 to 2).
    Axis(usize),
    /// Along the two other axes.
    Across(usize),
    /// Across the view, about the view's axis, or along all axes alike.
    All,
}

/// How far a drag has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// Along the axes, in scene units.
    Moved(DVec3),
    /// In degrees.
    Turned(f64),
    /// Factors along the axes.
    Scaled(DVec3),
}
