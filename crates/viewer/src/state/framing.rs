//! What the picture follows from: its size, its camera, what is in view, and what its rays hit.

use super::pick::Pick;
use super::viewpoint::Viewpoint;
use super::{REST_SAMPLES, Resolution, State};
use raycast_core::camera::{Camera, ImagePlane, PlaneError, PlaneRequest, Projection};
use raycast_core::glam::DVec3;
use raycast_core::render::{Settings, View};
use raycast_core::scene::{Bounds, Masks};
use raycast_core::shade::{Legend, Mode};
use std::sync::Arc;

impl State {
    /// Columns and rows of the picture.
    pub fn size(&self) -> (u32, u32) {
        match self.resolution {
            Resolution::Fixed(columns, rows) => (columns, rows),
            Resolution::Window { density } => {
                let side = |pixels: u32| {
                    let side = (f64::from(pixels) * density).round();
                    side.clamp(1.0, f64::from(self.side_limit)) as u32
                };
                (side(self.viewport.0), side(self.viewport.1))
            }
        }
    }

    /// The frame's height at the target, in scene units.
    pub fn frame_height(&self) -> f64 {
        self.viewpoint.frame_height()
    }

    /// Samples a pixel of a still or saved picture: as set, else [`REST_SAMPLES`] if the preferences allow it and each
    /// pixel of the window has one ray, or columns and rows were typed: that is a picture to be saved. A person who
    /// makes the step larger wants to see single rays.
    pub fn rest_samples(&self) -> u32 {
        let is_picture = match self.resolution {
            Resolution::Window { density } => density == 1.0,
            Resolution::Fixed(..) => true,
        };
        match self.samples {
            Some(samples) => samples,
            None if self.preferences.refine && is_picture => REST_SAMPLES,
            None => 1,
        }
    }

    /// The lattice of rays.
    ///
    /// # Errors
    /// A size or a frame out of range.
    pub fn plane(&self) -> Result<ImagePlane, PlaneError> {
        PlaneRequest {
            size: Some(self.size()),
            step: None,
            frame_height: Some(self.frame_height()),
        }
        .resolve(self.size(), self.frame_height())
    }

    /// The camera; `None` where the plane cannot be made.
    pub fn camera(&self) -> Option<Camera> {
        let plane = self.plane().ok()?;
        let mut viewpoint = self.viewpoint;
        if viewpoint.projection == Projection::Orthographic {
            // Zooming narrows the frame; the plane that rays start from stays in front of the scene.
            viewpoint.orbit.distance = viewpoint.orbit.distance.max(self.clear_distance());
        }
        let camera = Camera::new(viewpoint.pose(), viewpoint.projection, plane);
        Some(match self.can_shift() {
            true => camera.shifted(self.shift),
            false => camera,
        })
    }

    /// Whether the projection's frame can be shifted.
    pub fn can_shift(&self) -> bool {
        let projection = self.viewpoint.projection;
        projection.panorama().is_none() || projection.lens().is_some()
    }

    /// The distance from the pivot at which an eye has everything in front of it.
    fn clear_distance(&self) -> f64 {
        let orbit = self.viewpoint.orbit;
        let back = orbit.back();
        self.bounds()
            .corners()
            .into_iter()
            .map(|corner| (corner - orbit.pivot).dot(back))
            .filter(|distance| distance.is_finite())
            .fold(0.0, f64::max)
            * 1.05
    }

    /// The box around the scene; a unit box about the origin while there is none.
    pub fn bounds(&self) -> Bounds {
        match &self.document {
            Some(document) if !document.bounds.is_empty() => document.bounds,
            _ => Bounds::around([DVec3::splat(-0.5), DVec3::splat(0.5)]),
        }
    }

    /// The scene's size: the diagonal of its box, in scene units.
    pub fn extent(&self) -> f64 {
        let length = self.bounds().size().length();
        if length.is_normal() { length } else { 1.0 }
    }

    /// The greatest coordinate that is displayed as 0: what arithmetic leaves of zeros is below it, and what a person can
    /// see above it. Zooming ends at 1e-5 of the scene's size, where a pixel is some 1e-8 of it.
    pub fn negligible(&self) -> f64 {
        self.extent() * 1e-9
    }

    /// The picture's width over its height.
    pub fn aspect(&self) -> f64 {
        let (columns, rows) = match self.resolution {
            Resolution::Fixed(columns, rows) => (columns, rows),
            Resolution::Window { .. } => self.viewport,
        };
        f64::from(columns.max(1)) / f64::from(rows.max(1))
    }

    /// The greatest coordinate along a direction of what is visible.
    fn support(&self, direction: DVec3) -> Option<f64> {
        match &self.document {
            Some(document) => document.accel.support(direction),
            None => {
                let corners = self.bounds().corners().into_iter();
                corners.map(|corner| corner.dot(direction)).reduce(f64::max)
            }
        }
    }

    /// The viewpoint with this direction and lens that has everything visible in view.
    pub fn fitted(&self, viewpoint: Viewpoint) -> Viewpoint {
        let center = self.bounds().center();
        viewpoint.fitted(center, self.aspect(), |direction| self.support(direction))
    }

    /// Sets the size of the picture's place. A view that was fitted to what is visible stays so, as does the first one.
    pub fn set_viewport(&mut self, pixels: (u32, u32)) {
        if self.viewport == pixels {
            return;
        }
        let is_fitted = |state: &Self, view| state.document.is_some() && view == state.fitted(view);
        let fits = self.motion.is_none() && is_fitted(self, self.viewpoint);
        let home_fits = is_fitted(self, self.home);
        self.viewport = pixels;
        if fits {
            self.viewpoint = self.fitted(self.viewpoint);
        }
        if home_fits {
            self.home = self.fitted(self.home);
        }
    }

    /// Everything that decides a picture in motion; `None` while there is no scene.
    pub fn view(&self) -> Option<View> {
        let document = self.document.as_ref()?;
        Some(View {
            scene: Arc::clone(&document.built),
            accel: Arc::clone(&document.accel),
            camera: self.camera()?,
            settings: Settings {
                samples: self.samples.unwrap_or(1),
                ..self.settings
            },
        })
    }

    /// The same for a still or saved picture.
    pub fn view_at_rest(&self) -> Option<View> {
        let mut view = self.view()?;
        view.settings.samples = self.rest_samples();
        Some(view)
    }

    /// The hit of the ray through (x, y) of the picture.
    pub fn pick(&self, x: f64, y: f64) -> Option<Pick> {
        let ray = self.camera()?.ray(x, y);
        let document = self.document.as_ref()?;
        let masks = Masks::of(&document.scene);
        let kept = document.accel.clipped(&self.settings.clip);
        let hit = (kept.masked(masks.as_ref())).cast(&ray, self.settings.cull)?;
        Some(Pick {
            hit,
            point: ray.at(hit.t),
        })
    }

    /// The legend to show: of the selected object where it shows numbers by itself, else the picture's.
    pub fn shown_legend(&self) -> Option<Arc<Legend>> {
        let shown = self.legend.as_ref()?;
        let shading = &self.settings.shading;
        let own = || {
            let scene = &self.document.as_ref()?.built;
            Legend::of_object(self.selected?, scene, &self.camera()?, shading)
        };
        let own = (shading.mode != Mode::Depth).then(own).flatten();
        Some(own.map_or_else(|| Arc::clone(shown), Arc::new))
    }

    /// For each point, whether a surface that is kept lies before it, nearer to the eye by more than a pixel's width
    /// there: what is less apart touches it, as far as the picture can show.
    pub fn hidden(&self, points: &[DVec3]) -> Vec<bool> {
        let Some((camera, document)) = self.camera().zip(self.document.as_ref()) else {
            return vec![false; points.len()];
        };
        let masks = Masks::of(&document.built);
        let kept = document.accel.clipped(&self.settings.clip);
        let kept = kept.masked(masks.as_ref());
        let is_hidden = |point: &DVec3| {
            let (x, y) = camera.project(*point)?;
            let ray = camera.ray(x, y);
            let hit = ray.at(kept.cast(&ray, self.settings.cull)?.t);
            let away = point.distance(ray.origin);
            let pixel = camera.plane().step
                * match camera.projection().is_parallel() {
                    true => 1.0,
                    false => away / camera.distance(),
                };
            Some(hit.distance(ray.origin) < away - pixel)
        };
        let points = points.iter();
        points.map(|p| is_hidden(p).unwrap_or(false)).collect()
    }

    /// The number of columns and rows of tiles.
    pub fn tile_counts(&self) -> (u32, u32) {
        let (columns, rows) = self.size();
        self.grid.counts(columns, rows)
    }
}
