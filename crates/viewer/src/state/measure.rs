//! Distances, angles and radii between points of the scene.

use super::State;
use super::lengths::Lengths;
use super::pick::Pick;
use raycast_core::glam::DVec3;
use raycast_core::math;
use std::sync::Arc;

/// The distance from the cursor within which a point snaps to a vertex, in pixels of the window.
const SNAP: f64 = 12.0;

/// The kind of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The distance between two points.
    Distance,
    /// The angle at the second of three points.
    Angle,
    /// The length of a path through points.
    Path,
    /// The radius of the circle through three points.
    Radius,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Distance, Self::Angle, Self::Path, Self::Radius];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Distance => "Distance",
            Self::Angle => "Angle",
            Self::Path => "Path",
            Self::Radius => "Radius",
        }
    }

    /// Its number of points; `None` for a path.
    pub fn points(self) -> Option<usize> {
        match self {
            Self::Distance => Some(2),
            Self::Angle | Self::Radius => Some(3),
            Self::Path => None,
        }
    }

    /// An instruction for the user, after so many points.
    fn hint(self, points: usize) -> &'static str {
        match (self, points) {
            (Self::Distance, 0) => "Click two points",
            (Self::Distance, _) => "Click the second point",
            (Self::Angle, 0) => "Click three points: the angle is at the second",
            (Self::Angle, 1) => "Click the second point, at which the angle is",
            (Self::Radius, 0) => "Click three points of the circle",
            (Self::Radius, 1) => "Click the second of three points",
            (Self::Angle | Self::Radius, _) => "Click the third point",
            (Self::Path, 0) => "Click points; Enter or a double-click ends the path",
            (Self::Path, 1) => "Click the next point",
            (Self::Path, _) => "Click the next point; Enter or a double-click ends the path",
        }
    }
}

/// A measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Its kind.
    pub kind: Kind,
    /// Its points in world space.
    pub points: Vec<DVec3>,
}

/// A circle in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Its middle.
    pub center: DVec3,
    /// Its radius, in scene units.
    pub radius: f64,
    /// The unit normal of its plane.
    pub normal: DVec3,
}

impl Measurement {
    /// A length in scene units, or an angle in degrees from 0 to 180. `None` for an angle with an arm of length zero,
    /// and a circle through collinear points.
    pub fn value(&self) -> Option<f64> {
        match (self.kind, &self.points[..]) {
            (Kind::Distance | Kind::Path, points) => {
                let lengths = points.windows(2).map(|ends| ends[0].distance(ends[1]));
                Some(lengths.sum())
            }
            (Kind::Angle, &[a, b, c]) => {
                let (u, v) = (a - b, c - b);
                // Well-conditioned at all angles, where the arc cosine is not (Kahan, "How Futile are
                // Mindless Assessments of Roundoff in Floating-Point Computation?", 2006).
                let angle = math::atan2(u.cross(v).length(), u.dot(v)).to_degrees();
                (u != DVec3::ZERO && v != DVec3::ZERO).then_some(angle)
            }
            (Kind::Radius, _) => self.circle().map(|circle| circle.radius),
            _ => None,
        }
    }

    /// The value in the unit that lengths are shown in; an angle stays in degrees.
    pub fn told(&self, lengths: &Lengths) -> Option<f64> {
        let value = self.value()?;
        Some(match self.kind {
            Kind::Angle => value,
            _ => lengths.converted(value, 1),
        })
    }

    /// The circle through three points; `None` if they are collinear.
    pub fn circle(&self) -> Option<Circle> {
        let (Kind::Radius, &[a, b, c]) = (self.kind, &self.points[..]) else {
            return None;
        };
        let (u, v) = (b - a, c - a);
        let normal = u.cross(v);
        let square = normal.length_squared();
        let from_a = (normal.cross(u) * v.length_squared() + v.cross(normal) * u.length_squared())
            / (2.0 * square);
        let circle = Circle {
            center: a + from_a,
            radius: from_a.length(),
            normal: normal.normalize_or_zero(),
        };
        (square.is_normal() && from_a.is_finite()).then_some(circle)
    }
}

/// The measuring tool, and the finished measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct Measuring {
    /// The tool in use; `None` if clicks pick.
    pub tool: Option<Kind>,
    /// The points clicked so far.
    pub points: Vec<DVec3>,
    /// Whether points snap to vertices.
    pub snaps: bool,
    /// The finished measurements, oldest first.
    pub list: Arc<Vec<Measurement>>,
}

impl Default for Measuring {
    fn default() -> Self {
        Self {
            tool: None,
            points: Vec::new(),
            snaps: true,
            list: Arc::default(),
        }
    }
}

impl Measuring {
    /// An instruction for the next click, while a tool is in use.
    pub fn hint(&self) -> Option<&'static str> {
        Some(self.tool?.hint(self.points.len()))
    }

    /// All measurements as comma-separated values, one a line, numbers with all their digits. Points are in the scene's
    /// coordinates.
    pub fn csv(&self, lengths: &Lengths) -> String {
        let mut text = "number,kind,value,unit,points\n".to_owned();
        for (number, measurement) in (1..).zip(&*self.list) {
            let value = measurement.told(lengths);
            let value = value.map_or_else(String::new, |value| value.to_string());
            let unit = match measurement.kind {
                Kind::Angle => "degrees",
                _ => lengths.symbol(),
            };
            let points: Vec<_> = measurement
                .points
                .iter()
                .map(|p| format!("{} {} {}", p.x, p.y, p.z))
                .collect();
            let (kind, points) = (measurement.kind.name(), points.join("; "));
            text.push_str(&format!("{number},{kind},{value},{unit},{points}\n"));
        }
        text
    }

    /// Forgets a measurement.
    pub(super) fn remove(&mut self, number: usize) {
        if number < self.list.len() {
            Arc::make_mut(&mut self.list).remove(number);
        }
    }

    /// Finishes a path of at least two points.
    pub(super) fn end_path(&mut self) {
        if self.tool == Some(Kind::Path) && self.points.len() > 1 {
            self.finish(Kind::Path);
        }
    }

    fn finish(&mut self, kind: Kind) {
        let points = std::mem::take(&mut self.points);
        Arc::make_mut(&mut self.list).push(Measurement { kind, points });
    }

    /// Adds a point; the last one finishes the measurement, and the next begins.
    pub(super) fn add(&mut self, point: DVec3) {
        // A double-click adds no second point.
        if self.points.last() == Some(&point) {
            return;
        }
        self.points.push(point);
        if let Some(kind) = self.tool
            && kind.points() == Some(self.points.len())
        {
            self.finish(kind);
        }
    }
}

/// The point that a click would add.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// In world space.
    pub point: DVec3,
    /// Whether it is a vertex that is snapped to.
    pub is_vertex: bool,
}

impl State {
    /// The point that a click at (x, y) of the picture would add: a vertex of the triangle there if points snap and one
    /// is near enough, else the hit itself.
    pub fn target(&self, x: f64, y: f64) -> Option<Target> {
        let pick = self.pick(x, y)?;
        let hit = Target {
            point: pick.point,
            is_vertex: false,
        };
        if !self.measuring.snaps {
            return Some(hit);
        }
        let camera = self.camera()?;
        let reach = SNAP * f64::from(self.size().0) / f64::from(self.viewport.0.max(1));
        let near = self.corners_of(pick)?.into_iter().filter_map(|corner| {
            let (cx, cy) = camera.project(corner)?;
            let square = (cx - x) * (cx - x) + (cy - y) * (cy - y);
            (square <= reach * reach).then_some((square, corner))
        });
        let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0));
        Some(nearest.map_or(hit, |(_, point)| Target {
            point,
            is_vertex: true,
        }))
    }

    fn corners_of(&self, pick: Pick) -> Option<[DVec3; 3]> {
        let scene = &self.document.as_ref()?.built;
        let number = pick.hit.object as usize;
        let object = scene.objects.get(number)?;
        let world_from_object = scene.world_from_object(number).ok()?;
        let corners = object.mesh.corners(pick.hit.triangle)?;
        Some(corners.map(|corner| {
            world_from_object.transform_point3(object.mesh.offset() + corner.as_dvec3())
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(kind: Kind, points: &[[f64; 3]]) -> Option<f64> {
        let points = points.iter().map(|p| DVec3::from_array(*p)).collect();
        Measurement { kind, points }.value()
    }

    #[test]
    fn lengths_angles_and_radii_are_those_of_geometry() {
        assert_eq!(value(Kind::Distance, &[[0.; 3], [3., 4., 0.]]), Some(5.0));
        let path = [[0.; 3], [1., 0., 0.], [1., 2., 0.], [1., 2., 4.]];
        assert_eq!(value(Kind::Path, &path), Some(7.0));
        let right = [[1., 0., 0.], [0.; 3], [0., 0., 7.]];
        assert_eq!(value(Kind::Angle, &right), Some(90.0));
        // An angle of 1e-8 radians, of which an arc cosine would know nothing.
        let narrow = value(Kind::Angle, &[[1., 0., 0.], [0.; 3], [1., 1e-8, 0.]]);
        assert!((narrow.expect("an angle").to_radians() / 1e-8 - 1.0).abs() < 1e-12);
        assert_eq!(
            value(Kind::Angle, &[[1., 0., 0.], [1., 0., 0.], [0.; 3]]),
            None
        );
        let circle = [[13., 0., 5.], [10., 3., 5.], [7., 0., 5.]];
        let radius = value(Kind::Radius, &circle).expect("a circle");
        assert!((radius - 3.0).abs() < 1e-14);
        let points = circle.map(DVec3::from_array).to_vec();
        let circle = Measurement {
            kind: Kind::Radius,
            points,
        }
        .circle()
        .expect("one");
        assert!(circle.center.distance(DVec3::new(10., 0., 5.)) < 1e-14);
        assert!(circle.normal.distance(DVec3::Z) < 1e-15);
        let line = [[0.; 3], [1., 1., 1.], [2., 2., 2.]];
        assert_eq!(value(Kind::Radius, &line), None);
    }

    #[test]
    fn points_make_measurements_one_after_another() {
        let mut measuring = Measuring {
            tool: Some(Kind::Distance),
            ..Measuring::default()
        };
        for point in [DVec3::ZERO, DVec3::ZERO, DVec3::X, DVec3::Y] {
            measuring.add(point);
        }
        assert_eq!(measuring.hint(), Some("Click the second point"));
        assert_eq!(measuring.list.len(), 1, "the same place twice is one point");
        assert_eq!(measuring.points, [DVec3::Y], "the next has begun");
        measuring.tool = Some(Kind::Path);
        measuring.end_path();
        assert_eq!(measuring.list.len(), 1, "one point is no path");
        measuring.add(DVec3::new(0.1, 1.0, 0.0));
        measuring.end_path();
        assert_eq!(
            measuring.csv(&Lengths::default()),
            "number,kind,value,unit,points\n1,Distance,1,scene units,0 0 0; 1 0 0\n\
             2,Path,0.1,scene units,0 1 0; 0.1 1 0\n"
        );
    }
}
