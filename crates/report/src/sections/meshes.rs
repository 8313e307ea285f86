//! The speed and the errors of each caster for each mesh.

use super::Section;
use crate::budget::ReportBudget;
use crate::casters::Caster;
use crate::chart::number;
use crate::errors::Errors;
use crate::known_answers::{self, KnownAnswers};
use crate::progress::ReportProgress;
use crate::subject::{Subject, cast_tiles, stride, tiles};
use crate::table::{Cell, ReportError, Table, grouped};
use crate::timing::{Spread, interleaved};
use crate::views;
use raycast_core::camera::{Camera, Lattice, Rect};
use std::collections::HashSet;
use std::time::Instant;

/// The results for one mesh.
#[derive(Clone, Debug)]
pub struct MeshFigures {
    /// Its name in tables.
    pub name: String,
    /// Triangles of the files, dropped ones included.
    pub triangles: usize,
    /// The fraction of the picture's rays that hit a triangle.
    pub hit_share: f64,
    /// Distinct triangles hit per ray that hits one.
    pub density: f64,
    /// Milliseconds to read the files; `None` for a mesh made in memory.
    pub parse_ms: Option<f64>,
    /// Milliseconds to build RayCast's BVH.
    pub build_ms: f64,
    /// Bytes kept per triangle, for the BVH and the triangle itself.
    pub bytes_per_triangle: f64,
    /// The results of each caster.
    pub casters: Vec<CasterFigures>,
}

/// The results of one caster for one mesh.
#[derive(Clone, Debug)]
pub struct CasterFigures {
    /// The caster's name.
    pub name: String,
    /// Millions of rays per second.
    pub mrays: Spread,
    /// Wrong hits, compared with the oracle.
    pub errors: Errors,
}

/// Measures all casters with one mesh.
///
/// # Errors
/// An invalid camera.
pub fn measure(
    subject: &Subject,
    budget: &ReportBudget,
    progress: &dyn ReportProgress,
) -> Result<MeshFigures, ReportError> {
    let stage = &subject.stage;
    let camera = views::filling(&stage.scene, budget.size, views::FOV, 1.0)?;
    progress.begin(
        "speed",
        (subject.casters.len() * (budget.rounds + 1)) as u64,
    );
    let speeds = speeds(&subject.casters, &camera, budget, progress);
    progress.begin("errors", subject.casters.len() as u64 + 1);
    let pixels = known_answers::random_pixels(&camera, budget.checked);
    let checked = KnownAnswers::new(stage, Vec::new(), vec![(camera, pixels)]);
    progress.step();
    let errors = subject.casters.iter().map(|caster| {
        let errors = checked.errors(caster.as_ref(), 5 * budget.tests);
        progress.step();
        errors
    });
    let (hits, visible) = count_visible(subject, &camera);
    let pixels = budget.size.0 as usize * budget.size.1 as usize;
    let accel = &stage.accel;
    Ok(MeshFigures {
        name: subject.name.clone(),
        triangles: stage.scene.triangle_count(),
        hit_share: hits as f64 / pixels as f64,
        density: visible as f64 / hits.max(1) as f64,
        parse_ms: subject.parsing.map(|time| time.as_secs_f64() * 1e3),
        build_ms: subject.building.as_secs_f64() * 1e3,
        bytes_per_triangle: accel.retained_bytes() as f64 / accel.len().max(1) as f64,
        casters: subject
            .casters
            .iter()
            .zip(speeds)
            .zip(errors)
            .map(|((caster, mrays), errors)| CasterFigures {
                name: caster.name().to_owned(),
                mrays,
                errors,
            })
            .collect(),
    })
}

/// The greatest duration of a frame in seconds. A caster that would take longer is measured with fewer rays:
/// otherwise the slowest casters would take most of the report's time.
const LONG_FRAME: f64 = 0.15;

/// The stride with which a caster's frame takes about [`LONG_FRAME`] at most, estimated from every eighth ray of
/// every eighth row.
fn affordable_stride(caster: &dyn Caster, camera: &Camera, tests: usize) -> u32 {
    const SAMPLE: u32 = 8;
    if caster.tests_per_ray() > 0 {
        return stride(camera, caster.tests_per_ray(), tests);
    }
    let sample = tiles(camera, SAMPLE);
    let started = Instant::now();
    std::hint::black_box(cast_tiles(caster, &sample));
    let frame = started.elapsed().as_secs_f64() * f64::from(SAMPLE * SAMPLE);
    ((frame / LONG_FRAME).sqrt().floor() as u32).max(1)
}

/// Millions of rays per second of each caster, measured alternately. Casters that are too slow for every ray of the
/// picture trace an evenly spaced subset.
pub fn speeds(
    casters: &[Box<dyn Caster>],
    camera: &Camera,
    budget: &ReportBudget,
    progress: &dyn ReportProgress,
) -> Vec<Spread> {
    let lattices: Vec<Vec<Lattice>> = casters
        .iter()
        .map(|caster| {
            tiles(
                camera,
                affordable_stride(caster.as_ref(), camera, budget.tests),
            )
        })
        .collect();
    let mut works: Vec<Box<dyn FnMut() + Send>> = Vec::new();
    for (caster, lattices) in casters.iter().zip(&lattices) {
        works.push(Box::new(move || {
            std::hint::black_box(cast_tiles(caster.as_ref(), lattices));
        }));
    }
    let seconds = interleaved(budget.rounds, &mut works, &|| progress.step());
    let rate = |(seconds, tiles): (Spread, &Vec<Lattice>)| {
        let rays: usize = tiles.iter().map(Lattice::len).sum();
        seconds.rate(rays as f64 / 1e6)
    };
    seconds.into_iter().zip(&lattices).map(rate).collect()
}

/// How many rays of the picture hit a triangle, and how many distinct triangles they hit.
fn count_visible(subject: &Subject, camera: &Camera) -> (usize, usize) {
    let plane = camera.plane();
    let rect = Rect {
        x: 0,
        y: 0,
        width: plane.columns,
        height: plane.rows,
    };
    let Some(caster) = subject.casters.first() else {
        return (0, 0);
    };
    let mut hits = Vec::new();
    caster.cast_lattice(&camera.sub_camera(rect).lattice(), &mut hits);
    hits.retain(|hit| !hit.is_miss());
    let visible: HashSet<u32> = hits.iter().map(|hit| hit.primitive).collect();
    (hits.len(), visible.len())
}

/// The tables of all meshes and casters.
pub fn show(meshes: &[MeshFigures], budget: &ReportBudget) -> Section {
    let mut section = Section::default();
    section.paragraph("## Mesh by mesh");
    section.paragraph(format!(
        "Each mesh fills the frame ({}x{} rays) and is seen from the same side. *Shown triangles a \
         pixel* are the different triangles that rays meet, for each ray that meets one. Bytes are \
         the tree's and the triangles' own.",
        budget.size.0, budget.size.1
    ));
    let mut table = Table::new(&[
        "mesh",
        "triangles",
        "rays that hit, %",
        "shown triangles a pixel",
        "parse, ms",
        "build, ms",
        "bytes a triangle",
    ]);
    for mesh in meshes {
        table.row(vec![
            mesh.name.as_str().into(),
            (mesh.triangles as u64).into(),
            Cell::decimals(mesh.hit_share * 100.0, 1),
            Cell::short(mesh.density),
            mesh.parse_ms
                .map_or(Cell::Empty, |ms| Cell::decimals(ms, 1)),
            Cell::decimals(mesh.build_ms, 1),
            Cell::decimals(mesh.bytes_per_triangle, 0),
        ]);
    }
    section.table("meshes", table);
    section.paragraph(
        "Caster by caster: *leaks* are rays that went through a surface, *wrong* all wrong triangles (leaks \
         among them), each of so many rays that the oracle was asked about; where that is none, the \
         true rate is below 3 in that many rays, with 95 % confidence. `t` is how far the distance \
         is off, in units of single precision's last place (half of one is as near as single \
         precision gets); `u, v` how far the weights are off at most, in units of 2⁻²³. Both where \
         the ray meets the surface at a cosine above 0.1. *Ties* are other triangles at exactly the \
         same distance: not wrong, but not the lowest number. The deviation is the median distance \
         from the median.",
    );
    let mut table = Table::new(&[
        "mesh",
        "caster",
        "Mrays/s",
        "deviation",
        "leaks",
        "wrong",
        "of rays",
        "ties",
        "t p50, ulp",
        "t p99.9, ulp",
        "t max, ulp",
        "u, v max, 2⁻²³",
    ]);
    for mesh in meshes {
        for caster in &mesh.casters {
            let errors = &caster.errors;
            let ulps = |share| match errors.t_count() {
                0 => Cell::Empty,
                _ => Cell::short(errors.t_ulps(share)),
            };
            table.row(vec![
                mesh.name.as_str().into(),
                caster.name.as_str().into(),
                Cell::short(caster.mrays.median),
                Cell::short(caster.mrays.deviation),
                errors.leaks.into(),
                errors.wrong().into(),
                errors.rays.into(),
                errors.ties.into(),
                ulps(0.5),
                ulps(0.999),
                ulps(1.0),
                Cell::short(errors.weight * f64::from(1 << 23)),
            ]);
        }
    }
    section.table("casters", table);
    section
}

/// `0 of 1,000 rays, so fewer than 3,000 in a million`, or `12 of 1,000 rays`.
pub fn wrong_of_rays(wrong: u64, rays: u64) -> String {
    let counted = format!("{} of {} rays", grouped(wrong), grouped(rays));
    if wrong == 0 && rays > 0 {
        let bound = number(3e6 / rays as f64);
        format!("{counted}, so fewer than {bound} in a million")
    } else {
        counted
    }
}
