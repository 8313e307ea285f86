//! Where labels go: beside what they name, and over nothing else.
//!
//! Places about a point are tried from near to far; the one that is in the way of least is taken,
//! label after label (the greedy way of Christensen, Marks and Shieber, "An Empirical Study of
//! Algorithms for Point-Feature Label Placement", 1995).

use super::canvas::Point;

/// A rectangle with its sides along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub(super) low: Point,
    pub(super) high: Point,
}

impl Area {
    pub(super) fn around(point: Point, reach: f64) -> Self {
        Self {
            low: (point.0 - reach, point.1 - reach),
            high: (point.0 + reach, point.1 + reach),
        }
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.low.0 < other.high.0
            && other.low.0 < self.high.0
            && self.low.1 < other.high.1
            && other.low.1 < self.high.1
    }

    fn holds(&self, other: &Self) -> bool {
        self.low.0 <= other.low.0
            && self.low.1 <= other.low.1
            && self.high.0 >= other.high.0
            && self.high.1 >= other.high.1
    }

    fn contains(&self, (x, y): Point) -> bool {
        (self.low.0..=self.high.0).contains(&x) && (self.low.1..=self.high.1).contains(&y)
    }

    /// Its point nearest to another.
    pub(super) fn nearest_to(&self, (x, y): Point) -> Point {
        (
            x.clamp(self.low.0, self.high.0),
            y.clamp(self.low.1, self.high.1),
        )
    }
}

/// What is there already.
#[derive(Debug)]
pub(super) struct Taken {
    /// What labels must stay within.
    pub(super) bounds: Area,
    /// Dots and labels.
    pub(super) areas: Vec<Area>,
    /// Points along lines, a few pixels apart.
    pub(super) line_points: Vec<Point>,
}

/// Distances from a point to its label, from the best to the worst.
const DISTANCES: [f64; 8] = [7.0, 12.0, 19.0, 28.0, 40.0, 56.0, 76.0, 100.0];

/// Directions from a point to its label, from the best to the worst.
const DIRECTIONS: [Point; 10] = [
    (1.0, 0.0),
    (1.0, -0.55),
    (1.0, 0.55),
    (0.0, -1.0),
    (0.0, 1.0),
    (0.6, -1.0),
    (0.6, 1.0),
    (-1.0, 0.0),
    (-1.0, -0.55),
    (-1.0, 0.55),
];

impl Taken {
    /// The best place for a label of this size at one of the points (the first being the best to
    /// name), and the point; the place is taken from then on.
    pub(super) fn place(&mut self, (width, height): (f64, f64), points: &[Point]) -> (Area, Point) {
        let mut best = (f64::INFINITY, Area::around((0.0, 0.0), 0.0), (0.0, 0.0));
        for (rank, &point) in points.iter().enumerate() {
            for (ring, &distance) in DISTANCES.iter().enumerate() {
                for (turn, &(right, down)) in DIRECTIONS.iter().enumerate() {
                    let center = (
                        point.0 + right * (distance + width * 0.5),
                        point.1 + down * (distance + height * 0.5),
                    );
                    let area = Area {
                        low: (center.0 - width * 0.5, center.1 - height * 0.5),
                        high: (center.0 + width * 0.5, center.1 + height * 0.5),
                    };
                    if !self.bounds.holds(&area) {
                        continue;
                    }
                    let cost = self.cost(&area)
                        + 5.0 * ring as f64
                        + 0.8 * turn as f64
                        + 3.0 * (rank as f64).min(10.0);
                    if cost < best.0 {
                        best = (cost, area, point);
                    }
                }
            }
        }
        let (_, area, point) = best;
        self.areas.push(area);
        (area, point)
    }

    fn cost(&self, area: &Area) -> f64 {
        let over = self
            .areas
            .iter()
            .filter(|taken| taken.overlaps(area))
            .count();
        let crossed = self
            .line_points
            .iter()
            .filter(|&&point| area.contains(point))
            .count();
        400.0 * over as f64 + 6.0 * crossed as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_keep_out_of_each_others_way() {
        let bounds = Area {
            low: (0.0, 0.0),
            high: (400.0, 300.0),
        };
        let points: Vec<Point> = (0..12)
            .map(|i| (200.0, 120.0 + 3.0 * f64::from(i)))
            .collect();
        let mut taken = Taken {
            bounds,
            areas: points
                .iter()
                .map(|&point| Area::around(point, 3.0))
                .collect(),
            line_points: Vec::new(),
        };
        let mut placed: Vec<Area> = Vec::new();
        for &point in &points {
            let (area, _) = taken.place((90.0, 14.0), &[point]);
            assert!(bounds.holds(&area));
            assert!(
                !placed.iter().any(|other| other.overlaps(&area)),
                "{placed:?}"
            );
            placed.push(area);
        }
    }

    #[test]
    fn a_lonely_label_is_to_the_right() {
        let mut taken = Taken {
            bounds: Area::around((0.0, 0.0), 500.0),
            areas: vec![],
            line_points: vec![],
        };
        let (area, point) = taken.place((50.0, 10.0), &[(10.0, 20.0), (0.0, 0.0)]);
        assert_eq!(point, (10.0, 20.0));
        assert!(area.low.0 > 10.0 && area.low.1 < 20.0 && area.high.1 > 20.0);
        assert_eq!(area.nearest_to(point), (area.low.0, 20.0));
    }
}
