use super::{Attribute, Bounds, Color, Diagonals, Groups, Material, Scalar};
use glam::{DVec3, Vec2, Vec3};
use std::mem::size_of;

/// The largest distance from zero along an axis at which a vertex is kept. Beyond it products of single-precision
/// coordinates would come near the end of their range (3e38).
pub const COORDINATE_LIMIT: f64 = 1e18;

/// A mesh as read from a file, before anything is checked.
#[derive(Clone, Debug, Default)]
pub struct MeshData {
    /// Vertices in the file's coordinates.
    pub positions: Vec<DVec3>,
    /// Three indices a triangle, in the file's order of faces.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals at the corners.
    pub normals: Option<Attribute<Vec3>>,
    /// Texture coordinates at the corners, origin bottom-left.
    pub uvs: Option<Attribute<Vec2>>,
    /// The file's materials.
    pub materials: Vec<Material>,
    /// A material index a triangle (`u32::MAX`: none); empty where the file has no materials.
    pub material_of_triangle: Vec<u32>,
    /// An sRGB colour for each vertex; vertices beyond the end of the list have none.
    pub colors: Vec<Option<Color>>,
    /// The scalars that the file gives vertices and triangles.
    pub scalars: Vec<Scalar>,
    /// The edges along which polygons were triangulated; empty where the file has triangles only.
    pub diagonals: Diagonals,
    /// The file's groups of triangles; none where the file has none.
    pub groups: Groups,
}

impl MeshData {
    /// The [`Mesh::offset`](super::Mesh::offset) of a mesh made from it.
    pub(crate) fn offset(&self) -> DVec3 {
        let usable = self.triangles.iter().filter_map(|triangle| {
            let corners = self.corners(*triangle)?;
            corners.iter().all(|c| is_storable(*c)).then_some(corners)
        });
        recentring_offset(&Bounds::around(usable.flatten()))
    }

    /// A lower bound of the bytes that it occupies.
    pub(crate) fn bytes(&self) -> u64 {
        let bytes = self.positions.len() * size_of::<DVec3>() + self.shared_bytes();
        bytes as u64
    }

    /// The bytes that a [`Mesh`](super::Mesh) made from it occupies.
    pub(crate) fn stored_bytes(&self) -> u64 {
        let bytes = self.positions.len() * size_of::<Vec3>()
            + self.triangles.len() * size_of::<u32>()
            + self.shared_bytes();
        bytes as u64
    }

    /// The bytes of the parts that a [`Mesh`](super::Mesh) keeps unchanged.
    fn shared_bytes(&self) -> usize {
        self.triangles.len() * size_of::<[u32; 3]>()
            + self.normals.as_ref().map_or(0, Attribute::bytes)
            + self.uvs.as_ref().map_or(0, Attribute::bytes)
            + self.material_of_triangle.len() * size_of::<u32>()
            + self.colors.len() * size_of::<Option<Color>>()
            + self.diagonals.bytes()
            + self.groups.bytes()
            + self
                .scalars
                .iter()
                .map(|s| s.values.len() * size_of::<f32>())
                .sum::<usize>()
    }

    pub(super) fn corners(&self, triangle: [u32; 3]) -> Option<[DVec3; 3]> {
        let [a, b, c] = triangle.map(|i| self.positions.get(i as usize).copied());
        Some([a?, b?, c?])
    }
}

/// Whether a vertex is finite and within [`COORDINATE_LIMIT`].
pub(crate) fn is_storable(position: DVec3) -> bool {
    position.is_finite() && position.abs().max_element() <= COORDINATE_LIMIT
}

/// The offset that moves a far mesh near the origin, an axis at a time, such that coordinates that were single
/// precision in the file stay exact.
///
/// An axis has an offset where the mesh [lo, hi] lies further from zero than it is long. A single-precision
/// coordinate there is a multiple of `ulp = 2^(e−23)`, with e the exponent of the nearer end, and `hi − lo < 2^(e+1)
/// = 2^24 ulp`. The offset is a multiple of a power of two g, the greater of `ulp` and the one just below `hi − lo`,
/// so differences from it are multiples of `ulp`. It is within g/2 of the middle, so differences are at most `hi −
/// lo`: 24 bits hold them exactly.
pub(crate) fn recentring_offset(bounds: &Bounds) -> DVec3 {
    if bounds.is_empty() {
        return DVec3::ZERO;
    }
    let axis = |lo: f64, hi: f64| {
        let nearest = lo.abs().min(hi.abs());
        let length = hi - lo;
        if lo.signum() != hi.signum() || nearest <= length {
            return 0.0;
        }
        let nearest_ulp = power_of_two_below(nearest) * 2f64.powi(-23);
        let grain = if length > 0.0 {
            power_of_two_below(length)
        } else {
            0.0
        };
        let grain = grain.max(nearest_ulp);
        ((lo + length * 0.5) / grain).round() * grain
    };
    DVec3::new(
        axis(bounds.min.x, bounds.max.x),
        axis(bounds.min.y, bounds.max.y),
        axis(bounds.min.z, bounds.max.z),
    )
}

/// The largest power of two not above a positive normal `x`.
fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & 0x7ff0_0000_0000_0000)
}
