//! The memory that is left, by the process's own limits, its control group and the machine.

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

    #[cfg(target_os = "linux")]
    #[test]
    fn this_machine_reports_its_memory() {
        let available = AvailableMemory::now().expect("Linux tells");
        assert!(available.bytes > MIB, "{available:?}");
    }
}
