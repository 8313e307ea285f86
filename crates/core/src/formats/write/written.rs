use crate::scene::SceneError;
use std::io;

/// What was written, and what the format could not hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Written {
    /// Triangles, those that no ray can meet among them: numbers stay.
    pub triangles: u64,
    /// Triangles that no ray can meet.
    pub dropped: u64,
    /// Those of them whose corners cannot be written (they are not there, not finite or too far): in
    /// their place there is a triangle without area.
    pub emptied: u64,
    /// Vertices.
    pub vertices: u64,
    /// Vertices of triangles that rays can meet which the format's numbers do not hold.
    pub moved: u64,
    /// How far the furthest of them was moved, in the scene's units.
    pub largest_move: f64,
    /// What the scene has and the file has not, in words.
    pub lost: Vec<String>,
}

/// Why meshes were not written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The system's refusal.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// Parents that do not exist, or go round in a circle, or a transform that is not finite.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// More than the format can hold.
    #[error("{what} are more than {format} can hold")]
    TooMany {
        /// How much of what.
        what: String,
        /// The format.
        format: &'static str,
    },
}
