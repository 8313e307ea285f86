//! Images placed in an object's space: on a rectangle, a sphere, a cylinder.

use crate::math;
use crate::scene::{Projector, TextureProjection};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// A placed image, for points relative to a mesh's offset.
#[derive(Clone, Copy, Debug)]
pub(in crate::shade) struct PlacedImage {
    surface: ImageSurface,
    center: DVec3,
    /// Right, up and front.
    axes: [DVec3; 3],
    size: DVec2,
}

#[derive(Clone, Copy, Debug)]
enum ImageSurface {
    Plane,
    Sphere,
    Cylinder,
}

impl PlacedImage {
    /// `None` where the projection is not placed, or the projector is invalid.
    pub(in crate::shade) fn new(
        projection: TextureProjection,
        projector: &Projector,
        offset: DVec3,
    ) -> Option<Self> {
        let surface = match projection {
            TextureProjection::Plane => ImageSurface::Plane,
            TextureProjection::Sphere => ImageSurface::Sphere,
            TextureProjection::Cylinder => ImageSurface::Cylinder,
            TextureProjection::Uv
            | TextureProjection::Triplanar
            | TextureProjection::PerTriangle
            | TextureProjection::Camera => return None,
        };
        Some(Self {
            surface,
            center: projector.center - offset,
            axes: projector.axes().ok()?,
            size: projector.size,
        })
    }

    /// Whether u goes around an axis.
    pub(in crate::shade) fn goes_round(&self) -> bool {
        !matches!(self.surface, ImageSurface::Plane)
    }

    /// The texture coordinates of a point of the mesh. With x, y and z its distances from the centre to the
    /// right, up and to the front:
    ///
    /// - plane: (½ + x / width, ½ + y / height);
    /// - sphere: (½ + atan2(x, z) / 2π, ½ + atan2(y, √(x² + z²)) / π), each 0 to 1;
    /// - cylinder: (½ + atan2(x, z) / 2π, ½ + y / height).
    ///
    /// On the axis, where the angle is undefined, u is ½; in the centre of a sphere v is ½ as well.
    pub(in crate::shade) fn at(&self, point: DVec3) -> DVec2 {
        let [x, y, z] = self.axes.map(|axis| (point - self.center).dot(axis));
        let turn = || 0.5 + math::atan2(x, z) / TAU;
        match self.surface {
            ImageSurface::Plane => DVec2::new(x, y) / self.size + 0.5,
            ImageSurface::Sphere => {
                let across = (x * x + z * z).sqrt();
                DVec2::new(turn(), 0.5 + math::atan2(y, across) / PI)
            }
            ImageSurface::Cylinder => DVec2::new(turn(), 0.5 + y / self.size.y),
        }
    }
}

impl PlacedImage {
    /// The derivative of [`PlacedImage::at`] along a step; infinite or NaN where it is undefined.
    pub(in crate::shade) fn along(&self, point: DVec3, step: DVec3) -> DVec2 {
        let [x, y, z] = self.axes.map(|axis| (point - self.center).dot(axis));
        let [dx, dy, dz] = self.axes.map(|axis| step.dot(axis));
        let squared = x * x + z * z;
        let turn = || (z * dx - x * dz) / (squared * TAU);
        match self.surface {
            ImageSurface::Plane => DVec2::new(dx, dy) / self.size,
            ImageSurface::Sphere => {
                let across = squared.sqrt();
                let outwards = (x * dx + z * dz) / across;
                let rise = (across * dy - y * outwards) / ((squared + y * y) * PI);
                DVec2::new(turn(), rise)
            }
            ImageSurface::Cylinder => DVec2::new(turn(), dy / self.size.y),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROJECTOR: Projector = Projector {
        center: DVec3::new(10.0, 0.0, 0.0),
        front: DVec3::new(0.0, 5.0, 2.0),
        up: DVec3::new(0.0, 3.0, 0.0),
        size: DVec2::new(4.0, 2.0),
    };

    fn at(projection: TextureProjection, point: DVec3) -> DVec2 {
        let offset = DVec3::new(10.0, 1.0, 0.0);
        let placed = PlacedImage::new(projection, &PROJECTOR, offset).expect("a place");
        placed.at(point + PROJECTOR.center - offset)
    }

    fn check(projection: TextureProjection, places: &[(DVec3, (f64, f64))]) {
        for (point, (u, v)) in places {
            let found = at(projection, *point);
            let apart = (found - DVec2::new(*u, *v)).abs().max_element();
            assert!(apart < 1e-15, "{projection:?} {point}: {found}");
        }
    }

    #[test]
    fn known_points_have_known_places() {
        // The front is made perpendicular to up: it is +Z, and the right is +X.
        check(
            TextureProjection::Plane,
            &[
                (DVec3::new(0.0, 0.0, 7.0), (0.5, 0.5)),
                (DVec3::new(2.0, 1.0, -3.0), (1.0, 1.0)),
                (DVec3::new(-4.0, -1.0, 0.0), (-0.5, 0.0)),
            ],
        );
        check(
            TextureProjection::Sphere,
            &[
                (DVec3::Z, (0.5, 0.5)),
                (DVec3::X * 1e-3, (0.75, 0.5)),
                (DVec3::NEG_X * 1e8, (0.25, 0.5)),
                (DVec3::NEG_Z, (1.0, 0.5)),
                (DVec3::Y, (0.5, 1.0)),
                (DVec3::NEG_Y, (0.5, 0.0)),
                (DVec3::new(1.0, 2f64.sqrt(), 1.0), (0.625, 0.75)),
                (DVec3::ZERO, (0.5, 0.5)),
            ],
        );
        check(
            TextureProjection::Cylinder,
            &[
                (DVec3::new(0.0, 1.0, 3.0), (0.5, 1.0)),
                (DVec3::new(3.0, -1.0, 0.0), (0.75, 0.0)),
                (DVec3::new(0.0, 4.0, 0.0), (0.5, 2.5)),
            ],
        );
    }

    /// The truth is a difference over a small step in both directions.
    #[test]
    fn derivatives_are_those_of_differences() {
        let point = DVec3::new(0.7, -0.4, 1.1) + PROJECTOR.center;
        let step = DVec3::new(0.3, 0.5, -0.2);
        for projection in [
            TextureProjection::Plane,
            TextureProjection::Sphere,
            TextureProjection::Cylinder,
        ] {
            let placed = PlacedImage::new(projection, &PROJECTOR, DVec3::ZERO).expect("a place");
            let by = 1e-5;
            let truth = (placed.at(point + step * by) - placed.at(point - step * by)) / (2.0 * by);
            let apart = (placed.along(point, step) - truth).length();
            assert!(apart < 1e-9, "{projection:?}");
        }
    }

    #[test]
    fn invalid_projectors_are_refused() {
        let bad = [
            Projector {
                front: DVec3::Y,
                ..PROJECTOR
            },
            Projector {
                up: DVec3::ZERO,
                ..PROJECTOR
            },
            Projector {
                size: DVec2::new(1.0, 0.0),
                ..PROJECTOR
            },
            Projector {
                center: DVec3::NAN,
                ..PROJECTOR
            },
            Projector {
                center: DVec3::new(f64::NAN, 0.0, 0.0),
                ..PROJECTOR
            },
            Projector {
                front: DVec3::new(f64::NAN, 0.0, 1.0),
                ..PROJECTOR
            },
        ];
        for projector in bad {
            assert!(projector.axes().is_err());
            assert!(PlacedImage::new(TextureProjection::Plane, &projector, DVec3::ZERO).is_none());
        }
        let tiny = Projector {
            front: DVec3::Z * 1e-300,
            up: DVec3::Y * 1e15,
            ..PROJECTOR
        };
        assert_eq!(tiny.axes(), Ok([DVec3::X, DVec3::Y, DVec3::Z]));
        assert!(PlacedImage::new(TextureProjection::Uv, &PROJECTOR, DVec3::ZERO).is_none());
    }
}
