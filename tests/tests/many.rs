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
    let apart = turned.pose().eye.distance(orbit.pose().eye);
    assert!(apart < 1e-9, "{apart}");
    assert!(turned.pose().up.distance(orbit.pose().up) < 1e-9);
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
    // All of them are the default where the name is for frames, of a plan as well.
    render(&scene, &at("all-%d.png"), &[]);
    render(&scene, &at("all.apng"), &[]);
    let mut plan = arguments!["plan", &scene, "-o", at("p"), "--pictures"];
    plan.extend(arguments![at("p-%d.png"), "--", "--size", "64x48"]);
    succeed(plan);
    let plan = String::from_utf8(bytes(&at("p"))).expect("text");
    assert_eq!(plan.lines().count(), 5);
    for frame in 0..5 {
        let one = bytes(&at(&format!("f{frame}.png")));
        assert!(one == bytes(&at(&format!("all-{frame}.png"))), "{frame}");
        let range = format!("--frames {frame}..{frame}");
        assert!(plan.contains(&range), "{plan}");
    }
    render(&scene, &at("one.png"), &["--frames", "0..4"]);
    assert!(bytes(&at("all.apng")) == bytes(&at("one.png")));
    let listed = |name: &str| names(folder.path()).contains(&name.into());
    assert!(!listed("all-%d.png") && !listed("all-5.png"));
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
    for (arguments, message) in [
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
            arguments!["render", &mesh, "-o", at("x%d.png")],
            "x%d.png: such a name is for several frames: give --turntable N",
        ),
        (
            arguments!["render", &mesh, "-o", at("x.gif")],
            "x.gif: such a name is for several frames",
        ),
        (
            arguments![
                "render",
                &scene,
                "-o",
                at("x%d.png"),
                "--save-scene",
                at("x.raycast.toml")
            ],
            "--save-scene",
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
        assert!(line.contains(message), "{line}");
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

/// The truth is the frames' own PNGs; flat colours are fewer than 256 a frame and come back exactly.
#[test]
fn a_gifs_frames_are_those_of_their_own_files() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let mesh = asset("monkey.obj");
    let turn = ["--turntable", "3", "--mode", "color"];
    let transparent = [&turn[..], &["--background", "transparent"]].concat();
    for (name, looks) in [("seen", &turn[..]), ("open", &transparent[..])] {
        let gif = at(&format!("{name}.gif"));
        render(&mesh, &gif, &[looks, &["--threads", "1"]].concat());
        render(&mesh, &at(&format!("{name}%d.png")), looks);
        let file = bytes(&gif);
        render(&mesh, &gif, &[looks, &["--threads", "2"]].concat());
        assert!(file == bytes(&gif), "{name}");
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(&file[..]).expect("a GIF");
        for frame in 0..3 {
            let found = decoder.read_next_frame().expect("a GIF").expect("a frame");
            assert_eq!(found.delay, 4);
            let one = at(&format!("{name}{frame}.png"));
            let one = ImageFile::decode(&bytes(&one)).expect("a picture");
            for (&[r, g, b, a], found) in (one.picture.pixels.iter()).zip(found.buffer.chunks(4)) {
                if a < 128 {
                    assert_eq!(found[3], 0, "{name} {frame}");
                } else {
                    assert_eq!(found, [r, g, b, 255], "{name} {frame}");
                }
            }
        }
        assert!(decoder.read_next_frame().expect("a GIF").is_none());
    }
    let rate = |rate| {
        let gif = at("rate.gif");
        arguments![
            "render",
            &mesh,
            "-o",
            gif,
            "--turntable",
            "2",
            "--size",
            "8x8",
            "--rate",
            rate
        ]
    };
    let line = refuse(2, rate("51"));
    assert!(line.contains("at most 50 frames a second"), "{line}");
    assert!(!at("rate.gif").exists());
    assert!(succeed(rate("30")).errors.contains("3 and 4 by turns"));
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
    // Picture 1 is stitched; that 0 is not is what the engine hears.
    let both = run(Command::new("sh").arg("-e").arg(at("it's a plan.stitch")));
    assert_ne!(both.status, Some(0), "{}", both.errors);
    for line in [lines[0], lines[7]] {
        assert_eq!(shell(line).status, Some(0), "{line}");
    }
    for line in stitch.lines() {
        let message = shell(line);
        assert_eq!(message.status, Some(0), "{line}: {}", message.errors);
    }
    render(&mesh, &at("whole-%d.png"), &["--turntable", "2"]);
    for frame in 0..2 {
        let [out, whole] = ["out", "whole"].map(|name| bytes(&at(&format!("{name}-{frame}.png"))));
        assert!(out == whole, "{frame}");
    }
}

/// The scripts by which an engine starts a plan's jobs: what Slurm is given, by an `sbatch` that keeps it, and what
/// Kubernetes' containers run.
#[cfg(unix)]
fn scripts(folder: &Path, plan: &Path) -> Vec<(String, &'static str)> {
    use std::os::unix::fs::PermissionsExt;
    let sbatch = write(
        folder,
        "sbatch",
        "#!/bin/sh\nn=$(ls \"$KEPT\" | wc -l)\ncat > \"$KEPT/$n\"\necho \"$n\"\n",
    );
    std::fs::set_permissions(&sbatch, std::fs::Permissions::from_mode(0o755)).expect("set");
    let kept = folder.join("kept");
    std::fs::create_dir(&kept).expect("a folder");
    let beside = |suffix: &str| {
        let mut name = plan.as_os_str().to_owned();
        name.push(suffix);
        std::path::PathBuf::from(name)
    };
    let path = std::env::var("PATH").unwrap_or_default();
    let submitted = run(Command::new("sh")
        .arg(beside(".slurm"))
        .env("PATH", format!("{}:{path}", folder.display()))
        .env("KEPT", &kept));
    assert_eq!(submitted.status, Some(0), "{}", submitted.errors);
    let mut scripts: Vec<_> = names(&kept)
        .iter()
        .map(|name| {
            let script = String::from_utf8(bytes(&kept.join(name))).expect("text");
            (script, "SLURM_ARRAY_TASK_ID")
        })
        .collect();
    for suffix in [".yaml", ".stitch.yaml"] {
        let text = String::from_utf8(bytes(&beside(suffix))).expect("text");
        let command = text
            .lines()
            .find_map(|line| line.trim().strip_prefix("command: "));
        let words: Vec<String> =
            serde_json::from_str(command.expect("a command")).expect("a list of words");
        scripts.push((words[2].clone(), "JOB_COMPLETION_INDEX"));
    }
    scripts
}

#[cfg(unix)]
#[test]
fn an_engines_job_fails_where_its_command_or_its_plan_does() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let plan = at("it's a plan");
    let mut arguments = arguments!["plan", asset("monkey.obj"), "-o", &plan, "--tiles", "2x1"];
    arguments.extend(arguments!["--program", raycast_tests::binary::path(), "--"]);
    arguments.extend(arguments!["--size", "64x48"]);
    succeed(&arguments);
    let scripts = scripts(folder.path(), &plan);
    assert_eq!(scripts.len(), 4);
    let status = |(script, index): &(String, &str), value: &str| {
        run(Command::new("sh").args(["-c", script]).env(index, value)).status
    };
    // Nothing is there to be stitched yet.
    for (stitch, index) in [(&scripts[1], "1"), (&scripts[3], "0")] {
        assert_ne!(status(stitch, index), Some(0), "{stitch:?}");
    }
    for (job, indices) in [(&scripts[0], ["1", "2"]), (&scripts[2], ["0", "1"])] {
        for index in indices {
            assert_eq!(status(job, index), Some(0), "{job:?}");
        }
        assert_eq!(names(&at("it's a plan.parts")).len(), 2, "{job:?}");
    }
    for (stitch, index) in [(&scripts[1], "1"), (&scripts[3], "0")] {
        assert_eq!(status(stitch, index), Some(0), "{stitch:?}");
        std::fs::remove_file(at("it's a plan.png")).expect("it was stitched");
    }
    for name in ["it's a plan", "it's a plan.stitch"] {
        std::fs::remove_file(at(name)).expect("removed");
    }
    for script in &scripts {
        assert_ne!(status(script, "1"), Some(0), "{script:?}");
    }
}

#[cfg(unix)]
#[test]
fn a_plans_jobs_find_a_texture_from_any_folder() {
    let folder = folder();
    let work = folder.path().join("work");
    std::fs::create_dir(&work).expect("a folder");
    let at = |name: &str| work.join(name);
    write(folder.path(), "skin.png", bytes(&asset("leopard.png")));
    write(&work, "a.obj", bytes(&asset("torus.obj")));
    let program = raycast_tests::binary::path();
    for (name, texture) in [
        ("one", "--texture=../skin.png"),
        ("two", "--texture ../skin.png"),
    ] {
        let mut plan = Command::new(program);
        plan.args(["plan", "a.obj", "-o", name, "--", "--size", "64x48"]);
        plan.args(["--mode", "texture"]).args(texture.split(' '));
        let message = run(plan.current_dir(&work));
        assert_eq!(message.status, Some(0), "{}", message.errors);
        for lines in [name.to_owned(), format!("{name}.stitch")] {
            let message = run(Command::new("sh")
                .arg("-e")
                .arg(at(&lines))
                .current_dir("/"));
            assert_eq!(message.status, Some(0), "{lines}: {}", message.errors);
        }
    }
    let texture = folder.path().join("skin.png").display().to_string();
    render(
        &at("a.obj"),
        &at("want.png"),
        &["--mode", "texture", "--texture", &texture],
    );
    for name in ["one.png", "two.png"] {
        assert!(bytes(&at(name)) == bytes(&at("want.png")), "{name}");
    }
}

#[test]
fn a_plan_replaces_a_plan_and_nothing_that_is_only_called_alike() {
    let folder = folder();
    let plan = folder.path().join("p");
    let arguments = arguments!["plan", asset("monkey.obj"), "-o", &plan];
    let notes = write(folder.path(), "p.yaml", "mine: true\n");
    let line = refuse(1, &arguments);
    assert!(
        line.contains("p.yaml") && line.contains("it is there already"),
        "{line}"
    );
    assert_eq!(names(folder.path()), ["p.yaml"]);
    assert_eq!(bytes(&notes), b"mine: true\n");
    std::fs::remove_file(&notes).expect("removed");
    for _ in 0..2 {
        succeed(&arguments);
    }
}

#[test]
fn a_plan_is_refused_where_its_jobs_would_be() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let scene = |mesh: &str, more: &str| {
        format!(
            "[camera]\nprojection = \"fisheye\"\neye = [4.0, 2.0, 6.0]\ntarget = [0.0, 0.0, 0.0]\n\
             [image]\nsize = [64, 64]\n[[object]]\nmesh = {mesh:?}\n{more}"
        )
    };
    let mesh = asset("cube.obj").display().to_string();
    let good = write(folder.path(), "good.raycast.toml", scene(&mesh, ""));
    let no_mesh = write(folder.path(), "a.raycast.toml", scene("gone.obj", ""));
    let no_image = scene(&mesh, "texture = \"gone.png\"\n");
    let no_image = write(folder.path(), "b.raycast.toml", no_image);
    let gone = at("gone.obj");
    let image = at("gone.png");
    let lens = ["--lens", "0.1,0,0,0,0"];
    let texture = ["--texture", image.to_str().expect("Unicode")];
    for (status, scene, options) in [
        (1, &gone, &[][..]),
        (1, &no_mesh, &[]),
        (1, &no_image, &[]),
        (1, &good, &texture),
        // What the scene file says counts: its projection has no lens, and its size fewer tiles.
        (2, &good, &lens),
        (2, &good, &["--shift", "1,0"]),
    ] {
        let mut plan = arguments!["plan", scene, "-o", at("p"), "--"];
        let mut job = arguments!["render", scene, "-o", at("p.png")];
        plan.extend(options.iter().map(OsString::from));
        job.extend(options.iter().map(OsString::from));
        assert_eq!(refuse(status, plan), refuse(status, job), "{options:?}");
        assert!(!at("p").exists());
    }
    let tiles = ["--tiles", "65x1"];
    let mut plan = arguments!["plan", &good, "-o", at("p")];
    plan.extend(tiles.iter().map(OsString::from));
    let mut job = arguments!["render", &good, "-o", at("p.png"), "--sub-camera", "64,0"];
    job.extend(tiles.iter().map(OsString::from));
    assert_eq!(refuse(2, plan), refuse(2, job));
    let pictures = at("no folder/x.png");
    let line = refuse(
        1,
        arguments!["plan", &good, "-o", at("p"), "--pictures", pictures],
    );
    assert!(line.contains("there is no directory"), "{line}");
    let line = refuse(
        2,
        arguments!["plan", &good, "-o", at("p"), "--pictures", &good],
    );
    assert!(line.contains("good.raycast.toml"), "{line}");
    assert!(!at("p").exists());
}

#[test]
fn stitching_names_all_that_is_missing_and_where() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let mesh = asset("cube.obj");
    let cells: Vec<String> = (0..16).map(|i| format!("{},{}", i % 4, i / 4)).collect();
    for cell in &cells {
        let part = at(&format!("{cell}.png"));
        render(&mesh, &part, &["--tiles", "4x4", "--sub-camera", cell]);
    }
    let stitch = || {
        let mut arguments = arguments!["stitch"];
        arguments.extend(cells.iter().map(|cell| at(&format!("{cell}.png")).into()));
        arguments.extend(arguments!["-o", at("whole.png")]);
        refuse(1, arguments)
    };
    // In the wrong place: the one that it replaced is missing.
    let last = bytes(&at("3,3.png"));
    write(folder.path(), "3,3.png", bytes(&at("2,3.png")));
    let line = stitch();
    let gap = "192 of 64 x 48 pixels are in no fragment: columns 48..63 of rows 36..47";
    assert!(
        line.contains("3,3.png and") && line.contains("2,3.png both hold") && line.contains(gap),
        "{line}"
    );
    write(folder.path(), "3,3.png", last);
    for (gone, named, rest) in [
        (2, "2 of 16 fragments are missing: ", "1,0.png"),
        (12, "12 of 16 fragments are missing: ", "1,2.png and 2 more"),
    ] {
        for cell in &cells[..gone] {
            // Some are gone already.
            let _ = std::fs::remove_file(at(&format!("{cell}.png")));
        }
        let line = stitch();
        assert!(
            line.contains(named) && line.contains("0,0.png, ") && line.ends_with(rest),
            "{line}"
        );
    }
    assert!(!at("whole.png").exists());
}

#[cfg(unix)]
#[test]
fn what_is_stitched_or_verified_is_no_pipe() {
    let folder = folder();
    // By its name it is a picture: a mesh may be a pipe.
    let pipe = folder.path().join("pipe.png");
    std::fs::rename(raycast_tests::files::pipe(folder.path()), &pipe).expect("renamed");
    let whole = folder.path().join("whole.png");
    for arguments in [
        arguments!["stitch", &pipe, "-o", &whole],
        arguments!["verify", &pipe, asset("cube.obj")],
        arguments!["plan", &pipe, "-o", folder.path().join("p")],
    ] {
        let line = refuse(1, arguments);
        assert!(
            line.ends_with("it is a pipe or a socket, not a regular file"),
            "{line}"
        );
    }
}
