//! The rays of a packet, and the map T from world space to packet space. [`setup`](super) derives the bounds on its
//! errors.

use super::{EPSILON, Linear, REACH};
use crate::camera::{Camera, Projection};
use crate::hit::Cull;
use crate::num::simd::LANES;
use crate::packet::depth_reference::DepthReference;
use crate::packet::params::SIDE;
use crate::triangle::CornerLanes;
use glam::{DVec3, Vec3};

/// The map of triangles into a packet's space, with the magnitudes of its error bounds.
#[derive(Clone, Debug)]
pub(crate) struct PacketSpace {
    pub(in crate::packet) perspective: bool,
    /// The point that corners are relative to.
    pub(in crate::packet) origin: DVec3,
    /// From there to the point of depth one on the first ray.
    pub(in crate::packet) unit_depth: DVec3,
    /// T's rows.
    pub(in crate::packet) map: [DVec3; 3],
    pub(in crate::packet) cull: Cull,
    /// Columns and rows of the packet, less one.
    pub(in crate::packet) last: (f32, f32),
    /// K + h, or K for orthographic packets.
    pub(super) stretch_and_reach: f64,
    /// η.
    pub(in crate::packet) origin_error: f64,
    /// The factors of A and of Z in the bound on r.
    size: (f64, f64),
    /// 32εK·B/D; zero for orthographic packets.
    pub(in crate::packet) ray_error: f64,
    /// B/D; one for orthographic packets.
    pub(in crate::packet) obliqueness: f64,
    pub(in crate::packet) rays: PacketRays,
    /// The reference of depth keys, and the bound on its error, that of moving it within the packet included.
    pub(in crate::packet) reference: Linear,
    pub(in crate::packet) reference_error: f64,
    /// The triangle whose plane is the reference.
    pub(in crate::packet) reference_plane: Option<u32>,
    /// The factor of depth keys.
    pub(in crate::packet) key_factor: f64,
    /// Units of depth to one of the scene's. T maps to these, and all that is derived for T holds in these.
    pub(in crate::packet) units: f64,
}

/// The rays of a packet in world space.
#[derive(Clone, Copy, Debug)]
pub(in crate::packet) struct PacketRays {
    /// d: the direction of the first ray.
    pub(in crate::packet) direction: DVec3,
    /// a and b: the steps from ray to ray, along columns and rows.
    pub(in crate::packet) steps: [DVec3; 2],
    /// D; one for orthographic packets.
    pub(in crate::packet) distance: f64,
    /// Bound on the error of products with directions, in units of the other factor's components: of the rays' own
    /// directions, of d and of products' roundings. [`componentwise_setup`](crate::packet::componentwise_setup) derives it.
    pub(in crate::packet) error: DVec3,
}

/// What the spaces of perspective and of orthographic packets have in common.
struct Packet {
    steps: [DVec3; 2],
    last: (f32, f32),
    cull: Cull,
}

impl Packet {
    /// The map of a packet whose first ray has this direction, with its image plane at `distance` from the origin, and
    /// this error of products with directions. Magnitudes are left to the projection.
    fn space(
        self,
        (d, distance): (DVec3, f64),
        (origin, origin_error): (DVec3, f64),
        error: DVec3,
    ) -> PacketSpace {
        let [a, b] = self.steps;
        let determinant = a.dot(b.cross(d));
        let scale = distance / determinant;
        PacketSpace {
            perspective: true,
            origin,
            unit_depth: d / distance,
            map: [b.cross(d) * scale, d.cross(a) * scale, a.cross(b) * scale],
            cull: self.cull,
            last: self.last,
            stretch_and_reach: 0.0,
            origin_error,
            size: (0.0, 0.0),
            ray_error: 0.0,
            obliqueness: 1.0,
            rays: PacketRays {
                direction: d,
                steps: self.steps,
                distance,
                error,
            },
            reference: Linear::ZERO,
            reference_error: 0.0,
            reference_plane: None,
            key_factor: 1.0,
            units: 1.0,
        }
    }
}

/// Bound on how far an orthographic ray's origin is from its place, but for the eye's error. `sizes` are the greatest
/// coordinates of the eye in world space, to which the place is added in the ray, and of the point that places are
/// relative to, to which it is added in the packet; `reach` is the sum of the greatest coordinates of the place on the
/// image plane and in the picture. Each of the two sums is rounded once. A place in the picture, its offset from the view
/// axis, and products and sum with the axes round twelve times by no more than `reach`, in the ray and again in the
/// packet.
pub(in crate::packet) fn origin_error(sizes: [f64; 2], reach: f64) -> f64 {
    let [eye, point] = sizes;
    EPSILON * (1.01 * (eye + point) + 32.0 * reach)
}

impl PacketSpace {
    /// The packet whose first ray goes through (x, y) of the picture, with rays `stride` pixels apart. `eye` is the
    /// camera's, relative to the point that corners are relative to, and off by at most `eye_error`.
    pub(crate) fn new(
        camera: &Camera,
        eye: DVec3,
        eye_error: f64,
        (x, y): (f64, f64),
        stride: f64,
        (columns, rows): (u32, u32),
        cull: Cull,
    ) -> Self {
        let step = camera.plane().step * stride;
        let (across, along) = camera.across_and_along(x, y);
        let reach = (across.abs() + REACH * step) + (along.abs() + REACH * step);
        let steps = [camera.right() * step, camera.up() * -step];
        let packet = Packet {
            steps,
            last: (columns as f32 - 1.0, rows as f32 - 1.0),
            cull,
        };
        match camera.projection() {
            Projection::Perspective => {
                let (d, distance) = (camera.direction(x, y), camera.distance());
                let (stretch, wide) = ((reach + distance) / step, (reach + distance) / distance);
                let [axis, others] = camera.greatest_terms((x, y), REACH * stride);
                let error = (axis * 8.0 + others * 26.0) * EPSILON;
                Self {
                    stretch_and_reach: stretch + REACH,
                    size: (2.1 * step / distance, 1.1 * wide),
                    ray_error: 32.0 * EPSILON * stretch * wide,
                    obliqueness: wide,
                    ..packet.space((d, distance), (eye, eye_error), error)
                }
            }
            Projection::Orthographic | Projection::Panoramic(_) => {
                let origin = eye + camera.on_plane(x, y);
                let places = (x.abs() + y.abs()) * camera.plane().step;
                let sizes = [camera.pose().eye, origin].map(|point| point.abs().max_element());
                let origin_error = eye_error + origin_error(sizes, reach + places);
                let error = camera.forward().abs() * (3.0 * EPSILON);
                Self {
                    perspective: false,
                    stretch_and_reach: 1.0 / step,
                    size: (2.1 * step, 1.1),
                    ray_error: 0.0,
                    obliqueness: 1.0,
                    ..packet.space((camera.forward(), 1.0), (origin, origin_error), error)
                }
            }
        }
    }

    /// The same space, with depth keys relative to a reference and of its units.
    pub(in crate::packet) fn relative_to(self, reference: DepthReference) -> Self {
        let units = reference.units();
        let (function, error) = reference.function();
        Self {
            reference: function,
            reference_error: match reference.is_plane() {
                true => error + 8.0 * EPSILON * function.reach(),
                false => 0.0,
            },
            reference_plane: reference.plane(),
            key_factor: reference.factor(),
            map: self.map.map(|row| row * units),
            units,
            ..self
        }
    }

    /// A lower bound of the reference along the packet's rays.
    pub(in crate::packet) fn least_reference(&self) -> f64 {
        let Linear { constant, x, y } = self.reference;
        let side = SIDE as f64;
        constant + (x * side).min(0.0) + (y * side).min(0.0) - self.reference_error
    }

    /// Maps a point into packet space.
    pub(super) fn map_point(&self, point: Vec3) -> [f64; 3] {
        let relative = point.as_dvec3() - self.origin;
        self.map.map(|row| relative.dot(row))
    }

    /// Maps corners into packet space.
    #[inline(always)]
    pub(super) fn map(&self, corners: &CornerLanes) -> [[f64; LANES]; 9] {
        let mut out = [[0.0; LANES]; 9];
        let [tx, ty, tz] = self.map;
        let o = self.origin;
        for corner in 0..3 {
            for l in 0..LANES {
                let x = f64::from(corners[3 * corner][l]) - o.x;
                let y = f64::from(corners[3 * corner + 1][l]) - o.y;
                let z = f64::from(corners[3 * corner + 2][l]) - o.z;
                out[3 * corner][l] = x * tx.x + y * tx.y + z * tx.z;
                out[3 * corner + 1][l] = x * ty.x + y * ty.y + z * ty.z;
                out[3 * corner + 2][l] = x * tz.x + y * tz.y + z * tz.z;
            }
        }
        out
    }

    /// δ for corners whose X and Y are at most `reach` and Z at most `depth`.
    #[inline(always)]
    pub(super) fn delta(&self, reach: f64, depth: f64) -> f64 {
        72.0 * (EPSILON * (reach * self.size.0 + depth * self.size.1)
            + self.origin_error * self.units)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{ImagePlane, Pose};
    use crate::num::double_double::DoubleDouble;
    use crate::random::Random;

    /// Eyes far from the world's origin, corners relative to a point far from both, and places far from the view axis.
    /// With any of the three terms of the bound at zero this fails.
    #[test]
    fn origins_of_parallel_rays_are_within_their_error() {
        let mut random = Random(131);
        for case in 0..4 {
            let mut most: f64 = 0.0;
            for _ in 0..2000 {
                // With few digits, so that the eye relative to the point is exact.
                let far = (random.point() * 1e3).round() * 1e6;
                let (eye, frame, shift) = match case {
                    0 => (far, DVec3::ZERO, 0.0),
                    1 => (far, far, 0.0),
                    2 => (DVec3::ZERO, far, 0.0),
                    _ => (DVec3::ZERO, DVec3::ZERO, 1e6),
                };
                let pose = Pose {
                    eye,
                    target: eye + random.point(),
                    up: DVec3::Y,
                };
                let plane = ImagePlane::new(64, 64, 1e-9).expect("a good plane");
                let camera = Camera::new(pose, Projection::Orthographic, plane);
                let place @ (x, y) = (
                    random.unit() * 32.0 + shift * random.signed(),
                    random.unit(),
                );
                let size = (32, 32);
                let space =
                    PacketSpace::new(&camera, eye - frame, 0.0, place, 1.0, size, Cull::None);
                // Products with powers of two are exact.
                let [i, j] = [(); 2].map(|()| f64::from(1 << (random.unit() * 5.0) as u32));
                let ray = camera.ray(x + i, y + j);
                let [a, b] = space.rays.steps;
                for axis in 0..3 {
                    let relative = DoubleDouble::difference(ray.origin[axis], frame[axis]);
                    let terms = [space.origin[axis], i * a[axis], j * b[axis]];
                    let off = (terms.into_iter())
                        .fold(relative, |off, term| off - DoubleDouble::from(term))
                        .high
                        .abs();
                    assert!(off <= space.origin_error, "{case} {place:?}");
                    most = most.max(off / space.origin_error);
                }
            }
            assert!(most > 0.02, "{case} {most}");
        }
    }
}
