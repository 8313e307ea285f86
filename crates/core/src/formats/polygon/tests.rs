//! The truth: with integer coordinates, areas are exact. Triangles of the face's orientation, made of its corners,
//! whose areas sum to the face's area, cover it exactly once.

use super::*;
use crate::math;
use crate::random::Random;
use glam::{DVec3, Vec3};
use std::time::{Duration, Instant};

type Corner = (i64, i64);

/// Twice the signed area of a closed polyline.
fn area(corners: &[Corner]) -> i128 {
    let next = corners.iter().cycle().skip(1);
    corners
        .iter()
        .zip(next)
        .map(|(a, b)| i128::from(a.0) * i128::from(b.1) - i128::from(b.0) * i128::from(a.1))
        .sum()
}

/// The face in each of the three coordinate planes, seen from both sides.
fn placed(corners: &[Corner]) -> Vec<Vec<Vec3>> {
    let place = |plane: usize, mirrored: bool| {
        let corner = |&(x, y): &Corner| {
            let (x, y) = (x as f32, y as f32);
            let x = if mirrored { -x } else { x };
            match plane {
                0 => Vec3::new(0.5 * x, x, y),
                1 => Vec3::new(y, 7.0, x),
                _ => Vec3::new(x, y, 0.25 * y - 3.0),
            }
        };
        corners.iter().map(corner).collect()
    };
    (0..6).map(|i| place(i / 2, i % 2 == 1)).collect()
}

fn decided(corners: &[Corner]) -> (Cut, Vec<[u32; 3]>) {
    let mut cutter = Cutter::default();
    let flat: Vec<Vec3> = corners
        .iter()
        .map(|&(x, y)| Vec3::new(x as f32, y as f32, 0.0))
        .collect();
    let cut = cutter.cut(&flat);
    (cut, cutter.ears)
}

/// Checks that a face is covered in all positions and with each corner as the first.
fn covers(corners: &[Corner]) {
    let whole = area(corners);
    let mut cutter = Cutter::default();
    for start in 0..corners.len().min(12) {
        let mut turned = corners.to_vec();
        turned.rotate_left(start);
        for placed in placed(&turned) {
            let fan: Vec<[u32; 3]> = (1..turned.len() as u32 - 1)
                .map(|i| [0, i, i + 1])
                .collect();
            let triangles = match cutter.cut(&placed) {
                Cut::Fan => &fan,
                Cut::Ears => &cutter.ears,
                other => panic!("{other:?} from {start}: {turned:?}"),
            };
            assert_eq!(triangles.len(), turned.len() - 2);
            let mut sum = 0;
            for triangle in triangles {
                let area = area(&triangle.map(|i| turned[i as usize]));
                assert!(
                    area.signum() * whole.signum() >= 0,
                    "{triangle:?} of {turned:?}"
                );
                sum += area;
            }
            assert_eq!(sum, whole, "{turned:?}");
        }
    }
}

/// The truth is the faces themselves: the edges that are not diagonals are the faces' edges, each once.
#[test]
fn edges_that_are_not_diagonals_are_the_faces_edges() {
    let faces: [&[Corner]; 4] = [
        &[(0, 0), (4, 0), (0, 4)],
        &[(0, 0), (1, 0), (1, 1), (0, 1)],
        &[(2, 0), (2, 1), (1, 1), (1, 3), (0, 3), (0, 0)],
        // A comb.
        &[
            (0, 0),
            (9, 0),
            (9, 5),
            (7, 1),
            (5, 6),
            (3, 1),
            (1, 7),
            (0, 2),
        ],
    ];
    let mut mesh = MeshData::default();
    let mut polygons = Vec::new();
    let mut expected = Vec::new();
    for face in faces {
        let first = mesh.positions.len() as u32;
        let place = |&(x, y): &Corner| DVec3::new(x as f64, y as f64, 0.0);
        mesh.positions.extend(face.iter().map(place));
        let count = face.len() as u32;
        expected.extend((0..count).map(|i| [first + i, first + (i + 1) % count]));
        if count > 3 {
            polygons.push(Polygon {
                first: mesh.triangles.len() as u32,
                triangles: count - 2,
            });
        }
        let fan = 1..count - 1;
        mesh.triangles
            .extend(fan.map(|i| [first, first + i, first + i + 1]));
    }
    assert_eq!(cut(&mut mesh, &polygons), Uncut::default());
    let mut found = Vec::new();
    for (number, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        let is_diagonal = mesh.diagonals.on(number as u32);
        let edges = [[a, b], [b, c], [c, a]].into_iter().zip(is_diagonal);
        found.extend(edges.filter(|(_, is)| !is).map(|(edge, _)| edge));
    }
    found.sort_unstable();
    expected.sort_unstable();
    assert_eq!(found, expected);
}

#[test]
fn an_l_shape_is_covered_exactly_once() {
    let l = [(2, 0), (2, 1), (1, 1), (1, 3), (0, 3), (0, 0)];
    covers(&l);
    assert_eq!(decided(&l).0, Cut::Ears);
    let fan_from_the_notch = [(1, 1), (1, 3), (0, 3), (0, 0), (2, 0), (2, 1)];
    assert_eq!(decided(&fan_from_the_notch).0, Cut::Fan);
}

#[test]
fn fans_stay_where_they_are_right() {
    for convex in [
        &[(0, 0), (1, 0), (1, 1), (0, 1)][..],
        &[(0, 0), (4, 0), (6, 2), (4, 5), (1, 4)],
        // A dart, from its reflex corner.
        &[(0, 0), (3, -1), (0, 5), (-3, -1)],
    ] {
        assert_eq!(decided(convex).0, Cut::Fan);
        covers(convex);
    }
    assert_eq!(decided(&[(3, -1), (0, 5), (-3, -1), (0, 0)]).0, Cut::Ears);
}

#[test]
fn faces_with_coincident_corners_and_corners_on_edges_are_covered() {
    // A square with every edge halved.
    covers(&[
        (0, 0),
        (1, 0),
        (2, 0),
        (2, 1),
        (2, 2),
        (1, 2),
        (0, 2),
        (0, 1),
    ]);
    // Quads with coincident or collinear corners.
    covers(&[(0, 0), (2, 0), (2, 0), (0, 2)]);
    covers(&[(0, 0), (0, 0), (2, 0), (0, 2)]);
    covers(&[(0, 0), (1, 0), (2, 0), (0, 2)]);
    // A spike.
    covers(&[(0, 0), (4, 0), (4, 4), (2, 4), (2, 7), (2, 4), (0, 4)]);
    // A square hole, connected to the outside by an edge in both directions.
    covers(&[
        (0, 0),
        (9, 0),
        (9, 9),
        (0, 9),
        (0, 0),
        (3, 3),
        (3, 6),
        (6, 6),
        (6, 3),
        (3, 3),
    ]);
    // Two squares that touch at a corner.
    covers(&[
        (0, 0),
        (2, 0),
        (2, 2),
        (4, 2),
        (4, 4),
        (2, 4),
        (2, 2),
        (0, 2),
    ]);
}

#[test]
fn random_faces_are_covered() {
    let mut random = Random(1);
    let mut below = |count: i64| (random.unit() * count as f64) as i64;
    for round in 0..300 {
        let count = 4 + below(40) as usize;
        // Star-shaped around the centre: corners at ascending angles.
        let star: Vec<Corner> = (0..count)
            .map(|i| {
                let angle = std::f64::consts::TAU * i as f64 / count as f64;
                let length = 10.0 + below(1000) as f64;
                (
                    (math::cos(angle) * length) as i64,
                    (math::sin(angle) * length) as i64,
                )
            })
            .collect();
        // Columns of random heights side by side, above and below.
        let mut skyline: Vec<Corner> = Vec::new();
        let mut x = 0;
        for _ in 0..count / 2 {
            let (y, width) = (1 + below(9), 1 + below(3));
            skyline.extend([(x, y), (x + width, y)]);
            x += width;
        }
        for _ in 0..count / 2 {
            let (y, width) = (-below(9), 1 + below(3));
            let end = (x - width).max(0);
            skyline.extend([(x, y), (end, y)]);
            x = end;
        }
        skyline.extend([(x, 0), (0, 0)]);
        let is_simple = decided(&star).0 != Cut::Crossing;
        if is_simple && area(&star) != 0 {
            covers(&star);
        }
        covers(&skyline);
        assert!(round > 0 || is_simple);
    }
}

#[test]
fn faces_that_cross_themselves_are_counted() {
    let bow_tie = [(0, 0), (2, 2), (2, 0), (0, 2)];
    assert_eq!(decided(&bow_tie).0, Cut::Crossing);
    // Seven corners, twice around: every triangle of the fan has the same orientation.
    let twice: Vec<Corner> = (0..7)
        .map(|i| {
            let angle = std::f64::consts::TAU * f64::from(2 * i) / 7.0;
            (
                (math::cos(angle) * 1000.0) as i64,
                (math::sin(angle) * 1000.0) as i64,
            )
        })
        .collect();
    assert_eq!(decided(&twice).0, Cut::Crossing);
    let on_a_line = [(0, 0), (1, 1), (2, 2), (3, 3), (1, 1)];
    assert_eq!(decided(&on_a_line).0, Cut::Ears);
}

/// A corner on an edge, or a unit in the last place beside it on either side.
#[test]
fn the_last_bit_decides() {
    let above = f32::from_bits(1f32.to_bits() + 1);
    let below = f32::from_bits(1f32.to_bits() - 1);
    for (y, expected) in [(above, Cut::Fan), (below, Cut::Crossing), (1.0, Cut::Ears)] {
        let corners = [(0.0, 0.0), (3.0, 3.0), (1.0, y), (0.0, 3.0)];
        let corners = corners.map(|(x, y)| Vec3::new(x, y, 5.0));
        assert_eq!(Cutter::default().cut(&corners), expected, "{y}");
    }
}

/// Curves of a hundred thousand corners of any shape take a moment.
#[test]
fn many_corners_take_a_moment() {
    const COUNT: i64 = 50_000;
    let comb = (0..COUNT).flat_map(|i| [(4 * i, 0), (4 * i + 2, 1000)]);
    let comb: Vec<Corner> = comb.chain([(4 * COUNT, -5), (0, -5)]).collect();
    let spiral: Vec<Corner> = {
        let arm = |turn: f64, out: f64| {
            let length = 50.0 * turn + out;
            (
                (math::sin(turn) * length * 1.0) as i64,
                (math::cos(turn) * length * 1.0) as i64,
            )
        };
        let turn = |i: i64| 10.0 + i as f64 * 0.01;
        let inner = (0..COUNT).map(|i| arm(turn(i), 0.0));
        let outer = (0..COUNT).rev().map(|i| arm(turn(i), 100.0));
        inner.chain(outer).collect()
    };
    // Slanted teeth: every edge lies in the boxes of thousands.
    let slanted = (0..COUNT).flat_map(|i| [(4 * i, 0), (4 * i + 300_001, 700_000)]);
    let slanted: Vec<Corner> = slanted.chain([(4 * COUNT, -5), (0, -5)]).collect();
    let mut random = Random(2);
    let mut below = |count: i64| (random.unit() * count as f64) as i64;
    let scribble: Vec<Corner> = (0..2 * COUNT)
        .map(|_| (below(1 << 20), below(1 << 20)))
        .collect();
    for (name, face, expected) in [
        ("comb", comb, Some(Cut::Ears)),
        ("spiral", spiral, Some(Cut::Ears)),
        ("slanted", slanted, None),
        ("scribble", scribble, Some(Cut::Crossing)),
    ] {
        let started = Instant::now();
        let (cut, ears) = decided(&face);
        let took = started.elapsed();
        assert!(
            took < Duration::from_secs(20),
            "{name}: {cut:?} after {took:?}"
        );
        assert!(
            expected.is_none_or(|expected| cut == expected),
            "{name}: {cut:?}"
        );
        if cut == Cut::Ears {
            let sum: i128 = ears
                .iter()
                .map(|ear| area(&ear.map(|i| face[i as usize])).abs())
                .sum();
            assert_eq!(sum, area(&face).abs(), "{name}");
        }
    }
}

#[test]
fn positions_and_attributes_are_cut_alike() {
    use crate::scene::Attribute;
    let base = DVec3::new(1e7, 0.0, 0.0);
    let l = [(2, 0), (2, 1), (1, 1), (1, 3), (0, 3), (0, 0)];
    let fan = |first: u32| (1..5).map(move |i| [first, first + i, first + i + 1]);
    let mut mesh = MeshData {
        positions: l
            .iter()
            .map(|&(x, y)| base + DVec3::new(f64::from(x), f64::from(y), 0.0))
            .collect(),
        triangles: fan(0).chain([[0, 1, 2]]).collect(),
        uvs: Some(Attribute {
            values: vec![glam::Vec2::ZERO; 20],
            indices: Some(fan(10).chain([[u32::MAX; 3]]).collect()),
        }),
        ..MeshData::default()
    };
    let polygon = Polygon {
        first: 0,
        triangles: 4,
    };
    assert_eq!(cut(&mut mesh, &[polygon]), Uncut::default());
    let uvs = mesh.uvs.as_ref().and_then(|uvs| uvs.indices.as_ref());
    let shifted: Vec<_> = mesh.triangles[..4]
        .iter()
        .map(|triangle| triangle.map(|i| i + 10))
        .collect();
    assert_eq!(uvs.map(|uvs| &uvs[..4]), Some(&shifted[..]));
    assert_eq!(mesh.triangles[4], [0, 1, 2]);
    assert_ne!(mesh.triangles[..4], fan(0).collect::<Vec<_>>());
    // A corner that is not finite: the fan stays.
    mesh.triangles.splice(..4, fan(0));
    mesh.positions[3].y = f64::NAN;
    cut(&mut mesh, &[polygon]);
    assert_eq!(mesh.triangles[..4], fan(0).collect::<Vec<_>>());
}
