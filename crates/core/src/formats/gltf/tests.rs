use crate::formats::SceneFile;
use crate::formats::held::Held;
use crate::formats::limits::Budget;
use crate::formats::read_scene_from;
use crate::scene::Mesh;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::{DVec3, Vec3};
use std::path::Path;
use std::sync::Arc;

/// The numbers 0 to 3 as indices, a square's corners, and bytes that a test adds.
fn buffer(more: &[u8]) -> Vec<u8> {
    let corners: [f32; 12] = [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.];
    let mut bytes = vec![0, 1, 2, 3];
    bytes.extend(corners.iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend(more);
    bytes
}

/// A file whose accessors are the square's corners (0) and indices (1), and those of `accessors`, over
/// views of all bytes (0), of the corners (1), and of `more` (2).
pub(super) fn gltf(more: &[u8], accessors: &str, rest: &str) -> String {
    let bytes = buffer(more);
    let length = bytes.len();
    let data = STANDARD.encode(&bytes);
    format!(
        r#"{{"asset": {{"version": "2.0"}},
"buffers": [{{"byteLength": {length}, "uri": "data:application/octet-stream;base64,{data}"}}],
"bufferViews": [{{"buffer": 0, "byteLength": {length}}},
 {{"buffer": 0, "byteOffset": 4, "byteLength": 48}},
 {{"buffer": 0, "byteOffset": 52, "byteLength": {}}}],
"accessors": [{{"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3"}},
 {{"bufferView": 0, "componentType": 5121, "count": 4, "type": "SCALAR"}}{accessors}],
{rest}}}"#,
        length - 52
    )
}

/// A node with a mesh of these primitives.
pub(super) fn primitives(list: &str) -> String {
    format!(r#""nodes": [{{"mesh": 0}}], "meshes": [{{"primitives": [{list}]}}]"#)
}

pub(super) fn try_read(bytes: &[u8]) -> Result<SceneFile, String> {
    let files = |name: &str| match name {
        "a.gltf" => Some(bytes.to_vec()),
        "t.ppm" => Some("P3\n1 1\n255\n255 100 0\n".into()),
        _ => None,
    };
    read_scene_from("[[object]]\nmesh = \"a.gltf\"\n", &files).map_err(|error| error.to_string())
}

pub(super) fn read(text: &str) -> SceneFile {
    try_read(text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

pub(super) fn notes(text: &str) -> Vec<String> {
    let budget = Budget::default();
    let image = |_: &str| Some("P3\n1 1\n255\n1 2 3\n".into());
    let files = Held::new(&image, &budget);
    let read = super::read(Path::new("a.gltf"), text.as_bytes(), &files, &|_| ());
    read.expect("a good file").notes
}

fn mesh(file: &SceneFile) -> &Mesh {
    &file.scene.objects[0].mesh
}

#[test]
fn own_attributes_of_one_number_are_scalars() {
    // Four numbers as floats, and as normalised bytes; and four pairs, which are no scalars.
    let floats: [f32; 4] = [0.5, -1.0, 1e30, 7.0];
    let mut more: Vec<u8> = floats.iter().flat_map(|x| x.to_le_bytes()).collect();
    more.extend([0, 51, 102, 255]);
    let accessors = r#",
 {"bufferView": 2, "componentType": 5126, "count": 4, "type": "SCALAR"},
 {"bufferView": 2, "byteOffset": 16, "componentType": 5121, "normalized": true, "count": 4, "type": "SCALAR"},
 {"bufferView": 2, "componentType": 5121, "count": 4, "type": "VEC2"},
 {"bufferView": 2, "componentType": 5126, "count": 3, "type": "SCALAR"}"#;
    let of = |list: &str| try_read(gltf(&more, accessors, &primitives(list)).as_bytes());
    let file = of(
        r#"{"attributes": {"POSITION": 0, "_HEAT": 2, "_PAIR": 4, "_SHARE": 3}, "mode": 5},
 {"attributes": {"POSITION": 0, "_HEAT": 3}, "mode": 5}, {"attributes": {"POSITION": 0}, "mode": 5}"#,
    )
    .expect("a good file");
    let mesh = mesh(&file);
    assert_eq!((mesh.positions().len(), mesh.triangles().len()), (12, 6));
    let none = [f32::NAN; 4];
    let shares = [0.0, 0.2, 0.4, 1.0];
    let expected = [
        ("_HEAT", [floats, shares, none].concat()),
        ("_SHARE", [shares, none, none].concat()),
    ];
    assert_eq!(mesh.scalars().len(), 2);
    for (scalar, (name, values)) in mesh.scalars().iter().zip(expected) {
        assert_eq!(scalar.name, name);
        let bits = |values: &[f32]| -> Vec<u32> { values.iter().map(|v| v.to_bits()).collect() };
        assert_eq!(bits(&scalar.values), bits(&values), "{name}");
    }
    let message = of(r#"{"attributes": {"POSITION": 0, "_HEAT": 5}}"#).expect_err("too few");
    assert!(
        message.contains("_HEAT: expected as many as positions, 4"),
        "{message}"
    );
}

#[test]
fn lists_strips_and_fans_turn_one_way() {
    let of = |mode: u32| {
        let one = format!(r#"{{"attributes": {{"POSITION": 0}}, "indices": 1, "mode": {mode}}}"#);
        mesh(&read(&gltf(&[], "", &primitives(&one))))
            .triangles()
            .to_vec()
    };
    assert_eq!(of(4), [[0, 1, 2]]);
    assert_eq!(of(5), [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(of(6), [[1, 2, 0], [2, 3, 0]]);
    let file = read(&gltf(
        &[],
        "",
        &primitives(
            r#"{"attributes": {"POSITION": 0}, "mode": 5}, {"attributes": {"POSITION": 0}, "mode": 1},
 {"attributes": {}}, {"attributes": {"POSITION": 0}, "indices": 1, "targets": [{}]}"#,
        ),
    ));
    assert_eq!(mesh(&file).triangles(), [[0, 1, 2], [1, 3, 2], [0, 1, 2]]);
    assert_eq!(
        mesh(&file).positions().len(),
        4,
        "one list of vertices for both"
    );
    assert_eq!(
        file.warnings,
        [
            "a.gltf: primitives of points or lines, which are not shown: 1",
            "a.gltf: primitives without positions, which are not shown: 1",
            "a.gltf: corners behind the last whole triangle, which are passed over: 1",
            "a.gltf: meshes with morph targets, which are shown at rest: 1",
        ]
    );
}

#[test]
fn numbers_are_read_in_all_their_forms() {
    // Three positions in each form, four bytes or more apart, read as the accessor says.
    let check =
        |component: u32, normalized: bool, stride: usize, bytes: &[u8], expected: [f32; 9]| {
            let view = format!(
                r#", {{"bufferView": 3, "byteOffset": 1, "componentType": {component}, "count": 3,
 "type": "VEC3", "normalized": {normalized}}}"#
            );
            let length = bytes.len() + 1;
            let mut more = vec![9];
            more.extend(bytes);
            let text = gltf(
            &more,
            &view,
            &primitives(r#"{"attributes": {"POSITION": 2}}"#),
        )
        .replace("],\n\"accessors\"", &format!(
            r#", {{"buffer": 0, "byteOffset": 52, "byteLength": {length}, "byteStride": {stride}}}],
"accessors""#
        ));
            let file = read(&text);
            let found: Vec<f32> = mesh(&file)
                .positions()
                .iter()
                .flat_map(|p| p.to_array())
                .collect();
            assert_eq!(found, expected, "{component}, {normalized}");
        };
    let i8s = [0x80, 127, 0, 99, 1, 0, 2, 99, 0, 0, 0xff];
    check(
        5120,
        false,
        4,
        &i8s,
        [-128., 127., 0., 1., 0., 2., 0., 0., -1.],
    );
    let [one, two] = [1.0 / 127.0, 2.0 / 127.0].map(|x: f64| x as f32);
    check(
        5120,
        true,
        4,
        &i8s,
        [-1., 1., 0., one, 0., two, 0., 0., -one],
    );
    let small = 51.0 / 255.0;
    check(
        5121,
        true,
        3,
        &[255, 0, 0, 0, 255, 0, 51, 0, 0],
        [1., 0., 0., 0., 1., 0., small, 0., 0.],
    );
    let words: Vec<u8> = [-32768i16, 0, 32767, 0, 9, 1, 0, 5, 5]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    check(
        5122,
        false,
        6,
        &words,
        [-32768., 0., 32767., 0., 9., 1., 0., 5., 5.],
    );
    let words: Vec<u8> = [65535u16, 0, 0, 0, 65535, 0, 0, 0, 13107]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    check(5123, true, 6, &words, [1., 0., 0., 0., 1., 0., 0., 0., 0.2]);
    let floats: Vec<u8> = [0.1f32, 0., 0., 0., 1e-3, 0., 0., 7., 8.]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    check(
        5126,
        false,
        12,
        &floats,
        [0.1, 0., 0., 0., 1e-3, 0., 0., 7., 8.],
    );
}

#[test]
fn sparse_values_stand_over_others_or_over_zeros() {
    let mut more = vec![1, 2];
    more.extend(
        [5f32, 0., 0., 0., 6., 7.]
            .iter()
            .flat_map(|x| x.to_le_bytes()),
    );
    let sparse = r#""sparse": {"count": 2, "indices": {"bufferView": 2, "componentType": 5121},
 "values": {"bufferView": 2, "byteOffset": 2}}"#;
    let accessors = format!(
        r#", {{"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3", {sparse}}},
 {{"componentType": 5126, "count": 3, "type": "VEC3", {sparse}}}"#
    );
    let of = |accessor: u32| {
        let one = format!(r#"{{"attributes": {{"POSITION": {accessor}}}, "mode": 5}}"#);
        mesh(&read(&gltf(&more, &accessors, &primitives(&one))))
            .positions()
            .to_vec()
    };
    let (five, six) = (Vec3::X * 5.0, Vec3::new(0.0, 6.0, 7.0));
    assert_eq!(of(2), [Vec3::ZERO, five, six, Vec3::Y]);
    assert_eq!(of(3), [Vec3::ZERO, five, six]);
}

#[test]
fn nodes_are_objects_depth_first_and_share_their_meshes() {
    let text = gltf(
        &[],
        "",
        r#""scene": 1, "scenes": [{"nodes": [3]}, {"nodes": [2, 0]}],
"nodes": [{"name": "last", "mesh": 0},
 {"name": "child", "mesh": 1, "scale": [2, 2, 2], "rotation": [0, 0, 0.70710678, 0.70710678]},
 {"name": "first", "mesh": 0, "translation": [10, 0, 0], "children": [1, 4]},
 {"mesh": 0},
 {"children": [5]}, {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0.1, 1]}],
"meshes": [{"name": "square", "primitives": [{"attributes": {"POSITION": 0}, "mode": 6}]},
 {"primitives": [{"attributes": {"POSITION": 0}, "mode": 5}]}], "cameras": [{}]"#,
    );
    let file = read(&text);
    let objects = &file.scene.objects;
    let names: Vec<&str> = objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["first", "child", "square", "last"]);
    let nodes: Vec<_> = objects.iter().map(|object| object.node).collect();
    assert_eq!(nodes, [Some(0), Some(1), Some(2), Some(3)]);
    assert!(Arc::ptr_eq(&objects[0].mesh, &objects[2].mesh));
    assert!(!Arc::ptr_eq(&objects[0].mesh, &objects[1].mesh));
    let maps = file.scene.world_from_objects().expect("good transforms");
    let at =
        |object: usize, x: f64, y: f64, z: f64| maps[object].transform_point3(DVec3::new(x, y, z));
    assert_eq!(at(0, 1.0, 2.0, 3.0), DVec3::new(11.0, 2.0, 3.0));
    assert!((at(1, 1.0, 0.0, 0.0) - DVec3::new(10.0, 2.0, 0.0)).length() < 1e-15);
    assert_eq!(at(2, 0.0, 1.0, 0.0), DVec3::new(10.0, 0.0, 1.1));
    assert!(file.warnings.is_empty(), "{:?}", file.warnings);
    assert_eq!(
        notes(&text),
        [
            "unit: metre; up axis: Y",
            "not used: cameras (1), other scenes (1)"
        ]
    );

    // In a saved scene each object names its node, and is placed by it to the last bit.
    let saved = file.to_toml(Path::new("")).expect("it can be saved");
    let files = |_: &str| Some(text.clone().into_bytes());
    let again = read_scene_from(&saved, &files).expect("a good scene");
    assert_eq!(again.scene.content(), file.scene.content(), "{saved}");
    assert!(Arc::ptr_eq(
        &again.scene.objects[0].mesh,
        &again.scene.objects[2].mesh
    ));
    assert_eq!(again.to_toml(Path::new("")).ok(), Some(saved));

    // A table that names the file stands for all of its objects, transformed; one that names a node, for that object.
    let scene = "[[object]]\nname = \"all\"\nmesh = \"a.gltf\"\ntranslate = [0, 0, 1]\ncolor = \"#102030\"\n\
        [[object]]\nname = \"one\"\nmesh = \"a.gltf\"\nnode = 1\n\
        [[object]]\nmesh = \"a.gltf\"\nnode = 0\nparent = \"one\"\n";
    let moved = read_scene_from(scene, &files).expect("a good scene").scene;
    let names: Vec<&str> = moved
        .objects
        .iter()
        .map(|object| object.name.as_str())
        .collect();
    assert_eq!(
        names,
        [
            "all: first",
            "all: child",
            "all: square",
            "all: last",
            "one",
            "first"
        ]
    );
    let maps = moved.world_from_objects().expect("good transforms");
    assert_eq!(
        maps[2].transform_point3(DVec3::Y),
        DVec3::new(10.0, 0.0, 2.1)
    );
    assert_eq!(maps[4].transform_point3(DVec3::Y), DVec3::Y);
    assert_eq!(moved.objects[5].parent, Some(4));
    let bad = |scene: &str| {
        read_scene_from(scene, &files)
            .expect_err("a bad scene")
            .to_string()
    };
    assert_eq!(
        bad(&scene.replace("node = 1", "node = 4")),
        "scene:9: expected the number of one of the file's 4 mesh nodes, from 0, found 4"
    );
    assert_eq!(
        bad(&scene.replace("parent = \"one\"", "parent = \"all\"")),
        "scene:13: expected the name of one object as parent, found \"all\", a file of 4 objects"
    );
}

#[test]
fn bad_normals_are_left_out_by_triangle() {
    let normals = [0f32, 0., 2., 0., 0., 2., 0., 0., 2., 0., 0., 0.];
    let more: Vec<u8> = normals.iter().flat_map(|x| x.to_le_bytes()).collect();
    let accessors = r#", {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC3"}"#;
    let rest = primitives(r#"{"attributes": {"POSITION": 0, "NORMAL": 2}, "mode": 5}"#);
    let file = read(&gltf(&more, accessors, &rest));
    assert_eq!(mesh(&file).corner_normals(0), Some([Vec3::Z; 3]));
    assert_eq!(mesh(&file).corner_normals(1), None);
}

/// A binary file of this JSON and these bytes.
fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let number = |x: usize| (x as u32).to_le_bytes();
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend(number(28 + json.len() + binary.len()));
    bytes.extend(number(json.len()));
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes.extend(number(binary.len()));
    bytes.extend(b"BIN\0");
    bytes.extend(binary);
    bytes
}

#[test]
fn a_binary_file_is_the_same_file() {
    let rest = primitives(r#"{"attributes": {"POSITION": 0}, "mode": 6}"#);
    let text = gltf(&[], "", &rest);
    let uri = text.find(", \"uri\"").expect("a URI")..text.find("\"}],").expect("its end") + 1;
    let mut json = text.clone();
    json.replace_range(uri, "");
    let bytes = glb(&json, &buffer(&[]));
    let file = try_read(&bytes).expect("a good file");
    assert_eq!(file.scene.content(), read(&text).scene.content());
    for (at, byte, message) in [
        (4, 1, "a.gltf: byte 4: expected GLB version 2, found 1"),
        (8, 255, "a.gltf: byte 8: expected a file of "),
        (15, 1, "a.gltf: byte 12: expected a chunk of at most "),
        (20, b'[', "a.gltf: its JSON: "),
    ] {
        let mut bad = bytes.clone();
        bad[at] = byte;
        if at == 8 {
            bad[9] = 255;
        }
        let error = try_read(&bad).expect_err(message);
        assert!(error.contains(message), "{error}");
    }
    // Truncated anywhere, it is refused without a panic.
    for end in 0..bytes.len() {
        assert!(try_read(&bytes[..end]).is_err(), "{end} bytes");
    }
}

#[test]
fn deep_nests_take_no_stack() {
    for (open, close) in [("[", "]"), ("{\"a\":", "}")] {
        let deep = format!("{}1{}", open.repeat(100_000), close.repeat(100_000));
        let text = format!("{{\"asset\": {{\"version\": \"2.0\"}}, \"extras\": {deep}}}");
        let error = try_read(text.as_bytes()).expect_err("a deep nest");
        assert!(error.contains("no node with a mesh"), "{error}");
    }
    // A chain of nodes may be arbitrarily deep.
    let count = 100_000;
    let nodes: Vec<String> = (1..count)
        .map(|child| format!("{{\"children\": [{child}]}}"))
        .collect();
    let rest = format!(
        "\"nodes\": [{}, {{\"mesh\": 0}}], \"meshes\": [{{\"primitives\": [{{\"attributes\": {{\"POSITION\": 0}}}}]}}]",
        nodes.join(", ")
    );
    assert_eq!(read(&gltf(&[], "", &rest)).scene.objects.len(), 1);
}
