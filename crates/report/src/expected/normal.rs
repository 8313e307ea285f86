//! A surface's normal: the triangle's own, and the mesh's interpolated one.

use super::range::{
    Double, Single, Vector, cross, dot, exactly, exactly_single, length, minus, plus, scaled, to,
    unit,
};
use raycast_core::camera::{Camera, Projection};
use raycast_core::glam::{DAffine3, DVec3, Vec3};

/// The unit normal of a triangle on the side that the camera sees, from its corners relative to the eye.
///
/// Perspective: the side of the eye; orthographic: against the rays. Unknown where rounding in double precision may
/// flip it.
pub(super) fn flat(camera: &Camera, corners: [Vector<53>; 3]) -> Vector<24> {
    let [a, b, c] = corners;
    // The length is irrelevant before normalising.
    let normal = unit(cross(minus(b, a), minus(c, a)));
    let along = match camera.projection() {
        Projection::Orthographic => exactly(camera.forward()),
        _ => a,
    };
    let away = dot(normal, along);
    if !away.is_known() || away.contains(0.0) {
        return [Single::UNKNOWN; 3];
    }
    let normal = if away.low > 0.0 {
        normal.map(|n| -n)
    } else {
        normal
    };
    to(normal)
}

/// The map of a mesh's normals to world space: the inverse transpose of its transform, up to a factor.
#[derive(Clone, Copy, Debug)]
pub(super) struct ToWorld([Vector<24>; 3]);

impl ToWorld {
    /// `None` for an object that is flattened, or nearly so: there rounding may decide.
    pub(super) fn new(world_from_object: &DAffine3) -> Option<Self> {
        // The columns of the inverse transpose are cross products of those of the matrix, over its
        // determinant; its sign makes no difference, since normals are turned to the side that shows.
        let [x, y, z] = [
            world_from_object.matrix3.x_axis,
            world_from_object.matrix3.y_axis,
            world_from_object.matrix3.z_axis,
        ];
        let lengths = x.length() * y.length() * z.length();
        let determinant = x.cross(y).dot(z).abs();
        if !(lengths.is_finite() && determinant > 1e-6 * lengths) {
            return None;
        }
        let columns = [y.cross(z), z.cross(x), x.cross(y)];
        let largest = columns
            .iter()
            .map(|column| column.abs().max_element())
            .fold(0.0, f64::max);
        // Each entry is a difference of two rounded products of the matrix's own entries, by way of an
        // inverse whose determinant is known to 1e-6 of its lengths at worst: 2⁻⁵³ · 1e6 and a few
        // operations more are below 2⁻³⁰ of the largest entry.
        let entry = |entry: f64| Single::around(entry / largest, 2f64.powi(-30)).rounded();
        Some(Self(columns.map(|column| column.to_array().map(entry))))
    }

    /// A mesh's normal in world space, of unit length, with the sign of the mesh's.
    pub(super) fn direction(&self, normal: Vec3) -> Vector<24> {
        unit(self.apply(exactly_single(normal)))
    }

    fn apply(&self, [x, y, z]: Vector<24>) -> Vector<24> {
        let [a, b, c] = self.0;
        plus(plus(scaled(a, x), scaled(b, y)), scaled(c, z))
    }
}

/// The mesh's normals at the corners, interpolated at a hit and oriented to the side of `flat`; `flat` itself where
/// they cancel. `to_world` is `None` where the map is unknown.
pub(super) fn smooth(
    normals: [Vector<24>; 3],
    to_world: Option<&ToWorld>,
    weights: [Single; 3],
    flat: Vector<24>,
) -> Vector<24> {
    let Some(to_world) = to_world else {
        return [Single::UNKNOWN; 3];
    };
    let corner = |normal: Vector<24>| {
        if normal.iter().all(|n| n.low == 0.0 && n.high == 0.0) {
            exactly(DVec3::ZERO)
        } else {
            unit(to_world.apply(normal))
        }
    };
    let [a, b, c] = normals.map(corner);
    let blended = blend([a, b, c], weights);
    let size = length(blended);
    if size.high <= 1e-6 {
        return flat;
    }
    let turned = dot(blended, flat);
    if !size.is_known() || size.low <= 1e-6 || turned.contains(0.0) || !turned.is_known() {
        return [Single::UNKNOWN; 3];
    }
    let unit = blended.map(|n| n / size);
    if turned.high < 0.0 {
        unit.map(|n| -n)
    } else {
        unit
    }
}

/// The weights of a triangle's corners at (u, v), in single precision.
pub(super) fn weights(u: Single, v: Single) -> [Single; 3] {
    [Single::exactly(1.0) - u - v, u, v]
}

/// Corner values, weighted.
pub(super) fn blend<const N: usize>(
    [a, b, c]: [[Single; N]; 3],
    [of_a, of_b, of_c]: [Single; 3],
) -> [Single; N] {
    std::array::from_fn(|i| a[i] * of_a + b[i] * of_b + c[i] * of_c)
}

/// The direction from a triangle's middle to the eye, from its corners relative to the eye.
pub(super) fn middle_to_eye(camera: &Camera, [a, b, c]: [Vector<53>; 3]) -> Vector<24> {
    match camera.projection() {
        Projection::Orthographic => exactly_single((-camera.forward()).as_vec3()),
        _ => {
            let middle = plus(plus(a, b), c).map(|sum| sum / Double::exactly(3.0));
            to(unit(middle).map(|m| -m))
        }
    }
}
