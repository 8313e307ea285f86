//! Degenerate triangles, invalid rays, and many duplicates.

use super::{Case, CaseTheme, Setting};
use crate::cameras::{PROJECTIONS, camera};
use crate::meshes::{self, mesh, soup};
use raycast_core::camera::Ray;
use raycast_core::glam::DVec3;
use raycast_oracle::random::Random;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "no_area",
        theme: CaseTheme::BadGeometry,
        difficulty: "Points, lines and folded triangles among good ones: NaN, hits on nothing, numbers shifted.",
        variants: 1,
        setting: no_area,
    },
    Case {
        name: "random_bits",
        theme: CaseTheme::BadGeometry,
        difficulty: "Vertices of random bits, one index in 32 out of range: builders panic.",
        variants: 50,
        setting: random_bits,
    },
    Case {
        name: "one_bad_vertex",
        theme: CaseTheme::BadGeometry,
        difficulty: "One vertex that is no number takes the whole mesh with it.",
        variants: 1,
        setting: one_bad_vertex,
    },
    Case {
        name: "rays_that_are_none",
        theme: CaseTheme::BadGeometry,
        difficulty: "NaN or infinity in a ray: a hit, or a walk through every box.",
        variants: 1,
        setting: rays_that_are_none,
    },
    Case {
        name: "few_triangles",
        theme: CaseTheme::BadGeometry,
        difficulty: "0, 1, 2, 3, 4 and 9 triangles: a tree of one node, or of none.",
        variants: 30,
        setting: few_triangles,
    },
    Case {
        name: "copies",
        theme: CaseTheme::BadGeometry,
        difficulty: "1,000 to 100,000 copies of one triangle: builders take forever, and which one shows is chance.",
        variants: 3,
        setting: copies,
    },
];

/// Triangles whose id is 3 modulo 4 are valid; the others have no area.
fn no_area(_: u32) -> Setting {
    let mut random = Random::new(21);
    let mut corners = Vec::new();
    for i in 0..120 {
        let place = random.in_cube();
        let [a, b]: [DVec3; 2] =
            std::array::from_fn(|_| (place + random.in_cube() * 0.5).as_vec3().as_dvec3());
        // Collinear points that single precision represents exactly.
        let start = (a * 64.0).round() / 64.0;
        let step = DVec3::new(0.5, 0.25, -0.125);
        corners.push(match i % 4 {
            0 => [a; 3],
            1 => [start, start + step, start + step * 2.0],
            2 => [a, b, a],
            _ => [a, b, place],
        });
    }
    let eye = DVec3::Z * 4.0;
    let aimed_at = corners.clone();
    Setting::from_meshes([soup(&corners)])
        .with_cameras(
            PROJECTIONS.map(|projection| camera(eye, DVec3::ZERO, projection, (64, 48), 3.0)),
        )
        .with_generator(move |random| {
            let origin = random.direction() * 4.0;
            let target = aimed_at[random.below(120) as usize][random.below(3) as usize];
            Ray::new(origin, target - origin)
        })
}

fn random_bits(variant: u32) -> Setting {
    let mut random = Random::new(2200 + u64::from(variant));
    let vertices = 30;
    let positions: Vec<DVec3> = (0..vertices)
        .map(|_| {
            DVec3::from_array(std::array::from_fn(|_| match variant % 2 {
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
    let eye = DVec3::splat(random.decade(-6.0, 6.0));
    let aimed_at = positions.clone();
    Setting::from_meshes([mesh(positions, triangles)])
        .with_cameras(
            PROJECTIONS.map(|projection| camera(eye, DVec3::ZERO, projection, (32, 24), eye.x)),
        )
        .with_generator(move |random| {
            if random.below(2) == 0 {
                let mut number = || f64::from(f32::from_bits(random.bits() as u32));
                return Ray {
                    origin: DVec3::new(number(), number(), number()),
                    direction: DVec3::new(number(), number(), number()),
                    t_min: number().min(0.0),
                    t_max: number().abs(),
                };
            }
            let origin = random.in_cube();
            let target = aimed_at[random.below(vertices) as usize];
            Ray::new(origin, target - origin)
        })
}

fn one_bad_vertex(_: u32) -> Setting {
    let whole = meshes::sphere(DVec3::ZERO, 1.0, 60);
    let mut positions: Vec<DVec3> = whole.positions().iter().map(|p| p.as_dvec3()).collect();
    positions[700].y = f64::NAN;
    let eye = DVec3::new(1.0, 1.0, 3.0);
    Setting::from_meshes([mesh(positions, whole.triangles().to_vec())])
        .with_cameras(
            PROJECTIONS.map(|projection| camera(eye, DVec3::ZERO, projection, (120, 90), 2.3)),
        )
        .with_generator(|random| {
            let origin = random.direction() * 3.0;
            Ray::new(origin, random.in_cube() - origin)
        })
}

fn rays_that_are_none(_: u32) -> Setting {
    let good = Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z);
    let mut rays = vec![good];
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let (mut origin, mut direction) = (good.origin, good.direction);
            origin[axis] = bad;
            direction[axis] = bad;
            rays.extend([
                Ray { origin, ..good },
                Ray { direction, ..good },
                Ray {
                    origin,
                    direction,
                    ..good
                },
                Ray { t_min: bad, ..good },
                Ray { t_max: bad, ..good },
            ]);
        }
    }
    rays.push(Ray {
        direction: DVec3::ZERO,
        ..good
    });
    let eye = good.origin;
    Setting::from_meshes([meshes::sphere(DVec3::ZERO, 1.0, 60)])
        .with_rays(rays)
        .with_cameras(
            PROJECTIONS.map(|projection| camera(eye, DVec3::ZERO, projection, (64, 48), 2.3)),
        )
}

fn few_triangles(variant: u32) -> Setting {
    let count = [9, 4, 3, 2, 1, 0][variant as usize % 6];
    let mut random = Random::new(2500 + u64::from(variant));
    let soup = meshes::random_soup(&mut random, count, DVec3::ZERO, 1.0, 1.0);
    let eye = DVec3::Z * 4.0;
    Setting::from_meshes([soup])
        .with_cameras(
            PROJECTIONS.map(|projection| camera(eye, DVec3::ZERO, projection, (40, 30), 3.0)),
        )
        .with_generator(|random| {
            let origin = random.direction() * 3.0;
            Ray::new(origin, random.in_cube() - origin)
        })
}

fn copies(variant: u32) -> Setting {
    let count = [1000, 10_000, 100_000][variant as usize % 3];
    let unit = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let target = DVec3::new(0.4, 0.4, 0.0);
    let eye = target + DVec3::new(0.1, 0.2, 3.0);
    // Few rays, because every ray tests every duplicate.
    let camera = camera(eye, target, PROJECTIONS[0], (6, 4), 1.5);
    let places = [(0.2, 0.3), (0.0, 0.0), (0.5, 0.5), (0.7, 0.7)];
    Setting::from_meshes([mesh(unit, vec![[0, 1, 2]; count])])
        .with_cameras([camera])
        .with_rays(places.map(|(x, y)| Ray::new(DVec3::new(x, y, 5.0), DVec3::NEG_Z)))
}
