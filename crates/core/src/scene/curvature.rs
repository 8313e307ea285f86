use super::weld::weld;
use crate::math;
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

/// The curvatures of a mesh at its vertices.
#[derive(Clone, Debug)]
pub(super) struct Curvatures {
    /// Mean curvature, one a vertex; NaN where it is undefined: at open edges, at edges of more than two triangles,
    /// and at vertices without triangles.
    pub(super) mean: Vec<f32>,
    /// Gaussian curvature, likewise.
    pub(super) gaussian: Vec<f32>,
}

/// Discrete curvatures by Meyer, Desbrun, Schröder, Barr, "Discrete Differential-Geometry Operators for Triangulated
/// 2-Manifolds", 2003: the angle deficit, and half the length of the cotangent Laplacian, each divided by the
/// vertex's mixed area. The mean curvature is positive where the surface bends away from its front side, as on the
/// outside of a ball.
///
/// Vertices at one position count as one. `kept` are the triangles that count.
pub(super) fn curvatures(positions: &[Vec3], triangles: &[[u32; 3]], kept: &[u32]) -> Curvatures {
    let place = weld(positions);
    let mut sums = vec![Sums::default(); positions.len()];
    let mut edges = Vec::with_capacity(3 * kept.len());
    for &number in kept {
        let corners = triangles[number as usize].map(|vertex| place[vertex as usize]);
        let points = corners.map(|vertex| positions[vertex as usize].as_dvec3());
        add_triangle(&mut sums, corners, points);
        for side in 0..3 {
            let (from, to) = (corners[side], corners[(side + 1) % 3]);
            edges.push([from.min(to), from.max(to)]);
        }
    }
    edges.sort_unstable();
    for sides in edges.chunk_by(|a, b| a == b) {
        if sides.len() != 2 {
            for vertex in sides[0] {
                sums[vertex as usize].area = f64::NAN;
            }
        }
    }
    let at = |of: fn(&Sums) -> f64| {
        let vertices = place.iter();
        let value = |&vertex: &u32| {
            let sum = &sums[vertex as usize];
            // False for NaN.
            if sum.area > 0.0 {
                of(sum) as f32
            } else {
                f32::NAN
            }
        };
        vertices.map(value).collect()
    };
    Curvatures {
        mean: at(Sums::mean),
        gaussian: at(Sums::gaussian),
    }
}

/// Sums over the triangles at a vertex.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    /// The mixed area.
    area: f64,
    angle: f64,
    /// (cot α + cot β) times each edge, pointing to the vertex.
    laplacian: DVec3,
    /// Twice the area of each triangle along its normal.
    normal: DVec3,
}

impl Sums {
    fn mean(&self) -> f64 {
        let mean = self.laplacian.length() / (4.0 * self.area);
        match self.laplacian.dot(self.normal) < 0.0 {
            true => -mean,
            false => mean,
        }
    }

    fn gaussian(&self) -> f64 {
        (TAU - self.angle) / self.area
    }
}

fn add_triangle(sums: &mut [Sums], corners: [u32; 3], points: [DVec3; 3]) {
    let [a, b, c] = points;
    let normal = (b - a).cross(c - a);
    let doubled = normal.length();
    // For each corner, the cosine of its angle times the lengths of both edges. `doubled` is the sine times the same.
    let dots: [f64; 3] = std::array::from_fn(|i| {
        let (p, q, r) = (points[i], points[(i + 1) % 3], points[(i + 2) % 3]);
        (q - p).dot(r - p)
    });
    let obtuse = dots.iter().position(|dot| *dot < 0.0);
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let (to_j, to_k) = (points[i] - points[j], points[i] - points[k]);
        // The cotangents of the angles opposite to the two edges.
        let (opposite_j, opposite_k) = (dots[k] / doubled, dots[j] / doubled);
        let sum = &mut sums[corners[i] as usize];
        sum.area += match obtuse {
            Some(corner) if corner == i => doubled / 4.0,
            Some(_) => doubled / 8.0,
            None => (to_j.length_squared() * opposite_j + to_k.length_squared() * opposite_k) / 8.0,
        };
        sum.angle += math::atan2(doubled, dots[i]);
        sum.laplacian += to_j * opposite_j + to_k * opposite_k;
        sum.normal += normal;
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Mesh, Shape};
    use super::*;

    fn of(shape: Shape) -> (Mesh, Curvatures) {
        let mesh = Mesh::new(shape.mesh().expect("a good shape"));
        let found = curvatures(mesh.positions(), mesh.triangles(), mesh.kept());
        (mesh, found)
    }

    #[test]
    fn a_sphere_of_radius_two_has_mean_curvature_one_half_and_gaussian_one_quarter() {
        let ball = Shape::Sphere {
            radius: 2.0,
            segments: 128,
            rings: 64,
        };
        let (mesh, found) = of(ball);
        for (vertex, position) in mesh.positions().iter().enumerate() {
            // Near the poles the triangles are slivers, where the operators are inaccurate.
            if position.y.abs() < 1.8 {
                let (mean, gaussian) = (found.mean[vertex], found.gaussian[vertex]);
                assert!((mean - 0.5).abs() < 5e-3, "{position} {mean}");
                assert!((gaussian - 0.25).abs() < 5e-3, "{position} {gaussian}");
            }
        }
    }

    #[test]
    fn a_torus_has_its_analytic_curvatures() {
        let (radius, tube) = (1.0, 0.25);
        let (mesh, found) = of(Shape::Torus {
            radius,
            tube,
            segments: 256,
            rings: 128,
        });
        for (vertex, position) in mesh.positions().iter().enumerate() {
            // The distance from the axis is R + r cos v.
            let [x, y, z] = position.to_array().map(f64::from);
            let from_axis = [x, y, z]
                .map(|axis| x * x + y * y + z * z - axis * axis)
                .map(f64::sqrt);
            let fits = |d: &f64| {
                let along = (x * x + y * y + z * z - d * d).max(0.0).sqrt();
                (((d - radius).powi(2) + along * along).sqrt() - tube).abs() < 1e-4
            };
            let Some(d) = from_axis.iter().find(|d| fits(d)) else {
                panic!("{position} is on the torus");
            };
            let cosine = (d - radius) / tube;
            let gaussian = cosine / (tube * d);
            let mean = (radius + 2.0 * tube * cosine) / (2.0 * tube * d);
            assert!(
                (f64::from(found.gaussian[vertex]) - gaussian).abs() < 0.05,
                "{position}"
            );
            assert!(
                (f64::from(found.mean[vertex]) - mean).abs() < 0.02,
                "{position}"
            );
        }
    }

    #[test]
    fn curvature_is_nan_at_open_edges_and_zero_inside_a_plane() {
        let positions: Vec<Vec3> = (0..9)
            .map(|i| Vec3::new((i % 3) as f32, (i / 3) as f32, 0.0))
            .collect();
        let mut triangles = Vec::new();
        for [x, y] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            let a = x + 3 * y;
            triangles.extend([[a, a + 1, a + 4], [a, a + 4, a + 3]]);
        }
        let kept: Vec<u32> = (0..8).collect();
        let found = curvatures(&positions, &triangles, &kept);
        for vertex in 0..9 {
            let (mean, gaussian) = (found.mean[vertex], found.gaussian[vertex]);
            if vertex == 4 {
                assert!(mean.abs() < 1e-6 && gaussian.abs() < 1e-6);
            } else {
                assert!(mean.is_nan() && gaussian.is_nan());
            }
        }
    }
}
