//! Ground truth: what the readers of the original files give, and newly built trees.

use super::checksum::{BYTES, checksum};
use super::header::HEADER_BYTES;
use super::*;
use crate::formats::{Budget, FormatError};
use crate::formats::{FileKind, Limits, SceneFile, read_scene, read_scene_within};
use crate::hit::Cull;
use crate::random::Random;
use crate::ray::Ray;
use crate::scene::{
    Alpha, Attribute, Color, Material, Mesh, MeshData, Object, Opacity, Reflectance, Scalar,
    ScalarAt, Scene, Shape, Texture, TreeTopology, Wrap,
};
use crate::{Accel, glam::DVec3};
use glam::{Vec2, Vec3};
use std::path::Path;
use std::sync::Arc;

fn prepared(file: &SceneFile) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_prepared(file, Path::new("a.raycast"), &mut bytes).expect("it can be prepared");
    bytes
}

fn prepared_scene(scene: Scene) -> Vec<u8> {
    prepared(&SceneFile {
        scene,
        ..SceneFile::default()
    })
}

/// Reads prepared bytes as a file.
fn read_back(bytes: &[u8]) -> Result<SceneFile, FormatError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.raycast");
    std::fs::write(&path, bytes).expect("a file");
    read_scene(&path, &|_| ())
}

/// The error message for prepared bytes, without the file's name.
fn refusal(bytes: &[u8]) -> String {
    let read = super::read(Path::new("a"), bytes, &Budget::default(), &|_| ());
    let told = read.err().expect("a refusal").to_string();
    told.strip_prefix("a: ").expect("the file").to_owned()
}

/// The bytes with some replaced at `at`, and with a correct checksum.
fn changed(bytes: &[u8], at: usize, to: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes[at..at + to.len()].copy_from_slice(to);
    signed(bytes)
}

fn signed(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - BYTES;
    let sum = checksum(&bytes[..end]);
    bytes[end..].copy_from_slice(&sum);
    bytes
}

/// A mesh with every optional attribute, with duplicate and dropped triangles.
fn rich() -> Mesh {
    let texture = |texel: u8, wrap| {
        let texture = Texture::new(2, 1, vec![[texel; 4], [9; 4]]);
        texture.map(|texture| Arc::new(texture.wrapped([wrap, Wrap::Mirror])))
    };
    let shared = texture(3, Wrap::Clamp);
    let mut image = Material::new("image", Color([1, 2, 3]));
    image.texture = shared.clone();
    image.by_vertex = true;
    image.reflectance = Some(Arc::new(Reflectance {
        metallic: 1.0,
        roughness: 0.25,
        texture: shared.clone(),
        emission: [0.0, 2.0, 0.5],
        emission_texture: texture(4, Wrap::Border(Some(Color([7, 8, 9])))),
        is_unlit: true,
    }));
    let mut mask = Material::new("mask", Color([4, 5, 6]));
    mask.opacity = Opacity::Mask {
        alpha: Alpha {
            factor: 0.5,
            image: texture(5, Wrap::Border(None)),
        },
        cutoff: 0.25,
    };
    let mut blend = Material::new("", Color([7, 8, 9]));
    blend.opacity = Opacity::Blend(Alpha {
        factor: 0.75,
        image: None,
    });
    let mut positions: Vec<DVec3> = (0..60u32)
        .map(|i| DVec3::new(f64::from(i % 8), f64::from(i / 8), f64::from(i % 3) * 0.1))
        .map(|at| at + DVec3::X * 1e6)
        .collect();
    positions.push(DVec3::NAN);
    let mut triangles: Vec<[u32; 3]> = (0..50).map(|i| [i, i + 1, i + 9]).collect();
    triangles.extend([[0, 1, 9], [0, 0, 1], [1, 2, 60], [1, 2, 99], [1, 9, 0]]);
    let count = triangles.len();
    Mesh::new(MeshData {
        normals: Some(Attribute {
            values: vec![Vec3::Z, Vec3::X],
            indices: Some((0..count as u32).map(|i| [0, 1, i % 2]).collect()),
        }),
        uvs: Some(Attribute {
            values: (0..61).map(|i| Vec2::new(i as f32 * 0.1, 0.5)).collect(),
            indices: None,
        }),
        materials: vec![image, mask, blend],
        material_of_triangle: (0..count as u32)
            .map(|i| if i % 4 == 3 { u32::MAX } else { i % 4 })
            .collect(),
        colors: vec![Some(Color([1, 1, 1])), None, Some(Color([0, 0, 0]))],
        scalars: vec![
            Scalar {
                name: "height".to_owned(),
                at: ScalarAt::Vertices,
                values: (0..61).map(|i| i as f32).collect(),
            },
            Scalar {
                name: "part é".to_owned(),
                at: ScalarAt::Triangles,
                values: vec![f32::NAN; count],
            },
        ],
        diagonals: {
            let mut diagonals = crate::scene::Diagonals::of(count);
            diagonals.set(2, [true, false, true]);
            diagonals
        },
        positions,
        triangles,
    })
}

fn ball(segments: u32) -> Mesh {
    let shape = Shape::Sphere {
        radius: 1.0,
        segments,
        rings: segments / 2,
    };
    Mesh::new(shape.mesh().expect("a shape"))
}

/// Asserts that rays have bitwise equal hits in both trees.
fn answer_alike(a: &Accel, b: &Accel) {
    let mut random = Random(5);
    let bounds = a.bounds();
    let size = bounds.size().max_element();
    let mut hits = 0;
    for _ in 0..3000 {
        let origin = bounds.center() + random.point() * size;
        let ray = Ray::new(
            origin,
            bounds.center() + random.point() * size * 0.4 - origin,
        );
        let (a, b) = (a.cast(&ray, Cull::None), b.cast(&ray, Cull::None));
        hits += u32::from(a.is_some());
        assert_eq!(format!("{a:?}"), format!("{b:?}"));
    }
    assert!(hits > 300, "{hits}");
}

#[test]
fn a_prepared_mesh_keeps_all_its_fields() {
    let mut object = Object::new("an object", Arc::new(rich()));
    object.transform.matrix.translation = DVec3::new(0.1, 0.2, 0.3);
    object.texture = Texture::new(1, 1, vec![[1, 2, 3, 4]]).map(Arc::new);
    object.texture_source = Some("/somewhere/x.png".into());
    let again = Object {
        name: "again".to_owned(),
        ..object.clone()
    };
    let file = SceneFile {
        scene: Scene {
            objects: vec![object, again],
        },
        unit: Some(crate::formats::LengthUnit::Inch),
        warnings: vec!["a warning".to_owned()],
        notes: vec!["a note".to_owned()],
        ..SceneFile::default()
    };
    let read = read_back(&prepared(&file)).expect("a good file");
    assert_eq!(read.kind, FileKind::Prepared);
    assert_eq!((read.unit, &read.warnings), (file.unit, &file.warnings));
    assert_eq!(read.notes, ["prepared from no file", "a note"]);
    assert_eq!(read.scene.content(), file.scene.content());
    let [first, second] = &read.scene.objects[..] else {
        panic!("two objects");
    };
    assert!(Arc::ptr_eq(&first.mesh, &second.mesh));
    assert_eq!((&*first.name, &*second.name), ("an object", "again"));
    assert_eq!((first.node, second.node), (Some(0), Some(1)));
    assert!(
        first
            .texture_source
            .as_ref()
            .is_some_and(|path| path.ends_with("x.png"))
    );
    let (mesh, before) = (&first.mesh, &file.scene.objects[0].mesh);
    // Properties that the digest of the content does not cover.
    assert_eq!(mesh.kept(), before.kept());
    assert_eq!(mesh.dropped(), before.dropped());
    assert!(mesh.dropped().total() >= 3);
    assert_eq!(mesh.materials(), before.materials());
    let materials = mesh.materials();
    let texture = materials[0].texture.as_ref().expect("a texture");
    let reflectance = materials[0].reflectance.as_ref().expect("a reflectance");
    assert!(Arc::ptr_eq(
        texture,
        reflectance.texture.as_ref().expect("the same")
    ));
    assert_eq!(
        format!("{:?}", mesh.scalars()),
        format!("{:?}", before.scalars())
    );
    assert_eq!(mesh.diagonals(), before.diagonals());
    assert_eq!(mesh.rounding(), before.rounding());
    assert_eq!(mesh.bounds(), before.bounds());
    let tree = mesh.tree().expect("a tree");
    // Duplicates are not in the tree.
    assert_eq!(tree.order.len() + 2, mesh.kept().len());
    // Preparing the result again gives the same bytes.
    let again = prepared(&read);
    let third = read_back(&again).expect("a good file");
    assert_eq!(third.scene.objects[0].mesh.tree(), Some(tree));
}

#[test]
fn rays_hit_the_same_with_and_without_a_kept_tree() {
    let kept = |mesh: &Mesh| {
        let read = read_back(&prepared_scene(Scene::from(mesh.clone()))).expect("a good file");
        Arc::clone(&read.scene.objects[0].mesh)
    };
    let (ball, rich, small) = (ball(300), rich(), self::ball(20));
    let meshes = [
        (&ball, 0.0),
        (&rich, 0.0),
        (&ball, 1.0),
        (&small, 3.0),
        (&rich, 1.0),
    ];
    let scene = |kept: &dyn Fn(usize, &Mesh) -> Arc<Mesh>, count: usize| {
        let objects = meshes[..count].iter().enumerate().map(|(i, (mesh, x))| {
            let mut object = Object::new("object", kept(i, mesh));
            object.transform.translate = DVec3::new(*x, 0.0, 0.0) - object.mesh.offset();
            if object.mesh.offset() == DVec3::ZERO {
                object.transform.rotate.y = x * 10.0;
            }
            object
        });
        Scene {
            objects: objects.collect(),
        }
    };
    for count in [1, 2, 5] {
        let plain = scene(&|_, mesh| Arc::new(mesh.clone()), count);
        let known = scene(&|_, mesh| kept(mesh), count);
        // Only some of the meshes have a tree.
        let mixed = scene(
            &|i, mesh| {
                if i % 2 == 0 {
                    kept(mesh)
                } else {
                    Arc::new(mesh.clone())
                }
            },
            count,
        );
        for scene in [known, mixed] {
            let built = Accel::build(&plain).expect("a scene");
            answer_alike(&built, &Accel::build(&scene).expect("a scene"));
            let instances = Accel::build_instances(&plain).expect("a scene");
            answer_alike(
                &instances,
                &Accel::build_instances(&scene).expect("a scene"),
            );
            let joined = Accel::build(&scene).expect("a scene");
            assert!(!joined.has_instances() && joined.len() >= built.len());
            assert_eq!(joined.bounds(), built.bounds());
        }
    }
}

#[test]
fn meshes_partly_out_of_range_get_a_tree_over_the_rest() {
    let read = read_back(&prepared_scene(Scene::from(ball(40)))).expect("a good file");
    let mut scene = read.scene;
    scene.objects[0].transform.scale = DVec3::new(3e18, 1.0, 1.0);
    let accel = Accel::build(&scene).expect("a scene");
    assert!(accel.out_of_range() > 0 && !accel.is_empty());
    scene.objects[0].mesh = Arc::new(ball(40));
    let built = Accel::build(&scene).expect("a scene");
    assert_eq!(
        (accel.out_of_range(), accel.len()),
        (built.out_of_range(), built.len())
    );
}

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
    let told = refusal(&changed(&bytes, 12, &[2, 0, 0, 0]));
    assert!(
        told.contains("expected a prepared mesh of version 1"),
        "{told}"
    );
    assert!(
        told.contains("found version 2, written by program \"0."),
        "{told}"
    );
    assert!(told.contains("`raycast prepare`"), "{told}");
    let told = refusal(&bytes[..bytes.len() - 1]);
    let expected = format!("{} bytes, found a file cut short at", bytes.len());
    assert!(told.contains(&expected), "{told}");
    let mut damaged = bytes;
    damaged[100] ^= 4;
    let told = refusal(&damaged);
    assert!(
        told.contains("damaged: run `raycast prepare` again"),
        "{told}"
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
    // Skips the ids of dropped triangles, five counts, no normals, no coordinates, five empty lists, rounding.
    let order = dropped + 4 + 20 + 8 + 20 + 20;
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
        let told = refusal(&changed(&bytes, at, &to));
        assert!(told.contains(expected), "{at}: {told}");
        assert_eq!(told.lines().count(), 1);
    }
    // Removes one triangle from the tree.
    let mut less = bytes[..order].to_vec();
    less.extend(number(4));
    less.extend(&bytes[order + 4..order + 20]);
    less.extend(number(0));
    less.extend(&bytes[last + 8..]);
    let length = less.len() as u64;
    less[HEADER_BYTES - 8..HEADER_BYTES].copy_from_slice(&length.to_le_bytes());
    let told = refusal(&signed(less));
    assert!(told.contains("a triangle is in no leaf"), "{told}");
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
    assert!(deep.is_err_and(|told| told.contains("too deep")));
}

#[test]
fn limits_hold() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.raycast");
    std::fs::write(&path, prepared_scene(Scene::from(ball(100)))).expect("a file");
    for (limits, told) in [
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
        assert!(error.to_string().contains(told), "{error}");
    }
}

#[test]
fn settings_that_only_scene_files_have_are_refused() {
    let told = |change: fn(&mut SceneFile)| {
        let mut file = SceneFile {
            scene: Scene::from(ball(8)),
            ..SceneFile::default()
        };
        change(&mut file);
        let written = write_prepared(&file, Path::new("a.raycast"), &mut Vec::new());
        written.expect_err("a refusal").to_string()
    };
    let check = |change, what: &str| {
        let told = told(change);
        assert!(told.contains(what) && told.contains("scene file"), "{told}");
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
        told(|file| file.scene.objects.clear()),
        "there is no mesh to prepare"
    );
}
