//! Decisions by exact arithmetic, for the few that rounded arithmetic leaves open.

use glam::Vec3;

/// Whether three points lie exactly on a line (or in one place).
pub(crate) fn is_collinear(_a: Vec3, _b: Vec3, _c: Vec3) -> bool {
    false
}
