use super::*;
use crate::scene::{Color, ScalarAt};
use glam::{DVec3, Vec2};

fn parse(bytes: &[u8]) -> Result<Parsed, String> {
    let read = read(Path::new("a/b.ply"), bytes, &Budget::default(), &|_| ());
    read.map_err(|error| error.to_string())
}

/// Every property that is read, and one that is not.
const HEADER: &str = "ply\nformat FORMAT 1.0\ncomment TextureFile skin.png\nelement vertex 5\n\
    property double x\nproperty float y\nproperty short z\nproperty uchar red\nproperty uchar green\n\
    property uchar blue\nproperty uchar alpha\nproperty float nx\nproperty float ny\nproperty float nz\n\
    property float u\nproperty float v\nelement edge 1\nproperty int a\nproperty list uchar char b\n\
    element face 2\nproperty ushort flag\nproperty list ushort uint vertex_index\nend_header\n";

const VERTICES: [[f64; 12]; 5] = [
    [0.1, 0., 0., 255., 0., 0., 7., 0., 0., 2., 0., 0.],
    [2., 0., 0., 0., 255., 0., 7., 0., 0., 1., 1., 0.],
    [2., 2., 0., 0., 0., 255., 7., 0., 1., 1., 1., 1.],
    [0., 2., 0., 9., 9., 9., 7., 0., 0., 1., 0., 1.],
    [1., 1., -3., 9., 9., 9., 7., 0., 0., 0., 0.5, 0.5],
];

fn ascii() -> Vec<u8> {
    let mut text = HEADER.replace("FORMAT", "ascii");
    for vertex in VERTICES {
        let words: Vec<String> = vertex.iter().map(f64::to_string).collect();
        text += &(words.join(" ") + "\n");
    }
    (text + "1 2 5 -6\n3 4 0 1 2 3\n3 3 0 1 4").into_bytes()
}

fn binary(big: bool) -> Vec<u8> {
    let format = if big {
        "binary_big_endian"
    } else {
        "binary_little_endian"
    };
    let mut bytes = HEADER.replace("FORMAT", format).into_bytes();
    let mut put = |little: &[u8]| {
        let mut number = little.to_vec();
        if big {
            number.reverse();
        }
        bytes.extend(number);
    };
    for vertex in VERTICES {
        for (index, value) in vertex.into_iter().enumerate() {
            match index {
                0 => put(&value.to_le_bytes()),
                2 => put(&(value as i16).to_le_bytes()),
                3..7 => put(&[value as u8]),
                _ => put(&(value as f32).to_le_bytes()),
            }
        }
    }
    put(&1i32.to_le_bytes());
    for byte in [2, 5, 250] {
        put(&[byte]);
    }
    for face in [&[0u32, 1, 2, 3][..], &[0, 1, 4]] {
        put(&3u16.to_le_bytes());
        put(&(face.len() as u16).to_le_bytes());
        for corner in face {
            put(&corner.to_le_bytes());
        }
    }
    bytes
}

#[test]
fn all_encodings_are_one_mesh() {
    for (bytes, encoding) in [
        (ascii(), "ASCII"),
        (binary(false), "binary, little-endian"),
        (binary(true), "binary, big-endian"),
    ] {
        let Parsed {
            mesh,
            texture,
            warnings,
            notes,
        } = parse(&bytes).expect(encoding);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 4]]);
        assert_eq!(mesh.positions[4], DVec3::new(1.0, 1.0, -3.0));
        assert_eq!(mesh.positions[0].x, 0.1, "double precision stays");
        assert_eq!(mesh.colors[2], Some(Color([0, 0, 255])));
        let normals = mesh.normals.expect("normals");
        assert_eq!(normals.values[0], Vec3::Z);
        assert_eq!(normals.indices, Some(vec![[0, 1, 2], [0, 2, 3], [NONE; 3]]));
        let uvs = mesh.uvs.expect("texture coordinates");
        assert_eq!((uvs.values[4], uvs.indices), (Vec2::splat(0.5), None));
        assert_eq!(texture.as_deref(), Some(Path::new("a/skin.png")));
        let alpha = &mesh.scalars[0];
        assert_eq!((&*alpha.name, alpha.at), ("alpha", ScalarAt::Vertices));
        assert_eq!(alpha.values, [7.0; 5]);
        let flag = &mesh.scalars[1];
        assert_eq!((&*flag.name, flag.at), ("flag", ScalarAt::Triangles));
        assert_eq!(flag.values, [3.0; 3]);
        assert_eq!(warnings, [""; 0]);
        let expected = [
            encoding,
            "scalars of vertices: alpha",
            "not used: 1 of element edge",
            "scalars of faces: flag",
        ];
        assert_eq!(notes, expected);
    }
}

const TRIANGLE: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n\
    property float y\nproperty float z\nelement face 1\n\
    property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

/// The triangle as a binary file, with this face.
fn binary_triangle(face: &[u8]) -> Vec<u8> {
    let (header, _) = TRIANGLE.split_once("0 0 0").expect("a body");
    let mut bytes = header.replace("ascii", "binary_little_endian").into_bytes();
    for float in [0f32, 0., 0., 1., 0., 0., 0., 1., 0.] {
        bytes.extend(float.to_le_bytes());
    }
    bytes.extend(face);
    bytes
}

#[test]
fn scalars_of_triangles_alone_are_those_of_any_faces() {
    let header = "element face 2\nproperty float before\n\
        property list uchar int vertex_indices\nproperty double after";
    let with = |format: &str| {
        let (head, _) = TRIANGLE.split_once("0 0 0").expect("a body");
        let list = "element face 1\nproperty list uchar int vertex_indices";
        head.replace(list, header).replace("ascii", format)
    };
    let text = with("ascii") + "0 0 0\n1 0 0\n0 1 0\n1.5 3 0 1 2 -4\n2.5 3 0 2 1 7\n";
    let mut bytes = with("binary_little_endian").into_bytes();
    for float in [0f32, 0., 0., 1., 0., 0., 0., 1., 0.] {
        bytes.extend(float.to_le_bytes());
    }
    for (before, list, after) in [(1.5f32, [0, 1, 2], -4f64), (2.5, [0, 2, 1], 7.0)] {
        bytes.extend(before.to_le_bytes());
        bytes.push(3);
        bytes.extend(list.map(i32::to_le_bytes).as_flattened());
        bytes.extend(after.to_le_bytes());
    }
    for bytes in [text.into_bytes(), bytes] {
        let scalars = parse(&bytes).expect("a good file").mesh.scalars;
        let found: Vec<_> = scalars.iter().map(|s| (&*s.name, &*s.values)).collect();
        let expected = [("before", &[1.5f32, 2.5][..]), ("after", &[-4.0, 7.0])];
        assert_eq!(found, expected);
    }
}

#[test]
fn a_name_of_vertices_and_faces_both_is_two_scalars() {
    let text = TRIANGLE
        .replace(
            "property float z",
            "property float z\nproperty float quality",
        )
        .replace("vertex_indices", "vertex_indices\nproperty float quality")
        .replace(
            "0 0 0\n1 0 0\n0 1 0\n3 0 1 2",
            "0 0 0 1\n1 0 0 2\n0 1 0 3\n3 0 1 2 9",
        );
    let scalars = parse(text.as_bytes()).expect("a good file").mesh.scalars;
    let found: Vec<_> = scalars.iter().map(|s| (&*s.name, &*s.values)).collect();
    let expected = [
        ("quality", &[1.0f32, 2.0, 3.0][..]),
        ("quality of faces", &[9.0]),
    ];
    assert_eq!(found, expected);
}

#[test]
fn triangles_alone_are_read_as_any_faces_are() {
    let face = [3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0];
    let parsed = parse(&binary_triangle(&face)).expect("a good file");
    assert_eq!(parsed.mesh.triangles, [[0, 1, 2]]);
    let two = "element face 2";
    let faces = "3 0 1 2\n4 0 1 2 1\n";
    let text = TRIANGLE
        .replace("element face 1", two)
        .replace("3 0 1 2\n", faces);
    let parsed = parse(text.as_bytes()).expect("a good file");
    assert_eq!(parsed.mesh.triangles.len(), 3);
}

#[test]
fn faces_have_colours_and_texture_coordinates() {
    let text = TRIANGLE
        .replace("element face 1", "element face 4")
        .replace(
            "indices\n",
            "indices\nproperty list uchar float texcoord\nproperty float red\n\
            property float green\nproperty float blue\n",
        )
        .replace(
            "3 0 1 2\n",
            "3 0 1 2 6 0 0 1 0 0 0.5 1 0 0.5\n2 0 1 0 0 0 0\n\
            3 2 1 0 0 1 0 0.5\n3 1 2 0 6 0 0 1e300 0 0 0.5 1 0 0.5\n",
        );
    let Parsed { mesh, warnings, .. } = parse(text.as_bytes()).expect("a good file");
    let uvs = mesh.uvs.expect("texture coordinates");
    assert_eq!(uvs.values[2], Vec2::new(0.0, 0.5));
    assert_eq!(uvs.indices, Some(vec![[0, 1, 2], [NONE; 3], [NONE; 3]]));
    assert_eq!(mesh.material_of_triangle, [0, 0, 0]);
    assert_eq!(mesh.materials[0].color, Color([255, 0, 128]));
    let message = "a/b.ply: faces of fewer than three corners, which are passed over: 1";
    assert_eq!(warnings, [message]);
}

#[test]
fn strips_turn_every_second_triangle() {
    let text = TRIANGLE
        .replace("element face 1", "element tristrips 1")
        .replace("uchar int", "int int")
        .replace("3 0 1 2\n", "8 0 1 2 0 -1 2 1 0\n");
    let Parsed { mesh, .. } = parse(text.as_bytes()).expect("a good file");
    assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 0], [2, 1, 0]]);
}

#[test]
fn says_where_and_what() {
    let check = |bytes: &[u8], expected: &str| {
        assert_eq!(
            parse(bytes).expect_err("a bad file"),
            format!("a/b.ply{expected}")
        );
    };
    let edit = |from: &str, to: &str| {
        assert_eq!(TRIANGLE.matches(from).count(), 1, "{from}");
        TRIANGLE.replace(from, to).into_bytes()
    };
    check(
        &edit("1 0 0\n", "1 x 0\n"),
        ":11: expected a number of element vertex, found \"x\"",
    );
    check(
        &edit("3 0 1 2\n", "3 0 1"),
        ":13: expected a list of vertex indices, found the file's end: it is cut short",
    );
    check(
        &edit("3 0 1 2\n", "3 0 1 3\n"),
        ":13: expected vertex indices from 0 to 2, found another in the list that ends here",
    );
    check(
        &edit("3 0 1 2\n", "3 0 1 -1\n"),
        ":13: expected vertex indices from 0 to 2, found another in the list that ends here",
    );
    check(
        &edit("vertex 3", "vertex 3000000"),
        ":10: expected 3000000 of element vertex, found 25 bytes for them: it is cut short",
    );
    check(
        &edit("vertex 3", "vertex 99999999999"),
        ": expected fewer than 4294967295 vertices, found 99999999999",
    );
    check(
        &edit("float z", "float w"),
        ":3: expected vertices with properties `x`, `y` and `z`, found \"x y w\"",
    );
    check(
        &edit("vertex_indices", "corners"),
        ":7: expected faces with a list `vertex_indices` or `vertex_index`, found \"corners\"",
    );
    check(
        &edit("face 1", "face 0"),
        ": expected faces, found none: it has 3 points alone, which are not shown",
    );
    let start = binary_triangle(&[]).len();
    let cut = binary_triangle(&[3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0]);
    check(
        &cut,
        &format!(
            ": expected a list of vertex indices at byte {}, found the file's end: it is cut short",
            start + 9
        ),
    );
    check(
        &binary_triangle(&[3, 0, 0, 0, 0, 1, 0, 0, 0, 9, 0, 0, 0]),
        &format!(
            ": expected vertex indices from 0 to 2 at byte {}, found another in the list that ends here",
            start + 13
        ),
    );
    check(
        &edit("element face 1", "element fa\u{1}ce 2"),
        ":13: expected a number of element \"fa\\u{1}ce\", found the file's end: it is cut short",
    );
    let longer = binary_triangle(&[3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 9]);
    let message = "a/b.ply: bytes behind its last element, which are passed over: 1";
    assert_eq!(parse(&longer).expect("a good file").warnings, [message]);
}

#[test]
fn damaged_files_never_panic() {
    for bytes in [ascii(), binary(false), binary(true)] {
        for end in 0..bytes.len() {
            let _ = parse(&bytes[..end]);
            let mut changed = bytes.clone();
            for byte in [0, b'9', 255] {
                changed[end] = byte;
                let _ = parse(&changed);
            }
        }
    }
}
