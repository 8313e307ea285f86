//! Places of rays and their bounds, against the rays themselves.

use super::*;
use crate::camera::{Lattice, Panorama, Pose, Projection};
use crate::num::simd::Plain;
use crate::packet::place_box::PlaceBox;
use crate::random::Random;

fn lattices() -> impl Iterator<Item = Lattice> {
    let mut random = Random(91);
    Panorama::ALL.into_iter().flat_map(move |(_, panorama)| {
        [0.02, 1e-3, 1e-7, 1e-13].map(|step| {
            let pose = Pose::towards(random.point(), random.point() * 3.0);
            let distance = pose.eye.distance(pose.target);
            let plane = ImagePlane::new(70, 50, step * distance).expect("a good plane");
            let camera = Camera::new(pose, Projection::Panoramic(panorama), plane);
            camera.whole().lattice()
        })
    })
}

/// Whether a rectangle of a lattice's rays is one packet, whose places are then found.
fn fits(places: &mut Places, (lattice, rays): (&Lattice, &PanoramaRays), rect: Rect) -> bool {
    let patch = rays.lens_patch(rect, None);
    places.find(Plain, (&lattice.camera, rays), rect, patch.as_ref()) == Fit::Packet
}

/// The truth is the ray's own direction through the packet's map, which is off by a tenth of the bound. Places of
/// rays that are very close together are off by more than rounding to single precision: they need the bound.
#[test]
fn places_are_within_their_error_bound_of_rays() {
    let (mut packets, mut needed) = (0, 0);
    for lattice in lattices() {
        let rays = PanoramaRays::new(&lattice).expect("a panorama");
        let mut places = Places::new(&lattice.camera);
        for (x, y) in [(0, 0), (32, 0), (0, 32), (38, 18)] {
            let rect = Rect {
                x,
                y,
                width: 32,
                height: 50 - y.max(18),
            };
            if !fits(&mut places, (&lattice, &rays), rect) {
                continue;
            }
            packets += 1;
            let space = places.space(DVec3::ZERO, 0.0, Cull::None);
            for row in 0..rect.height {
                for column in 0..rect.width {
                    if places.has_ray[row as usize] >> column & 1 == 0 {
                        continue;
                    }
                    let direction = lattice.ray(x + column, y + row).direction;
                    let [i, j, k] = space.map.map(|line| line.dot(direction));
                    let at = row as usize * SIDE + column as usize;
                    for (place, truth) in [(places.x[at], i / k), (places.y[at], j / k)] {
                        let off = (f64::from(place) - truth).abs();
                        let rounding = truth.abs() / f64::from(1 << 24);
                        assert!(off <= rounding + space.ray_error, "{place} {truth}");
                        needed += u32::from(off > 2.0 * rounding);
                    }
                    assert!((0.4..31.6).contains(&places.x[at]));
                    assert!((0.4..31.6).contains(&places.y[at]));
                }
            }
        }
    }
    assert!(packets > 60, "{packets}");
    assert!(needed > 100, "{needed}");
}

/// A cell's window contains its rays' tangents, of which places are the roundings to single precision. Without slack
/// for these this fails.
#[test]
fn windows_of_cells_contain_their_rays() {
    let mut rays_seen = 0;
    for lattice in lattices() {
        let rays = PanoramaRays::new(&lattice).expect("a panorama");
        let mut places = Places::new(&lattice.camera);
        let rect = Rect {
            x: 7,
            y: 3,
            width: 31,
            height: 30,
        };
        if !fits(&mut places, (&lattice, &rays), rect) {
            continue;
        }
        let windows = places.cell_windows();
        let view = &places.view;
        for row in 0..rect.height {
            for column in 0..rect.width {
                if places.has_ray[row as usize] >> column & 1 == 0 {
                    continue;
                }
                let direction = lattice.ray(rect.x + column, rect.y + row).direction;
                let depth = direction.dot(view.forward());
                let across = direction.dot(view.right()) / depth;
                let along = direction.dot(view.up()) / depth;
                let (left, right) = windows[column as usize / ROW].across;
                let (low, high) = windows[row as usize / ROW].along;
                assert!((left..=right).contains(&across), "{column} {row} {across}");
                assert!((low..=high).contains(&along), "{column} {row} {along}");
                rays_seen += 1;
            }
        }
    }
    assert!(rays_seen > 5_000, "{rays_seen}");
}

/// A box that contains a ray's place touches the ray's row and cell.
#[test]
fn boxes_touch_the_rows_and_cells_of_the_rays_in_them() {
    for lattice in lattices() {
        let rays = PanoramaRays::new(&lattice).expect("a panorama");
        let mut places = Places::new(&lattice.camera);
        let rect = Rect {
            x: 7,
            y: 3,
            width: 32,
            height: 32,
        };
        if !fits(&mut places, (&lattice, &rays), rect) {
            continue;
        }
        for at in 0..RAYS {
            let (x, y) = (places.x[at], places.y[at]);
            let own = PlaceBox {
                left: x,
                right: x,
                top: y,
                bottom: y,
            };
            let cell = at / SIDE / ROW * CELLS + at % SIDE / ROW;
            assert!(places.cells_touched(Plain, &own) >> cell & 1 != 0);
            assert!(places.rows_touched(Plain, cell, &own) >> (at / SIDE % ROW) & 1 != 0);
            let centres = places.centres(cell / LANES);
            let lane = cell % LANES;
            // Both were rounded.
            let rounding = 2.0 * SIDE as f64 / f64::from(1 << 24);
            let exact = f64::from(x) - f64::from(centres.x[lane]);
            assert!(exact.abs() <= f64::from(centres.half_x[lane]) + rounding);
            let exact = f64::from(y) - f64::from(centres.y[lane]);
            assert!(exact.abs() <= f64::from(centres.half_y[lane]) + rounding);
        }
        assert_eq!(places.cells_touched(Plain, &PlaceBox::EMPTY), 0);
    }
}
