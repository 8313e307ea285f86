use crate::bvh::Accel;
use crate::camera::{Camera, PixelFilter, SamplePattern};
use crate::hit::{Cull, Precision};
use crate::scene::{ClippingPlanes, Scene};
use crate::shade::Shading;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The settings of a picture, besides scene and camera.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// Mode, colours, light, textures and lines.
    pub shading: Shading,
    /// Which faces rays hit.
    pub cull: Cull,
    /// Clipping planes.
    pub clip: ClippingPlanes,
    /// Exact or rounded casting.
    pub precision: Precision,
    /// Rays per pixel; zero counts as one. The first goes through the pixel's centre.
    pub samples: u32,
    /// How samples are weighted by their offset from the pixel's centre.
    pub pixel_filter: PixelFilter,
    /// Whether to keep colours in linear light, depth, object and triangle numbers, normals and texture coordinates as
    /// well as the 8-bit pixels.
    pub layers: bool,
}

/// A clock of the caller: time since a fixed moment. The core reads no clock of its own.
pub type Clock<'a> = &'a (dyn Fn() -> Duration + Sync);

/// A flag, shared between threads, that stops a render.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// Stops the render where each of its workers next checks: at a tile, or at the end of a row of tiles.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it was cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// All that decides a picture.
#[derive(Clone, Debug)]
pub struct View {
    /// The objects.
    pub scene: Arc<Scene>,
    /// The tree over them: [`Accel::build`] or [`Accel::build_instances`] of this scene.
    pub accel: Arc<Accel>,
    /// The camera.
    pub camera: Camera,
    /// The settings.
    pub settings: Settings,
}

impl Settings {
    /// The sample positions of the picture's pixels.
    pub fn sample_pattern(&self) -> SamplePattern {
        SamplePattern::new(self.samples, self.pixel_filter)
    }
}
