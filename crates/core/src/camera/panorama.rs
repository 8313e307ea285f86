use super::BrownConrady;
use crate::math;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Curved projections: each maps places of the picture to directions.
///
/// A place is (a, b), to the right of and above the picture's middle; near the middle of the picture, or of a cube's
/// face, a unit is a radian. Directions are (right, up, forward), of any length. A place outside the projection has
/// no direction, and its pixel is transparent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Panorama {
    /// a is longitude, b latitude: (sin a cos b, sin b, cos a cos b), where |a| ≤ π and |b| ≤ π/2.
    Equirectangular,
    /// A cylinder about the up axis, unrolled: (sin a, b, cos a), where |a| ≤ π.
    Cylindrical,
    /// A fisheye with equal angles: with ρ = √(a² + b²) the angle from the view axis is θ = ρ ≤ π.
    Equidistant,
    /// An equal-area fisheye: ρ = 2 sin(θ/2) ≤ 2.
    Equisolid,
    /// A conformal fisheye: ρ = 2 tan(θ/2).
    Stereographic,
    /// The six faces of a cube in a row: right, left, up, down, front, back, in OpenGL's order; each is two units
    /// wide. With (p, q) on a face, |p| ≤ 1 and |q| ≤ 1: front looks along (p, q, 1), up along (p, 1, −q), so that
    /// up, front and down follow one another, as do left, front, right and back.
    CubeStrip,
    /// The same faces as a cross: left, front, right and back in a row of four, up above and down below the front.
    CubeCross,
    /// A planar picture through a calibrated, distorting lens.
    Lens(BrownConrady),
}

/// Right, up and forward of each face of a cube.
const RIGHT: [DVec3; 3] = [DVec3::NEG_Z, DVec3::Y, DVec3::X];
const LEFT: [DVec3; 3] = [DVec3::Z, DVec3::Y, DVec3::NEG_X];
const UP: [DVec3; 3] = [DVec3::X, DVec3::NEG_Z, DVec3::Y];
const DOWN: [DVec3; 3] = [DVec3::X, DVec3::Z, DVec3::NEG_Y];
const FRONT: [DVec3; 3] = [DVec3::X, DVec3::Y, DVec3::Z];
const BACK: [DVec3; 3] = [DVec3::NEG_X, DVec3::Y, DVec3::NEG_Z];

/// The place of the middle of a cube's face, and the face's axes.
pub(super) type Face = (f64, f64, [DVec3; 3]);

/// The places of the middles of a strip's faces; `CROSS` has a cross's.
pub(super) const STRIP: [Face; 6] = [
    (-5.0, 0.0, RIGHT),
    (-3.0, 0.0, LEFT),
    (-1.0, 0.0, UP),
    (1.0, 0.0, DOWN),
    (3.0, 0.0, FRONT),
    (5.0, 0.0, BACK),
];
pub(super) const CROSS: [Face; 6] = [
    (-3.0, 0.0, LEFT),
    (-1.0, 0.0, FRONT),
    (1.0, 0.0, RIGHT),
    (3.0, 0.0, BACK),
    (-1.0, 2.0, UP),
    (-1.0, -2.0, DOWN),
];

impl Panorama {
    /// Every projection without parameters, and its name.
    pub const ALL: [(&str, Self); 7] = [
        ("equirectangular", Self::Equirectangular),
        ("cylindrical", Self::Cylindrical),
        ("fisheye", Self::Equidistant),
        ("fisheye:equisolid", Self::Equisolid),
        ("fisheye:stereographic", Self::Stereographic),
        ("cubemap", Self::CubeStrip),
        ("cubemap:cross", Self::CubeCross),
    ];

    /// The direction at a place, of any length; `None` outside the projection.
    pub fn direction(self, a: f64, b: f64) -> Option<DVec3> {
        let squared = a * a + b * b;
        match self {
            Self::Equirectangular if a.abs() <= PI && b.abs() <= FRAC_PI_2 => {
                let ((sin_a, cos_a), (sin_b, cos_b)) = (math::sin_cos(a), math::sin_cos(b));
                Some(DVec3::new(sin_a * cos_b, sin_b, cos_a * cos_b))
            }
            Self::Cylindrical if a.abs() <= PI && b.is_finite() => {
                let (sin, cos) = math::sin_cos(a);
                Some(DVec3::new(sin, b, cos))
            }
            Self::Equidistant if squared <= PI * PI => {
                let (share, cos) = sine_over_angle(squared.sqrt());
                Some(DVec3::new(a * share, b * share, cos))
            }
            Self::Equisolid if squared <= 4.0 => {
                // sin θ = ρ √(1 − ρ²/4) and cos θ = 1 − ρ²/2.
                let share = (1.0 - squared * 0.25).sqrt();
                Some(DVec3::new(a * share, b * share, 1.0 - squared * 0.5))
            }
            // Times 1 + ρ²/4: sin θ = ρ and cos θ = 1 − ρ²/4.
            Self::Stereographic if squared.is_finite() => {
                Some(DVec3::new(a, b, 1.0 - squared * 0.25))
            }
            Self::CubeStrip => on_face(&STRIP, a, b),
            Self::CubeCross => on_face(&CROSS, a, b),
            Self::Lens(lens) => lens.direction(a, b),
            _ => None,
        }
    }

    /// Whether a place is inside the projection: whether [`Panorama::direction`] is defined there.
    pub fn has_place(self, a: f64, b: f64) -> bool {
        let squared = a * a + b * b;
        match self {
            Self::Equirectangular => a.abs() <= PI && b.abs() <= FRAC_PI_2,
            Self::Cylindrical => a.abs() <= PI && b.is_finite(),
            Self::Equidistant => squared <= PI * PI,
            Self::Equisolid => squared <= 4.0,
            Self::Stereographic => squared.is_finite(),
            Self::CubeStrip | Self::CubeCross => self.face(a, b).is_some(),
            Self::Lens(lens) => lens.has_place(a, b),
        }
    }

    /// Whether the picture surely has all places of a row between two that it has. Rows are contiguous in all
    /// projections except a lens's.
    pub(super) fn has_all_between(self, (left, right): (f64, f64), b: f64) -> bool {
        match self {
            // Places between two are no further from the middle than the further one.
            Self::Lens(lens) => {
                lens.surely_has_place(left, b) && lens.surely_has_place(right, b)
                    || lens.region((left, right), (b, b)).is_some()
            }
            _ => self.has_place(left, b) && self.has_place(right, b),
        }
    }

    /// The derivatives of [`Panorama::direction`] by a and b: infinite at the rim of an equisolid fisheye, zero
    /// outside the projection.
    pub fn derivatives(self, a: f64, b: f64) -> [DVec3; 2] {
        if self.direction(a, b).is_none() {
            return [DVec3::ZERO; 2];
        }
        let squared = a * a + b * b;
        // (a s, b s, c), where s and c depend on ρ² alone: `slope` is twice the derivative of s by ρ², and `fall` is
        // twice that of c.
        let round = |share: f64, slope: f64, fall: f64| {
            [
                DVec3::new(share + a * a * slope, a * b * slope, a * fall),
                DVec3::new(a * b * slope, share + b * b * slope, b * fall),
            ]
        };
        match self {
            Self::Equirectangular => {
                let ((sin_a, cos_a), (sin_b, cos_b)) = (math::sin_cos(a), math::sin_cos(b));
                [
                    DVec3::new(cos_a * cos_b, 0.0, -sin_a * cos_b),
                    DVec3::new(-sin_a * sin_b, cos_b, -cos_a * sin_b),
                ]
            }
            Self::Cylindrical => {
                let (sin, cos) = math::sin_cos(a);
                [DVec3::new(cos, 0.0, -sin), DVec3::Y]
            }
            Self::Equidistant => {
                let angle = squared.sqrt();
                let (share, cos) = sine_over_angle(angle);
                // (cos ρ − sin ρ / ρ) / ρ² cancels for small ρ; the series is −1/3 + ρ²/30 − …
                let slope = if angle < 1e-3 {
                    squared / 30.0 - 1.0 / 3.0
                } else {
                    (cos - share) / squared
                };
                round(share, slope, -share)
            }
            Self::Equisolid => {
                let share = (1.0 - squared * 0.25).sqrt();
                round(share, -0.25 / share, -1.0)
            }
            Self::Stereographic => round(1.0, 0.0, -0.5),
            Self::Lens(lens) => lens.derivatives(a, b),
            Self::CubeStrip | Self::CubeCross => {
                (self.face(a, b)).map_or([DVec3::ZERO; 2], |(_, _, [p, q, _])| [p, q])
            }
        }
    }

    /// The face of a cube map that contains a place.
    #[inline]
    pub(super) fn face(self, a: f64, b: f64) -> Option<Face> {
        match self {
            Self::CubeStrip => face_at(&STRIP, a, b),
            Self::CubeCross => face_at(&CROSS, a, b),
            _ => None,
        }
    }

    /// The place of a direction; `None` for a zero direction, for up and down on a cylinder, and for straight back in
    /// a stereographic fisheye.
    pub fn place(self, direction: DVec3) -> Option<(f64, f64)> {
        let across = math::hypot(direction.x, direction.y);
        let length = math::hypot(across, direction.z);
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        let around = || math::atan2(direction.x, direction.z);
        let level = math::hypot(direction.x, direction.z);
        let off_axis = |radius: f64| {
            let share = if across > 0.0 { radius / across } else { 0.0 };
            Some((direction.x * share, direction.y * share))
        };
        let half = || math::atan2(across, direction.z) * 0.5;
        match self {
            Self::Equirectangular => Some((around(), math::atan2(direction.y, level))),
            Self::Cylindrical => (level > 0.0).then(|| (around(), direction.y / level)),
            Self::Equidistant => off_axis(2.0 * half()),
            Self::Equisolid => off_axis(2.0 * math::sin(half())),
            Self::Stereographic if length + direction.z > 0.0 => {
                off_axis(2.0 * across / (length + direction.z))
            }
            Self::Stereographic => None,
            Self::CubeStrip => place_on(&STRIP, direction),
            Self::CubeCross => place_on(&CROSS, direction),
            Self::Lens(lens) => lens.place(direction),
        }
    }

    /// The height of a picture with this vertical field of view in degrees.
    pub fn height(self, fov_degrees: f64) -> f64 {
        let angle = fov_degrees.to_radians();
        match self {
            Self::Equirectangular | Self::Equidistant => angle,
            Self::Cylindrical | Self::Lens(_) => 2.0 * math::tan(angle * 0.5),
            Self::Equisolid => 4.0 * math::sin(angle * 0.25),
            Self::Stereographic => 4.0 * math::tan(angle * 0.25),
            // Times the number of faces in a column.
            Self::CubeStrip | Self::CubeCross => fov_degrees / 45.0,
        }
    }

    /// The vertical field of view in degrees of a picture of this height; the largest one, if it is higher than that.
    pub fn fov_degrees(self, height: f64) -> f64 {
        let angle = match self {
            Self::Equirectangular | Self::Equidistant => height,
            Self::Cylindrical | Self::Lens(_) => 2.0 * math::atan(height * 0.5),
            Self::Equisolid => 4.0 * math::asin((height * 0.25).min(1.0)),
            Self::Stereographic => 4.0 * math::atan(height * 0.25),
            Self::CubeStrip | Self::CubeCross => return (height * 45.0).min(self.most_fov()),
        };
        angle.to_degrees().min(self.most_fov())
    }

    /// The largest vertical field of view in degrees. A cylinder would need infinitely many rows for 180, and a
    /// stereographic fisheye for 360; a degree less is some 200 and 900 units high.
    pub fn most_fov(self) -> f64 {
        match self {
            Self::Equirectangular => 180.0,
            Self::Cylindrical | Self::Lens(_) => 179.0,
            Self::Equidistant | Self::Equisolid => 360.0,
            Self::Stereographic => 359.0,
            Self::CubeStrip => 90.0,
            Self::CubeCross => 270.0,
        }
    }

    /// The default vertical field of view in degrees: all of it, where that is not too large.
    pub fn default_fov(self) -> f64 {
        match self {
            Self::Cylindrical | Self::Lens(_) => 90.0,
            Self::Equidistant | Self::Equisolid | Self::Stereographic => 180.0,
            Self::Equirectangular | Self::CubeStrip | Self::CubeCross => self.most_fov(),
        }
    }

    /// The size of a picture of this many rows that has the projection's full width, and no more.
    pub fn size(self, rows: u32) -> (u32, u32) {
        let aspect = match self {
            Self::Equirectangular => 2.0,
            Self::Cylindrical => PI,
            Self::Equidistant | Self::Equisolid | Self::Stereographic => 1.0,
            Self::CubeStrip => 6.0,
            Self::Lens(_) => 16.0 / 9.0,
            Self::CubeCross => 4.0 / 3.0,
        };
        ((f64::from(rows) * aspect).round() as u32, rows)
    }
}

/// sin ρ / ρ, which is one at zero, and cos ρ.
fn sine_over_angle(angle: f64) -> (f64, f64) {
    let (sin, cos) = math::sin_cos(angle);
    (if angle > 0.0 { sin / angle } else { 1.0 }, cos)
}

/// The face that contains a place; on an edge, the first in the list.
fn face_at(faces: &[Face; 6], a: f64, b: f64) -> Option<Face> {
    let on = |(x, y, _): &&Face| (a - x).abs() <= 1.0 && (b - y).abs() <= 1.0;
    faces.iter().find(on).copied()
}

fn on_face(faces: &[Face; 6], a: f64, b: f64) -> Option<DVec3> {
    let (x, y, [right, up, forward]) = face_at(faces, a, b)?;
    Some(right * (a - x) + up * (b - y) + forward)
}

/// The place of a direction on the face that it goes through.
fn place_on(faces: &[Face; 6], direction: DVec3) -> Option<(f64, f64)> {
    faces.iter().find_map(|(x, y, [right, up, forward])| {
        let depth = direction.dot(*forward);
        let (p, q) = (direction.dot(*right) / depth, direction.dot(*up) / depth);
        (depth > 0.0 && p.abs() <= 1.0 && q.abs() <= 1.0).then_some((x + p, y + q))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    fn all() -> impl Iterator<Item = Panorama> {
        Panorama::ALL.into_iter().map(|(_, panorama)| panorama)
    }

    /// The angle in radians between two directions.
    fn angle(a: DVec3, b: DVec3) -> f64 {
        math::atan2(a.cross(b).length(), a.dot(b))
    }

    #[test]
    fn every_direction_has_a_place_with_that_direction() {
        let mut random = Random(5);
        for panorama in all() {
            for _ in 0..2000 {
                let direction = random.point();
                let (a, b) = panorama.place(direction).expect("a place");
                let found = panorama.direction(a, b).expect("a direction");
                assert!(angle(direction, found) < 1e-7, "{panorama:?} {direction}");
            }
        }
    }

    #[test]
    fn a_picture_has_the_places_that_have_a_direction() {
        let mut random = Random(6);
        for panorama in all() {
            for _ in 0..5000 {
                let place = random.point() * 7.0;
                let has = panorama.direction(place.x, place.y).is_some();
                assert_eq!(
                    panorama.has_place(place.x, place.y),
                    has,
                    "{panorama:?} {place}"
                );
                let other = place.x + random.signed();
                let between = place.x + (other - place.x) * random.unit();
                if panorama.has_all_between((place.x, other), place.y) {
                    assert!(panorama.has_place(between, place.y), "{panorama:?} {place}");
                }
            }
        }
    }

    #[test]
    fn known_places_have_known_directions() {
        let looks = |panorama: Panorama, a: f64, b: f64, expected: DVec3| {
            let found = panorama.direction(a, b).expect("a direction");
            let apart = angle(found, expected);
            assert!(apart < 1e-12, "{panorama:?} {a} {b}: {found}");
        };
        for panorama in all().filter(|p| !matches!(p, Panorama::CubeStrip | Panorama::CubeCross)) {
            looks(panorama, 0.0, 0.0, DVec3::Z);
        }
        looks(Panorama::Equirectangular, FRAC_PI_2, 0.0, DVec3::X);
        looks(Panorama::Equirectangular, 0.3, FRAC_PI_2, DVec3::Y);
        looks(Panorama::Equirectangular, -PI, 0.0, DVec3::NEG_Z);
        looks(
            Panorama::Cylindrical,
            -FRAC_PI_2,
            1.0,
            DVec3::new(-1.0, 1.0, 0.0),
        );
        looks(Panorama::Equidistant, 0.0, FRAC_PI_2, DVec3::Y);
        looks(Panorama::Equisolid, 2f64.sqrt(), 0.0, DVec3::X);
        looks(Panorama::Stereographic, 0.0, -2.0, DVec3::NEG_Y);
        looks(Panorama::CubeStrip, 3.0, 0.0, DVec3::Z);
        looks(Panorama::CubeStrip, 5.0, 0.5, DVec3::new(0.0, 0.5, -1.0));
        looks(Panorama::CubeCross, -1.0, 0.0, DVec3::Z);
        looks(Panorama::CubeCross, -1.0, 2.0, DVec3::Y);
    }

    #[test]
    fn places_outside_the_projection_have_no_direction() {
        for (panorama, a, b) in [
            (Panorama::Equirectangular, 3.2, 0.0),
            (Panorama::Equirectangular, 0.0, 1.6),
            (Panorama::Cylindrical, -3.2, 0.0),
            (Panorama::Cylindrical, 0.0, f64::INFINITY),
            (Panorama::Equidistant, 3.0, 1.0),
            (Panorama::Equisolid, 1.5, 1.5),
            (Panorama::Stereographic, f64::NAN, 0.0),
            (Panorama::CubeStrip, 6.1, 0.0),
            (Panorama::CubeCross, 1.0, 2.0),
        ] {
            assert_eq!(panorama.direction(a, b), None, "{panorama:?}");
            assert!(!panorama.has_place(a, b), "{panorama:?}");
            assert_eq!(panorama.derivatives(a, b), [DVec3::ZERO; 2]);
        }
        assert_eq!(Panorama::Equirectangular.place(DVec3::ZERO), None);
        assert_eq!(Panorama::Cylindrical.place(DVec3::Y), None);
        assert_eq!(Panorama::Stereographic.place(DVec3::NEG_Z), None);
    }

    #[test]
    fn faces_of_a_cross_join_at_their_edges() {
        // Close to an edge, on both sides, the directions are nearly equal.
        for (a, b, across) in [
            (-2.0, 0.3, true),
            (0.0, -0.4, true),
            (2.0, 0.9, true),
            (-1.2, 1.0, false),
            (-0.3, -1.0, false),
        ] {
            let (da, db) = if across { (1e-9, 0.0) } else { (0.0, 1e-9) };
            let [one, other] = [1.0, -1.0].map(|side| {
                let found = Panorama::CubeCross.direction(a + da * side, b + db * side);
                found.expect("a direction")
            });
            assert!(angle(one, other) < 1e-8, "{a} {b}");
        }
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let by = 1e-6;
        for panorama in all() {
            for (a, b) in [(0.3, -0.2), (-0.9, 0.7), (1e-5, 2e-5), (-0.4, -0.8)] {
                let at = |a, b| panorama.direction(a, b).expect("a direction");
                let truth = [
                    (at(a + by, b) - at(a - by, b)) / (2.0 * by),
                    (at(a, b + by) - at(a, b - by)) / (2.0 * by),
                ];
                for (found, truth) in panorama.derivatives(a, b).into_iter().zip(truth) {
                    assert!(
                        (found - truth).length() < 1e-8,
                        "{panorama:?} {found} {truth}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_field_of_view_is_the_angle_from_bottom_to_top() {
        for panorama in all() {
            for fov in [10.0, 60.0, panorama.default_fov()] {
                let height = panorama.height(fov);
                assert!((panorama.fov_degrees(height) - fov).abs() < 1e-9);
                if matches!(panorama, Panorama::CubeStrip | Panorama::CubeCross) || fov > 170.0 {
                    continue;
                }
                let top = panorama.direction(0.0, height * 0.5).expect("a direction");
                let up = angle(top, DVec3::Z).to_degrees();
                assert!((up - fov * 0.5).abs() < 1e-9, "{panorama:?} {fov}: {up}");
            }
            assert!(panorama.fov_degrees(1e9) <= panorama.most_fov());
        }
    }
}
