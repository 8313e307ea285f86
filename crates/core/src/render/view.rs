use crate::bvh::Accel;
use crate::camera::{Camera, PixelFilter, SamplePattern};
use crate::hit::{Cull, Precision};
use crate::scene::{ClippingPlanes, Scene};
use crate::shade::Shading;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How a picture is made, besides scene and camera.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// Colours.
    pub shading: Shading,
    /// Which faces rays meet.
    pub cull: Cull,
    /// What is cut away.
    pub clip: ClippingPlanes,
    /// How sure the triangles are.
    pub precision: Precision,
    /// Rays a pixel, at least 1. The first goes through the pixel's centre.
    pub samples: u32,
    /// How samples are weighed by their place.
    pub pixel_filter: PixelFilter,
    /// Whether to keep depth, numbers, normals and texture coordinates beside the colours.
    pub layers: bool,
}

/// A clock from outside: time since some moment of the caller's. The core has none of its own.
pub type Clock<'a> = &'a (dyn Fn() -> Duration + Sync);

/// Tells a render to stop; shared between threads.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// Asks the render to stop where each of its workers next can: at a tile, or at the end of a row of
    /// them.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it was asked to.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Everything that decides a picture.
#[derive(Clone, Debug)]
pub struct View {
    /// The objects.
    pub scene: Arc<Scene>,
    /// The tree over them: `Accel::build(&scene)`.
    pub accel: Arc<Accel>,
    /// Where from.
    pub camera: Camera,
    /// How.
    pub settings: Settings,
}

impl Settings {
    /// Where the samples of a picture's pixels are.
    pub fn sample_pattern(&self) -> SamplePattern {
        SamplePattern::new(self.samples, self.pixel_filter)
    }
}
