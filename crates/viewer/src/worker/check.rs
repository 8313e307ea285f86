//! Looking meshes over.

use super::tasks::Progress;
use crate::state::inspection::Checked;
use raycast_core::health;
use raycast_core::scene::Mesh;
use std::collections::HashMap;
use std::sync::Arc;

/// Looks meshes over one after another, each once however many objects have it; `None` where `goes_on`, which
/// is asked at each step, says that nobody waits.
pub(super) fn check(
    meshes: &[(usize, Arc<Mesh>)],
    progress: &Progress,
    goes_on: &(dyn Fn() -> bool + Sync),
) -> Option<Vec<Checked>> {
    let all: usize = meshes.iter().map(|(_, mesh)| mesh.triangles().len()).sum();
    let mut done = 0;
    let mut known: HashMap<*const Mesh, Arc<health::Health>> = HashMap::new();
    let mut checked = Vec::with_capacity(meshes.len());
    for (object, mesh) in meshes {
        let own = mesh.triangles().len();
        let told = |share: f32| {
            progress.read((done as f32 + share * own as f32) / all.max(1) as f32);
            goes_on()
        };
        let health = match known.get(&Arc::as_ptr(mesh)) {
            Some(health) => Arc::clone(health),
            None => Arc::new(health::check(mesh, &told)?),
        };
        known.insert(Arc::as_ptr(mesh), Arc::clone(&health));
        done += own;
        checked.push(Checked {
            object: *object,
            mesh: Arc::clone(mesh),
            health,
        });
    }
    Some(checked)
}
