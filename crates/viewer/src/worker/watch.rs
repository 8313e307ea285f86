//! Watching the files of a scene: changes are reported after a file was written completely.

use super::Wake;
use notify::event::{AccessKind, AccessMode, EventKind, ModifyKind};
use notify::{RecommendedWatcher, RecursiveMode, Watcher};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, SystemTime};

/// How long a file must stay unchanged before it is reported: programs write in pieces.
const QUIET: Duration = Duration::from_millis(300);
/// The number of such intervals after which a file that was not seen to be closed counts as complete: a link was made
/// to it, or an event was lost.
const PATIENCE: u32 = 20;

/// Detects changes of a file: its length, and its modification time.
type Signature = Option<(u64, SystemTime)>;

enum Message {
    Watch(Vec<PathBuf>),
    /// A file was touched; the flag says whether its writer may still have it open.
    Touched(PathBuf, bool),
}

/// A thread that watches files.
pub struct Watch {
    send: Sender<Message>,
    changes: Receiver<PathBuf>,
}

impl Watch {
    /// Starts watching no files. `None` where the system cannot watch files: then F5 reloads.
    pub fn start(wake: Wake) -> Option<Self> {
        let (send, messages) = channel();
        let (tell, changes) = channel();
        let touched = send.clone();
        let watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
            let Ok(event) = event else {
                return;
            };
            let is_closed = event.kind == EventKind::Access(AccessKind::Close(AccessMode::Write));
            let is_change = matches!(event.kind, EventKind::Create(_) | EventKind::Modify(_));
            // Linux reports when a file is closed; renaming is no writing.
            let is_open = cfg!(target_os = "linux")
                && !is_closed
                && !matches!(event.kind, EventKind::Modify(ModifyKind::Name(_)));
            if is_closed || is_change {
                for path in event.paths {
                    // Sending fails only after the thread has ended.
                    let _ = touched.send(Message::Touched(path, is_open));
                }
            }
        });
        let watcher = watcher.ok()?;
        let run = move || run(watcher, &messages, &tell, &wake);
        let thread = std::thread::Builder::new().name("raycast-watch".to_owned());
        thread.spawn(run).ok()?;
        Some(Self { send, changes })
    }

    /// Watches these files from now on, from their present state.
    pub fn watch(&self, files: Vec<PathBuf>) {
        let _ = self.send.send(Message::Watch(files));
    }

    /// Files that have changed since the last call.
    pub fn changes(&self) -> Vec<PathBuf> {
        self.changes.try_iter().collect()
    }
}

fn run(
    mut watcher: RecommendedWatcher,
    messages: &Receiver<Message>,
    tell: &Sender<PathBuf>,
    wake: &Wake,
) {
    let mut files: HashMap<PathBuf, Signature> = HashMap::new();
    let mut folders: HashSet<PathBuf> = HashSet::new();
    // Touched files, with their state when last inspected.
    let mut touched: HashMap<PathBuf, Touched> = HashMap::new();
    loop {
        let message = if touched.is_empty() {
            messages.recv().map_err(|_| RecvTimeoutError::Disconnected)
        } else {
            messages.recv_timeout(QUIET)
        };
        match message {
            Ok(Message::Watch(new)) => {
                touched.clear();
                let known = new.iter().filter_map(|file| place(file));
                files = known
                    .map(|file| {
                        let signature = signature(&file);
                        (file, signature)
                    })
                    .collect();
                let parents: HashSet<_> = files
                    .keys()
                    .filter_map(|f| f.parent().map(Path::to_owned))
                    .collect();
                for gone in folders.difference(&parents) {
                    let _ = watcher.unwatch(gone);
                }
                // Folders, not files: many programs write a new file and rename it.
                for new in parents.difference(&folders) {
                    let _ = watcher.watch(new, RecursiveMode::NonRecursive);
                }
                folders = parents;
            }
            Ok(Message::Touched(path, is_open)) => {
                if files.contains_key(&path) {
                    let patience = if is_open { PATIENCE } else { 0 };
                    let last = signature(&path);
                    touched.insert(path, Touched { last, patience });
                }
            }
            Err(RecvTimeoutError::Timeout) => {
                let mut settled = Vec::new();
                for (path, Touched { last, patience }) in &mut touched {
                    let now = signature(path);
                    if now != *last {
                        *last = now;
                    } else if *patience > 0 {
                        *patience -= 1;
                    } else {
                        settled.push(path.clone());
                    }
                }
                for path in settled {
                    let now = touched.remove(&path).and_then(|touched| touched.last);
                    // A removed file may come back; an empty one is about to be written.
                    let is_whole = now.is_some_and(|(length, _)| length > 0);
                    let known = files.get(&path).copied().flatten();
                    if is_whole && now != known {
                        files.insert(path.clone(), now);
                        if tell.send(path).is_err() {
                            return;
                        }
                        wake();
                    }
                }
            }
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

/// A file that was touched.
struct Touched {
    /// Its state when last inspected.
    last: Signature,
    /// The remaining inspections before it counts as complete.
    patience: u32,
}

/// Where a file is, or will be once it is there.
fn place(file: &Path) -> Option<PathBuf> {
    let there = file.canonicalize().ok();
    there.or_else(|| Some(file.parent()?.canonicalize().ok()?.join(file.file_name()?)))
}

fn signature(path: &Path) -> Signature {
    let found = std::fs::metadata(path).ok()?;
    Some((found.len(), found.modified().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;
    use std::sync::Arc;
    use std::time::Instant;

    fn wait(watch: &Watch) -> Vec<PathBuf> {
        let start = Instant::now();
        while start.elapsed() < Duration::from_secs(20) {
            let changes = watch.changes();
            if !changes.is_empty() {
                return changes;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        Vec::new()
    }

    #[test]
    fn only_files_that_were_written_or_renamed_are_reported() {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path().canonicalize().expect("it is there");
        let (file, other) = (folder.join("a.obj"), folder.join("b.obj"));
        std::fs::write(&file, "v 0 0 0").expect("written");
        let Some(watch) = Watch::start(Arc::new(|| {})) else {
            return;
        };
        watch.watch(vec![file.clone()]);
        std::thread::sleep(Duration::from_millis(300));
        std::fs::write(&other, "v 1 1 1").expect("written");
        std::fs::write(&file, "v 0 0 0 \nv 1 0 0").expect("written");
        assert_eq!(wait(&watch), std::slice::from_ref(&file));
        // A file that is being written is incomplete, however long that takes.
        let mut writer = std::fs::File::create(&file).expect("made");
        writer.write_all(b"v 0 0 0").expect("written");
        std::thread::sleep(QUIET * 3);
        if cfg!(target_os = "linux") {
            assert_eq!(watch.changes(), [] as [PathBuf; 0]);
        }
        writer.write_all(b" and the rest").expect("written");
        drop(writer);
        assert_eq!(wait(&watch), std::slice::from_ref(&file));
        std::fs::rename(&other, &file).expect("moved");
        assert_eq!(wait(&watch), std::slice::from_ref(&file));
        // One that is not there yet.
        let late = folder.join("late.png");
        watch.watch(vec![file, late.clone()]);
        std::thread::sleep(Duration::from_millis(300));
        std::fs::write(&late, "an image").expect("written");
        assert_eq!(wait(&watch), [late]);
    }
}
