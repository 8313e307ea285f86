//! `raycast verify`: pictures that are right, and pictures that were changed.

use raycast_core::picture::{Format, ImageFile, Picture};
use raycast_tests::arguments;
use raycast_tests::binary::{command, refuse, run, succeed};
use raycast_tests::files::{asset, bytes, documented, folder, names};
use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

/// Who checks a picture of the documentation against its scene is told that it is right.
#[test]
fn the_documentations_pictures_are_of_their_scenes() {
    for (picture, scene) in [
        ("demo.png", "demo.raycast.toml"),
        ("panorama.png", "demo.raycast.toml"),
        ("normals.png", "monkey.obj"),
        ("low.png", "monkey.obj"),
        ("high.png", "monkey.obj"),
        ("depth.png", "dahlia.obj"),
        ("wireframe.png", "dahlia.obj"),
    ] {
        let (picture, scene) = (documented(picture), asset(scene));
        succeed(arguments!["verify", &picture, &scene, "--checks", "300"]);
    }
}

/// `verify` passes what `render` wrote, and finds one pixel that was changed by hand.
#[test]
fn a_wrong_pixel_is_found() {
    let folder = folder();
    let mesh = asset("monkey.obj");
    let view = ["--size", "150x110", "--orbit", "40,10"].map(OsString::from);
    for projection in ["perspective", "orthographic", "fisheye:equisolid"] {
        let path = folder.path().join("picture.exr");
        let with_view = |mut arguments: Vec<OsString>| {
            arguments.extend(view.iter().cloned());
            arguments.extend(arguments!["--projection", projection]);
            arguments
        };
        succeed(with_view(arguments!["render", &mesh, "-o", &path]));
        let message = succeed(with_view(arguments!["verify", &path, &mesh]));
        let text = String::from_utf8(message.output).expect("a report is UTF-8");
        assert!(
            text.starts_with("16500 of 16500 pixels checked: "),
            "{text}"
        );
        assert!(text.ends_with("0 wrong: every pixel shows what its ray meets first\n"));

        let good = Picture::decode_exr(&bytes(&path)).expect("an EXR");
        let triangles = &good.layers.as_ref().expect("an EXR has layers").triangle;
        // Where the mesh ends: a miss to the left.
        let is_silhouette = |&i: &usize| triangles[i - 1] == u32::MAX && triangles[i] != u32::MAX;
        let at = (1..triangles.len())
            .find(is_silhouette)
            .expect("a silhouette");
        for leak in [false, true] {
            let mut bad = good.clone();
            let layers = bad.layers.as_mut().expect("an EXR has layers");
            if leak {
                layers.object[at] = u32::MAX;
                layers.triangle[at] = u32::MAX;
                layers.depth[at] = f32::INFINITY;
            } else {
                layers.triangle[at] ^= 1;
            }
            std::fs::write(&path, bad.encode(Format::Exr).expect("encodes")).expect("writes");
            let message = run(&mut command(with_view(arguments!["verify", &path, &mesh])));
            assert_eq!(message.status, Some(1), "{}", message.errors);
            assert!(
                message
                    .errors
                    .contains("1 of 16500 pixels checked are wrong")
            );
            let text = String::from_utf8(message.output).expect("a report is UTF-8");
            let (column, row) = (at % 150, at / 150);
            assert!(
                text.contains(&format!("column {column}, row {row}: ")),
                "{text}"
            );
        }
    }
}

/// A picture whose colours, or normals, or texture coordinates were painted over is found out, in an EXR,
/// a PNG and a TIFF, and nothing need be said of its camera or its shading.
#[test]
fn a_repainted_picture_is_found() {
    let folder = folder();
    let mesh = asset("monkey.obj");
    for (mode, samples) in [("smooth", "1"), ("flat", "3"), ("normals", "1")] {
        let exr = folder.path().join("picture.exr");
        let png = folder.path().join("picture.png");
        let tiff = folder.path().join("picture.tif");
        for path in [&exr, &png, &tiff] {
            let view = ["--size", "90x70", "--orbit", "40,10", "--fov", "30"];
            let mut arguments = arguments!["render", &mesh, "-o", path];
            arguments.extend(view.map(OsString::from));
            arguments.extend(["--mode", mode, "--samples", samples].map(OsString::from));
            succeed(arguments);
            let message = succeed(arguments!["verify", path, &mesh, "--all"]);
            let text = String::from_utf8(message.output).expect("a report is UTF-8");
            assert!(text.starts_with("6300 of 6300 pixels checked"), "{text}");
            assert!(text.contains("colour at "), "{text}");
            assert!(text.contains("0 wrong: every "), "{text}");
        }
        let refused = |path: &Path, count: Option<usize>| {
            let message = run(&mut command(arguments!["verify", path, &mesh, "--all"]));
            assert_eq!(message.status, Some(1), "{}", message.errors);
            if let Some(count) = count {
                let expected = format!("{count} of 6300 pixels checked are wrong");
                assert!(message.errors.contains(&expected), "{}", message.errors);
            } else {
                assert!(message.errors.contains("are wrong"), "{}", message.errors);
            }
        };
        let ImageFile {
            picture, recipe, ..
        } = ImageFile::decode(&bytes(&exr)).expect("an EXR");
        let write = |picture: &Picture, format: Format, path: &Path| {
            let bytes = picture.encode_with(format, recipe.as_ref());
            std::fs::write(path, bytes.expect("encodes")).expect("writes");
        };
        // A stroke across the middle.
        let row = 35 * 90..36 * 90;
        let mut bad = picture.clone();
        let layers = bad.layers.as_mut().expect("an EXR has layers");
        layers.color[row.clone()].fill([0.5, 0.1, 0.9, 1.0]);
        write(&bad, Format::Exr, &exr);
        refused(&exr, Some(90));
        let mut bad = picture.clone();
        let layers = bad.layers.as_mut().expect("an EXR has layers");
        layers.normal[row.clone()].fill([0.6, 0.8, 0.0]);
        write(&bad, Format::Exr, &exr);
        refused(&exr, None);
        let mut bad = picture.clone();
        bad.layers = None;
        bad.pixels[row].fill([120, 40, 200, 255]);
        write(&bad, Format::Png, &png);
        refused(&png, None);
        write(&bad, Format::Tiff, &tiff);
        refused(&tiff, None);
    }
}

/// A recipe that does not fit is refused before a pixel is looked at.
#[test]
fn a_picture_of_something_else_is_refused() {
    let folder = folder();
    let (mesh, other) = (asset("monkey.obj"), asset("cube.obj"));
    for name in ["picture.exr", "picture.png", "picture.tiff", "part.png"] {
        let path = folder.path().join(name);
        let mut arguments = arguments!["render", &mesh, "-o", &path, "--size", "60x40"];
        arguments.extend(["--orbit", "40,10", "--color", "#aa3355"].map(OsString::from));
        if name == "part.png" {
            arguments.extend(["--tiles", "2x2", "--sub-camera", "1,1"].map(OsString::from));
        }
        succeed(arguments);
        let verify = |mesh: &Path, more: &[&str]| {
            let mut arguments = arguments!["verify", &path, mesh];
            arguments.extend(more.iter().map(OsString::from));
            arguments
        };
        let color = ["--color", "#aa3355"];
        succeed(verify(&mesh, &color));
        succeed(verify(
            &mesh,
            &[&color[..], &["--orbit", "40,10", "--mode", "smooth"]].concat(),
        ));
        for (mesh, more, expected) in [
            (&other, &[][..], "another scene"),
            (&mesh, &[], "another scene"),
            (&other, &["--color", "#aa3355"], "another scene"),
            (
                &mesh,
                &["--color", "#aa3355", "--orbit", "41,10"],
                "another camera (",
            ),
            (
                &mesh,
                &["--color", "#aa3355", "--mode", "flat"],
                "other settings (mode = \"smooth\", not mode = \"flat\")",
            ),
            (
                &mesh,
                &["--color", "#aa3355", "--samples", "2"],
                "other settings (samples = 1, not samples = 2)",
            ),
        ] {
            let line = refuse(1, verify(mesh, more));
            assert!(line.contains(expected) && line.contains(name), "{line}");
        }
    }
}

/// The recipe is the same however a picture is split, from whatever folder, by however many threads.
#[test]
fn recipes_hang_on_nothing_but_the_picture() {
    let folder = folder();
    let copy = folder.path().join("another name.obj");
    std::fs::write(&copy, bytes(&asset("torus.obj"))).expect("writes");
    std::fs::write(folder.path().join("torus.mtl"), bytes(&asset("torus.mtl"))).expect("writes");
    let mut whole = Vec::new();
    for (mesh, more) in [
        (&asset("torus.obj"), &["--threads", "1"][..]),
        (&copy, &["--threads", "2", "--tiles", "3x2"]),
    ] {
        let path = folder.path().join("picture.png");
        let mut arguments = arguments!["render", mesh, "-o", &path, "--size", "60x40"];
        arguments.extend(more.iter().map(OsString::from));
        succeed(arguments);
        whole.push(bytes(&path));
    }
    assert!(whole[0] == whole[1]);
    let recipe = ImageFile::decode(&whole[0]).expect("a PNG").recipe;
    let text = recipe.expect("a render tells its recipe").to_string();
    assert!(!text.contains("torus") && !text.contains("name"), "{text}");
}

/// What needs more memory than there is is refused before it is begun, with the figures; no process is
/// ended half-way.
#[cfg(target_os = "linux")]
#[test]
fn pictures_beyond_memory_are_refused() {
    let folder = folder();
    // Files of one piece: a JPEG, and pictures that are not finished. Others are made in bands.
    let unfinished = ["--unfinished", "1"];
    for (name, size, more) in [
        ("a.tif", "32768x32768", &unfinished[..]),
        ("a.png", "32768x32768", &unfinished),
        ("a.jpg", "32768x32768", &[]),
    ] {
        let output = folder.path().join(name);
        let mut shell = Command::new("sh");
        shell.arg("-c").arg("ulimit -v 1000000; exec \"$0\" \"$@\"");
        shell.arg(raycast_tests::binary::path());
        shell.args(arguments!["render", asset("cube.obj"), "-o", &output]);
        shell.args(["--size", size, "--threads", "2"]).args(more);
        let message = run(&mut shell);
        assert_eq!(message.status, Some(1), "{name}: {}", message.errors);
        let line = &message.errors;
        assert_eq!(line.lines().count(), 1, "{line}");
        for expected in [size, "GiB of memory", "ulimit -v", "would fit"] {
            assert!(line.contains(expected), "{expected}: {line}");
        }
        assert!(names(folder.path()).is_empty(), "{name}: a file was left");
    }
}

#[test]
fn verify_renders_where_there_is_no_image_and_takes_fragments() {
    let folder = folder();
    let scene = asset("demo.raycast.toml");
    let checks = ["--checks", "3000", "--seed", "7"];
    let mut arguments = arguments!["verify", &scene];
    arguments.extend(checks.map(OsString::from));
    let first = succeed(&arguments).output;
    assert_eq!(first, succeed(&arguments).output);
    let text = String::from_utf8(first).expect("a report is UTF-8");
    assert!(
        text.starts_with("3000 of 921600 pixels checked: "),
        "{text}"
    );
    assert!(text.contains("0 wrong of 3000: "), "{text}");

    let part = folder.path().join("part.exr");
    let split = ["--tiles", "4x3", "--sub-camera", "2,1"].map(OsString::from);
    let mut render = arguments!["render", &scene, "-o", &part];
    render.extend(split);
    succeed(render);
    succeed(arguments!["verify", &part, &scene, "--checks", "2000"]);
    // From elsewhere it is not what the rays hit.
    let elsewhere = arguments!["verify", &part, &scene, "--orbit", "80,10"];
    let message = run(&mut command(elsewhere));
    assert_eq!(message.status, Some(1), "{}", message.errors);
}

#[test]
fn what_cannot_be_verified_is_refused() {
    let folder = folder();
    let mesh = asset("cube.obj");
    let picture = folder.path().join("picture.exr");
    succeed(arguments![
        "render", &mesh, "-o", &picture, "--size", "40x30"
    ]);
    let size = refuse(2, arguments!["verify", &picture, &mesh, "--size", "41x30"]);
    assert!(size.contains("40x30") && size.contains("41x30"), "{size}");
    refuse(2, arguments!["verify", &picture]);
    refuse(2, arguments!["verify", &picture, &picture, &mesh]);
    refuse(2, arguments!["verify", &mesh, "--checks", "0"]);
    let text = folder.path().join("text.exr");
    std::fs::write(&text, "no image").expect("writes");
    refuse(1, arguments!["verify", &text, &mesh]);
    refuse(
        1,
        arguments!["verify", folder.path().join("none.exr"), &mesh],
    );
}
