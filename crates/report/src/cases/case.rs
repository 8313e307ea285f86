//! A hard case: what it is about, and how it is put up.

use super::setting::Setting;

/// What goes wrong in a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CaseTheme {
    /// Rays pass where there is a surface.
    Leaks,
    /// Zeros, signs and ties are decided wrongly.
    Signs,
    /// Large, small, far and near together.
    Scale,
    /// Triangles and rays that are none.
    BadGeometry,
    /// The same question gets different answers.
    Sameness,
    /// One set-up serves many rays.
    Packets,
    /// Answers that take too long.
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

    /// What it is called.
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

/// A hard case: one or several settings, made when they are asked for.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// What it is called: lower case, with underscores.
    pub name: &'static str,
    /// What it is about.
    pub theme: CaseTheme,
    /// What goes wrong elsewhere, in a line.
    pub trouble: &'static str,
    /// How many settings it has, at least one.
    pub variants: u32,
    /// Puts one of them up: `variant` < `variants`.
    pub setting: fn(variant: u32) -> Setting,
}

impl Case {
    /// All its settings, one after the other.
    pub fn settings(self) -> impl Iterator<Item = Setting> {
        (0..self.variants).map(self.setting)
    }

    /// The name in words.
    pub fn title(self) -> String {
        self.name.replace('_', " ")
    }
}
