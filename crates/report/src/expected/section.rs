//! The colour of sections, computed independently: where a ray reaches a back face through a clipping plane.

use super::light::Lights;
use super::range::{Single, Vector, exactly_single};
use super::srgb;
use crate::stage::Stage;
use raycast_core::Cull;
use raycast_core::camera::{Camera, Projection};
use raycast_core::glam::DVec3;
use raycast_core::scene::Color;
use raycast_core::shade::{LightSet, Mode};
use raycast_oracle::Truth;

/// sRGB.
const SECTION: Color = Color([0xe0, 0x7b, 0x39]);
const OUTLINE: Color = Color([0x2b, 0x15, 0x08]);

/// The least distance from a threshold at which a decision is sure: far more than a few roundings of double
/// precision, and still negligible.
const DECISION_MARGIN: f64 = 1e-9;

/// What a sample shows of sections.
#[derive(Clone, Copy, PartialEq)]
enum SectionSample {
    None,
    /// The plane's unit normal, and the object.
    Section(DVec3, u32),
    Unsure,
}

/// The colour of the sample at (x, y), whose ray hits `truth` first; unknown where it is undecided whether a section
/// or its outline is visible, and `None` where none is.
pub(super) fn color(
    stage: &Stage,
    camera: &Camera,
    mode: Mode,
    (x, y): (f64, f64),
    truth: Option<&Truth>,
) -> Option<Vector<24>> {
    let is_shown = matches!(
        mode,
        Mode::Color | Mode::Flat | Mode::Smooth | Mode::Material | Mode::Texture
    );
    if !is_shown || stage.clip().enabled().next().is_none() {
        return None;
    }
    let sample = sample_section(stage, camera, (x, y), truth);
    let unit = match sample {
        SectionSample::None => return None,
        SectionSample::Unsure => return Some([Single::UNKNOWN; 3]),
        SectionSample::Section(unit, _) => unit,
    };
    let plane = camera.plane();
    let inside = |(x, y): &(f64, f64)| {
        (0.0..f64::from(plane.columns)).contains(x) && (0.0..f64::from(plane.rows)).contains(y)
    };
    let around = [(x - 1.0, y), (x + 1.0, y), (x, y - 1.0), (x, y + 1.0)];
    let around = around.into_iter().filter(inside).map(|place| {
        let truth = stage.truth(&camera.ray(place.0, place.1), Cull::None);
        sample_section(stage, camera, place, truth.as_ref())
    });
    let around: Vec<SectionSample> = around.collect();
    if around
        .iter()
        .any(|next| *next != sample && *next != SectionSample::Unsure)
    {
        return Some(srgb::linear(OUTLINE));
    }
    if around.contains(&SectionSample::Unsure) {
        return Some([Single::UNKNOWN; 3]);
    }
    let near = |x: f32| Single::around(f64::from(x), 2.0 * f64::from(f32::EPSILON));
    let to_us = (-unit).as_vec3().to_array().map(near);
    let light = Lights::new(camera, LightSet::Soft)
        .on(to_us, exactly_single((-camera.forward()).as_vec3()));
    let base = srgb::linear(SECTION);
    Some(std::array::from_fn(|i| base[i] * light[i]))
}

fn sample_section(
    stage: &Stage,
    camera: &Camera,
    (x, y): (f64, f64),
    truth: Option<&Truth>,
) -> SectionSample {
    let ray = camera.ray(x, y);
    let along = ray.direction;
    // Where the ray enters the kept side, through which plane, and where it leaves it.
    let (mut last, mut exit): (Option<(f64, DVec3)>, f64) = (None, f64::INFINITY);
    let mut is_sure = true;
    let mut towards = Vec::new();
    for plane in stage.clip().enabled() {
        let length = plane.normal.length();
        let unit = plane.normal / length;
        let (before, steep) = (
            (plane.offset - plane.normal.dot(ray.origin)) / length,
            unit.dot(along),
        );
        let size = plane.offset.abs() / length + ray.origin.abs().max_element();
        is_sure &= steep.abs() > DECISION_MARGIN && before.abs() > DECISION_MARGIN * size;
        let crossing = before / steep;
        if steep < 0.0 {
            exit = exit.min(crossing);
            continue;
        }
        towards.push(*plane);
        if crossing > 0.0 {
            let other = last.map_or(0.0, |(entry, _)| entry);
            is_sure &= (crossing - other).abs() > DECISION_MARGIN * (crossing + size);
            if crossing > other {
                last = Some((crossing, unit));
            }
        }
    }
    let behind_planes;
    let truth = match (truth, last) {
        (Some(truth), _) => Some(truth),
        (None, Some((entry, _))) if exit.is_finite() => {
            is_sure &= (exit - entry).abs() > DECISION_MARGIN * (exit.abs() + entry);
            behind_planes = (entry < exit || !is_sure).then(|| stage.truth_within(&ray, &towards));
            behind_planes.as_ref().and_then(Option::as_ref)
        }
        (None, _) => None,
    };
    let Some((truth, triangle)) = truth.and_then(|truth| {
        let triangle = stage.oracle.triangle(truth.object, truth.triangle)?;
        Some((truth, triangle))
    }) else {
        return SectionSample::None;
    };
    let eye = camera.pose().eye - triangle.base;
    let [a, b, c] = triangle.corners.map(|corner| corner.as_dvec3() - eye);
    let placed = stage.scene.world_from_objects();
    let is_mirrored =
        placed.is_ok_and(|all| all[truth.object as usize].matrix3.determinant() < 0.0);
    let turn = if is_mirrored { -1.0 } else { 1.0 };
    let normal = (b - a).cross(c - a).normalize_or_zero() * turn;
    let facing = match camera.projection() {
        Projection::Orthographic => normal.dot(along),
        _ => normal.dot(a.normalize_or_zero()),
    };
    if facing < -DECISION_MARGIN {
        return SectionSample::None;
    }
    is_sure &= facing > DECISION_MARGIN;
    match last {
        _ if !is_sure => SectionSample::Unsure,
        Some((_, unit)) => SectionSample::Section(unit, truth.object),
        None => SectionSample::None,
    }
}
