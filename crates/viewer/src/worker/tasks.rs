//! What tasks share with the window: news, progress, and a named thread for each.

use super::{Wake, panic_text};
use crate::state::news::News;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Mutex, PoisonError};

/// The stage of a load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LoadStage {
    /// Reading; the fraction that is done.
    Reading(f32),
    /// Building the tree.
    Building,
}

pub(super) struct Shared {
    pub(super) send: SyncSender<(u64, News)>,
    pub(super) wake: Wake,
    pub(super) newest_load: AtomicU64,
    pub(super) documents: AtomicU64,
    pub(super) loads: Mutex<Vec<(u64, String, Arc<Progress>)>>,
    pub(super) saves: AtomicU32,
    pub(super) newest_tree: AtomicU64,
    pub(super) newest_size: AtomicU64,
    pub(super) newest_check: AtomicU64,
    /// The check in progress.
    pub(super) check: Mutex<Option<(u64, String, Arc<Progress>)>>,
    pub(super) building: AtomicU32,
    pub(super) building_turn: Mutex<()>,
    /// Every file that was opened: no output may overwrite one.
    pub(super) opened: Mutex<Vec<PathBuf>>,
}

impl std::fmt::Debug for Shared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shared").finish_non_exhaustive()
    }
}

/// The number of news that belong to no load.
pub(super) const ANY: u64 = u64::MAX;
/// The value of progress that means building the tree.
const BUILDING: u32 = u32::MAX;

#[derive(Debug, Default)]
pub(super) struct Progress(AtomicU32);

impl Shared {
    pub(super) fn tell(&self, load: u64, news: News) {
        // Sending fails only after the window was closed.
        let _ = self.send.send((load, news));
        (self.wake)();
    }

    /// Runs a task on a thread of its own; its error or panic becomes a message.
    pub(super) fn spawn(
        self: &Arc<Self>,
        name: &str,
        load: u64,
        task: impl FnOnce(&Self) -> Result<News, String> + Send + 'static,
    ) {
        let shared = Arc::clone(self);
        let run = move || {
            let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| task(&shared)));
            let news = match outcome {
                Ok(Ok(News::Nothing)) => return,
                Ok(Ok(news)) => news,
                Ok(Err(message)) => News::Failed(message),
                Err(panic) => {
                    lock(&shared.loads).retain(|(ticket, ..)| *ticket != load);
                    News::Failed(format!("A fault in this program: {}", panic_text(&*panic)))
                }
            };
            shared.tell(load, news);
        };
        let spawned = std::thread::Builder::new().name(name.to_owned()).spawn(run);
        if let Err(error) = spawned {
            lock(&self.loads).retain(|(ticket, ..)| *ticket != load);
            // The channel may be full, and the window's thread must not wait.
            let message = format!("No thread could be started: {error}");
            let _ = self.send.try_send((ANY, News::Failed(message)));
        }
    }
}

impl Progress {
    pub(super) fn read(&self, share: f32) {
        let share = (share.clamp(0.0, 1.0) * 1e6) as u32;
        self.0.store(share, Ordering::Relaxed);
    }

    pub(super) fn build(&self) {
        self.0.store(BUILDING, Ordering::Relaxed);
    }

    pub(super) fn stage(&self) -> LoadStage {
        match self.0.load(Ordering::Relaxed) {
            BUILDING => LoadStage::Building,
            share => LoadStage::Reading(share as f32 * 1e-6),
        }
    }
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
