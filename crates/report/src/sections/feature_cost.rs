//! Plot E: the cost of each optional feature, used and present but unused.

use super::Section;
use crate::budget::ReportBudget;
use crate::chart::{Axis, Better, Chart, Ink, Series};
use crate::progress::ReportProgress;
use crate::scenes::bumpy_sphere;
use crate::table::{Cell, ReportError, Table, short};
use crate::timing::{Spread, interleaved};
use crate::views;
use raycast_core::Accel;
use raycast_core::camera::Grid;
use raycast_core::glam::{DVec3, Vec2, Vec3};
use raycast_core::picture::Layers;
use raycast_core::render::{Cancel, Settings, View};
use raycast_core::scene::{Attribute, Mesh, MeshData, Object, Scene, Texture};
use raycast_core::shade::{Mode, Shading, Wireframe};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// The cost of an optional feature for one picture.
#[derive(Clone, Debug)]
pub struct FeatureCost {
    /// The feature's name.
    pub feature: &'static str,
    /// Milliseconds with it, and without it.
    pub used: [Spread; 2],
    /// Milliseconds if the scene has it and the picture does not use it; `None` if that is impossible.
    pub unused: Option<Spread>,
    /// Additional bytes kept if it is used.
    pub bytes: f64,
}

/// A picture that is rendered repeatedly.
struct TimedPicture {
    view: View,
    /// Whether it records statistics with a clock, as `--stats` and the window do.
    counted: bool,
}

/// Measures all features alternately.
///
/// # Errors
/// A scene that cannot be built.
pub fn measure(
    budget: &ReportBudget,
    progress: &dyn ReportProgress,
) -> Result<Vec<FeatureCost>, ReportError> {
    let count = 20_000.min(budget.largest);
    let plain = ball(count, false, false);
    let normals = ball(count, true, false);
    let mapped = ball(count, false, true);
    let texture = checkers();
    let eight = Scene {
        objects: (0..8)
            .map(|part| Object::new("part", Arc::new(every_eighth_triangle(&plain, part))))
            .collect(),
    };
    let wired = {
        let mut settings = settings_for(Mode::Flat);
        settings.shading.wireframe = Some(Wireframe::default());
        settings
    };
    let layered = Settings {
        layers: true,
        ..settings_for(Mode::Flat)
    };
    let picture = |scene: Scene, settings: Settings| TimedPicture::new(scene, settings, budget);
    let flat = || picture(scene_of(&plain, None), settings_for(Mode::Flat));
    // Flat shading shows textures. This texture is present, but has no effect with a blend factor of zero.
    let mut unblended = settings_for(Mode::Flat);
    unblended.shading.blend = 0.0;
    let flat_textured = picture(scene_of(&mapped, texture.as_ref()), unblended)?;
    let counted = TimedPicture {
        counted: true,
        ..flat()?
    };
    let pictures = [
        flat()?,
        picture(scene_of(&normals, None), settings_for(Mode::Smooth))?,
        picture(scene_of(&normals, None), settings_for(Mode::Flat))?,
        picture(
            scene_of(&mapped, texture.as_ref()),
            settings_for(Mode::Texture),
        )?,
        flat_textured,
        picture(scene_of(&plain, None), wired)?,
        picture(scene_of(&plain, None), layered)?,
        picture(eight, settings_for(Mode::Flat))?,
        counted,
    ];
    // The differences are small, so they need more measurements.
    let rounds = 3 * budget.rounds;
    progress.begin("optional things", (pictures.len() * (rounds + 1)) as u64);
    let mut works: Vec<Box<dyn FnMut() + Send>> = Vec::new();
    for picture in &pictures {
        works.push(Box::new(|| picture.render()));
    }
    let times = interleaved(rounds, &mut works, &|| progress.step());
    drop(works);
    let [
        flat,
        smooth,
        flat_normals,
        textured,
        flat_textured,
        wire,
        layers,
        objects,
        counted,
    ]: [Spread; 9] = std::array::from_fn(|at| times[at].scaled(1e3));
    let pixels = f64::from(budget.size.0) * f64::from(budget.size.1);
    let accel_bytes = |at: usize| pictures[at].view.accel.retained_bytes() as f64;
    let cost =
        |feature, with: Spread, without: Spread, unused: Option<Spread>, bytes: f64| FeatureCost {
            feature,
            used: [with, without],
            unused,
            bytes,
        };
    let texels = texture.as_ref().map_or(0.0, |texture| {
        f64::from(texture.width()) * f64::from(texture.height())
    });
    let vertices = plain.positions().len() as f64;
    let mut costs = vec![
        cost(
            "smooth normals",
            smooth,
            flat,
            Some(flat_normals),
            vertices * size_of::<Vec3>() as f64,
        ),
        cost(
            "texture",
            textured,
            flat,
            Some(flat_textured),
            vertices * size_of::<Vec2>() as f64 + texels * 4.0,
        ),
        cost("wireframe", wire, flat, None, 0.0),
        cost(
            "several objects (8)",
            objects,
            flat,
            None,
            accel_bytes(7) - accel_bytes(0),
        ),
        cost("statistics", counted, flat, None, 0.0),
        cost(
            "all channels of an EXR",
            layers,
            flat,
            None,
            pixels * channel_bytes().iter().map(|c| c.1).sum::<f64>(),
        ),
    ];
    costs.sort_by(|a, b| a.feature.cmp(b.feature));
    Ok(costs)
}

/// A scene with one object.
fn scene_of(mesh: &Arc<Mesh>, texture: Option<&Arc<Texture>>) -> Scene {
    let mut object = Object::new("ball", Arc::clone(mesh));
    object.texture = texture.map(Arc::clone);
    Scene {
        objects: vec![object],
    }
}

fn settings_for(mode: Mode) -> Settings {
    Settings {
        shading: Shading {
            mode,
            ..Shading::default()
        },
        samples: 1,
        ..Settings::default()
    }
}

impl TimedPicture {
    fn new(scene: Scene, settings: Settings, budget: &ReportBudget) -> Result<Self, ReportError> {
        let camera = views::filling(&scene, budget.size, views::FOV, 1.0)?;
        let accel = Arc::new(Accel::build(&scene)?.with_simd(budget.simd));
        let view = View {
            scene: Arc::new(scene),
            accel,
            camera,
            settings,
        };
        Ok(Self {
            view,
            counted: false,
        })
    }

    fn render(&self) {
        let started = Instant::now();
        let rays = AtomicU64::new(0);
        let clock = || {
            if self.counted {
                started.elapsed()
            } else {
                Duration::ZERO
            }
        };
        let picture = self
            .view
            .render(Grid::default(), &clock, &Cancel::default(), &|stats| {
                if self.counted {
                    rays.fetch_add(stats.rays, Ordering::Relaxed);
                }
            });
        std::hint::black_box((picture, rays));
    }
}

/// Bytes per pixel of each optional channel of a picture.
fn channel_bytes() -> [(&'static str, f64); 6] {
    fn bytes_per_value<T>(_: fn(Layers) -> Vec<T>) -> f64 {
        size_of::<T>() as f64
    }
    [
        (
            "R G B A, linear light",
            bytes_per_value(|layers| layers.color),
        ),
        ("Z", bytes_per_value(|layers| layers.depth)),
        ("id.object", bytes_per_value(|layers| layers.object)),
        ("id.triangle", bytes_per_value(|layers| layers.triangle)),
        ("N.X N.Y N.Z", bytes_per_value(|layers| layers.normal)),
        ("uv.U uv.V", bytes_per_value(|layers| layers.uv)),
    ]
}

/// A sphere, optionally with normals and texture coordinates.
fn ball(triangles: u32, normals: bool, uvs: bool) -> Arc<Mesh> {
    let ball = bumpy_sphere(triangles);
    let positions = positions(&ball);
    let attribute = |is_present: bool| is_present.then_some(());
    Arc::new(Mesh::new(MeshData {
        triangles: ball.triangles().to_vec(),
        normals: attribute(normals).map(|()| Attribute {
            values: positions.iter().map(|p| p.normalize().as_vec3()).collect(),
            indices: None,
        }),
        uvs: attribute(uvs).map(|()| Attribute {
            values: positions
                .iter()
                .map(|p| Vec2::new(p.x as f32, p.y as f32) * 0.5 + 0.5)
                .collect(),
            indices: None,
        }),
        positions,
        ..MeshData::default()
    }))
}

fn positions(mesh: &Mesh) -> Vec<DVec3> {
    let stored = mesh.positions().iter();
    stored
        .map(|position| mesh.offset() + position.as_dvec3())
        .collect()
}

/// Every eighth triangle of a mesh, from the triangle `part` on.
fn every_eighth_triangle(mesh: &Mesh, part: usize) -> Mesh {
    Mesh::new(MeshData {
        positions: positions(mesh),
        triangles: mesh
            .triangles()
            .iter()
            .copied()
            .skip(part)
            .step_by(8)
            .collect(),
        ..MeshData::default()
    })
}

fn checkers() -> Option<Arc<Texture>> {
    const SIDE: u32 = 512;
    let texel = |at: u32| {
        let (x, y) = (at % SIDE / 32, at / SIDE / 32);
        if (x + y) % 2 == 0 {
            [230, 220, 200, 255]
        } else {
            [90, 60, 40, 255]
        }
    };
    Texture::new(SIDE, SIDE, (0..SIDE * SIDE).map(texel).collect()).map(Arc::new)
}

/// Adds the chart, the tables, and the conclusions.
pub fn show(section: &mut Section, costs: &[FeatureCost]) {
    let more = |cost: &FeatureCost| (cost.used[0].median - cost.used[1].median).max(0.0);
    let mut series = Vec::new();
    for (cost, ink) in costs.iter().zip(Ink::ALL) {
        series.push(Series::dot(cost.feature, (more(cost), cost.bytes), ink));
    }
    let base = costs.first().map_or(0.0, |cost| cost.used[1].median);
    let dearest = costs.iter().max_by(|a, b| more(a).total_cmp(&more(b)));
    let chart = Chart {
        title: match dearest {
            Some(cost) => format!(
                "What costs the most time: {}, {} ms on top of {}",
                cost.feature,
                short(more(cost)),
                short(base)
            ),
            None => "Nothing was measured".to_owned(),
        },
        subtitle:
            "What each optional thing adds to a picture of a bumpy ball, flat shaded, where it \
                   is used."
                .to_owned(),
        x: Axis::linear("milliseconds more a picture", costs.iter().map(more)),
        y: Axis::log("bytes more", costs.iter().map(|cost| cost.bytes)).with_zero("none"),
        series,
        better: Better::LowerLeft,
    };
    section.chart("e-cost", chart);
    let mut table = Table::new(&[
        "what",
        "without, ms",
        "there but not used, ms",
        "used, ms",
        "more, ms",
        "deviation",
        "bytes more, used",
        "bytes more, not used",
    ]);
    for cost in costs {
        let [with, without] = cost.used;
        table.row(vec![
            cost.feature.into(),
            Cell::short(without.median),
            cost.unused
                .map_or(Cell::Empty, |time| Cell::short(time.median)),
            Cell::short(with.median),
            Cell::short(with.median - without.median),
            Cell::short(with.deviation.max(without.deviation)),
            Cell::short(cost.bytes),
            Cell::short(0.0),
        ]);
    }
    section.paragraph(describe_unused(costs));
    section.table("e-cost", table);
    section.paragraph("Channels beside the 8-bit colours, by the pixel (kept for `.exr` alone):");
    let mut table = Table::new(&["channel", "bytes a pixel"]);
    for (channel, bytes) in channel_bytes() {
        table.row(vec![channel.into(), Cell::short(bytes)]);
    }
    section.table("e-channels", table);
}

/// Describes the cost of features that are present but unused.
fn describe_unused(costs: &[FeatureCost]) -> String {
    let comparisons: Vec<String> = costs
        .iter()
        .filter_map(|cost| {
            let [_, without] = cost.used;
            let unused = cost.unused?;
            let noise = unused.deviation.max(without.deviation);
            let more = unused.median - without.median;
            Some(format!(
                "{}: {more:+.3} ms, {} the noise of {noise:.3} ms",
                cost.feature,
                if more.abs() <= 2.0 * noise {
                    "within"
                } else {
                    "beyond"
                }
            ))
        })
        .collect();
    format!(
        "There but not used ({}). A difference within twice the deviation is noise; the rest of the \
         things cannot be there without being used.",
        comparisons.join("; ")
    )
}
