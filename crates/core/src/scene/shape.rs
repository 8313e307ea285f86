use glam::{DVec2, DVec3};

/// A mesh that a few parameters describe: closed except for the plane and the disc, centred on the origin (the monkey
/// and the dahlia lie around it), Y up, with normals and texture coordinates. Lengths are in scene units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A box.
    Cube {
        /// Its sides along x, y and z.
        size: DVec3,
    },
    /// A rectangle that faces up.
    Plane {
        /// Its sides along x and z.
        size: DVec2,
    },
    /// A sphere of rings between two poles.
    Sphere {
        /// The distance from the centre.
        radius: f64,
        /// Quads (triangles at the poles) around the axis: 3 to [`Shape::PARTS`].
        segments: u32,
        /// Bands from pole to pole: 2 to [`Shape::PARTS`].
        rings: u32,
    },
    /// A cone with its base.
    Cone {
        /// The radius of the base.
        radius: f64,
        /// The distance from base to tip.
        height: f64,
        /// As of a sphere.
        segments: u32,
    },
    /// A cylinder with both ends.
    Cylinder {
        /// The radius of the ends.
        radius: f64,
        /// The length along y.
        height: f64,
        /// As of a sphere.
        segments: u32,
    },
    /// A ring around y.
    Torus {
        /// The distance from the centre to the middle of the tube.
        radius: f64,
        /// The tube's own radius.
        tube: f64,
        /// As of a sphere.
        segments: u32,
        /// Bands around its tube: 3 to [`Shape::PARTS`].
        rings: u32,
    },
    /// A disc that faces up.
    Disc {
        /// The distance from the centre.
        radius: f64,
        /// As of a sphere.
        segments: u32,
    },
    /// The demo's monkey: a head that looks along +Z, with eyes and locks of fur that are closed parts of their own, and
    /// materials.
    Monkey {
        /// Half the skull's width, about; from ear to ear it is three times this.
        size: f64,
    },
    /// The demo's dahlia: a bloom that faces up on a stem, each petal a closed part, with materials.
    Dahlia {
        /// The bloom's radius, about; the stem is twice as long as this.
        size: f64,
        /// Petals of the bloom: 1 to [`Shape::PARTS`].
        petals: u32,
    },
}

/// A parameter out of range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("expected {expected}, found {found}")]
pub struct ShapeError {
    expected: String,
    found: String,
}

impl Shape {
    /// The default of radii, heights and sides, in scene units.
    pub const LENGTH: f64 = 1.0;
    /// The default radius of a torus's tube.
    pub const TUBE: f64 = 0.25;
    /// The default number of segments: enough to look round.
    pub const SEGMENTS: u32 = 64;
    /// The default number of rings.
    pub const RINGS: u32 = 32;

    /// The default number of a dahlia's petals: the demo's.
    pub const PETALS: u32 = raycast_assets::PETALS;

    /// Each kind with the defaults.
    pub const ALL: [Self; 9] = [
        Self::Cube {
            size: DVec3::splat(Self::LENGTH),
        },
        Self::Plane {
            size: DVec2::splat(Self::LENGTH),
        },
        Self::Sphere {
            radius: Self::LENGTH,
            segments: Self::SEGMENTS,
            rings: Self::RINGS,
        },
        Self::Cone {
            radius: Self::LENGTH,
            height: Self::LENGTH,
            segments: Self::SEGMENTS,
        },
        Self::Cylinder {
            radius: Self::LENGTH,
            height: Self::LENGTH,
            segments: Self::SEGMENTS,
        },
        Self::Torus {
            radius: Self::LENGTH,
            tube: Self::TUBE,
            segments: Self::SEGMENTS,
            rings: Self::RINGS,
        },
        Self::Disc {
            radius: Self::LENGTH,
            segments: Self::SEGMENTS,
        },
        Self::Monkey { size: Self::LENGTH },
        Self::Dahlia {
            size: Self::LENGTH,
            petals: Self::PETALS,
        },
    ];

    /// The largest number of segments, of rings, and of petals.
    pub const PARTS: u32 = 1 << 14;

    /// The kind's name, as in scene files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Cube { .. } => "cube",
            Self::Plane { .. } => "plane",
            Self::Sphere { .. } => "sphere",
            Self::Cone { .. } => "cone",
            Self::Cylinder { .. } => "cylinder",
            Self::Torus { .. } => "torus",
            Self::Disc { .. } => "disc",
            Self::Monkey { .. } => "monkey",
            Self::Dahlia { .. } => "dahlia",
        }
    }

    /// The number of triangles of a valid shape's mesh.
    pub fn triangles(&self) -> u64 {
        let quads = |segments: u32, rings: u32| 2 * u64::from(segments) * u64::from(rings);
        match *self {
            Self::Cube { .. } => 12,
            Self::Plane { .. } => 2,
            // The two rings at the poles have triangles in place of quads.
            Self::Sphere {
                segments, rings, ..
            } => quads(segments, rings.saturating_sub(1)),
            Self::Cone { segments, .. } => quads(segments, 1),
            Self::Cylinder { segments, .. } => quads(segments, 2),
            Self::Torus {
                segments, rings, ..
            } => quads(segments, rings),
            Self::Disc { segments, .. } => u64::from(segments),
            Self::Monkey { .. } => raycast_assets::MONKEY_TRIANGLES,
            Self::Dahlia { petals, .. } => raycast_assets::dahlia_triangles(petals),
        }
    }

    /// Checks the parameters.
    ///
    /// # Errors
    /// A length that is not positive and finite; a number of parts out of range.
    pub fn check(&self) -> Result<(), ShapeError> {
        let name = self.name();
        let length = |what: &str, length: f64| match length > 0.0 && length.is_finite() {
            true => Ok(()),
            false => Err(ShapeError {
                expected: format!("a {name}'s {what} above 0"),
                found: length.to_string(),
            }),
        };
        let parts =
            |what: &str, least: u32, parts: u32| match (least..=Self::PARTS).contains(&parts) {
                true => Ok(()),
                false => Err(ShapeError {
                    expected: format!("{least} to {} {what} of a {name}", Self::PARTS),
                    found: parts.to_string(),
                }),
            };
        match *self {
            Self::Cube { size } => size
                .to_array()
                .into_iter()
                .try_for_each(|x| length("size", x)),
            Self::Plane { size } => size
                .to_array()
                .into_iter()
                .try_for_each(|x| length("size", x)),
            Self::Sphere {
                radius,
                segments,
                rings,
            } => {
                length("radius", radius)?;
                parts("segments", 3, segments)?;
                parts("rings", 2, rings)
            }
            Self::Cone {
                radius,
                height,
                segments,
            }
            | Self::Cylinder {
                radius,
                height,
                segments,
            } => {
                length("radius", radius)?;
                length("height", height)?;
                parts("segments", 3, segments)
            }
            Self::Torus {
                radius,
                tube,
                segments,
                rings,
            } => {
                length("radius", radius)?;
                length("tube", tube)?;
                parts("segments", 3, segments)?;
                parts("rings", 3, rings)
            }
            Self::Disc { radius, segments } => {
                length("radius", radius)?;
                parts("segments", 3, segments)
            }
            Self::Monkey { size } => length("size", size),
            Self::Dahlia { size, petals } => {
                length("size", size)?;
                parts("petals", 1, petals)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_out_of_range_are_refused() {
        let message = |shape: Shape| shape.mesh().expect_err("a bad shape").to_string();
        let sphere = |radius, segments| Shape::Sphere {
            radius,
            segments,
            rings: 4,
        };
        assert_eq!(
            message(sphere(0.0, 8)),
            "expected a sphere's radius above 0, found 0"
        );
        assert_eq!(
            message(sphere(1.0, 2)),
            "expected 3 to 16384 segments of a sphere, found 2"
        );
        let size = DVec3::new(1.0, f64::NAN, 1.0);
        assert_eq!(
            message(Shape::Cube { size }),
            "expected a cube's size above 0, found NaN"
        );
    }
}
