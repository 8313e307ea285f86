//! Checking meshes on a thread of its own; a new request replaces the one before.

use super::check::check;
use super::files::Files;
use super::panic_text;
use super::tasks::{ANY, Progress, lock};
use crate::state::inspection::Sized;
use crate::state::news::News;
use raycast_core::glam::DAffine3;
use raycast_core::health;
use raycast_core::scene::Mesh;
use std::sync::Arc;
use std::sync::atomic::Ordering;

impl Files {
    /// Computes the size of a mesh under its transform.
    pub fn weigh(&self, mesh: Arc<Mesh>, world_from_object: DAffine3) {
        let ticket = self.shared.newest_size.fetch_add(1, Ordering::Relaxed) + 1;
        self.shared.spawn("raycast-size", ANY, move |shared| {
            let goes_on = |_| shared.newest_size.load(Ordering::Relaxed) == ticket;
            let size = health::size(&mesh, &world_from_object, &goes_on);
            Ok(size.map_or(News::Nothing, |size| {
                News::Sized(Sized {
                    mesh: Arc::clone(&mesh),
                    world_from_object,
                    size,
                })
            }))
        });
    }

    /// Checks meshes of objects, if `deep` also for self-intersections; `name` is that of the task. The newest call
    /// wins.
    pub fn check(&self, name: String, meshes: Vec<(usize, Arc<Mesh>)>, deep: bool) {
        let ticket = self.shared.newest_check.fetch_add(1, Ordering::Relaxed) + 1;
        let progress = Arc::new(Progress::default());
        *lock(&self.shared.check) = Some((ticket, name, Arc::clone(&progress)));
        self.shared.spawn("raycast-check", ANY, move |shared| {
            let goes_on = || {
                (shared.wake)();
                shared.newest_check.load(Ordering::Relaxed) == ticket
            };
            let checked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                check(&meshes, deep, &progress, &goes_on)
            }));
            let mut under_way = lock(&shared.check);
            if under_way.as_ref().is_some_and(|(own, ..)| *own == ticket) {
                *under_way = None;
            }
            drop(under_way);
            let checked = checked.map_err(|panic| panic_text(&*panic))?;
            Ok(checked.map_or(News::Nothing, News::Checked))
        });
    }
}
