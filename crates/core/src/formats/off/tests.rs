//! Ground truth: short files whose meshes and messages are written out.

use super::*;

fn parse(text: &str) -> Result<Parsed, String> {
    let read = read(
        Path::new("a.off"),
        text.as_bytes(),
        &Budget::default(),
        &|_| (),
    );
    read.map_err(|error| error.to_string())
}

#[test]
fn keywords() {
    for good in ["OFF", "COFF", "STCN4OFF", "NCOFF", "nOFF", "# a\n\n OFF"] {
        assert!(is_off(good.as_bytes()), "{good}");
    }
    for bad in ["", "off", "OFFF", "XOFF", "CCOFF", "v OFF"] {
        assert!(!is_off(bad.as_bytes()), "{bad}");
    }
}

#[test]
fn counts_and_comments_stand_where_they_like() {
    let body = "0 0 0\n1 0 0 # one\n\n1 1 0\r\n0 1 0\n4 0 1 2 3\n2 0 1\n3 1 2 3\n";
    for head in [
        "OFF\n4 3 0\n",
        "OFF 4 3\n",
        "OFF # all\n# of it\n4\n3\n",
        "4 3 5\n",
    ] {
        let Parsed { mesh, warnings, .. } = parse(&format!("{head}{body}")).expect(head);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [1, 2, 3]], "{head}");
        assert_eq!(mesh.positions[2], DVec3::new(1.0, 1.0, 0.0));
        let message = "a.off: faces of fewer than three corners, which are passed over: 1";
        assert_eq!(warnings, [message]);
    }
}

#[test]
fn faces_may_go_on_in_further_lines() {
    let body = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    let faces = "4 0\n1 # two\n2 3\n3 0 1 2 0.5 0.5 0.5\n3\n1 2 3\n";
    let Parsed { mesh, warnings, .. } = parse(&format!("OFF\n4 3 0\n{body}{faces}")).expect("good");
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2], [1, 2, 3]]);
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn vertices_have_normals_colours_and_texture_coordinates() {
    let vertex = |x: u8, y: u8, color: &str| format!("{x} {y} 0 0 0 2 {color} {x} {y}\n");
    let file = |colors: [&str; 3]| {
        let [a, b, c] = colors;
        let vertices = vertex(0, 0, a) + &vertex(1, 0, b) + &vertex(0, 1, c);
        parse(&format!("STCNOFF\n3 1 0\n{vertices}3 0 1 2\n"))
            .expect("a good file")
            .mesh
    };
    let color = |r, g, b| Some(Color([r, g, b]));
    let mesh = file(["255 0 0 255", "0 128 0", "0 0 1 0"]);
    assert_eq!(
        mesh.colors,
        [color(255, 0, 0), color(0, 128, 0), color(0, 0, 1)]
    );
    assert_eq!(
        mesh.uvs.expect("uvs").values,
        [Vec2::ZERO, Vec2::X, Vec2::Y]
    );
    assert_eq!(mesh.normals.expect("normals").values, [Vec3::Z; 3]);
    let mesh = file(["1 0 0 1", "0 0.5 0", "0 0 1 0"]);
    assert_eq!(
        mesh.colors,
        [color(255, 0, 0), color(0, 128, 0), color(0, 0, 255)]
    );
}

#[test]
fn vertex_values_follow_the_order_of_the_keyword() {
    let vertices = "0 0 0 1 0 0 1 0 3 0\n1 0 0 1 0 0 1 0 3 0\n0 1 0 1 0 0 1 0 3 0\n";
    let mesh = parse(&format!("NCOFF\n3 1 0\n{vertices}3 0 1 2\n")).expect("a good file");
    assert_eq!(mesh.mesh.colors[0], Some(Color([255, 0, 0])));
    assert_eq!(mesh.mesh.normals.expect("normals").values[0], Vec3::Y);
}

#[test]
fn faces_have_colours() {
    let vertices = "OFF\n4 4 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    let faces = |colors: [&str; 4]| {
        let [a, b, c, d] = colors;
        let text = format!("{vertices}4 0 1 2 3 {a}\n3 0 1 2 {b}\n3 0 1 3 {c}\n3 1 2 3 {d}\n");
        parse(&text).expect("a good file")
    };
    let parsed = faces(["255 0 0", "", "7", "0 0 255 9"]);
    let colors: Vec<_> = parsed.mesh.materials.iter().map(|m| m.color).collect();
    assert_eq!(colors, [Color([255, 0, 0]), Color([0, 0, 255])]);
    assert_eq!(
        parsed.mesh.material_of_triangle,
        [0, 0, u32::MAX, u32::MAX, 1]
    );
    assert_eq!(parsed.notes, ["not used: numbers of colours of 1 faces"]);
    let parsed = faces(["1.0 0.5 0", "1 2", "", ""]);
    assert_eq!(parsed.mesh.materials[0].color, Color([255, 128, 0]));
    let message = "a.off: vertices and faces with more numbers than there is a use for: 1";
    assert_eq!(parsed.warnings, [message]);
}

#[test]
fn says_where_and_what() {
    let check = |text: &str, expected: &str| {
        assert_eq!(
            parse(text).expect_err("a bad file"),
            format!("a.off{expected}")
        );
    };
    let body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    check(
        "OFF BINARY\n1 2 3",
        ":1: expected an OFF as text, found a binary OFF, which is not read",
    );
    check(
        "4OFF\n1",
        ":1: expected an OFF of three dimensions, found \"4OFF\"",
    );
    check(
        "OFF\n3 x 0\n",
        ":2: expected the counts of vertices and faces, found \"x\"",
    );
    check(
        "OFF\n",
        ":1: expected the counts of vertices and faces, found the file's end: it is cut short",
    );
    check(
        &format!("OFF\n9999999 1 0\n{body}"),
        ":2: expected 9999999 vertices and 1 faces, found 29 bytes for them: it is cut short",
    );
    check(
        "OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n",
        ":4: expected 3 numbers of a vertex, found 2",
    );
    check(
        "OFF\n3 1 0\n0 0 0\n1 0 z\n0 1 0\n3 0 1 2\n",
        ":4: expected 3 numbers of a vertex, found \"z\"",
    );
    let face = "a face: its count of corners, and as many vertex indices";
    for (line, found) in [("3 0 1", "3 numbers"), ("-3 0 1 2", "4 numbers")] {
        check(
            &format!("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n{line}\n"),
            &format!(":6: expected {face}, found {found}"),
        );
    }
    check(
        &format!("OFF\n3 2 0\n{body}"),
        &format!(":6: expected {face}, found the file's end: it is cut short"),
    );
    // What is missing in one line is not taken from the next.
    check(
        "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n3 0 1 2\n",
        &format!(":6: expected {face}, found 3 numbers"),
    );
    for bad in ["3", "-1", "0.5"] {
        check(
            &format!("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 {bad}\n"),
            &format!(":6: expected vertex indices from 0 to 2, found {bad}"),
        );
    }
    check(
        "OFF\n1 1 0\n0 0 0\n1 0\n",
        ": expected faces, found 1 of fewer than three corners",
    );
    check("OFF\n1 0 0\n0 0 0\n", ": expected faces, found none");
}
