//! Hostile scenes, and as many ordinary triangles in the same place.

use super::scene_pair::{
    EYE, ScenePair, SceneView, ordinary, ordinary_pair, pair, pair_from_the_origin, pair_on_grid,
    single_mesh, soups_in, to_f32, triangles_on,
};
use crate::meshes::{self, mesh, soup};
use crate::stage::scene_of;
use raycast_core::glam::DVec3;
use raycast_core::math;
use raycast_core::scene::{Object, Scene};
use raycast_oracle::random::Random;
use std::f64::consts::TAU;
use std::sync::Arc;

pub(super) fn cone() -> ScenePair {
    let around = |step: u32| {
        let (sin, cos) = math::sin_cos(TAU * f64::from(step) / 64.0);
        DVec3::new(cos, sin, 0.0)
    };
    let from = |apex: DVec3| {
        let triangle = |step| [apex, around(step), around(step + 1)];
        single_mesh(soup(&(0..64).map(triangle).collect::<Vec<_>>()))
    };
    pair(EYE, from(EYE), from(DVec3::Z * 0.5))
}

/// 12 random triangles with a corner of their own.
fn random_fan(corner: impl Fn(&mut Random) -> [DVec3; 2]) -> Scene {
    let mut random = Random::new(420);
    let triangles: Vec<[DVec3; 3]> = (0..12)
        .map(|_| {
            let [a, b] = corner(&mut random);
            let c = random.in_cube() * 2.0;
            [a, b, c]
        })
        .collect();
    single_mesh(soup(&triangles))
}

pub(super) fn shared_vertex() -> ScenePair {
    let hostile = random_fan(|random| [EYE, random.in_cube() * 2.0]);
    pair(EYE, hostile, ordinary(12, 1.0))
}

pub(super) fn shared_edge() -> ScenePair {
    let along = DVec3::new(0.5, -0.125, 1.0);
    let hostile = random_fan(|_| [EYE - along, EYE + along]);
    pair(EYE, hostile, ordinary(12, 1.0))
}

/// Planes that hold the eye, and for orthographic rays the image plane.
pub(super) fn shared_plane() -> ScenePair {
    let (eye, far) = (DVec3::new(0.0, 0.0, 3.0), 64.0);
    let corners: Vec<[DVec3; 3]> = (0..12)
        .map(|i| {
            let turn = TAU * f64::from(i) / 12.0;
            let corner =
                |turn: f64| to_f32(DVec3::new(math::cos(turn), math::sin(turn), 0.0) * far);
            match i % 3 {
                // All around the eye, in the image plane.
                0 => [
                    corner(turn),
                    corner(turn + TAU / 3.0),
                    corner(turn - TAU / 3.0),
                ],
                // Edge-on, from the eye to far behind the target.
                1 => [eye, corner(turn), DVec3::NEG_Z * far],
                _ => [DVec3::Z * far, corner(turn), DVec3::NEG_Z * far],
            }
            .map(|corner| if i % 3 == 0 { corner + eye } else { corner })
        })
        .collect();
    // Something to be seen behind them all.
    let behind = meshes::sphere(DVec3::ZERO, 0.5, 8);
    pair(
        eye,
        scene_of([soup(&corners), behind]),
        ordinary(12 + 48, 1.0),
    )
}

pub(super) fn next_to_vertex() -> ScenePair {
    let ScenePair { hostile, .. } = shared_vertex();
    let eye = DVec3::from_array(EYE.to_array().map(f64::next_up));
    pair(eye, hostile.scene, ordinary(12, 1.0))
}

pub(super) fn coincident() -> ScenePair {
    let corners = vec![
        DVec3::new(-2.0, -2.0, 0.25),
        DVec3::new(2.0, -2.0, -0.5),
        DVec3::Y * 3.0,
    ];
    let count = 20_000;
    let turns = [[0, 1, 2], [1, 2, 0], [2, 1, 0]];
    let triangles = (0..count).map(|i| turns[i % 3]).collect();
    pair(
        EYE,
        single_mesh(mesh(corners, triangles)),
        ordinary(count, 1.0),
    )
}

pub(super) fn mesh_copies() -> ScenePair {
    let sphere = Arc::new(meshes::sphere(DVec3::ZERO, 1.0, 12));
    let count = sphere.triangles().len();
    let objects = (0..1000).map(|_| Object::new("copy", Arc::clone(&sphere)));
    let hostile = Scene {
        objects: objects.collect(),
    };
    pair(EYE, hostile, ordinary(1000 * count, 0.5))
}

pub(super) fn exponents() -> ScenePair {
    let mut random = Random::new(430);
    let mut number = || random.between(-1.0, 1.0).signum() * random.decade(-18.0, 18.0);
    let corners: Vec<[DVec3; 3]> = (0..5000)
        .map(|_| [(); 3].map(|()| DVec3::new(number(), number(), number())))
        .collect();
    pair(EYE, single_mesh(soup(&corners)), ordinary(5000, 0.5))
}

pub(super) fn about_eye() -> ScenePair {
    let mut random = Random::new(580);
    let about = triangles_on(6000, || random.in_cube() * random.decade(-12.0, 12.0));
    let ordinary = triangles_on(6000, || random.in_cube() * 4.0);
    pair_from_the_origin(&about, &ordinary)
}

pub(super) fn thin_boxes() -> ScenePair {
    let boxes = (0..30_000).map(|i| {
        let z = -1e-4 * f64::from(i);
        meshes::cuboid(DVec3::new(-1.0, -1.0, z - 1e-7), DVec3::new(1.0, 1.0, z))
    });
    let corners: Vec<[DVec3; 3]> = boxes
        .flat_map(|b| {
            let triangle = |n| b.corners(n).unwrap_or_default();
            let all = (0..12).map(triangle);
            all.map(|t| t.map(|c| b.offset() + c.as_dvec3()))
                .collect::<Vec<_>>()
        })
        .collect();
    pair(
        EYE,
        single_mesh(soup(&corners)),
        ordinary(corners.len(), 0.02),
    )
}

/// A sphere along no axis, and one as large in the picture of a camera next to it.
fn distant_sphere(radius: f64) -> ScenePair {
    let view_of = |radius: f64| SceneView {
        scene: single_mesh(meshes::sphere(DVec3::ZERO, radius, 40)),
        view: (DVec3::new(1.0, 2.0, 4.0), DVec3::ZERO, 3.0 * radius),
    };
    ScenePair {
        hostile: view_of(radius),
        ordinary: vec![view_of(1.0)],
    }
}

pub(super) fn tiny_and_far() -> ScenePair {
    distant_sphere(2e-11)
}

pub(super) fn closer_than_roundings() -> ScenePair {
    distant_sphere(2e-15)
}

/// Triangles about an edge, seen next to its corner by parallel rays that are roundings of their origins apart.
pub(super) fn roundings_apart() -> ScenePair {
    let mut random = Random::new(580);
    let ends = [(); 2].map(|()| to_f32(random.in_cube()));
    let fan: Vec<_> = (0..300)
        .map(|_| [ends[0], ends[1], random.in_cube()])
        .collect();
    let eye = ends[0] + random.in_cube() * 3e-8;
    ordinary_pair((eye, ends[0], 2e-14), &fan)
}

/// Large triangles about a corner, from 1e13 of their lengths away and next to them.
pub(super) fn far_fan() -> ScenePair {
    let mut random = Random::new(445);
    let mut corner = || random.in_cube();
    let fan: Vec<_> = (0..6000)
        .map(|_| [DVec3::ZERO, corner(), corner()])
        .collect();
    let view_from = |eye: DVec3| SceneView {
        scene: single_mesh(soup(&fan)),
        view: (eye, DVec3::ZERO, 2.0),
    };
    ScenePair {
        hostile: view_from(DVec3::new(1.0, 2.0, 4.0) * 4e12),
        ordinary: vec![view_from(DVec3::new(1.0, 2.0, 4.0))],
    }
}

/// A part of some 1e-5 of a scene, whose coordinates have random exponents, from a billion of its lengths away: rays are as
/// far apart there as directions are rounded.
pub(super) fn far_part() -> ScenePair {
    let mut random = Random::new(620);
    let mut number = || random.between(-1.0, 1.0).signum() * random.decade(-16.0, 4.2);
    let triangles = triangles_on(125, || DVec3::new(number(), number(), number()));
    let eye = DVec3::new(1.0, 2.0, 4.0) * 4e12;
    ordinary_pair((eye, DVec3::ZERO, 0.14), &triangles)
}

/// Slices of a disc about the view axis, which meet it at heights of their own, seen from between these: as flat as
/// doubles can tell, and as deep as wide.
pub(super) fn flat_disc() -> ScenePair {
    let view_of = |height: f64| {
        let mut random = Random::new(590);
        let count = 2880;
        let rim = |slice: i32| {
            let (sin, cos) = math::sin_cos(TAU * f64::from(slice) / f64::from(count));
            DVec3::new(cos, sin, 0.0)
        };
        let slices: Vec<_> = (0..count)
            .map(|slice| {
                let middle = DVec3::Z * random.between(-height, height);
                [middle, rim(slice), rim(slice + 1)]
            })
            .collect();
        SceneView {
            scene: single_mesh(soup(&slices)),
            view: (DVec3::Z * (-0.7 * height), DVec3::ZERO, 2.0),
        }
    };
    ScenePair {
        hostile: view_of(1e-15),
        ordinary: vec![view_of(1.0)],
    }
}

/// Triangles of one plane that no axis lies in, around its middle.
pub(super) fn one_plane() -> ScenePair {
    let mut random = Random::new(440);
    let (u, v) = (DVec3::new(1.0, 0.25, -0.5), DVec3::new(-0.25, 1.0, 0.75));
    let corners: Vec<[DVec3; 3]> = (0..64)
        .map(|_| {
            let turn = random.between(0.0, TAU);
            [0.0, 1.0, 2.0].map(|third: f64| {
                let (sin, cos) = math::sin_cos(turn + third * TAU / 3.0);
                // Whole places hold the plane exactly.
                (u * (cos * 256.0).round() + v * (sin * 256.0).round()) / 64.0
            })
        })
        .collect();
    pair(EYE, single_mesh(soup(&corners)), ordinary(64, 1.0))
}

/// The corners of layers, as single precision holds them.
const LAYER: [DVec3; 3] = [
    DVec3::new(-1.0, -1.0, 0.1),
    DVec3::new(1.1, -1.0, 0.2),
    DVec3::new(0.1, 1.2, 0.3),
];

/// Triangles of these corners, each coordinate moved by up to three units in its last place; and as many whose corners
/// are moved by up to 0.3.
fn layers(count: usize, corners: [DVec3; 3]) -> [Scene; 2] {
    let mut random = Random::new(450);
    let mut moved = |x: f64| {
        let steps = random.between(-3.5, 3.5).round() as i32;
        let x = x as f32;
        let step = |x: f32| {
            if steps < 0 {
                x.next_down()
            } else {
                x.next_up()
            }
        };
        f64::from((0..steps.abs()).fold(x, |x, _| step(x)))
    };
    let mut hostile = || corners.map(|c| DVec3::from_array(c.to_array().map(&mut moved)));
    let hostile: Vec<[DVec3; 3]> = (0..count).map(|_| hostile()).collect();
    let mut random = Random::new(460);
    let mut ordinary = || corners.map(|corner| corner + random.in_cube() * 0.3);
    let ordinary: Vec<[DVec3; 3]> = (0..count).map(|_| ordinary()).collect();
    [hostile, ordinary].map(|corners| single_mesh(soup(&corners)))
}

pub(super) fn rounded_layers() -> ScenePair {
    let [hostile, ordinary] = layers(20_000, LAYER);
    pair(DVec3::Z * 3.0, hostile, ordinary)
}

pub(super) fn subnormal_layers() -> ScenePair {
    let [hostile, ordinary] = layers(2000, LAYER.map(|corner| corner.with_z(0.0)));
    pair(DVec3::Z * 3.0, hostile, ordinary)
}

pub(super) fn next_to_layers() -> ScenePair {
    let [hostile, ordinary] = layers(2000, LAYER);
    let away = DVec3::new(1e-8, 2e-8, 1e-7);
    pair(to_f32(LAYER[0]) + away, hostile, ordinary)
}

/// 4,000 triangles with a corner at the eye, a million units from the origin.
pub(super) fn far_vertex() -> ScenePair {
    let far = DVec3::new(-800_817.0, 281_754.0, 893_990.0);
    let eye = far + EYE;
    let mut random = Random::new(470);
    // Sixteenths are represented exactly, wherever the mesh's offset is.
    let mut sixteenths = || far + (random.in_cube() * 32.0).round() / 16.0;
    let fan: Vec<[DVec3; 3]> = (0..4000)
        .map(|_| [eye, sixteenths(), sixteenths()])
        .collect();
    let mut moved = |corner: DVec3| corner + random.in_cube() * 0.3;
    let ordinary: Vec<[DVec3; 3]> = fan.iter().map(|corners| corners.map(&mut moved)).collect();
    soups_in((eye, far, 2.0), &fan, &ordinary)
}

/// 200 triangles about the eye, across the view, their corners a rounding or so from one plane.
pub(super) fn between_layers() -> ScenePair {
    let eye = DVec3::new(-0.436, -2.63, 2.683);
    let across = eye.normalize().any_orthonormal_vector();
    let up = eye.normalize().cross(across);
    let corners = [up - across, up + across, -up].map(|corner| eye + corner);
    let [hostile, ordinary] = layers(200, corners);
    pair(eye, hostile, ordinary)
}

/// 4,000 triangles around the eye, whose corners are in its plane or beside it by the least number.
pub(super) fn next_to_planes() -> ScenePair {
    let mut random = Random::new(480);
    let least = f64::from(f32::from_bits(1));
    let mut corner = || {
        let y = if random.between(-1.0, 1.0) < 0.0 {
            0.0
        } else {
            least
        };
        (random.in_cube() * 3.0).with_y(y)
    };
    let hostile: Vec<[DVec3; 3]> = (0..4000).map(|_| [(); 3].map(|()| corner())).collect();
    let mut moved = |corner: DVec3| corner + random.in_cube() * 0.3;
    let ordinary: Vec<[DVec3; 3]> =
        (hostile.iter().map(|corners| corners.map(&mut moved))).collect();
    let [hostile, ordinary] = [hostile, ordinary].map(|corners| single_mesh(soup(&corners)));
    pair(DVec3::new(1.0, 0.0, 2.0), hostile, ordinary)
}

pub(super) fn integer_plane() -> ScenePair {
    let mut random = Random::new(490);
    let whole = triangles_on(12_000, || (random.in_cube() * 8.0).round().with_z(0.0));
    let ordinary = triangles_on(12_000, || random.in_cube() * 8.0);
    pair_on_grid(&whole, &ordinary)
}

pub(super) fn rounded_plane() -> ScenePair {
    let mut random = Random::new(500);
    let tilted = triangles_on(15_000, || {
        let at = random.in_cube() * 8.0;
        at.with_z(0.37 * at.x + 0.21 * at.y)
    });
    let ordinary = triangles_on(15_000, || random.in_cube() * 8.0);
    pair_on_grid(&tilted, &ordinary)
}

pub(super) fn crossing_layers() -> ScenePair {
    let mut random = Random::new(510);
    let least = f64::from(f32::from_bits(1));
    let layers = triangles_on(16_000, || {
        let at = random.in_cube() * 8.0;
        at.with_z((at.z * 2000.0).round() * least)
    });
    let ordinary = triangles_on(16_000, || random.in_cube() * 8.0);
    pair_on_grid(&layers, &ordinary)
}

/// A corner of the plane z = x − 2y with whole coordinates, but up to some 1e-41 off it where z is zero.
fn on_tilted_plane(random: &mut Random, size: f64) -> DVec3 {
    let at = (random.in_cube() * size).round();
    let least = f64::from(f32::from_bits(1));
    match at.x - 2.0 * at.y {
        0.0 => at.with_z(at.z * 1e3 * least),
        z => at.with_z(z),
    }
}

pub(super) fn tilted_layers() -> ScenePair {
    let mut random = Random::new(560);
    let layers = triangles_on(8000, || on_tilted_plane(&mut random, 4.0));
    let ordinary = triangles_on(8000, || random.in_cube() * 4.0);
    soups_in(
        (DVec3::new(6.0, 2.0, 16.0), DVec3::ZERO, 8.0),
        &layers,
        &ordinary,
    )
}

pub(super) fn next_to_tilted_layers() -> ScenePair {
    let mut random = Random::new(570);
    let layers = triangles_on(2000, || on_tilted_plane(&mut random, 4.0));
    let ordinary = triangles_on(2000, || random.in_cube() * 4.0);
    pair_from_the_origin(&layers, &ordinary)
}

/// A plane with whole coordinates, whose normal orthographic rays follow from a point in it on.
pub(super) fn ray_plane() -> ScenePair {
    let mut random = Random::new(520);
    let tilted = triangles_on(12_000, || {
        let at = (random.in_cube() * 8.0).round();
        at.with_z(2.0 * at.x - 3.0 * at.y)
    });
    let ordinary = triangles_on(12_000, || random.in_cube() * 8.0);
    let eye = DVec3::new(0.5, 0.5, -0.5);
    soups_in(
        (eye, eye + DVec3::new(2.0, -3.0, -1.0), 24.0),
        &tilted,
        &ordinary,
    )
}

/// Triangles that all have the origin as a corner.
pub(super) fn next_to_fan() -> ScenePair {
    let mut random = Random::new(530);
    let mut corner = || random.in_cube();
    let fan: Vec<[DVec3; 3]> = (0..4000)
        .map(|_| [DVec3::ZERO, corner(), corner()])
        .collect();
    let ordinary = triangles_on(4000, || random.in_cube());
    pair_from_the_origin(&fan, &ordinary)
}

/// Thirds of discs around the origin, stacked, with a corner there.
pub(super) fn next_to_discs() -> ScenePair {
    let mut random = Random::new(540);
    let third = |disc: u32| {
        let corner = |turn: u32| {
            let (sin, cos) = math::sin_cos(TAU * f64::from(turn) / 3.0);
            DVec3::new(cos, sin, f64::from(disc) * 1e-12)
        };
        [corner(disc), corner(disc + 1), DVec3::ZERO]
    };
    let discs: Vec<[DVec3; 3]> = (0..4000).map(third).collect();
    let ordinary = triangles_on(4000, || random.in_cube());
    pair_from_the_origin(&discs, &ordinary)
}

/// Triangles of a plane through the origin with corners at multiples of an eighth.
pub(super) fn next_to_grid_plane() -> ScenePair {
    let mut random = Random::new(550);
    let in_plane = triangles_on(4000, || {
        let at = (random.in_cube() * 8.0).round() / 8.0;
        at.with_z(at.x)
    });
    let ordinary = triangles_on(4000, || random.in_cube());
    pair_from_the_origin(&in_plane, &ordinary)
}

/// Needles of which one has the eye in its middle but for rounding: it fills half of the picture.
pub(super) fn inside_needle() -> ScenePair {
    let mut random = Random::new(560);
    let mut needle = |middle: DVec3| {
        let (along, aside) = (random.in_cube(), random.in_cube() * 1e-7);
        [middle - along, middle + along, middle + aside].map(to_f32)
    };
    let held = needle(DVec3::ZERO);
    let [a, b, c] = held;
    let mut places = Random::new(561);
    let mut needles = vec![held];
    needles.extend((1..300).map(|_| needle(places.in_cube())));
    let view_of = |scene| SceneView {
        scene,
        view: ((a + b + c) / 3.0, DVec3::new(0.25, -0.5, -1.0), 1.0),
    };
    ScenePair {
        hostile: view_of(single_mesh(soup(&needles))),
        ordinary: vec![view_of(ordinary(300, 1.0))],
    }
}
