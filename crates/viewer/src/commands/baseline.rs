//! What `bench --baselines` compares with: obvhs's own traversal, and brute force.

use super::bench::{Spread, median};
use crate::stats;
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::ray::{Ray, RayHit};
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use raycast_core::accel::Accel;
use raycast_core::camera::{Camera, Grid, Projection, Rect};
use raycast_core::glam::{DVec3, Vec3A};
use raycast_core::intersect::Cull;
use rayon::prelude::*;
use serde::Serialize;
use std::time::{Duration, Instant};

/// Tests of a ray against a triangle that brute force may take, all in all: about a second.
const BRUTE_FORCE_TESTS: usize = 2_000_000;

/// A view's figures, beside RayCast's own.
#[derive(Debug, Serialize)]
pub(super) struct BaselineFigures {
    obvhs_hits: u64,
    obvhs_cast_ms: Spread,
    obvhs_mrays_per_s: f64,
    brute_force_rays: u64,
    brute_force_mrays_per_s: f64,
}

/// obvhs's tree over a scene, its triangles in the order of the leaves, as its examples advise.
pub(super) struct Baseline<'a> {
    accel: &'a Accel,
    bvh: Option<Bvh2>,
    triangles: Vec<RtTriangle>,
}

/// A frame's time and how many of its rays met something.
pub(super) struct BaselineFrame {
    time: Duration,
    hits: u64,
}

impl<'a> Baseline<'a> {
    /// Builds obvhs's tree (BVH2, medium build) over the triangles that RayCast casts at.
    pub(super) fn build(accel: &'a Accel) -> Self {
        let triangles: Vec<Triangle> = (0..accel.len() as u32)
            .map(|slot| {
                let [v0, v1, v2] = accel.corners(slot).map(Vec3A::from);
                Triangle { v0, v1, v2 }
            })
            .collect();
        if triangles.is_empty() {
            return Self {
                accel,
                bvh: None,
                triangles: Vec::new(),
            };
        }
        let bvh = build_bvh2_from_tris(
            &triangles,
            BvhBuildParams::medium_build(),
            &mut Duration::default(),
        );
        let triangles = bvh
            .primitive_indices
            .iter()
            .map(|&index| RtTriangle::from(&triangles[index as usize]))
            .collect();
        Self {
            accel,
            bvh: Some(bvh),
            triangles,
        }
    }

    /// Casts every ray of a picture, on the same tiles and workers as a render. Setting up rays is
    /// part of it, in single precision and a row at a time: its cheapest form.
    pub(super) fn frame(&self, camera: &Camera) -> BaselineFrame {
        let plane = camera.plane();
        let tiles = Grid::default().tiles(plane.columns, plane.rows);
        let started = Instant::now();
        let hits = tiles.par_iter().map(|tile| self.tile(camera, *tile)).sum();
        BaselineFrame {
            time: started.elapsed(),
            hits,
        }
    }

    /// Casts a tile's rays, keeps their hits as a renderer would, and counts them.
    fn tile(&self, camera: &Camera, tile: Rect) -> u64 {
        let Some(bvh) = &self.bvh else {
            return 0;
        };
        let relative = |point: DVec3| Vec3A::from((point - self.accel.origin()).as_vec3());
        let step = camera.plane().step;
        let right = Vec3A::from((camera.right() * step).as_vec3());
        let mut found = Vec::with_capacity(tile.area());
        for row in tile.y..tile.bottom() {
            let (x, y) = (f64::from(tile.x) + 0.5, f64::from(row) + 0.5);
            let first_origin = relative(camera.ray(x, y).origin);
            let first_direction = Vec3A::from(camera.direction(x, y).as_vec3());
            for column in 0..tile.width {
                let along = right * column as f32;
                let ray = match camera.projection() {
                    Projection::Perspective => {
                        Ray::new_inf(first_origin, (first_direction + along).normalize())
                    }
                    Projection::Orthographic => Ray::new_inf(first_origin + along, first_direction),
                };
                let mut hit = RayHit::none();
                bvh.ray_traverse(ray, &mut hit, |ray, index| {
                    self.triangles[index].intersect(ray)
                });
                found.push(hit);
            }
        }
        let found = std::hint::black_box(found);
        found.iter().filter(|hit| hit.t < f32::INFINITY).count() as u64
    }

    /// The figures of some frames of `rays` rays, and brute force's on a lattice of some of them.
    pub(super) fn figures(
        &self,
        camera: &Camera,
        cull: Cull,
        rays: u64,
        frames: &mut [BaselineFrame],
    ) -> BaselineFigures {
        let mut times: Vec<_> = frames.iter().map(|frame| frame.time).collect();
        let obvhs_cast_ms = Spread::of(&mut times);
        let (brute_force_rays, brute_force_time) = self.brute_force(camera, cull);
        BaselineFigures {
            obvhs_hits: frames.last().map_or(0, |frame| frame.hits),
            obvhs_cast_ms,
            obvhs_mrays_per_s: stats::mrays_per_s(rays, median(&times)),
            brute_force_rays,
            brute_force_mrays_per_s: stats::mrays_per_s(brute_force_rays, brute_force_time),
        }
    }

    /// Tries every triangle for the rays of a lattice over the picture, as many as there is time
    /// for.
    fn brute_force(&self, camera: &Camera, cull: Cull) -> (u64, Duration) {
        let affordable = (BRUTE_FORCE_TESTS / self.accel.len().max(1)).clamp(16, 65_536);
        let side = (affordable as f64).sqrt() as u32;
        let plane = camera.plane();
        let place = |index: u32, pixels: u32| {
            (f64::from(index) + 0.5) * f64::from(pixels) / f64::from(side)
        };
        let started = Instant::now();
        let hits: usize = (0..side * side)
            .into_par_iter()
            .filter(|index| {
                let x = place(index % side, plane.columns);
                let y = place(index / side, plane.rows);
                self.accel
                    .cast_brute_force(&camera.ray(x, y), cull)
                    .is_some()
            })
            .count();
        std::hint::black_box(hits);
        (u64::from(side) * u64::from(side), started.elapsed())
    }
}
