use super::dropped::dropped;
use super::nothing_to_see::NothingToSee;
use crate::failure::Failure;
use raycast_core::scene::{Bounds, Scene, Unseen};
use raycast_core::{Accel, Simd};

/// The environment variable that sets the instruction set of packets.
pub const SIMD_VARIABLE: &str = "RAYCAST_SIMD";

/// The instruction set that [`SIMD_VARIABLE`] names, else the machine's widest.
///
/// # Errors
/// A variable that names no instruction set of this machine.
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

/// The least ratio of shown to stored triangles at which a command uses instances. With a smaller ratio they save
/// little memory; with a larger one scenes with moderate repetition take memory and build time for all that they
/// show. Casting takes longer with instances, the more so where objects overlap, which many frames make up for.
const INSTANCES_RATIO: usize = 4;

/// Whether objects share meshes so much that a tree for each mesh saves enough memory.
pub fn has_instances(scene: &Scene) -> bool {
    Accel::stored_triangles(scene).saturating_mul(INSTANCES_RATIO) <= scene.triangle_count()
        && scene.triangle_count() > 0
}

/// The number of triangles that the tree of [`tree`] stores for a scene, for memory estimates.
pub fn stored_triangles(scene: &Scene) -> usize {
    match has_instances(scene) {
        true => Accel::stored_triangles(scene),
        false => scene.triangle_count(),
    }
}

/// The tree over a scene, for the instruction set of [`instruction_set`]: one over all triangles, or one for each
/// mesh where that stores at most a quarter of them. Both give the same answers.
///
/// # Errors
/// As [`Accel::build`], as [`instruction_set`].
pub fn tree(scene: &Scene) -> Result<Accel, Failure> {
    let simd = instruction_set()?;
    let accel = match has_instances(scene) {
        true => Accel::build_instances(scene)?,
        false => Accel::build(scene)?,
    };
    Ok(accel.with_simd(simd))
}

/// One tree over all triangles of a scene: for commands that visit them one by one.
///
/// # Errors
/// As [`tree`].
pub fn single_tree(scene: &Scene) -> Result<Accel, Failure> {
    let simd = instruction_set()?;
    Ok(Accel::build(scene)?.with_simd(simd))
}

/// The tree over a scene whose objects may be moved and hidden: for several objects, a tree for each mesh, so that a
/// move rebuilds the top-level tree only.
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

/// The tree over a scene with visible triangles; `name` is the scene's name in errors.
///
/// # Errors
/// As [`tree`]; [`NothingToSee`] where no triangle is left.
pub fn visible_tree(name: &str, scene: &Scene) -> Result<Accel, Failure> {
    visible(name, scene, tree(scene)?)
}

/// A tree with visible triangles.
///
/// # Errors
/// [`NothingToSee`] where no triangle is left.
pub fn visible(name: &str, scene: &Scene, accel: Accel) -> Result<Accel, Failure> {
    let placed = scene.world_from_objects().unwrap_or_default();
    let mut placed = scene.objects.iter().zip(&placed);
    let is_seen = placed.any(|(object, world_from_object)| {
        object.visible && Unseen::of(object, world_from_object).is_none()
    });
    if accel.is_empty() || !is_seen {
        let hidden = scene.objects.iter().map(|object| {
            let shown = object.kept().len() * usize::from(object.visible);
            object.mesh.kept().len() - shown
        });
        return Err(NothingToSee {
            name: name.to_owned(),
            triangles: scene.triangle_count(),
            dropped: dropped(scene, &accel),
            hidden: hidden.sum(),
        }
        .into());
    }
    Ok(accel)
}

/// The box around what can be seen, without triangles that a transform moved out of range.
pub fn bounds(scene: &Scene, accel: &Accel) -> Bounds {
    match accel.out_of_range() {
        0 => scene.bounds(),
        _ => accel.bounds(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_core::scene::{Mesh, Object, Shape};
    use std::sync::Arc;

    #[test]
    fn commands_have_instances_where_they_save_memory() {
        let ball = Shape::Sphere {
            radius: 1.0,
            segments: 256,
            rings: 128,
        };
        let mesh = Arc::new(Mesh::new(ball.mesh().expect("a shape")));
        let triangles = mesh.triangles().len();
        let scene = |count: u32| {
            let objects = (0..count).map(|number| {
                let mut object = Object::new("ball", Arc::clone(&mesh));
                object.transform.translate.x = f64::from(number);
                object
            });
            Scene {
                objects: objects.collect(),
            }
        };
        assert!(3 * triangles < 1 << 20 && 1 << 20 < 17 * triangles);
        for (count, expected) in [(0, false), (1, false), (3, false), (17, true)] {
            let scene = scene(count);
            assert_eq!(has_instances(&scene), expected, "{count}");
            let stored = if expected { 1 } else { count as usize };
            assert_eq!(stored_triangles(&scene), stored * triangles, "{count}");
        }
        let scene = scene(17);
        let accel = tree(&scene).expect("a tree");
        assert!(accel.has_instances());
        // The default view is that of one tree.
        assert_eq!(bounds(&scene, &accel), scene.bounds());
    }
}
