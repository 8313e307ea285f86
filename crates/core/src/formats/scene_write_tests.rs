//! Writing scene files and reading them again.

use super::scene_read_tests::{MAPPED, WHOLE, files, parse};
use super::*;
use crate::camera::{Curve, Ease};
use crate::scene::{Color, Object, Shape};
use crate::shade::{LightSet, Mode};
use glam::DVec3;
use std::sync::Arc;

#[test]
fn saved_scenes_read_the_same() {
    let orthographic = WHOLE
        .replace("\"perspective\"", "\"orthographic\"")
        .replace("fov = 40.0", "frame = 2.125")
        .replace("[\"#20242c\", \"#3A4454\"]", "\"transparent\"")
        .replace("wireframe = true\nwireframe-width = 1.3\n", "")
        .replace(
            "wireframe-edges = \"feature:25,boundary\"\nwireframe-hidden = 0.2\n",
            "",
        );
    let studio = "[shading]\nmode = \"material\"\ncrease = 35.5\nlights = \"headlight\"\nplain-color = \"#c8bfb2\"\n";
    let read = parse(studio).shading.expect("a shading");
    assert_eq!((read.mode, read.crease), (Mode::Material, 35.5));
    assert_eq!(read.lights, LightSet::Headlight);
    assert_eq!(read.plain_color, Color([0xc8, 0xbf, 0xb2]));
    let mapped = "[[object]]\nmesh = \"b.txt\"";
    for text in [WHOLE, &orthographic, "", mapped, MAPPED, studio] {
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

    for (matrix, message) in [
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
        assert_eq!(error.expect_err("a bad matrix").to_string(), message);
    }
    let node = read_scene_from(&object("node = 0"), &files).expect_err("no nodes");
    let message = "scene:3: expected the number of one of the file's 0 mesh nodes, from 0, found 0";
    assert_eq!(node.to_string(), message);
}

#[test]
fn shapes_without_numbers_are_those_of_the_one_list() {
    for shape in Shape::ALL {
        let kind = shape.name();
        let text = format!("[[object]]\nshape = {{ kind = \"{kind}\" }}\n");
        assert_eq!(parse(&text).scene.objects[0].shape, Some(shape));
    }
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
    for (line, message) in [
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
        assert!(error.contains(message), "{error}");
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
    assert_eq!(path.keys()[1].pose.target, DVec3::new(0.0, 0.5, 0.0));
    let saved = file.to_toml(Path::new("/")).expect("it can be saved");
    assert_eq!(read(&saved).expect("a scene").animation, Some(path));

    for (from, to, line, message) in [
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
        assert!(error.contains(line) && error.contains(message), "{error}");
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
    for (bad, message) in [
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
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn hidden_groups_are_saved_and_shared_by_objects_of_one_mesh() {
    let object =
        |names: &str| format!("[[object]]\nmesh = \"groups.obj\"\nhidden-groups = [{names}]\n");
    let both = r#""\"box\" é", """#;
    let text = [object(both), object("\"lid\""), object(both), object("")].concat();
    let file = parse(&text);
    assert_eq!(file.warnings, [""; 0]);
    let kept = |file: &SceneFile| -> Vec<Vec<u32>> {
        let objects = file.scene.objects.iter();
        objects.map(|object| object.kept().to_vec()).collect()
    };
    let expected: [&[u32]; 4] = [&[1], &[0, 2], &[1], &[0, 1, 2]];
    assert_eq!(kept(&file), expected);
    let [first, _, third, none] = &file.scene.objects[..] else {
        panic!("four objects");
    };
    let hidden = |object: &Object| object.hidden_groups.clone().expect("hidden groups");
    assert!(Arc::ptr_eq(&hidden(first), &hidden(third)));
    assert_eq!(none.hidden_groups, None);
    let saved = file
        .to_toml(Path::new("/nowhere"))
        .expect("it can be saved");
    assert_eq!(kept(&parse(&saved)), expected);

    let unknown = parse(&object("\"lid\", \"wheel\""));
    assert_eq!(kept(&unknown), [[0, 2]]);
    let message = "scene:3: hidden-groups: the mesh has no group \"wheel\"";
    assert_eq!(unknown.warnings, [message]);
}
