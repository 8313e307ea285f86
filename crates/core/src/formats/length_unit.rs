//! Units of length of mesh files.

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthUnit {
    /// A millionth of a metre; "micron" in 3MF.
    Micrometre,
    /// A thousandth of a metre.
    Millimetre,
    /// A hundredth of a metre.
    Centimetre,
    /// A metre.
    Metre,
    /// 25.4 millimetres.
    Inch,
    /// Twelve inches.
    Foot,
}

impl LengthUnit {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Micrometre,
        Self::Millimetre,
        Self::Centimetre,
        Self::Metre,
        Self::Inch,
        Self::Foot,
    ];

    /// The unit of a 3MF word (3MF Core Specification 1.3, 3.4, `ST_Unit`); `None` for any other word.
    pub fn from_threemf(word: &str) -> Option<Self> {
        Some(match word {
            "micron" => Self::Micrometre,
            "millimeter" => Self::Millimetre,
            "centimeter" => Self::Centimetre,
            "meter" => Self::Metre,
            "inch" => Self::Inch,
            "foot" => Self::Foot,
            _ => return None,
        })
    }

    /// The unit in micrometres: an integer for each.
    pub fn micrometres(self) -> f64 {
        match self {
            Self::Micrometre => 1.0,
            Self::Millimetre => 1e3,
            Self::Centimetre => 1e4,
            Self::Metre => 1e6,
            Self::Inch => 25_400.0,
            Self::Foot => 304_800.0,
        }
    }

    /// Its symbol: `mm`.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Micrometre => "µm",
            Self::Millimetre => "mm",
            Self::Centimetre => "cm",
            Self::Metre => "m",
            Self::Inch => "in",
            Self::Foot => "ft",
        }
    }

    /// Its name: `millimetres`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Micrometre => "micrometres",
            Self::Millimetre => "millimetres",
            Self::Centimetre => "centimetres",
            Self::Metre => "metres",
            Self::Inch => "inches",
            Self::Foot => "feet",
        }
    }
}
