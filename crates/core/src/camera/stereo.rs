//! Pictures for two eyes.

use crate::ranges::{self, OutOfRange};
use std::fmt;
use std::str::FromStr;

/// The layout of a picture for two eyes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StereoKind {
    /// Two pictures side by side, the left eye's on the left.
    Pair,
    /// An omni-directional panorama, the left eye's above the right eye's: each column is seen from where the eyes
    /// would be of somebody who turns to look at it (Ishiguro, Yamamoto, Tsuji, "Omni-Directional Stereo", 1992;
    /// Peleg, Ben-Ezra, Pritch, "Omnistereo: Panoramic Stereo Imaging", 2001).
    Ods,
}

/// A picture for two eyes: each half of it is seen from another eye.
///
/// The camera's own eye is halfway between the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stereo {
    /// The layout of its halves.
    pub kind: StereoKind,
    /// The distance between the eyes, in scene units.
    pub eye_distance: f64,
    /// The distance along the view axis at which a point is at the same place in both pictures of a pair; infinite
    /// for parallel view axes. By default that of the target for a planar pair, and infinite for others.
    pub convergence: Option<f64>,
}

/// Why a camera cannot make such a picture.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StereoError {
    /// A distance out of range.
    #[error(transparent)]
    Range(#[from] OutOfRange),
    /// A projection whose rays share no eye.
    #[error("a pair of orthographic pictures has no eyes")]
    Orthographic,
    /// A layout that needs an equirectangular panorama.
    #[error("an omni-directional stereo picture is equirectangular")]
    NotEquirectangular,
    /// A finite convergence with a projection whose frame cannot be shifted.
    #[error("eyes converge in perspective pictures alone")]
    CannotConverge,
    /// A pair with an odd number of columns.
    #[error("a pair has an even number of columns")]
    OddColumns,
    /// Stacked pictures with an odd number of rows.
    #[error("an omni-directional stereo picture has an even number of rows")]
    OddRows,
}

impl fmt::Display for StereoKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Pair => "pair",
            Self::Ods => "ods",
        })
    }
}

impl FromStr for StereoKind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "pair" => Ok(Self::Pair),
            "ods" => Ok(Self::Ods),
            _ => {
                let found = crate::quote::quote(text);
                Err(format!("expected pair or ods, found {found}"))
            }
        }
    }
}

impl Stereo {
    /// How many pictures are side by side, and how many are stacked.
    pub fn pictures(&self) -> (u32, u32) {
        match self.kind {
            StereoKind::Pair => (2, 1),
            StereoKind::Ods => (1, 2),
        }
    }

    /// Checks the distances.
    ///
    /// # Errors
    /// A distance out of range.
    pub fn check_distances(&self) -> Result<(), StereoError> {
        ranges::eye_distance(self.eye_distance)?;
        self.convergence.map(ranges::convergence).transpose()?;
        Ok(())
    }
}

/// Where a camera's rays start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Eyes {
    /// At the camera's eye, or on its image plane.
    One,
    /// On a horizontal circle of this radius around the eye, at a right angle to the right of each ray's direction
    /// (to the left, if the radius is negative).
    Circle(f64),
    /// In each half of the picture, at another eye.
    Two(Stereo),
}
