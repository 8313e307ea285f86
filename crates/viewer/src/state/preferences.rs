//! How a person likes to work: kept from one session to the next, never part of a scene.

use raycast_core::formats::LengthUnit;
use std::path::{Path, PathBuf};

/// The most files that are remembered as opened.
const MOST_RECENT: usize = 12;
/// The most files whose views are remembered.
const MOST_WITH_VIEWS: usize = 100;
/// The smallest and the largest interface, as a factor.
pub const SCALE_RANGE: (f32, f32) = (0.5, 4.0);

/// Light or dark.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Theme {
    /// As the desktop has it.
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
    /// Left orbits; right, middle and Shift with left pan.
    #[default]
    Viewer,
    /// As in Blender: middle orbits, with Shift it pans, with Ctrl it zooms.
    Blender,
    /// As in many CAD programs: right orbits, middle pans.
    Cad,
}

/// The settings of the program.
#[derive(Clone, Debug, PartialEq)]
pub struct Preferences {
    /// Light or dark.
    pub theme: Theme,
    /// How large the interface is; 1 is what the desktop asks for.
    pub scale: f32,
    /// What drags of the mouse do.
    pub mouse: Mouse,
    /// Whether the camera takes its time from one view to another.
    pub smooth: bool,
    /// Whether a picture that stands still gets more samples by itself.
    pub refine: bool,
    /// Whether files that change are read again.
    pub watch: bool,
    /// In which unit lengths are told; in that of the files, for `None`.
    pub unit: Option<LengthUnit>,
    /// Files that were opened, newest first.
    pub recent: Vec<PathBuf>,
    /// Views that were kept, as options of the command line: for each file, the newest first.
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
            unit: None,
            recent: Vec::new(),
            views: Vec::new(),
        }
    }
}

impl Preferences {
    /// Remembers the views of a file in place of others.
    pub fn keep_views(&mut self, file: &Path, views: Vec<String>) {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
        self.views.retain(|(other, _)| *other != file);
        if !views.is_empty() {
            self.views.insert(0, (file, views));
        }
        self.views.truncate(MOST_WITH_VIEWS);
    }

    /// The views that are remembered for a file.
    pub fn views_of(&self, file: &Path) -> &[String] {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
        let mut all = self.views.iter();
        all.find(|(other, _)| *other == file)
            .map_or(&[], |(_, views)| views)
    }

    /// Puts a file at the front of those opened.
    pub fn remember(&mut self, file: &Path) {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
        self.recent.retain(|other| *other != file);
        self.recent.insert(0, file);
        self.recent.truncate(MOST_RECENT);
    }
}
