mod health;

use self::health::{Findings, HealthInfo};
use super::Failure;
use crate::cli::{CameraArgs, InfoArgs};
use crate::output::print;
use crate::progress::TerminalProgress;
use crate::stats::{json, milliseconds};
use crate::{memory, setup};
use raycast_core::formats::{self, SceneFile};
use raycast_core::quote;
use raycast_core::scene::{Bounds, Dropped, Object, Scalar, ScalarAt, Texture};
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// The contents of a file.
#[derive(Debug, Serialize)]
struct FileInfo {
    file: String,
    kind: String,
    triangles: u64,
    dropped: DroppedInfo,
    /// `null` for an empty scene.
    bounds: Option<BoundsInfo>,
    load_ms: f64,
    build_ms: f64,
    tree_bytes: usize,
    tree_bytes_per_triangle: f64,
    /// Whether there is a tree for each mesh, instead of one over all triangles.
    instances: bool,
    objects: Vec<ObjectInfo>,
    warnings: Vec<String>,
    /// The file's format, metadata, and contents that are not used.
    notes: Vec<String>,
}

/// What an object is.
#[derive(Debug, Serialize)]
struct ObjectInfo {
    name: String,
    triangles: usize,
    dropped: DroppedInfo,
    vertices: usize,
    /// In the mesh's own coordinates; `null` for an empty mesh.
    bounds: Option<BoundsInfo>,
    normals: bool,
    uvs: bool,
    materials: Vec<String>,
    /// Width and height of each material's own texture; empty where none has one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    material_textures: Vec<Option<[u32; 2]>>,
    /// The groups of its triangles.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    groups: Vec<GroupInfo>,
    /// Width and height of its texture.
    texture: Option<[u32; 2]>,
    /// The offset of the recentred mesh.
    offset: [f64; 3],
    rounding: RoundingInfo,
    vertex_colors: bool,
    /// Scalars for `--color scalar:NAME`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    scalars: Vec<ScalarInfo>,
    /// Only if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    health: Option<HealthInfo>,
}

/// A group of triangles.
#[derive(Debug, Serialize)]
struct GroupInfo {
    name: String,
    /// Whether the scene file hides it.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    hidden: bool,
    triangles: usize,
}

/// A scalar of vertices or triangles.
#[derive(Debug, Serialize)]
struct ScalarInfo {
    name: String,
    /// `vertices` or `triangles`.
    at: &'static str,
    /// The least and the greatest finite value; `null` if there is none.
    range: Option<[f32; 2]>,
}

impl From<&Scalar> for ScalarInfo {
    fn from(scalar: &Scalar) -> Self {
        Self {
            name: scalar.name.clone(),
            at: match scalar.at {
                ScalarAt::Vertices => "vertices",
                ScalarAt::Triangles => "triangles",
            },
            range: scalar.range(),
        }
    }
}

impl ScalarInfo {
    fn description(&self) -> String {
        let Self { name, at, range } = self;
        let name = quote::name(name);
        match range {
            Some([low, high]) => format!("{name} of {at}, {low} to {high}"),
            None => format!("{name} of {at}, no numbers"),
        }
    }
}

/// How far rounding to single precision has moved triangles' corners.
#[derive(Debug, Serialize)]
struct RoundingInfo {
    /// In the file's units.
    distance: f64,
    /// Relative to a triangle's shortest edge.
    share_of_edge: f64,
    /// Triangles with a corner that moved by more than the limit for a warning.
    bent: u32,
}

/// Dropped triangles, by reason.
#[derive(Debug, Serialize)]
struct DroppedInfo {
    total: u32,
    not_finite: u32,
    too_far: u32,
    bad_index: u32,
    zero_area: u32,
    rounded_away: u32,
    #[serde(skip)]
    reasons: String,
}

/// A box.
#[derive(Debug, Serialize)]
struct BoundsInfo {
    min: [f64; 3],
    max: [f64; 3],
    size: [f64; 3],
}

impl From<&Dropped> for DroppedInfo {
    fn from(dropped: &Dropped) -> Self {
        Self {
            total: dropped.total(),
            not_finite: dropped.not_finite,
            too_far: dropped.too_far,
            bad_index: dropped.bad_index,
            zero_area: dropped.zero_area,
            rounded_away: dropped.rounded_away,
            reasons: setup::reasons(dropped),
        }
    }
}

impl BoundsInfo {
    fn new(bounds: &Bounds) -> Option<Self> {
        (!bounds.is_empty()).then(|| Self {
            min: bounds.min.to_array(),
            max: bounds.max.to_array(),
            size: bounds.size().to_array(),
        })
    }
}

impl From<&Object> for ObjectInfo {
    fn from(object: &Object) -> Self {
        let mesh = &object.mesh;
        let size = |texture: &Arc<Texture>| [texture.width(), texture.height()];
        let of_materials = mesh.materials().iter();
        let mut material_textures: Vec<_> = of_materials
            .map(|material| material.texture.as_ref().map(size))
            .collect();
        if material_textures.iter().all(Option::is_none) {
            material_textures.clear();
        }
        let rounding = mesh.rounding();
        Self {
            name: object.name.clone(),
            triangles: mesh.triangles().len(),
            dropped: (&mesh.dropped()).into(),
            vertices: mesh.positions().len(),
            bounds: BoundsInfo::new(&mesh.bounds()),
            normals: mesh.has_normals(),
            uvs: mesh.has_uvs(),
            materials: mesh.materials().iter().map(|m| m.name.clone()).collect(),
            material_textures,
            groups: groups(object),
            texture: object.texture.as_ref().map(size),
            offset: mesh.offset().to_array(),
            rounding: RoundingInfo {
                distance: rounding.distance,
                share_of_edge: rounding.share_of_edge,
                bent: rounding.bent,
            },
            vertex_colors: !mesh.vertex_colors().is_empty(),
            scalars: mesh.scalars().iter().map(ScalarInfo::from).collect(),
            health: None,
        }
    }
}

fn groups(object: &Object) -> Vec<GroupInfo> {
    let mesh = &object.mesh;
    let hidden = object.hidden_groups.as_ref();
    let is_hidden = |name: &String| hidden.is_some_and(|it| it.names().contains(name));
    let sizes = mesh.groups().sizes(mesh.triangles().len());
    let names = mesh.groups().names().iter().cloned();
    let of = |(name, triangles)| GroupInfo {
        hidden: is_hidden(&name),
        name,
        triangles,
    };
    names.zip(sizes).map(of).collect()
}

/// Describes files.
pub(super) fn run(args: &InfoArgs) -> Result<(), Failure> {
    let mut infos = Vec::with_capacity(args.files.len());
    for file in &args.files {
        infos.push(inspect(file, args)?);
    }
    if args.json {
        return print(&json(&infos)?);
    }
    let texts: Vec<_> = infos.iter().map(describe).collect();
    print(&texts.join("\n"))
}

/// Reads a file and builds its tree.
fn inspect(path: &Path, args: &InfoArgs) -> Result<FileInfo, Failure> {
    let progress = TerminalProgress::new();
    progress.loading();
    let loading = Instant::now();
    let budget = memory::budget(args.reading.limits());
    let SceneFile {
        kind,
        scene,
        warnings,
        notes,
        camera,
        image,
        ..
    } = formats::read_scene_within(path, &budget, &|share| progress.loaded(share))?;
    let load_time = loading.elapsed();
    progress.building();
    let building = Instant::now();
    let name = path.display().to_string();
    memory::check_tree(&name, setup::stored_triangles(&scene))?;
    let accel = setup::tree(&scene)?;
    let build_time = building.elapsed();
    let bounds = setup::bounds(&scene, &accel);
    if !accel.is_empty() {
        // A file that cannot be rendered as it is must not be described as if it could.
        let given = CameraArgs::default();
        setup::camera(&given, camera.as_ref(), image, &bounds)
            .map_err(|error| setup::camera_failure(&given, &path.display().to_string(), error))?;
    }
    let tree_bytes = accel.retained_bytes();
    let mut objects: Vec<_> = scene.objects.iter().map(ObjectInfo::from).collect();
    if args.health {
        let mut findings = Findings::new(args.self_intersections);
        let transforms = scene.world_from_objects();
        let transforms = transforms.map_err(|error| Failure::could_not(error.to_string()))?;
        for ((info, object), place) in objects.iter_mut().zip(&scene.objects).zip(&transforms) {
            info.health = findings.examine(&object.mesh, place);
        }
    }
    Ok(FileInfo {
        file: path.display().to_string(),
        kind: kind.to_string(),
        triangles: scene.triangle_count() as u64,
        dropped: (&setup::dropped(&scene, &accel)).into(),
        bounds: BoundsInfo::new(&bounds),
        load_ms: milliseconds(load_time),
        build_ms: milliseconds(build_time),
        tree_bytes,
        tree_bytes_per_triangle: tree_bytes as f64 / accel.len().max(1) as f64,
        instances: accel.has_instances(),
        objects,
        warnings,
        notes,
    })
}

/// The description for people.
fn describe(info: &FileInfo) -> String {
    let mut text = format!("{}: {}\n", info.file, info.kind);
    let mut line = |name: &str, value: String| {
        // Writing to a string does not fail.
        let _ = writeln!(text, "  {name:<10} {value}");
    };
    line("triangles", triangles(info.triangles, &info.dropped));
    bounds(&mut line, info.bounds.as_ref());
    line("loaded in", format!("{:.1} ms", info.load_ms));
    line(
        "tree",
        format!(
            "{:.1} bytes a triangle{}, built in {:.1} ms",
            info.tree_bytes_per_triangle,
            if info.instances {
                ", one for each mesh"
            } else {
                ""
            },
            info.build_ms
        ),
    );
    for note in &info.notes {
        line("note", note.clone());
    }
    for warning in &info.warnings {
        line("warning", warning.clone());
    }
    for object in &info.objects {
        describe_object(&mut text, object, info.objects.len() > 1);
    }
    text
}

/// Adds the description of an object, with its bounds where they are not the file's.
fn describe_object(text: &mut String, object: &ObjectInfo, is_one_of_several: bool) {
    let _ = writeln!(text, "  object {:?}", object.name);
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "    {name:<10} {value}");
    };
    line(
        "triangles",
        triangles(object.triangles as u64, &object.dropped),
    );
    line("vertices", object.vertices.to_string());
    if is_one_of_several {
        bounds(&mut line, object.bounds.as_ref());
    }
    line("normals", yes_no(object.normals));
    line("uvs", yes_no(object.uvs));
    if object.vertex_colors {
        line("colors", "at vertices".to_owned());
    }
    for scalar in &object.scalars {
        line("scalar", scalar.description());
    }
    if !object.materials.is_empty() {
        let mut textures = object.material_textures.iter();
        let name = |name: &String| match textures.next() {
            Some(&Some([width, height])) => {
                format!("{} (texture {width}x{height})", quote::name(name))
            }
            _ => quote::name(name),
        };
        let names: Vec<String> = object.materials.iter().map(name).collect();
        line("materials", first_few(&names));
    }
    if !object.groups.is_empty() {
        let names = object.groups.iter();
        let names = names.map(|group| {
            let hidden = if group.hidden { ", hidden" } else { "" };
            format!("{} ({}{hidden})", quote::name(&group.name), group.triangles)
        });
        line("groups", first_few(&names.collect::<Vec<_>>()));
    }
    if let Some([width, height]) = object.texture {
        line("texture", format!("{width}x{height}"));
    }
    if let Some(health) = &object.health {
        let closed = if health.closed {
            "closed"
        } else {
            "not closed"
        };
        let (shells, euler) = (health.shells, health.euler_characteristic);
        let plural = if shells == 1 { "" } else { "s" };
        line(
            "joined",
            format!("{closed}, {shells} shell{plural}, Euler characteristic {euler}"),
        );
        line("faults", health.faults());
        line("area", health.area.to_string());
        if let Some(volume) = health.volume {
            line("volume", volume.to_string());
        }
    }
    if object.offset != [0.0; 3] {
        line("recentred", format!("by {}", vector(object.offset)));
    }
    let RoundingInfo {
        distance,
        share_of_edge,
        ..
    } = object.rounding;
    if distance > 0.0 {
        let share = 100.0 * share_of_edge;
        line(
            "rounded",
            format!("by at most {distance:.2e}, and {share:.2e} % of an edge"),
        );
    }
}

fn triangles(count: u64, dropped: &DroppedInfo) -> String {
    match dropped.total {
        0 => count.to_string(),
        total => format!("{count}, of which {total} dropped ({})", dropped.reasons),
    }
}

fn bounds(line: &mut impl FnMut(&str, String), bounds: Option<&BoundsInfo>) {
    match bounds {
        Some(bounds) => {
            line("from", vector(bounds.min));
            line("to", vector(bounds.max));
            line("size", vector(bounds.size));
        }
        None => line("bounds", "none: there is nothing to see".to_owned()),
    }
}

fn vector([x, y, z]: [f64; 3]) -> String {
    format!("{x} {y} {z}")
}

/// The first of many names, and the number of the others: a file of coloured faces has a name for each colour.
fn first_few(names: &[String]) -> String {
    const MAX_LISTED: usize = 12;
    let first = names[..names.len().min(MAX_LISTED)].join(", ");
    match names.len().saturating_sub(MAX_LISTED) {
        0 => first,
        more => format!("{first} and {more} more"),
    }
}

fn yes_no(is: bool) -> String {
    if is { "yes" } else { "no" }.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_core::glam::DVec3;
    use raycast_core::scene::{Mesh, MeshData, Scene};
    use std::sync::Arc;

    fn info() -> FileInfo {
        let mesh = Mesh::new(MeshData {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::new(0.0, 1.0, 0.1)],
            triangles: vec![[0, 1, 2], [0, 1, 7]],
            ..MeshData::default()
        });
        let scene = Scene {
            objects: vec![Object::new("part", Arc::new(mesh))],
        };
        FileInfo {
            file: "part.obj".to_owned(),
            kind: "OBJ".to_owned(),
            triangles: scene.triangle_count() as u64,
            dropped: (&scene.objects[0].mesh.dropped()).into(),
            bounds: BoundsInfo::new(&scene.bounds()),
            load_ms: 1.0,
            build_ms: 2.0,
            tree_bytes: 100,
            tree_bytes_per_triangle: 100.0,
            instances: false,
            objects: scene.objects.iter().map(ObjectInfo::from).collect(),
            warnings: vec!["part.obj: no such material".to_owned()],
            notes: vec!["binary".to_owned()],
        }
    }

    #[test]
    fn names_of_files_are_escaped_and_cut() {
        let long = format!("a\u{1b}[2J\n{}", "x".repeat(1000));
        let mut info = info();
        let object = &mut info.objects[0];
        object.materials = vec![long.clone()];
        object.scalars = vec![ScalarInfo {
            name: long,
            at: "vertices",
            range: None,
        }];
        let text = describe(&info);
        let shown = text
            .lines()
            .filter(|line| line.contains("a\\u{1b}[2J\\nxxx"));
        assert_eq!(shown.count(), 2, "{text}");
        assert!(text.lines().all(|line| line.chars().count() < 300));
    }

    #[test]
    fn text_lists_what_was_dropped_and_why() {
        let text = describe(&info());
        assert!(
            text.contains("2, of which 1 dropped (1 with a vertex that is not there)"),
            "{text}"
        );
        assert!(text.contains("size       1 1 0.1"), "{text}");
        assert!(text.contains("note       binary"), "{text}");
        // 0.1 is 1.49e-9 from the nearest single-precision number, and no edge is shorter than 1.
        let rounded = "rounded    by at most 1.49e-9, and 1.49e-7 % of an edge";
        assert!(text.contains(rounded), "{text}");
    }

    #[test]
    fn json_lists_what_was_dropped_and_why() {
        let value = serde_json::to_value([info()]).expect("JSON");
        assert_eq!(value[0]["dropped"]["bad_index"], 1);
        assert_eq!(value[0]["objects"][0]["vertices"], 3);
        assert_eq!(value[0]["bounds"]["max"][0], 1.0);
        let rounding = &value[0]["objects"][0]["rounding"];
        assert_eq!(rounding["distance"], rounding["share_of_edge"]);
        assert_eq!(rounding["bent"], 0);
    }
}
