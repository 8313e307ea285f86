//! Packets, single rays, brute force and the oracle compared with one another, on scenes made from bytes: the
//! kernel's fuzz target.
//!
//! Bytes select a small mesh, a camera and a part of its rays, from numbers that are hard for kernels: equal ones,
//! both zeros, neighbours in the last place, tiny and huge ones, corners that triangles share, eyes in corners, on
//! edges and in planes. Missing bytes count as zeros.

use crate::meshes::mesh;
use crate::stage::{Stage, scene_of};
use crate::wrong_answer::compare;
use raycast_core::Simd;
use raycast_core::camera::{
    BrownConrady, Camera, ImagePlane, Lattice, Panorama, Pose, Projection, Ray, Rect,
};
use raycast_core::glam::DVec3;
use raycast_core::packet::MultiHits;
use raycast_core::scene::{ClippingPlane, ClippingPlanes};
use raycast_core::{Accel, Cull, Detail, Precision, PrimitiveHit};
use std::collections::HashSet;

/// The most triangles; `MAX_CORNERS` limits the corners that they share.
const MAX_TRIANGLES: usize = 64;
const MAX_CORNERS: usize = 24;

/// Rays of a lattice that are compared with the oracle and brute force, besides those next to a ray that hits
/// something else.
const SPREAD_RAYS: usize = 24;
/// The most of those.
const MAX_BORDER_RAYS: usize = 40;

/// The scene and rays that bytes describe.
#[derive(Debug)]
pub struct Scenario {
    /// The mesh, its tree and the truth about it.
    pub stage: Stage,
    /// The rays.
    pub lattice: Lattice,
    /// Which faces the rays hit.
    pub cull: Cull,
}

/// Builds the scenario of these bytes, and checks it.
///
/// # Errors
/// The first answer that is wrong, or differs from another caster's, with all that is needed to reproduce it.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    scenario(bytes).map_or(Ok(()), |scenario| scenario.check())
}

/// The scenario of these bytes; `None` where it is invalid.
pub fn scenario(bytes: &[u8]) -> Option<Scenario> {
    let mut source = Source(bytes.iter());
    let points = source.points();
    let count = 1 + source.below(MAX_TRIANGLES);
    let triangles = (0..count).map(|_| [(); 3].map(|()| source.below(points.len()) as u32));
    let triangles: Vec<[u32; 3]> = triangles.collect();
    let projection = source.projection();
    let cull = [Cull::None, Cull::Back][source.below(2)];
    let eye = source.place(&points, &triangles);
    let target = source.place(&points, &triangles);
    let up = [DVec3::Y, DVec3::Z, DVec3::ZERO, DVec3::new(1.0, 2.0, -0.5)][source.below(4)];
    let pose = Pose { eye, target, up };
    let distance = match (eye - target).length() {
        0.0 => 1.0,
        distance => distance,
    };
    let [width, height] = [1 + source.below(32) as u32, 1 + source.below(32) as u32];
    let stride = [1, 1, 1, 2, 3, 16][source.below(6)];
    let first = [0, 0, 1, 7, 100, 16_381][source.below(6)];
    let step = match source.below(4) {
        0 => distance * 10f64.powi(source.below(20) as i32 - 17),
        1 => 2f64.powi(source.below(64) as i32 - 48),
        _ => distance * [2.0, 1.0, 0.1, 0.01][source.below(4)] / f64::from(height * stride),
    };
    let [columns, rows] = [width, height].map(|side| side * stride + 2 * first);
    let plane = ImagePlane::new(columns, rows, step).ok()?;
    let rect = Rect {
        x: first,
        y: first,
        width: width * stride,
        height: height * stride,
    };
    let offset = [(); 2].map(|()| match source.below(4) {
        0 => 0.0,
        1 => f64::from(source.byte()) / 256.0,
        _ => 0.5,
    });
    let lattice = Lattice {
        offset: offset.into(),
        ..Camera::new(pose, projection, plane)
            .sub_camera(rect)
            .sparse_lattice(stride, (0, 0))
    };
    let mut clip = ClippingPlanes::NONE;
    for _ in 0..source.below(4) {
        if let Some(plane) = source.plane(&points, &triangles, eye) {
            clip.push(plane).ok()?;
        }
    }
    let stage = Stage::new(scene_of([mesh(points, triangles)])).ok()?;
    let stage = stage.clipped(clip);
    Some(Scenario {
        stage,
        lattice,
        cull,
    })
}

impl Scenario {
    /// Checks each ray of the lattice: with every instruction set the single ray's hit, bit for bit; and for some
    /// rays brute force's, and the truth, of their closest hits and of all in order.
    ///
    /// # Errors
    /// As [`check`].
    pub fn check(&self) -> Result<(), String> {
        let Self {
            stage,
            lattice,
            cull,
        } = self;
        let clipped = stage.clipped_accel();
        let single = |ray: &Ray| clipped.cast_primitive(ray, *cull, Precision::Exact);
        let expected: Vec<PrimitiveHit> =
            (0..lattice.len()).map(|i| single(&self.ray(i))).collect();
        let mut all = Vec::new();
        for simd in Simd::available() {
            let accel = Accel::clone(&stage.accel).with_simd(simd);
            let mut of_set = MultiHits::default();
            let clipped = accel.clipped(&stage.clip());
            clipped.find_all(lattice, *cull, &mut of_set);
            all.push((simd, of_set));
            let mut found = Vec::new();
            clipped.cast_lattice(lattice, *cull, Precision::Exact, Detail::Full, &mut found);
            let differs = (0..lattice.len()).find(|&i| found.get(i) != expected.get(i));
            if let Some(i) = differs {
                let (found, expected) = (found.get(i), &expected[i]);
                let name = simd.name();
                return Err(self.describe(
                    i,
                    &format!("{name} tiles gave {found:?}, the single ray {expected:?}"),
                ));
            }
        }
        let every = lattice.len().div_ceil(SPREAD_RAYS).max(1);
        let spread = (0..lattice.len()).step_by(every);
        let differs = |i: usize, j: usize| {
            expected
                .get(j)
                .is_some_and(|hit| hit.primitive != expected[i].primitive)
        };
        let columns = lattice.columns as usize;
        let is_border = |&i: &usize| differs(i, i + 1) || differs(i, i + columns);
        let borders = (0..lattice.len()).filter(is_border).take(MAX_BORDER_RAYS);
        // The tree keeps one of equal triangles.
        let kept: HashSet<_> = stage
            .accel
            .primitives()
            .map(|p| stage.accel.identify(p))
            .collect();
        for i in spread.chain(borders) {
            self.check_ray(i)?;
            let hits = stage.hits_in_order(&self.ray(i), *cull);
            let numbers = hits.iter().map(|truth| (truth.object, truth.triangle));
            let truth: Vec<_> = numbers.filter(|numbers| kept.contains(numbers)).collect();
            for (simd, found) in &all {
                let found = found.of(i).iter().map(|&p| stage.accel.identify(p));
                if !found.clone().eq(truth.iter().copied()) {
                    let (name, found) = (simd.name(), found.collect::<Vec<_>>());
                    let fault = format!("{name} found the hits {found:?}, in truth {truth:?}");
                    return Err(self.describe(i, &fault));
                }
            }
        }
        Ok(())
    }

    fn check_ray(&self, i: usize) -> Result<(), String> {
        let Self { stage, cull, .. } = self;
        let ray = self.ray(i);
        let cast = stage.clipped_accel().cast(&ray, *cull);
        let brute = stage.clipped_accel().cast_brute_force(&ray, *cull);
        if cast != brute {
            return Err(self.describe(i, &format!("the tree gave {cast:?}, brute force {brute:?}")));
        }
        let truth = stage.truth(&ray, *cull);
        compare(cast.as_ref(), truth.as_ref())
            .map_err(|fault| self.describe(i, &format!("{fault}: {cast:?}, in truth {truth:?}")))
    }

    fn ray(&self, i: usize) -> Ray {
        let columns = self.lattice.columns as usize;
        self.lattice.ray((i % columns) as u32, (i / columns) as u32)
    }

    /// A fault, with all that is needed to reproduce it.
    fn describe(&self, i: usize, fault: &str) -> String {
        let Self {
            stage,
            lattice,
            cull,
        } = self;
        let mesh = &stage.scene.objects[0].mesh;
        let triangles: Vec<_> = (0..mesh.triangles().len() as u32)
            .map(|number| mesh.corners(number))
            .collect();
        format!(
            "{fault}\n    ray: {i}, {:?}\n   cull: {cull:?}\nlattice: {lattice:?}\n offset: {:?}\n   clip: {:?}\ncorners: {triangles:?}",
            self.ray(i),
            mesh.offset(),
            stage.clip(),
        )
    }
}

/// A stream of bytes.
struct Source<'b>(std::slice::Iter<'b, u8>);

impl Source<'_> {
    fn byte(&mut self) -> u8 {
        self.0.next().copied().unwrap_or(0)
    }

    fn below(&mut self, end: usize) -> usize {
        usize::from(self.byte()) % end.max(1)
    }

    fn projection(&mut self) -> Projection {
        let byte = usize::from(self.byte());
        match byte {
            0..160 => [Projection::Perspective, Projection::Orthographic][byte % 2],
            160..232 => Projection::Panoramic(Panorama::ALL[byte % Panorama::ALL.len()].1),
            _ => self.lens(),
        }
    }

    /// A lens as strong as calibrated ones, or twice that.
    fn lens(&mut self) -> Projection {
        let coefficients = [1.0, 1.0, 0.05, 0.05, 1.0]
            .map(|most| most * f64::from(self.byte().cast_signed()) / 128.0);
        // Finite and small, so there is such a lens.
        let lens = BrownConrady::new(coefficients);
        lens.map_or(Projection::Perspective, Projection::through)
    }

    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        std::array::from_fn(|_| self.byte())
    }

    /// Corners with numbers of their own, equal to others' or between them, at one scale and position.
    fn points(&mut self) -> Vec<DVec3> {
        let scale = match self.below(4) {
            0 | 1 => 1.0,
            2 => 2f64.powi(self.below(64) as i32 - 40),
            _ => 10f64.powi(self.below(33) as i32 - 16),
        };
        let shift = match self.below(4) {
            0 => DVec3::new(148_376.0, 1234.0, -223_423.0),
            1 => DVec3::splat(1e7) * scale,
            _ => DVec3::ZERO,
        };
        let count = 3 + self.below(MAX_CORNERS - 2);
        let mut points: Vec<DVec3> = Vec::with_capacity(count);
        for _ in 0..count {
            let point = match (self.below(8), points.len()) {
                (0, many) if many > 1 => {
                    let (a, b) = (points[self.below(many)], points[self.below(many)]);
                    (a + b) * 0.5
                }
                (1, many) if many > 2 => {
                    let [a, b, c] = [(); 3].map(|()| points[self.below(many)]);
                    a + (b - a) * 0.5 + (c - a) * 0.25
                }
                (2, many) if many > 0 => {
                    // All but one coordinate of another corner.
                    let mut point = points[self.below(many)];
                    point[self.below(3)] = self.number();
                    point
                }
                _ => DVec3::from_array([(); 3].map(|()| self.number())),
            };
            points.push(point);
        }
        points
            .into_iter()
            .map(|point| point * scale + shift)
            .collect()
    }

    /// A number that often equals others.
    fn number(&mut self) -> f64 {
        const HOSTILE: [f64; 16] = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            2.0,
            -3.0,
            0.5,
            0.1,
            1.0 / 3.0,
            1.0 + f64::EPSILON,
            1.0 + f32::EPSILON as f64,
            1e-9,
            -1e-18,
            1e9,
            1e18,
            1e-40,
        ];
        match self.below(8) {
            0 => f64::from(f32::from_le_bytes(self.bytes())),
            1 => f64::from_le_bytes(self.bytes()),
            2 | 3 => f64::from(self.byte() as i8) / 8.0,
            4 => f64::from(i16::from_le_bytes(self.bytes())) / 1024.0,
            _ => HOSTILE[self.below(HOSTILE.len())],
        }
    }

    /// A clipping plane: through a corner, an edge, a triangle or the eye, or any.
    fn plane(
        &mut self,
        points: &[DVec3],
        triangles: &[[u32; 3]],
        eye: DVec3,
    ) -> Option<ClippingPlane> {
        let [a, b, c] = triangles[self.below(triangles.len())].map(|i| points[i as usize]);
        let any = DVec3::from_array([(); 3].map(|()| self.number()));
        let normal = match self.below(6) {
            0 => (b - a).cross(c - a),
            1 => (b - a).cross(any),
            2 => any,
            _ => [DVec3::X, DVec3::NEG_Y, DVec3::Z][self.below(3)],
        };
        match self.below(4) {
            0 => ClippingPlane::through(eye, normal),
            1 => ClippingPlane::new(normal, self.number()),
            2 => ClippingPlane::through((a + b) * 0.5, normal),
            _ => ClippingPlane::through(a, normal),
        }
        .ok()
    }

    /// A position of an eye or a target: random, or at the hardest points of the mesh, or slightly beside them.
    fn place(&mut self, points: &[DVec3], triangles: &[[u32; 3]]) -> DVec3 {
        let [a, b, c] = triangles[self.below(triangles.len())].map(|i| points[i as usize]);
        let place = match self.below(8) {
            0 => a,
            1 => (a + b) * 0.5,
            2 => a + (b - a) * 0.25 + (c - a) * 0.5,
            3 => a * 3.0 - b - c,
            4 => a + (b - a).cross(c - a).normalize_or_zero() * (b - a).length(),
            5 => (a + b + c) / 3.0 + DVec3::from_array([(); 3].map(|()| self.number())),
            _ => DVec3::from_array([(); 3].map(|()| self.number())),
        };
        let off = match self.below(4) {
            0 => f64::from(self.byte() as i8) * f64::EPSILON,
            1 => f64::from(self.byte() as i8) * 1e-9,
            _ => 0.0,
        };
        let place = place * (1.0 + off);
        // Cameras need room for products of coordinates.
        if place.is_finite() && place.abs().max_element() < 1e25 {
            place
        } else {
            DVec3::new(1.0, 2.0, 3.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_oracle::random::Random;

    /// Random bytes: most build a scenario with visible triangles.
    #[test]
    fn random_bytes_are_answered_truly() {
        let mut random = Random::new(71);
        let (mut built, mut hits) = (0, 0);
        for _ in 0..400 {
            let bytes: Vec<u8> = (0..300).map(|_| random.bits() as u8).collect();
            let Some(scenario) = scenario(&bytes) else {
                continue;
            };
            built += 1;
            if let Err(fault) = scenario.check() {
                panic!("{fault}\n{bytes:?}");
            }
            let mut primitives = Vec::new();
            let Scenario {
                stage,
                lattice,
                cull,
            } = &scenario;
            let counts =
                stage
                    .accel
                    .find_closest(lattice, *cull, Precision::Exact, &mut primitives);
            hits += u32::from(counts.hits > 0);
        }
        assert!(built > 300 && hits > 50, "{built} built, {hits} hit");
    }

    #[test]
    fn no_bytes_are_answered_too() {
        assert_eq!(check(&[]), Ok(()));
        for byte in 0..=255 {
            assert_eq!(check(&[byte; 200]), Ok(()), "{byte}");
        }
    }
}
