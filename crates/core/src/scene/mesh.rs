use super::adjacency::Adjacency;
use super::crease;
use super::measures::Measures;
use super::mesh_data::recentring_offset;
use super::rounding::{Measure, Moves, Rounding};
use super::{
    Attribute, Bounds, COORDINATE_LIMIT, Color, Diagonals, Groups, Material, MeshData, Opacity,
    TreeTopology,
};
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use robust::{Coord, orient2d};
use std::sync::{Arc, OnceLock};

/// How many triangles were dropped, by reason. Dropped triangles keep their numbers and are never hit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dropped {
    /// A vertex that is not finite.
    pub not_finite: u32,
    /// A vertex more than 1e18 from zero along an axis.
    pub too_far: u32,
    /// A vertex index out of range.
    pub bad_index: u32,
    /// No area in the file: corners that coincide, or lie on one line.
    pub zero_area: u32,
    /// An area in the file, but none after its corners were rounded to single precision.
    pub rounded_away: u32,
}

impl Dropped {
    /// The sum over all reasons.
    pub fn total(&self) -> u32 {
        self.not_finite + self.too_far + self.bad_index + self.zero_area + self.rounded_away
    }
}

/// Triangles, checked and stored for casting.
///
/// Positions are in single precision, relative to [`Mesh::offset`]. Every picture and every query is about the
/// vertices `offset + position`, exactly.
#[derive(Clone, Debug)]
pub struct Mesh {
    pub(super) offset: DVec3,
    pub(super) positions: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) kept: Vec<u32>,
    pub(super) dropped: Dropped,
    pub(super) normals: Option<Attribute<Vec3>>,
    pub(super) uvs: Option<Attribute<Vec2>>,
    pub(super) materials: Vec<Material>,
    pub(super) material_of_triangle: Vec<u32>,
    pub(super) colors: Vec<Option<Color>>,
    pub(super) diagonals: Diagonals,
    pub(super) groups: Groups,
    pub(super) rounding: Rounding,
    pub(super) bounds: OnceLock<Bounds>,
    pub(super) adjacency: OnceLock<Adjacency>,
    pub(super) measures: Measures,
    pub(super) tree: Option<Arc<TreeTopology>>,
}

impl Mesh {
    /// Checks and stores `data`. A mesh that lies further from the origin than it is long is recentred; triangles
    /// that no ray could hit are dropped and counted.
    pub fn new(data: MeshData) -> Self {
        let (unusable, mut dropped, bounds) = unusable(&data);
        let offset = recentring_offset(&bounds);
        let positions: Vec<Vec3> = data
            .positions
            .par_iter()
            .with_min_len(CHUNK)
            .map(|p| (*p - offset).as_vec3())
            .collect();

        let moves = Moves::new(&data.positions, &positions, offset);
        let drop_in = |(part, triangles): (usize, &[[u32; 3]])| {
            let numbers = (part * CHUNK) as u32..;
            let known = unusable.partition_point(|number| *number < numbers.start);
            let mut known = unusable[known..].iter().peekable();
            let mut removed = Vec::new();
            let mut dropped = Dropped::default();
            let mut rounding = Measure::new(&moves);
            for (number, triangle) in numbers.zip(triangles) {
                if known.next_if_eq(&&number).is_some() {
                    removed.push(number);
                    continue;
                }
                let [a, b, c] = triangle.map(|i| positions[i as usize]);
                if !has_no_area(a, b, c) {
                    rounding.add(*triangle);
                    continue;
                }
                removed.push(number);
                let [a, b, c] = triangle.map(|i| data.positions[i as usize]);
                if has_no_area_in_doubles(a, b, c) {
                    dropped.zero_area += 1;
                } else {
                    dropped.rounded_away += 1;
                }
            }
            (removed, dropped, rounding)
        };
        let parts = data.triangles.par_chunks(CHUNK).enumerate();
        let parts: Vec<_> = parts.map(drop_in).collect();
        let mut rounding = Measure::new(&moves);
        let mut removed = Vec::new();
        for (numbers, less, moved) in parts {
            removed.extend(numbers);
            dropped.zero_area += less.zero_area;
            dropped.rounded_away += less.rounded_away;
            rounding.join(&moved);
        }
        let rounding = rounding.rounding();
        let kept = all_but(data.triangles.len() as u32, &removed);

        let material_of_triangle = if data.materials.is_empty() {
            Vec::new()
        } else {
            data.material_of_triangle
        };
        Self {
            offset,
            positions,
            triangles: data.triangles,
            kept,
            dropped,
            normals: data.normals.filter(|n| !n.values.is_empty()),
            uvs: data.uvs.filter(|uv| !uv.values.is_empty()),
            materials: data.materials,
            material_of_triangle,
            colors: data.colors,
            diagonals: data.diagonals,
            groups: data.groups,
            rounding,
            bounds: OnceLock::new(),
            adjacency: OnceLock::new(),
            measures: Measures::new(data.scalars),
            tree: None,
        }
    }

    /// The mesh with a tree topology, so that building needs no clustering.
    pub(crate) fn with_tree(self, tree: TreeTopology) -> Self {
        Self {
            tree: Some(Arc::new(tree)),
            ..self
        }
    }

    /// Removes the tree topology.
    #[cfg(test)]
    pub(crate) fn forget_tree(&mut self) {
        self.tree = None;
    }

    /// The topology of the mesh's tree, where it is known.
    pub(crate) fn tree(&self) -> Option<&TreeTopology> {
        self.tree.as_deref()
    }

    /// What to add to every position; zero unless the mesh lies far from the origin.
    pub fn offset(&self) -> DVec3 {
        self.offset
    }

    /// Vertices relative to [`Mesh::offset`]. Those of dropped triangles may be anything.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// All triangles, dropped ones included; a triangle's number is its index.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The numbers of the triangles that rays can hit, ascending.
    pub fn kept(&self) -> &[u32] {
        &self.kept
    }

    /// How many triangles were dropped, and why.
    pub fn dropped(&self) -> Dropped {
        self.dropped
    }

    /// The corners of a kept triangle, relative to [`Mesh::offset`].
    ///
    /// `None` where the number or one of its indices is out of range.
    #[inline]
    pub fn corners(&self, triangle: u32) -> Option<[Vec3; 3]> {
        let &[a, b, c] = self.triangles.get(triangle as usize)?;
        let position = |index: u32| self.positions.get(index as usize).copied();
        Some([position(a)?, position(b)?, position(c)?])
    }

    /// Normals at a triangle's corners, where the mesh has them.
    pub fn corner_normals(&self, triangle: u32) -> Option<[Vec3; 3]> {
        let shared = *self.triangles.get(triangle as usize)?;
        self.normals.as_ref()?.corners(triangle, shared)
    }

    /// Texture coordinates at a triangle's corners, where the mesh has them.
    pub fn corner_uvs(&self, triangle: u32) -> Option<[Vec2; 3]> {
        let shared = *self.triangles.get(triangle as usize)?;
        self.uvs.as_ref()?.corners(triangle, shared)
    }

    /// Whether the mesh has normals of its own.
    pub fn has_normals(&self) -> bool {
        self.normals.is_some()
    }

    /// Whether the mesh has texture coordinates.
    pub fn has_uvs(&self) -> bool {
        self.uvs.is_some()
    }

    /// Unit normals at the corners of the kept triangles, smooth over all edges whose triangles' normals are at most
    /// `degrees` apart: at 0 only where triangles lie in one plane, at 180 wherever two triangles share an edge with
    /// one orientation. The mesh's own normals do not count. The normals of the last angle are cached, at some 20 to
    /// 50 bytes a triangle.
    pub fn creased(&self, degrees: f32) -> Arc<Attribute<Vec3>> {
        self.measures.creased.get(degrees, || {
            crease::creased(&self.positions, &self.triangles, &self.kept, degrees)
        })
    }

    /// The mesh's own normals, as stored.
    pub(crate) fn normals(&self) -> Option<&Attribute<Vec3>> {
        self.normals.as_ref()
    }

    /// Texture coordinates, as stored.
    pub(crate) fn uvs(&self) -> Option<&Attribute<Vec2>> {
        self.uvs.as_ref()
    }

    /// The material index of each triangle, as stored; empty where the file has none.
    pub(crate) fn material_of_triangle(&self) -> &[u32] {
        &self.material_of_triangle
    }

    /// The file's materials.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The material of a triangle, where the file names one.
    pub fn material(&self, triangle: u32) -> Option<&Material> {
        let index = *self.material_of_triangle.get(triangle as usize)?;
        self.materials.get(index as usize)
    }

    /// The opacity of a triangle's material.
    pub fn opacity(&self, triangle: u32) -> &Opacity {
        let material = self.material(triangle);
        material.map_or(&Opacity::Opaque, |material| &material.opacity)
    }

    /// The file's vertex colours, by index of position; empty where the file has none.
    pub fn vertex_colors(&self) -> &[Option<Color>] {
        &self.colors
    }

    /// The colours of a triangle's corners, where the file gives one to all three.
    pub fn corner_colors(&self, triangle: u32) -> Option<[Color; 3]> {
        let corners = self.triangles.get(triangle as usize)?;
        let [a, b, c] = corners.map(|i| self.colors.get(i as usize).copied().flatten());
        Some([a?, b?, c?])
    }

    /// The edges along which the file's polygons were triangulated.
    pub fn diagonals(&self) -> &Diagonals {
        &self.diagonals
    }

    /// The file's groups of triangles.
    pub fn groups(&self) -> &Groups {
        &self.groups
    }

    /// What lies across the mesh's edges; `make` computes it on first use.
    pub(crate) fn adjacency(&self, make: impl FnOnce() -> Adjacency) -> &Adjacency {
        self.adjacency.get_or_init(make)
    }

    /// How far rounding to single precision has moved the corners.
    pub fn rounding(&self) -> Rounding {
        self.rounding
    }

    pub(super) fn measures(&self) -> &Measures {
        &self.measures
    }

    /// The box around the kept triangles, in the file's coordinates; computed on first use.
    pub fn bounds(&self) -> Bounds {
        *self.bounds.get_or_init(|| {
            Bounds::around(
                self.kept
                    .iter()
                    .filter_map(|&number| self.corners(number))
                    .flatten()
                    .map(|position| self.offset + position.as_dvec3()),
            )
        })
    }
}

/// Whether a triangle has exactly no area.
pub(super) fn has_no_area(a: Vec3, b: Vec3, c: Vec3) -> bool {
    if a == b || b == c || c == a {
        return true;
    }
    crate::num::exact::is_collinear(a, b, c)
}

/// Whether a triangle has no area in the file's double precision.
///
/// Exact unless products of differences underflow, with edges shorter than some 1e-150.
fn has_no_area_in_doubles(a: DVec3, b: DVec3, c: DVec3) -> bool {
    let is_flat = |x: usize, y: usize| {
        let [a, b, c] = [a, b, c].map(|point| Coord {
            x: point[x],
            y: point[y],
        });
        orient2d(a, b, c) == 0.0
    };
    is_flat(0, 1) && is_flat(1, 2) && is_flat(2, 0)
}

/// Triangles, or vertices, in one parallel task.
const CHUNK: usize = 1 << 15;

/// The numbers of the triangles with a corner that does not exist, is not finite or is not within [`COORDINATE_LIMIT`],
/// ascending, and how many there are of each; and the box around the others.
fn unusable(data: &MeshData) -> (Vec<u32>, Dropped, Bounds) {
    let part = |(part, triangles): (usize, &[[u32; 3]])| {
        let mut numbers = Vec::new();
        let mut dropped = Dropped::default();
        let mut bounds = Bounds::EMPTY;
        for (number, triangle) in ((part * CHUNK) as u32..).zip(triangles) {
            let reason = match data.corners(*triangle) {
                None => &mut dropped.bad_index,
                Some([a, b, c]) if !(a.is_finite() && b.is_finite() && c.is_finite()) => {
                    &mut dropped.not_finite
                }
                Some([a, b, c]) => {
                    let reach = a.abs().max(b.abs()).max(c.abs()).max_element();
                    if reach <= COORDINATE_LIMIT {
                        bounds.min = bounds.min.min(a).min(b).min(c);
                        bounds.max = bounds.max.max(a).max(b).max(c);
                        continue;
                    }
                    &mut dropped.too_far
                }
            };
            *reason += 1;
            numbers.push(number);
        }
        (numbers, dropped, bounds)
    };
    let parts = data.triangles.par_chunks(CHUNK).enumerate();
    let parts: Vec<_> = parts.map(part).collect();
    let mut numbers = Vec::new();
    let mut dropped = Dropped::default();
    let mut bounds = Bounds::EMPTY;
    for (part, less, around) in parts {
        numbers.extend(part);
        dropped.bad_index += less.bad_index;
        dropped.not_finite += less.not_finite;
        dropped.too_far += less.too_far;
        bounds = bounds.union(around);
    }
    (numbers, dropped, bounds)
}

/// The numbers below `count` but for some, which ascend.
fn all_but(count: u32, removed: &[u32]) -> Vec<u32> {
    if removed.is_empty() {
        let all = (0..count).into_par_iter().with_min_len(CHUNK);
        return all.collect();
    }
    let mut removed = removed.iter().peekable();
    let is_kept = |number: &u32| removed.next_if_eq(&number).is_none();
    (0..count).filter(is_kept).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn single(corners: [[f64; 3]; 3]) -> Mesh {
        Mesh::new(MeshData {
            positions: corners.map(DVec3::from_array).to_vec(),
            triangles: vec![[0, 1, 2]],
            ..MeshData::default()
        })
    }

    #[test]
    fn dropped_triangles_keep_their_numbers() {
        let p = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let mesh = Mesh::new(MeshData {
            positions: vec![
                p(0., 0.),
                p(1., 0.),
                p(0., 1.),
                p(2., 0.),
                p(f64::NAN, 0.),
                p(2e18, 0.),
            ],
            triangles: vec![
                [0, 1, 3],
                [0, 1, 2],
                [0, 1, 4],
                [0, 1, 99],
                [0, 2, 5],
                [1, 1, 2],
                [1, 3, 2],
            ],
            ..MeshData::default()
        });
        assert_eq!(mesh.kept(), [1, 6]);
        let dropped = Dropped {
            not_finite: 1,
            too_far: 1,
            bad_index: 1,
            zero_area: 2,
            rounded_away: 0,
        };
        assert_eq!(mesh.dropped(), dropped);
        assert_eq!(mesh.dropped().total(), 5);
        assert_eq!(mesh.bounds().max, DVec3::new(2.0, 1.0, 0.0));
    }

    #[test]
    fn near_meshes_stay_where_they_are() {
        let mesh = single([[1.0, -1.0, 0.0], [3.0, 1.0, 0.0], [1.0, 1.0, 0.5]]);
        assert_eq!(mesh.offset(), DVec3::ZERO);
    }

    #[test]
    fn far_single_precision_coordinates_stay_exact() {
        for base in [1e3f32, 148376.0, -223423.0, 1e7, 3e12, -7.5e17] {
            for length in [1e-1f32, 0.7, 13.0, 900.0] {
                let xs = [base, base + length * 0.4, base + length];
                let mesh = single([
                    [f64::from(xs[0]), 0.0, 0.0],
                    [f64::from(xs[1]), 1.0, 0.0],
                    [f64::from(xs[2]), 0.0, 1.0],
                ]);
                for (x, position) in xs.iter().zip(mesh.positions()) {
                    assert_eq!(mesh.offset().x + f64::from(position.x), f64::from(*x));
                }
            }
        }
    }

    #[test]
    fn far_double_precision_coordinates_keep_their_detail() {
        let base = 1e7;
        let mesh = single([
            [base + 0.123456789, 0.0, 0.0],
            [base + 1.0, 0.0, 0.0],
            [base, 1.0, 0.0],
        ]);
        // Single precision has steps of 6e-8 near 1, and of 1 near 1e7.
        let stored = mesh.offset().x + f64::from(mesh.positions()[0].x);
        assert!((stored - (base + 0.123456789)).abs() < 3e-8, "{stored}");
    }

    #[test]
    fn triangles_that_rounding_makes_degenerate_are_counted() {
        let small = 1e-10;
        let mesh = Mesh::new(MeshData {
            positions: vec![
                DVec3::ZERO,
                DVec3::X * 2.0,
                DVec3::Y * 2.0,
                DVec3::ONE,
                DVec3::ONE + DVec3::X * small,
                DVec3::ONE + DVec3::Y * small,
                // On a line in decimal, but not after rounding to binary.
                DVec3::ZERO,
                DVec3::new(0.1, 0.2, 0.3),
                DVec3::new(0.2, 0.4, 0.6),
            ],
            triangles: vec![[0, 1, 2], [3, 4, 5], [6, 7, 8], [0, 0, 1]],
            ..MeshData::default()
        });
        let dropped = mesh.dropped();
        assert_eq!((dropped.rounded_away, dropped.zero_area), (1, 2));
        assert_eq!(dropped.total(), 3);
        assert_eq!(mesh.rounding(), Rounding::default());
    }

    #[test]
    fn rounding_reports_how_far_corners_move() {
        // A unit in the last place of 1 is 2^-23.
        let half = 2f64.powi(-25);
        let mesh = |edge: f64| {
            single([
                [1.0 + half, 0.0, 0.0],
                [1.0 + edge, 0.0, 0.0],
                [-1.0, 1.0, 0.0],
            ])
        };
        let coarse = mesh(2f64.powi(-10)).rounding();
        assert_eq!(coarse.distance, half);
        let edge = 2f64.powi(-10) - half;
        assert!((coarse.share_of_edge - half / edge).abs() < 1e-12);
        assert_eq!(coarse.bent, 0);
        // 2^-25 of an edge of 2^-20 less 2^-25 is a 31st: 3 %.
        let fine = mesh(2f64.powi(-20)).rounding();
        assert!((fine.share_of_edge - 1.0 / 31.0).abs() < 1e-9, "{fine:?}");
        assert_eq!(fine.bent, 1);
    }

    #[test]
    fn corner_colors_need_a_color_at_each_corner() {
        let color = Some(Color([1, 2, 3]));
        let mesh = Mesh::new(MeshData {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            triangles: vec![[0, 1, 2], [1, 2, 3]],
            colors: vec![color; 3],
            ..MeshData::default()
        });
        assert_eq!(mesh.corner_colors(0), Some([Color([1, 2, 3]); 3]));
        assert_eq!(mesh.corner_colors(1), None);
        assert_eq!(mesh.corner_colors(2), None);
    }
}
