//! Reflection by metals and dielectrics, computed independently by the formulas that the shader documents.

use super::light::Lights;
use super::range::{Single, Vector, cross, dot, minus, plus, scaled, unit};
use raycast_core::math;

const LEAST_ALPHA: f64 = 0.03;
const DIELECTRIC: f64 = 0.04;

/// A number that single precision stores.
fn number(number: f64) -> Single {
    Single::exactly(number).rounded()
}

fn times(a: Vector<24>, b: Vector<24>) -> Vector<24> {
    std::array::from_fn(|i| a[i] * b[i])
}

/// The square of a number, which is not negative.
fn squared(a: Single) -> Single {
    let a = a.abs();
    a * a
}

/// One minus a number.
fn one_minus(a: Single) -> Single {
    Single::exactly(1.0) - a
}

/// The light from a surface of this base colour, metallic and roughness. Unknown where `normal` is.
pub(super) fn reflected(
    lights: &Lights,
    base: Vector<24>,
    [metallic, roughness]: [Single; 2],
    normal: Vector<24>,
    to_eye: Vector<24>,
) -> Vector<24> {
    let known = [normal, to_eye, base]
        .iter()
        .flatten()
        .all(|n| n.is_known());
    if !(known && metallic.is_known() && roughness.is_known()) {
        return [Single::UNKNOWN; 3];
    }
    let alpha = squared(roughness).max(LEAST_ALPHA);
    let square = squared(alpha);
    let diffuse = scaled(base, one_minus(metallic));
    let head_on: Vector<24> = base.map(|c| c * metallic + number(DIELECTRIC) * one_minus(metallic));
    let along = dot(normal, to_eye);
    let facing = along.abs().min(1.0);
    let mirrored = minus(scaled(normal, Single::exactly(2.0) * along), to_eye);

    let all = reflected_of_all(head_on, roughness, facing);
    let mut seen = lights.around(mirrored);
    let mut light = times(times(diffuse, all.map(one_minus)), lights.around(normal));
    for (direction, color) in lights.shining() {
        let to_light = direction.unwrap_or(to_eye);
        let glow = squared(dot(mirrored, to_light).max(0.0));
        let half = Single::exactly(0.5);
        seen = plus(seen, scaled(color, half * one_minus(alpha) * glow));
        let lit = dot(normal, to_light).max(0.0);
        if lit.high <= 0.0 {
            continue;
        }
        let halfway = unit(plus(to_light, to_eye));
        let (peak, off) = (dot(normal, halfway), cross(normal, halfway));
        let off = squared(off[0]) + squared(off[1]) + squared(off[2]);
        let spread = square * squared(peak) + off;
        // A range of cosines may exceed what one direction allows: (n · h)² + |n × h|² is 1.
        let spread = Single {
            low: spread.low.max(square.low * (1.0 - 1e-5)),
            high: spread.high,
        };
        let distribution = square / squared(spread);
        let side = |cosine: Single| (square + one_minus(square) * squared(cosine)).sqrt();
        let visibility = half / (lit * side(facing) + facing * side(lit));
        let away = one_minus(dot(to_eye, halfway)).max(0.0).min(1.0);
        let fifth = squared(squared(away)) * away;
        let fresnel: Vector<24> = head_on.map(|f| f + one_minus(f) * fifth);
        let specular = scaled(fresnel, distribution * visibility);
        let sent = plus(times(diffuse, fresnel.map(one_minus)), specular);
        light = plus(light, times(scaled(color, lit), sent));
    }
    plus(light, times(all, seen))
}

/// Karis' fit.
fn reflected_of_all(head_on: Vector<24>, roughness: Single, facing: Single) -> Vector<24> {
    let x = one_minus(roughness);
    let y = number(0.0425) - number(0.0275) * roughness;
    let z = number(1.04) - number(0.572) * roughness;
    let w = number(0.022) * roughness - number(0.04);
    // Decreasing in n · v.
    let grazing = |facing: f64| math::exp(-9.28 * std::f64::consts::LN_2 * facing);
    let grazing = Single::over([grazing(facing.low), grazing(facing.high)]).rounded();
    let square = squared(x);
    let least = Single {
        low: square.low.min(grazing.low),
        high: square.high.min(grazing.high),
    };
    let a = least * x + y;
    let (of_color, white) = (z - number(1.04) * a, (number(1.04) * a + w).max(0.0));
    head_on.map(|f| f * of_color + white)
}
