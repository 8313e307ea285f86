//! A scene that is opened for rendering, with its camera and settings.

use super::{Failure, warn, warn_of_reading};
use crate::cli::RenderArgs;
use crate::progress::TerminalProgress;
use crate::stats::{self, Shares, Stats, StatsTarget, milliseconds};
use crate::{memory, setup};
use raycast_core::camera::{Camera, CameraPath, ImagePlane};
use raycast_core::formats::{CameraFile, SceneFile};
use raycast_core::math;
use raycast_core::picture::Format;
use raycast_core::render::{Settings, TileStats, View};
use raycast_core::scene::ClippingPlanes;
use rayon::ThreadPool;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// An opened scene, with its camera and settings.
pub(super) struct OpenedScene {
    pub(super) view: View,
    /// The scene file's camera.
    pub(super) camera_file: Option<CameraFile>,
    /// The scene file's keyframes.
    pub(super) animation: Option<CameraPath>,
    /// Every file that was opened.
    pub(super) opened: Vec<PathBuf>,
    /// Whether a part of each picture is rendered, which may well be empty.
    is_fragment: bool,
    warnings: Vec<String>,
    load_time: Duration,
    build_time: Duration,
}

impl OpenedScene {
    /// Reads files and builds the tree. Before building, `check` is called to check the outputs against the opened files.
    pub(super) fn open(
        args: &RenderArgs,
        format: Format,
        pool: &ThreadPool,
        progress: &TerminalProgress,
        check: &dyn Fn(&[PathBuf]) -> Result<(), Failure>,
    ) -> Result<Self, Failure> {
        progress.loading();
        let loading = Instant::now();
        let mut file = setup::load(&args.files, &args.reading, &|share| progress.loaded(share))?;
        setup::apply_textures_and_colors(&mut file.scene, &args.shading, &args.reading)?;
        check(&file.opened)?;
        let load_time = loading.elapsed();
        let settings = Settings {
            shading: setup::shading(&args.shading, file.shading),
            cull: (args.casting.cull).or(file.image.cull).unwrap_or_default(),
            clip: args.casting.clip.planes(file.clip)?,
            precision: (args.casting.precision)
                .or(file.image.precision)
                .unwrap_or_default(),
            samples: args.samples.or(file.image.samples).unwrap_or(1).max(1),
            pixel_filter: (args.pixel_filter)
                .or(file.image.pixel_filter)
                .unwrap_or_default(),
            layers: format == Format::Exr,
        };

        progress.building();
        let building = Instant::now();
        let SceneFile {
            scene,
            mut warnings,
            camera: camera_file,
            animation,
            image,
            opened,
            ..
        } = file;
        let name = setup::name_of(&args.files);
        let levels = match settings.shading.filter.has_footprint() {
            true => scene.level_bytes(),
            false => 0,
        };
        let normals = match settings.shading.is_creased() {
            true => scene.crease_bytes(),
            false => 0,
        };
        memory::check_scene(&name, setup::stored_triangles(&scene), levels + normals)?;
        let accel = pool.install(|| setup::visible_tree(&name, &scene))?;
        let build_time = building.elapsed();
        let bounds = setup::bounds(&scene, &accel);
        let camera = setup::camera(&args.camera, camera_file.as_ref(), image, &bounds)
            .map_err(|error| setup::camera_failure(&args.camera, &name, error))?;
        let lines = settings.shading.wireframe;
        if let Some(lines) = lines.and_then(|lines| lines.left_out(camera.projection())) {
            let seen = match camera.projection().lens() {
                Some(_) => "a picture through a lens",
                None => "a panorama",
            };
            warnings.push(format!("{lines} are not drawn: {seen} has none"));
        }
        warnings.extend(lens_warning(&camera));
        Ok(Self {
            view: View {
                scene: Arc::new(scene),
                accel: Arc::new(accel),
                camera,
                settings,
            },
            camera_file,
            animation,
            opened,
            is_fragment: args.tiles.sub_camera.is_some(),
            warnings,
            load_time,
            build_time,
        })
    }

    /// Reports what reading left out and that pictures show nothing, and writes the statistics.
    pub(super) fn report(
        &self,
        target: &StatsTarget,
        tiles: &TileStats,
        wall: Duration,
        started: Instant,
        pool: &ThreadPool,
    ) -> Result<(), Failure> {
        let view = &self.view;
        warn_of_reading(&self.warnings, &view.scene, &view.accel);
        let nothing = nothing_warning(tiles, &view.settings.clip);
        if let Some(nothing) = nothing.filter(|_| !self.is_fragment) {
            warn(&nothing);
        }
        let shares = Shares::new(wall, tiles);
        target.write(&Stats {
            triangles: view.scene.triangle_count() as u64,
            dropped: setup::dropped(&view.scene, &view.accel).total().into(),
            load_ms: milliseconds(self.load_time),
            build_ms: milliseconds(self.build_time),
            cast_ms: milliseconds(shares.cast),
            shade_ms: milliseconds(shares.shade),
            total_ms: milliseconds(started.elapsed()),
            rays: tiles.rays,
            hits: tiles.counts.hits,
            invalid_rays: 0,
            nodes: tiles.counts.nodes,
            triangles_set_up: tiles.counts.triangles,
            double_rays: tiles.counts.double_rays,
            exact_rays: tiles.counts.exact_rays,
            mrays_per_s: stats::mrays_per_s(tiles.rays, shares.cast),
            threads: pool.current_num_threads(),
            simd: view.accel.simd().name(),
            instances: view.accel.has_instances(),
            peak_bytes: stats::peak_bytes(),
        })
    }
}

/// A warning that a lens shows nothing in the picture's corners, which is how a mistyped coefficient looks.
fn lens_warning(camera: &Camera) -> Option<String> {
    let lens = camera.projection().lens()?;
    let ImagePlane { columns, rows, .. } = camera.plane();
    let [right, bottom] = [columns, rows].map(|count| f64::from(count) - 0.5);
    let mut corners = [(0.5, 0.5), (right, 0.5), (0.5, bottom), (right, bottom)].into_iter();
    let is_whole = corners.all(|(x, y)| camera.has_place(x, y));
    (!is_whole).then(|| {
        format!(
            "the lens ends {:.1} degrees off the view axis: pixels beyond that, in the corners at least, are empty",
            math::atan(lens.end()).to_degrees()
        )
    })
}

/// A warning that no ray hits anything, which is how a camera that looks elsewhere shows.
fn nothing_warning(tiles: &TileStats, clip: &ClippingPlanes) -> Option<String> {
    let left = match clip.enabled().next() {
        None => "",
        Some(_) => " that the clipping planes leave",
    };
    let rays = tiles.rays;
    (rays > 0 && tiles.counts.hits == 0)
        .then(|| format!("none of {rays} rays hits a triangle{left}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_core::glam::DVec3;
    use raycast_core::scene::ClippingPlane;

    #[test]
    fn pictures_of_nothing_give_a_warning() {
        let of = |rays, hits, clip| {
            let mut tiles = TileStats {
                rays,
                ..TileStats::default()
            };
            tiles.counts.hits = hits;
            nothing_warning(&tiles, &clip)
        };
        let plane = ClippingPlane::new(DVec3::X, 5.0).expect("a plane");
        let clip = ClippingPlanes::new(&[plane]).expect("one plane");
        assert_eq!(of(12, 1, clip), None);
        assert_eq!(of(0, 0, clip), None, "all frames exist already");
        let all = ClippingPlanes::NONE;
        assert_eq!(
            of(12, 0, all).as_deref(),
            Some("none of 12 rays hits a triangle")
        );
        let left = "none of 12 rays hits a triangle that the clipping planes leave";
        assert_eq!(of(12, 0, clip).as_deref(), Some(left));
    }

    #[test]
    fn a_lens_that_ends_within_the_picture_gives_a_warning() {
        use raycast_core::camera::{BrownConrady, Pose, Projection};
        let pose = Pose::towards(DVec3::Z, DVec3::ZERO);
        let warning = |k1: f64| {
            let lens = BrownConrady::new([k1, 0.0, 0.0, 0.0, 0.0]).expect("a lens");
            let plane = ImagePlane::new(64, 48, 0.83 / 48.0).expect("a plane");
            let camera = Camera::new(pose, Projection::through(lens), plane);
            lens_warning(&camera)
        };
        // The end of -10 is where 1 − 30 r² is zero: at atan(0.1826).
        let ten = warning(-10.0).expect("a warning");
        assert!(ten.contains("ends 10.3 degrees off"), "{ten}");
        assert_eq!(warning(-0.2), None);
        let plane = ImagePlane::new(64, 48, 0.83 / 48.0).expect("a plane");
        let pinhole = Camera::new(pose, Projection::Perspective, plane);
        assert_eq!(lens_warning(&pinhole), None);
    }
}
