//! Scenes made from seeds to find what takes long: arrangements that are hard for kernels, at random scales, seen from
//! eyes in hard places.

use super::scene_pair::{ScenePair, pair_in_place};
use raycast_core::glam::DVec3;
use raycast_core::math;
use raycast_oracle::random::Random;
use std::f64::consts::TAU;

/// The scene of a seed, and as many ordinary triangles in its places and in an ordinary view.
pub fn hunted(seed: u64) -> ScenePair {
    let mut random = Random::new(seed);
    let random = &mut random;
    let count = random.decade(1.0, 4.1) as usize;
    let mut triangles = arranged(random, count);
    if random.below(4) == 0 {
        // Two arrangements in one place.
        let others = arranged(random, count / 2 + 1);
        triangles.truncate(count / 2);
        triangles.extend(others);
    }
    let scale = match random.below(3) {
        0 => random.decade(-12.0, 12.0),
        _ => 1.0,
    };
    let middle = match random.below(4) {
        0 => random.in_cube() * random.decade(0.0, 9.0) * scale,
        _ => DVec3::ZERO,
    };
    for corner in triangles.as_flattened_mut() {
        *corner = *corner * scale + middle;
        if random.below(2) == 0 {
            // As it is stored, so that an eye can be there.
            *corner = corner.as_vec3().as_dvec3();
        }
    }
    let (eye, target) = eye_and_target(random, &triangles, middle, scale);
    let distance = match eye.distance(target) {
        0.0 => scale,
        distance => distance,
    };
    let height = match random.below(4) {
        0 => scale * random.decade(-3.0, 0.5),
        1 => distance * random.decade(-6.0, 0.5),
        _ => 2.0 * scale,
    };
    pair_in_place((eye, target, height), &triangles)
}

/// How far layers are from one another.
const STEPS: [f64; 7] = [0.0, 1e-3, 1e-7, 1e-12, 1e-17, 1e-30, 1e-44];

/// Triangles within a few units of the origin.
fn arranged(random: &mut Random, count: usize) -> Vec<[DVec3; 3]> {
    // What all triangles of an arrangement share.
    let corners = [(); 3].map(|()| random.in_cube());
    let step = STEPS[random.below(STEPS.len() as u32) as usize];
    let off = random.decade(-18.0, -2.0);
    let (right, up) = match random.below(2) {
        0 => (DVec3::X, DVec3::Y),
        _ => (DVec3::new(1.0, 0.25, -0.5), DVec3::new(-0.25, 1.0, 0.75)),
    };
    let kind = random.below(10);
    let triangle = |number: usize| match kind {
        // Anything.
        0 => [(); 3].map(|()| random.in_cube()),
        // About a corner.
        1 => [corners[0], random.in_cube(), random.in_cube()],
        // About an edge.
        2 => [corners[0], corners[1], random.in_cube()],
        // Layers.
        3 => corners.map(|corner| DVec3 {
            z: corner.z * 0.1 + step * number as f64,
            ..corner
        }),
        // Layers that cross.
        4 => corners.map(|corner| corner + random.in_cube() * step),
        // In one plane: that of axes, or any.
        5 => [(); 3].map(|()| {
            let whole = |number: f64| (number * 64.0).round() / 64.0;
            let place = random.in_cube();
            right * whole(place.x) + up * whole(place.y)
        }),
        // Coordinates of all magnitudes.
        6 => [(); 3].map(|()| {
            let sides = [(); 3].map(|()| {
                let sign = random.between(-1.0, 1.0).signum();
                sign * random.decade(-18.0, 3.0)
            });
            DVec3::from_array(sides)
        }),
        // Needles.
        7 => {
            let (from, along) = (random.in_cube(), random.in_cube());
            let beside = random.in_cube() * random.decade(-15.0, -3.0);
            [from, from + along, from + along * 0.5 + beside]
        }
        // A disc of slices that nearly share a plane.
        8 => {
            let turn = |step: f64| {
                let (sin, cos) = math::sin_cos(TAU * (number as f64 + step) / count as f64);
                DVec3::new(cos, sin, 0.0)
            };
            [DVec3::Z * random.between(-off, off), turn(0.0), turn(1.0)]
        }
        // The same triangle again and again, from each of its corners.
        _ => {
            let mut corners = corners;
            corners.rotate_left(number % 3);
            corners
        }
    };
    (0..count).map(triangle).collect()
}

/// An eye that is hard for the triangles, and what it looks at.
fn eye_and_target(
    random: &mut Random,
    triangles: &[[DVec3; 3]],
    middle: DVec3,
    scale: f64,
) -> (DVec3, DVec3) {
    let mut any = || triangles[random.below(triangles.len() as u32) as usize];
    let ([a, b, c], [other, ..]) = (any(), any());
    let eye = match random.below(8) {
        0 => a,
        1 => (a + b) * 0.5,
        2 => a + (b - a) * 0.5 + (c - a) * 0.25,
        // In the plane, outside.
        3 => a + (b - a) * 4.0 - (c - a) * 2.0,
        4 => random.nudge(a, 3),
        5 => a + random.in_cube() * scale * random.decade(-44.0, -6.0),
        6 => middle + random.direction() * scale * random.decade(0.0, 16.0),
        _ => middle + random.direction() * scale * 3.0,
    };
    let target = match random.below(3) {
        0 => other,
        _ => middle,
    };
    match eye == target {
        true => (eye, eye + DVec3::NEG_Z * scale),
        false => (eye, target),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_core::Accel;
    use raycast_core::camera::Projection;

    #[test]
    fn scenes_are_those_of_their_seeds_and_most_are_seen() {
        let mut seen = 0;
        for seed in 0..40 {
            let [one, again] = [hunted(seed), hunted(seed)];
            let camera = one.hostile.camera(Projection::Perspective, (16, 12));
            assert_eq!(
                camera,
                again.hostile.camera(Projection::Perspective, (16, 12))
            );
            let accel = Accel::build(&one.hostile.scene).expect("a valid scene");
            let lattice = camera.whole().lattice();
            let hits = (0..lattice.len() as u32)
                .map(|i| lattice.ray(i % lattice.columns, i / lattice.columns))
                .filter(|ray| accel.cast(ray, raycast_core::Cull::None).is_some());
            seen += u32::from(hits.count() > 0);
        }
        assert!(seen > 20, "{seen}");
    }
}
