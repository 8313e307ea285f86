//! Zeros of both signs, ties, and eyes on the surface that they look at.

use super::{Case, CaseTheme, Setting};
use crate::cameras::{PROJECTIONS, camera};
use crate::meshes::{self, mesh, soup};
use raycast_core::Cull;
use raycast_core::camera::Ray;
use raycast_core::glam::DVec3;
use raycast_oracle::random::Random;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "negative_zeros",
        theme: CaseTheme::Signs,
        difficulty: "A direction of (−0, 0, −1) is not answered as (0, 0, −1) is: its inverse is −∞.",
        variants: 1,
        setting: negative_zeros,
    },
    Case {
        name: "in_the_plane_of_a_face",
        theme: CaseTheme::Signs,
        difficulty: "A ray in the plane of a box's face: zero times infinity, and the box is lost.",
        variants: 1,
        setting: in_the_plane_of_a_face,
    },
    Case {
        name: "eye_on_the_surface",
        theme: CaseTheme::Signs,
        difficulty: "An eye on a vertex, on an edge, in a triangle's plane or inside a mesh: NaN, or the others wrong.",
        variants: 8,
        setting: eye_on_the_surface,
    },
    Case {
        name: "quads_in_one_place",
        theme: CaseTheme::Signs,
        difficulty: "Two surfaces in one place, turned either way: which one shows changes from ray to ray.",
        variants: 4,
        setting: quads_in_one_place,
    },
    Case {
        name: "four_triangles",
        theme: CaseTheme::Signs,
        difficulty: "Four triangles on one line of boxes: builders have looped or crashed.",
        variants: 1,
        setting: four_triangles,
    },
];

fn negative_zeros(_: u32) -> Setting {
    let mut random = Random::new(8);
    let box_and_soup = [
        meshes::cuboid(DVec3::splat(-1.0), DVec3::ONE),
        meshes::random_soup(&mut random, 200, DVec3::ZERO, 2.0, 0.5),
    ];
    let cameras = PROJECTIONS
        .map(|projection| camera(DVec3::Z * 5.0, DVec3::ZERO, projection, (48, 48), 3.0));
    Setting::from_meshes(box_and_soup)
        .with_cameras(cameras)
        .with_generator(|random| {
            let across = if random.below(3) == 0 {
                // In the cube's face planes, some on its edges.
                DVec3::new(1.0, f64::from(random.below(5)) * 0.5 - 1.0, 0.0)
            } else {
                random.in_cube() * 1.5
            };
            let axis = random.below(3) as usize;
            let sign = [-1.0, 1.0][random.below(2) as usize];
            let [x, y] = [0.0, -0.0].map(|_| [0.0, -0.0][random.below(2) as usize]);
            let turn = |x: f64, y: f64, z: f64| {
                let mut point = DVec3::ZERO;
                point[axis] = z;
                point[(axis + 1) % 3] = x;
                point[(axis + 2) % 3] = y;
                point
            };
            Ray::new(turn(across.x, across.y, -5.0 * sign), turn(x, y, sign))
        })
}

fn in_the_plane_of_a_face(_: u32) -> Setting {
    // Pixel centres are at multiples of 1/16, some of them in the cube's face planes.
    let aside = DVec3::new(1.0 / 32.0, -1.0 / 32.0, 0.0);
    let cameras = PROJECTIONS
        .map(|projection| camera(aside + DVec3::Z * 5.0, aside, projection, (64, 64), 4.0));
    Setting::from_meshes([meshes::cuboid(DVec3::splat(-1.0), DVec3::ONE)])
        .with_rays([Ray::new(DVec3::new(1.0, 0.25, 5.0), DVec3::NEG_Z)])
        .with_cameras(cameras)
        .with_generator(|random| {
            let mut quarter = || f64::from(random.below(9)) * 0.25 - 1.0;
            let origin = DVec3::new(quarter(), quarter(), quarter());
            let axis = DVec3::AXES[random.below(3) as usize];
            let away = axis * [5.0, -5.0][random.below(2) as usize];
            Ray::new(origin + away, -away.normalize())
        })
}

fn eye_on_the_surface(variant: u32) -> Setting {
    let sphere = meshes::sphere(DVec3::ZERO, 1.0, 16);
    let corners = |number| {
        let corners = sphere.corners(number).unwrap_or_default();
        corners.map(|corner| sphere.offset() + corner.as_dvec3())
    };
    let vertex = corners(5)[1];
    let [a, b, c] = corners(9);
    let eyes = [
        vertex,
        a + (b - a) * 0.5,
        (a + b + c) / 3.0,
        a * 2.0 - b,
        DVec3::new(1.5, 2.0, 0.3),
        DVec3::new(2.0, 2.0, 2.0),
        DVec3::ZERO,
        DVec3::new(0.1, -0.2, 0.3),
    ];
    let eye = eyes[variant as usize % eyes.len()];
    let cube = meshes::cuboid(DVec3::splat(-2.0), DVec3::splat(2.0));
    let target = eye + DVec3::new(0.3, -0.5, 1.0);
    Setting::from_meshes([sphere, cube])
        .with_cameras(PROJECTIONS.map(|projection| camera(eye, target, projection, (48, 32), 1.5)))
        .with_generator(move |random| {
            let direction = match random.below(4) {
                0 => b - eye + DVec3::splat(f64::MIN_POSITIVE),
                _ => random.direction(),
            };
            Ray {
                t_min: [0.0, 1e-9][random.below(2) as usize],
                ..Ray::new(eye, direction)
            }
        })
}

fn quads_in_one_place(variant: u32) -> Setting {
    let [a, b] = [DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, -1.0, 0.0)];
    let [c, d] = [DVec3::new(1.0, 1.0, 0.0), DVec3::new(-1.0, 1.0, 0.0)];
    let both = mesh(
        vec![a, b, c, d],
        vec![[0, 1, 2], [0, 2, 3], [2, 1, 0], [3, 2, 0]],
    );
    let other = mesh(
        vec![a, b, c, d],
        vec![[2, 1, 0], [3, 2, 0], [0, 1, 2], [0, 2, 3]],
    );
    let meshes = if variant.is_multiple_of(2) {
        [both, other]
    } else {
        [other, both]
    };
    let eye = DVec3::new(0.2, 0.3, 3.0);
    Setting::from_meshes(meshes)
        .with_cameras(
            PROJECTIONS.map(|projection| camera(eye, DVec3::ZERO, projection, (64, 64), 1.5)),
        )
        .with_generator(move |random| {
            let target = random.in_cube() * DVec3::new(0.99, 0.99, 0.0);
            Ray::new(eye, target - eye)
        })
        .with_cull([Cull::None, Cull::Back][variant as usize / 2 % 2])
        .must_hit()
}

fn four_triangles(_: u32) -> Setting {
    let [a, b, c, d] = [-6.400_002_4, 25.6, 34.0, 57.600_002_1];
    let p = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    let triangles = soup(&[
        [p(b, 0.0), p(d, 0.0), p(d, 1.0)],
        [p(b, 0.0), p(c, 0.0), p(c, 1.0)],
        [p(a, 0.0), p(d, 0.0), p(d, 1.0)],
        [p(a, 0.0), p(d, 0.0), p(d, 1.0)],
    ]);
    let target = p(25.6, 0.5);
    let cameras = PROJECTIONS
        .map(|projection| camera(target + DVec3::Z * 30.0, target, projection, (160, 20), 8.0));
    Setting::from_meshes([triangles])
        .with_cameras(cameras)
        .with_rays((0..700).map(|i| {
            let origin = DVec3::new(f64::from(i) * 0.1 - 8.0, f64::from(i % 7) * 0.15, 5.0);
            Ray::new(origin, DVec3::NEG_Z)
        }))
}
