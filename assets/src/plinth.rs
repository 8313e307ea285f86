//! A round plinth to stand things on.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use crate::obj::{Material, Model};
use crate::sweep::{Station, sweep};

const SEGMENTS: usize = 96;
const HEIGHT: f64 = 0.1;
/// The radius of its rounded upper edge.
const EDGE: f64 = 0.03;

const TOP: usize = 0;
const INLAY: usize = 1;
const SIDE: usize = 2;
const MATERIALS: [Material; 3] = [
    Material::new("top", 0xece7dd),
    Material::new("inlay", 0xc2a87e),
    Material::new("side", 0xd8d0c2),
];

/// The plinth: radius 1 and a rounded edge, its top at `y = 0`.
pub(crate) fn plinth() -> Model {
    let top = [
        (0.0, TOP),
        (0.4, TOP),
        (0.8, TOP),
        (0.84, INLAY),
        (0.9, TOP),
        (1.0 - EDGE, TOP),
    ];
    let mut stations: Vec<Station> = top
        .map(|(radius, material)| (DVec3::ZERO, radius, material))
        .to_vec();
    for step in 1..=4 {
        let (sin, cos) = libm::sincos(FRAC_PI_2 * f64::from(step) / 4.0);
        stations.push((
            DVec3::NEG_Y * (EDGE * (1.0 - cos)),
            1.0 - EDGE * (1.0 - sin),
            SIDE,
        ));
    }
    for (height, radius) in [
        (EDGE * 1.5, 1.0),
        (HEIGHT, 1.0),
        (HEIGHT, 0.9),
        (HEIGHT, 0.0),
    ] {
        stations.push((DVec3::NEG_Y * height, radius, SIDE));
    }
    Model {
        name: "plinth",
        about: "A round plinth",
        materials: MATERIALS.to_vec(),
        ..sweep(&stations, SEGMENTS, DVec3::Z)
    }
}
