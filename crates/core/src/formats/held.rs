use super::Progress;
use super::error::FormatError;
use super::files::{Contents, Files, NamedBy, OpenedFiles};
use super::limits::Budget;
use std::io;
use std::path::{Component, Path, PathBuf};

/// Files that the caller supplies from memory.
pub(super) struct Held<'a> {
    /// Maps a relative path, with `/` between its parts, to bytes.
    resolve: &'a dyn Fn(&str) -> Option<Vec<u8>>,
    budget: &'a Budget,
    opened: OpenedFiles,
}

impl<'a> Held<'a> {
    pub(super) fn new(resolve: &'a dyn Fn(&str) -> Option<Vec<u8>>, budget: &'a Budget) -> Self {
        Self {
            resolve,
            budget,
            opened: OpenedFiles::default(),
        }
    }

    fn bytes(&self, path: &Path) -> Result<Vec<u8>, FormatError> {
        let source = self.source(path);
        let bytes = source.to_str().and_then(self.resolve);
        let bytes = bytes.ok_or_else(|| FormatError::io(path, io::ErrorKind::NotFound.into()))?;
        self.opened.add(source);
        Ok(bytes)
    }
}

impl Files for Held<'_> {
    fn read(
        &self,
        path: &Path,
        _: NamedBy<'_>,
        progress: Progress<'_>,
    ) -> Result<Contents<'_>, FormatError> {
        let bytes = self.bytes(path)?;
        progress(1.0);
        let size = bytes.capacity() as u64;
        let share = self.budget.share(path, "the file", size)?;
        Ok(Contents::new(bytes, share))
    }

    fn check(&self, path: &Path, _: NamedBy<'_>) -> Result<(), FormatError> {
        self.bytes(path).map(drop)
    }

    /// Nobody writes over what a caller holds.
    fn name(&self, _: &Path) {}

    fn source(&self, path: &Path) -> PathBuf {
        let mut parts: Vec<String> = Vec::new();
        for part in path.components() {
            match part {
                Component::ParentDir => drop(parts.pop()),
                Component::Normal(name) => parts.push(name.to_string_lossy().into_owned()),
                Component::CurDir | Component::RootDir | Component::Prefix(_) => {}
            }
        }
        PathBuf::from(parts.join("/"))
    }

    fn opened(&self) -> Vec<PathBuf> {
        self.opened.list()
    }

    fn budget(&self) -> &Budget {
        self.budget
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_in_a_store_are_normalised() {
        let budget = Budget::default();
        let held = Held::new(&|name| (name == "a/c.obj").then(|| vec![7]), &budget);
        let read = |path: &str| held.read(Path::new(path), NamedBy::Person, &|_| ());
        assert_eq!(read("./a/b/../c.obj").expect("it is there")[..], [7]);
        assert!(read("c.obj").is_err());
        assert!(read("a/c.obj").is_ok());
        assert_eq!(held.opened(), [PathBuf::from("a/c.obj")]);
    }
}
