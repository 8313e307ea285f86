//! Colours and sizes.

use plotters::style::RGBColor;

/// A palette for readers with colour vision deficiencies: Okabe and Ito, "Color Universal Design", 2008, without
/// its yellow, which has little contrast on white.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// RayCast's packet traversal of a tile.
    Blue,
    /// RayCast's single-ray traversal.
    Sky,
    /// obvhs.
    Vermilion,
    /// Embree.
    Purple,
    /// Möller and Trumbore.
    Green,
    /// Woop, Benthin and Wald.
    Orange,
    /// The test against the plane, then against the edges.
    Grey,
    /// Series that do not belong to a caster.
    Black,
}

impl Ink {
    /// The order of colours for series that do not belong to a caster.
    pub const ALL: [Self; 7] = [
        Self::Blue,
        Self::Vermilion,
        Self::Green,
        Self::Purple,
        Self::Orange,
        Self::Sky,
        Self::Grey,
    ];

    /// The colour of a caster, found by its name.
    pub fn for_caster(name: &str) -> Self {
        const PREFIXES: [(&str, Ink); 7] = [
            ("RayCast tiles", Ink::Blue),
            ("RayCast", Ink::Sky),
            ("obvhs", Ink::Vermilion),
            ("Embree", Ink::Purple),
            ("Möller", Ink::Green),
            ("watertight", Ink::Orange),
            ("plane", Ink::Grey),
        ];
        PREFIXES
            .into_iter()
            .find(|(beginning, _)| name.starts_with(beginning))
            .map_or(Self::Black, |(_, ink)| ink)
    }

    pub(super) fn color(self) -> RGBColor {
        match self {
            Self::Blue => RGBColor(0, 114, 178),
            Self::Sky => RGBColor(56, 160, 220),
            Self::Vermilion => RGBColor(213, 94, 0),
            Self::Purple => RGBColor(170, 80, 140),
            Self::Green => RGBColor(0, 140, 100),
            Self::Orange => RGBColor(205, 140, 0),
            Self::Grey => RGBColor(110, 110, 110),
            Self::Black => RGBColor(30, 30, 30),
        }
    }
}

pub(super) const TEXT: RGBColor = RGBColor(34, 38, 44);
pub(super) const QUIET: RGBColor = RGBColor(92, 98, 108);
pub(super) const AXIS: RGBColor = RGBColor(120, 126, 136);
pub(super) const GRID: RGBColor = RGBColor(222, 226, 232);
pub(super) const FAINT_GRID: RGBColor = RGBColor(240, 242, 245);
pub(super) const ZERO: RGBColor = RGBColor(234, 244, 236);

/// The size of a chart in pixels, before magnification.
pub(super) const SIZE: (u32, u32) = (980, 620);
pub(super) const TITLE: f64 = 23.0;
pub(super) const SUBTITLE: f64 = 15.5;
pub(super) const AXIS_LABEL: f64 = 16.5;
pub(super) const TICK: f64 = 14.5;
pub(super) const LABEL: f64 = 15.5;
pub(super) const DOT: f64 = 4.5;
