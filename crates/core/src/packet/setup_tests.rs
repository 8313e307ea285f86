//! Triangles as functions of a ray's place, against exact arithmetic: what they leave no doubt about is
//! so, over pitches from a scene's size to next to a double's, and they leave little in doubt.

use super::params::SIDE;
use super::ray_box::RayBox;
use super::setup::{CornerLanes, PacketSpace, TriangleSetup};
use crate::camera::{Camera, ImagePlane, Placement, Projection};
use crate::hit::Cull;
use crate::num::simd::LANES;
use crate::random::Random;
use crate::ray::Ray;
use crate::triangle::Nearest;
use crate::triangle::exact::{self, Placed};
use glam::{DVec3, Vec3};

const ALL: RayBox = RayBox {
    left: 0,
    right: SIDE as i32 - 1,
    top: 0,
    bottom: SIDE as i32 - 1,
};

/// What a set-up's functions said of some rays.
#[derive(Debug, Default)]
struct Tally {
    decided: usize,
    all: usize,
    hits: usize,
    culled: usize,
}

/// A camera some 5 units away from what is around `middle`, of 32 × 32 rays `pitch` apart there.
fn camera(random: &mut Random, middle: DVec3, projection: Projection, pitch: f64) -> Camera {
    let plane = ImagePlane::new(32, 32, pitch).expect("a good plane");
    let placement = Placement {
        eye: middle + random.point().normalize() * 5.0,
        target: middle,
        up: DVec3::Y,
    };
    Camera::new(placement, projection, plane)
}

/// A triangle of some rays' width; one in three seen from its edge but for rounding, or a little more.
fn triangle(random: &mut Random, camera: &Camera, pitch: f64) -> [Vec3; 3] {
    let place = random.point() * (10.0 * pitch);
    let [a, b, c] = [(); 3].map(|()| place + random.point() * (12.0 * pitch));
    let kind = random.unit();
    let c = if kind > 0.33 {
        c
    } else {
        let way = camera.forward() * (20.0 * pitch);
        a + (b - a) * random.signed() + way * random.signed() + c * (1e-9 * kind.powi(6))
    };
    [a, b, c].map(DVec3::as_vec3)
}

/// Checks one lane of a set-up at every ray.
fn check(
    set_up: &TriangleSetup,
    l: usize,
    camera: &Camera,
    cull: Cull,
    placed: &Placed,
    tally: &mut Tally,
) {
    tally.all += SIDE * SIDE;
    if set_up.ill_conditioned[l] {
        return;
    }
    let perspective = camera.projection() == Projection::Perspective;
    for y in 0..SIDE {
        for x in 0..SIDE {
            let ray = camera.ray(x as f64 + 0.5, y as f64 + 0.5);
            let ray = Ray {
                // Where orthographic rays begin is another matter.
                t_min: if perspective { 0.0 } else { -1e99 },
                ..ray
            };
            let truth: Option<Nearest> = exact::hit(&ray, placed, cull, 0);
            if set_up.boxes[l].right < 0 {
                assert!(truth.is_none(), "left out, and hit by ({x}, {y})");
                tally.culled += 1;
                tally.decided += 1;
                continue;
            }
            let (i, j) = (
                (x as i32 - set_up.column[l]) as f64,
                (y as i32 - set_up.row[l]) as f64,
            );
            let at = |f: &[[f32; LANES]; 3]| {
                f64::from(f[0][l]) + f64::from(f[1][l]) * i + f64::from(f[2][l]) * j
            };
            let edges = set_up.edges.each_ref().map(at);
            let least = edges.into_iter().fold(f64::INFINITY, f64::min);
            let error = f64::from(set_up.edge_error[l]);
            if least > error {
                assert!(
                    truth.is_some(),
                    "inside, and missed by ({x}, {y}): {edges:?}"
                );
            }
            if least < -error {
                assert!(truth.is_none(), "outside, and met by ({x}, {y}): {edges:?}");
            }
            tally.decided += usize::from(least.abs() > error);
            if let Some(hit) = truth {
                tally.hits += 1;
                let depth = hit.t * ray.direction.dot(camera.forward());
                let truth = if perspective { 1.0 / depth } else { -depth };
                let off = (at(&set_up.depth_key) - truth).abs();
                // The truth is rounded too.
                let error = f64::from(set_up.depth_key_error[l]) + 1e-14 * truth.abs();
                assert!(off <= error, "{off} off, by {error} at most: ({x}, {y})");
            }
        }
    }
}

/// How triangles are made, and set up.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// By the greatest coordinate.
    Plain,
    /// The same triangles, by component.
    Componentwise,
    /// With a corner next to the eye.
    NextToTheEye,
    /// With coordinates of any exponent.
    AnyExponent,
}

fn hostile_triangle(
    random: &mut Random,
    kind: Kind,
    (camera, eye): (&Camera, DVec3),
    pitch: f64,
) -> [Vec3; 3] {
    let [a, b, c] = triangle(random, camera, pitch);
    let decades = |random: &mut Random, most: f64| crate::math::pow(10.0, most * random.signed());
    match kind {
        Kind::Plain | Kind::Componentwise => [a, b, c],
        Kind::NextToTheEye => {
            // Single precision's numbers next to the eye; where it is one, its neighbours at some rays' pitch.
            let beside = random.point() * (pitch * decades(random, 3.0));
            let next = (eye + beside).as_vec3();
            let turned = [[next, b, c], [c, next, b], [b, c, next]];
            turned[(random.unit() * 3.0) as usize % 3]
        }
        Kind::AnyExponent => [(); 3].map(|()| {
            let [x, y, z] = [(); 3].map(|()| random.signed() * decades(random, 15.0));
            DVec3::new(x, y, z).as_vec3()
        }),
    }
}

fn check_all(projection: Projection, pitch: f64, frame: DVec3, kind: Kind) -> Tally {
    let mut random = Random(51);
    let mut tally = Tally::default();
    let rounds = if kind == Kind::Plain { 12 } else { 4 };
    for round in 0..rounds {
        let camera = camera(&mut random, frame, projection, pitch);
        let cull = [Cull::None, Cull::Back][round % 2];
        let eye = camera.placement().eye - frame;
        let error = if frame == DVec3::ZERO {
            0.0
        } else {
            eye.abs().max_element() * f64::EPSILON * 0.5
        };
        let space = PacketSpace::new(
            &camera,
            eye,
            error,
            (0.5, 0.5),
            1.0,
            (SIDE as u32, SIDE as u32),
            cull,
        );
        let triangles: [[Vec3; 3]; LANES] =
            std::array::from_fn(|_| hostile_triangle(&mut random, kind, (&camera, eye), pitch));
        let mut corners: CornerLanes = [[0.0; LANES]; 9];
        for (l, triangle) in triangles.iter().enumerate() {
            for (at, x) in triangle.iter().flat_map(|c| c.to_array()).enumerate() {
                corners[at][l] = x;
            }
        }
        let boxes = [ALL; LANES];
        let mut set_up = space.set_up(&corners, &boxes);
        for (l, &corners) in triangles.iter().enumerate() {
            if kind != Kind::Plain {
                set_up.boxes[l] = ALL;
                space.set_up_componentwise(corners, &ALL, l, &mut set_up);
            }
        }
        for (l, &corners_of) in triangles.iter().enumerate() {
            let placed = Placed {
                corners: corners_of,
                origin: frame,
            };
            check(&set_up, l, &camera, cull, &placed, &mut tally);
        }
    }
    tally
}

/// The truth is integer arithmetic on the rays as they are.
#[test]
fn what_a_set_up_is_sure_of_is_so() {
    for projection in [Projection::Perspective, Projection::Orthographic] {
        for (pitch, least) in [(1e-2, 60), (1e-6, 60), (1e-10, 45), (1e-11, 0), (1e-13, 0)] {
            let tally = check_all(projection, pitch, DVec3::ZERO, Kind::Plain);
            let Tally {
                decided,
                all,
                hits,
                culled,
            } = tally;
            assert!(decided * 100 >= all * least, "{pitch}: {decided} of {all}");
            assert!(
                least < 45 || (hits > 1000 && culled > 1000),
                "{pitch}: {hits} {culled}"
            );
        }
        let far = DVec3::new(148_376.0, 1234.5, -223_423.25);
        let Tally { decided, all, .. } = check_all(projection, 1e-6, far, Kind::Plain);
        assert!(decided * 100 >= all * 40, "{decided} of {all}");
    }
}

/// The truth is integer arithmetic on the rays as they are.
#[test]
fn what_componentwise_bounds_are_sure_of_is_so() {
    for projection in [Projection::Perspective, Projection::Orthographic] {
        for (kind, pitch, least) in [
            (Kind::Componentwise, 1e-2, 45),
            (Kind::Componentwise, 1e-6, 45),
            (Kind::Componentwise, 1e-10, 45),
            (Kind::Componentwise, 1e-12, 30),
            (Kind::Componentwise, 1e-13, 5),
            (Kind::Componentwise, 1e-15, 0),
            (Kind::NextToTheEye, 1e-2, 30),
            (Kind::NextToTheEye, 1e-6, 20),
            (Kind::AnyExponent, 1e-1, 40),
            (Kind::AnyExponent, 1e-6, 20),
        ] {
            let far = DVec3::new(148_376.0, 1234.5, -223_423.25);
            for frame in [DVec3::ZERO, DVec3::new(0.25, 0.0, -3.0), far] {
                let Tally { decided, all, .. } = check_all(projection, pitch, frame, kind);
                let share = decided * 100 / all;
                let is_enough = share >= least || frame != DVec3::ZERO;
                assert!(is_enough, "{projection:?} {pitch}: {share} in a hundred");
            }
        }
    }
}
