//! What is never kept: questions, messages, lines to type in.

use std::path::PathBuf;
use std::time::Duration;

/// What a path is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PromptKind {
    /// Meshes or a scene to open.
    Open,
    /// Meshes or a scene to put beside what is open.
    Add,
    /// Where to save the picture.
    Picture,
    /// Where to save the scene.
    Scene,
    /// Where to save what was measured.
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
            Self::Picture | Self::Scene | Self::Measurements | Self::Outline(_) => true,
            Self::Open | Self::Add | Self::Texture | Self::TextureOf(_) => false,
        }
    }
}

/// A line for a path, shown over the picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Prompt {
    /// What the path is for.
    pub kind: PromptKind,
    /// What was typed so far.
    pub text: String,
    /// Whether a desktop dialog is open as well.
    pub dialog: bool,
}

/// What would give up changes that no file has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Pending {
    /// Files to open.
    Open(Vec<PathBuf>),
    /// A hard case to open.
    Case(&'static str),
    /// A neighbour to open.
    Neighbor(i32),
    /// Reading what is open again.
    Reload,
    /// Copying the picture as a command.
    CopyCommand,
    /// Closing the window.
    Close,
}

/// What a person says about changes that no file has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Save them first.
    Save,
    /// They may go.
    Discard,
    /// Stay with them.
    Stay,
}

/// A file that would be replaced, while the person is asked whether it may.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Replacing {
    /// Which.
    pub path: PathBuf,
    /// By what: a picture, a scene, measurements or an outline.
    pub by: PromptKind,
}

/// The list of all commands, while it is open.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Palette {
    /// What was typed.
    pub text: String,
    /// Which of what is left is marked.
    pub marked: usize,
}

/// A short message that goes by itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Toast {
    /// What it says.
    pub text: String,
    /// When it came, on the window's clock.
    pub since: Duration,
}
