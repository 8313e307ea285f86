//! Effects: what commands leave to other threads and to the window.

use super::PromptKind;
use super::thumbnail::TexturePart;
use std::path::PathBuf;
use std::sync::Arc;

/// What stays when another scene is opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keep {
    /// Nothing: the file's view and look are used.
    #[default]
    Nothing,
    /// Mode, lines, and the direction of view.
    Look,
    /// Camera and look: the same scene is reloaded.
    All,
}

/// A picture for the clipboard: columns, rows, and red, green, blue and alpha of each pixel, sRGB with straight alpha.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Copied {
    /// Columns and rows.
    pub size: (u32, u32),
    /// The pixels, row by row from the top.
    pub pixels: Vec<[u8; 4]>,
}

/// Work for other threads or the window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Read files as a new scene.
    Open(Vec<PathBuf>, Keep),
    /// Read files to add to the scene.
    Add(Vec<PathBuf>),
    /// Read the folder's next file (1), or the one before (−1), in place of this one.
    OpenNeighbor(PathBuf, i32),
    /// Open a hard case as a new scene.
    OpenCase(&'static str),
    /// Fill the screen with the window, or no longer.
    ToggleFullScreen,
    /// Give the keyboard to the menu bar.
    FocusMenu,
    /// Cancel the load.
    CancelLoad,
    /// Build the tree over the document's objects.
    Build,
    /// Read a part of an image as the texture of this request.
    LoadTexture {
        /// The request's number.
        number: u64,
        /// The image.
        path: PathBuf,
        /// The part.
        part: TexturePart,
    },
    /// Read an image's thumbnail.
    ReadThumbnail(PathBuf),
    /// Read a picture's recipe. If its scene is not the open one, search these files for it. A picture without a recipe
    /// is used as a texture.
    OpenPicture(PathBuf, Vec<PathBuf>),
    /// Write the picture; it replaces an existing file only with `replace`.
    SavePicture {
        /// The path.
        path: PathBuf,
        /// Whether an existing file may be replaced.
        replace: bool,
    },
    /// Write the scene, likewise.
    SaveScene {
        /// The path.
        path: PathBuf,
        /// Whether an existing file may be replaced.
        replace: bool,
    },
    /// Write the scene to a file that does not become its own, likewise.
    SaveSceneCopy {
        /// The path.
        path: PathBuf,
        /// Whether an existing file may be replaced.
        replace: bool,
    },
    /// Write the visible objects as a mesh file, likewise.
    SaveMeshes {
        /// The path.
        path: PathBuf,
        /// Whether an existing file may be replaced.
        replace: bool,
    },
    /// Read the names in a folder that is typed for this purpose.
    List(String, PromptKind),
    /// Show the desktop's own dialog.
    Dialog(PromptKind),
    /// Write the measurements, likewise.
    SaveMeasurements {
        /// The path.
        path: PathBuf,
        /// Whether an existing file may be replaced.
        replace: bool,
    },
    /// Write the outline that a clipping plane cuts, likewise.
    SaveOutline {
        /// The plane's index.
        plane: usize,
        /// The path.
        path: PathBuf,
        /// Whether an existing file may be replaced.
        replace: bool,
    },
    /// Measure an object's box, area and volume.
    Weigh(usize),
    /// Check objects' meshes.
    Check {
        /// The objects' indices.
        objects: Vec<usize>,
        /// Whether to search for self-intersections, too.
        deep: bool,
    },
    /// Open the key bindings file in the desktop's editor; if there is none, write a template first.
    OpenKeysFile,
    /// Read the key bindings file.
    ReadKeysFile,
    /// Apply the key bindings in this text; with `asked`, show how many commands have other keys.
    SetKeys {
        /// The file's text; empty if there is none.
        text: String,
        /// Whether to confirm that it was read.
        asked: bool,
    },
    /// Put text on the clipboard.
    Copy(String),
    /// Render the picture for the clipboard.
    RenderCopy,
    /// Put a picture on the clipboard.
    CopyImage(Arc<Copied>),
    /// Close the window.
    Close,
}
