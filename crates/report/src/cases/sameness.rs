//! The same ray, given in different ways.

use super::{Case, CaseTheme, Setting};
use crate::cameras::{PROJECTIONS, camera};
use crate::meshes::{self, soup};
use raycast_core::Cull;
use raycast_core::camera::Ray;
use raycast_core::glam::{DVec3, Vec3};
use raycast_oracle::random::Random;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "random_soups",
        theme: CaseTheme::Sameness,
        difficulty: "Random triangles over many decades: tree and brute force disagree.",
        variants: 30,
        setting: random_soups,
    },
    Case {
        name: "culled_sphere",
        theme: CaseTheme::Sameness,
        difficulty: "Without its back faces a closed mesh seen from outside is another picture.",
        variants: 2,
        setting: culled_sphere,
    },
    Case {
        name: "alternating_fronts",
        theme: CaseTheme::Sameness,
        difficulty: "A thousand triangles turned to and fro: culled ones hide those behind them.",
        variants: 2,
        setting: alternating_fronts,
    },
    Case {
        name: "unit_triangle",
        theme: CaseTheme::Sameness,
        difficulty: "One triangle seen from one unit away: u, v and t beyond 4 · 2^-23.",
        variants: 1,
        setting: unit_triangle,
    },
];

fn random_soups(variant: u32) -> Setting {
    let mut random = Random::new(2800 + u64::from(variant));
    let scale = random.decade(-12.0, 12.0);
    let middle = match variant % 3 {
        0 => DVec3::ZERO,
        _ => random.direction() * scale * random.decade(0.0, 5.0),
    };
    let size = random.decade(-2.0, 0.0);
    let count = 1 + random.below(300);
    let soup = meshes::random_soup(&mut random, count, middle, scale, size);
    let target = middle + random.in_cube() * scale * 0.5;
    let eye = middle + random.direction() * scale * random.decade(-1.0, 1.5);
    let height = (eye - target).length() * random.decade(-2.0, 0.5);
    Setting::from_meshes([soup])
        .with_cameras(
            PROJECTIONS.map(|projection| camera(eye, target, projection, (61, 43), height)),
        )
        .with_cull([Cull::None, Cull::Back][variant as usize % 2])
        .with_generator(move |random| {
            let origin = middle + random.direction() * scale * random.decade(0.0, 2.0);
            Ray::new(origin, middle + random.in_cube() * scale - origin)
        })
}

fn culled_sphere(variant: u32) -> Setting {
    let eye = DVec3::new(2.0, 1.5, 2.5);
    Setting::from_meshes([meshes::sphere(DVec3::ZERO, 1.0, 60)])
        .with_cameras(
            PROJECTIONS.map(|projection| camera(eye, DVec3::ZERO, projection, (200, 150), 2.3)),
        )
        .with_cull([Cull::None, Cull::Back][variant as usize % 2])
        .with_generator(|random| {
            let origin = random.direction() * random.between(1.1, 9.0);
            Ray::new(origin, random.in_cube() - origin)
        })
}

/// Triangles with even ids have their fronts towards +Z, those with odd ids towards −Z.
fn alternating_fronts(variant: u32) -> Setting {
    let mut random = Random::new(30);
    let corners: Vec<[DVec3; 3]> = (0..1000)
        .map(|i| {
            let place = random.in_cube().with_z(f64::from(i) * 0.01);
            let [a, b, c] = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| place + p * 0.3);
            if i % 2 == 0 { [a, b, c] } else { [a, c, b] }
        })
        .collect();
    let eye = DVec3::new(0.1, 0.1, [20.0, -10.0][variant as usize % 2]);
    Setting::from_meshes([soup(&corners)])
        .with_cameras(
            PROJECTIONS.map(|projection| camera(eye, DVec3::ZERO, projection, (96, 96), 2.0)),
        )
        .with_cull(Cull::Back)
        .with_generator(move |random| Ray::new(eye, random.in_cube() - eye))
}

fn unit_triangle(_: u32) -> Setting {
    let eye = DVec3::new(0.0, 0.0, -1.0);
    let target = DVec3::new(0.3, 0.3, 0.0);
    Setting::from_meshes([soup(&[[DVec3::ZERO, DVec3::X, DVec3::Y]])])
        .with_cameras(PROJECTIONS.map(|projection| camera(eye, target, projection, (64, 64), 1.5)))
        .with_generator(move |random| {
            let (mut u, mut v) = (random.between(0.0, 1.0), random.between(0.0, 1.0));
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            // The target is rounded to single precision, as in a file of rays, so that it is exact; so is the eye.
            Ray::new(eye, Vec3::new(u as f32, v as f32, 0.0).as_dvec3() - eye)
        })
}
