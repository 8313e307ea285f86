//! What the lines of an OBJ file say.

use crate::formats::polygon::Polygon;
use crate::scene::Color;
use glam::{DVec3, Vec2, Vec3};

/// No index: a corner without texture coordinates or normal.
pub(super) const NONE: u32 = u32::MAX;

/// What the lines of an OBJ file say, checked.
#[derive(Debug, Default)]
pub(super) struct ObjText {
    /// Every `v`, in the file's order.
    pub(super) positions: Vec<DVec3>,
    /// A colour a vertex, `None` where it has none; empty where none has.
    pub(super) colors: Vec<Option<Color>>,
    /// Every `vt`.
    pub(super) uvs: Vec<Vec2>,
    /// Every `vn`, of unit length; zero where it has no direction.
    pub(super) normals: Vec<Vec3>,
    /// The faces' triangles, in the file's order, as fans.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Texture coordinates at the corners of as many triangles, from the first on, as it takes to
    /// have all that are not [`NONE`]. Indices may be of none that is there.
    pub(super) uv_triangles: Vec<[u32; 3]>,
    /// Normals at corners, likewise.
    pub(super) normal_triangles: Vec<[u32; 3]>,
    /// The faces of more than three corners.
    pub(super) polygons: Vec<Polygon>,
    /// What stands behind `mtllib`, line by line.
    pub(super) libraries: Vec<String>,
    /// The names behind `usemtl`, each once.
    pub(super) materials: Vec<String>,
    /// From which triangle on there is another material, by index of its name; [`NONE`] for none.
    pub(super) material_runs: Vec<(u32, u32)>,
    /// The line of the last face, where the file ends in it with no line end behind.
    pub(super) open_end: Option<usize>,
    /// What is odd, and how often.
    pub(super) oddities: Oddities,
}

/// What is not as it should be and does not matter enough to stop, counted.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Oddities {
    /// Faces that name texture coordinates or normals of which the file has none at all.
    pub(super) dangling: usize,
    /// Vertices with a weight that is not 1.
    pub(super) weights: usize,
    /// Vertices with values behind the colour.
    pub(super) extra_values: usize,
    /// Vertices with a colour that is not from 0 to 1.
    pub(super) colors_out_of_range: usize,
}

/// Vertices, texture coordinates and normals: how many, or which.
pub(super) type Counts = [i64; 3];

/// Whether a face has an index beyond what the file has. Of texture coordinates and normals there may be none
/// at all: then faces do without.
pub(super) fn is_beyond(highest: Counts, totals: Counts) -> bool {
    (0..3).any(|kind| totals[kind] > 0 && highest[kind] > totals[kind]) || highest[0] > totals[0]
}

impl ObjText {
    /// Counts the faces that ask for texture coordinates or normals in a file that has none, of those with
    /// texture coordinates alone, normals alone, both.
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
