use super::Color;
use std::str::FromStr;

/// What a texture shows beyond its image, along one axis. Coordinates are in units of the image's side; the image
/// covers 0 ≤ coordinate < 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// Repeats the image: coordinate − ⌊coordinate⌋.
    #[default]
    Repeat,
    /// Repeats the image, every other time mirrored.
    Mirror,
    /// Extends the texels at the image's border.
    Clamp,
    /// One colour; `None` is no texel: the object's own colour shows.
    Border(Option<Color>),
}

impl Wrap {
    /// A coordinate that shows the same texels and is at most two sides from zero, so that its product with an
    /// image's side keeps its fraction. Zero where `coordinate` is not finite.
    pub(crate) fn near(self, coordinate: f64) -> f64 {
        if !coordinate.is_finite() {
            return 0.0;
        }
        match self {
            Self::Repeat => coordinate - coordinate.floor(),
            Self::Mirror => coordinate - 2.0 * (coordinate * 0.5).floor(),
            // More than a side away only the border shows, also to filters that blend texels.
            Self::Clamp | Self::Border(_) => coordinate.clamp(-1.0, 2.0),
        }
    }

    /// The index of the texel shown at `index` along a side of `size` texels (not 0); `None` is the border.
    #[inline]
    pub fn texel(self, index: i64, size: u32) -> Option<u32> {
        let size = i64::from(size);
        let within = match self {
            Self::Repeat => index.rem_euclid(size),
            Self::Mirror => {
                let turned = index.rem_euclid(2 * size);
                turned.min(2 * size - 1 - turned)
            }
            Self::Clamp => index.clamp(0, size - 1),
            Self::Border(_) if (0..size).contains(&index) => index,
            Self::Border(_) => return None,
        };
        Some(within as u32)
    }
}

impl FromStr for Wrap {
    type Err = String;

    /// Parses `repeat`, `mirror`, `clamp`, `border` or `border:#rrggbb`.
    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "repeat" => Ok(Self::Repeat),
            "mirror" => Ok(Self::Mirror),
            "clamp" => Ok(Self::Clamp),
            "border" => Ok(Self::Border(None)),
            _ => text
                .strip_prefix("border:")
                .and_then(|color| color.parse().ok())
                .map(|color| Self::Border(Some(color)))
                .ok_or_else(|| {
                    let found = crate::quote::quote(text);
                    format!(
                        "expected repeat, mirror, clamp, border or border:#rrggbb, found {found}"
                    )
                }),
        }
    }
}

impl std::fmt::Display for Wrap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Repeat => f.write_str("repeat"),
            Self::Mirror => f.write_str("mirror"),
            Self::Clamp => f.write_str("clamp"),
            Self::Border(None) => f.write_str("border"),
            Self::Border(Some(color)) => write!(f, "border:{color}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_beyond_the_image_are_those_of_the_mode() {
        let row = |wrap: Wrap| (-4..7).map(|i| wrap.texel(i, 3)).collect::<Vec<_>>();
        let texels = |texels: [u32; 11]| texels.map(Some).to_vec();
        assert_eq!(row(Wrap::Repeat), texels([2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0]));
        assert_eq!(row(Wrap::Mirror), texels([2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0]));
        assert_eq!(row(Wrap::Clamp), texels([0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2]));
        let mut border = vec![None; 11];
        border[4..7].copy_from_slice(&[Some(0), Some(1), Some(2)]);
        assert_eq!(row(Wrap::Border(None)), border);
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for index in [i64::MIN / 2, i64::MAX / 2] {
                assert_eq!(wrap.texel(index, 1), Some(0), "{wrap}");
            }
        }
    }

    #[test]
    fn displayed_wraps_parse_to_themselves() {
        let color = Color([1, 2, 0xab]);
        let all = [
            Wrap::Repeat,
            Wrap::Mirror,
            Wrap::Clamp,
            Wrap::Border(None),
            Wrap::Border(Some(color)),
        ];
        for wrap in all {
            assert_eq!(wrap.to_string().parse(), Ok(wrap));
        }
        for bad in ["", "Repeat", "border:", "border:red", "clamp:#fff"] {
            assert!(bad.parse::<Wrap>().is_err(), "{bad}");
        }
    }
}
