use super::dropped::dropped;
use super::nothing_to_see::NothingToSee;
use crate::failure::Failure;
use raycast_core::scene::{Bounds, Scene};
use raycast_core::{Accel, Simd};

/// The environment variable that forces an instruction set on the casting of tiles.
pub const SIMD_VARIABLE: &str = "RAYCAST_SIMD";

/// The instruction set that [`SIMD_VARIABLE`] names, else the machine's widest.
///
/// # Errors
/// A variable that names no instruction set that this machine has.
pub fn instruction_set() -> Result<Simd, Failure> {
    let Some(name) = std::env::var_os(SIMD_VARIABLE) else {
        return Ok(Simd::best());
    };
    let name = name.to_string_lossy();
    let simd: Simd = name
        .parse()
        .map_err(|expected| Failure::usage(format!("{SIMD_VARIABLE}: {expected}")))?;
    if simd > Simd::best() {
        return Err(Failure::usage(format!(
            "{SIMD_VARIABLE}: this machine has no {name}; its widest is {}",
            Simd::best().name()
        )));
    }
    Ok(simd)
}

/// The tree over a scene, for the instruction set of [`instruction_set`].
///
/// # Errors
/// As [`Accel::build`], as [`instruction_set`].
pub fn tree(scene: &Scene) -> Result<Accel, Failure> {
    let simd = instruction_set()?;
    Ok(Accel::build(scene)?.with_simd(simd))
}

/// The tree over a scene whose objects may come to be moved and hidden: of more than one object, a tree for each
/// mesh, with which a move rebuilds the top-level tree alone. Where nothing is moved [`tree`] is faster to cast at.
///
/// # Errors
/// As [`tree`].
pub fn tree_to_edit(scene: &Scene) -> Result<Accel, Failure> {
    let simd = instruction_set()?;
    Ok(match &scene.objects[..] {
        [] | [_] => Accel::build(scene)?,
        _ => Accel::build_instances(scene)?,
    }
    .with_simd(simd))
}

/// The tree over a scene of which something can be seen; `name` is what an error calls it.
///
/// # Errors
/// As [`tree`]; [`NothingToSee`] where no triangle is left.
pub fn visible_tree(name: &str, scene: &Scene) -> Result<Accel, Failure> {
    visible(name, scene, tree(scene)?)
}

/// A tree of which something can be seen.
///
/// # Errors
/// [`NothingToSee`] where no triangle is left.
pub fn visible(name: &str, scene: &Scene, accel: Accel) -> Result<Accel, Failure> {
    if accel.is_empty() {
        return Err(NothingToSee {
            name: name.to_owned(),
            triangles: scene.triangle_count(),
            dropped: dropped(scene, &accel),
        }
        .into());
    }
    Ok(accel)
}

/// The box around what can be seen: a triangle that its transform moved out of range is not.
pub fn bounds(scene: &Scene, accel: &Accel) -> Bounds {
    if accel.out_of_range() == 0 && !accel.has_instances() {
        return scene.bounds();
    }
    accel.bounds()
}
