//! Vertex normals for meshes without normals: smooth across edges below a crease angle.

use super::{Attribute, weld};
use crate::math;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};

/// Vertices in one parallel task.
const CHUNK: usize = 1 << 14;

/// Normals at the corners of the triangles `kept`, with indices of their own; other triangles have none.
///
/// Vertices at one position count as one. An edge is smooth where exactly two triangles share it, one in each
/// direction, and their normals are at most `degrees` apart (at 180 and above, always). Around a vertex, triangles
/// that smooth edges connect share a normal: Σ e × f / (|e|² |f|²) over their edges e and f at the vertex, which
/// weighs by angle and size and is exact where the vertices lie on a sphere (Max, "Weights for Computing Vertex
/// Normals from Facet Normals", 1999). A sum that cancels is zero.
///
/// The sum is in double precision, in the triangles' order, and rounded once: the bits do not depend on the number of
/// threads. O(n log n) in the number of triangles, however many share a vertex.
pub(super) fn creased(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    kept: &[u32],
    degrees: f32,
) -> Attribute<Vec3> {
    let welded = weld(positions);
    let fans = Fans {
        positions,
        triangles,
        welded: &welded,
        least_cosine: match degrees < 180.0 {
            true => math::cos(f64::from(degrees).to_radians()),
            false => f64::NEG_INFINITY,
        },
    };
    let (starts, corners) = fans.corners_by_position(kept);
    let chunks: Vec<usize> = (0..positions.len()).step_by(CHUNK).collect();
    let parts: Vec<_> = chunks
        .par_iter()
        .map(|&first| {
            let mut part = RangeNormals::default();
            let mut star = Star::default();
            for position in first..(first + CHUNK).min(positions.len()) {
                let corners = &corners[starts[position]..starts[position + 1]];
                fans.smooth(corners, &mut star, &mut part);
            }
            part
        })
        .collect();
    let mut values = Vec::with_capacity(parts.iter().map(|part| part.normals.len()).sum());
    let mut indices = vec![[u32::MAX; 3]; triangles.len()];
    let mut rest = &corners[..];
    for part in parts {
        let (own, behind) = rest.split_at(part.normal_of_corner.len());
        rest = behind;
        for (corner, normal) in own.iter().zip(part.normal_of_corner) {
            indices[corner.triangle as usize][corner.side as usize] = values.len() as u32 + normal;
        }
        values.extend(part.normals);
    }
    Attribute {
        values,
        indices: Some(indices),
    }
}

/// A corner of a triangle.
#[derive(Clone, Copy, Debug, Default)]
struct Corner {
    triangle: u32,
    side: u32,
}

/// The normals at a range of vertices, and for each corner there the index of its normal.
#[derive(Debug, Default)]
struct RangeNormals {
    normals: Vec<Vec3>,
    normal_of_corner: Vec<u32>,
}

/// Working memory for the corners at one vertex, reused from vertex to vertex.
#[derive(Debug, Default)]
struct Star {
    /// Each triangle's unit normal, and its weighted contribution to the sum.
    facets: Vec<[DVec3; 2]>,
    /// For each edge at the vertex: the vertex at its other end, whether the edge leads there, and its corner's index
    /// in the star.
    edges: Vec<(u32, bool, u32)>,
    /// Disjoint sets of corners, a set a fan: an index in the same fan that is no higher; the fan's first corner
    /// points to itself.
    fan: Vec<u32>,
    sums: Vec<DVec3>,
}

struct Fans<'m> {
    positions: &'m [Vec3],
    triangles: &'m [[u32; 3]],
    /// Of the vertices at each one's position, the first.
    welded: &'m [u32],
    least_cosine: f64,
}

impl Fans<'_> {
    /// The start of each vertex's corners, and the corners sorted by vertex, then by triangle.
    fn corners_by_position(&self, kept: &[u32]) -> (Vec<usize>, Vec<Corner>) {
        let mut starts = vec![0; self.positions.len() + 1];
        for &triangle in kept {
            for vertex in self.welded(triangle) {
                starts[vertex as usize + 1] += 1;
            }
        }
        for position in 1..starts.len() {
            starts[position] += starts[position - 1];
        }
        let mut next = starts.clone();
        let mut corners = vec![Corner::default(); 3 * kept.len()];
        for &triangle in kept {
            for (side, vertex) in (0..).zip(self.welded(triangle)) {
                corners[next[vertex as usize]] = Corner { triangle, side };
                next[vertex as usize] += 1;
            }
        }
        (starts, corners)
    }

    /// The first vertices at the positions of a triangle's corners.
    fn welded(&self, triangle: u32) -> [u32; 3] {
        self.triangles[triangle as usize].map(|vertex| self.welded[vertex as usize])
    }

    /// Appends the normals at one vertex.
    fn smooth(&self, corners: &[Corner], star: &mut Star, part: &mut RangeNormals) {
        star.facets.clear();
        star.edges.clear();
        for (&Corner { triangle, side }, number) in corners.iter().zip(0..) {
            let side = side as usize;
            let vertices = self.welded(triangle);
            let (next, last) = (vertices[(side + 1) % 3], vertices[(side + 2) % 3]);
            let [a, b, c] = [vertices[side], next, last]
                .map(|vertex| self.positions[vertex as usize].as_dvec3());
            let (e, f) = (b - a, c - a);
            let normal = e.cross(f);
            // Coordinates are at most 1e18 and differ by at least 1e-45, so nothing overflows or underflows double
            // precision.
            let weighted = normal / (e.length_squared() * f.length_squared());
            star.facets.push([normal.normalize_or_zero(), weighted]);
            star.edges.push((next, true, number));
            star.edges.push((last, false, number));
        }
        star.edges.sort_unstable();
        star.fan.clear();
        star.fan.extend(0..corners.len() as u32);
        for edge in star.edges.chunk_by(|a, b| a.0 == b.0) {
            if let [(_, false, left), (_, true, right)] = *edge {
                let cosine = star.facets[left as usize][0].dot(star.facets[right as usize][0]);
                if cosine >= self.least_cosine {
                    join(&mut star.fan, left, right);
                }
            }
        }
        // Each fan's first corner comes before its others.
        star.sums.clear();
        star.sums.resize(corners.len(), DVec3::ZERO);
        for number in 0..star.fan.len() {
            let first = first_of(&mut star.fan, number as u32);
            star.sums[first as usize] += star.facets[number][1];
        }
        let begin = part.normal_of_corner.len();
        for number in 0..star.fan.len() {
            let first = star.fan[number] as usize;
            let normal = if first == number {
                let normal = unit(star.sums[number]);
                part.normals.push(normal.as_vec3());
                part.normals.len() as u32 - 1
            } else {
                part.normal_of_corner[begin + first]
            };
            part.normal_of_corner.push(normal);
        }
    }
}

/// Normalised, or zero. Sums lie between 1e-36 and 1e90, so their squares stay in range.
fn unit(sum: DVec3) -> DVec3 {
    sum.normalize_or_zero()
}

/// The root of a corner's fan, which the corner then points to.
fn first_of(fan: &mut [u32], corner: u32) -> u32 {
    let mut first = corner;
    while fan[first as usize] != first {
        // Path halving.
        fan[first as usize] = fan[fan[first as usize] as usize];
        first = fan[first as usize];
    }
    fan[corner as usize] = first;
    first
}

fn join(fan: &mut [u32], left: u32, right: u32) {
    let (left, right) = (first_of(fan, left), first_of(fan, right));
    fan[left.max(right) as usize] = left.min(right);
}

/// A cache of the normals at the last crease angle.
#[derive(Debug, Default)]
pub(super) struct LastCreased(Mutex<Option<(f32, Arc<Attribute<Vec3>>)>>);

impl LastCreased {
    /// The normals at an angle: cached, or computed by `make`.
    pub(super) fn get(
        &self,
        degrees: f32,
        make: impl FnOnce() -> Attribute<Vec3>,
    ) -> Arc<Attribute<Vec3>> {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known = lock().clone();
        match known {
            Some((known, normals)) if known == degrees => normals,
            // `make` runs without the lock: it may wait for a thread that waits for the lock.
            _ => {
                let normals = Arc::new(make());
                *lock() = Some((degrees, Arc::clone(&normals)));
                normals
            }
        }
    }
}

impl Clone for LastCreased {
    fn clone(&self) -> Self {
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        Self(Mutex::new(known.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Mesh, MeshData, Shape};
    use super::*;
    use crate::random::Random;

    fn mesh(shape: Shape) -> Mesh {
        let data = shape.mesh().expect("a good shape");
        Mesh::new(MeshData {
            normals: None,
            ..data
        })
    }

    fn normals(mesh: &Mesh, degrees: f32) -> Vec<[Vec3; 3]> {
        let found = mesh.creased(degrees);
        let kept = mesh.kept().iter();
        kept.map(|&triangle| found.corners(triangle, [0; 3]).expect("a kept triangle"))
            .collect()
    }

    #[test]
    fn on_a_sphere_normals_are_radial() {
        let ball = mesh(Shape::Sphere {
            radius: 2.0,
            segments: 48,
            rings: 24,
        });
        for (triangle, corners) in ball.kept().iter().zip(normals(&ball, 60.0)) {
            let points = ball.corners(*triangle).expect("a kept triangle");
            for (normal, point) in corners.iter().zip(points) {
                let radial = point / point.length();
                assert!((*normal - radial).length() < 1e-5, "{normal} {radial}");
            }
        }
    }

    #[test]
    fn a_cube_stays_sharp_below_a_right_angle_and_is_rounded_above() {
        let cube = mesh(Shape::Cube {
            size: glam::DVec3::ONE,
        });
        for (degrees, along) in [(0.0, true), (89.9, true), (90.1, false), (180.0, false)] {
            for normal in normals(&cube, degrees).into_iter().flatten() {
                let greatest = normal.abs().max_element();
                assert_eq!(greatest == 1.0, along, "{degrees}: {normal}");
                let diagonal = 1.0 / 3f32.sqrt();
                assert!(along || (greatest - diagonal).abs() < 1e-6, "{normal}");
            }
        }
    }

    #[test]
    fn a_cylinder_has_a_smooth_side_and_flat_lids() {
        let cylinder = mesh(Shape::Cylinder {
            radius: 1.0,
            height: 2.0,
            segments: 32,
        });
        for (triangle, corners) in cylinder.kept().iter().zip(normals(&cylinder, 40.0)) {
            let points = cylinder.corners(*triangle).expect("a kept triangle");
            let [a, b, c] = points.map(|point| point.y);
            for (normal, point) in corners.iter().zip(points) {
                if a == b && b == c {
                    assert_eq!(normal.abs(), Vec3::Y);
                } else {
                    let radial = Vec3::new(point.x, 0.0, point.z).normalize();
                    assert!((*normal - radial).length() < 1e-5, "{normal} {radial}");
                }
            }
        }
    }

    /// The truth is the definition applied corner by corner, without sorting: fans grow until nothing joins them.
    #[test]
    fn normals_of_triangle_soups_are_those_of_the_definition() {
        let mut random = Random(5);
        for round in 0..60 {
            let points = 5 + (random.unit() * 12.0) as usize;
            let mut positions: Vec<Vec3> = (0..points).map(|_| random.point().as_vec3()).collect();
            // Duplicate positions, and a minus zero.
            positions.push(positions[0]);
            positions[1].x = 0.0;
            positions.push(Vec3::new(-0.0, positions[1].y, positions[1].z));
            let count = positions.len() as u32;
            let triangles: Vec<[u32; 3]> = (0..40)
                .map(|_| std::array::from_fn(|_| (random.unit() * f64::from(count)) as u32))
                .collect();
            let mesh = Mesh::new(MeshData {
                positions: positions.iter().map(|p| p.as_dvec3()).collect(),
                triangles,
                ..MeshData::default()
            });
            let degrees = [0.0, 30.0, 75.0, 120.0, 180.0][round % 5];
            let found = mesh.creased(degrees);
            for &triangle in mesh.kept() {
                let corners = found.corners(triangle, [0; 3]).expect("normals");
                for (side, normal) in corners.into_iter().enumerate() {
                    let truth = defined(&mesh, triangle, side, degrees);
                    assert!((normal - truth).length() < 1e-5, "{normal} {truth}");
                }
            }
        }
    }

    fn defined(mesh: &Mesh, triangle: u32, side: usize, degrees: f32) -> Vec3 {
        let corners = |triangle| mesh.corners(triangle).expect("kept").map(|p| p.as_dvec3());
        let normal = |triangle| {
            let [a, b, c] = corners(triangle);
            (b - a).cross(c - a).normalize()
        };
        let at = corners(triangle)[side];
        // For each triangle at the vertex, the ends of its two edges there.
        let star: Vec<(u32, DVec3, DVec3)> = mesh
            .kept()
            .iter()
            .flat_map(|&other| {
                let points = corners(other);
                let there = (0..3).filter(move |&i| points[i] == at);
                there.map(move |i| (other, points[(i + 1) % 3], points[(i + 2) % 3]))
            })
            .collect();
        let smooth = |end: DVec3| {
            let out: Vec<_> = star.iter().filter(|(_, next, _)| *next == end).collect();
            let back: Vec<_> = star.iter().filter(|(.., last)| *last == end).collect();
            match (&out[..], &back[..]) {
                ([one], [other]) => {
                    let cosine = normal(one.0).dot(normal(other.0));
                    let least = math::cos(f64::from(degrees).to_radians());
                    (degrees >= 180.0 || cosine >= least).then_some([one.0, other.0])
                }
                _ => None,
            }
        };
        let mut fan = vec![triangle];
        loop {
            let joined = star.iter().flat_map(|(_, next, last)| [*next, *last]);
            let more = joined.filter_map(smooth).find_map(|[one, other]| {
                match (fan.contains(&one), fan.contains(&other)) {
                    (true, false) => Some(other),
                    (false, true) => Some(one),
                    _ => None,
                }
            });
            match more {
                Some(more) => fan.push(more),
                None => break,
            }
        }
        let sum: DVec3 = star
            .iter()
            .filter(|(other, ..)| fan.contains(other))
            .map(|(_, next, last)| {
                let (e, f) = (*next - at, *last - at);
                e.cross(f) / (e.length_squared() * f.length_squared())
            })
            .sum();
        sum.normalize_or_zero().as_vec3()
    }

    #[test]
    fn a_vertex_of_a_hundred_thousand_triangles_takes_no_longer_than_they_do() {
        // A fan around the origin, twice: each spoke belongs to four triangles, so none is smooth.
        let spokes = 50_000;
        let mut positions = vec![DVec3::ZERO];
        positions.extend((0..spokes).map(|i| {
            let (sine, cosine) =
                math::sin_cos(f64::from(i) * std::f64::consts::TAU / f64::from(spokes));
            DVec3::new(cosine, sine, 0.0)
        }));
        let fan = |i: u32| [0, 1 + i, 1 + (i + 1) % spokes];
        let once: Vec<_> = (0..spokes).map(fan).collect();
        let twice: Vec<_> = once.iter().chain(&once).copied().collect();
        for triangles in [once, twice] {
            let mesh = Mesh::new(MeshData {
                positions: positions.clone(),
                triangles,
                ..MeshData::default()
            });
            assert!(mesh.kept().len() > 49_000);
            for normal in normals(&mesh, 40.0).into_iter().flatten() {
                assert_eq!(normal, Vec3::Z);
            }
        }
    }
}
