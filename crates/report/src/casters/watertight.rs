//! Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013: shears the triangle so that the
//! ray is the z axis, and evaluates the edge functions in two dimensions; a zero in single precision is evaluated
//! again in double precision.

use super::one_ray::CasterRay;
use super::triangle::{Intersection, TriangleTest};
use raycast_core::glam::Vec3;

pub(super) struct Watertight {
    corners: [Vec3; 3],
}

/// The ray's axis permutation and shear: section 3.1.
pub(super) struct ShearedRay {
    origin: Vec3,
    axes: [usize; 3],
    shear: [f32; 3],
}

impl TriangleTest for Watertight {
    type V = Vec3;
    type Ray = ShearedRay;

    fn new(corners: [Vec3; 3]) -> Self {
        Self { corners }
    }

    fn prepare(ray: &CasterRay<Vec3>) -> ShearedRay {
        let d = ray.direction;
        let z = d.abs().max_position();
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        // Preserves the triangle's winding.
        if d[z] < 0.0 {
            (x, y) = (y, x);
        }
        ShearedRay {
            origin: ray.origin,
            axes: [x, y, z],
            shear: [d[x] / d[z], d[y] / d[z], 1.0 / d[z]],
        }
    }

    #[inline(always)]
    fn intersect(&self, ray: &ShearedRay) -> Option<Intersection<f32>> {
        let [x, y, z] = ray.axes;
        let [shear_x, shear_y, shear_z] = ray.shear;
        let relative = self.corners.map(|corner| corner - ray.origin);
        let [a, b, c] = relative.map(|p| (p[x] - shear_x * p[z], p[y] - shear_y * p[z]));
        let mut u = c.0 * b.1 - c.1 * b.0;
        let mut v = a.0 * c.1 - a.1 * c.0;
        let mut w = b.0 * a.1 - b.1 * a.0;
        if u == 0.0 || v == 0.0 || w == 0.0 {
            let double = |p: (f32, f32), q: (f32, f32)| {
                (f64::from(p.0) * f64::from(q.1) - f64::from(p.1) * f64::from(q.0)) as f32
            };
            u = double(c, b);
            v = double(a, c);
            w = double(b, a);
        }
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let determinant = u + v + w;
        if determinant == 0.0 {
            return None;
        }
        let [a_z, b_z, c_z] = relative.map(|p| shear_z * p[z]);
        let scaled_t = u * a_z + v * b_z + w * c_z;
        let inverse = 1.0 / determinant;
        Some(Intersection {
            t: scaled_t * inverse,
            u: v * inverse,
            v: w * inverse,
        })
    }
}
