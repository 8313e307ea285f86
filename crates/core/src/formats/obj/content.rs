//! The contents of an OBJ file's lines.

use crate::formats::group_statements::GroupStatements;
use crate::formats::polygon::Polygon;
use crate::scene::Color;
use glam::{DVec3, Vec2, Vec3};

/// No index: a corner without texture coordinates or normal.
pub(super) const NONE: u32 = u32::MAX;

/// The contents of an OBJ file's lines, checked.
#[derive(Debug, Default)]
pub(super) struct ObjText {
    /// Every `v`, in the file's order.
    pub(super) positions: Vec<DVec3>,
    /// A colour a vertex, `None` without one; empty where no vertex has one.
    pub(super) colors: Vec<Option<Color>>,
    /// Every `vt`.
    pub(super) uvs: Vec<Vec2>,
    /// Every `vn`, of unit length; zero where it has length zero.
    pub(super) normals: Vec<Vec3>,
    /// The faces' triangles, in the file's order, as fans.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Texture coordinate indices at the corners of triangles, from the first triangle to the last one that has any;
    /// [`NONE`] where it has none. Indices may be out of range.
    pub(super) uv_triangles: Vec<[u32; 3]>,
    /// Normal indices, in the same way.
    pub(super) normal_triangles: Vec<[u32; 3]>,
    /// Faces of more than three corners.
    pub(super) polygons: Vec<Polygon>,
    /// The text after each `mtllib`.
    pub(super) libraries: Vec<String>,
    /// The names after `usemtl`, each once.
    pub(super) materials: Vec<String>,
    /// Runs of triangles: the first triangle, and the index of its material's name; [`NONE`] for no material.
    pub(super) material_runs: Vec<(u32, u32)>,
    /// The names after `g` and `o`. The last of either counts, whichever it is.
    pub(super) groups: GroupStatements,
    /// The line of the last face, where the file ends with it, without a line end.
    pub(super) open_end: Option<usize>,
    /// Oddities, counted.
    pub(super) oddities: Oddities,
}

/// Counts of faults that are too small to refuse the file.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Oddities {
    /// Faces with indices of texture coordinates or normals in a file that has none.
    pub(super) dangling: usize,
    /// Vertices with a weight that is not 1.
    pub(super) weights: usize,
    /// Vertices with values after the colour.
    pub(super) extra_values: usize,
    /// Vertices with a colour outside 0 to 1.
    pub(super) colors_out_of_range: usize,
}

/// Numbers or indices of vertices, texture coordinates and normals.
pub(super) type Counts = [i64; 3];

/// Whether an index is out of range. A file may lack texture coordinates or normals altogether: its faces then ignore
/// those indices.
pub(super) fn is_beyond(highest: Counts, totals: Counts) -> bool {
    (0..3).any(|kind| totals[kind] > 0 && highest[kind] > totals[kind]) || highest[0] > totals[0]
}

impl ObjText {
    /// Counts the faces with indices of texture coordinates or normals that the file lacks altogether, from the
    /// numbers of faces with texture coordinates only, with normals only, and with both.
    pub(super) fn count_dangling(&mut self, [uvs, normals, both]: [usize; 3]) {
        let no_uvs = self.uvs.is_empty();
        let no_normals = self.normals.is_empty();
        self.oddities.dangling = if no_uvs { uvs } else { 0 }
            + if no_normals { normals } else { 0 }
            + if no_uvs || no_normals { both } else { 0 };
    }
}

impl Oddities {
    /// Adds those of a piece.
    pub(super) fn add(&mut self, more: Self) {
        self.dangling += more.dangling;
        self.weights += more.weights;
        self.extra_values += more.extra_values;
        self.colors_out_of_range += more.colors_out_of_range;
    }
}
