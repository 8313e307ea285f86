//! Closed surfaces, through which no ray may pass.

use super::{Case, CaseTheme, Setting};
use crate::cameras::{PROJECTIONS, camera};
use crate::meshes::{self, mesh};
use raycast_core::camera::{Projection, Ray};
use raycast_core::glam::DVec3;
use raycast_core::math;
use raycast_core::scene::Mesh;
use raycast_oracle::random::Random;
use std::f64::consts::TAU;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "far_sphere",
        theme: CaseTheme::Leaks,
        difficulty: "Far from the origin, rounded edges leave gaps: Embree's own test allows 2e-5 of the rays to leave.",
        variants: 1,
        setting: |_| far_sphere(None),
    },
    Case {
        name: "far_sphere_corners",
        theme: CaseTheme::Leaks,
        difficulty: "Rounded edge planes of one vertex do not meet in a point, so rays aimed at corners and edges pass.",
        variants: 1,
        setting: |_| far_sphere(Some(4)),
    },
    Case {
        name: "far_plane",
        theme: CaseTheme::Leaks,
        difficulty: "40,000 quads far from the origin: rays pass between them.",
        variants: 1,
        setting: far_plane,
    },
    Case {
        name: "common_edge",
        theme: CaseTheme::Leaks,
        difficulty: "Rays within two units in the last place of an edge miss both of its triangles, where one path fuses a product and a sum.",
        variants: 100,
        setting: common_edge,
    },
    Case {
        name: "integer_heights",
        theme: CaseTheme::Leaks,
        difficulty: "Rays exactly through vertices and edges: every sign is zero somewhere.",
        variants: 1,
        setting: |_| integer_heights(128),
    },
    Case {
        name: "octahedron",
        theme: CaseTheme::Leaks,
        difficulty: "Rays through the silhouette's vertices and edges are taken for misses.",
        variants: 1,
        setting: octahedron,
    },
    Case {
        name: "horizon",
        theme: CaseTheme::Leaks,
        difficulty: "An eye just above a vast plane: holes and stripes at the horizon.",
        variants: 1,
        setting: horizon,
    },
    Case {
        name: "small_distant_fan",
        theme: CaseTheme::Leaks,
        difficulty: "Edges a ten-thousandth of their distance long: a plain cross product of corners gets about half of the hits wrong.",
        variants: 100,
        setting: small_distant_fan,
    },
];

const FAR: DVec3 = DVec3::new(148_376.0, 1234.0, -223_423.0);

/// A vertex of a mesh, or a point on an edge.
fn corner_or_edge(mesh: &Mesh, random: &mut Random) -> DVec3 {
    let number = random.below(mesh.triangles().len() as u32) as usize;
    let [a, b, _] =
        mesh.triangles()[number].map(|i| mesh.offset() + mesh.positions()[i as usize].as_dvec3());
    match random.below(3) {
        0 => a,
        1 => (a + b) * 0.5,
        _ => a + (b - a) * random.between(0.0, 1.0),
    }
}

/// A sphere far from the origin with rays from inside it. With `nudges`, rays aim at vertices and edges, off by up
/// to so many units in the last place; without, in any direction.
fn far_sphere(nudges: Option<u32>) -> Setting {
    let sphere = meshes::sphere(FAR, 2.0, 200);
    let cameras = DVec3::AXES.map(|axis| {
        let eye = FAR + DVec3::splat(0.1);
        let target = FAR + axis * 5.0;
        camera(eye, target, Projection::Perspective, (160, 120), 12.0)
    });
    let aimed_at = sphere.clone();
    Setting::from_meshes([sphere])
        .with_cameras(cameras)
        .with_generator(move |random| {
            let origin = FAR + random.direction() * random.between(0.0, 1.9);
            let Some(nudges) = nudges else {
                return Ray::new(origin, random.direction());
            };
            let target = corner_or_edge(&aimed_at, random);
            Ray::new(origin, random.nudge(target, nudges) - origin)
        })
        .must_hit()
}

fn far_plane(_: u32) -> Setting {
    let cells = 200;
    let plane = meshes::grid(cells, cells, |x, y| {
        let along = |i: u32| f64::from(i) * (12.0 / f64::from(cells)) - 6.0;
        FAR + DVec3::new(along(x), along(y), 0.0)
    });
    let eye = FAR + DVec3::Z * 3.0;
    Setting::from_meshes([plane])
        .with_cameras(PROJECTIONS.map(|projection| camera(eye, FAR, projection, (200, 200), 11.9)))
        .with_generator(move |random| {
            let target = FAR + random.in_cube() * DVec3::new(5.99, 5.99, 0.0);
            Ray::new(eye, (target - eye).normalize())
        })
        .must_hit()
}

fn common_edge(variant: u32) -> Setting {
    let mut random = Random::new(300 + u64::from(variant));
    let scale = random.decade(-6.0, 6.0);
    let [p, q]: [DVec3; 2] = std::array::from_fn(|_| random.in_cube() * scale);
    let aside = (q - p).cross(random.direction());
    let r = p + aside + random.in_cube() * scale * 0.1;
    let s = q - aside - random.in_cube() * scale * 0.1;
    let triangles = if variant.is_multiple_of(2) {
        vec![[0, 1, 2], [1, 0, 3]]
    } else {
        vec![[2, 0, 1], [3, 0, 1]]
    };
    let pair = mesh(vec![p, q, r, s], triangles);
    let middle = (p + q) * 0.5;
    let front = (q - p).cross(aside).normalize();
    let cameras = PROJECTIONS.map(|projection| {
        let eye = middle + front * scale;
        camera(eye, middle, projection, (40, 30), (q - p).length() * 1e-6)
    });
    Setting::from_meshes([pair])
        .with_cameras(cameras)
        .with_generator(move |random| {
            let origin = random.in_cube() * scale * random.decade(0.0, 2.0);
            Ray::new(origin, random.nudge(middle, 2) - origin)
        })
}

fn integer_heights(side: u32) -> Setting {
    let field = meshes::integer_heights(side, 4);
    // One ray per vertex; with half the step also through the middles of edges and diagonals.
    let cameras = [1, 2].map(|halves| {
        let count = (side - 2) * halves;
        let middle = f64::from(side) * 0.5 + 0.5 / f64::from(halves);
        let center = DVec3::new(middle, middle, 0.0);
        let (eye, frame) = (center + DVec3::Z * 100.0, f64::from(side - 2));
        camera(eye, center, Projection::Orthographic, (count, count), frame)
    });
    Setting::from_meshes([field])
        .with_cameras(cameras)
        .with_generator(move |random| {
            let mut half = || f64::from(random.below(2 * side + 1)) * 0.5;
            let origin = DVec3::new(half(), half(), 50.0);
            if random.below(2) == 0 {
                Ray::new(origin, DVec3::NEG_Z)
            } else {
                Ray::new(origin.with_z(-50.0), DVec3::Z * 3.0)
            }
        })
        .must_hit()
}

fn octahedron(_: u32) -> Setting {
    let mut rays = Vec::new();
    for i in -64..=64 {
        let x = f64::from(i) / 64.0;
        for y in [1.0 - x.abs(), x.abs() - 1.0] {
            for turn in 0..3 {
                let turned =
                    |p: [f64; 3]| DVec3::new(p[turn], p[(turn + 1) % 3], p[(turn + 2) % 3]);
                let target = turned([x, y, 0.0]);
                // From an eye on the axis, the silhouette is where |x| + |y| = 1 in the plane across it.
                for eye in [turned([0.0, 0.0, 4.0]), turned([0.0, 0.0, -8.0])] {
                    rays.push(Ray::new(eye, target - eye));
                }
                let axis = turned([0.0, 0.0, 1.0]);
                rays.push(Ray::new(target + axis * 5.0, -axis));
                rays.push(Ray::new(target - axis * 3.0, axis * 0.5));
            }
        }
    }
    // Pixels of 1/32 with centres at multiples of it, so that rays go exactly through the silhouette.
    let aside = DVec3::new(1.0 / 64.0, -1.0 / 64.0, 0.0);
    let cameras = PROJECTIONS
        .map(|projection| camera(aside + DVec3::Z * 4.0, aside, projection, (96, 96), 3.0));
    Setting::from_meshes([meshes::octahedron()])
        .with_rays(rays)
        .with_cameras(cameras)
}

fn horizon(_: u32) -> Setting {
    let (side, half) = (100, 5e3);
    let plane = meshes::grid(side, side, |x, z| {
        let at = |i: u32| f64::from(i) / f64::from(side) * 2.0 * half - half;
        DVec3::new(at(x), 0.0, -at(z))
    });
    let eye = DVec3::new(0.3, 1e-4, 0.2);
    let target = eye - DVec3::Z;
    let camera = camera(eye, target, Projection::Perspective, (64, 256), 1e-3);
    Setting::from_meshes([plane])
        .with_cameras([camera])
        .with_generator(move |random| {
            let far = random.direction().with_y(0.0) * random.decade(-3.0, 3.7);
            Ray::new(eye, (far - eye).normalize())
        })
}

fn small_distant_fan(variant: u32) -> Setting {
    let mut random = Random::new(700 + u64::from(variant));
    let scale = random.decade(-6.0, 6.0);
    let eye = random.in_cube() * scale;
    let middle = eye + random.direction() * scale;
    let sight = (middle - eye).normalize();
    let across = sight.any_orthonormal_vector();
    let along = sight.cross(across);
    let mut positions = vec![middle];
    for i in 0..6 {
        let (sin, cos) = math::sin_cos(TAU * f64::from(i) / 6.0);
        positions.push(middle + (across * cos + along * sin) * scale * 1e-4);
    }
    let fan = mesh(
        positions,
        (0..6).map(|i| [0, 1 + i, 1 + (i + 1) % 6]).collect(),
    );
    let cameras =
        PROJECTIONS.map(|projection| camera(eye, middle, projection, (32, 24), scale * 2.2e-4));
    Setting::from_meshes([fan])
        .with_cameras(cameras)
        .with_generator(move |random| {
            let inside = random.in_cube() * scale * 0.4e-4;
            Ray::new(eye, (middle + inside - eye).normalize())
        })
}
