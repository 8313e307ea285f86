use super::Progress;
use super::error::FormatError;
use super::limits::{Budget, Share};
use bytemuck::allocation::try_zeroed_vec;
use rayon::prelude::*;
use std::cell::RefCell;
use std::collections::HashSet;
use std::io;
use std::ops::Deref;
use std::path::{Component, Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Who named a file: that decides which files may be opened.
#[derive(Clone, Copy, Debug)]
pub(super) enum NamedBy<'a> {
    /// A person or a program: anything that can be read to its end, including pipes.
    Person,
    /// A scene file: any regular file.
    Scene,
    /// A mesh or its material library: a regular file in the mesh's folder or the one above.
    Mesh(&'a Path),
}

/// A store of files.
pub(super) trait Files {
    /// Reads a file completely.
    ///
    /// # Errors
    /// Under the file's own name: it cannot be read, may not be opened, or is larger than the budget allows.
    fn read(
        &self,
        path: &Path,
        by: NamedBy<'_>,
        progress: Progress<'_>,
    ) -> Result<Contents<'_>, FormatError>;

    /// Checks that a file may be opened and can be, without reading it; it counts as opened.
    ///
    /// # Errors
    /// Under the file's own name: it is not there, or may not be opened.
    fn check(&self, path: &Path, by: NamedBy<'_>) -> Result<(), FormatError>;

    /// Remembers a file that a mesh names and that nothing shown here needs: if it is there, it counts as opened.
    fn name(&self, path: &Path);

    /// The path by which an object refers to its file.
    fn source(&self, path: &Path) -> PathBuf;

    /// The files that were opened or named so far, each once, as paths that [`Files::source`] gives.
    fn opened(&self) -> Vec<PathBuf>;

    /// The budget of reading.
    fn budget(&self) -> &Budget;
}

/// A file's bytes, counted against the budget.
#[derive(Debug)]
pub(super) struct Contents<'b> {
    bytes: Vec<u8>,
    _share: Share<'b>,
}

impl<'b> Contents<'b> {
    /// Bytes that `share` counts already.
    pub(super) fn new(bytes: Vec<u8>, share: Share<'b>) -> Self {
        Self {
            bytes,
            _share: share,
        }
    }
}

impl Deref for Contents<'_> {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.bytes
    }
}

/// The bytes that are read at once: progress is told, and cancelling is seen, between steps.
const STEP: usize = 1 << 20;

/// A buffer for bytes of unknown length, counted against the budget before it grows.
pub(super) struct Filling<'b> {
    path: PathBuf,
    bytes: Vec<u8>,
    share: Share<'b>,
    /// The expected number of bytes.
    length: usize,
}

impl<'b> Filling<'b> {
    /// Empty, for an unknown number of bytes.
    pub(super) fn new(path: &Path, budget: &'b Budget) -> Result<Self, FormatError> {
        Self::with_length(path, budget, 0)
    }

    pub(super) fn with_length(
        path: &Path,
        budget: &'b Budget,
        length: u64,
    ) -> Result<Self, FormatError> {
        Ok(Self {
            path: path.to_owned(),
            bytes: Vec::new(),
            share: budget.share(path, "the file", length)?,
            length: usize::try_from(length).unwrap_or(usize::MAX),
        })
    }

    /// Reads the expected number of bytes by several threads; `read_at` fills a slice from an offset on. Steps begin in
    /// the order of the offsets, so that a disk is read from its beginning to its end.
    ///
    /// # Errors
    /// The source's own; it has no memory; reading was cancelled.
    pub(super) fn fill(
        &mut self,
        read_at: &(dyn Fn(u64, &mut [u8]) -> io::Result<()> + Sync),
        progress: Progress<'_>,
    ) -> Result<(), FormatError> {
        let no_memory = |()| self.no_memory("there is no memory for it");
        self.bytes = try_zeroed_vec(self.length).map_err(no_memory)?;
        let (path, share, length) = (&self.path, &self.share, self.length);
        let done = AtomicUsize::new(0);
        let steps = self.bytes.chunks_mut(STEP).enumerate().par_bridge();
        steps.try_for_each(|(step, bytes)| {
            share.check_cancelled(path)?;
            read_at((step * STEP) as u64, bytes).map_err(|error| FormatError::io(path, error))?;
            let done = done.fetch_add(bytes.len(), Ordering::Relaxed) + bytes.len();
            progress(done as f32 / length as f32);
            Ok(())
        })
    }

    fn no_memory(&self, reason: &str) -> FormatError {
        FormatError::refused(&self.path, None, reason)
    }

    /// Makes room for more bytes.
    fn reserve(&mut self, more: usize) -> Result<(), FormatError> {
        let reserved = self.bytes.try_reserve_exact(more);
        reserved.map_err(|error| self.no_memory(&error.to_string()))
    }

    /// Reads a source to its end. `more` appends at most the given number of bytes and returns how many; zero at the
    /// end. The inner error is the source's own.
    ///
    /// # Errors
    /// The budget is exhausted.
    pub(super) fn read(
        &mut self,
        more: &mut dyn FnMut(&mut Vec<u8>, u64) -> io::Result<usize>,
    ) -> Result<io::Result<()>, FormatError> {
        self.reserve(self.length.saturating_sub(self.bytes.len()))?;
        loop {
            let mut step = self.length.saturating_sub(self.bytes.len()).min(STEP);
            if step == 0 {
                // A small buffer finds out whether this is the end.
                let mut byte = Vec::new();
                match more(&mut byte, 1) {
                    Err(error) => return Ok(Err(error)),
                    Ok(0) => return Ok(Ok(())),
                    Ok(_) => {}
                }
                let (length, room) = (self.bytes.len(), self.bytes.capacity());
                if length + STEP > room {
                    // The old buffer exists until the new one is filled.
                    let capacity = (length + STEP).max(2 * room);
                    let both = (room + capacity) as u64;
                    self.share.grow(&self.path, "the file", both)?;
                    self.reserve(capacity - length)?;
                }
                self.bytes.extend(byte);
                step = STEP - 1;
            }
            self.share.check_cancelled(&self.path)?;
            if let Err(error) = more(&mut self.bytes, step as u64) {
                return Ok(Err(error));
            }
        }
    }

    pub(super) fn into_contents(self) -> Contents<'b> {
        Contents::new(self.bytes, self.share)
    }
}

/// The files that were opened or named, each once, in order.
#[derive(Default)]
pub(super) struct OpenedFiles(RefCell<(Vec<PathBuf>, HashSet<PathBuf>)>);

impl OpenedFiles {
    pub(super) fn add(&self, path: PathBuf) {
        let (paths, known) = &mut *self.0.borrow_mut();
        if known.insert(path.clone()) {
            paths.push(path);
        }
    }

    pub(super) fn list(&self) -> Vec<PathBuf> {
        self.0.borrow().0.clone()
    }
}

pub(super) fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

/// A path that a file names, relative to that file. Backslashes count as separators, as in files written on Windows.
pub(super) fn beside(file: &Path, named: &str) -> PathBuf {
    let named = named.replace('\\', "/");
    match file.parent() {
        Some(folder) => folder.join(named),
        None => PathBuf::from(named),
    }
}

/// The path to `file` relative to `folder`, with `/` between its parts; `file` itself where they have no folder in
/// common. `None` where it is not Unicode.
pub(super) fn relative(file: &Path, folder: &Path) -> Option<String> {
    let slashed = |path: &Path| path.to_str().map(|text| text.replace('\\', "/"));
    if file.is_relative() {
        return slashed(file);
    }
    let folder = absolute(folder);
    let mut to = file.components().peekable();
    let mut from = folder.components().peekable();
    let mut in_common = false;
    while let Some(part) = to.next_if(|part| from.peek() == Some(part)) {
        from.next();
        in_common |= matches!(part, Component::Normal(_));
    }
    let up: Vec<_> = from.collect();
    if !in_common || up.iter().any(|part| !matches!(part, Component::Normal(_))) {
        return slashed(file);
    }
    let mut path: PathBuf = up.iter().map(|_| Component::ParentDir).collect();
    path.extend(to);
    slashed(&path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_from_a_folder() {
        let check = |file: &str, folder: &str, expected: &str| {
            assert_eq!(
                relative(Path::new(file), Path::new(folder)).as_deref(),
                Some(expected)
            );
        };
        check("/a/b/c.obj", "/a/b", "c.obj");
        check("/a/b/c.obj", "/a", "b/c.obj");
        check("/a/b/c.obj", "/a/d/e", "../../b/c.obj");
        check("/a/b/c.obj", "/a/../d", "/a/b/c.obj");
        check("/a/b/c.obj", "/d", "/a/b/c.obj");
        check("c.obj", "/a", "c.obj");
    }
}
