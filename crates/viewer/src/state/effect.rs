//! What commands leave to do outside the state: work for other threads, and for the window.

use super::PromptKind;
use std::path::PathBuf;

/// What stays of what is shown when another scene comes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keep {
    /// Nothing: the file's own view and look.
    #[default]
    Nothing,
    /// Mode and lines, and the direction that one looks in.
    Look,
    /// Camera and look: it is the same scene once more.
    All,
}

/// Work that is left to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Read files as a new scene.
    Open(Vec<PathBuf>, Keep),
    /// Read files to put beside what is open.
    Add(Vec<PathBuf>),
    /// Read the next file of a folder (1), or the one before (−1), in place of this one.
    OpenNeighbor(PathBuf, i32),
    /// Put up a hard case as a new scene.
    OpenCase(&'static str),
    /// Let what is being read go.
    CancelLoad,
    /// Build the tree over the document's objects.
    Build,
    /// Read an image as the texture of an object; of all, for `None`.
    LoadTexture(PathBuf, Option<usize>),
    /// Read what a picture was made of; and where that is not the scene that is open, look for it in these
    /// files. A picture that does not tell is a texture.
    OpenPicture(PathBuf, Vec<PathBuf>),
    /// Write the picture; in place of what is there only if it may `replace` that.
    SavePicture {
        /// Where.
        path: PathBuf,
        /// Whether another file may be there.
        replace: bool,
    },
    /// Write the scene, likewise.
    SaveScene {
        /// Where.
        path: PathBuf,
        /// Whether another file may be there.
        replace: bool,
    },
    /// Show the desktop's own dialog.
    Dialog(PromptKind),
    /// Write what was measured, likewise.
    SaveMeasurements {
        /// Where.
        path: PathBuf,
        /// Whether another file may be there.
        replace: bool,
    },
    /// Write the outline that a clipping plane cuts, likewise.
    SaveOutline {
        /// Which plane.
        plane: usize,
        /// Where.
        path: PathBuf,
        /// Whether another file may be there.
        replace: bool,
    },
    /// Work out the size of an object.
    Weigh(usize),
    /// Look objects over.
    Check {
        /// Which.
        objects: Vec<usize>,
        /// Also for triangles that pass through one another.
        deep: bool,
    },
    /// Open the file that changes keys in the desktop's editor; write one that changes nothing if there is none.
    OpenKeysFile,
    /// Read the file that changes keys.
    ReadKeysFile,
    /// Give commands the keys that this text says; tell how many have others, if a person has `asked`.
    SetKeys {
        /// What the file says; nothing, if there is none.
        text: String,
        /// Whether a person wants to know that it was read.
        asked: bool,
    },
    /// Put text on the clipboard.
    Copy(String),
    /// Close the window.
    Close,
}
