//! The window for long: files are opened one after another, good, broken and large, with orbits,
//! modes, sizes and saves between them. Memory, open files and threads stay what they were.
//!
//! `RAYCAST_SOAK_SECONDS` says how long (30 where it is not set), `RAYCAST_SOAK_SAMPLES` names a CSV
//! file for what was measured. CONTRIBUTING.md tells of the hour before a release.
//!
//! Where Xvfb, xdotool or ImageMagick is missing this says so and passes, except in CI, where it
//! fails.

#![cfg(target_os = "linux")]
#![allow(
    clippy::print_stdout,
    reason = "tests tell what they measured and what they skipped"
)]

use raycast_tests::binary::command;
use raycast_tests::process::Usage;
use raycast_tests::screen::{OnScreen, Program, Screen, missing_programs};
use raycast_tests::soak_files::{Kind, SoakFiles};
use serde_json::Value;
use std::fmt::Write;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// As long as a person waits before trying again.
const SETTLE_TIME: Duration = Duration::from_secs(10);

/// The window's sizes; the first is that of the screen, and of every rest.
const SIZES: [(u32, u32); 3] = [(1280, 800), (900, 700), (640, 480)];

/// The file that is shown at every rest.
const REST_FILE: &str = "part.obj";

/// What makes glibc map all that is as large as 128 kB by itself, and give it back when it is
/// freed. What it keeps for later otherwise (up to 64 MB an arena: mallopt(3), `M_TRIM_THRESHOLD`) is not
/// lost, but hides what is.
const ALLOCATOR_OPTIONS: &str =
    "glibc.malloc.mmap_threshold=131072:glibc.malloc.trim_threshold=131072";

/// How much more memory may be resident at a late rest than at an early one, in kB.
///
/// Between one rest and the next with nothing lost it differed by up to 9 MB: small things lie in other
/// places, and keep the pages around them. A thousand files that lost 16 kB each would go beyond this.
const SLACK_KB: u64 = 16 * 1024;

struct Window {
    // In this order: the program ends before its screen does.
    program: Program,
    screen: Screen,
    home: tempfile::TempDir,
    files: SoakFiles,
    id: String,
    /// How often something had to be asked for twice.
    retries: u32,
}

impl OnScreen for Window {
    fn screen_and_program(&mut self) -> (&Screen, &mut Program) {
        (&self.screen, &mut self.program)
    }
}

impl Window {
    fn open() -> Self {
        let screen = Screen::start(SIZES[0].0, SIZES[0].1);
        let home = tempfile::tempdir().expect("a folder for temporary files");
        let files = SoakFiles::new(home.path()).expect("files can be written");
        let mut command = command(["view", REST_FILE, "--log", "log"]);
        // No desktop's dialog may come up, here or where the person sits: a path is typed.
        command.current_dir(home.path()).env("PATH", "");
        command.env("DBUS_SESSION_BUS_ADDRESS", "unix:path=/none");
        command.env("GLIBC_TUNABLES", ALLOCATOR_OPTIONS);
        let program = screen.start_program(&mut command, home.path());
        let mut window = Self {
            program,
            screen,
            home,
            files,
            id: String::new(),
            retries: 0,
        };
        window.id = window.wait_for("a window", |window| window.screen.window());
        window.screen.place(&window.id, SIZES[0]);
        window.wait_for("a scene", |window| window.shows(REST_FILE).then_some(()));
        window
    }

    fn usage(&self) -> Usage {
        Usage::of(self.program.id()).expect("the window runs")
    }

    fn title(&self) -> String {
        let message = self.screen.xdotool(&["getwindowname", &self.id]);
        // Without the mark of changes that are not saved.
        let title = String::from_utf8_lossy(&message.stdout).replace(" *", "");
        title.trim().to_owned()
    }

    /// Whether a file is shown before long: its name is in the title, its picture complete.
    fn shows(&mut self, name: &str) -> bool {
        let start = Instant::now();
        while start.elapsed() < SETTLE_TIME {
            if self.title().starts_with(name) {
                self.settle();
                return true;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        false
    }

    /// Waits until the picture that was asked for last is complete.
    fn settle(&mut self) {
        self.wait_for("complete picture", |window| {
            let line = window.last_line_of_log()?;
            (line["complete"] == true).then_some(())
        });
    }

    fn log_length(&self) -> u64 {
        let log = std::fs::metadata(self.home.path().join("log"));
        log.map_or(0, |log| log.len())
    }

    /// The window's log from a place on; the log of an hour is long.
    fn log_from(&self, start: u64) -> Option<Vec<Value>> {
        let mut file = File::open(self.home.path().join("log")).ok()?;
        file.seek(SeekFrom::Start(start)).ok()?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).ok()?;
        let text = String::from_utf8_lossy(&bytes);
        let lines = text.lines();
        Some(
            lines
                .filter_map(|line| serde_json::from_str(line).ok())
                .collect(),
        )
    }

    fn frames_since(&self, start: u64) -> usize {
        let lines = self.log_from(start).unwrap_or_default();
        lines
            .iter()
            .filter(|line| line.get("frame_ms").is_some())
            .count()
    }

    /// The last line of the log that tells of a frame.
    fn last_line_of_log(&self) -> Option<Value> {
        const END: u64 = 4096;
        let lines = self.log_from(self.log_length().saturating_sub(END))?;
        lines
            .into_iter()
            .rev()
            .find(|line| line.get("frame_ms").is_some())
    }

    fn resize(&self, (width, height): (u32, u32)) {
        let (width, height) = (width.to_string(), height.to_string());
        self.screen
            .xdotool(&["windowsize", &self.id, &width, &height]);
    }

    fn keys(&self, keys: &[&str]) {
        self.screen
            .xdotool(&[&["key", "--delay", "2"], keys].concat());
    }

    /// Types a path into the line that a key opens.
    fn give_path(&mut self, key: &str, path: &str) {
        if key == "ctrl+o" {
            // As a scene was opened, so that nobody is asked whether to save what was changed.
            self.keys(&["ctrl+z"; 6]);
        }
        let before = self.log_length();
        self.keys(&[key]);
        // The line comes with the next frame, and takes the keyboard with the one after it: what is
        // typed before that is a key for each letter.
        let start = Instant::now();
        while self.frames_since(before) < 4 && start.elapsed() < Duration::from_secs(1) {
            std::thread::sleep(Duration::from_millis(20));
        }
        std::thread::sleep(Duration::from_millis(100));
        self.keys(&["ctrl+a"]);
        self.screen.xdotool(&["type", "--delay", "2", path]);
        self.keys(&["Return"]);
    }

    /// Gives a path, and looks whether that did what it should. On a machine with other work the line may
    /// take longer to come than anyone waits: then all is closed, and tried again, as a person would.
    fn insist(&mut self, what: &str, key: &str, path: &str, done: impl Fn(&mut Self) -> bool) {
        for _ in 0..5 {
            self.give_path(key, path);
            if done(self) {
                return;
            }
            self.retries += 1;
            self.keys(&["Escape", "Escape", "Escape"]);
            self.settle();
        }
        // Says where the screen is left to look at.
        self.wait_for(what, |window| done(window).then_some(()));
    }

    /// Orbits with the mouse, as a hand does it.
    fn orbit(&self, number: u32) {
        let mut arguments: Vec<String> = Vec::new();
        let mut to = |x: u32, y: u32| {
            arguments.extend(["mousemove".into(), x.to_string(), y.to_string()]);
            arguments.extend(["sleep".into(), "0.015".into()]);
        };
        to(300, 240);
        for step in 1..=10 {
            to(300 + step * (5 + number % 9), 240 + step * (number % 5));
        }
        arguments.insert(5, "mousedown".into());
        arguments.insert(6, "1".into());
        arguments.extend(["mouseup".into(), "1".into()]);
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        self.screen.xdotool(&arguments);
    }

    /// Opens a file of a kind, which is shown if it is good; what was shown before stays if it is not.
    fn open_file(&mut self, kind: Kind, number: u32) {
        let name = self
            .files
            .make(kind, number)
            .expect("a file can be written");
        if kind.is_good() {
            let shown = name.clone();
            self.insist(&name, "ctrl+o", &name, |window| window.shows(&shown));
        } else {
            let before = self.title();
            self.give_path("ctrl+o", &name);
            std::thread::sleep(Duration::from_millis(200));
            // Closes the message. Were the line for a path still there it would close that, and the
            // next path would be two in one.
            self.keys(&["Escape", "Escape"]);
            assert_eq!(self.title(), before, "{kind:?} {name}");
        }
        self.files.remove(&name);
    }

    /// What a person does with a file.
    fn look_around(&mut self, number: u32) {
        let mode = format!("alt+{}", 1 + number % 9);
        self.orbit(number);
        self.keys(&[&mode]);
        self.orbit(number / 2);
        match number % 8 {
            0 => self.keys(&["w"]),
            1 => self.keys(&["t"]),
            2 => self.keys(&["o"]),
            3 => self.keys(&["plus", "minus"]),
            4 => self.keys(&["p"]),
            5 => self.resize(SIZES[(number / 8) as usize % SIZES.len()]),
            6 => self.keys(&["f", "Left", "Up", "r"]),
            _ => self.save(number),
        }
        self.settle();
    }

    /// Saves the picture, and waits for the file.
    fn save(&mut self, number: u32) {
        let name = format!(
            "saved-{number}.{}",
            ["png", "exr", "jpg"][number as usize % 3]
        );
        let path = self.home.path().join(&name);
        self.insist("a saved picture", "ctrl+e", &name, |_| {
            let start = Instant::now();
            while !path.exists() && start.elapsed() < SETTLE_TIME {
                std::thread::sleep(Duration::from_millis(20));
            }
            path.exists()
        });
        std::fs::remove_file(&path).expect("it is there");
    }

    /// Back to one file, one size, one mode; what the window has then, once nothing more goes on.
    fn rest(&mut self, expected: Option<Usage>) -> Usage {
        self.resize(SIZES[0]);
        self.insist(REST_FILE, "ctrl+o", REST_FILE, |window| {
            window.shows(REST_FILE)
        });
        self.keys(&["alt+3", "r"]);
        self.settle();
        // A thread that has told its news ends soon, and says so nowhere: look until it has.
        let start = Instant::now();
        loop {
            std::thread::sleep(Duration::from_millis(100));
            let usage = self.usage();
            let is_at_rest = expected.is_none_or(|expected| {
                usage.files <= expected.files && usage.threads <= expected.threads
            });
            if start.elapsed() > Duration::from_secs(if is_at_rest { 1 } else { 10 }) {
                return usage;
            }
        }
    }
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
    println!("SKIPPED: the soak needs {missing:?}");
    false
}

/// Samples of a soak, as they go to a CSV file.
struct Samples {
    started: Instant,
    file: Option<PathBuf>,
    text: String,
}

impl Samples {
    fn new() -> Self {
        Self {
            started: Instant::now(),
            file: std::env::var_os("RAYCAST_SOAK_SAMPLES").map(PathBuf::from),
            text: "seconds,opened,at_rest,resident_kb,files,threads\n".to_owned(),
        }
    }

    fn add(&mut self, opened: u32, at_rest: bool, usage: Usage) {
        let seconds = self.started.elapsed().as_secs_f64();
        let Usage {
            resident_kb,
            files,
            threads,
        } = usage;
        let at_rest = u8::from(at_rest);
        let _ = writeln!(
            self.text,
            "{seconds:.1},{opened},{at_rest},{resident_kb},{files},{threads}"
        );
        if let Some(file) = &self.file {
            std::fs::write(file, &self.text).expect("samples can be written");
        }
    }
}

fn median(values: &[u64]) -> u64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable();
    sorted[sorted.len() / 2]
}

#[test]
fn the_window_keeps_its_size_over_many_files() {
    if !can_run() {
        return;
    }
    let seconds = std::env::var("RAYCAST_SOAK_SECONDS").map_or(Ok(30), |text| text.parse());
    let length = Duration::from_secs(seconds.expect("RAYCAST_SOAK_SECONDS is a number"));
    let mut window = Window::open();
    let mut samples = Samples::new();
    let mut number = 0;
    let mut rests: Vec<Usage> = Vec::new();
    // The first lap meets everything once: what is made once, and kept, is there at the first rest.
    while samples.started.elapsed() < length || rests.len() < 2 {
        for kind in Kind::ALL {
            number += 1;
            window.open_file(kind, number);
            window.look_around(number);
            samples.add(number, false, window.usage());
        }
        let usage = window.rest(rests.first().copied());
        samples.add(number, true, usage);
        rests.push(usage);
    }

    let first = rests[0];
    for (lap, usage) in rests.iter().enumerate() {
        assert!(
            usage.files <= first.files && usage.threads <= first.threads,
            "left over after {} laps: {usage:?}, at first {first:?}",
            lap + 1
        );
    }
    // A fifth is for warming up.
    let resident: Vec<u64> = rests.iter().map(|usage| usage.resident_kb).collect();
    let warm = &resident[resident.len() / 5..];
    let (early, late) = warm.split_at(warm.len().div_ceil(2));
    let (early, late) = (
        median(early),
        median(if late.is_empty() { early } else { late }),
    );
    println!(
        "{number} files in {:?}, {} rests, {} retries: {early} kB early, {late} kB late, {} files, {} threads",
        samples.started.elapsed(),
        rests.len(),
        window.retries,
        first.files,
        first.threads
    );
    assert!(
        late <= early + SLACK_KB,
        "resident at rest: {early} kB early, {late} kB late, {resident:?}"
    );
}
