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

/// What a timed picture has or uses beside flat shading of one plain mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Variant {
    Plain,
    Smooth,
    UnusedNormals,
    Textured,
    UnusedTexture,
    Wireframe,
    AllChannels,
    EightObjects,
    Counted,
}

/// A picture that is rendered repeatedly.
struct TimedPicture {
    variant: Variant,
    view: View,
}

/// The pictures, with what their costs in memory follow from.
struct Pictures {
    pictures: Vec<TimedPicture>,
    vertices: usize,
    texels: usize,
}

/// Measures all features alternately.
///
/// # Errors
/// A scene that cannot be built.
pub fn measure(
    budget: &ReportBudget,
    progress: &dyn ReportProgress,
) -> Result<Vec<FeatureCost>, ReportError> {
    let pictures = Pictures::new(budget)?;
    // The differences are small, so they need more measurements.
    let rounds = 3 * budget.rounds;
    let steps = pictures.pictures.len() * (rounds + 1);
    progress.begin("optional things", steps as u64);
    let mut works: Vec<Box<dyn FnMut() + Send>> = Vec::new();
    for picture in &pictures.pictures {
        works.push(Box::new(|| picture.render()));
    }
    let times = interleaved(rounds, &mut works, &|| progress.step());
    drop(works);
    let mut costs = pictures.costs(&times, budget);
    costs.sort_by(|a, b| a.feature.cmp(b.feature));
    Ok(costs)
}

impl Pictures {
    fn new(budget: &ReportBudget) -> Result<Self, ReportError> {
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
        let mut wired = settings_for(Mode::Flat);
        wired.shading.wireframe = Some(Wireframe::default());
        // Flat shading shows textures. This texture is present, but has no effect with a blend factor of zero.
        let mut unblended = settings_for(Mode::Flat);
        unblended.shading.blend = 0.0;
        let layered = Settings {
            layers: true,
            ..settings_for(Mode::Flat)
        };
        let flat = || settings_for(Mode::Flat);
        let plain_scene = || scene_of(&plain, None);
        let normals_scene = || scene_of(&normals, None);
        let mapped_scene = || scene_of(&mapped, texture.as_ref());
        let pictures = [
            (Variant::Plain, plain_scene(), flat()),
            (Variant::Smooth, normals_scene(), settings_for(Mode::Smooth)),
            (Variant::UnusedNormals, normals_scene(), flat()),
            (
                Variant::Textured,
                mapped_scene(),
                settings_for(Mode::Texture),
            ),
            (Variant::UnusedTexture, mapped_scene(), unblended),
            (Variant::Wireframe, plain_scene(), wired),
            (Variant::AllChannels, plain_scene(), layered),
            (Variant::EightObjects, eight, flat()),
            (Variant::Counted, plain_scene(), flat()),
        ];
        let timed =
            |(variant, scene, settings)| TimedPicture::new(variant, scene, settings, budget);
        Ok(Self {
            pictures: pictures.into_iter().map(timed).collect::<Result<_, _>>()?,
            vertices: plain.positions().len(),
            texels: texture.as_ref().map_or(0, |texture| {
                texture.width() as usize * texture.height() as usize
            }),
        })
    }

    fn at(&self, variant: Variant) -> usize {
        let mut pictures = self.pictures.iter();
        let found = pictures.position(|picture| picture.variant == variant);
        found.expect("every variant has a picture")
    }

    /// What the pictures' `times`, in seconds, say of each feature.
    fn costs(&self, times: &[Spread], budget: &ReportBudget) -> Vec<FeatureCost> {
        let time = |variant| times[self.at(variant)].scaled(1e3);
        let cost = |feature, with: Variant, unused: Option<Variant>, bytes: usize| FeatureCost {
            feature,
            used: [time(with), time(Variant::Plain)],
            unused: unused.map(time),
            bytes: bytes as f64,
        };
        let tree_bytes = |variant| {
            let picture = &self.pictures[self.at(variant)];
            picture.view.accel.retained_bytes()
        };
        let pixels = budget.size.0 as usize * budget.size.1 as usize;
        let normals = self.vertices * size_of::<Vec3>();
        let texture = self.vertices * size_of::<Vec2>() + self.texels * 4;
        let channels = pixels * channel_bytes().iter().map(|c| c.1).sum::<usize>();
        let objects = tree_bytes(Variant::EightObjects) as f64 - tree_bytes(Variant::Plain) as f64;
        vec![
            cost(
                "smooth normals",
                Variant::Smooth,
                Some(Variant::UnusedNormals),
                normals,
            ),
            cost(
                "texture",
                Variant::Textured,
                Some(Variant::UnusedTexture),
                texture,
            ),
            cost("wireframe", Variant::Wireframe, None, 0),
            FeatureCost {
                bytes: objects,
                ..cost("several objects (8)", Variant::EightObjects, None, 0)
            },
            cost("statistics", Variant::Counted, None, 0),
            cost(
                "all channels of an EXR",
                Variant::AllChannels,
                None,
                channels,
            ),
        ]
    }
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
    fn new(
        variant: Variant,
        scene: Scene,
        settings: Settings,
        budget: &ReportBudget,
    ) -> Result<Self, ReportError> {
        let camera = views::filling(&scene, budget.size, views::FOV, 1.0)?;
        let accel = Arc::new(Accel::build(&scene)?.with_simd(budget.simd));
        let view = View {
            scene: Arc::new(scene),
            accel,
            camera,
            settings,
        };
        Ok(Self { variant, view })
    }

    fn render(&self) {
        // `--stats` and the window record statistics, with a clock.
        let counted = self.variant == Variant::Counted;
        let started = Instant::now();
        let rays = AtomicU64::new(0);
        let clock = || {
            if counted {
                started.elapsed()
            } else {
                Duration::ZERO
            }
        };
        let picture = self
            .view
            .render(Grid::default(), &clock, &Cancel::default(), &|stats| {
                if counted {
                    rays.fetch_add(stats.rays, Ordering::Relaxed);
                }
            });
        std::hint::black_box((picture, rays));
    }
}

/// Bytes per pixel of each optional channel of a picture.
fn channel_bytes() -> [(&'static str, usize); 6] {
    fn bytes_per_value<T>(_: fn(Layers) -> Vec<T>) -> usize {
        size_of::<T>()
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
        table.row(vec![channel.into(), Cell::short(bytes as f64)]);
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
