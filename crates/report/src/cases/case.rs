//! A hard case: its theme and its settings.

use super::setting::Setting;

/// The kind of error that a case provokes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CaseTheme {
    /// Rays pass through a closed surface.
    Leaks,
    /// Signs, zeros and ties are handled wrongly.
    Signs,
    /// Very large and very small coordinates and distances together.
    Scale,
    /// Degenerate or invalid triangles and rays.
    BadGeometry,
    /// The same ray gets different hits.
    Sameness,
    /// Errors of packet traversal, which sets a triangle up once for many rays.
    Packets,
    /// Scenes that take a caster far too long.
    Time,
}

impl CaseTheme {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Leaks,
        Self::Signs,
        Self::Scale,
        Self::BadGeometry,
        Self::Sameness,
        Self::Packets,
        Self::Time,
    ];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Leaks => "leaks",
            Self::Signs => "signs and zeros",
            Self::Scale => "scale and range",
            Self::BadGeometry => "bad geometry",
            Self::Sameness => "sameness",
            Self::Packets => "packets of rays",
            Self::Time => "time",
        }
    }
}

/// A hard case: one or more settings, built on demand.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its name: lower case, with underscores.
    pub name: &'static str,
    /// The kind of error that it provokes.
    pub theme: CaseTheme,
    /// What goes wrong in other casters, in one line.
    pub difficulty: &'static str,
    /// The number of settings, at least one.
    pub variants: u32,
    /// Builds the setting of a variant below `variants`.
    pub setting: fn(variant: u32) -> Setting,
}

impl Case {
    /// All its settings in order.
    pub fn settings(self) -> impl Iterator<Item = Setting> {
        (0..self.variants).map(self.setting)
    }

    /// The name with spaces instead of underscores.
    pub fn title(self) -> String {
        self.name.replace('_', " ")
    }
}
