//! Disks that are full, folders that are read-only, files that change while they are read.

use raycast_tests::arguments;
use raycast_tests::binary::{self, ProgramOutput, command, refuse, run, run_to_any_end, succeed};
use raycast_tests::files::{asset, bytes, folder, names, write, write_rays};
use std::ffi::OsString;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};

/// A refusal: exit status 1, one line that says all of this.
fn assert_refused(message: &ProgramOutput, said: &[&str]) {
    assert_eq!(message.status, Some(1), "{message:?}");
    assert_eq!(message.errors.lines().count(), 1, "{message:?}");
    for word in said {
        assert!(message.errors.contains(word), "{message:?}");
    }
}

/// Commands that write some kilobytes to `place`, from rays in `folder`.
#[cfg(unix)]
fn writers(folder: &Path, place: &Path) -> [Vec<OsString>; 2] {
    let ray = [0.2f32, 0.2, 5.0, 0.0, 0.0, 0.0, -1.0, 9.0].map(f32::to_le_bytes);
    let rays = write(folder, "rays", ray.concat().repeat(5000));
    let mesh = asset("cube.obj");
    [
        arguments!["render", &mesh, "-o", place, "--size", "200x150"],
        arguments!["cast", &mesh, "--rays", rays, "--hits", place],
    ]
}

/// A file-size limit is an error like a full disk, not the end of the process.
#[cfg(unix)]
#[test]
fn a_file_size_limit_leaves_the_old_file_and_nothing_else() {
    let (folder, inputs) = (folder(), folder());
    let place = write(folder.path(), "a.ppm", "old");
    for arguments in writers(inputs.path(), &place) {
        let mut limited = std::process::Command::new("sh");
        // 4 blocks are 2 or 4 KiB.
        limited.args(["-c", "ulimit -f 4 && exec \"$@\"", "sh"]);
        limited.arg(binary::path()).args(&arguments);
        assert_refused(&run(&mut limited), &["a.ppm: cannot be written", "large"]);
        assert_eq!(bytes(&place), b"old", "{arguments:?}");
        assert_eq!(names(folder.path()), ["a.ppm"], "{arguments:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_an_error() {
    let folder = folder();
    let full = Path::new("/dev/full");
    let [_, cast] = writers(folder.path(), full);
    assert_refused(
        &run(&mut command(cast)),
        &["/dev/full: cannot be written", "No space"],
    );
    let picture = folder.path().join("a.png");
    let mut render = arguments!["render", asset("cube.obj"), "-o", &picture, "--size", "4x4"];
    render.extend(arguments!["--stats", full]);
    assert_refused(
        &run(&mut command(render)),
        &["/dev/full: cannot be written"],
    );
    assert!(!picture.exists(), "not without its numbers");
}

/// Runs a script that may mount, with the program as its `$1`; what it said, or nothing where it may not.
#[cfg(target_os = "linux")]
fn with_mounts(script: &str, arguments: &[&std::ffi::OsStr]) -> Option<ProgramOutput> {
    // A mount namespace of its own: what is mounted goes with it.
    let mut unshare = std::process::Command::new("unshare");
    unshare.args(["--mount", "sh", "-c", script, "sh"]);
    unshare.arg(binary::path()).args(arguments);
    unshare.stdin(Stdio::null());
    let output = unshare.output().ok()?;
    let message = ProgramOutput {
        status: output.status.code(),
        output: output.stdout,
        errors: String::from_utf8_lossy(&output.stderr).into_owned(),
    };
    let may_mount = String::from_utf8_lossy(&message.output).starts_with("mounted\n");
    may_mount.then_some(message)
}

#[cfg(target_os = "linux")]
#[allow(clippy::print_stdout, reason = "tests tell what they skipped")]
#[test]
fn a_full_disk_and_a_read_only_one_leave_the_old_file_and_nothing_else() {
    let folder = folder();
    let mesh = asset("cube.obj");
    let (place, mesh) = (folder.path().as_os_str(), mesh.as_os_str());
    // $2 is the folder, $3 the mesh. The picture is of 90 KB; the disk of 32.
    let full = r#"
        mount -t tmpfs -o size=32k none "$2" && echo mounted && printf old > "$2/a.ppm"
        "$1" render "$3" -o "$2/a.ppm" --size 200x150; echo status $?
        "$1" render "$3" -o "$2/b.ppm" --size 200x150; echo status $?
        ls -A "$2"; cat "$2/a.ppm"
    "#;
    let read_only = r#"
        mount -t tmpfs none "$2" && echo mounted && printf old > "$2/a.ppm"
        mount -o remount,ro "$2"
        "$1" render "$3" -o "$2/a.ppm" --size 8x8; echo status $?
        "$1" render "$3" -o "$2/b.ppm" --size 8x8; echo status $?
        ls -A "$2"; cat "$2/a.ppm"
    "#;
    for (script, said) in [
        (full, "No space left"),
        (read_only, "Read-only file system"),
    ] {
        let Some(message) = with_mounts(script, &[place, mesh]) else {
            println!("skipped: nothing can be mounted here");
            return;
        };
        let text = String::from_utf8_lossy(&message.output);
        assert_eq!(
            text, "mounted\nstatus 1\nstatus 1\na.ppm\nold",
            "{}",
            message.errors
        );
        let lines: Vec<_> = message.errors.lines().collect();
        assert_eq!(lines.len(), 2, "{lines:?}");
        for (line, name) in lines.iter().zip(["a.ppm", "b.ppm"]) {
            assert!(line.contains(name) && line.contains(said), "{line}");
        }
    }
}

/// The superuser may write anywhere: for others a folder that is read-only.
#[cfg(unix)]
#[test]
fn a_read_only_folder_is_refused_before_the_work() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let place = write(folder.path(), "a.png", "old");
    let set = |mode| {
        let mode = std::fs::Permissions::from_mode(mode);
        std::fs::set_permissions(folder.path(), mode).expect("set");
    };
    set(0o555);
    let may_write = std::fs::File::create(folder.path().join("probe")).is_ok();
    if !may_write {
        // The mesh is not there, and is not missed: the place is checked first.
        let line = refuse(
            1,
            arguments!["render", folder.path().join("none.obj"), "-o", &place],
        );
        assert!(line.contains("a.png: cannot be written"), "{line}");
        assert_eq!(bytes(&place), b"old");
    }
    set(0o755);
}

/// The rays are counted when they are opened; they are cut while the mesh is read.
#[cfg(unix)]
#[test]
fn rays_that_are_cut_while_they_are_read_are_an_error() {
    let folder = folder();
    let rays = write(folder.path(), "rays", [0; 32 * 10]);
    let hits = write(folder.path(), "hits", "old");
    let mut cast = command(arguments![
        "cast",
        "/dev/stdin",
        "--rays",
        &rays,
        "--hits",
        &hits
    ]);
    cast.stdin(Stdio::piped()).stderr(Stdio::piped());
    let mut child = cast.spawn().expect("the program can be started");
    let mut mesh = child.stdin.take().expect("its input is piped");
    let mut text = bytes(&asset("cube.obj"));
    text.extend(b"# more than a pipe holds\n".repeat(20_000));
    let (first, rest) = text.split_at(text.len() / 2);
    // It is not taken in before it is read, and the rays are opened before.
    mesh.write_all(first).expect("written");
    write(folder.path(), "rays", [0; 32 * 4]);
    mesh.write_all(rest).expect("written");
    drop(mesh);
    let output = child.wait_with_output().expect("it ends");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(errors.contains("expected 320 bytes, found 128"), "{errors}");
    assert_eq!(bytes(&hits), b"old");
    assert_eq!(names(folder.path()), ["hits", "rays"]);
}

/// A mesh that is written anew, again and again, while it is read: a picture or one line.
#[test]
fn a_mesh_that_changes_while_it_is_read_is_a_picture_or_one_line() {
    let folder = folder();
    let whole = bytes(&asset("monkey.obj"));
    let mesh = write(folder.path(), "mesh.obj", &whole);
    let place = folder.path().join("a.ppm");
    let render = arguments![
        "render",
        &mesh,
        "-o",
        &place,
        "--size",
        "8x8",
        "--threads",
        "1"
    ];
    succeed(&render);
    let length = bytes(&place).len();
    let is_done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut cut = 0;
            while !is_done.load(Ordering::Relaxed) {
                // Not renamed into place: this is how others write.
                write(folder.path(), "mesh.obj", &whole[..cut]);
                cut = (cut + 7919) % whole.len();
            }
        });
        for _ in 0..40 {
            write(folder.path(), "a.ppm", "old");
            let message = run(&mut command(&render));
            let left = bytes(&place);
            match message.status {
                Some(0) => assert_eq!(left.len(), length, "{message:?}"),
                Some(1) => {
                    assert_eq!(message.errors.lines().count(), 1, "{message:?}");
                    assert_eq!(left, b"old");
                }
                _ => panic!("{message:?}"),
            }
            assert_eq!(names(folder.path()), ["a.ppm", "mesh.obj"]);
        }
        is_done.store(true, Ordering::Relaxed);
    });
}

/// What needs more memory than there is is refused before it is begun, with the figures: the program neither ends
/// half-way, without a word, nor hangs.
#[cfg(target_os = "linux")]
#[test]
fn meshes_and_trees_beyond_memory_are_refused() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    // So many facets of nothing but zeros, of which the disk holds none.
    let facets = 4_000_000u32;
    let mut head = vec![0; 80];
    head.extend(facets.to_le_bytes());
    let mesh = write(folder.path(), "large.stl", head);
    // An OBJ, unlike an STL, is read as a whole.
    let text = write(folder.path(), "large.obj", b"v 0 0 0\n");
    let length = 84 + 50 * u64::from(facets);
    for path in [&mesh, &text] {
        let file = std::fs::File::options().write(true).open(path);
        file.and_then(|file| file.set_len(length))
            .expect("a sparse file");
    }
    write_rays(&at("rays"), &[]);
    let cast = arguments!["cast", &mesh, "--rays", at("rays"), "--hits", at("hits")];
    for (kibibytes, arguments, expected) in [
        (1_000_000, cast, "the tree over 4000000 triangles"),
        (
            1_000_000,
            arguments!["bench", "--made", "ball:6000000", "--frames", "1"],
            "ball:6000000: the tree over 6000000 triangles",
        ),
        (
            600_000,
            arguments!["info", &mesh],
            "large.stl: the tree over 4000000 triangles",
        ),
        (
            500_000,
            arguments!["info", &text],
            "large.obj: the file takes 200000084 bytes",
        ),
    ] {
        let mut shell = Command::new("sh");
        shell.arg("-c");
        shell.arg(format!(
            "ulimit -v {kibibytes}; exec timeout 60 \"$0\" \"$@\""
        ));
        shell.arg(raycast_tests::binary::path()).args(&arguments);
        let message = run(shell.stdin(Stdio::null()));
        assert_eq!(message.status, Some(1), "{arguments:?}: {}", message.errors);
        assert_eq!(message.errors.lines().count(), 1, "{}", message.errors);
        for expected in [expected, "ulimit -v"] {
            assert!(
                message.errors.contains(expected),
                "{expected}: {}",
                message.errors
            );
        }
    }
    assert_eq!(names(folder.path()), ["large.obj", "large.stl", "rays"]);
}

/// From the least address space that the program starts in: every thread and every allocation may be refused.
#[cfg(target_os = "linux")]
#[test]
fn little_address_space_is_one_line() {
    let folder = folder();
    let mesh = asset("cube.obj");
    let picture = folder.path().join("a.png");
    let limited = |kibibytes: u32, arguments: &[OsString]| {
        let mut shell = Command::new("sh");
        shell.arg("-c");
        shell.arg(format!("ulimit -v {kibibytes}; exec \"$0\" \"$@\""));
        shell.arg(binary::path()).args(arguments);
        // Without room for a signal's stack the standard library panics and aborts before the program begins.
        run_to_any_end(shell.stdin(Stdio::null()))
    };
    // Under less than it takes itself the system ends it before it begins. Arguments take some of it, too.
    let starts = |&kibibytes: &u32| limited(kibibytes, &["--version".into()]).status == Some(0);
    let least = (20_000..2_000_000).step_by(1000).find(starts);
    let least = least.expect("it starts in two gigabytes") + 100;
    let mut refused = 0;
    for kibibytes in (least..least + 70_000).step_by(1000) {
        for arguments in [
            arguments!["info", &mesh],
            arguments!["render", &mesh, "-o", &picture, "--size", "64x48"],
            arguments!["stitch", &mesh, "-o", &picture],
        ] {
            let message = limited(kibibytes, &arguments);
            let lines = message.errors.lines().count();
            match message.status {
                Some(0) => assert_eq!(lines, 0, "{kibibytes}: {message:?}"),
                Some(1) => {
                    assert_eq!(lines, 1, "{kibibytes}: {message:?}");
                    refused += u32::from(message.errors.contains("(ulimit -v)"));
                }
                // Where not even some bytes are left, the standard library ends the process and says so.
                None => {}
                _ => panic!("{kibibytes}: {arguments:?}: {message:?}"),
            }
        }
    }
    assert!(refused > 20, "{refused}");
}

#[cfg(unix)]
#[test]
fn rays_are_read_from_no_device() {
    let folder = folder();
    let hits = folder.path().join("hits");
    let line = refuse(
        1,
        arguments![
            "cast",
            asset("cube.obj"),
            "--rays",
            "/dev/zero",
            "--hits",
            &hits
        ],
    );
    assert!(line.contains("found a device"), "{line}");
    assert!(names(folder.path()).is_empty());
}
