//! What is no prepared file, or breaks a limit, is refused.

use super::checksum::BYTES;
use super::header::HEADER_BYTES;
use super::tests::{ball, changed, prepared_scene, read_back, refusal, rich, signed};
use super::*;
use crate::formats::{Budget, Limits, SceneFile, read_scene_within};
use crate::hit::Cull;
use crate::random::Random;
use crate::ray::Ray;
use crate::scene::{Mesh, MeshData, Scene, TreeTopology};
use crate::{Accel, glam::DVec3};
use std::path::Path;

#[test]
fn every_changed_byte_and_every_cut_is_an_error() {
    let bytes = prepared_scene(Scene::from(rich()));
    assert!(super::read(Path::new("a"), &bytes, &Budget::default(), &|_| ()).is_ok());
    for at in 0..bytes.len() {
        for bit in [1, 0x80] {
            let mut bytes = bytes.clone();
            bytes[at] ^= bit;
            refusal(&bytes);
            assert!(at > 12 || read_back(&bytes).is_err(), "{at}");
        }
        refusal(&bytes[..at]);
    }
    refusal(&[&bytes[..], &[0]].concat());
}

#[test]
fn other_versions_and_damage_are_named() {
    let bytes = prepared_scene(Scene::from(ball(4)));
    let message = refusal(&changed(&bytes, 12, &[3, 0, 0, 0]));
    assert!(
        message.contains("expected a prepared mesh of version 2"),
        "{message}"
    );
    assert!(
        message.contains("found version 3, written by program \"0."),
        "{message}"
    );
    assert!(message.contains("`raycast prepare`"), "{message}");
    let message = refusal(&bytes[..bytes.len() - 1]);
    let expected = format!("{} bytes, found a file cut short at", bytes.len());
    assert!(message.contains(&expected), "{message}");
    let mut damaged = bytes;
    damaged[100] ^= 4;
    let message = refusal(&damaged);
    assert!(
        message.contains("damaged: run `raycast prepare` again"),
        "{message}"
    );
}

/// A prepared row of triangles, and the offset of its vertex list.
fn row() -> (Vec<u8>, usize) {
    let positions = (0..14).map(|i| DVec3::new(f64::from(i), f64::from(i % 2), 0.0));
    let mesh = Mesh::new(MeshData {
        positions: positions.collect(),
        triangles: (0..12).map(|i| [i, i + 1, i + 2]).collect(),
        ..MeshData::default()
    });
    let bytes = prepared_scene(Scene::from(mesh));
    // Skips unit, warnings, notes with one string, textures, meshes, and the mesh's offset.
    let note = 4 + "prepared from no file".len();
    (bytes, HEADER_BYTES + 4 + 4 + 4 + note + 4 + 4 + 24)
}

#[test]
fn crafted_files_with_right_checksums_are_refused() {
    let (bytes, positions) = row();
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four"));
    assert_eq!(word(positions), 14);
    let triangles = positions + 4 + 14 * 12;
    assert_eq!(word(triangles), 12);
    let dropped = triangles + 4 + 12 * 12;
    // Skips the ids of dropped triangles, five counts, no normals, no coordinates, seven empty lists, rounding.
    let order = dropped + 4 + 20 + 8 + 28 + 20;
    assert_eq!(word(order), 12);
    let nodes = order + 4 + 12 * 4;
    let count = word(nodes);
    assert!(count >= 2, "{count}");
    let number = |n: u32| n.to_le_bytes();
    let single = |x: f32| x.to_le_bytes();
    let last = nodes + 4 + 8 * (count as usize - 1);
    for (at, to, expected) in [
        (positions, number(u32::MAX), "vertices that are in the file"),
        (positions, number(13), ""),
        (
            positions + 4,
            single(f32::NAN),
            "a corner that is not finite",
        ),
        (positions + 4, single(3e18), "a corner that is too far"),
        (positions + 8, single(5e4), ""),
        (triangles + 4, number(14), "a corner that is not there"),
        (triangles + 4, number(1), "a triangle has no area"),
        (dropped, number(1), ""),
        (dropped + 4, number(1), "not as many triangles are dropped"),
        (
            dropped + 24,
            number(7),
            "whether there are attributes below 2",
        ),
        (order + 4, number(12), "in two leaves, or not there"),
        (
            order + 4,
            bytes[order + 8..order + 12].try_into().expect("four"),
            "in two leaves",
        ),
        (nodes + 4, number(0), "children that do not fit it"),
        (nodes + 4, number(12), "children that do not fit it"),
        (nodes + 4, number(u32::MAX), "children that do not fit it"),
        (nodes + 8, number(count), "children that do not fit it"),
        (nodes + 8, number(u32::MAX), "children that do not fit it"),
        (last, number(0), "children that do not fit it"),
        (last + 4, number(1), "children that do not fit it"),
    ] {
        if expected.is_empty() {
            // The change shifts what follows, or makes another valid mesh. Only the absence of a panic is tested.
            let bytes = changed(&bytes, at, &to);
            drop(super::read(
                Path::new("a"),
                &bytes,
                &Budget::default(),
                &|_| (),
            ));
            continue;
        }
        let message = refusal(&changed(&bytes, at, &to));
        assert!(message.contains(expected), "{at}: {message}");
        assert_eq!(message.lines().count(), 1);
    }
    // Removes one triangle from the tree.
    let mut less = bytes[..order].to_vec();
    less.extend(number(4));
    less.extend(&bytes[order + 4..order + 20]);
    less.extend(number(0));
    less.extend(&bytes[last + 8..]);
    let length = less.len() as u64;
    less[HEADER_BYTES - 8..HEADER_BYTES].copy_from_slice(&length.to_le_bytes());
    let message = refusal(&signed(less));
    assert!(message.contains("a triangle is in no leaf"), "{message}");
}

/// A file that is accepted has a tree of all its triangles, and rays hit the same as in a newly built tree.
#[test]
fn random_changes_under_right_checksums_are_refused_or_sound() {
    let mut random = Random(11);
    let files = [
        row().0,
        prepared_scene(Scene::from(rich())),
        prepared_scene(Scene::from(ball(8))),
    ];
    let rounds = std::env::var("RAYCAST_PREPARED_ROUNDS")
        .ok()
        .and_then(|n| n.parse().ok());
    let mut accepted = 0;
    for round in 0..rounds.unwrap_or(4000) {
        let mut bytes = files[round % files.len()].clone();
        let end = bytes.len() - BYTES;
        let mut below = |count: usize| (random.unit() * count as f64) as usize % count;
        for _ in 0..1 + round % 3 {
            let at = HEADER_BYTES + below(end - HEADER_BYTES - 4);
            match below(4) {
                0 => bytes[at] ^= 1 << below(8),
                1 => bytes[at] = below(256) as u8,
                // Replaces a word by a nearby value, or by a word from elsewhere in the file.
                2 => {
                    let word = u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four"));
                    let word = word.wrapping_add(below(5) as u32).wrapping_sub(2);
                    bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
                }
                _ => {
                    let from = HEADER_BYTES + below(end - HEADER_BYTES - 4);
                    bytes.copy_within(from..from + 4, at);
                }
            }
        }
        let bytes = signed(bytes);
        let Ok(read) = super::read(Path::new("a"), &bytes, &Budget::default(), &|_| ()) else {
            continue;
        };
        accepted += 1;
        let mesh = &read.objects[0].mesh;
        let scene = |mesh: Mesh| Scene::from(mesh);
        let known = Accel::build(&scene(Mesh::clone(mesh))).expect("a scene");
        let mut plain = Mesh::clone(mesh);
        plain.forget_tree();
        let built = Accel::build(&scene(plain)).expect("a scene");
        for primitive in known.primitives().take(20) {
            let [a, b, c] = known.corners(primitive).map(|corner| corner.as_dvec3());
            let target = known.origin() + (a + b + c) / 3.0;
            let way = (b - a).cross(c - a).normalize_or_zero() + random.point() * 0.1;
            let ray = Ray::new(target - way * (b - a).length(), way);
            let hits = [&known, &built].map(|accel| accel.cast(&ray, Cull::None));
            assert_eq!(
                format!("{:?}", hits[0]),
                format!("{:?}", hits[1]),
                "{round}"
            );
        }
    }
    assert!(accepted > 100, "{accepted}");
}

#[test]
fn a_chain_of_nodes_is_too_deep() {
    let positions = (0..202).map(|i| DVec3::new(f64::from(i), f64::from(i % 2), 0.0));
    let mesh = Mesh::new(MeshData {
        positions: positions.collect(),
        triangles: (0..200).map(|i| [i, i + 1, i + 2]).collect(),
        ..MeshData::default()
    });
    let chain = |length: u32| {
        let order = (0..200).collect();
        // A chain: each first child is a leaf of one triangle, the second child has the rest.
        let mut nodes = vec![[1, 0]; length as usize];
        let left = 200 - length;
        // The rest is halved.
        fn halve(count: u32, nodes: &mut Vec<[u32; 2]>) {
            if count > 4 {
                let at = nodes.len();
                nodes.push([count / 2, 0]);
                halve(count / 2, nodes);
                nodes[at][1] = (nodes.len() - at - 1) as u32;
                halve(count - count / 2, nodes);
            }
        }
        halve(left, &mut nodes);
        TreeTopology::checked(&mesh, order, nodes).map(|tree| tree.levels)
    };
    assert_eq!(chain(20), Ok(20 + 7));
    assert!(chain(85).is_ok_and(|levels| levels <= 96));
    assert!(chain(150).is_err());
    let deep = TreeTopology::checked(&mesh, (0..200).collect(), vec![[1, 0]; 196]);
    assert!(deep.is_err_and(|message| message.contains("too deep")));
}

#[test]
fn limits_hold() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.raycast");
    std::fs::write(&path, prepared_scene(Scene::from(ball(100)))).expect("a file");
    for (limits, message) in [
        (
            Limits {
                triangles: 100,
                ..Limits::default()
            },
            "limit `triangles`",
        ),
        (
            Limits {
                bytes: 600_000,
                ..Limits::default()
            },
            "limit `bytes`",
        ),
    ] {
        let error = read_scene_within(&path, &Budget::new(limits), &|_| ()).expect_err("too much");
        assert!(error.to_string().contains(message), "{error}");
    }
}

#[test]
fn settings_that_only_scene_files_have_are_refused() {
    let message = |change: fn(&mut SceneFile)| {
        let mut file = SceneFile {
            scene: Scene::from(ball(8)),
            ..SceneFile::default()
        };
        change(&mut file);
        let written = write_prepared(&file, Path::new("a.raycast"), &mut Vec::new());
        written.expect_err("a refusal").to_string()
    };
    let check = |change, what: &str| {
        let message = message(change);
        assert!(
            message.contains(what) && message.contains("scene file"),
            "{message}"
        );
    };
    check(|file| file.image.samples = Some(4), "image settings");
    check(
        |file| file.scene.objects[0].parent = Some(0),
        "parent of the object",
    );
    check(
        |file| file.scene.objects[0].transform.scale.x = 2.0,
        "place of the object",
    );
    check(
        |file| file.scene.objects[0].visible = false,
        "visible of the object",
    );
    assert_eq!(
        message(|file| file.scene.objects.clear()),
        "there is no mesh to prepare"
    );
}
