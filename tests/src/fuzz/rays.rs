//! Ray files, answered as `raycast cast` does it, against exact arithmetic.

use crate::check::{Check, Stage};
use raycast_core::Cull;
use raycast_core::camera::Ray;
use raycast_core::formats::{RAY_BYTES, decode_ray, encode_hit};
use raycast_core::glam::DVec3;
use raycast_report::meshes;
use raycast_report::wrong_answer::compare;
use std::sync::OnceLock;

/// Rays of a file that are answered: more tell nothing new.
const MOST_RAYS: usize = 64;

/// The bit of the first byte that leaves out back faces.
const CULLED: u8 = 0x80;

/// What must hold of rays: the first byte chooses a scene, and whether back faces are seen; whole rays
/// follow.
///
/// # Errors
/// What does not.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    let Some((&choice, rays)) = bytes.split_first() else {
        return Ok(());
    };
    let cull = match choice & CULLED {
        0 => Cull::None,
        _ => Cull::Back,
    };
    let stages = stages();
    let stage = &stages[usize::from(choice & !CULLED) % stages.len()];
    let rays = rays.as_chunks::<RAY_BYTES>().0.iter().take(MOST_RAYS);
    rays.map(decode_ray)
        .try_for_each(|ray| is_answered(stage, &ray, cull))
}

/// Scenes with something to miss.
fn stages() -> &'static [Stage] {
    static STAGES: OnceLock<Vec<Stage>> = OnceLock::new();
    STAGES.get_or_init(|| {
        let at = DVec3::new;
        let quad = [
            at(-1., -1., 0.),
            at(1., -1., 0.),
            at(1., 1., 0.),
            at(-1., 1., 0.),
        ];
        let [a, b, c, d] = quad;
        vec![
            Stage::from_meshes([meshes::octahedron()]),
            Stage::from_meshes([meshes::cuboid(DVec3::NEG_ONE, DVec3::ONE)]),
            // Twice the same, once seen from behind.
            Stage::from_meshes([meshes::soup(&[[a, b, c], [a, c, d], [a, c, b], [a, d, c]])]),
            Stage::from_meshes([meshes::integer_heights(6, 1)]),
            Stage::from_meshes([meshes::sphere(at(148_376.0, 1234.0, -223_423.0), 2.0, 8)]),
            // Small on large.
            Stage::from_meshes([
                meshes::cuboid(at(-1e6, -1e6, -1.0), at(1e6, 1e6, 0.0)),
                meshes::sphere(at(0.25, 0.5, 0.01), 0.01, 6),
            ]),
            Stage::from_meshes([meshes::cuboid(
                at(-5.89e11, -5.89e11, 0.0),
                at(5.89e11, 5.89e11, 12e4),
            )]),
            // Slivers, and one whose numbers are hardly any more.
            Stage::from_meshes([meshes::soup(&[
                [at(0., 0., 0.), at(1., 1e-7, 0.), at(2., 3e-7, 1e-7)],
                [at(0., 0., 0.), at(1e-20, 0., 1e-20), at(0., 1e-20, 0.)],
                [at(-1e18, -1e18, 1.), at(1e18, -1e18, 1.), at(0., 1e18, 1.)],
            ])]),
        ]
    })
}

fn is_answered(stage: &Stage, ray: &Ray, cull: Cull) -> Result<(), String> {
    let hit = stage.accel.cast(ray, cull);
    let message = |fault: &str| Err(format!("{fault}: {ray:?}, {cull:?}, answer {hit:?}"));
    let brute_force = stage.accel.cast_brute_force(ray, cull);
    if hit != brute_force {
        return message(&format!("tree and brute force, {brute_force:?}, differ"));
    }
    if !ray.is_valid() {
        return hit.map_or(Ok(()), |_| message("a hit of a ray that is none"));
    }
    let truth = stage.truth(ray, cull);
    if let Err(fault) = compare(hit.as_ref(), truth.as_ref()) {
        return message(&format!("{fault}, the truth being {truth:?}"));
    }
    let bytes = encode_hit(hit.as_ref());
    let is_miss = bytes[4..12] == [0xff; 8];
    if is_miss != hit.is_none()
        || f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]).is_nan()
    {
        return message(&format!("written as {bytes:?}"));
    }
    Ok(())
}
