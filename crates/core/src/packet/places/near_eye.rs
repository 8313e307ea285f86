//! Places of rays from far away, as they pass an eye close to the scene.
//!
//! From far away rays are closer together than roundings of their directions, or of their origins, and corners
//! relative to their eye are rounded by more than triangles' sizes. But close to the scene each ray is known
//! (`triangle/close_start`), and next to parallel to all others. So a packet sees the scene from a **near eye**, at most
//! [`DISTANCE`] lengths of the scene in front of it; a ray's place is where it passes the scene, seen from there.
//!
//! # Error bound
//! One ray of a packet is followed to a point P₀ close to the scene, in double-double arithmetic. Other rays pass the
//! plane through P₀ square to the view axis: from the same eye at P₀ + s₀/a·(a₀δ − (x·δ)d₀), with d₀ the known ray's
//! direction, d₀ + δ the other's, s₀ the parameter of P₀, x the row of the map to the view axis, and a₀ and a their
//! products with both directions; along the same direction, from an origin moved by m, at P₀ + m − (x·m)d₀/a₀.
//! Differences of neighbours are rounded by ε of themselves at most, and all other operations are no more than
//! thirty: P is off by P₀'s error and 32ε(|s₀||δ| + |m|)/a a coordinate.
//!
//! With v = P − N a ray's direction from the near eye N, f its part along the view axis, and t the tangents of v, its
//! place: a hit at a depth w behind P is seen in direction (f·t + w·t′)/(f + w), where t′ are the tangents of the ray's
//! own direction. That is w·(t′ − t)/(f + w) beside the place. All of the scene is within √3/2 of its length L from its
//! centre: |w| < [`DEEPEST`]·L plus the depth of P₀ from it. Where P is off by e a coordinate, t moves by less
//! than 4e/f, as it is below one (untested, because dominated). These are how far off places are beside ([`Places`]). v
//! is rounded by ε|v|, and the map's rows, products and quotients by less than sixty more: a thirtieth of
//! [`PLACE_ERROR`](super::PLACE_ERROR).
//!
//! # What holds for the rays
//! A ray that hits a triangle is within this of the one from N to the hit. Where all rays from N that are this close
//! to a ray's place hit a triangle, the ray hits it, and crosses its plane the way they do: on its way through the
//! scene it is seen in these directions, first before the triangle and in the end behind it. So orders by the planes
//! of sure hits, the only ones asked for (`plane_order`), are its own; and hits along it are in the order of their
//! depths. But it may see another side than N does of a triangle that it does not surely hit.

use super::{Fit, MOST_TANGENT, PLACE_ERROR, Places, extremes, fill};
use crate::bvh::Accel;
use crate::camera::{Camera, Lattice, Projection};
use crate::hit::{Cull, Precision};
use crate::num::choice::greater;
use crate::num::roundoff::EPSILON;
use crate::num::simd::Lanes;
use crate::packet::frustum::Window;
use crate::packet::params::SIDE;
use crate::ray::{Ray, relative_origin};
use crate::triangle::PreparedRay;
use glam::DVec3;

/// The distance of the scene from an eye, in columns of its rays, from which on packets see it from a near eye: 2⁴⁰.
/// Corners' roundings are a column for triangles of a few columns here (64·72ε, see `setup`): from further away, most
/// triangles are set up twice, and soon rays that needles are next to are undecided. From nearer, packets of the lattice
/// itself decide most rays, and need not compute each of them.
const FAR: f64 = (1u64 << 40) as f64;

/// The distance of the near eye from the scene, in its lengths: 2²¹. With a greater one errors of places grow, and
/// with them those of edge functions; with a lesser one those of next to parallel rays, seen from one point. Both are
/// 2⁻²¹ of the columns that the scene takes up.
const DISTANCE: f64 = (1u64 << 21) as f64;

/// The least distance of a near eye from the scene, in its lengths, which is the best one where a column is 2⁻³⁰ of the
/// scene. A greater one is worse for smaller columns; a lesser one would have to be above two, so that the whole scene lies
/// in front of the eye.
const LEAST_DISTANCE: f64 = (1u64 << 8) as f64;

/// From d lengths of the scene, where a column is a share c of it, places are off by [`PLACE_ERROR`]·εd/c columns by
/// rounding, and by half a packet's columns over d as rays are next to parallel: the ratio of the two for d and c of one.
const ERROR_RATIO: f64 = PLACE_ERROR * EPSILON / (SIDE as f64 * 0.5);

/// More than the distance of a point of the scene from its centre, in lengths of the scene: √3/2, and a thirtieth of it
/// for roundings and for axes that are not perpendicular.
const DEEPEST: f64 = 0.9;

/// The least extent of a packet's places, as tangents: 2⁻³¹. Rays that are closer are one except for rounding; with a
/// lesser extent, places would be off by more than a sixtieth of a column.
const LEAST_EXTENT: f64 = 1.0 / (1u64 << 31) as f64;

/// An eye close to a scene, in front of it.
#[derive(Clone, Copy, Debug)]
pub(in crate::packet) struct NearEye {
    /// Relative to the point that corners are relative to; exact, as any point would be correct.
    pub(in crate::packet) eye: DVec3,
    /// L.
    length: f64,
    /// Its depth in front of the scene's centre.
    distance: f64,
    /// The camera's: to the right, up and forward.
    axes: [DVec3; 3],
    /// The rows of the map from world space to these axes, which need not be perpendicular except for rounding.
    map: [DVec3; 3],
}

impl NearEye {
    /// One for a lattice whose rays see the scene from [`FAR`] away; `None` for others.
    pub(in crate::packet) fn of(accel: &Accel, lattice: &Lattice) -> Option<Self> {
        let bounds = accel.tree.bounds.corners();
        let (eye, _) = relative_origin(lattice.camera.pose().eye, accel.origin);
        let near = Self::before(bounds, eye, &lattice.camera)?;
        let (right, bottom) = (
            lattice.columns.checked_sub(1)?,
            lattice.rows.checked_sub(1)?,
        );
        let pass = |(column, row)| {
            let ray = lattice.ray(column, row);
            let ray = accel.prepare(&ray, Cull::None, Precision::Exact)?;
            near.pass(&ray)
        };
        let [first, middle, last] = [(0, 0), (right / 2, bottom / 2), (right, bottom)].map(pass);
        let columns = f64::from(right.max(bottom).max(1));
        Some(near.before_rays([first?, middle?, last?].map(|ray| ray.from_eye), columns))
    }

    /// One before the point where a lattice's middle ray passes the scene, from where errors of its packets are least.
    /// Given are the points, from this eye, where its first, its middle and its last ray pass, which are so many columns
    /// apart. Where the middle ray passes beside the scene, this one.
    fn before_rays(self, points: [DVec3; 3], columns: f64) -> Self {
        let [first, middle, last] = points.map(|point| self.map.map(|row| row.dot(point)));
        let [right, up, _] = middle;
        if greater(right.abs(), up.abs()) > self.length {
            return self;
        }
        let extent = greater((last[0] - first[0]).abs(), (last[1] - first[1]).abs());
        // The sum of both errors is least where they are equal.
        let share = extent / (columns * self.length);
        let lengths = (share / ERROR_RATIO).sqrt();
        let distance = lengths.clamp(LEAST_DISTANCE, DISTANCE) * self.length;
        let [to_right, to_up, forward] = self.axes;
        Self {
            eye: self.eye + to_right * right + to_up * up + forward * (self.distance - distance),
            distance,
            ..self
        }
    }

    /// One before a box, for a camera whose eye relative to the box's frame is this.
    fn before([min, max]: [DVec3; 2], eye: DVec3, camera: &Camera) -> Option<Self> {
        let length = (max - min).max_element();
        let centre = (min + max) * 0.5;
        let to_scene = centre - eye;
        let depth = to_scene.dot(camera.forward());
        let distance = match camera.projection() {
            Projection::Perspective => camera.distance(),
            Projection::Orthographic => depth,
            Projection::Panoramic(_) => return None,
        };
        let is_far = distance > FAR * camera.plane().step && depth > 2.0 * DISTANCE * length;
        // Numbers are no NaN: a camera's are finite, as corners are. Twice as far aside as in front, and a packet's
        // rays are oblique to its axis.
        let is_ahead = depth > 0.5 * to_scene.length();
        let axes @ [right, up, forward] = [camera.right(), camera.up(), camera.forward()];
        let volume = right.dot(up.cross(forward));
        (is_far && is_ahead && length > 0.0).then(|| Self {
            eye: centre - forward * (DISTANCE * length),
            length,
            distance: DISTANCE * length,
            axes,
            map: [0, 1, 2].map(|axis| axes[(axis + 1) % 3].cross(axes[(axis + 2) % 3]) / volume),
        })
    }

    /// What is known of a ray close to the scene; `None` where it is not followed from there.
    pub(in crate::packet) fn pass(&self, ray: &PreparedRay) -> Option<PassingRay> {
        let from_eye = ray.start - self.eye;
        let axis = self.map[2];
        Some(PassingRay {
            ray: ray.ray,
            parameter: ray.skipped?.high,
            along: axis.dot(ray.ray.direction),
            from_eye,
            error: ray.start_error,
            depth: DEEPEST * self.length + (axis.dot(from_eye) - self.distance).abs(),
        })
    }

    /// The tangents of a ray's place, and how far off they are, which is infinite where nothing is known. `known` is a
    /// ray from the same eye or of the same direction.
    #[inline(always)]
    fn place(&self, known: &PassingRay, ray: &Ray) -> [f64; 3] {
        let axis = self.map[2];
        let PassingRay {
            ray: other,
            parameter,
            depth,
            ..
        } = *known;
        let turned = ray.direction - other.direction;
        let moved = ray.origin - other.origin;
        let along = axis.dot(ray.direction);
        let by_turning = turned * known.along - other.direction * axis.dot(turned);
        let by_moving = moved - other.direction * (axis.dot(moved) / known.along);
        let point = known.from_eye + by_turning * (parameter / along) + by_moving;
        let [right, up, forward] = self.map.map(|row| row.dot(point));
        let place = [right / forward, up / forward];
        let slope =
            |row: usize, place: f64| (self.map[row].dot(ray.direction) / along - place).abs();
        let slope = greater(slope(0, place[0]), slope(1, place[1]));
        let reach = turned.abs().max_element() * parameter.abs() + moved.abs().max_element();
        let error = known.error + 32.0 * EPSILON * reach / along;
        let off = depth * slope / (forward - depth) + 4.0 * error / forward;
        let is_known = (forward > 2.0 * depth) & (along > 0.0);
        [
            place[0],
            place[1],
            if is_known { off } else { f64::INFINITY },
        ]
    }
}

/// A ray as it passes a near eye.
#[derive(Clone, Copy, Debug)]
pub(in crate::packet) struct PassingRay {
    ray: Ray,
    /// Its parameter at a point close to the scene.
    parameter: f64,
    /// Its direction along the view axis.
    along: f64,
    /// From the near eye to that point, off by at most `error` a coordinate.
    from_eye: DVec3,
    error: f64,
    /// The greatest depth of the scene before or behind that point.
    depth: f64,
}

impl Places {
    /// Computes the places of a packet of at most [`SIDE`] × [`SIDE`] rays as they pass a near eye. `known` is one of
    /// them; `ray` gives all, by column and row.
    #[inline(always)]
    pub(in crate::packet) fn find_from_near(
        &mut self,
        lanes: impl Lanes,
        (camera, near, known): (&Camera, &NearEye, &PassingRay),
        (columns, rows): (u32, u32),
        ray: impl Fn(u32, u32) -> Ray,
    ) -> Fit {
        (self.columns, self.rows_of_rays) = (columns, rows);
        self.beside = 0.0;
        self.has_ray = [0; SIDE];
        for row in 0..rows.min(SIDE as u32) {
            self.has_ray[row as usize] = u32::MAX >> (SIDE as u32 - columns.clamp(1, SIDE as u32));
            for column in 0..columns.min(SIDE as u32) {
                let [across, along, beside] = near.place(known, &ray(column, row));
                let at = row as usize * SIDE + column as usize;
                (self.directions[0][at], self.directions[1][at]) = (across, along);
                self.beside = greater(beside, self.beside);
            }
        }
        if self.beside == f64::INFINITY {
            return Fit::Wide;
        }
        let [x, y, _] = &mut self.directions;
        fill(&self.has_ray, 0, [x, y]);
        let (across, along) = (extremes(x), extremes(y));
        let furthest = greater(greater(-across.0, across.1), greater(-along.0, along.1));
        if furthest > MOST_TANGENT {
            return Fit::Wide;
        }
        self.view = camera.unit_perspective();
        let extent = greater(across.1 - across.0, along.1 - along.0);
        let lacking = greater(LEAST_EXTENT - extent, 0.0);
        self.window = Window { across, along }.grown(0.5 * lacking);
        self.place();
        self.bound(lanes);
        Fit::Packet
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{ImagePlane, Pose};
    use crate::hit::{Cull, Precision};
    use crate::num::double_double::DoubleDouble;
    use crate::random::Random;

    /// Points of rays within the scene's box, in double-double arithmetic, seen from the near eye. With the error at
    /// zero this fails, and with axes of the camera that are taken to be perpendicular.
    #[test]
    fn rays_pass_the_scene_at_their_places() {
        let mut random = Random(95);
        let mut most = 0.0f64;
        for round in 0..2000 {
            let length = random.decades(-20.0, 20.0);
            let half = DVec3::splat(length * 0.5);
            let centre = random.point() * length;
            let bounds = [centre - half, centre + half];
            let towards = random.point().normalize();
            let away = length * random.decades(12.4, 16.0);
            let eye = centre + random.point() * length - towards * away;
            // Next to the view axis, so that the camera's axes are not perpendicular within a few roundings.
            let up = match round % 2 {
                0 => towards + random.point() * 1e-7,
                _ => random.point(),
            };
            let pose = Pose {
                eye,
                target: eye + towards * away,
                up,
            };
            let projection = [Projection::Perspective, Projection::Orthographic][round / 2 % 2];
            // The whole scene, or a part of it.
            let magnified = [1.0, random.decades(-6.0, 0.0)][round / 4 % 2];
            let plane = ImagePlane::new(32, 32, length / 16.0 * magnified).expect("a good plane");
            let camera = Camera::new(pose, projection, plane);
            let near = NearEye::before(bounds, eye, &camera).expect("a scene far away");
            let (x, y) = (random.unit() * 32.0, random.unit() * 32.0);
            let ray = camera.ray(x, y);
            let prepare = |ray: &Ray| {
                PreparedRay::new(ray, DVec3::ZERO, Cull::None, Precision::Exact)
                    .expect("a valid ray")
                    .close_to(bounds)
            };
            let prepared = prepare(&ray);
            let pass = |near: &NearEye, (x, y)| {
                let ray = prepare(&camera.ray(x, y));
                near.pass(&ray).expect("a ray from far away")
            };
            let points = [(0.5, 0.5), (16.0, 16.0), (31.5, 31.5)];
            let points = points.map(|place| pass(&near, place).from_eye);
            let near = near.before_rays(points, 31.0);
            let known = pass(&near, (random.unit() * 32.0, random.unit() * 32.0));
            let [across, along, off] = near.place(&known, &ray);
            let closest = prepared.skipped.expect("a start close to the scene");
            let parameter = closest + (random.signed() * 0.87 * length).into();
            let at = [0, 1, 2].map(|axis| {
                let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
                DoubleDouble::from(origin) + parameter * direction.into()
            });
            let point = DVec3::from(at.map(|at| at.high));
            if (point - centre).abs().max_element() > length * 0.5 {
                continue;
            }
            let rows = [camera.right(), camera.up(), camera.forward()];
            let seen = at.map(|at| at.high);
            let seen = [0, 1, 2].map(|axis| {
                let rest = DoubleDouble::from(seen[axis]) - near.eye[axis].into();
                rest + at[axis].low.into()
            });
            let [right, up, forward] = coordinates(rows, seen);
            for (place, part) in [(across, right), (along, up)] {
                let rest = (part - forward * place.into()).high / forward.high;
                let rounding = 64.0 * f64::EPSILON;
                assert!(rest.abs() <= off + rounding, "{rest} {off} {prepared:?}");
                most = most.max((rest.abs() - rounding) / off);
            }
        }
        assert!(most > 0.4, "{most}");
    }

    /// A vector in terms of three others, but for a factor: by Cramer's rule.
    fn coordinates([a, b, c]: [DVec3; 3], v: [DoubleDouble; 3]) -> [DoubleDouble; 3] {
        let product = |p: f64, q: f64| DoubleDouble::from(p) * q.into();
        let dot = |p: DVec3, q: DVec3| {
            let minor = |i: usize, j: usize| product(p[i], q[j]) - product(p[j], q[i]);
            v[0] * minor(1, 2) + v[1] * minor(2, 0) + v[2] * minor(0, 1)
        };
        [dot(b, c), dot(c, a), dot(a, b)]
    }
}
