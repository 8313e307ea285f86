use crate::camera::Camera;
use crate::num::exact::{Scale, Vector, cross, dot, subtract};
use crate::num::integer::Integer;
use crate::num::roundoff::EPSILON;
use glam::{DVec3, Vec3};
use num_bigint::BigInt;
use std::cmp::Ordering;

/// Decides which side of a triangle a camera's rays see, by the exact sign that [`Cull`](crate::hit::Cull) uses: that
/// of one determinant for all rays that hit the triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sides {
    /// The rays' common origin, in world space, or their common direction.
    eye: Result<DVec3, DVec3>,
    /// The point that corners are relative to.
    origin: DVec3,
}

impl Sides {
    /// For triangles whose corners are relative to `origin`.
    pub(super) fn new(camera: &Camera, origin: DVec3) -> Self {
        let eye = match camera.projection().is_parallel() {
            true => Err(camera.forward()),
            false => Ok(camera.pose().eye),
        };
        Self { eye, origin }
    }

    /// Whether rays that hit a triangle see its back: its corners run clockwise. Rays along the triangle hit neither
    /// side.
    pub(super) fn is_back(&self, corners: [Vec3; 3]) -> bool {
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let (along, size) = match self.eye {
            Err(forward) => (forward, forward.abs()),
            Ok(eye) => {
                let eye = eye - self.origin;
                (a - eye, a.abs() + eye.abs())
            }
        };
        let (p, q) = (b - a, c - a);
        let value = p.cross(q).dot(along);
        // No term has more than nine roundings: the differences of corners, their two products, the difference of
        // these, the eye's position and the difference from it (both relative to `size`), a product and two sums. 16
        // times the unit roundoff, 2⁻⁵³, covers them with all higher orders and the bound's own rounding.
        let (p, q) = (p.abs(), q.abs());
        let products = DVec3::new(
            p.y * q.z + p.z * q.y,
            p.z * q.x + p.x * q.z,
            p.x * q.y + p.y * q.x,
        );
        let error = products.dot(size) * (16.0 * EPSILON);
        // Corners are at most 1e18 and, unless they coincide with the eye along an axis, products of differences stay
        // above the smallest normal number; what leaves the range is decided exactly.
        if value.abs() > error + f64::MIN_POSITIVE {
            value > 0.0
        } else {
            self.exact_sign([a, b, c]) == Ordering::Greater
        }
    }

    #[inline(never)]
    fn exact_sign(&self, corners: [DVec3; 3]) -> Ordering {
        let (Ok(along) | Err(along)) = self.eye;
        let lengths = Scale::of_vectors(corners.iter().chain([&self.origin, &along]));
        let [a, b, c] = corners.map(|corner| lengths.vector::<BigInt>(corner));
        let normal = cross(&subtract(&b, &a), &subtract(&c, &a));
        let along: Vector<BigInt> = lengths.vector(along);
        let along = match self.eye {
            Err(_) => along,
            Ok(_) => subtract(&a, &subtract(&along, &lengths.vector(self.origin))),
        };
        Integer::sign(&dot(&normal, &along))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::Accel;
    use crate::camera::{ImagePlane, Pose, Projection};
    use crate::hit::Cull;
    use crate::random::Random;
    use crate::scene::{Mesh, MeshData, Scene};

    /// Planes through the eye except for 2⁻⁵¹, which rounding hides: exact arithmetic decides the side.
    #[test]
    fn sides_within_rounding_are_decided_exactly() {
        let corners = [[5.0, -3.0, -2.0], [-3.0, 5.0, -2.0], [-2.0, -3.0, 5.0]];
        let corners = corners.map(Vec3::from_array);
        let plane = ImagePlane::new(9, 9, 0.1).expect("a good plane");
        for (z, is_back) in [
            (2f64.next_up(), true),
            (2.0, false),
            (2f64.next_down(), false),
        ] {
            for origin in [DVec3::ZERO, DVec3::X * 1024.0] {
                let pose = Pose {
                    eye: DVec3::new(1.0, 1.0, -z) + origin,
                    target: DVec3::ONE * 30.0,
                    up: DVec3::Y,
                };
                let camera = Camera::new(pose, Projection::Perspective, plane);
                let sides = Sides::new(&camera, origin);
                assert_eq!(sides.is_back(corners), is_back, "{z} {origin}");
            }
        }
    }

    /// The truth is culling, which drops back faces hit by hit. Triangles lie nearly in planes through the eye, also
    /// far from the origin.
    #[test]
    fn backs_are_what_culling_drops() {
        let mut random = Random(5);
        let (mut backs, mut slivers) = (0, 0);
        for round in 0..3000 {
            let away = DVec3::X * [0.0, 1e7][round % 2];
            let thin = [1.0, 1e-9, 1e-14][round % 3];
            let eye = away + random.point() * 3.0;
            let (p, q) = (random.point(), random.point());
            // Nearly in the plane of the eye, p and q.
            let mut corner = || {
                let (x, y) = (random.signed(), random.signed());
                eye + p * x + q * y + random.point() * thin
            };
            let positions = vec![corner(), corner(), corner()];
            let middle = (positions[0] + positions[1] + positions[2]) / 3.0;
            let mesh = Mesh::new(MeshData {
                positions,
                triangles: vec![[0, 1, 2]],
                ..MeshData::default()
            });
            let Ok(accel) = Accel::build(&Scene::from(mesh)) else {
                continue;
            };
            if accel.is_empty() {
                continue;
            }
            let plane = ImagePlane::new(101, 101, 1e-3).expect("a good plane");
            let projection = [Projection::Perspective, Projection::Orthographic][round / 2 % 2];
            let pose = Pose {
                eye,
                target: middle,
                up: random.point(),
            };
            let camera = Camera::new(pose, projection, plane);
            let sides = Sides::new(&camera, accel.origin());
            for step in -2..=2 {
                let place = 50.5 + f64::from(step) * 1e-6;
                let ray = camera.ray(place, 50.5);
                if accel.cast(&ray, Cull::None).is_none() {
                    continue;
                }
                let is_front = accel.cast(&ray, Cull::Back).is_some();
                assert_eq!(sides.is_back(accel.corners(0)), !is_front, "{round}");
                backs += u32::from(!is_front);
                slivers += u32::from(thin < 1e-8);
            }
        }
        assert!(backs > 300 && slivers > 100, "{backs} {slivers}");
    }
}
