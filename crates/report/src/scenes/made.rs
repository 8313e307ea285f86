use super::{bumpy_sphere, interior, interior_camera};
use crate::stage::scene_of;
use crate::views;
use raycast_core::camera::{Camera, PlaneError};
use raycast_core::scene::Scene;
use std::fmt;
use std::str::FromStr;

/// A scene to measure that is made in code, by a name such as `ball:100000`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Made {
    /// A ball with bumps, of at most so many triangles.
    Ball(u32),
    /// A furnished flat seen from inside, of about so many triangles.
    Interior(u32),
}

impl Made {
    /// The scene.
    pub fn scene(self) -> Scene {
        match self {
            Self::Ball(triangles) => scene_of([bumpy_sphere(triangles)]),
            Self::Interior(triangles) => scene_of([interior(triangles)]),
        }
    }

    /// One of its two views: from outside the [usual ones](views::filling), from inside those of
    /// [`interior_camera`].
    ///
    /// # Errors
    /// A size that no picture can have.
    pub fn camera(
        self,
        scene: &Scene,
        size: (u32, u32),
        close: bool,
    ) -> Result<Camera, PlaneError> {
        match self {
            Self::Ball(_) => views::filling(scene, size, views::FOV, if close { 2.0 } else { 1.0 }),
            Self::Interior(_) => interior_camera(size, close),
        }
    }
}

impl FromStr for Made {
    type Err = String;

    /// Reads `ball:TRIANGLES` or `interior:TRIANGLES`.
    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || format!("expected ball:TRIANGLES or interior:TRIANGLES, found {text:?}");
        let (name, count) = text.split_once(':').ok_or_else(expected)?;
        let count = count.parse().map_err(|_| expected())?;
        match name {
            "ball" => Ok(Self::Ball(count)),
            "interior" => Ok(Self::Interior(count)),
            _ => Err(expected()),
        }
    }
}

impl fmt::Display for Made {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ball(count) => write!(out, "ball:{count}"),
            Self::Interior(count) => write!(out, "interior:{count}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_back() {
        for name in ["ball:1000", "interior:30000"] {
            assert_eq!(
                name.parse::<Made>().map(|made| made.to_string()),
                Ok(name.into())
            );
        }
        for wrong in ["ball", "ball:", "cube:12", "ball:-1"] {
            assert!(wrong.parse::<Made>().is_err(), "{wrong}");
        }
    }
}
