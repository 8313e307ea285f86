//! Reflection by metals and dielectrics of any roughness: a microfacet model under the picture's lights.

use super::light::{Lights, Source};
use super::vectors::Vectors;
use crate::math;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};
use glam::Vec3;
use std::f64::consts::LN_2;

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

/// How a material reflects light, without images.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlainReflectance {
    /// Metallic share and roughness, 0 to 1.
    pub(super) factors: [f32; 2],
    /// Its own light, linear.
    pub(super) emission: Vec3,
    /// Whether its colour is shown as it is.
    pub(super) is_unlit: bool,
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
        if color == Vec3::ZERO {
            continue;
        }
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
    let a = (x * x).min(grazing(facing)) * x + y;
    head_on * (z - 1.04 * a) + Vec3::splat((1.04 * a + w).max(0.0))
}

/// The logarithm of [`grazing`] at 1.
const GRAZING: f64 = -9.28 * LN_2;

/// 2^(−9.28 n · v).
fn grazing(facing: f32) -> f32 {
    math::exp(f64::from(facing) * GRAZING) as f32
}

/// [`grazing`] of eight numbers from 0 to 1.
///
/// e^t is 2ⁿ e^r, with n the integer nearest to t / ln 2 and |r| ≤ 0.347, and e^r the sum of its series to r⁹ / 9!. The rest
/// of the series is less than 2⁻³⁶·⁴ of it. r is off by less than 2⁻⁴⁹: n ln 2, at most 6.5, was rounded, and so was ln 2.
/// The sum and [`math::exp`] are off by less than 2⁻⁴⁹ beside. What is within 2⁻³⁶ of the sum rounds to single precision
/// as it does, if both ends of that range do; else, for one row of eight in some 360, [`math::exp`] is called.
#[inline(always)]
fn eight_grazing(facing: &[f32; LANES]) -> [f32; LANES] {
    const ERROR: f64 = 1.0 / (1u64 << 36) as f64;
    /// The sum with an integer has it in its lowest bits.
    const WHOLE: f64 = (3u64 << 51) as f64;
    let mut found = [0.0; LANES];
    let mut is_unsure = [0; LANES];
    for lane in 0..LANES {
        let t = f64::from(facing[lane]) * GRAZING;
        let whole = t * (1.0 / LN_2) + WHOLE;
        let r = t - (whole - WHOLE) * LN_2;
        let mut sum = SERIES[0];
        for coefficient in &SERIES[1..] {
            sum = sum * r + coefficient;
        }
        let power = f64::from_bits((whole.to_bits() << 52).wrapping_add(1.0f64.to_bits()));
        let [least, most] = [1.0 - ERROR, 1.0 + ERROR].map(|share| (sum * power * share) as f32);
        found[lane] = least;
        is_unsure[lane] = least.to_bits() ^ most.to_bits();
    }
    if is_unsure != [0; LANES] {
        return facing.map(grazing);
    }
    found
}

/// 1 / k!, from 9 to 0.
const SERIES: [f64; 10] = {
    let mut series = [1.0; 10];
    let mut k = 1;
    while k < 10 {
        series[9 - k] = series[10 - k] / k as f64;
        k += 1;
    }
    series
};

/// Eight surfaces, as light falls on them.
pub(super) struct Surfaces<L: Lanes> {
    /// Base colours, linear light.
    pub(super) base: Vectors<L>,
    /// 0 to 1.
    pub(super) metallic: L::F32,
    /// 0 to 1.
    pub(super) roughness: L::F32,
}

/// [`reflected`] of eight surfaces.
#[inline(always)]
pub(super) fn eight_reflected<L: Lanes>(
    lanes: L,
    lights: &Lights,
    surfaces: &Surfaces<L>,
    normal: Vectors<L>,
    to_eye: Vectors<L>,
) -> Vectors<L> {
    let &Surfaces {
        base,
        metallic,
        roughness,
    } = surfaces;
    let splat = |vector| Vectors::splat(lanes, vector);
    let [zero, half, one] = [0.0, 0.5, 1.0].map(|number| lanes.splat(number));
    let alpha = (roughness * roughness).max(lanes.splat(LEAST_ALPHA));
    let square = alpha * alpha;
    let rest = one - square;
    let diffuse = base.scaled(one - metallic);
    let dielectric = lanes.splat(DIELECTRIC) * (one - metallic);
    let head_on = (base.scaled(metallic)).plus(Vectors::all(lanes, dielectric));
    let along = normal.dot(to_eye);
    let facing = along.abs().min(one);
    let mirrored = normal.scaled(along * 2.0).minus(to_eye);

    let all = eight_reflected_of_all(lanes, head_on, roughness, facing);
    let ones = splat(Vec3::ONE);
    let mut seen = eight_around(lanes, lights, mirrored);
    let around = eight_around(lanes, lights, normal);
    let mut light = diffuse.times(ones.minus(all)).times(around);
    for Source { direction, color } in lights.sources {
        if color == Vec3::ZERO {
            continue;
        }
        let to_light = direction.map_or(to_eye, splat);
        let glow = mirrored.dot(to_light).max(zero);
        seen = seen.plus(splat(color).scaled(half * (one - alpha) * (glow * glow)));
        let lit = normal.dot(to_light);
        let between = to_light.plus(to_eye).unit_or_zero();
        let (peak, off) = (normal.dot(between), normal.cross(between));
        let spread = square * (peak * peak) + off.dot(off);
        let distribution = square / (spread * spread);
        let light_side = lit * (square + rest * (facing * facing)).sqrt();
        let eye_side = facing * (square + rest * (lit * lit)).sqrt();
        let visibility = half / (light_side + eye_side);
        let away = one - to_eye.dot(between);
        let away = away.lt(zero).select(zero, away);
        let away = one.lt(away).select(one, away);
        let away2 = away * away;
        let fresnel = head_on.plus(ones.minus(head_on).scaled(away2 * away2 * away));
        let specular = fresnel.scaled(distribution * visibility);
        let sent = diffuse.times(ones.minus(fresnel)).plus(specular);
        let more = light.plus(splat(color).scaled(lit).times(sent));
        light = light.replaced(zero.lt(lit), more);
    }
    light.plus(all.times(seen))
}

/// [`Lights::around`] eight directions.
#[inline(always)]
fn eight_around<L: Lanes>(lanes: L, lights: &Lights, direction: Vectors<L>) -> Vectors<L> {
    let up = Vectors::splat(lanes, lights.up);
    let above = lanes.splat(0.5) + lanes.splat(0.5) * direction.dot(up);
    let more = Vectors::splat(lanes, lights.sky - lights.ground).scaled(above);
    Vectors::splat(lanes, lights.ground).plus(more)
}

/// [`reflected_of_all`] of eight surfaces.
#[inline(always)]
fn eight_reflected_of_all<L: Lanes>(
    lanes: L,
    head_on: Vectors<L>,
    roughness: L::F32,
    facing: L::F32,
) -> Vectors<L> {
    let splat = |number| lanes.splat(number);
    let x = splat(1.0) - roughness;
    let y = splat(0.0425) - roughness * 0.0275;
    let z = splat(1.04) - roughness * 0.572;
    let w = roughness * 0.022 - 0.04;
    let mut grazing = [0.0; LANES];
    facing.store(&mut grazing);
    let a = (x * x).min(lanes.load(&eight_grazing(&grazing))) * x + y;
    let fixed = (a * 1.04 + w).max(splat(0.0));
    (head_on.scaled(z - a * 1.04)).plus(Vectors::all(lanes, fixed))
}

#[cfg(test)]
mod tests {
    use super::super::LightSet;
    use super::super::vectors::Rows;
    use super::*;
    use crate::Simd;
    use crate::camera::{Camera, ImagePlane, Pose, Projection};
    use crate::num::simd::{Work, dispatch};
    use crate::random::Random;
    use glam::DVec3;

    /// Eight surfaces: base colour, normal, way to the eye, and metallic share and roughness.
    struct Eight<'a> {
        lights: &'a Lights,
        vectors: [&'a Rows; 3],
        numbers: [&'a [f32; LANES]; 2],
        found: &'a mut Rows,
    }

    impl Work for Eight<'_> {
        #[inline(always)]
        fn run(self, lanes: impl Lanes) {
            let [base, normal, to_eye] = self.vectors.map(|rows| Vectors::load(lanes, rows));
            let [metallic, roughness] = self.numbers.map(|row| lanes.load(row));
            let surfaces = Surfaces {
                base,
                metallic,
                roughness,
            };
            *self.found = eight_reflected(lanes, self.lights, &surfaces, normal, to_eye).store();
        }
    }

    #[test]
    fn eight_powers_have_the_bits_of_single_ones() {
        let mut random = Random(8);
        for round in 0..200_000 {
            let facing: [f32; LANES] = std::array::from_fn(|lane| match round {
                0 => lane as f32 / 7.0,
                1 => [0.0, f32::MIN_POSITIVE, 1e-9, 1e-4, 0.5, 0.999, 1.0, 0.1][lane],
                _ => random.unit() as f32,
            });
            let bits = |powers: [f32; LANES]| powers.map(f32::to_bits);
            let expected = facing.map(grazing);
            assert_eq!(bits(eight_grazing(&facing)), bits(expected), "{facing:?}");
        }
    }

    #[test]
    fn every_instruction_set_reflects_what_one_pixel_reflects_to_the_bit() {
        let plane = ImagePlane::new(64, 64, 0.1).expect("a good plane");
        let pose = Pose {
            eye: DVec3::new(3.0, 4.0, 5.0),
            target: DVec3::ZERO,
            up: DVec3::Y,
        };
        let camera = Camera::new(pose, Projection::Perspective, plane);
        let sets = [LightSet::Soft, LightSet::Headlight, LightSet::ThreePoint];
        let mut random = Random(5);
        for round in 0..2000 {
            let lights = Lights::new(&camera, sets[round % 3]);
            let surface = |random: &mut Random| Surface {
                base: random.point().as_vec3().abs(),
                metallic: [0.0, 1.0, random.unit() as f32][round / 3 % 3],
                roughness: [0.0, 1.0, random.unit() as f32][round / 9 % 3],
            };
            let all: [_; LANES] = std::array::from_fn(|_| {
                let surface = surface(&mut random);
                let mut unit = || random.point().as_vec3().normalize_or_zero();
                (surface, unit(), unit())
            });
            let mut vectors = [Rows::ZERO; 3];
            let mut numbers = [[0.0; LANES]; 2];
            for (lane, (surface, normal, to_eye)) in all.iter().enumerate() {
                vectors[0].set(lane, surface.base);
                vectors[1].set(lane, *normal);
                vectors[2].set(lane, *to_eye);
                numbers[0][lane] = surface.metallic;
                numbers[1][lane] = surface.roughness;
            }
            for simd in Simd::available() {
                let mut found = Rows::ZERO;
                let eight = Eight {
                    lights: &lights,
                    vectors: vectors.each_ref(),
                    numbers: numbers.each_ref(),
                    found: &mut found,
                };
                dispatch(simd, eight);
                for (lane, &(surface, normal, to_eye)) in all.iter().enumerate() {
                    let expected = reflected(&lights, surface, normal, to_eye);
                    let found = found.0.map(|row| row[lane].to_bits());
                    let expected = expected.to_array().map(f32::to_bits);
                    assert_eq!(found, expected, "{simd:?}, round {round}, lane {lane}");
                }
            }
        }
    }
}
