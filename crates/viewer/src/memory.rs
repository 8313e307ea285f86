//! The memory that this process may still take, and refusals of what needs more.
//!
//! A process that runs out of memory is killed, by the system or by its own allocator, without a word about what was
//! too large. So the memory of a picture is estimated before it is started, and compared with the least of what the
//! process's own limits, its control group and the machine leave.

use crate::failure::Failure;
use raycast_core::formats::{Budget, Limits};
use std::fmt;
use std::path::{Path, PathBuf};

/// The limit that leaves least.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// `RLIMIT_AS`: the process's address space (`ulimit -v`).
    AddressSpace,
    /// `RLIMIT_DATA`: its data segment (`ulimit -d`).
    Data,
    /// The memory limit of the control group, such as a container's.
    ControlGroup,
    /// The machine's memory.
    Machine,
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AddressSpace => "this process's limit of address space (ulimit -v)",
            Self::Data => "this process's limit of data (ulimit -d)",
            Self::ControlGroup => "its control group",
            Self::Machine => "this machine",
        })
    }
}

/// Address space that a thread reserves at its start, used or not: glibc's allocator reserves 64 MiB for each, and
/// its stack takes some 8 MiB. Encoders start as many threads as the machine has.
const THREAD_BYTES: u64 = 72 << 20;

/// The quarters of the remaining address space that estimates may take: lists that double ask for more than they
/// fill, which costs addresses but no memory.
const ADDRESS_QUARTERS: u64 = 3;

/// The memory that is left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AvailableMemory {
    /// The bytes that the process may take in addition.
    pub bytes: u64,
    /// The limit that decides it.
    pub limit: Limit,
}

/// Limits of a process in bytes; `None` for unlimited.
#[derive(Clone, Copy, Debug, Default)]
struct ProcessLimits {
    /// The number of threads that it may still start.
    threads: u64,
    address_space: Option<u64>,
    data: Option<u64>,
}

impl AvailableMemory {
    /// The memory that is left now; `None` where the system does not report it.
    pub fn now() -> Option<Self> {
        Self::from_system_files(Path::new("/"), process_limits())
    }

    /// As reported by a Linux system's files under `root`.
    fn from_system_files(root: &Path, limits: ProcessLimits) -> Option<Self> {
        let status = read(&root.join("proc/self/status")).unwrap_or_default();
        let has = |key: &str| kibibytes(&status, key).unwrap_or(0);
        let left = |limit: Option<u64>, has: u64| limit.map(|limit| limit.saturating_sub(has));
        let addresses = left(limits.address_space, has("VmSize:"));
        let addresses = addresses.map(|left| left.saturating_sub(limits.threads * THREAD_BYTES));
        let addresses = addresses.map(|left| left / 4 * ADDRESS_QUARTERS);
        let meminfo = read(&root.join("proc/meminfo")).unwrap_or_default();
        [
            (Limit::AddressSpace, addresses),
            (Limit::Data, left(limits.data, has("VmData:"))),
            (Limit::ControlGroup, control_group(root)),
            (Limit::Machine, kibibytes(&meminfo, "MemAvailable:")),
        ]
        .into_iter()
        .filter_map(|(limit, bytes)| {
            Some(Self {
                bytes: bytes?,
                limit,
            })
        })
        .min_by_key(|available| available.bytes)
    }

    /// As [`check_scene`].
    fn check_scene(self, name: &str, triangles: usize, levels: u64) -> Result<(), Failure> {
        let tree = triangles as u64 * TREE_BYTES;
        let over = format!("{name}: the tree over {triangles} triangles");
        let (what, fits) = match self.bytes.checked_sub(levels) {
            _ if levels == 0 => (
                over,
                format!("{} triangles would fit", self.bytes / TREE_BYTES),
            ),
            Some(left) if left >= TREE_BYTES => (
                format!("{over} and its textures' mip levels"),
                format!("{} triangles would fit", left / TREE_BYTES),
            ),
            _ => (
                format!("{over} and its textures' mip levels"),
                "the filters nearest and bilinear need no mip levels".to_owned(),
            ),
        };
        self.check(tree.saturating_add(levels), what, fits)
    }

    /// As [`check_threads`].
    fn check_threads(self) -> Result<(), Failure> {
        if self.bytes > 0 || self.limit != Limit::AddressSpace {
            return Ok(());
        }
        let limit = self.limit;
        Err(Failure::could_not(format!(
            "{limit} leaves no room for worker threads"
        )))
    }

    /// Refuses what needs more memory than is left. `what` needs it, `instead` would fit.
    ///
    /// # Errors
    /// Too little memory, with the figures.
    pub fn check(
        self,
        bytes: u64,
        what: impl fmt::Display,
        instead: impl fmt::Display,
    ) -> Result<(), Failure> {
        if bytes <= self.bytes {
            return Ok(());
        }
        Err(Failure::could_not(format!(
            "{what} needs {} of memory, and {} leaves {}: {instead}",
            Size(bytes),
            self.limit,
            Size(self.bytes)
        )))
    }
}

/// An unused budget of reading, within these limits and the memory that is left.
pub fn budget(limits: Limits) -> Budget {
    let budget = Budget::new(limits);
    match AvailableMemory::now() {
        Some(available) => budget.within_memory(available.bytes, available.limit.to_string()),
        None => budget,
    }
}

/// An upper bound of the memory that building the tree takes, in bytes a triangle: 180 were measured at the peak of
/// reading and building a mesh of a million. A larger value would refuse scenes that fit; with a smaller one commands
/// would fail halfway.
const TREE_BYTES: u64 = 200;

/// Refuses to start worker threads where no address space would be left for anything else: the standard library aborts
/// a process in which a thread cannot have the second stack that handles overflows of its first.
///
/// # Errors
/// The limit that leaves nothing.
pub fn check_threads() -> Result<(), Failure> {
    AvailableMemory::now().map_or(Ok(()), AvailableMemory::check_threads)
}

/// Refuses a scene for whose tree too little memory is left.
///
/// # Errors
/// Too many triangles, with the figures and how many would fit.
pub fn check_tree(name: &str, triangles: usize) -> Result<(), Failure> {
    check_scene(name, triangles, 0)
}

/// Refuses a scene for whose tree, and `levels` bytes of mip levels that are made when a pixel first needs them, too
/// little memory is left.
///
/// # Errors
/// Too many triangles or too large textures, with the figures and what would fit.
pub fn check_scene(name: &str, triangles: usize, levels: u64) -> Result<(), Failure> {
    match AvailableMemory::now() {
        Some(available) => available.check_scene(name, triangles, levels),
        None => Ok(()),
    }
}

/// Refuses a picture for which too little memory is left; `memory_for` gives the memory of a picture of a size, and
/// `otherwise` names other ways to make it.
///
/// # Errors
/// Too large a picture, with the figures and the largest of its shape that would fit.
pub fn check_picture(
    name: &Path,
    (columns, rows): (u32, u32),
    memory_for: impl Fn(u32, u32) -> u64,
    otherwise: &str,
) -> Result<(), Failure> {
    let Some(available) = AvailableMemory::now() else {
        return Ok(());
    };
    let what = format!("{}: a picture of {columns}x{rows}", name.display());
    let fits = match largest((columns, rows), available.bytes, &memory_for) {
        Some((columns, rows)) => format!("{columns}x{rows} would fit{otherwise}"),
        None => format!("no picture would fit{otherwise}"),
    };
    available.check(memory_for(columns, rows), what, fits)
}

/// Refuses a picture made in bands if too little memory is left for one band.
///
/// # Errors
/// Too wide a picture, with the figures.
pub fn check_band(name: &Path, bytes: u64) -> Result<(), Failure> {
    let Some(available) = AvailableMemory::now() else {
        return Ok(());
    };
    let what = format!("{}: a band of the picture", name.display());
    available.check(bytes, what, "a narrower picture would fit")
}

/// The largest picture of a shape that takes at most so many bytes.
fn largest(
    (columns, rows): (u32, u32),
    bytes: u64,
    memory_for: impl Fn(u32, u32) -> u64,
) -> Option<(u32, u32)> {
    // In 4096ths of the sides: finer differences do not matter in a message.
    let scaled = |share: u32| {
        let side = |side: u32| (u64::from(side) * u64::from(share) / 4096) as u32;
        (side(columns), side(rows))
    };
    (1..=4096)
        .rev()
        .map(scaled)
        .find(|&(columns, rows)| columns > 0 && rows > 0 && memory_for(columns, rows) <= bytes)
}

/// A number of bytes, formatted for people.
struct Size(u64);

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mebibytes = self.0 as f64 / f64::from(1 << 20);
        if mebibytes < 1024.0 {
            write!(f, "{mebibytes:.0} MiB")
        } else {
            write!(f, "{:.1} GiB", mebibytes / 1024.0)
        }
    }
}

#[cfg(target_os = "linux")]
fn process_limits() -> ProcessLimits {
    use rustix::process::{Resource, getrlimit};
    ProcessLimits {
        threads: std::thread::available_parallelism().map_or(1, |count| count.get() as u64),
        address_space: getrlimit(Resource::As).current,
        data: getrlimit(Resource::Data).current,
    }
}

#[cfg(not(target_os = "linux"))]
fn process_limits() -> ProcessLimits {
    ProcessLimits::default()
}

/// The least that the process's control group and its ancestors leave.
fn control_group(root: &Path) -> Option<u64> {
    let groups = read(&root.join("proc/self/cgroup"))?;
    let cgroups = root.join("sys/fs/cgroup");
    let mut least: Option<u64> = None;
    for line in groups.lines() {
        // `4:memory:/path` in version 1, `0::/path` in version 2.
        let mut fields = line.splitn(3, ':').skip(1);
        let (controllers, path) = (fields.next()?, fields.next()?);
        let files = if controllers.is_empty() {
            let names = ["memory.max", "memory.current", "inactive_file "];
            Some((cgroups.clone(), names))
        } else if controllers.split(',').any(|name| name == "memory") {
            let names = [
                "memory.limit_in_bytes",
                "memory.usage_in_bytes",
                "total_inactive_file ",
            ];
            Some((cgroups.join("memory"), names))
        } else {
            None
        };
        let Some((mount, names)) = files else {
            continue;
        };
        for group in group_folders(&mount, path) {
            if let Some(left) = group_bytes_left(&group, names) {
                least = Some(least.map_or(left, |least| least.min(left)));
            }
        }
    }
    least
}

/// The folders of a group and its ancestors. In a container the path often exists on the host only; the mount itself
/// is then the group's folder.
fn group_folders(mount: &Path, path: &str) -> Vec<PathBuf> {
    let leaf = mount.join(path.trim_start_matches('/'));
    let mut folders: Vec<PathBuf> = leaf
        .ancestors()
        .take_while(|folder| folder.starts_with(mount))
        .map(Path::to_owned)
        .collect();
    if folders.is_empty() {
        folders.push(mount.to_owned());
    }
    folders
}

/// What a group leaves: its limit minus its usage, not counting cached files that are inactive.
fn group_bytes_left(group: &Path, [limit, usage, unread]: [&str; 3]) -> Option<u64> {
    let number = |name: &str| read(&group.join(name))?.trim().parse::<u64>().ok();
    // `max`, which is no number, means unlimited; so does version 1's 2⁶³ minus a page.
    let limit = number(limit).filter(|&limit| limit < 1 << 62)?;
    let stat = read(&group.join("memory.stat")).unwrap_or_default();
    let unread = stat.lines().find_map(|line| line.strip_prefix(unread));
    let unread: u64 = unread.and_then(|n| n.trim().parse().ok()).unwrap_or(0);
    let used = number(usage)?.saturating_sub(unread);
    Some(limit.saturating_sub(used))
}

/// The number of a line `Key:   123 kB`, in bytes.
fn kibibytes(text: &str, key: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    let number: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    number.checked_mul(1024)
}

fn read(path: &Path) -> Option<String> {
    std::fs::read_to_string(path).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    const MIB: u64 = 1 << 20;

    /// Files of a system, made for a test.
    fn system(files: &[(&str, &str)]) -> tempfile::TempDir {
        let root = tempfile::tempdir().expect("a folder");
        for (path, text) in files {
            let path = root.path().join(path);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            fs::write(path, text).expect("a file");
        }
        root
    }

    const STATUS: (&str, &str) = (
        "proc/self/status",
        "Name:\traycast\nVmSize:\t  204800 kB\nVmData:\t  102400 kB\n",
    );
    const MEMINFO: (&str, &str) = (
        "proc/meminfo",
        "MemTotal:  4194304 kB\nMemFree:  1024 kB\nMemAvailable:  2097152 kB\n",
    );

    fn available(files: &[(&str, &str)], limits: ProcessLimits) -> Option<(u64, Limit)> {
        let root = system(files);
        let available = AvailableMemory::from_system_files(root.path(), limits)?;
        Some((available.bytes / MIB, available.limit))
    }

    #[test]
    fn the_least_counts() {
        let none = ProcessLimits::default();
        assert_eq!(available(&[], none), None);
        assert_eq!(
            available(&[STATUS, MEMINFO], none),
            Some((2048, Limit::Machine))
        );
        // 200 MiB in use and two threads to be started, of which a quarter is left free.
        let limits = ProcessLimits {
            threads: 2,
            address_space: Some((200 + 2 * 72 + 800) * MIB),
            data: Some(3000 * MIB),
        };
        assert_eq!(
            available(&[STATUS, MEMINFO], limits),
            Some((600, Limit::AddressSpace))
        );
        let limits = ProcessLimits {
            data: Some(150 * MIB),
            ..none
        };
        assert_eq!(
            available(&[STATUS, MEMINFO], limits),
            Some((50, Limit::Data))
        );
        let used_up = ProcessLimits {
            address_space: Some(1),
            ..none
        };
        assert_eq!(
            available(&[STATUS], used_up),
            Some((0, Limit::AddressSpace))
        );
    }

    #[test]
    fn control_groups_of_both_versions_count() {
        let none = ProcessLimits::default();
        let second = [
            MEMINFO,
            ("proc/self/cgroup", "0::/a/b\n"),
            ("sys/fs/cgroup/a/memory.max", "524288000\n"),
            ("sys/fs/cgroup/a/memory.current", "314572800\n"),
            (
                "sys/fs/cgroup/a/memory.stat",
                "anon 5\ninactive_file 104857600\n",
            ),
            ("sys/fs/cgroup/a/b/memory.max", "max\n"),
            ("sys/fs/cgroup/a/b/memory.current", "314572800\n"),
        ];
        assert_eq!(available(&second, none), Some((300, Limit::ControlGroup)));
        let first = [
            MEMINFO,
            (
                "proc/self/cgroup",
                "9:name=systemd:/\n4:cpu,memory:/x\n0::/\n",
            ),
            (
                "sys/fs/cgroup/memory/memory.limit_in_bytes",
                "9223372036854771712\n",
            ),
            ("sys/fs/cgroup/memory/memory.usage_in_bytes", "1\n"),
            (
                "sys/fs/cgroup/memory/x/memory.limit_in_bytes",
                "209715200\n",
            ),
            (
                "sys/fs/cgroup/memory/x/memory.usage_in_bytes",
                "104857600\n",
            ),
            (
                "sys/fs/cgroup/memory/x/memory.stat",
                "inactive_file 7\ntotal_inactive_file 52428800\n",
            ),
        ];
        assert_eq!(available(&first, none), Some((150, Limit::ControlGroup)));
        // In a container: the path does not exist, and the limit is at the mount.
        let inside = [
            MEMINFO,
            ("proc/self/cgroup", "0::/../../host/path\n"),
            ("sys/fs/cgroup/memory.max", "104857600\n"),
            ("sys/fs/cgroup/memory.current", "0\n"),
        ];
        assert_eq!(available(&inside, none), Some((100, Limit::ControlGroup)));
    }

    #[test]
    fn refusals_give_the_figures() {
        let available = AvailableMemory {
            bytes: 3 << 30,
            limit: Limit::ControlGroup,
        };
        assert_eq!(available.check(3 << 30, "a", "b"), Ok(()));
        let refused = available.check(5 << 30, "a picture", "a smaller one would fit");
        assert_eq!(
            refused.expect_err("too large").to_string(),
            "a picture needs 5.0 GiB of memory, and its control group leaves 3.0 GiB: a smaller one would fit"
        );
        let small = AvailableMemory {
            bytes: 10 * MIB,
            ..available
        };
        let refused = small.check(11 * MIB, "a", "b").expect_err("too large");
        assert!(refused.to_string().contains("11 MiB"), "{refused}");
    }

    #[test]
    fn threads_are_refused_where_nothing_else_could_start() {
        let available = |bytes: u64, limit: Limit| AvailableMemory { bytes, limit };
        let refused = available(0, Limit::AddressSpace).check_threads();
        let message = refused.expect_err("no room").to_string();
        assert!(message.contains("(ulimit -v)"), "{message}");
        for started in [
            available(1, Limit::AddressSpace),
            available(0, Limit::Machine),
        ] {
            assert_eq!(started.check_threads(), Ok(()));
        }
    }

    #[test]
    fn mip_levels_are_counted_with_the_tree() {
        let available = AvailableMemory {
            bytes: 100 * MIB,
            limit: Limit::Data,
        };
        let triangles = (50 * MIB / TREE_BYTES) as usize;
        assert_eq!(available.check_scene("a.obj", triangles, 50 * MIB), Ok(()));
        let refusal = |triangles, levels| {
            let refused = available.check_scene("a.obj", triangles, levels);
            refused.expect_err("too much").to_string()
        };
        let both = refusal(triangles, 60 * MIB);
        assert!(
            both.contains("and its textures' mip levels needs 110 MiB"),
            "{both}"
        );
        assert!(both.ends_with("209715 triangles would fit"), "{both}");
        let levels = refusal(12, 101 * MIB);
        assert!(levels.ends_with("bilinear need no mip levels"), "{levels}");
        let tree = refusal(3 * triangles, 0);
        assert!(!tree.contains("mip levels"), "{tree}");
    }

    #[test]
    fn the_largest_that_fits_is_of_the_same_shape() {
        let four_a_pixel = |columns: u32, rows: u32| 4 * u64::from(columns) * u64::from(rows);
        assert_eq!(
            largest((4096, 2048), 4 * 2048 * 1024, four_a_pixel),
            Some((2048, 1024))
        );
        assert_eq!(largest((4096, 2048), 3, four_a_pixel), None);
        assert_eq!(largest((100, 100), 1 << 40, four_a_pixel), Some((100, 100)));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_machine_reports_its_memory() {
        let available = AvailableMemory::now().expect("Linux tells");
        assert!(available.bytes > MIB, "{available:?}");
    }
}
