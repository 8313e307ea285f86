//! Which hits the masks of materials keep, worked out a second time: within what a hit's barycentrics may be off by.

use super::range::Single;
use super::texture;
use crate::stage::Stage;
use crate::wrong_answer::{GRAZING, UV_BOUND};
use raycast_core::Cull;
use raycast_core::camera::Ray;
use raycast_core::scene::{Opacity, Scene, Wrap};
use raycast_core::shade::Filter;
use raycast_oracle::Truth;

/// The nearest triangle that a ray hits and no mask rejects; `None` where rounding may decide whether a mask keeps a hit
/// that would be the nearest.
pub(crate) fn seen(stage: &Stage, ray: &Ray, cull: Cull) -> Option<Option<Truth>> {
    if !stage.has_masks() {
        return Some(stage.truth(ray, cull));
    }
    // With what is not sure kept, and left out: where both give one hit, it is the nearest in any case.
    let [least, most] = [true, false].map(|unsure| {
        let counts = |truth: &Truth| keeps(&stage.scene, truth).unwrap_or(unsure);
        stage.truth_where(ray, cull, counts)
    });
    let number = |truth: &Option<Truth>| truth.as_ref().map(|t| (t.object, t.triangle));
    (number(&least) == number(&most)).then_some(least)
}

/// Whether a hit counts; `None` where rounding may decide it.
fn keeps(scene: &Scene, truth: &Truth) -> Option<bool> {
    let mesh = &scene.objects.get(truth.object as usize)?.mesh;
    let Opacity::Mask { alpha, cutoff } = mesh.opacity(truth.triangle) else {
        return Some(true);
    };
    let factor = Single::exactly(alpha.factor.into());
    let range = match (&alpha.image, mesh.corner_uvs(truth.triangle)) {
        (Some(image), Some(uvs)) => {
            if truth.cosine <= GRAZING || image.wrap() != [Wrap::Repeat; 2] {
                return None;
            }
            let weight = |weight| Single::around(weight, UV_BOUND).max(0.0).min(1.0);
            let place = texture::place(uvs, weight(truth.u), weight(truth.v));
            let [_, _, _, a] = texture::sample(image, place, Filter::Bilinear);
            a * factor
        }
        _ => factor,
    };
    if !range.is_known() {
        return None;
    }
    let cutoff = f64::from(*cutoff);
    match (range.low >= cutoff, range.high < cutoff) {
        (true, _) => Some(true),
        (_, true) => Some(false),
        _ => None,
    }
}
