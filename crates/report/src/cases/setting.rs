//! What a hard case provides: a scene, rays, cameras.

use crate::stage::scene_of;
use raycast_core::Cull;
use raycast_core::camera::{Camera, Ray};
use raycast_core::scene::{Mesh, Scene};
use raycast_oracle::random::Random;
use std::fmt;

/// Generates any number of rays from a source of random numbers.
type Generator = Box<dyn Fn(&mut Random) -> Ray + Send + Sync>;

/// A scene with rays and cameras.
pub struct Setting {
    /// The scene.
    pub scene: Scene,
    /// Cameras, at least one. The rays of each form a lattice of their own.
    pub cameras: Vec<Camera>,
    /// Which sides of triangles rays can hit.
    pub cull: Cull,
    /// Whether every ray, of cameras too, must hit a triangle. A miss is then a leak.
    pub must_hit: bool,
    /// Fixed rays.
    fixed: Vec<Ray>,
    /// Generates additional rays.
    generator: Option<Generator>,
}

impl Setting {
    /// A setting of these meshes, each an object without a transform; it has no cameras yet.
    pub fn from_meshes(meshes: impl IntoIterator<Item = Mesh>) -> Self {
        Self::new(scene_of(meshes))
    }

    /// A setting of this scene, without rays and cameras yet.
    pub fn new(scene: Scene) -> Self {
        Self {
            scene,
            cameras: Vec::new(),
            cull: Cull::None,
            must_hit: false,
            fixed: Vec::new(),
            generator: None,
        }
    }

    /// Adds cameras.
    pub fn with_cameras(mut self, cameras: impl IntoIterator<Item = Camera>) -> Self {
        self.cameras.extend(cameras);
        self
    }

    /// Adds fixed rays.
    pub fn with_rays(mut self, rays: impl IntoIterator<Item = Ray>) -> Self {
        self.fixed.extend(rays);
        self
    }

    /// Adds a generator of any number of rays.
    pub fn with_generator(
        mut self,
        generator: impl Fn(&mut Random) -> Ray + Send + Sync + 'static,
    ) -> Self {
        self.generator = Some(Box::new(generator));
        self
    }

    /// Requires every ray to hit.
    pub fn must_hit(mut self) -> Self {
        self.must_hit = true;
        self
    }

    /// Sets which sides rays can hit.
    pub fn with_cull(mut self, cull: Cull) -> Self {
        self.cull = cull;
        self
    }

    /// Whether it can generate any number of rays.
    pub fn has_generator(&self) -> bool {
        self.generator.is_some()
    }

    /// At most `limit` rays: the fixed ones, then rays generated from `seed`.
    pub fn rays(&self, limit: usize, seed: u64) -> Vec<Ray> {
        let mut rays: Vec<Ray> = self.fixed.iter().copied().take(limit).collect();
        if let Some(generator) = &self.generator {
            let mut random = Random::new(seed);
            rays.extend((rays.len()..limit).map(|_| generator(&mut random)));
        }
        rays
    }

    /// At most `limit` camera rays, distributed evenly over the cameras and over each picture.
    pub fn camera_rays(&self, limit: usize) -> Vec<Ray> {
        let each = limit / self.cameras.len().max(1);
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
            .field("must_hit", &self.must_hit)
            .field("fixed_rays", &self.fixed.len())
            .field("has_generator", &self.has_generator())
            .finish()
    }
}
