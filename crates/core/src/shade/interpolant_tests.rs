//! t, u, v and normals by linear functions against the single ray's, at triangles that are hard to interpolate.

use super::interpolants::{
    HitParameters, Interpolants, LinearNormal, PlanarRays, eight_weights_of,
};
use super::vectors::{Row, Rows, Vectors};
use crate::Simd;
use crate::camera::{Camera, ImagePlane, Lattice, Pose, Projection};
use crate::hit::{Cull, Precision, PrimitiveHit};
use crate::num::simd::{F32x8, LANES, Lanes, Work, dispatch};
use crate::random::Random;
use crate::triangle::row_tests::{SCENES, triangle_and_rays};
use crate::triangle::{BoundedHit, PreparedRay};
use glam::{DVec3, Vec3};

/// Four units in the last place of a weight just below one. Twice this is four of t's, relative to t.
const BOUND: f64 = 4.0 / (1u64 << 24) as f64;

/// Counts of what became of the rays that hit.
#[derive(Debug, Default)]
struct Tally {
    interpolated: u32,
    refused: u32,
    wrong: u32,
}

fn exact_hit(
    camera: &Camera,
    (x, y): (f64, f64),
    frame: DVec3,
    corners: [Vec3; 3],
) -> PrimitiveHit {
    let ray = PreparedRay::new(&camera.ray(x, y), frame, Cull::None, Precision::Exact);
    let mut nearest = BoundedHit::NONE;
    let ray = ray.expect("a valid ray");
    ray.intersect(0, |_| corners, |id| id, &mut nearest);
    nearest.to_primitive_hit()
}

/// Interpolates at all rays that hit one of many triangles, with rays changed and with accuracy tested or not.
fn tally(
    projection: Projection,
    scene: (DVec3, f64),
    change: impl Fn(&mut PlanarRays),
    make: impl Fn(&PlanarRays, [Vec3; 3]) -> Option<Interpolants>,
) -> Tally {
    let mut random = Random(7);
    let mut tally = Tally::default();
    let frame = scene.0;
    for _ in 0..4000 {
        let (corners, Lattice { camera, .. }) = triangle_and_rays(&mut random, scene);
        let camera = Camera::new(camera.pose(), projection, camera.plane());
        let mut rays = PlanarRays::new(&camera, frame).expect("a planar picture");
        change(&mut rays);
        let interpolants = make(&rays, corners);
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let edges = [b - a, c - a, c - b].map(|edge| edge.abs().max_element());
        let edge = edges.into_iter().fold(0.0, f64::max);
        let slack = match projection {
            Projection::Orthographic => edge * 0.125,
            _ => 0.0,
        };
        for place in (0..64).map(|i| (f64::from(i % 8) + 0.5, f64::from(i / 8) + 0.5)) {
            let hit = exact_hit(&camera, place, frame, corners);
            if hit.is_miss() {
                continue;
            }
            let Some(interpolants) = &interpolants else {
                tally.refused += 1;
                continue;
            };
            tally.interpolated += 1;
            let HitParameters { t, u, v } = interpolants.at(&rays, place.0, place.1);
            let off = |found: f32, expected: f32| f64::from((found - expected).abs());
            let is_good = off(u, hit.u) <= BOUND
                && off(v, hit.v) <= BOUND
                && off(t, hit.t) <= BOUND * (2.0 * f64::from(hit.t) + slack);
            tally.wrong += u32::from(!is_good);
        }
    }
    tally
}

const PROJECTIONS: [Projection; 2] = [Projection::Perspective, Projection::Orthographic];

#[test]
fn interpolated_hits_are_within_their_bounds_of_the_single_ray() {
    for projection in PROJECTIONS {
        for scene in SCENES {
            let tally = tally(projection, scene, |_| {}, Interpolants::new);
            assert_eq!(tally.wrong, 0, "{projection:?} {scene:?}: {tally:?}");
            let is_varied = tally.interpolated > 500 && tally.refused > 500;
            assert!(is_varied, "{projection:?} {scene:?}: {tally:?}");
        }
    }
}

/// The eye's error, and that of the corners: bounds without either accept triangles whose weights are wrong.
#[test]
fn without_any_term_of_the_bound_interpolated_hits_are_wrong() {
    for projection in PROJECTIONS {
        let without_eye_error = |rays: &mut PlanarRays| rays.set_eye_error(0.0);
        let found = tally(projection, SCENES[2], without_eye_error, Interpolants::new);
        assert!(found.wrong > 0, "{projection:?}: {found:?}");
        let found = tally(projection, SCENES[0], |_| {}, Interpolants::unchecked);
        assert!(found.wrong > 0, "{projection:?}: {found:?}");
    }
}

/// Eight places of a row, in lanes.
struct Eight<'a> {
    rays: &'a PlanarRays,
    interpolants: &'a Interpolants,
    normal: &'a LinearNormal,
    xs: &'a [f64; LANES],
    y: f64,
    numbers: &'a mut [Row; 3],
    normals: &'a mut Rows,
}

impl Work for Eight<'_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let weights = self.interpolants.eight_weights(lanes, self.xs, self.y);
        let [u, v] = eight_weights_of(lanes, weights);
        let distances = (self.interpolants).eight_distances(lanes, self.xs, self.y);
        let place = (self.xs, self.y);
        let t = self.rays.eight_distances_of(lanes, place, distances);
        for (row, numbers) in self.numbers.iter_mut().zip([t, u, v]) {
            numbers.store(row);
        }
        let normal: Vectors<_> = self.normal.eight(lanes, self.xs, self.y);
        let inverse = lanes.splat(1.0) / normal.length();
        *self.normals = normal.scaled(inverse).store();
    }
}

#[test]
fn every_instruction_set_gives_one_places_numbers_to_the_bit() {
    let mut random = Random(5);
    let mut count = 0;
    for round in 0..2000 {
        let scene = SCENES[round % 3];
        let (corners, Lattice { camera, .. }) = triangle_and_rays(&mut random, scene);
        let projection = PROJECTIONS[round / 3 % 2];
        let camera = Camera::new(camera.pose(), projection, camera.plane());
        let rays = PlanarRays::new(&camera, scene.0).expect("a planar picture");
        let Some(interpolants) = Interpolants::new(&rays, corners) else {
            continue;
        };
        let flat = random.point().as_vec3().normalize();
        let near = |random: &mut Random| (flat + random.point().as_vec3() * 0.3).normalize();
        let normals = [(); 3].map(|()| near(&mut random));
        let Some(normal) = interpolants.normals(normals, flat).filter(|it| !it.turns()) else {
            continue;
        };
        count += 1;
        let offset = random.unit();
        let xs = std::array::from_fn(|lane| lane as f64 + offset);
        let y = 8.0 * random.unit();
        for simd in Simd::available() {
            let (mut numbers, mut found) = ([[0.0; LANES]; 3], Rows::ZERO);
            let work = Eight {
                rays: &rays,
                interpolants: &interpolants,
                normal: &normal,
                xs: &xs,
                y,
                numbers: &mut numbers,
                normals: &mut found,
            };
            dispatch(simd, work);
            for (lane, &x) in xs.iter().enumerate() {
                let HitParameters { t, u, v } = interpolants.at(&rays, x, y);
                let bits = [t, u, v].map(f32::to_bits);
                assert_eq!(numbers.map(|row| row[lane].to_bits()), bits, "{simd:?}");
                let one = normal.at(x, y, flat).to_array().map(f32::to_bits);
                assert_eq!(found.0.map(|row| row[lane].to_bits()), one, "{simd:?}");
            }
        }
    }
    assert!(count > 500, "{count}");
}

#[test]
fn scenes_of_any_scale_have_their_distances() {
    for projection in PROJECTIONS {
        for scale in [1e-30, 1e-20, 1.0, 1e15] {
            let pose = Pose {
                eye: DVec3::new(0.3, 0.2, 3.0) * scale,
                target: DVec3::ZERO,
                up: DVec3::Y,
            };
            let plane = ImagePlane::new(64, 48, 0.03 * scale).expect("a size and a step");
            let camera = Camera::new(pose, projection, plane);
            let corners = [Vec3::NEG_ONE, Vec3::new(1.0, -1.0, 0.5), Vec3::Y];
            let corners = corners.map(|corner| corner * scale as f32);
            let rays = PlanarRays::new(&camera, DVec3::ZERO).expect("a planar picture");
            let interpolants = Interpolants::new(&rays, corners).expect("a large triangle");
            let hit = exact_hit(&camera, (32.5, 24.5), DVec3::ZERO, corners);
            let HitParameters { t, .. } = interpolants.at(&rays, 32.5, 24.5);
            assert!(
                (t / hit.t - 1.0).abs() < 1e-6,
                "{projection:?} {scale}: {t}"
            );
        }
    }
}

/// Normals that are opposite at two corners cancel between them; others never do.
#[test]
fn normals_that_may_cancel_are_refused() {
    let (corners, Lattice { camera, .. }) = triangle_and_rays(&mut Random(1), SCENES[0]);
    let rays = PlanarRays::new(&camera, DVec3::ZERO).expect("a planar picture");
    let interpolants = Interpolants::unchecked(&rays, corners);
    let interpolants = interpolants.expect("interpolants");
    let is_taken = |normals: [Vec3; 3]| interpolants.normals(normals, Vec3::Z).is_some();
    assert!(is_taken([Vec3::X, Vec3::Y, Vec3::Z]));
    assert!(!is_taken([Vec3::X, Vec3::NEG_X, Vec3::Z]));
    assert!(!is_taken([Vec3::X, Vec3::ZERO, Vec3::Z]));
    // Three in a plane, 120° apart, cancel in the middle.
    let around = [(1.0, 0.0), (-0.5, 0.866), (-0.5, -0.866)];
    assert!(!is_taken(around.map(|(x, y)| Vec3::new(x, y, 0.0))));
}
