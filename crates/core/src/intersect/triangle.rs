//! One ray against one triangle: rounded arithmetic where it is sure, exact where it is not.
//!
//! The ray is sheared so that it becomes the axis along which its direction is longest; inside or
//! outside is then three signs in two dimensions (Woop, Benthin, Wald, "Watertight Ray/Triangle
//! Intersection", JCGT 2013). Theirs are exact for the sheared, rounded vertices; these are exact for
//! the vertices and the ray as given: each sign and each order of depth comes with a bound on its
//! error, and what the bound leaves open goes to [`ExactHit`] (after Shewchuk, "Adaptive Precision
//! Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997).

use super::exact::ExactHit;
use super::{Cull, Nearest};
use crate::camera::Ray;
use glam::{DVec3, Vec3};
use std::cmp::Ordering;

/// Half a unit in the last place of 1: the relative error of one rounded operation.
const EPSILON: f64 = f64::EPSILON / 2.0;

/// A ray made ready for many triangles.
#[derive(Clone, Debug)]
pub(crate) struct PreparedRay {
    /// The ray as given, in world space.
    pub(crate) ray: Ray,
    /// What corners are relative to, in world space.
    frame: DVec3,
    /// The ray's origin relative to that, rounded.
    pub(crate) origin: DVec3,
    /// How far each of its coordinates may be off.
    pub(crate) origin_error: f64,
    /// The axis along which the direction is longest.
    pub(crate) major: usize,
    /// `direction[axis] / direction[major]` of the next axis and the one after; at most 1.
    shear: [f64; 2],
    /// The direction along the major axis.
    pub(crate) advance: f64,
    /// Whether back faces are left out.
    cull: Cull,
}

/// What one triangle says to one ray.
enum Verdict {
    Miss,
    Hit(Nearest),
    /// Too close to call in doubles.
    Open,
}

impl PreparedRay {
    /// Prepares a ray for triangles whose corners are relative to `frame`. `None` if the ray is not
    /// valid.
    pub(crate) fn new(ray: &Ray, frame: DVec3, cull: Cull) -> Option<Self> {
        if !ray.is_valid() {
            return None;
        }
        let origin = ray.origin - frame;
        // Nothing is rounded where nothing is subtracted.
        let off = frame != DVec3::ZERO;
        let origin_error = if off {
            origin.abs().max_element() * EPSILON
        } else {
            0.0
        };
        let lengths = ray.direction.abs();
        let major = if lengths.z >= lengths.x && lengths.z >= lengths.y {
            2
        } else if lengths.y >= lengths.x {
            1
        } else {
            0
        };
        let d = ray.direction.to_array();
        let advance = d[major];
        let shear = [d[(major + 1) % 3] / advance, d[(major + 2) % 3] / advance];
        Some(Self {
            ray: *ray,
            frame,
            origin,
            origin_error,
            major,
            shear,
            advance,
            cull,
        })
    }

    /// Meets the triangle in `slot` if it is nearer than `nearest`, or as near with a lower
    /// number; `number` tells a slot's.
    pub(crate) fn meet(
        &self,
        slot: u32,
        corners: impl Fn(u32) -> [Vec3; 3],
        number: impl Fn(u32) -> u32,
        nearest: &mut Nearest,
    ) {
        let candidate = match self.judge(slot, corners(slot)) {
            Verdict::Miss => return,
            Verdict::Hit(hit) => hit,
            Verdict::Open => {
                let Some(hit) = ExactHit::new(&self.ray, corners(slot), self.frame, self.cull)
                else {
                    return;
                };
                hit.rounded(slot)
            }
        };
        if nearest.is_miss() || candidate.is_surely_before(nearest) {
            *nearest = candidate;
        } else if !nearest.is_surely_before(&candidate) {
            let order = match same_corners(corners(slot), corners(nearest.slot)) {
                true => Ordering::Equal,
                false => {
                    let exact =
                        |slot| ExactHit::new(&self.ray, corners(slot), self.frame, self.cull);
                    match (exact(slot), exact(nearest.slot)) {
                        (Some(candidate), Some(nearest)) => candidate.compare(&nearest),
                        // Both were decided to be hits, so both are.
                        _ => Ordering::Greater,
                    }
                }
            };
            let wins = order == Ordering::Less
                || order == Ordering::Equal && number(slot) < number(nearest.slot);
            if wins {
                *nearest = candidate;
            }
        }
    }

    /// The hit at a triangle that the ray is known to meet.
    pub(crate) fn evaluate(&self, slot: u32, corners: [Vec3; 3]) -> Nearest {
        match self.judge(slot, corners) {
            Verdict::Hit(hit) => hit,
            _ => ExactHit::new(&self.ray, corners, self.frame, self.cull)
                .map_or(Nearest::NONE, |hit| hit.rounded(slot)),
        }
    }

    /// Decides in doubles, or leaves open what they cannot.
    ///
    /// Error bounds, with ε = 2⁻⁵³, m the largest coordinate of the corners relative to the ray's
    /// origin, and η the error of that origin:
    ///
    /// * A corner relative to the origin has an error of at most εm + η a coordinate, a shear factor
    ///   of ε (and is at most 1), so their product 3εm + η, and a sheared coordinate, with one more
    ///   subtraction of numbers up to m each, 2·εm + 4·εm + 2η. With higher orders:
    ///   δ = 8εm + 3η.
    /// * An edge function `cx·by − cy·bx` of coordinates within δ is off by
    ///   δ(|cx| + |by| + |cy| + |bx|) + 2δ², and by 2ε(|cx·by| + |cy·bx|) from its own rounding,
    ///   which is below half the first term since |cx| ≤ 2m. Summed over all corners:
    ///   E = 2δ(Σ|x| + Σ|y| + δ).
    /// * The depth is the mean of the corners' depths z by the edge functions. Errors of E in the
    ///   functions move it by at most 3E·(max z − min z)/|D|, D their sum, since it lies between
    ///   them; its own rounding, and that of the depths, is below 10εm + η. With higher orders:
    ///   4E·(max z − min z)/|D| + 2δ.
    fn judge(&self, slot: u32, corners: [Vec3; 3]) -> Verdict {
        let relative = corners.map(|corner| corner.as_dvec3() - self.origin);
        let (kx, ky, kz) = ((self.major + 1) % 3, (self.major + 2) % 3, self.major);
        let x = relative.map(|p| p[kx] - self.shear[0] * p[kz]);
        let y = relative.map(|p| p[ky] - self.shear[1] * p[kz]);
        let z = relative.map(|p| p[kz]);

        let u = x[2] * y[1] - y[2] * x[1];
        let v = x[0] * y[2] - y[0] * x[2];
        let w = x[1] * y[0] - y[1] * x[0];

        let m = relative
            .into_iter()
            .fold(DVec3::ZERO, |m, p| m.max(p.abs()))
            .max_element();
        let delta = 8.0 * EPSILON * m + 3.0 * self.origin_error;
        let sum = x.into_iter().chain(y).map(f64::abs).sum::<f64>();
        let edge_error = 2.0 * delta * (sum + delta);

        let least = u.min(v).min(w);
        let greatest = u.max(v).max(w);
        if least < -edge_error && greatest > edge_error {
            return Verdict::Miss;
        }
        if !(least > edge_error || greatest < -edge_error) {
            return Verdict::Open;
        }
        let determinant = u + v + w;
        // The weights must be good to single precision.
        if edge_error > 2f64.powi(-28) * determinant.abs() {
            return Verdict::Open;
        }
        if self.cull == Cull::Back {
            // The sheared triangle is seen along the major axis: its turning sense is the sign of
            // the determinant, against the way that the ray runs along the axis.
            let is_back = (determinant > 0.0) != (self.advance > 0.0);
            if is_back {
                return Verdict::Miss;
            }
        }
        let depth = (u * z[0] + v * z[1] + w * z[2]) / determinant;
        let span = z[0].max(z[1]).max(z[2]) - z[0].min(z[1]).min(z[2]);
        let depth_error = 4.0 * edge_error * span / determinant.abs() + 2.0 * delta;
        let t = depth / self.advance;
        let t_error =
            depth_error / self.advance.abs() * (1.0 + 4.0 * EPSILON) + 2.0 * EPSILON * t.abs();
        // Single precision must be had here too; and the range's ends are exact.
        if t_error > 2f64.powi(-27) * t.abs() {
            return Verdict::Open;
        }
        let Ray { t_min, t_max, .. } = self.ray;
        if t + t_error < t_min || t - t_error > t_max {
            return Verdict::Miss;
        }
        if t - t_error < t_min || t + t_error > t_max {
            return Verdict::Open;
        }
        Verdict::Hit(Nearest {
            slot,
            t,
            t_error,
            u: v / determinant,
            v: w / determinant,
        })
    }
}

/// Whether two triangles have the same corners, in any order.
fn same_corners(a: [Vec3; 3], b: [Vec3; 3]) -> bool {
    a.iter().all(|p| b.contains(p)) && b.iter().all(|p| a.contains(p))
}
