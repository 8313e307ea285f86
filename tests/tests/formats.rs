//! Files from outside, good and broken ones, where the machine has them: as many triangles in the same
//! box as another program finds, or a refusal with its reason. `tests/formats/figures.py` tells how
//! its figures were made.

use raycast_core::formats::{SceneFile, read_scene};
use raycast_core::glam::DVec3;
use raycast_tests::models;
use std::path::{Path, PathBuf};

const FIGURES: &str = include_str!("../formats/figures.tsv");

/// What holds nothing to show, or is broken, and why it is refused.
const REFUSED: &[(&str, &str)] = &[
    // A vertex of no face, which others pass over.
    (
        "OBJ/number_formats.obj",
        "number_formats.obj:11: expected three numbers behind `v`",
    ),
    ("OBJ/point_cloud.obj", "expected faces"),
    ("OBJ/testline.obj", "expected faces"),
    ("OBJ/testpoints.obj", "expected faces"),
    ("OFF/invalid.off", "invalid.off:7: expected a face"),
    ("PLY/issue623.ply", "expected a number of element vertex"),
    (
        "PLY/payload_JVN42386607",
        "payload_JVN42386607:6: expected one element of a name",
    ),
    ("PLY/points.ply", "4 points alone, which are not shown"),
    ("PLY/pond.0.ply", "70051 points alone, which are not shown"),
];

/// The folder of a folder a format; `None`, said aloud, where there is none.
fn folder() -> Option<PathBuf> {
    Some(models::folder()?.join("formats"))
}

fn read(folder: &Path, name: &str) -> Result<SceneFile, String> {
    read_scene(&folder.join(name), &|_| ()).map_err(|error| error.to_string())
}

#[test]
fn good_files_have_the_triangles_that_another_program_finds() {
    let Some(folder) = folder() else { return };
    let mut faults = Vec::new();
    for line in FIGURES.lines() {
        let mut words = line.split('\t');
        let name = words.next().expect("a name");
        if REFUSED.iter().any(|(refused, _)| *refused == name) {
            continue;
        }
        let triangles: usize = words.next().and_then(|n| n.parse().ok()).expect("a count");
        let ends: Vec<f64> = words.map(|word| word.parse().expect("a number")).collect();
        let (min, max) = (DVec3::from_slice(&ends[..3]), DVec3::from_slice(&ends[3..]));
        let file = match read(&folder, name) {
            Ok(file) => file,
            Err(refusal) => {
                faults.push(refusal);
                continue;
            }
        };
        let found = file.scene.triangle_count();
        if found != triangles {
            faults.push(format!("{name}: {found} triangles, and not {triangles}"));
        }
        let bounds = file.scene.bounds();
        // Single precision of one of the two, and the other's text.
        let tolerance = 1e-6 * (max - min).max_element();
        let off = (bounds.min - min).abs().max((bounds.max - max).abs());
        if !off.is_finite() || off.max_element() > tolerance {
            faults.push(format!("{name}: {bounds:?}, and not {min} to {max}"));
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn what_is_broken_is_refused_with_its_reason() {
    let Some(folder) = folder() else { return };
    for (name, reason) in REFUSED {
        let refusal = read(&folder, name).expect_err(name);
        assert!(refusal.contains(reason), "{name}: {refusal}");
        assert!(refusal.contains(name), "{refusal}");
    }
}

/// No file is left unlooked at.
#[test]
fn every_file_is_good_or_broken() {
    let Some(folder) = folder() else { return };
    let known = |name: &str| {
        let figures = FIGURES
            .lines()
            .any(|line| line.split('\t').next() == Some(name));
        figures || REFUSED.iter().any(|(refused, _)| *refused == name)
    };
    let mut places: Vec<PathBuf> = ["OBJ", "PLY", "STL", "OFF"]
        .map(|n| folder.join(n))
        .to_vec();
    while let Some(place) = places.pop() {
        for entry in std::fs::read_dir(&place).expect("a folder") {
            let path = entry.expect("a folder can be listed").path();
            let extension = path
                .extension()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            if path.is_dir() {
                places.push(path);
            } else if !["mtl", "jpg", "png", "txt"].contains(&&*extension) {
                let name = path
                    .strip_prefix(&folder)
                    .expect("within")
                    .to_string_lossy();
                assert!(known(&name.replace('\\', "/")), "{name}");
            }
        }
    }
}
