//! The time of each mode's pictures, relative to visibility alone.

use super::{cameras, inside, render_frame};
use crate::cli::BenchArgs;
use crate::commands::Failure;
use crate::memory;
use crate::output::print;
use crate::progress::TerminalProgress;
use crate::setup;
use crate::stats::{json, milliseconds};
use raycast_core::camera::{Camera, Grid};
use raycast_core::formats;
use raycast_core::math;
use raycast_core::picture::Picture;
use raycast_core::render::{Settings, View};
use raycast_core::scene::{ClippingPlanes, Scene, Texture};
use raycast_core::shade::{Mode, Shading, Wireframe};
use raycast_core::{Accel, Detail};
use raycast_report::scenes::Made;
use rayon::ThreadPool;
use serde::Serialize;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The kinds of pictures: name, mode, and what they have besides.
const PICTURES: [(&str, Mode, Extra); 13] = [
    ("color", Mode::Color, Extra::None),
    ("flat", Mode::Flat, Extra::None),
    ("smooth", Mode::Smooth, Extra::None),
    ("normals", Mode::Normals, Extra::None),
    ("depth", Mode::Depth, Extra::None),
    ("barycentric", Mode::Barycentric, Extra::None),
    ("uv", Mode::Uv, Extra::None),
    ("material", Mode::Material, Extra::None),
    ("texture", Mode::Texture, Extra::Texture),
    ("smooth, textured", Mode::Smooth, Extra::Texture),
    ("flat, wireframe", Mode::Flat, Extra::Lines),
    ("smooth, wireframe", Mode::Smooth, Extra::Lines),
    ("smooth, all channels", Mode::Smooth, Extra::Channels),
];

/// What a picture has besides its mode.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Extra {
    None,
    /// Each object has a texture, filtered bilinearly.
    Texture,
    /// A wireframe over it.
    Lines,
    /// The channels of an EXR.
    Channels,
}

/// All measurements.
#[derive(Debug, Serialize)]
struct ModeFigures {
    threads: usize,
    /// The bandwidth of one thread that writes to memory outside the caches, in 10⁹ bytes a second.
    written_gb_per_s: f64,
    modes: Vec<ModeMeasurement>,
}

/// The measurements of a kind of picture.
#[derive(Debug, Serialize)]
struct ModeMeasurement {
    mode: &'static str,
    /// The geometric mean over the views of frame time divided by cast time.
    frame_beside_cast: f64,
    /// The time that writing a picture's bytes takes at that bandwidth.
    written_ms: f64,
    views: Vec<ViewMeasurement>,
}

/// The measurements of a kind of picture in a view: the least times.
#[derive(Debug, Serialize)]
struct ViewMeasurement {
    file: String,
    view: &'static str,
    cast_ms: f64,
    frame_ms: f64,
    frame_beside_cast: f64,
}

/// Measures all modes and prints the figures.
pub(super) fn run(args: &BenchArgs, pool: &ThreadPool) -> Result<(), Failure> {
    let mut modes: Vec<Vec<ViewMeasurement>> = PICTURES.iter().map(|_| Vec::new()).collect();
    let mut measure = |name: String, scene: Scene, cameras| -> Result<(), Failure> {
        memory::check_tree(&name, setup::stored_triangles(&scene))?;
        let accel = Arc::new(pool.install(|| setup::tree(&scene))?);
        let textured = Arc::new(textured(&scene));
        let scenes = [Arc::new(scene), textured];
        for (view, camera) in cameras {
            let found = pool.install(|| measure_view(args, (&scenes, &accel), camera))?;
            let (cast, frames) = found;
            for (mode, frame) in modes.iter_mut().zip(frames) {
                mode.push(ViewMeasurement {
                    file: name.clone(),
                    view,
                    cast_ms: milliseconds(cast),
                    frame_ms: milliseconds(frame),
                    frame_beside_cast: ratio(frame, cast),
                });
            }
        }
        Ok(())
    };
    for file in &args.files {
        let progress = TerminalProgress::new();
        progress.loading();
        let budget = memory::budget(args.reading.limits());
        let scene =
            formats::read_scene_within(file, &budget, &|share| progress.loaded(share))?.scene;
        drop(progress);
        let cameras = cameras(args, &scene)?;
        measure(file.display().to_string(), scene, cameras)?;
    }
    for made in &args.made {
        let scene = made.scene();
        let cameras = match made {
            Made::Interior(_) if args.eye.is_none() => inside(args)?,
            _ => cameras(args, &scene)?,
        };
        measure(made.to_string(), scene, cameras)?;
    }
    let pixels = f64::from(args.size.0) * f64::from(args.size.1);
    let per_second = written_per_second();
    let modes = PICTURES.iter().zip(modes).map(|((mode, _, extra), views)| {
        let share = 1.0 / views.len().max(1) as f64;
        let roots = views
            .iter()
            .map(|view| math::pow(view.frame_beside_cast, share));
        let bytes = match extra {
            Extra::Channels => BYTES + CHANNEL_BYTES,
            _ => BYTES,
        };
        ModeMeasurement {
            mode,
            frame_beside_cast: roots.product(),
            written_ms: pixels * bytes as f64 / per_second * 1e3,
            views,
        }
    });
    print(&json(&ModeFigures {
        threads: pool.current_num_threads(),
        written_gb_per_s: per_second * 1e-9,
        modes: modes.collect(),
    })?)
}

/// Bytes of a pixel: 8-bit RGBA.
const BYTES: usize = 4;

/// Bytes of a pixel's other channels: colours in linear light, depth, object, triangle, normal and texture coordinates.
const CHANNEL_BYTES: usize = 16 + 4 + 4 + 4 + 12 + 8;

/// The least times of a view's visibility and of all its pictures, measured in turns after one that warms up.
fn measure_view(
    args: &BenchArgs,
    (scenes, accel): (&[Arc<Scene>; 2], &Arc<Accel>),
    camera: Camera,
) -> Result<(Duration, Vec<Duration>), Failure> {
    let view = |mode, extra| -> Result<View, Failure> {
        Ok(View {
            scene: Arc::clone(&scenes[usize::from(extra == Extra::Texture)]),
            accel: Arc::clone(accel),
            camera,
            settings: Settings {
                shading: Shading {
                    mode,
                    wireframe: (extra == Extra::Lines).then(Wireframe::default),
                    ..Shading::default()
                },
                cull: args.casting.cull.unwrap_or_default(),
                clip: args.casting.clip.planes(ClippingPlanes::NONE)?,
                precision: args.casting.precision.unwrap_or_default(),
                samples: 1,
                layers: extra == Extra::Channels,
                ..Settings::default()
            },
        })
    };
    let plane = camera.plane();
    let picture = |layers| Picture::blank(plane.columns, plane.rows, layers);
    let (mut plain, mut layered) = (picture(false), picture(true));
    let views: Result<Vec<_>, Failure> = (PICTURES.iter())
        .map(|&(_, mode, extra)| Ok((view(mode, extra)?, extra)))
        .collect();
    let views = views?;
    let mut cast = Duration::MAX;
    let mut frames = vec![Duration::MAX; views.len()];
    for turn in 0..=args.frames {
        for ((view, extra), least) in views.iter().zip(&mut frames) {
            let started = Instant::now();
            std::hint::black_box(view.cast(Grid::default(), Detail::Triangle));
            let visibility = started.elapsed();
            let picture = match extra {
                Extra::Channels => &mut layered,
                _ => &mut plain,
            };
            let frame = render_frame(view, picture)?;
            if turn > 0 {
                cast = cast.min(visibility);
                *least = frame.min(*least);
            }
        }
    }
    Ok((cast, frames))
}

/// The scene with a texture on each object.
fn textured(scene: &Scene) -> Scene {
    const SIDE: u32 = 512;
    let texel = |at: u32| {
        let (x, y) = (at % SIDE / 32, at / SIDE / 32);
        if (x + y).is_multiple_of(2) {
            [230, 220, 200, 255]
        } else {
            [90, 60, 40, 255]
        }
    };
    let texture = Texture::new(SIDE, SIDE, (0..SIDE * SIDE).map(texel).collect()).map(Arc::new);
    let mut scene = scene.clone();
    for object in &mut scene.objects {
        object.texture = texture.clone();
    }
    scene
}

/// More bytes than caches hold, so that memory's bandwidth is measured and not theirs.
const UNCACHED_BYTES: usize = 1 << 28;

/// The bytes a second that one thread writes to memory.
fn written_per_second() -> f64 {
    let mut memory = vec![0u8; UNCACHED_BYTES];
    let mut least = Duration::MAX;
    for turn in 0..5 {
        let started = Instant::now();
        std::hint::black_box(&mut memory).fill(turn);
        least = least.min(started.elapsed());
    }
    std::hint::black_box(&memory);
    UNCACHED_BYTES as f64 / least.as_secs_f64()
}

fn ratio(one: Duration, other: Duration) -> f64 {
    one.as_secs_f64() / other.as_secs_f64()
}
