//! Planes that pass the eye more closely than roundings in double precision, and planes that parallel rays run along except
//! for rounding: packets find what single rays find, and leave few rays to them.

use super::CastCounts;
use super::around_tests::accel;
use crate::bvh::Accel;
use crate::camera::{Camera, ImagePlane, Panorama, Pose, Projection};
use crate::hit::{Cull, MISS, Precision};
use crate::random::Random;
use glam::DVec3;

/// The least positive number of single precision.
fn least() -> f64 {
    f64::from(f32::from_bits(1))
}

pub(super) fn camera(
    eye: DVec3,
    towards: DVec3,
    projection: Projection,
    plane: ImagePlane,
) -> Camera {
    let target = eye + towards;
    let up = towards.any_orthonormal_vector();
    Camera::new(Pose { eye, target, up }, projection, plane)
}

/// Casts 48 × 40 rays; returns how many hit something, and how many were left to single rays.
fn check(accel: &Accel, eye: DVec3, towards: DVec3, projection: Projection) -> (usize, u64) {
    let plane = ImagePlane::new(48, 40, 0.02).expect("a good plane");
    let (hits, counts) = check_from(accel, &camera(eye, towards, projection, plane));
    (hits, counts.double_rays + counts.exact_rays)
}

/// Casts a camera's rays; returns how many hit something.
pub(super) fn check_from(accel: &Accel, camera: &Camera) -> (usize, CastCounts) {
    check_faces(accel, camera, Cull::None)
}

/// The same for some faces.
pub(super) fn check_faces(accel: &Accel, camera: &Camera, cull: Cull) -> (usize, CastCounts) {
    let lattice = camera.whole().lattice();
    let mut primitives = Vec::new();
    let counts = accel.find_closest(&lattice, cull, Precision::Exact, &mut primitives);
    for (at, &primitive) in primitives.iter().enumerate() {
        let ray = lattice.ray(at as u32 % lattice.columns, at as u32 / lattice.columns);
        let truth = accel.cast_primitive(&ray, cull, Precision::Exact);
        assert_eq!(primitive, truth.primitive, "{ray:?}");
    }
    let hits = primitives.iter().filter(|&&primitive| primitive != MISS);
    (hits.count(), counts)
}

/// Triangles of the plane z = x with corners on a grid, of which many have a corner or an edge below the eye.
#[test]
fn a_plane_within_rounding_of_the_eye_is_seen_from_it() {
    let mut random = Random(96);
    let mut corner = || {
        let [x, y] = [(); 2].map(|()| (random.signed() * 4.0).round());
        DVec3::new(x, y, x)
    };
    let accel = accel((0..400).map(|_| [corner(), corner(), corner()]).collect());
    for (corner, above) in [
        (DVec3::ZERO, 2.0 * least()),
        (DVec3::ZERO, 1e-30),
        (DVec3::new(1.0, 2.0, 1.0), f64::EPSILON),
        (DVec3::new(0.5, 0.25, 0.5), f64::EPSILON),
    ] {
        let eye = corner + DVec3::Z * above;
        let towards = DVec3::new(0.25, -0.5, -1.0);
        let (hits, undecided) = check(&accel, eye, towards, Projection::Perspective);
        assert!(hits > 1500 && undecided < 300, "{eye}: {hits} {undecided}");
    }
}

/// A fan of triangles, and layers of them, with a corner next to the eye.
#[test]
fn triangles_with_a_corner_next_to_the_eye_are_seen_from_it() {
    let mut random = Random(97);
    let fan = (0..300).map(|_| [DVec3::ZERO, random.point(), random.point()]);
    let fan: Vec<[DVec3; 3]> = fan.collect();
    let layers = (0..300).map(|layer| {
        let corner = |turn: f64| {
            let (sin, cos) = crate::math::sin_cos(turn);
            DVec3::new(cos, sin, f64::from(layer) * 1e-12)
        };
        let turn = f64::from(layer % 3) * std::f64::consts::TAU / 3.0;
        [
            corner(turn),
            corner(turn + std::f64::consts::TAU / 3.0),
            DVec3::ZERO,
        ]
    });
    for (corners, towards) in [(fan, DVec3::X), (layers.collect(), DVec3::NEG_Z)] {
        let accel = accel(corners);
        for above in [least(), 3.0 * least(), 1e-30] {
            let eye = DVec3::Z * above;
            let (hits, undecided) = check(&accel, eye, towards, Projection::Perspective);
            assert!(
                hits > 1000 && undecided < 200,
                "{above}: {hits} {undecided}"
            );
        }
    }
}

/// The pages of a book, seen along its spine: only rays next to a page's line may hit it.
#[test]
fn planes_along_parallel_rays_leave_few_of_them_undecided() {
    let mut random = Random(98);
    let spine = [random.point(), random.point()].map(|end| end.as_vec3().as_dvec3());
    let accel = accel(
        (0..300)
            .map(|_| [spine[0], spine[1], random.point()])
            .collect(),
    );
    let towards = spine[1] - spine[0];
    let (_, undecided) = check(
        &accel,
        spine[0] - towards,
        towards,
        Projection::Orthographic,
    );
    assert!(undecided < 200, "{undecided}");
}

/// Hundreds of layers closer together than single precision distinguishes depths, across the view, seen from beside them and
/// from between them: keys are relative to the plane of one. Without that, orders of pairs decide thousands of rows.
#[test]
fn layers_within_the_roundings_of_their_depths_are_distinguished() {
    let mut random = Random(99);
    let (across, along) = (DVec3::new(1.0, 0.3, -0.5), DVec3::new(-0.2, 1.0, 0.4));
    let normal = across.cross(along);
    for (apart, tilted) in [(1e-7, 0.0), (1e-6, 0.0), (1e-6, 1e-6)] {
        let mut layer = || {
            let off = apart * random.unit();
            [(); 3].map(|()| {
                let [x, y] = [(); 2].map(|()| random.signed() * 2.0);
                across * x + along * y + normal * (off + tilted * x)
            })
        };
        let accel = accel((0..400).map(|_| layer()).collect());
        for (eye, towards) in [
            (normal * 2.0 + across, -normal - across * 0.5),
            (normal * apart * 0.5, normal * 0.2 - across),
        ] {
            for projection in [
                Projection::Perspective,
                Projection::Orthographic,
                Projection::Panoramic(Panorama::Equirectangular),
            ] {
                let (hits, undecided) = check(&accel, eye, towards, projection);
                assert!(hits > 100, "{apart} {projection:?}: {hits}");
                assert!(undecided < 200, "{apart} {projection:?}: {undecided}");
            }
        }
    }
}

/// Layers that cover cells, and others that have a corner on one ray and hit no other: that ray stays undecided between them,
/// also where a layer is nearer than all that the other rays of its cell hit. If it counts as decided, this fails.
#[test]
fn corners_of_layers_on_rays_are_seen_among_larger_layers() {
    let mut random = Random(100);
    // The last cells of rows and columns are not full.
    let plane = ImagePlane::new(45, 37, 1.0 / 32.0).expect("a good plane");
    let camera = camera(DVec3::Z, DVec3::NEG_Z, Projection::Orthographic, plane);
    let lattice = camera.whole().lattice();
    for apart in [1e-40, 1e-40, 1e-40, 1e-10, 1e-8, 1e-8] {
        let layer = |random: &mut Random, [x, y]: [f64; 2], size: f64| {
            let off = (random.unit() * 1000.0).round() * apart;
            [(0.0, 0.0), (2.0, 1.0), (1.0, 2.0)]
                .map(|(s, t)| DVec3::new(x + s * size, y + t * size, off))
        };
        let mut layers = vec![layer(&mut random, [-30.0, -30.0], 30.0)];
        for _ in 0..1000 {
            let [column, row] = [lattice.columns, lattice.rows]
                .map(|rays| (random.unit() * f64::from(rays)) as u32);
            let on = lattice.ray(column, row).origin;
            layers.push(layer(&mut random, [on.x, on.y], 0.01));
            layers.push(layer(&mut random, [on.x - 1.0, on.y - 1.0], 1.0));
        }
        let (hits, _) = check_from(&accel(layers), &camera);
        assert_eq!(hits, lattice.len());
    }
}
