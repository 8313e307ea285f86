//! What a person can ask for. Panels and keys make commands; `update` carries them out.

use super::{PromptKind, Tint};
use raycast_core::Cull;
use raycast_core::camera::{FrameLock, Grid, Projection};
use raycast_core::scene::{Color, ColorRule};
use raycast_core::shade::{Background, Filter, Mode, TextureProjection};
use std::path::PathBuf;

/// One wish. Places are in the picture's pixels, from its top left corner.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Turn about the pivot, in degrees.
    Orbit {
        /// About the vertical axis.
        yaw: f64,
        /// Up from the horizon.
        pitch: f64,
    },
    /// Take hold of the point seen at a place, to pan.
    Grab {
        /// The place.
        at: (f64, f64),
    },
    /// Move what was grabbed, in pixels of the picture.
    Pan {
        /// To the right.
        dx: f64,
        /// Downwards.
        dy: f64,
    },
    /// Come nearer (a factor below one) or go away, keeping what is seen at a place.
    Zoom {
        /// The place.
        at: (f64, f64),
        /// The new distance over the old.
        factor: f64,
    },
    /// Turn about the point seen at a place from now on, and bring it to the middle.
    SetPivot {
        /// The place.
        at: (f64, f64),
    },
    /// Bring everything into view.
    Fit,
    /// The camera as it was at first.
    ResetView,

    /// Another ray spacing, in scene units.
    SetStep(f64),
    /// The ray spacing, times a factor.
    ScaleStep(f64),
    /// Columns and rows.
    SetSize(u32, u32),
    /// A ray for each pixel of the window.
    FitWindow,
    /// The vertical field of view in degrees.
    SetFov(f64),
    /// The frame's height in scene units.
    SetFrame(f64),
    /// What stays when the step changes.
    SetLock(FrameLock),
    /// How rays leave the camera.
    SetProjection(Projection),
    /// Rays a pixel.
    SetSamples(u32),

    /// How the picture is split.
    SetGrid(Grid),
    /// Lines between tiles.
    SetBorders(bool),
    /// Numbers on tiles.
    SetOrder(bool),
    /// Colours on tiles.
    SetTint(Tint),

    /// What the picture shows.
    SetMode(Mode),
    /// Lines along edges, over any mode.
    SetWireframe(bool),
    /// Their width in pixels.
    SetWireframeWidth(f32),
    /// Their colour.
    SetWireframeColor(Color),
    /// From the object's colours (0) to its texture (1).
    SetBlend(f32),
    /// Between texels.
    SetFilter(Filter),
    /// How surfaces find their place in textures.
    SetTextureProjection(TextureProjection),
    /// Which faces rays meet.
    SetCull(Cull),
    /// What lies behind everything.
    SetBackground(Background),
    /// How an object's triangles get their colours; all objects' for `None`.
    SetColorRule(Option<usize>, ColorRule),
    /// Take all textures off.
    RemoveTextures,

    /// Render threads.
    SetThreads(usize),

    /// Ask for a path: by the desktop's dialog, and in the window.
    Ask(PromptKind),
    /// What was typed in the path line.
    TypePath(String),
    /// Take the path line's text.
    ConfirmPath,
    /// Open a file.
    Open(PathBuf),
    /// Put the hard case of this name on screen.
    OpenCase(&'static str),
    /// Put an image on every object.
    LoadTexture(PathBuf),
    /// Write the picture to a file; its name says which kind. Where one is there already, ask first.
    SavePicture(PathBuf),
    /// The same, in place of what is there.
    ReplacePicture(PathBuf),

    /// Show or hide the side panel.
    TogglePanel,
    /// Show or hide the keys.
    ToggleHelp,
    /// Close the topmost of: keys, question, path line, error.
    Dismiss,
    /// Close one error.
    DismissError(usize),
}

impl Command {
    /// Whether it moves the camera, and does nothing else.
    pub fn moves_camera(&self) -> bool {
        matches!(
            self,
            Self::Orbit { .. } | Self::Grab { .. } | Self::Pan { .. } | Self::Zoom { .. }
        )
    }
}
