use glam::DVec3;
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

/// A quantity on a surface that a colour map shows.
#[derive(Clone, Debug, PartialEq)]
pub enum Quantity {
    /// The area of the triangle, in the mesh's own coordinates.
    Area,
    /// The Euclidean distance of the point from the eye (orthographic: along its ray), or from a point in world space;
    /// in scene units.
    Distance(Option<DVec3>),
    /// The curvature at vertices, in the mesh's own coordinates (1/length, or 1/length²), interpolated between them.
    Curvature(Curvature),
    /// The file's scalar of this name.
    Scalar(Arc<str>),
}

/// Which curvature of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curvature {
    /// Half the sum of the principal curvatures: 1/r on a sphere of radius r whose triangles face outwards.
    Mean,
    /// The product of the principal curvatures: 1/r² on a sphere of radius r.
    Gaussian,
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Area => f.write_str("area"),
            Self::Distance(None) => f.write_str("distance"),
            Self::Distance(Some(from)) => write!(f, "distance:{},{},{}", from.x, from.y, from.z),
            Self::Curvature(Curvature::Mean) => f.write_str("curvature"),
            Self::Curvature(Curvature::Gaussian) => f.write_str("curvature:gaussian"),
            Self::Scalar(name) => write!(f, "scalar:{name}"),
        }
    }
}

impl FromStr for Quantity {
    type Err = String;

    /// Parses what [`Quantity`] displays, and `curvature:mean`. Coordinates must be finite.
    fn from_str(text: &str) -> Result<Self, String> {
        let (kind, of) = match text.split_once(':') {
            Some((kind, of)) => (kind, Some(of)),
            None => (text, None),
        };
        match (kind, of) {
            ("area", None) => Ok(Self::Area),
            ("distance", None) => Ok(Self::Distance(None)),
            ("distance", Some(point)) => {
                let numbers: Option<Vec<f64>> = point
                    .split(',')
                    .map(|number| number.trim().parse().ok().filter(|n: &f64| n.is_finite()))
                    .collect();
                match numbers.as_deref() {
                    Some(&[x, y, z]) => Ok(Self::Distance(Some(DVec3::new(x, y, z)))),
                    _ => Err(format!(
                        "expected a point as distance:X,Y,Z, found {point:?}"
                    )),
                }
            }
            ("curvature", None | Some("mean")) => Ok(Self::Curvature(Curvature::Mean)),
            ("curvature", Some("gaussian")) => Ok(Self::Curvature(Curvature::Gaussian)),
            ("scalar", Some(name)) if !name.is_empty() => Ok(Self::Scalar(name.into())),
            _ => Err(format!(
                "expected area, distance, distance:X,Y,Z, curvature, curvature:gaussian or scalar:NAME, \
                 found {text:?}"
            )),
        }
    }
}
