//! Settings that are stored between sessions: preferences, not what was open.

use crate::state::preferences::{Mouse, Preferences, SCALE_RANGE, Theme};
use crate::state::{Overlay, State, Tint, default_threads};
use raycast_core::camera::{FrameLock, Grid};
use raycast_core::formats::LengthUnit;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// eframe's key for them.
pub const KEY: &str = "raycast";

/// The stored settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Remembered {
    threads: Option<usize>,
    panel: bool,
    keep_resolution: bool,
    tile_size: Option<u32>,
    tile_grid: Option<(u32, u32)>,
    borders: bool,
    order: bool,
    tint: String,
    theme: String,
    scale: f32,
    mouse: String,
    smooth: bool,
    refine: bool,
    watch: bool,
    z_up: bool,
    unit: Option<String>,
    knows_mouse: bool,
    recent: Vec<PathBuf>,
    views: Vec<(PathBuf, Vec<String>)>,
}

impl Default for Remembered {
    fn default() -> Self {
        Self::of(&State::default())
    }
}

impl Remembered {
    /// The part of the state that is stored.
    pub fn of(state: &State) -> Self {
        Self {
            // The default is not stored: another machine has another number of cores.
            threads: (state.threads != default_threads()).then_some(state.threads),
            panel: state.panel,
            keep_resolution: state.lock == FrameLock::KeepResolution,
            tile_size: match state.grid {
                Grid::Size(size) => Some(size),
                Grid::Count { .. } => None,
            },
            tile_grid: match state.grid {
                Grid::Size(_) => None,
                Grid::Count { columns, rows } => Some((columns, rows)),
            },
            borders: state.overlay.borders,
            order: state.overlay.order,
            tint: match state.overlay.tint {
                Tint::None => "none",
                Tint::Time => "time",
                Tint::Worker => "worker",
            }
            .to_owned(),
            theme: match state.preferences.theme {
                Theme::System => "system",
                Theme::Dark => "dark",
                Theme::Light => "light",
            }
            .to_owned(),
            scale: state.preferences.scale,
            mouse: match state.preferences.mouse {
                Mouse::Viewer => "viewer",
                Mouse::Blender => "blender",
                Mouse::Cad => "cad",
            }
            .to_owned(),
            smooth: state.preferences.smooth,
            refine: state.preferences.refine,
            watch: state.preferences.watch,
            z_up: state.preferences.z_up,
            unit: state.preferences.unit.map(|unit| unit.name().to_owned()),
            knows_mouse: state.preferences.knows_mouse,
            recent: state.preferences.recent.clone(),
            views: state.preferences.views.clone(),
        }
    }

    /// Restores it.
    pub fn restore(&self, state: &mut State) {
        if let Some(threads) = self.threads {
            state.threads = threads.clamp(1, 256);
        }
        state.panel = self.panel;
        state.lock = if self.keep_resolution {
            FrameLock::KeepResolution
        } else {
            FrameLock::KeepFrame
        };
        state.grid = match (self.tile_grid, self.tile_size) {
            (Some((columns, rows)), _) => Grid::Count {
                columns: columns.clamp(1, 256),
                rows: rows.clamp(1, 256),
            },
            (None, Some(size)) => Grid::Size(size.clamp(16, 4096)),
            (None, None) => Grid::default(),
        };
        state.overlay = Overlay {
            borders: self.borders,
            order: self.order,
            tint: match self.tint.as_str() {
                "time" => Tint::Time,
                "worker" => Tint::Worker,
                _ => Tint::None,
            },
        };
        let scale = if self.scale.is_finite() {
            self.scale
        } else {
            1.0
        };
        state.preferences = Preferences {
            theme: match self.theme.as_str() {
                "dark" => Theme::Dark,
                "light" => Theme::Light,
                _ => Theme::System,
            },
            scale: scale.clamp(SCALE_RANGE.0, SCALE_RANGE.1),
            mouse: match self.mouse.as_str() {
                "blender" => Mouse::Blender,
                "cad" => Mouse::Cad,
                _ => Mouse::Viewer,
            },
            smooth: self.smooth,
            refine: self.refine,
            watch: self.watch,
            z_up: self.z_up,
            unit: LengthUnit::ALL
                .into_iter()
                .find(|unit| self.unit.as_deref() == Some(unit.name())),
            knows_mouse: self.knows_mouse,
            recent: self.recent.clone(),
            views: self.views.clone(),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comes_back_as_it_was() {
        let state = State {
            threads: default_threads() + 3,
            panel: false,
            lock: FrameLock::KeepResolution,
            grid: Grid::Count {
                columns: 3,
                rows: 2,
            },
            overlay: Overlay {
                borders: true,
                order: true,
                tint: Tint::Worker,
            },
            preferences: Preferences {
                theme: Theme::Light,
                scale: 1.5,
                mouse: Mouse::Cad,
                smooth: false,
                refine: false,
                watch: false,
                z_up: true,
                unit: Some(LengthUnit::Inch),
                knows_mouse: true,
                recent: vec!["/a/b.obj".into()],
                views: vec![("/a/b.obj".into(), vec!["--eye 0,0,1".to_owned()])],
            },
            ..State::default()
        };
        let kept = serde_json::to_string(&Remembered::of(&state)).expect("writes");
        let kept: Remembered = serde_json::from_str(&kept).expect("reads");
        let mut other = State::default();
        kept.restore(&mut other);
        assert_eq!(
            (
                other.threads,
                other.panel,
                other.lock,
                other.grid,
                other.overlay,
                other.preferences
            ),
            (
                state.threads,
                state.panel,
                state.lock,
                state.grid,
                state.overlay,
                state.preferences
            )
        );
    }

    #[test]
    fn an_older_file_fills_in_with_defaults() {
        let kept: Remembered = serde_json::from_str("{}").expect("reads");
        assert_eq!(kept, Remembered::default());
    }
}
