use super::{Bounds, Photograph};
use glam::{DVec2, DVec3};

/// How a surface finds its place in a texture. Each gives texture coordinates (u, v), in sides of the image
/// from its bottom left; `docs/textures.md` has the formulas.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TextureProjection {
    /// The mesh's texture coordinates; [`TextureProjection::Triplanar`] where it has none.
    #[default]
    Uv,
    /// From three sides along the object's axes, blended by the surface's direction.
    Triplanar,
    /// Each triangle laid flat into the image in its own shape, as large as it fits, its longest edge
    /// along the bottom.
    PerTriangle,
    /// Straight onto the surface from a placed rectangle, as a slide is.
    Plane,
    /// From a sphere's middle, by longitude and latitude.
    Sphere,
    /// From a cylinder's axis, by angle and height.
    Cylinder,
    /// As a slide projector stands where the image was taken: onto what its [`Photograph`] sees.
    Camera,
}

impl TextureProjection {
    /// Each of them.
    pub const ALL: [Self; 7] = [
        Self::Uv,
        Self::Triplanar,
        Self::PerTriangle,
        Self::Plane,
        Self::Sphere,
        Self::Cylinder,
        Self::Camera,
    ];

    /// Whether a [`Projector`] says where its image stands.
    pub fn is_placed(self) -> bool {
        matches!(self, Self::Plane | Self::Sphere | Self::Cylinder)
    }
}

/// Where the image of a [`Plane`](TextureProjection::Plane), a [`Sphere`](TextureProjection::Sphere) or a
/// [`Cylinder`](TextureProjection::Cylinder) stands: in the object's own space, so that it moves with the
/// object, in the file's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projector {
    /// What lies at (½, ½) of the image, or within it: the rectangle's middle, the sphere's, the
    /// cylinder's.
    pub center: DVec3,
    /// From there towards who looks at the image: the rectangle's normal; longitude 0 of a sphere and a
    /// cylinder. Only what of it is at right angles to `up` counts.
    pub front: DVec3,
    /// Up in the image: the axis of a sphere and of a cylinder.
    pub up: DVec3,
    /// Width and height of a rectangle; the height counts for a cylinder, neither for a sphere.
    pub size: DVec2,
}

/// Why a [`Projector`] places no image.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ProjectorError {
    /// A number that is not finite, or a coordinate further than 10¹⁸ from zero.
    #[error("expected a texture's place in finite numbers, up to 1e18")]
    NotFinite,
    /// Two directions that are none, or one.
    #[error("expected a texture's front and up in two directions, found {front} and {up}")]
    OneDirection {
        /// The front.
        front: DVec3,
        /// Up.
        up: DVec3,
    },
    /// A width or height that is not above zero.
    #[error("expected a texture's size above 0, found {0}")]
    NoSize(DVec2),
}

impl Projector {
    /// Once over a box, seen from +Z with +Y up; a side without length is as long as the longest, or one.
    pub fn about(bounds: &Bounds) -> Self {
        let (center, size) = if bounds.is_empty() {
            (DVec3::ZERO, DVec3::ZERO)
        } else {
            (bounds.center(), bounds.size())
        };
        let longest = size.max_element();
        let side = |length: f64| match (length > 0.0, longest > 0.0) {
            (true, _) => length,
            (_, true) => longest,
            _ => 1.0,
        };
        Self {
            center,
            front: DVec3::Z,
            up: DVec3::Y,
            size: DVec2::new(side(size.x), side(size.y)),
        }
    }

    /// The directions to the right in the image, up in it, and out of it towards who looks at it: unit
    /// vectors, at right angles to one another. `up` keeps its direction.
    ///
    /// # Errors
    /// Numbers that are not finite or out of range, directions that are none or one, a size of zero.
    pub fn axes(&self) -> Result<[DVec3; 3], ProjectorError> {
        let Self {
            center,
            front,
            up,
            size,
        } = *self;
        let in_range = |vector: DVec3| {
            vector.is_finite() && vector.abs().max_element() <= super::COORDINATE_LIMIT
        };
        let extent = DVec3::new(size.x, size.y, 0.0);
        if ![center, front, up, extent].into_iter().all(in_range) {
            return Err(ProjectorError::NotFinite);
        }
        if !(size.x > 0.0 && size.y > 0.0) {
            return Err(ProjectorError::NoSize(size));
        }
        let one = ProjectorError::OneDirection { front, up };
        // Each is scaled before it is multiplied: 1e-300 is a direction as well.
        let unit = |vector: DVec3| {
            let largest = vector.abs().max_element();
            (largest > 0.0).then(|| (vector / largest).normalize())
        };
        let (Some(up), Some(front)) = (unit(up), unit(front)) else {
            return Err(one);
        };
        // The product of two unit vectors is the sine of the angle between them, and is rounded by some
        // 2⁻⁵²: below 2⁻³⁰ fewer than 22 of its bits say where the right is.
        let right = up.cross(front);
        if right.length() < 2f64.powi(-30) {
            return Err(one);
        }
        let right = right.normalize();
        Ok([right, up, right.cross(up).normalize()])
    }
}

/// How the texture of one object lies on it, where that is its own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TextureMapping {
    /// `None`: as the picture's shading says.
    pub projection: Option<TextureProjection>,
    /// `None`: [`Projector::about`] the mesh's box.
    pub projector: Option<Projector>,
    /// Where a texture was taken that is projected by its [`Camera`](TextureProjection::Camera); `None` projects none.
    pub photograph: Option<Photograph>,
}
