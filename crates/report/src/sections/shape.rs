//! Plot C: how speed depends on what is cast at, and with what.

use super::Section;
use super::meshes::speeds;
use crate::chart::{Axis, Better, Chart, Form, Ink, Series};
use crate::effort::Effort;
use crate::embree::Embree;
use crate::scenes::bumpy_sphere;
use crate::stage::scene_of;
use crate::table::{Cell, ReportError, Table};
use crate::timing::Spread;
use crate::watch::Watch;
use crate::ways::{self, Way};
use crate::{subject, views};
use raycast_core::camera::{Camera, ImagePlane, fov_to_frame};
use raycast_core::math;
use raycast_core::scene::Scene;
use raycast_core::{Accel, Simd};
use std::sync::Arc;

/// A way's speed along an axis.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The way's name.
    pub way: String,
    /// Places along the axis, with million rays a second there.
    pub points: Vec<(f64, Spread)>,
}

/// What is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sweep {
    /// How many triangles a pixel shows: the ball is brought nearer.
    Density,
    /// How many triangles the ball has.
    Triangles,
    /// How many rays the picture has.
    Resolution,
    /// How many workers there are.
    Threads,
}

/// Triangles of the ball where they are not what is varied.
const TRIANGLES: u32 = 100_000;

impl Sweep {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Density,
        Self::Triangles,
        Self::Resolution,
        Self::Threads,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Density => "c-density",
            Self::Triangles => "c-triangles",
            Self::Resolution => "c-resolution",
            Self::Threads => "c-threads",
        }
    }

    fn axis(self) -> &'static str {
        match self {
            Self::Density => "triangles in the frame, hidden ones too, for each ray that hits",
            Self::Triangles => "triangles of the mesh",
            Self::Resolution => "rays of the picture",
            Self::Threads => "threads",
        }
    }

    fn title(self) -> &'static str {
        match self {
            Self::Density => "Triangles large and small in the picture",
            Self::Triangles => "Small and large meshes",
            Self::Resolution => "Small and large pictures",
            Self::Threads => "Few and many threads",
        }
    }
}

/// Measures all ways but the slowest along one axis.
///
/// # Errors
/// A camera that cannot be had.
pub fn measure(
    sweep: Sweep,
    effort: &Effort,
    library: Option<&Arc<Embree>>,
    watch: &dyn Watch,
) -> Result<Vec<Curve>, ReportError> {
    let most = TRIANGLES.min(effort.largest);
    let mut curves: Vec<Curve> = Vec::new();
    let (columns, rows) = effort.size;
    match sweep {
        Sweep::Density => {
            // From afar to nearby, and then through ever longer lenses.
            let views = [0.0625, 0.125, 0.25, 0.5, 1.0].map(|nearer| (nearer, views::FOV));
            let lenses = [2.0, 4.0, 8.0, 16.0].map(|longer| (1.0, views::FOV / longer));
            watch.begin("density", (views.len() + lenses.len()) as u64);
            let target = Target::new(most, effort.simd, library)?;
            for (nearer, fov) in views.into_iter().chain(lenses) {
                let camera = views::filling(&target.scene, effort.size, views::FOV, nearer)?;
                let frame = fov_to_frame(fov, camera.distance()) / f64::from(effort.size.1);
                let plane = ImagePlane::new(effort.size.0, effort.size.1, frame)?;
                let camera = camera.with_plane(plane);
                let speeds = target.speeds(&camera, effort);
                add(&mut curves, target.density(&camera), speeds);
                watch.step();
            }
        }
        Sweep::Triangles => {
            let counts = (6..=18).map(|half| math::pow(10.0, f64::from(half) / 2.0).round() as u32);
            let counts: Vec<u32> = counts
                .take_while(|&count| count <= effort.largest)
                .collect();
            watch.begin("triangles", counts.len() as u64);
            for count in counts {
                let target = Target::new(count, effort.simd, library)?;
                let speeds = target.measure(effort.size, effort)?;
                add(&mut curves, target.accel.len() as f64, speeds);
                watch.step();
            }
        }
        Sweep::Resolution => {
            let sizes: Vec<(u32, u32)> = [(1, 8), (1, 4), (1, 2), (1, 1), (2, 1)]
                .map(|(up, down)| ((columns * up / down).max(1), (rows * up / down).max(1)))
                .to_vec();
            watch.begin("resolution", sizes.len() as u64);
            let target = Target::new(most, effort.simd, library)?;
            for size in sizes {
                let speeds = target.measure(size, effort)?;
                add(&mut curves, f64::from(size.0 * size.1), speeds);
                watch.step();
            }
        }
        Sweep::Threads => {
            let cores = std::thread::available_parallelism().map_or(1, usize::from);
            let mut counts: Vec<usize> = (0..)
                .map(|power| 1 << power)
                .take_while(|n| *n < cores)
                .collect();
            counts.push(cores);
            watch.begin("threads", counts.len() as u64);
            let target = Target::new(most, effort.simd, library)?;
            for threads in counts {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()?;
                let speeds = pool.install(|| target.measure(effort.size, effort))?;
                add(&mut curves, threads as f64, speeds);
                watch.step();
            }
        }
    }
    for curve in &mut curves {
        curve.points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    Ok(curves)
}

fn add(curves: &mut Vec<Curve>, place: f64, speeds: Vec<(String, Spread)>) {
    for (way, speed) in speeds {
        match curves.iter_mut().find(|curve| curve.way == way) {
            Some(curve) => curve.points.push((place, speed)),
            None => curves.push(Curve {
                way,
                points: vec![(place, speed)],
            }),
        }
    }
}

/// A ball, and those ways that need not try every triangle.
struct Target {
    scene: Arc<Scene>,
    accel: Arc<Accel>,
    ways: Vec<Box<dyn Way>>,
}

impl Target {
    fn new(triangles: u32, simd: Simd, library: Option<&Arc<Embree>>) -> Result<Self, ReportError> {
        let scene = Arc::new(scene_of([bumpy_sphere(triangles)]));
        let accel = Arc::new(Accel::build(&scene)?.with_simd(simd));
        let mut all = ways::raycast(&accel);
        all.extend(ways::trees(&accel));
        if let Some(Ok(embree)) = library.map(|library| ways::embree(&accel, library)) {
            all.extend(embree);
        }
        Ok(Self {
            scene,
            accel,
            ways: all,
        })
    }

    /// Each way's speed at a picture of this size that the ball fills.
    fn measure(
        &self,
        size: (u32, u32),
        effort: &Effort,
    ) -> Result<Vec<(String, Spread)>, ReportError> {
        let camera = views::filling(&self.scene, size, views::FOV, 1.0)?;
        Ok(self.speeds(&camera, effort))
    }

    fn speeds(&self, camera: &Camera, effort: &Effort) -> Vec<(String, Spread)> {
        // There are many places: what matters is the curve.
        let effort = Effort {
            rounds: effort.rounds.div_ceil(2),
            ..*effort
        };
        let measured = speeds(&self.ways, camera, &effort, &());
        let names = self.ways.iter().map(|way| way.name().to_owned());
        names.zip(measured).collect()
    }

    /// Triangles in the frame, the hidden ones too, for each ray that hits one.
    fn density(&self, camera: &Camera) -> f64 {
        let plane = camera.plane();
        let (width, height) = (f64::from(plane.columns), f64::from(plane.rows));
        let in_frame = |primitive: &u32| {
            let [a, b, c] = self.accel.corners(*primitive);
            let middle = self.accel.origin() + ((a + b + c) / 3.0).as_dvec3();
            camera
                .project(middle)
                .is_some_and(|(x, y)| (0.0..width).contains(&x) && (0.0..height).contains(&y))
        };
        let triangles = (0..self.accel.len() as u32).filter(in_frame).count();
        let first = self.ways.first().map(AsRef::as_ref);
        let hits = first.map_or(0, |way| {
            subject::cast_tiles(way, &subject::tiles(camera, 1))
        });
        triangles as f64 / hits.max(1) as f64
    }
}

/// Adds the plot of one axis, its numbers, and what is to be read from it.
pub fn show(section: &mut Section, sweep: Sweep, curves: &[Curve]) {
    let series = curves
        .iter()
        .map(|curve| {
            let points = curve.points.iter();
            Series {
                label: curve.way.clone(),
                points: points.map(|(at, speed)| (*at, speed.median)).collect(),
                ink: Ink::of_way(&curve.way),
                form: if curve.way.contains("robust") || curve.way.contains("fast") {
                    Form::Dashes
                } else {
                    Form::Line
                },
            }
        })
        .collect();
    let points = || curves.iter().flat_map(|curve| curve.points.iter());
    let chart = Chart {
        title: format!("{}: {}", sweep.title(), conclusion(curves)),
        subtitle: format!(
            "Million rays a second, ray set-up and stores included. {}Broken lines: RayCast's fast \
             precision, Embree's robust mode.",
            match sweep {
                Sweep::Density => "From near (left) to far. ",
                _ => "",
            }
        ),
        x: Axis::log(sweep.axis(), points().map(|point| point.0)),
        y: Axis::log(
            "million rays a second",
            points().map(|point| point.1.median),
        ),
        series,
        better: Better::Higher,
    };
    section.chart(sweep.name(), chart);
    let mut table = Table::new(&["way", sweep.axis(), "Mrays/s", "deviation"]);
    for curve in curves {
        for (place, speed) in &curve.points {
            table.row(vec![
                curve.way.as_str().into(),
                Cell::short(*place),
                Cell::short(speed.median),
                Cell::short(speed.deviation),
            ]);
        }
    }
    section.numbers(sweep.name(), table);
}

/// How RayCast's exact tiles do against the best of the others, from place to place.
fn conclusion(curves: &[Curve]) -> String {
    let (mine, others): (Vec<&Curve>, Vec<&Curve>) = curves
        .iter()
        .partition(|curve| curve.way.starts_with("RayCast"));
    let Some(tiles) = mine
        .iter()
        .find(|curve| curve.way == "RayCast tiles, exact")
    else {
        return "RayCast is missing".to_owned();
    };
    let ratio = |at: usize| {
        let best = others
            .iter()
            .filter_map(|curve| Some(curve.points.get(at)?.1.median));
        tiles.points[at].1.median / best.fold(f64::MIN_POSITIVE, f64::max)
    };
    let ratios: Vec<f64> = (0..tiles.points.len()).map(ratio).collect();
    let low = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    let high = ratios.iter().copied().fold(0.0, f64::max);
    format!("RayCast's exact tiles reach {low:.1} to {high:.1} times the best other")
}
