//! Asks the core and the oracle the same, and compares.

use raycast_core::camera::{Camera, Grid, Lattice, Ray, Rect};
use raycast_core::picture::{Layers, Picture};
use raycast_core::render::{Cancel, View};
use raycast_core::scene::{Mesh, Scene};
use raycast_core::{Accel, Cull, Detail, Precision, PrimitiveHit, Simd};
use raycast_oracle::Truth;
use raycast_oracle::random::Random;
pub use raycast_report::Stage;
use raycast_report::stage::scene_of;
use raycast_report::wrong_answer::{compare, compare_pixel};
use rayon::prelude::*;
use std::time::Duration;

/// A stage that asks and compares, and panics where an answer is not the truth.
pub trait Check {
    /// A valid scene made ready.
    fn from_scene(scene: Scene) -> Self;
    /// One object a mesh, each where its mesh is.
    fn from_meshes(meshes: impl IntoIterator<Item = Mesh>) -> Self;
    /// Casts a ray: through the tree, by brute force, and in truth. All must agree.
    fn check(&self, ray: &Ray, cull: Cull) -> Option<Truth>;
    /// As [`Stage::check`] without brute force, for large meshes.
    fn check_quickly(&self, ray: &Ray, cull: Cull) -> Option<Truth>;
    /// [`Stage::check`] for many rays, in parallel. How many of them hit something.
    fn check_all(&self, rays: &[Ray], cull: Cull) -> usize;
    /// [`Stage::check_quickly`] for many rays, in parallel. How many of them hit something.
    fn check_all_quickly(&self, rays: &[Ray], cull: Cull) -> usize;
    /// Renders the view, in tiles, and compares every `every`-th pixel (along both sides) with the
    /// truth, and with [`Accel::cast`] of the pixel's ray.
    fn check_picture(&self, camera: Camera, cull: Cull, every: u32) -> Picture;
    /// Casts a lattice of rays with every instruction set, exact and fast. Each ray must get what
    /// [`Accel::cast_primitive`] gives it, bit for bit, and every `every`-th one, with those whose
    /// neighbours show something else, the truth. How many hit something.
    fn check_lattice(&self, lattice: &Lattice, cull: Cull, every: usize) -> usize;
}

impl Check for Stage {
    fn from_scene(scene: Scene) -> Self {
        Self::new(scene).expect("a valid scene")
    }

    fn from_meshes(meshes: impl IntoIterator<Item = Mesh>) -> Self {
        Self::from_scene(scene_of(meshes))
    }

    fn check(&self, ray: &Ray, cull: Cull) -> Option<Truth> {
        let truth = self.check_quickly(ray, cull);
        let cast = self.accel.cast(ray, cull);
        let brute = self.accel.cast_brute_force(ray, cull);
        assert_eq!(cast, brute, "tree (left) against brute force: {ray:?}");
        truth
    }

    fn check_quickly(&self, ray: &Ray, cull: Cull) -> Option<Truth> {
        let truth = self.truth(ray, cull);
        let cast = self.accel.cast(ray, cull);
        if let Err(fault) = compare(cast.as_ref(), truth.as_ref()) {
            panic!(
                "{fault}\n cull: {cull:?}\n  ray: {ray:?}\n cast: {cast:?}\n      {}\ntruth: {truth:?}\n      {}",
                describe(self, cast.map(|hit| (hit.object, hit.triangle))),
                describe(self, truth.map(|truth| (truth.object, truth.triangle))),
            );
        }
        truth
    }

    fn check_all(&self, rays: &[Ray], cull: Cull) -> usize {
        rays.par_iter()
            .filter(|ray| self.check(ray, cull).is_some())
            .count()
    }

    fn check_all_quickly(&self, rays: &[Ray], cull: Cull) -> usize {
        rays.par_iter()
            .filter(|ray| self.check_quickly(ray, cull).is_some())
            .count()
    }

    fn check_picture(&self, camera: Camera, cull: Cull, every: u32) -> Picture {
        let picture = render(&self.view(camera, cull), Grid::default());
        let layers = picture.layers.as_ref().expect("layers were asked for");
        let (columns, rows) = (picture.width, picture.height);
        (0..rows)
            .step_by(every as usize)
            .flat_map(|y| (0..columns).step_by(every as usize).map(move |x| (x, y)))
            .collect::<Vec<_>>()
            .into_par_iter()
            .for_each(|(x, y)| {
                let ray = camera.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let truth = self.check_quickly(&ray, cull);
                let (object, triangle, depth) = pixel(layers, columns, x, y);
                let is_right = compare_pixel(object, triangle, depth, truth.as_ref()).is_ok();
                assert!(
                    is_right,
                    "pixel ({x}, {y}) shows object {object} triangle {triangle} at {depth}\n  ray: {ray:?}\ntruth: {truth:?}\n      {}\n{camera:?}",
                    describe(self, truth.map(|truth| (truth.object, truth.triangle))),
                );
                let cast = self.accel.cast(&ray, cull).map_or(f32::INFINITY, |hit| hit.t as f32);
                assert!(
                    depth.to_bits() == cast.to_bits(),
                    "pixel ({x}, {y}) is at {depth}, its ray's hit at {cast}: {ray:?}"
                );
            });
        picture
    }

    fn check_lattice(&self, lattice: &Lattice, cull: Cull, every: usize) -> usize {
        let at = |i: usize| (i as u32 % lattice.columns, i as u32 / lattice.columns);
        let ray = |i: usize| lattice.ray(at(i).0, at(i).1);
        let single = |precision| -> Vec<PrimitiveHit> {
            (0..lattice.len())
                .into_par_iter()
                .map(|i| self.accel.cast_primitive(&ray(i), cull, precision))
                .collect()
        };
        let exact = single(Precision::Exact);
        for precision in [Precision::Fast, Precision::Exact] {
            let expected = single(precision);
            let accels = Simd::available().map(|simd| Accel::clone(&self.accel).with_simd(simd));
            for accel in accels {
                // The widest does less and guesses too; what that may break is not the others'.
                let details: &[Detail] = match (accel.simd() == Simd::best(), precision) {
                    (true, _) => &[Detail::Full, Detail::Triangle],
                    (false, Precision::Exact) => &[Detail::Full],
                    (false, Precision::Fast) => &[],
                };
                for &detail in details {
                    let mut found = Vec::new();
                    accel.cast_lattice(lattice, cull, precision, detail, &mut found);
                    assert_eq!(found.len(), expected.len());
                    let is_same = |(found, expected): (&PrimitiveHit, &PrimitiveHit)| match detail {
                        Detail::Full => found == expected,
                        Detail::Triangle => found.primitive == expected.primitive,
                    };
                    // What a packet decides is right where a single ray in double precision alone may not be.
                    let wrong: Vec<usize> = (0..lattice.len())
                        .filter(|&i| {
                            !is_same((&found[i], &expected[i])) && !is_same((&found[i], &exact[i]))
                        })
                        .collect();
                    if let Some(&i) = wrong.first() {
                        let place = |hit: &PrimitiveHit| {
                            (!hit.is_miss()).then(|| self.accel.identify(hit.primitive))
                        };
                        panic!(
                            "{} of {} rays differ, first {:?}, {precision:?} {detail:?} {} {cull:?}\n  tile: {:?}\n        {}\nsingle: {:?}\n        {}\n truth: {:?}\n   ray: {:?}\n{lattice:?}",
                            wrong.len(),
                            lattice.len(),
                            at(i),
                            accel.simd().name(),
                            found[i],
                            describe(self, place(&found[i])),
                            expected[i],
                            describe(self, place(&expected[i])),
                            self.truth(&ray(i), cull),
                            ray(i),
                        );
                    }
                }
            }
        }
        let columns = lattice.columns as usize;
        let is_border = |i: usize| {
            let differs = |j: usize| {
                exact
                    .get(j)
                    .is_some_and(|hit| hit.primitive != exact[i].primitive)
            };
            differs(i + 1) || differs(i + columns)
        };
        (0..lattice.len())
            .into_par_iter()
            .filter(|&i| i % every == 0 || (i % every.div_ceil(8) == 0 && is_border(i)))
            .for_each(|i| {
                self.check_quickly(&ray(i), cull);
            });
        exact.iter().filter(|hit| !hit.is_miss()).count()
    }
}

/// A triangle's corners, to be copied into a test.
fn describe(stage: &Stage, numbers: Option<(u32, u32)>) -> String {
    numbers.map_or_else(String::new, |(object, triangle)| {
        let mesh = &stage.scene.objects[object as usize].mesh;
        format!(
            "offset {:?}, corners {:?}",
            mesh.offset(),
            mesh.corners(triangle)
        )
    })
}

/// A pixel's object, triangle and depth.
pub fn pixel(layers: &Layers, columns: u32, x: u32, y: u32) -> (u32, u32, f32) {
    let index = (y * columns + x) as usize;
    (
        layers.object[index],
        layers.triangle[index],
        layers.depth[index],
    )
}

/// Renders a whole view on the current thread pool.
pub fn render(view: &View, grid: Grid) -> Picture {
    view.render(grid, &|| Duration::ZERO, &Cancel::default(), &|_| ())
        .expect("nothing cancelled it")
}

/// Some of a camera's rays: a rectangle, a stride, a phase and a place in the pixel, all at random.
pub fn part(random: &mut Random, camera: Camera) -> Lattice {
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
        ..camera.sub_camera(rect).sparse_lattice(stride, phase)
    }
}

/// Runs `work` on a pool of so many threads.
pub fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("a thread pool")
        .install(work)
}
