//! A screen of the tests' own: Xvfb, with synthetic input and screenshots.

use image::RgbImage;
use std::collections::HashSet;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A running X server that ends with this value.
#[derive(Debug)]
pub struct Screen {
    server: Child,
    display: String,
}

/// The programs that a screen needs and this machine does not have.
pub fn missing_programs() -> Vec<&'static str> {
    ["Xvfb", "xdotool", "import"]
        .into_iter()
        .filter(|program| {
            let folders = std::env::var_os("PATH").unwrap_or_default();
            !std::env::split_paths(&folders).any(|folder| folder.join(program).is_file())
        })
        .collect()
}

impl Screen {
    /// Starts a screen of so many pixels, on a display number that is free.
    pub fn start(width: u32, height: u32) -> Self {
        let mut server = Command::new("Xvfb")
            // Without -noreset it starts anew, and refuses connections meanwhile, whenever the last
            // program leaves: each call of xdotool may be that.
            .args(["-displayfd", "1", "-noreset", "-nolisten", "tcp"])
            // No key repeats: on a busy machine a stroke may last as long as a key that is held.
            .arg("-r")
            .args(["-screen", "0"])
            .arg(format!("{width}x{height}x24"))
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb can be started");
        // It writes the number when it is ready.
        let output = server.stdout.take().expect("its output is piped");
        let mut number = String::new();
        let read = BufReader::new(output).read_line(&mut number);
        let screen = Self {
            server,
            display: format!(":{}", number.trim()),
        };
        assert!(
            read.is_ok() && screen.display.len() > 1,
            "Xvfb ended without a display"
        );
        screen
    }

    /// Starts a program on this screen, with a home of its own and Mesa's software OpenGL.
    pub fn start_program(&self, command: &mut Command, home: &Path) -> Program {
        let child = self
            .on_screen(command)
            .env("HOME", home)
            .env("XDG_CONFIG_HOME", home)
            .env("XDG_DATA_HOME", home)
            .env("XDG_CACHE_HOME", home)
            .env("LIBGL_ALWAYS_SOFTWARE", "1")
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program can be started");
        Program(child)
    }

    /// Synthetic input, and questions about windows: xdotool's own words.
    pub fn xdotool(&self, arguments: &[&str]) -> Output {
        let mut command = Command::new("xdotool");
        self.on_screen(command.args(arguments))
            .output()
            .expect("xdotool can be started")
    }

    /// What the screen shows.
    pub fn shot(&self) -> Shot {
        let mut command = Command::new("import");
        let output = self
            .on_screen(command.args(["-silent", "-window", "root", "png:-"]))
            .output()
            .expect("import can be started");
        let image = image::load_from_memory(&output.stdout).expect("import writes a PNG");
        Shot(image.into_rgb8())
    }

    /// The program's window, by the number that [`Screen::xdotool`] knows it by, once it is shown.
    pub fn window(&self) -> Option<String> {
        let found = self.xdotool(&["search", "--onlyvisible", "--name", "RayCast"]);
        let text = String::from_utf8_lossy(&found.stdout);
        text.lines().next().map(str::to_owned)
    }

    /// Tells a window its place and size, and gives it the keyboard: there is no window manager.
    pub fn place(&self, window: &str, (width, height): (u32, u32)) {
        let (width, height) = (width.to_string(), height.to_string());
        self.xdotool(&["windowmove", window, "0", "0"]);
        self.xdotool(&["windowsize", window, &width, &height]);
        self.xdotool(&["windowfocus", window]);
    }

    fn on_screen<'a>(&self, command: &'a mut Command) -> &'a mut Command {
        command
            .env("DISPLAY", &self.display)
            .env_remove("WAYLAND_DISPLAY")
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        // Asked kindly, it removes its lock and its socket.
        let asked = Command::new("kill")
            .arg(self.server.id().to_string())
            .status();
        if !asked.is_ok_and(|status| status.success()) {
            let _ = self.server.kill();
        }
        let _ = self.server.wait();
    }
}

/// A program on a screen, that ends with this value.
#[derive(Debug)]
pub struct Program(Child);

impl Program {
    /// Its number, by which the system knows it.
    pub fn id(&self) -> u32 {
        self.0.id()
    }

    /// The exit status and what it said on standard error, if it has ended.
    pub fn ended(&mut self) -> Option<String> {
        let status = self.0.try_wait().expect("the program can be asked")?;
        let errors = self.0.stderr.take().map(std::io::read_to_string);
        Some(format!("{status}: {errors:?}"))
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A program on a screen of its own.
pub trait OnScreen: Sized {
    /// The screen, and the program on it.
    fn screen_and_program(&mut self) -> (&Screen, &mut Program);

    /// Asks until there is an answer.
    ///
    /// # Panics
    /// The program ended, or there is no answer in two minutes, longer than the slowest machine needs for anything that
    /// is waited for.
    fn wait_for<T>(&mut self, what: &str, mut ask: impl FnMut(&mut Self) -> Option<T>) -> T {
        const PATIENCE: Duration = Duration::from_secs(120);
        let start = Instant::now();
        loop {
            if let Some(end) = self.screen_and_program().1.ended() {
                panic!("the window closed while waiting for {what}: {end}");
            }
            if let Some(answer) = ask(self) {
                return answer;
            }
            if start.elapsed() > PATIENCE {
                let left = std::env::temp_dir().join("raycast-screen.png");
                let saved = self.screen_and_program().0.shot().0.save(&left);
                panic!("no {what} in {PATIENCE:?}; {}: {saved:?}", left.display());
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

/// A screenshot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shot(pub RgbImage);

impl Shot {
    /// Its middle, half as wide and half as high: the picture, without what stands beside it.
    pub fn middle(&self) -> Self {
        let (width, height) = self.0.dimensions();
        let view = image::imageops::crop_imm(&self.0, width / 4, height / 4, width / 2, height / 2);
        Self(view.to_image())
    }

    /// How many colours it has.
    pub fn colors(&self) -> usize {
        self.0.pixels().collect::<HashSet<_>>().len()
    }

    /// The share of its pixels that are not as in another of the same size, 0 to 1.
    pub fn difference(&self, other: &Self) -> f64 {
        let changed = self
            .0
            .pixels()
            .zip(other.0.pixels())
            .filter(|(a, b)| a != b)
            .count();
        changed as f64 / f64::from(self.0.width() * self.0.height()).max(1.0)
    }
}
