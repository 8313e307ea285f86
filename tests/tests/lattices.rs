//! Lattices of rays, cast together, against the same rays cast one by one and against the truth:
//! scenes that are hard for a kernel that sets a triangle up once for many rays.
//!
//! How the truth is known: rational arithmetic on the vertices as stored (`raycast-oracle`). Every
//! ray of every lattice is compared with its own single ray, bit for bit, with every instruction set
//! of the machine, exact and fast.

#![allow(clippy::print_stdout, reason = "tests tell what they checked")]

use raycast_core::camera::{Camera, ImagePlane, Lattice, Placement, Rect};
use raycast_core::glam::{DVec2, DVec3};
use raycast_core::intersect::Cull;
use raycast_core::scene::Mesh;
use raycast_oracle::random::Random;
use raycast_report::meshes::{self, soup};
use raycast_tests::check::{Check, PROJECTIONS, Stage, camera};

/// The rays through the middle of all of a camera's pixels.
fn whole(camera: Camera) -> Lattice {
    let plane = camera.plane();
    let rect = Rect {
        x: 0,
        y: 0,
        width: plane.columns,
        height: plane.rows,
    };
    Lattice::new(camera, rect, 1, (0, 0))
}

/// Some of a camera's rays: a rectangle, a stride, a phase and a place in the pixel, all at random.
fn part(random: &mut Random, camera: Camera) -> Lattice {
    let plane = camera.plane();
    let (x, y) = (random.below(plane.columns), random.below(plane.rows));
    let rect = Rect {
        x,
        y,
        width: 1 + random.below(plane.columns - x),
        height: 1 + random.below(plane.rows - y),
    };
    let stride = [1, 1, 2, 3, 4, 7, 8, 16][random.below(8) as usize];
    let phase = (random.below(stride), random.below(stride));
    let offset = match random.below(3) {
        0 => (0.0, 0.0),
        1 => (0.5, 0.5),
        _ => (random.between(0.0, 1.0), random.between(0.0, 1.0)),
    };
    Lattice {
        offset,
        ..Lattice::new(camera, rect, stride, phase)
    }
}

/// What was checked, told at the end.
struct Tally {
    name: &'static str,
    rays: usize,
    hits: usize,
}

impl Tally {
    fn new(name: &'static str) -> Self {
        Self {
            name,
            rays: 0,
            hits: 0,
        }
    }

    fn check(&mut self, stage: &Stage, lattice: &Lattice, cull: Cull, every: usize) {
        self.rays += lattice.len();
        self.hits += stage.check_lattice(lattice, cull, every);
    }

    /// At least this share of the rays must have met something, or nothing was tested.
    fn end(self, least: f64) {
        let Self { name, rays, hits } = self;
        println!("{name}: {rays} rays, {hits} hits, none wrong");
        assert!(
            hits as f64 >= least * rays as f64,
            "{name}: {hits} of {rays}"
        );
    }
}

const CULLS: [Cull; 2] = [Cull::None, Cull::Back];

/// A sphere whose radius changes from vertex to vertex.
fn bumpy(random: &mut Random, center: DVec3, radius: f64, steps: u32, bumps: f64) -> Mesh {
    let smooth = meshes::sphere(DVec3::ZERO, 1.0, steps);
    let positions = smooth
        .positions()
        .iter()
        .map(|p| center + p.as_dvec3() * radius * (1.0 + random.between(-bumps, bumps)))
        .collect();
    meshes::mesh(positions, smooth.triangles().to_vec())
}

/// Triangles from much smaller than a pixel to a few pixels, in one picture.
#[test]
fn triangles_smaller_than_a_pixel() {
    let mut tally = Tally::new("triangles smaller than a pixel");
    let mut random = Random::new(101);
    for (steps, bumps, pixels) in [
        (500, 0.003, 150),
        (500, 0.02, 40),
        (200, 0.1, 100),
        (60, 0.3, 90),
    ] {
        for center in [DVec3::ZERO, DVec3::new(148_376.0, 1234.0, -223_423.0)] {
            let stage = Stage::of([bumpy(&mut random, center, 1.0, steps, bumps)]);
            for projection in PROJECTIONS {
                let eye = center + random.direction() * 3.0;
                let camera = camera(eye, center, projection, (pixels + 11, pixels), 2.3);
                for cull in CULLS {
                    tally.check(&stage, &whole(camera), cull, 40);
                }
            }
        }
    }
    tally.end(0.4);
}

/// One surface from far below a pixel to far above it: the density changes within a tile.
#[test]
fn density_that_changes_within_a_tile() {
    let mut tally = Tally::new("density that changes");
    // Cells grow by a tenth from one to the next, from 1e-3 to 1e3.
    let place = |i: u32| 1e-3 * 1.1f64.powi(i as i32);
    let stage = Stage::of([meshes::grid(140, 140, |x, y| {
        DVec3::new(place(x), place(y), 0.02 * f64::from((x * 7 + y * 3) % 5))
    })]);
    let mut random = Random::new(102);
    for projection in PROJECTIONS {
        for height in [0.05, 1.0, 30.0, 1000.0] {
            let target = DVec3::new(height * 0.55, height * 0.45, 0.0);
            let eye = target + DVec3::new(0.1, -0.2, 1.0) * height;
            let camera = camera(eye, target, projection, (130, 90), height);
            tally.check(&stage, &whole(camera), Cull::None, 40);
            tally.check(&stage, &part(&mut random, camera), Cull::None, 40);
        }
    }
    tally.end(0.5);
}

/// Triangles a thousand times the view, in front of, beside, behind and through the eye.
#[test]
fn triangles_around_the_eye() {
    let mut tally = Tally::new("triangles around the eye");
    let mut random = Random::new(103);
    for round in 0..24 {
        let scale = random.decade(-6.0, 6.0);
        let eye = match round % 3 {
            0 => DVec3::ZERO,
            1 => random.in_cube() * scale,
            _ => random.direction() * scale * 1e5,
        };
        let corners: Vec<[DVec3; 3]> = (0..30)
            .map(|i| {
                let mut corner = || eye + random.direction() * scale * random.decade(-3.0, 3.0);
                let [a, b, c] = [corner(), corner(), corner()];
                match i % 5 {
                    // A corner, an edge or the plane through the eye itself.
                    0 => [eye, b, c],
                    1 => [a, eye * 2.0 - a, c],
                    2 => [a, b, eye * 3.0 - a - b],
                    _ => [a, b, c],
                }
            })
            .collect();
        let stage = Stage::of([soup(&corners)]);
        for projection in PROJECTIONS {
            let target = eye + random.direction() * scale;
            let height = scale * random.decade(-2.0, 2.0);
            let camera = camera(eye, target, projection, (77, 66), height);
            let cull = CULLS[round % 2];
            tally.check(&stage, &whole(camera), cull, 20);
            tally.check(&stage, &part(&mut random, camera), cull, 20);
        }
    }
    tally.end(0.5);
}

/// Triangles whose planes hold the eye, or pass it by a few units in the last place.
#[test]
fn slivers_seen_from_their_edge() {
    let mut tally = Tally::new("slivers seen from their edge");
    let mut random = Random::new(104);
    for round in 0..20 {
        let scale = random.decade(-4.0, 4.0);
        let eye = [DVec3::ZERO, random.in_cube() * scale * 100.0][round % 2];
        let corners: Vec<[DVec3; 3]> = (0..60)
            .map(|i| {
                let near = random.direction() * scale;
                let far = near * random.between(1.0, 30.0);
                let aside = random.direction() * scale * random.decade(-9.0, 0.0);
                let corners = [near, far, near + aside].map(|p| eye + p);
                if i % 2 == 0 {
                    corners
                } else {
                    // In a plane through the eye, all three, as near as numbers allow.
                    let [a, b] = [corners[0], corners[2]];
                    let c = eye + (a - eye) * 0.7 + (b - eye) * 0.9;
                    [a, b, random.nudge(c, 2)]
                }
            })
            .collect();
        let floor = meshes::grid(6, 6, |x, y| {
            eye + DVec3::new(f64::from(x) - 3.0, f64::from(y) - 3.0, -3.0) * scale
        });
        let stage = Stage::of([soup(&corners), floor]);
        for projection in PROJECTIONS {
            for target in [corners[0][0], corners[1][1], eye - DVec3::Z * scale] {
                let height = (target - eye).length() * random.decade(-3.0, 0.5);
                let camera = camera(eye, target, projection, (64, 50), height);
                tally.check(&stage, &whole(camera), CULLS[round / 2 % 2], 20);
            }
        }
    }
    tally.end(0.1);
}

/// Corners on the centres of pixels, edges through rows of centres: every sign may be zero.
#[test]
fn corners_on_the_centres_of_pixels() {
    let mut tally = Tally::new("corners on the centres of pixels");
    let mut random = Random::new(105);
    for round in 0..24 {
        let power = [0, 0, -40, 40, -17, 23][round % 6];
        let scale = 2f64.powi(power);
        let depths = [0.0, 8.0, -8.0, -24.0];
        let flat = round % 2 == 0;
        let corners: Vec<[DVec3; 3]> = (0..80)
            .map(|_| {
                let z = depths[random.below(4) as usize];
                let spread = [3, 17, 65][random.below(3) as usize];
                let start = DVec2::new(f64::from(random.below(65)), f64::from(random.below(65)));
                std::array::from_fn(|_| {
                    let x = start.x + f64::from(random.below(spread)) - 32.0;
                    let y = start.y + f64::from(random.below(spread)) - 32.0;
                    let z = if flat {
                        z
                    } else {
                        depths[random.below(4) as usize]
                    };
                    // The same place of the picture, nearer or further.
                    DVec3::new(x * (32.0 - z) / 32.0, y * (32.0 - z) / 32.0, z) * 0.25 * scale
                })
            })
            .collect();
        let shift = [DVec3::ZERO, DVec3::new(65_536.0, -1024.0, 4096.0)][round / 6 % 2] * scale;
        let moved: Vec<_> = corners.iter().map(|c| c.map(|p| p + shift)).collect();
        let stage = Stage::of([soup(&moved)]);
        for projection in PROJECTIONS {
            // Half a pixel aside, a quarter wide: centres lie where the corners may.
            let aside = shift + DVec3::new(0.125, -0.125, 0.0) * scale;
            let eye = aside + DVec3::Z * 8.0 * scale;
            let camera = camera(eye, aside, projection, (72, 72), 18.0 * scale);
            let cull = CULLS[round % 2];
            tally.check(&stage, &whole(camera), cull, 10);
            tally.check(&stage, &part(&mut random, camera), cull, 10);
        }
    }
    tally.end(0.3);
}

/// Edges through the corners of blocks of 8 and 64 rays, on them and a hair to either side: a
/// triangle that holds a whole block, or all of it but one ray.
#[test]
fn edges_through_the_corners_of_blocks() {
    let mut tally = Tally::new("edges through the corners of blocks");
    let mut random = Random::new(106);
    for round in 0..40 {
        let projection = PROJECTIONS[round % 2];
        let far = round % 4 / 2;
        let shift = [DVec3::ZERO, DVec3::new(3000.0, -7000.0, 500.0)][far];
        let eye = shift + DVec3::new(0.3, -0.2, 5.0);
        let camera = camera(eye, shift, projection, (136, 136), 3.0);
        let corners: Vec<[DVec3; 3]> = (0..24)
            .map(|_| {
                let depth = random.between(-2.0, 2.0);
                // Two rays at blocks' corners; the edge through them goes on beyond both.
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
                let aside = DVec3::new(-along.y, along.x, 0.0)
                    + DVec3::new(0.1, 0.2, 0.3) * random.between(-1.0, 1.0);
                let [a, b] = [random.nudge(a, 1), random.nudge(b, 1)];
                let reach = random.between(0.0, 3.0);
                [
                    a - along * reach,
                    b + along * reach,
                    a + aside * random.decade(-1.0, 1.5),
                ]
            })
            .collect();
        // Few at a time too: many hide each other.
        for corners in [&corners[..], &corners[..2], &corners[2..3]] {
            let stage = Stage::of([soup(corners)]);
            tally.check(&stage, &whole(camera), CULLS[round / 4 % 2], 20);
        }
    }
    tally.end(0.1);
}

/// Slivers along rows and columns of pixels' centres, thinner than a rounding: the bounds of a row
/// must let through what may touch it.
#[test]
fn slivers_along_rows() {
    let mut tally = Tally::new("slivers along rows");
    let mut random = Random::new(107);
    for round in 0..20 {
        let projection = PROJECTIONS[round % 2];
        let eye = DVec3::new(0.0, 0.0, 4.0);
        let scale = 2f64.powi([0, -40, 40, 3][round % 4]);
        let camera = camera(eye * scale, DVec3::ZERO, projection, (80, 72), 9.0 * scale);
        let corners: Vec<[DVec3; 3]> = (0..70)
            .map(|i| {
                let row = f64::from(random.below(72)) + 0.5;
                let thickness = scale * random.decade(-12.0, -1.0);
                let at = |x: f64, y: f64| {
                    let ray = if i % 2 == 0 {
                        camera.ray(x, y)
                    } else {
                        camera.ray(y, x)
                    };
                    ray.at(-ray.origin.z / ray.direction.z)
                };
                let (left, right) = (random.between(-5.0, 60.0), random.between(20.0, 90.0));
                let (a, b) = (at(left, row), at(right, row));
                let aside = if i % 2 == 0 { DVec3::Y } else { DVec3::X };
                let middle = a + (b - a) * random.between(-0.5, 1.5) + aside * thickness;
                if i % 3 == 0 {
                    [random.nudge(a, 1), random.nudge(b, 1), middle]
                } else {
                    [a, b, middle]
                }
            })
            .collect();
        let stage = Stage::of([soup(&corners)]);
        tally.check(&stage, &whole(camera), CULLS[round / 4 % 2], 20);
    }
    tally.end(0.02);
}

/// Surfaces a unit in the last place apart, the same ones twice, and tessellated otherwise: the
/// order of depths and of numbers is all that tells them apart.
#[test]
fn surfaces_on_one_another() {
    let mut tally = Tally::new("surfaces on one another");
    let mut random = Random::new(108);
    for round in 0..12 {
        let base = [100.0, 1.0, 3e5][round % 3];
        let size = base * 0.02;
        let layer = |random: &mut Random, cells: u32, slope: f64, ulps: i32| {
            let z = f64::from(f32::from_bits(
                (base as f32).to_bits().wrapping_add_signed(ulps),
            ));
            let turned = random.below(2) == 0;
            meshes::grid(cells, cells, |x, y| {
                let at = |i: u32| (f64::from(i) / f64::from(cells) - 0.5) * size;
                let (x, y) = if turned {
                    (at(cells - x), at(y))
                } else {
                    (at(x), at(y))
                };
                DVec3::new(x, y, z + x * slope)
            })
        };
        let slope = [0.0, 0.0, 0.5, 3.0][round % 4];
        let mut layers: Vec<Mesh> = (0..10)
            .map(|i| {
                let cells = [1, 1, 3, 8, 20][random.below(5) as usize];
                layer(&mut random, cells, slope, [0, 0, 1, -1, 2, 8, -4][i % 7])
            })
            .collect();
        layers.push(layers[2].clone());
        let stage = Stage::of(layers);
        for projection in PROJECTIONS {
            for eye in [
                DVec3::new(0.0, 0.0, 0.0),
                DVec3::new(size, size * 0.3, base * 2.0),
            ] {
                let target = DVec3::new(0.0, 0.0, base);
                let camera = camera(eye, target, projection, (70, 58), size * 0.9);
                tally.check(&stage, &whole(camera), CULLS[round % 2], 20);
            }
        }
    }
    tally.end(0.3);
}

/// Many layers behind one another, crossing each other: what is nearest changes from ray to ray, and
/// whole blocks are soon covered.
#[test]
fn layers_that_cross() {
    let mut tally = Tally::new("layers that cross");
    let mut random = Random::new(109);
    for round in 0..12 {
        let corners: Vec<[DVec3; 3]> = (0..150)
            .map(|i| {
                let z = f64::from(i % 50) * 0.02;
                let tilt = random.decade(-7.0, 0.0);
                std::array::from_fn(|corner| {
                    let turn =
                        std::f64::consts::TAU * (corner as f64 / 3.0 + random.between(0.0, 0.2));
                    DVec3::new(
                        turn.cos() * 3.0,
                        turn.sin() * 3.0,
                        z + random.between(-tilt, tilt),
                    )
                })
            })
            .collect();
        let stage = Stage::of([soup(&corners)]);
        for projection in PROJECTIONS {
            let eye = DVec3::new(0.2, 0.1, [4.0, -3.0, 0.5][round % 3]);
            let target = DVec3::new(0.0, 0.0, 0.51);
            let camera = camera(eye, target, projection, (67, 67), 2.0);
            tally.check(&stage, &whole(camera), CULLS[round % 2], 20);
        }
    }
    tally.end(0.5);
}

/// Narrow to a millionth of a degree and wide to a thousandth less than half a turn, and the far
/// corner of a picture of a gigapixel.
#[test]
fn narrow_wide_and_far_off_the_axis() {
    let mut tally = Tally::new("narrow, wide, off the axis");
    let mut random = Random::new(110);
    let stage = Stage::of([
        bumpy(&mut random, DVec3::ZERO, 1.0, 48, 0.1),
        meshes::random_soup(&mut random, 200, DVec3::ZERO, 8.0, 0.3),
        meshes::cuboid(DVec3::splat(-30.0), DVec3::splat(30.0)),
    ]);
    for round in 0..30 {
        let projection = PROJECTIONS[round % 2];
        let eye = random.direction() * random.between(1.5, 20.0);
        let target = random.in_cube();
        let distance = (eye - target).length();
        let height = distance * random.decade(-7.0, 4.0);
        let narrow = camera(eye, target, projection, (61, 45), height);
        tally.check(&stage, &whole(narrow), CULLS[round / 2 % 2], 10);
        let plane = ImagePlane::new(32_768, 32_768, height / 32_768.0).expect("a good plane");
        let placement = Placement {
            eye,
            target,
            up: DVec3::Y,
        };
        let vast = Camera::new(placement, projection, plane);
        let rect = Rect {
            x: random.below(32_700),
            y: random.below(32_700),
            width: 68,
            height: 41,
        };
        tally.check(&stage, &Lattice::new(vast, rect, 1, (0, 0)), Cull::None, 10);
        let coarse = Rect {
            x: 0,
            y: 0,
            width: 32_768,
            height: 32_768,
        };
        let lattice = Lattice::new(vast, coarse, 499, (round as u32, 7));
        tally.check(&stage, &lattice, Cull::None, 10);
    }
    tally.end(0.3);
}

/// Every size from one ray up, across the borders of blocks of 8 and 64.
#[test]
fn lattices_of_every_size() {
    let mut tally = Tally::new("lattices of every size");
    let mut random = Random::new(111);
    let stage = Stage::of([bumpy(&mut random, DVec3::ZERO, 1.0, 24, 0.2)]);
    let sizes = [0, 1, 2, 7, 8, 9, 15, 16, 17, 31, 63, 64, 65, 72, 127, 129];
    for projection in PROJECTIONS {
        let camera = camera(
            DVec3::new(1.0, 0.5, 3.0),
            DVec3::ZERO,
            projection,
            (150, 140),
            2.0,
        );
        for &width in &sizes {
            for height in [0, 1, 3, 8, 9, 64, 65] {
                let (x, y) = (random.below(150 - width), random.below(140 - height));
                let rect = Rect {
                    x,
                    y,
                    width,
                    height,
                };
                tally.check(
                    &stage,
                    &Lattice::new(camera, rect, 1, (0, 0)),
                    Cull::None,
                    50,
                );
            }
        }
        for _ in 0..60 {
            tally.check(&stage, &part(&mut random, camera), Cull::None, 10);
        }
    }
    tally.end(0.5);
}

/// A fan of long thin triangles that meet in one vertex, on a pixel's centre or near it, and a strip
/// whose triangles share long edges.
#[test]
fn fans_and_strips() {
    let mut tally = Tally::new("fans and strips");
    let mut random = Random::new(112);
    for round in 0..16 {
        let spokes = [6, 50, 1000, 5000][round % 4];
        let projection = PROJECTIONS[round / 4 % 2];
        let eye = DVec3::new(0.5, 0.25, 4.0);
        let camera = camera(eye, DVec3::new(0.5, 0.25, 0.0), projection, (96, 64), 4.0);
        let through = camera.ray(40.5, 30.5);
        let middle = through.at((0.5 - through.origin.z) / through.direction.z);
        let middle = if round % 2 == 0 {
            middle
        } else {
            random.nudge(middle, 2)
        };
        let mut positions = vec![middle];
        for i in 0..spokes {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(spokes)).sin_cos();
            let reach = random.between(0.5, 6.0);
            positions.push(DVec3::new(cos, sin, random.between(-0.1, 0.1)) * reach);
        }
        let triangles = (0..spokes)
            .map(|i| [0, 1 + i, 1 + (i + 1) % spokes])
            .collect();
        let fan = meshes::mesh(positions, triangles);
        let strip = meshes::grid(1, 40, |x, y| {
            DVec3::new((f64::from(x) - 0.5) * 200.0, f64::from(y) * 0.1 - 2.0, -1.0)
        });
        let stage = Stage::of([fan, strip]);
        tally.check(&stage, &whole(camera), Cull::None, 10);
        tally.check(&stage, &part(&mut random, camera), Cull::Back, 10);
    }
    tally.end(0.4);
}

/// Coordinates at the ends of their range, and pictures of them.
#[test]
fn the_ends_of_the_range() {
    let mut tally = Tally::new("the ends of the range");
    let mut random = Random::new(113);
    for round in 0..24 {
        let scale = [1e-37, 1e-30, 1e-20, 1e12, 1e17, 0.9e18][round % 6];
        let count = 1 + random.below(60);
        let stage = Stage::of([
            meshes::random_soup(&mut random, count, DVec3::ZERO, scale * 0.5, 0.9),
            meshes::cuboid(DVec3::splat(-scale), DVec3::splat(scale)),
        ]);
        for projection in PROJECTIONS {
            let eye = random.in_cube() * scale * [0.9, 3.0][round / 6 % 2];
            let target = random.in_cube() * scale * 0.1;
            let camera = camera(eye, target, projection, (49, 43), scale);
            tally.check(&stage, &whole(camera), CULLS[round / 12], 5);
        }
    }
    tally.end(0.3);
}

/// Near and far in one triangle: from a millionth of the view's distance to a million times it.
#[test]
fn a_ground_from_the_feet_to_the_horizon() {
    let mut tally = Tally::new("from the feet to the horizon");
    for height in [1e-4, 1.0, 1e3] {
        for cells in [1, 10, 100] {
            let ground = meshes::grid(cells, cells, |x, z| {
                let at = |i: u32| (f64::from(i) / f64::from(cells) - 0.5) * 2e4;
                DVec3::new(at(x), 0.0, -at(z))
            });
            let post = meshes::cuboid(DVec3::new(-0.5, 0.0, -60.0), DVec3::new(0.5, 9.0, -59.0));
            let stage = Stage::of([ground, post]);
            for projection in PROJECTIONS {
                for frame in [1e-3, 1.0, 30.0] {
                    let eye = DVec3::new(0.3, height, 0.2);
                    let camera = camera(eye, eye - DVec3::Z, projection, (60, 80), frame);
                    tally.check(&stage, &whole(camera), Cull::None, 20);
                }
            }
        }
    }
    tally.end(0.1);
}
