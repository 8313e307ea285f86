//! The real window, on a screen of the tests' own: it opens, answers to the mouse, and fills in.
//!
//! Where Xvfb, xdotool or ImageMagick is missing this says so and passes, except in CI, where it
//! fails. Time never decides here, short of the extreme: machines differ.

#![allow(
    clippy::print_stdout,
    reason = "tests tell what they checked and what they skipped"
)]

use raycast_tests::binary::{command, succeed};
use raycast_tests::files::folder_with;
use raycast_tests::models;
use raycast_tests::screen::{OnScreen, Program, Screen, Shot, missing_programs};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::Duration;

const SIZE: (u32, u32) = (1600, 1000);

/// A window on a screen.
struct Window {
    // In this order: the program ends before its screen does.
    program: Program,
    screen: Screen,
    home: tempfile::TempDir,
}

impl OnScreen for Window {
    fn screen_and_program(&mut self) -> (&Screen, &mut Program) {
        (&self.screen, &mut self.program)
    }
}

impl Window {
    fn open(files: &[PathBuf]) -> Self {
        let screen = Screen::start(SIZE.0, SIZE.1);
        let home = tempfile::tempdir().expect("a folder for temporary files");
        let mut command = command(["view"]);
        if has_log() {
            command.arg("--log").arg(home.path().join("log"));
        }
        command.args(files);
        let program = screen.start_program(&mut command, home.path());
        let mut window = Self {
            program,
            screen,
            home,
        };
        let id = window.wait_for("a window", |window| window.screen.window());
        window.screen.place(&id, SIZE);
        window
    }

    /// The lines of the window's log, as far as they are whole.
    fn log(&self) -> Vec<Value> {
        let text = std::fs::read_to_string(self.home.path().join("log")).unwrap_or_default();
        text.lines()
            .filter_map(|line| serde_json::from_str(line).ok())
            .collect()
    }

    /// The screen once the full picture stands: the log says that it is complete, and two
    /// screenshots 300 ms apart show the same.
    fn settled(&mut self, is_as_expected: impl Fn(&Shot) -> bool) -> Shot {
        self.wait_for("picture that stands", |window| {
            let before = window.screen.shot();
            std::thread::sleep(Duration::from_millis(300));
            let after = window.screen.shot();
            let log = window.log();
            let frames = log.iter().rev().find(|line| line.get("frame_ms").is_some());
            let is_complete = frames.map_or(!has_log(), |line| line["complete"] == true);
            (is_complete && before == after && is_as_expected(&after)).then_some(after)
        })
    }

    /// Opens a line for text with a key, and waits until it is on the screen, which stood before.
    fn open_line(&mut self, key: &str) {
        let before = self.screen.shot();
        self.screen.xdotool(&["key", key]);
        self.wait_for("a line for text", |window| {
            (window.screen.shot() != before).then_some(())
        });
    }

    /// Sends the program a signal.
    fn signal(&self, name: &str) {
        let id = self.program.id().to_string();
        let sent = Command::new("kill").args(["-s", name, &id]).status();
        assert!(sent.is_ok_and(|status| status.success()), "{name}");
    }

    /// Types a text and accepts it.
    fn enter(&self, text: &str) {
        self.screen.xdotool(&["type", "--delay", "5", text]);
        self.screen.xdotool(&["key", "Return"]);
    }

    /// Drags the picture with a mouse button, in steps as a hand does it.
    fn drag(&self, button: &str, from: (u32, u32), to: (u32, u32)) {
        let at = |(x, y): (u32, u32)| {
            let (x, y) = (x.to_string(), y.to_string());
            self.screen.xdotool(&["mousemove", &x, &y]);
            std::thread::sleep(Duration::from_millis(15));
        };
        at(from);
        self.screen.xdotool(&["mousedown", button]);
        let steps = 20;
        for step in 1..=steps {
            let between = |a: u32, b: u32| (a * (steps - step) + b * step) / steps;
            at((between(from.0, to.0), between(from.1, to.1)));
        }
        self.screen.xdotool(&["mouseup", button]);
    }
}

/// Whether this window writes a log of its frames.
fn has_log() -> bool {
    static HAS_LOG: OnceLock<bool> = OnceLock::new();
    *HAS_LOG.get_or_init(|| {
        let help = succeed(["view", "--help"]).output;
        String::from_utf8_lossy(&help).contains("--log")
    })
}

fn can_run() -> bool {
    let missing = missing_programs();
    if missing.is_empty() {
        return true;
    }
    assert!(
        std::env::var_os("CI").is_none(),
        "CI must have {missing:?}: see .ci/run"
    );
    println!("SKIPPED: the window's test needs {missing:?}");
    false
}

/// Opens files, orbits, zooms: each time the picture changes, and fills in.
fn assert_window_works(files: &[PathBuf]) {
    let mut window = Window::open(files);
    // A picture, not the background alone: many colours, and as fine as pixels are.
    let is_picture = |shot: &Shot| shot.middle().colors() > 100;
    let first = window.settled(is_picture);
    assert_eq!(first.0.dimensions(), SIZE);

    let (x, y) = (SIZE.0 / 2, SIZE.1 / 2);
    window.drag("1", (x, y), (x + 170, y + 40));
    let orbited =
        window.settled(|shot| is_picture(shot) && shot.middle().difference(&first.middle()) > 0.02);

    window
        .screen
        .xdotool(&["mousemove", &x.to_string(), &y.to_string()]);
    for _ in 0..3 {
        // The wheel, away from the hand.
        window.screen.xdotool(&["click", "4"]);
    }
    let zoomed = window
        .settled(|shot| is_picture(shot) && shot.middle().difference(&orbited.middle()) > 0.02);

    window.drag("3", (x, y), (x - 90, y + 60));
    window.settled(|shot| is_picture(shot) && shot.middle().difference(&zoomed.middle()) > 0.02);

    // The interface kept answering: no frame of it near a second, on any machine.
    if !has_log() {
        return;
    }
    let log = window.log();
    let frames: Vec<f64> = log
        .iter()
        .filter_map(|line| line["frame_ms"].as_f64())
        .collect();
    let slowest = frames.iter().copied().fold(0.0, f64::max);
    println!("{} frames, the slowest {slowest} ms", frames.len());
    assert!(frames.len() > 20, "{} frames", frames.len());
    assert!(slowest < 5000.0, "a frame of {slowest} ms");
    let coarse = log
        .iter()
        .filter(|line| line["stride"].as_u64() > Some(1))
        .count();
    println!("{coarse} frames showed a coarse picture");
}

#[test]
fn the_demo_scene_opens_orbits_and_fills_in() {
    if can_run() {
        let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets");
        assert_window_works(&[assets.join("demo.raycast.toml")]);
    }
}

/// With no file there is a scene all the same: it is in the binary.
#[test]
fn no_file_opens_a_scene() {
    if can_run() {
        let mut window = Window::open(&[]);
        let shot = window.settled(|shot| shot.middle().colors() > 10);
        assert!(shot.colors() > 50, "{}", shot.colors());
    }
}

#[test]
fn the_bunny_opens_orbits_and_fills_in() {
    if let Some(bunny) = models::file("stanford-bunny.obj")
        && can_run()
    {
        assert_window_works(&[bunny]);
    }
}

/// The window says that a file is missing, and stays open.
#[test]
fn a_missing_file_does_not_end_the_session() {
    if !can_run() {
        return;
    }
    let mut window = Window::open(&[Path::new("/none/at-all.obj").to_owned()]);
    std::thread::sleep(Duration::from_secs(2));
    window.wait_for("the window's contents", |window| {
        (window.screen.shot().colors() > 20).then_some(())
    });
    assert_eq!(window.program.ended(), None);
}

/// What a person does in a sitting, through the keyboard alone: adds a file, hides what is marked, takes that
/// back, names it, saves the scene, and opens it again.
#[test]
fn a_scene_is_put_together_saved_and_opened_again() {
    if !can_run() {
        return;
    }
    let folder = folder_with(&["cube.obj", "cube.mtl", "torus.obj", "torus.mtl"]);
    let mut window = Window::open(&[folder.path().join("cube.obj")]);
    let is_picture = |shot: &Shot| shot.middle().colors() > 3;
    let cube = window.settled(is_picture);
    let keys = |window: &Window, keys: &[&str]| {
        window
            .screen
            .xdotool(&[&["key", "--delay", "60"], keys].concat());
    };
    window.open_line("ctrl+shift+o");
    let torus = folder.path().join("torus.obj").display().to_string();
    let before_last = torus.trim_end_matches('j');
    window
        .screen
        .xdotool(&["type", "--delay", "60", before_last]);
    window.settled(|_| true);
    // The last letter and Enter come in one frame, as from fast hands on a slow machine: the popup offers the name still.
    window.signal("STOP");
    keys(&window, &["j", "Return"]);
    window.signal("CONT");
    // The torus is in the middle, too: the path line alone would be another picture of the cube.
    let both = window.settled(|shot| shot.middle().difference(&cube.middle()) > 0.01);

    // A click on the picture marks the object there; h hides it.
    let middle = [(SIZE.0 / 2 - 140).to_string(), (SIZE.1 / 2).to_string()];
    window
        .screen
        .xdotool(&["mousemove", &middle[0], &middle[1], "click", "1"]);
    std::thread::sleep(Duration::from_millis(500));
    keys(&window, &["h"]);
    window.settled(|shot| shot.middle().difference(&both.middle()) > 0.02);
    keys(&window, &["ctrl+z", "F2"]);
    std::thread::sleep(Duration::from_millis(300));
    window.screen.xdotool(&["type", "--delay", "5", "lid"]);
    keys(&window, &["Return"]);

    let scene = folder.path().join("both.raycast.toml");
    window.settled(is_picture);
    window.open_line("ctrl+s");
    keys(&window, &["ctrl+a"]);
    window.enter(&scene.display().to_string());
    let text = window.wait_for("saved scene", |_| std::fs::read_to_string(&scene).ok());
    assert!(
        text.contains("\"lid\"") && !text.contains("visible"),
        "{text}"
    );
    assert_eq!(text.matches("[[object]]").count(), 2, "{text}");

    // It is what the command line renders, too, and the window opens.
    let picture = folder.path().join("both.png");
    succeed([
        "render".as_ref(),
        scene.as_os_str(),
        "-o".as_ref(),
        picture.as_os_str(),
    ]);
    drop(window);
    let mut window = Window::open(&[scene]);
    window.settled(is_picture);
}

/// The square in the middle of the handles moves the marked object with the hand; Escape puts it back.
#[test]
fn a_handle_moves_the_marked_object_and_escape_gives_a_drag_up() {
    if !can_run() {
        return;
    }
    let folder = folder_with(&["cube.obj", "cube.mtl"]);
    let mut window = Window::open(&[folder.path().join("cube.obj")]);
    window.settled(|shot| shot.middle().colors() > 3);
    // From the front the cube's middle is in that of the picture: left of the panel, between menu and status.
    let (x, y) = ((SIZE.0 - 288) / 2, SIZE.1 / 2);
    window.screen.xdotool(&["key", "--delay", "60", "1", "f"]);
    window.settled(|_| true);
    let at = [x.to_string(), y.to_string()];
    window
        .screen
        .xdotool(&["mousemove", &at[0], &at[1], "click", "1"]);
    std::thread::sleep(Duration::from_millis(500));
    window.screen.xdotool(&["key", "g"]);
    let before = window.settled(|_| true);
    window.drag("1", (x, y), (x + 120, y));
    window.settled(|shot| shot.middle().difference(&before.middle()) > 0.02);

    let save = |window: &mut Window, name: &str| {
        let scene = folder.path().join(name);
        window.settled(|_| true);
        window.open_line("ctrl+shift+s");
        window.screen.xdotool(&["key", "ctrl+a"]);
        window.enter(&scene.display().to_string());
        window.wait_for("saved scene", |_| std::fs::read_to_string(&scene).ok())
    };
    let moved = save(&mut window, "moved.raycast.toml");
    assert!(moved.contains("translate"), "{moved}");

    // Where the middle is now, and away with the hand; Escape before it lets go.
    let hand = |window: &Window, x: u32| {
        let at = [x.to_string(), y.to_string()];
        window.screen.xdotool(&["mousemove", &at[0], &at[1]]);
        std::thread::sleep(Duration::from_millis(150));
    };
    let stands = window.settled(|_| true);
    hand(&window, x + 120);
    window.screen.xdotool(&["mousedown", "1"]);
    (1..=10).for_each(|step| hand(&window, x + 120 - 20 * step));
    window.settled(|shot| shot.middle().difference(&stands.middle()) > 0.02);
    window.screen.xdotool(&["key", "Escape"]);
    std::thread::sleep(Duration::from_millis(300));
    hand(&window, x - 200);
    window.screen.xdotool(&["mouseup", "1"]);
    // The camera is in it, too: a hand beside the handle would have orbited.
    assert_eq!(save(&mut window, "again.raycast.toml"), moved);
}

/// A bad file beside a good one; a file added, a cut, its outline, an object that is made to move with another by a drag
/// in the list, a picture: what a sitting leaves behind is there, and is sound.
#[test]
fn a_sitting_leaves_its_outline_its_picture_and_a_scene_with_a_parent() {
    if !can_run() {
        return;
    }
    let folder = folder_with(&["cube.obj", "cube.mtl", "torus.obj", "torus.mtl"]);
    let bad = folder.path().join("bad.obj");
    std::fs::write(&bad, "v 0 0 0\nf 1 2 x\n").expect("written");
    let files = ["cube.obj", "torus.obj"].map(|name| folder.path().join(name));
    let [cube, torus] = files;
    let mut window = Window::open(&[cube, torus, bad]);
    let is_picture = |shot: &Shot| shot.middle().colors() > 3;
    let both = window.settled(is_picture);
    let press = |window: &Window, keys: &[&str]| {
        window
            .screen
            .xdotool(&[&["key", "--delay", "60"], keys].concat());
        std::thread::sleep(Duration::from_millis(500));
    };
    let write = |window: &mut Window, key: &str, text: &str| {
        window.settled(|_| true);
        window.open_line(key);
        window.enter(text);
    };
    // The message about the bad file.
    press(&window, &["Escape"]);
    write(&mut window, "ctrl+p", "cut across x");
    window.settled(|shot| shot.middle().difference(&both.middle()) > 0.01);
    let outline = folder.path().join("outline.svg");
    write(&mut window, "ctrl+p", "save outline");
    std::thread::sleep(Duration::from_millis(500));
    // A whole name over the suggested one, whose ending is not marked.
    window.enter(&outline.display().to_string());
    let drawing = window.wait_for("an outline", |_| std::fs::read_to_string(&outline).ok());
    assert!(drawing.contains("<path"), "{drawing}");

    // The torus is dragged onto the cube, in the list at the top of the panel.
    let list = SIZE.0 - 288 + 60;
    window.drag("1", (list, 96), (list, 72));
    std::thread::sleep(Duration::from_millis(300));
    let scene = folder.path().join("sitting.raycast.toml");
    write(&mut window, "ctrl+s", &scene.display().to_string());
    let text = window.wait_for("a scene", |_| std::fs::read_to_string(&scene).ok());
    assert!(text.contains("parent"), "{text}");
    assert!(text.contains("[[clip]]"), "{text}");

    let picture = folder.path().join("picture.png");
    write(&mut window, "ctrl+e", &picture.display().to_string());
    window.wait_for("a picture", |_| image::open(&picture).ok());
    succeed(["info".as_ref(), scene.as_os_str()]);
}
