//! Error messages of faulty scene files.

use super::scene_objects::ANCESTOR_LIMIT;
use super::scene_read_tests::{WHOLE, files, parse};
use super::*;
use crate::camera::LensError;
use crate::ranges::OutOfRange;
use crate::shade::{Ground, GroundError};

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
    check(&edit("0.7", "1.5"), "scene:20", "found 1.5");
    check(
        &edit("feature:25,boundary", "pretty"),
        "scene:18",
        "expected kinds of edges: all, polygon, feature[:DEGREES], silhouette, boundary, non-manifold, found \"pretty\"",
    );
    check(
        &edit("= 0.2", "= 2.0"),
        "scene:19",
        "expected 0 to 1 of hidden lines, found 2",
    );
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
    check(&edit("\"#ff8000\"", "\"red\""), "scene:36", "found \"red\"");
    check(
        &edit("\"b.txt\"", "\"c.txt\""),
        "scene:41",
        "c.txt cannot be read",
    );
    check(&edit("\"b.txt\"", "\"bad.obj\""), "bad.obj:2", "found 2");
    check(
        &edit("parent = \"planet\"", "parent = \"sun\""),
        "scene:31",
        "\"sun\"",
    );
    check(
        &edit("parent = \"planet\"", "parent = \"moon\""),
        "scene:31",
        "descendant",
    );
    check(
        &edit("rotate = [0, 90, 0]", "parent = \"moon\""),
        "scene:31",
        "descendant",
    );
    check(
        &edit("name = \"moon\"", "name = \"planet\""),
        "scene:31",
        "2 objects",
    );
}

#[test]
fn invisible_objects_give_a_warning() {
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
fn a_shape_that_is_no_table_gives_an_error_with_the_expected_form() {
    let error = read_scene_from("[[object]]\nshape = \"cube\"\n", &files).expect_err("no table");
    assert_eq!(
        error.to_string(),
        "scene:2: invalid type: string \"cube\", expected a table, as { kind = \"sphere\", radius = 2 }"
    );
}

#[test]
fn lenses_eyes_and_the_ground_are_refused_in_the_words_of_their_ranges() {
    let camera = "[camera]\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n";
    let refusal = |text: &str| {
        let error = read_scene_from(text, &files).expect_err(text);
        error.to_string()
    };
    let stereo = |more: &str| format!("[image]\nstereo = {{ kind = \"pair\", {more} }}\n");
    for (text, line, expected) in [
        (
            format!("{camera}lens = [1, 2]\n"),
            4,
            LensError::Count.to_string(),
        ),
        (
            format!("{camera}lens = [1e308, 0, 0, 0, 0]\n"),
            4,
            OutOfRange::Lens {
                found: [1e308, 0.0, 0.0, 0.0, 0.0],
            }
            .to_string(),
        ),
        (
            stereo("eye-distance = -1"),
            2,
            OutOfRange::EyeDistance(-1.0).to_string(),
        ),
        (
            stereo("eye-distance = 1, convergence = 0"),
            2,
            OutOfRange::Convergence(0.0).to_string(),
        ),
        (
            "[shading]\nground = \"middle\"\n".to_owned(),
            2,
            GroundError::Word.to_string(),
        ),
        (
            "[shading]\nground = 1e300\n".to_owned(),
            2,
            OutOfRange::Ground(1e300).to_string(),
        ),
        (
            "[shading]\nground = \"-1e300\"\n".to_owned(),
            2,
            OutOfRange::Ground(-1e300).to_string(),
        ),
    ] {
        assert_eq!(refusal(&text), format!("scene:{line}: {expected}"));
    }
    let ground = |text: &str| parse(text).shading.expect("shading").ground;
    assert_eq!(ground("[shading]\nground = -2\n"), Some(Ground::At(-2.0)));
    let lowest = "[shading]\nground = \"lowest\"\n";
    assert_eq!(ground(lowest), Some(Ground::Lowest));
}

#[test]
fn messages_quote_a_bounded_part_of_a_file() {
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
        let error_text = error.to_string();
        assert!(error_text.len() < 500, "{} characters", error_text.len());
    }
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
            let error_text = format!(
                "scene:2: expected a scene file of version 1, which this program reads, found version {version}"
            );
            assert_eq!(of(version, more).expect_err(version), error_text);
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
        let error_text = of(version, more).expect_err(version);
        assert!(error_text.starts_with(expected), "{error_text}");
    }
}

#[test]
fn chains_of_parents_are_limited() {
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
    let error_text = chain(ANCESTOR_LIMIT + 2).expect_err("too long");
    assert_eq!(
        error_text,
        "scene:4: expected at most 1000 ancestors, found more"
    );
}
