//! Lines where no triangle that a pixel shows has them: hidden ones, and silhouettes, which lie outside.

use super::edge_choice::{EdgeChoice, SilhouetteView};
use super::edges::{EdgeLines, LineStyle, covered};
use crate::bvh::Accel;
use crate::camera::Camera;
use crate::num::simd::LANES;
use crate::scene::ClippingPlanes;
use glam::{DVec2, DVec3, Vec2};
use rayon::prelude::*;

/// The side of a cell, in pixels. Smaller ones take more memory, larger ones more lines a pixel.
const CELL: f64 = 16.0;

/// How much nearer than a pixel's hit a silhouette has to be, in shares of its distance: either is in single
/// precision, at the end of a few roundings of 2⁻²⁴ each.
const NEARER: f64 = 1.0 / (1 << 21) as f64;

/// Edges as line segments of a picture that is a plane, by cells of its pixels. They take 32 bytes an edge that
/// is in the picture, for each triangle that has it, and four bytes in each cell.
#[derive(Debug)]
pub(super) struct LineOverlay {
    segments: Vec<Segment>,
    /// For each cell where its lines begin; and the end of all.
    starts: Vec<usize>,
    /// Numbers of segments, cell by cell.
    lines: Vec<u32>,
    /// Cells in a row.
    columns: usize,
    width: f64,
    camera: Camera,
}

/// What lines are to be there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted<'a> {
    /// `None`: all edges.
    pub(super) choice: Option<&'a EdgeChoice<'a>>,
    /// The lines' width in pixels.
    pub(super) width: f64,
    /// Whether hidden lines are seen.
    pub(super) hidden: bool,
    /// What is cut away.
    pub(super) clip: &'a ClippingPlanes,
}

/// An edge in the picture.
#[derive(Clone, Copy, Debug)]
struct Segment {
    ends: [Vec2; 2],
    /// What is linear between them: inverse depths from an eye, depths along parallel rays.
    depths: [f32; 2],
    /// How much of its line is left.
    fade: f32,
    style: LineStyle,
    is_silhouette: bool,
}

impl Segment {
    /// The place on it that is nearest to another, as a share of its length, and how far away that is.
    fn nearest(&self, place: DVec2) -> (f64, f64) {
        let [from, to] = self.ends.map(Vec2::as_dvec2);
        let along = to - from;
        let share = ((place - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        // A segment that is seen as a point has no direction.
        let share = if share.is_nan() { 0.0 } else { share };
        (share, place.distance(from + along * share))
    }
}

impl LineOverlay {
    /// Of a scene's edges; `None` where no line is wanted, or the picture is no plane.
    pub(super) fn new(accel: &Accel, camera: Camera, wanted: Wanted<'_>) -> Option<Self> {
        let asks = wanted.hidden || wanted.choice.is_some_and(EdgeChoice::has_silhouettes);
        if !asks || camera.projection().panorama().is_some() {
            return None;
        }
        let projector = LineProjector::new(&camera, wanted.width);
        let primitives: Vec<u32> = accel.primitives().collect();
        let of = |&primitive: &u32| edges(accel, primitive, &projector, wanted);
        let segments: Vec<Segment> = primitives.par_iter().flat_map_iter(of).collect();
        let [columns, rows] = projector.size.map(|side| (side / CELL).ceil() as usize);
        let mut overlay = Self {
            segments,
            starts: vec![0; columns * rows + 1],
            lines: Vec::new(),
            columns,
            width: wanted.width,
            camera,
        };
        overlay.sort(rows);
        Some(overlay)
    }

    /// Puts segments into cells: counts them, then lays them down.
    fn sort(&mut self, rows: usize) {
        let reach = self.reach();
        for segment in &self.segments {
            cells(segment, reach, (self.columns, rows), |cell| {
                self.starts[cell + 1] += 1;
            });
        }
        for cell in 1..self.starts.len() {
            self.starts[cell] += self.starts[cell - 1];
        }
        let mut next = self.starts.clone();
        self.lines = vec![0; self.starts.last().copied().unwrap_or(0)];
        for (number, segment) in self.segments.iter().enumerate() {
            cells(segment, reach, (self.columns, rows), |cell| {
                self.lines[next[cell]] = number as u32;
                next[cell] += 1;
            });
        }
    }

    /// The segments that may reach a place.
    fn near(&self, x: f64, y: f64) -> impl Iterator<Item = &Segment> {
        let cell = (y / CELL) as usize * self.columns + (x / CELL) as usize;
        let range = self.starts.get(cell).zip(self.starts.get(cell + 1));
        let lines = range.map_or(&[][..], |(from, to)| &self.lines[*from..*to]);
        lines.iter().map(|line| &self.segments[*line as usize])
    }

    /// For eight places of a row, from left to right, whether a line may reach them: `false` is certain.
    pub(super) fn may_reach(&self, xs: &[f64; LANES], y: f64) -> [bool; LANES] {
        // Cells of a row lie one after another.
        let cell = |x: f64| (y / CELL) as usize * self.columns + (x / CELL) as usize;
        let end = self.lines.len();
        let begin = |cell: usize| self.starts.get(cell).copied().unwrap_or(end);
        if begin(cell(xs[0])) == begin(cell(xs[LANES - 1]) + 1) {
            return [false; LANES];
        }
        let reach = self.reach();
        xs.map(|x| {
            let place = DVec2::new(x, y);
            self.near(x, y)
                .any(|segment| segment.nearest(place).1 < reach)
        })
    }

    /// The distance from a segment, in pixels, beyond which its line covers nothing: with a margin of half a pixel.
    fn reach(&self) -> f64 {
        self.width + 1.0
    }

    /// How much of a hidden line shows at a place of the picture, as if nothing hid it, and in which style.
    pub(super) fn hidden(&self, x: f64, y: f64) -> (f32, LineStyle) {
        let mut most = (0.0, LineStyle::Plain);
        for segment in self.near(x, y) {
            let (_, distance) = segment.nearest(DVec2::new(x, y));
            let covered = covered(distance, self.width) * f64::from(segment.fade);
            if covered > most.0 {
                most = (covered, segment.style);
            }
        }
        (most.0 as f32, most.1)
    }

    /// How much of a silhouette shows at a place whose ray hits something `t` away, and in which style: that of a silhouette which is
    /// nearer. Lines lie outside, over what is farther away, since the surface within turns away from the viewer
    /// and hides its own edge.
    pub(super) fn silhouette(&self, x: f64, y: f64, t: f32) -> (f32, LineStyle) {
        let mut most = (0.0, LineStyle::Feature);
        let mut depth = None;
        for segment in self.near(x, y).filter(|segment| segment.is_silhouette) {
            let (share, distance) = segment.nearest(DVec2::new(x, y));
            let covered = (self.width + 0.5 - distance).clamp(0.0, self.width.clamp(0.0, 1.0));
            if covered > most.0 {
                let depth = *depth.get_or_insert_with(|| self.depth(x, y, t));
                let [from, to] = segment.depths.map(f64::from);
                let linear = from + (to - from) * share;
                let line = match self.camera.projection().is_parallel() {
                    true => linear,
                    false => 1.0 / linear,
                };
                if depth - line > line.abs() * NEARER {
                    most = (covered, segment.style);
                }
            }
        }
        (most.0 as f32, most.1)
    }

    /// How far a hit lies from the eye's plane.
    fn depth(&self, x: f64, y: f64, t: f32) -> f64 {
        let camera = &self.camera;
        let slant = match camera.projection().is_parallel() {
            true => 1.0,
            false => camera.distance() / camera.direction(x, y).length(),
        };
        f64::from(t) * slant
    }
}

/// Tells the cells that a segment's line may reach.
fn cells(
    segment: &Segment,
    reach: f64,
    (columns, rows): (usize, usize),
    mut tell: impl FnMut(usize),
) {
    let [a, b] = segment.ends.map(Vec2::as_dvec2);
    let cell = |place: f64, count: usize| {
        let cell = (place / CELL).floor();
        (cell.max(0.0) as usize).min(count - 1)
    };
    let (low, high) = (a.y.min(b.y), a.y.max(b.y));
    for row in cell(low - reach, rows)..=cell(high + reach, rows) {
        // The part of it that is no farther from the row than it reaches.
        let top = row as f64 * CELL - reach;
        let bottom = (row + 1) as f64 * CELL + reach;
        let Some(shares) = shares_within(&[a.y - top, bottom - a.y], &[b.y - top, bottom - b.y])
        else {
            continue;
        };
        let [x, other] = shares.map(|share| a.x + (b.x - a.x) * share);
        let (left, right) = (x.min(other) - reach, x.max(other) + reach);
        for column in cell(left, columns)..=cell(right, columns) {
            tell(row * columns + column);
        }
    }
}

/// The edges of a triangle that are wanted, as far as they are in the picture.
fn edges<'a>(
    accel: &Accel,
    primitive: u32,
    projector: &'a LineProjector<'a>,
    wanted: Wanted<'a>,
) -> impl Iterator<Item = Segment> + use<'a> {
    let (object, triangle) = accel.identify(primitive);
    let corners = accel
        .corners(primitive)
        .map(|corner| accel.origin() + corner.as_dvec3());
    let eye = projector.camera.pose().eye;
    let (styles, silhouettes) = match wanted.choice {
        None => ([Some(LineStyle::Plain); 3], [false; 3]),
        Some(choice) => {
            let viewpoint = SilhouetteView::of(projector.camera);
            (
                choice.styles(object, triangle),
                choice.silhouettes(object, triangle, viewpoint),
            )
        }
    };
    let is_wanted = |edge: usize| silhouettes[edge] || (wanted.hidden && styles[edge].is_some());
    let any = (0..3).any(is_wanted);
    let height = || EdgeLines::new(projector.camera, corners.map(|corner| corner - eye)).height();
    let height = if any { height() } else { 0.0 };
    (0..3).filter_map(move |edge| {
        let is_silhouette = silhouettes[edge];
        if !(is_silhouette || (wanted.hidden && styles[edge].is_some())) {
            return None;
        }
        let ends = [corners[edge], corners[(edge + 1) % 3]];
        let ends = kept(ends, wanted.clip)?.map(|end| projector.point(end - eye));
        let ends = projector.within(ends)?;
        let style = styles[edge].unwrap_or(LineStyle::Feature);
        Some(Segment {
            ends: ends.map(|[x, y, w, _]| DVec2::new(x / w, y / w).as_vec2()),
            depths: ends.map(|[_, _, w, depth]| {
                let is_parallel = projector.camera.projection().is_parallel();
                (if is_parallel { depth } else { 1.0 / w }) as f32
            }),
            fade: if is_silhouette {
                1.0
            } else {
                style.fade(height, wanted.width) as f32
            },
            style,
            is_silhouette,
        })
    })
}

/// The part of a segment that clipping planes keep.
fn kept([a, b]: [DVec3; 2], clip: &ClippingPlanes) -> Option<[DVec3; 2]> {
    let mut shares = [0.0, 1.0];
    for plane in clip.enabled() {
        let side = |point: DVec3| [plane.normal.dot(point) - plane.offset];
        let [first, last] = shares_within(&side(a), &side(b))?;
        shares = [first.max(shares[0]), last.min(shares[1])];
    }
    (shares[0] <= shares[1]).then(|| shares.map(|share| a + (b - a) * share))
}

/// A point (x, y, w) whose place in the picture is (x / w, y / w), and its depth.
type ProjectedPoint = [f64; 4];

/// Takes points to a picture that is a plane.
struct LineProjector<'a> {
    camera: &'a Camera,
    /// How far to the right and up the picture's corner lies from the view axis, on the plane through the target.
    corner: [f64; 2],
    /// Columns and rows.
    size: [f64; 2],
    /// How far outside the picture a line may lie that reaches into it.
    margin: f64,
}

impl<'a> LineProjector<'a> {
    fn new(camera: &'a Camera, width: f64) -> Self {
        let corner = camera.on_plane(0.0, 0.0);
        let plane = camera.plane();
        Self {
            camera,
            corner: [corner.dot(camera.right()), corner.dot(camera.up())],
            size: [plane.columns, plane.rows].map(f64::from),
            margin: width + 1.0,
        }
    }

    /// A point relative to the eye.
    fn point(&self, point: DVec3) -> ProjectedPoint {
        let camera = self.camera;
        let depth = point.dot(camera.forward());
        let (w, reach) = match camera.projection().is_parallel() {
            true => (1.0, 1.0),
            false => (depth, camera.distance()),
        };
        let step = camera.plane().step;
        let x = point.dot(camera.right()) * reach - self.corner[0] * w;
        let y = self.corner[1] * w - point.dot(camera.up()) * reach;
        [x / step, y / step, w, depth]
    }

    /// The part of a segment that lies in the picture: between the four planes through the eye and the picture's
    /// sides, which no point behind the eye is between.
    fn within(&self, [a, b]: [ProjectedPoint; 2]) -> Option<[ProjectedPoint; 2]> {
        let ([width, height], margin) = (self.size, self.margin);
        let inside = |[x, y, w, _]: ProjectedPoint| {
            [
                x + margin * w,
                y + margin * w,
                (width + margin) * w - x,
                (height + margin) * w - y,
            ]
        };
        let shares = shares_within(&inside(a), &inside(b))?;
        let ends = shares.map(|share| std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share));
        let is_seen = |[x, y, w, _]: &ProjectedPoint| {
            *w > 0.0 && (x / w).is_finite() && (y / w).is_finite() && (1.0 / w).is_finite()
        };
        ends.iter().all(is_seen).then_some(ends)
    }
}

/// From which share of the way between two ends to which none of some numbers, linear on the way, is below zero.
fn shares_within(from: &[f64], to: &[f64]) -> Option<[f64; 2]> {
    let (mut first, mut last) = (0.0f64, 1.0f64);
    for (&a, &b) in from.iter().zip(to) {
        if !(a.is_finite() && b.is_finite()) || (a < 0.0 && b < 0.0) {
            return None;
        } else if a < 0.0 {
            first = first.max(a / (a - b));
        } else if b < 0.0 {
            last = last.min(a / (a - b));
        }
    }
    (first <= last).then_some([first, last])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{ImagePlane, Pose, Projection};
    use crate::random::Random;

    fn camera(projection: Projection) -> Camera {
        let plane = ImagePlane::new(200, 100, 0.02).expect("a good plane");
        let pose = Pose {
            eye: DVec3::new(0.5, 0.3, 4.0),
            target: DVec3::ZERO,
            up: DVec3::Y,
        };
        Camera::new(pose, projection, plane)
    }

    /// The truth is [`Camera::project`], point by point along the segment.
    #[test]
    fn segments_are_where_their_points_are_seen() {
        let mut random = Random(31);
        let mut some = [0; 2];
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let camera = camera(projection);
            let projector = LineProjector::new(&camera, 1.0);
            for _ in 0..2000 {
                let mut point = || {
                    let mut coordinate = || (random.unit() - 0.5) * 12.0;
                    DVec3::new(coordinate(), coordinate(), coordinate())
                };
                let (a, b) = (point(), point());
                let eye = camera.pose().eye;
                let ends = [a, b].map(|end| projector.point(end - eye));
                let part = projector.within(ends);
                some[usize::from(part.is_some())] += 1;
                for at in 0..=50 {
                    let Some((x, y)) = camera.project(a + (b - a) * (f64::from(at) / 50.0)) else {
                        continue;
                    };
                    let is_in = (0.0..200.0).contains(&x) && (0.0..100.0).contains(&y);
                    let Some(part) = part.filter(|_| is_in) else {
                        assert!(!is_in || camera.projection().is_parallel(), "{x} {y}");
                        continue;
                    };
                    let [from, to] = part.map(|[x, y, w, _]| DVec2::new(x / w, y / w).as_vec2());
                    let segment = Segment {
                        ends: [from, to],
                        depths: [1.0; 2],
                        fade: 1.0,
                        style: LineStyle::Plain,
                        is_silhouette: false,
                    };
                    let (_, distance) = segment.nearest(DVec2::new(x, y));
                    assert!(distance < 1e-3, "{distance} at {x} {y} of {segment:?}");
                    // And its cell knows of it.
                    let mut found = false;
                    let [columns, rows] = projector.size.map(|side| (side / CELL).ceil() as usize);
                    let own = (y / CELL) as usize * columns + (x / CELL) as usize;
                    cells(&segment, 2.0, (columns, rows), |cell| found |= cell == own);
                    assert!(found, "{x} {y}");
                }
            }
        }
        assert!(some.iter().all(|&count| count > 500), "{some:?}");
    }

    #[test]
    fn shares_are_those_where_nothing_is_below_zero() {
        assert_eq!(shares_within(&[-1.0, 2.0], &[1.0, -2.0]), Some([0.5, 0.5]));
        assert_eq!(shares_within(&[-1.0, 1.0], &[3.0, -1.0]), Some([0.25, 0.5]));
        assert_eq!(shares_within(&[-3.0, 1.0], &[1.0, -3.0]), None);
        assert_eq!(shares_within(&[-3.0], &[-1.0]), None);
        assert_eq!(shares_within(&[f64::NAN], &[1.0]), None);
    }
}
