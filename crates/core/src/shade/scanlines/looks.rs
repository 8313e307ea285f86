//! What each mode makes of a row's numbers.

use super::Scanline;
use crate::num::simd::{F32x8, Lanes};
use crate::shade::eight_colors::EightSamples;
use crate::shade::vectors::Vectors;
use glam::Vec3;

/// What a mode makes of eight samples' numbers.
pub(super) trait Look {
    fn eight<L: Lanes>(&self, lanes: L, row: &Scanline<'_, '_, '_>, at: usize) -> EightSamples<L>;
}

pub(super) struct OwnColorLook;

impl Look for OwnColorLook {
    #[inline(always)]
    fn eight<L: Lanes>(&self, lanes: L, row: &Scanline<'_, '_, '_>, at: usize) -> EightSamples<L> {
        EightSamples::Light(row.vectors(lanes, 3, at))
    }
}

pub(super) struct FlatLight;

impl Look for FlatLight {
    #[inline(always)]
    fn eight<L: Lanes>(&self, lanes: L, row: &Scanline<'_, '_, '_>, at: usize) -> EightSamples<L> {
        EightSamples::Light(row.vectors(lanes, 3, at).times(row.vectors(lanes, 0, at)))
    }
}

/// The samples' own colours under the light on their unit normals.
pub(super) struct SmoothLight;

impl Look for SmoothLight {
    #[inline(always)]
    fn eight<L: Lanes>(&self, lanes: L, row: &Scanline<'_, '_, '_>, at: usize) -> EightSamples<L> {
        let shader = row.tile.shader();
        let [x, y, z] = &*row.to_eye;
        let to_eye = [
            lanes.load(x.eight(at)),
            lanes.load(y.eight(at)),
            lanes.load(z.eight(at)),
        ];
        let normals = row.vectors(lanes, 0, at);
        let light = shader.light(lanes, normals, Vectors::new(lanes, to_eye));
        EightSamples::Light(row.vectors(lanes, 3, at).times(light))
    }
}

pub(super) struct NormalColors;

impl Look for NormalColors {
    #[inline(always)]
    fn eight<L: Lanes>(&self, lanes: L, row: &Scanline<'_, '_, '_>, at: usize) -> EightSamples<L> {
        let half = Vectors::splat(lanes, Vec3::splat(0.5));
        EightSamples::Display(row.vectors(lanes, 0, at).times(half).plus(half))
    }
}

pub(super) struct Greys;

impl Look for Greys {
    #[inline(always)]
    fn eight<L: Lanes>(&self, lanes: L, row: &Scanline<'_, '_, '_>, at: usize) -> EightSamples<L> {
        let numbers = [row.number(lanes, 0, at), row.number(lanes, 1, at)];
        let place = (row.columns.x.eight(at), row.y);
        let t = row.planar.eight_distances_of(lanes, place, numbers);
        EightSamples::Display(Vectors::all(lanes, row.tile.shader().eight_greys(lanes, t)))
    }
}

pub(super) struct Weights;

impl Look for Weights {
    #[inline(always)]
    fn eight<L: Lanes>(&self, lanes: L, row: &Scanline<'_, '_, '_>, at: usize) -> EightSamples<L> {
        let [u, v] = row.weights(lanes, at);
        let w = lanes.splat(1.0) - u - v;
        EightSamples::Display(Vectors::new(lanes, [w, u, v]))
    }
}

pub(super) struct TextureCoordinates;

impl Look for TextureCoordinates {
    #[inline(always)]
    fn eight<L: Lanes>(&self, lanes: L, row: &Scanline<'_, '_, '_>, at: usize) -> EightSamples<L> {
        let [u, v] = row.weights(lanes, at);
        let w = lanes.splat(1.0) - u - v;
        let [ax, bx, cx] = row.vectors(lanes, 3, at).xyz();
        let [ay, by, cy] = row.vectors(lanes, 6, at).xyz();
        let x = ax * w + bx * u + cx * v;
        let y = ay * w + by * u + cy * v;
        let [x, y] = [x - x.floor(), y - y.floor()];
        EightSamples::Display(Vectors::new(lanes, [x, y, lanes.splat(0.25)]))
    }
}
