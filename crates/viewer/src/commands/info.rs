use super::Failure;
use crate::cli::{CameraArgs, InfoArgs};
use crate::output::print;
use crate::progress::Progress;
use crate::setup;
use crate::stats::{json, milliseconds};
use raycast_core::formats::{self, SceneFile};
use raycast_core::scene::{Bounds, Dropped, Object};
use serde::Serialize;
use std::fmt::Write;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::time::Instant;

/// What a file holds.
#[derive(Debug, Serialize)]
struct FileInfo {
    file: String,
    kind: &'static str,
    triangles: u64,
    dropped: DroppedInfo,
    /// `null` where there is nothing.
    bounds: Option<BoundsInfo>,
    load_ms: f64,
    build_ms: f64,
    tree_bytes: usize,
    tree_bytes_per_triangle: f64,
    objects: Vec<ObjectInfo>,
    warnings: Vec<String>,
}

/// What an object is.
#[derive(Debug, Serialize)]
struct ObjectInfo {
    name: String,
    triangles: usize,
    dropped: DroppedInfo,
    vertices: usize,
    /// In the mesh's own coordinates; `null` where there is nothing.
    bounds: Option<BoundsInfo>,
    normals: bool,
    uvs: bool,
    materials: Vec<String>,
    /// Width and height of its texture.
    texture: Option<[u32; 2]>,
    /// What the mesh was recentred by.
    offset: [f64; 3],
}

/// Dropped triangles, by reason.
#[derive(Debug, Serialize)]
struct DroppedInfo {
    total: u32,
    not_finite: u32,
    too_far: u32,
    bad_index: u32,
    zero_area: u32,
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
        let texture = object.texture.as_ref();
        Self {
            name: object.name.clone(),
            triangles: mesh.triangles().len(),
            dropped: (&mesh.dropped()).into(),
            vertices: mesh.positions().len(),
            bounds: BoundsInfo::new(&mesh.bounds()),
            normals: mesh.has_normals(),
            uvs: mesh.has_uvs(),
            materials: mesh.materials().iter().map(|m| m.name.clone()).collect(),
            texture: texture.map(|texture| [texture.width(), texture.height()]),
            offset: mesh.offset().to_array(),
        }
    }
}

/// Tells what files hold.
pub(super) fn run(args: &InfoArgs) -> Result<(), Failure> {
    let mut infos = Vec::with_capacity(args.files.len());
    for file in &args.files {
        infos.push(inspect(file)?);
    }
    if args.json {
        return print(&json(&infos)?);
    }
    let texts: Vec<_> = infos.iter().map(describe).collect();
    print(&texts.join("\n"))
}

/// Reads a file and builds its tree.
fn inspect(path: &Path) -> Result<FileInfo, Failure> {
    let progress = Progress::new();
    progress.loading();
    let loading = Instant::now();
    let SceneFile {
        scene,
        warnings,
        camera,
        image,
        ..
    } = formats::read_scene(path, &|share| progress.loaded(share))?;
    let load_time = loading.elapsed();
    progress.building();
    let building = Instant::now();
    let accel = setup::tree(&scene)?;
    let build_time = building.elapsed();
    let bounds = setup::bounds(&scene, &accel);
    if !accel.is_empty() {
        // What cannot be rendered as it is is not described as if it could.
        let args = CameraArgs::default();
        setup::camera(&args, camera.as_ref(), image.size, &bounds)
            .map_err(|error| setup::no_camera(&args, &path.display().to_string(), error))?;
    }
    let tree_bytes = accel.retained_bytes();
    Ok(FileInfo {
        file: path.display().to_string(),
        kind: kind(path, &first_bytes(path)),
        triangles: scene.triangle_count() as u64,
        dropped: (&setup::dropped(&scene, &accel)).into(),
        bounds: BoundsInfo::new(&bounds),
        load_ms: milliseconds(load_time),
        build_ms: milliseconds(build_time),
        tree_bytes,
        tree_bytes_per_triangle: tree_bytes as f64 / accel.len().max(1) as f64,
        objects: scene.objects.iter().map(ObjectInfo::from).collect(),
        warnings,
    })
}

/// What kind of file it is, of those that can be read: its own first words tell.
fn kind(path: &Path, first_bytes: &[u8]) -> &'static str {
    let text = String::from_utf8_lossy(first_bytes);
    let first = text
        .trim_start_matches('\u{feff}')
        .lines()
        .map(str::trim)
        .find(|line| !line.is_empty() && !line.starts_with('#'))
        .unwrap_or_default();
    let is_toml = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    if is_toml || first.starts_with('[') {
        "scene file"
    } else if first.starts_with('(') {
        "triangle text"
    } else {
        "OBJ"
    }
}

/// Enough of a file to tell its kind; nothing where it cannot be read.
fn first_bytes(path: &Path) -> Vec<u8> {
    let mut bytes = Vec::new();
    if let Ok(file) = File::open(path) {
        // What could not be read cannot be told.
        let _ = file.take(1 << 16).read_to_end(&mut bytes);
    }
    bytes
}

/// The same for people.
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
            "{:.1} bytes a triangle, built in {:.1} ms",
            info.tree_bytes_per_triangle, info.build_ms
        ),
    );
    for warning in &info.warnings {
        line("warning", warning.clone());
    }
    for object in &info.objects {
        let _ = writeln!(text, "  object {:?}", object.name);
        let mut line = |name: &str, value: String| {
            let _ = writeln!(text, "    {name:<10} {value}");
        };
        line(
            "triangles",
            triangles(object.triangles as u64, &object.dropped),
        );
        line("vertices", object.vertices.to_string());
        if info.objects.len() > 1 {
            bounds(&mut line, object.bounds.as_ref());
        }
        line("normals", yes_no(object.normals));
        line("uvs", yes_no(object.uvs));
        if !object.materials.is_empty() {
            line("materials", object.materials.join(", "));
        }
        if let Some([width, height]) = object.texture {
            line("texture", format!("{width}x{height}"));
        }
        if object.offset != [0.0; 3] {
            line("recentred", format!("by {}", vector(object.offset)));
        }
    }
    text
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
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            triangles: vec![[0, 1, 2], [0, 1, 7]],
            ..MeshData::default()
        });
        let scene = Scene {
            objects: vec![Object::new("part", Arc::new(mesh))],
        };
        FileInfo {
            file: "part.obj".to_owned(),
            kind: "OBJ",
            triangles: scene.triangle_count() as u64,
            dropped: (&scene.objects[0].mesh.dropped()).into(),
            bounds: BoundsInfo::new(&scene.bounds()),
            load_ms: 1.0,
            build_ms: 2.0,
            tree_bytes: 100,
            tree_bytes_per_triangle: 100.0,
            objects: scene.objects.iter().map(ObjectInfo::from).collect(),
            warnings: vec!["part.obj: no such material".to_owned()],
        }
    }

    #[test]
    fn people_are_told_what_was_dropped_and_why() {
        let text = describe(&info());
        assert!(
            text.contains("2, of which 1 dropped (1 with a vertex that is not there)"),
            "{text}"
        );
        assert!(text.contains("size       1 1 0"), "{text}");
    }

    #[test]
    fn programs_are_told_the_same() {
        let value = serde_json::to_value([info()]).expect("JSON");
        assert_eq!(value[0]["dropped"]["bad_index"], 1);
        assert_eq!(value[0]["objects"][0]["vertices"], 3);
        assert_eq!(value[0]["bounds"]["max"][0], 1.0);
    }

    #[test]
    fn kinds_are_told_by_their_first_words() {
        let kind = |name: &str, text: &str| kind(Path::new(name), text.as_bytes());
        assert_eq!(kind("demo.raycast.toml", "# a scene\n"), "scene file");
        assert_eq!(kind("a.obj", "# a cube\nv 0 0 0\n"), "OBJ");
        assert_eq!(
            kind("a.txt", "\n(0,0,0);(1,0,0);(0,1,0)\n"),
            "triangle text"
        );
    }
}
