//! Which hits alpha masks keep, computed independently, within the error of a hit's barycentrics.

use super::range::Single;
use super::texture;
use crate::stage::Stage;
use crate::wrong_answer::{GRAZING, UV_BOUND};
use raycast_core::Cull;
use raycast_core::camera::Ray;
use raycast_core::scene::{Alpha, Mesh, Opacity, Scene, Wrap};
use raycast_core::shade::Filter;
use raycast_oracle::Truth;

/// The closest hit of a ray that no mask rejects; `None` where rounding may decide whether a mask keeps it.
pub(crate) fn closest_visible(stage: &Stage, ray: &Ray, cull: Cull) -> Option<Option<Truth>> {
    if !stage.has_masks() {
        return Some(stage.truth(ray, cull));
    }
    // With undecided hits kept, and with them rejected: if both give the same hit, it is the closest.
    let [least, most] = [true, false].map(|unsure| {
        let counts = |truth: &Truth| keeps(&stage.scene, truth).unwrap_or(unsure);
        stage.truth_where(ray, cull, counts)
    });
    let number = |truth: &Option<Truth>| truth.as_ref().map(|t| (t.object, t.triangle));
    (number(&least) == number(&most)).then_some(least)
}

/// The alpha of a material at a hit; `None` where it is not known.
pub(super) fn alpha(alpha: &Alpha, mesh: &Mesh, truth: &Truth) -> Option<Single> {
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
    range.is_known().then_some(range)
}

/// Whether masks keep a hit; `None` where rounding may decide.
fn keeps(scene: &Scene, truth: &Truth) -> Option<bool> {
    let mesh = &scene.objects.get(truth.object as usize)?.mesh;
    let Opacity::Mask { alpha, cutoff } = mesh.opacity(truth.triangle) else {
        return Some(true);
    };
    let range = self::alpha(alpha, mesh, truth)?;
    let cutoff = f64::from(*cutoff);
    match (range.low >= cutoff, range.high < cutoff) {
        (true, _) => Some(true),
        (_, true) => Some(false),
        _ => None,
    }
}
