//! Large and small, near and far, each alone and all together.

use super::{Case, CaseTheme, Setting};
use crate::cameras::{PROJECTIONS, camera};
use crate::meshes::{self, mesh, soup};
use raycast_core::camera::{Projection, Ray};
use raycast_core::glam::DVec3;
use raycast_core::math;
use raycast_core::scene::Mesh;
use raycast_oracle::random::Random;
use std::f64::consts::TAU;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "directions_of_any_length",
        theme: CaseTheme::Scale,
        difficulty: "Directions from 1e-9 to 1e9 long: short ones are clamped, long ones overflow.",
        variants: 1,
        setting: directions_of_any_length,
    },
    Case {
        name: "powers_of_two",
        theme: CaseTheme::Scale,
        difficulty: "A scene times 2^-50 to 2^40: an epsilon somewhere stands for a length.",
        variants: 16,
        setting: powers_of_two,
    },
    Case {
        name: "coordinates_to_1e18",
        theme: CaseTheme::Scale,
        difficulty: "Products of coordinates near the end of single precision.",
        variants: 3,
        setting: coordinates_to_1e18,
    },
    Case {
        name: "origins_beyond_the_scene",
        theme: CaseTheme::Scale,
        difficulty: "Rays that begin up to 1e300 away: products overflow, and what is not less is taken for more.",
        variants: 1,
        setting: origins_beyond_the_scene,
    },
    Case {
        name: "half_a_trillion",
        theme: CaseTheme::Scale,
        difficulty: "A slab of 1e12 by 1e12: the ray down is lost, or its distance is.",
        variants: 1,
        setting: half_a_trillion,
    },
    Case {
        name: "grazed_sliver",
        theme: CaseTheme::Scale,
        difficulty: "A sliver met at half a degree: a well-known library answered 12291 for something nearer than 600.",
        variants: 100,
        setting: grazed_sliver,
    },
    Case {
        name: "small_thing_on_vast_ground",
        theme: CaseTheme::Scale,
        difficulty: "An object of a hundredth on a ground of a million.",
        variants: 1,
        setting: small_thing_on_vast_ground,
    },
    Case {
        name: "ten_million_away",
        theme: CaseTheme::Scale,
        difficulty: "A mesh and its eye at 1e7: in single precision the mesh has steps of a unit.",
        variants: 3,
        setting: ten_million_away,
    },
    Case {
        name: "next_to_what_is_stored_far_away",
        theme: CaseTheme::Scale,
        difficulty: "An eye next to one object, while all is stored relative to another at 1e7: the eye itself is rounded.",
        variants: 12,
        setting: next_to_what_is_stored_far_away,
    },
    Case {
        name: "close_planes",
        theme: CaseTheme::Scale,
        difficulty: "A plane 1, 2, 4 or 8 units in the last place behind another shines through.",
        variants: 8,
        setting: close_planes,
    },
    Case {
        name: "feet_to_horizon",
        theme: CaseTheme::Scale,
        difficulty: "Triangles from the feet to the horizon: the near and far of a million to one in one of them.",
        variants: 9,
        setting: feet_to_horizon,
    },
];

const UNIT: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

fn directions_of_any_length(_: u32) -> Setting {
    let target = DVec3::new(0.3, 0.3, 0.0);
    let cameras = PROJECTIONS
        .map(|projection| camera(target + DVec3::Z * 5.0, target, projection, (48, 48), 1.5));
    Setting::from_meshes([soup(&[UNIT])])
        .with_cameras(cameras)
        .with_generator(|random| {
            let places = [(0.2, 0.3), (0.0, 0.0), (0.5, 0.5), (0.9, 0.05), (0.6, 0.5)];
            let (x, y) = places[random.below(5) as usize];
            let length = random.decade(-9.0, 9.0);
            Ray::new(DVec3::new(x, y, 5.0), DVec3::NEG_Z * length)
        })
}

fn powers_of_two(variant: u32) -> Setting {
    let power = [0, -50, -40, -17, -1, 1, 23, 40][variant as usize / 2 % 8];
    let size = [2e-4, 0.5][variant as usize % 2];
    let scale = 2f64.powi(power);
    let mut random = Random::new(14 + u64::from(variant % 2));
    let plain = meshes::random_soup(&mut random, 80, DVec3::ZERO, 1.0, size);
    // Corners are rounded once, before scaling by a power of two, so that scenes of one size differ only by the factor.
    let corners: Vec<[DVec3; 3]> = (0..80)
        .filter_map(|number| plain.corners(number))
        .map(|corners| corners.map(|p| (plain.offset() + p.as_dvec3()) * scale))
        .collect();
    let target = corners[0][0];
    let cameras = PROJECTIONS.map(|projection| {
        let eye = target + DVec3::new(0.5, 0.25, 1.0) * (4.0 * size * scale);
        camera(eye, target, projection, (64, 48), 3.0 * size * scale)
    });
    let aimed_at = corners.clone();
    Setting::from_meshes([soup(&corners)])
        .with_cameras(cameras)
        .with_generator(move |random| {
            let [a, b, c] = aimed_at[random.below(80) as usize];
            let target = [(a + b + c) / 3.0, (a + b) * 0.5, c][random.below(3) as usize];
            let origin = random.direction() * (5.0 * scale);
            Ray::new(origin, target - origin)
        })
}

fn coordinates_to_1e18(variant: u32) -> Setting {
    let scale = [1e15, 1e17, 0.99e18][variant as usize % 3];
    let mut random = Random::new(15 + u64::from(variant));
    let inside = meshes::random_soup(&mut random, 60, DVec3::ZERO, scale * 0.5, 1.0);
    let around = meshes::cuboid(DVec3::splat(-scale), DVec3::splat(scale));
    let eye = DVec3::new(0.5, 0.3, 0.9) * scale;
    Setting::from_meshes([inside, around])
        .with_cameras([camera(
            eye,
            DVec3::ZERO,
            Projection::Perspective,
            (64, 48),
            scale,
        )])
        .with_generator(move |random| {
            let direction = random.direction() * random.decade(-9.0, 9.0);
            Ray::new(random.in_cube() * scale, direction)
        })
        .must_hit()
}

fn origins_beyond_the_scene(_: u32) -> Setting {
    let cube = meshes::cuboid(DVec3::splat(-1.0), DVec3::ONE);
    let eye = DVec3::new(0.1, 0.2, 1e15);
    Setting::from_meshes([cube])
        .with_cameras([camera(
            eye,
            eye.with_z(0.0),
            Projection::Orthographic,
            (32, 32),
            2.5,
        )])
        .with_generator(|random| {
            // Parallel to an axis: with an origin up to 1e300 away, any other direction would miss the scene.
            let axis = random.below(3) as usize;
            let mut quarter = || f64::from(random.below(11)) * 0.25 - 1.25;
            let mut origin = DVec3::new(quarter(), quarter(), quarter());
            let mut direction = DVec3::ZERO;
            let side = [-1.0, 1.0][random.below(2) as usize];
            origin[axis] = side * random.decade(1.0, 300.0);
            direction[axis] = -side;
            Ray::new(origin, direction)
        })
}

fn half_a_trillion(_: u32) -> Setting {
    let (side, height) = (5.89e11, 12e4);
    let slab = meshes::cuboid(
        DVec3::new(-side, -side, 0.0),
        DVec3::new(side, side, height),
    );
    let places = [(0.0, 0.0), (1e11, -3e11), (1234.5, 5.5e11), (-2e11, -2e11)];
    let heights = [120_500.0, height.next_down(), height, 0f64.next_down()];
    let rays = places
        .into_iter()
        .flat_map(move |(x, y)| heights.map(|z| Ray::new(DVec3::new(x, y, z), DVec3::NEG_Z)));
    let eye = DVec3::new(1e3, 2e3, 120_500.0);
    let cameras = PROJECTIONS.map(|projection| {
        camera(
            eye,
            eye - DVec3::new(3.0, 1.0, 500.0),
            projection,
            (48, 48),
            1e5,
        )
    });
    Setting::from_meshes([slab])
        .with_rays(rays)
        .with_cameras(cameras)
}

fn grazed_sliver(variant: u32) -> Setting {
    let mut random = Random::new(1700 + u64::from(variant));
    let (middle, short) = (9.7f64, 1.4f64);
    // The sides 11.2, 9.7 and 1.4 would form no triangle, so the longest is shortened. The law of cosines gives the
    // corner opposite it.
    let long = 11.2f64.min(middle + short - 1e-2);
    let along = (middle * middle + long * long - short * short) / (2.0 * long);
    let across = (middle * middle - along * along).sqrt();
    let x = random.direction();
    let y = x.any_orthonormal_vector();
    let normal = x.cross(y);
    let place = random.in_cube() * random.decade(0.0, 3.0);
    let corners = [place, place + x * long, place + x * along + y * across];
    let [a, b, c] = corners;
    let (slope_sin, slope_cos) = math::sin_cos(0.5f64.to_radians());
    let lean = move |turn: f64| {
        let (sin, cos) = math::sin_cos(turn);
        (x * cos + y * sin) * slope_cos + normal * slope_sin
    };
    let middle = (a + b + c) / 3.0;
    let cameras = PROJECTIONS.map(|projection| {
        camera(
            middle - lean(0.4) * 300.0,
            middle,
            projection,
            (64, 24),
            2.0,
        )
    });
    Setting::from_meshes([soup(&[corners])])
        .with_cameras(cameras)
        .with_generator(move |random| {
            let (u, v) = (random.between(0.1, 0.4), random.between(0.1, 0.4));
            let target = a + (b - a) * u + (c - a) * v;
            let direction = lean(random.between(0.0, TAU)).normalize();
            Ray::new(target - direction * random.between(1.0, 600.0), direction)
        })
}

fn small_thing_on_vast_ground(_: u32) -> Setting {
    let ground = meshes::grid(10, 10, |x, z| {
        DVec3::new(f64::from(x) * 2e5 - 1e6, 0.0, 1e6 - f64::from(z) * 2e5)
    });
    let middle = DVec3::new(0.3, 0.01, 0.2);
    let eye = middle + DVec3::new(0.02, 0.03, 0.05);
    Setting::from_meshes([ground, meshes::sphere(middle, 0.01, 24)])
        .with_cameras(PROJECTIONS.map(|projection| camera(eye, middle, projection, (96, 72), 0.05)))
        .with_generator(move |random| {
            let from = random.direction() * random.decade(-2.0, 6.0);
            let origin = middle + from.with_y(from.y.abs());
            let target = middle + random.in_cube() * 0.015;
            Ray::new(origin, (target - origin).normalize())
        })
}

/// A sphere whose corners are multiples of 2⁻²⁰, which double precision represents exactly at 1e7 too.
fn ten_million_away(variant: u32) -> Setting {
    let by = [
        DVec3::new(1e7, 0.0, 0.0),
        DVec3::new(-1e7, 1e7, 1e7),
        DVec3::ZERO,
    ][variant as usize % 3];
    let eyes = [DVec3::new(1.5, 1.0, 2.0), DVec3::new(0.0, 0.0, 3.0)];
    let cameras = eyes.into_iter().flat_map(|eye| {
        PROJECTIONS.map(|projection| camera(by + eye, by, projection, (96, 96), 2.0))
    });
    Setting::from_meshes([moved_sphere(by)])
        .with_cameras(cameras)
        .with_generator(move |random| {
            let origin = by + random.direction() * 3.0;
            Ray::new(origin, by + random.in_cube() - origin)
        })
}

/// The sphere of `ten_million_away`, translated.
pub fn moved_sphere(by: DVec3) -> Mesh {
    let grain = 2f64.powi(20);
    let near = meshes::sphere(DVec3::ZERO, 1.0, 40);
    let points = near
        .positions()
        .iter()
        .map(|p| (p.as_dvec3() * grain).round() / grain + by);
    mesh(points.collect(), near.triangles().to_vec())
}

/// The corners of the second object are integers, which single precision represents exactly at 1e7.
fn next_to_what_is_stored_far_away(variant: u32) -> Setting {
    let mut random = Random::new(1900 + u64::from(variant));
    let far = DVec3::X * 1e7;
    let first = meshes::cuboid(far - DVec3::ONE, far + DVec3::ONE);
    let second = meshes::integer_heights(8, variant.into());
    let corners: Vec<DVec3> = second.positions().iter().map(|p| p.as_dvec3()).collect();
    // At the border: inside the surface, the neighbour would hide that a ray misses a triangle.
    let target = corners[random.below(9) as usize];
    let eye = target + random.direction() * random.between(3.0, 9.0);
    let height = match variant % 2 {
        0 => random.decade(-9.0, 1.0),
        _ => random.decade(-12.0, -9.0),
    };
    Setting::from_meshes([first, second])
        .with_cameras(
            PROJECTIONS.map(|projection| camera(eye, target, projection, (61, 45), height)),
        )
        .with_generator(move |random| {
            let origin = target + random.direction() * random.between(1.0, 9.0);
            let (a, b) = (random.below(81) as usize, random.below(81) as usize);
            // Half of the rays aim at a corner, half at the midpoint of two corners, which is often on an edge.
            let share = [0.0, 0.5][random.below(2) as usize];
            let aim = corners[a] + (corners[b] - corners[a]) * share;
            Ray::new(origin, aim - origin)
        })
}

fn close_planes(variant: u32) -> Setting {
    let ulps = [1, 2, 4, 8][variant as usize / 2 % 4];
    let quad = |z: f64| {
        meshes::grid(1, 1, |x, y| {
            DVec3::new(f64::from(x) * 2.0 - 1.0, f64::from(y) * 2.0 - 1.0, z)
        })
    };
    let behind = f64::from(f32::from_bits(100f32.to_bits() + ulps));
    let (near, far) = (quad(100.0), quad(behind));
    let meshes = if variant.is_multiple_of(2) {
        [near, far]
    } else {
        [far, near]
    };
    let target = DVec3::new(0.0, 0.0, 100.0);
    let eyes = [DVec3::ZERO, DVec3::new(0.3, 0.2, 200.0)];
    let cameras = eyes.into_iter().flat_map(|eye| {
        PROJECTIONS.map(|projection| camera(eye, target, projection, (64, 64), 1.0))
    });
    Setting::from_meshes(meshes)
        .with_cameras(cameras)
        .with_generator(move |random| {
            let eye = eyes[random.below(2) as usize];
            let aside = random.in_cube() * DVec3::new(0.99, 0.99, 0.0);
            Ray::new(eye, target + aside - eye)
        })
        .must_hit()
}

fn feet_to_horizon(variant: u32) -> Setting {
    let height = [1e-4, 1.0, 1e3][variant as usize % 3];
    let cells = [1, 10, 100][variant as usize / 3 % 3];
    let ground = meshes::grid(cells, cells, |x, z| {
        let at = |i: u32| (f64::from(i) / f64::from(cells) - 0.5) * 2e4;
        DVec3::new(at(x), 0.0, -at(z))
    });
    let post = meshes::cuboid(DVec3::new(-0.5, 0.0, -60.0), DVec3::new(0.5, 9.0, -59.0));
    let eye = DVec3::new(0.3, height, 0.2);
    let cameras = [30.0, 1.0, 1e-3].into_iter().flat_map(|frame| {
        PROJECTIONS.map(|projection| camera(eye, eye - DVec3::Z, projection, (60, 80), frame))
    });
    Setting::from_meshes([ground, post]).with_cameras(cameras)
}
