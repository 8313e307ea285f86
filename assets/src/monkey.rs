//! A monkey's head: a blend of ellipsoids, meshed, with a region of colour for each feature.

use glam::{DVec2, DVec3};

use crate::cut::{cut, refine};
use crate::field::{blend, carve, ellipsoid, gradient, rod};
use crate::obj::{Corner, Face, Material, Model};
use crate::surface_nets::surface_net;
use crate::sweep::{ball, sweep};

const FUR: usize = 0;
const FACE: usize = 1;
const EAR: usize = 2;
const MOUTH: usize = 3;
const NOSTRIL: usize = 4;
const EYE_WHITE: usize = 5;
const IRIS_RIM: usize = 6;
const IRIS: usize = 7;
const PUPIL: usize = 8;
const GLINT: usize = 9;
const LID: usize = 10;
const MATERIALS: [Material; 11] = [
    Material::new("fur", 0x8a522c),
    Material::new("face_skin", 0xf0c498),
    Material::new("ear_inside", 0xe8a28a),
    Material::new("mouth", 0x642222),
    Material::new("nostril", 0x5a3024),
    Material::new("eye_white", 0xfbf8f0),
    Material::new("iris_rim", 0x5c3012),
    Material::new("iris", 0xa8621e),
    Material::new("pupil", 0x140e0c),
    Material::new("glint", 0xffffff),
    Material::new("lid", 0xe2ae80),
];

/// The width of the grid's cells.
const CELL: f64 = 0.096;

/// How far an edge may stand off the surface before it is halved.
const TOLERANCE: f64 = 0.008;

/// The cosine of the angle, some 25°, by which the solid's normal may differ from the faces'.
const AGREEMENT: f64 = 0.9;

const EYE_CENTRE: DVec3 = v(0.29, 0.2, 0.6);
const EYE_RADIUS: f64 = 0.25;
/// Where the right eye looks: straight on, a little outwards.
const GAZE: DVec3 = v(0.06, 0.02, 1.0);

/// The number of the monkey's triangles.
pub const MONKEY_TRIANGLES: u64 = 9602;

/// The head, some three units wide from ear to ear, looking along +Z. The skull, and each ball,
/// glint, lid and lock of fur, is a closed part.
pub fn monkey() -> Model {
    let mut shell = surface_net(skull, v(1.7, 1.5, 1.5), CELL);
    let bent = |a: DVec3, b: DVec3| skull(a.midpoint(b)).abs() > TOLERANCE;
    let at_engraving = |a: DVec3, b: DVec3| {
        let (middle, length) = (a.midpoint(b), a.distance(b));
        length > 0.035 && mouth(middle).min(nostril(middle)).abs() < length / 2.0
    };
    for _ in 0..2 {
        refine(&mut shell, skull, bent);
    }
    for _ in 0..3 {
        refine(&mut shell, skull, at_engraving);
    }
    cut(&mut shell, skull, face_region, |m| m == FUR, FACE);
    cut(&mut shell, skull, ear_region, |m| m == FUR, EAR);
    cut(&mut shell, skull, mouth, |m| m == FACE, MOUTH);
    cut(&mut shell, skull, nostril, |m| m == FACE, NOSTRIL);
    for p in &mut shell.positions {
        let depth = head(*p) - skull(*p);
        if depth > 0.0 {
            *p -= gradient(skull, *p).normalize() * depth;
        }
    }
    let shell = shell.mirrored();

    let mut model = Model {
        name: "monkey",
        about: "A monkey's head",
        materials: MATERIALS.to_vec(),
        positions: shell.positions,
        faces: shell
            .triangles
            .into_iter()
            .map(|(triangle, material)| Face {
                material,
                corners: triangle.map(Corner::all).to_vec(),
            })
            .collect(),
        ..Model::default()
    };
    // The solid's normals are smoother than the mean of the faces', but in a crease, or where the
    // surface was pushed in, they need not be on the faces' side.
    model.smooth_normals();
    for (normal, &p) in model.normals.iter_mut().zip(&model.positions) {
        let smoother = gradient(skull, p).normalize();
        if smoother.dot(*normal) > AGREEMENT {
            *normal = smoother;
        }
    }
    for part in right_eye().into_iter().chain(right_locks()) {
        model.append(part.mirrored());
        model.append(part);
    }
    model.append(lock(
        [v(0.0, 1.0, 0.0), v(0.0, 1.32, 0.0), v(0.0, 1.42, 0.3)],
        0.2,
    ));
    model.uvs = model
        .positions
        .iter()
        .map(|&p| texture_coordinate(p))
        .collect();
    for corner in model.faces.iter_mut().flat_map(|face| &mut face.corners) {
        corner.uv = corner.position;
    }
    model
}

/// The solid, eyeballs apart.
fn head(p: DVec3) -> f64 {
    skull(p) + engraving(mouth(p), 0.05) + engraving(nostril(p), 0.03)
}

/// How far the surface is pushed in within `region`, with a rounded step at its border.
fn engraving(region: f64, depth: f64) -> f64 {
    let t = (-region / 0.05).clamp(0.0, 1.0);
    depth * t * t * (3.0 - 2.0 * t)
}

/// The solid before mouth and nostrils are engraved.
fn skull(p: DVec3) -> f64 {
    let p = right_half(p);
    let at = |centre: DVec3, radii: DVec3| ellipsoid(p - centre, radii);
    let ball = |x: f64, y: f64, z: f64, radius: f64| (v(x, y, z), radius);

    let mut d = at(v(0.0, 0.25, -0.1), v(0.92, 0.88, 0.86));
    d = blend(d, at(v(0.0, -0.28, 0.0), v(0.8, 0.6, 0.68)), 0.3);

    // Ears: saucers.
    let q = ear_from_head(p);
    d = blend(d, ellipsoid(q, v(0.42, 0.44, 0.15)), 0.12);
    d = carve(
        d,
        ellipsoid(q - v(0.03, 0.0, 0.17), v(0.29, 0.31, 0.16)),
        0.08,
    );

    // Eye sockets under a brow ridge.
    d = carve(d, at(v(0.29, 0.19, 0.8), v(0.27, 0.27, 0.2)), 0.1);
    let ridge = rod(p, ball(0.06, 0.47, 0.7, 0.1), ball(0.3, 0.53, 0.68, 0.12));
    let ridge = blend(
        ridge,
        rod(p, ball(0.3, 0.53, 0.68, 0.12), ball(0.56, 0.42, 0.52, 0.09)),
        0.05,
    );
    d = blend(d, ridge, 0.16);

    // Muzzle and nose.
    d = blend(d, at(v(0.0, -0.42, 0.54), v(0.6, 0.4, 0.52)), 0.14);
    d = blend(
        d,
        rod(p, ball(0.0, 0.25, 0.7, 0.1), ball(0.0, -0.1, 0.94, 0.12)),
        0.14,
    );
    blend(d, at(v(0.0, -0.14, 0.99), v(0.19, 0.1, 0.12)), 0.08)
}

const fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn right_half(p: DVec3) -> DVec3 {
    v(p.x.abs(), p.y, p.z)
}

/// The space of the right ear: its disc's centre, and the direction that it faces as Z.
fn ear_from_head(p: DVec3) -> DVec3 {
    let p = p - v(1.1, 0.22, -0.12);
    v(0.94 * p.x + 0.34 * p.z, p.y, -0.34 * p.x + 0.94 * p.z)
}

/// A smile seen from the front: between two parabolas that meet at its corners.
fn mouth(p: DVec3) -> f64 {
    let square = p.x * p.x;
    let above = p.y - (-0.55 + 0.6 * square);
    let below = (-0.66 + 1.2 * square) - p.y;
    above.max(below).max(0.3 - p.z)
}

fn nostril(p: DVec3) -> f64 {
    let q = v(p.x.abs() - 0.085, p.y + 0.15, 0.0);
    ellipsoid(q, v(0.055, 0.042, 1.0)).max(0.8 - p.z)
}

/// Seen from the front: the eyes' surrounds above, the muzzle below.
fn face_region(p: DVec3) -> f64 {
    // Above, leaning back, or the border would run over the top of the ridge.
    let lean = 0.4 * (0.7 - p.z).max(0.0);
    let q = v(p.x.abs(), p.y, 0.0);
    let eye = ellipsoid(q - v(0.3, 0.24 - lean, 0.0), v(0.4, 0.41, 1.0));
    let muzzle = ellipsoid(q - v(0.0, -0.42, 0.0), v(0.66, 0.46, 1.0));
    blend(eye, muzzle, 0.15).max(0.05 - p.z)
}

fn ear_region(p: DVec3) -> f64 {
    let q = ear_from_head(right_half(p));
    ellipsoid(v(q.x - 0.03, q.y, 0.0), v(0.29, 0.31, 1.0))
        .max(-q.z)
        .max(q.z - 0.16)
}

/// Azimuthal coordinates: the face in the middle, angles from the view axis as distances, so that
/// a pattern keeps its size up to the ears. The back of the head is the front's mirror image, which
/// leaves no seam; a texture should tile, as the rim goes past its edge.
fn texture_coordinate(p: DVec3) -> DVec2 {
    let across = p.truncate();
    let rho = across.length();
    if rho == 0.0 {
        return DVec2::splat(0.5);
    }
    let from_axis = libm::atan2(rho, p.z.abs());
    // On the unit sphere this is the angle; whatever stands out from it keeps its length.
    let radius = from_axis + rho - libm::sin(from_axis);
    DVec2::splat(0.5) + across / rho * radius * 0.35
}

/// Ball, glint and lids.
fn right_eye() -> Vec<Model> {
    let gaze = GAZE.normalize();
    let rings = [
        (0.0, PUPIL),
        (11.0, PUPIL),
        (22.0, PUPIL),
        (36.0, IRIS),
        (43.0, IRIS_RIM),
        (57.0, EYE_WHITE),
        (75.0, EYE_WHITE),
        (100.0, EYE_WHITE),
        (140.0, EYE_WHITE),
        (180.0, EYE_WHITE),
    ];
    let eye = ball(EYE_CENTRE, EYE_RADIUS, gaze, &rings);

    let out = (gaze + v(0.19, 0.28, 0.0)).normalize();
    let rings = [0.0, 40.0, 80.0, 130.0, 180.0].map(|angle| (angle, GLINT));
    let glint = ball(EYE_CENTRE + out * (EYE_RADIUS * 0.97), 0.045, out, &rings);

    let lid = |up: DVec3, edge: f64| {
        let up = up.normalize();
        let rings: Vec<_> = (0..=6)
            .map(|ring| (edge * f64::from(ring) / 6.0, LID))
            .collect();
        let mut cap = ball(EYE_CENTRE, EYE_RADIUS + 0.02, up, &rings);
        let (floor, ..) = cap[cap.len() - 1];
        cap.push((floor, 0.0, LID));
        sweep(&cap, 32, DVec3::X)
    };
    vec![
        sweep(&eye, 24, DVec3::X),
        sweep(&glint, 12, DVec3::X),
        lid(v(0.02, 0.95, -0.17), 65.0),
        lid(v(0.05, -0.95, -0.22), 54.0),
    ]
}

/// Tufts of fur on the cheek and on the crown.
fn right_locks() -> Vec<Model> {
    vec![
        lock(
            [v(0.05, 1.0, 0.0), v(0.3, 1.22, 0.0), v(0.36, 1.3, 0.2)],
            0.17,
        ),
        lock(
            [
                v(0.55, -0.05, -0.02),
                v(0.9, -0.2, 0.0),
                v(1.02, -0.48, 0.04),
            ],
            0.3,
        ),
        lock(
            [
                v(0.5, -0.25, 0.0),
                v(0.84, -0.46, 0.03),
                v(0.92, -0.76, 0.07),
            ],
            0.3,
        ),
        lock(
            [
                v(0.35, -0.4, 0.0),
                v(0.64, -0.72, 0.03),
                v(0.66, -0.98, 0.08),
            ],
            0.28,
        ),
    ]
}

/// A lock of fur along a quadratic Bézier curve, pointed at its end.
fn lock([start, middle, end]: [DVec3; 3], radius: f64) -> Model {
    let steps = 8;
    let stations: Vec<_> = (0..=steps)
        .map(|step| {
            let t = f64::from(step) / f64::from(steps);
            let spine = start.lerp(middle, t).lerp(middle.lerp(end, t), t);
            let swell = (t * 6.0).min(1.0) * (1.0 - t * t);
            (spine, radius * swell, FUR)
        })
        .collect();
    sweep(&stations, 10, DVec3::Z)
}
