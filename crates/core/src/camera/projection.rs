use super::{BrownConrady, Panorama};
use crate::math;
use crate::ranges::{self, OutOfRange};
use std::fmt;
use std::str::FromStr;

/// The default vertical field of view of a planar picture, in degrees.
pub const DEFAULT_FOV: f64 = 45.0;

/// How pixels map to rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Projection {
    /// All rays start at the eye and go through the image plane.
    #[default]
    Perspective,
    /// Rays are parallel to the view axis and start on the plane through the eye.
    Orthographic,
    /// All rays start at the eye; the picture is not a plane.
    Panoramic(Panorama),
}

impl Projection {
    /// Every projection with its name.
    pub fn all() -> impl Iterator<Item = (&'static str, Self)> {
        let planar = [
            ("perspective", Self::Perspective),
            ("orthographic", Self::Orthographic),
        ];
        let panoramas = Panorama::ALL.map(|(name, panorama)| (name, Self::Panoramic(panorama)));
        planar.into_iter().chain(panoramas)
    }

    /// Its name, as in [`Projection::all`]. A perspective picture through a lens is called perspective.
    pub fn name(self) -> &'static str {
        if self.lens().is_some() {
            return Self::Perspective.name();
        }
        let mut all = Self::all();
        all.find(|(_, it)| *it == self).map_or("", |(name, _)| name)
    }

    /// Whether rays are parallel. Otherwise they start at the eye.
    #[inline]
    pub fn is_parallel(self) -> bool {
        self == Self::Orthographic
    }

    /// The kind of panorama; `None` for a planar picture.
    #[inline]
    pub fn panorama(self) -> Option<Panorama> {
        match self {
            Self::Panoramic(panorama) => Some(panorama),
            Self::Perspective | Self::Orthographic => None,
        }
    }

    /// The lens of a perspective picture, if it has one.
    pub fn lens(self) -> Option<BrownConrady> {
        match self {
            Self::Panoramic(Panorama::Lens(lens)) => Some(lens),
            _ => None,
        }
    }

    /// A perspective picture through a lens.
    pub fn through(lens: BrownConrady) -> Self {
        Self::Panoramic(Panorama::Lens(lens))
    }

    /// The height of the frame at `distance` for a vertical field of view in degrees. An orthographic frame has the
    /// height of the perspective one, so that the target keeps its size when the projection is switched.
    pub fn frame(self, fov_degrees: f64, distance: f64) -> f64 {
        match self {
            Self::Perspective | Self::Orthographic => fov_to_frame(fov_degrees, distance),
            Self::Panoramic(panorama) => panorama.height(fov_degrees) * distance,
        }
    }

    /// The vertical field of view in degrees for the height of the frame at `distance`.
    pub fn fov_degrees(self, frame_height: f64, distance: f64) -> f64 {
        match self {
            Self::Perspective | Self::Orthographic => frame_to_fov(frame_height, distance),
            Self::Panoramic(panorama) => panorama.fov_degrees(frame_height / distance),
        }
    }

    /// Checks a vertical field of view in degrees against the projection's range.
    ///
    /// # Errors
    /// A number outside the range.
    pub fn check_fov(self, degrees: f64) -> Result<f64, OutOfRange> {
        match self {
            Self::Perspective | Self::Orthographic => ranges::fov(degrees),
            Self::Panoramic(panorama) => {
                let most = panorama.most_fov();
                if (ranges::NARROWEST_FOV..=most).contains(&degrees) {
                    Ok(degrees)
                } else {
                    let name = self.name();
                    Err(OutOfRange::WideFov {
                        name,
                        most,
                        found: degrees,
                    })
                }
            }
        }
    }

    /// The part of the vertical field of view in degrees that a scene should fill when it is framed. Of a panorama
    /// it is the middle 90°, which look much like a perspective picture.
    pub fn fitting_fov(self, fov_degrees: f64) -> f64 {
        match self {
            Self::Perspective | Self::Orthographic => fov_degrees,
            Self::Panoramic(_) => fov_degrees.min(90.0),
        }
    }

    /// The default vertical field of view in degrees.
    pub fn default_fov(self) -> f64 {
        let panorama = self.panorama().filter(|_| self.lens().is_none());
        panorama.map_or(DEFAULT_FOV, Panorama::default_fov)
    }
}

impl fmt::Display for Projection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Projection {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::all().find(|(name, _)| *name == text);
        found.map(|(_, projection)| projection).ok_or_else(|| {
            let names: Vec<_> = Self::all().map(|(name, _)| name).collect();
            let found = crate::quote::quote(text);
            format!("expected one of {}, found {found}", names.join(", "))
        })
    }
}

/// The height of a planar frame at `distance` for a vertical field of view in degrees.
pub fn fov_to_frame(fov_degrees: f64, distance: f64) -> f64 {
    2.0 * distance * math::tan(fov_degrees.to_radians() * 0.5)
}

/// The vertical field of view in degrees for a planar frame of this height at `distance`.
pub fn frame_to_fov(frame_height: f64, distance: f64) -> f64 {
    2.0 * math::atan(frame_height * 0.5 / distance).to_degrees()
}
