//! Places of a panorama's rays in packet space.
//!
//! The rays of a panorama share an eye, so a packet of them has a plane: the one square to its mean direction. There
//! triangles are set up as for a perspective packet, but rays lie at places of their own and not on a lattice.
//!
//! # Error bound
//! ε = 2⁻⁵³, K, B and D as in [`setup`](super::setup). A place is ((p − p₀)/s + ½, (q₁ − q)/s + ½), with p and q the
//! quotients of the products of three vectors (the plane's right, up and forward) and the ray's direction, in the
//! camera's own axes.
//!
//! * A direction is off by 320ε|v| a coordinate ([`PanoramaRays`]).
//! * The nine coefficients, products of unit vectors, are off by 4ε; the product of a row and a direction v, in whose
//!   three products and two sums each term is rounded four times, by 8√3ε|v|. A ray's own direction is rounded five
//!   times a component on its way to the world and to unit length: 9√3ε|v|. With the direction's
//!   own √3·320ε|v|, and divided by v's depth, at least |v|·D/B, each of the two products is off by less than
//!   590ε·B/D, and the quotient, at most one, by 1190ε·B/D.
//! * The plane's axes are perpendicular to 32ε ([`view`]): that moves p and q by less than 128ε·B/D.
//! * Divided by s = D·(B/D)/K, and with the two roundings of sum and quotient, which are below 4ε·64: a place is off
//!   by less than 1500ε·K·B/D columns or rows, [`PLACE_ERROR`] times εK·B/D with a margin.
//! * It is rounded to single precision, u of itself, which moves a linear function by less than u of the sum of its
//!   terms' magnitudes; evaluating it there takes three roundings of coefficients, two products and two sums, 6u: far
//!   below [`LINEAR_ERROR`](super::setup::LINEAR_ERROR), which allows for stepping from row to row.

use super::frustum::Window;
use super::params::{CELLS, ROW, SIDE};
use super::place_box::PlaceBox;
use super::setup::PacketSpace;
use crate::camera::{Camera, ImagePlane, PanoramaRays, Rect};
use crate::hit::Cull;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};
use glam::DVec3;

/// Rays in a packet.
pub(super) const RAYS: usize = SIDE * SIDE;

/// Cells in a packet.
pub(super) const ALL_CELLS: usize = CELLS * CELLS;

/// The error of a place in double precision, in units of εK·B/D: see above.
const PLACE_ERROR: f64 = 2048.0;

/// The greatest tangent of the angle between a packet's axis and its rays, to the right or up.
const MOST_TANGENT: f64 = 0.75;

/// Places are from half a column to this: inside of what functions are bounded for, however they are rounded.
const EXTENT: f64 = 30.0;
const MARGIN: f64 = 0.5;

/// The furthest place of a picture, in radians at its middle, up to which nothing overflows. Directions are at least
/// half a unit long.
const FURTHEST: f64 = 1e50;

/// What a rectangle of a panorama's rays is to a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Span {
    /// None of its places has a ray.
    Empty,
    /// They see too wide for one plane.
    Wide,
    /// They have places.
    Packet,
}

/// Bounds of eight sets of places.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
struct PlaceBoxes {
    left: [f32; LANES],
    right: [f32; LANES],
    top: [f32; LANES],
    bottom: [f32; LANES],
}

impl PlaceBoxes {
    const NONE: Self = Self {
        left: [0.0; LANES],
        right: [0.0; LANES],
        top: [0.0; LANES],
        bottom: [0.0; LANES],
    };

    /// Those of the eight, as bits, that a box touches.
    #[inline(always)]
    fn touched(&self, lanes: impl Lanes, by: &PlaceBox) -> u32 {
        let beside = lanes.load(&self.right).lt(lanes.splat(by.left))
            | lanes.splat(by.right).lt(lanes.load(&self.left));
        let above = lanes.load(&self.bottom).lt(lanes.splat(by.top))
            | lanes.splat(by.bottom).lt(lanes.load(&self.top));
        !(beside | above).bits() & ((1 << LANES) - 1)
    }
}

/// Centres and half extents of eight cells.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct CellCentres {
    pub(super) x: [f32; LANES],
    pub(super) y: [f32; LANES],
    pub(super) half_x: [f32; LANES],
    pub(super) half_y: [f32; LANES],
}

/// Where the rays of a packet of a panorama lie in packet space.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Places {
    /// Places, rows of rays one after another. Rays that the packet does not have lie where some other ray does.
    pub(super) x: [f32; RAYS],
    pub(super) y: [f32; RAYS],
    /// Bounds of the rows of eight rays of each cell.
    rows: [PlaceBoxes; ALL_CELLS],
    /// Bounds of eight cells each.
    cells: [PlaceBoxes; ALL_CELLS / LANES],
    centres: [CellCentres; ALL_CELLS / LANES],
    /// Rows of the packet, and in each the columns that have a ray, as bits.
    pub(super) has_ray: [u32; SIDE],
    pub(super) columns: u32,
    pub(super) rows_of_rays: u32,
    /// A camera whose image plane is the packet's.
    pub(super) view: Camera,
    /// The part of that plane that the rays go through.
    pub(super) window: Window,
    /// Place of the packet's first ray in that picture.
    first: (f64, f64),
    /// Directions in the camera's axes, then places on the plane.
    directions: [[f64; RAYS]; 3],
}

impl Places {
    pub(super) fn new(camera: &Camera) -> Box<Self> {
        let zero = [[0.0; RAYS]; 3];
        let centres = CellCentres {
            x: [0.0; LANES],
            y: [0.0; LANES],
            half_x: [0.0; LANES],
            half_y: [0.0; LANES],
        };
        Box::new(Self {
            x: [0.0; RAYS],
            y: [0.0; RAYS],
            rows: [PlaceBoxes::NONE; ALL_CELLS],
            cells: [PlaceBoxes::NONE; ALL_CELLS / LANES],
            centres: [centres; ALL_CELLS / LANES],
            has_ray: [0; SIDE],
            columns: 0,
            rows_of_rays: 0,
            view: *camera,
            window: Window {
                across: (0.0, 0.0),
                along: (0.0, 0.0),
            },
            first: (0.0, 0.0),
            directions: zero,
        })
    }

    /// Finds the places of a rectangle of at most [`SIDE`] × [`SIDE`] rays of a camera.
    #[inline(always)]
    pub(super) fn find(
        &mut self,
        lanes: impl Lanes,
        (camera, rays): (&Camera, &PanoramaRays),
        part: Rect,
    ) -> Span {
        self.columns = part.width;
        self.rows_of_rays = part.height;
        if !self.look(rays, part) {
            return Span::Empty;
        }
        // NaN is not near.
        let is_near = rays.reach() <= FURTHEST;
        if !is_near {
            return Span::Wide;
        }
        let Some(view) = self.view(camera) else {
            return Span::Wide;
        };
        self.view = view;
        if !self.project(camera) {
            return Span::Wide;
        }
        self.settle();
        self.bound(lanes);
        Span::Packet
    }

    /// Directions of all rays, in the camera's axes. Whether there are any.
    #[inline(always)]
    fn look(&mut self, rays: &PanoramaRays, part: Rect) -> bool {
        self.has_ray = [0; SIDE];
        let in_part = u32::MAX >> (SIDE as u32 - part.width.clamp(1, SIDE as u32));
        let mut eight = [[0.0; LANES]; 3];
        for row in 0..part.height {
            for first in (0..part.width).step_by(ROW) {
                let has = rays.nearly_eight(part.x + first, part.y + row, &mut eight);
                let at = row as usize * SIDE + first as usize;
                for (all, eight) in self.directions.iter_mut().zip(&eight) {
                    if let Some(all) = all.get_mut(at..at + LANES) {
                        all.copy_from_slice(eight);
                    }
                }
                self.has_ray[row as usize] |= has << first & in_part;
            }
        }
        let Some(row) = self.has_ray.iter().rposition(|&has| has != 0) else {
            return false;
        };
        let column = self.has_ray[row].trailing_zeros() as usize;
        self.fill(row * SIDE + column);
        true
    }

    /// Gives rays that the packet does not have the direction of one that it has.
    fn fill(&mut self, from: usize) {
        let all = u32::MAX >> (SIDE as u32 - self.columns.clamp(1, SIDE as u32));
        let is_whole = |&rays: &u32| rays == all;
        let rows = self.rows_of_rays as usize;
        if self.columns == SIDE as u32 && rows == SIDE && self.has_ray.iter().all(is_whole) {
            return;
        }
        let mut near = from;
        for row in 0..SIDE {
            for column in 0..SIDE {
                let at = row * SIDE + column;
                if self.has_ray[row] >> column & 1 != 0 {
                    near = at;
                } else {
                    for all in &mut self.directions {
                        all[at] = all[near];
                    }
                }
            }
        }
    }

    fn direction(&self, column: usize, row: usize) -> DVec3 {
        let [x, y, z] = &self.directions;
        let at = row * SIDE + column;
        DVec3::new(x[at], y[at], z[at])
    }

    /// A camera that looks along the middle of the rays: its axes are perpendicular, and of unit length, to less than
    /// 32ε. `None` where there is no middle.
    fn view(&self, camera: &Camera) -> Option<Camera> {
        let (right, bottom) = (self.columns as usize - 1, self.rows_of_rays as usize - 1);
        let unit = |column: usize, row: usize| self.direction(column, row).normalize_or_zero();
        let (top, low) = (unit(right / 2, 0), unit(right / 2, bottom));
        let mean = unit(0, 0)
            + unit(right, 0)
            + unit(0, bottom)
            + unit(right, bottom)
            + top
            + low
            + unit(right / 2, bottom / 2);
        let forward = mean.try_normalize()?;
        let axes = [camera.right(), camera.up(), camera.forward()];
        let in_world = |v: DVec3| axes[0] * v.x + axes[1] * v.y + axes[2] * v.z;
        let forward = in_world(forward).try_normalize()?;
        // Rows of rays run along rows of places, as far as they run anywhere: then their bounds are flat.
        let up = in_world(top - low);
        let up = up - forward * up.dot(forward);
        let up = up.try_normalize().filter(|up| up.dot(forward).abs() < 0.5);
        let up = up.unwrap_or_else(|| forward.any_orthonormal_vector());
        Some(Camera::upright(forward, up))
    }

    /// Places on the view's plane, as tangents to the right and up, in place of directions, and the window that they
    /// are in. Whether all are in front, and within [`MOST_TANGENT`].
    #[inline(always)]
    #[allow(
        clippy::needless_range_loop,
        reason = "a lane is an index into all the arrays at once"
    )]
    fn project(&mut self, camera: &Camera) -> bool {
        let axes = [camera.right(), camera.up(), camera.forward()];
        let row = |v: DVec3| axes.map(|axis| v.dot(axis));
        let [ax, ay, az] = row(self.view.right());
        let [bx, by, bz] = row(self.view.up());
        let [cx, cy, cz] = row(self.view.forward());
        let mut least = [[f64::INFINITY; LANES]; 3];
        let mut most = [[f64::NEG_INFINITY; LANES]; 2];
        let [xs, ys, zs] = &mut self.directions;
        let all = (xs.as_chunks_mut::<LANES>().0.iter_mut())
            .zip(ys.as_chunks_mut::<LANES>().0)
            .zip(zs.as_chunks::<LANES>().0);
        for ((x, y), z) in all {
            for lane in 0..LANES {
                let (dx, dy, dz) = (x[lane], y[lane], z[lane]);
                let depth = cx * dx + cy * dy + cz * dz;
                let inverse = 1.0 / depth;
                let across = (ax * dx + ay * dy + az * dz) * inverse;
                let along = (bx * dx + by * dy + bz * dz) * inverse;
                (x[lane], y[lane]) = (across, along);
                least[0][lane] = lesser(across, least[0][lane]);
                least[1][lane] = lesser(along, least[1][lane]);
                least[2][lane] = lesser(depth, least[2][lane]);
                most[0][lane] = greater(across, most[0][lane]);
                most[1][lane] = greater(along, most[1][lane]);
            }
        }
        let [left, low, depth] = least.map(|all| all.into_iter().fold(f64::INFINITY, lesser));
        let [right, high] = most.map(|all| all.into_iter().fold(f64::NEG_INFINITY, greater));
        self.window = Window {
            across: (left, right),
            along: (low, high),
        };
        let furthest = greater(greater(-left, right), greater(-low, high));
        (depth > 0.0) & (furthest <= MOST_TANGENT)
    }

    /// Scales places to the packet's columns and rows.
    #[inline(always)]
    fn settle(&mut self) {
        let [xs, ys, _] = &self.directions;
        let Window {
            across: (left, right),
            along: (low, high),
        } = self.window;
        // Of rays that are nearly one, any step will do.
        let extent = (right - left)
            .max(high - low)
            .max(1.0 / (1u64 << 40) as f64);
        let step = extent / EXTENT;
        let plane = ImagePlane {
            columns: SIDE as u32,
            rows: SIDE as u32,
            step,
        };
        self.view = self.view.with_plane(plane);
        let inverse = 1.0 / step;
        for ((x, y), (&across, &along)) in
            (self.x.iter_mut().zip(&mut self.y)).zip(xs.iter().zip(ys))
        {
            *x = ((across - left) * inverse + MARGIN) as f32;
            *y = ((high - along) * inverse + MARGIN) as f32;
        }
        let half = SIDE as f64 * 0.5;
        self.first = (
            left * inverse - MARGIN + half,
            half - (high * inverse + MARGIN),
        );
    }

    /// Bounds of rows and cells.
    #[inline(always)]
    fn bound<L: Lanes>(&mut self, lanes: L) {
        for cell in 0..ALL_CELLS {
            let [mut left, mut right, mut top, mut bottom] = [lanes.splat(0.0); 4];
            for (places, least, most) in [
                (&self.x, &mut left, &mut right),
                (&self.y, &mut top, &mut bottom),
            ] {
                let mut rows = [lanes.splat(0.0); ROW];
                for (row, places_of_row) in rows.iter_mut().enumerate() {
                    let first = first_of(cell, row);
                    if let Some(eight) = places.get(first..).and_then(|rest| rest.first_chunk()) {
                        *places_of_row = lanes.load(eight);
                    }
                }
                let [a, b, c, d, e, f, g, h] = lanes.transpose(rows);
                *least = a.min(b).min(c.min(d)).min(e.min(f).min(g.min(h)));
                *most = a.max(b).max(c.max(d)).max(e.max(f).max(g.max(h)));
            }
            let rows = &mut self.rows[cell];
            left.store(&mut rows.left);
            right.store(&mut rows.right);
            top.store(&mut rows.top);
            bottom.store(&mut rows.bottom);
            let zero = lanes.splat(0.0);
            let (half, lane) = (cell / LANES, cell % LANES);
            let cells = &mut self.cells[half];
            cells.left[lane] = left.reduce_min();
            cells.right[lane] = -(zero - right).reduce_min();
            cells.top[lane] = top.reduce_min();
            cells.bottom[lane] = -(zero - bottom).reduce_min();
        }
        for (cells, centres) in self.cells.iter().zip(&mut self.centres) {
            // A mean and a difference are rounded by less than 3u of 32.
            let half = |least: f32, most: f32| (most - least) * 0.5 + 1.0 / 65536.0;
            for lane in 0..LANES {
                centres.x[lane] = (cells.left[lane] + cells.right[lane]) * 0.5;
                centres.y[lane] = (cells.top[lane] + cells.bottom[lane]) * 0.5;
                centres.half_x[lane] = half(cells.left[lane], cells.right[lane]);
                centres.half_y[lane] = half(cells.top[lane], cells.bottom[lane]);
            }
        }
    }

    /// The packet's space. `eye` is the camera's, relative to what corners are relative to, and off by at most
    /// `eye_error`.
    pub(super) fn space(&self, eye: DVec3, eye_error: f64, cull: Cull) -> PacketSpace {
        let side = (SIDE as u32, SIDE as u32);
        let mut space = PacketSpace::new(&self.view, eye, eye_error, self.first, 1.0, side, cull);
        // Bounds go by these where a lattice's rays are off by 32 units, or its directions by 20.
        space.ray_error *= PLACE_ERROR / 32.0;
        space.rays.greatest *= space.obliqueness * (PLACE_ERROR / 20.0);
        space
    }

    /// For each of the packet's four columns and rows of cells, the window of its rays.
    pub(super) fn cell_windows(&self) -> [Window; CELLS] {
        let step = self.view.plane().step;
        let (left, high) = (self.window.across.0, self.window.along.1);
        std::array::from_fn(|index| {
            let mut all = PlaceBox::EMPTY;
            for other in 0..CELLS {
                let column = self.cell(other * CELLS + index);
                let row = self.cell(index * CELLS + other);
                all.left = all.left.min(column.left);
                all.right = all.right.max(column.right);
                all.top = all.top.min(row.top);
                all.bottom = all.bottom.max(row.bottom);
            }
            // Rounded to single precision: less than 2⁻¹⁸ of a column.
            let slack = 1.0 / (1 << 16) as f64;
            let across = |place: f32| left + (f64::from(place) - MARGIN) * step;
            let along = |place: f32| high - (f64::from(place) - MARGIN) * step;
            Window {
                across: (
                    across(all.left) - slack * step,
                    across(all.right) + slack * step,
                ),
                along: (
                    along(all.bottom) - slack * step,
                    along(all.top) + slack * step,
                ),
            }
        })
    }

    fn cell(&self, cell: usize) -> PlaceBox {
        let (cells, lane) = (&self.cells[cell / LANES], cell % LANES);
        PlaceBox {
            left: cells.left[lane],
            right: cells.right[lane],
            top: cells.top[lane],
            bottom: cells.bottom[lane],
        }
    }

    /// The cells that a box touches, as bits.
    #[inline(always)]
    pub(super) fn cells_touched(&self, lanes: impl Lanes, by: &PlaceBox) -> u32 {
        let mut touched = 0;
        for (half, cells) in self.cells.iter().enumerate() {
            touched |= cells.touched(lanes, by) << (half * LANES);
        }
        touched
    }

    /// The rows of a cell that a box touches, as bits.
    #[inline(always)]
    pub(super) fn rows_touched(&self, lanes: impl Lanes, cell: usize, by: &PlaceBox) -> u32 {
        self.rows[cell % ALL_CELLS].touched(lanes, by)
    }

    /// Eight cells' centres, the first eight or the last.
    #[inline(always)]
    pub(super) fn centres(&self, half: usize) -> &CellCentres {
        &self.centres[half % (ALL_CELLS / LANES)]
    }

    /// Places of eight rays from one on.
    #[inline(always)]
    pub(super) fn eight(&self, first: usize) -> Option<(&[f32; ROW], &[f32; ROW])> {
        Some((
            self.x.get(first..)?.first_chunk()?,
            self.y.get(first..)?.first_chunk()?,
        ))
    }
}

#[inline(always)]
fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline(always)]
fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The first ray of a cell's row.
#[inline(always)]
pub(super) fn first_of(cell: usize, row: usize) -> usize {
    (cell / CELLS * ROW + row) * SIDE + cell % CELLS * ROW
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Lattice, Panorama, Placement, Projection};
    use crate::num::simd::Plain;
    use crate::random::Random;

    fn lattices() -> impl Iterator<Item = Lattice> {
        let mut random = Random(91);
        Panorama::ALL.into_iter().flat_map(move |(_, panorama)| {
            [0.02, 1e-3, 1e-7, 1e-13].map(|step| {
                let placement = Placement::towards(random.point(), random.point() * 3.0);
                let distance = placement.eye.distance(placement.target);
                let plane = ImagePlane::new(70, 50, step * distance).expect("a good plane");
                let camera = Camera::new(placement, Projection::Panoramic(panorama), plane);
                camera.whole().lattice()
            })
        })
    }

    /// The truth is the ray's own direction through the packet's map, which is off by a tenth of the bound. Of rays very
    /// close together places are off by more than single precision rounds them by: they need the bound.
    #[test]
    fn rays_are_where_their_places_say() {
        let (mut packets, mut needed) = (0, 0);
        for lattice in lattices() {
            let rays = PanoramaRays::new(&lattice).expect("a panorama");
            let mut places = Places::new(&lattice.camera);
            for (x, y) in [(0, 0), (32, 0), (0, 32), (38, 18)] {
                let rect = Rect {
                    x,
                    y,
                    width: 32,
                    height: 50 - y.max(18),
                };
                if places.find(Plain, (&lattice.camera, &rays), rect) != Span::Packet {
                    continue;
                }
                packets += 1;
                let space = places.space(DVec3::ZERO, 0.0, Cull::None);
                for row in 0..rect.height {
                    for column in 0..rect.width {
                        if places.has_ray[row as usize] >> column & 1 == 0 {
                            continue;
                        }
                        let direction = lattice.ray(x + column, y + row).direction;
                        let [i, j, k] = space.map.map(|line| line.dot(direction));
                        let at = row as usize * SIDE + column as usize;
                        for (place, truth) in [(places.x[at], i / k), (places.y[at], j / k)] {
                            let off = (f64::from(place) - truth).abs();
                            let rounding = truth.abs() / f64::from(1 << 24);
                            assert!(off <= rounding + space.ray_error, "{place} {truth}");
                            needed += u32::from(off > 2.0 * rounding);
                        }
                        assert!((0.4..31.6).contains(&places.x[at]));
                        assert!((0.4..31.6).contains(&places.y[at]));
                    }
                }
            }
        }
        assert!(packets > 60, "{packets}");
        assert!(needed > 100, "{needed}");
    }

    /// What a ray's place is in touches the ray's row and cell.
    #[test]
    fn boxes_touch_the_rows_and_cells_of_the_rays_in_them() {
        for lattice in lattices() {
            let rays = PanoramaRays::new(&lattice).expect("a panorama");
            let mut places = Places::new(&lattice.camera);
            let rect = Rect {
                x: 7,
                y: 3,
                width: 32,
                height: 32,
            };
            if places.find(Plain, (&lattice.camera, &rays), rect) != Span::Packet {
                continue;
            }
            for at in 0..RAYS {
                let (x, y) = (places.x[at], places.y[at]);
                let own = PlaceBox {
                    left: x,
                    right: x,
                    top: y,
                    bottom: y,
                };
                let cell = at / SIDE / ROW * CELLS + at % SIDE / ROW;
                assert!(places.cells_touched(Plain, &own) >> cell & 1 != 0);
                assert!(places.rows_touched(Plain, cell, &own) >> (at / SIDE % ROW) & 1 != 0);
                let centres = places.centres(cell / LANES);
                let lane = cell % LANES;
                let exact = f64::from(x) - f64::from(centres.x[lane]);
                assert!(exact.abs() <= f64::from(centres.half_x[lane]));
                let exact = f64::from(y) - f64::from(centres.y[lane]);
                assert!(exact.abs() <= f64::from(centres.half_y[lane]));
            }
            assert_eq!(places.cells_touched(Plain, &PlaceBox::EMPTY), 0);
        }
    }
}
