//! Signals and rivals: whatever happens to a command, its output is wholly old or wholly new, and what
//! it leaves behind the next one clears away.
//!
//! `RAYCAST_SIGNALS=1000` sends so many of each signal at random moments, in place of a few.

#![cfg(unix)]
#![allow(
    clippy::print_stdout,
    reason = "tests tell what they checked and what they skipped"
)]

use raycast_oracle::random::Random;
use raycast_tests::arguments;
use raycast_tests::binary::{command, succeed};
use raycast_tests::files::{asset, bytes, folder, names, write};
use rustix::process::{Pid, Signal, kill_process};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// The signals that end a command in order, each with its exit status.
const ENDS: [(Signal, i32); 3] = [(Signal::INT, 130), (Signal::TERM, 143), (Signal::HUP, 129)];

fn send(child: &Child, signal: Signal) {
    // A command that has ended is not waited for yet: its number is still its own.
    let pid = Pid::from_raw(child.id() as i32).expect("a process");
    kill_process(pid, signal).expect("the signal is sent");
}

/// Part files in a folder.
fn parts(folder: &Path) -> usize {
    let names = names(folder).into_iter();
    names
        .filter(|name| name.to_string_lossy().ends_with(".part"))
        .count()
}

/// A command that is amid its work until its input ends: it waits for rays, with its part file there.
struct Waiting(Child);

impl Waiting {
    fn start(output: &Path) -> Self {
        let folder = output.parent().expect("a folder");
        let mesh = asset("cube.obj");
        let mut cast = command(arguments![
            "cast",
            mesh,
            "--rays",
            "/dev/stdin",
            "--hits",
            output
        ]);
        cast.stdin(Stdio::piped()).stderr(Stdio::null());
        let child = cast.spawn().expect("the program can be started");
        // It makes one to see whether it can, and removes it, before it reads the mesh: that one is there
        // for a moment.
        let own = format!(".raycast-{}-", child.id());
        let is_there = || {
            let mut names = names(folder).into_iter();
            names.any(|name| name.to_string_lossy().starts_with(&own))
        };
        let start = Instant::now();
        let mut seen = 0;
        while seen < 20 {
            seen = if is_there() { seen + 1 } else { 0 };
            assert!(start.elapsed() < Duration::from_secs(60), "no part file");
            std::thread::sleep(Duration::from_millis(5));
        }
        Self(child)
    }

    /// Waits until it ends, its input open: to wait for a child would close it.
    fn wait(mut self) -> ExitStatus {
        let input = self.0.stdin.take();
        let status = self.0.wait().expect("the program ends");
        drop(input);
        status
    }

    /// Ends its input: no rays, no hits.
    fn let_finish(mut self) -> ExitStatus {
        drop(self.0.stdin.take());
        self.wait()
    }
}

/// Whether signals that this process was started with as ignored, and so its children, have this one.
fn is_ignored_here(signal: Signal) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal.as_raw() - 1) & 1 == 1)
}

#[test]
fn a_signal_ends_a_command_with_its_own_status_and_leaves_no_file() {
    for (signal, status) in ENDS {
        if signal == Signal::HUP && is_ignored_here(signal) {
            println!("skipped: SIGHUP is ignored here, and stays so");
            continue;
        }
        for old in [None, Some("old")] {
            let folder = folder();
            let output = folder.path().join("hits");
            if let Some(old) = old {
                write(folder.path(), "hits", old);
            }
            let waiting = Waiting::start(&output);
            send(&waiting.0, signal);
            assert_eq!(waiting.wait().code(), Some(status), "{signal:?}");
            match old {
                None => assert!(names(folder.path()).is_empty()),
                Some(old) => {
                    assert_eq!(names(folder.path()), ["hits"]);
                    assert_eq!(bytes(&output), old.as_bytes());
                }
            }
        }
    }
}

/// `nohup raycast …` outlives its terminal.
#[test]
fn a_hangup_that_is_ignored_stays_ignored() {
    if !Path::new("/proc/self/status").exists() {
        println!("skipped: this system does not tell which signals are ignored");
        return;
    }
    let folder = folder();
    let output = folder.path().join("hits");
    let mut cast = std::process::Command::new("sh");
    cast.args(["-c", "trap '' HUP; exec \"$@\"", "sh"]);
    cast.arg(raycast_tests::binary::path());
    cast.args(arguments![
        "cast",
        asset("cube.obj"),
        "--rays",
        "/dev/stdin",
        "--hits",
        &output
    ]);
    let mut child = cast
        .stdin(Stdio::piped())
        .spawn()
        .expect("sh can be started");
    let start = Instant::now();
    while parts(folder.path()) == 0 {
        assert!(start.elapsed() < Duration::from_secs(60), "no part file");
        std::thread::sleep(Duration::from_millis(5));
    }
    send(&child, Signal::HUP);
    std::thread::sleep(Duration::from_millis(50));
    drop(child.stdin.take());
    assert!(child.wait().expect("it ends").success());
    assert_eq!(names(folder.path()), ["hits"]);
}

#[test]
fn what_a_killed_command_leaves_the_next_one_removes_and_nothing_else() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let killed = Waiting::start(&at("killed"));
    send(&killed.0, Signal::KILL);
    assert_eq!(killed.wait().signal(), Some(Signal::KILL.as_raw()));
    assert_eq!((parts(folder.path()), names(folder.path()).len()), (1, 1));
    for own in [".raycast-1-0.part", ".raycast-notes.part"] {
        write(folder.path(), own, "somebody's own");
    }

    let waiting = Waiting::start(&at("waiting"));
    assert_eq!(parts(folder.path()), 3, "its own, and somebody's");
    let render = arguments![
        "render",
        asset("cube.obj"),
        "-o",
        at("a.png"),
        "--size",
        "4x4"
    ];
    succeed(render);
    assert_eq!(parts(folder.path()), 3, "what is held is not removed");
    assert!(waiting.let_finish().success());
    assert_eq!(
        names(folder.path()),
        [
            ".raycast-1-0.part",
            ".raycast-notes.part",
            "a.png",
            "waiting"
        ]
    );
    assert_eq!(bytes(&at(".raycast-1-0.part")), b"somebody's own");
}

/// In a folder that anybody may write to; the superuser alone can be two users.
#[test]
fn what_a_killed_command_of_another_user_leaves_stays() {
    use std::os::unix::fs::PermissionsExt;
    use std::os::unix::process::CommandExt;
    if !rustix::process::geteuid().is_root() {
        println!("skipped: only the superuser can start programs as somebody else");
        return;
    }
    let folder = folder();
    let anybody = std::fs::Permissions::from_mode(0o777);
    std::fs::set_permissions(folder.path(), anybody).expect("set");
    let killed = Waiting::start(&folder.path().join("killed"));
    send(&killed.0, Signal::KILL);
    killed.wait();
    let left = folder.path().join(&names(folder.path())[0]);
    let mode = std::fs::Permissions::from_mode(0o666);
    std::fs::set_permissions(&left, mode).expect("set");
    let picture = folder.path().join("a.png");
    let render = arguments!["render", asset("cube.obj"), "-o", &picture, "--size", "4x4"];
    let mut other = command(&render);
    let Ok(status) = other.uid(12_345).gid(12_345).status() else {
        println!("skipped: others may not start the program here");
        return;
    };
    assert!(status.success() && picture.exists());
    assert!(left.exists(), "another user removed it");
    succeed(&render);
    assert!(!left.exists());
}

#[test]
fn of_two_writers_one_is_seen_whole() {
    let folder = folder();
    let place = folder.path().join("a.ppm");
    let render = |size: &str, place: &Path| {
        arguments![
            "render",
            asset("cube.obj"),
            "-o",
            place,
            "--size",
            size,
            "--threads",
            "1"
        ]
    };
    let sizes = ["400x300", "300x400", "64x48", "500x200"];
    let whole = sizes.map(|size| {
        let alone = folder.path().join("alone.ppm");
        succeed(render(size, &alone));
        bytes(&alone)
    });
    for _ in 0..5 {
        let writers = sizes.map(|size| {
            let mut command = command(render(size, &place));
            command.spawn().expect("the program can be started")
        });
        let reader_sees = |when: &str| {
            if place.exists() {
                assert!(
                    whole.contains(&bytes(&place)),
                    "{when}: a picture of two writers"
                );
            }
        };
        for mut writer in writers {
            reader_sees("amid");
            assert!(writer.wait().expect("it ends").success());
        }
        reader_sees("at the end");
        assert_eq!(names(folder.path()), ["a.ppm", "alone.ppm"]);
    }
}

/// How many of each signal.
fn count() -> u32 {
    let asked = std::env::var("RAYCAST_SIGNALS").ok();
    asked.and_then(|count| count.parse().ok()).unwrap_or(25)
}

/// Sends `signal` at a random moment of a render, over and over. How often the output was new.
fn interrupt(signal: Signal, status: Option<i32>, seed: u64) -> u32 {
    let folder = folder();
    let place = folder.path().join("a.ppm");
    let render = || {
        let size = ["--size", "200x150", "--threads", "1"];
        let mut render = arguments!["render", asset("monkey.obj"), "-o", &place];
        render.extend(size.map(std::ffi::OsString::from));
        render
    };
    succeed(render());
    let started = Instant::now();
    succeed(render());
    let whole_time = started.elapsed();
    let whole = bytes(&place);

    let mut random = Random::new(seed);
    let mut new = 0;
    for round in 0..count() {
        std::fs::write(&place, "old").expect("written");
        let mut command = command(render());
        let mut child = command
            .stderr(Stdio::null())
            .spawn()
            .expect("the program can be started");
        // A little longer than it takes: the end is what is of interest.
        let share = f64::from(random.below(1 << 16)) / f64::from(1 << 16);
        std::thread::sleep(whole_time.mul_f64(1.2 * share));
        send(&child, signal);
        let ended = child.wait().expect("the program ends");
        let what = format!("{signal:?}, round {round}: {ended}");
        let by_signal = ended.signal() == Some(signal.as_raw());
        assert!(
            by_signal || ended.code() == Some(0) || (status.is_some() && ended.code() == status),
            "{what}"
        );
        let left = bytes(&place);
        let is_new = left == whole;
        assert!(is_new || left == b"old", "{what}: neither old nor new");
        assert!(
            is_new || !ended.success(),
            "{what}: done, and nothing written"
        );
        new += u32::from(is_new);
        if signal == Signal::KILL {
            // At most what this one left: it removed what the one before did, if it came so far.
            assert!(names(folder.path()).len() <= 3 + round as usize, "{what}");
        } else {
            assert_eq!(names(folder.path()), ["a.ppm"], "{what}");
        }
    }
    succeed(render());
    assert_eq!(names(folder.path()), ["a.ppm"], "{signal:?}");
    assert!(bytes(&place) == whole);
    println!("{signal:?}: {} at random moments, {new} too late", count());
    new
}

/// Sends `signal` at a random moment of a deep zoom, whose tiles are files in a folder under way, over and over.
fn interrupt_deep_zoom(signal: Signal, status: Option<i32>, seed: u64) {
    let render = |folder: &Path| {
        let mut render = arguments!["render", asset("torus.obj"), "-o", folder.join("a.dzi")];
        render.extend(["--size", "2000x1500", "--mode", "flat"].map(std::ffi::OsString::from));
        render
    };
    let all = ["a.dzi", "a.html", "a_files"];
    let alone = folder();
    let started = Instant::now();
    succeed(render(alone.path()));
    let whole_time = started.elapsed();
    assert_eq!(names(alone.path()), all);

    let mut random = Random::new(seed);
    for round in 0..count() {
        let folder = folder();
        let mut child = command(render(folder.path()))
            .stderr(Stdio::null())
            .spawn()
            .expect("the program can be started");
        let share = f64::from(random.below(1 << 16)) / f64::from(1 << 16);
        std::thread::sleep(whole_time.mul_f64(1.1 * share));
        send(&child, signal);
        let ended = child.wait().expect("the program ends");
        if signal == Signal::KILL {
            let next = arguments![
                "render",
                asset("cube.obj"),
                "-o",
                folder.path().join("b.png")
            ];
            succeed(next);
            std::fs::remove_file(folder.path().join("b.png")).expect("it was made");
        }
        let what = format!("{signal:?}, round {round}: {ended}");
        let by_signal = ended.signal() == Some(signal.as_raw());
        assert!(
            by_signal || ended.code() == Some(0) || (status.is_some() && ended.code() == status),
            "{what}"
        );
        // The tiles are put in their place before the page, and that before the .dzi.
        let left = names(folder.path());
        assert!(
            all.iter()
                .rev()
                .zip(left.iter().rev())
                .all(|(name, left)| left == name),
            "{what}: {left:?}"
        );
        assert!(left.len() == 3 || !ended.success(), "{what}: {left:?}");
    }
}

#[test]
fn signals_amid_a_deep_zoom_leave_no_folder_under_way() {
    for (seed, (signal, status)) in ENDS.into_iter().enumerate() {
        if signal == Signal::HUP && is_ignored_here(signal) {
            println!("skipped: SIGHUP is ignored here, and stays so");
            continue;
        }
        interrupt_deep_zoom(signal, Some(status), seed as u64);
    }
    interrupt_deep_zoom(Signal::KILL, None, 99);
}

#[test]
fn signals_at_random_moments_leave_the_old_file_or_the_new_one() {
    for (seed, (signal, status)) in ENDS.into_iter().enumerate() {
        if signal == Signal::HUP && is_ignored_here(signal) {
            println!("skipped: SIGHUP is ignored here, and stays so");
            continue;
        }
        let new = interrupt(signal, Some(status), seed as u64);
        assert!(new < count(), "{signal:?}: none was in time");
    }
    let new = interrupt(Signal::KILL, None, 99);
    assert!(new < count(), "none was in time");
}
