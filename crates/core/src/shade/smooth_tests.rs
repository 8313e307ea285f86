//! Smooth shading of eight pixels against one pixel, float by float, with every instruction set: bytes
//! forgive what a fused multiplication changes, nearly always.

use super::LightSet;
use super::facet::Facet;
use super::light::Lights;
use super::smooth::{EightLights, Facets, to_eye};
use super::vectors::{Row, Rows, Vectors};
use crate::Simd;
use crate::camera::{Camera, ImagePlane, Pose, Projection};
use crate::num::simd::{LANES, Lanes, Work, dispatch};
use crate::random::Random;
use glam::{DVec3, Vec3};

/// Eight pixels of a triangle.
struct Pixels<'a> {
    facet: &'a Facet,
    lights: &'a Lights,
    to_eye: &'a [Vec3; 3],
    weights: (&'a Row, &'a Row),
    place: (&'a Row, f32),
    colors: &'a mut Rows,
}

impl Work for Pixels<'_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let facets = Facets::one(lanes, self.facet);
        let to_eye = to_eye(lanes, self.to_eye, self.place);
        let (u, v) = self.weights;
        let normal = facets.normal_at(lanes, lanes.load(u), lanes.load(v));
        let light = EightLights::new(self.lights).on(lanes, normal, to_eye);
        let color = Vectors::splat(lanes, self.facet.color);
        *self.colors = color.times(light).store();
    }
}

#[test]
fn every_instruction_set_gives_one_pixels_colours_to_the_bit() {
    let plane = ImagePlane::new(64, 64, 0.1).expect("a good plane");
    let pose = Pose {
        eye: DVec3::new(3.0, 4.0, 5.0),
        target: DVec3::ZERO,
        up: DVec3::Y,
    };
    let camera = Camera::new(pose, Projection::Perspective, plane);
    let sets = [LightSet::Soft, LightSet::Headlight, LightSet::ThreePoint];
    let mut random = Random(31);
    for round in 0..3000 {
        let lights = Lights::new(&camera, sets[round / 6 % 3]);
        let mut vector = || random.point().as_vec3();
        let facet = Facet {
            normal: vector().normalize(),
            normals: (round % 3 > 0).then(|| [vector(), vector(), vector()]),
            color: vector().abs(),
            ..Facet::NONE
        };
        let to_eye = [vector() * 9.0, vector() * 0.1, vector() * 0.1];
        let [u, v, x]: [Row; 3] = [0, 1, 2].map(|row| {
            std::array::from_fn(|lane| match row {
                2 => lane as f32 + 0.5,
                _ => random.unit() as f32 * 0.5,
            })
        });
        let y = (random.unit() * 4000.0) as f32;
        let expected: [Vec3; LANES] = std::array::from_fn(|lane| {
            let [corner, right, down] = to_eye;
            let to_eye = corner + right * x[lane] + down * y;
            let normal = facet.normal_at(u[lane], v[lane]);
            facet.color * lights.on(normal, to_eye * (1.0 / to_eye.length()))
        });
        for simd in Simd::available() {
            let mut colors = Rows::ZERO;
            let pixels = Pixels {
                facet: &facet,
                lights: &lights,
                to_eye: &to_eye,
                weights: (&u, &v),
                place: (&x, y),
                colors: &mut colors,
            };
            dispatch(simd, pixels);
            for (lane, expected) in expected.iter().enumerate() {
                let found = colors.0.map(|row| row[lane].to_bits());
                let expected = expected.to_array().map(f32::to_bits);
                assert_eq!(found, expected, "{simd:?}, round {round}, lane {lane}");
            }
        }
    }
}
