//! The unit in which lengths are shown.

use super::State;
use raycast_core::formats::LengthUnit;

/// The units of lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lengths {
    /// The unit of the scene's coordinates, if known.
    scene: Option<LengthUnit>,
    /// The displayed unit; `None` for the scene's own.
    told: Option<LengthUnit>,
}

impl State {
    /// How lengths are told: in the unit that a person chose, else in that of the scene's files. Where the files say
    /// none, the scene's coordinates are taken to be in what was chosen.
    pub fn lengths(&self) -> Lengths {
        let scene = self.document.as_ref().and_then(|document| document.unit);
        let told = self.preferences.unit.or(scene);
        Lengths { scene, told }
    }
}

impl Lengths {
    /// A length of the scene (`power` 1), an area (2) or a volume (3) in the unit that is told.
    pub fn converted(&self, value: f64, power: u32) -> f64 {
        match (self.scene, self.told) {
            (Some(scene), Some(told)) if scene != told => (0..power).fold(value, |value, _| {
                value * scene.micrometres() / told.micrometres()
            }),
            _ => value,
        }
    }

    /// What stands behind a length, an area or a volume: ` mm²`; nothing in the scene's own units.
    pub fn suffix(&self, power: u32) -> String {
        let power = match power {
            2 => "²",
            3 => "³",
            _ => "",
        };
        let symbol = self.told.map(LengthUnit::symbol);
        symbol.map_or_else(String::new, |symbol| format!("\u{a0}{symbol}{power}"))
    }

    /// The unit's symbol, or `scene units`.
    pub fn symbol(&self) -> &'static str {
        self.told.map_or("scene units", LengthUnit::symbol)
    }

    /// The unit's name, or `scene units`.
    pub fn name(&self) -> &'static str {
        self.told.map_or("scene units", LengthUnit::name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_areas_and_volumes_are_told_in_the_chosen_unit() {
        use LengthUnit::{Inch, Metre, Millimetre};
        let lengths = |scene, told| Lengths { scene, told };
        let metres = lengths(Some(Metre), Some(Millimetre));
        assert_eq!(metres.converted(0.25, 1), 250.0);
        assert_eq!(metres.converted(0.25, 2), 250_000.0);
        assert_eq!(metres.converted(2.0, 3), 2e9);
        assert_eq!(metres.suffix(3), "\u{a0}mm³");
        assert_eq!(
            lengths(Some(Inch), Some(Millimetre)).converted(10.0, 1),
            254.0
        );
        let unsaid = lengths(None, Some(Inch));
        assert_eq!((unsaid.converted(0.1, 3), unsaid.symbol()), (0.1, "in"));
        let unknown = lengths(None, None);
        assert_eq!(
            (unknown.converted(7.0, 1), unknown.symbol()),
            (7.0, "scene units")
        );
        assert_eq!(unknown.suffix(2), "");
    }
}
