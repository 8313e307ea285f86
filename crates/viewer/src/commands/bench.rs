mod modes;
mod passes;

use super::{Failure, warn, workers};
use crate::cli::BenchArgs;
use crate::output::print;
use crate::progress::TerminalProgress;
use crate::stats::{self, json, milliseconds};
use crate::{memory, setup};
use passes::PassFigures;
use raycast_core::camera::{Camera, Grid, ImagePlane, Lattice, PixelFilter, PlaneRequest, Pose};
use raycast_core::picture::Picture;
use raycast_core::render::{Cancel, Settings, TileStats, View};
use raycast_core::scene::{ClippingPlanes, Scene};
use raycast_core::shade::Shading;
use raycast_core::{Accel, Detail};
use raycast_core::{Precision, formats};
use raycast_report::casters::{self, Caster};
use raycast_report::embree::{Embree, EmbreeError};
use raycast_report::scenes::{Made, interior_camera};
use raycast_report::{subject, views};
use rayon::ThreadPool;
use serde::Serialize;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The measurements of a file.
#[derive(Debug, Serialize)]
struct FileFigures {
    file: String,
    triangles: usize,
    build_ms: f64,
    threads: usize,
    simd: &'static str,
    instances: bool,
    precision: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    builds: Option<Vec<BuildFigures>>,
    views: Vec<ViewFigures>,
}

/// The build times of a caster's tree, measured in turns with the others'.
#[derive(Debug, Serialize)]
struct BuildFigures {
    caster: &'static str,
    ms: TimeRange,
}

/// The measurements of a view.
#[derive(Debug, Serialize)]
struct ViewFigures {
    view: &'static str,
    rays: u64,
    hits: u64,
    cast_ms: TimeRange,
    hits_ms: TimeRange,
    frame_ms: TimeRange,
    mrays_per_s: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    passes: Option<Vec<PassFigures>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    baselines: Option<Vec<BaselineFigures>>,
}

/// The measurements of another caster: of all the view's rays, or for brute force of a sample of them.
#[derive(Debug, Serialize)]
struct BaselineFigures {
    caster: String,
    rays: u64,
    hits: u64,
    cast_ms: TimeRange,
    mrays_per_s: f64,
    /// RayCast's rays a second divided by this caster's.
    raycast_is_faster: f64,
}

/// How many times trees are built for comparison.
const BUILDS: usize = 5;

/// The most tests of a ray against a triangle that brute force makes in a frame.
const BRUTE_FORCE_TESTS: usize = 2_000_000;

/// The minimum and the median of several times, in milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
struct TimeRange {
    min: f64,
    median: f64,
}

impl TimeRange {
    /// Sorts the times.
    fn from_times(times: &mut [Duration]) -> Self {
        times.sort_unstable();
        Self {
            min: times.first().copied().map_or(0.0, milliseconds),
            median: milliseconds(median(times)),
        }
    }
}

/// The median of sorted times; zero of none.
fn median(sorted: &[Duration]) -> Duration {
    match (sorted.get(sorted.len() / 2), sorted.len() % 2) {
        (None, _) => Duration::ZERO,
        (Some(&middle), 1) => middle,
        (Some(&upper), _) => (sorted[sorted.len() / 2 - 1] + upper) / 2,
    }
}

/// Measures frame times and prints them.
pub(super) fn run(args: &BenchArgs) -> Result<(), Failure> {
    let pool = workers(args.casting.threads)?;
    if args.modes {
        return modes::run(args, &pool);
    }
    let mut figures = Vec::with_capacity(args.files.len());
    for file in &args.files {
        let progress = TerminalProgress::new();
        progress.loading();
        let budget = memory::budget(args.reading.limits());
        let scene =
            formats::read_scene_within(file, &budget, &|share| progress.loaded(share))?.scene;
        let cameras = cameras(args, &scene)?;
        let name = file.display().to_string();
        figures.push(measure(args, name, scene, cameras, &pool, &progress)?);
    }
    for made in &args.made {
        let (Made::Ball(triangles) | Made::Interior(triangles)) = *made;
        memory::check_tree(&made.to_string(), triangles as usize)?;
        let scene = made.scene();
        let cameras = match made {
            // From outside only walls would be visible.
            Made::Interior(_) if args.eye.is_none() => inside(args)?,
            _ => cameras(args, &scene)?,
        };
        let progress = TerminalProgress::new();
        figures.push(measure(
            args,
            made.to_string(),
            scene,
            cameras,
            &pool,
            &progress,
        )?);
    }
    print(&json(&figures)?)
}

fn measure(
    args: &BenchArgs,
    name: String,
    scene: Scene,
    cameras: Vec<(&'static str, Camera)>,
    pool: &ThreadPool,
    progress: &TerminalProgress,
) -> Result<FileFigures, Failure> {
    progress.building();
    // Other casters have no instances: they get every triangle.
    let build = match args.baselines {
        true => setup::single_tree,
        false => setup::tree,
    };
    let stored = match args.baselines {
        true => scene.triangle_count(),
        false => setup::stored_triangles(&scene),
    };
    memory::check_tree(&name, stored)?;
    let building = Instant::now();
    let accel = Arc::new(pool.install(|| build(&scene))?);
    let build_time = building.elapsed();
    let (builds, baselines) = if args.baselines {
        let embree = Embree::load(pool.current_num_threads());
        let builds = pool.install(|| measure_builds(&scene, &accel, embree.as_ref().ok()))?;
        let casters = pool.install(|| baselines(&accel, embree));
        (Some(builds), Some(casters))
    } else {
        (None, None)
    };

    let scene = Arc::new(scene);
    progress.counting(
        "measuring",
        cameras.len() as u64 * (u64::from(args.frames) + 1) * (1 + u64::from(args.passes)),
    );
    let mut views = Vec::with_capacity(cameras.len());
    for (name, camera) in cameras {
        let view = View {
            scene: Arc::clone(&scene),
            accel: Arc::clone(&accel),
            camera,
            settings: Settings {
                shading: Shading {
                    mode: args.mode,
                    ..Shading::default()
                },
                cull: args.casting.cull.unwrap_or_default(),
                clip: args.casting.clip.planes(ClippingPlanes::NONE)?,
                precision: args.casting.precision.unwrap_or_default(),
                samples: 1,
                pixel_filter: PixelFilter::Box,
                layers: false,
            },
        };
        let measured =
            pool.install(|| measure_view(name, &view, baselines.as_deref(), args.frames, progress));
        let passes = args
            .passes
            .then(|| pool.install(|| passes::measure(&view, args.frames, progress)));
        views.push(ViewFigures {
            passes: passes.transpose()?,
            ..measured?
        });
    }
    Ok(FileFigures {
        file: name,
        triangles: scene.triangle_count(),
        build_ms: milliseconds(build_time),
        threads: pool.current_num_threads(),
        simd: accel.simd().name(),
        instances: accel.has_instances(),
        precision: match args.casting.precision.unwrap_or_default() {
            Precision::Fast => "fast",
            Precision::Exact => "exact",
        },
        builds,
        views,
    })
}

/// Builds trees in turns: RayCast's from the scene, and Embree's from buffers that are already filled.
fn measure_builds(
    scene: &Scene,
    accel: &Accel,
    embree: Option<&Arc<Embree>>,
) -> Result<Vec<BuildFigures>, Failure> {
    let corners: Vec<_> = (0..accel.len() as u32).map(|s| accel.corners(s)).collect();
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for _ in 0..BUILDS {
        let begin = Instant::now();
        let tree = setup::single_tree(scene)?;
        ours.push(begin.elapsed());
        drop(tree);
        match embree.map(|library| library.scene(&corners, true)) {
            Some(Ok(built)) => theirs.push(built.commit_time()),
            Some(Err(error)) => warn(&format!("Embree built no tree: {error}")),
            None => {}
        }
    }
    let figures = [("RayCast", ours), ("Embree robust", theirs)].into_iter();
    Ok(figures
        .filter(|(_, times)| !times.is_empty())
        .map(|(caster, mut times)| BuildFigures {
            caster,
            ms: TimeRange::from_times(&mut times),
        })
        .collect())
}

/// The casters to compare with: those with trees of their own, brute force, and Embree if it is installed.
fn baselines(accel: &Arc<Accel>, embree: Result<Arc<Embree>, EmbreeError>) -> Vec<Box<dyn Caster>> {
    let mut all = casters::trees(accel);
    all.extend(casters::brute_force(accel));
    match embree.and_then(|library| casters::embree(accel, &library)) {
        Ok(embree) => all.extend(embree),
        Err(error) => warn(&format!("Embree is left out: {error}")),
    }
    all
}

/// The views of a scene [`Made::Interior`].
fn inside(args: &BenchArgs) -> Result<Vec<(&'static str, Camera)>, Failure> {
    let camera = |close| -> Result<Camera, Failure> {
        let camera = interior_camera(args.size, close)?;
        let projection = args.projection();
        let is_planar = projection.panorama().is_none() || projection.lens().is_some();
        let plane = match is_planar {
            true => camera.plane(),
            false => plane(args, &camera.pose())?,
        };
        Ok(Camera::new(camera.pose(), projection, plane))
    };
    Ok(vec![("medium", camera(false)?), ("close", camera(true)?)])
}

/// The field of view in degrees, checked.
fn fov(args: &BenchArgs) -> Result<f64, Failure> {
    let fov = args.fov.unwrap_or(args.projection().default_fov());
    let checked = args.projection().check_fov(fov);
    checked.map_err(|error| Failure::usage(format!("--fov {fov}: {error}")))
}

/// The image plane of a camera with this pose.
fn plane(args: &BenchArgs, pose: &Pose) -> Result<ImagePlane, Failure> {
    let distance = pose.eye.distance(pose.target);
    let request = PlaneRequest {
        size: Some(args.size),
        ..PlaneRequest::default()
    };
    let frame = args.projection().frame(fov(args)?, distance);
    Ok(request.resolve(args.size, frame)?)
}

/// The views to measure, by name.
fn cameras(args: &BenchArgs, scene: &Scene) -> Result<Vec<(&'static str, Camera)>, Failure> {
    let camera = |pose: Pose| -> Result<Camera, Failure> {
        pose.check()?;
        let plane = plane(args, &pose)?;
        Ok(Camera::new(pose, args.projection(), plane))
    };
    if let Some(eye) = args.eye {
        let target = args.target.unwrap_or(scene.bounding_sphere().0);
        let towards = Pose::towards(eye, target);
        let given = Pose {
            up: args.up.unwrap_or(towards.up),
            ..towards
        };
        return Ok(vec![("given", camera(given)?)]);
    }
    let seen = args.projection().fitting_fov(fov(args)?);
    let from = |nearer| camera(views::filling(scene, args.size, seen, nearer)?.pose());
    Ok(vec![("medium", from(1.0)?), ("close", from(2.0)?)])
}

/// Measures frames of one view, in turns with the other casters, after one frame that warms up.
fn measure_view(
    name: &'static str,
    view: &View,
    baselines: Option<&[Box<dyn Caster>]>,
    frames: u32,
    progress: &TerminalProgress,
) -> Result<ViewFigures, Failure> {
    let mut cast_times = Vec::new();
    let mut hits_times = Vec::new();
    let mut frame_times = Vec::new();
    let casters = baselines.unwrap_or_default();
    let lattices: Vec<Vec<Lattice>> = casters
        .iter()
        .map(|caster| {
            let stride = subject::stride(&view.camera, caster.tests_per_ray(), BRUTE_FORCE_TESTS);
            subject::tiles(&view.camera, stride)
        })
        .collect();
    let mut baseline_frames: Vec<Vec<(Duration, usize)>> = vec![Vec::new(); casters.len()];
    let mut tiles = TileStats::default();
    let plane = view.camera.plane();
    let mut picture = Picture::blank(plane.columns, plane.rows, false);
    for frame in 0..=frames {
        let started = Instant::now();
        let counts = std::hint::black_box(view.cast(Grid::default(), Detail::Triangle));
        let cast = started.elapsed();
        let started = Instant::now();
        std::hint::black_box(view.cast(Grid::default(), Detail::Full));
        let hits = started.elapsed();
        let wall = render_frame(view, &mut picture)?;
        for ((caster, lattices), frames) in casters.iter().zip(&lattices).zip(&mut baseline_frames)
        {
            let started = Instant::now();
            let hits = subject::find_tiles(caster.as_ref(), lattices);
            if frame > 0 {
                frames.push((started.elapsed(), hits));
            }
        }
        if frame > 0 {
            cast_times.push(cast);
            hits_times.push(hits);
            frame_times.push(wall);
            tiles = counts;
        }
        progress.done(1);
    }
    let cast_ms = TimeRange::from_times(&mut cast_times);
    let cast_time = median(&cast_times);
    Ok(ViewFigures {
        view: name,
        rays: tiles.rays,
        hits: tiles.counts.hits,
        cast_ms,
        hits_ms: TimeRange::from_times(&mut hits_times),
        frame_ms: TimeRange::from_times(&mut frame_times),
        mrays_per_s: stats::mrays_per_s(tiles.rays, cast_time),
        passes: None,
        baselines: baselines.map(|casters| {
            let measured = casters.iter().zip(&lattices).zip(baseline_frames);
            measured
                .map(|((caster, lattices), frames)| {
                    let rays = lattices.iter().map(Lattice::len).sum::<usize>() as u64;
                    let mut times: Vec<_> = frames.iter().map(|frame| frame.0).collect();
                    let cast_ms = TimeRange::from_times(&mut times);
                    BaselineFigures {
                        caster: caster.name().to_owned(),
                        rays,
                        hits: frames.last().map_or(0, |frame| frame.1 as u64),
                        cast_ms,
                        mrays_per_s: stats::mrays_per_s(rays, median(&times)),
                        raycast_is_faster: times_as_fast(
                            (tiles.rays, cast_time),
                            (rays, median(&times)),
                        ),
                    }
                })
                .collect()
        }),
    })
}

/// The first's rays a second divided by the other's, rounded to two decimals; 0 if that is not finite.
fn times_as_fast(one: (u64, Duration), other: (u64, Duration)) -> f64 {
    let seconds = |(rays, time): (u64, Duration)| time.as_secs_f64() / rays.max(1) as f64;
    let ratio = seconds(other) / seconds(one);
    if ratio.is_finite() {
        (ratio * 100.0).round() / 100.0
    } else {
        0.0
    }
}

/// The time of one frame: visibility, shading and the RGBA image, into the memory of the frame before.
fn render_frame(view: &View, picture: &mut Picture) -> Result<Duration, Failure> {
    let started = Instant::now();
    let clock = || Duration::ZERO;
    let done = view.render_into(
        Grid::default(),
        &clock,
        &Cancel::default(),
        &|_| (),
        picture,
    );
    let wall = started.elapsed();
    if done {
        Ok(wall)
    } else {
        Err(Failure::could_not("the render was stopped"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spreads_are_least_and_middle() {
        let ms = Duration::from_millis;
        let odd = TimeRange::from_times(&mut [ms(5), ms(1), ms(3)]);
        assert_eq!((odd.min, odd.median), (1.0, 3.0));
        let even = TimeRange::from_times(&mut [ms(4), ms(1), ms(2), ms(9)]);
        assert_eq!((even.min, even.median), (1.0, 3.0));
        assert_eq!(TimeRange::from_times(&mut []), TimeRange::default());
    }

    #[test]
    fn json_is_as_promised() {
        let figures = ViewFigures {
            view: "medium",
            rays: 2,
            hits: 1,
            cast_ms: TimeRange::default(),
            hits_ms: TimeRange::default(),
            frame_ms: TimeRange::default(),
            mrays_per_s: 1.0,
            passes: None,
            baselines: None,
        };
        let value = serde_json::to_value(figures).expect("JSON");
        let mut keys: Vec<_> = value.as_object().expect("an object").keys().collect();
        keys.sort();
        assert_eq!(
            keys,
            [
                "cast_ms",
                "frame_ms",
                "hits",
                "hits_ms",
                "mrays_per_s",
                "rays",
                "view"
            ]
        );
        assert_eq!(
            value["cast_ms"],
            serde_json::json!({"min": 0.0, "median": 0.0})
        );
    }
}
