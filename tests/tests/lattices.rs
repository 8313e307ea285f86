//! Lattices of rays of any shape, cast together, against the same rays cast one by one and against
//! the truth. What is hard in the scenes is in `hard_cases.rs`.

#![allow(clippy::print_stdout, reason = "tests report what they checked")]

use raycast_core::Cull;
use raycast_core::camera::{Lattice, Rect};
use raycast_core::glam::DVec3;
use raycast_oracle::random::Random;
use raycast_report::cameras::{PROJECTIONS, camera};
use raycast_report::cases::time::hunted;
use raycast_report::meshes;
use raycast_tests::check::{Check, Stage, part};

/// What was checked, printed at the end.
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

    /// At least this share of the rays must have hit something, or nothing was tested.
    fn end(self, least: f64) {
        let Self { name, rays, hits } = self;
        println!("{name}: {rays} rays, {hits} hits, none wrong");
        assert!(
            hits as f64 >= least * rays as f64,
            "{name}: {hits} of {rays}"
        );
    }
}

/// The far corner of a picture of a gigapixel, and rays 499 pixels apart.
#[test]
fn far_off_the_axis() {
    let mut tally = Tally::new("far off the axis");
    let mut random = Random::new(110);
    let stage = Stage::from_meshes([
        meshes::sphere(DVec3::ZERO, 1.0, 48),
        meshes::random_soup(&mut random, 200, DVec3::ZERO, 8.0, 0.3),
        meshes::cuboid(DVec3::splat(-30.0), DVec3::splat(30.0)),
    ]);
    let side = 32_768;
    for round in 0..30 {
        let eye = random.direction() * random.between(1.5, 20.0);
        let target = random.in_cube();
        let height = (eye - target).length() * random.decade(-7.0, 4.0);
        let vast = camera(eye, target, PROJECTIONS[round % 2], (side, side), height);
        let rect = Rect {
            x: random.below(side - 68),
            y: random.below(side - 68),
            width: 68,
            height: 41,
        };
        let near = vast.sub_camera(rect).lattice();
        tally.check(&stage, &near, Cull::None, 10);
        let everywhere = Rect {
            x: 0,
            y: 0,
            width: side,
            height: side,
        };
        let coarse = vast
            .sub_camera(everywhere)
            .sparse_lattice(499, (round as u32, 7));
        tally.check(&stage, &coarse, Cull::None, 10);
    }
    tally.end(0.3);
}

/// Every size from one ray up, across the borders of cells of 8 and tiles of 64.
#[test]
fn lattices_of_every_size() {
    let mut tally = Tally::new("lattices of every size");
    let mut random = Random::new(111);
    let stage = Stage::from_meshes([meshes::sphere(DVec3::ZERO, 1.0, 24)]);
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
                tally.check(&stage, &camera.sub_camera(rect).lattice(), Cull::None, 50);
            }
        }
        for _ in 0..60 {
            tally.check(&stage, &part(&mut random, camera), Cull::None, 10);
        }
    }
    tally.end(0.5);
}

/// The scenes among which slow ones are looked for: some from their beginning, and those that packets were made faster for.
#[test]
fn scenes_of_the_hunt() {
    const MADE_FASTER: [u64; 10] = [500, 598, 711, 1879, 2058, 2078, 2297, 2478, 2748, 2846];
    let mut tally = Tally::new("scenes of the hunt");
    for seed in (0..50).chain(MADE_FASTER) {
        let seen = hunted(seed).hostile;
        let cameras = PROJECTIONS.map(|projection| seen.camera(projection, (36, 34)));
        let stage = Stage::from_scene(seen.scene);
        for (camera, cull) in cameras.iter().zip([Cull::None, Cull::Back]) {
            tally.check(&stage, &camera.whole().lattice(), cull, 400);
        }
    }
    tally.end(0.2);
}
