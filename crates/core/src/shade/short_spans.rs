//! Normals and colours where triangles are as small as samples.
//!
//! To prepare a shading triangle for one sample takes longer than to cast its ray. Here the triangles of eight samples give
//! a normal each, in a loop that the compiler vectorises, with the bits that their shading triangles would give.

use super::Shader;
use super::facet::facing_normal;
use super::interpolants::{PlanarRays, SmoothSample};
use super::numbers::Numbers;
use super::vectors::Rows;
use crate::num::simd::{LANES, Lanes};
use crate::triangle::{CornerLanes, vectors_in_lane};
use glam::{DVec3, Mat3, Vec3};

/// The most samples of a span whose triangle is not prepared for them, and the most samples that a row may have for each of
/// its spans. With 1, pictures of 1 M and 4 M triangles took up to a tenth longer; with 3, those of 250,000 and 1 M did,
/// where each triangle comes back in the next row.
pub(super) const LONGEST: usize = 2;

/// Whether short spans of a row with so many spans are shaded here.
#[inline(always)]
pub(super) fn are_worth_it(spans: u32, samples: usize) -> bool {
    spans as usize >= LANES && LONGEST * spans as usize >= samples
}

/// Up to eight samples of short spans of a row.
#[derive(Clone, Copy)]
pub(super) struct ShortSpans {
    count: usize,
    /// Places in the row.
    places: [usize; LANES],
    /// The triangles; those beyond `count` are of samples before.
    primitives: [u32; LANES],
}

impl ShortSpans {
    /// None.
    pub(super) const NONE: Self = Self {
        count: 0,
        places: [0; LANES],
        primitives: [0; LANES],
    };

    /// Adds a sample; there is room for one. Whether there is none any more.
    #[inline(always)]
    pub(super) fn add(&mut self, primitive: u32, place: usize) -> bool {
        if self.count == 0 {
            self.primitives = [primitive; LANES];
        }
        self.places[self.count % LANES] = place;
        self.primitives[self.count % LANES] = primitive;
        self.count += 1;
        self.count == LANES
    }

    /// Takes them all; `None` where there are none.
    #[inline(always)]
    pub(super) fn take(&mut self) -> Option<Self> {
        let taken = *self;
        self.count = 0;
        (taken.count > 0).then_some(taken)
    }

    /// Lanes and the places in the row of their samples.
    #[inline(always)]
    pub(super) fn places(&self) -> impl Iterator<Item = (usize, usize)> {
        self.places.into_iter().take(self.count).enumerate()
    }

    /// The triangles of these samples of a row.
    #[inline(always)]
    pub(super) fn triangles(&self, lanes: impl Lanes, shader: &Shader<'_>) -> EightTriangles {
        EightTriangles::new(lanes, shader, &self.primitives)
    }
}

/// The triangles of eight samples.
pub(super) struct EightTriangles {
    primitives: [u32; LANES],
    objects: [u32; LANES],
    /// Their numbers in their objects.
    numbers: [u32; LANES],
    corners: CornerLanes,
    /// The mesh's normals at the corners.
    normals: CornerLanes,
    /// The columns of the normal matrices.
    world_normals: CornerLanes,
    has_normals: [bool; LANES],
}

/// Normals of eight samples.
pub(super) struct SampleNormals {
    /// Not of unit length.
    pub(super) xyz: Rows,
    /// Whether the triangles' normals are linear over the picture; else these are anything.
    pub(super) are_linear: [bool; LANES],
}

impl EightTriangles {
    #[inline(always)]
    fn new(lanes: impl Lanes, shader: &Shader<'_>, primitives: &[u32; LANES]) -> Self {
        let mut triangles = Self {
            primitives: *primitives,
            objects: [0; LANES],
            numbers: [0; LANES],
            corners: shader.accel().eight_corners::<true>(lanes, primitives),
            normals: [[0.0; LANES]; 9],
            world_normals: [[0.0; LANES]; 9],
            has_normals: [false; LANES],
        };
        for (lane, &primitive) in primitives.iter().enumerate() {
            let (object, number) = shader.accel().identify(primitive);
            triangles.objects[lane] = object;
            triangles.numbers[lane] = number;
            let Some((normals, world_normals)) = shader.corner_normals(object, number) else {
                continue;
            };
            triangles.has_normals[lane] = true;
            set(&mut triangles.normals, lane, normals);
            let Mat3 {
                x_axis,
                y_axis,
                z_axis,
            } = world_normals;
            set(&mut triangles.world_normals, lane, [x_axis, y_axis, z_axis]);
        }
        triangles
    }

    /// The colour of a lane's triangle.
    #[inline(always)]
    pub(super) fn color(&self, shader: &Shader<'_>, lane: usize) -> Vec3 {
        shader.triangle_color(
            self.objects[lane],
            self.numbers[lane],
            self.primitives[lane],
        )
    }

    /// The normals of the samples at these places of a row.
    #[inline(always)]
    pub(super) fn normals(
        &self,
        shader: &Shader<'_>,
        rays: &PlanarRays,
        (places, xs, y): (&ShortSpans, &Numbers<f64>, f64),
    ) -> SampleNormals {
        let mut x = [0.0; LANES];
        for (x, place) in x.iter_mut().zip(places.places) {
            *x = xs.0[place];
        }
        let mut out = SampleNormals {
            xyz: Rows::ZERO,
            are_linear: [false; LANES],
        };
        let eye = shader.eye();
        // A loop for each kind of rays, so that neither has a branch.
        match rays.parallel() {
            None => {
                for (lane, &x) in x.iter().enumerate() {
                    self.normal(eye, rays, None, (lane, x, y), &mut out);
                }
            }
            Some(forward) => {
                for (lane, &x) in x.iter().enumerate() {
                    self.normal(eye, rays, Some(forward), (lane, x, y), &mut out);
                }
            }
        }
        out
    }

    #[inline(always)]
    fn normal(
        &self,
        eye: DVec3,
        rays: &PlanarRays,
        parallel: Option<DVec3>,
        (lane, x, y): (usize, f64, f64),
        out: &mut SampleNormals,
    ) {
        let corners = vectors_in_lane(&self.corners, lane);
        let [a, b, c] = corners;
        let from_eye = [a.as_dvec3() - eye, b.as_dvec3() - eye, c.as_dvec3() - eye];
        let flat = facing_normal(from_eye, parallel);
        let [x_axis, y_axis, z_axis] = vectors_in_lane(&self.world_normals, lane);
        let world = Mat3 {
            x_axis,
            y_axis,
            z_axis,
        };
        let [na, nb, nc] = vectors_in_lane(&self.normals, lane);
        let sample = SmoothSample {
            place: (x, y),
            corners,
            normals: [
                (world * na).normalize_or_zero(),
                (world * nb).normalize_or_zero(),
                (world * nc).normalize_or_zero(),
            ],
            flat,
        };
        let (smooth, is_linear) = rays.normal_of(parallel, &sample);
        let has_normals = self.has_normals[lane];
        let normal = if has_normals { smooth } else { flat };
        out.xyz.set(lane, normal);
        // Triangles without area have another normal of their own.
        out.are_linear[lane] = (is_linear | !has_normals) & (flat != Vec3::ZERO);
    }
}

#[inline(always)]
fn set(all: &mut CornerLanes, lane: usize, [a, b, c]: [Vec3; 3]) {
    let one = [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z];
    for (all, one) in all.iter_mut().zip(one) {
        all[lane] = one;
    }
}
