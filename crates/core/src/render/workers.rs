//! Distributing work over threads.

use super::view::Cancel;
use crate::camera::{ImagePlane, Rect};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Calls `work` with every index below `count`; workers take indices in ascending order, until `cancel`. Each worker
/// has its own buffers. Returns whether all indices were done.
pub(super) fn in_parallel<B>(
    count: usize,
    cancel: &Cancel,
    buffers: impl Fn() -> B + Sync,
    work: impl Fn(&mut B, usize) + Sync,
) -> bool {
    let next = AtomicUsize::new(0);
    let done = AtomicUsize::new(0);
    rayon::scope(|scope| {
        for _ in 0..rayon::current_num_threads() {
            scope.spawn(|_| {
                let mut buffers = buffers();
                while !cancel.is_cancelled() {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    if index >= count {
                        break;
                    }
                    work(&mut buffers, index);
                    done.fetch_add(1, Ordering::Relaxed);
                }
            });
        }
    });
    done.into_inner() == count
}

/// A picture's tiles, sorted by the distance of their middles from the picture's middle: the order of rendering.
pub fn center_first(tiles: &[Rect], plane: ImagePlane) -> Vec<Rect> {
    let mut order = tiles.to_vec();
    // Twice the distance, in integers.
    order.sort_by_key(|tile| {
        let x = i64::from(2 * tile.x + tile.width) - i64::from(plane.columns);
        let y = i64::from(2 * tile.y + tile.height) - i64::from(plane.rows);
        x * x + y * y
    });
    order
}
