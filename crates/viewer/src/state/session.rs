//! State that is never stored: questions, messages, text fields.

use super::listing::Listing;
use std::path::PathBuf;
use std::time::Duration;

/// The purpose of a requested path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PromptKind {
    /// Meshes or a scene to open.
    Open,
    /// Meshes or a scene to add.
    Add,
    /// Where to save the picture.
    Picture,
    /// Where to save the scene.
    Scene,
    /// Where to save a copy of the scene.
    SceneCopy,
    /// Where to save the visible objects as a mesh file.
    Meshes,
    /// Where to save the measurements.
    Measurements,
    /// Where to save the outline that this clipping plane cuts.
    Outline(usize),
    /// A texture for every object.
    Texture,
    /// A texture for this object.
    TextureOf(usize),
}

impl PromptKind {
    /// Whether it asks for a file to write, and suggests a name.
    pub fn saves(self) -> bool {
        match self {
            Self::Picture
            | Self::Scene
            | Self::SceneCopy
            | Self::Meshes
            | Self::Measurements
            | Self::Outline(_) => true,
            Self::Open | Self::Add | Self::Texture | Self::TextureOf(_) => false,
        }
    }
}

/// A line for a path, shown over the picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Prompt {
    /// Its purpose.
    pub kind: PromptKind,
    /// Its text.
    pub text: String,
    /// Whether a desktop dialog is open as well.
    pub dialog: bool,
    /// Whether the window has lost the keyboard since: to the dialog, if there is one.
    pub has_lost_keyboard: bool,
    /// The names in its path's folder; `None` until something is typed.
    pub listing: Option<Listing>,
}

/// An action that would lose unsaved changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pending {
    /// Showing the scene that has arrived.
    Open,
    /// Copying the command that makes the picture, for which the scene must be saved.
    CopyCommand,
    /// Closing the window.
    Close,
}

/// An answer to the question about unsaved changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Save them first.
    Save,
    /// Discard them.
    Discard,
    /// Cancel the action.
    Stay,
}

/// An existing file that the user is asked about replacing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Replacing {
    /// Which.
    pub path: PathBuf,
    /// What replaces it: a picture, a scene, measurements or an outline.
    pub by: PromptKind,
}

/// The open command palette.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Palette {
    /// Its text.
    pub text: String,
    /// The selected line among those that match.
    pub marked: usize,
}

/// A short message that disappears by itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Toast {
    /// Its text.
    pub text: String,
    /// When it was shown, on the window's clock.
    pub since: Duration,
}
