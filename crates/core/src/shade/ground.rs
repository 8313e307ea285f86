//! A grid of lines on a horizontal plane, which shows the vertical and the scale.

pub(in crate::shade) mod lines;

use super::Ground;
use super::edges::reach;
use super::srgb::{self, over};
use crate::camera::Camera;
use crate::math;
use crate::num::simd::LANES;
use crate::scene::Scene;
use glam::{DVec3, Vec3};
use lines::{
    APART, AXIS_WIDTH, CLOSEST, COARSER, EightSeen, GroundLines, Seen, WHOLE_LIMIT, from_whole,
};

/// The opacity of each type of line.
const FINE: f64 = 0.28;
const COARSE: f64 = 0.55;
const AXIS: f64 = 0.85;

/// How much nearer than a pixel's hit the ground must be to be in front, relative to its distance: the hit is in
/// single precision, after a few roundings of 2⁻²⁴ each. So objects that stand on the ground hide it.
const NEARER: f64 = 1.0 / (1 << 21) as f64;

/// The ground of a picture. A ray intersects it in one point; the change of that point from pixel to pixel gives the
/// width there of a line of one pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct GroundGrid {
    height: f64,
    /// A cell's width: a power of ten, between a fifth and a fiftieth of the scene's size.
    cell: f64,
    /// Those of plain lines, and of the lines at x = 0 and at z = 0.
    colors: [Vec3; 3],
    /// Which places are close to lines; `None` where that is not known.
    close: Option<GroundLines>,
}

/// Where a ray intersects the ground, and the change of that point from pixel to pixel, to the right and down.
struct Intersection {
    distance: f64,
    point: DVec3,
    steps: [DVec3; 2],
}

impl GroundGrid {
    /// `None` for an empty scene.
    pub(super) fn new(scene: &Scene, ground: Ground, camera: &Camera) -> Option<Self> {
        let bounds = scene.bounds();
        let size = (bounds.max - bounds.min).max_element();
        let height = match ground {
            Ground::Lowest => bounds.min.y,
            Ground::At(height) => height,
        };
        if !(size.is_finite() && height.is_finite()) {
            return None;
        }
        let size = if size > 0.0 { size } else { 1.0 };
        // log₁₀ of a fifth of the size, rounded down.
        let digits = (math::log2(size / 5.0) / std::f64::consts::LOG2_10).floor();
        let cell = math::pow(10.0, digits);
        Some(Self {
            height,
            cell,
            close: GroundLines::new(camera, height, cell),
            // Lines at constant x run along z, and conversely.
            colors: [Ground::LINES, Ground::Z_AXIS, Ground::X_AXIS].map(srgb::linear),
        })
    }

    /// The ground at a place of the picture of the camera that it was made for, over a surface at the distance `t`; infinite for none.
    pub(super) fn over(
        &self,
        camera: &Camera,
        (x, y): (f64, f64),
        t: f32,
        under: [f32; 4],
    ) -> [f32; 4] {
        let is_nearer = |distance: f64| f64::from(t) - distance > distance * NEARER;
        let seen = match &self.close {
            Some(close) => close.seen(x, y),
            None => Seen::Uncertain,
        };
        let (coverage, color) = match seen {
            Seen::Nowhere => return under,
            Seen::At {
                along,
                places,
                rates,
            } => {
                // The length costs a square root.
                if t.is_finite() && !is_nearer(along * self.cell * camera.direction(x, y).length())
                {
                    return under;
                }
                self.line(places, rates)
            }
            Seen::Uncertain => match self.intersection(camera, x, y) {
                Some(at) if is_nearer(at.distance) => self.line_at(&at),
                _ => return under,
            },
        };
        over(color, coverage as f32, under)
    }

    /// For eight places of a row of the picture, whether the ground may show: `false` is certain.
    #[inline(always)]
    pub(super) fn may_show(&self, xs: &[f64; LANES], y: f64) -> [bool; LANES] {
        match &self.close {
            Some(close) => close.may_cover_eight(xs, y),
            None => [true; LANES],
        }
    }

    /// Whether the ground surely shows before no point between corners, relative to the eye of a picture whose rays all
    /// begin there.
    ///
    /// Where the eye is above the ground, a ray meets it before a point p only where p is below it: t of p is (height of the
    /// eye over p) / (height of the eye over the ground) of the ground's, at most 1 + 2⁻²³ here. t's rounding to single
    /// precision adds 2⁻²⁴, and both are less than [`NEARER`]. What the eye's own height is rounded by is of no account.
    pub(super) fn is_hidden_by(&self, eye: f64, origin: f64, corners: [DVec3; 3]) -> bool {
        const LOWER: f64 = 1.0 + 1.0 / (1 << 23) as f64;
        const COARSE_EYE: f64 = 1.0 / (1u64 << 26) as f64;
        let down = self.height - (eye + origin);
        let rounded = (eye.abs() + origin.abs() + self.height.abs()) * f64::EPSILON;
        let lowest = down * LOWER;
        let is_before = |corner: DVec3| (corner.y - lowest) * down <= 0.0;
        rounded <= down.abs() * COARSE_EYE && corners.into_iter().all(is_before)
    }

    fn intersection(&self, camera: &Camera, x: f64, y: f64) -> Option<Intersection> {
        // With one eye for all columns: the neighbouring column's eye would move lines by far less than a pixel.
        let seen_at;
        let camera = if camera.has_an_eye_a_column() {
            seen_at = camera.seen_at(x, y);
            &seen_at
        } else {
            camera
        };
        let ray = camera.ray(x, y);
        let distance = (self.height - ray.origin.y) / ray.direction.y;
        if !(distance > 0.0 && distance.is_finite()) {
            return None;
        }
        let steps = if camera.projection().is_parallel() {
            let step = camera.plane().step;
            [camera.right() * step, camera.up() * -step]
        } else {
            let length = distance / camera.direction(x, y).length();
            camera.direction_slopes(x, y).map(|slope| slope * length)
        };
        Some(Intersection {
            distance,
            point: ray.at(distance),
            // Moved along the ray, back to the plane.
            steps: steps.map(|step| step - ray.direction * (step.y / ray.direction.y)),
        })
    }

    /// [`GroundGrid::line`] at an intersection.
    fn line_at(&self, at: &Intersection) -> (f64, Vec3) {
        let rate = |axis: usize| {
            let [right, down] = at.steps.map(|step| step[axis]);
            (right * right + down * down).sqrt() / self.cell
        };
        let places = [at.point.x, at.point.z].map(|place| place / self.cell);
        self.line(places, [rate(0), rate(2)])
    }

    /// The fraction of the pixel that lines cover, and the colour of the line that covers most, at x and z in cells that
    /// change by these rates from pixel to pixel.
    fn line(&self, places: [f64; 2], rates: [f64; 2]) -> (f64, Vec3) {
        let (coverage, number) = most_covering(places, rates);
        (coverage, self.colors[number as usize])
    }

    /// [`GroundGrid::over`] a background of one colour at eight places of a row; `None` where each has to be computed by
    /// itself.
    #[inline(always)]
    pub(super) fn over_eight(
        &self,
        xs: &[f64; LANES],
        y: f64,
        under: [f32; 4],
    ) -> Option<[[f32; 4]; LANES]> {
        let EightSeen {
            places: [at_x, at_z],
            rates: [by_x, by_z],
            is_uncertain,
        } = self.close.as_ref()?.seen_by_eight(xs, y);
        if is_uncertain {
            return None;
        }
        let [mut coverages, mut numbers] = [[0.0; LANES]; 2];
        for lane in 0..LANES {
            let (places, rates) = ([at_x[lane], at_z[lane]], [by_x[lane], by_z[lane]]);
            (coverages[lane], numbers[lane]) = most_covering(places, rates);
        }
        let mut colors = [under; LANES];
        for (lane, color) in colors.iter_mut().enumerate() {
            let line = self.colors[numbers[lane] as usize % 3];
            *color = over(line, coverages[lane] as f32, under);
        }
        Some(colors)
    }
}

/// The fraction of a pixel that is covered by the line that covers most of it, and the number of its colour: 0 of plain
/// lines, 1 of that at x = 0, 2 of that at z = 0. `places` are x and z in cells, and `rates` their changes from pixel to
/// pixel; across one whose rate is not good no line is seen. Without a branch, so that loops over it are vectorised.
#[inline(always)]
fn most_covering(places: [f64; 2], rates: [f64; 2]) -> (f64, f64) {
    let (mut most, mut number) = (0.0, 0.0);
    for (axis, (place, rate)) in places.into_iter().zip(rates).enumerate() {
        let is_good = (rate > 0.0) & (rate < f64::INFINITY) & (place.abs() < WHOLE_LIMIT);
        let inverse = 1.0 / rate;
        // The distance of such lines in cells, their width and opacity.
        for (kind, (cells, width, opacity)) in [
            (1.0, 1.0, FINE),
            (COARSER, 1.0, COARSE),
            (COARSER * COARSER, AXIS_WIDTH, AXIS),
        ]
        .into_iter()
        .enumerate()
        {
            let is_axis = kind == 2;
            let is_there = is_good & (!is_axis | (place.abs() < 0.5));
            let apart = cells * inverse;
            let fade = within((apart - CLOSEST) * (1.0 / (APART - CLOSEST)), 1.0);
            let beside = from_whole(place * (1.0 / cells)).abs() * apart;
            let (reach, full) = reach(width);
            let covered = opacity * (fade * within(reach - beside, full));
            let is_most = is_there & (covered > most);
            most = if is_most { covered } else { most };
            let color = if is_axis { axis as f64 + 1.0 } else { 0.0 };
            number = if is_most { color } else { number };
        }
    }
    (most, number)
}

/// A number from zero to `most`.
#[inline(always)]
fn within(number: f64, most: f64) -> f64 {
    let number = if number > 0.0 { number } else { 0.0 };
    if number < most { number } else { most }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{ImagePlane, Panorama, Pose, Projection};
    use crate::random::Random;
    use crate::scene::{Mesh, MeshData, Object};
    use std::sync::Arc;

    /// A triangle four units long whose lowest point is at −0.5.
    fn scene() -> Scene {
        let mesh = Mesh::new(MeshData {
            positions: vec![
                DVec3::new(-2.0, -0.5, 0.0),
                DVec3::new(2.0, -0.5, 0.0),
                DVec3::new(0.0, 1.0, 1.0),
            ],
            triangles: vec![[0, 1, 2]],
            ..MeshData::default()
        });
        Scene {
            objects: vec![Object::new("triangle", Arc::new(mesh))],
        }
    }

    /// Cameras for which cells are at least 15 pixels wide, so that no line fades.
    fn cameras() -> Vec<Camera> {
        let pose = Pose {
            eye: DVec3::new(0.7, 1.5, 3.0),
            target: DVec3::new(0.1, -0.4, 0.2),
            up: DVec3::Y,
        };
        let plane = ImagePlane::new(600, 400, 0.002).expect("a good plane");
        let panorama = Projection::Panoramic(Panorama::Stereographic);
        [Projection::Perspective, Projection::Orthographic, panorama]
            .map(|projection| Camera::new(pose, projection, plane))
            .into()
    }

    const CLEAR: [f32; 4] = [0.0; 4];

    /// The truth is [`Camera::project`]: where points of lines, and the middles of cells, are seen.
    #[test]
    fn lines_are_where_their_points_are_seen() {
        let mut random = Random(3);
        for (kind, camera) in cameras().into_iter().enumerate() {
            let ground = GroundGrid::new(&scene(), Ground::Lowest, &camera).expect("a ground");
            assert_eq!((ground.height, ground.cell), (-0.5, 0.1));
            let mut seen = 0;
            for _ in 0..2000 {
                let mut cell = || (random.unit() * 14.0).floor() - 7.0;
                let (x, z) = (cell(), cell());
                let along = random.unit();
                let at = |x: f64, z: f64| {
                    let place = camera.project(DVec3::new(x * 0.1, -0.5, z * 0.1));
                    let inside = |&(x, y): &(f64, f64)| {
                        (0.0..600.0).contains(&x) && (0.0..400.0).contains(&y)
                    };
                    let place = place.filter(inside)?;
                    Some(ground.over(&camera, place, f32::INFINITY, CLEAR)[3])
                };
                let least = if x % 10.0 == 0.0 { COARSE } else { FINE } as f32;
                for on_line in [at(x, z + along), at(z + along, x)].into_iter().flatten() {
                    assert!(on_line > least - 1e-4, "{kind}: {on_line} at {x} {z}");
                    seen += 1;
                }
                assert!(at(x + 0.5, z + 0.5).is_none_or(|middle| middle == 0.0));
            }
            assert!(seen > 300, "{kind}: {seen}");
        }
    }

    #[test]
    fn a_line_of_one_pixel_covers_as_much_as_it_is_long() {
        // Straight down: a cell of a tenth is 25 pixels wide.
        let pose = Pose {
            eye: DVec3::new(0.03, 2.0, 0.04),
            target: DVec3::new(0.03, -0.5, 0.04),
            up: DVec3::Z,
        };
        let plane = ImagePlane::new(250, 250, 0.004).expect("a good plane");
        let camera = Camera::new(pose, Projection::Orthographic, plane);
        let ground = GroundGrid::new(&scene(), Ground::At(-0.2), &camera).expect("a ground");
        let mut sum = 0.0;
        for y in 145..195 {
            for x in 10..110 {
                let place = (f64::from(x) + 0.5, f64::from(y) + 0.5);
                sum += f64::from(ground.over(&camera, place, f32::INFINITY, CLEAR)[3]);
            }
        }
        // Two lines of 100 pixels and four of 50, which cross at eight pixels.
        let expected = FINE * (2.0 * 100.0 + 4.0 * 50.0 - 8.0);
        assert!((sum / expected - 1.0).abs() < 0.05, "{sum} {expected}");
    }

    /// From near and far, close to the horizon and straight down.
    #[test]
    fn no_line_covers_what_is_said_to_be_bare() {
        let mut random = Random(17);
        let [mut covered, mut compared, mut bare, mut unknown] = [0; 4];
        for _ in 0..400 {
            let far = math::pow(10.0, random.signed() * 7.0);
            let target = random.point() * math::pow(10.0, random.signed() * 3.0);
            let target = DVec3::new(target.x, -0.5, target.z);
            let flat = if random.unit() < 0.5 { 1.0 } else { 0.01 };
            let toward = random.point() * DVec3::new(1.0, flat, 1.0);
            let pose = Pose {
                eye: target + toward * far,
                target,
                up: random.point(),
            };
            let step = far * 0.003 * math::pow(10.0, random.signed());
            let plane = ImagePlane::new(600, 400, step).expect("a good plane");
            let projection = match random.unit() < 0.5 {
                true => Projection::Perspective,
                false => Projection::Orthographic,
            };
            let camera = Camera::new(pose, projection, plane);
            let ground = GroundGrid::new(&scene(), Ground::Lowest, &camera).expect("a ground");
            let Some(close) = ground.close else {
                unknown += 1;
                continue;
            };
            for _ in 0..500 {
                let (x, y) = (random.unit() * 600.0, random.unit() * 400.0);
                let at = ground.intersection(&camera, x, y);
                let coverage = at.map_or(0.0, |at| ground.line_at(&at).0);
                if let Seen::At { places, rates, .. } = close.seen(x, y) {
                    let coverage_seen = ground.line(places, rates).0;
                    assert!(
                        (coverage_seen - coverage).abs() < 1e-3,
                        "{camera:?} {x} {y}"
                    );
                    compared += u32::from(coverage > 0.0);
                }
                if close.may_cover_eight(&[x; LANES], y)[0] {
                    covered += u32::from(coverage > 0.0);
                } else {
                    assert_eq!(coverage, 0.0, "{camera:?} {x} {y}");
                    bare += 1;
                }
            }
        }
        assert!(compared > 5000, "{compared} of {covered}");
        assert!(
            covered > 5000 && bare > 100_000,
            "{covered} {bare} {unknown}"
        );
    }

    #[test]
    fn eight_places_show_what_each_shows() {
        let mut random = Random(29);
        // With cells 10⁷ pixels wide, places are rounded by too much.
        let plane = ImagePlane::new(600, 400, 2e-9).expect("a good plane");
        let close_up = Camera::new(cameras()[0].pose(), Projection::Perspective, plane);
        // Above the horizon rays meet the ground behind the eye.
        let pose = Pose {
            eye: DVec3::new(0.7, 1.5, 3.0),
            target: DVec3::new(0.1, 1.4, 0.2),
            up: DVec3::Y,
        };
        let level = Camera::new(pose, Projection::Perspective, cameras()[0].plane());
        let [mut lines, mut uncertain] = [0; 2];
        for camera in cameras().into_iter().chain([close_up, level]) {
            let ground = GroundGrid::new(&scene(), Ground::Lowest, &camera).expect("a ground");
            for _ in 0..20_000 {
                let (x, y) = (random.unit() * 590.0, random.unit() * 400.0);
                let xs = std::array::from_fn(|lane| x + lane as f64 * 1.2);
                let under = [0.2, 0.4, 0.1, random.unit() as f32];
                let eight = ground.over_eight(&xs, y, under);
                let Some(close) = &ground.close else {
                    assert_eq!(eight, None);
                    continue;
                };
                let is_uncertain = |&x: &f64| matches!(close.seen(x, y), Seen::Uncertain);
                assert_eq!(eight.is_none(), xs.iter().any(is_uncertain));
                uncertain += u32::from(eight.is_none());
                for (x, found) in xs.into_iter().zip(eight.into_iter().flatten()) {
                    assert_eq!(found, ground.over(&camera, (x, y), f32::INFINITY, under));
                    lines += u32::from(found != under);
                }
            }
        }
        assert!(lines > 10_000 && uncertain > 10_000, "{lines} {uncertain}");
    }

    #[test]
    fn what_is_nearer_or_on_the_ground_hides_it() {
        for camera in cameras() {
            let ground = GroundGrid::new(&scene(), Ground::Lowest, &camera).expect("a ground");
            let point = DVec3::new(0.3, -0.5, 0.6);
            let place = camera.project(point).expect("in the picture");
            let distance = ground
                .intersection(&camera, place.0, place.1)
                .expect("the ray meets the ground")
                .distance;
            let shown = |t: f64| ground.over(&camera, place, t as f32, CLEAR)[3] > 0.0;
            assert!(!shown(distance * 0.9) && !shown(distance));
            assert!(shown(distance * 1.001) && shown(f64::INFINITY));
        }
    }

    #[test]
    fn rays_along_the_ground_and_eyes_in_it_see_none() {
        let plane = ImagePlane::new(3, 3, 0.1).expect("a good plane");
        let pose = Pose {
            eye: DVec3::new(0.0, -0.5, 3.0),
            target: DVec3::new(0.0, -0.5, 0.0),
            up: DVec3::Y,
        };
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let camera = Camera::new(pose, projection, plane);
            let ground = GroundGrid::new(&scene(), Ground::Lowest, &camera).expect("a ground");
            for place in [(1.5, 1.5), (0.5, 1.5), (1.5, 0.5), (2.5, 2.5)] {
                assert_eq!(ground.over(&camera, place, f32::INFINITY, CLEAR), CLEAR);
            }
        }
        let camera = cameras()[0];
        assert!(GroundGrid::new(&Scene::default(), Ground::Lowest, &camera).is_none());
    }

    #[test]
    fn a_ground_is_written_as_it_is_read() {
        for ground in [Ground::Lowest, Ground::At(-0.1), Ground::At(1e18)] {
            assert_eq!(ground.to_string().parse(), Ok(ground));
        }
        for text in ["", "low", "nan", "1e19", "inf"] {
            assert!(text.parse::<Ground>().is_err(), "{text}");
        }
    }
}
