//! The user's preferences: stored between sessions, never part of a scene.

use raycast_core::formats::{LengthUnit, Limits};
use raycast_core::scene::UpAxis;
use std::path::{Path, PathBuf};

/// The most files that are remembered as opened.
const MOST_RECENT: usize = 12;
/// The most files whose views are remembered.
const MOST_WITH_VIEWS: usize = 100;
/// The least and the greatest scale of the interface.
pub const SCALE_RANGE: (f32, f32) = (0.5, 4.0);

/// Light or dark panels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Theme {
    /// That of the desktop.
    #[default]
    System,
    /// Dark panels.
    Dark,
    /// Light panels.
    Light,
}

/// What drags of the mouse do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mouse {
    /// Left drag orbits; right, middle and Shift+left drag pan.
    #[default]
    Viewer,
    /// As in Blender: middle drag orbits, with Shift it pans, with Ctrl it zooms.
    Blender,
    /// As in many CAD programs: right drag orbits, middle drag pans.
    Cad,
}

/// The preferences.
#[derive(Clone, Debug, PartialEq)]
pub struct Preferences {
    /// Light or dark panels.
    pub theme: Theme,
    /// The scale of the interface; 1 is the desktop's.
    pub scale: f32,
    /// What drags of the mouse do.
    pub mouse: Mouse,
    /// Whether the camera moves smoothly between views.
    pub smooth: bool,
    /// Whether still pictures get more samples.
    pub refine: bool,
    /// Whether files are reloaded when they change.
    pub watch: bool,
    /// Whether files that do not say which axis is up have z up, as in much of CAD.
    pub z_up: bool,
    /// The unit in which lengths are shown; `None` for that of the files.
    pub unit: Option<LengthUnit>,
    /// Whether the mouse has been used in the picture: until then a line says what it does.
    pub knows_mouse: bool,
    /// Files that were opened, newest first.
    pub recent: Vec<PathBuf>,
    /// Bookmarks as options of the command line, for each file, the most recent file first.
    pub views: Vec<(PathBuf, Vec<String>)>,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            theme: Theme::System,
            scale: 1.0,
            mouse: Mouse::default(),
            smooth: true,
            refine: true,
            watch: true,
            z_up: false,
            unit: None,
            knows_mouse: false,
            recent: Vec::new(),
            views: Vec::new(),
        }
    }
}

impl Preferences {
    /// The limits of reading by these preferences; `given` are those of the command line.
    pub fn limits(&self, given: Limits) -> Limits {
        Limits {
            up_axis: if self.z_up { UpAxis::Z } else { given.up_axis },
            // A scene without one of its images can still be looked at, and saved with the image's name.
            stand_ins: true,
            ..given
        }
    }

    /// Stores the bookmarks of a file.
    pub fn keep_views(&mut self, file: &Path, views: Vec<String>) {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
        self.views.retain(|(other, _)| *other != file);
        if !views.is_empty() {
            self.views.insert(0, (file, views));
        }
        self.views.truncate(MOST_WITH_VIEWS);
    }

    /// The stored bookmarks of a file.
    pub fn views_of(&self, file: &Path) -> &[String] {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
        let mut all = self.views.iter();
        all.find(|(other, _)| *other == file)
            .map_or(&[], |(_, views)| views)
    }

    /// Puts files at the front of the recent ones, the first foremost.
    pub fn remember_all(&mut self, files: &[PathBuf]) {
        files.iter().rev().for_each(|file| self.remember(file));
    }

    /// Puts a file at the front of the recent ones.
    pub fn remember(&mut self, file: &Path) {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
        self.recent.retain(|other| *other != file);
        self.recent.insert(0, file);
        self.recent.truncate(MOST_RECENT);
    }
}
