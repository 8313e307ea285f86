//! The program's edge: exit status, standard output, mistyped commands, scenes of which nothing is left.

use raycast_tests::arguments;
use raycast_tests::binary::{ProgramOutput, command, refuse, run, succeed};
use raycast_tests::files::{asset, bytes, folder, names, write};
use std::ffi::OsString;
use std::path::Path;

// Standard output and standard error.

/// Commands that write to standard output; one of them writes a picture too.
fn talkative(picture: &Path) -> Vec<Vec<OsString>> {
    let mesh = asset("cube.obj");
    vec![
        arguments!["--help"],
        arguments!["--version"],
        arguments!["help", "cast"],
        arguments!["render", "--help"],
        arguments!["info", &mesh],
        arguments!["info", "--json", &mesh],
        arguments!["bench", &mesh, "--frames", "1", "--size", "8x8"],
        arguments!["verify", &mesh, "--size", "8x8"],
        arguments![
            "render", &mesh, "-o", picture, "--size", "4x4", "--stats", "-"
        ],
    ]
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_an_error_everywhere() {
    let full = || {
        let options = std::fs::File::options().write(true).open("/dev/full");
        options.expect("/dev/full")
    };
    let folder = folder();
    let picture = folder.path().join("a.png");
    let all = talkative(&picture);
    for arguments in all {
        let output = run(command(&arguments).stdout(full()));
        assert_eq!(output.status, Some(1), "{arguments:?}: {output:?}");
        assert_eq!(
            output.errors.lines().count(),
            1,
            "{arguments:?}: {output:?}"
        );
        assert!(output.errors.contains("standard output"), "{output:?}");
    }
    assert!(names(folder.path()).is_empty());

    // Where messages cannot be written either, the exit status still reports the failure.
    let mesh = folder.path().join("none.obj");
    for (arguments, status) in [
        (arguments!["info", &mesh], 1),
        (arguments!["frobnicate"], 2),
        (arguments!["render"], 2),
        (arguments!["info", asset("cube.obj")], 1),
    ] {
        let output = run(command(&arguments).stdout(full()).stderr(full()));
        assert_eq!(output.status, Some(status), "{arguments:?}: {output:?}");
    }
}

#[test]
fn a_closed_pipe_ends_quietly() {
    let folder = folder();
    let picture = folder.path().join("a.png");
    let all = talkative(&picture);
    let closed = || {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        writer
    };
    for arguments in all {
        let output = run(command(&arguments).stdout(closed()));
        assert_eq!(output.status, Some(0), "{arguments:?}: {output:?}");
        assert!(output.errors.is_empty(), "{arguments:?}: {output:?}");
    }
    assert_eq!(names(folder.path()), ["a.png"]);
    // Warnings and errors that nobody reads are no panic.
    let dropped = write(
        folder.path(),
        "d.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\n",
    );
    let render = arguments!["render", dropped, "-o", &picture, "--size", "4x4"];
    assert_eq!(run(command(render).stderr(closed())).status, Some(0));
    assert_eq!(run(command(["render"]).stderr(closed())).status, Some(2));
}

// Words.

#[test]
fn a_mistyped_command_is_named_with_the_nearest_one() {
    let mesh = asset("cube.obj");
    for (word, meant) in [
        ("reder", "render"),
        ("rendr", "render"),
        ("inof", "info"),
        ("stich", "stitch"),
        ("verfiy", "verify"),
    ] {
        for arguments in [
            arguments![word],
            arguments![word, &mesh],
            arguments![word, &mesh, "-o", "a.png"],
        ] {
            let line = refuse(2, arguments);
            assert!(line.contains(&format!("{word}: ")), "{line}");
            assert!(line.contains(&format!("did you mean `{meant}`?")), "{line}");
        }
    }
    let line = refuse(2, ["nonsense"]);
    assert!(line.contains("no such command and no such file"), "{line}");

    // A file of that name is a file. Without a display it is not shown, but that is another error.
    let folder = folder();
    std::fs::copy(&mesh, folder.path().join("reder")).expect("copied");
    let mut view = command(["reder"]);
    view.current_dir(folder.path());
    for variable in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        view.env_remove(variable);
    }
    let output = run(&mut view);
    assert!(!output.errors.contains("no such command"), "{output:?}");
}

#[test]
fn a_name_that_is_an_ending_alone_is_refused() {
    let folder = folder();
    let mesh = asset("cube.obj");
    for name in ["png", ".png", "exr", "a.png.bak"] {
        let mut render = command(arguments!["render", &mesh, "-o", name, "--size", "4x4"]);
        let output = run(render.current_dir(folder.path()));
        assert_eq!(output.status, Some(2), "{name}: {output:?}");
        assert!(
            output.errors.contains("expected a name that ends in .png"),
            "{output:?}"
        );
        let path = folder.path().join(name);
        refuse(2, arguments!["render", &mesh, "-o", path, "--size", "4x4"]);
    }
    assert!(names(folder.path()).is_empty());
}

#[test]
fn short_colours_are_colours() {
    let folder = folder();
    let mesh = asset("cube.obj");
    let render = |name: &str, color: &str, background: &str| {
        let path = folder.path().join(name);
        let size = [
            "--size",
            "16x12",
            "--color",
            color,
            "--background",
            background,
        ];
        let mut arguments = arguments!["render", &mesh, "-o", &path];
        arguments.extend(size.map(OsString::from));
        succeed(arguments);
        bytes(&path)
    };
    let long = render("long.png", "#ff8800", "#ffffff,#001122");
    let short = render("short.png", "#f80", "#fff,#012");
    assert!(long == short);
    for bad in ["#ff", "#ffff", "#xyz"] {
        let arguments = arguments![
            "render",
            &mesh,
            "-o",
            folder.path().join("a.png"),
            "--color",
            bad
        ];
        let line = refuse(2, arguments);
        assert!(line.contains("#rgb"), "{line}");
    }
}

// Scenes of which nothing is left, and others that cannot be rendered.

/// Every command that looks at a scene, at this one.
fn looks(scene: &Path, folder: &Path) -> Vec<Vec<OsString>> {
    let rays = write(folder, "rays", [0; 32]);
    let at = |name: &str| folder.join(name);
    vec![
        arguments!["render", scene, "-o", at("a.png")],
        arguments!["cast", scene, "--rays", rays, "--hits", at("hits")],
        arguments!["verify", scene],
        arguments!["report", scene, "-o", at("report"), "--quick"],
    ]
}

#[test]
fn a_mesh_of_which_nothing_is_left_is_an_error_that_says_why() {
    let folder = folder();
    let write = |name: &str, text: &str| write(folder.path(), name, text);
    let lost = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv nan 0 0\nf 1 2 3\nf 1 1 2\nf 1 2 4\n";
    let far = "v 1e30 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    write(
        "cube.obj",
        &String::from_utf8_lossy(&bytes(&asset("cube.obj"))),
    );
    for (name, text, said) in [
        (
            "lost.obj",
            lost,
            "all of its 3 triangles were dropped: 2 without area, 1 not finite",
        ),
        (
            "far.obj",
            far,
            "its one triangle was dropped: 1 too far away",
        ),
        (
            "empty.raycast.toml",
            "[image]\nsize = [8, 8]\n",
            "it holds no triangle",
        ),
        (
            "moved.raycast.toml",
            "[[object]]\nmesh = \"cube.obj\"\nscale = [1e300, 1.0, 1.0]\n",
            "all of its 12 triangles were dropped: 12 too far away",
        ),
    ] {
        let scene = write(name, text);
        let before = names(folder.path()).len();
        for arguments in looks(&scene, folder.path()) {
            let line = refuse(1, &arguments);
            assert!(
                line.contains(name) && line.contains(said),
                "{arguments:?}: {line}"
            );
        }
        // Nothing but the rays, and the folder that the report would have been in.
        let left = names(folder.path());
        assert!(
            left.len() <= before + 2 && !folder.path().join("a.png").exists(),
            "{left:?}"
        );
        succeed(arguments!["info", &scene]);
    }
}

#[test]
fn info_and_render_agree_on_scenes() {
    let folder = folder();
    std::fs::copy(asset("cube.obj"), folder.path().join("cube.obj")).expect("copied");
    let object = "[[object]]\nmesh = \"cube.obj\"\n";
    let other = "[[object]]\nmesh = \"cube.obj\"\nscale = [1e300, 1.0, 1.0]\n";
    let camera = |eye: &str, more: &str| {
        format!("[camera]\neye = [{eye}, 0, 0]\ntarget = [0, 0, 0]\n{more}{object}")
    };
    for (text, status) in [
        (object.to_owned(), 0),
        // One object is far too large, and is left out; the other is seen.
        (format!("{object}{other}"), 0),
        (
            format!("[image]\nsamples = 4096\nsize = [1, 1]\n{object}"),
            0,
        ),
        (
            format!("[image]\nsamples = 4097\nsize = [1, 1]\n{object}"),
            1,
        ),
        (camera("5", ""), 0),
        (camera("1e308", "fov = 179\n"), 1),
        (
            camera("5", "projection = \"orthographic\"\nframe = 1e-323\n"),
            1,
        ),
    ] {
        let scene = write(folder.path(), "a.raycast.toml", &text);
        let picture = folder.path().join("a.png");
        let mut outputs: Vec<ProgramOutput> = Vec::new();
        for arguments in [
            arguments!["info", &scene],
            arguments!["render", &scene, "-o", &picture, "--threads", "1"],
        ] {
            outputs.push(run(&mut command(arguments)));
        }
        for output in &outputs {
            assert_eq!(output.status, Some(status), "{text}: {output:?}");
        }
        if status == 1 {
            assert_eq!(outputs[0].errors, outputs[1].errors, "{text}");
        }
    }
}
