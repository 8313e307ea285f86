//! The cost of adversarial scenes, compared with as many ordinary triangles in the same place.

use super::Section;
use crate::cameras::PROJECTIONS;
use crate::cases::time::{SLOWDOWN_GOAL, ScenePair, SceneView, TimedCase};
use crate::progress::ReportProgress;
use crate::subject;
use crate::table::{Cell, ReportError, Table};
use raycast_core::camera::Projection;
use raycast_core::{Accel, Cull, Detail, Precision};
use std::time::{Duration, Instant};

/// Columns and rows of the pictures: small, because these scenes take seconds even so.
const SIZE: (u32, u32) = (64, 48);

/// The times for a picture of an adversarial scene and of an ordinary one, on one thread.
#[derive(Clone, Debug)]
pub struct HostileCost {
    /// The scene.
    pub name: String,
    /// Its projection.
    pub projection: Projection,
    /// The number of triangles without duplicates.
    pub triangles: usize,
    /// The time to build the BVH.
    pub build: Duration,
    /// The same for as many ordinary triangles; of several scenes, the longest.
    pub ordinary_build: Duration,
    /// The time to cast the picture's rays, exact, with t, u and v.
    pub cast: Duration,
    /// The same for as many ordinary triangles; of several scenes, the longest.
    pub ordinary_cast: Duration,
}

impl HostileCost {
    /// The ratio of the time for the picture to that for ordinary triangles.
    pub fn slowdown(&self) -> f64 {
        self.cast.as_secs_f64() / self.ordinary_cast.as_secs_f64()
    }
}

/// The least time of several rounds, adversarial and ordinary scenes alternately.
///
/// # Errors
/// A scene that cannot be built.
pub fn measure(
    cases: &[TimedCase],
    rounds: usize,
    progress: &dyn ReportProgress,
) -> Result<Vec<HostileCost>, ReportError> {
    progress.begin("time of hostile scenes", cases.len() as u64);
    let mut costs = Vec::new();
    for case in cases {
        costs.extend(measure_pair(case.name, &(case.scenes)(), SIZE, rounds)?);
        progress.step();
    }
    Ok(costs)
}

/// The least times of two scenes' pictures of a size, likewise, by both projections.
///
/// # Errors
/// A scene that cannot be built.
pub fn measure_pair(
    name: &str,
    scenes: &ScenePair,
    size: (u32, u32),
    rounds: usize,
) -> Result<Vec<HostileCost>, ReportError> {
    let build = |seen: &SceneView| {
        let started = Instant::now();
        Accel::build(&seen.scene).map(|accel| (accel, started.elapsed()))
    };
    let (hostile, build_time) = build(&scenes.hostile)?;
    let ordinary = (scenes.ordinary.iter())
        .map(build)
        .collect::<Result<Vec<_>, _>>()?;
    let builds = ordinary.iter().map(|(_, build)| *build);
    let ordinary_build = builds.max().unwrap_or_default();
    let mut costs = Vec::new();
    for projection in PROJECTIONS {
        let time = |accel: &Accel, seen: &SceneView| {
            let tiles = subject::tiles(&seen.camera(projection, size), 1);
            let mut hits = Vec::new();
            let started = Instant::now();
            for tile in &tiles {
                let (cull, precision) = (Cull::None, Precision::Exact);
                accel.cast_lattice(tile, cull, precision, Detail::Full, &mut hits);
            }
            started.elapsed()
        };
        let mut cast = Duration::MAX;
        let mut ordinary_casts = vec![Duration::MAX; ordinary.len()];
        for _ in 0..rounds.max(1) {
            cast = cast.min(time(&hostile, &scenes.hostile));
            let scenes = ordinary.iter().zip(&scenes.ordinary);
            for (least, ((accel, _), seen)) in ordinary_casts.iter_mut().zip(scenes) {
                *least = (*least).min(time(accel, seen));
            }
        }
        let ordinary_cast = ordinary_casts.into_iter().max().unwrap_or(cast);
        costs.push(HostileCost {
            name: name.to_owned(),
            projection,
            triangles: hostile.len(),
            build: build_time,
            ordinary_build,
            cast,
            ordinary_cast,
        });
    }
    Ok(costs)
}

/// Adds a table with a row for each scene and projection.
pub fn show(section: &mut Section, costs: &[HostileCost]) {
    section.paragraph("### Time of hostile scenes");
    section.paragraph(format!(
        "What costs other kernels time without bound, beside as many ordinary triangles in the same \
         place, by RayCast's tiles, exact, with t, u and v, on one thread. The goal is {SLOWDOWN_GOAL} times as long at most."
    ));
    let mut table = Table::new(&[
        "case",
        "projection",
        "triangles",
        "build ms",
        "ordinary build ms",
        "ms",
        "ordinary ms",
        "times",
    ]);
    for cost in costs {
        let ms = |time: Duration| Cell::short(time.as_secs_f64() * 1e3);
        table.row(vec![
            cost.name.replace('_', " ").into(),
            format!("{:?}", cost.projection).to_lowercase().into(),
            (cost.triangles as u64).into(),
            ms(cost.build),
            ms(cost.ordinary_build),
            ms(cost.cast),
            ms(cost.ordinary_cast),
            Cell::short(cost.slowdown()),
        ]);
    }
    section.table("hard-time", table);
}
