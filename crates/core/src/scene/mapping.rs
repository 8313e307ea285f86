use super::{Bounds, Photograph};
use glam::{DVec2, DVec3};

/// How texture coordinates (u, v) are assigned to a surface, in units of the image's sides from its bottom left.
/// `docs/textures.md` has the formulas.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TextureProjection {
    /// The mesh's texture coordinates; [`TextureProjection::Triplanar`] where it has none.
    #[default]
    Uv,
    /// Along the three axes of the object, blended by the surface's direction.
    Triplanar,
    /// Each triangle is laid flat into the image without distortion, as large as it fits, its longest edge along the
    /// bottom.
    PerTriangle,
    /// Parallel projection from a placed rectangle, as of a slide.
    Plane,
    /// From a sphere's centre, by longitude and latitude.
    Sphere,
    /// From a cylinder's axis, by angle and height.
    Cylinder,
    /// Central projection from the camera that took the image, onto the surfaces that its [`Photograph`] sees.
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

    /// Whether a [`Projector`] places the image.
    pub fn is_placed(self) -> bool {
        matches!(self, Self::Plane | Self::Sphere | Self::Cylinder)
    }
}

/// Where the image of a [`Plane`](TextureProjection::Plane), a [`Sphere`](TextureProjection::Sphere) or a
/// [`Cylinder`](TextureProjection::Cylinder) stands: in the object's own space, so that it moves with the object, in
/// the file's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projector {
    /// The centre of the rectangle, the sphere or the cylinder.
    pub center: DVec3,
    /// From the centre towards whoever looks at the image: the rectangle's normal, and longitude 0 of a sphere or a
    /// cylinder. Only its component perpendicular to `up` counts.
    pub front: DVec3,
    /// Up in the image: the axis of a sphere and of a cylinder.
    pub up: DVec3,
    /// Width and height of a rectangle; the height counts for a cylinder, neither for a sphere.
    pub size: DVec2,
}

/// Why a [`Projector`] is invalid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ProjectorError {
    /// A number that is not finite, or a coordinate more than 10¹⁸ from zero.
    #[error("expected a texture's place in finite numbers, up to 1e18")]
    NotFinite,
    /// A direction of length zero, or two parallel ones.
    #[error("expected a texture's front and up in two directions, found {front} and {up}")]
    OneDirection {
        /// The front direction.
        front: DVec3,
        /// The up direction.
        up: DVec3,
    },
    /// A width or height that is not above zero.
    #[error("expected a texture's size above 0, found {0}")]
    NoSize(DVec2),
}

impl Projector {
    /// The image once over a box, seen from +Z with +Y up. A side of length zero takes the length of the longest
    /// side, or one.
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

    /// Unit vectors to the right in the image, up in it, and out of it towards the viewer, perpendicular to one
    /// another. `up` keeps its direction.
    ///
    /// # Errors
    /// Numbers that are not finite or out of range, directions of length zero or parallel ones, a size of zero.
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
        // Scaled before it is squared, so that a direction as short as 1e-300 does not underflow.
        let unit = |vector: DVec3| {
            let largest = vector.abs().max_element();
            (largest > 0.0).then(|| (vector / largest).normalize())
        };
        let (Some(up), Some(front)) = (unit(up), unit(front)) else {
            return Err(one);
        };
        // The length of this product is the sine of the angle between two unit vectors, rounded by some 2⁻⁵². Below
        // 2⁻³⁰ fewer than 22 bits of its direction are significant.
        let right = up.cross(front);
        if right.length() < 2f64.powi(-30) {
            return Err(one);
        }
        let right = right.normalize();
        Ok([right, up, right.cross(up).normalize()])
    }
}

/// How an object's texture is mapped, where that is set for the object itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TextureMapping {
    /// `None`: the projection of the picture's shading.
    pub projection: Option<TextureProjection>,
    /// `None`: [`Projector::about`] the mesh's bounds.
    pub projector: Option<Projector>,
    /// The camera that took the texture, for [`Camera`](TextureProjection::Camera); `None` projects nothing.
    pub photograph: Option<Photograph>,
}
