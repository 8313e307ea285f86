//! The ground's lines in a planar picture: how rays meet the ground, as a function of the place alone, and which
//! pixels no line covers.

use crate::camera::{Camera, Projection};
use crate::num::simd::LANES;
use crate::shade::edges::reach;
use glam::DVec3;

/// The distance of the stronger lines, in cells.
pub(in crate::shade) const COARSER: f64 = 10.0;

/// The width of axes, the widest lines, in pixels.
pub(in crate::shade) const AXIS_WIDTH: f64 = 1.5;

/// Lines fade where cells are seen this many pixels wide, down to [`CLOSEST`]. With smaller limits dense lines would
/// become a shimmering grey; with larger ones the grid would end near the viewer.
pub(in crate::shade) const APART: f64 = 12.0;
pub(in crate::shade) const CLOSEST: f64 = 3.0;

/// The squared cells a pixel beyond which lines one cell apart have faded, with a margin for rounding.
const FADED: f64 = 1.0001 / (CLOSEST * CLOSEST);

/// The most cells that the eye or a place is from the origin where places are compared with lines. So a place is rounded
/// by less than 2⁻⁵⁰ · 2 · 10⁶, which is 2 · 10⁻⁹ cells.
const FURTHEST: f64 = 1e6;

/// The squared cells a pixel down to which places are compared with lines: a hundredth of a pixel, 10⁻⁸ cells here, must be
/// more than a place's rounding.
const FINEST: f64 = 1e-12;

/// 2⁵¹.
pub(in crate::shade) const WHOLE_LIMIT: f64 = (1u64 << 51) as f64;

/// The sum with a number below 2⁵¹ is rounded to a whole number, to the nearest even one at halves.
const WHOLE: f64 = (3u64 << 51) as f64;

/// A hundredth more than the reach of the widest line, in pixels.
const REACH: f64 = reach(AXIS_WIDTH).0 * 1.01;

/// How far a number below [`WHOLE_LIMIT`] is from the nearest whole one.
#[inline(always)]
pub(in crate::shade) fn from_whole(number: f64) -> f64 {
    number - ((number + WHOLE) - WHOLE)
}

/// Where a ray meets the ground.
struct Meeting {
    /// λ, in cells.
    along: f64,
    /// x and z.
    places: [f64; 2],
    /// The squared length of the derivatives of x, and of z, by the place in the picture: cells a pixel.
    squared: [f64; 2],
}

/// Where a ray is seen to meet the ground.
pub(in crate::shade) enum Seen {
    /// It does not.
    Nowhere,
    /// Errors could be seen.
    Uncertain,
    At {
        /// The distance, in cells, as a multiple of the length of [`Camera::direction`].
        along: f64,
        /// x and z, in cells.
        places: [f64; 2],
        /// By how much each changes from pixel to pixel.
        rates: [f64; 2],
    },
}

/// Where eight rays are seen to meet the ground.
pub(in crate::shade) struct EightSeen {
    /// x and z, in cells.
    pub(in crate::shade) places: [[f64; LANES]; 2],
    /// By how much each changes from pixel to pixel.
    pub(in crate::shade) rates: [[f64; LANES]; 2],
    /// Whether errors of any of them could be seen.
    pub(in crate::shade) is_uncertain: bool,
}

/// A vector that is linear over the picture: its value at the top left corner, and its derivatives by x and y in pixels.
#[derive(Clone, Copy, Debug)]
struct LinearVector {
    corner: DVec3,
    right: DVec3,
    down: DVec3,
}

impl LinearVector {
    fn constant(corner: DVec3) -> Self {
        Self {
            corner,
            right: DVec3::ZERO,
            down: DVec3::ZERO,
        }
    }

    #[inline(always)]
    fn at(&self, axis: usize, (x, y): (f64, f64)) -> f64 {
        self.corner[axis] + self.down[axis] * y + self.right[axis] * x
    }
}

/// The ground as the rays of a planar picture with one eye, or of an orthographic one, meet it. Coordinates are in cells.
#[derive(Clone, Copy, Debug)]
pub(in crate::shade) struct GroundLines {
    height: f64,
    /// Where rays start.
    origin: LinearVector,
    direction: LinearVector,
}

impl GroundLines {
    /// `None` for another kind of picture, and for eyes too far from the origin.
    pub(in crate::shade) fn new(camera: &Camera, height: f64, cell: f64) -> Option<Self> {
        let eye = camera.pose().eye / cell;
        if camera.stereo().is_some() || eye.abs().max_element() >= FURTHEST {
            return None;
        }
        let direction = camera.direction(0.0, 0.0);
        let (origin, direction) = match camera.projection() {
            Projection::Perspective => {
                let [right, down] = camera.direction_slopes(0.0, 0.0);
                let direction = LinearVector {
                    corner: direction,
                    right,
                    down,
                };
                (LinearVector::constant(eye), direction)
            }
            Projection::Orthographic => {
                let step = camera.plane().step / cell;
                let origin = LinearVector {
                    corner: eye + camera.on_plane(0.0, 0.0) / cell,
                    right: camera.right() * step,
                    down: camera.up() * -step,
                };
                (origin, LinearVector::constant(direction))
            }
            Projection::Panoramic(_) => return None,
        };
        Some(Self {
            height: height / cell,
            origin,
            direction,
        })
    }

    /// The ground where the ray through (x, y) meets it. NaN where nothing is known.
    ///
    /// A ray o + λd meets the ground at λ = (height − o.y) / d.y. With s = oₓ + λdₓ, oₓ and dₓ the derivatives of o and d by x,
    /// that of the point is s − d·s.y / d.y.
    #[inline(always)]
    fn meeting(&self, x: f64, y: f64) -> Meeting {
        let Self {
            height,
            origin,
            direction,
        } = self;
        let inverse = 1.0 / direction.at(1, (x, y));
        let along = (height - origin.at(1, (x, y))) * inverse;
        let right = |axis: usize| origin.right[axis] + direction.right[axis] * along;
        let down = |axis: usize| origin.down[axis] + direction.down[axis] * along;
        let (right_y, down_y) = (right(1) * inverse, down(1) * inverse);
        let [mut places, mut squared] = [[0.0; 2]; 2];
        for number in 0..2 {
            let axis = 2 * number;
            let ahead = direction.at(axis, (x, y));
            let by_x = right(axis) - ahead * right_y;
            let by_y = down(axis) - ahead * down_y;
            places[number] = origin.at(axis, (x, y)) + ahead * along;
            squared[number] = by_x * by_x + by_y * by_y;
        }
        Meeting {
            along,
            places,
            squared,
        }
    }

    /// Whether a line may cover part of the pixel at (x, y): `false` is certain.
    #[inline(always)]
    fn may_cover(&self, x: f64, y: f64) -> bool {
        let Meeting {
            along,
            places,
            squared,
        } = self.meeting(x, y);
        let mut is_close = false;
        for (place, squared) in places.into_iter().zip(squared) {
            // The distance of the finest lines that have not faded.
            let cells = if squared < FADED {
                1.0
            } else if squared < FADED * COARSER * COARSER {
                COARSER
            } else {
                COARSER * COARSER
            };
            let beside = from_whole(place / cells) * cells;
            let is_beside = beside * beside > REACH * REACH * squared;
            let is_faded = squared > FADED * COARSER * COARSER * COARSER * COARSER;
            let is_known = (squared > FINEST) & (place.abs() < FURTHEST);
            is_close |= !((is_beside | is_faded) & is_known);
        }
        // Nothing is known where it is NaN.
        (along > 0.0 || along.is_nan()) & is_close
    }

    /// How the ray through (x, y) is seen to meet the ground.
    #[inline]
    pub(in crate::shade) fn seen(&self, x: f64, y: f64) -> Seen {
        let meeting = self.meeting(x, y);
        if meeting.along <= 0.0 {
            return Seen::Nowhere;
        }
        let is_known = |number: usize| {
            (meeting.squared[number] > FINEST) & (meeting.places[number].abs() < FURTHEST)
        };
        if !(is_known(0) && is_known(1)) {
            return Seen::Uncertain;
        }
        let [x, z] = meeting.squared;
        Seen::At {
            along: meeting.along,
            places: meeting.places,
            rates: [x.sqrt(), z.sqrt()],
        }
    }

    /// How eight rays of a row are seen to meet the ground. Where one does not, its rates are zero.
    #[inline(always)]
    pub(in crate::shade) fn seen_by_eight(&self, xs: &[f64; LANES], y: f64) -> EightSeen {
        let [mut places, mut rates] = [[[0.0; LANES]; 2]; 2];
        let mut is_known = [0.0; LANES];
        for lane in 0..LANES {
            let meeting = self.meeting(xs[lane], y);
            let misses = meeting.along <= 0.0;
            let mut are_known = true;
            for number in 0..2 {
                let (place, squared) = (meeting.places[number], meeting.squared[number]);
                are_known &= (squared > FINEST) & (place.abs() < FURTHEST);
                places[number][lane] = place;
                rates[number][lane] = if misses { 0.0 } else { squared.sqrt() };
            }
            is_known[lane] = if are_known | misses { 1.0 } else { 0.0 };
        }
        EightSeen {
            places,
            rates,
            is_uncertain: is_known != [1.0; LANES],
        }
    }

    /// [`GroundLines::may_cover`] at eight places of a row.
    #[inline(always)]
    pub(in crate::shade) fn may_cover_eight(&self, xs: &[f64; LANES], y: f64) -> [bool; LANES] {
        let mut all = [false; LANES];
        for lane in 0..LANES {
            all[lane] = self.may_cover(xs[lane], y);
        }
        all
    }
}
