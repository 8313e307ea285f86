//! Huge pages for large blocks of memory.
//!
//! Memory is mapped in pages of 4 KB, and the system is asked for each when it is first written: for meshes of millions
//! of triangles that takes a sixth of the time from a file to its first picture. Linux maps pages of 2 MB instead where
//! a program asks for them.

#![allow(
    unsafe_code,
    reason = "allocators are unsafe to implement; this one forwards to the system's"
)]

use std::alloc::{GlobalAlloc, Layout, System};

/// The fewest bytes of a block in huge pages. With 2 MB, the buffers of a picture of 1920 × 1080 have them, and frames
/// took 1 to 3 % longer. With more than 16 MB, fewer of a mesh's arrays have them.
const LEAST: usize = 16 << 20;

/// The system's allocator, with huge pages for large blocks where the system has them.
pub struct HugePages;

// SAFETY: every call is forwarded to the system's allocator, which keeps the contract; advice changes neither the
// address nor the contents of a block.
unsafe impl GlobalAlloc for HugePages {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as the caller promises.
        let block = unsafe { System.alloc(layout) };
        advise(block, layout.size());
        block
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as the caller promises.
        let block = unsafe { System.alloc_zeroed(layout) };
        advise(block, layout.size());
        block
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as the caller promises.
        let block = unsafe { System.realloc(block, layout, size) };
        advise(block, size);
        block
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(block, layout) };
    }
}

/// Asks for huge pages in a block of this size, or null. A system that has none keeps its small ones.
#[inline]
fn advise(block: *mut u8, size: usize) {
    if size >= LEAST && !block.is_null() {
        #[cfg(target_os = "linux")]
        {
            use rustix::mm::{Advice, madvise};
            /// A multiple of the page size of every processor.
            const PAGE: usize = 64 << 10;
            let before = block.align_offset(PAGE);
            let pages = (size - before) / PAGE * PAGE;
            // SAFETY: the pages lie inside the block, and the advice changes no contents.
            let _ = unsafe { madvise(block.add(before).cast(), pages, Advice::LinuxHugepage) };
        }
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::fs;

    /// What the system says of the memory around an address.
    fn flags_at(address: usize) -> Option<String> {
        let maps = fs::read_to_string("/proc/self/smaps").ok()?;
        let mut is_inside = false;
        for line in maps.lines() {
            let range = line.split(' ').next().and_then(|r| r.split_once('-'));
            let number = |text| usize::from_str_radix(text, 16);
            if let Some((Ok(start), Ok(end))) = range.map(|(a, b)| (number(a), number(b))) {
                is_inside = (start..end).contains(&address);
            } else if is_inside && let Some(flags) = line.strip_prefix("VmFlags:") {
                return Some(flags.to_owned());
            }
        }
        None
    }

    #[test]
    fn large_blocks_alone_have_huge_pages_and_keep_their_contents() {
        let layout = |size| Layout::from_size_align(size, 8).expect("a good layout");
        let is_huge = |block: *mut u8, size: usize| {
            let flags = flags_at(block as usize + size / 2).unwrap_or_default();
            flags.split(' ').any(|flag| flag == "hg")
        };
        // A system without huge pages refuses the advice; one without /proc does not say whether it took it.
        let has_any = fs::exists("/sys/kernel/mm/transparent_hugepage").is_ok_and(|has| has)
            && flags_at((&raw const layout).addr()).is_some();
        let (small, large) = (LEAST / 2, LEAST + 12345);
        // SAFETY: blocks are used within their size, and freed once with the layout that they have.
        unsafe {
            let block = HugePages.alloc(layout(small));
            assert!(!block.is_null() && !is_huge(block, small));
            block.write(17);
            block.add(small - 1).write(18);
            let block = HugePages.realloc(block, layout(small), large);
            assert_eq!((block.read(), block.add(small - 1).read()), (17, 18));
            assert_eq!(is_huge(block, large), has_any);
            HugePages.dealloc(block, layout(large));

            let block = HugePages.alloc_zeroed(layout(large));
            assert_eq!(is_huge(block, large), has_any);
            assert!((0..large).all(|at| block.add(at).read() == 0));
            HugePages.dealloc(block, layout(large));
        }
    }
}
