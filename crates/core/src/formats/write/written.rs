use crate::scene::SceneError;
use std::io;

/// A summary of what was written, and of what the format could not represent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Written {
    /// All triangles, including those that no ray can hit: numbers stay.
    pub triangles: u64,
    /// Triangles that no ray can hit.
    pub dropped: u64,
    /// Those of them whose corners cannot be written (missing, not finite or out of range); each is replaced by a
    /// triangle without area.
    pub emptied: u64,
    /// Vertices.
    pub vertices: u64,
    /// Vertices, of triangles that rays can hit, that the format's numbers cannot represent.
    pub moved: u64,
    /// The largest distance by which such a vertex was moved, in the scene's units.
    pub largest_move: f64,
    /// What the scene has and the file has not, in words.
    pub lost: Vec<String>,
}

/// Why meshes cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// An error of the output.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// Parents that do not exist or form a cycle, or a transform that is not finite.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// More than the format can hold.
    #[error("{what} are more than {format} can hold")]
    TooMany {
        /// What there is too much of, and how much.
        what: String,
        /// The format.
        format: &'static str,
    },
}
