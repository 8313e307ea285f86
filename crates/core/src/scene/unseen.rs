use super::{Bounds, COORDINATE_LIMIT, Object};
use glam::{DAffine3, DVec3};
use std::fmt;

/// Why a transform leaves nothing of an object's triangles for rays to hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unseen {
    /// All of it lies further than [`COORDINATE_LIMIT`] from zero along an axis.
    TooFar,
    /// It is scaled to a line or a point.
    NoArea,
}

impl Unseen {
    /// Whether, and why, no ray can hit an object that has triangles; from its transform alone, hidden or not.
    pub fn of(object: &Object, world_from_object: &DAffine3) -> Option<Self> {
        if object.kept().is_empty() {
            return None;
        }
        let bounds = object.bounds();
        let corners = bounds
            .corners()
            .map(|corner| world_from_object.transform_point3(corner));
        let placed = Bounds::around(corners);
        // A box that is out of range along an axis, or degenerate to a line, contains nothing that rays can hit.
        let nearest = DVec3::ZERO.clamp(placed.min, placed.max);
        let [x, y, z] = world_from_object
            .matrix3
            .to_cols_array_2d()
            .map(DVec3::from_array);
        if nearest.abs().max_element() > COORDINATE_LIMIT {
            Some(Self::TooFar)
        } else if [x.cross(y), y.cross(z), z.cross(x)] == [DVec3::ZERO; 3] {
            Some(Self::NoArea)
        } else {
            None
        }
    }
}

impl fmt::Display for Unseen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFar => write!(f, "it lies further than {COORDINATE_LIMIT:e} from zero"),
            Self::NoArea => f.write_str("it is scaled to nothing"),
        }
    }
}
