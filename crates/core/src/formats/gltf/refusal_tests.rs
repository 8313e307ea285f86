//! Each fault of a file gives one line that says where it is and what was expected.

use super::tests::{gltf, primitives, try_read};

#[test]
fn says_where_and_what() {
    let check = |from: &str, to: &str, message: &str| {
        let rest = primitives(r#"{"attributes": {"POSITION": 0}, "indices": 1}"#);
        let good = gltf(&[], "", &rest);
        assert!(good.contains(from), "{from}");
        let error = try_read(good.replacen(from, to, 1).as_bytes()).expect_err(to);
        assert!(error.contains(message), "{error}");
        assert!(error.contains("a.gltf"), "{error}");
        assert_eq!(error.lines().count(), 1, "{error}");
    };
    check(
        "\"2.0\"",
        "\"1.0\"",
        "expected glTF version 2, found \"1.0\"",
    );
    check(
        "\"count\": 4",
        "\"count\": 5",
        "accessors[0]: expected 5 elements 12 bytes apart, from byte 0, found a view of 48 bytes",
    );
    check(
        "\"byteLength\": 52,",
        "\"byteLength\": 53,",
        "buffers[0]: expected 53 bytes, found 52",
    );
    check(
        "\"byteOffset\": 4, \"byteLength\": 48",
        "\"byteOffset\": 5, \"byteLength\": 48",
        "bufferViews[1]: expected a part of the buffer's 52 bytes, found 48 from 5",
    );
    check(
        "\"byteOffset\": 4,",
        "\"byteOffset\": 18446744073709551615,",
        "found 48 from 18446744073709551615",
    );
    check(
        "\"byteLength\": 48",
        "\"byteLength\": 48, \"byteStride\": 4",
        "accessors[0]: expected a stride of 12 bytes or more, found 4",
    );
    check(
        "\"byteLength\": 48",
        "\"byteLength\": 48, \"byteStride\": 18446744073709551615",
        "found a view of 48 bytes",
    );
    check(
        "\"VEC3\"",
        "\"VEC2\"",
        "accessors[0]: expected VEC3, found \"VEC2\"",
    );
    check(
        "5126",
        "5124",
        "expected a component type (5120 to 5123, 5125 or 5126), found 5124",
    );
    check(
        "5121",
        "5120",
        "meshes[0].primitives[0].indices: expected unsigned numbers, found signed ones or fractions",
    );
    check(
        "\"indices\": 1",
        "\"indices\": 7",
        "expected one of the file's accessors, found number 7, of 2 accessors",
    );
    check(
        "\"POSITION\": 0",
        "\"POSITION\": 0, \"NORMAL\": 1",
        "expected VEC3, found \"SCALAR\"",
    );
    check(
        "\"mesh\": 0",
        "\"mesh\": 1",
        "nodes[0]: expected one of the file's meshes, found number 1, of 1 meshes",
    );
    check(
        "{\"mesh\": 0}",
        "{\"children\": [0]}",
        "expected triangles, found no node with a mesh",
    );
    check(
        "[{\"mesh\": 0}]",
        "[{\"mesh\": 0}, {\"children\": [0, 0]}]",
        "nodes[1].children: expected nodes that have no other parent, found node 0, which has another",
    );
    check(
        "\"nodes\": [",
        "\"scenes\": [{\"nodes\": [1]}], \"nodes\": [{\"children\": [1]}, {\"children\": [0]}, ",
        "nodes[1]: expected a node of a tree, found one that is reached twice",
    );
    check(
        "{\"mesh\": 0}",
        "{\"mesh\": 0, \"rotation\": [0, 0, 0, 0]}",
        "nodes[0]: expected a rotation as a quaternion",
    );
    check(
        "{\"mesh\": 0}",
        "{\"mesh\": 0, \"scale\": [1e308, 1, 1], \"children\": [1]}, {\"mesh\": 0, \"scale\": [1e308, 1, 1]}",
        "nodes[1]: expected a placement of finite numbers",
    );
    check(
        "{\"mesh\": 0}",
        "{\"mesh\": 0, \"matrix\": [1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]}",
        "as a matrix's last row, found [1.0, 0.0, 0.0, 1.0]",
    );
    check(
        "\"primitives\": [{",
        "\"primitives\": [{\"mode\": 7, ",
        "meshes[0].primitives[0]: expected a mode from 0 to 6, found 7",
    );
    check(
        "\"primitives\": [{",
        "\"primitives\": [{\"mode\": 0, ",
        "expected triangles, found points and lines alone",
    );
    check(
        "\"primitives\": [{",
        "\"primitives\": [{\"material\": 0, ",
        "expected one of the file's materials, found number 0, of 0 materials",
    );
    check(
        "data:application/octet-stream;base64,",
        "data:application/octet-stream;base64,=",
        "buffers[0]: expected base64",
    );
    check(
        "data:application/octet-stream;base64,",
        "https://host/a?",
        "buffers[0]: expected a file, found \"https://host/a?",
    );
    check(
        "{\"bufferView\": 1, \"componentType\": 5126, \"count\": 4,",
        "{\"componentType\": 5126, \"count\": 53,",
        "at most 52 elements, one for each byte of the buffers, found 53",
    );
    check(
        "\"asset\": {\"version\": \"2.0\"},",
        "\"asset\": {\"version\": 2},",
        "a.gltf:1: invalid type: integer `2`, expected a string (column 23)",
    );
    for (extension, message) in [
        ("KHR_draco_mesh_compression", "Draco compression"),
        ("EXT_meshopt_compression", "meshopt compression"),
        ("EXT_texture_webp", "WebP images"),
        ("KHR_texture_basisu", "KTX2 images"),
        ("FB_ngon", "one that is not known"),
    ] {
        let named = format!(
            "{{\"extensionsRequired\": [\"KHR_mesh_quantization\", \"{extension}\"], \"asset\""
        );
        let message = format!("found \"{extension}\" ({message})");
        check("{\"asset\"", &named, &message);
    }
}

#[test]
fn an_index_beyond_the_vertices_is_named() {
    let rest = primitives(r#"{"attributes": {"POSITION": 2}, "indices": 1}"#);
    let accessors = r#", {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"}"#;
    let error = try_read(gltf(&[], accessors, &rest).as_bytes()).expect_err("a bad index");
    assert_eq!(
        error,
        "a.gltf: meshes[0].primitives[0].indices: expected indices of its 3 vertices, found 3 as number 3"
    );
}

#[test]
fn positions_under_draco_alone_are_named() {
    let primitive = |accessor: &str| {
        let rest = primitives(
            r#"{"attributes": {"POSITION": 2}, "extensions": {"KHR_draco_mesh_compression": {"bufferView": 0}}}"#,
        );
        try_read(gltf(&[], accessor, &rest).as_bytes())
    };
    let error = primitive(r#", {"componentType": 5126, "count": 3, "type": "VEC3"}"#);
    assert_eq!(
        error.expect_err("no positions"),
        "a.gltf: meshes[0].primitives[0]: expected positions in a buffer view, found them under Draco compression alone, \
         which is not read"
    );
    let also = r#", {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"}"#;
    assert!(primitive(also).is_ok());
}
