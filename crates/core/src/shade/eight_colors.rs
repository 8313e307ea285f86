//! Which modes are shaded eight pixels at once, and where the colours go.

use super::spans::within;
use super::srgb::Tables;
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
    /// [`EightColors::Smooth`], without textures.
    Smooth,
    /// [`EightColors::Smooth`] where no mesh has normals, without textures.
    Facets,
    /// [`EightColors::Smooth`], with textures.
    SmoothTextured,
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
    /// Whether colours depend on the directions of normals and of the eye.
    #[inline(always)]
    pub(super) fn are_lit(self) -> bool {
        matches!(self, Self::Smooth | Self::Facets | Self::SmoothTextured)
    }

    /// Whether triangles may have textures.
    #[inline(always)]
    pub(super) fn have_textures(self) -> bool {
        matches!(self, Self::Own | Self::Flat | Self::SmoothTextured)
    }
}

/// Opaque colours of eight samples.
pub(super) enum EightSamples<L: Lanes> {
    /// Linear light.
    Light(Vectors<L>),
    /// Numbers to be shown, 0 to 1 in sRGB.
    Display(Vectors<L>),
}

impl<L: Lanes> EightSamples<L> {
    /// Linear light.
    #[inline(always)]
    pub(super) fn light(self, lanes: L, tables: &Tables) -> Vectors<L> {
        match self {
            Self::Light(light) => light,
            Self::Display(values) => tables.displayed(lanes, values),
        }
    }
}

/// Where colours go.
pub(super) enum Target<'t, 'p> {
    /// The rows of a rectangle of a picture. Whatever gives them, this is compiled once: it is long.
    Bytes(&'t mut dyn Iterator<Item = &'p mut [[u8; 4]]>),
    /// Linear light, row by row.
    Light(&'t mut [[f32; 4]]),
}

/// A row of a [`Target`]. One of the two is empty.
pub(super) struct TargetRow<'r> {
    pub(super) pixels: &'r mut [[u8; 4]],
    /// Linear light.
    pub(super) light: &'r mut [[f32; 4]],
}

impl Target<'_, '_> {
    /// The next row, `row`, of so many columns. `None` where the picture ends.
    #[inline(always)]
    pub(super) fn row(&mut self, row: u32, columns: usize) -> Option<TargetRow<'_>> {
        match self {
            Self::Bytes(rows) => Some(TargetRow {
                pixels: within(rows.next()?, columns),
                light: &mut [],
            }),
            Self::Light(light) => {
                let begin = row as usize * columns;
                Some(TargetRow {
                    pixels: &mut [],
                    light: light.get_mut(begin..begin + columns)?,
                })
            }
        }
    }
}
