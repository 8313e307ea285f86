//! Distances of a scene, and the greys of the depth mode.

use super::mask;
use super::range::{Double, Single};
use crate::stage::Stage;
use crate::wrong_answer::{T_BOUND, ulp};
use raycast_core::Cull;
use raycast_core::camera::{Camera, Projection};
use raycast_core::glam::DVec3;
use rayon::prelude::*;

/// The sRGB greys at the near and the far end of the depth mode.
const NEAR_GREY: f64 = 0.96;
const FAR_GREY: f64 = 0.08;

/// The grey at a distance: near is light, far is dark. The range is that of [`range`].
pub(super) fn grey([near, per_unit]: [Single; 2], t: Single) -> Single {
    let share = ((t - near) * per_unit).max(0.0).min(1.0);
    let [near, far] = [NEAR_GREY, FAR_GREY].map(|grey| Single::exactly(grey).rounded());
    near + (far - near) * share
}

/// The distance at which the depth mode's greys begin, and one over the range that they cover: that of the scene's
/// box; zero for an empty range.
pub(super) fn range(stage: &Stage, camera: &Camera) -> [Single; 2] {
    match distances(stage, camera, camera.pose().eye, true) {
        Some([near, far]) if far.low > near.high => {
            [near.to(), (Double::exactly(1.0) / (far - near)).to()]
        }
        _ => [Single::exactly(0.0); 2],
    }
}

/// The distances from a point to the nearest point and the farthest corner of the scene's box; from the eye of an
/// orthographic camera, along its rays. `None` for an empty scene.
pub(super) fn distances(
    stage: &Stage,
    camera: &Camera,
    from: DVec3,
    is_eye: bool,
) -> Option<[Double; 2]> {
    let bounds = stage.scene.bounds();
    if bounds.is_empty() {
        return None;
    }
    let along_rays = is_eye && camera.projection() == Projection::Orthographic;
    let distances = bounds.corners().map(|corner| match along_rays {
        true => (corner - from).dot(camera.forward()),
        false => corner.distance(from),
    });
    let far = distances.into_iter().fold(0.0, f64::max);
    let near = match along_rays {
        true => distances.into_iter().fold(far, f64::min).max(0.0),
        false => from.clamp(bounds.min, bounds.max).distance(from),
    };
    // Both distances are rounded a few times, each by 2⁻⁵³ of the numbers that went into them.
    let size = from.abs().max_element() + bounds.min.abs().max(bounds.max.abs()).max_element();
    let slack = size * 2f64.powi(-49);
    Some([near, far].map(|distance| Double::around(distance, slack)))
}

/// The nearest and the farthest hit of every 16th ray of the whole picture in both directions, which the depth mode's
/// colours are fitted to. `None` where any is undecided.
pub(super) fn visible_range(stage: &Stage, camera: &Camera, cull: Cull) -> Option<[Double; 2]> {
    let plane = camera.plane();
    // Every 16th, but at most 256 in each direction.
    let stride = plane.columns.max(plane.rows).div_ceil(256).max(16) as usize;
    let places: Vec<(u32, u32)> = (0..plane.rows)
        .step_by(stride)
        .flat_map(|y| (0..plane.columns).step_by(stride).map(move |x| (x, y)))
        .collect();
    let truths: Vec<f64> = places
        .into_par_iter()
        .filter_map(|(x, y)| {
            let ray = camera.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
            // An undecided hit makes the range unknown.
            match mask::closest_visible(stage, &ray, cull) {
                Some(truth) => truth.map(|truth| truth.t),
                None => Some(f64::NAN),
            }
        })
        .collect();
    if truths.iter().any(|t| t.is_nan()) {
        return None;
    }
    let near = truths.iter().copied().reduce(f64::min)?;
    let far = truths.into_iter().reduce(f64::max)?;
    Some([near, far].map(|t| Double::around(t, T_BOUND * ulp(t))))
}
