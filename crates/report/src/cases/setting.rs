//! What a hard case puts up: a scene, rays, cameras.

use crate::stage::scene_of;
use raycast_core::Cull;
use raycast_core::camera::{Camera, Ray};
use raycast_core::scene::{Mesh, Scene};
use raycast_oracle::random::Random;
use std::fmt;

/// Makes rays, one after the other, without end.
type Make = Box<dyn Fn(&mut Random) -> Ray + Send + Sync>;

/// A scene with rays to cast at it and cameras to look at it.
pub struct Setting {
    /// The scene.
    pub scene: Scene,
    /// Where to look at it from: at least one. Each has its own lattice of rays.
    pub cameras: Vec<Camera>,
    /// Which faces rays hit.
    pub cull: Cull,
    /// Whether every ray, of the cameras too, hits something: a miss is a leak.
    pub is_closed: bool,
    /// Rays that are always cast.
    given: Vec<Ray>,
    /// More of them, as many as anyone likes.
    make: Option<Make>,
}

impl Setting {
    /// These meshes, each where it is, as a camera sees them.
    pub fn of(meshes: impl IntoIterator<Item = Mesh>) -> Self {
        Self::new(scene_of(meshes))
    }

    /// This scene.
    pub fn new(scene: Scene) -> Self {
        Self {
            scene,
            cameras: Vec::new(),
            cull: Cull::None,
            is_closed: false,
            given: Vec::new(),
            make: None,
        }
    }

    /// Looked at by these cameras too.
    pub fn seen(mut self, cameras: impl IntoIterator<Item = Camera>) -> Self {
        self.cameras.extend(cameras);
        self
    }

    /// With these rays.
    pub fn given(mut self, rays: impl IntoIterator<Item = Ray>) -> Self {
        self.given.extend(rays);
        self
    }

    /// With as many rays as this makes.
    pub fn making(mut self, make: impl Fn(&mut Random) -> Ray + Send + Sync + 'static) -> Self {
        self.make = Some(Box::new(make));
        self
    }

    /// No ray may miss.
    pub fn closed(mut self) -> Self {
        self.is_closed = true;
        self
    }

    /// Rays hit these faces.
    pub fn culled(mut self, cull: Cull) -> Self {
        self.cull = cull;
        self
    }

    /// Whether there are as many rays as anyone likes.
    pub fn is_endless(&self) -> bool {
        self.make.is_some()
    }

    /// At most `most` rays: those that are given, then those that a seed makes.
    pub fn rays(&self, most: usize, seed: u64) -> Vec<Ray> {
        let mut rays: Vec<Ray> = self.given.iter().copied().take(most).collect();
        if let Some(make) = &self.make {
            let mut random = Random::new(seed);
            rays.extend((rays.len()..most).map(|_| make(&mut random)));
        }
        rays
    }

    /// At most `most` of the cameras' rays, each camera's evenly spread over its picture.
    pub fn camera_rays(&self, most: usize) -> Vec<Ray> {
        let each = most / self.cameras.len().max(1);
        let mut rays = Vec::new();
        for camera in &self.cameras {
            let plane = camera.plane();
            let (columns, rows) = (plane.columns as usize, plane.rows as usize);
            let every = (columns * rows).div_ceil(each.max(1));
            let places = (0..columns * rows).step_by(every).take(each);
            rays.extend(places.map(|i| {
                let (x, y) = (i % columns, i / columns);
                camera.ray(x as f64 + 0.5, y as f64 + 0.5)
            }));
        }
        rays
    }
}

impl fmt::Debug for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Setting")
            .field("objects", &self.scene.objects.len())
            .field("cameras", &self.cameras.len())
            .field("cull", &self.cull)
            .field("is_closed", &self.is_closed)
            .field("given", &self.given.len())
            .field("is_endless", &self.is_endless())
            .finish()
    }
}
