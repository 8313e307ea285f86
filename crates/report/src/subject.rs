//! A measured scene.

use crate::table::ReportError;
use crate::{Stage, casters, embree};
use casters::Caster;
use raycast_core::camera::{Camera, Lattice, Rect};
use raycast_core::scene::Scene;
use raycast_core::{Accel, MISS, Precision, Simd};
use rayon::prelude::*;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A scene to be measured, as the caller gives it.
#[derive(Clone, Debug)]
pub struct Input {
    /// Its name in tables.
    pub name: String,
    /// The objects.
    pub scene: Arc<Scene>,
    /// The time to read it; `None` for a scene made in memory.
    pub parsing: Option<Duration>,
}

/// A measured scene with all casters.
pub struct Subject {
    /// Its name in tables.
    pub name: String,
    /// The scene, RayCast's tree, the truth.
    pub stage: Stage,
    /// The time to read it.
    pub parsing: Option<Duration>,
    /// The time to build RayCast's tree.
    pub building: Duration,
    /// All casters, RayCast's own first.
    pub casters: Vec<Box<dyn Caster>>,
}

impl Subject {
    /// Builds every caster's tree. RayCast's packets are cast with `simd`, or the widest set below it that this
    /// machine has, and with the plainer ones as well.
    ///
    /// # Errors
    /// A scene whose transforms or parents are invalid.
    pub fn new(
        input: &Input,
        simd: Simd,
        library: Option<&Arc<embree::Embree>>,
    ) -> Result<Self, ReportError> {
        let started = Instant::now();
        let accel = Arc::new(Accel::build(&input.scene)?.with_simd(simd));
        let building = started.elapsed();
        let mut all = casters::raycast(&accel);
        for simd in Simd::available() {
            if simd < accel.simd() {
                let plainer = Arc::new(Accel::build(&input.scene)?.with_simd(simd));
                all.push(casters::raycast_simd(&plainer, Precision::Exact));
            }
        }
        all.extend(casters::baselines(&accel));
        if let Some(Ok(embree)) = library.map(|library| casters::embree(&accel, library)) {
            all.extend(embree);
        }
        Ok(Self {
            name: input.name.clone(),
            stage: Stage::from_parts(Arc::clone(&input.scene), accel)?,
            parsing: input.parsing,
            building,
            casters: all,
        })
    }
}

/// Rays along the side of a tile, as in a render.
const TILE: u32 = 64;

/// A camera's rays, or every `stride`-th in both directions, in tiles for several workers.
pub fn tiles(camera: &Camera, stride: u32) -> Vec<Lattice> {
    let plane = camera.plane();
    // Few rays make small tiles, so that all workers have some.
    let side = if stride == 1 { TILE } else { 8 } * stride;
    let mut tiles = Vec::new();
    for y in (0..plane.rows).step_by(side as usize) {
        for x in (0..plane.columns).step_by(side as usize) {
            let rect = Rect {
                x,
                y,
                width: side.min(plane.columns - x),
                height: side.min(plane.rows - y),
            };
            tiles.push(camera.sub_camera(rect).sparse_lattice(stride, (0, 0)));
        }
    }
    tiles
}

/// The stride at which a caster that tests `tests_per_ray` triangles a ray takes at most `tests` tests.
pub fn stride(camera: &Camera, tests_per_ray: usize, tests: usize) -> u32 {
    let plane = camera.plane();
    let rays = (tests / tests_per_ray.max(1)).max(1) as f64;
    let pixels = f64::from(plane.columns) * f64::from(plane.rows);
    let longest = plane.columns.min(plane.rows).max(1);
    if tests_per_ray == 0 {
        1
    } else {
        ((pixels / rays).sqrt().ceil() as u32).clamp(1, longest)
    }
}

/// Casts all rays of all tiles on the current workers; returns how many hit something.
pub fn cast_tiles(caster: &dyn Caster, tiles: &[Lattice]) -> usize {
    tiles
        .par_iter()
        .map_init(Vec::new, |hits, tile| {
            caster.cast_lattice(tile, hits);
            std::hint::black_box(&hits)
                .iter()
                .filter(|hit| !hit.is_miss())
                .count()
        })
        .sum()
}

/// As [`cast_tiles`], for visibility alone.
pub fn find_tiles(caster: &dyn Caster, tiles: &[Lattice]) -> usize {
    tiles
        .par_iter()
        .map_init(Vec::new, |primitives, tile| {
            caster.find_lattice(tile, primitives);
            let primitives = std::hint::black_box(&primitives);
            primitives
                .iter()
                .filter(|&&primitive| primitive != MISS)
                .count()
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stage::scene_of;
    use crate::{meshes, views};

    #[test]
    fn tiles_cover_a_picture_once() {
        let scene = scene_of([meshes::octahedron()]);
        let camera = views::filling(&scene, (201, 130), views::FOV, 1.0).expect("a camera");
        let rays = |stride| {
            tiles(&camera, stride)
                .iter()
                .map(Lattice::len)
                .sum::<usize>()
        };
        assert_eq!(rays(1), 201 * 130);
        assert_eq!(rays(7), 201usize.div_ceil(7) * 130usize.div_ceil(7));
        assert_eq!(stride(&camera, 0, 5), 1);
        assert!(rays(stride(&camera, 100, 100_000)) <= 1100);
    }
}
