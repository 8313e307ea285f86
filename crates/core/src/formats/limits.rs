use super::error::{FormatError, position};
use crate::render::Cancel;
use crate::scene::UpAxis;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

/// Limits on what reading may use, and defaults for what a file leaves open. Sizes that a file claims are checked
/// against them before anything is allocated, so that a small malicious file cannot exhaust memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes allocated at any one time, while reading and by the result: file contents, decoded images, meshes.
    /// Each copy counts.
    pub bytes: u64,
    /// Pixels of one image.
    pub pixels: u64,
    /// Triangles of all objects together; each object counts, even if it shares its mesh with another.
    pub triangles: u64,
    /// Whether references to material libraries and textures may lead to any folder. Otherwise they are confined to
    /// the mesh's own folder and its parent.
    pub follow_anywhere: bool,
    /// The up axis of a mesh file that is read by itself and does not define one. Scene files set it for each
    /// object.
    pub up_axis: UpAxis,
    /// Whether a checkerboard stands in for an image that a scene file names and that cannot be read, with a warning
    /// ([`Texture::is_stand_in`](crate::scene::Texture::is_stand_in)). Otherwise that is an error.
    pub stand_ins: bool,
}

impl Default for Limits {
    /// 4 GiB, 2²⁸ pixels (16384 × 16384), 2²⁷ triangles; references lead only to the mesh's folder and its parent; nothing
    /// stands in for images.
    fn default() -> Self {
        Self {
            bytes: 4 << 30,
            pixels: 1 << 28,
            triangles: 1 << 27,
            follow_anywhere: false,
            up_axis: UpAxis::Y,
            stand_ins: false,
        }
    }
}

/// A bound on additional memory, and a name for what imposes it, for the error message.
#[derive(Clone, Debug)]
struct Memory {
    bytes: u64,
    whose: String,
}

/// [`Limits`] and the amounts used so far. All files of a scene share one budget.
#[derive(Debug, Default)]
pub struct Budget {
    limits: Limits,
    memory: Option<Memory>,
    bytes: AtomicU64,
    triangles: AtomicU64,
    cancel: Cancel,
}

impl Budget {
    /// A budget with nothing used.
    pub fn new(limits: Limits) -> Self {
        Self {
            limits: Limits {
                // Triangle indices are 32 bits wide.
                triangles: limits.triangles.min(u32::MAX.into()),
                ..limits
            },
            ..Self::default()
        }
    }

    /// The same budget, with which reading ends in [`FormatError::Cancelled`] soon after `cancel` is set. It is
    /// checked whenever memory is counted: within some tenths of a second in files of millions of triangles.
    #[must_use]
    pub fn cancelled_by(self, cancel: Cancel) -> Self {
        Self { cancel, ..self }
    }

    /// The same budget, with which reading ends in [`FormatError::NoMemory`] when it would allocate more than
    /// `bytes`. This is the memory still available beside what the process uses already; `whose` names what sets
    /// the bound (a process limit, the machine).
    #[must_use]
    pub fn within_memory(self, bytes: u64, whose: impl Into<String>) -> Self {
        let whose = whose.into();
        Self {
            memory: Some(Memory { bytes, whose }),
            ..self
        }
    }

    /// Returns an error if reading `file` was cancelled.
    ///
    /// # Errors
    /// The reading was cancelled.
    pub(super) fn check_cancelled(&self, file: &Path) -> Result<(), FormatError> {
        check_cancelled(&self.cancel, file)
    }

    /// The limits.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Reserves bytes for `what` of a file until the share is dropped.
    pub(super) fn share(
        &self,
        file: &Path,
        what: &str,
        bytes: u64,
    ) -> Result<Share<'_>, FormatError> {
        let mut share = Share {
            budget: self,
            bytes: 0,
        };
        share.grow(file, what, bytes)?;
        Ok(share)
    }

    /// Adds an object's triangles to the count.
    pub(super) fn add_triangles(&self, file: &Path, count: u64) -> Result<(), FormatError> {
        let sum = self.triangles().saturating_add(count);
        if sum > self.limits.triangles {
            return Err(too_many_triangles(file, sum, self.limits.triangles));
        }
        self.triangles.store(sum, Ordering::Relaxed);
        Ok(())
    }

    /// The remaining budget, for threads that read one file together.
    pub(super) fn allowance(&self) -> Allowance {
        Allowance {
            limits: self.limits,
            memory: self.memory.clone(),
            bytes: self.bytes.load(Ordering::Relaxed),
            triangles: self.triangles(),
            held: AtomicU64::new(0),
            cancel: self.cancel.clone(),
        }
    }

    /// The number of triangles still allowed.
    pub(super) fn triangles_left(&self) -> u64 {
        self.limits.triangles - self.triangles()
    }

    fn triangles(&self) -> u64 {
        self.triangles.load(Ordering::Relaxed)
    }

    /// Returns bytes of data that was kept and is dropped after all.
    pub(super) fn release(&self, bytes: u64) {
        self.bytes.fetch_sub(bytes, Ordering::Relaxed);
    }

    /// The number of bytes still allowed.
    pub(super) fn bytes_left(&self) -> u64 {
        let memory = self.memory.as_ref().map_or(u64::MAX, |memory| memory.bytes);
        memory
            .min(self.limits.bytes)
            .saturating_sub(self.bytes.load(Ordering::Relaxed))
    }

    /// Checks an image's size against the limit.
    pub(super) fn check_pixels(
        &self,
        file: &Path,
        width: u32,
        height: u32,
    ) -> Result<(), FormatError> {
        let pixels = u64::from(width) * u64::from(height);
        if pixels > self.limits.pixels {
            let what = format!("an image of {width}x{height} has {pixels} pixels");
            return Err(FormatError::too_much(
                file,
                what,
                "pixels",
                self.limits.pixels,
            ));
        }
        Ok(())
    }
}

/// The remainder of a [`Budget`], shared by threads that read one file together. It does not change the budget
/// itself.
#[derive(Debug)]
pub(super) struct Allowance {
    limits: Limits,
    memory: Option<Memory>,
    /// Bytes used of the budget when this allowance was made.
    bytes: u64,
    triangles: u64,
    /// Bytes held by all threads together.
    held: AtomicU64,
    cancel: Cancel,
}

impl Allowance {
    /// The number of triangles still allowed.
    pub(super) fn triangles(&self) -> u64 {
        self.limits.triangles - self.triangles
    }

    /// Counts `more` bytes that are held for `what` of a file.
    ///
    /// # Errors
    /// All threads together exceed the limit; reading was cancelled.
    pub(super) fn hold(&self, file: &Path, what: &str, more: u64) -> Result<(), FormatError> {
        check_cancelled(&self.cancel, file)?;
        let held = self
            .held
            .fetch_add(more, Ordering::Relaxed)
            .saturating_add(more);
        let sum = self.bytes.saturating_add(held);
        check_bytes((&self.limits, &self.memory), file, what, (held, sum))
    }

    /// The error for a file with `count` triangles, which exceed the limit.
    pub(super) fn too_many_triangles(&self, file: &Path, count: u64) -> FormatError {
        let sum = self.triangles.saturating_add(count);
        too_many_triangles(file, sum, self.limits.triangles)
    }
}

fn check_cancelled(cancel: &Cancel, file: &Path) -> Result<(), FormatError> {
    if cancel.is_cancelled() {
        return Err(FormatError::cancelled(file));
    }
    Ok(())
}

fn too_many_triangles(file: &Path, count: u64, most: u64) -> FormatError {
    let what = format!("the scene has {count} triangles or more");
    FormatError::too_much(file, what, "triangles", most)
}

/// Checks the `sum` of all bytes held against the limits. `bytes`, the part held for `what` of a file, only goes
/// into the error message.
fn check_bytes(
    (limits, memory): (&Limits, &Option<Memory>),
    file: &Path,
    what: &str,
    (bytes, sum): (u64, u64),
) -> Result<(), FormatError> {
    let message = || format!("{what} takes {bytes} bytes, {sum} with all else that is held");
    if sum > limits.bytes {
        return Err(FormatError::too_much(
            file,
            message(),
            "bytes",
            limits.bytes,
        ));
    }
    match memory {
        Some(Memory { bytes, whose }) if sum > *bytes => Err(FormatError::NoMemory {
            position: position(file, None),
            what: message(),
            whose: whose.clone(),
            leaves: *bytes,
        }),
        _ => Ok(()),
    }
}

/// Bytes reserved of a [`Budget`]; dropping the share releases them.
#[derive(Debug)]
pub(super) struct Share<'b> {
    budget: &'b Budget,
    bytes: u64,
}

impl Share<'_> {
    /// Grows the share to `bytes`; a share that is as large already stays.
    ///
    /// # Errors
    /// The budget is exhausted; reading was cancelled.
    pub(super) fn grow(&mut self, file: &Path, what: &str, bytes: u64) -> Result<(), FormatError> {
        self.budget.check_cancelled(file)?;
        let more = bytes.saturating_sub(self.bytes);
        let Budget { limits, memory, .. } = self.budget;
        let counted = &self.budget.bytes;
        let mut checked = Ok(());
        let _ = counted.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |held| {
            let sum = held.saturating_add(more);
            checked = check_bytes((limits, memory), file, what, (bytes, sum));
            checked.is_ok().then_some(sum)
        });
        checked?;
        self.bytes += more;
        Ok(())
    }

    /// As [`Budget::check_cancelled`].
    pub(super) fn check_cancelled(&self, file: &Path) -> Result<(), FormatError> {
        self.budget.check_cancelled(file)
    }

    /// Ends the share, but leaves `bytes` of it reserved for data that outlives reading.
    pub(super) fn keep(mut self, bytes: u64) {
        self.bytes = self.bytes.saturating_sub(bytes);
    }
}

impl Drop for Share<'_> {
    fn drop(&mut self) {
        self.budget.release(self.bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_counted_and_given_back() {
        let budget = Budget::new(Limits {
            bytes: 100,
            ..Limits::default()
        });
        let file = Path::new("a.png");
        let first = budget.share(file, "it", 60).expect("there is room");
        let error = budget.share(file, "the image", 50).expect_err("no room");
        assert_eq!(
            error.to_string(),
            "a.png: the image takes 50 bytes, 110 with all else that is held; at most 100 are \
             allowed (limit `bytes`)"
        );
        first.keep(20);
        assert_eq!(budget.bytes_left(), 80);
        let mut second = budget.share(file, "it", 50).expect("there is room");
        assert!(second.grow(file, "it", 81).is_err());
        assert!(second.grow(file, "it", 80).is_ok());
        drop(second);
        assert_eq!(budget.bytes_left(), 80);
        assert!(budget.share(file, "it", u64::MAX).is_err());
    }

    #[test]
    fn reading_beyond_the_available_memory_is_an_error() {
        let budget = Budget::default().within_memory(100, "the machine");
        let file = Path::new("a.png");
        assert_eq!(budget.bytes_left(), 100);
        let share = budget.share(file, "it", 60).expect("there is room");
        for refused in [
            budget.share(file, "it", 50).map(drop),
            budget.allowance().hold(file, "it", 50),
        ] {
            assert_eq!(
                refused.expect_err("no room").to_string(),
                "a.png: it takes 50 bytes, 110 with all else that is held; the machine leaves 100"
            );
        }
        drop(share);
        assert!(budget.share(file, "it", 100).is_ok());
    }

    #[test]
    fn a_cancelled_reading_stops_counting() {
        let cancel = Cancel::default();
        let budget = Budget::default().cancelled_by(cancel.clone());
        let allowance = budget.allowance();
        let file = Path::new("a");
        let mut share = budget.share(file, "it", 1).expect("it goes on");
        assert!(allowance.hold(file, "it", 1).is_ok());
        cancel.cancel();
        let message = share.grow(file, "it", 2).expect_err("it was cancelled");
        assert_eq!(message.to_string(), "a: reading it was cancelled");
        assert!(allowance.hold(file, "it", 1).is_err());
        assert!(budget.check_cancelled(file).is_err());
    }

    #[test]
    fn triangles_and_pixels_have_limits() {
        let budget = Budget::new(Limits {
            pixels: 6,
            triangles: 10,
            ..Limits::default()
        });
        let file = Path::new("a");
        assert!(budget.check_pixels(file, 2, 3).is_ok());
        assert!(budget.check_pixels(file, 7, 1).is_err());
        assert!(budget.check_pixels(file, u32::MAX, u32::MAX).is_err());
        assert!(budget.add_triangles(file, 6).is_ok());
        assert!(budget.add_triangles(file, 5).is_err());
        assert!(budget.add_triangles(file, 4).is_ok());
        assert_eq!(budget.triangles_left(), 0);
    }
}
