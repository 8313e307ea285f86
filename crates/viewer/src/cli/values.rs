//! Values of options: names, numbers, sizes and points. Errors of the parsers say in words what was expected.

use clap::builder::{PossibleValuesParser, RangedI64ValueParser, TypedValueParser};
use raycast_core::camera::{ImagePlane, PixelFilter};
use raycast_core::glam::DVec3;
use raycast_core::ranges;
use raycast_core::scene::UpAxis;
use raycast_core::{Cull, Precision};
use std::str::FromStr;

/// Names and their values, in the order in which help lists them.
pub(super) type Names<T> = &'static [(&'static str, T)];

pub(super) const PIXEL_FILTERS: Names<PixelFilter> = &PixelFilter::ALL;

pub(super) const PRECISIONS: Names<Precision> =
    &[("fast", Precision::Fast), ("exact", Precision::Exact)];

pub(super) const UP_AXES: Names<UpAxis> = &[("y", UpAxis::Y), ("z", UpAxis::Z)];

pub(super) const CULLS: Names<Cull> = &[("none", Cull::None), ("back", Cull::Back)];

/// Parses one of `names`.
pub(super) fn named<T: Copy + Send + Sync + 'static>(
    names: Names<T>,
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(names.iter().map(|(name, _)| *name)).map(move |given| {
        names
            .iter()
            .find(|(name, _)| *name == given)
            .map(|(_, value)| *value)
            .expect("clap lets only listed names through")
    })
}

/// Parses a count of workers.
pub(super) fn threads() -> RangedI64ValueParser<u16> {
    clap::value_parser!(u16).range(0..=256)
}

/// Parses a picture's size.
pub(super) fn size(text: &str) -> Result<(u32, u32), String> {
    let (columns, rows) = by(text, "a size as WIDTHxHEIGHT")?;
    ImagePlane::new(columns, rows, 1.0).map_err(|error| error.to_string())?;
    Ok((columns, rows))
}

/// Parses a grid's counts of columns and rows, at least 1.
pub(super) fn counts(text: &str) -> Result<(u32, u32), String> {
    match by(text, "a grid as COLUMNSxROWS")? {
        (0, _) | (_, 0) => Err("a grid needs at least one column and one row".to_owned()),
        counts => Ok(counts),
    }
}

/// Parses a column and row of a grid, from 0.
pub(super) fn cell(text: &str) -> Result<(u32, u32), String> {
    let [column, row] = list(text, "a sub-camera as COLUMN,ROW")?;
    Ok((column, row))
}

/// Parses a point or a direction.
pub(super) fn point(text: &str) -> Result<DVec3, String> {
    let point = DVec3::from_array(list(text, "three numbers as X,Y,Z")?);
    if point.is_finite() {
        Ok(point)
    } else {
        Err("expected three finite numbers".to_owned())
    }
}

/// Parses a count of samples.
pub(super) fn samples(text: &str) -> Result<u32, String> {
    ranges::samples(number(text)?).map_err(|error| error.to_string())
}

/// Parses a number of any size.
pub(super) fn number<T: FromStr>(text: &str) -> Result<T, String> {
    text.parse().map_err(|_| "expected a number".to_owned())
}

/// Parses two whole numbers separated by `x`.
pub(super) fn by(text: &str, expected: &str) -> Result<(u32, u32), String> {
    text.split_once(['x', 'X'])
        .and_then(|(left, right)| Some((left.parse().ok()?, right.parse().ok()?)))
        .ok_or_else(|| format!("expected {expected}"))
}

/// Parses `N` values separated by commas.
pub(super) fn list<T: FromStr, const N: usize>(
    text: &str,
    expected: &str,
) -> Result<[T; N], String> {
    text.split(',')
        .map(|part| part.trim().parse().ok())
        .collect::<Option<Vec<T>>>()
        .and_then(|values| values.try_into().ok())
        .ok_or_else(|| format!("expected {expected}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_limits() {
        assert_eq!(size("1280x720"), Ok((1280, 720)));
        assert_eq!(size("65536x65536"), Ok((65_536, 65_536)));
        for bad in ["0x5", "5x0", "-1x5", "65537x1", "5", "x", "1x2x3", "1.5x2"] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn lists_have_their_length() {
        assert_eq!(point("1,-2, 3e2"), Ok(DVec3::new(1.0, -2.0, 300.0)));
        assert!(point("1,2,3,4").is_err() && point("1,2").is_err() && point("1,2,x").is_err());
        assert!(point("1,2,NaN").is_err());
        assert_eq!(cell("2,0"), Ok((2, 0)));
        assert!(cell("-1,0").is_err());
    }
}
