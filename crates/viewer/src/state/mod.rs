//! What the window shows and how: plain values, no user interface.

pub mod command;
pub mod update;

use raycast_core::camera::{
    Camera, FrameLock, Grid, ImagePlane, Orbit, PlaneError, PlaneRequest, Projection, fit_distance,
    fov_to_frame,
};
use raycast_core::glam::DVec3;
use raycast_core::render::{Settings, View};
use raycast_core::scene::{Bounds, Scene};
use raycast_core::{Accel, Hit};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// The vertical field of view, in degrees, that the window starts with.
pub const DEFAULT_FOV: f64 = 45.0;
/// The narrowest and the widest field of view, in degrees.
pub const FOV_RANGE: (f64, f64) = (0.1, 170.0);
/// The most pixels of a picture in the window: 4 bytes each, held a few times over.
pub const WINDOW_PIXELS: u64 = 1 << 25;
/// The most samples a pixel.
pub const SAMPLES_LIMIT: u32 = raycast_core::ranges::MOST_SAMPLES;
/// The most tiles a picture is split into.
pub const TILES_LIMIT: u64 = 1 << 16;

/// A scene, ready to be cast at.
#[derive(Clone, Debug)]
pub struct Document {
    /// Counts scenes opened in this window.
    pub number: u64,
    /// What the title shows.
    pub name: String,
    /// The files it came from; none for the demo scene.
    pub paths: Vec<PathBuf>,
    /// The objects.
    pub scene: Arc<Scene>,
    /// Counts changes to the scene's colours and textures.
    pub edits: u64,
    /// The tree over its triangles.
    pub accel: Arc<Accel>,
    /// The box around everything, in world space.
    pub bounds: Bounds,
    /// How long reading took.
    pub load_time: Duration,
    /// How long the tree took.
    pub build_time: Duration,
}

/// Where the picture's columns and rows come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// The window's own pixels, times a density: 1 is a ray a pixel, ½ a ray for 2 × 2 of them.
    Window {
        /// Rays along a side for each pixel of the screen.
        density: f64,
    },
    /// So many columns and rows, whatever the window's size.
    Fixed(u32, u32),
}

/// What colours tiles by their statistics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tint {
    /// Nothing does.
    #[default]
    None,
    /// How long each took.
    Time,
    /// Which worker made it.
    Worker,
}

/// What is drawn over the picture about its tiles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overlay {
    /// Lines between tiles.
    pub borders: bool,
    /// The place of each tile in the order of arrival.
    pub order: bool,
    /// Colour by statistics.
    pub tint: Tint,
}

/// What a path is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PromptKind {
    /// A mesh or a scene to open.
    Open,
    /// Where to save the picture.
    Save,
    /// A texture for every object.
    Texture,
}

/// A line for a path, shown over the picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Prompt {
    /// What the path is for.
    pub kind: PromptKind,
    /// What was typed so far.
    pub text: String,
    /// Whether a desktop dialog is open as well.
    pub dialog: bool,
}

/// A short message that goes by itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Toast {
    /// What it says.
    pub text: String,
    /// When it came, on the window's clock.
    pub since: Duration,
}

/// The triangle under a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// Which, and where on it.
    pub hit: Hit,
    /// The point in world space.
    pub point: DVec3,
}

/// All that a person can change, and what there is to see.
#[derive(Clone, Debug)]
pub struct State {
    /// The scene on screen; `None` until the first one is there.
    pub document: Option<Document>,
    /// Where the camera is.
    pub orbit: Orbit,
    /// How rays leave it.
    pub projection: Projection,
    /// The vertical field of view in degrees. An orthographic frame is as high as this makes it at
    /// the orbit's distance, so that switching the projection keeps the picture.
    pub fov: f64,
    /// Where columns and rows come from.
    pub resolution: Resolution,
    /// What stays when the step changes.
    pub lock: FrameLock,
    /// The picture's place in the window, in device pixels.
    pub viewport: (u32, u32),
    /// The longest side that the window's graphics can hold.
    pub side_limit: u32,
    /// Shading, culling, samples.
    pub settings: Settings,
    /// How the picture is split.
    pub grid: Grid,
    /// What is drawn over it.
    pub overlay: Overlay,
    /// Render threads.
    pub threads: usize,
    /// Whether the side panel is open.
    pub panel: bool,
    /// Whether the keys are shown.
    pub help: bool,
    /// The path line, if open.
    pub prompt: Option<Prompt>,
    /// The file that a picture would replace, while the person is asked whether it may.
    pub replacing: Option<PathBuf>,
    /// Errors that were not dismissed yet, oldest first.
    pub errors: Vec<String>,
    /// Messages that go by themselves, oldest first.
    pub toasts: Vec<Toast>,
    /// The point of the picture under the cursor, in its pixels.
    pub hover: Option<(f64, f64)>,
    /// How far along the view axis the point is that a pan holds on to.
    pub grabbed_depth: f64,
}

impl Default for State {
    fn default() -> Self {
        let (yaw, pitch) = Orbit::DEFAULT_ANGLES;
        Self {
            document: None,
            orbit: Orbit {
                pivot: DVec3::ZERO,
                yaw,
                pitch,
                distance: 1.0,
            },
            projection: Projection::Perspective,
            fov: DEFAULT_FOV,
            resolution: Resolution::Window { density: 1.0 },
            lock: FrameLock::KeepFrame,
            viewport: (1280, 720),
            side_limit: 8192,
            settings: Settings {
                samples: 1,
                ..Settings::default()
            },
            grid: Grid::default(),
            overlay: Overlay::default(),
            threads: default_threads(),
            panel: true,
            help: false,
            prompt: None,
            replacing: None,
            errors: Vec::new(),
            toasts: Vec::new(),
            hover: None,
            grabbed_depth: 1.0,
        }
    }
}

/// As many threads as the machine runs at once.
pub fn default_threads() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

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
        fov_to_frame(self.fov, self.orbit.distance)
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
        let mut orbit = self.orbit;
        if self.projection == Projection::Orthographic {
            // Zooming narrows the frame; the plane that rays start from stays before the scene.
            orbit.distance = orbit.distance.max(self.clear_distance());
        }
        Some(Camera::new(orbit.placement(), self.projection, plane))
    }

    /// How far from the pivot an eye has everything in front of it.
    fn clear_distance(&self) -> f64 {
        let back = self.orbit.back();
        self.bounds()
            .corners()
            .into_iter()
            .map(|corner| (corner - self.orbit.pivot).dot(back))
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

    /// How large the scene is, corner to corner, in its units.
    pub fn extent(&self) -> f64 {
        let length = self.bounds().size().length();
        if length.is_normal() { length } else { 1.0 }
    }

    /// Brings the whole scene into view from where the camera looks.
    pub fn fit(&mut self) {
        let bounds = self.bounds();
        self.orbit.pivot = bounds.center();
        let aspect = f64::from(self.viewport.0.max(1)) / f64::from(self.viewport.1.max(1));
        let aspect = match self.resolution {
            Resolution::Fixed(columns, rows) => f64::from(columns) / f64::from(rows),
            Resolution::Window { .. } => aspect,
        };
        self.orbit.distance = fit_distance(&bounds, &self.orbit, self.projection, self.fov, aspect);
    }

    /// Everything that decides the picture; `None` while there is no scene.
    pub fn view(&self) -> Option<View> {
        let document = self.document.as_ref()?;
        Some(View {
            scene: Arc::clone(&document.scene),
            accel: Arc::clone(&document.accel),
            camera: self.camera()?,
            settings: self.settings,
        })
    }

    /// What the ray through (x, y) of the picture meets.
    pub fn pick(&self, x: f64, y: f64) -> Option<Pick> {
        let ray = self.camera()?.ray(x, y);
        let hit = self
            .document
            .as_ref()?
            .accel
            .cast(&ray, self.settings.cull)?;
        Some(Pick {
            hit,
            point: ray.at(hit.t),
        })
    }

    /// How many tiles the picture is split into, side by side and one above the other.
    pub fn tile_counts(&self) -> (u32, u32) {
        let (columns, rows) = self.size();
        self.grid.counts(columns, rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_three_are_bound_together() {
        let state = State::default();
        let plane = state.plane().expect("a good plane");
        let frame = f64::from(plane.rows) * plane.step;
        let d = state.orbit.distance;
        assert!(
            (frame - 2.0 * d * raycast_core::math::tan((DEFAULT_FOV / 2.0).to_radians())).abs()
                < 1e-12
        );
    }

    #[test]
    fn a_density_follows_the_window() {
        let mut state = State {
            resolution: Resolution::Window { density: 0.25 },
            viewport: (1000, 800),
            ..State::default()
        };
        assert_eq!(state.size(), (250, 200));
        state.viewport = (400, 404);
        assert_eq!(state.size(), (100, 101));
        state.viewport = (0, 0);
        assert_eq!(state.size(), (1, 1));
    }

    #[test]
    fn an_orthographic_eye_stays_before_the_scene() {
        let mut state = State {
            projection: Projection::Orthographic,
            ..State::default()
        };
        state.fit();
        let frame = state.frame_height();
        state.orbit.distance *= 0.01;
        let camera = state.camera().expect("a camera");
        assert!((camera.plane().frame_height() - frame * 0.01).abs() < frame * 1e-9);
        for corner in state.bounds().corners() {
            let depth = (corner - camera.placement().eye).dot(camera.forward());
            assert!(depth >= 0.0, "{corner} lies {depth} before the eye");
        }
    }
}
