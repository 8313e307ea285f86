//! Interpolates t, u and v of eight neighbouring rays at triangles that they are known to hit, in double precision,
//! side by side.
//!
//! Each lane computes what [`PreparedRay`](super::PreparedRay) computes for one ray, operation by operation, so the
//! bits are the same.

use super::corner_lanes::CornerLanes;
use super::edges::{Edges, axes, major_axis};
use crate::camera::{Camera, EightDirections, Lattice, Projection};
use crate::num::choice::greater;
use crate::num::roundoff::EPSILON;
use glam::DVec3;

pub(crate) use crate::num::simd::LANES;

/// The hits of eight rays.
pub(crate) struct RowHits {
    pub(crate) t: [f32; LANES],
    pub(crate) u: [f32; LANES],
    pub(crate) v: [f32; LANES],
    /// Whether a lane has the bits of the single ray; other lanes must be interpolated alone.
    pub(crate) sure: [bool; LANES],
}

impl RowHits {
    /// Of which nothing is known.
    pub(crate) const NONE: Self = Self {
        t: [0.0; LANES],
        u: [0.0; LANES],
        v: [0.0; LANES],
        sure: [false; LANES],
    };

    /// Takes the lanes from `first` on from others.
    #[inline(always)]
    pub(crate) fn replace_from(&mut self, first: usize, others: &Self) {
        replace_from(&mut self.t, first, &others.t);
        replace_from(&mut self.u, first, &others.u);
        replace_from(&mut self.v, first, &others.v);
        replace_from(&mut self.sure, first, &others.sure);
    }
}

/// One kind of number at a time, which compilers vectorise.
#[inline(always)]
fn replace_from<N: Copy>(mine: &mut [N; LANES], first: usize, others: &[N; LANES]) {
    for (lane, (mine, &other)) in mine.iter_mut().zip(others).enumerate() {
        *mine = if lane >= first { other } else { *mine };
    }
}

/// The image-plane places of eight neighbouring rays: for each column the very number that [`Lattice::place`] gives,
/// and not the first ray's rounded place plus a multiple of the stride.
#[derive(Clone, Copy)]
pub(crate) struct RowPlaces {
    /// The first ray's column in the picture, an integer.
    first: f64,
    stride: f64,
    offset: f64,
    y: f64,
}

impl RowPlaces {
    const NONE: Self = Self {
        first: 0.0,
        stride: 0.0,
        offset: 0.0,
        y: 0.0,
    };

    /// The places of a column of a lattice's row and the seven columns after it.
    #[inline(always)]
    pub(crate) fn new(lattice: &Lattice, column: u32, row: u32) -> Self {
        Self {
            first: f64::from(lattice.x + column * lattice.stride),
            stride: f64::from(lattice.stride),
            offset: lattice.offset.0,
            y: lattice.place(column, row).1,
        }
    }

    /// The places' distances to the right of the view axis.
    #[inline(always)]
    pub(crate) fn across(&self, camera: &Camera) -> [f64; LANES] {
        let mut all = [0.0; LANES];
        for (lane, across) in all.iter_mut().enumerate() {
            let (x, y) = self.get(lane);
            (*across, _) = camera.across_and_along(x, y);
        }
        all
    }

    /// The place of one lane. Integers are not rounded.
    #[inline(always)]
    fn get(&self, lane: usize) -> (f64, f64) {
        let column = self.first + lane as f64 * self.stride;
        (column + self.offset, self.y)
    }
}

/// Interpolates each ray's hit at the triangle in its lane. Corners are relative to `tree_origin`.
#[inline(always)]
pub(crate) fn interpolate_row(
    camera: &Camera,
    tree_origin: DVec3,
    places: RowPlaces,
    corners: &CornerLanes,
) -> RowHits {
    let (x, y) = places.get(0);
    let DVec3 { x, y, z } = match camera.projection() {
        Projection::Perspective => camera.on_plane(x, y) + camera.forward() * camera.distance(),
        _ => camera.forward(),
    };
    let rays = (places, &[[0.0; LANES]; 3]);
    // Neighbouring rays nearly always share their major axis; a lane that does not is left to the single ray.
    match (major_axis(x, y, z), camera.projection()) {
        (0, Projection::Perspective) => {
            interpolate::<0, FROM_EYE>(camera, tree_origin, rays, corners)
        }
        (1, Projection::Perspective) => {
            interpolate::<1, FROM_EYE>(camera, tree_origin, rays, corners)
        }
        (_, Projection::Perspective) => {
            interpolate::<2, FROM_EYE>(camera, tree_origin, rays, corners)
        }
        (0, _) => interpolate::<0, PARALLEL>(camera, tree_origin, rays, corners),
        (1, _) => interpolate::<1, PARALLEL>(camera, tree_origin, rays, corners),
        (_, _) => interpolate::<2, PARALLEL>(camera, tree_origin, rays, corners),
    }
}

/// [`interpolate_row`] for a panorama's rays, given by their directions. The major axis is that of one lane; lanes
/// with another are left to the single ray.
#[inline(always)]
pub(crate) fn interpolate_around(
    camera: &Camera,
    tree_origin: DVec3,
    (directions, lane): (&EightDirections, usize),
    corners: &CornerLanes,
) -> RowHits {
    let [x, y, z] = directions.map(|all| all[lane % LANES]);
    let rays = (RowPlaces::NONE, directions);
    match major_axis(x, y, z) {
        0 => interpolate::<0, AROUND>(camera, tree_origin, rays, corners),
        1 => interpolate::<1, AROUND>(camera, tree_origin, rays, corners),
        _ => interpolate::<2, AROUND>(camera, tree_origin, rays, corners),
    }
}

/// Types of rays: through places of the image plane from one eye; parallel; and with directions of their own.
const FROM_EYE: u8 = 0;
const PARALLEL: u8 = 1;
const AROUND: u8 = 2;

/// Plain loops over arrays, which the compiler vectorises.
#[inline(always)]
#[allow(
    clippy::needless_range_loop,
    reason = "a lane is an index into all the arrays at once"
)]
fn interpolate<const MAJOR: usize, const RAYS: u8>(
    camera: &Camera,
    tree_origin: DVec3,
    (places, directions): (RowPlaces, &EightDirections),
    corners: &CornerLanes,
) -> RowHits {
    let [kx, ky, kz] = const { axes(MAJOR) };
    let [right, up, forward] =
        [camera.right(), camera.up(), camera.forward()].map(|v| v.to_array());
    let eye = camera.pose().eye.to_array();
    let tree_origin = tree_origin.to_array();
    let off = if tree_origin == [0.0; 3] { 0.0 } else { 1.0 };
    let distance = camera.distance();
    let mut hits = RowHits::NONE;
    for lane in 0..LANES {
        // As `Camera::ray`, one coordinate at a time.
        let (x, y) = places.get(lane);
        let (across, along) = camera.across_and_along(x, y);
        let mut origin = eye;
        let mut direction = forward;
        for axis in 0..3 {
            let on_plane = right[axis] * across + up[axis] * along;
            if RAYS == AROUND {
                direction[axis] = directions[axis][lane];
            } else if RAYS == FROM_EYE {
                direction[axis] = on_plane + forward[axis] * distance;
            } else {
                origin[axis] = eye[axis] + on_plane;
            }
        }
        if RAYS == FROM_EYE {
            let [x, y, z] = direction;
            let length = (x * x + y * y + z * z).sqrt();
            direction = [x / length, y / length, z / length];
        }
        let [x, y, z] = direction;
        let same_major = major_axis(x, y, z) == MAJOR;
        let o = [
            origin[0] - tree_origin[0],
            origin[1] - tree_origin[1],
            origin[2] - tree_origin[2],
        ];
        let far = greater(greater(o[0].abs(), o[1].abs()), o[2].abs());
        let origin_error = far * EPSILON * off;

        let advance = direction[kz];
        let shear = [direction[kx] / advance, direction[ky] / advance];
        let at = |axis: usize, corner: usize| f64::from(corners[3 * corner + axis][lane]) - o[axis];
        let edges = Edges::new(
            [at(kx, 0), at(kx, 1), at(kx, 2)],
            [at(ky, 0), at(ky, 1), at(ky, 2)],
            [at(kz, 0), at(kz, 1), at(kz, 2)],
            shear,
            origin_error,
        );
        let [t, u, v] = edges.weights(advance);
        // A camera's rays have t_min = 0 and no t_max. The sign of t is right, since its error is far less than t.
        hits.sure[lane] = same_major & edges.surely_inside() & edges.surely_single() & (t > 0.0);
        hits.t[lane] = t as f32;
        hits.u[lane] = u as f32;
        hits.v[lane] = v as f32;
    }
    hits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{ImagePlane, Pose, Rect};

    /// The place of a sample's ray must not depend on the tile; here the tile begins below a power of two and ends
    /// above it.
    #[test]
    fn lanes_are_at_the_places_of_their_columns() {
        let plane = ImagePlane::new(20_000, 100, 0.1).expect("a good plane");
        let pose = Pose {
            eye: DVec3::ZERO,
            target: DVec3::Z,
            up: DVec3::Y,
        };
        let camera = Camera::new(pose, Projection::Perspective, plane);
        for stride in [1, 3] {
            for sample in 0..256 {
                let rect = Rect {
                    x: 16_381,
                    y: 7,
                    width: 64,
                    height: 2,
                };
                let mut lattice = camera.sub_camera(rect).sparse_lattice(stride, (0, 0));
                // Not multiples of 1/256: those are sums without rounding, in whatever order they are added.
                let offset = |base: u32| (f64::from(sample) + 0.5) / f64::from(base);
                lattice.offset = (offset(257), offset(259));
                let places = RowPlaces::new(&lattice, 2, 1);
                for lane in 0..LANES {
                    let expected = lattice.place(2 + lane as u32, 1);
                    assert_eq!(places.get(lane), expected, "{stride} {sample} {lane}");
                }
            }
        }
    }
}
