//! Which modes are shaded eight pixels at once, and where the colours go.

use super::vectors::Vectors;
use crate::num::simd::Lanes;

/// What eight pixels are coloured by, but for lines over them.
#[derive(Clone, Copy, Debug)]
pub(super) enum EightColors {
    /// The objects' own colours and textures.
    Own,
    /// The same under the light on each triangle.
    Flat,
    /// Light on the mesh's normals.
    Smooth,
    /// What materials send back.
    Material,
    /// The normals themselves.
    Normals,
    /// Distances.
    Depth,
    /// Barycentrics.
    Barycentric,
    /// Texture coordinates.
    Uv,
    /// The background, under lines.
    Lines,
}

/// Modes in which whole rows follow from the linear functions of their triangles: see `scanlines`.
#[derive(Clone, Copy, Debug)]
pub(super) enum RowColors {
    /// [`EightColors::Own`], with textures.
    Own,
    /// [`EightColors::Flat`], with textures.
    Flat,
    /// [`EightColors::Smooth`], with or without textures.
    Smooth(bool),
    /// [`EightColors::Normals`].
    Normals,
    /// [`EightColors::Depth`].
    Depth,
    /// [`EightColors::Barycentric`].
    Barycentric,
    /// [`EightColors::Uv`].
    Uv,
}

impl RowColors {
    /// Whether triangles may have textures.
    #[inline(always)]
    pub(super) fn have_textures(self) -> bool {
        matches!(self, Self::Own | Self::Flat | Self::Smooth(true))
    }
}

/// Opaque colours of eight samples.
pub(super) enum Eight<L: Lanes> {
    /// Linear light.
    Light(Vectors<L>),
    /// Numbers to be shown, 0 to 1 in sRGB.
    Display(Vectors<L>),
}

/// Where colours go.
pub(super) enum Target<'t, 'p> {
    /// The rows of a rectangle of a picture. Whatever gives them, this is compiled once: it is long.
    Bytes(&'t mut dyn Iterator<Item = &'p mut [[u8; 4]]>),
    /// Linear light, row by row.
    Light(&'t mut [[f32; 4]]),
}
