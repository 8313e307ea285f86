//! Animations, and plans of many jobs.

use raycast_core::picture::ImageFile;
use raycast_tests::arguments;
use raycast_tests::binary::{refuse, run, succeed};
use raycast_tests::files::{asset, bytes, folder, names, write};
use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

fn render(scene: &Path, output: &Path, more: &[&str]) {
    let mut arguments = arguments!["render", scene, "-o", output, "--size", "64x48"];
    arguments.extend(more.iter().map(OsString::from));
    succeed(arguments);
}

#[test]
fn a_turntables_frames_are_the_pictures_of_their_orbits() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let mesh = asset("monkey.obj");
    render(
        &mesh,
        &at("turn-%03d.png"),
        &["--orbit", "22,16,5", "--turntable", "8"],
    );
    assert_eq!(names(folder.path()).len(), 8);
    // The first is the picture without a turntable, to the last byte; another is that of its orbit, but for
    // the rounding of its place.
    render(&mesh, &at("first.png"), &["--orbit", "22,16,5"]);
    assert!(bytes(&at("turn-000.png")) == bytes(&at("first.png")));
    let camera = |name: &str| {
        let file = ImageFile::decode(&bytes(&at(name))).expect("a picture");
        file.recipe.expect("a recipe").camera
    };
    render(&mesh, &at("orbit.png"), &["--orbit", "157,16,5"]);
    let (turned, orbit) = (camera("turn-003.png"), camera("orbit.png"));
    let apart = turned.placement().eye.distance(orbit.placement().eye);
    assert!(apart < 1e-9, "{apart}");
    assert!(turned.placement().up.distance(orbit.placement().up) < 1e-9);
}

#[test]
fn frames_that_are_there_are_left_and_others_are_made() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let mesh = asset("monkey.obj");
    let more = ["--turntable", "6", "--frames", "1..4"];
    render(&mesh, &at("a-%d.png"), &more);
    let all: Vec<_> = (1..=4).map(|i| bytes(&at(&format!("a-{i}.png")))).collect();
    assert_eq!(names(folder.path()).len(), 4);
    let written = |i: u32| {
        let found = std::fs::metadata(at(&format!("a-{i}.png"))).expect("a file");
        found.modified().expect("a time")
    };
    let first = written(1);
    // Damaged, missing, and of another recipe.
    write(folder.path(), "a-2.png", &all[1][..all[1].len() - 40]);
    std::fs::remove_file(at("a-3.png")).expect("removed");
    render(&mesh, &at("a-4.png"), &["--mode", "flat"]);
    render(&mesh, &at("a-%d.png"), &more);
    for (i, expected) in (1..=4).zip(&all) {
        assert!(bytes(&at(&format!("a-{i}.png"))) == *expected, "{i}");
    }
    assert_eq!(written(1), first, "it was there");
}

#[test]
fn a_scenes_keyframes_are_its_frames() {
    let folder = folder();
    let mesh = asset("cube.obj");
    let text = format!(
        "[camera]\neye = [4.0, 2.0, 6.0]\ntarget = [0.0, 0.0, 0.0]\nfov = 30.0\n\
         [animation]\ncurve = \"linear\"\n\
         [[animation.key]]\nat = 0\neye = [4.0, 2.0, 6.0]\ntarget = [0.0, 0.0, 0.0]\n\
         [[animation.key]]\nat = 4\neye = [6.0, 2.0, 4.0]\ntarget = [0.0, 0.0, 0.0]\nfov = 50.0\n\
         [[object]]\nmesh = {:?}\n",
        mesh.display().to_string()
    );
    let scene = write(folder.path(), "a.raycast.toml", text);
    let at = |name: &str| folder.path().join(name);
    render(&scene, &at("f%d.png"), &["--frames", "0..4"]);
    for (frame, more) in [
        (0, ["--eye", "4,2,6", "--target", "0,0,0", "--fov", "30"]),
        (2, ["--eye", "5,2,5", "--target", "0,0,0", "--fov", "50"]),
        (4, ["--eye", "6,2,4", "--target", "0,0,0", "--fov", "50"]),
    ] {
        render(&scene, &at("one.png"), &more);
        assert!(
            bytes(&at(&format!("f{frame}.png"))) == bytes(&at("one.png")),
            "{frame}"
        );
    }
    for (arguments, told) in [
        (
            arguments![
                "render",
                &scene,
                "-o",
                at("x%d.png"),
                "--frames",
                "0..1",
                "--orbit",
                "0,0"
            ],
            "--orbit",
        ),
        (
            arguments!["render", &mesh, "-o", at("x%d.png"), "--frames", "0..1"],
            "--turntable",
        ),
        (
            arguments!["render", &mesh, "-o", at("x.jpg"), "--turntable", "3"],
            "%05d",
        ),
        (
            arguments![
                "render",
                &mesh,
                "-o",
                at("x%d.png"),
                "--turntable",
                "3",
                "--frames",
                "0..3"
            ],
            "beyond 2",
        ),
    ] {
        let line = refuse(2, arguments);
        assert!(line.contains(told), "{line}");
    }
}

#[test]
fn several_frames_in_one_png_are_those_of_their_own_files() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let mesh = asset("monkey.obj");
    render(&mesh, &at("all.png"), &["--turntable", "3", "--rate", "10"]);
    render(&mesh, &at("one%d.png"), &["--turntable", "3"]);
    let file = bytes(&at("all.png"));
    let mut reader = png::Decoder::new(std::io::Cursor::new(&file))
        .read_info()
        .expect("a PNG");
    let frames = reader
        .info()
        .animation_control()
        .expect("an animation")
        .num_frames;
    assert_eq!(frames, 3);
    for frame in 0..3 {
        let mut pixels = vec![0; 64 * 48 * 3];
        reader.next_frame(&mut pixels).expect("a frame");
        let one = ImageFile::decode(&bytes(&at(&format!("one{frame}.png")))).expect("a picture");
        let rgb: Vec<u8> = one
            .picture
            .pixels
            .iter()
            .flat_map(|&[r, g, b, _]| [r, g, b])
            .collect();
        assert!(pixels == rgb, "{frame}");
    }
}

#[cfg(unix)]
#[test]
fn a_plans_lines_make_the_whole_pictures_bytes_in_any_order() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let mesh = asset("monkey.obj");
    let plan = at("it's a plan");
    let mut arguments = arguments![
        "plan",
        &mesh,
        "-o",
        &plan,
        "--turntable",
        "2",
        "--tiles",
        "2x2"
    ];
    arguments.extend(arguments!["--pictures", at("out-%d.png"), "--program"]);
    arguments.extend(arguments![
        raycast_tests::binary::path(),
        "--",
        "--size",
        "64x48"
    ]);
    succeed(&arguments);
    let text = String::from_utf8(bytes(&plan)).expect("text");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 8);
    let shell = |line: &str| run(Command::new("sh").args(["-c", line]).current_dir("/"));
    let stitch = String::from_utf8(bytes(&at("it's a plan.stitch"))).expect("text");
    // The last line twice, as a job that was put in the queue again; before it a fragment is missing.
    for line in lines[1..].iter().rev() {
        assert_eq!(shell(line).status, Some(0), "{line}");
    }
    let lacking = shell(stitch.lines().next().expect("a line"));
    assert!(
        lacking.errors.contains("00000-0-0.png"),
        "{}",
        lacking.errors
    );
    for line in [lines[0], lines[7]] {
        assert_eq!(shell(line).status, Some(0), "{line}");
    }
    for line in stitch.lines() {
        let told = shell(line);
        assert_eq!(told.status, Some(0), "{line}: {}", told.errors);
    }
    render(&mesh, &at("whole-%d.png"), &["--turntable", "2"]);
    for frame in 0..2 {
        let [out, whole] = ["out", "whole"].map(|name| bytes(&at(&format!("{name}-{frame}.png"))));
        assert!(out == whole, "{frame}");
    }
}
