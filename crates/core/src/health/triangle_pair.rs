//! Whether two triangles of a mesh intersect elsewhere than where they are joined.
//!
//! Decided by exact signs alone (Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
//! Predicates", 1997): an edge intersects a triangle where its ends are not strictly on one side of the plane and its
//! line passes all three edges with the same orientation (Guigue, Devillers, "Fast and Robust Triangle-Triangle
//! Overlap Test Using Orientation Predicates", 2003, use the same signs in an order that needs fewer).

use glam::Vec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

/// A corner: its welded vertex, equal where two corners are at one position, and its coordinates.
pub(super) type Corner = (u32, Vec3);

/// Whether two triangles intersect elsewhere than at the corner or edge that both have. Touching counts. Two
/// triangles with all three corners in common do not intersect otherwise.
///
/// Both must have area. The order of triangles and of corners does not matter.
pub(super) fn meet(a: &[Corner; 3], b: &[Corner; 3]) -> bool {
    let shared = |corner: &Corner, of: &[Corner; 3]| of.iter().any(|other| other.0 == corner.0);
    let count = a.iter().filter(|corner| shared(corner, b)).count();
    let first = |of: &[Corner; 3], is_first: &dyn Fn(&Corner) -> bool| {
        let mut points = of.map(|(_, point)| point);
        let at = of.iter().position(is_first).unwrap_or(0);
        points.rotate_left(at);
        points
    };
    match count {
        0 => disjoint(&a.map(|(_, point)| point), &b.map(|(_, point)| point)),
        1 => joined_at_corner(&first(a, &|c| shared(c, b)), &first(b, &|c| shared(c, a))),
        2 => joined_at_edge(&first(a, &|c| !shared(c, b)), &first(b, &|c| !shared(c, a))),
        _ => false,
    }
}

/// Two triangles without a common corner.
fn disjoint(a: &[Vec3; 3], b: &[Vec3; 3]) -> bool {
    let (sides_of_b, sides_of_a) = (b.map(|p| side(a, p)), a.map(|p| side(b, p)));
    if is_apart(&sides_of_b) || is_apart(&sides_of_a) {
        return false;
    }
    // If they intersect, some edge of one intersects the other: an extreme point of the intersection lies on an edge.
    let edges = |of: &[Vec3; 3], sides: &[i8; 3], other: &[Vec3; 3]| {
        [(0, 1), (1, 2), (2, 0)]
            .iter()
            .any(|&(i, j)| edge_meets([of[i], of[j]], [sides[i], sides[j]], other))
    };
    edges(b, &sides_of_b, a) || edges(a, &sides_of_a, b)
}

/// Two triangles with their first corner in common.
///
/// A ray from the corner through another common point leaves one of the triangles no later than the other, through
/// its edge opposite to the corner: that edge intersects the other triangle. The edge does not contain the corner, so
/// the converse holds as well.
fn joined_at_corner(a: &[Vec3; 3], b: &[Vec3; 3]) -> bool {
    let sides_of_b = [side(a, b[1]), side(a, b[2])];
    let sides_of_a = [side(b, a[1]), side(b, a[2])];
    let is_apart = |[one, other]: [i8; 2]| one * other > 0;
    !is_apart(sides_of_b)
        && !is_apart(sides_of_a)
        && (edge_meets([b[1], b[2]], sides_of_b, a) || edge_meets([a[1], a[2]], sides_of_a, b))
}

/// Two triangles with all but their first corner in common. If their planes differ, they intersect along the common
/// edge alone.
fn joined_at_edge(a: &[Vec3; 3], b: &[Vec3; 3]) -> bool {
    side(a, b[0]) == 0 && {
        let flat = flatten(a);
        turn(flat(a[1]), flat(a[2]), flat(a[0])) == turn(flat(a[1]), flat(a[2]), flat(b[0]))
    }
}

fn is_apart(sides: &[i8; 3]) -> bool {
    sides.iter().all(|side| *side > 0) || sides.iter().all(|side| *side < 0)
}

/// Whether an edge, whose ends lie on these sides of a triangle's plane, intersects the triangle.
fn edge_meets([p, q]: [Vec3; 2], sides: [i8; 2], triangle: &[Vec3; 3]) -> bool {
    match sides {
        [0, 0] => edge_meets_in_plane([p, q], triangle),
        [one, other] if one * other > 0 => false,
        _ => {
            // The line crosses the plane in one point. Not all three signs are zero, since the triangle has area.
            let [a, b, c] = *triangle;
            let around = [[a, b], [b, c], [c, a]].map(|[from, to]| side(&[p, q, from], to));
            around.iter().all(|sign| *sign >= 0) || around.iter().all(|sign| *sign <= 0)
        }
    }
}

fn edge_meets_in_plane([p, q]: [Vec3; 2], triangle: &[Vec3; 3]) -> bool {
    let flat = flatten(triangle);
    let (p, q) = (flat(p), flat(q));
    let corners @ [a, b, c] = triangle.map(flat);
    let is_inside = |point| {
        let turns = [turn(a, b, point), turn(b, c, point), turn(c, a, point)];
        turns.iter().all(|turn| *turn >= 0) || turns.iter().all(|turn| *turn <= 0)
    };
    is_inside(p)
        || is_inside(q)
        || [(0, 1), (1, 2), (2, 0)].iter().any(|&(i, j)| {
            let (from, to) = (corners[i], corners[j]);
            turn(p, q, from) * turn(p, q, to) <= 0
                && turn(from, to, p) * turn(from, to, q) <= 0
                && boxes_overlap([p, q], [from, to])
        })
}

/// Whether the bounding boxes of two edges of one plane overlap. Two edges whose ends are not strictly on one side of
/// the other may still lie apart if all four ends are on one line.
fn boxes_overlap([p, q]: [[f32; 2]; 2], [a, b]: [[f32; 2]; 2]) -> bool {
    let overlaps = |axis: usize| {
        let (p, q, a, b) = (p[axis], q[axis], a[axis], b[axis]);
        p.min(q) <= a.max(b) && a.min(b) <= p.max(q)
    };
    overlaps(0) && overlaps(1)
}

/// On which side of a triangle's plane a point lies.
fn side(&[a, b, c]: &[Vec3; 3], point: Vec3) -> i8 {
    let coord = |p: Vec3| Coord3D {
        x: f64::from(p.x),
        y: f64::from(p.y),
        z: f64::from(p.z),
    };
    sign(orient3d(coord(a), coord(b), coord(c), coord(point)))
}

/// The orientation of three points of the plane.
fn turn(a: [f32; 2], b: [f32; 2], c: [f32; 2]) -> i8 {
    let coord = |[x, y]: [f32; 2]| Coord {
        x: f64::from(x),
        y: f64::from(y),
    };
    sign(orient2d(coord(a), coord(b), coord(c)))
}

fn sign(value: f64) -> i8 {
    i8::from(value > 0.0) - i8::from(value < 0.0)
}

/// The projection along an axis onto a plane in which the triangle keeps area, so that no two points of its plane
/// coincide.
fn flatten(&[a, b, c]: &[Vec3; 3]) -> impl Fn(Vec3) -> [f32; 2] + Copy {
    let along = |axis: usize| move |p: Vec3| [p[(axis + 1) % 3], p[(axis + 2) % 3]];
    let keeps_area = |axis: &usize| {
        let flat = along(*axis);
        turn(flat(a), flat(b), flat(c)) != 0
    };
    along((0..3).find(keeps_area).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use glam::I64Vec3;

    /// Whether an axis separates two sets of points; exact, since coordinates are integers.
    fn separates(axis: I64Vec3, a: &[I64Vec3], b: &[I64Vec3]) -> bool {
        let range = |of: &[I64Vec3]| {
            let along = of.iter().map(|p| p.dot(axis));
            (along.clone().min(), along.max())
        };
        let ((a_min, a_max), (b_min, b_max)) = (range(a), range(b));
        a_max < b_min || b_max < a_min
    }

    /// Whether the convex hulls of at most three points each intersect, by the separating axis theorem (Gottschalk,
    /// Lin, Manocha, "OBBTree", 1996). It uses no orientation, so it is independent of the code under test.
    fn hulls_meet(a: &[I64Vec3], b: &[I64Vec3]) -> bool {
        let edges = |of: &[I64Vec3]| -> Vec<I64Vec3> {
            (0..of.len())
                .map(|i| of[(i + 1) % of.len()] - of[i])
                .collect()
        };
        let mut ways = [edges(a), edges(b)].concat();
        let normals: Vec<_> = [a, b]
            .iter()
            .filter(|of| of.len() == 3)
            .map(|of| (of[1] - of[0]).cross(of[2] - of[0]))
            .collect();
        ways.extend(&normals);
        let crossed = ways.iter().flat_map(|a| ways.iter().map(|b| a.cross(*b)));
        let mut axes = normals.iter().copied().chain(crossed);
        !axes.any(|axis| separates(axis, a, b))
    }

    /// [`meet`] by separating axes. A triangle that shares a corner is scaled far beyond all coordinates, and tested
    /// against the opposite edge of the other alone.
    fn meet_by_axes(a: &[(u32, I64Vec3); 3], b: &[(u32, I64Vec3); 3]) -> bool {
        let is_shared = |of: &[(u32, I64Vec3); 3], corner: &(u32, I64Vec3)| {
            of.iter().any(|other| other.0 == corner.0)
        };
        let split = |of: &[(u32, I64Vec3); 3], other: &[(u32, I64Vec3); 3]| -> [Vec<I64Vec3>; 2] {
            [true, false].map(|shared| {
                let is = |corner: &&(u32, I64Vec3)| is_shared(other, corner) == shared;
                of.iter().filter(is).map(|corner| corner.1).collect()
            })
        };
        let ([shared, own], [_, others]) = (split(a, b), split(b, a));
        match shared.len() {
            0 => hulls_meet(&own, &others),
            1 => {
                let apex = shared[0];
                let large = others.iter().map(|p| apex + (p - apex) * 1000);
                let large: Vec<_> = std::iter::once(apex).chain(large).collect();
                hulls_meet(&own, &large)
            }
            2 => {
                let along = shared[1] - shared[0];
                let normal = |p: &I64Vec3| along.cross(p - shared[0]);
                let (one, other) = (normal(&own[0]), normal(&others[0]));
                one.cross(other) == I64Vec3::ZERO && one.dot(other) > 0
            }
            _ => false,
        }
    }

    #[test]
    fn triangles_on_a_small_grid_intersect_where_no_axis_separates_them() {
        let mut random = Random(17);
        let mut counts = [[0_u32; 2]; 3];
        // A small grid, so that corners and edges are shared, lines touch, and planes coincide.
        for size in [2, 3, 4, 6] {
            let mut corner = |flat: bool| {
                let mut axis = || (random.unit() * f64::from(size)) as i64;
                let point = I64Vec3::new(axis(), axis(), if flat { 0 } else { axis() });
                let place = (point.x * 64 + point.y * 8 + point.z) as u32;
                (place, point)
            };
            for round in 0..20_000 {
                let flat = round % 4 == 0;
                let [a, b] = [0, 1].map(|_| [corner(flat), corner(flat), corner(flat)]);
                let has_area = |t: &[(u32, I64Vec3); 3]| {
                    (t[1].1 - t[0].1).cross(t[2].1 - t[0].1) != I64Vec3::ZERO
                };
                let shared = a.iter().filter(|x| b.iter().any(|y| x.0 == y.0)).count();
                if !has_area(&a) || !has_area(&b) || shared == 3 {
                    continue;
                }
                let expected = meet_by_axes(&a, &b);
                counts[shared][usize::from(expected)] += 1;
                let [a, b] = [a, b].map(|t| t.map(|(place, p)| (place, p.as_vec3())));
                let turned = [a[1], a[0], a[2]];
                assert_eq!(meet(&a, &b), expected, "{a:?} {b:?}");
                assert_eq!(meet(&b, &a), expected, "{b:?} {a:?}");
                assert_eq!(meet(&turned, &b), expected, "{turned:?} {b:?}");
            }
        }
        // Each type of pair occurred with either answer.
        assert!(counts.iter().flatten().all(|n| *n > 500), "{counts:?}");
    }

    #[test]
    fn a_gap_of_the_least_positive_number_is_no_touch() {
        let flat = [(0, Vec3::ZERO), (1, Vec3::X), (2, Vec3::Y)];
        let above = |z: f32| {
            [
                (3, Vec3::new(0.25, 0.25, z)),
                (4, Vec3::new(0.25, 0.5, 1.0)),
                (5, Vec3::new(0.5, 0.25, 1.0)),
            ]
        };
        assert!(meet(&flat, &above(0.0)));
        assert!(!meet(&flat, &above(f32::from_bits(1))));
        assert!(meet(&flat, &above(-f32::from_bits(1))));
    }
}
