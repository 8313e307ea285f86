//! What scene files say, what is wrong with them, and what is saved.

use super::scene_file::SceneFile;
use super::scene_objects::ANCESTOR_LIMIT;
use super::*;
use crate::camera::{Curve, Ease, Projection};
use crate::scene::{Color, ColorRule, Object, Shape, UpAxis, Wrap};
use crate::shade::{Background, Filter, Mode, Shading, TextureProjection, Wireframe};
use glam::DVec3;
use std::path::{Path, PathBuf};

const WHOLE: &str = r##"# A scene with everything.
[camera]
projection = "perspective"
eye = [3, 2.5, 5]
target = [0, 0, 0.1]
up = [0.0, 1.0, 0.0]
fov = 40.0

[image]
size = [1280, 720]
samples = 4
background = ["#20242c", "#3A4454"]

[shading]
mode = "barycentric"
wireframe = true
wireframe-width = 1.3
blend = 0.7
filter = "nearest"
texture-projection = "triplanar"

[[object]]
name = "moon"
mesh = "./parts/a.obj"
color = "per-triangle"
seed = 3
texture = "t.ppm"
translate = [4, 0, 0]
parent = "planet"

[[object]]
name = "planet"
mesh = "parts/a.obj"
color = "#ff8000"
rotate = [0, 90, 0]
scale = [1, 2, -1]

[[object]]
mesh = "b.txt"
texture = "t.ppm"
"##;

fn files(name: &str) -> Option<Vec<u8>> {
    match name {
        "parts/a.obj" => Some("mtllib a.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3".into()),
        "parts/a.mtl" => Some("newmtl x\nKd 0 1 0".into()),
        "b.txt" => Some("(0,0,0);(1,0,0);(0,1,0)".into()),
        "wide.ppm" => Some("P3\n4 1\n255\n1 2 3 4 5 6 7 8 9 10 11 12\n".into()),
        "t.ppm" => Some("P3\n1 1\n255\n1 2 3\n".into()),
        "bad.obj" => Some("v 0 0 0\nf 1 2 3\n".into()),
        _ => None,
    }
}

fn parse(text: &str) -> SceneFile {
    read_scene_from(text, &files).expect("a good scene")
}

#[test]
fn reads_everything() {
    let file = parse(WHOLE);
    let camera = file.camera.expect("a camera");
    assert_eq!(camera.placement.eye, DVec3::new(3.0, 2.5, 5.0));
    assert_eq!(camera.placement.target, DVec3::new(0.0, 0.0, 0.1));
    assert_eq!(
        (camera.projection, camera.frame),
        (Projection::Perspective, 40.0)
    );
    assert_eq!(file.image.size, Some((1280, 720)));
    assert_eq!(file.image.samples, Some(4));
    let shading = Shading {
        mode: Mode::Barycentric,
        wireframe: Some(Wireframe {
            width: 1.3,
            ..Wireframe::default()
        }),
        background: Background::default(),
        blend: 0.7,
        filter: Filter::Nearest,
        projection: TextureProjection::Triplanar,
        scale: None,
    };
    assert_eq!(file.shading, Some(shading));
    let [moon, planet, plain] = &file.scene.objects[..] else {
        panic!("three objects");
    };
    assert_eq!((moon.parent, planet.parent), (Some(1), None));
    assert_eq!(moon.color, ColorRule::PerTriangle { seed: 3 });
    assert_eq!(planet.color, ColorRule::Uniform(Color([255, 128, 0])));
    assert_eq!(planet.transform.scale, DVec3::new(1.0, 2.0, -1.0));
    assert_eq!(plain.name, "b");
    assert!(Arc::ptr_eq(&moon.mesh, &planet.mesh), "one mesh, read once");
    let image = |object: &Object| object.texture.clone().expect("a texture");
    assert!(Arc::ptr_eq(&image(moon), &image(plain)));
    assert_eq!(moon.source.as_deref(), Some(Path::new("parts/a.obj")));
    assert_eq!(moon.mesh.materials()[0].color, Color([0, 255, 0]));
}

#[test]
fn an_object_says_what_is_up_in_its_file() {
    let text = "[[object]]\nmesh = \"b.txt\"\n[[object]]\nmesh = \"b.txt\"\nup-axis = \"z\"\n";
    let file = parse(text);
    let corner = |index: usize| file.scene.objects[index].mesh.corners(0).expect("corners")[2];
    assert_eq!(corner(0), glam::Vec3::Y);
    assert_eq!(corner(1), glam::Vec3::NEG_Z);
    let saved = file
        .to_toml(Path::new("/nowhere"))
        .expect("it can be saved");
    assert_eq!(saved.matches("up-axis").count(), 1, "{saved}");
    let again = parse(&saved);
    assert_eq!(again.scene.content(), file.scene.content());
    assert_eq!(again.scene.objects[1].up_axis, UpAxis::Z);
    assert!(
        file.notes[1].ends_with("z is taken to be up"),
        "{:?}",
        file.notes
    );
}

#[test]
fn a_file_of_a_newer_version_is_refused_as_that_whatever_else_it_holds() {
    let saved = parse(WHOLE).to_toml(Path::new("/nowhere"));
    let saved = saved.expect("it can be saved");
    assert!(saved.starts_with("version = 1\n"), "{saved}");
    assert_eq!(parse(&saved).scene.content(), parse(WHOLE).scene.content());
    assert!(super::kind::is_scene(Path::new("-"), saved.as_bytes()));
    let of = |version: &str, more: &str| {
        let text = format!("# A scene.\nversion = {version}\n{more}");
        let read = read_scene_from(&text, &files);
        read.map_err(|error| error.to_string())
    };
    assert!(of("1", "[camera]\neye = [0, 0, 1]\ntarget = [0, 0, 0]\n").is_ok());
    for version in ["2", "0", "-1"] {
        for more in ["", "[weather]\nrain = true\n"] {
            let told = format!(
                "scene:2: expected a scene file of version 1, which this program reads, found version {version}"
            );
            assert_eq!(of(version, more).expect_err(version), told);
        }
    }
    for (version, more, expected) in [
        (
            "1",
            "[weather]\nrain = true\n",
            "scene:3: unknown field `weather`",
        ),
        ("\"one\"", "", "scene:2: invalid type"),
    ] {
        let told = of(version, more).expect_err(version);
        assert!(told.starts_with(expected), "{told}");
    }
}

#[test]
fn what_is_left_out_is_left_to_the_caller() {
    let file = parse("");
    let nothing = "scene: the scene has no objects: there is nothing to see";
    assert_eq!(file.warnings, [nothing]);
    assert!(file.camera.is_none() && file.shading.is_none() && file.scene.objects.is_empty());
    assert_eq!(file.image, ImageSettings::default());
    let file = parse("[image]\nbackground = \"transparent\"\n");
    let shading = Shading {
        background: Background::Transparent,
        ..Shading::default()
    };
    assert_eq!(file.shading, Some(shading));
}

#[test]
fn says_where_and_what() {
    let check = |text: &str, place: &str, what: &str| {
        let message = read_scene_from(text, &files)
            .expect_err("a bad scene")
            .to_string();
        assert!(message.starts_with(&format!("{place}: ")), "{message}");
        assert!(message.contains(what), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    };
    let edit = |from: &str, to: &str| {
        assert_eq!(WHOLE.matches(from).count(), 1, "{from}");
        WHOLE.replace(from, to)
    };
    check("[camera", "scene:1", "");
    check(
        &edit("samples", "sample"),
        "scene:11",
        "unknown field `sample`",
    );
    check(&edit("samples = 4", "samples = 0"), "scene:11", "found 0");
    check(&edit("[1280, 720]", "[0, 720]"), "scene:10", "0x720");
    check(&edit("[1280, 720]", "[-1, 720]"), "scene:10", "");
    check(&edit("[1280, 720]", "[1280]"), "scene:10", "length");
    check(
        &edit("\"barycentric\"", "\"pretty\""),
        "scene:15",
        "`pretty`",
    );
    check(&edit("0.7", "1.5"), "scene:18", "found 1.5");
    check(&edit("[3, 2.5, 5]", "[nan, 0, 0]"), "scene:4", "finite");
    check(
        &edit("[3, 2.5, 5]", "[0, 0, 0.1]"),
        "scene:5",
        "away from the eye",
    );
    let with_up = |up: &str| edit("[0.0, 1.0, 0.0]", up);
    check(&with_up("[0, 0, 0]"), "scene:6", "expected a direction");
    check(
        &with_up("[-3, -2.5, -4.9]"),
        "scene:6",
        "lies along the view",
    );
    check(&edit("= 1.3", "= 0"), "scene:17", "above 0 and at most 100");
    check(
        &edit("= 1.3", "= 101"),
        "scene:17",
        "above 0 and at most 100",
    );
    check(
        &edit("samples = 4", "samples = 4097"),
        "scene:11",
        "expected 1 to 4096 samples, found 4097",
    );
    check(&edit("fov = 40.0", "fov = 180"), "scene:7", "found 180");
    check(&edit("fov = 40.0", "frame = 2"), "scene:7", "orthographic");
    check(
        &edit("\"perspective\"", "\"orthographic\""),
        "scene:7",
        "perspective",
    );
    check(&edit("#20242c", "20242"), "scene:12", "transparent");
    check(&edit("\"#ff8000\"", "\"red\""), "scene:34", "found \"red\"");
    check(
        &edit("\"b.txt\"", "\"c.txt\""),
        "scene:39",
        "c.txt cannot be read",
    );
    check(&edit("\"b.txt\"", "\"bad.obj\""), "bad.obj:2", "found 2");
    check(
        &edit("parent = \"planet\"", "parent = \"sun\""),
        "scene:29",
        "\"sun\"",
    );
    check(
        &edit("parent = \"planet\"", "parent = \"moon\""),
        "scene:29",
        "descendant",
    );
    check(
        &edit("rotate = [0, 90, 0]", "parent = \"moon\""),
        "scene:29",
        "descendant",
    );
    check(
        &edit("name = \"moon\"", "name = \"planet\""),
        "scene:29",
        "2 objects",
    );
}

/// Two objects with parts of one image, placed each in its own way.
const MAPPED: &str = r##"[[object]]
mesh = "b.txt"
texture = "wide.ppm"
crop = [1, 0, 2, 1]
wrap = ["mirror", "border:#ff0000"]
texture-projection = "cylinder"
texture-center = [0.5, 0.25, 0]
texture-size = [1, 3]

[[object]]
mesh = "b.txt"
texture = "wide.ppm"
texture-projection = "per-triangle"
"##;

#[test]
fn a_texture_is_cropped_wrapped_and_placed() {
    let file = parse(MAPPED);
    let [first, second] = &file.scene.objects[..] else {
        panic!("two objects");
    };
    let texture = first.texture.as_ref().expect("a texture");
    assert_eq!(texture.texels(), [[4, 5, 6, 255], [7, 8, 9, 255]]);
    let red = Wrap::Border(Some(Color([255, 0, 0])));
    assert_eq!(texture.wrap(), [Wrap::Mirror, red]);
    let projector = first.mapping.projector.expect("a place");
    assert_eq!(projector.center, DVec3::new(0.5, 0.25, 0.0));
    assert_eq!((projector.front, projector.up), (DVec3::Z, DVec3::Y));
    assert_eq!(projector.size.to_array(), [1.0, 3.0]);
    let whole = second.texture.as_ref().expect("a texture");
    assert_eq!((whole.width(), whole.crop()), (4, None));
    assert_eq!(
        second.mapping.projection,
        Some(TextureProjection::PerTriangle)
    );
    assert_eq!(second.mapping.projector, None);
    let told = |from: &str, to: &str| {
        let text = MAPPED.replacen(from, to, 1);
        let error = read_scene_from(&text, &files).expect_err(to);
        error.to_string()
    };
    assert_eq!(
        told("crop = [1, 0, 2, 1]", "crop = [3, 0, 2, 1]"),
        "scene:4: expected a part of an image of 4x1, found [3, 0, 2, 1]"
    );
    assert_eq!(
        told("texture = \"wide.ppm\"\n", ""),
        "scene:3: expected a `texture` beside what says how it lies, found none"
    );
    let wrap = told("mirror", "bounce");
    assert!(
        wrap.starts_with("scene:5: ") && wrap.contains("\"bounce\""),
        "{wrap}"
    );
    assert_eq!(
        told("texture-size = [1, 3]", "texture-up = [0, 0, 1e-9]"),
        "scene:7: expected a texture's front and up in two directions, found [0, 0, 1] and [0, 0, 0.000000001]"
    );
    assert_eq!(
        told("texture-size = [1, 3]", "texture-size = [1, -3]"),
        "scene:7: expected a texture's size above 0, found [1, -3]"
    );
}

#[test]
fn saved_scenes_read_the_same() {
    let orthographic = WHOLE
        .replace("\"perspective\"", "\"orthographic\"")
        .replace("fov = 40.0", "frame = 2.125")
        .replace("[\"#20242c\", \"#3A4454\"]", "\"transparent\"")
        .replace("wireframe = true\nwireframe-width = 1.3\n", "");
    let mapped = "[[object]]\nmesh = \"b.txt\"";
    for text in [WHOLE, &orthographic, "", mapped, MAPPED] {
        let file = parse(text);
        let saved = file
            .to_toml(Path::new("/nowhere"))
            .expect("it can be saved");
        let again = parse(&saved);
        assert_eq!(file.camera, again.camera);
        assert_eq!(file.image, again.image);
        assert_eq!(file.shading, again.shading);
        assert_eq!(file.scene.objects.len(), again.scene.objects.len());
        for (object, other) in file.scene.objects.iter().zip(&again.scene.objects) {
            assert_eq!(object.name, other.name);
            assert_eq!(object.transform, other.transform);
            assert_eq!(object.parent, other.parent);
            assert_eq!(object.color, other.color);
            assert_eq!(object.source, other.source);
            assert_eq!(object.texture, other.texture);
            assert_eq!(object.texture_source, other.texture_source);
            assert_eq!(object.mapping, other.mapping);
        }
        assert_eq!(again.to_toml(Path::new("/nowhere")).ok(), Some(saved));
    }
}

#[test]
fn a_matrix_places_an_object_and_is_saved_with_its_bits() {
    let object = |more: &str| format!("[[object]]\nmesh = \"b.txt\"\n{more}\n");
    let rows = "1, 0.1, -0.0, 4, 0, 1e-300, 2, 0.3, 5, 0, 3, 1e17";
    let twelve = parse(&object(&format!("scale = [2, 2, 2]\nmatrix = [{rows}]")));
    let found = twelve.scene.objects[0].transform;
    assert_eq!(found.matrix.translation, DVec3::new(4.0, 0.3, 1e17));
    assert_eq!(found.matrix.matrix3.y_axis, DVec3::new(0.1, 1e-300, 0.0));
    assert_eq!(found.scale, DVec3::splat(2.0));
    let sixteen = parse(&object(&format!("matrix = [{rows}, 0, 0, 0, 1]")));
    let bits = |file: &SceneFile| {
        let matrix = file.scene.objects[0].transform.matrix;
        matrix.to_cols_array().map(f64::to_bits)
    };
    assert_eq!(bits(&sixteen), bits(&twelve));
    let saved = sixteen.to_toml(Path::new("")).expect("it can be saved");
    assert_eq!(bits(&parse(&saved)), bits(&twelve), "{saved}");

    for (matrix, told) in [
        (
            "[1, 2, 3]",
            "scene:3: expected a matrix of 12 or 16 numbers, row by row, found 3",
        ),
        (
            "[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, inf, 0]",
            "scene:3: expected finite numbers, found inf",
        ),
        (
            "[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1]",
            "scene:3: expected 0, 0, 0, 1 as a matrix's last row, found [4.0, 5.0, 6.0, 1.0]",
        ),
    ] {
        let error = read_scene_from(&object(&format!("matrix = {matrix}")), &files);
        assert_eq!(error.expect_err("a bad matrix").to_string(), told);
    }
    let node = read_scene_from(&object("node = 0"), &files).expect_err("no nodes");
    let told = "scene:3: expected the number of one of the file's 0 mesh nodes, from 0, found 0";
    assert_eq!(node.to_string(), told);
}

#[test]
fn shapes_are_made_from_their_numbers_and_saved_as_them() {
    let text = "[[object]]\nshape = { kind = \"sphere\", radius = 2, rings = 4 }\n\n\
        [[object]]\nname = \"box\"\nshape = { kind = \"cube\", size = [1, 2, 0.1] }\nparent = \"ring\"\n\n\
        [[object]]\nname = \"ring\"\nshape = { kind = \"torus\" }\ntranslate = [1, 0, 0]\n";
    let file = parse(text);
    let names: Vec<&str> = file.scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["sphere", "box", "ring"]);
    assert_eq!(
        file.scene.objects[0].shape,
        Some(Shape::Sphere {
            radius: 2.0,
            segments: 64,
            rings: 4
        })
    );
    assert_eq!(file.scene.objects[0].mesh.triangles().len(), 2 * 64 * 3);
    assert_eq!(file.scene.objects[1].parent, Some(2));
    let saved = file
        .to_toml(Path::new("/nowhere"))
        .expect("it can be saved");
    assert_eq!(
        parse(&saved).scene.content(),
        file.scene.content(),
        "{saved}"
    );
    for (line, told) in [
        ("shape = { kind = \"egg\" }", "unknown variant `egg`"),
        (
            "shape = { kind = \"disc\", height = 1 }",
            "unknown field `height`",
        ),
        (
            "shape = { kind = \"disc\", segments = 2 }",
            "expected 3 to 16384 segments of a disc, found 2",
        ),
        (
            "shape = { kind = \"disc\", radius = -1 }",
            "expected a disc's radius above 0, found -1",
        ),
        (
            "mesh = \"b.txt\"\nshape = { kind = \"disc\" }",
            "expected a mesh or a shape, found both",
        ),
        (
            "name = \"a\"",
            "expected an object's `mesh`, or `shape`, found none",
        ),
        (
            "shape = { kind = \"sphere\", rings = 16384, segments = 16384 }",
            "(limit `triangles`)",
        ),
    ] {
        let error = read_scene_from(&format!("[[object]]\n{line}\n"), &files);
        let error = error.expect_err(line).to_string();
        assert!(error.starts_with("scene"), "{error}");
        assert!(error.contains(told), "{error}");
        assert_eq!(error.lines().count(), 1, "{error}");
    }
}

#[test]
fn saving_gives_parents_names_of_their_own() {
    let mut file = parse(WHOLE);
    for object in &mut file.scene.objects {
        object.name = "same".into();
    }
    let saved = file
        .to_toml(Path::new("/nowhere"))
        .expect("it can be saved");
    let again = parse(&saved);
    assert_eq!(again.scene.objects[0].parent, Some(1));
    assert_eq!(again.scene.objects[1].name, "same 2");
    file.scene.objects[2].source = None;
    let error = file.to_toml(Path::new("/nowhere")).expect_err("no file");
    assert!(error.to_string().contains("\"same\""), "{error}");
}

#[test]
fn files_append() {
    let mut file = parse("[image]\nsamples = 2\n[[object]]\nmesh = \"b.txt\"");
    file.append(parse(WHOLE));
    let opened = ["b.txt", "parts/a.obj", "parts/a.mtl", "t.ppm"].map(PathBuf::from);
    assert_eq!(file.opened, opened, "what both opened is named once");
    assert_eq!(file.scene.objects.len(), 4);
    assert_eq!(file.scene.objects[1].parent, Some(2));
    assert_eq!(file.image.samples, Some(2));
    assert_eq!(file.image.size, Some((1280, 720)));
}

#[test]
fn chains_of_parents_have_an_end() {
    let chain = |count: usize| {
        let object = |i: usize| {
            let parent = format!("parent = \"{}\"\n", i + 1);
            let parent = if i + 1 < count { parent.as_str() } else { "" };
            format!("[[object]]\nname = \"{i}\"\nmesh = \"b.txt\"\n{parent}")
        };
        let text: String = (0..count).map(object).collect();
        read_scene_from(&text, &files).map_err(|error| error.to_string())
    };
    assert!(chain(ANCESTOR_LIMIT + 1).is_ok());
    let told = chain(ANCESTOR_LIMIT + 2).expect_err("too long");
    assert_eq!(told, "scene:4: expected at most 1000 ancestors, found more");
}

#[test]
fn objects_that_nobody_will_see_are_told() {
    let object = |more: &str| format!("[[object]]\nmesh = \"b.txt\"\n{more}\n");
    for (place, why) in [
        ("scale = [0, 0, 0]", "scaled to nothing"),
        ("scale = [0, 2, 0]", "scaled to nothing"),
        ("translate = [0, -2e18, 0]", "further than 1e18 from zero"),
    ] {
        let warnings = parse(&object(place)).warnings;
        assert_eq!(warnings.len(), 1, "{place}: {warnings:?}");
        let start = "scene: none of the 1 triangles of object \"b\" is seen: it ";
        assert!(warnings[0].starts_with(start), "{warnings:?}");
        assert!(warnings[0].ends_with(why), "{warnings:?}");
    }
    for place in ["", "scale = [1, 0, 1]", "scale = [1e-30, 1e-30, 1e-30]"] {
        assert!(parse(&object(place)).warnings.is_empty(), "{place}");
    }
}

#[test]
fn a_shape_that_is_no_table_is_told_what_one_is() {
    let error = read_scene_from("[[object]]\nshape = \"cube\"\n", &files).expect_err("no table");
    assert_eq!(
        error.to_string(),
        "scene:2: invalid type: string \"cube\", expected a table, as { kind = \"sphere\", radius = 2 }"
    );
}

#[test]
fn messages_show_no_more_of_a_file_than_they_should() {
    let long = "x".repeat(100_000);
    for text in [
        format!("[camera]\n{long} = 1\n"),
        format!("[shading]\nmode = \"{long}\"\n"),
        format!("[image]\nbackground = [\"{long}\", \"#000000\"]\n"),
        format!("[[object]]\nmesh = \"{long}\"\n"),
        format!("[[object]]\nmesh = \"b.txt\"\ncolor = \"{long}\"\n"),
        format!("[[object]]\nmesh = \"b.txt\"\nparent = \"{long}\"\n"),
    ] {
        let error = read_scene_from(&text, &files).expect_err("a bad scene");
        let told = error.to_string();
        assert!(told.len() < 500, "{} characters", told.len());
    }
}

#[test]
fn an_animation_comes_back_and_its_faults_are_named() {
    let text = "\
[camera]
eye = [0.0, 1.0, 5.0]
target = [0.0, 0.0, 0.0]

[animation]
ease = \"smooth\"

[[animation.key]]
at = 3
eye = [0.0, 1.0, 5.0]
target = [0.0, 0.0, 0.0]

[[animation.key]]
at = 7
eye = [2.0, 1.0, 5.0]
target = [0.0, 0.5, 0.0]
fov = 20.0
";
    let read = |text: &str| crate::formats::read_scene_from(text, &|_| None);
    let file = read(text).expect("a scene");
    let path = file.animation.clone().expect("an animation");
    assert_eq!(path.frames(), (3, 7));
    assert_eq!(
        (path.curve(), path.ease()),
        (Curve::CatmullRom, Ease::Smooth)
    );
    let views: Vec<_> = path.keys().iter().map(|key| key.view).collect();
    assert_eq!(views, [None, Some(20.0)]);
    assert_eq!(path.keys()[1].placement.target, DVec3::new(0.0, 0.5, 0.0));
    let saved = file.to_toml(Path::new("/")).expect("it can be saved");
    assert_eq!(read(&saved).expect("a scene").animation, Some(path));

    for (from, to, line, told) in [
        ("at = 7", "at = 3", "scene:13", "a keyframe after 3"),
        ("fov = 20.0", "fov = 180.0", "scene:17", "found 180"),
        ("fov = 20.0", "frame = 2.0", "scene:17", "orthographic"),
        ("ease = \"smooth\"", "ease = \"fast\"", "scene:6", "fast"),
        (
            "[2.0, 1.0, 5.0]",
            "[0.0, 0.5, 0.0]",
            "scene:",
            "target away",
        ),
    ] {
        let error = read(&text.replace(from, to)).expect_err(to).to_string();
        assert!(error.contains(line) && error.contains(told), "{error}");
    }
    let none = "[animation]\nkey = []\n";
    let error = read(none).expect_err("no keyframes").to_string();
    assert!(error.contains("expected a keyframe"), "{error}");
}

#[test]
fn clipping_planes_come_back_and_their_faults_are_named() {
    let text = "[[clip]]\nnormal = [0.1, 0, -2]\noffset = 3.5\n\n[[clip]]\nnormal = [0, 1, 0]\nenabled = false\n";
    let file = parse(text);
    let [first, second] = file.clip.all() else {
        panic!("two planes: {:?}", file.clip);
    };
    assert_eq!(
        (first.normal, first.offset),
        (DVec3::new(0.1, 0.0, -2.0), 3.5)
    );
    assert_eq!((second.offset, second.enabled), (0.0, false));
    assert_eq!(file.clip.only_enabled().all(), [*first]);
    let saved = file
        .to_toml(Path::new("/nowhere"))
        .expect("it can be saved");
    assert_eq!(parse(&saved).clip, file.clip, "{saved}");
    let plain = parse("")
        .to_toml(Path::new("/nowhere"))
        .expect("it can be saved");
    assert!(!plain.contains("clip"), "{plain}");
    for (bad, told) in [
        (
            "[[clip]]\nnormal = [0, 0, 0]",
            "scene:1: a clipping plane's normal must not be zero",
        ),
        (
            "[[clip]]\nnormal = [1, 0, 0]\noffset = nan",
            "scene:1: a clipping plane's numbers must be finite",
        ),
        ("[[clip]]\noffset = 1", "normal"),
        (
            &"[[clip]]\nnormal = [1, 0, 0]\n".repeat(9),
            "scene:17: there can be at most 8 clipping planes",
        ),
    ] {
        let error = read_scene_from(bad, &files).expect_err(bad).to_string();
        assert!(error.contains(told), "{error}");
    }
}
