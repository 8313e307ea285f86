use super::Progress;
use super::error::FormatError;
use super::files::{Contents, Files, Filling, NamedBy, OpenedFiles, absolute};
use super::kind::{Start, is_lfs_pointer};
use super::limits::Budget;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Component, Path, PathBuf};

/// The length from which on a file is read by several threads: most of the time goes into new memory, and one thread
/// copies less than memory can take. With shorter files the threads have woken when it is over.
const LARGE: u64 = 4 << 20;

/// The file system, as the files of one scene are read from it.
pub(super) struct Disk<'b> {
    budget: &'b Budget,
    opened: OpenedFiles,
}

impl<'b> Disk<'b> {
    pub(super) fn new(budget: &'b Budget) -> Self {
        Self {
            budget,
            opened: OpenedFiles::default(),
        }
    }

    /// A regular file that a person named, to be read where it is wanted, and its kind, if its first bytes and its length
    /// tell one; `None` of any other, and of what cannot be opened.
    pub(super) fn open_if<Kind>(
        &self,
        path: &Path,
        kind: impl Fn(&Start, u64) -> Option<Kind>,
    ) -> Option<(OpenFile, Kind)> {
        // What a pipe gives is gone once it is looked at.
        if !std::fs::metadata(path).ok()?.is_file() {
            return None;
        }
        let file = open(path, false).ok()?;
        let length = file.metadata().ok()?.len();
        let file = OpenFile { file, length };
        let mut start: Start = [0; _];
        file.read_at(0, &mut start).ok()?;
        let kind = kind(&start, length)?;
        self.opened.add(self.source(path));
        Some((file, kind))
    }

    /// The first bytes of a regular file that a person named, at most `most`.
    pub(super) fn start(&self, path: &Path, most: u64) -> Result<Vec<u8>, FormatError> {
        let mut bytes = Vec::new();
        let read = open_regular(path)?.take(most).read_to_end(&mut bytes);
        read.map_err(|error| FormatError::io(path, error))?;
        self.opened.add(self.source(path));
        Ok(bytes)
    }

    /// Opens a file that may be opened.
    fn open(&self, path: &Path, by: NamedBy<'_>) -> Result<File, FormatError> {
        let refused = |error| FormatError::io(path, error);
        if let NamedBy::Mesh(mesh) = by
            && !self.budget.limits().follow_anywhere
            && !is_near(path, mesh).map_err(refused)?
        {
            let reason = "it is neither in the mesh's folder nor in the one above, and is not \
                          followed without `follow-anywhere`";
            return Err(FormatError::refused(path, None, reason));
        }
        let file = open(path, matches!(by, NamedBy::Person)).map_err(refused)?;
        self.opened.add(self.source(path));
        Ok(file)
    }
}

/// Opens a regular file for reading. What is none is refused without waiting for the other end of a pipe.
///
/// # Errors
/// A file that is not there or cannot be opened, a folder, a pipe, a device.
pub fn open_regular(path: &Path) -> Result<File, FormatError> {
    open(path, false).map_err(|error| FormatError::io(path, error))
}

/// A file that is read here and there.
pub(super) struct OpenFile {
    file: File,
    /// Bytes that it had when it was opened.
    pub(super) length: u64,
}

impl OpenFile {
    /// Fills a slice from an offset in the file on.
    #[cfg(unix)]
    pub(super) fn read_at(&self, at: u64, to: &mut [u8]) -> io::Result<()> {
        let read = std::os::unix::fs::FileExt::read_exact_at(&self.file, to, at);
        read.map_err(|error| match error.kind() {
            io::ErrorKind::UnexpectedEof => io::Error::other("it was cut short while it was read"),
            _ => error,
        })
    }

    /// Elsewhere files are read from their beginning.
    #[cfg(not(unix))]
    pub(super) fn read_at(&self, _: u64, _: &mut [u8]) -> io::Result<()> {
        Err(io::ErrorKind::Unsupported.into())
    }
}

impl Files for Disk<'_> {
    fn read(
        &self,
        path: &Path,
        by: NamedBy<'_>,
        progress: Progress<'_>,
    ) -> Result<Contents<'_>, FormatError> {
        let refused = |error| FormatError::io(path, error);
        let file = self.open(path, by)?;
        let length = file.metadata().map_err(refused)?.len();
        let mut file = OpenFile { file, length };
        let mut filling = Filling::with_length(path, self.budget, length)?;
        let mut done = 0;
        if cfg!(unix) && length >= LARGE {
            filling.fill(&|at, to| file.read_at(at, to), progress)?;
            file.file.seek(SeekFrom::Start(length)).map_err(refused)?;
            done = length as usize;
        }
        let read = filling.read(&mut |bytes, most| {
            let read = (&mut file.file).take(most).read_to_end(bytes)?;
            done += read;
            progress((done as f32 / length.max(1) as f32).min(1.0));
            Ok(read)
        })?;
        read.map_err(refused)?;
        let contents = filling.into_contents();
        if is_lfs_pointer(&contents) {
            let reason =
                "it is a Git LFS pointer in place of the file, which `git lfs pull` fetches";
            return Err(FormatError::refused(path, None, reason));
        }
        Ok(contents)
    }

    fn check(&self, path: &Path, by: NamedBy<'_>) -> Result<(), FormatError> {
        self.open(path, by).map(drop)
    }

    fn name(&self, path: &Path) {
        if path.is_file() {
            self.opened.add(self.source(path));
        }
    }

    fn source(&self, path: &Path) -> PathBuf {
        absolute(path)
    }

    fn opened(&self) -> Vec<PathBuf> {
        self.opened.list()
    }

    fn budget(&self) -> &Budget {
        self.budget
    }
}

/// Opens a regular file without blocking; with `pipes`, also a pipe, waiting for its other end. Devices are not
/// opened: they have no end, and opening some has side effects.
fn open(path: &Path, pipes: bool) -> io::Result<File> {
    let check = |metadata: std::fs::Metadata| {
        let what = match metadata.file_type() {
            kind if kind.is_file() || (pipes && !kind.is_dir() && !is_device(kind)) => {
                return Ok(());
            }
            kind if kind.is_dir() => "a folder",
            kind if is_device(kind) => "a device",
            _ => "a pipe or a socket",
        };
        Err(io::Error::other(format!(
            "it is {what}, not a regular file"
        )))
    };
    check(std::fs::metadata(path)?)?;
    let mut options = File::options();
    options.read(true);
    // The name may stand for another file since the check: opening a pipe must not block.
    #[cfg(unix)]
    if !pipes {
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags(rustix::fs::OFlags::NONBLOCK.bits() as i32);
    }
    let file = options.open(path)?;
    check(file.metadata()?)?;
    Ok(file)
}

#[cfg(unix)]
fn is_device(kind: std::fs::FileType) -> bool {
    use std::os::unix::fs::FileTypeExt;
    kind.is_char_device() || kind.is_block_device()
}

#[cfg(not(unix))]
fn is_device(_: std::fs::FileType) -> bool {
    false
}

/// Whether a path lies in the folder of `mesh` or in the one above, with all their subfolders, both as written and
/// after following links. If the folder above is the file system's root, only the mesh's own folder counts, since
/// everything lies in the root.
fn is_near(path: &Path, mesh: &Path) -> io::Result<bool> {
    let within = |path: &Path, mesh: &Path| {
        let folder = mesh.parent().unwrap_or(mesh);
        let area = match folder.parent() {
            Some(above) if above.parent().is_some() => above,
            _ => folder,
        };
        path.starts_with(area)
    };
    let as_written = |path: &Path| plain(&absolute(path));
    if !within(&as_written(path), &as_written(mesh)) {
        return Ok(false);
    }
    // If the mesh itself is a link, the neighbours of the link and those of its target are allowed.
    let real = std::fs::canonicalize(path)?;
    let folder = mesh.parent().filter(|folder| *folder != Path::new(""));
    let beside_link = std::fs::canonicalize(folder.unwrap_or(Path::new(".")))?.join("mesh");
    let beside_file = std::fs::canonicalize(mesh).unwrap_or_else(|_| beside_link.clone());
    Ok(within(&real, &beside_link) || within(&real, &beside_file))
}

/// The absolute path without `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => drop(plain.pop()),
            part => plain.push(part),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::super::files::beside;
    use super::super::limits::Limits;
    use super::*;

    fn limited(bytes: u64) -> Budget {
        Budget::new(Limits {
            bytes,
            ..Limits::default()
        })
    }

    #[test]
    fn files_are_counted_before_they_are_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        std::fs::write(&path, [7; 5000]).expect("a file");
        let budget = limited(5000);
        let disk = Disk::new(&budget);
        let first = disk.read(&path, NamedBy::Scene, &|_| ()).expect("it fits");
        assert_eq!(first[..], [7; 5000]);
        let second = disk
            .read(&path, NamedBy::Scene, &|_| ())
            .expect_err("two do not");
        assert!(second.to_string().contains("limit `bytes`"), "{second}");
        drop(first);
        assert!(disk.read(&path, NamedBy::Person, &|_| ()).is_ok());
    }

    #[test]
    fn pointers_of_git_lfs_are_named_as_such() {
        let folder = tempfile::tempdir().expect("a folder");
        let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n";
        for name in ["a.obj", "a.toml", "a.glb", "a"] {
            let path = folder.path().join(name);
            std::fs::write(&path, pointer).expect("a file");
            let error = crate::formats::read_scene(&path, &|_| ()).expect_err("no mesh");
            let message = error.to_string();
            assert!(
                message.contains(&format!("{name}: it is a Git LFS pointer")),
                "{message}"
            );
        }
        let image = folder.path().join("a.png");
        std::fs::write(&image, pointer).expect("a file");
        let error = crate::formats::read_texture(&image).expect_err("no image");
        assert!(error.to_string().contains("`git lfs pull`"), "{error}");
    }

    /// Of several steps, the last of which is shorter.
    #[test]
    fn large_files_are_read_in_the_order_of_their_bytes() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        let numbers = 0..(LARGE as u32 + 4444) / 4;
        let bytes: Vec<u8> = numbers.flat_map(u32::to_le_bytes).collect();
        std::fs::write(&path, &bytes).expect("a file");
        let length = bytes.len() as u64;
        let done = std::sync::Mutex::new(Vec::new());
        let progress = |share| done.lock().expect("no thread panicked").push(share);
        let budget = limited(length);
        let disk = Disk::new(&budget);
        let read = disk.read(&path, NamedBy::Person, &progress);
        assert!(read.expect("it fits")[..] == bytes);
        let done = done.into_inner().expect("no thread panicked");
        assert!(done.len() > 4 && done.contains(&1.0), "{done:?}");
        let budget = limited(length - 1);
        let disk = Disk::new(&budget);
        let refused = disk.read(&path, NamedBy::Person, &|_| ());
        let refused = refused.expect_err("it does not").to_string();
        assert!(refused.contains("limit `bytes`"), "{refused}");
    }

    #[test]
    fn a_mesh_is_followed_to_its_folder_and_the_one_above() {
        let folder = tempfile::tempdir().expect("a folder");
        let root = folder.path();
        for name in ["a/b/c", "a/textures", "elsewhere"] {
            std::fs::create_dir_all(root.join(name)).expect("a folder");
        }
        let mesh = root.join("a/b/mesh.obj");
        for name in [
            "a/b/mesh.obj",
            "a/b/c/x",
            "a/b/x",
            "a/x",
            "a/textures/x",
            "x",
            "elsewhere/x",
        ] {
            std::fs::write(root.join(name), "x").expect("a file");
        }
        let read = |named: &str, follow_anywhere: bool| {
            let budget = Budget::new(Limits {
                follow_anywhere,
                ..Limits::default()
            });
            let disk = Disk::new(&budget);
            let read = disk.read(&beside(&mesh, named), NamedBy::Mesh(&mesh), &|_| ());
            read.map(|_| ()).map_err(|error| error.to_string())
        };
        for near in [
            "x",
            "c/x",
            "../x",
            "../textures/x",
            "..\\textures\\x",
            "c/../../b/x",
        ] {
            assert_eq!(read(near, false), Ok(()), "{near}");
        }
        let absolute = root.join("elsewhere/x").display().to_string();
        for far in [
            "../../x",
            "../../elsewhere/x",
            "c/../../../x",
            &absolute,
            "/dev/null",
        ] {
            let message = read(far, false).expect_err(far);
            assert!(message.contains("`follow-anywhere`"), "{message}");
        }
        assert_eq!(read("../../x", true), Ok(()));
        assert!(
            read("/dev/null", true)
                .expect_err("a device")
                .contains("a device")
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_file_that_is_cut_while_it_is_open_says_so() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        std::fs::write(&path, [7; 5000]).expect("a file");
        let budget = limited(5000);
        let disk = Disk::new(&budget);
        let first = |start: &Start, length| (length == 5000).then_some(start[0]);
        let is =
            |byte| move |start: &Start, length| first(start, length).filter(|first| *first == byte);
        assert!(disk.open_if(&path, is(8)).is_none());
        assert!(disk.opened().is_empty());
        let (file, kind) = disk.open_if(&path, is(7)).expect("it is right");
        assert_eq!(kind, 7);
        assert_eq!((disk.opened(), file.length), (vec![path.clone()], 5000));
        let mut to = [0; 100];
        file.read_at(4900, &mut to).expect("they are there");
        assert_eq!(to, [7; 100]);
        std::fs::write(&path, [7; 4950]).expect("a file");
        let error = file.read_at(4900, &mut to).expect_err("they are gone");
        assert!(error.to_string().contains("cut short"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_no_further_than_names() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().expect("a folder");
        let root = folder.path();
        std::fs::create_dir_all(root.join("a/b")).expect("a folder");
        std::fs::create_dir_all(root.join("elsewhere")).expect("a folder");
        std::fs::write(root.join("elsewhere/x"), "x").expect("a file");
        symlink("../../elsewhere", root.join("a/b/link")).expect("a link");
        let budget = Budget::default();
        let disk = Disk::new(&budget);
        let mesh = root.join("a/b/mesh.obj");
        let named = disk.read(&beside(&mesh, "link/x"), NamedBy::Mesh(&mesh), &|_| ());
        assert!(named.is_err_and(|error| error.to_string().contains("follow-anywhere")));
        // A mesh that is a link may also use the neighbours of its target.
        std::fs::write(root.join("elsewhere/mesh.obj"), "x").expect("a file");
        symlink("../../elsewhere/mesh.obj", &mesh).expect("a link");
        assert!(
            disk.read(&beside(&mesh, "link/x"), NamedBy::Mesh(&mesh), &|_| ())
                .is_ok()
        );
    }

    #[cfg(unix)]
    #[test]
    fn pipes_are_read_for_people_alone_and_within_the_limit() {
        let folder = tempfile::tempdir().expect("a folder");
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(
            made.is_ok_and(|status| status.success()),
            "a pipe can be made"
        );
        let budget = limited(64 << 20);
        let disk = Disk::new(&budget);
        let mesh = folder.path().join("mesh.obj");
        for by in [NamedBy::Scene, NamedBy::Mesh(&mesh)] {
            let message = disk
                .read(&pipe, by, &|_| ())
                .expect_err("a pipe")
                .to_string();
            assert!(message.ends_with("not a regular file"), "{message}");
        }
        let device = disk.read(Path::new("/dev/zero"), NamedBy::Person, &|_| ());
        assert!(device.is_err_and(|error| error.to_string().contains("a device")));
        assert!(disk.opened().is_empty());
        let fill = |count: usize| {
            let pipe = pipe.clone();
            std::thread::spawn(move || {
                use std::io::Write;
                let mut file = File::options().write(true).open(pipe).expect("a pipe");
                // The reader may close its end early.
                let _ = file.write_all(&vec![7; count]);
            })
        };
        let writer = fill(3_000_000);
        let read = disk.read(&pipe, NamedBy::Person, &|_| ()).expect("it fits");
        assert_eq!(read.len(), 3_000_000);
        drop(read);
        writer.join().expect("the writer is done");
        let writer = fill(100 << 20);
        let message = disk
            .read(&pipe, NamedBy::Person, &|_| ())
            .expect_err("too much");
        assert!(message.to_string().contains("limit `bytes`"), "{message}");
        writer.join().expect("the writer is done");
    }
}
