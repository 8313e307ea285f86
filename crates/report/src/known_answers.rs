//! Rays with known truth, for every caster to be compared with.

use crate::Stage;
use crate::casters::{self, Caster, Rays};
use crate::errors::Errors;
use crate::subject;
use raycast_core::camera::{Camera, Ray};
use raycast_core::{Cull, PrimitiveHit};
use raycast_oracle::Truth;
use rayon::prelude::*;

/// Free rays and pixels of cameras, each as given and rounded to single precision, with the truth about all of them.
pub struct KnownAnswers<'a> {
    stage: &'a Stage,
    /// Rays as given, camera rays last.
    double: RaysWithTruth,
    /// The same, rounded.
    single: RaysWithTruth,
    /// The number of free rays.
    free: usize,
    pictures: Vec<(Camera, Vec<(u32, u32)>)>,
}

/// Rays, and the truth about them.
struct RaysWithTruth {
    rays: Vec<Ray>,
    truths: Vec<Option<Truth>>,
}

impl<'a> KnownAnswers<'a> {
    /// Asks the oracle about these free rays, and these pixels of these cameras.
    pub fn new(
        stage: &'a Stage,
        mut rays: Vec<Ray>,
        pictures: Vec<(Camera, Vec<(u32, u32)>)>,
    ) -> Self {
        let free = rays.len();
        for (camera, pixels) in &pictures {
            let ray = |&(x, y): &(u32, u32)| camera.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
            rays.extend(pixels.iter().map(ray));
        }
        let rounded = rays.iter().map(|ray| casters::rounded(ray, &stage.accel));
        let rounded = rounded.collect();
        let with_truth = |rays: Vec<Ray>| RaysWithTruth {
            truths: rays
                .par_iter()
                .map(|ray| stage.truth(ray, Cull::None))
                .collect(),
            rays,
        };
        Self {
            stage,
            single: with_truth(rounded),
            double: with_truth(rays),
            free,
            pictures,
        }
    }

    /// The rays that a caster is given: camera rays only, if it answers no others.
    pub fn rays(&self, caster: &dyn Caster) -> &[Ray] {
        match caster.rays() {
            Rays::Camera => &self.double.rays[self.free..],
            Rays::Double => &self.double.rays,
            Rays::Single => &self.single.rays,
        }
    }

    /// A caster's errors. Brute force gets only as many rays as `tests` ray–triangle tests allow.
    pub fn errors(&self, caster: &dyn Caster, tests: usize) -> Errors {
        let (compared, first) = match caster.rays() {
            Rays::Camera => (&self.double, self.free),
            Rays::Double => (&self.double, 0),
            Rays::Single => (&self.single, 0),
        };
        let hits = match caster.rays() {
            Rays::Camera => {
                let pictures = self.pictures.iter();
                pictures
                    .flat_map(|(camera, pixels)| cast_pixels(caster, camera, pixels))
                    .collect()
            }
            _ => cast(caster, &compared.rays, tests),
        };
        let range = first..first + hits.len();
        let (rays, truths) = (&compared.rays[range.clone()], &compared.truths[range]);
        Errors::compare(self.stage, caster, rays, truths, &hits)
    }
}

/// A caster's answers to rays, on all workers.
fn cast(caster: &dyn Caster, rays: &[Ray], tests: usize) -> Vec<PrimitiveHit> {
    let affordable = match caster.tests_per_ray() {
        0 => rays.len(),
        each => rays.len().min((tests / each).max(1)),
    };
    let parts: Vec<Vec<PrimitiveHit>> = rays[..affordable]
        .par_chunks(64)
        .map(|rays| {
            let mut hits = Vec::new();
            caster.cast(rays, &mut hits);
            hits
        })
        .collect();
    parts.concat()
}

/// A caster's answers to some pixels of a camera: the whole picture is cast, in tiles.
fn cast_pixels(caster: &dyn Caster, camera: &Camera, pixels: &[(u32, u32)]) -> Vec<PrimitiveHit> {
    let plane = camera.plane();
    let mut picture = vec![PrimitiveHit::NONE; plane.columns as usize * plane.rows as usize];
    let tiles = subject::tiles(camera, 1);
    let parts: Vec<Vec<PrimitiveHit>> = tiles
        .par_iter()
        .map(|tile| {
            let mut hits = Vec::new();
            caster.cast_lattice(tile, &mut hits);
            hits
        })
        .collect();
    let place = |x: u32, y: u32| (y * plane.columns + x) as usize;
    for (tile, hits) in tiles.iter().zip(parts) {
        for (row, hits) in hits.chunks(tile.columns as usize).enumerate() {
            let first = place(tile.x, tile.y + row as u32);
            picture[first..first + hits.len()].copy_from_slice(hits);
        }
    }
    pixels.iter().map(|&(x, y)| picture[place(x, y)]).collect()
}

/// Pseudorandom pixels, the same every time.
pub fn random_pixels(camera: &Camera, count: usize) -> Vec<(u32, u32)> {
    let plane = camera.plane();
    let mut random = raycast_oracle::random::Random::new(4);
    (0..count)
        .map(|_| (random.below(plane.columns), random.below(plane.rows)))
        .collect()
}
