//! Self-intersections of a mesh.

use super::GoOn;
use super::box_tree::BoxTree;
use super::report::faces;
use super::triangle_pair::{Corner, meet};
use crate::scene::{Mesh, weld};
use rayon::prelude::*;

/// The most pairs that are listed: more than anybody reads, in 1 MiB.
const MOST_PAIRS: usize = 1 << 17;
/// The most pairs that are listed for one triangle.
const MOST_OF_ONE: usize = 1 << 10;
/// Triangles between two calls of `go_on`: some milliseconds of work.
const BATCH: usize = 1 << 12;

/// Pairs of triangles that intersect elsewhere than at a shared corner or edge.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Intersections {
    /// The triangles' numbers, the lower first, in ascending order; each pair once.
    pub pairs: Vec<[u32; 2]>,
    /// Whether pairs were left out because there are too many.
    pub has_more: bool,
}

/// Finds the triangles of a mesh that intersect: pass through one another, overlap in a plane, or touch. `None` if
/// cancelled. It takes some 100 bytes of memory a triangle.
///
/// Decided exactly on the stored coordinates. Vertices at one position count as one. Degenerate triangles, and
/// duplicates of a triangle with a lower number, are left out; [`check`](super::check) lists them. At most 131,072
/// pairs are listed, and at most 1,024 of one triangle with triangles of higher numbers.
pub fn self_intersections(mesh: &Mesh, go_on: GoOn<'_>) -> Option<Intersections> {
    let welded = weld(mesh.positions());
    let mut is_kept = vec![false; mesh.triangles().len()];
    for &number in mesh.kept() {
        is_kept[number as usize] = true;
    }
    let (mut faces, _) = faces(mesh, &welded);
    faces.retain(|(number, _)| is_kept[*number as usize]);
    if !go_on(0.05) {
        return None;
    }
    let corners = |index: u32| -> [Corner; 3] {
        let (_, places) = faces[index as usize];
        places.map(|place| (place, mesh.positions()[place as usize]))
    };
    let boxes = (0..faces.len() as u32).into_par_iter().map(|index| {
        let [a, b, c] = corners(index).map(|(_, point)| point);
        [a.min(b).min(c), a.max(b).max(c)]
    });
    let tree = BoxTree::new(boxes.collect());
    let mut found = Intersections::default();
    for start in (0..faces.len()).step_by(BATCH) {
        if !go_on(0.1 + 0.9 * start as f32 / faces.len() as f32) {
            return None;
        }
        let end = (start + BATCH).min(faces.len());
        let batch = (start as u32..end as u32).into_par_iter().map(|index| {
            let own = corners(index);
            let mut crossed = Vec::new();
            tree.later_overlaps(index, |other| {
                if crossed.len() <= MOST_OF_ONE && meet(&own, &corners(other)) {
                    crossed.push(other);
                }
            });
            // The tree visits boxes in an order of its own.
            crossed.sort_unstable();
            crossed
        });
        let batch: Vec<Vec<u32>> = batch.collect();
        for (index, crossed) in (start..).zip(batch) {
            found.has_more |= crossed.len() > MOST_OF_ONE;
            let number = |index: usize| faces[index].0;
            let crossed = crossed.into_iter().take(MOST_OF_ONE);
            let pairs = crossed.map(|other| [number(index), number(other as usize)]);
            found.pairs.extend(pairs);
        }
        if found.pairs.len() > MOST_PAIRS {
            found.pairs.truncate(MOST_PAIRS);
            found.has_more = true;
            break;
        }
    }
    go_on(1.0).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::scene::{MeshData, Shape};
    use glam::DVec3;

    fn found(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Intersections {
        let data = MeshData {
            positions,
            triangles,
            ..MeshData::default()
        };
        self_intersections(&Mesh::new(data), &|_| true).expect("it goes on")
    }

    fn shape(shape: Shape) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let data = shape.mesh().expect("a good shape");
        (data.positions, data.triangles)
    }

    /// Two balls in one mesh, their centres so far apart.
    fn two_balls(apart: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let (one, sides) = shape(Shape::Sphere {
            radius: 1.0,
            segments: 40,
            rings: 20,
        });
        let count = one.len() as u32;
        let other = one.iter().map(|p| *p + DVec3::new(apart, 0.125, 0.0625));
        let positions = one.iter().copied().chain(other).collect();
        let others = sides.iter().map(|side| side.map(|corner| corner + count));
        let triangles = sides.iter().copied().chain(others).collect();
        (positions, triangles)
    }

    #[test]
    fn closed_shapes_do_not_intersect_themselves() {
        for each in [
            Shape::Sphere {
                radius: 1.0,
                segments: 48,
                rings: 24,
            },
            Shape::Torus {
                radius: 1.0,
                tube: 0.25,
                segments: 48,
                rings: 24,
            },
        ] {
            let (positions, triangles) = shape(each);
            let found = found(positions, triangles);
            assert_eq!(found, Intersections::default(), "{each:?}");
        }
    }

    #[test]
    fn balls_intersect_where_they_overlap_and_not_where_they_are_apart() {
        let (positions, triangles) = two_balls(3.0);
        assert_eq!(found(positions, triangles), Intersections::default());
        let (positions, triangles) = two_balls(1.0);
        let half = triangles.len() as u32 / 2;
        let crossed = found(positions, triangles).pairs;
        assert!(crossed.len() > 50, "{}", crossed.len());
        assert!(crossed.iter().all(|[a, b]| *a < half && *b >= half));
        assert!(crossed.is_sorted());
    }

    #[test]
    fn the_tree_finds_the_pairs_that_brute_force_finds() {
        let mut random = Random(5);
        for count in [1, 2, 9, 64, 65, 500] {
            // Far and near triangles, some of which share corners.
            let places: Vec<_> = (0..count).map(|_| random.point() * 4.0).collect();
            let triangles: Vec<[u32; 3]> = (0..count)
                .map(|_| [0; 3].map(|_| (random.unit() * f64::from(count)) as u32))
                .collect();
            let mesh = Mesh::new(MeshData {
                positions: places.clone(),
                triangles: triangles.clone(),
                ..MeshData::default()
            });
            let corners = |number: u32| {
                let corners = mesh.triangles()[number as usize];
                corners.map(|corner| (corner, mesh.positions()[corner as usize]))
            };
            let same = |a: u32, b: u32| {
                let sorted = |number: u32| {
                    let mut corners = mesh.triangles()[number as usize];
                    corners.sort_unstable();
                    corners
                };
                sorted(a) == sorted(b)
            };
            let mut expected = Vec::new();
            for (i, &a) in mesh.kept().iter().enumerate() {
                let is_again = mesh.kept()[..i].iter().any(|&b| same(a, b));
                for &b in &mesh.kept()[i + 1..] {
                    if !is_again && !same(a, b) && meet(&corners(a), &corners(b)) {
                        expected.push([a, b]);
                    }
                }
            }
            expected.retain(|&[_, b]| !mesh.kept().iter().any(|&c| c < b && same(b, c)));
            assert_eq!(found(places, triangles).pairs, expected, "{count}");
        }
    }

    #[test]
    fn the_list_is_cut_at_its_limit_and_cancelling_gives_nothing() {
        // A fan of walls around one line: all of them intersect.
        let walls = 2000;
        let positions = (0..walls).flat_map(|i| {
            let (sin, cos) = crate::math::sin_cos(f64::from(i) * 1e-3);
            let side = DVec3::new(cos, sin, 0.0);
            [side + DVec3::Z, side - DVec3::Z, -side]
        });
        let triangles = (0..walls as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
        let (positions, triangles): (Vec<_>, Vec<_>) = (positions.collect(), triangles.collect());
        let many = found(positions.clone(), triangles.clone());
        assert!(many.has_more && many.pairs.len() == MOST_PAIRS);
        let mesh = Mesh::new(MeshData {
            positions,
            triangles,
            ..MeshData::default()
        });
        assert_eq!(self_intersections(&mesh, &|share| share < 0.05), None);
    }
}
