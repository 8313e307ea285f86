//! Reflection by metals and dielectrics of any roughness: a microfacet model under the picture's lights.

use super::light::{Lights, Source};
use crate::math;
use glam::Vec3;

/// The least α = roughness²: highlights are at least as wide as those of a light 3° wide. Without a limit no ray
/// would hit the mirror image of a point light; with a smaller one, one ray in 10⁵ pixels would decide a highlight's
/// brightness.
const LEAST_ALPHA: f32 = 0.03;

/// The reflectance of dielectrics at normal incidence: of glass and plastics, with an index of refraction of 1.5.
const DIELECTRIC: f32 = 0.04;

/// A surface's reflectance at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    /// Base colour, linear light.
    pub(super) base: Vec3,
    /// 0 to 1.
    pub(super) metallic: f32,
    /// 0 to 1.
    pub(super) roughness: f32,
}

/// Linear light from a surface; `normal` and `to_eye` are unit vectors in world space.
///
/// glTF 2.0's model (appendix B), with c the base colour, m the metallic share, α = max(roughness², [`LEAST_ALPHA`]),
/// the unit vectors n, v to the eye, l to a light and h = l + v made unit, F0 = 0.04 (1 − m) + c m,
/// F = F0 + (1 − F0) (1 − v · h)⁵ (Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", 1994):
///
/// light of each source × max(0, n · l) × ((1 − F) (1 − m) c + π D V F), where
/// π D = α² / (α² (n · h)² + |n × h|²)² (GGX: Walter, Marschner, Li, Torrance, "Microfacet Models for Refraction through
/// Rough Surfaces", 2007; |n × h|² = 1 − (n · h)² keeps its digits at the peak), and
/// V = ½ / (n · l √(α² + (1 − α²) (n · v)²) + |n · v| √(α² + (1 − α²) (n · l)²)) (Smith's function, height-correlated:
/// Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", 2014).
///
/// Light from all around adds (1 − S) (1 − m) c × that on n, and S × what is seen along v's mirror image r: light from
/// all around on r, and of each source a glow, ½ (1 − α) max(0, r · l)² of its light, as of a room that it stands in.
/// S = F0 A + B is what the microfacets reflect over all directions, by Karis' fit ("Physically Based Shading on
/// Mobile", 2014).
pub(super) fn reflected(lights: &Lights, surface: Surface, normal: Vec3, to_eye: Vec3) -> Vec3 {
    let Surface {
        base,
        metallic,
        roughness,
    } = surface;
    let alpha = (roughness * roughness).max(LEAST_ALPHA);
    let square = alpha * alpha;
    let rest = 1.0 - square;
    let diffuse = base * (1.0 - metallic);
    let head_on = base * metallic + Vec3::splat(DIELECTRIC * (1.0 - metallic));
    let along = normal.dot(to_eye);
    let facing = along.abs().min(1.0);
    let mirrored = normal * (2.0 * along) - to_eye;

    let all = reflected_of_all(head_on, roughness, facing);
    let mut seen = lights.around(mirrored);
    let mut light = diffuse * (Vec3::ONE - all) * lights.around(normal);
    for Source { direction, color } in lights.sources {
        let to_light = direction.unwrap_or(to_eye);
        let glow = mirrored.dot(to_light).max(0.0);
        seen += color * (0.5 * (1.0 - alpha) * (glow * glow));
        let lit = normal.dot(to_light);
        if lit > 0.0 {
            let half = (to_light + to_eye).normalize_or_zero();
            let (peak, off) = (normal.dot(half), normal.cross(half));
            let spread = square * (peak * peak) + off.length_squared();
            let distribution = square / (spread * spread);
            let light_side = lit * (square + rest * (facing * facing)).sqrt();
            let eye_side = facing * (square + rest * (lit * lit)).sqrt();
            let visibility = 0.5 / (light_side + eye_side);
            let away = (1.0 - to_eye.dot(half)).clamp(0.0, 1.0);
            let away2 = away * away;
            let fresnel = head_on + (Vec3::ONE - head_on) * (away2 * away2 * away);
            let specular = fresnel * (distribution * visibility);
            light += color * lit * (diffuse * (Vec3::ONE - fresnel) + specular);
        }
    }
    light + all * seen
}

/// The fraction of uniform light from all directions that microfacets reflect.
fn reflected_of_all(head_on: Vec3, roughness: f32, facing: f32) -> Vec3 {
    let x = 1.0 - roughness;
    let y = 0.0425 - 0.0275 * roughness;
    let z = 1.04 - 0.572 * roughness;
    let w = 0.022 * roughness - 0.04;
    // 2^(−9.28 n · v)
    let grazing = math::exp(f64::from(facing) * (-9.28 * std::f64::consts::LN_2)) as f32;
    let a = (x * x).min(grazing) * x + y;
    head_on * (z - 1.04 * a) + Vec3::splat((1.04 * a + w).max(0.0))
}
