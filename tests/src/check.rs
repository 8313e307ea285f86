//! Asks the core and the oracle the same, and compares.

use crate::oracle::{Oracle, Truth};
use raycast_core::accel::Accel;
use raycast_core::camera::{Camera, Grid, ImagePlane, Placement, Projection, Ray};
use raycast_core::glam::DVec3;
use raycast_core::image::{Layers, Picture};
use raycast_core::intersect::{Cull, Hit};
use raycast_core::render::{Cancel, Settings, View};
use raycast_core::scene::{Mesh, Object, Scene};
use raycast_core::shade::{Mode, Shading};
use rayon::prelude::*;
use std::sync::Arc;
use std::time::Duration;

/// Below this cosine between ray and normal, distances and weights are not held to a bound.
const GRAZING: f64 = 0.1;

/// A scene with its tree and its oracle.
pub struct Stage {
    /// The scene.
    pub scene: Arc<Scene>,
    /// The tree over it.
    pub accel: Arc<Accel>,
    /// The truth about it.
    pub oracle: Oracle,
}

impl Stage {
    /// A scene made ready.
    pub fn new(scene: Scene) -> Self {
        let accel = Accel::build(&scene).expect("a valid scene");
        let oracle = Oracle::new(&scene, &accel);
        Self {
            scene: Arc::new(scene),
            accel: Arc::new(accel),
            oracle,
        }
    }

    /// One object a mesh, each where its mesh is.
    pub fn of(meshes: impl IntoIterator<Item = Mesh>) -> Self {
        let objects = meshes
            .into_iter()
            .map(|mesh| Object::new("object", Arc::new(mesh)))
            .collect();
        Self::new(Scene { objects })
    }

    /// Casts a ray: through the tree, by brute force, and in truth. All must agree.
    pub fn check(&self, ray: &Ray, cull: Cull) -> Option<Truth> {
        let truth = self.check_quickly(ray, cull);
        let cast = self.accel.cast(ray, cull);
        let brute = self.accel.cast_brute_force(ray, cull);
        assert_eq!(cast, brute, "tree (left) against brute force: {ray:?}");
        truth
    }

    /// As [`Stage::check`] without brute force, for large meshes.
    pub fn check_quickly(&self, ray: &Ray, cull: Cull) -> Option<Truth> {
        let truth = self.oracle.nearest(ray, cull);
        let cast = self.accel.cast(ray, cull);
        if let Err(fault) = compare(cast.as_ref(), truth.as_ref()) {
            panic!(
                "{fault}\n cull: {cull:?}\n  ray: {ray:?}\n cast: {cast:?}\n      {}\ntruth: {truth:?}\n      {}",
                self.describe(cast.map(|hit| (hit.object, hit.triangle))),
                self.describe(truth.map(|truth| (truth.object, truth.triangle))),
            );
        }
        truth
    }

    /// [`Stage::check`] for many rays, in parallel. How many of them met something.
    pub fn check_all(&self, rays: &[Ray], cull: Cull) -> usize {
        rays.par_iter()
            .filter(|ray| self.check(ray, cull).is_some())
            .count()
    }

    /// [`Stage::check_quickly`] for many rays, in parallel. How many of them met something.
    pub fn check_all_quickly(&self, rays: &[Ray], cull: Cull) -> usize {
        rays.par_iter()
            .filter(|ray| self.check_quickly(ray, cull).is_some())
            .count()
    }

    /// A view of it, with layers.
    pub fn view(&self, camera: Camera, cull: Cull) -> View {
        View {
            scene: self.scene.clone(),
            accel: self.accel.clone(),
            camera,
            settings: Settings {
                shading: Shading {
                    mode: Mode::Color,
                    ..Shading::default()
                },
                cull,
                samples: 1,
                layers: true,
                ..Settings::default()
            },
        }
    }

    /// Renders the view, in tiles, and compares every `every`-th pixel (along both sides) with the
    /// truth, and with [`Accel::cast`] of the pixel's ray.
    pub fn check_picture(&self, camera: Camera, cull: Cull, every: u32) -> Picture {
        let picture = render(&self.view(camera, cull), Grid::default());
        let layers = picture.layers.as_ref().expect("layers were asked for");
        let (columns, rows) = (picture.width, picture.height);
        (0..rows)
            .step_by(every as usize)
            .flat_map(|y| (0..columns).step_by(every as usize).map(move |x| (x, y)))
            .collect::<Vec<_>>()
            .into_par_iter()
            .for_each(|(x, y)| {
                let ray = camera.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let truth = self.check_quickly(&ray, cull);
                let (object, triangle, depth) = pixel(layers, columns, x, y);
                let expected = truth.map_or((u32::MAX, u32::MAX), |t| (t.object, t.triangle));
                let is_right = (object, triangle) == expected
                    && truth.map_or(depth == f32::INFINITY, |truth| {
                        truth.cosine <= GRAZING || ulps(depth, truth.t) <= 4.0
                    });
                assert!(
                    is_right,
                    "pixel ({x}, {y}) shows object {object} triangle {triangle} at {depth}\n  ray: {ray:?}\ntruth: {truth:?}\n      {}\n{camera:?}",
                    self.describe(truth.map(|truth| (truth.object, truth.triangle))),
                );
                let cast = self.accel.cast(&ray, cull).map_or(f32::INFINITY, |hit| hit.t as f32);
                assert!(
                    depth.to_bits() == cast.to_bits(),
                    "pixel ({x}, {y}) is at {depth}, its ray's hit at {cast}: {ray:?}"
                );
            });
        picture
    }

    /// A triangle's corners, to be copied into a test.
    fn describe(&self, numbers: Option<(u32, u32)>) -> String {
        numbers.map_or_else(String::new, |(object, triangle)| {
            let mesh = &self.scene.objects[object as usize].mesh;
            format!(
                "offset {:?}, corners {:?}",
                mesh.offset(),
                mesh.corners(triangle)
            )
        })
    }
}

/// A pixel's object, triangle and depth.
pub fn pixel(layers: &Layers, columns: u32, x: u32, y: u32) -> (u32, u32, f32) {
    let index = (y * columns + x) as usize;
    (
        layers.object[index],
        layers.triangle[index],
        layers.depth[index],
    )
}

/// Whether a hit is the truth: the same triangle, and numbers within the bounds that the project
/// promises (t within 4 ulp of single precision and u, v within 4 · 2⁻²³, where the ray does not
/// graze).
fn compare(hit: Option<&Hit>, truth: Option<&Truth>) -> Result<(), String> {
    let (hit, truth) = match (hit, truth) {
        (None, None) => return Ok(()),
        (Some(hit), Some(truth)) => (hit, truth),
        (None, Some(_)) => return Err("a miss where there is a hit".to_owned()),
        (Some(_), None) => return Err("a hit where there is a miss".to_owned()),
    };
    if (hit.object, hit.triangle) != (truth.object, truth.triangle) {
        return Err("the wrong triangle".to_owned());
    }
    let (u, v) = (hit.u, hit.v);
    if !(hit.t.is_finite() && (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v)) {
        return Err("a number out of its range".to_owned());
    }
    if truth.cosine <= GRAZING {
        return Ok(());
    }
    let error = (hit.t - truth.t).abs() / ulp(truth.t);
    if error > 4.0 {
        return Err(format!("t is off by {error} ulp"));
    }
    let error = (u - truth.u).abs().max((v - truth.v).abs()) * 2f64.powi(23);
    if error > 4.0 {
        return Err(format!("u, v are off by {error} · 2^-23"));
    }
    Ok(())
}

/// How far a single-precision number is from the truth, in units of its last place.
fn ulps(found: f32, truth: f64) -> f64 {
    (f64::from(found) - truth).abs() / ulp(truth)
}

/// A unit in the last place of single precision, at a double.
fn ulp(x: f64) -> f64 {
    let power = f64::from_bits(x.abs().to_bits() & 0x7ff0_0000_0000_0000);
    (power * 2f64.powi(-23)).max(2f64.powi(-149))
}

/// Renders a whole view on the current thread pool.
pub fn render(view: &View, grid: Grid) -> Picture {
    view.render(grid, &|| Duration::ZERO, &Cancel::default(), &|_| ())
        .expect("nothing cancelled it")
}

/// A camera at `eye` that looks at `target`, its frame `height` high there, up being +Y.
pub fn camera(
    eye: DVec3,
    target: DVec3,
    projection: Projection,
    (columns, rows): (u32, u32),
    height: f64,
) -> Camera {
    let plane = ImagePlane::new(columns, rows, height / f64::from(rows)).expect("a good plane");
    let placement = Placement {
        eye,
        target,
        up: DVec3::Y,
    };
    Camera::new(placement, projection, plane)
}

/// Both projections, one after the other.
pub const PROJECTIONS: [Projection; 2] = [Projection::Perspective, Projection::Orthographic];

/// Runs `work` on a pool of so many threads.
pub fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("a thread pool")
        .install(work)
}
