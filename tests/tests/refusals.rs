//! What the program refuses is one line with its place, an exit status, and no file left behind.

use raycast_oracle::random::Random;
use raycast_tests::arguments;
use raycast_tests::binary::{command, refuse, run};
use raycast_tests::files::{asset, bytes, folder, names, write};
use std::ffi::OsString;
use std::path::Path;

/// A render that must be refused: one line that names `named`, and no file left.
fn refuse_render(status: i32, mesh: &Path, more: &[&str], named: &str) {
    let folder = folder();
    let mut arguments = arguments!["render", mesh, "-o", folder.path().join("a.png")];
    arguments.extend(more.iter().map(OsString::from));
    let line = refuse(status, arguments);
    assert!(line.contains(named), "{line:?} does not say {named:?}");
    assert!(names(folder.path()).is_empty(), "{more:?}: a file was left");
}

#[test]
fn bad_files_are_one_line_and_exit_1() {
    let folder = folder();
    refuse_render(1, &folder.path().join("none.obj"), &[], "none.obj");
    refuse_render(1, folder.path(), &[], &folder.path().display().to_string());
    for name in ["empty.obj", "empty.txt", "empty"] {
        refuse_render(1, &write(folder.path(), name, b""), &[], name);
    }
    let picture = bytes(&asset("leopard.png"));
    for name in ["picture.obj", "picture.txt", "picture.png", "picture"] {
        refuse_render(1, &write(folder.path(), name, &picture), &[], name);
    }
    for (name, text, place) in [
        (
            "vertices.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\n",
            "vertices.obj",
        ),
        ("cut.obj", "v 0 0 0\nv 1 0 0\nv 0 1", "cut.obj:3"),
        (
            "word.obj",
            "v 0 0 0\nv 1 0 zero\nv 0 1 0\nf 1 2 3\n",
            "word.obj:2",
        ),
        (
            "face.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 x\n",
            "face.obj:4",
        ),
        (
            "cut.txt",
            "(0,0,0);(1,0,0);(0,1,0)\n(0,0,0);(1,0,0);(0,",
            "cut.txt:2",
        ),
        ("two.txt", "(0,0,0);(1,0,0)\n", "two.txt:1"),
        ("bad.raycast.toml", "[camera\n", "bad.raycast.toml:1"),
    ] {
        refuse_render(1, &write(folder.path(), name, text.as_bytes()), &[], place);
    }
}

/// A file that ends anywhere: a picture, or one line; never a panic, and no file left with an error.
#[test]
fn a_mesh_cut_anywhere_is_a_picture_or_one_line() {
    let whole = bytes(&asset("cube.obj"));
    let folder = folder();
    let mut random = Random::new(5);
    let mut refused = 0;
    for _ in 0..25 {
        let length = random.below(whole.len() as u32) as usize;
        let mesh = write(folder.path(), "cut.obj", &whole[..length]);
        let output = folder.path().join("a.png");
        let mut command = command(arguments![
            "render", &mesh, "-o", &output, "--size", "16x16"
        ]);
        let message = run(&mut command);
        match message.status {
            Some(0) => std::fs::remove_file(&output).expect("a picture"),
            Some(1) => {
                refused += 1;
                let place = mesh.display().to_string();
                assert_eq!(
                    message.errors.lines().count(),
                    1,
                    "{length}: {}",
                    message.errors
                );
                assert!(
                    message.errors.contains(&place),
                    "{length}: {}",
                    message.errors
                );
                assert!(!output.exists(), "{length}");
            }
            status => panic!("{length}: {status:?}: {}", message.errors),
        }
    }
    assert!(refused > 5, "{refused}");
}

#[test]
fn bad_usage_is_one_line_and_exits_2() {
    let mesh = asset("cube.obj");
    for (more, named) in [
        (&["--size", "0x5"][..], "0x5"),
        (&["--size", "5x0"], "5x0"),
        (&["--size", "-5x5"], "-5"),
        (&["--size", "99999999x5"], "size"),
        (
            &["--size", "100x100", "--step", "0.5", "--fov", "10"],
            "odds",
        ),
        (&["--step", "0"], "step"),
        (&["--step", "nan"], "step"),
        (&["--fov", "180"], "fov"),
        (&["--eye", "1,2"], "eye"),
        (&["--mode", "beautiful"], "beautiful"),
        (&["--tiles", "3x2", "--tile-size", "5"], "tile"),
        (&["--tiles", "3x2", "--sub-camera", "3,0"], "3,0"),
        (&["--sub-camera", "0,0"], "tile"),
        (&["--threads", "many"], "many"),
        (&["--frobnicate"], "frobnicate"),
    ] {
        refuse_render(2, &mesh, more, named);
    }
    refuse(2, ["render"]);
    refuse(2, arguments!["render", &mesh]);
    let folder = folder();
    let line = refuse(
        2,
        arguments!["render", &mesh, "-o", folder.path().join("a.gif")],
    );
    assert!(line.contains("a.gif"), "{line}");
    assert!(names(folder.path()).is_empty());
}

#[test]
fn outputs_that_cannot_be_are_one_line_and_exit_1() {
    let mesh = asset("cube.obj");
    let folder = folder();
    let taken = folder.path().join("taken.png");
    std::fs::create_dir(&taken).expect("a folder can be made");
    let mut places = vec![folder.path().join("none").join("a.png"), taken];
    if cfg!(target_os = "linux") {
        // Even the superuser makes no file there.
        places.push("/proc/a.png".into());
    }
    for place in places {
        let line = refuse(
            1,
            arguments!["render", &mesh, "-o", &place, "--size", "8x8"],
        );
        assert!(line.contains(&place.display().to_string()), "{line}");
    }
    assert_eq!(names(folder.path()), ["taken.png"]);
}

/// An output that is an input would lose the mesh.
#[test]
fn an_input_is_not_overwritten() {
    let folder = folder();
    let mesh = write(folder.path(), "mesh.png", bytes(&asset("cube.obj")));
    let mut command = command(arguments!["render", &mesh, "-o", &mesh, "--size", "8x8"]);
    let message = run(&mut command);
    assert!(
        message.status == Some(1) || message.status == Some(2),
        "{message:?}"
    );
    assert!(bytes(&mesh) == bytes(&asset("cube.obj")));
}

#[test]
fn a_field_of_view_is_one_that_the_projection_can_have() {
    let mesh = asset("cube.obj");
    for (projection, fov, named) in [
        ("perspective", "180", "below 180 degrees"),
        ("equirectangular", "181", "180 degrees at most"),
        ("cylindrical", "180", "179 degrees at most"),
        ("fisheye:stereographic", "360", "359 degrees at most"),
        ("cubemap", "91", "90 degrees at most"),
    ] {
        let options = ["--projection", projection, "--fov", fov, "--size", "8x8"];
        refuse_render(2, &mesh, &options, named);
    }
}
