//! Lines along a triangle's edges, of constant width in pixels.

use crate::camera::Camera;
use crate::num::simd::LANES;
use glam::DVec3;

/// The height of a triangle, in line widths, below which lines fade. Lower triangles would be covered by lines.
const FADE_WIDTHS: f64 = 8.0;

/// How far lines fade in triangles smaller than a pixel: without a limit distant wireframes would vanish.
const FAINTEST: f64 = 0.1;

/// The style of a line along an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LineStyle {
    /// In the lines' colour; fades in small triangles.
    Plain,
    /// In the lines' colour.
    Feature,
    /// Of an edge of one triangle.
    Boundary,
    /// Of an edge of more than two triangles.
    NonManifold,
}

impl LineStyle {
    /// The opacity that remains of a line in a triangle of this height in pixels.
    pub(super) fn fade(self, height: f64, width: f64) -> f64 {
        match self {
            // Where all edges have lines, those of a distant mesh would cover everything.
            Self::Plain => (height / (FADE_WIDTHS * width.max(1.0))).clamp(FAINTEST, 1.0),
            Self::Feature | Self::Boundary | Self::NonManifold => 1.0,
        }
    }
}

/// The map from a pixel's place to its distance from each edge of one triangle.
///
/// Seen from an eye, an edge from B to C lies in the plane with normal B × C (both relative to the eye). `d · (B ×
/// C)` is linear in the pixel's place, because the direction `d` is before normalising. Divided by its gradient it is
/// the distance in pixels from the edge's line. The origins of orthographic rays are linear in the pixel's place in
/// the same way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EdgeLines {
    /// Coefficients of x, y and 1 for each edge, none of them NaN. An edge that is seen as a point is infinitely far from
    /// every pixel.
    lines: [[f64; 3]; 3],
    /// The triangle's least height in pixels.
    height: f64,
    /// The style of each edge that has a line, unless all have plain ones.
    styles: Option<[Option<LineStyle>; 3]>,
}

/// A camera whose rays are linear in the pixel's place.
struct LinearView {
    /// The vector from the view axis to the place (0, 0).
    first: DVec3,
    across: DVec3,
    down: DVec3,
    forward: DVec3,
    distance: f64,
    is_parallel: bool,
}

impl EdgeLines {
    /// A line that is infinitely far from every pixel.
    const NOWHERE: [f64; 3] = [0.0, 0.0, f64::INFINITY];

    /// The edges of a triangle whose corners are relative to the eye.
    pub(super) fn new(camera: &Camera, corners: [DVec3; 3]) -> Self {
        let plane = camera.plane();
        let [x, y] = camera.principal_point();
        let across = camera.right() * plane.step;
        let down = camera.up() * -plane.step;
        let view = LinearView {
            first: across * -x + down * -y,
            across,
            down,
            forward: camera.forward(),
            distance: camera.distance(),
            is_parallel: camera.projection().is_parallel(),
        };
        Self::seen(&view, corners)
    }

    /// The edges as seen near a place of a curved picture: on the plane that is tangent there.
    pub(super) fn at(camera: &Camera, corners: [DVec3; 3], (x, y): (f64, f64)) -> Self {
        let direction = camera.direction(x, y);
        let [across, down] = camera.direction_slopes(x, y);
        let distance = direction.length();
        let view = LinearView {
            first: across * -x + down * -y,
            across,
            down,
            forward: direction / distance,
            distance,
            is_parallel: false,
        };
        Self::seen(&view, corners)
    }

    fn seen(view: &LinearView, corners: [DVec3; 3]) -> Self {
        let LinearView {
            first,
            across,
            down,
            forward,
            distance,
            is_parallel,
        } = *view;
        // Distances in the picture do not depend on the scene's scale; scaling keeps products in range.
        let scale = corners
            .iter()
            .map(|corner| corner.abs().max_element())
            .fold(0.0, f64::max);
        let [a, b, c] = corners.map(|corner| corner / scale);
        let edge = |from: DVec3, to: DVec3, opposite: DVec3| {
            // A linear function of the pixel's place that is zero on the edge, and its value at the opposite corner.
            let (normal, constant, at_opposite) = if is_parallel {
                let normal = (to - from).cross(forward);
                let constant = normal.dot(first / scale - from);
                (normal / scale, constant, normal.dot(opposite - from))
            } else {
                let normal = (to - from).cross(from + to);
                let reach = opposite.dot(forward) / distance;
                let at_opposite = if reach > 0.0 {
                    normal.dot(opposite) / reach
                } else {
                    // Behind the eye: the triangle is unbounded in the picture.
                    f64::INFINITY
                };
                let constant = normal.dot(first + forward * distance);
                (normal, constant, at_opposite)
            };
            let (x, y) = (normal.dot(across), normal.dot(down));
            let gradient = (x * x + y * y).sqrt();
            let constant = constant / gradient;
            let line = match gradient.is_normal() && constant.is_finite() {
                true => [x / gradient, y / gradient, constant],
                false => Self::NOWHERE,
            };
            let height = match gradient.is_normal() {
                true => at_opposite.abs() / gradient,
                false => f64::INFINITY,
            };
            (line, height)
        };
        let edges = [edge(a, b, c), edge(b, c, a), edge(c, a, b)];
        Self {
            lines: edges.map(|(line, _)| line),
            height: edges
                .map(|(_, height)| height)
                .into_iter()
                .fold(f64::INFINITY, f64::min),
            styles: None,
        }
    }

    /// The same with lines along some edges only, each in its style.
    pub(super) fn chosen(mut self, styles: [Option<LineStyle>; 3]) -> Self {
        self.styles = Some(styles);
        self
    }

    /// The same with another's choice of edges.
    pub(super) fn chosen_as(mut self, other: &Self) -> Self {
        self.styles = other.styles;
        self
    }

    /// The triangle's least height in pixels.
    pub(super) fn height(&self) -> f64 {
        self.height
    }

    /// The distance in pixels from (x, y) to the nearest edge's line.
    pub(super) fn distance(&self, x: f64, y: f64) -> f64 {
        self.lines
            .iter()
            .map(|line| (line[0] * x + line[1] * y + line[2]).abs())
            .fold(f64::INFINITY, f64::min)
    }

    /// The opacity of a line at (x, y), 0 to 1 over one pixel, and the style of the most visible line.
    ///
    /// Half of a line lies in each of the two triangles at an edge. Plain lines fade in triangles that are only a few
    /// line widths high, so that a distant mesh keeps its shading.
    pub(super) fn coverage(&self, x: f64, y: f64, width: f64) -> (f32, LineStyle) {
        let Some(styles) = self.styles else {
            let fade = LineStyle::Plain.fade(self.height, width);
            let covered = covered(self.distance(x, y), width);
            return ((covered * fade) as f32, LineStyle::Plain);
        };
        let mut most = (0.0, LineStyle::Plain);
        for (line, style) in self.lines.iter().zip(styles) {
            let Some(style) = style else {
                continue;
            };
            let distance = (line[0] * x + line[1] * y + line[2]).abs();
            let covered = covered(distance, width) * style.fade(self.height, width);
            if covered > most.0 {
                most = (covered, style);
            }
        }
        (most.0 as f32, most.1)
    }
}

impl EdgeLines {
    /// Whether not all edges have plain lines.
    pub(super) fn is_chosen(&self) -> bool {
        self.styles.is_some()
    }

    /// [`EdgeLines::coverage`] at eight places of a row, where all edges have plain lines. Plain loops over arrays, which
    /// compilers vectorise.
    #[inline(always)]
    pub(super) fn coverages(&self, xs: &[f64; LANES], y: f64, width: f64) -> [f32; LANES] {
        let fade = LineStyle::Plain.fade(self.height, width);
        let (reach, most) = reach(width);
        let distances = |[a, b, c]: [f64; 3]| {
            let down = b * y;
            let mut distances = [0.0; LANES];
            for (distance, x) in distances.iter_mut().zip(xs) {
                *distance = (a * x + down + c).abs();
            }
            distances
        };
        // None is NaN: a comparison with infinity at first would be compiled lane by lane.
        let [first, rest @ ..] = self.lines;
        let mut nearest = distances(first);
        for line in rest {
            for (nearest, distance) in nearest.iter_mut().zip(distances(line)) {
                *nearest = if distance < *nearest {
                    distance
                } else {
                    *nearest
                };
            }
        }
        let mut coverages = [0.0; LANES];
        for (coverage, distance) in coverages.iter_mut().zip(nearest) {
            let covered = reach - distance;
            let covered = if covered > 0.0 { covered } else { 0.0 };
            let covered = if covered < most { covered } else { most };
            *coverage = (covered * fade) as f32;
        }
        coverages
    }
}

/// The distance from a line's middle at which it covers nothing of a pixel, and the most that it covers of one.
#[inline(always)]
pub(super) const fn reach(width: f64) -> (f64, f64) {
    (width * 0.5 + 0.5, width.clamp(0.0, 1.0))
}

/// The fraction of a pixel that is covered by a line whose middle is this many pixels away.
pub(super) fn covered(distance: f64, width: f64) -> f64 {
    let (reach, most) = reach(width);
    (reach - distance).clamp(0.0, most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{ImagePlane, Pose, Projection};
    use crate::random::Random;

    fn camera(projection: Projection, eye: DVec3) -> Camera {
        let plane = ImagePlane::new(200, 100, 0.02).expect("a good plane");
        let pose = Pose {
            eye,
            target: DVec3::new(0.1, 0.2, 0.3),
            up: DVec3::Y,
        };
        Camera::new(pose, projection, plane)
    }

    /// The distance from a point to the line through two others in the picture: the truth.
    fn to_line(p: (f64, f64), a: (f64, f64), b: (f64, f64)) -> f64 {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        ((p.0 - a.0) * dy - (p.1 - a.1) * dx).abs() / (dx * dx + dy * dy).sqrt()
    }

    #[test]
    fn distances_are_those_between_projected_points() {
        // The truth is the corners projected into the picture, and plane geometry there.
        let corners = [
            DVec3::new(-0.5, -0.3, 0.2),
            DVec3::new(0.7, -0.1, -0.4),
            DVec3::new(0.2, 0.6, 0.5),
        ];
        for projection in [Projection::Perspective, Projection::Orthographic] {
            for eye in [DVec3::new(3.0, 2.0, 4.0), DVec3::new(-1.0, 0.5, 1.5)] {
                let camera = camera(projection, eye);
                let edges = EdgeLines::new(&camera, corners.map(|corner| corner - eye));
                let [a, b, c] =
                    corners.map(|corner| camera.project(corner).expect("in front of the eye"));
                for p in [(100.0, 50.0), (90.5, 47.5), (3.0, 99.0)] {
                    let truth = [(a, b), (b, c), (c, a)]
                        .map(|(from, to)| to_line(p, from, to))
                        .into_iter()
                        .fold(f64::INFINITY, f64::min);
                    let found = edges.distance(p.0, p.1);
                    assert!((found - truth).abs() < 1e-9, "{found} for {truth}");
                }
                let height = to_line(a, b, c).min(to_line(b, c, a)).min(to_line(c, a, b));
                assert!((edges.height - height).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn lines_are_as_wide_far_as_near() {
        // The same shape, ten times as far away and ten times as large, looks the same.
        let camera = camera(Projection::Perspective, DVec3::new(0.1, 0.2, 5.0));
        let corners = [
            DVec3::new(-1.0, -1.0, -5.0),
            DVec3::new(1.0, -1.0, -6.0),
            DVec3::new(0.0, 1.0, -4.0),
        ];
        let near = EdgeLines::new(&camera, corners);
        let far = EdgeLines::new(&camera, corners.map(|corner| corner * 1e20));
        for (x, y) in [(100.0, 50.0), (70.5, 20.5)] {
            assert!((near.coverage(x, y, 2.0).0 - far.coverage(x, y, 2.0).0).abs() < 1e-6);
        }
    }

    #[test]
    fn coverage_runs_from_all_to_none_over_a_pixel() {
        let edges = EdgeLines {
            lines: [[1.0, 0.0, 0.0], [0.0, 1.0, 1e3], [0.0, 1.0, 2e3]],
            height: 1e3,
            styles: None,
        };
        let at = |x| edges.coverage(x, 0.0, 3.0).0;
        assert_eq!((at(0.0), at(1.0), at(1.5), at(2.0)), (1.0, 1.0, 0.5, 0.0));
        // A line half a pixel wide never covers more than half a pixel.
        assert_eq!(edges.coverage(0.0, 0.0, 0.5).0, 0.5);
        assert_eq!(edges.coverage(0.0, 0.0, 0.0).0, 0.0);
    }

    #[test]
    fn lines_fade_in_small_triangles() {
        let edges = |height| EdgeLines {
            lines: [[1.0, 0.0, 0.0], [0.0, 1.0, 1e3], [0.0, 1.0, 2e3]],
            height,
            styles: None,
        };
        assert_eq!(edges(0.01).coverage(0.0, 0.0, 1.0).0, FAINTEST as f32);
        assert_eq!(edges(4.0).coverage(0.0, 0.0, 1.0).0, 0.5);
        assert_eq!(edges(50.0).coverage(0.0, 0.0, 1.0).0, 1.0);
    }

    #[test]
    fn eight_coverages_have_the_bits_of_single_ones() {
        let mut random = Random(3);
        for round in 0..2000 {
            let mut line = || {
                let p = random.point();
                [p.x, p.y, p.z * 30.0]
            };
            let mut edges = EdgeLines {
                lines: [line(), line(), line()],
                height: random.unit() * 20.0,
                styles: None,
            };
            if round % 5 == 0 {
                edges.lines[round % 3] = EdgeLines::NOWHERE;
            }
            if round % 7 == 0 {
                edges.lines[2] = EdgeLines::NOWHERE;
            }
            let width = [0.0, 0.5, 1.0, 2.7][round % 4];
            let y = random.unit() * 40.0;
            let xs: [f64; LANES] = std::array::from_fn(|lane| lane as f64 * 0.7);
            let expected = xs.map(|x| edges.coverage(x, y, width).0);
            assert_eq!(edges.coverages(&xs, y, width), expected, "{edges:?}");
        }
    }

    #[test]
    fn chosen_edges_alone_have_lines_in_their_styles() {
        // Lines at x = 0, 10 and 20, in a triangle that plain lines fade in.
        let edges = EdgeLines {
            lines: [[1.0, 0.0, 0.0], [1.0, 0.0, -10.0], [1.0, 0.0, -20.0]],
            height: 4.0,
            styles: None,
        };
        let styles = [None, Some(LineStyle::Boundary), Some(LineStyle::Plain)];
        let chosen = edges.chosen(styles);
        assert_eq!(chosen.coverage(0.0, 0.0, 1.0).0, 0.0);
        assert_eq!(chosen.coverage(10.0, 0.0, 1.0), (1.0, LineStyle::Boundary));
        assert_eq!(chosen.coverage(20.0, 0.0, 1.0), (0.5, LineStyle::Plain));
        // With all edges in the plain style the result is that without a choice.
        let plain = edges.chosen([Some(LineStyle::Plain); 3]);
        for x in 0..100 {
            let x = f64::from(x) * 0.25;
            assert_eq!(plain.coverage(x, 0.0, 2.5).0, edges.coverage(x, 0.0, 2.5).0);
        }
    }

    #[test]
    fn triangles_seen_from_within_their_plane_are_no_error() {
        let camera = camera(Projection::Perspective, DVec3::ZERO);
        let forward = camera.forward();
        let edges = EdgeLines::new(&camera, [forward, forward * 2.0, forward * 3.0]);
        assert!(!edges.coverage(10.5, 10.5, 1.0).0.is_nan());
        let behind = EdgeLines::new(&camera, [forward, -forward, forward + camera.right()]);
        assert!(!behind.coverage(10.5, 10.5, 1.0).0.is_nan());
    }
}
