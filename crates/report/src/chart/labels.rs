//! Label placement: near what a label names, and not over anything else.
//!
//! A greedy algorithm: for each label in turn, candidate positions around the point are scored by distance and
//! overlap, and the cheapest is taken (Christensen, Marks and Shieber, "An Empirical Study of Algorithms for
//! Point-Feature Label Placement", 1995).

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

    /// The point of the area nearest to another point.
    pub(super) fn nearest_to(&self, (x, y): Point) -> Point {
        (
            x.clamp(self.low.0, self.high.0),
            y.clamp(self.low.1, self.high.1),
        )
    }
}

/// The areas that are occupied.
#[derive(Debug)]
pub(super) struct OccupiedAreas {
    /// The area that labels must not leave.
    pub(super) bounds: Area,
    /// Dots and labels placed so far.
    pub(super) areas: Vec<Area>,
    /// Samples of lines, a few pixels apart.
    pub(super) line_points: Vec<Point>,
}

/// Candidate gaps between a point and the nearest side of its label, in pixels.
const GAPS: [f64; 5] = [7.0, 16.0, 34.0, 60.0, 90.0];

/// Candidate rows above and below a point.
const ROWS: i32 = 12;

impl OccupiedAreas {
    /// Finds the cheapest position for a label of this size at one of the points (the earlier, the better to name)
    /// and marks it as occupied. Returns it and the point.
    pub(super) fn place(&mut self, (width, height): (f64, f64), points: &[Point]) -> (Area, Point) {
        let mut best = (f64::INFINITY, Area::around((0.0, 0.0), 0.0), (0.0, 0.0));
        for (rank, &point) in points.iter().enumerate() {
            for (center, penalty) in candidates(point, (width, height)) {
                let area = Area {
                    low: (center.0 - width * 0.5, center.1 - height * 0.5),
                    high: (center.0 + width * 0.5, center.1 + height * 0.5),
                };
                if !self.bounds.holds(&area) {
                    continue;
                }
                let cost = self.cost(&area) + penalty + 3.0 * (rank as f64).min(10.0);
                if cost < best.0 {
                    best = (cost, area, point);
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
            .filter(|occupied| occupied.overlaps(area))
            .count();
        let crossed = self
            .line_points
            .iter()
            .filter(|&&point| area.contains(point))
            .count();
        400.0 * over as f64 + 6.0 * crossed as f64
    }
}

/// Candidate centres of a label around a point, each with a cost that grows with distance: to the right, to the
/// left, above, below, and in rows further up and down.
fn candidates(point: Point, (width, height): (f64, f64)) -> Vec<(Point, f64)> {
    let mut all = Vec::new();
    for (ring, gap) in GAPS.into_iter().enumerate() {
        let far = 6.0 * ring as f64;
        for (side, away) in [(1.0, 0.0), (-1.0, 2.5)] {
            let x = point.0 + side * (gap + width * 0.5);
            for row in -ROWS..=ROWS {
                let center = (x, point.1 + f64::from(row) * height * 0.75);
                all.push((center, far + away + 2.2 * f64::from(row.abs())));
            }
        }
        for (side, away) in [(-1.0, 1.5), (1.0, 2.0)] {
            all.push(((point.0, point.1 + side * (gap + height * 0.5)), far + away));
        }
    }
    all
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
        let mut occupied = OccupiedAreas {
            bounds,
            areas: points
                .iter()
                .map(|&point| Area::around(point, 3.0))
                .collect(),
            line_points: Vec::new(),
        };
        let mut placed: Vec<Area> = Vec::new();
        for &point in &points {
            let (area, _) = occupied.place((90.0, 14.0), &[point]);
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
        let mut occupied = OccupiedAreas {
            bounds: Area::around((0.0, 0.0), 500.0),
            areas: vec![],
            line_points: vec![],
        };
        let (area, point) = occupied.place((50.0, 10.0), &[(10.0, 20.0), (0.0, 0.0)]);
        assert_eq!(point, (10.0, 20.0));
        assert!(area.low.0 > 10.0 && area.low.1 < 20.0 && area.high.1 > 20.0);
        assert_eq!(area.nearest_to(point), (area.low.0, 20.0));
    }
}
