use super::*;
use crate::camera::{Camera, Projection};
use crate::hit::Cull;
use crate::math;
use crate::num::exact::is_collinear;
use crate::packet::params::SIDE;
use crate::packet::setup_tests::{camera, space};
use crate::random::Random;
use crate::triangle::exact::{self, OffsetTriangle};
use glam::DVec3;
use std::cmp::Ordering;

/// Two triangles that are a few units in the last place apart, or cross at a small angle, or lie in exactly one plane,
/// before a camera with rays `pitch` apart.
fn near_pair(random: &mut Random, middle: DVec3, pitch: f64) -> [[Vec3; 3]; 2] {
    let size = pitch * 40.0;
    let is_one_plane = random.unit() < 0.2;
    // Whole multiples of a power of two.
    let grain = f64::from_bits(size.to_bits() >> 52 << 52) / 4096.0;
    let rounded = |point: DVec3| (point / grain).round() * grain;
    let first = [(); 3].map(|()| {
        let corner = random.point() * size;
        if is_one_plane {
            rounded(corner)
        } else {
            middle + corner
        }
    });
    let first = first.map(DVec3::as_vec3);
    let apart = size * math::pow(10.0, -4.0 - 5.0 * random.unit());
    let [a, b, c] = first.map(Vec3::as_dvec3);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    // Another triangle of the plane, its corners moved off it.
    let second = [(); 3].map(|()| {
        let (s, t) = (random.signed() * 2.0, random.signed() * 2.0);
        if is_one_plane {
            let (s, t) = ((s * 2.0).round(), (t * 2.0).round());
            return (a + (b - a) * s + (c - a) * t).as_vec3();
        }
        let off = normal * (apart * random.signed());
        (a + (b - a) * s + (c - a) * t + off).as_vec3()
    });
    [first, second]
}

/// Whether the order of eight rays at one place is decided; it must then be the true one.
fn is_decided(order: [u32; 2], truth: Ordering) -> bool {
    match order {
        [0xff, 0] => assert_eq!(truth, Ordering::Less),
        [0, 0xff] => assert_eq!(truth, Ordering::Greater),
        _ => return false,
    }
    true
}

fn of_pair<'o>(
    orders: &'o mut PlaneOrders,
    pair: [u32; 2],
    triangles: &[[Vec3; 3]],
) -> &'o PlaneOrder {
    if !orders.knows(pair) {
        orders.find(pair, pair.map(|number| &triangles[number as usize]), true);
    }
    orders.order(pair)
}

/// Orders each two neighbours among the triangles that a ray in the middle of a camera's picture hits: calls `check`
/// with the order, the truth, and the order of eight rays at that place. Only triangles at one distance may be in one
/// plane.
fn for_each_pair(
    camera: &Camera,
    triangles: &[[Vec3; 3]],
    mut check: impl FnMut(&PlaneOrder, Ordering, [u32; 2]),
) {
    let mut orders = PlaneOrders::new();
    orders.set_rays(&space(camera, DVec3::ZERO, Cull::None));
    let triangle = |triangle: u32| OffsetTriangle {
        corners: triangles[triangle as usize],
        origin: DVec3::ZERO,
    };
    let ray = camera.ray(9.5, 9.5);
    let places = (&[9.0; LANES], &[9.0; LANES]);
    let hits: Vec<u32> = (0..triangles.len() as u32)
        .filter(|&at| exact::hit(&ray, &triangle(at), Cull::None, 0).is_some())
        .collect();
    for pair in hits.windows(2).map(|pair| [pair[0], pair[1]]) {
        let [first, second] = pair.map(triangle);
        let truth = exact::compare(&ray, &first, &second, Cull::None).expect("both are hit");
        let order = of_pair(&mut orders, pair, triangles);
        assert!(!order.in_one_plane || truth.is_eq());
        check(order, truth, order.of_eight(places));
    }
}

/// Orders are those of exact arithmetic, for rays and for cells.
#[test]
fn pairs_a_rounding_apart_are_ordered_as_exact_arithmetic_orders_them() {
    let mut random = Random(73);
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let [mut hits, mut cells] = [0; 2];
        let mut decided = [0; 2];
        for _ in 0..900 {
            // Next to zero single precision distinguishes corners at any distance of the eye.
            let is_at_zero = random.unit() < 0.5;
            let middle = if is_at_zero {
                DVec3::ZERO
            } else {
                random.point() * 3.0
            };
            let finest = if is_at_zero { 13.0 } else { 5.0 };
            let pitch = math::pow(10.0, -1.0 - finest * random.unit());
            let camera = camera(&mut random, middle, projection, pitch);
            let pair = near_pair(&mut random, middle, pitch);
            let space = space(&camera, DVec3::ZERO, Cull::None);
            let mut orders = PlaneOrders::new();
            orders.set_rays(&space);
            let triangle = pair.map(|corners| OffsetTriangle {
                corners,
                origin: DVec3::ZERO,
            });
            for _ in 0..12 {
                let (x, y) = (
                    (random.unit() * SIDE as f64).floor(),
                    (random.unit() * SIDE as f64).floor(),
                );
                let ray = camera.ray(x + 0.5, y + 0.5);
                let truth = exact::compare(&ray, &triangle[0], &triangle[1], Cull::None);
                let Some(truth) = truth else { continue };
                hits += 1;
                let places = (&[x as f32; LANES], &[y as f32; LANES]);
                let order = of_pair(&mut orders, [0, 1], &pair);
                let truth = match order.in_one_plane {
                    true => truth.then(Ordering::Less),
                    false => truth,
                };
                let at_place = order.of_eight(places);
                let lane = (random.unit() * x.min(LANES as f64)).floor();
                let in_row = order.of_row((x - lane, y));
                let in_row = in_row.map(|rays| rays >> lane as u32 & 1);
                for ([first, second], decided) in [at_place, in_row].into_iter().zip(&mut decided) {
                    assert!(first & second == 0);
                    assert!(first == 0 || truth == Ordering::Less, "{pair:?} {x} {y}");
                    assert!(
                        second == 0 || truth == Ordering::Greater,
                        "{pair:?} {x} {y}"
                    );
                    *decided += u32::from(first | second != 0);
                }
                let cell = y as usize / ROW * CELLS + x as usize / ROW;
                let within = PlacesWithin::of_cell(cell);
                let order = of_pair(&mut orders, [0, 1], &pair).within(&within);
                if let Some(order) = order {
                    assert_eq!(truth, order, "{pair:?} {cell}");
                    cells += 1;
                }
            }
        }
        assert!(hits > 250 && cells > hits / 5, "{hits} {cells}");
        assert!(
            decided.iter().all(|&decided| decided > hits / 2),
            "{decided:?} of {hits}"
        );
    }
}

/// Of large triangles around the eye, a rounding of their corners away from it, those two whose planes are closest:
/// closer than double precision tells distances from them. With those alone this fails. Cameras, and both orders of a pair,
/// follow one another in one cache: functions that were kept of another packet or triangle would decide wrongly.
#[test]
fn planes_next_to_the_eye_are_ordered_as_exact_arithmetic_orders_them() {
    let mut random = Random(77);
    let [mut hits, mut decided] = [0; 2];
    let mut orders = PlaneOrders::new();
    for round in 0..600 {
        let camera = camera(&mut random, DVec3::ZERO, Projection::Perspective, 0.02);
        let eye = camera.pose().eye;
        let across = camera.forward().any_orthogonal_vector();
        let around = [across, camera.forward().cross(across)];
        let mut layer = || {
            [(-1.0, -1.0), (1.0, -1.0), (0.0, 1.0)].map(|(s, t)| {
                let off = random.point() * 6e-8;
                (eye + around[0] * s + around[1] * t + off).as_vec3()
            })
        };
        let mut layers: Vec<(f64, [Vec3; 3])> = (0..60)
            .map(|_| {
                let corners = layer();
                let [a, b, c] = corners.map(Vec3::as_dvec3);
                ((b - a).cross(c - a).normalize().dot(a - eye), corners)
            })
            .collect();
        layers.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let apart = |pair: &&[(f64, [Vec3; 3])]| pair[1].0 - pair[0].0;
        let closest = layers
            .windows(2)
            .filter(|pair| pair[0].1 != pair[1].1)
            .min_by(|a, b| apart(a).total_cmp(&apart(b)));
        let closest = closest.expect("layers differ");
        let pair = [closest[0].1, closest[1].1];
        orders.set_rays(&space(&camera, DVec3::ZERO, Cull::None));
        let triangle = pair.map(|corners| OffsetTriangle {
            corners,
            origin: DVec3::ZERO,
        });
        for place in [2.0, 9.0, 20.0, 31.0] {
            let ray = camera.ray(place + 0.5, place + 0.5);
            let truth = exact::compare(&ray, &triangle[0], &triangle[1], Cull::None);
            let Some(truth) = truth.filter(|order| order.is_ne()) else {
                continue;
            };
            let places = (&[place as f32; LANES], &[place as f32; LANES]);
            let both = [([0, 1], truth), ([1, 0], truth.reverse())];
            // The same triangle is the second one for the last rays of a packet and the first of the next.
            let turned = [both[1], both[0]];
            for (pair_of, truth) in if round % 2 == 0 { both } else { turned } {
                hits += 1;
                let order = of_pair(&mut orders, pair_of, &pair).of_eight(places);
                decided += u32::from(is_decided(order, truth));
            }
        }
    }
    assert!(
        hits > 1000 && decided * 100 > hits * 99,
        "{decided} of {hits}"
    );
}

/// Corners whose coordinates relative to the eye have random exponents. With the bounds of edge functions that go by
/// the greatest coordinate alone this fails.
#[test]
fn triangles_of_many_magnitudes_are_ordered_as_exact_arithmetic_orders_them() {
    let mut random = Random(78);
    let [mut pairs, mut decided] = [0; 2];
    for _ in 0..150 {
        let camera = camera(&mut random, DVec3::ZERO, Projection::Perspective, 0.02);
        let eye = camera.pose().eye;
        let mut number = || random.signed() * math::pow(10.0, 18.0 * random.signed());
        let mut corner = || (eye + DVec3::new(number(), number(), number())).as_vec3();
        let triangles: Vec<[Vec3; 3]> = (0..40).map(|_| [(); 3].map(|()| corner())).collect();
        for_each_pair(&camera, &triangles, |order, truth, eight| {
            pairs += 1;
            decided += u32::from(order.in_one_plane || is_decided(eight, truth));
        });
    }
    assert!(
        pairs > 300 && decided * 100 > pairs * 90,
        "{decided} of {pairs}"
    );
}

/// Triangles of a tilted plane with whole coordinates, but for corners that are subnormal numbers off it: no precision
/// of a fixed length tells the distances from zero, since their terms are of the size of the coordinates. With
/// distances in double-double arithmetic this fails.
#[test]
fn triangles_of_a_tilted_plane_but_for_subnormal_numbers_are_ordered() {
    let mut random = Random(82);
    let least = f64::from(f32::from_bits(1));
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let [mut pairs, mut decided, mut in_one_plane] = [0; 3];
        for _ in 0..100 {
            let camera = camera(&mut random, DVec3::ZERO, projection, 0.1);
            let mut corner = || {
                let [x, y] = [(); 2].map(|()| (random.signed() * 2.0).round());
                let z = x - 2.0 * y;
                let off = (random.signed() * 4.0).round() * 1e3 * least;
                DVec3::new(x, y, if z == 0.0 { off } else { z }).as_vec3()
            };
            let triangles: Vec<[Vec3; 3]> = (0..40)
                .map(|_| [corner(), corner(), corner()])
                .filter(|&[a, b, c]| !is_collinear(a, b, c))
                .collect();
            for_each_pair(&camera, &triangles, |order, truth, eight| {
                pairs += 1;
                match order.in_one_plane {
                    true => in_one_plane += 1,
                    false => decided += u32::from(is_decided(eight, truth)),
                }
            });
        }
        assert!(
            pairs > 200 && in_one_plane > 10 && (decided + in_one_plane) * 100 > pairs * 90,
            "{decided} and {in_one_plane} of {pairs}"
        );
    }
}

/// Where two planes cross between a ray and its place in single precision, the place does not decide. With
/// [`SINGLE_PLACE_ERROR`] at zero this fails.
#[test]
fn places_in_single_precision_do_not_decide_across_a_crossing() {
    let place = 17.0 + f64::from(f32::EPSILON);
    let crossing = 17.0 + f64::from(f32::EPSILON) / 2.0;
    assert_eq!(place as f32, 17.0);
    let edge = |x: f64, constant: f64| Linear {
        constant,
        x,
        y: 0.0,
    };
    // Distances of 1, −1 and 0 from the plane z = 0, and edge functions whose difference is x − crossing.
    let first = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let corners = [Vec3::Z, -Vec3::Z, Vec3::ZERO];
    let edges = [edge(1.0, 0.0), edge(0.0, crossing), edge(0.0, 1.0)];
    let order = by_edges([&first, &corners], off_by(edges, 0.0));
    let of = |x: f64| order.of_eight((&[x as f32; LANES], &[0.0; LANES]));
    assert_eq!(of(place), [0, 0]);
    assert_eq!([of(18.0), of(16.0)], [[0xff, 0], [0, 0xff]]);
}

/// The order of two triangles, the second of which has these edge functions in double precision.
fn by_edges(corners: [&[Vec3; 3]; 2], edges: BoundedEdges) -> PlaneOrder {
    let camera = camera(&mut Random(79), DVec3::ZERO, Projection::Perspective, 0.01);
    let mut known = KnownEdges {
        in_double: Cached {
            of: 1,
            packet: 0,
            known: edges,
        },
        ..KnownEdges::NONE
    };
    let mut edges = PairEdges {
        space: &space(&camera, DVec3::ZERO, Cull::None),
        packet: 0,
        corners,
        second: 1,
        known: &mut known,
    };
    let mut order = PlaneOrder::UNKNOWN;
    order.set(&Some(Plane::new(*corners[0])), &mut edges, true);
    order
}

fn off_by(edges: [Linear; 3], error: f64) -> BoundedEdges {
    Some(edges.map(|edge| (edge, error)))
}

fn constant(constant: f64) -> Linear {
    Linear {
        constant,
        x: 0.0,
        y: 0.0,
    }
}

fn signs(order: &PlaneOrder) -> [u32; 2] {
    order.of_eight((&[0.0; LANES], &[0.0; LANES]))
}

/// With the error of edge functions at zero this fails.
#[test]
fn sums_within_the_error_of_edge_functions_decide_nothing() {
    let first = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let corners = [Vec3::Z, -Vec3::Z, Vec3::ZERO];
    let of = |more: f64| {
        let edges = [constant(1.0 + more), constant(1.0), constant(1.0)];
        signs(&by_edges([&first, &corners], off_by(edges, 1e-9)))
    };
    assert_eq!([of(1.9e-9), of(-1.9e-9)], [[0; 2]; 2]);
    assert_eq!([of(2.1e-9), of(-2.1e-9)], [[0xff, 0], [0, 0xff]]);
}

/// Corners in exactly the plane, whose rounded distances are not zero. With the error of distances at zero this fails.
#[test]
fn corners_within_rounding_of_a_plane_decide_nothing() {
    let mut random = Random(76);
    let mut rounded = 0;
    for _ in 0..500 {
        let mut whole = || [(); 3].map(|()| (random.signed() * 1048576.0).round());
        let [a, b, c] = [whole(), whole(), whole()].map(DVec3::from_array);
        let at = |s: f64, t: f64| (a + (b - a) * s + (c - a) * t).as_vec3();
        let first = [a, b, c].map(|corner| corner.as_vec3());
        let plane = Plane::new(first);
        let corners = [at(2.0, -3.0), at(-1.0, 3.0), at(3.0, 2.0)];
        let edges = off_by([constant(1.0), constant(2.0), constant(0.5)], 0.0);
        let order = PlaneOrder::by_distances(corners.map(|c| plane.distance(c)), || &edges);
        assert_eq!(signs(&order), [0, 0], "{a} {b} {c}");
        let exact = by_edges([&first, &corners], edges);
        assert!(exact.in_one_plane, "{a} {b} {c}");
        rounded += u32::from(order.function.constant != 0.0);
    }
    assert!(rounded > 200, "{rounded}");
}

#[test]
fn orders_of_another_packet_are_forgotten() {
    let mut random = Random(74);
    let pair = [
        [Vec3::ZERO, Vec3::X, Vec3::Y],
        [Vec3::Z, Vec3::X + Vec3::Z, Vec3::Y + Vec3::Z],
    ];
    let places = (&[0.0; LANES], &[0.0; LANES]);
    let mut orders = PlaneOrders::new();
    assert_eq!(of_pair(&mut orders, [0, 1], &pair).of_eight(places), [0, 0]);
    for _ in 0..40 {
        let camera = camera(&mut random, DVec3::ZERO, Projection::Perspective, 0.01);
        orders.set_rays(&space(&camera, DVec3::ZERO, Cull::None));
        let expected = match camera.pose().eye.z {
            z if z > 1.1 => [0, 0xff],
            z if z < -0.1 => [0xff, 0],
            _ => continue,
        };
        assert_eq!(
            of_pair(&mut orders, [0, 1], &pair).of_eight(places),
            expected
        );
    }
}
