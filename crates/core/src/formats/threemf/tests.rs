use crate::formats::LengthUnit;
use crate::formats::limits::{Budget, Limits};
use crate::formats::placed_meshes::PlacedMeshes;
use crate::scene::{Color, MeshData};
use glam::DVec3;
use std::io::{Cursor, Write};
use std::path::Path;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

const RELATIONSHIPS: &str = r#"<?xml version="1.0"?><Relationships
 xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="a" Target="/3D/m.model"
 Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"#;

/// An archive of these parts.
fn archive(parts: &[(&str, &str)]) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in parts {
        writer
            .start_file(*name, SimpleFileOptions::default())
            .and_then(|()| Ok(writer.write_all(text.as_bytes())?))
            .expect("a part can be written");
    }
    writer
        .finish()
        .expect("an archive can be written")
        .into_inner()
}

fn model(resources: &str, build: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<model unit=\"inch\" xmlns=\"http://schemas.microsoft.com/\
         3dmanufacturing/core/2015/02\" xmlns:m=\"x/material/y\" xmlns:p=\"x/production/y\">\n\
         <resources>\n{resources}\n</resources>\n<build>\n{build}\n</build>\n</model>"
    )
}

/// A triangle as object `id`, with attributes of the object and of the triangle.
fn object(id: u32, of_object: &str, of_triangle: &str) -> String {
    format!(
        "<object id=\"{id}\" {of_object}><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/>\
         <vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"1\" z=\"0\"/></vertices>\
         <triangles><triangle v1=\"0\" v2=\"1\" v3=\"2\" {of_triangle}/></triangles></mesh></object>"
    )
}

fn read_bytes(bytes: &[u8], budget: &Budget) -> Result<PlacedMeshes, String> {
    super::read(Path::new("a.3mf"), bytes, budget, &|_| ()).map_err(|error| error.to_string())
}

fn read(model: &str) -> Result<PlacedMeshes, String> {
    let bytes = archive(&[("_rels/.rels", RELATIONSHIPS), ("3D/m.model", model)]);
    read_bytes(&bytes, &Budget::default())
}

#[test]
fn items_and_components_are_nodes_depth_first() {
    let resources = [
        object(1, "name=\"one\"", ""),
        object(2, "", ""),
        "<object id=\"3\"><components><component objectid=\"2\" transform=\"0 1 0 -1 0 0 0 0 1 5 0 0\"/>\
         <component objectid=\"1\"/></components></object>"
            .to_owned(),
        object(4, "", ""),
    ];
    let build =
        "<item objectid=\"1\"/><item objectid=\"3\" transform=\"2 0 0 0 2 0 0 0 2 0 0 1\"/>";
    let placed = read(&model(&resources.join("\n"), build)).expect("a good file");
    let names: Vec<&str> = placed.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!(names, ["one", "a 2", "one"]);
    let meshes: Vec<usize> = placed.nodes.iter().map(|node| node.mesh).collect();
    assert_eq!(meshes, [0, 1, 0]);
    let at =
        |node: usize, point: DVec3| placed.nodes[node].world_from_object.transform_point3(point);
    assert_eq!(at(0, DVec3::ONE), DVec3::ONE);
    // x becomes y, y becomes −x, 5 along x; then twice as large, and 1 up.
    assert_eq!(at(1, DVec3::X), DVec3::new(10.0, 2.0, 1.0));
    assert_eq!(at(1, DVec3::Y), DVec3::new(8.0, 0.0, 1.0));
    assert_eq!(at(2, DVec3::X), DVec3::new(2.0, 0.0, 1.0));
    assert_eq!(placed.meshes.len(), 2);
    assert_eq!(placed.unit, Some(LengthUnit::Inch));
    assert_eq!(
        placed.notes,
        [
            "unit: inch; up axis: Z",
            "not used: meshes that are not built (1)"
        ]
    );
    assert!(placed.warnings.is_empty());
}

#[test]
fn parts_have_numbers_of_their_own() {
    let root = model(
        &object(1, "name=\"root\"", ""),
        "<item objectid=\"1\" p:path=\"/3D/Other.model\"/><item objectid=\"1\"/>",
    );
    let other = model(&object(1, "name=\"other &amp; more\"", ""), "");
    let bytes = archive(&[
        ("_rels/.rels", RELATIONSHIPS),
        ("3D/m.model", &root),
        ("3D/other.model", &other),
    ]);
    let placed = read_bytes(&bytes, &Budget::default()).expect("a good file");
    let names: Vec<&str> = placed.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!(names, ["other & more", "root"]);
}

#[test]
fn triangles_have_the_colours_of_groups_and_base_materials() {
    let groups = "<basematerials id=\"5\"><base name=\"red\" displaycolor=\"#ff0000\"/>\
        <base name=\"blue\" displaycolor=\"#0000FFff\"/></basematerials>\
        <m:colorgroup id=\"6\"><m:color color=\"#00ff0080\"/></m:colorgroup>\
        <m:texture2dgroup id=\"7\" texid=\"8\"><m:tex2coord u=\"0\" v=\"0\"/></m:texture2dgroup>";
    let color = |of_object: &str, of_triangle: &str| {
        let resources = format!("{}{groups}", object(1, of_object, of_triangle));
        let placed = read(&model(&resources, "<item objectid=\"1\"/>")).expect("a good file");
        let mesh = &placed.meshes[0];
        let number = mesh.material_of_triangle.first().copied();
        let material = number.and_then(|number| mesh.materials.get(number as usize));
        (material.map(|material| material.color), placed)
    };
    let [red, green, blue] = [[255, 0, 0], [0, 255, 0], [0, 0, 255]].map(|c| Some(Color(c)));
    assert_eq!(color("", "").0, None);
    assert_eq!(color("pid=\"5\" pindex=\"1\"", "").0, blue);
    assert_eq!(color("pid=\"5\" pindex=\"1\"", "p1=\"0\"").0, red);
    assert_eq!(
        color("pid=\"5\" pindex=\"1\"", "pid=\"7\" p1=\"0\"").0,
        None
    );
    let (found, placed) = color("pid=\"5\"", "pid=\"6\" p1=\"0\" p2=\"0\" p3=\"0\"");
    assert_eq!(found, green);
    assert_eq!(
        placed.notes[1],
        "not used: groups of textures or mixtures (1), opacity of colours (1)"
    );
    let (found, placed) = color("", "pid=\"5\" p1=\"0\" p2=\"1\" p3=\"0\"");
    assert_eq!(found, red);
    let message =
        "a.3mf: triangles whose corners have different materials, of which the first is shown: 1";
    assert_eq!(placed.warnings, [message]);
}

#[test]
fn colours_of_corners_are_those_of_vertices() {
    let colors = "<m:colorgroup id=\"6\"><m:color color=\"#ff0000\"/><m:color color=\"#00ff00\"/>\
        <m:color color=\"#0000ff\"/></m:colorgroup>";
    let triangles = |more: &str| {
        format!(
            "<object id=\"1\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/>\
             <vertex x=\"0\" y=\"1\" z=\"0\"/><vertex x=\"0\" y=\"0\" z=\"1\"/></vertices><triangles>\
             <triangle v1=\"0\" v2=\"1\" v3=\"2\" pid=\"6\" p1=\"0\" p2=\"1\" p3=\"2\"/>\
             <triangle v1=\"0\" v2=\"2\" v3=\"3\" pid=\"6\" p1=\"1\" p2=\"2\"/>{more}</triangles></mesh></object>{colors}"
        )
    };
    let mesh = |more: &str| {
        let text = model(&triangles(more), "<item objectid=\"1\"/>");
        let placed = read(&text).expect("a good file");
        assert!(placed.warnings.is_empty(), "{:?}", placed.warnings);
        placed.meshes.into_iter().next().expect("a mesh")
    };
    let shown = |mesh: &MeshData, triangle: usize| {
        let corners = mesh.triangles[triangle];
        let corner = |vertex: u32| {
            let color = mesh.colors.get(vertex as usize).copied().flatten();
            (mesh.positions[vertex as usize].to_array(), color)
        };
        (
            corners.map(corner),
            mesh.material_of_triangle[triangle] == u32::MAX,
        )
    };
    let [red, green, blue] = [[255, 0, 0], [0, 255, 0], [0, 0, 255]].map(|c| Some(Color(c)));
    let [o, x, y, z] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let first = ([(o, red), (x, green), (y, blue)], true);
    let second = ([(o, green), (y, blue), (z, green)], true);
    let plain = mesh("");
    assert_eq!((shown(&plain, 0), shown(&plain, 1)), (first, second));
    assert_eq!(
        plain.positions.len(),
        5,
        "the corner with two colours is doubled"
    );
    // Neither a triangle of one colour nor one without any takes those of its vertices.
    let one_color = mesh("<triangle v1=\"1\" v2=\"2\" v3=\"3\" pid=\"6\" p1=\"0\"/>");
    assert_eq!(
        (shown(&one_color, 0), shown(&one_color, 1)),
        (first, second)
    );
    assert_eq!(
        one_color.materials[one_color.material_of_triangle[2] as usize].color,
        Color([255, 0, 0])
    );
    let bare = mesh("<triangle v1=\"1\" v2=\"2\" v3=\"3\"/>");
    assert_eq!((shown(&bare, 0), shown(&bare, 1)), (first, second));
    assert_eq!(shown(&bare, 2), ([(x, None), (y, None), (z, None)], true));
}

#[test]
fn says_where_and_what() {
    let check = |resources: &str, build: &str, message: &str| {
        let error = read(&model(resources, build)).expect_err(message);
        assert_eq!(error, format!("a.3mf: {message}"));
    };
    let (good, item) = (object(1, "", ""), "<item objectid=\"1\"/>");
    assert!(read(&model(&good, item)).is_ok());
    let part = "\"3D/m.model\"";
    check(&good, "", "expected triangles, found nothing that is built");
    check(
        &good,
        "\n<item/>",
        &format!("{part}, line 8: expected `objectid` of an element, found \"item\" without"),
    );
    check(
        &good,
        "<item objectid=\"2\"/>",
        &format!("{part}, line 7: expected the number of an object, found 2"),
    );
    check(
        &good,
        "<item objectid=\"1\" transform=\"1 2\"/>",
        &format!("{part}, line 7: expected twelve numbers as a transform, found \"1 2\""),
    );
    check(
        &good.replace("x=\"1\"", "x=\"one\""),
        item,
        &format!("{part}, line 4: expected a number, found \"one\""),
    );
    check(
        &good.replace("z=\"0\"", ""),
        item,
        &format!("{part}, line 4: expected a vertex with x, y and z, found one without"),
    );
    check(
        &good.replace("v3=\"2\"", "v3=\"3\""),
        item,
        &format!("{part}, line 4: expected the number of one of 3 vertices, found 3"),
    );
    check(
        &good.replace("v3=\"2\"", "v3=\"-1\""),
        item,
        &format!("{part}, line 4: expected a whole number, found \"-1\""),
    );
    check(
        &object(1, "", "pid=\"9\" p1=\"0\""),
        item,
        &format!(
            "{part}, line 4: expected object 1 to name groups of colours or materials, found 9"
        ),
    );
    let group = "<m:colorgroup id=\"9\"><m:color color=\"#FF0000\"/></m:colorgroup>";
    check(
        &format!("{group}\n{}", object(1, "", "pid=\"9\" p1=\"1000000\"")),
        item,
        &format!(
            "{part}, line 5: expected object 1 to name one of group 9's 1 colours, found number 1000000"
        ),
    );
    check(
        &format!("{}\n{good}", group.replace("#FF0000", "red")),
        item,
        &format!("{part}, line 4: expected a colour as #RRGGBB or #RRGGBBAA, found \"red\""),
    );
    let twice = format!("{good}\n{good}");
    check(
        &twice,
        item,
        &format!("{part}, line 5: expected a number that no other object has, found 1 once more"),
    );
    let cycle = "<object id=\"2\"><components><component objectid=\"3\"/></components></object>\n\
        <object id=\"3\"><components><component objectid=\"2\"/></components></object>";
    check(
        cycle,
        "<item objectid=\"2\"/>",
        &format!("{part}, line 5: object 2 is a part of itself"),
    );
    check(
        &good,
        "<item objectid=\"1\" p:path=\"/3D/none.model\"/>",
        "\"/3D/none.model\": there is no such part",
    );
}

#[test]
fn broken_files_are_refused_in_one_line() {
    let good = model(&object(1, "", ""), "<item objectid=\"1\"/>");
    for (from, to, message) in [
        ("</mesh>", "</mash>", "line 4"),
        ("</model>", "", "found the part's end"),
        (
            "<model unit",
            "<modal unit",
            "line 9: expected a model, found none",
        ),
        (
            "unit=",
            "requiredextensions=\"q\" xmlns:q=\"x/slice/y\" unit=",
            "but those that are read, found \"x/slice/y\"",
        ),
        ("x=\"1\"", "x=\"&a;\" y=\"1\"", "line 4"),
        ("x=\"1\"", "x='1", "line"),
    ] {
        let mut broken = good.replacen(from, to, 1);
        if to.starts_with("<modal") {
            broken = broken.replace("</model>", "</modal>");
        }
        let error = read(&broken).expect_err(message);
        assert!(error.contains(message), "{error}");
        assert_eq!(error.lines().count(), 1, "{error}");
    }
    let budget = Budget::default();
    let none = archive(&[("3D/m.model", &good)]);
    let error = read_bytes(&none, &budget).expect_err("no relationships");
    assert_eq!(error, "a.3mf: \"_rels/.rels\": there is no such part");
    let bytes = archive(&[("_rels/.rels", RELATIONSHIPS), ("3D/m.model", &good)]);
    for end in 0..bytes.len() {
        assert!(read_bytes(&bytes[..end], &budget).is_err(), "{end} bytes");
    }
}

/// The size to which a small archive expands is counted before memory is allocated.
#[test]
fn bombs_stay_within_the_limits() {
    let limits = Limits {
        bytes: 8 << 20,
        ..Limits::default()
    };
    let long = model(&" ".repeat(16 << 20), "");
    let bytes = archive(&[("_rels/.rels", RELATIONSHIPS), ("3D/m.model", &long)]);
    assert!(bytes.len() < 100_000);
    let error = read_bytes(&bytes, &Budget::new(limits)).expect_err("a bomb");
    assert!(error.contains("(limit `bytes`)"), "{error}");
    // Each object consists of two of the one before.
    let double = |id: u32| {
        let below = id - 1;
        let component = format!("<component objectid=\"{below}\"/>");
        format!("<object id=\"{id}\"><components>{component}{component}</components></object>")
    };
    let doubled: String = (2..60).map(double).collect();
    for first in [
        object(1, "", ""),
        "<object id=\"1\"><components/></object>".to_owned(),
    ] {
        let error =
            read(&model(&(first + &doubled), "<item objectid=\"59\"/>")).expect_err("a bomb");
        assert!(
            error.contains("more than 1048576 items and components"),
            "{error}"
        );
    }
    let limits = Limits {
        triangles: 2,
        ..Limits::default()
    };
    let many = (1..5).map(|id| object(id, "", "")).collect::<String>();
    let bytes = archive(&[
        ("_rels/.rels", RELATIONSHIPS),
        ("3D/m.model", &model(&many, "")),
    ]);
    let error = read_bytes(&bytes, &Budget::new(limits)).expect_err("too many");
    assert!(
        error.contains("more triangles than the 2 that are left"),
        "{error}"
    );
}
