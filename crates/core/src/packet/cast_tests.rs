//! Packets against single rays, brute force and each other.

use crate::bvh::Accel;
use crate::camera::{Camera, ImagePlane, Lattice, Orbit, Pose, Projection, Rect};
use crate::hit::{Cull, Detail, HitNumbers, Precision, PrimitiveHit};
use crate::hits::Hits;
use crate::math;
use crate::num::simd::Simd;
use crate::random::Random;
use crate::scene::{Mesh, MeshData, Object, Scene};
use glam::DVec3;
use std::sync::Arc;

/// A wavy surface over a square, of `side²` quads.
pub(super) fn waves(side: u32, size: f64, offset: DVec3) -> Accel {
    build([waves_mesh(side, size, offset)])
}

pub(super) fn build(meshes: impl IntoIterator<Item = Mesh>) -> Accel {
    let objects = meshes
        .into_iter()
        .map(|mesh| Object::new("mesh", Arc::new(mesh)));
    let scene = Scene {
        objects: objects.collect(),
    };
    Accel::build(&scene).expect("a valid scene")
}

pub(super) fn waves_mesh(side: u32, size: f64, offset: DVec3) -> Mesh {
    grid(side, |x, y| {
        let (x, y) = (x / f64::from(side) - 0.5, y / f64::from(side) - 0.5);
        DVec3::new(x, 0.1 * math::sin(x * 20.0) * math::cos(y * 17.0), y) * size + offset
    })
}

/// `side²` quads of two triangles each, with corners at integer positions.
pub(super) fn grid(side: u32, place: impl Fn(f64, f64) -> DVec3) -> Mesh {
    let corners = (0..=side).flat_map(|y| (0..=side).map(move |x| (f64::from(x), f64::from(y))));
    let row = side + 1;
    let quads = (0..side * side).map(|cell| cell / side * row + cell % side);
    mesh(
        corners.map(|(x, y)| place(x, y)).collect(),
        quads
            .flat_map(|a| [[a, a + row, a + row + 1], [a, a + row + 1, a + 1]])
            .collect(),
    )
}

fn mesh(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh::new(MeshData {
        positions,
        triangles,
        ..MeshData::default()
    })
}

/// All rays of a camera.
fn whole(camera: Camera) -> Lattice {
    let plane = camera.plane();
    let rect = Rect {
        x: 0,
        y: 0,
        width: plane.columns,
        height: plane.rows,
    };
    camera.sub_camera(rect).lattice()
}

/// A camera that looks at `pivot` from the front, with 64 × 64 rays.
fn front(pivot: DVec3, distance: f64, step: f64, projection: Projection) -> Camera {
    let orbit = Orbit {
        pivot,
        yaw: 0.0,
        pitch: 0.0,
        distance,
    };
    let plane = ImagePlane::new(64, 64, step).expect("a good plane");
    Camera::new(orbit.pose(), projection, plane)
}

fn assert_tiles_equal_rays(accel: &Accel, camera: Camera) -> usize {
    let Lattice { columns, rows, .. } = whole(camera);
    let rect = Rect {
        x: 0,
        y: 0,
        width: columns,
        height: rows,
    };
    let mut hits = Vec::new();
    let mut hits_found = 0;
    for (stride, phase) in [(1, (0, 0)), (4, (2, 0))] {
        for cull in [Cull::None, Cull::Back] {
            let lattice = camera.sub_camera(rect).sparse_lattice(stride, phase);
            accel.cast_lattice(&lattice, cull, Precision::Exact, Detail::Full, &mut hits);
            assert_eq!(hits.len(), lattice.len());
            for (at, hit) in hits.iter().enumerate() {
                let (column, row) = (at as u32 % lattice.columns, at as u32 / lattice.columns);
                let expected =
                    accel.cast_primitive(&lattice.ray(column, row), cull, Precision::Exact);
                assert_eq!(*hit, expected, "{column} {row} {camera:?}");
                hits_found += usize::from(!hit.is_miss());
            }
            assert_numbers_alone_are_the_same(accel, &lattice, cull, &hits);
        }
    }
    hits_found
}

/// Where t alone is asked for, or u and v alone, they have the bits that they have among all.
fn assert_numbers_alone_are_the_same(
    accel: &Accel,
    lattice: &Lattice,
    cull: Cull,
    all: &[PrimitiveHit],
) {
    let all: Hits = all.iter().copied().collect();
    let alone = |numbers| {
        let mut hits = Hits {
            primitives: all.primitives.clone(),
            ..Hits::default()
        };
        accel.interpolate_numbers(lattice, cull, Precision::Exact, numbers, &mut hits);
        hits
    };
    assert_eq!(alone(HitNumbers::T).t, all.t);
    let weights = alone(HitNumbers::Weights);
    assert_eq!((weights.u, weights.v), (all.u, all.v));
}

pub(super) fn cameras(size: f64, offset: DVec3) -> Vec<Camera> {
    let mut cameras = Vec::new();
    for projection in [Projection::Perspective, Projection::Orthographic] {
        for (yaw, pitch, distance) in [
            (22.0, 16.0, 1.5),
            (0.0, 90.0, 1.0),
            (0.0, 0.0, 1.0),
            (130.0, -20.0, 0.6),
            (77.0, 3.0, 0.05),
        ] {
            let orbit = Orbit {
                pivot: offset,
                yaw,
                pitch,
                distance: distance * size,
            };
            let plane = ImagePlane::new(101, 75, 0.012 * size * distance).expect("a good plane");
            cameras.push(Camera::new(orbit.pose(), projection, plane));
        }
    }
    cameras
}

/// Compares packets with single rays from every camera at the scene around `offset`.
fn assert_views_equal_rays(accel: &Accel, size: f64, offset: DVec3) {
    let hits_found: usize = cameras(size, offset)
        .into_iter()
        .map(|camera| assert_tiles_equal_rays(accel, camera))
        .sum();
    assert!(hits_found > 50_000, "{hits_found}");
}

/// A picture of 32k + 1 columns and rows ends in packets of one column, one row and one ray.
#[test]
fn the_last_column_and_row_are_cast() {
    let accel = waves(12, 2.0, DVec3::ZERO);
    for side in [33, 65] {
        let plane = ImagePlane::new(side, side, 0.02).expect("a good plane");
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let orbit = Orbit {
                pivot: DVec3::ZERO,
                yaw: 30.0,
                pitch: 50.0,
                distance: 3.0,
            };
            let camera = Camera::new(orbit.pose(), projection, plane);
            let (columns, rows) = (side as usize, side as usize);
            let mut hits = Vec::new();
            let lattice = whole(camera);
            accel.cast_lattice(
                &lattice,
                Cull::None,
                Precision::Exact,
                Detail::Full,
                &mut hits,
            );
            let hits_found = |at: &usize| !hits[*at].is_miss();
            let in_column = (0..rows)
                .map(|row| row * columns + columns - 1)
                .filter(hits_found);
            let in_row = ((rows - 1) * columns..rows * columns).filter(hits_found);
            let (in_column, in_row) = (in_column.count(), in_row.count());
            assert!(in_column > 5 && in_row > 5, "{in_column} {in_row}");
            assert_tiles_equal_rays(&accel, camera);
        }
    }
}

#[test]
fn tiles_answer_as_single_rays_do() {
    for (size, offset) in [
        (1.0, DVec3::ZERO),
        (1e-12, DVec3::ZERO),
        (1e9, DVec3::ZERO),
        (30.0, DVec3::new(148376.0, 1234.0, -223423.0)),
    ] {
        let accel = waves(40, size, offset);
        assert_views_equal_rays(&accel, size, offset);
    }
}

#[test]
fn a_tree_of_one_leaf_is_cast_from_beyond_the_range_of_single_precision() {
    // Frusta overflow there: the box that fills a pair with one entry point may count as inside.
    let accel = waves(1, 2.0, DVec3::ZERO);
    for distance in [1e30, 1e40, 1e80, 1e120, 1e150] {
        for projection in [Projection::Perspective, Projection::Orthographic] {
            for step in [0.01, distance * 0.01] {
                let camera = front(DVec3::ZERO, distance, step, projection);
                assert_tiles_equal_rays(&accel, camera);
            }
        }
    }
}

#[test]
fn small_triangles_are_hit_as_single_rays_hit_them() {
    // From many rays a triangle to many triangles a ray; one layer, layers so close that the depths of their nearest
    // and furthest corners do not order them, or that nothing in single precision does, and layers that intersect.
    let apart = |gap: f64| DVec3::new(0.0, gap, 0.0);
    for layers in [
        vec![(0.0, 0)],
        vec![(0.0, 0), (1e-3, 0), (2e-3, 0)],
        vec![(0.0, 0), (1e-6, 0)],
        vec![(0.0, 0), (1e-7, 0)],
        vec![(0.0, 0), (2e-8, 0)],
        vec![(0.0, 0), (0.0, 0)],
        vec![(0.0, 0), (0.0, 1)],
    ] {
        for side in [60, 120, 200] {
            let mesh = |&(gap, more): &(f64, u32)| waves_mesh(side + more, 1.0, apart(gap));
            let accel = build(layers.iter().map(mesh));
            assert_views_equal_rays(&accel, 1.0, DVec3::ZERO);
        }
    }
}

#[test]
fn small_triangles_with_corners_on_rays_are_hit_as_single_rays_hit_them() {
    // Corners as close to rays as single precision allows, or a little further away; three corners of one row make
    // slivers. Every second triangle lies in the plane of the one before except for rounding.
    let mut random = Random(3);
    for aside in [0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2] {
        for camera in cameras(1.0, DVec3::ZERO) {
            let mut positions = Vec::new();
            for _ in 0..400 {
                let (x, y) = (100.0 * random.unit(), 74.0 * random.unit());
                let [a, b, c] = [(); 3].map(|()| {
                    let near = |at: f64, unit: f64| (at + 3.0 * unit).floor();
                    let (x, y) = (near(x, random.unit()), near(y, random.unit()));
                    let ray = camera.ray(x + aside * random.signed(), y + aside * random.signed());
                    ray.at(camera.distance() * (1.0 + 0.5 * random.signed()))
                });
                positions.extend([a, b, c]);
                positions.extend([(); 3].map(|()| {
                    let (u, v) = (random.signed(), random.signed());
                    a + (b - a) * (0.5 + u) + (c - a) * (0.5 + v)
                }));
            }
            let triangles = (0..800).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
            let hits_found = assert_tiles_equal_rays(&build([mesh(positions, triangles)]), camera);
            assert!(hits_found > 200, "{hits_found} {camera:?}");
        }
    }
}

#[test]
fn fast_pictures_that_avoid_vertices_are_the_exact_ones() {
    let accel = waves(40, 1.0, DVec3::ZERO);
    let (mut rays, mut wrong) = (0, 0);
    let slanted = |camera: &Camera| camera.forward().abs().min_element() > 0.01;
    for camera in cameras(1.0, DVec3::ZERO).into_iter().filter(slanted) {
        let mut lattice = whole(camera);
        // Moved so that the middle ray does not go through a vertex, as in ordinary pictures.
        lattice.offset = (0.3, 0.6);
        let cast = |precision| {
            let mut hits = Vec::new();
            accel.cast_lattice(&lattice, Cull::None, precision, Detail::Triangle, &mut hits);
            hits
        };
        let pairs = cast(Precision::Fast)
            .into_iter()
            .zip(cast(Precision::Exact));
        wrong += pairs
            .filter(|(fast, exact)| fast.primitive != exact.primitive)
            .count();
        rays += lattice.len();
    }
    assert!(rays > 40_000 && wrong == 0, "{wrong} of {rays}");
}

#[test]
fn lattices_aimed_at_vertices_are_decided_exactly() {
    // A flat grid of unit cells, and rays exactly through its vertices, edges and middles.
    let accel = build([grid(32, |x, y| DVec3::new(x, y, 0.0))]);
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let middle = DVec3::new(16.0, 16.0, 0.0);
        let mut lattice = whole(front(middle, 8.0, 0.5, projection));
        lattice.offset = (0.0, 0.0);
        let mut hits = Vec::new();
        accel.cast_lattice(
            &lattice,
            Cull::None,
            Precision::Exact,
            Detail::Full,
            &mut hits,
        );
        for (at, hit) in hits.iter().enumerate() {
            let ray = lattice.ray(at as u32 % 64, at as u32 / 64);
            assert_eq!(
                *hit,
                accel.cast_primitive(&ray, Cull::None, Precision::Exact)
            );
            assert_eq!(
                accel.cast(&ray, Cull::None),
                accel.cast_brute_force(&ray, Cull::None)
            );
            assert!(!hit.is_miss(), "a hole at ray {at}");
        }
    }
}

#[test]
fn occluded_triangles_need_not_be_ordered() {
    // Two triangles a rounding apart, and a third in front of both, in every order. The two are tilted towards the
    // eye, so that their near corners come first.
    let far = [
        DVec3::new(-4.0, -4.0, -2.0),
        DVec3::new(4.0, -4.0, -2.5),
        DVec3::new(0.25, 30.0, 14.0),
    ];
    // The same plane from another corner, so that rounded depths do not order them.
    let in_plane = far[0] + (far[0] - far[1]);
    let next = f64::from((in_plane.z as f32).next_up());
    let other = [in_plane.with_z(next), far[1], far[2]];
    let near = [
        DVec3::new(-9.0, -9.0, 3.0),
        DVec3::new(9.0, -9.0, 3.0),
        DVec3::new(0.0, 9.0, 3.0),
    ];
    let in_one_plane = [in_plane, far[1], far[2]];
    let triangles = [far, other, near, in_one_plane];
    let open = |shown: &[usize], precision: Precision| {
        let positions = shown.iter().flat_map(|&at| triangles[at]).collect();
        let numbers = (0..shown.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
        let accel = build([mesh(positions, numbers.collect())]);
        let lattice = whole(front(DVec3::ZERO, 20.0, 0.03, Projection::Perspective));
        let counts = accel.find_closest(&lattice, Cull::None, precision, &mut Vec::new());
        counts.double_rays + counts.exact_rays
    };
    for order in [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ] {
        let without: Vec<_> = order.into_iter().filter(|&at| at != 2).collect();
        // Fast casting does not order triangles by their planes.
        assert!(open(&without, Precision::Fast) > 500, "{order:?}");
        assert!(open(&order, Precision::Fast) < 10, "{order:?}");
        assert!(open(&without, Precision::Exact) < 10, "{order:?}");
    }
    // Triangles in exactly one plane are ordered once, not once a ray.
    assert!(open(&[0, 3], Precision::Exact) < 10);
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    let lattice = whole(cameras(1.0, DVec3::ZERO)[0]);
    let cast = |simd| {
        let mut hits = Vec::new();
        let accel = waves(40, 1.0, DVec3::ZERO).with_simd(simd);
        accel.cast_lattice(
            &lattice,
            Cull::None,
            Precision::Exact,
            Detail::Full,
            &mut hits,
        );
        hits
    };
    let plain = cast(Simd::Plain);
    assert_eq!(plain, cast(Simd::Avx2));
}

/// Layers of triangles some units in the last place apart, that cross one another; seen from all sides, from next to a
/// corner that all have, and with coordinates that are zero but for subnormal numbers. With the order of planes exchanged,
/// or cells taken for occluded by a triangle that does not cover them, this fails; and without that order, or with one
/// scale for all edges of a triangle with a corner next to the eye, rays are left undecided.
#[test]
fn layers_a_rounding_apart_are_ordered_as_single_rays_order_them() {
    let mut random = Random(75);
    let base = [
        DVec3::new(-1.0, -1.0, 0.1),
        DVec3::new(1.1, -1.0, 0.2),
        DVec3::new(0.1, 1.2, 0.3),
    ];
    for (flat, tilt) in [(false, 0.0), (false, 0.3), (true, 0.0)] {
        let mut jitter = |x: f64| {
            let steps = (random.signed() * 4.0).round() as i32;
            let step = |x: f32| {
                if steps < 0 {
                    x.next_down()
                } else {
                    x.next_up()
                }
            };
            (0..steps.abs()).fold(x as f32, |x, _| step(x)).into()
        };
        let layers: Vec<DVec3> = (0..300)
            .flat_map(|_| base)
            .map(|corner| {
                let corner = DVec3::new(corner.x + tilt * corner.z, corner.y, corner.z);
                let corner = if flat { corner.with_z(0.0) } else { corner };
                DVec3::from_array(corner.to_array().map(&mut jitter))
            })
            .collect();
        let triangles = (0..300).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let accel = build([mesh(layers, triangles)]);
        let (mut hits, mut most_shown) = (0, 0);
        for projection in [Projection::Perspective, Projection::Orthographic] {
            for (eye, target) in [
                (DVec3::new(0.0, 0.0, 3.0), DVec3::ZERO),
                (DVec3::new(2.0, 1.0, -1.5), DVec3::new(0.0, 0.0, 0.2)),
                // Next to the first corner.
                (base[0] + DVec3::new(1e-6, 2e-6, 1e-5), base[0] - DVec3::Z),
            ] {
                let up = DVec3::Y;
                let distance = eye.distance(target);
                let plane = ImagePlane::new(70, 50, 0.03 * distance).expect("a good plane");
                let camera = Camera::new(Pose { eye, target, up }, projection, plane);
                hits += assert_tiles_equal_rays(&accel, camera);
                let mut found = Vec::new();
                let counts =
                    accel.find_closest(&whole(camera), Cull::None, Precision::Exact, &mut found);
                let undecided = counts.double_rays + counts.exact_rays;
                assert!(undecided <= 40, "{counts:?} {camera:?}");
                found.sort_unstable();
                found.dedup();
                most_shown = most_shown.max(found.len());
            }
        }
        assert!(hits > 1500 && most_shown > 2, "{hits} {most_shown}");
    }
}

/// Rays that hit as many triangles of one plane, or of layers closer together than single precision distinguishes, as
/// there are: packets order all of them, and leave few rays to be cast one by one.
#[test]
fn triangles_in_or_next_to_one_plane_are_ordered_by_packets() {
    let mut random = Random(61);
    // Integer corners, that rays go exactly through.
    let integer = |random: &mut Random| (random.point() * 8.0).round().with_z(0.0);
    let tilted = |random: &mut Random| {
        let at = random.point() * 8.0;
        at.with_z(0.37 * at.x + 0.21 * at.y)
    };
    let subnormal = |random: &mut Random| {
        let at = random.point() * 8.0;
        at.with_z((at.z * 2000.0).round() * f64::from(f32::from_bits(1)))
    };
    type Corner = fn(&mut Random) -> DVec3;
    let planes: [(Corner, _); 3] = [(integer, 1000), (tilted, 20), (subnormal, 20)];
    for (corner, most_undecided) in planes {
        let count = 400;
        // One in four is small.
        let positions = (0..count).flat_map(|triangle| {
            let [a, b, c] = [(); 3].map(|()| corner(&mut random));
            let size = if triangle % 4 == 0 { 0.25 } else { 1.0 };
            [a, a + (b - a) * size, a + (c - a) * size]
        });
        let positions: Vec<_> = positions.collect();
        let triangles = (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let accel = build([mesh(positions, triangles)]);
        // The last rays start between the triangles.
        for (projection, distance) in [
            (Projection::Perspective, 16.0),
            (Projection::Orthographic, 16.0),
            (Projection::Orthographic, 1.0),
            (Projection::Orthographic, 1e-42),
        ] {
            let camera = front(DVec3::new(0.5, 0.5, 0.0), distance, 0.25, projection);
            assert_tiles_equal_rays(&accel, camera);
            let mut primitives = Vec::new();
            let lattice = whole(camera);
            let counts =
                accel.find_closest(&lattice, Cull::None, Precision::Exact, &mut primitives);
            let undecided = counts.double_rays + counts.exact_rays;
            assert!(
                counts.hits > 1500,
                "{projection:?} {distance}: {}",
                counts.hits
            );
            if distance == 16.0 {
                assert!(undecided < most_undecided, "{projection:?}: {undecided}");
            }
        }
    }
}

/// Parallel rays far from the world's origin, at triangles next to the tree's: their origins are rounded by more than rays
/// are apart, and the planes that bound them must allow for it. They see triangles whose plane they all but follow.
#[test]
fn parallel_rays_that_start_beside_their_places_are_not_lost() {
    let mut random = Random(63);
    let mut hits_found = 0;
    for round in 0..300 {
        let mut corner = || DVec3::new(-3e8, -1e9 * random.unit(), -1e9 * random.unit());
        let positions = vec![corner(), corner(), corner()];
        let pose = Pose {
            eye: DVec3::new(-3e8 - 2.8e-6, -3e8, -1e8),
            target: positions[0],
            up: DVec3::Y,
        };
        let accel = build([mesh(positions, vec![[0, 1, 2]])]);
        let plane = ImagePlane::new(64, 64, 1e-9).expect("a good plane");
        let camera = Camera::new(pose, Projection::Orthographic, plane);
        // Right of the middle, or left of it, and above.
        let rect = Rect {
            x: [33, 10][round % 2],
            y: 3,
            width: 20,
            height: 15,
        };
        let lattice = camera.sub_camera(rect).lattice();
        let mut primitives = Vec::new();
        accel.find_closest(&lattice, Cull::None, Precision::Exact, &mut primitives);
        for (at, &primitive) in (0..).zip(&primitives) {
            let ray = lattice.ray(at % lattice.columns, at / lattice.columns);
            let expected = accel.cast_primitive(&ray, Cull::None, Precision::Exact);
            assert_eq!(primitive, expected.primitive, "{round} {at}");
            hits_found += u32::from(!expected.is_miss());
        }
    }
    assert!(hits_found > 300, "{hits_found}");
}
