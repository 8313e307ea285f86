//! glTF and 3MF files from outside, against what other programs find in them
//! (`tests/outside/placed.csv`, made by the script beside it), and the broken ones, refused for their reason.

#![allow(
    clippy::print_stdout,
    reason = "tests tell what they checked and what they skipped"
)]

use raycast_core::formats::{SceneFile, read_scene};
use raycast_core::glam::DVec3;
use raycast_tests::models;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Files that are broken, and a part of what they are refused with.
const BROKEN: [(&str, &str); 9] = [
    (
        "3MF/malformed_property_index_oob.3mf",
        "\"3D/3dmodel.model\", line 7: expected object 1 to name one of group 2's 1 colours, found number 1000000",
    ),
    (
        "glTF2/IndexOutOfRange/AllIndicesOutOfRange.gltf",
        "meshes[0].primitives[0].indices: expected indices of its 24 vertices, found 65535 as number 0",
    ),
    (
        "glTF2/IndexOutOfRange/IndexOutOfRange.gltf",
        "meshes[0].primitives[0].indices: expected indices of its 24 vertices, found 255 as number 0",
    ),
    (
        "glTF2/MissingBin/BoxTextured.gltf",
        "BoxTextured.gltf: buffers[0]: ",
    ),
    (
        "glTF2/RecursiveNodes/RecursiveNodes.gltf",
        "nodes[0]: expected a node of a tree, found one that is reached twice",
    ),
    (
        "glTF2/SchemaFailures/sceneWrongType.gltf",
        "sceneWrongType.gltf:6: invalid type: string \"hello\", expected u32",
    ),
    (
        "glTF2/TestNoRootNode/NoScene.gltf",
        "expected triangles, found no node with a mesh",
    ),
    (
        "glTF2/TestNoRootNode/SceneWithoutNodes.gltf",
        "expected triangles, found no node with a mesh",
    ),
    // It is cut short before anything could be said of its Draco compression.
    (
        "glTF2/draco/2CylinderEngine.gltf",
        "2CylinderEngine.gltf:4409: EOF while parsing a value",
    ),
];

/// Files that the other program does not read: objects and triangles, counted by hand. Cubes, one without its
/// last corner, in triangles and in lines, with indices and without.
const CHECKED_BY_HAND: [(&str, usize, usize); 1] =
    [("glTF2/IncorrectVertexArrays/Cube.gltf", 8, 46)];

/// Files of which not all is shown, and a part of the warning that says so.
const PARTLY_SHOWN: [(&str, &str); 8] = [
    (
        "glTF2/AnimatedMorphCube/glTF/AnimatedMorphCube.gltf",
        "at rest: 1",
    ),
    (
        "glTF2/AnimatedMorphSphere/glTF/AnimatedMorphSphere.gltf",
        "at rest: 1",
    ),
    (
        "glTF2/ClearCoat-glTF/ClearCoatTest.gltf",
        "blended materials, of which each layer covers by its alpha, with nothing refracted: 1",
    ),
    (
        "glTF2/IncorrectVertexArrays/Cube.gltf",
        "points or lines, which are not shown: 4",
    ),
    (
        "glTF2/IncorrectVertexArrays/Cube.gltf",
        "corners behind the last whole triangle, which are passed over: 4",
    ),
    (
        "glTF2/MorphPrimitivesTest/glTF/MorphPrimitivesTest.gltf",
        "at rest: 1",
    ),
    (
        "glTF2/MorphStressTest/glTF/MorphStressTest.gltf",
        "at rest: 1",
    ),
    ("glTF2/SimpleMorph/glTF/SimpleMorph.gltf", "at rest: 1"),
];

/// What another program finds in a file.
struct Figures {
    file: String,
    objects: usize,
    triangles: usize,
    low: DVec3,
    high: DVec3,
}

fn figures() -> Vec<Figures> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("outside/placed.csv");
    let mut table = csv::Reader::from_path(path).expect("the table");
    let row = |row: Result<csv::StringRecord, csv::Error>| {
        let row = row.expect("a row");
        let count = |column: usize| row[column].parse().expect("a whole number");
        let corner = |column: usize| {
            DVec3::from_array([0, 1, 2].map(|axis| row[column + axis].parse().expect("a number")))
        };
        Figures {
            file: row[0].to_owned(),
            objects: count(1),
            triangles: count(2),
            low: corner(3),
            high: corner(6),
        }
    };
    table.records().map(row).collect()
}

fn read(path: &Path) -> SceneFile {
    read_scene(path, &|_| ()).unwrap_or_else(|error| panic!("{error}"))
}

/// The glTF and 3MF files below a folder.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("a folder can be listed").path();
        let kinds = ["gltf", "glb", "3mf"];
        if path.is_dir() {
            files(&path, found);
        } else if path
            .extension()
            .is_some_and(|kind| kinds.iter().any(|k| kind == *k))
        {
            found.push(path);
        }
    }
}

/// The folder of files from outside; `None`, said aloud, where there is none.
fn folder() -> Option<PathBuf> {
    Some(models::folder()?.join("formats")).filter(|folder| {
        let is_there = folder.is_dir();
        if !is_there {
            println!("skipped: RAYCAST_MODELS has no folder `formats`");
        }
        is_there
    })
}

#[test]
fn good_files_hold_what_other_programs_find_in_them() {
    let Some(folder) = folder() else { return };
    let broken: BTreeSet<&str> = BROKEN.iter().map(|(file, _)| *file).collect();
    let mut checked = 0;
    for figures in figures() {
        if broken.contains(&*figures.file) {
            continue;
        }
        let file = read(&folder.join(&figures.file)).scene;
        let name = &figures.file;
        assert_eq!(file.objects.len(), figures.objects, "{name}");
        assert_eq!(file.triangle_count(), figures.triangles, "{name}");
        let bounds = file.bounds();
        if figures.low.is_finite() && figures.high.is_finite() {
            // Single precision, of the file and of ours, in numbers as large as the box.
            let most = 4.0
                * f64::from(f32::EPSILON)
                * figures.low.abs().max(figures.high.abs()).max_element();
            let off = (bounds.min - figures.low)
                .abs()
                .max((bounds.max - figures.high).abs());
            assert!(
                off.max_element() <= most,
                "{name}: {bounds:?} is off by {off}"
            );
        } else {
            assert!(bounds.is_empty(), "{name}: {bounds:?}");
        }
        checked += 1;
    }
    for (name, objects, triangles) in CHECKED_BY_HAND {
        let file = read(&folder.join(name)).scene;
        assert_eq!(
            (file.objects.len(), file.triangle_count()),
            (objects, triangles),
            "{name}"
        );
        checked += 1;
    }
    println!("{checked} files");
}

#[test]
fn broken_files_are_refused_with_their_reason() {
    let Some(folder) = folder() else { return };
    for (name, reason) in BROKEN {
        let error = read_scene(&folder.join(name), &|_| ())
            .expect_err(name)
            .to_string();
        assert!(error.contains(reason), "{error}");
        assert_eq!(error.lines().count(), 1, "{error}");
    }
}

#[test]
fn contents_that_are_not_shown_are_noted() {
    let Some(folder) = folder() else { return };
    for (name, message) in PARTLY_SHOWN {
        let warnings = read(&folder.join(name)).warnings;
        assert!(
            warnings.iter().any(|line| line.contains(message)),
            "{name}: {warnings:?}"
        );
    }
    // The rest is shown whole.
    let partly: BTreeSet<&str> = PARTLY_SHOWN.iter().map(|(file, _)| *file).collect();
    for Figures { file, .. } in figures() {
        let is_whole = !partly.contains(&*file) && BROKEN.iter().all(|(broken, _)| *broken != file);
        if is_whole {
            let warnings = read(&folder.join(&file)).warnings;
            assert!(warnings.is_empty(), "{file}: {warnings:?}");
        }
    }
}

/// A file that is in none of the lists would be one that nobody looked at.
#[test]
fn every_file_is_accounted_for() {
    let Some(folder) = folder() else { return };
    let figures = figures();
    let known: BTreeSet<PathBuf> = figures
        .iter()
        .map(|figures| &*figures.file)
        .chain(BROKEN.iter().map(|(file, _)| *file))
        .chain(CHECKED_BY_HAND.iter().map(|(file, ..)| *file))
        .map(|file| folder.join(file))
        .collect();
    let mut found = Vec::new();
    files(&folder.join("glTF2"), &mut found);
    files(&folder.join("3MF"), &mut found);
    assert!(!found.is_empty());
    for file in found {
        assert!(known.contains(&file), "{}", file.display());
    }
}
