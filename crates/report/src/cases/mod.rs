//! Hard cases: scenes, rays and cameras for which known ray casters fail. The oracle gives the right hits. Tests,
//! the report and the viewer share this list.
//!
//! [`leaks`], [`signs`], [`scale`], [`bad_geometry`], [`sameness`], [`packets`] and [`time`] hold the cases by
//! theme; [`setting`] defines what a case provides.

pub mod bad_geometry;
mod case;
pub mod leaks;
pub mod packets;
pub mod sameness;
pub mod scale;
pub mod setting;
pub mod signs;
pub mod time;

pub use case::{Case, CaseTheme};
pub use setting::Setting;

/// All cases, ordered by theme. Their scenes are built on demand.
pub fn all() -> Vec<Case> {
    [
        leaks::CASES,
        signs::CASES,
        scale::CASES,
        bad_geometry::CASES,
        sameness::CASES,
        packets::CASES,
        time::CASES,
    ]
    .concat()
}

/// Finds a case by its name.
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
            assert!(case.variants > 0 && !case.difficulty.is_empty());
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
