//! Checking meshes for faults.

use super::tasks::Progress;
use crate::state::inspection::Checked;
use raycast_core::health;
use raycast_core::scene::Mesh;
use std::collections::HashMap;
use std::sync::Arc;

/// The results for a mesh.
type Known = (Arc<health::Health>, Option<Arc<health::Intersections>>);

/// Checks meshes one after another, each once however many objects share it; with `deep` also for self-intersections.
/// `None` if `goes_on`, which is called at each step, returns false.
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
        // Topology takes a small fraction of the time of searching intersections.
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
