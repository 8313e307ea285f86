//! Triangles exactly edge-on to a camera: decided once for all its rays.

use super::componentwise::{plane_crosses, plane_misses};
use super::exact::{OffsetTriangle, plane_contains, plane_is_parallel};
use super::wide_determinants::eye_distance;
use crate::camera::{Camera, Projection};
use crate::hit::MISS;
use glam::{DVec3, Vec3};

/// Triangles in the cache at first: 2 kB, indexed by the low bits of the primitive index. Triangles with the same bits
/// evict one another: fewer entries decide triangles again, more push the packet out of the first-level cache.
const CACHED: usize = 256;

/// The most triangles in the cache, 512 kB, which doubles when as many triangles were evicted as it has room for: where
/// thousands lie in planes through the eye, deciding them again for each packet takes longer than reading memory.
const MOST_CACHED: usize = 1 << 16;

/// What all rays of a camera have in common.
#[derive(Clone, Copy, Debug)]
enum Shared {
    /// Their origin.
    Eye(DVec3),
    /// Their direction, and the plane that their origins lie in, where that is axis-aligned.
    Direction(DVec3, Option<Level>),
}

/// A coordinate that the origins of all rays have exactly, where the image plane is perpendicular to an axis.
#[derive(Clone, Copy, Debug)]
struct Level {
    axis: usize,
    coordinate: f64,
    /// Whether rays run towards greater coordinates.
    ascends: bool,
}

impl Level {
    /// An origin is eye + right · across + up · along, so a coordinate in which `right` and `up` are zero is the
    /// eye's.
    fn of(camera: &Camera) -> Option<Self> {
        let (right, up) = (camera.right(), camera.up());
        let axis = (0..3).find(|&axis| right[axis] == 0.0 && up[axis] == 0.0)?;
        Some(Self {
            axis,
            coordinate: camera.pose().eye[axis],
            ascends: camera.forward()[axis] > 0.0,
        })
    }

    /// Whether a point lies at the level or on the side that rays come from. Its coordinate is `tree_origin` +
    /// `relative`.
    fn is_not_before(self, tree_origin: f64, relative: f32) -> bool {
        let relative = f64::from(relative);
        let sum = tree_origin + relative;
        // The rounding error of the sum (Knuth's two-sum). Rounding is monotone: unless the rounded sum equals the
        // level, the exact sum is on the same side of it.
        let added = sum - tree_origin;
        let rest = (tree_origin - (sum - added)) + (relative - added);
        let above = if sum == self.coordinate {
            rest
        } else {
            sum - self.coordinate
        };
        if self.ascends {
            above <= 0.0
        } else {
            above >= 0.0
        }
    }
}

/// Decides which triangles no ray of a camera hits because all rays start in their plane, or are parallel to it.
///
/// Every hit of a ray from an eye has the parameter det(A, B, C) / (d·n), with A, B, C the corners relative to the
/// eye. Where the plane contains the eye the determinant is zero for every direction: all hits are at t = 0, and
/// camera rays hit t > 0 only. Where rays share a direction d and d·n is zero, the three weights sum to zero: they
/// differ in sign or are all zero, and there is no hit. Where parallel rays start at one level of an axis, they hit
/// nothing at that level or behind it: such a hit would have t ≤ 0.
#[derive(Debug)]
pub(crate) struct EdgeOn {
    shared: Shared,
    /// The point that corners are relative to.
    tree_origin: DVec3,
    /// Primitive indices, and whether each is edge-on: none before the first query, then as many as a power of
    /// two.
    decided: Vec<(u32, bool)>,
    /// How many were evicted since the cache last grew.
    evicted: usize,
    /// What was decided last.
    last: bool,
}

impl EdgeOn {
    pub(crate) fn new(camera: &Camera, tree_origin: DVec3) -> Self {
        let shared = match camera.projection() {
            Projection::Perspective | Projection::Panoramic(_) => Shared::Eye(camera.pose().eye),
            Projection::Orthographic => Shared::Direction(camera.forward(), Level::of(camera)),
        };
        Self {
            shared,
            tree_origin,
            decided: Vec::new(),
            evicted: 0,
            last: false,
        }
    }

    /// Whether no ray hits the triangle for one of these reasons.
    #[inline(never)]
    pub(crate) fn is(&mut self, primitive: u32, corners: [Vec3; 3]) -> bool {
        if self.decided.is_empty() {
            self.decided.resize(CACHED, (MISS, false));
        }
        let at = self.entry(primitive);
        let (stored, is) = self.decided[at];
        if stored == primitive {
            return is;
        }
        let is = self.decide(corners);
        self.last = is;
        self.decided[at] = (primitive, is);
        if stored != MISS {
            self.evicted += 1;
            if self.evicted > self.decided.len() && self.decided.len() < MOST_CACHED {
                self.grow();
            }
        }
        is
    }

    /// Whether the triangle that was decided last is edge-on.
    #[inline(always)]
    pub(crate) fn was_last(&self) -> bool {
        self.last
    }

    /// Whether the triangle is known to be edge-on.
    #[inline(always)]
    pub(crate) fn is_known(&self, primitive: u32) -> bool {
        self.decided.get(self.entry(primitive)) == Some(&(primitive, true))
    }

    fn entry(&self, primitive: u32) -> usize {
        primitive as usize & self.decided.len().wrapping_sub(1)
    }

    /// Doubles the cache.
    fn grow(&mut self) {
        let doubled = vec![(MISS, false); 2 * self.decided.len()];
        for (primitive, is) in std::mem::replace(&mut self.decided, doubled) {
            if primitive != MISS {
                let at = self.entry(primitive);
                self.decided[at] = (primitive, is);
            }
        }
        self.evicted = 0;
    }

    fn decide(&self, corners: [Vec3; 3]) -> bool {
        let in_double = corners.map(Vec3::as_dvec3);
        match self.shared {
            Shared::Eye(eye) => {
                let rounded = eye - self.tree_origin;
                // In units of ε; zero where nothing is subtracted, and so nothing is rounded.
                let off = if self.tree_origin == DVec3::ZERO {
                    0.0
                } else {
                    rounded.abs().max_element()
                };
                let misses = plane_misses(in_double, rounded, off);
                let placed = OffsetTriangle {
                    corners,
                    origin: self.tree_origin,
                };
                let misses = misses.or_else(|| {
                    let distance = eye_distance(eye, &placed)?;
                    distance.signum().map(|sign| sign != 0)
                });
                !misses.unwrap_or_else(|| !plane_contains(eye, &placed))
            }
            Shared::Direction(direction, level) => {
                let is_not_before = level.is_some_and(|level| {
                    let tree_origin = self.tree_origin[level.axis];
                    let mut relative = corners.iter().map(|corner| corner[level.axis]);
                    relative.all(|relative| level.is_not_before(tree_origin, relative))
                });
                let crosses = || plane_crosses(direction, in_double);
                is_not_before
                    || !crosses().unwrap_or_else(|| !plane_is_parallel(direction, corners))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{ImagePlane, Pose};
    use crate::random::Random;

    fn camera(eye: DVec3, target: DVec3, projection: Projection) -> Camera {
        let plane = ImagePlane::new(8, 8, 0.1).expect("a good plane");
        let up = DVec3::Y;
        Camera::new(Pose { eye, target, up }, projection, plane)
    }

    /// Triangles with the eye at a corner, on an edge, elsewhere in the plane, and next to the plane.
    #[test]
    fn planes_through_the_eye_are_decided_exactly() {
        let eye = DVec3::new(0.75, -2.5, 3.0);
        let (u, v) = (DVec3::new(0.5, 0.25, 4.0), DVec3::new(-1.0, 3.0, 0.125));
        for tree_origin in [DVec3::ZERO, DVec3::new(4096.0, -64.0, 0.5)] {
            let placed = [
                [DVec3::ZERO, u, v],
                [-u, u, v],
                [u, v, u * 2.0 + v * 4.0],
                [u, v, u.cross(v).round()],
            ];
            for (at, corners) in placed.into_iter().enumerate() {
                let corners = corners.map(|c| (eye + c).as_vec3());
                for next in [false, true] {
                    let x = tree_origin.x + eye.x;
                    let x = if next { x.next_up() } else { x };
                    let eye = (tree_origin + eye).with_x(x);
                    let camera = camera(eye, eye + DVec3::ONE, Projection::Perspective);
                    let mut edge_on = EdgeOn::new(&camera, tree_origin);
                    let expected = at < 3 && !next;
                    assert_eq!(
                        edge_on.is(7, corners),
                        expected,
                        "{at} {next} {tree_origin}"
                    );
                    assert_eq!(edge_on.is(7, corners), expected);
                    // A triangle that shares the entry of the cache.
                    let other = [Vec3::X * 50.0, Vec3::Y * 50.0, Vec3::Z * 50.0];
                    assert!(!edge_on.is(7 + CACHED as u32, other));
                    assert_eq!(edge_on.is(7, corners), expected);
                }
            }
        }
    }

    /// Thousands of triangles, of which every third is edge-on, each queried many times: what is known is right, and
    /// after some rounds all of them are known.
    #[test]
    fn many_triangles_through_the_eye_are_decided_once() {
        let camera = camera(DVec3::ZERO, DVec3::ONE, Projection::Perspective);
        let mut edge_on = EdgeOn::new(&camera, DVec3::ZERO);
        let corners = |primitive: u32| {
            let z = if primitive.is_multiple_of(3) {
                0.0
            } else {
                1.0
            };
            [Vec3::X, Vec3::Y, Vec3::new(-1.0, -1.0, 0.0)].map(|corner| corner.with_z(z))
        };
        let all = 0..3000u32;
        for round in 0..20 {
            for primitive in all.clone() {
                let expected = primitive.is_multiple_of(3);
                assert!(expected || !edge_on.is_known(primitive));
                assert_eq!(edge_on.is(primitive, corners(primitive)), expected);
                assert!(round > 0 || edge_on.was_last() == expected);
            }
        }
        assert!(
            all.clone()
                .all(|primitive| edge_on.is_known(primitive) == primitive.is_multiple_of(3))
        );
        assert_eq!(edge_on.decided.len(), 4096);
        for primitive in 0..1 << 20 {
            edge_on.is(primitive, corners(primitive));
        }
        assert_eq!(edge_on.decided.len(), MOST_CACHED);
    }

    /// The plane contains the eye, but not the eye's rounded position relative to the tree's origin.
    #[test]
    fn an_eye_that_rounding_moves_off_a_plane_is_in_it() {
        let (tree_origin, eye) = (DVec3::X * 4096.0, DVec3::new(0.1, 0.1, 0.25));
        // In world space all corners have x = y.
        let corners = [[0.0, -3.0], [4.0, -2.0], [1.0, 5.0]];
        let corners = corners.map(|[y, z]: [f32; 2]| Vec3::new(y - 4096.0, y, z));
        let rounded = eye - tree_origin;
        assert_ne!(rounded.x + 4096.0, rounded.y);
        let in_double = corners.map(Vec3::as_dvec3);
        assert_eq!(plane_misses(in_double, rounded, 0.0), Some(true));
        let camera = camera(eye, DVec3::ZERO, Projection::Perspective);
        assert!(EdgeOn::new(&camera, tree_origin).is(0, corners));
    }

    #[test]
    fn planes_along_the_rays_are_decided_exactly() {
        let along = camera(DVec3::Z * 5.0, DVec3::ZERO, Projection::Orthographic);
        let mut edge_on = EdgeOn::new(&along, DVec3::ZERO);
        let (a, b) = (Vec3::new(0.1, 0.2, 0.3), Vec3::new(0.1, -7.0, 1e-9));
        assert!(edge_on.is(0, [a, b, a + Vec3::Z]));
        assert!(edge_on.is(1, [a, b, b.with_z(3e8)]));
        assert!(!edge_on.is(2, [a, b, b.with_x(b.x.next_up())]));
    }

    /// Planes that are parallel to a direction, exactly or except for the rounding of one corner. The truth is
    /// integer arithmetic.
    #[test]
    fn what_double_precision_decides_about_parallel_planes_is_what_integers_decide() {
        let mut random = Random(67);
        let (mut sure, mut along) = (0, 0);
        for _ in 0..20_000 {
            let [a, b] = [(); 2].map(|()| random.point().as_vec3());
            let direction = random.point();
            let to_c = (b - a).as_dvec3() * random.signed() + direction * random.signed();
            let c = (a.as_dvec3() + to_c).as_vec3();
            // In the plane's span except for roundings in double precision.
            let [to_b, to_c] = [b, c].map(|corner| corner.as_dvec3() - a.as_dvec3());
            let direction = to_b * random.signed() + to_c * random.signed();
            let is_along = plane_is_parallel(direction, [a, b, c]);
            let crosses = plane_crosses(direction, [a, b, c].map(Vec3::as_dvec3));
            assert!(crosses.is_none_or(|crosses| crosses != is_along));
            sure += usize::from(crosses.is_some());
            along += usize::from(is_along);
        }
        assert!(sure < 20_000 && along < 20_000, "{sure} {along}");
    }

    /// Planes that parallel rays run along except for roundings in double precision: what those leave undecided is
    /// decided exactly. The truth is integer arithmetic.
    #[test]
    fn planes_nearly_along_the_rays_are_decided_exactly() {
        let mut random = Random(68);
        let mut undecided = 0;
        for _ in 0..4000 {
            let corners = [(); 3].map(|()| random.point().as_vec3());
            let [a, b, c] = corners.map(Vec3::as_dvec3);
            let way = (b - a) * random.signed() + (c - a) * random.signed();
            let camera = camera(a, a + way, Projection::Orthographic);
            let forward = camera.forward();
            let is_along = plane_is_parallel(forward, corners);
            undecided += usize::from(!is_along && plane_crosses(forward, [a, b, c]).is_none());
            let mut edge_on = EdgeOn::new(&camera, DVec3::ZERO);
            assert_eq!(edge_on.is(0, corners), is_along, "{corners:?} {forward}");
        }
        assert!(undecided > 1000, "{undecided}");
    }

    #[test]
    fn triangles_at_or_behind_the_image_plane_are_decided_exactly() {
        for (tree_origin, height) in [(0.0, 3.0), (4096.0, 0.1), (1_000_000.1, 0.3)] {
            let (tree_origin, up) = (DVec3::Z * tree_origin, DVec3::Z * f64::from(height as f32));
            let triangle = |z: f32| {
                [
                    Vec3::new(1.0, 2.0, z),
                    Vec3::new(-1.0, 0.5, z),
                    Vec3::new(7.0, -1.0, z),
                ]
            };
            let at = triangle(height as f32);
            let next = triangle((height as f32).next_up());
            let eye = tree_origin + up;
            // The sum is representable only for the first: elsewhere the eye is above or below the level.
            let is_above = eye.z - tree_origin.z > up.z;
            let exact = eye.z - tree_origin.z == up.z;
            for way in [DVec3::NEG_Z, DVec3::Z] {
                let camera = camera(eye, eye + way * 4.0, Projection::Orthographic);
                let is = |number, corners| EdgeOn::new(&camera, tree_origin).is(number, corners);
                let behind = if way.z < 0.0 { !is_above } else { is_above };
                assert_eq!(is(0, at), exact || behind, "{tree_origin} {way}");
                assert_eq!(is(1, next), way.z < 0.0);
                let [a, b, c] = at;
                let spans = is(2, [a, b.with_z(1e5), c.with_z(-1e5)]);
                assert!(!spans);
            }
        }
    }
}
