use super::*;
use crate::camera::BrownConrady;
use crate::math;
use crate::random::Random;
use glam::DVec2;

/// Calibrated and arbitrary lenses.
pub(in crate::camera) fn lenses() -> impl Iterator<Item = BrownConrady> {
    let mut random = Random(47);
    let known = [
        [-0.28, 0.07, 0.0002, 0.00002, 0.0],
        [-0.4, 0.2, 0.001, -0.002, -0.05],
        [0.3, 0.1, -0.02, 0.01, 0.05],
    ];
    let made = (0..150).map(move |_| {
        let size = math::pow(2.0, random.signed() * 3.0 - 3.0);
        let [a, b, c] = (random.point() * size).to_array();
        let decentred = random.point() * 0.05 * size;
        [a, b, decentred.x, decentred.y, c]
    });
    let all = known.into_iter().chain(made);
    all.map(|coefficients| BrownConrady::new(coefficients).expect("finite"))
}

/// The truth is the definition, all of Newton's steps for each place: it has a direction, within the disc, which
/// steps from nearby reach. Places are beyond where a lens is well-behaved.
#[test]
fn followed_rectangles_have_the_directions_of_their_places() {
    let mut random = Random(48);
    let (mut count, mut beyond) = (0, 0);
    for lens in lenses() {
        for _ in 0..60 {
            let middle = random.point() * 1.6;
            let half = random.point().abs() * math::pow(10.0, -1.0 - 3.0 * random.unit());
            let across = (middle.x - half.x, middle.x + half.x);
            let along = (middle.y - half.y, middle.y + half.y);
            let Some(region) = lens.region(across, along) else {
                continue;
            };
            beyond += usize::from(!lens.is_well_behaved(middle.x, middle.y));
            for _ in 0..20 {
                // Corners, too.
                let mut side = || (2.0 * random.signed()).clamp(-1.0, 1.0);
                let (a, b) = (middle.x + half.x * side(), middle.y + half.y * side());
                let found = lens.direction(a, b);
                let found = found.unwrap_or_else(|| panic!("{lens} at {a} {b}: {region:?}"));
                let (off, most) = region.off_centre(found.x, -found.y);
                assert!(off <= most, "{lens} {a} {b}: {region:?}");
                let start = random.point() * region.reach * 0.1;
                let start = [[found.x + start.x], [-found.y + start.y]];
                if let Some([[x], [y]]) =
                    region.undistort_from(&lens.distortion, [&[a], &[-b]], start)
                {
                    let off = DVec2::new(x - found.x, y + found.y).length();
                    assert!(off < 720.0 * f64::EPSILON, "{lens} {a} {b}: {off:e}");
                    count += 1;
                }
            }
        }
    }
    assert!(count > 40_000 && beyond > 500, "{count} {beyond}");
}

/// The truth is Newton's steps for each of the places.
#[test]
fn iterates_are_as_near_and_steps_as_short_as_is_said() {
    let mut random = Random(50);
    let (mut furthest, mut longest) = ([0.0_f64; 4], [0.0_f64; 4]);
    for lens in lenses() {
        for _ in 0..60 {
            let place = [(); 2].map(|()| 1.6 * random.signed());
            let radius = math::pow(10.0, -1.0 - 2.0 * random.unit());
            let places = [(); 40].map(|()| {
                let (sin, cos) = math::sin_cos(random.signed() * 3.2);
                [place[0] + radius * cos, place[1] + radius * sin]
            });
            let mut each = places;
            let mut iterates = Iterates {
                centre: place,
                within: radius,
                step: f64::INFINITY,
            };
            for step in 0..furthest.len() {
                let Some((near, next)) = iterates.next(&lens.distortion, place, radius, 0.0) else {
                    break;
                };
                let rounding = 1e-13 * near.beta;
                for (at, &to) in each.iter_mut().zip(&places) {
                    let near = Near::of(&lens.distortion, at[0], at[1], 0.0)
                        .expect("J is definite within r");
                    let by = near.step(to);
                    let length = DVec2::from_array(by).length();
                    assert!(length <= next.step + rounding, "{lens} {place:?} {step}");
                    *at = [at[0] - by[0], at[1] - by[1]];
                    let off = DVec2::from_array(*at).distance(next.centre.into());
                    assert!(off <= next.within + rounding, "{lens} {place:?} {step}");
                    if next.step > 1e-9 {
                        longest[step] = longest[step].max(length / next.step);
                        furthest[step] = furthest[step].max(off / next.within);
                    }
                }
                iterates = next;
            }
        }
    }
    let are_close = furthest.into_iter().chain(longest).all(|ratio| ratio > 0.6);
    assert!(are_close, "{furthest:?} {longest:?}");
}

/// The truth is differences of the first derivative, along the direction in which it changes most of some hundred.
#[test]
fn curvatures_are_no_less_than_differences_of_derivatives() {
    let mut random = Random(49);
    let mut closest = 0.0_f64;
    for lens in lenses() {
        for _ in 0..20 {
            let (x, y) = (random.signed(), random.signed());
            let near = Near::of(&lens.distortion, x, y, 0.0);
            let Some(near) = near else { continue };
            let within = math::pow(10.0, -4.0 + 3.0 * random.unit());
            let bound = near.curvature(&lens.distortion, within);
            for turn in 0..24 {
                let (sin, cos) = math::sin_cos(f64::from(turn) * 0.2618);
                let to = lens.distortion.at(x + cos * within, y + sin * within);
                let (xx, xy, yy) = (to.xx - near.xx, to.xy - near.xy, to.yy - near.yy);
                let (middle, half) = ((xx + yy) * 0.5, (xx - yy) * 0.5);
                let norm = middle.abs() + (half * half + xy * xy).sqrt();
                assert!(norm <= bound * within * (1.0 + 1e-9), "{lens} {x} {y}");
                closest = closest.max(norm / (bound * within));
            }
        }
    }
    assert!(closest > 0.8, "{closest}");
}

/// The truth is Newton's steps for places of a ring, in all directions from the middle, each turned back to the first axis.
#[test]
fn iterates_of_rings_are_as_near_and_steps_as_short_as_is_said() {
    let mut random = Random(54);
    let (mut furthest, mut longest) = ([0.0_f64; 3], [0.0_f64; 3]);
    // The tangential part alone matters where rings are narrow.
    for lens in lenses().map(|lens| lens.distortion) {
        let radial = lens.radial();
        let [_, _, p1, p2, _] = lens.coefficients;
        let decentring = (p1 * p1 + p2 * p2).sqrt();
        for _ in 0..60 {
            let (ring, half) = (1.6 * random.unit(), random.decades(-5.0, -1.0));
            let places = [(); 40].map(|()| {
                let (sin, cos) = math::sin_cos(random.signed() * 3.2);
                let along = ring + half * (2.0 * random.signed()).clamp(-1.0, 1.0);
                ([sin, cos], [along * cos, along * sin])
            });
            let mut each = places.map(|(_, place)| place);
            let place = [ring, 0.0];
            let mut iterates = Iterates {
                centre: place,
                within: half,
                step: f64::INFINITY,
            };
            for step in 0..furthest.len() {
                let Some((near, next)) = iterates.next(&radial, place, half, decentring) else {
                    break;
                };
                let rounding = 1e-13 * near.beta;
                for (at, &([sin, cos], to)) in each.iter_mut().zip(&places) {
                    let near = Near::of(&lens, at[0], at[1], 0.0).expect("J is definite within r");
                    let by = near.step(to);
                    let length = DVec2::from_array(by).length();
                    assert!(length <= next.step + rounding, "{lens:?} {ring} {step}");
                    *at = [at[0] - by[0], at[1] - by[1]];
                    let turned = DVec2::new(at[0] * cos + at[1] * sin, at[1] * cos - at[0] * sin);
                    let off = turned.distance(next.centre.into());
                    assert!(off <= next.within + rounding, "{lens:?} {ring} {step}");
                    if decentring * ring * ring > 10.0 * half {
                        longest[step] = longest[step].max(length / next.step);
                        furthest[step] = furthest[step].max(off / next.within);
                    }
                }
                iterates = next;
            }
        }
    }
    let are_close = furthest.into_iter().chain(longest).all(|ratio| ratio > 0.6);
    assert!(are_close, "{furthest:?} {longest:?}");
}

/// The truth is all of Newton's steps for each place.
#[test]
fn places_within_the_radius_of_convergence_have_directions() {
    let mut random = Random(55);
    let (mut count, mut wider) = (0, 0);
    for lens in lenses() {
        wider += usize::from(lens.convergence > 1.2 * lens.well_behaved.radius);
        for _ in 0..200 {
            let (sin, cos) = math::sin_cos(random.signed() * 3.2);
            let along = lens.convergence * random.unit().sqrt().min(0.999_999);
            let (a, b) = (along * cos, along * sin);
            let found = lens.direction(a, b);
            let found = found.unwrap_or_else(|| panic!("{lens} {a} {b}"));
            assert!(lens.has_place(a, b) && lens.surely_has_place(a, b));
            // The direction is the one that is followed from the middle.
            let inner = lens
                .direction(a * 0.999, b * 0.999)
                .expect("within the radius");
            assert!(found.distance(inner) < 0.1, "{lens} {a} {b}");
            count += 1;
        }
    }
    assert!(count > 20_000 && wider > 50, "{count} {wider}");
    // The whole of a calibrated camera's wide picture, and all but the rim where a lens ends.
    let euroc = [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0];
    let ending = [-0.35, 0.15, 0.001, -0.0005, -0.03];
    let [euroc, ending] = [euroc, ending].map(|it| BrownConrady::new(it).expect("finite"));
    assert!(euroc.convergence > 1.4, "{}", euroc.convergence);
    let (rim, _) = ending.distort(0.999 * ending.end(), 0.0).expect("inside");
    assert!(
        ending.convergence > 0.95 * rim,
        "{} {rim}",
        ending.convergence
    );
}

/// The truth is differences of the second derivative along the direction in which it changes most of some.
#[test]
fn third_derivatives_are_no_less_than_differences_of_second_ones() {
    const H: f64 = 1e-4;
    let mut random = Random(56);
    let mut closest = 0.0_f64;
    // The second derivative along a unit vector twice, by differences of the first.
    let along = |lens: &Distortion, [x, y]: [f64; 2], [cos, sin]: [f64; 2]| {
        let one = |h: f64| {
            let at = lens.at(x + h * cos, y + h * sin);
            [at.xx * cos + at.xy * sin, at.xy * cos + at.yy * sin]
        };
        let (ahead, behind) = (one(H), one(-H));
        [0, 1].map(|axis| (ahead[axis] - behind[axis]) / (2.0 * H))
    };
    // It vanishes along and across x where |x| = ½, and not between.
    let between = BrownConrady::new([0.5, -1.6, 0.0, 0.0, 1.6]).expect("finite");
    let point = [0.3, 0.4];
    let places = lenses().flat_map(|lens| (0..20).map(move |_| (lens, None)));
    for (lens, at) in places.chain([(between, Some(point))]) {
        let lens = lens.distortion;
        let at = at.unwrap_or_else(|| [random.signed(), random.signed()]);
        let Some(near) = Near::of(&lens, at[0], at[1], 0.0) else {
            continue;
        };
        for within in [0.02, 0.001] {
            let bound = near.third(&lens, within);
            for turn in 0..24 {
                let (sin, cos) = math::sin_cos(f64::from(turn) * 0.2618);
                let away = within - H;
                let there = [at[0] + cos * away, at[1] + sin * away];
                let second = [at, there].map(|at| DVec2::from(along(&lens, at, [cos, sin])));
                let third = second[0].distance(second[1]) / away;
                assert!(
                    third <= bound * (1.0 + 1e-6) + 1e-8,
                    "{lens:?} {at:?} {within}"
                );
                closest = closest.max(third / bound);
            }
        }
    }
    assert!(closest > 0.9, "{closest}");
}
