//! The figure of a tile's frustum and the triangles that each level of the traversal leaves, seen from outside.

use super::chosen_tile::{Chosen, SIZE};
use crate::chart::{Note, QUIET, TEXT, annotated};
use crate::figure::Figure;
use crate::table::{ReportError, grouped};
use image::{RgbImage, imageops};
use raycast_core::camera::{Camera, ImagePlane, Lattice, Pose, Projection, Rect};
use raycast_core::glam::DVec3;
use raycast_core::math;
use raycast_core::scene::{Bounds, Color};
use raycast_core::{Accel, Simd};
use std::collections::HashSet;

/// Size of the figure, and side of the enlarged tile beside it, in pixels.
pub(super) const SHEET: (u32, u32) = (1600, 900);
const INSET: u32 = 288;

/// Colours of triangles by the last stage that they reach: not below an entry point of the tile, below one, set up
/// for the packet, seen by a ray of the packet.
pub(super) const LEFT_OUT: Color = Color([232, 232, 228]);
pub(super) const LISTED: Color = Color([150, 200, 238]);
pub(super) const SET_UP: Color = Color([250, 204, 92]);
pub(super) const SEEN: Color = Color([220, 84, 20]);

/// Colours of lines.
const PICTURE_INK: Color = Color([70, 76, 86]);
const GRID_INK: Color = Color([190, 196, 204]);
pub(super) const TILE_INK: Color = Color([0, 92, 170]);
const BOX_INK: Color = Color([110, 170, 220]);
pub(super) const PACKET_INK: Color = Color([0, 130, 80]);
pub(super) const CELL_INK: Color = Color([150, 30, 130]);
const EDGE_INK: Color = Color([90, 70, 60]);

/// The geometry of the figure, scaled so that the scene's bounding sphere is the unit sphere.
pub(super) struct LevelFigure<'a> {
    chosen: &'a Chosen,
    simd: Simd,
    /// The camera of the tile.
    inner: Camera,
    /// The camera of the figure, which looks at everything from outside.
    outer: Camera,
    triangles: Vec<([DVec3; 3], Color)>,
    boxes: Vec<Bounds>,
    /// The depths along the view axis at which the picture is drawn, and at which the tile's frustum ends.
    shown_at: f64,
    end: f64,
}

impl<'a> LevelFigure<'a> {
    pub(super) fn new(
        accel: &Accel,
        camera: &Camera,
        chosen: &'a Chosen,
        center: DVec3,
        radius: f64,
    ) -> Result<Self, ReportError> {
        let unit = |point: DVec3| (point - center) / radius;
        let pose = camera.pose();
        let pose = Pose {
            eye: unit(pose.eye),
            target: unit(pose.target),
            up: pose.up,
        };
        let (columns, rows) = SIZE;
        let plane = ImagePlane::new(columns, rows, camera.plane().step / radius)?;
        let inner = Camera::new(pose, Projection::Perspective, plane);

        let listed: HashSet<u32> = chosen
            .large
            .entry_points
            .iter()
            .flat_map(|l| l.primitives.clone())
            .collect();
        let holds =
            |primitives: &[u32], primitive: u32| primitives.binary_search(&primitive).is_ok();
        let triangle = |primitive: u32| {
            let color = if holds(&chosen.packet.seen, primitive) {
                SEEN
            } else if holds(&chosen.packet.set_up, primitive) {
                SET_UP
            } else if listed.contains(&primitive) {
                LISTED
            } else {
                LEFT_OUT
            };
            let corners = accel.corners(primitive);
            (
                corners.map(|corner| unit(accel.origin() + corner.as_dvec3())),
                color,
            )
        };
        let triangles: Vec<_> = (0..accel.len() as u32).map(triangle).collect();
        let boxes = chosen.large.entry_points.iter().map(|listed| Bounds {
            min: unit(listed.bounds.min),
            max: unit(listed.bounds.max),
        });
        let boxes: Vec<Bounds> = boxes.collect();
        let depth = |point: DVec3| (point - pose.eye).dot(inner.forward());
        let corners = || triangles.iter().flat_map(|(corners, _)| corners);
        let begin = corners()
            .map(|&corner| depth(corner))
            .fold(f64::INFINITY, f64::min);
        let ends = boxes.iter().flat_map(|bounds| bounds.corners()).map(depth);
        let end = ends.fold(begin, f64::max) + 0.12;
        let mut figure = Self {
            chosen,
            simd: accel.simd(),
            inner,
            outer: inner,
            triangles,
            boxes,
            shown_at: begin * 0.5,
            end,
        };
        figure.outer = figure.outside()?;
        Ok(figure)
    }

    /// The point at `depth` along the view axis on the inner camera's ray through (x, y).
    fn at(&self, (x, y): (f64, f64), depth: f64) -> DVec3 {
        let direction = self.inner.direction(x, y);
        self.inner.pose().eye + direction * (depth / self.inner.distance())
    }

    /// The corners at `depth` of the frustum of some of the inner camera's rays.
    fn corners(&self, rays: &Lattice, depth: f64) -> [DVec3; 4] {
        let (left, top) = (f64::from(rays.x), f64::from(rays.y));
        let (right, bottom) = (left + f64::from(rays.columns), top + f64::from(rays.rows));
        [(left, top), (right, top), (right, bottom), (left, bottom)].map(|at| self.at(at, depth))
    }

    fn whole(&self) -> Lattice {
        let (width, height) = SIZE;
        self.inner
            .sub_camera(Rect {
                x: 0,
                y: 0,
                width,
                height,
            })
            .lattice()
    }

    /// A camera to the right of the inner one and above it, with a narrow field of view that contains everything.
    fn outside(&self) -> Result<Camera, ReportError> {
        /// Angles in degrees: from behind the inner camera to its right, and upwards.
        const ASIDE: f64 = 62.0;
        const ABOVE: f64 = 14.0;
        const FOV: f64 = 24.0;
        /// The size of the view relative to its content.
        const MARGIN: f64 = 1.05;
        /// Fractions of the sheet that stay free for text, on the left and at the bottom.
        const WORDS: f64 = 0.06;
        const BELOW: f64 = 0.1;
        let (columns, rows) = SHEET;
        let (aside, above) = (f64::to_radians(ASIDE), f64::to_radians(ABOVE));
        let level = self.inner.right() * math::sin(aside) - self.inner.forward() * math::cos(aside);
        let back = level * math::cos(above) + self.inner.up() * math::sin(above);
        let mut points = vec![self.inner.pose().eye];
        points.extend(self.corners(&self.whole(), self.shown_at));
        points.extend(self.corners(&self.chosen.large.rays, self.end));
        points.extend(self.triangles.iter().flat_map(|(corners, _)| corners));
        let mut target = Bounds::around(points.iter().copied()).center();
        let mut distance = 12.0;
        let camera = |target: DVec3, distance: f64| -> Result<Camera, ReportError> {
            let pose = Pose {
                eye: target + back * distance,
                target,
                up: self.inner.up(),
            };
            let step = raycast_core::camera::fov_to_frame(FOV, distance) / f64::from(rows);
            let plane = ImagePlane::new(columns, rows, step)?;
            Ok(Camera::new(pose, Projection::Perspective, plane))
        };
        // Each iteration moves the middle of the content to the middle of the free area and scales it to fit; a few
        // iterations converge.
        for _ in 0..8 {
            let camera = camera(target, distance)?;
            let places = points.iter().filter_map(|&point| camera.project(point));
            let places = places.map(|(x, y)| DVec3::new(x, y, 0.0));
            let bounds = Bounds::around(places);
            let (middle, size) = (bounds.center(), bounds.size());
            let step = camera.plane().step;
            let (columns, rows) = (f64::from(columns), f64::from(rows));
            target += camera.right() * ((middle.x - columns * (1.0 + WORDS) * 0.5) * step)
                - camera.up() * ((middle.y - rows * (1.0 - BELOW) * 0.5) * step);
            distance *=
                (size.x / (columns * (1.0 - WORDS))).max(size.y / (rows * (1.0 - BELOW))) * MARGIN;
        }
        camera(target, distance)
    }

    /// Draws the triangles; those below entry points with edges, thinner ones if there are many.
    fn mesh(&self, figure: &mut Figure) {
        const WIDTH: f64 = 1.2;
        const MANY: f64 = 2000.0;
        let is_listed = |color: Color| color != LEFT_OUT;
        let listed = self.triangles.iter().filter(|(_, color)| is_listed(*color));
        let width = WIDTH * (MANY / listed.count().max(1) as f64).sqrt().min(1.0);
        for &(corners, color) in &self.triangles {
            figure.triangle(corners, color);
            if is_listed(color) {
                figure.ring(&corners, width, EDGE_INK);
            }
        }
    }

    /// The view from outside.
    fn overview(&self) -> Result<RgbImage, ReportError> {
        let mut figure = Figure::new(self.outer, self.simd);
        self.mesh(&mut figure);
        for bounds in &self.boxes {
            figure.edges(bounds, 1.6, BOX_INK);
        }
        let eye = self.inner.pose().eye;
        figure.ball(eye, 0.032, PICTURE_INK);
        // Draws the picture and its tiles.
        let whole = self.whole();
        let frame = self.corners(&whole, self.shown_at);
        figure.ring(&frame, 3.0, PICTURE_INK);
        for corner in frame {
            figure.line(eye, corner, 2.0, PICTURE_INK);
        }
        let (columns, rows) = SIZE;
        let tile = self.chosen.large.rays.columns.max(1);
        for x in (tile..columns).step_by(tile as usize) {
            let ends = [0, rows].map(|y| self.at((f64::from(x), f64::from(y)), self.shown_at));
            figure.line(ends[0], ends[1], 1.2, GRID_INK);
        }
        for y in (tile..rows).step_by(tile as usize) {
            let ends = [0, columns].map(|x| self.at((f64::from(x), f64::from(y)), self.shown_at));
            figure.line(ends[0], ends[1], 1.2, GRID_INK);
        }
        for (rays, pixels, color) in self.frusta() {
            let end = self.corners(rays, self.end);
            for corner in end {
                figure.line(eye, corner, pixels, color);
            }
            figure.ring(&end, pixels, color);
            figure.ring(&self.corners(rays, self.shown_at), pixels, color);
        }
        figure.draw()
    }

    /// The frusta of tile, packet and cell, with line widths and colours.
    fn frusta(&self) -> [(&Lattice, f64, Color); 3] {
        [
            (&self.chosen.large.rays, 3.4, TILE_INK),
            (&self.chosen.packet.rays, 2.6, PACKET_INK),
            (&self.chosen.cell, 1.8, CELL_INK),
        ]
    }

    /// The tile as its own camera sees it.
    fn inset(&self) -> Result<RgbImage, ReportError> {
        let rays = &self.chosen.large.rays;
        let times = INSET / rays.columns.max(rays.rows).max(1);
        let (columns, rows) = SIZE;
        let step = self.inner.plane().step / f64::from(times);
        let plane = ImagePlane::new(columns * times, rows * times, step)?;
        let mut figure = Figure::new(self.inner.with_plane(plane), self.simd);
        self.mesh(&mut figure);
        figure.draw_part(Rect {
            x: rays.x * times,
            y: rays.y * times,
            width: rays.columns * times,
            height: rays.rows * times,
        })
    }

    pub(super) fn sheet(&self) -> Result<Vec<u8>, ReportError> {
        let mut sheet = self.overview()?;
        let inset = self.inset()?;
        let (left, top) = (28, SHEET.1 - inset.height() - 28);
        imageops::replace(&mut sheet, &inset, left.into(), top.into());
        let mut notes = Vec::new();
        let large = &self.chosen.large.rays;
        let times = f64::from(inset.width()) / f64::from(large.columns);
        for (rays, pixels, Color(color)) in self.frusta() {
            let x = f64::from(left) + f64::from(rays.x - large.x) * times;
            let y = f64::from(top) + f64::from(rays.y - large.y) * times;
            let (right, bottom) = (
                x + f64::from(rays.columns) * times,
                y + f64::from(rays.rows) * times,
            );
            notes.push(Note::Line {
                points: vec![(x, y), (right, y), (right, bottom), (x, bottom), (x, y)],
                width: pixels + 1.0,
                color,
            });
        }
        notes.push(words(
            "the tile, from its eye",
            (
                f64::from(left + inset.width()) + 18.0,
                f64::from(top + inset.height()) - 12.0,
            ),
            QUIET,
        ));
        self.legend(&mut notes);
        Ok(annotated(&sheet, &notes)?)
    }

    fn legend(&self, notes: &mut Vec<Note>) {
        const LINE: f64 = 30.0;
        const LEFT: f64 = 28.0;
        const WORDS: f64 = 76.0;
        /// Text appears this far above its position; the symbols beside it are moved as far.
        const SINK: f64 = 4.0;
        let Chosen {
            large,
            packet,
            cell,
            ..
        } = self.chosen;
        let size = |rays: &Lattice| format!("{} × {}", rays.columns, rays.rows);
        let lines = [
            (
                format!("the picture, {} × {} rays", SIZE.0, SIZE.1),
                3.0,
                PICTURE_INK,
            ),
            (
                format!("a tile of it, {}", size(&large.rays)),
                3.4,
                TILE_INK,
            ),
            (format!("a packet, {}", size(&packet.rays)), 2.6, PACKET_INK),
            (format!("a cell, {}", size(cell)), 1.8, CELL_INK),
            (
                format!(
                    "{} subtrees that the tile touches",
                    large.entry_points.len()
                ),
                1.6,
                BOX_INK,
            ),
        ];
        let mut y = 38.0;
        for (text, width, Color(color)) in lines {
            notes.push(Note::Line {
                points: vec![(LEFT, y - SINK), (LEFT + 34.0, y - SINK)],
                width: width + 1.0,
                color,
            });
            notes.push(words(&text, (WORDS, y), TEXT));
            y += LINE;
        }
        y += LINE * 0.4;
        let count = |color: Color| {
            let triangles = self.triangles.iter().filter(|(_, other)| *other == color);
            grouped(triangles.count() as u64)
        };
        let patches = [
            (LEFT_OUT, "triangles left out by the tile"),
            (LISTED, "only listed for it"),
            (SET_UP, "only set up for the packet"),
            (SEEN, "seen by the packet's rays"),
        ];
        for (color, text) in patches {
            notes.push(Note::Patch {
                low: (LEFT + 4.0, y - SINK - 11.0),
                high: (LEFT + 30.0, y - SINK + 11.0),
                color: color.0,
            });
            notes.push(words(&format!("{} {text}", count(color)), (WORDS, y), TEXT));
            y += LINE;
        }
    }
}

fn words(text: &str, at: (f64, f64), color: [u8; 3]) -> Note {
    Note::Words {
        text: text.to_owned(),
        at,
        size: 24.0,
        color,
    }
}
