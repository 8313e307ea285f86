//! Looking meshes over.

use super::tasks::Progress;
use crate::state::inspection::Checked;
use raycast_core::health;
use raycast_core::scene::Mesh;
use std::collections::HashMap;
use std::sync::Arc;

/// What was found out about a mesh.
type Known = (Arc<health::Health>, Option<Arc<health::Intersections>>);

/// Looks meshes over one after another, each once however many objects have it, and if `deep` for triangles that pass
/// through one another; `None` where `goes_on`, which
/// is asked at each step, says that nobody waits.
pub(super) fn check(
    meshes: &[(usize, Arc<Mesh>)],
    deep: bool,
    progress: &Progress,
    goes_on: &(dyn Fn() -> bool + Sync),
) -> Option<Vec<Checked>> {
    let all: usize = meshes.iter().map(|(_, mesh)| mesh.triangles().len()).sum();
    let mut done = 0;
    let mut known: HashMap<*const Mesh, Known> = HashMap::new();
    let mut checked = Vec::with_capacity(meshes.len());
    for (object, mesh) in meshes {
        let own = mesh.triangles().len();
        let told = |share: f32| {
            progress.read((done as f32 + share * own as f32) / all.max(1) as f32);
            goes_on()
        };
        // Joints are looked at in a small share of the time that a search for intersections takes.
        let joints = if deep { 0.2 } else { 1.0 };
        let (health, intersections) = match known.get(&Arc::as_ptr(mesh)) {
            Some(known) => known.clone(),
            None => {
                let health = health::check(mesh, &|share| told(share * joints))?;
                let search = |share: f32| told(joints + share * (1.0 - joints));
                let found = match deep {
                    true => Some(Arc::new(health::self_intersections(mesh, &search)?)),
                    false => None,
                };
                (Arc::new(health), found)
            }
        };
        known.insert(
            Arc::as_ptr(mesh),
            (Arc::clone(&health), intersections.clone()),
        );
        done += own;
        checked.push(Checked {
            object: *object,
            mesh: Arc::clone(mesh),
            health,
            intersections,
        });
    }
    Some(checked)
}
