use super::Color;

/// A map from numbers in a range to colours, from the low end to the high end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorMap {
    /// Dark blue, green, yellow: perceptually uniform, and readable with colour vision deficiency (Smith and van der
    /// Walt, "A Better Default Colormap for Matplotlib", 2015).
    #[default]
    Viridis,
    /// Black, purple, pale yellow (by the same authors).
    Magma,
    /// All hues from blue to red: shows the most detail (Mikhailov, "Turbo, An Improved Rainbow Colormap", 2019).
    Turbo,
    /// Blue, grey, yellow: designed for colour vision deficiency (Nuñez, Anderton, Renslow, "Optimizing colormaps",
    /// 2018).
    Cividis,
    /// Blue, white in the middle, red: for numbers that deviate in both directions (ColorBrewer's RdBu; Brewer 2003).
    Diverging,
}

/// Entries of a map's table; between two of them colours are interpolated in linear light.
pub const COLOR_MAP_STEPS: usize = 256;

impl ColorMap {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Viridis,
        Self::Magma,
        Self::Turbo,
        Self::Cividis,
        Self::Diverging,
    ];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Viridis => "viridis",
            Self::Magma => "magma",
            Self::Turbo => "turbo",
            Self::Cividis => "cividis",
            Self::Diverging => "diverging",
        }
    }

    /// The table of colours, at equal distances.
    pub fn colors(self) -> [Color; COLOR_MAP_STEPS] {
        let (gradient, reversed) = match self {
            Self::Viridis => (colorous::VIRIDIS, false),
            Self::Magma => (colorous::MAGMA, false),
            Self::Turbo => (colorous::TURBO, false),
            Self::Cividis => (colorous::CIVIDIS, false),
            Self::Diverging => (colorous::RED_BLUE, true),
        };
        std::array::from_fn(|step| {
            let step = if reversed {
                COLOR_MAP_STEPS - 1 - step
            } else {
                step
            };
            let colorous::Color { r, g, b } = gradient.eval_rational(step, COLOR_MAP_STEPS);
            Color([r, g, b])
        })
    }
}

/// How a picture shows numbers as colours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ColorScale {
    /// The colour map.
    pub map: ColorMap,
    /// The numbers at the map's ends, low and high; numbers beyond have the colours of the ends. `None`: fitted to
    /// the values in the scene.
    pub range: Option<[f64; 2]>,
    /// Whether the picture shows a legend.
    pub legend: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_have_the_published_ends() {
        // From matplotlib's `_cm_listed`, Google's Turbo table and ColorBrewer, rounded to bytes.
        let ends = |map: ColorMap| {
            let colors = map.colors();
            [colors[0].to_string(), colors[255].to_string()]
        };
        assert_eq!(ends(ColorMap::Viridis), ["#440154", "#fde725"]);
        assert_eq!(ends(ColorMap::Magma), ["#000004", "#fcfdbf"]);
        // Interpolated as in d3: within one unit of its first colour, #053061.
        assert_eq!(ends(ColorMap::Diverging), ["#042f60", "#67001f"]);
        for map in ColorMap::ALL {
            let distinct: std::collections::HashSet<_> = map.colors().into_iter().collect();
            assert!(distinct.len() > 200, "{}", map.name());
        }
    }
}
