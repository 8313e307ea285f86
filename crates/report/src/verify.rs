//! A picture's pixels against the truth, more of them where it is easiest to be wrong.

use crate::fault::{Fault, compare_pixel};
use crate::stage::Stage;
use raycast_core::camera::{Camera, Rect};
use raycast_core::image::Layers;
use raycast_core::intersect::Cull;
use raycast_oracle::Truth;
use raycast_oracle::random::Random;
use rayon::prelude::*;

/// How many wrong pixels are told of.
const TOLD: usize = 5;

/// A rectangle of a camera's picture that is said to show a scene.
#[derive(Clone, Copy, Debug)]
pub struct Claim<'a> {
    /// The camera of the whole picture.
    pub camera: Camera,
    /// The rectangle.
    pub rect: Rect,
    /// What each of its pixels is said to show: as many as the rectangle has.
    pub layers: &'a Layers,
    /// Which faces its rays meet.
    pub cull: Cull,
}

/// What a claim came to.
#[derive(Clone, Debug, Default)]
pub struct Verification {
    /// Pixels in the rectangle.
    pub pixels: usize,
    /// How many of them were checked.
    pub checked: usize,
    /// Of those: next to a miss, or to another object.
    pub silhouettes: usize,
    /// Of those: next to another triangle of the same object.
    pub edges: usize,
    /// How many were wrong.
    pub wrong: usize,
    /// The first few of them, row by row.
    pub first_wrong: Vec<WrongPixel>,
}

/// A pixel that does not show what its ray meets.
#[derive(Clone, Copy, Debug)]
pub struct WrongPixel {
    /// Its column in the whole picture.
    pub x: u32,
    /// Its row.
    pub y: u32,
    /// What is wrong.
    pub fault: Fault,
    /// The object that it shows; `u32::MAX` for none.
    pub object: u32,
    /// The triangle that it shows.
    pub triangle: u32,
    /// The distance that it tells.
    pub depth: f32,
    /// What its ray meets, in truth.
    pub truth: Option<Truth>,
}

/// Checks `most` of a claim's pixels, or all if there are no more: a third where an object ends, a
/// third where two triangles of one meet, and the rest anywhere. The same seed draws the same ones.
/// `done` is called with how many more are checked, from several threads.
pub fn verify(
    stage: &Stage,
    claim: &Claim<'_>,
    most: usize,
    seed: u64,
    done: &(impl Fn(u64) + Sync),
) -> Verification {
    let drawn = draw(claim, most, seed);
    let mut wrong: Vec<WrongPixel> = drawn
        .par_chunks(256)
        .flat_map_iter(|chunk| {
            let check = |&i: &u32| check(stage, claim, i as usize);
            let wrong: Vec<WrongPixel> = chunk.iter().filter_map(check).collect();
            done(chunk.len() as u64);
            wrong
        })
        .collect();
    wrong.sort_unstable_by_key(|pixel| (pixel.y, pixel.x));
    let count = wrong.len();
    wrong.truncate(TOLD);
    let count_of = |kind| {
        let is_kind = |i: &&u32| claim.kind(**i as usize) == kind;
        drawn.iter().filter(is_kind).count()
    };
    Verification {
        pixels: claim.rect.area(),
        checked: drawn.len(),
        silhouettes: count_of(Kind::Silhouette),
        edges: count_of(Kind::Edge),
        wrong: count,
        first_wrong: wrong,
    }
}

/// What meets at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Silhouette,
    Edge,
    Inside,
}

impl Claim<'_> {
    fn kind(&self, i: usize) -> Kind {
        let (width, height) = (self.rect.width as usize, self.rect.height as usize);
        let (x, y) = (i % width, i / width);
        let neighbours = [
            (x > 0).then(|| i - 1),
            (x + 1 < width).then(|| i + 1),
            (y > 0).then(|| i - width),
            (y + 1 < height).then(|| i + width),
        ];
        let differs = |of: &[u32]| neighbours.iter().flatten().any(|&j| of[j] != of[i]);
        if differs(&self.layers.object) {
            Kind::Silhouette
        } else if differs(&self.layers.triangle) {
            Kind::Edge
        } else {
            Kind::Inside
        }
    }
}

/// The pixels to check, none twice.
fn draw(claim: &Claim<'_>, most: usize, seed: u64) -> Vec<u32> {
    let [mut silhouettes, mut edges, mut insides] = [const { Vec::new() }; 3];
    for i in 0..claim.rect.area() {
        match claim.kind(i) {
            Kind::Silhouette => silhouettes.push(i as u32),
            Kind::Edge => edges.push(i as u32),
            Kind::Inside => insides.push(i as u32),
        }
    }
    let mut random = Random::new(seed);
    let mut take = |from: &mut Vec<u32>, count: usize| -> Vec<u32> {
        (0..count.min(from.len()))
            .map(|_| from.swap_remove(random.below(from.len() as u32) as usize))
            .collect()
    };
    let mut drawn = take(&mut silhouettes, most / 3);
    drawn.extend(take(&mut edges, most / 3));
    let mut rest = [silhouettes, edges, insides].concat();
    drawn.extend(take(&mut rest, most - drawn.len()));
    drawn
}

/// What is wrong with a pixel, if anything is.
fn check(stage: &Stage, claim: &Claim<'_>, i: usize) -> Option<WrongPixel> {
    let width = claim.rect.width as usize;
    let (x, y) = (
        claim.rect.x + (i % width) as u32,
        claim.rect.y + (i / width) as u32,
    );
    let ray = claim.camera.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
    let truth = stage.truth(&ray, claim.cull);
    let layers = claim.layers;
    let (object, triangle, depth) = (layers.object[i], layers.triangle[i], layers.depth[i]);
    let fault = compare_pixel(object, triangle, depth, truth.as_ref()).err()?;
    Some(WrongPixel {
        x,
        y,
        fault,
        object,
        triangle,
        depth,
        truth,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cameras::{PROJECTIONS, camera};
    use crate::meshes;
    use crate::stage::scene_of;
    use raycast_core::camera::Grid;
    use raycast_core::glam::DVec3;
    use raycast_core::image::Picture;
    use raycast_core::render::Cancel;
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::time::Duration;

    const SIZE: (u32, u32) = (80, 60);

    fn rendered(stage: &Stage, camera: Camera) -> Picture {
        stage
            .view(camera, Cull::None)
            .render(
                Grid::default(),
                &|| Duration::ZERO,
                &Cancel::default(),
                &|_| (),
            )
            .expect("nothing cancelled it")
    }

    fn checked(stage: &Stage, camera: Camera, layers: &Layers, most: usize) -> Verification {
        let rect = Rect {
            x: 0,
            y: 0,
            width: SIZE.0,
            height: SIZE.1,
        };
        let claim = Claim {
            camera,
            rect,
            layers,
            cull: Cull::None,
        };
        let told = AtomicU64::new(0);
        let found = verify(stage, &claim, most, 1, &|more| {
            told.fetch_add(more, Ordering::Relaxed);
        });
        assert_eq!(told.into_inner(), found.checked as u64);
        found
    }

    #[test]
    fn a_good_picture_passes_and_each_fault_is_found() {
        let stage = Stage::new(scene_of([
            meshes::sphere(DVec3::ZERO, 1.0, 24),
            meshes::octahedron(),
        ]))
        .expect("a valid scene");
        for projection in PROJECTIONS {
            let eye = DVec3::new(1.0, 2.0, 3.0);
            let camera = camera(eye, DVec3::ZERO, projection, SIZE, 2.4);
            let good = rendered(&stage, camera).layers.expect("layers");
            let all = checked(&stage, camera, &good, 100_000);
            assert_eq!((all.pixels, all.checked, all.wrong), (4800, 4800, 0));
            assert!(all.silhouettes > 100 && all.edges > 500);
            let some = checked(&stage, camera, &good, 300);
            assert_eq!((some.checked, some.wrong), (300, 0));
            assert!(some.silhouettes >= 100 && some.edges >= 100);

            let middle = 30 * 80 + 40;
            for spoil in [
                (|layers, i| layers.triangle[i] += 1) as fn(&mut Layers, usize),
                |layers, i| layers.object[i] = 1 - layers.object[i],
                |layers, i| layers.depth[i] *= 1.000_001,
                |layers, i| layers.depth[i] = f32::NAN,
                |layers, i| layers.depth[i] = f32::INFINITY,
                |layers, i| {
                    layers.object[i] = u32::MAX;
                    layers.triangle[i] = u32::MAX;
                    layers.depth[i] = f32::INFINITY;
                },
            ] {
                let mut bad = good.clone();
                spoil(&mut bad, middle);
                let found = checked(&stage, camera, &bad, 4800);
                assert_eq!(found.wrong, 1);
                let first = &found.first_wrong[0];
                assert_eq!((first.x, first.y), (40, 30));
            }
            // A hit where there is nothing.
            let mut bad = good.clone();
            (bad.object[0], bad.triangle[0], bad.depth[0]) = (0, 0, 3.0);
            let found = checked(&stage, camera, &bad, 4800);
            assert_eq!(found.first_wrong[0].fault, Fault::Hit);
        }
    }

    #[test]
    fn only_a_few_wrong_pixels_are_told_of_and_all_are_counted() {
        let stage = Stage::new(scene_of([meshes::octahedron()])).expect("a valid scene");
        let camera = camera(DVec3::Z * 3.0, DVec3::ZERO, PROJECTIONS[0], SIZE, 1.0);
        let blank = Layers::blank(4800);
        let found = checked(&stage, camera, &blank, 1000);
        assert!(found.wrong > 500 && found.first_wrong.len() == TOLD);
        let fault = |pixel: &WrongPixel| pixel.fault == Fault::Miss;
        assert!(found.first_wrong.iter().all(fault));
    }
}
