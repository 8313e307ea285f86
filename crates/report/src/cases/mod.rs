//! Places where known ray casters go wrong: scenes, rays and cameras, whose outcome is what the
//! oracle says. One list serves tests, the report and the viewer.
//!
//! [`leaks`], [`signs`], [`scale`], [`bad_geometry`], [`sameness`], [`blocks`] and [`time`] hold the cases by
//! theme; [`setting`] is what a case puts up.

pub mod bad_geometry;
pub mod blocks;
pub mod leaks;
pub mod sameness;
pub mod scale;
pub mod setting;
pub mod signs;
pub mod time;

pub use setting::Setting;

/// What goes wrong in a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Theme {
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
    Blocks,
    /// Answers that take too long.
    Time,
}

impl Theme {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Leaks,
        Self::Signs,
        Self::Scale,
        Self::BadGeometry,
        Self::Sameness,
        Self::Blocks,
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
            Self::Blocks => "blocks of rays",
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
    pub theme: Theme,
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

/// All cases, theme by theme. Nothing is built yet.
pub fn all() -> Vec<Case> {
    [
        leaks::CASES,
        signs::CASES,
        scale::CASES,
        bad_geometry::CASES,
        sameness::CASES,
        blocks::CASES,
        time::CASES,
    ]
    .concat()
}

/// The case of a name.
pub fn find(name: &str) -> Option<Case> {
    all().into_iter().find(|case| case.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn names_are_unique_and_every_setting_has_rays_to_cast() {
        let mut names = HashSet::new();
        for case in all() {
            assert!(names.insert(case.name), "{} twice", case.name);
            assert!(case.variants > 0 && !case.trouble.is_empty());
            assert_eq!(find(case.name).map(|found| found.name), Some(case.name));
            let setting = (case.setting)(0);
            assert!(
                !setting.cameras.is_empty(),
                "{}: nothing to look at",
                case.name
            );
            let rays = setting.rays(100, 1);
            assert!(rays.len() <= 100, "{}", case.name);
            let again = setting.rays(100, 1);
            assert_eq!(format!("{rays:?}"), format!("{again:?}"), "{}", case.name);
        }
    }
}
