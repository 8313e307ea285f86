//! Plot C: how speed depends on the scene, the picture and the number of threads.

use super::Section;
use super::meshes::speeds;
use crate::budget::ReportBudget;
use crate::casters::{self, Caster};
use crate::chart::{Axis, Better, Chart, Form, Ink, Series};
use crate::embree::Embree;
use crate::progress::ReportProgress;
use crate::scenes::bumpy_sphere;
use crate::stage::scene_of;
use crate::table::{Cell, ReportError, Table};
use crate::timing::Spread;
use crate::{subject, views};
use raycast_core::camera::{Camera, ImagePlane, fov_to_frame};
use raycast_core::math;
use raycast_core::scene::Scene;
use raycast_core::{Accel, Simd};
use std::sync::Arc;

/// The speed of a caster along an axis.
#[derive(Clone, Debug)]
pub struct SpeedCurve {
    /// The caster's name.
    pub caster: String,
    /// Positions on the axis, each with millions of rays per second.
    pub points: Vec<(f64, Spread)>,
}

/// The quantity that is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpeedSweep {
    /// Triangles in the frame per ray that hits one: the camera approaches the sphere.
    Density,
    /// The number of the sphere's triangles.
    Triangles,
    /// The number of the picture's rays.
    Resolution,
    /// The number of threads.
    Threads,
}

/// Triangles of the sphere where their number is not varied.
const TRIANGLES: u32 = 100_000;

impl SpeedSweep {
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

/// Measures the casters with a BVH built for speed along one axis.
///
/// # Errors
/// An invalid camera.
pub fn measure(
    sweep: SpeedSweep,
    budget: &ReportBudget,
    library: Option<&Arc<Embree>>,
    progress: &dyn ReportProgress,
) -> Result<Vec<SpeedCurve>, ReportError> {
    let most = TRIANGLES.min(budget.largest);
    let mut curves: Vec<SpeedCurve> = Vec::new();
    let (columns, rows) = budget.size;
    match sweep {
        SpeedSweep::Density => {
            // The camera approaches, then its field of view narrows.
            let views = [0.0625, 0.125, 0.25, 0.5, 1.0].map(|nearer| (nearer, views::FOV));
            let lenses = [2.0, 4.0, 8.0, 16.0].map(|longer| (1.0, views::FOV / longer));
            progress.begin("density", (views.len() + lenses.len()) as u64);
            let target = Target::new(most, budget.simd, library)?;
            for (nearer, fov) in views.into_iter().chain(lenses) {
                let camera = views::filling(&target.scene, budget.size, views::FOV, nearer)?;
                let frame = fov_to_frame(fov, camera.distance()) / f64::from(budget.size.1);
                let plane = ImagePlane::new(budget.size.0, budget.size.1, frame)?;
                let camera = camera.with_plane(plane);
                let speeds = target.speeds(&camera, budget);
                add(&mut curves, target.density(&camera), speeds);
                progress.step();
            }
        }
        SpeedSweep::Triangles => {
            let counts = (6..=18).map(|half| math::pow(10.0, f64::from(half) / 2.0).round() as u32);
            let counts: Vec<u32> = counts
                .take_while(|&count| count <= budget.largest)
                .collect();
            progress.begin("triangles", counts.len() as u64);
            for count in counts {
                let target = Target::new(count, budget.simd, library)?;
                let speeds = target.measure(budget.size, budget)?;
                add(&mut curves, target.accel.len() as f64, speeds);
                progress.step();
            }
        }
        SpeedSweep::Resolution => {
            let sizes: Vec<(u32, u32)> = [(1, 8), (1, 4), (1, 2), (1, 1), (2, 1)]
                .map(|(up, down)| ((columns * up / down).max(1), (rows * up / down).max(1)))
                .to_vec();
            progress.begin("resolution", sizes.len() as u64);
            let target = Target::new(most, budget.simd, library)?;
            for size in sizes {
                let speeds = target.measure(size, budget)?;
                add(&mut curves, f64::from(size.0 * size.1), speeds);
                progress.step();
            }
        }
        SpeedSweep::Threads => {
            let cores = std::thread::available_parallelism().map_or(1, usize::from);
            let mut counts: Vec<usize> = (0..)
                .map(|power| 1 << power)
                .take_while(|n| *n < cores)
                .collect();
            counts.push(cores);
            progress.begin("threads", counts.len() as u64);
            let target = Target::new(most, budget.simd, library)?;
            for threads in counts {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()?;
                let speeds = pool.install(|| target.measure(budget.size, budget))?;
                add(&mut curves, threads as f64, speeds);
                progress.step();
            }
        }
    }
    for curve in &mut curves {
        curve.points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    Ok(curves)
}

fn add(curves: &mut Vec<SpeedCurve>, place: f64, speeds: Vec<(String, Spread)>) {
    for (caster, speed) in speeds {
        match curves.iter_mut().find(|curve| curve.caster == caster) {
            Some(curve) => curve.points.push((place, speed)),
            None => curves.push(SpeedCurve {
                caster,
                points: vec![(place, speed)],
            }),
        }
    }
}

/// A sphere, and the casters with a BVH built for speed.
struct Target {
    scene: Arc<Scene>,
    accel: Arc<Accel>,
    casters: Vec<Box<dyn Caster>>,
}

impl Target {
    fn new(triangles: u32, simd: Simd, library: Option<&Arc<Embree>>) -> Result<Self, ReportError> {
        let scene = Arc::new(scene_of([bumpy_sphere(triangles)]));
        let accel = Arc::new(Accel::build(&scene)?.with_simd(simd));
        let mut all = casters::raycast(&accel);
        all.extend(casters::trees(&accel));
        if let Some(Ok(embree)) = library.map(|library| casters::embree(&accel, library)) {
            all.extend(embree);
        }
        Ok(Self {
            scene,
            accel,
            casters: all,
        })
    }

    /// The speed of each caster for a picture of this size that the sphere fills.
    fn measure(
        &self,
        size: (u32, u32),
        budget: &ReportBudget,
    ) -> Result<Vec<(String, Spread)>, ReportError> {
        let camera = views::filling(&self.scene, size, views::FOV, 1.0)?;
        Ok(self.speeds(&camera, budget))
    }

    fn speeds(&self, camera: &Camera, budget: &ReportBudget) -> Vec<(String, Spread)> {
        // Fewer rounds: there are many positions, and the shape of the curve matters more than each value.
        let budget = ReportBudget {
            rounds: budget.rounds.div_ceil(2),
            ..*budget
        };
        let measured = speeds(&self.casters, camera, &budget, &());
        let names = self.casters.iter().map(|caster| caster.name().to_owned());
        names.zip(measured).collect()
    }

    /// Triangles in the frame, occluded ones included, per ray that hits one.
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
        let first = self.casters.first().map(AsRef::as_ref);
        let hits = first.map_or(0, |caster| {
            subject::cast_tiles(caster, &subject::tiles(camera, 1))
        });
        triangles as f64 / hits.max(1) as f64
    }
}

/// Adds the chart of one axis, its numbers, and the conclusion.
pub fn show(section: &mut Section, sweep: SpeedSweep, curves: &[SpeedCurve]) {
    let series = curves
        .iter()
        .map(|curve| {
            let points = curve.points.iter();
            Series {
                label: curve.caster.clone(),
                points: points.map(|(at, speed)| (*at, speed.median)).collect(),
                ink: Ink::for_caster(&curve.caster),
                form: if curve.caster.contains("robust") || curve.caster.contains("fast") {
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
                SpeedSweep::Density => "From near (left) to far. ",
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
    let mut table = Table::new(&["caster", sweep.axis(), "Mrays/s", "deviation"]);
    for curve in curves {
        for (place, speed) in &curve.points {
            table.row(vec![
                curve.caster.as_str().into(),
                Cell::short(*place),
                Cell::short(speed.median),
                Cell::short(speed.deviation),
            ]);
        }
    }
    section.numbers(sweep.name(), table);
}

/// The ratio of the speed of RayCast's exact tiles to the best other caster's, over all positions.
fn conclusion(curves: &[SpeedCurve]) -> String {
    let (mine, others): (Vec<&SpeedCurve>, Vec<&SpeedCurve>) = curves
        .iter()
        .partition(|curve| curve.caster.starts_with("RayCast"));
    let Some(tiles) = mine
        .iter()
        .find(|curve| curve.caster == "RayCast tiles, exact")
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
