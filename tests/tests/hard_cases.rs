//! Places where known ray casters go wrong (`raycast_report::cases`), in every way of casting: one
//! ray and tiles, each instruction set of the machine, exact and fast, perspective and orthographic.
//!
//! How the truth is known: rational arithmetic on the stored vertices (`raycast-oracle`), and for a
//! closed surface that no ray may pass. Tests that cast no rays are below the list.
//!
//! Counts are such that the whole suite runs in minutes. `RAYCAST_LONG_RAYS=1000000000 cargo test
//! --release -p raycast-tests --test hard_cases leaves -- --nocapture` casts as many rays of cameras
//! inside of closed surfaces, and a hundredth as many single rays at each: a minute or two.

#![allow(
    clippy::print_stdout,
    reason = "tests report what they checked and what they skipped"
)]

use raycast_core::camera::{Lattice, Projection, Ray};
use raycast_core::glam::DVec3;
use raycast_core::{Accel, Cull, Precision};
use raycast_oracle::random::Random;
use raycast_report::cameras::{PROJECTIONS, camera, whole};
use raycast_report::cases::{self, Case, Setting};
use raycast_report::meshes::{self, mesh, soup};
use raycast_report::stage::scene_of;
use raycast_report::subject;
use raycast_tests::check::{Check, Stage, part};
use rayon::prelude::*;

/// Rays a case, its variants together; the cameras' come on top.
const RAYS: usize = 6_000;
/// Rays a case that brute force answers too, each triangle counted.
const BRUTE: usize = 2_000_000;
/// Rays a camera that are compared with the oracle, and not only with the single ray.
const TRUTHS: usize = 300;

const UNIT: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

/// How many of a case's rays fast casting answers otherwise than the truth. No other case has any.
const FAST_IS_WRONG: &[(&str, usize)] = &[
    ("far_sphere_corners", 1),
    ("eye_on_the_surface", 244),
    ("quads_in_one_place", 271),
    ("four_triangles", 2),
    ("powers_of_two", 1029),
    ("origins_beyond_the_scene", 1920),
    ("next_to_what_is_stored_far_away", 1026),
    ("no_area", 348),
    ("random_bits", 213),
];

macro_rules! cases {
    ($($name:ident)*) => {
        $(#[test] fn $name() { check(stringify!($name)); })*
        const TESTED: &[&str] = &[$(stringify!($name)),*];
    };
}

cases! {
    far_sphere far_sphere_corners far_plane common_edge integer_heights octahedron horizon
    small_distant_fan
    negative_zeros in_the_plane_of_a_face eye_on_the_surface quads_in_one_place four_triangles
    directions_of_any_length powers_of_two coordinates_to_1e18 origins_beyond_the_scene
    half_a_trillion grazed_sliver small_thing_on_vast_ground ten_million_away
    next_to_what_is_stored_far_away close_planes
    feet_to_horizon
    no_area random_bits one_bad_vertex rays_that_are_none few_triangles copies
    random_soups culled_sphere alternating_fronts unit_triangle
    smaller_than_a_pixel changing_density around_the_eye edge_on corners_on_pixel_centres
    edges_through_cell_corners slivers_along_rows surfaces_on_one_another crossing_layers
    fan_on_a_pixel ends_of_the_range narrow_and_wide narrower_than_rounding
    eye_at_a_cones_apex eye_at_a_vertex_of_many eye_on_an_edge_of_many eye_in_planes_of_many
    eye_next_to_a_vertex_of_many coincident_triangles copies_of_a_mesh exponents_of_any_size
    eye_among_triangles_of_any_size thin_boxes_behind_one_another tiny_and_far rays_closer_than_roundings
    rays_roundings_apart_at_an_edge triangles_about_a_corner_from_far_away
    part_of_a_scene_from_far_away layers_in_one_plane layers_a_rounding_apart layers_apart_by_subnormal_numbers eye_next_to_a_corner_of_layers
    eye_at_a_vertex_of_thousands_far_from_the_origin eye_between_layers
    eye_a_subnormal_number_from_planes rays_through_edges_of_one_plane
    triangles_of_a_rounded_plane layers_that_cross_by_subnormal_numbers
    rays_that_start_in_a_plane eye_next_to_a_vertex_of_thousands eye_next_to_a_vertex_of_layers
    eye_next_to_thousands_of_one_plane eye_in_a_needle eye_in_a_flat_disc
    layers_of_a_tilted_plane_apart_by_subnormal_numbers eye_next_to_layers_of_a_tilted_plane
}

#[test]
fn every_case_is_tested() {
    let names: Vec<&str> = cases::all().iter().map(|case| case.name).collect();
    assert_eq!(names, TESTED);
}

/// What a case came to.
#[derive(Default)]
struct Sum {
    rays: usize,
    hits: usize,
    camera_rays: usize,
    camera_hits: usize,
    fast_is_wrong: usize,
}

fn check(name: &str) {
    let case = cases::find(name).expect("a case in the list");
    let mut sum = Sum::default();
    for variant in 0..case.variants {
        // Shown only where it fails: which one it was.
        println!("{name}, variant {variant}");
        check_setting(&case, variant, (case.setting)(variant), &mut sum);
    }
    let Sum {
        rays,
        hits,
        camera_rays,
        camera_hits,
        fast_is_wrong,
    } = sum;
    println!(
        "{name}: {hits} of {rays} rays and {camera_hits} of {camera_rays} rays of cameras hit, none wrong; fast: {fast_is_wrong} wrong"
    );
    assert!(hits + camera_hits > 0, "nothing was hit");
    let expected = FAST_IS_WRONG.iter().find(|(case, _)| *case == name);
    assert_eq!(fast_is_wrong, expected.map_or(0, |(_, count)| *count));
}

fn check_setting(case: &Case, variant: u32, setting: Setting, sum: &mut Sum) {
    let rays = setting.rays(RAYS / case.variants as usize, u64::from(variant) + 1);
    let Setting {
        scene,
        cameras,
        cull,
        must_hit,
        ..
    } = setting;
    let stage = Stage::from_scene(scene);
    let brute = BRUTE / case.variants as usize / stage.accel.len().max(1);
    let (few, many) = rays.split_at(brute.min(rays.len()));
    let hits = stage.check_all(few, cull) + stage.check_all_quickly(many, cull);
    assert!(
        !must_hit || hits == rays.len(),
        "{} leaks",
        rays.len() - hits
    );
    sum.rays += rays.len();
    sum.hits += hits;
    let is_wrong = |ray: &&Ray| {
        let cast = |precision| stage.accel.cast_primitive(ray, cull, precision).primitive;
        cast(Precision::Fast) != cast(Precision::Exact)
    };
    sum.fast_is_wrong += rays.par_iter().filter(is_wrong).count();

    let mut random = Random::new(u64::from(variant) + 1);
    for camera in cameras {
        for lattice in [whole(camera), part(&mut random, camera)] {
            let every = lattice.len().div_ceil(TRUTHS).max(1);
            let hits = stage.check_lattice(&lattice, cull, every);
            assert!(
                !must_hit || hits == lattice.len(),
                "{} leaks",
                lattice.len() - hits
            );
            sum.camera_rays += lattice.len();
            sum.camera_hits += hits;
        }
    }
}

/// As many rays as `RAYCAST_LONG_RAYS` says.
fn long_rays(otherwise: u64) -> u64 {
    match std::env::var("RAYCAST_LONG_RAYS") {
        Ok(text) => text.parse().expect("RAYCAST_LONG_RAYS is a whole number"),
        Err(_) => otherwise,
    }
}

/// Random cameras inside of closed surfaces, of a few triangles to a million, near the origin and far
/// from it: none of their rays may leave.
#[test]
fn no_ray_of_a_camera_leaves() {
    let count = long_rays(100_000_000);
    let far = DVec3::new(148_376.0, 1_234.0, -223_423.0);
    let surfaces = [
        (DVec3::ZERO, 1.0, 8),
        (far, 30.0, 64),
        (far, 1e-2, 200),
        (DVec3::ZERO, 1e6, 1000),
    ];
    let mut random = Random::new(1);
    for (center, radius, steps) in surfaces {
        let scene = scene_of([meshes::sphere(center, radius, steps)]);
        let accel = Accel::build(&scene).expect("a valid scene");
        // The corners of this box are at 0.52 of the radius, and no triangle nearer than 0.85.
        let inside = |random: &mut Random| {
            let unit = std::array::from_fn(|_| random.between(-0.3, 0.3));
            center + DVec3::from_array(unit) * radius
        };
        let (mut rays, mut hit) = (0, 0);
        while rays < count / surfaces.len() as u64 {
            let (eye, target) = (inside(&mut random), inside(&mut random));
            let projection = PROJECTIONS[random.below(2) as usize];
            let height = match projection {
                Projection::Perspective | Projection::Panoramic(_) => {
                    eye.distance(target) * random.between(0.01, 4.0)
                }
                // All rays begin inside.
                Projection::Orthographic => radius * random.between(0.01, 0.2),
            };
            let tiles = subject::tiles(&camera(eye, target, projection, (1024, 1024), height), 1);
            rays += tiles.iter().map(|tile| tile.len() as u64).sum::<u64>();
            let hits = |tile: &Lattice| {
                accel
                    .find_closest(tile, Cull::None, Precision::Exact, &mut Vec::new())
                    .hits
            };
            hit += tiles.par_iter().map(hits).sum::<u64>();
        }
        println!(
            "{} triangles: {} leaks of {rays} rays",
            accel.len(),
            rays - hit
        );
        assert_eq!(hit, rays);
    }
}

/// Single rays at each closed surface, random ones and those aimed at corners and edges: none may pass.
/// A hundredth of them are compared with the oracle.
#[test]
fn no_single_ray_leaves() {
    let count = long_rays(20_000_000) / 100;
    for case in cases::all() {
        let setting = (case.setting)(0);
        if !(setting.must_hit && setting.has_generator()) {
            continue;
        }
        let stage = Stage::from_scene(setting.scene.clone());
        let cull = setting.cull;
        let each = 10_000;
        let leaks: u64 = (0..count.div_ceil(each))
            .into_par_iter()
            .map(|seed| {
                let rays = setting.rays(each as usize, 1000 + seed);
                for ray in &rays[..each as usize / 100] {
                    stage.check_quickly(ray, cull);
                }
                let is_miss = |ray: &&Ray| stage.accel.cast(ray, cull).is_none();
                rays.iter().filter(is_miss).count() as u64
            })
            .sum();
        println!("{}: {leaks} leaks of {count} rays", case.name);
        assert_eq!(leaks, 0, "{}", case.name);
    }
}

// What is no matter of rays, or says more than that the truth is found.

#[test]
fn coordinates_beyond_1e18_are_counted() {
    let beyond = soup(&[UNIT, UNIT.map(|p| p * 1.01e18), UNIT.map(|p| p * 1e300)]);
    assert_eq!(beyond.dropped().too_far, 2);
    assert_eq!(beyond.kept(), [0]);
}

/// Distances that have no rounding to be excused with.
#[test]
fn whole_distances_are_whole() {
    for (name, expected) in [
        ("in_the_plane_of_a_face", vec![Some(4.0)]),
        (
            "half_a_trillion",
            vec![Some(500.0), Some(12e4f64.next_down()), Some(12e4), None],
        ),
    ] {
        let case = cases::find(name).expect("a case in the list");
        let setting = (case.setting)(0);
        let rays = setting.rays(expected.len(), 1);
        let stage = Stage::from_scene(setting.scene);
        let found = rays.iter().map(|ray| {
            let hit = stage.accel.cast(ray, Cull::None);
            hit.map(|hit| hit.t)
        });
        assert_eq!(found.collect::<Vec<_>>(), expected, "{name}");
    }
}

/// Scaling by a power of two scales t by it, and changes no other number.
#[test]
fn powers_of_two_change_nothing() {
    let case = cases::find("powers_of_two").expect("a case in the list");
    for plain in [0, 1] {
        let setting = (case.setting)(plain);
        let rays = setting.rays(500, 1);
        let home = Stage::from_scene(setting.scene);
        for variant in (plain + 2..case.variants).step_by(2) {
            let setting = (case.setting)(variant);
            let scaled_rays = setting.rays(500, 1);
            let scaled = Stage::from_scene(setting.scene);
            let scale = scaled_rays[0].origin.x / rays[0].origin.x;
            for (ray, there) in rays.iter().zip(&scaled_rays) {
                assert_eq!(there.direction, ray.direction * scale);
                let cast = |stage: &Stage, ray| stage.accel.cast(ray, Cull::None);
                // The direction is scaled too, so that even t stays.
                assert_eq!(cast(&scaled, there), cast(&home, ray), "{scale}: {ray:?}");
                let there = Ray::new(there.origin, ray.direction);
                let expected = cast(&home, ray).map(|mut hit| {
                    hit.t *= scale;
                    hit
                });
                assert_eq!(cast(&scaled, &there), expected, "{scale}: {ray:?}");
            }
        }
    }
}

/// Corners and camera are multiples of 2⁻²⁰, which a double holds at 1e7 too.
#[test]
fn ten_million_units_away_the_picture_is_the_same() {
    let moved = |by: DVec3| Stage::from_meshes([cases::scale::moved_sphere(by)]);
    let home = moved(DVec3::ZERO);
    for by in [DVec3::new(1e7, 0.0, 0.0), DVec3::new(-1e7, 1e7, 1e7)] {
        let away = moved(by);
        for (eye, projection) in [
            (DVec3::new(1.5, 1.0, 2.0), Projection::Perspective),
            (DVec3::new(0.0, 0.0, 3.0), Projection::Perspective),
            (DVec3::new(0.0, 0.0, 3.0), Projection::Orthographic),
        ] {
            // A step of a power of two along the axes: orthographic origins are not rounded.
            let camera = |by: DVec3| camera(by + eye, by, projection, (128, 128), 2.0);
            let here = home.check_picture(camera(DVec3::ZERO), Cull::None, 3);
            let there = away.check_picture(camera(by), Cull::None, 3);
            assert!(here.pixels == there.pixels, "{by} {projection:?}");
            let [here, there] = [here, there].map(|p| p.layers.expect("layers were requested"));
            assert!(here.triangle == there.triangle, "{by} {projection:?}");
        }
    }
}

/// 1000 seeds: no panic, and what was dropped is counted.
#[test]
fn random_bits_are_counted() {
    (0..1000).into_par_iter().for_each(|seed| {
        let mut random = Random::new(seed);
        let vertices = 30;
        let positions: Vec<DVec3> = (0..vertices)
            .map(|_| {
                DVec3::from_array(std::array::from_fn(|_| match seed % 2 {
                    0 => f64::from(f32::from_bits(random.bits() as u32)),
                    _ => f64::from_bits(random.bits()),
                }))
            })
            .collect();
        let triangles: Vec<[u32; 3]> = (0..60)
            .map(|_| {
                std::array::from_fn(|_| match random.below(32) {
                    0 => random.bits() as u32,
                    _ => random.below(vertices),
                })
            })
            .collect();
        let is_bad = |triangle: &&[u32; 3]| triangle.iter().any(|&i| i >= vertices);
        let bad = triangles.iter().filter(is_bad).count();
        let mesh = mesh(positions, triangles);
        assert_eq!(mesh.dropped().bad_index as usize, bad);
        assert_eq!(mesh.kept().len() + mesh.dropped().total() as usize, 60);
        assert!(Accel::build(&scene_of([mesh])).is_ok());
    });
}

#[test]
fn one_bad_vertex_takes_its_own_triangles_alone() {
    let whole = meshes::sphere(DVec3::ZERO, 1.0, 60);
    let bad = 700;
    let positions: Vec<DVec3> = whole.positions().iter().map(|p| p.as_dvec3()).collect();
    let mut broken = positions.clone();
    broken[bad as usize].y = f64::NAN;
    let broken = mesh(broken, whole.triangles().to_vec());
    let others: Vec<[u32; 3]> = whole
        .triangles()
        .iter()
        // A triangle that is only a point keeps the numbers of those behind it.
        .map(|&triangle| {
            if triangle.contains(&bad) {
                [0; 3]
            } else {
                triangle
            }
        })
        .collect();
    let others = mesh(positions, others);
    assert_eq!(broken.dropped().not_finite, 6);
    assert_eq!(broken.kept(), others.kept());
    let camera = camera(
        DVec3::new(1.0, 1.0, 3.0),
        DVec3::ZERO,
        Projection::Perspective,
        (160, 120),
        2.3,
    );
    let broken = Stage::from_meshes([broken]).check_picture(camera, Cull::None, 2);
    let others = Stage::from_meshes([others]).check_picture(camera, Cull::None, 2);
    assert!(broken.pixels == others.pixels);
    assert!(broken.layers.map(|l| l.triangle) == others.layers.map(|l| l.triangle));
}

/// In under 2 s each, when nothing else runs; the bound here leaves room for what does.
#[test]
fn copies_of_one_triangle_build_and_the_first_shows() {
    for count in [1_000, 10_000, 100_000] {
        let copies = mesh(UNIT.to_vec(), vec![[0, 1, 2]; count]);
        let start = std::time::Instant::now();
        let accel = Accel::build(&scene_of([copies])).expect("a valid scene");
        let took = start.elapsed().as_secs_f64();
        assert!(took < 10.0, "{count} copies took {took} s");
        println!("{count} copies: {took:.3} s");
        for (x, y) in [(0.2, 0.3), (0.0, 0.0), (0.5, 0.5)] {
            let ray = Ray::new(DVec3::new(x, y, 5.0), DVec3::NEG_Z);
            let hit = accel.cast(&ray, Cull::None).expect("a hit");
            assert_eq!((hit.triangle, hit.t), (0, 5.0));
        }
    }
}

#[test]
fn culling_leaves_a_closed_mesh_as_it_is() {
    let stage = Stage::from_meshes([meshes::sphere(DVec3::ZERO, 1.0, 60)]);
    for projection in PROJECTIONS {
        let camera = camera(
            DVec3::new(2.0, 1.5, 2.5),
            DVec3::ZERO,
            projection,
            (200, 150),
            2.3,
        );
        let all = stage.check_picture(camera, Cull::None, 3);
        let fronts = stage.check_picture(camera, Cull::Back, 3);
        assert!(all.pixels == fronts.pixels && all.layers == fronts.layers);
    }
}
