//! The memory that this process may still take, and refusals of what needs more.
//!
//! A process that runs out of memory is killed, by the system or by its own allocator, without a word about what was
//! too large. So the memory of a picture is estimated before it is started, and compared with the least of what the
//! process's own limits, its control group and the machine leave.

mod available;
mod huge_pages;

use crate::failure::Failure;
pub use available::{AvailableMemory, Limit};
pub use huge_pages::HugePages;
use raycast_core::formats::{Budget, Limits};
use std::fmt;
use std::path::Path;

impl AvailableMemory {
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

#[cfg(test)]
mod tests {
    use super::*;

    const MIB: u64 = 1 << 20;

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
}
