//! Triangles as functions of a ray's place, against exact arithmetic: what they leave no doubt about is
//! so, over pitches from a scene's size to next to a double's, and they leave little in doubt.

use super::exact::{self, Placed};
use super::footprint::RayBox;
use super::setup::{BlockSpace, CornerLanes, LANES, SIDE, SetUp};
use super::{Cull, Nearest};
use crate::camera::{Camera, ImagePlane, Placement, Projection, Ray};
use crate::random::Random;
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
    set_up: &SetUp,
    l: usize,
    camera: &Camera,
    cull: Cull,
    placed: &Placed,
    tally: &mut Tally,
) {
    tally.all += SIDE * SIDE;
    if set_up.awkward[l] {
        return;
    }
    let perspective = camera.projection() == Projection::Perspective;
    for y in 0..SIDE {
        for x in 0..SIDE {
            let ray = camera.ray(x as f64 + 0.5, y as f64 + 0.5);
            let ray = Ray {
                // Where orthographic rays begin is another matter.
                t_min: if perspective { 0.0 } else { -1e9 },
                ..ray
            };
            let truth: Option<Nearest> = exact::hit(&ray, placed, cull, 0);
            if set_up.boxes[l].right < 0 {
                assert!(truth.is_none(), "culled, and met by ({x}, {y})");
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
                let off = (at(&set_up.nearness) - truth).abs();
                // The truth is rounded too.
                let error = f64::from(set_up.nearness_error[l]) + 1e-14 * truth.abs();
                assert!(off <= error, "{off} off, by {error} at most: ({x}, {y})");
            }
        }
    }
}

fn check_all(projection: Projection, pitch: f64, frame: DVec3) -> Tally {
    let mut random = Random(51);
    let mut tally = Tally::default();
    for round in 0..12 {
        let camera = camera(&mut random, frame, projection, pitch);
        let cull = [Cull::None, Cull::Back][round % 2];
        let eye = camera.placement().eye - frame;
        let error = if frame == DVec3::ZERO {
            0.0
        } else {
            eye.abs().max_element() * f64::EPSILON * 0.5
        };
        let space = BlockSpace::new(
            &camera,
            eye,
            error,
            (0.5, 0.5),
            1.0,
            (SIDE as u32, SIDE as u32),
            cull,
        );
        let triangles: [[Vec3; 3]; LANES] =
            std::array::from_fn(|_| triangle(&mut random, &camera, pitch));
        let mut corners: CornerLanes = [[0.0; LANES]; 9];
        for (l, triangle) in triangles.iter().enumerate() {
            for (at, x) in triangle.iter().flat_map(|c| c.to_array()).enumerate() {
                corners[at][l] = x;
            }
        }
        let boxes = [ALL; LANES];
        let set_up = space.set_up(&corners, &boxes);
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
            let tally = check_all(projection, pitch, DVec3::ZERO);
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
        let Tally { decided, all, .. } = check_all(projection, 1e-6, far);
        assert!(decided * 100 >= all * 40, "{decided} of {all}");
    }
}
