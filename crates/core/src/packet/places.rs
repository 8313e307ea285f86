//! The places of a panorama's rays in packet space.
//!
//! The rays of a panorama share an eye, so a packet of them has a plane: the one perpendicular to its mean direction.
//! There triangles are set up as for a perspective packet, but rays lie at irregular places and not on a lattice.
//!
//! # Error bound
//! u = 2⁻²⁴, ε = 2⁻⁵³; K, B and D as in [`setup`](super::setup): the plane is at distance D = 1, and rays are s = B/K
//! apart on it. With r, v and f the plane's right, up and forward and d a ray's direction in the camera's axes, its
//! tangents are p = r·d/f·d and q = v·d/f·d, at most [`MOST_TANGENT`]; its place is (½ + (p − p₀)/s, ½ + (q₁ − q)/s),
//! where p₀ is the least p of the packet and q₁ the greatest q.
//!
//! * **Directions.** d is off by 320ε|d| a coordinate ([`PanoramaRays`]): √3·320ε|d|.
//! * **Products.** The coefficients of r, v and f in the camera's axes are products of unit vectors, off by 4ε, and each
//!   term of the product with d is rounded four times: 8√3ε|d|. A ray's own direction is rounded five times a
//!   coordinate on its way to the world and to unit length: 9√3ε|d|. Together: 590ε|d|.
//! * **Tangents.** |d| is at most B times f·d. Numerator and denominator are off by 590ε|d|, and the quotient is below
//!   one: 1180εB, and 2ε for inverse and product. For the packet's own rays B is below 1 + 2·¾ = 2.5:
//!   [`TANGENT_ERROR`].
//! * **The plane.** Its axes are perpendicular to 32ε ([`Places::view`]), and T's rows are made of cross products of
//!   them: that moves p and q by less than 128εB.
//! * **Places.** Divided by s: 1310εK. The sum and the quotient round by less than 4ε·32, and the place of the packet's
//!   first ray in the picture by 6εK: below 1400εK, times √2 where both coordinates move a direction. [`PLACE_ERROR`] is
//!   above that, and above it with the 26ε by which products with directions are off beside
//!   ([`componentwise_setup`](super::componentwise_setup)).
//! * **Lenses.** Packets of a picture through a lens share the camera's own image plane, on which directions (x, y, 1)
//!   are places already: neither products nor the plane's axes move them. With x and y at most 2 ([`FLATTEST`]) |d| is
//!   at most 3, B at most 5, and the nine roundings of rays on their way to the world move tangents by less than
//!   9√3·3·(1 + 2)ε < 2⁸ε, in both coordinates 363ε. A ray's own direction and the packet's, from Newton's steps,
//!   differ by 2·720ε: together 1803ε, and with √2·90ε from rounding places as above below [`PLACE_ERROR`]. Where places
//!   are found without directions (`camera/lens_patch`), tangents are off by that patch's tolerance beside.
//! * **Faces of a cube.** They are planes, and their packets lattices, with the picture's own rays beside the
//!   lattice's. Those differ by less than 1100ε a tangent and rounding (`camera/cube_face`), K times as much in
//!   columns: 1560εK where both coordinates move a direction.
//! * **Single precision.** Rounding a place by u of itself moves a linear function by less than u of the sum of its
//!   terms' magnitudes: one of the roundings counted where functions are evaluated
//!   (`interval_zbuffer/at_places`).

mod bounds;
mod directions;
mod near_eye;

use super::frustum::Window;
use super::params::{CELLS, RAYS, ROW, SIDE};
use super::place_box::PlaceBox;
use super::setup::PacketSpace;
use crate::camera::{Camera, FLATTEST, ImagePlane, LensPatch, PanoramaRays, PlaceScale, Rect};
use crate::hit::Cull;
use crate::num::choice::{greater, lesser};
use crate::num::roundoff::EPSILON;
use crate::num::simd::{LANES, Lanes};
pub(super) use bounds::first_of;
use bounds::{CellCentres, PlaceBoxes};
use glam::DVec3;
pub(super) use near_eye::NearEye;

/// Cells in a packet.
pub(super) const ALL_CELLS: usize = CELLS * CELLS;

/// The error of a place in double precision, in units of εK·B/D: see above.
const PLACE_ERROR: f64 = 2048.0;

/// The error of a packet's tangents, 2⁻⁴¹: 1182ε·2.5 is below 2¹²ε. Packets' frusta are enlarged by it, since their own
/// slack only covers the rounding of planes.
pub(super) const TANGENT_ERROR: f64 = 1.0 / (1u64 << 41) as f64;

/// The greatest tangent of the angle between a packet's axis and its rays, to the right or up. Any value below one is
/// correct. With a greater one the packet's outer cells are wider on the plane than its inner ones, and errors grow with
/// B; with a lesser one more packets are split.
const MOST_TANGENT: f64 = 0.75;

/// Places lie at least this far from the first and the last column and row that functions are evaluated for, so that
/// rounding leaves them within 0 and [`SIDE`], where triangles are set up. With a wider margin cells are slightly
/// larger compared with the places' errors.
const MARGIN: f64 = 0.5;

/// The distance of the first and the last place: SIDE − 1 columns less both margins.
const EXTENT: f64 = (SIDE - 1) as f64 - 2.0 * MARGIN;

/// More than rounding to single precision moves a place, in columns: 2⁻¹⁹.
const ROUNDED: f64 = 1.0 / (1 << 16) as f64;

/// How far off places may be, in columns, apart from rounding: 512u, a third of what rounding moves an edge function by.
/// With a greater number more rays are left undecided; with a lesser one more packets take Newton's steps for each ray.
const MOST_BESIDE: f64 = 1.0 / (1 << 15) as f64;

/// The greatest coordinate of a place in a picture, in radians at its middle, and of an eye, for which packets are
/// made. Rays beyond are cast one by one. The longest direction is that of a stereographic fisheye, 1 + ρ²/4, below
/// 10¹⁰⁰, whose square is finite; and no number of a set-up, all products of four corners at most, is infinite or
/// NaN.
const FURTHEST: f64 = 1e50;

/// Whether a rectangle of a panorama's rays fits one packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fit {
    /// It contains no rays.
    Empty,
    /// Its rays span too wide an angle for one plane: it is split, or its rays are cast one by one.
    Wide,
    /// It is cast as one packet.
    Packet,
}

/// The places of a panorama packet's rays.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Places {
    /// The places in row order. Entries without a ray repeat the place of some other ray.
    pub(super) x: [f32; RAYS],
    pub(super) y: [f32; RAYS],
    /// Bounds of the rows of eight rays of each cell.
    rows: [PlaceBoxes; ALL_CELLS],
    /// Bounds of eight cells each.
    cells: [PlaceBoxes; ALL_CELLS / LANES],
    centres: [CellCentres; ALL_CELLS / LANES],
    /// Bounds of all places.
    pub(super) around: PlaceBox,
    /// For each row of the packet, the columns that have a ray, as bits.
    pub(super) has_ray: [u32; SIDE],
    pub(super) columns: u32,
    pub(super) rows_of_rays: u32,
    /// A camera whose image plane is the packet's plane.
    pub(super) view: Camera,
    /// The window of that plane that the rays go through, except for rounding.
    window: Window,
    /// The first ray's place in that camera's picture.
    first: (f64, f64),
    /// The corner of the window from which places are counted: its left, and its top.
    corner: (f64, f64),
    /// How far off the rays' tangents are, beyond rounding.
    beside: f64,
    /// Working memory: directions in the camera's axes, then places on the plane.
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
            around: PlaceBox::EMPTY,
            has_ray: [0; SIDE],
            columns: 0,
            rows_of_rays: 0,
            view: *camera,
            window: Window {
                across: (0.0, 0.0),
                along: (0.0, 0.0),
            },
            first: (0.0, 0.0),
            corner: (0.0, 0.0),
            beside: 0.0,
            directions: zero,
        })
    }

    /// Computes the places of a rectangle of at most [`SIDE`] × [`SIDE`] rays of a camera. `patch` is what is known of it
    /// through a lens.
    #[inline(always)]
    pub(super) fn find(
        &mut self,
        lanes: impl Lanes,
        (camera, rays): (&Camera, &PanoramaRays),
        packet: Rect,
        patch: Option<&LensPatch>,
    ) -> Fit {
        self.columns = packet.width;
        self.rows_of_rays = packet.height;
        // NaN fails this comparison.
        let eye = camera.pose().eye.abs();
        let is_near = rays.reach() <= FURTHEST && eye.cmple(DVec3::splat(FURTHEST)).all();
        if let Some(patch) = patch
            && is_near
            && self.find_smooth(lanes, (camera, rays), packet, patch)
        {
            return Fit::Packet;
        }
        self.beside = 0.0;
        if !self.find_directions(rays, packet, patch.map(|patch| patch.region)) {
            return Fit::Empty;
        }
        if !is_near {
            return Fit::Wide;
        }
        if !(rays.are_through_a_lens() && self.take_tangents(camera)) {
            let Some(view) = self.view(camera) else {
                return Fit::Wide;
            };
            self.view = view;
            if !self.project(camera) {
                return Fit::Wide;
            }
        }
        self.place();
        self.bound(lanes);
        Fit::Packet
    }

    /// Computes the places of a patch's rays. Returns `false` where only the rays' directions tell.
    #[inline(always)]
    fn find_smooth(
        &mut self,
        lanes: impl Lanes,
        (camera, rays): (&Camera, &PanoramaRays),
        packet: Rect,
        patch: &LensPatch,
    ) -> bool {
        let [across, along] = patch.window();
        self.window = Window { across, along };
        self.view = camera.unit_perspective();
        let scale = self.scale();
        let out = (&mut self.x[..], &mut self.y[..]);
        let Some(beside) = rays.find_places::<SIDE>((patch, packet), &scale, out) else {
            return false;
        };
        let step = self.view.plane().step;
        // A packet of few rays has columns that are closer than its rays.
        if beside > MOST_BESIDE * step {
            return false;
        }
        self.beside = beside;
        self.has_ray = [0; SIDE];
        let rows = packet.height as usize;
        for row in self.has_ray.iter_mut().take(rows) {
            *row = u32::MAX >> (SIDE as u32 - packet.width.clamp(1, SIDE as u32));
        }
        fill(&self.has_ray, 0, [&mut self.x, &mut self.y]);
        self.bound(lanes);
        // The patch's window is wider than its rays need.
        self.window = self.window_of(&self.around).grown(ROUNDED * step);
        true
    }

    /// The window of some places.
    fn window_of(&self, places: &PlaceBox) -> Window {
        let (step, (left, high)) = (self.view.plane().step, self.corner);
        let across = |place: f32| left + (f64::from(place) - MARGIN) * step;
        let along = |place: f32| high - (f64::from(place) - MARGIN) * step;
        Window {
            across: (across(places.left), across(places.right)),
            along: (along(places.bottom), along(places.top)),
        }
    }

    fn direction(&self, column: usize, row: usize) -> DVec3 {
        let [x, y, z] = &self.directions;
        let at = row * SIDE + column;
        DVec3::new(x[at], y[at], z[at])
    }

    /// A camera that looks along the mean direction of the rays; its axes are perpendicular, and of unit length,
    /// within 32ε. `None` where the mean is zero.
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
        // The up direction makes rows of rays run along rows of places, so far as possible: then their bounds are
        // flat.
        let up = in_world(top - low);
        let up = up - forward * up.dot(forward);
        // A difference parallel to the axis leaves rounding errors only. At an angle of at least 60° the cross
        // products of a camera's axes are no shorter than 0.86, and their roundings, 3ε each, are below 32ε after
        // normalising.
        let up = up.try_normalize().filter(|up| up.dot(forward).abs() < 0.5);
        let up = up.unwrap_or_else(|| forward.any_orthonormal_vector());
        Some(Camera::upright(forward, up))
    }

    /// Replaces directions by places on the view's plane, as tangents to the right and up, and computes their window.
    /// Returns whether all are in front, and within [`MOST_TANGENT`].
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

    /// Uses directions (x, y, 1) through a lens as places on the camera's own image plane, and computes their window.
    /// Returns whether all are within [`FLATTEST`].
    #[inline(always)]
    fn take_tangents(&mut self, camera: &Camera) -> bool {
        let [xs, ys, _] = &self.directions;
        let (across, along) = (extremes(xs), extremes(ys));
        let furthest = greater(greater(-across.0, across.1), greater(-along.0, along.1));
        if furthest > FLATTEST {
            return false;
        }
        self.view = camera.unit_perspective();
        self.window = Window { across, along };
        true
    }

    /// Scales the places of directions to the packet's columns and rows.
    #[inline(always)]
    fn place(&mut self) {
        let PlaceScale {
            corner: (left, high),
            inverse,
            ..
        } = self.scale();
        let [xs, ys, _] = &self.directions;
        for ((x, y), (&across, &along)) in
            (self.x.iter_mut().zip(&mut self.y)).zip(xs.iter().zip(ys))
        {
            *x = ((across - left) * inverse + MARGIN) as f32;
            *y = ((high - along) * inverse + MARGIN) as f32;
        }
    }

    /// Lays the packet's columns and rows over its window.
    #[inline(always)]
    fn scale(&mut self) -> PlaceScale {
        let Window {
            across: (left, right),
            along: (low, high),
        } = self.window;
        // Rays that are closer than this are one except for rounding. The limit keeps s positive and K finite.
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
        let half = SIDE as f64 * 0.5;
        self.first = (
            left * inverse - MARGIN + half,
            half - (high * inverse + MARGIN),
        );
        self.corner = (left, high);
        PlaceScale {
            corner: self.corner,
            inverse,
            margin: MARGIN,
        }
    }

    /// The packet's space. `eye` is the camera's, relative to the point that corners are relative to, and off by at
    /// most `eye_error`.
    pub(super) fn space(&self, eye: DVec3, eye_error: f64, cull: Cull) -> PacketSpace {
        let side = (SIDE as u32, SIDE as u32);
        let space = PacketSpace::new(&self.view, eye, eye_error, self.first, 1.0, side, cull);
        space.with_rays_beside(self.beside)
    }

    /// The window of the view's plane that the rays go through.
    pub(super) fn window(&self) -> Window {
        self.window.grown(TANGENT_ERROR + self.beside)
    }

    /// The places of eight rays of a cell's row, the first of which is `first`.
    #[inline(always)]
    pub(super) fn eight(&self, first: usize) -> (&[f32; ROW], &[f32; ROW]) {
        let row = first / ROW % (RAYS / ROW);
        (&self.x.as_chunks().0[row], &self.y.as_chunks().0[row])
    }
}

impl PacketSpace {
    /// The same packet, with rays beside their places by [`PLACE_ERROR`], and on a plane at distance one by `beside` more.
    pub(super) fn with_rays_beside(mut self, beside: f64) -> Self {
        // Bounds are proportional to it, where a lattice's rays are off by 32 units. These rays are off by as much in all
        // components.
        self.ray_error *= PLACE_ERROR / 32.0;
        let greatest = self.rays.distance * self.obliqueness;
        let off = greatest * self.obliqueness * (PLACE_ERROR * EPSILON);
        if beside > 0.0 {
            self.ray_error += beside / self.rays.steps[0].length();
        }
        self.rays.error = DVec3::splat(off + beside);
        self
    }
}

/// Gives entries without a ray the numbers of one that has a ray, at first those of `from`.
fn fill<T: Copy, const N: usize>(has_ray: &[u32; SIDE], from: usize, mut all: [&mut [T; RAYS]; N]) {
    if has_ray.iter().all(|&rays| rays == u32::MAX) {
        return;
    }
    let mut near = from;
    for (row, &rays) in has_ray.iter().enumerate() {
        for column in 0..SIDE {
            let at = row * SIDE + column;
            if rays >> column & 1 != 0 {
                near = at;
            } else {
                for numbers in &mut all {
                    numbers[at] = numbers[near];
                }
            }
        }
    }
}

/// The least and the greatest of some numbers.
#[inline(always)]
fn extremes(numbers: &[f64; RAYS]) -> (f64, f64) {
    let mut least = [f64::INFINITY; LANES];
    let mut most = [f64::NEG_INFINITY; LANES];
    for eight in numbers.as_chunks::<LANES>().0 {
        for lane in 0..LANES {
            least[lane] = lesser(eight[lane], least[lane]);
            most[lane] = greater(eight[lane], most[lane]);
        }
    }
    let mut ends = (f64::INFINITY, f64::NEG_INFINITY);
    for lane in 0..LANES {
        ends = (lesser(least[lane], ends.0), greater(most[lane], ends.1));
    }
    ends
}

#[cfg(test)]
mod tests;
