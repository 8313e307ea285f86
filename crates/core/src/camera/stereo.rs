//! Pictures for two eyes.

use std::fmt;
use std::str::FromStr;

/// The furthest that eyes are apart: as far as a scene's coordinates go. Much further, rays would start where no double is.
const WIDEST: f64 = 1e18;

/// How a picture for two eyes is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StereoKind {
    /// Two pictures side by side, the left eye's on the left: one of each eye.
    Pair,
    /// An omni-directional panorama, the left eye's above the right eye's: each column is seen from where the eyes of
    /// somebody are who turns to look at it (Ishiguro, Yamamoto, Tsuji, "Omni-Directional Stereo", 1992; Peleg,
    /// Ben-Ezra, Pritch, "Omnistereo: Panoramic Stereo Imaging", 2001).
    Ods,
}

/// A picture for two eyes: of each half of it another eye.
///
/// The camera's own eye is in the middle between the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stereo {
    /// What its halves are.
    pub kind: StereoKind,
    /// From eye to eye, in scene units.
    pub eye_distance: f64,
    /// The distance along the view axis at which a point is at the same place of both pictures of a pair; infinite for
    /// view axes side by side. Where nobody says, a planar pair's is that of the target, and others' is infinite.
    pub convergence: Option<f64>,
}

/// Why there is no such picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StereoError {
    /// A distance between the eyes that is none.
    #[error("expected a distance between the eyes above 0 and at most {WIDEST:e}")]
    EyeDistance,
    /// A distance of convergence that is none.
    #[error("expected a distance of convergence above 0, or inf")]
    Convergence,
    /// A pair without eyes.
    #[error("a pair of orthographic pictures has no eyes")]
    Orthographic,
    /// Something else than a panorama of all around.
    #[error("an omni-directional stereo picture is equirectangular")]
    NotEquirectangular,
    /// Frames that cannot be moved towards each other.
    #[error("eyes converge in perspective pictures alone")]
    CannotConverge,
    /// Halves of half a pixel.
    #[error("a pair has an even number of columns")]
    OddColumns,
    /// The same.
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
    /// How many of its pictures are side by side, and how many above one another.
    pub fn pictures(&self) -> (u32, u32) {
        match self.kind {
            StereoKind::Pair => (2, 1),
            StereoKind::Ods => (1, 2),
        }
    }

    /// Whether its distances are some.
    ///
    /// # Errors
    /// Distances that are none.
    pub fn check_distances(&self) -> Result<(), StereoError> {
        if !(self.eye_distance > 0.0 && self.eye_distance <= WIDEST) {
            return Err(StereoError::EyeDistance);
        }
        // NaN is not above zero.
        match self.convergence.is_none_or(|distance| distance > 0.0) {
            true => Ok(()),
            false => Err(StereoError::Convergence),
        }
    }
}

/// Where a camera's rays start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Eyes {
    /// At its eye, or on its image plane.
    One,
    /// On a horizontal circle around its eye of this radius, at a right angle to the right of where each ray looks (to the
    /// left, if it is negative).
    Circle(f64),
    /// In each half of the picture at another eye.
    Two(Stereo),
}
