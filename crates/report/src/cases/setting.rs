//! What a hard case provides: a scene, rays, cameras.

use crate::stage::scene_of;
use raycast_core::Cull;
use raycast_core::camera::{Camera, Ray};
use raycast_core::scene::{Mesh, Scene};
use raycast_oracle::random::Random;
use std::fmt;

/// Generates any number of rays from a source of random numbers.
type Make = Box<dyn Fn(&mut Random) -> Ray + Send + Sync>;

/// A scene with rays and cameras.
pub struct Setting {
    /// The scene.
    pub scene: Scene,
    /// Cameras, at least one. The rays of each form a lattice of their own.
    pub cameras: Vec<Camera>,
    /// Which sides of triangles rays can hit.
    pub cull: Cull,
    /// Whether every ray, of cameras too, must hit a triangle. A miss is then a leak.
    pub is_closed: bool,
    /// Fixed rays.
    given: Vec<Ray>,
    /// Generates additional rays.
    make: Option<Make>,
}

impl Setting {
    /// A setting of these meshes, each an object without a transform; it has no cameras yet.
    pub fn of(meshes: impl IntoIterator<Item = Mesh>) -> Self {
        Self::new(scene_of(meshes))
    }

    /// A setting of this scene, without rays and cameras yet.
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

    /// Adds cameras.
    pub fn seen(mut self, cameras: impl IntoIterator<Item = Camera>) -> Self {
        self.cameras.extend(cameras);
        self
    }

    /// Adds fixed rays.
    pub fn given(mut self, rays: impl IntoIterator<Item = Ray>) -> Self {
        self.given.extend(rays);
        self
    }

    /// Generates additional rays by `make`.
    pub fn making(mut self, make: impl Fn(&mut Random) -> Ray + Send + Sync + 'static) -> Self {
        self.make = Some(Box::new(make));
        self
    }

    /// Requires every ray to hit.
    pub fn closed(mut self) -> Self {
        self.is_closed = true;
        self
    }

    /// Sets which sides rays can hit.
    pub fn culled(mut self, cull: Cull) -> Self {
        self.cull = cull;
        self
    }

    /// Whether it can generate any number of rays.
    pub fn is_endless(&self) -> bool {
        self.make.is_some()
    }

    /// At most `most` rays: the fixed ones, then rays generated from `seed`.
    pub fn rays(&self, most: usize, seed: u64) -> Vec<Ray> {
        let mut rays: Vec<Ray> = self.given.iter().copied().take(most).collect();
        if let Some(make) = &self.make {
            let mut random = Random::new(seed);
            rays.extend((rays.len()..most).map(|_| make(&mut random)));
        }
        rays
    }

    /// At most `most` camera rays, distributed evenly over the cameras and over each picture.
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
