//! What holds for all assets together.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

use glam::{DVec3, I64Vec3};

use crate::obj::{Model, POSITION_DECIMALS, decimal};
use crate::{all, models, monkey, scene};

/// A position in the file's own last decimals, where sums and products are exact.
fn in_file(p: DVec3) -> I64Vec3 {
    I64Vec3::from_array(p.to_array().map(|v| {
        let text = format!("{:.1$}", v, POSITION_DECIMALS);
        text.replace('.', "").parse().expect("digits and a sign")
    }))
}

/// The models with their positions as the files have them.
fn models_in_file() -> impl Iterator<Item = (Model, Vec<I64Vec3>)> {
    models().into_iter().map(|model| {
        let positions = model.positions.iter().map(|&p| in_file(p)).collect();
        (model, positions)
    })
}

/// The number of each position's part: positions that faces join have the same.
fn parts(model: &Model) -> Vec<usize> {
    fn root(parent: &[usize], mut i: usize) -> usize {
        while parent[i] != i {
            i = parent[i];
        }
        i
    }
    let mut parent: Vec<usize> = (0..model.positions.len()).collect();
    for [a, b, c] in model.triangles() {
        for other in [b, c] {
            let (from, to) = (root(&parent, other), root(&parent, a));
            parent[from.max(to)] = from.min(to);
        }
    }
    (0..parent.len()).map(|i| root(&parent, i)).collect()
}

#[test]
fn the_files_in_the_repository_are_what_the_program_makes() {
    for (name, content) in all() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(&name);
        let committed = std::fs::read(&path).unwrap_or_default();
        assert!(
            committed == content,
            "{name}: run `cargo run -p raycast-assets --release`"
        );
    }
}

#[test]
fn every_edge_joins_two_triangles_that_agree_on_outside() {
    for model in models() {
        let mut edges = HashSet::new();
        for [a, b, c] in model.triangles() {
            for edge in [(a, b), (b, c), (c, a)] {
                assert!(
                    edges.insert(edge),
                    "{}: edge {edge:?} is used twice this way",
                    model.name
                );
            }
        }
        for &(a, b) in &edges {
            assert!(
                edges.contains(&(b, a)),
                "{}: edge {a}-{b} is open",
                model.name
            );
        }
    }
}

#[test]
fn every_part_faces_outwards() {
    for model in models() {
        let part_of = parts(&model);
        let mut volumes = BTreeMap::new();
        for [a, b, c] in model.triangles() {
            let at = |i: usize| model.positions[i] - model.positions[part_of[a]];
            *volumes.entry(part_of[a]).or_insert(0.0) += at(a).dot(at(b).cross(at(c)));
        }
        for (part, volume) in volumes {
            assert!(
                volume > 0.0,
                "{}: the part of vertex {part} is inside out",
                model.name
            );
        }
    }
}

#[test]
fn no_triangle_of_a_file_is_degenerate() {
    for (model, positions) in models_in_file() {
        for triangle in model.triangles() {
            let [a, b, c] = triangle.map(|i| positions[i]);
            assert_ne!(
                (b - a).cross(c - a),
                I64Vec3::ZERO,
                "{}: {triangle:?}",
                model.name
            );
        }
    }
}

#[test]
fn no_part_of_a_file_has_a_vertex_twice_or_one_too_many() {
    for (model, positions) in models_in_file() {
        let mut seen = HashMap::new();
        for (index, part) in parts(&model).into_iter().enumerate() {
            let earlier = seen.insert((part, positions[index]), index);
            assert_eq!(earlier, None, "{}: vertex {index} again", model.name);
        }
        let used: HashSet<usize> = model.triangles().flatten().collect();
        assert_eq!(used.len(), positions.len(), "{}", model.name);
    }
}

#[test]
fn normals_are_unit_and_on_their_faces_side() {
    for model in models() {
        for normal in &model.normals {
            assert!((normal.length() - 1.0).abs() < 1e-9, "{}", model.name);
        }
        for face in &model.faces {
            let [a, b, c] = [0, 1, 2].map(|i| model.positions[face.corners[i].position]);
            let across = (b - a).cross(c - a);
            for corner in &face.corners {
                assert!(
                    across.dot(model.normals[corner.normal]) > 0.0,
                    "{}: {face:?}",
                    model.name
                );
            }
        }
    }
}

#[test]
fn the_monkey_is_symmetric() {
    let monkey = monkey::monkey();
    let positions: HashSet<I64Vec3> = monkey.positions.iter().map(|&p| in_file(p)).collect();
    for p in &positions {
        assert!(positions.contains(&I64Vec3::new(-p.x, p.y, p.z)), "{p}");
    }
}

#[test]
fn triangle_counts_are_small() {
    let counts = models().map(|model| (model.name, model.triangle_count()));
    for (name, count) in counts {
        let expected = match name {
            "cube" => 12..=12,
            "monkey" => 4_000..=10_000,
            "dahlia" => 3_000..=8_000,
            "torus" => 4_096..=4_096,
            _ => 1..=3_000,
        };
        assert!(expected.contains(&count), "{name}: {count}");
    }
}

#[test]
fn the_scene_names_files_that_are_made() {
    let names: HashSet<String> = all().into_iter().map(|(name, _)| name).collect();
    let scene = scene::demo();
    let named: Vec<&str> = scene
        .lines()
        .filter_map(|line| {
            line.strip_prefix("mesh = ")
                .or(line.strip_prefix("texture = "))
        })
        .map(|value| value.trim_matches('"'))
        .collect();
    assert!(named.len() >= 5);
    for name in named {
        assert!(names.contains(name), "{name}");
    }
}

#[test]
fn numbers_are_short() {
    assert_eq!(decimal(1.0, 5), "1");
    assert_eq!(decimal(-0.000_001, 5), "0");
    assert_eq!(decimal(0.25, 4), "0.25");
    assert_eq!(decimal(-12.5, 5), "-12.5");
    assert_eq!(decimal(120.0, 0), "120");
}
