//! Ground truth: what the readers of the original files give, and newly built trees.

use super::checksum::{BYTES, checksum};
use super::*;
use crate::formats::{Budget, FormatError};
use crate::formats::{FileKind, SceneFile, read_scene};
use crate::hit::Cull;
use crate::random::Random;
use crate::ray::Ray;
use crate::scene::{
    Alpha, Attribute, Color, Groups, Material, Mesh, MeshData, Object, Opacity, Reflectance, Run,
    Scalar, ScalarAt, Scene, Shape, Texture, Wrap,
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

pub(super) fn prepared_scene(scene: Scene) -> Vec<u8> {
    prepared(&SceneFile {
        scene,
        ..SceneFile::default()
    })
}

/// Reads prepared bytes as a file.
pub(super) fn read_back(bytes: &[u8]) -> Result<SceneFile, FormatError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.raycast");
    std::fs::write(&path, bytes).expect("a file");
    read_scene(&path, &|_| ())
}

/// The error message for prepared bytes, without the file's name.
pub(super) fn refusal(bytes: &[u8]) -> String {
    let read = super::read(Path::new("a"), bytes, &Budget::default(), &|_| ());
    let message = read.err().expect("a refusal").to_string();
    message.strip_prefix("a: ").expect("the file").to_owned()
}

/// The bytes with some replaced at `at`, and with a correct checksum.
pub(super) fn changed(bytes: &[u8], at: usize, to: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes[at..at + to.len()].copy_from_slice(to);
    signed(bytes)
}

pub(super) fn signed(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - BYTES;
    let sum = checksum(&bytes[..end]);
    bytes[end..].copy_from_slice(&sum);
    bytes
}

/// A mesh with every optional attribute, with duplicate and dropped triangles.
pub(super) fn rich() -> Mesh {
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
        groups: {
            let names = vec!["wheel é".to_owned(), "body".to_owned()];
            let run = |first, group| Run { first, group };
            let runs = vec![run(3, 1), run(9, Run::NONE), run(20, 0)];
            Groups::new(names, runs, count).expect("good groups")
        },
        positions,
        triangles,
    })
}

pub(super) fn ball(segments: u32) -> Mesh {
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
    assert_eq!(mesh.groups(), before.groups());
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
