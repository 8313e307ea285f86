//! Plot B: under which conditions each caster breaks.

use super::Section;
use crate::budget::ReportBudget;
use crate::chart::{Axis, Better, Chart, Form, Ink, Series, number};
use crate::embree::Embree;
use crate::known_answers::{KnownAnswers, random_pixels};
use crate::meshes::{grid, mesh};
use crate::progress::ReportProgress;
use crate::stage::scene_of;
use crate::subject::{Input, Subject};
use crate::table::{Cell, ReportError, Table, grouped};
use raycast_core::camera::{Camera, ImagePlane, Pose, Projection};
use raycast_core::glam::DVec3;
use raycast_core::math;
use raycast_core::scene::{Mesh, Scene};
use raycast_oracle::random::Random;
use std::sync::Arc;

/// Wrong triangles of a caster in a million rays, along an axis.
#[derive(Clone, Debug)]
pub struct BreakingCurve {
    /// The caster's name.
    pub caster: String,
    /// Positions on the axis, each with the number of rays and of wrong triangles.
    pub points: Vec<(f64, u64, u64)>,
}

/// The quantity that is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BreakingSweep {
    /// The size of triangles in the picture, in pixels.
    Size,
    /// The distance of the scene from the origin.
    Distance,
    /// The angle between the surface and the rays.
    Angle,
}

impl BreakingSweep {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Size, Self::Distance, Self::Angle];

    fn places(self) -> Vec<f64> {
        match self {
            Self::Size => (-4..=4)
                .map(|half| math::pow(10.0, f64::from(half) / 2.0))
                .collect(),
            Self::Distance => (0..=8).map(|decade| 10f64.powi(decade)).collect(),
            Self::Angle => vec![90.0, 30.0, 10.0, 3.0, 1.0, 0.3, 0.1, 0.03, 0.01, 0.003],
        }
    }

    fn setting(self, place: f64, side: u32) -> Result<(Scene, Camera), ReportError> {
        match self {
            Self::Size => patch_of_size(place, side),
            Self::Distance => patch_at_distance(place, side),
            Self::Angle => patch_at_angle(place, side),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Size => "b-size",
            Self::Distance => "b-distance",
            Self::Angle => "b-angle",
        }
    }

    fn axis(self, places: &[f64]) -> Axis {
        let numbers = places.iter().copied();
        match self {
            Self::Size => Axis::log("edge of a triangle in the picture, pixels", numbers).falling(),
            Self::Distance => Axis::log(
                "distance from the origin (a triangle's edge is 1,024)",
                numbers,
            ),
            Self::Angle => Axis::log("angle between surface and ray, degrees", numbers).falling(),
        }
    }

    fn title(self) -> &'static str {
        match self {
            Self::Size => "Small triangles",
            Self::Distance => "Far from the origin",
            Self::Angle => "Flat rays",
        }
    }
}

/// Cells along each side of a patch.
const CELLS: u32 = 64;

/// A bumpy patch whose triangles are `pixels` long in a picture of 1000 rows with a field of view of 45°, and a
/// camera that sees the middle of the patch. Eye and patch have arbitrary coordinates, so that no arithmetic is
/// exact by chance.
fn patch_of_size(pixels: f64, side: u32) -> Result<(Scene, Camera), ReportError> {
    let eye = DVec3::new(2.3, 1.1, 3.7);
    let sight = DVec3::new(-0.61, -0.23, -0.76).normalize() * 5.0;
    let edge = pixels * 2.0 * sight.length() * math::tan(22.5f64.to_radians()) / 1000.0;
    let target = eye + sight;
    let across = sight.cross(DVec3::Y).normalize();
    let along = across.cross(sight).normalize();
    let mut random = Random::new(11);
    let half = f64::from(CELLS) * 0.5;
    let patch = grid(CELLS, CELLS, |x, y| {
        let within = across * (f64::from(x) - half) + along * (f64::from(y) - half);
        target + (within + random.in_cube() * 0.3) * edge
    });
    let frame = 0.6 * f64::from(CELLS) * edge;
    Ok((scene_of([patch]), camera(eye, target, side, frame)?))
}

/// A patch with integer coordinates, moved by `distance`. One triangle remains at the origin: otherwise the mesh
/// would be stored relative to an offset near it, and the distance would have no effect.
fn patch_at_distance(distance: f64, side: u32) -> Result<(Scene, Camera), ReportError> {
    // Multiples of 8, which single precision represents exactly up to 1.3e8.
    let whole = |x: f64| (x / 8.0).round() * 8.0;
    let offset = DVec3::new(0.62, 0.48, 0.62) * distance;
    let offset = DVec3::new(whole(offset.x), whole(offset.y), whole(offset.z));
    let mut random = Random::new(12);
    let hills = grid(CELLS, CELLS, |x, y| {
        let height = whole(random.between(-300.0, 300.0));
        offset + DVec3::new(f64::from(x), f64::from(y), 0.0) * 1024.0 + DVec3::Z * height
    });
    let middle = offset + DVec3::new(1.0, 1.0, 0.0) * (1024.0 * f64::from(CELLS) * 0.5);
    let eye = middle + DVec3::new(20_480.0, -30_720.0, 61_440.0);
    let frame = 1024.0 * 0.5 * f64::from(CELLS);
    let anchor = with_anchor(&hills);
    Ok((scene_of([anchor]), camera(eye, middle, side, frame)?))
}

/// The mesh with one more triangle near the origin, outside the view.
fn with_anchor(hills: &Mesh) -> Mesh {
    let mut positions: Vec<DVec3> = hills
        .positions()
        .iter()
        .map(|position| hills.offset() + position.as_dvec3())
        .collect();
    let mut triangles = hills.triangles().to_vec();
    let first = positions.len() as u32;
    let corner = DVec3::splat(-8.0);
    positions.extend([corner, corner - DVec3::X * 8.0, corner - DVec3::Y * 8.0]);
    triangles.push([first, first + 1, first + 2]);
    mesh(positions, triangles)
}

/// A flat patch at an arbitrary place, its vertices displaced within its plane, seen at an angle to the plane, in
/// degrees.
fn patch_at_angle(angle: f64, side: u32) -> Result<(Scene, Camera), ReportError> {
    let mut random = Random::new(13);
    let middle = DVec3::new(3.1, -1.7, 2.9);
    let normal = DVec3::new(0.3, 0.8, 0.52).normalize();
    let across = normal.cross(DVec3::new(0.7, 0.1, -0.4)).normalize();
    let along = across.cross(normal);
    let half = f64::from(CELLS) * 0.5;
    let patch = grid(CELLS, CELLS, |x, y| {
        let mut place = |at: u32| f64::from(at) - half + random.between(-0.3, 0.3);
        middle + across * place(x) + along * place(y)
    });
    let (sin, cos) = math::sin_cos(angle.to_radians());
    let eye = middle + (normal * sin - along * cos) * 80.0;
    // The frame's height is half of the patch's foreshortened height.
    let frame = 0.5 * f64::from(CELLS) * sin;
    Ok((scene_of([patch]), camera(eye, middle, side, frame)?))
}

/// A square picture whose frame has the height `frame` at the target.
fn camera(eye: DVec3, target: DVec3, side: u32, frame: f64) -> Result<Camera, ReportError> {
    let plane = ImagePlane::new(side, side, frame / f64::from(side))?;
    let pose = Pose {
        eye,
        target,
        up: DVec3::Y,
    };
    Ok(Camera::new(pose, Projection::Perspective, plane))
}

/// Checks the hits of every caster at each position of one axis.
///
/// # Errors
/// A scene that cannot be built.
pub fn measure(
    sweep: BreakingSweep,
    budget: &ReportBudget,
    library: Option<&Arc<Embree>>,
    progress: &dyn ReportProgress,
) -> Result<Vec<BreakingCurve>, ReportError> {
    let places = sweep.places();
    progress.begin("breaking", places.len() as u64);
    let side = (budget.breaking as f64).sqrt() as u32;
    let mut curves: Vec<BreakingCurve> = Vec::new();
    for place in places {
        let (scene, camera) = sweep.setting(place, side)?;
        let input = Input {
            name: sweep.name().to_owned(),
            scene: Arc::new(scene),
            parsing: None,
        };
        let subject = Subject::new(&input, budget.simd, library)?;
        let pixels = random_pixels(&camera, budget.breaking);
        let checked = KnownAnswers::new(&subject.stage, Vec::new(), vec![(camera, pixels)]);
        for caster in &subject.casters {
            let errors = checked.errors(caster.as_ref(), budget.tests);
            let point = (place, errors.rays, errors.wrong());
            match curves
                .iter_mut()
                .find(|curve| curve.caster == caster.name())
            {
                Some(curve) => curve.points.push(point),
                None => curves.push(BreakingCurve {
                    caster: caster.name().to_owned(),
                    points: vec![point],
                }),
            }
        }
        progress.step();
    }
    // From left to right in the chart.
    let axis = sweep.axis(&sweep.places());
    for curve in &mut curves {
        let place = |point: &(f64, u64, u64)| axis.position(point.0);
        curve.points.sort_by(|a, b| place(a).total_cmp(&place(b)));
    }
    Ok(curves)
}

/// Wrong triangles in a million rays.
fn rate(&(_, rays, wrong): &(f64, u64, u64)) -> f64 {
    wrong as f64 / rays.max(1) as f64 * 1e6
}

/// Adds the chart of one axis, its numbers, and the conclusion.
pub fn show(section: &mut Section, sweep: BreakingSweep, curves: &[BreakingCurve]) {
    let is_broken = |curve: &&BreakingCurve| curve.points.iter().any(|point| point.2 > 0);
    let (broken, whole): (Vec<_>, Vec<_>) = curves.iter().partition(is_broken);
    section.chart(sweep.name(), chart(sweep, curves, &broken, &whole));
    let rays = curves
        .iter()
        .flat_map(|curve| curve.points.iter().map(|point| point.1));
    let never: Vec<&str> = whole.iter().map(|curve| curve.caster.as_str()).collect();
    section.paragraph(format!(
        "Never wrong here, in {} rays a dot ({} for brute force): {}.",
        grouped(rays.clone().max().unwrap_or(0)),
        grouped(rays.min().unwrap_or(0)),
        if never.is_empty() {
            "no caster".to_owned()
        } else {
            never.join("; ")
        }
    ));
    let mut table = Table::new(&["caster", "place", "rays", "wrong", "wrong per million"]);
    for curve in curves {
        for point in &curve.points {
            table.row(vec![
                curve.caster.as_str().into(),
                Cell::short(point.0),
                point.1.into(),
                point.2.into(),
                Cell::short(rate(point)),
            ]);
        }
    }
    section.numbers(sweep.name(), table);
}

/// The chart of one axis: a line for each caster with errors, and one line for all others.
fn chart(
    sweep: BreakingSweep,
    curves: &[BreakingCurve],
    broken: &[&BreakingCurve],
    whole: &[&BreakingCurve],
) -> Chart {
    let places = sweep.places();
    let mut series: Vec<Series> = group_identical(broken)
        .iter()
        .map(|alike| line(alike))
        .collect();
    // All casters without errors share one line and one label.
    if let Some(first) = whole.first() {
        series.push(Series::line(
            if whole.len() == 1 {
                first.caster.clone()
            } else {
                format!("{} casters, never wrong", whole.len())
            },
            places.iter().map(|&place| (place, 0.0)).collect(),
            Ink::for_caster(&first.caster),
        ));
    }
    let worst = broken.iter().map(|curve| {
        let worst = curve.points.iter().map(rate).fold(0.0, f64::max);
        (worst, curve.caster.as_str())
    });
    let worst = worst.max_by(|a, b| a.0.total_cmp(&b.0));
    let rates = curves
        .iter()
        .flat_map(|curve| curve.points.iter().map(rate));
    Chart {
        title: match worst {
            Some((rate, caster)) => format!(
                "{}: {caster} is wrong for up to {} % of rays",
                sweep.title(),
                number(rate / 1e4)
            ),
            None => format!("{}: no caster was wrong", sweep.title()),
        },
        subtitle:
            "Wrong triangles against exact arithmetic, each caster with the very rays that it was \
                   given. Broken lines: double precision, or Embree's robust mode."
                .to_owned(),
        x: sweep.axis(&places),
        y: Axis::log(
            "wrong triangles in a million rays",
            // The axis covers at least three decades, whatever the rates.
            rates.chain([100.0, 100_000.0]),
        )
        .with_zero("none"),
        series,
        better: Better::Lower,
    }
}

/// One line for casters with identical curves.
fn line(alike: &[&BreakingCurve]) -> Series {
    let first = alike[0];
    Series {
        label: match alike.len() {
            1 => first.caster.clone(),
            count => format!("{} (+{} alike)", first.caster, count - 1),
        },
        points: first
            .points
            .iter()
            .map(|point| (point.0, rate(point)))
            .collect(),
        ink: Ink::for_caster(&first.caster),
        form: if first.caster.contains("f64") || first.caster.contains("robust") {
            Form::Dashes
        } else {
            Form::Line
        },
    }
}

/// Groups curves that are identical and whose casters have the same colour.
fn group_identical<'a>(curves: &[&'a BreakingCurve]) -> Vec<Vec<&'a BreakingCurve>> {
    let mut groups: Vec<Vec<&BreakingCurve>> = Vec::new();
    for &curve in curves {
        let same = |group: &&mut Vec<&BreakingCurve>| {
            group[0].points == curve.points
                && Ink::for_caster(&group[0].caster) == Ink::for_caster(&curve.caster)
        };
        match groups.iter_mut().find(same) {
            Some(group) => group.push(curve),
            None => groups.push(vec![curve]),
        }
    }
    groups
}
