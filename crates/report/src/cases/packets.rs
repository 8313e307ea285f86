//! Scenes that are hard for kernels that set a triangle up once for many rays.

use super::{Case, CaseTheme, Setting};
use crate::cameras::{PROJECTIONS, camera};
use crate::meshes::{self, mesh, soup};
use raycast_core::Cull;
use raycast_core::camera::{Camera, Projection, Ray};
use raycast_core::glam::{DVec2, DVec3};
use raycast_core::math;
use raycast_core::scene::Mesh;
use raycast_oracle::random::Random;
use std::f64::consts::TAU;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "smaller_than_a_pixel",
        theme: CaseTheme::Packets,
        difficulty: "Triangles from a tenth of a pixel to a few: a set-up serves one ray, or none.",
        variants: 8,
        setting: smaller_than_a_pixel,
    },
    Case {
        name: "changing_density",
        theme: CaseTheme::Packets,
        difficulty: "Cells from 1e-3 to 1e3 in one surface: no one way suits a whole tile.",
        variants: 4,
        setting: changing_density,
    },
    Case {
        name: "around_the_eye",
        theme: CaseTheme::Packets,
        difficulty: "Triangles through the eye and its plane: their projections turn inside out.",
        variants: 12,
        setting: around_the_eye,
    },
    Case {
        name: "edge_on",
        theme: CaseTheme::Packets,
        difficulty: "Triangles whose planes hold the eye, or all but: no side, and no depth, is sure.",
        variants: 20,
        setting: edge_on,
    },
    Case {
        name: "corners_on_pixel_centres",
        theme: CaseTheme::Packets,
        difficulty: "Corners on the centres of pixels, edges through rows of them: zeros, and ties of depth.",
        variants: 24,
        setting: corners_on_pixel_centres,
    },
    Case {
        name: "edges_through_cell_corners",
        theme: CaseTheme::Packets,
        difficulty: "Edges through the corner rays of cells of 8 × 8 and tiles of 64 × 64: a cell is accepted whole, or not, by one ray too many.",
        variants: 40,
        setting: edges_through_cell_corners,
    },
    Case {
        name: "slivers_along_rows",
        theme: CaseTheme::Packets,
        difficulty: "Slivers thinner than a rounding, along rows and columns of rays: a row's bounds leave them out.",
        variants: 20,
        setting: slivers_along_rows,
    },
    Case {
        name: "surfaces_on_one_another",
        theme: CaseTheme::Packets,
        difficulty: "Surfaces a few units in the last place apart, differently cut: rounded depths are in any order.",
        variants: 12,
        setting: surfaces_on_one_another,
    },
    Case {
        name: "crossing_layers",
        theme: CaseTheme::Packets,
        difficulty: "150 layers through one another: a packet is left too early, or shows the wrong side of a crossing.",
        variants: 12,
        setting: crossing_layers,
    },
    Case {
        name: "fan_on_a_pixel",
        theme: CaseTheme::Packets,
        difficulty: "Thousands of triangles that meet in one vertex, on a pixel's centre or next to it.",
        variants: 16,
        setting: fan_on_a_pixel,
    },
    Case {
        name: "ends_of_the_range",
        theme: CaseTheme::Packets,
        difficulty: "Coordinates of 1e-37 and of 1e18: products leave single precision, if not the numbers.",
        variants: 24,
        setting: ends_of_the_range,
    },
    Case {
        name: "narrow_and_wide",
        theme: CaseTheme::Packets,
        difficulty: "Views from a millionth of a degree to all but half a turn: directions all alike, or out of proportion.",
        variants: 20,
        setting: narrow_and_wide,
    },
    Case {
        name: "narrower_than_rounding",
        theme: CaseTheme::Packets,
        difficulty: "A view of a corner so narrow that neighbouring rays are a few roundings apart: a row of rays is no straight line.",
        variants: 24,
        setting: narrower_than_rounding,
    },
];

const CULLS: [Cull; 2] = [Cull::None, Cull::Back];

/// A sphere with a random radius at each vertex.
fn bumpy(random: &mut Random, center: DVec3, radius: f64, steps: u32, bumps: f64) -> Mesh {
    let smooth = meshes::sphere(DVec3::ZERO, 1.0, steps);
    let positions = smooth
        .positions()
        .iter()
        .map(|p| center + p.as_dvec3() * radius * (1.0 + random.between(-bumps, bumps)))
        .collect();
    mesh(positions, smooth.triangles().to_vec())
}

fn smaller_than_a_pixel(variant: u32) -> Setting {
    let mut random = Random::new(100 + u64::from(variant));
    let (steps, bumps, pixels) = [
        (500, 0.003, 150),
        (500, 0.02, 40),
        (200, 0.1, 100),
        (60, 0.3, 90),
    ][variant as usize % 4];
    let center = match variant / 4 % 2 {
        0 => DVec3::ZERO,
        _ => DVec3::new(148_376.0, 1234.0, -223_423.0),
    };
    let cameras = PROJECTIONS.map(|projection| {
        let eye = center + random.direction() * 3.0;
        camera(eye, center, projection, (pixels + 11, pixels), 2.3)
    });
    Setting::from_meshes([bumpy(&mut random, center, 1.0, steps, bumps)])
        .with_cameras(cameras)
        .with_cull(CULLS[variant as usize % 2])
}

fn changing_density(variant: u32) -> Setting {
    // Each cell is 10 % longer than the one before.
    let place = |i: u32| 1e-3 * 1.1f64.powi(i as i32);
    let ground = meshes::grid(140, 140, |x, y| {
        DVec3::new(place(x), place(y), 0.02 * f64::from((x * 7 + y * 3) % 5))
    });
    let height = [1.0, 0.05, 30.0, 1000.0][variant as usize % 4];
    let target = DVec3::new(height * 0.55, height * 0.45, 0.0);
    let eye = target + DVec3::new(0.1, -0.2, 1.0) * height;
    Setting::from_meshes([ground]).with_cameras(
        PROJECTIONS.map(|projection| camera(eye, target, projection, (130, 90), height)),
    )
}

fn around_the_eye(variant: u32) -> Setting {
    let mut random = Random::new(1030 + u64::from(variant));
    let scale = random.decade(-6.0, 6.0);
    let eye = match variant % 3 {
        0 => DVec3::ZERO,
        1 => random.in_cube() * scale,
        _ => random.direction() * scale * 1e5,
    };
    let corners: Vec<[DVec3; 3]> = (0..30)
        .map(|i| {
            let mut corner = || eye + random.direction() * scale * random.decade(-3.0, 3.0);
            let [a, b, c] = [corner(), corner(), corner()];
            match i % 5 {
                // The eye is a corner, the middle of an edge, or the centroid.
                0 => [eye, b, c],
                1 => [a, eye * 2.0 - a, c],
                2 => [a, b, eye * 3.0 - a - b],
                _ => [a, b, c],
            }
        })
        .collect();
    let cameras = PROJECTIONS.map(|projection| {
        let target = eye + random.direction() * scale;
        let height = scale * random.decade(-2.0, 2.0);
        camera(eye, target, projection, (53, 42), height)
    });
    Setting::from_meshes([soup(&corners)])
        .with_cameras(cameras)
        .with_cull(CULLS[variant as usize % 2])
}

fn edge_on(variant: u32) -> Setting {
    let mut random = Random::new(1040 + u64::from(variant));
    let scale = random.decade(-4.0, 4.0);
    let eye = match variant % 2 {
        0 => DVec3::ZERO,
        _ => random.in_cube() * scale * 100.0,
    };
    let corners: Vec<[DVec3; 3]> = (0..60)
        .map(|i| {
            let near = random.direction() * scale;
            let far = near * random.between(1.0, 30.0);
            let aside = random.direction() * scale * random.decade(-9.0, 0.0);
            let [a, b, c] = [near, far, near + aside].map(|p| eye + p);
            if i % 2 == 0 {
                [a, b, c]
            } else {
                // All three corners are in one plane with the eye, up to rounding.
                let third = eye + (a - eye) * 0.7 + (c - eye) * 0.9;
                [a, c, random.nudge(third, 2)]
            }
        })
        .collect();
    let floor = meshes::grid(6, 6, |x, y| {
        eye + DVec3::new(f64::from(x) - 3.0, f64::from(y) - 3.0, -3.0) * scale
    });
    let targets = [corners[0][0], corners[1][1], eye - DVec3::Z * scale];
    let cameras: Vec<Camera> = targets
        .into_iter()
        .flat_map(|target| PROJECTIONS.map(|projection| (target, projection)))
        .map(|(target, projection)| {
            let height = (target - eye).length() * random.decade(-3.0, 0.5);
            camera(eye, target, projection, (64, 50), height)
        })
        .collect();
    Setting::from_meshes([soup(&corners), floor])
        .with_cameras(cameras)
        .with_cull(CULLS[variant as usize / 2 % 2])
}

fn corners_on_pixel_centres(variant: u32) -> Setting {
    let mut random = Random::new(1050 + u64::from(variant));
    let scale = 2f64.powi([0, 0, -40, 40, -17, 23][variant as usize % 6]);
    let depths = [0.0, 8.0, -8.0, -24.0];
    let is_flat = variant.is_multiple_of(2);
    let shift = match variant / 6 % 2 {
        0 => DVec3::ZERO,
        _ => DVec3::new(65_536.0, -1024.0, 4096.0) * scale,
    };
    let corners: Vec<[DVec3; 3]> = (0..80)
        .map(|_| {
            let z = depths[random.below(4) as usize];
            let spread = [3, 17, 65][random.below(3) as usize];
            let start = DVec2::new(f64::from(random.below(65)), f64::from(random.below(65)));
            std::array::from_fn(|_| {
                let x = start.x + f64::from(random.below(spread)) - 32.0;
                let y = start.y + f64::from(random.below(spread)) - 32.0;
                let z = if is_flat {
                    z
                } else {
                    depths[random.below(4) as usize]
                };
                // The same position in the perspective picture at another depth.
                let shrunk = (32.0 - z) / 32.0 * 0.25;
                shift + DVec3::new(x * shrunk, y * shrunk, z * 0.25) * scale
            })
        })
        .collect();
    // Pixels have a size of a quarter and are shifted by half of it, so that their centres coincide with possible
    // corners.
    let aside = shift + DVec3::new(0.125, -0.125, 0.0) * scale;
    let eye = aside + DVec3::Z * 8.0 * scale;
    Setting::from_meshes([soup(&corners)])
        .with_cameras(
            PROJECTIONS.map(|projection| camera(eye, aside, projection, (72, 72), 18.0 * scale)),
        )
        .with_cull(CULLS[variant as usize % 2])
}

/// Triangles with an edge along the line through two corner rays of cells: a cell is covered completely, or but for
/// one ray.
fn edges_through_cell_corners(variant: u32) -> Setting {
    let mut random = Random::new(1060 + u64::from(variant));
    let projection = PROJECTIONS[variant as usize % 2];
    let shift = match variant / 2 % 2 {
        0 => DVec3::ZERO,
        _ => DVec3::new(3000.0, -7000.0, 500.0),
    };
    let eye = shift + DVec3::new(0.3, -0.2, 5.0);
    let camera = camera(eye, shift, projection, (136, 136), 3.0);
    // Few triangles too, because many occlude one another.
    let count = [24, 2, 1][variant as usize / 4 % 3];
    let corners: Vec<[DVec3; 3]> = (0..count)
        .map(|_| {
            let depth = random.between(-2.0, 2.0);
            let mut place = || {
                let side = [8, 8, 64][random.below(3) as usize];
                let inner = [0, side - 1][random.below(2) as usize];
                f64::from(random.below(136 / side) * side + inner) + 0.5
            };
            let [p, q] = [(place(), place()), (place(), place())];
            let at = |(x, y): (f64, f64)| {
                let ray = camera.ray(x, y);
                ray.at((depth + shift.z - ray.origin.z) / ray.direction.z)
            };
            let (a, b) = (at(p), at(q));
            let along = b - a;
            let tilt = DVec3::new(0.1, 0.2, 0.3) * random.between(-1.0, 1.0);
            let aside = DVec3::new(-along.y, along.x, 0.0) + tilt;
            let [a, b] = [random.nudge(a, 1), random.nudge(b, 1)];
            let reach = random.between(0.0, 3.0);
            let third = a + aside * random.decade(-1.0, 1.5);
            [a - along * reach, b + along * reach, third]
        })
        .collect();
    Setting::from_meshes([soup(&corners)])
        .with_cameras([camera])
        .with_cull(CULLS[variant as usize / 12 % 2])
}

fn slivers_along_rows(variant: u32) -> Setting {
    let mut random = Random::new(1070 + u64::from(variant));
    let projection = PROJECTIONS[variant as usize % 2];
    let scale = 2f64.powi([0, -40, 40, 3][variant as usize % 4]);
    let eye = DVec3::new(0.0, 0.0, 4.0) * scale;
    let camera = camera(eye, DVec3::ZERO, projection, (80, 72), 9.0 * scale);
    let corners: Vec<[DVec3; 3]> = (0..70)
        .map(|i| {
            let is_row = i % 2 == 0;
            let row = f64::from(random.below(72)) + 0.5;
            let thickness = scale * random.decade(-12.0, -1.0);
            let at = |x: f64| {
                let ray = if is_row {
                    camera.ray(x, row)
                } else {
                    camera.ray(row, x)
                };
                ray.at(-ray.origin.z / ray.direction.z)
            };
            let (a, b) = (
                at(random.between(-5.0, 60.0)),
                at(random.between(20.0, 90.0)),
            );
            let aside = if is_row { DVec3::Y } else { DVec3::X };
            let middle = a + (b - a) * random.between(-0.5, 1.5) + aside * thickness;
            if i % 3 == 0 {
                [random.nudge(a, 1), random.nudge(b, 1), middle]
            } else {
                [a, b, middle]
            }
        })
        .collect();
    Setting::from_meshes([soup(&corners)])
        .with_cameras([camera])
        .with_cull(CULLS[variant as usize / 4 % 2])
}

fn surfaces_on_one_another(variant: u32) -> Setting {
    let mut random = Random::new(1080 + u64::from(variant));
    let base = [100.0, 1.0, 3e5][variant as usize % 3];
    let slope = [0.0, 0.0, 0.5, 3.0][variant as usize % 4];
    let size = base * 0.02;
    let mut layers: Vec<Mesh> = (0..10)
        .map(|i| {
            let ulps = [0, 0, 1, -1, 2, 8, -4][i % 7];
            let z = f32::from_bits((base as f32).to_bits().wrapping_add_signed(ulps));
            let cells = [1, 1, 3, 8, 20][random.below(5) as usize];
            let is_turned = random.below(2) == 0;
            meshes::grid(cells, cells, |x, y| {
                let at = |i: u32| (f64::from(i) / f64::from(cells) - 0.5) * size;
                let x = at(if is_turned { cells - x } else { x });
                DVec3::new(x, at(y), f64::from(z) + x * slope)
            })
        })
        .collect();
    layers.push(layers[2].clone());
    let target = DVec3::new(0.0, 0.0, base);
    let eyes = [DVec3::ZERO, DVec3::new(size, size * 0.3, base * 2.0)];
    let cameras = eyes.into_iter().flat_map(|eye| {
        PROJECTIONS.map(|projection| camera(eye, target, projection, (70, 58), size * 0.9))
    });
    Setting::from_meshes(layers)
        .with_cameras(cameras)
        .with_cull(CULLS[variant as usize % 2])
}

fn crossing_layers(variant: u32) -> Setting {
    let mut random = Random::new(1090 + u64::from(variant));
    let corners: Vec<[DVec3; 3]> = (0..150)
        .map(|i| {
            let z = f64::from(i % 50) * 0.02;
            let tilt = random.decade(-7.0, 0.0);
            std::array::from_fn(|corner| {
                let turn = TAU * (corner as f64 / 3.0 + random.between(0.0, 0.2));
                let z = z + random.between(-tilt, tilt);
                DVec3::new(math::cos(turn) * 3.0, math::sin(turn) * 3.0, z)
            })
        })
        .collect();
    let eye = DVec3::new(0.2, 0.1, [4.0, -3.0, 0.5][variant as usize % 3]);
    let target = DVec3::new(0.0, 0.0, 0.51);
    Setting::from_meshes([soup(&corners)])
        .with_cameras(PROJECTIONS.map(|projection| camera(eye, target, projection, (67, 67), 2.0)))
        .with_cull(CULLS[variant as usize % 2])
}

fn fan_on_a_pixel(variant: u32) -> Setting {
    let mut random = Random::new(1120 + u64::from(variant));
    let spokes = [50, 6, 1000, 5000][variant as usize % 4];
    let projection = PROJECTIONS[variant as usize / 4 % 2];
    let eye = DVec3::new(0.5, 0.25, 4.0);
    let camera = camera(eye, eye.with_z(0.0), projection, (96, 64), 4.0);
    let through = camera.ray(40.5, 30.5);
    let middle = through.at((0.5 - through.origin.z) / through.direction.z);
    let mut positions = vec![match variant / 8 % 2 {
        0 => middle,
        _ => random.nudge(middle, 2),
    }];
    for i in 0..spokes {
        let (sin, cos) = math::sin_cos(TAU * f64::from(i) / f64::from(spokes));
        let reach = random.between(0.5, 6.0);
        positions.push(DVec3::new(cos, sin, random.between(-0.1, 0.1)) * reach);
    }
    let triangles = (0..spokes).map(|i| [0, 1 + i, 1 + (i + 1) % spokes]);
    let fan = mesh(positions, triangles.collect());
    // Long edges close to each other, behind the fan.
    let strip = meshes::grid(1, 40, |x, y| {
        let (x, y) = (f64::from(x) - 0.5, f64::from(y) * 0.1 - 2.0);
        DVec3::new(x * 200.0, y, -1.0)
    });
    Setting::from_meshes([fan, strip]).with_cameras([camera])
}

fn ends_of_the_range(variant: u32) -> Setting {
    let mut random = Random::new(1130 + u64::from(variant));
    let scale = [1e-37, 1e-30, 1e-20, 1e12, 1e17, 0.9e18][variant as usize % 6];
    let count = 1 + random.below(60);
    let inside = meshes::random_soup(&mut random, count, DVec3::ZERO, scale * 0.5, 0.9);
    let around = meshes::cuboid(DVec3::splat(-scale), DVec3::splat(scale));
    let reach = [0.9, 3.0][variant as usize / 6 % 2];
    let cameras = PROJECTIONS.map(|projection| {
        let eye = random.in_cube() * scale * reach;
        let target = random.in_cube() * scale * 0.1;
        camera(eye, target, projection, (49, 43), scale)
    });
    Setting::from_meshes([inside, around])
        .with_cameras(cameras)
        .with_cull(CULLS[variant as usize / 12 % 2])
}

fn narrow_and_wide(variant: u32) -> Setting {
    let mut random = Random::new(1100 + u64::from(variant));
    let meshes = [
        bumpy(&mut random, DVec3::ZERO, 1.0, 48, 0.1),
        meshes::random_soup(&mut random, 200, DVec3::ZERO, 8.0, 0.3),
        meshes::cuboid(DVec3::splat(-30.0), DVec3::splat(30.0)),
    ];
    let eye = random.direction() * random.between(1.5, 20.0);
    let target = random.in_cube();
    let height = (eye - target).length() * random.decade(-7.0, 4.0);
    let projection = match variant % 4 {
        3 => Projection::Orthographic,
        _ => Projection::Perspective,
    };
    Setting::from_meshes(meshes)
        .with_cameras([camera(eye, target, projection, (61, 45), height)])
        .with_cull(CULLS[variant as usize / 2 % 2])
        .with_generator(move |random| Ray::new(eye, random.in_cube() * 8.0 - eye))
}

fn narrower_than_rounding(variant: u32) -> Setting {
    let mut random = Random::new(1200 + u64::from(variant));
    // A single triangle: within a surface, its neighbour would hide that a ray misses it.
    let corners = [(); 3].map(|()| random.in_cube().as_vec3().as_dvec3());
    let target = corners[0];
    let eye = target + random.direction() * random.between(2.0, 9.0);
    let height = (eye - target).length() * random.decade(-13.5, -8.0);
    Setting::from_meshes([soup(&[corners])]).with_cameras(
        PROJECTIONS.map(|projection| camera(eye, target, projection, (61, 45), height)),
    )
}
