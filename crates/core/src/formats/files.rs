use super::Progress;
use std::cell::RefCell;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

/// Where named files come from.
pub(super) trait Files {
    /// All bytes of a file.
    fn read(&self, path: &Path, progress: Progress<'_>) -> io::Result<Vec<u8>>;

    /// The path under which an object remembers its file.
    fn source(&self, path: &Path) -> PathBuf;

    /// The files that were opened so far, each once, by the paths that [`Files::source`] gives.
    fn opened(&self) -> Vec<PathBuf>;
}

/// The files that were opened, each once, in their order.
#[derive(Default)]
struct Opened(RefCell<Vec<PathBuf>>);

impl Opened {
    fn add(&self, path: PathBuf) {
        let mut paths = self.0.borrow_mut();
        if !paths.contains(&path) {
            paths.push(path);
        }
    }

    fn list(&self) -> Vec<PathBuf> {
        self.0.borrow().clone()
    }
}

/// The file system, for one reading of a scene.
#[derive(Default)]
pub(super) struct Disk {
    opened: Opened,
}

impl Files for Disk {
    fn read(&self, path: &Path, progress: Progress<'_>) -> io::Result<Vec<u8>> {
        const STEP: u64 = 1 << 20;
        let mut file = File::open(path)?;
        self.opened.add(self.source(path));
        let length = file.metadata()?.len();
        let mut bytes = Vec::new();
        // The length is what the system says: a pipe has none, and grows as it is read.
        while (&mut file).take(STEP).read_to_end(&mut bytes)? > 0 {
            progress((bytes.len() as f32 / length.max(1) as f32).min(1.0));
        }
        Ok(bytes)
    }

    fn source(&self, path: &Path) -> PathBuf {
        absolute(path)
    }

    fn opened(&self) -> Vec<PathBuf> {
        self.opened.list()
    }
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

/// Files that the caller holds.
pub(super) struct Held<'a> {
    /// Relative path, with `/` between its parts, to bytes.
    resolve: &'a dyn Fn(&str) -> Option<Vec<u8>>,
    opened: Opened,
}

impl<'a> Held<'a> {
    pub(super) fn new(resolve: &'a dyn Fn(&str) -> Option<Vec<u8>>) -> Self {
        Self {
            resolve,
            opened: Opened::default(),
        }
    }
}

impl Files for Held<'_> {
    fn read(&self, path: &Path, progress: Progress<'_>) -> io::Result<Vec<u8>> {
        let source = self.source(path);
        let bytes = source.to_str().and_then(self.resolve);
        if bytes.is_some() {
            self.opened.add(source);
        }
        progress(1.0);
        bytes.ok_or_else(|| io::Error::from(io::ErrorKind::NotFound))
    }

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
}

/// A path that a file names, relative to the file that names it. Backslashes count as separators:
/// many files were written on Windows.
pub(super) fn beside(file: &Path, named: &str) -> PathBuf {
    let named = named.replace('\\', "/");
    match file.parent() {
        Some(folder) => folder.join(named),
        None => PathBuf::from(named),
    }
}

/// The path to `file` from `folder`, with `/` between its parts; `file` itself where the two have no
/// folder in common. `None` where it is not Unicode.
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

    #[test]
    fn held_files_have_plain_names() {
        let held = Held::new(&|name| (name == "a/c.obj").then(|| vec![7]));
        let read = |path: &str| held.read(Path::new(path), &|_| ());
        assert_eq!(read("./a/b/../c.obj").ok(), Some(vec![7]));
        assert!(read("c.obj").is_err());
        assert!(read("a/c.obj").is_ok());
        assert_eq!(held.opened(), [PathBuf::from("a/c.obj")]);
    }
}
