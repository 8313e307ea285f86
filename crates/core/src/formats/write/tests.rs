use super::*;
use crate::formats::error::FormatError;
use crate::formats::held::Held;
use crate::formats::limits::Budget;
use crate::formats::mesh_file;
use crate::render::Cancel;
use crate::scene::{
    Attribute, Color, Groups, Material, Mesh, MeshData, Object, Run, Scalar, ScalarAt, Shape,
    Transform, UpAxis,
};
use glam::{DVec3, Vec2, Vec3};
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;

/// The formats that can be read as well, by file names.
const READ: [(&str, MeshFormat); 6] = [
    ("a.obj", MeshFormat::Obj),
    ("a.ply", MeshFormat::Ply { ascii: false }),
    ("a.PLY", MeshFormat::Ply { ascii: true }),
    ("a.stl", MeshFormat::Stl { ascii: false }),
    ("a.STL", MeshFormat::Stl { ascii: true }),
    ("a.txt", MeshFormat::TriangleText),
];

pub(super) fn scene(meshes: impl IntoIterator<Item = MeshData>) -> Scene {
    let objects = meshes
        .into_iter()
        .enumerate()
        .map(|(number, data)| Object::new(format!("object\n{number}"), Arc::new(Mesh::new(data))));
    Scene {
        objects: objects.collect(),
    }
}

pub(super) fn bytes(scene: &Scene, format: MeshFormat) -> (Vec<u8>, Written) {
    let mut bytes = Vec::new();
    let library = library(scene);
    let named = Some(("a.mtl", &library));
    let written = write_meshes(scene, format, named, &mut bytes).expect("it is written");
    (bytes, written)
}

pub(super) fn library(scene: &Scene) -> MaterialLibrary {
    MaterialLibrary::new(scene, "an image").expect("a list takes all")
}

pub(super) fn read_all(scene: &Scene, name: &str, bytes: &[u8]) -> mesh_file::MeshFile {
    let library = library(scene);
    let resolve = |name: &str| {
        let mut images = library.images.iter();
        match name {
            "a.mtl" => Some(library.text.clone().into_bytes()),
            name => images
                .find(|(known, _)| known == name)
                .map(|(_, png)| png.clone()),
        }
    };
    let budget = Budget::default();
    let files = Held::new(&resolve, &budget);
    let up_axis = UpAxis::default();
    mesh_file::read(Path::new(name), bytes, &files, up_axis, &|_| ()).expect(name)
}

fn read(scene: &Scene, name: &str, bytes: &[u8]) -> Mesh {
    let read = read_all(scene, name, bytes);
    let text = String::from_utf8_lossy(bytes);
    assert_eq!(read.warnings, [""; 0], "{name}: {text}");
    let [object] = &read.objects[..] else {
        panic!("{name}: {} objects", read.objects.len());
    };
    Mesh::clone(&object.mesh)
}

/// The corners of a triangle in the file's coordinates, bit for bit.
fn corners(mesh: &Mesh, number: u32) -> [[u64; 3]; 3] {
    let corners = mesh.corners(number).expect("a corner");
    corners.map(|corner| {
        // Adding zero makes minus zero positive.
        let corner = mesh.offset() + corner.as_dvec3() + DVec3::ZERO;
        corner.to_array().map(f64::to_bits)
    })
}

/// Single-precision coordinates over several decades, with every attribute that a mesh may have.
pub(super) fn rich() -> MeshData {
    let places: [[f32; 3]; 5] = [
        [0.1, -0.0, 3e-9],
        [1.0, 0.2, 0.3],
        [0.7, 1.1, -0.25],
        [-12345.678, 1e-20, 0.3333333],
        [5.0, 5.0, 5.0],
    ];
    MeshData {
        positions: places
            .map(|place| Vec3::from_array(place).as_dvec3())
            .to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3], [1, 1, 2], [3, 1, 0]],
        normals: Some(Attribute {
            values: vec![Vec3::Z, Vec3::X],
            indices: Some(vec![[0, 0, 1], [1, 1, 0], [0; 3], [1; 3]]),
        }),
        uvs: Some(Attribute {
            values: vec![Vec2::ZERO, Vec2::X, Vec2::new(0.1, 0.75), Vec2::ONE],
            indices: Some(vec![[0, 1, 2], [2, 3, 0], [0; 3], [1, 2, 3]]),
        }),
        materials: vec![
            Material::new("a b", Color([1, 2, 3])),
            Material::new("b", Color([254, 128, 7])),
        ],
        material_of_triangle: vec![0, 1, u32::MAX, 0],
        colors: Vec::new(),
        ..MeshData::default()
    }
}

#[test]
fn scalars_are_written_as_ply_and_read_again() {
    let scalar = |name: &str, at: ScalarAt, values: &[f32]| Scalar {
        name: name.to_owned(),
        at,
        values: values.to_vec(),
    };
    let (vertices, triangles) = (ScalarAt::Vertices, ScalarAt::Triangles);
    let heat = [0.1, -1e-30, f32::NAN, 3e30, 5.0];
    let data = MeshData {
        scalars: vec![
            scalar("heat", vertices, &heat),
            scalar("part", vertices, &[0.0, 1.0, 2.0, 3.0, f32::INFINITY]),
            scalar("heat of faces", triangles, &[1.5, 2.5, -0.0, 4.5]),
            // Names that PLY cannot represent, or that have another meaning there.
            scalar("two words", vertices, &heat),
            scalar("nx", vertices, &heat),
            scalar("red", triangles, &[1.0; 4]),
        ],
        ..rich()
    };
    let scene = scene([data]);
    let mesh = &scene.objects[0].mesh;
    for (name, format) in READ {
        let (bytes, written) = bytes(&scene, format);
        let lost = written.lost.join("; ");
        if !matches!(format, MeshFormat::Ply { .. }) {
            assert!(lost.contains("scalars"), "{name}: {lost}");
            continue;
        }
        for name in ["\"two words\"", "\"nx\"", "\"red\""] {
            assert!(lost.contains(&format!("scalar {name}")), "{lost}");
        }
        assert!(!lost.contains("scalars"), "{lost}");
        let again = read(&scene, name, &bytes);
        assert_eq!(again.scalars().len(), 3, "{name}");
        for (found, expected) in again.scalars().iter().zip(mesh.scalars()) {
            assert_eq!((&found.name, found.at), (&expected.name, expected.at));
        }
        let bits = |values: [f32; 3]| values.map(f32::to_bits);
        for &number in mesh.kept() {
            for name in ["heat", "part", "heat of faces"] {
                let of = |mesh: &Mesh| {
                    let scalar = mesh.scalar(name).expect("a scalar");
                    let corners = mesh.triangles()[number as usize];
                    match scalar.at {
                        ScalarAt::Vertices => corners.map(|i| scalar.values[i as usize]),
                        ScalarAt::Triangles => [scalar.values[number as usize]; 3],
                    }
                };
                assert_eq!(bits(of(&again)), bits(of(mesh)), "{name} of {number}");
            }
        }
    }
}

#[test]
fn written_meshes_read_back_the_same_in_every_format() {
    let scene = scene([rich()]);
    let mesh = &scene.objects[0].mesh;
    for (name, format) in READ {
        let (bytes, written) = bytes(&scene, format);
        assert_eq!(
            (written.triangles, written.dropped, written.moved),
            (4, 1, 0),
            "{name}"
        );
        let again = read(&scene, name, &bytes);
        assert_eq!(again.kept(), mesh.kept(), "{name}");
        for &number in mesh.kept() {
            assert_eq!(corners(&again, number), corners(mesh, number), "{name}");
        }
        let keeps = matches!(format, MeshFormat::Obj | MeshFormat::Ply { .. });
        for &number in mesh.kept() {
            let color = |mesh: &Mesh| mesh.material(number).map(|material| material.color);
            if keeps {
                assert_eq!(
                    again.corner_normals(number),
                    mesh.corner_normals(number),
                    "{name}"
                );
                assert_eq!(again.corner_uvs(number), mesh.corner_uvs(number), "{name}");
                assert_eq!(color(&again), color(mesh), "{name}");
            } else {
                assert_eq!(
                    written.lost,
                    ["normals", "texture coordinates", "materials"]
                );
            }
        }
        // From every format to every other.
        let between = Scene::from(again);
        for (other, format) in READ {
            let (bytes, _) = self::bytes(&between, format);
            let last = read(&between, other, &bytes);
            assert_eq!(last.kept(), mesh.kept(), "{name} to {other}");
            for &number in mesh.kept() {
                assert_eq!(
                    corners(&last, number),
                    corners(mesh, number),
                    "{name} to {other}"
                );
            }
        }
    }
}

#[test]
fn groups_are_written_as_obj_and_counted_as_lost_elsewhere() {
    let run = |first, group| Run { first, group };
    let names = vec!["left wheel".to_owned(), "body".to_owned()];
    for runs in [
        vec![run(0, 0), run(2, 1), run(3, 0)],
        vec![run(1, 1), run(2, Run::NONE), run(3, 0)],
    ] {
        let scene = scene([MeshData {
            groups: Groups::new(names.clone(), runs, 4).expect("good groups"),
            ..rich()
        }]);
        for (name, format) in READ {
            let (bytes, written) = bytes(&scene, format);
            let (again, mesh) = (read(&scene, name, &bytes), &scene.objects[0].mesh);
            let is_lost = written.lost.contains(&"groups of triangles".to_owned());
            assert_eq!(is_lost, format != MeshFormat::Obj, "{name}");
            if !is_lost {
                for triangle in 0..4 {
                    let of = |mesh: &Mesh| mesh.groups().of(triangle).map(str::to_owned);
                    assert_eq!(of(&again), of(mesh), "{triangle}");
                }
            }
        }
    }
}

#[test]
fn vertex_colors_are_written() {
    let mut data = rich();
    data.materials.clear();
    data.colors = (0..5u8)
        .map(|n| Some(Color([n, 50 * n, 255 - n])))
        .collect();
    let scene = scene([data]);
    for (name, format) in &READ[..3] {
        let (bytes, _) = bytes(&scene, *format);
        let again = read(&scene, name, &bytes);
        for number in 0..4 {
            let expected = scene.objects[0].mesh.corner_colors(number);
            assert_eq!(again.corner_colors(number), expected, "{name}");
        }
    }
}

#[test]
fn moves_are_counted() {
    let far = MeshData {
        positions: vec![
            DVec3::new(1e7 + 0.123456789, 0.0, 0.0),
            DVec3::new(1e7 + 1.0, 0.0, 0.0),
            DVec3::new(1e7, 1.0, 0.0),
        ],
        triangles: vec![[0, 1, 2]],
        ..MeshData::default()
    };
    let scene = scene([far]);
    let mesh = &scene.objects[0].mesh;
    for (name, format) in READ {
        let (bytes, written) = bytes(&scene, format);
        let again = read(&scene, name, &bytes);
        if matches!(format, MeshFormat::Stl { .. }) {
            // Single-precision numbers near 1e7 are a unit apart.
            assert_eq!(written.moved, 1, "{name}");
            assert!(
                (written.largest_move - 0.123456789).abs() < 1e-7,
                "{written:?}"
            );
        } else {
            assert_eq!((written.moved, written.largest_move), (0, 0.0), "{name}");
            assert_eq!(corners(&again, 0), corners(mesh, 0), "{name}");
        }
    }
    assert_eq!(bytes(&scene, MeshFormat::Glb).1.moved, 0);
}

/// Single-precision coordinates that lie further from zero than the mesh is long, so that it is stored relative to an
/// offset. A reader in double precision recentres these, and the shortest decimals of single-precision numbers are
/// not these numbers.
fn far() -> MeshData {
    let places = [[1.0, 0.3f32, 0.007446289], [1.0, 0.3, 0.1], [1.1, 0.3, 0.7]];
    MeshData {
        positions: places
            .map(|place| Vec3::from_array(place).as_dvec3())
            .to_vec(),
        triangles: vec![[0, 1, 2]],
        ..MeshData::default()
    }
}

#[test]
fn far_singles_stay() {
    // A triangle that is too far away to be stored, beside it, does not count for the offset.
    let mut beside = far();
    beside.positions.extend([DVec3::splat(-2e18); 3]);
    beside.triangles.push([3, 4, 5]);
    for data in [far(), beside] {
        let scene = scene([data]);
        let mesh = &scene.objects[0].mesh;
        assert!(mesh.offset() != DVec3::ZERO && mesh.kept() == [0]);
        for (name, format) in READ {
            let (bytes, written) = bytes(&scene, format);
            assert_eq!(written.moved, 0, "{name}");
            let again = read(&scene, name, &bytes);
            assert_eq!(corners(&again, 0), corners(mesh, 0), "{name}");
        }
    }
}

#[test]
fn a_glb_is_read_again_object_by_object_where_each_stands() {
    let scene = scene([rich(), far(), rich()]);
    let (bytes, written) = bytes(&scene, MeshFormat::Glb);
    assert_eq!(written.moved, 0);
    let nothing = |_: &str| None;
    let budget = Budget::default();
    let files = Held::new(&nothing, &budget);
    let read = mesh_file::read(Path::new("a.glb"), &bytes, &files, UpAxis::Y, &|_| ());
    let read = read.expect("what was written is read");
    assert_eq!(read.objects.len(), 3);
    let places = scene.world_from_objects().expect("transforms");
    for ((before, place), after) in scene.objects.iter().zip(places).zip(&read.objects) {
        assert_eq!(
            before.name.replace('\n', " "),
            after.name.replace('\n', " ")
        );
        assert_eq!(before.mesh.kept(), after.mesh.kept());
        for &number in before.mesh.kept() {
            let stands = |mesh: &Mesh, place: glam::DAffine3| {
                let corners = mesh.corners(number).expect("a kept triangle has corners");
                corners.map(|corner| place.transform_point3(mesh.offset() + corner.as_dvec3()))
            };
            let again = stands(&after.mesh, after.world_from_object);
            assert_eq!(stands(&before.mesh, place), again, "{}", before.name);
        }
    }
}

#[test]
fn dropped_triangles_keep_their_numbers() {
    let mut data = rich();
    data.positions.push(DVec3::NAN);
    data.positions.push(DVec3::X * 1e300);
    data.triangles
        .splice(1..1, [[0, 1, 5], [0, 1, 99], [6, 0, 1]]);
    let normals = data.normals.as_mut().expect("normals");
    let indices = normals.indices.as_mut().expect("indices");
    indices.splice(1..1, [[0; 3]; 3]);
    data.uvs = None;
    data.materials.clear();
    let scene = scene([data]);
    let mesh = &scene.objects[0].mesh;
    for (name, format) in READ {
        let (bytes, written) = bytes(&scene, format);
        let counts = (written.triangles, written.dropped, written.emptied);
        assert_eq!(counts, (7, 4, 3), "{name}");
        let again = read(&scene, name, &bytes);
        assert_eq!(again.kept(), mesh.kept(), "{name}");
        assert_eq!(again.dropped().total(), 4, "{name}");
    }
}

#[test]
fn objects_are_written_where_they_stand() {
    let mut scene = scene([rich(), rich()]);
    scene.objects[1].transform = Transform {
        translate: DVec3::new(0.0, 100.0, 0.0),
        rotate: DVec3::new(0.0, 0.0, 30.0),
        scale: DVec3::splat(2.0),
        ..Transform::IDENTITY
    };
    scene.objects[1].parent = Some(0);
    let place = scene.world_from_objects().expect("transforms")[1];
    let mesh = &scene.objects[1].mesh;
    for (name, format) in READ {
        let (bytes, written) = bytes(&scene, format);
        let again = read(&scene, name, &bytes);
        assert_eq!(again.kept(), [0, 1, 3, 4, 5, 7], "{name}");
        let message = "that there are 2 objects".to_owned();
        assert_eq!(
            written.lost.contains(&message),
            format != MeshFormat::Obj,
            "{name}"
        );
        for (found, expected) in again
            .corners(4)
            .into_iter()
            .flatten()
            .zip(mesh.corners(0).expect("corners"))
        {
            let expected = place.transform_point3(expected.as_dvec3());
            assert!((found.as_dvec3() - expected).length() < 1e-5, "{name}");
        }
    }
    let (text, _) = bytes(&scene, MeshFormat::Obj);
    let text = String::from_utf8(text).expect("text");
    assert!(text.contains("\no object 1\n"), "{text}");
}

#[test]
fn materials_with_equal_names_get_unique_names() {
    let mut other = rich();
    other.materials[1].color = Color([9; 3]);
    let scene = scene([rich(), other]);
    let (bytes, _) = bytes(&scene, MeshFormat::Obj);
    let again = read(&scene, "a.obj", &bytes);
    let color = |number| again.material(number).map(|material| material.color);
    assert_eq!(
        [1, 5].map(color),
        [Some(Color([254, 128, 7])), Some(Color([9; 3]))]
    );
}

#[test]
fn a_glbs_lengths_and_offsets_agree_with_its_bytes() {
    let mut scene = scene([rich(), rich()]);
    scene.objects[1].transform.translate = DVec3::new(1e6, 0.0, 0.0);
    let (bytes, written) = bytes(&scene, MeshFormat::Glb);
    assert_eq!(&bytes[..8], b"glTF\x02\0\0\0");
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four")) as usize;
    assert_eq!(word(8), bytes.len());
    let json: Value = serde_json::from_slice(&bytes[20..20 + word(12)]).expect("JSON");
    let buffer = &bytes[28 + word(12)..];
    assert_eq!(word(20 + word(12)), buffer.len());
    assert_eq!(json["buffers"][0]["byteLength"], buffer.len());
    let numbers = |accessor: &Value, of: usize| -> Vec<[u8; 4]> {
        let accessor = &json["accessors"][accessor.as_u64().expect("a number") as usize];
        let view = accessor["bufferView"].as_u64().expect("a number") as usize;
        let at = |value: &Value| value["byteOffset"].as_u64().unwrap_or(0) as usize;
        let start = at(&json["bufferViews"][view]) + at(accessor);
        let count = accessor["count"].as_u64().expect("a count") as usize * of;
        buffer[start..start + 4 * count].as_chunks().0.to_vec()
    };
    let mut triangles = 0;
    for (index, object) in scene.objects.iter().enumerate() {
        let node = &json["nodes"][index];
        let mesh = &json["meshes"][node["mesh"].as_u64().expect("a mesh") as usize];
        let translation = &node["translation"][0];
        let x = translation.as_f64().unwrap_or(0.0);
        let place = object.transform.translate;
        let mut number = 0;
        for primitive in mesh["primitives"].as_array().expect("a list") {
            let positions = numbers(&primitive["attributes"]["POSITION"], 3);
            let position = |index: usize| {
                let number =
                    |axis: usize| f64::from(f32::from_le_bytes(positions[3 * index + axis]));
                DVec3::new(x + number(0), number(1), number(2))
            };
            for triangle in numbers(&primitive["indices"], 1).as_chunks::<3>().0 {
                let corners = triangle.map(|index| position(u32::from_le_bytes(index) as usize));
                let expected = object.mesh.corners(number).expect("corners");
                for (corner, expected) in corners.into_iter().zip(expected) {
                    let moved = (corner - (place + expected.as_dvec3())).length();
                    assert!(moved <= written.largest_move, "{moved} {written:?}");
                }
                let material = object.mesh.material(number).map(|material| &material.name);
                let named = primitive["material"].as_u64();
                let named = named.map(|index| &json["materials"][index as usize]["name"]);
                assert_eq!(named.and_then(Value::as_str), material.map(String::as_str));
                number += 1;
            }
        }
        triangles += number;
    }
    assert_eq!(triangles, 8);
    assert_eq!(json["nodes"][0].get("translation"), None);
}

#[test]
fn names_ask_for_formats() {
    let format = |name| MeshFormat::from_name(name, true);
    assert_eq!(format("a.b.PLY"), Some(MeshFormat::Ply { ascii: true }));
    assert_eq!(format("tri"), None);
    assert_eq!(format("a.off"), None);
}

#[test]
fn a_reading_that_is_cancelled_ends_without_a_mesh() {
    let sphere = Shape::Sphere {
        radius: 1.0,
        segments: 200,
        rings: 200,
    };
    let scene = scene([sphere.mesh().expect("a good shape")]);
    let resolve = |_: &str| None;
    for (name, format) in READ.into_iter().chain([("a.glb", MeshFormat::Glb)]) {
        let (bytes, _) = bytes(&scene, format);
        let cancel = Cancel::default();
        let budget = Budget::default().cancelled_by(cancel.clone());
        let files = Held::new(&resolve, &budget);
        let message = mesh_file::read(
            Path::new(name),
            &bytes,
            &files,
            UpAxis::Y,
            &|unit_channel| {
                // Progress ends at 1.
                if unit_channel < 1.0 {
                    cancel.cancel();
                }
            },
        );
        assert!(
            matches!(message, Err(FormatError::Cancelled { .. })),
            "{name}"
        );
    }
}

#[test]
fn hidden_objects_are_left_out_and_counted() {
    let mut all = scene([rich(), far(), rich()]);
    all.objects[1].visible = false;
    // A child of what is hidden stays where it is.
    all.objects[1].transform.translate = DVec3::X;
    all.objects[2].parent = Some(1);
    let mut shown = all.clone();
    shown.objects[2].parent = None;
    shown.objects[2].transform.translate = DVec3::X;
    shown.objects.remove(1);
    for (name, format) in READ {
        let (written, summary) = bytes(&all, format);
        assert!(written == bytes(&shown, format).0, "{name}");
        let hidden = "hidden objects (1)".to_owned();
        assert!(summary.lost.contains(&hidden), "{name}: {:?}", summary.lost);
    }
}

#[test]
fn triangles_of_hidden_groups_are_left_out_and_counted() {
    let groups = |names: &[&str], of: &[u32]| {
        let names = names.iter().map(|&name| name.to_owned()).collect();
        Groups::of_triangles(names, of.iter().map(|&group| Some(group))).expect("all have names")
    };
    let scalars = |at_vertices: &[f32], at_triangles: &[f32]| {
        let one = |name: &str, at, values: &[f32]| Scalar {
            name: name.to_owned(),
            at,
            values: values.to_vec(),
        };
        vec![
            one("v", ScalarAt::Vertices, at_vertices),
            one("t", ScalarAt::Triangles, at_triangles),
        ]
    };
    let whole = MeshData {
        groups: groups(&["a", "b"], &[0, 1, 0, 1]),
        scalars: scalars(&[1.0, 2.0, 3.0, 4.0, 5.0], &[6.0, 7.0, 8.0, 9.0]),
        ..rich()
    };
    let one = |attribute: &Option<Attribute<Vec2>>, count: usize, indices: Vec<[u32; 3]>| {
        attribute.as_ref().map(|uvs| Attribute {
            values: uvs.values[..count].to_vec(),
            indices: Some(indices),
        })
    };
    let normals = |indices| Attribute {
        values: vec![Vec3::Z, Vec3::X],
        indices: Some(indices),
    };
    let with_a = MeshData {
        positions: rich().positions[..3].to_vec(),
        triangles: vec![[0, 1, 2]],
        normals: Some(normals(vec![[0, 0, 1]])),
        uvs: one(&rich().uvs, 3, vec![[0, 1, 2]]),
        material_of_triangle: vec![0],
        groups: groups(&["a"], &[0]),
        scalars: scalars(&[1.0, 2.0, 3.0], &[6.0]),
        ..rich()
    };
    let with_b = MeshData {
        positions: rich().positions[..4].to_vec(),
        triangles: vec![[0, 2, 3], [3, 1, 0]],
        normals: Some(normals(vec![[1, 1, 0], [1; 3]])),
        uvs: one(&rich().uvs, 4, vec![[2, 3, 0], [1, 2, 3]]),
        material_of_triangle: vec![1, 0],
        groups: groups(&["b"], &[0, 0]),
        scalars: scalars(&[1.0, 2.0, 3.0, 4.0], &[7.0, 9.0]),
        ..rich()
    };
    let mut all = scene([whole]);
    for (hidden, left, count) in [("b", with_a, 3), ("a", with_b, 2)] {
        all.objects[0].hide_groups([hidden.to_owned()].into());
        let left = scene([left]);
        for (name, format) in READ.into_iter().chain([("a.glb", MeshFormat::Glb)]) {
            let (written, summary) = bytes(&all, format);
            assert!(written == bytes(&left, format).0, "{name} without {hidden}");
            let lost = format!("triangles of hidden groups ({count})");
            assert!(summary.lost.contains(&lost), "{name}: {:?}", summary.lost);
        }
    }
}
