//! The real binary over files that are hostile, damaged or odd: an error of one line or a warning,
//! never a wait, never in silence.

use raycast_tests::arguments;
use raycast_tests::binary::{ProgramOutput, command, refuse, run, succeed};
#[cfg(unix)]
use raycast_tests::files::pipe;
use raycast_tests::files::{asset, folder, write};
use std::ffi::OsString;
use std::path::Path;
use std::time::{Duration, Instant};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn render(file: &Path, more: &[&str]) -> Vec<OsString> {
    let mut arguments: Vec<OsString> = vec!["render".into(), file.into(), "-o".into()];
    arguments.push(file.with_extension("out.png").into());
    arguments.extend(["--size", "32x24"].map(OsString::from));
    arguments.extend(more.iter().map(OsString::from));
    arguments
}

/// Renders a small picture, which must succeed.
fn rendered(file: &Path, more: &[&str]) -> ProgramOutput {
    succeed(render(file, more))
}

#[test]
fn images_that_claim_too_much_are_refused_before_they_are_made() {
    let folder = folder();
    let image = write(folder.path(), "bomb.ppm", b"P6\n32768 32768\n255\n");
    let mesh = write(folder.path(), "a.obj", TRIANGLE);
    let with = |image: &Path, more: &[&str]| {
        let name = image.display().to_string();
        let all: Vec<&str> = ["--texture", name.as_str()]
            .iter()
            .chain(more)
            .copied()
            .collect();
        render(&mesh, &all)
    };
    let started = Instant::now();
    let message = refuse(1, with(&image, &[]));
    assert!(
        message.contains("bomb.ppm: an image of 32768x32768"),
        "{message}"
    );
    assert!(message.contains("limit `pixels`"), "{message}");
    let message = refuse(1, with(&image, &["--limit", "pixels=2G"]));
    assert!(message.contains("limit `bytes`"), "{message}");
    assert!(started.elapsed() < Duration::from_secs(20));
    // A mesh does without.
    write(folder.path(), "a.mtl", "newmtl x\nmap_Kd bomb.ppm\n");
    let mesh = write(
        folder.path(),
        "b.obj",
        format!("mtllib a.mtl\nusemtl x\n{TRIANGLE}"),
    );
    let message = rendered(&mesh, &[]);
    assert!(
        message.errors.contains("limit `pixels`"),
        "{}",
        message.errors
    );
}

#[test]
fn limits_count_what_a_scene_takes() {
    let folder = folder();
    let mesh = write(folder.path(), "a.obj", format!("{TRIANGLE}f 1 2 3\n"));
    rendered(&mesh, &["--limit", "triangles=2"]);
    let message = refuse(1, render(&mesh, &["--limit", "triangles=1"]));
    assert!(
        message.contains("at most 1 are allowed (limit `triangles`)"),
        "{message}"
    );
    let message = refuse(1, render(&mesh, &["--limit", "bytes=40"]));
    assert!(message.contains("limit `bytes`"), "{message}");
    // Of all files together, and of all objects.
    let name = mesh.display().to_string();
    let message = refuse(1, render(&mesh, &[&name, "--limit", "triangles=3"]));
    assert!(message.contains("limit `triangles`"), "{message}");
    let object = "[[object]]\nmesh = \"a.obj\"\n";
    let scene = write(folder.path(), "a.raycast.toml", object.repeat(2));
    rendered(&scene, &["--limit", "triangles=4"]);
    refuse(1, render(&scene, &["--limit", "triangles=3"]));
}

#[cfg(unix)]
#[test]
fn nothing_is_waited_for_that_a_file_names() {
    let folder = folder();
    pipe(folder.path());
    std::fs::create_dir(folder.path().join("in")).expect("a folder");
    let started = Instant::now();
    for library in ["/dev/zero", "../pipe", "../../../../../dev/zero"] {
        let mesh = write(
            folder.path(),
            "in/a.obj",
            format!("mtllib {library}\n{TRIANGLE}"),
        );
        let message = rendered(&mesh, &["--follow-anywhere"]);
        assert!(
            message.errors.contains("not a regular file"),
            "{}",
            message.errors
        );
        let message = rendered(&mesh, &[]);
        assert!(message.errors.contains(library), "{}", message.errors);
    }
    write(folder.path(), "in/a.mtl", "newmtl x\nmap_Kd ../pipe\n");
    let mesh = write(
        folder.path(),
        "in/b.obj",
        format!("mtllib a.mtl\nusemtl x\n{TRIANGLE}"),
    );
    let message = rendered(&mesh, &[]);
    assert!(message.errors.contains("a pipe"), "{}", message.errors);
    let scene = write(
        folder.path(),
        "a.raycast.toml",
        "[[object]]\nmesh = \"pipe\"\n",
    );
    let message = refuse(1, render(&scene, &[]));
    assert!(
        message.contains("a.raycast.toml:2: ") && message.contains("a pipe"),
        "{message}"
    );
    let device = Path::new("/dev/zero");
    let message = refuse(1, ["info".as_ref(), device.as_os_str()]);
    assert!(message.contains("a device"), "{message}");
    assert!(started.elapsed() < Duration::from_secs(60));
}

/// What a shell makes of `raycast info <(cat a.obj)`.
#[cfg(unix)]
#[test]
fn a_pipe_on_the_command_line_is_read_once() {
    let folder = folder();
    let pipe = pipe(folder.path());
    let writer = {
        let pipe = pipe.clone();
        std::thread::spawn(move || std::fs::write(pipe, TRIANGLE))
    };
    let message = run(&mut command(["info".as_ref(), pipe.as_os_str()]));
    assert_eq!(message.status, Some(0), "{}", message.errors);
    let output = String::from_utf8_lossy(&message.output);
    assert!(output.contains("pipe: OBJ"), "{output}");
    assert!(writer.join().is_ok_and(|written| written.is_ok()));
}

#[test]
fn what_is_followed_far_is_named() {
    let folder = folder();
    for name in ["a/b", "a/textures"] {
        std::fs::create_dir_all(folder.path().join(name)).expect("a folder");
    }
    write(folder.path(), "a/textures/near.mtl", "newmtl x\nKd 1 0 0\n");
    write(folder.path(), "far.mtl", "newmtl x\nKd 0 1 0\n");
    let mesh = write(
        folder.path(),
        "a/b/near.obj",
        format!("mtllib ../textures/near.mtl\nusemtl x\n{TRIANGLE}"),
    );
    assert_eq!(rendered(&mesh, &[]).errors, "");
    let mesh = write(
        folder.path(),
        "a/b/far.obj",
        format!("mtllib ../../far.mtl\nusemtl x\n{TRIANGLE}"),
    );
    let message = rendered(&mesh, &[]);
    assert!(
        message.errors.contains("\"../../far.mtl\""),
        "{}",
        message.errors
    );
    assert!(
        message.errors.contains("`follow-anywhere`"),
        "{}",
        message.errors
    );
    assert_eq!(rendered(&mesh, &["--follow-anywhere"]).errors, "");
}

#[test]
fn faces_cover_their_insides_alone() {
    let folder = folder();
    let l = "v 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nv 0 0 0\nf 1 2 3 4 5 6\n";
    // The same L of two rectangles.
    let boxes = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 0 1 0\nv 1 3 0\nv 0 3 0\n\
        f 1 2 3 4 5\nf 5 4 6 7\n";
    let camera = ["--mode", "flat", "--color", "#ffffff"];
    let pixels = |name: &str, text: &str| {
        let mesh = write(folder.path(), name, text);
        rendered(&mesh, &camera);
        let png = std::fs::read(mesh.with_extension("out.png")).expect("a picture");
        image::load_from_memory(&png).expect("a PNG").into_bytes()
    };
    assert_eq!(pixels("l.obj", l), pixels("boxes.obj", boxes));
    let bow_tie = write(
        folder.path(),
        "bow.obj",
        "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n",
    );
    let message = rendered(&bow_tie, &[]);
    assert!(
        message
            .errors
            .contains("faces that cross or touch themselves, which are cut as fans: 1"),
        "{}",
        message.errors
    );
}

#[test]
fn rounding_that_bends_triangles_gives_a_warning() {
    let folder = folder();
    let mesh = write(
        folder.path(),
        "a.obj",
        "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 1 1 1\nv 1.0000000001 1 1\nv 1 1.0000000001 1\n\
         v 1 1.000001 1\nf 1 2 3\nf 4 5 6\nf 1 4 7\n",
    );
    let message = rendered(&mesh, &[]);
    assert!(
        message
            .errors
            .contains("1 rounded away by single precision"),
        "{}",
        message.errors
    );
    assert!(
        message
            .errors
            .contains("triangles of which rounding to single precision moves a corner"),
        "{}",
        message.errors
    );
    let message = succeed(["info".as_ref(), "--json".as_ref(), mesh.as_os_str()]);
    let value: serde_json::Value = serde_json::from_slice(&message.output).expect("JSON");
    assert_eq!(value[0]["dropped"]["rounded_away"], 1);
    let object = &value[0]["objects"][0];
    assert_eq!(object["rounding"]["bent"], 1);
    let share = object["rounding"]["share_of_edge"]
        .as_f64()
        .expect("a share");
    // The single nearest to 1.000001 is 1.00000095367.
    assert!((share - 0.0463).abs() < 1e-3, "{share}");
}

#[test]
fn cameras_that_look_nowhere_are_refused_in_the_same_words() {
    let folder = folder();
    let mesh = write(folder.path(), "a.obj", TRIANGLE);
    for (options, lines, why) in [
        (
            &["--eye", "0,0,5", "--target", "0,0,0", "--up", "0,0,0"][..],
            "eye = [0, 0, 5]\ntarget = [0, 0, 0]\nup = [0, 0, 0]",
            "an up of [0.0, 0.0, 0.0] cannot be used: expected a direction",
        ),
        (
            &["--eye", "0,0,5", "--target", "0,0,0", "--up", "0,0,-2"],
            "eye = [0, 0, 5]\ntarget = [0, 0, 0]\nup = [0, 0, -2]",
            "an up of [0.0, 0.0, -2.0] cannot be used: it lies along the view",
        ),
        (
            &["--eye", "1,2,3", "--target", "1,2,3"],
            "eye = [1, 2, 3]\ntarget = [1, 2, 3]",
            "a camera cannot look from [1.0, 2.0, 3.0] at the same point",
        ),
    ] {
        let message = refuse(2, render(&mesh, options));
        assert!(message.contains(why), "{message}");
        let scene = format!("[camera]\n{lines}\n[[object]]\nmesh = \"a.obj\"\n");
        let scene = write(folder.path(), "a.raycast.toml", scene);
        let message = refuse(1, render(&scene, &[]));
        assert!(message.contains(why), "{message}");
    }
    let message = refuse(2, render(&mesh, &["--step", "1e-320"]));
    assert!(
        message.contains("a step of 1e-320 cannot be used"),
        "{message}"
    );
    for (option, key) in [
        ("--samples=4097", "[image]\nsamples = 4097"),
        ("--wireframe=101", "[shading]\nwireframe-width = 101.0"),
        (
            "--wireframe-hidden=1.5",
            "[shading]\nwireframe-hidden = 1.5",
        ),
    ] {
        let by_option = refuse(2, render(&mesh, &[option]));
        let scene = format!("{key}\n[[object]]\nmesh = \"a.obj\"\n");
        let scene = write(folder.path(), "b.raycast.toml", scene);
        let by_file = refuse(1, render(&scene, &[]));
        let (_, words) = by_file.rsplit_once(": ").expect("a place and a reason");
        assert!(by_option.contains(words.trim()), "{by_option} / {by_file}");
    }
}

/// Whatever a scene file holds, the two agree on whether it can be read.
#[test]
fn render_and_info_agree_on_scenes() {
    let folder = folder();
    write(folder.path(), "a.obj", TRIANGLE);
    let object = "[[object]]\nmesh = \"a.obj\"\n";
    for (text, is_good) in [
        (String::new(), true),
        (
            "[camera]\neye = [0, 0, 1]\ntarget = [0, 0, 0]\n".to_owned(),
            true,
        ),
        (object.to_owned(), true),
        (format!("{object}scale = [0, 0, 0]\n"), true),
        (format!("{object}translate = [3e18, 0, 0]\n"), true),
        (
            format!("{object}translate = [1e308, 0, 0]\nscale = [1e308, 1, 1]\n"),
            true,
        ),
        (format!("{object}rotate = [inf, 0, 0]\n"), false),
        (format!("[image]\nsamples = 4097\n{object}"), false),
        (format!("{object}parent = \"b\"\n"), false),
    ] {
        let scene = write(folder.path(), "a.raycast.toml", &text);
        let information = run(&mut command(["info".as_ref(), scene.as_os_str()]));
        let picture = run(&mut command(render(&scene, &[])));
        // There is a picture of what can be seen alone; `info` says what a file holds without one.
        let is_read = picture.status == Some(0) || picture.errors.contains("nothing to see");
        assert_eq!(is_read, is_good, "{text}: {}", picture.errors);
        assert_eq!(information.status == Some(0), is_good, "{text}");
        if is_good && text != object {
            let is_told = picture.errors.contains("warning: ") || picture.status != Some(0);
            assert!(is_told, "{text}: {}", picture.errors);
            let output = String::from_utf8_lossy(&information.output);
            assert!(output.contains("warning"), "{text}: {output}");
        }
    }
}

#[test]
fn a_scene_of_which_nothing_is_left_is_refused_and_says_why() {
    let folder = folder();
    let object = format!("[[object]]\nmesh = '{}'\n", asset("cube.obj").display());
    let rays = write(folder.path(), "rays", [0; 32]);
    let [picture, hits] = ["a.png", "hits"].map(|name| folder.path().join(name));
    for (place, why) in [
        ("visible = false", "12 hidden"),
        ("scale = [0, 0, 0]", "12 scaled to nothing or too far away"),
        (
            "scale = [2, 0, 0]\nrotate = [0, 30, 40]",
            "12 scaled to nothing",
        ),
        ("translate = [0, 2e18, 0]", "too far away"),
    ] {
        let scene = write(
            folder.path(),
            "a.raycast.toml",
            format!("{object}{place}\n"),
        );
        for arguments in [
            arguments!["render", &scene, "-o", &picture, "--size", "8x8"],
            arguments!["cast", &scene, "--rays", &rays, "--hits", &hits],
            arguments!["verify", &scene, "--size", "8x8"],
        ] {
            let output = run(&mut command(&arguments));
            assert_eq!(output.status, Some(1), "{place}: {arguments:?}");
            assert!(
                output.errors.contains("nothing to see") && output.errors.contains(why),
                "{place}: {}",
                output.errors
            );
        }
    }
}
