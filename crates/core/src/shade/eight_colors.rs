//! Which modes are shaded eight pixels at once.

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
