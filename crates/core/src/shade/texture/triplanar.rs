//! Triplanar mapping, for surfaces without texture coordinates.

use crate::num::simd::{F32x8, LANES, Lanes};
use crate::scene::{Bounds, Mesh};
use crate::shade::vectors::Vectors;
use glam::{DVec3, Vec3};

/// An object's triplanar mapping: one repeat over the longest side of its box, centred, upright and unmirrored on the
/// sides that face ±X and ±Z, and with −Z up on those that face ±Y.
#[derive(Clone, Copy, Debug)]
pub(in crate::shade) struct Triplanar {
    center: DVec3,
    scale: f64,
}

/// The contribution of one axis to a point's colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::shade) struct Side {
    /// 0 to 1; the three weights of a point sum to one.
    pub(in crate::shade) weight: f32,
    /// Texture coordinates.
    pub(in crate::shade) uv: [f64; 2],
}

impl Triplanar {
    pub(in crate::shade) fn new(mesh: &Mesh) -> Self {
        Self::over(&mesh.bounds(), mesh.offset())
    }

    /// For a box, with points relative to `offset`.
    fn over(bounds: &Bounds, offset: DVec3) -> Self {
        let longest = bounds.size().max_element();
        Self {
            center: bounds.center() - offset,
            scale: if longest > 0.0 { 1.0 / longest } else { 0.0 },
        }
    }

    /// The three axes' contributions to the colour of a point with this unit normal, both in object space.
    pub(in crate::shade) fn sides(&self, point: Vec3, normal: Vec3) -> [Side; 3] {
        let [x, y, z] = ((point.as_dvec3() - self.center) * self.scale).to_array();
        let squared = normal * normal;
        let fourth = squared * squared;
        let sum = fourth.x + fourth.y + fourth.z;
        let weights = if sum > 0.0 { fourth / sum } else { Vec3::Z };
        let [left, above, front] = on_sides([x, y, z], normal);
        let side = |weight, [u, v]: [f64; 2]| Side {
            weight,
            uv: [u + 0.5, v + 0.5],
        };
        [
            side(weights.x, left),
            side(weights.y, above),
            side(weights.z, front),
        ]
    }

    /// [`Triplanar::sides`] of eight samples, at barycentrics (u, v) between corners and between normals: weights and texture
    /// coordinates.
    #[inline(always)]
    pub(in crate::shade) fn eight_sides<L: Lanes>(
        &self,
        lanes: L,
        corners: [[L::F32; 3]; 3],
        normals: [[L::F32; 3]; 3],
        [u, v]: [L::F32; 2],
    ) -> (Vectors<L>, [[[f64; LANES]; 2]; 3]) {
        let point = Vectors::between(lanes, corners, u, v).store().0;
        let normal = Vectors::between(lanes, normals, u, v).unit_or_zero();
        let squared = normal.times(normal);
        let fourth = squared.times(squared);
        let [x, y, z] = fourth.xyz();
        let sum = x + y + z;
        let weights = fourth.divided(sum);
        let weights = Vectors::splat(lanes, Vec3::Z).replaced(lanes.splat(0.0).lt(sum), weights);
        let normal = normal.store().0;
        // A plain loop over arrays, which compilers vectorise.
        let mut sides = [[[0.0; LANES]; 2]; 3];
        let [center_x, center_y, center_z] = self.center.to_array();
        for lane in 0..LANES {
            let x = (f64::from(point[0][lane]) - center_x) * self.scale;
            let y = (f64::from(point[1][lane]) - center_y) * self.scale;
            let z = (f64::from(point[2][lane]) - center_z) * self.scale;
            sides[0][0][lane] = -z * sign(normal[0][lane]) + 0.5;
            sides[0][1][lane] = y + 0.5;
            sides[1][0][lane] = x + 0.5;
            sides[1][1][lane] = -z * sign(normal[1][lane]) + 0.5;
            sides[2][0][lane] = x * sign(normal[2][lane]) + 0.5;
            sides[2][1][lane] = y + 0.5;
        }
        (weights, sides)
    }

    /// The change of the three axes' texture coordinates along a step, for the same normal.
    pub(in crate::shade) fn along(&self, step: DVec3, normal: Vec3) -> [[f64; 2]; 3] {
        on_sides((step * self.scale).to_array(), normal)
    }
}

/// 1, or −1 below zero.
#[inline(always)]
fn sign(component: f32) -> f64 {
    if component < 0.0 { -1.0 } else { 1.0 }
}

/// The texture coordinates along the three axes, relative to the middle of the box.
fn on_sides([x, y, z]: [f64; 3], normal: Vec3) -> [[f64; 2]; 3] {
    [
        [-z * sign(normal.x), y],
        [x, -z * sign(normal.y)],
        [x * sign(normal.z), y],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triplanar() -> Triplanar {
        let bounds = Bounds {
            min: DVec3::new(9.0, 0.0, -1.0),
            max: DVec3::new(13.0, 2.0, 1.0),
        };
        Triplanar::over(&bounds, DVec3::new(10.0, 0.0, 0.0))
    }

    #[test]
    fn the_longest_side_is_one_repeat() {
        let [_, _, z] = triplanar().sides(Vec3::new(-1.0, 1.0, 1.0), Vec3::Z);
        assert_eq!((z.weight, z.uv), (1.0, [0.0, 0.5]));
        let [_, _, z] = triplanar().sides(Vec3::new(3.0, 2.0, 1.0), Vec3::Z);
        assert_eq!((z.weight, z.uv), (1.0, [1.0, 0.75]));
    }

    #[test]
    fn no_side_is_mirrored() {
        // Seen from outside with +Y up, u grows to the right on all four walls.
        for (normal, right) in [
            (Vec3::X, Vec3::NEG_Z),
            (Vec3::NEG_X, Vec3::Z),
            (Vec3::Z, Vec3::X),
            (Vec3::NEG_Z, Vec3::NEG_X),
        ] {
            let u = |point| {
                let sides = triplanar().sides(point, normal);
                sides
                    .iter()
                    .map(|s| f64::from(s.weight) * s.uv[0])
                    .sum::<f64>()
            };
            assert!(u(right) > u(-right), "{normal}");
        }
    }

    #[test]
    fn weights_add_up_to_one() {
        for normal in [
            Vec3::new(0.6, 0.0, 0.8),
            Vec3::ONE.normalize(),
            Vec3::NEG_Y,
            Vec3::ZERO,
        ] {
            let sum: f32 = triplanar()
                .sides(Vec3::ONE, normal)
                .iter()
                .map(|s| s.weight)
                .sum();
            assert!((sum - 1.0).abs() < 1e-6);
        }
    }
}
