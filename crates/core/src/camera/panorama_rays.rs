//! Ray directions of a panorama on a lattice. What all rays of a column or of a row share, such as the sine and
//! cosine of a longitude, is computed once.

#![allow(
    clippy::needless_range_loop,
    reason = "a lane is an index into all the arrays at once"
)]

use super::equidistant::{Expansion, equidistant};
use super::lens_patch::{LensPatch, PatchPlaces, PlaceScale};
use super::panorama::{CROSS, Face, STRIP};
use super::{Lattice, LensRegion, Panorama, Rect};
use crate::math;
use crate::num::simd::LANES;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// The half angle in radians from which a cone is too wide to be of use. Any value below π/2 is correct. A wider
/// cone touches most of the scene around the eye, so that testing against it rejects little; with a smaller limit
/// more large packets start traversal at the root.
const WIDE: f64 = 0.6;

/// x, y and z of eight vectors, one vector a lane.
pub(crate) type EightDirections = [[f64; LANES]; 3];

/// The rays of a panorama on a lattice, computed for eight neighbours of a row at a time.
pub(crate) struct PanoramaRays {
    panorama: Panorama,
    /// The camera's right, up and forward unit vectors.
    axes: [[f64; 3]; 3],
    columns: SidePlaces,
    rows: SidePlaces,
    /// From a row's place to that of the next.
    row_step: f64,
}

/// The places along one side of the picture, in the unit of [`Panorama`]: one radian at the picture's middle. The
/// last one is repeated, so that eight can be read at the end. Sines and cosines only where the panorama uses
/// places as angles.
#[derive(Default)]
struct SidePlaces {
    at: Vec<f64>,
    sin: Vec<f64>,
    cos: Vec<f64>,
}

impl SidePlaces {
    fn new(at: Vec<f64>, has_angles: bool) -> Self {
        let mut all = Self {
            at,
            ..Self::default()
        };
        let last = all.at.last().copied().unwrap_or(0.0);
        all.at.resize(all.at.len() + LANES, last);
        if has_angles {
            (all.sin, all.cos) = all.at.iter().map(|&angle| math::sin_cos(angle)).unzip();
        }
        all
    }

    /// Eight consecutive numbers; zeros if fewer are left.
    #[inline(always)]
    fn eight(numbers: &[f64], first: usize) -> [f64; LANES] {
        let eight = numbers.get(first..).and_then(|rest| rest.first_chunk());
        eight.copied().unwrap_or([0.0; LANES])
    }

    #[inline(always)]
    fn one(numbers: &[f64], at: usize) -> f64 {
        numbers.get(at).copied().unwrap_or(0.0)
    }
}

impl PanoramaRays {
    /// The rays of a lattice; `None` if its camera is not panoramic.
    pub(crate) fn new(lattice: &Lattice) -> Option<Self> {
        let camera = &lattice.camera;
        let panorama = camera.projection().panorama()?;
        let across = |column| {
            let (x, y) = lattice.place(column, 0);
            camera.panoramic_place(x, y).0
        };
        let along = |row| {
            let (x, y) = lattice.place(0, row);
            camera.panoramic_place(x, y).1
        };
        let (has_longitudes, has_latitudes) = match panorama {
            Panorama::Equirectangular => (true, true),
            Panorama::Cylindrical => (true, false),
            _ => (false, false),
        };
        let axes = [camera.right(), camera.up(), camera.forward()];
        Some(Self {
            panorama,
            axes: axes.map(|axis| axis.to_array()),
            columns: SidePlaces::new((0..lattice.columns).map(across).collect(), has_longitudes),
            rows: SidePlaces::new((0..lattice.rows).map(along).collect(), has_latitudes),
            row_step: along(1) - along(0),
        })
    }

    /// The greatest magnitude of a place. NaN is skipped: such a place has no ray.
    pub(crate) fn reach(&self) -> f64 {
        let ends = |places: &SidePlaces| [places.at.first().copied(), places.at.last().copied()];
        let all = ends(&self.columns).into_iter().chain(ends(&self.rows));
        all.flatten().map(f64::abs).fold(0.0, f64::max)
    }

    /// A cone that contains all rays of a rectangle: its axis in camera coordinates, and the tangent of its half
    /// angle. `None` if it is wider than [`WIDE`], if the rectangle's middle is outside the picture's domain, or
    /// for a lens.
    ///
    /// The angle between two directions is at most the distance of their places times the greatest turn rate on the
    /// way. The rate is at most 1 radian a unit, reached in the middle of the picture, except for an equisolid
    /// fisheye: along ρ it turns by 1/√(1 − ρ²/4). The picture's domain, or the cube face, is convex, so the
    /// segment from the middle to each ray lies in it.
    ///
    /// At the rim of an equisolid fisheye, 1 − ρ²/4 has an error of 4ε. A rectangle of size h turns by less than
    /// 2√(2h) there; the bound used is h/√(4ε). It is larger, because h is zero or at least 10⁻¹⁰: a picture has at
    /// most 2³² columns.
    pub(crate) fn cone(&self, rect: Rect) -> Option<(DVec3, f64)> {
        let ((left, right), (top, bottom)) = self.ends(rect)?;
        let (across, along) = ((right - left) * 0.5, (bottom - top) * 0.5);
        if matches!(self.panorama, Panorama::Lens(_)) {
            // The turn rate of a lens grows without bound towards the end of its domain: see `window`.
            return None;
        }
        let axis = self.panorama.direction(left + across, top + along)?;
        let turn = if self.panorama == Panorama::Equisolid {
            let (a, b) = (left.abs().max(right.abs()), top.abs().max(bottom.abs()));
            1.0 / (1.0 - (a * a + b * b) * 0.25).max(0.0).sqrt()
        } else {
            1.0
        };
        // The margins exceed all rounding errors of places and directions by orders of magnitude.
        let angle = math::hypot(across, along) * turn * (1.0 + 1e-9) + 1e-9;
        (angle < WIDE).then(|| (axis, math::tan(angle)))
    }

    /// The first and the last place of a rectangle's columns, and of its rows.
    fn ends(&self, rect: Rect) -> Option<((f64, f64), (f64, f64))> {
        let ends = |places: &[f64], first: u32, count: u32| {
            let last = first + count.max(1) - 1;
            Some((*places.get(first as usize)?, *places.get(last as usize)?))
        };
        let columns = ends(&self.columns.at, rect.x, rect.width)?;
        Some((columns, ends(&self.rows.at, rect.y, rect.height)?))
    }

    /// Whether the picture is a plane seen through a lens, so that all rays cross the camera's image plane.
    pub(crate) fn are_through_a_lens(&self) -> bool {
        matches!(self.panorama, Panorama::Lens(_))
    }

    /// Whether a rectangle surely has no rays: it is beyond the rim of a lens's picture.
    pub(crate) fn has_surely_none(&self, rect: Rect) -> bool {
        let (Panorama::Lens(lens), Some((across, along))) = (self.panorama, self.ends(rect)) else {
            return false;
        };
        let (a, b) = nearest(across, along);
        lens.surely_lacks(a, b)
    }

    /// What is known of a rectangle's rays through a lens. `None` if there is no lens, or where only the rays themselves
    /// tell.
    pub(crate) fn lens_region(&self, rect: Rect) -> Option<LensRegion> {
        let Panorama::Lens(lens) = self.panorama else {
            return None;
        };
        let (across, (top, bottom)) = self.ends(rect)?;
        lens.region(across, (bottom, top))
    }

    /// What is known of a rectangle's directions through a lens; `None` as [`PanoramaRays::lens_region`]. `larger` is the patch
    /// of a rectangle that contains it, where that is known.
    pub(crate) fn lens_patch(&self, rect: Rect, larger: Option<&LensPatch>) -> Option<LensPatch> {
        let Panorama::Lens(lens) = self.panorama else {
            return None;
        };
        let (across, (top, bottom)) = self.ends(rect)?;
        LensPatch::new(&lens, across, (bottom, top), self.row_step, larger)
    }

    /// Finds the places of a patch's rays in a packet of `SIDE` to a row, and how far off their directions may be; `None`
    /// where they are not found.
    #[inline(always)]
    pub(crate) fn find_places<const SIDE: usize>(
        &self,
        (patch, rect): (&LensPatch, Rect),
        scale: &PlaceScale,
        out: (&mut [f32], &mut [f32]),
    ) -> Option<f64> {
        let places = PatchPlaces {
            columns: self.columns.at.get(rect.x as usize..)?,
            width: rect.width as usize,
            first: -SidePlaces::one(&self.rows.at, rect.y as usize),
            step: -self.row_step,
            height: rect.height as usize,
        };
        let is_found = patch.find_places::<SIDE>(&places, scale, out);
        is_found.then(|| patch.tolerance(self.row_step)).flatten()
    }

    /// The cube face of a ray.
    pub(super) fn face(&self, column: u32, row: u32) -> Option<Face> {
        let at = |places: &SidePlaces, index: u32| places.at.get(index as usize).copied();
        (self.panorama).face(at(&self.columns, column)?, at(&self.rows, row)?)
    }

    /// Divides the lattice into rectangles, in row-major order, so that the rays of each are on one cube face, or
    /// all on none. `None` if the picture is no cube map.
    pub(crate) fn rects_of_faces(&self) -> Option<Vec<Rect>> {
        let faces = match self.panorama {
            Panorama::CubeStrip => &STRIP,
            Panorama::CubeCross => &CROSS,
            _ => return None,
        };
        let columns = spans_of_faces(&self.columns, faces.map(|(x, _, _)| x));
        let rows = spans_of_faces(&self.rows, faces.map(|(_, y, _)| y));
        let rect = |(y, height): (u32, u32), (x, width): (u32, u32)| Rect {
            x,
            y,
            width,
            height,
        };
        let row_by_row = |&row: &(u32, u32)| columns.iter().map(move |&column| rect(row, column));
        Some(rows.iter().flat_map(row_by_row).collect())
    }

    /// World directions of eight rays of a row, starting at `column`, bitwise equal to those of
    /// [`Camera::ray`](super::Camera::ray). Lanes without a ray have an arbitrary value.
    #[inline(always)]
    pub(crate) fn eight_in_world(&self, column: u32, row: u32) -> EightDirections {
        let mut directions = [[0.0; LANES]; 3];
        self.eight(column, row, &mut directions);
        let (sums, lengths) = self.turned(&directions);
        let mut out = [[0.0; LANES]; 3];
        for axis in 0..3 {
            for lane in 0..LANES {
                out[axis][lane] = sums[axis][lane] / lengths[lane];
            }
        }
        out
    }

    /// Unit vectors in world coordinates from the hit points of eight rays of a row to the eye, in single
    /// precision.
    #[inline(always)]
    pub(crate) fn eight_to_eye(&self, column: u32, row: u32) -> [[f32; LANES]; 3] {
        let mut directions = [[0.0; LANES]; 3];
        self.eight(column, row, &mut directions);
        let (sums, lengths) = self.turned(&directions);
        let mut out = [[0.0; LANES]; 3];
        for lane in 0..LANES {
            let inverse = 1.0 / lengths[lane];
            for axis in 0..3 {
                out[axis][lane] = -((sums[axis][lane] * inverse) as f32);
            }
        }
        out
    }

    /// Transforms eight vectors from camera to world coordinates; also returns their lengths.
    #[inline(always)]
    fn turned(&self, [xs, ys, zs]: &EightDirections) -> (EightDirections, [f64; LANES]) {
        let [right, up, forward] = self.axes;
        let mut out = [[0.0; LANES]; 3];
        let mut lengths = [0.0; LANES];
        for lane in 0..LANES {
            for axis in 0..3 {
                out[axis][lane] =
                    right[axis] * xs[lane] + up[axis] * ys[lane] + forward[axis] * zs[lane];
            }
            let [x, y, z] = [out[0][lane], out[1][lane], out[2][lane]];
            lengths[lane] = (x * x + y * y + z * z).sqrt();
        }
        (out, lengths)
    }

    /// Directions in camera coordinates of eight rays of a row, starting at `column`, bitwise equal to those of
    /// [`Panorama::direction`]. Returns a mask of the lanes that have a ray; the others have an arbitrary value.
    #[inline(always)]
    fn eight(&self, column: u32, row: u32, out: &mut EightDirections) -> u32 {
        let (a, b) = self.places(column, row);
        match self.panorama {
            Panorama::Equirectangular | Panorama::Cylindrical => self.around(column, row, out),
            Panorama::Lens(lens) => {
                let down = [-b; LANES];
                let [x, y] = lens.steps_towards(&a, &down);
                *out = [x, negated(&y), [1.0; LANES]];
                // The lanes between are closer to the middle than the farther end.
                if lens.surely_has_place(a[0], b) & lens.surely_has_place(a[LANES - 1], b) {
                    return (1 << LANES) - 1;
                }
                let has = lens.arrived([&a, &down], [&x, &y]);
                (0..LANES).fold(0, |bits, lane| bits | u32::from(has[lane]) << lane)
            }
            _ => {
                if let Some(axes) = self.face_of_eight(&a, b) {
                    return on_face(axes, &a, b, out);
                }
                let mut has = 0;
                for lane in 0..LANES {
                    let direction = self.panorama.direction(a[lane], b);
                    has |= u32::from(direction.is_some()) << lane;
                    let direction = direction.unwrap_or_default();
                    for (out, one) in out.iter_mut().zip(direction.to_array()) {
                        out[lane] = one;
                    }
                }
                has
            }
        }
    }

    /// What makes directions of a rectangle faster to compute.
    pub(crate) fn expansion(&self, rect: Rect) -> Option<Expansion> {
        if self.panorama != Panorama::Equidistant {
            return None;
        }
        let (across, along) = self.ends(rect)?;
        let (near, far) = (nearest(across, along), furthest(across, along));
        Expansion::new(
            near.0 * near.0 + near.1 * near.1,
            far.0 * far.0 + far.1 * far.1,
        )
    }

    /// As [`PanoramaRays::eight`] up to rounding, and faster: the error of each coordinate is below 320ε times the
    /// direction's length, ε = 2⁻⁵³. `expansion` is that of a rectangle that contains the rays, if it has one.
    #[inline(always)]
    pub(crate) fn nearly_eight(
        &self,
        expansion: Option<&Expansion>,
        (column, row): (u32, u32),
        out: &mut EightDirections,
    ) -> u32 {
        let (a, b) = self.places(column, row);
        let mut squared = [0.0; LANES];
        for lane in 0..LANES {
            squared[lane] = a[lane] * a[lane] + b * b;
        }
        if let Some(expansion) = expansion {
            expansion.directions(&a, b, &squared, out);
            return (1 << LANES) - 1;
        }
        match self.panorama {
            Panorama::Equidistant => {
                equidistant(&a, b, &squared, out);
                at_most(&squared, PI * PI)
            }
            Panorama::Equisolid => {
                for lane in 0..LANES {
                    let rest = 1.0 - squared[lane] * 0.25;
                    let share = if rest > 0.0 { rest } else { 0.0 }.sqrt();
                    out[0][lane] = a[lane] * share;
                    out[1][lane] = b * share;
                    out[2][lane] = 1.0 - squared[lane] * 0.5;
                }
                at_most(&squared, 4.0)
            }
            Panorama::Stereographic => {
                for lane in 0..LANES {
                    out[0][lane] = a[lane];
                    out[1][lane] = b;
                    out[2][lane] = 1.0 - squared[lane] * 0.25;
                }
                at_most(&squared, f64::MAX)
            }
            _ => self.eight(column, row, out),
        }
    }

    /// Directions of eight rays of a region's row through a lens, iterated from start values (x, y) nearby. As
    /// [`PanoramaRays::nearly_eight`], but with an error of up to 1440ε. `None` if a start value is not near
    /// enough, or without a lens.
    #[inline(always)]
    pub(crate) fn eight_through_lens(
        &self,
        region: &LensRegion,
        column: u32,
        row: u32,
        [x, y]: [[f64; LANES]; 2],
    ) -> Option<[[f64; LANES]; 2]> {
        let Panorama::Lens(lens) = self.panorama else {
            return None;
        };
        let (a, b) = self.places(column, row);
        let [x, down] =
            region.undistort_from(&lens.distortion, [&a, &[-b; LANES]], [x, negated(&y)])?;
        Some([x, negated(&down)])
    }

    #[inline(always)]
    fn places(&self, column: u32, row: u32) -> ([f64; LANES], f64) {
        (
            SidePlaces::eight(&self.columns.at, column as usize),
            SidePlaces::one(&self.rows.at, row as usize),
        )
    }

    /// As [`PanoramaRays::eight`], for a picture that wraps around the up axis.
    #[inline(always)]
    fn around(&self, column: u32, row: u32, out: &mut EightDirections) -> u32 {
        let (a, b) = self.places(column, row);
        let sin = SidePlaces::eight(&self.columns.sin, column as usize);
        let cos = SidePlaces::eight(&self.columns.cos, column as usize);
        if self.panorama == Panorama::Cylindrical {
            *out = [sin, [b; LANES], cos];
            return if b.is_finite() {
                at_most(&a.map(f64::abs), PI)
            } else {
                0
            };
        }
        let sin_b = SidePlaces::one(&self.rows.sin, row as usize);
        let cos_b = SidePlaces::one(&self.rows.cos, row as usize);
        for lane in 0..LANES {
            out[0][lane] = sin[lane] * cos_b;
            out[1][lane] = sin_b;
            out[2][lane] = cos[lane] * cos_b;
        }
        if b.abs() <= FRAC_PI_2 {
            at_most(&a.map(f64::abs), PI)
        } else {
            0
        }
    }

    /// The cube face of all eight places: that of the first if the last is on the same one, since faces are convex.
    #[inline(always)]
    fn face_of_eight(&self, a: &[f64; LANES], b: f64) -> Option<Face> {
        let (first, last) = (
            self.panorama.face(a[0], b)?,
            self.panorama.face(a[LANES - 1], b)?,
        );
        (first == last).then_some(first)
    }
}

/// Runs of places that lie within the same faces: the first index and the length of each. A place on a border lies
/// within two faces and belongs to the first in the list, as in [`Panorama::direction`]. It must not join its
/// neighbours' run: the adjacent face in the picture may look another way.
fn spans_of_faces(places: &SidePlaces, middles: [f64; 6]) -> Vec<(u32, u32)> {
    let beside = |at: f64| middles.map(|middle| (at - middle).abs() <= 1.0);
    let at = &places.at[..places.at.len() - LANES];
    let spans = at.chunk_by(|&one, &next| beside(one) == beside(next));
    let mut first = 0;
    let span = |span: &[f64]| {
        let count = span.len() as u32;
        first += count;
        (first - count, count)
    };
    spans.map(span).collect()
}

/// Directions of eight places on one face.
#[inline(always)]
fn on_face(
    (x, y, [right, up, forward]): Face,
    a: &[f64; LANES],
    b: f64,
    out: &mut EightDirections,
) -> u32 {
    for axis in 0..3 {
        for lane in 0..LANES {
            out[axis][lane] = right[axis] * (a[lane] - x) + up[axis] * (b - y) + forward[axis];
        }
    }
    (1 << LANES) - 1
}

#[inline(always)]
fn negated(numbers: &[f64; LANES]) -> [f64; LANES] {
    let mut out = [0.0; LANES];
    for lane in 0..LANES {
        out[lane] = -numbers[lane];
    }
    out
}

/// Mask of the lanes that are at most `most`.
#[inline(always)]
fn at_most(numbers: &[f64; LANES], most: f64) -> u32 {
    let mut all = 0;
    for (lane, number) in numbers.iter().enumerate() {
        all |= u32::from(*number <= most) << lane;
    }
    all
}

/// The distances of a rectangle's nearest column and row from the middle.
fn nearest(across: (f64, f64), along: (f64, f64)) -> (f64, f64) {
    let side = |(one, other): (f64, f64)| match one * other > 0.0 {
        true => one.abs().min(other.abs()),
        false => 0.0,
    };
    (side(across), side(along))
}

/// The distances of its furthest ones.
fn furthest(across: (f64, f64), along: (f64, f64)) -> (f64, f64) {
    let side = |(one, other): (f64, f64)| one.abs().max(other.abs());
    (side(across), side(along))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{BrownConrady, Camera, ImagePlane, Pose, Projection, Rect};
    use crate::random::Random;

    /// Lattices with arbitrary bounds, with places outside the picture's domain and on borders of faces.
    fn lattices() -> impl Iterator<Item = Lattice> {
        let mut random = Random(81);
        let lens = BrownConrady::new([-0.3, 0.1, 0.001, -0.0005, -0.01]).expect("finite");
        let all = Panorama::ALL.map(|(_, panorama)| panorama);
        let all = all.into_iter().chain([Panorama::Lens(lens)]);
        all.flat_map(move |panorama| {
            [0.11, 0.125, 1e-4].map(|step| {
                let eye = random.point();
                let pose = Pose::towards(eye, eye + random.point() * 3.0);
                let step = step * eye.distance(pose.target);
                let plane = ImagePlane::new(150, 90, step).expect("a good plane");
                let camera = Camera::new(pose, Projection::Panoramic(panorama), plane);
                let rect = Rect {
                    x: 1,
                    y: 2,
                    width: 149,
                    height: 88,
                };
                let stride = if random.unit() < 0.5 { 1 } else { 3 };
                let mut lattice = camera.sub_camera(rect).sparse_lattice(stride, (0, 0));
                if random.unit() < 0.5 {
                    lattice.offset = (random.unit(), random.unit());
                }
                lattice
            })
        })
    }

    #[test]
    fn eight_directions_have_the_bits_of_single_rays() {
        let (mut count, mut through_lens) = (0, 0);
        let mut random = Random(96);
        for lattice in lattices() {
            let camera = &lattice.camera;
            let panorama = camera.projection().panorama().expect("a panorama");
            let rays = PanoramaRays::new(&lattice).expect("a panorama");
            for row in 0..lattice.rows {
                for first in (0..lattice.columns).step_by(5) {
                    let [mut exact, mut near] = [[[0.0; LANES]; 3]; 2];
                    let has = rays.eight(first, row, &mut exact);
                    let in_world = rays.eight_in_world(first, row);
                    let rect = Rect {
                        x: first,
                        y: row,
                        width: LANES as u32,
                        height: 1,
                    };
                    let expansion = rays.expansion(rect);
                    let nearly_has = rays.nearly_eight(expansion.as_ref(), (first, row), &mut near);
                    // Start values nearby; of a lens, only where it is well-behaved.
                    let start = [0, 1].map(|axis| near[axis].map(|at| at + 1e-5 * random.signed()));
                    let from_there = (rays.lens_region(rect))
                        .and_then(|region| rays.eight_through_lens(&region, first, row, start));
                    for lane in 0..LANES {
                        let column = first + lane as u32;
                        if column >= lattice.columns {
                            continue;
                        }
                        let (x, y) = lattice.place(column, row);
                        let (a, b) = camera.panoramic_place(x, y);
                        let expected = panorama.direction(a, b);
                        assert_eq!(has >> lane & 1 != 0, expected.is_some());
                        assert_eq!(nearly_has >> lane & 1 != 0, expected.is_some());
                        let Some(expected) = expected else { continue };
                        let at =
                            |all: &EightDirections| DVec3::from_array(all.map(|axis| axis[lane]));
                        assert_eq!(at(&exact), expected, "{panorama:?} {a} {b}");
                        assert_eq!(at(&in_world), lattice.ray(column, row).direction);
                        let off = (at(&near) - expected).abs().max_element();
                        let bound = 160.0 * f64::EPSILON * expected.length();
                        assert!(off <= bound, "{panorama:?} {a} {b}: {off:e}");
                        count += 1;
                        if let Some([x, y]) = from_there {
                            let off = DVec3::new(x[lane], y[lane], 1.0).distance(expected);
                            let bound = 720.0 * f64::EPSILON;
                            assert!(off <= bound, "{panorama:?} {a} {b}: {off:e}");
                            through_lens += 1;
                        }
                    }
                }
            }
        }
        assert!(count > 50_000, "{count}");
        assert!(through_lens > 1000, "{through_lens}");
    }
}
