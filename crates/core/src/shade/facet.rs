//! Shading triangles: what all pixels of a triangle share.

use super::edges::EdgeLines;
use super::interpolants::{Interpolants, LinearNormal};
use crate::PrimitiveHit;
use glam::{DVec3, Vec2, Vec3};

/// The shortest interpolated normal that is used; the triangle's own replaces shorter ones. Each component of a blend of
/// three unit vectors, with weights of sum one, is off by γ₃ ≤ 3.01u, u = 2⁻²⁴, so the vector by √3·3.01u < 3.2e-7: below
/// this length a third may be rounding. Opposite normals alone come near it.
pub(super) const SHORTEST_NORMAL: f32 = 1e-6;

/// What a mode needs of each triangle; nothing else is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Needs {
    /// The surface normal.
    pub(super) normal: bool,
    /// The light on all of it.
    pub(super) light: bool,
    /// The mesh's own normals.
    pub(super) smooth: bool,
    /// The triangle's colour.
    pub(super) color: bool,
    /// How colours vary within it.
    pub(super) varied: bool,
    /// The texture.
    pub(super) texture: bool,
    /// Texture coordinates themselves.
    pub(super) uvs: bool,
    /// The reflectance of its material.
    pub(super) reflectance: bool,
    /// Its interpolants over the image plane.
    pub(super) interpolants: bool,
    /// Lines.
    pub(super) edges: bool,
    /// Whether the ground may lie before it.
    pub(super) ground: bool,
}

/// A shading triangle: a triangle prepared for its pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    pub(super) object: u32,
    /// Its number in its object, if it has a texture.
    pub(super) triangle: u32,
    /// The unit normal in world space, towards the eye.
    pub(super) normal: Vec3,
    /// The mesh's own normals at the corners, in world space.
    pub(super) normals: Option<[Vec3; 3]>,
    /// The triangle's colour, linear light.
    pub(super) color: Vec3,
    /// How its colours vary within it.
    pub(super) varied: Varied,
    /// The light on all of it: on its normal, seen from the eye in the direction of its middle.
    pub(super) light: Vec3,
    /// How its texture is mapped.
    pub(super) texture: Option<Mapping>,
    /// Whether the texture is multiplied by the triangle's own colours.
    pub(super) is_tinted: bool,
    /// How much of the texture shows at the corners, if the object sets it.
    pub(super) blends: Option<[f32; 3]>,
    /// Texture coordinates at the corners.
    pub(super) uvs: Option<[Vec2; 3]>,
    /// The index of its material in its mesh, if that says how it reflects light.
    pub(super) material: Option<u32>,
    pub(super) edges: Option<EdgeLines>,
    /// Whether the ground may lie before it.
    pub(super) shows_ground: bool,
    /// Where t, u and v of its samples come from.
    pub(super) interpolation: Interpolation,
    /// The normals at the corners, interpolated over the image plane.
    pub(super) linear_normal: Option<LinearNormal>,
}

/// Where t, u and v of a triangle's samples come from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Interpolation {
    /// From the hits.
    Hits,
    /// From linear functions of the sample's place.
    Linear(Interpolants),
    /// From the sample's ray: linear functions would not be accurate.
    Ray,
}

/// How colours vary within a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) enum Varied {
    /// They are constant.
    No,
    /// Interpolated in linear light from the colours at the corners.
    Colors([Vec3; 3]),
    /// A ramp's colours of positions in its span, which are interpolated from the corners.
    Shares([f32; 3]),
    /// A ramp's colours of the distance from zero of the point between these corners.
    Distances([Vec3; 3]),
}

/// How a texture is mapped to a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) enum Mapping {
    /// By texture coordinates at its corners.
    Uv([Vec2; 3]),
    /// By its corners and normals in object space.
    Triplanar([Vec3; 3], [Vec3; 3]),
    /// By the point between its corners, in object space.
    Placed([Vec3; 3]),
    /// By the point between its corners, in world space.
    Photographed([Vec3; 3]),
}

impl Facet {
    /// A triangle without any of these.
    pub(super) const NONE: Self = Self {
        object: 0,
        triangle: 0,
        normal: Vec3::ZERO,
        normals: None,
        color: Vec3::ZERO,
        varied: Varied::No,
        light: Vec3::ZERO,
        texture: None,
        is_tinted: false,
        blends: None,
        uvs: None,
        material: None,
        edges: None,
        shows_ground: true,
        interpolation: Interpolation::Hits,
        linear_normal: None,
    };

    /// How much of the texture shows at barycentrics (u, v), 0 to 1; all of it where the object sets nothing.
    pub(super) fn blend_at(&self, u: f32, v: f32) -> f32 {
        match self.blends {
            None => 1.0,
            Some(blends) => {
                let share = blend(blends, u, v);
                if share.is_nan() {
                    1.0
                } else {
                    share.clamp(0.0, 1.0)
                }
            }
        }
    }

    /// The unit normal of a sample, on the visible side.
    pub(super) fn normal_of(&self, x: f64, y: f64, hit: &PrimitiveHit) -> Vec3 {
        match &self.linear_normal {
            Some(normal) => normal.at(x, y, self.normal),
            None => self.normal_at(hit.u, hit.v),
        }
    }

    /// The unit normal at barycentrics (u, v), on the visible side: the mesh's interpolated normal where it has one.
    pub(super) fn normal_at(&self, u: f32, v: f32) -> Vec3 {
        let Some(normals) = self.normals else {
            return self.normal;
        };
        let normal = blend(normals, u, v);
        let length = normal.length();
        if !(length > SHORTEST_NORMAL && length.is_finite()) {
            return self.normal;
        }
        let side = if normal.dot(self.normal) < 0.0 {
            -length
        } else {
            length
        };
        normal / side
    }
}

/// A triangle made ready for a picture's channels beside colours.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceTriangle {
    pub(super) object: u32,
    /// Its number in its object.
    pub(super) triangle: u32,
    /// Its normals and texture coordinates.
    pub(super) facet: Facet,
}

impl SurfaceTriangle {
    /// The unit normal and the texture coordinates at barycentrics (u, v); zero where there are no coordinates.
    pub(super) fn at(&self, u: f32, v: f32) -> ([f32; 3], [f32; 2]) {
        let uv = self.facet.uvs.map_or(Vec2::ZERO, |uvs| blend(uvs, u, v));
        let uv = if uv.is_finite() { uv } else { Vec2::ZERO };
        (self.facet.normal_at(u, v).to_array(), uv.to_array())
    }
}

/// A triangle's unit normal on the side of the eye; zero for a triangle without area.
///
/// `corners` are single-precision coordinates less those of the eye. With an orthographic camera, whose rays do not start
/// at the eye, `forward` decides the side.
///
/// No product overflows or underflows. Coordinates of edges are differences of single-precision numbers, with their
/// rounding zero or from 2⁻¹⁵⁰ to 2¹³⁰; so those of the cross product are zero or from 2⁻³⁵³, the last place of the least
/// product, to 2²⁶¹, and their squares are in range too.
#[inline(always)]
pub(super) fn facing_normal(corners: [DVec3; 3], forward: Option<DVec3>) -> Vec3 {
    let [a, b, c] = corners;
    let normal = unit((b - a).cross(c - a));
    let away = normal.dot(forward.unwrap_or(a)) > 0.0;
    if away { -normal } else { normal }.as_vec3()
}

/// [`facing_normal`]; where there is none, the way back along the view.
#[inline(always)]
pub(super) fn visible_normal(corners: [DVec3; 3], forward: DVec3, parallel: Option<DVec3>) -> Vec3 {
    let normal = facing_normal(corners, parallel);
    if normal == Vec3::ZERO {
        -forward.as_vec3()
    } else {
        normal
    }
}

/// The unit vector to the eye from the middle of a triangle with these corners, relative to the eye, or against parallel
/// rays.
#[inline(always)]
pub(super) fn middle_to_eye([a, b, c]: [DVec3; 3], parallel: Option<DVec3>) -> Vec3 {
    match parallel {
        Some(forward) => -forward.as_vec3(),
        None => -unit(a + b + c).as_vec3(),
    }
}

/// A unit vector; zero for a zero vector.
#[inline(always)]
pub(super) fn unit(vector: DVec3) -> DVec3 {
    let length = vector.length();
    if length.is_finite() && length > 0.0 {
        vector * (1.0 / length)
    } else {
        DVec3::ZERO
    }
}

/// Values at the corners interpolated at barycentrics (u, v).
pub(super) fn blend<T>([a, b, c]: [T; 3], u: f32, v: f32) -> T
where
    T: std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
{
    a * (1.0 - u - v) + b * u + c * v
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facing(z: f64, scale: f64) -> [DVec3; 3] {
        [
            DVec3::new(-1.0, 0.0, z),
            DVec3::new(1.0, 0.0, z),
            DVec3::new(0.0, 1.0, z),
        ]
        .map(|corner| corner * scale)
    }

    #[test]
    fn normals_face_the_eye_at_any_scale() {
        for scale in [1e-45, 1e-20, 1.0, 1e18, 1e38] {
            for (z, towards) in [(-3.0, Vec3::Z), (3.0, Vec3::NEG_Z)] {
                assert_eq!(facing_normal(facing(z, scale), None), towards);
                let [a, b, c] = facing(z, scale);
                assert_eq!(facing_normal([a, c, b], None), towards);
            }
            let forward = Some(DVec3::NEG_Z);
            assert_eq!(facing_normal(facing(3.0, scale), forward), Vec3::Z);
        }
        assert_eq!(facing_normal([DVec3::ONE; 3], None), Vec3::ZERO);
    }

    #[test]
    fn smooth_normals_stay_on_the_side_that_shows() {
        let normals = [Vec3::NEG_Z, Vec3::new(0.6, 0.0, -0.8), Vec3::NEG_Z];
        let facet = Facet {
            normal: Vec3::Z,
            normals: Some(normals),
            ..Facet::NONE
        };
        assert_eq!(facet.normal_at(0.0, 0.0), Vec3::Z);
        let turned = facet.normal_at(1.0, 0.0);
        assert!((turned - Vec3::new(-0.6, 0.0, 0.8)).length() < 1e-6);
        let cancelled = Facet {
            normals: Some([Vec3::X, Vec3::NEG_X, Vec3::X]),
            ..facet
        };
        assert_eq!(cancelled.normal_at(0.5, 0.0), Vec3::Z);
    }
}
