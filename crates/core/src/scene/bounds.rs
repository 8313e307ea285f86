use glam::DVec3;

/// An axis-aligned box; [`Bounds::EMPTY`] contains no point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The lowest coordinate along each axis.
    pub min: DVec3,
    /// The highest coordinate along each axis.
    pub max: DVec3,
}

impl Bounds {
    /// The box of no points: `min` is +∞ and `max` −∞.
    pub const EMPTY: Self = Self {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };

    /// The smallest box around `points`; empty if there are none.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |bounds, point| Self {
            min: bounds.min.min(point),
            max: bounds.max.max(point),
        })
    }

    /// The smallest box that contains both.
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Whether the box contains no point.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The box's middle; the origin for an empty box.
    pub fn center(&self) -> DVec3 {
        if self.is_empty() {
            DVec3::ZERO
        } else {
            self.min + (self.max - self.min) * 0.5
        }
    }

    /// Length along each axis; zero for an empty box.
    pub fn size(&self) -> DVec3 {
        if self.is_empty() {
            DVec3::ZERO
        } else {
            self.max - self.min
        }
    }

    /// The eight corners, x fastest.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|corner| {
            DVec3::new(
                if corner & 1 == 0 {
                    self.min.x
                } else {
                    self.max.x
                },
                if corner & 2 == 0 {
                    self.min.y
                } else {
                    self.max.y
                },
                if corner & 4 == 0 {
                    self.min.z
                } else {
                    self.max.z
                },
            )
        })
    }
}
