//! Making one picture while the one before is written.

use super::Failure;
use std::sync::mpsc::{SyncSender, sync_channel};

/// Writes what `make_all` sends, in order, on a thread of its own. One waits while another is written, so that no more are in
/// memory; where writing fails there is nobody to send to, and its error is returned.
pub(super) fn write_behind<T: Send>(
    write: impl FnMut(T) -> Result<(), Failure> + Send,
    make_all: impl FnOnce(&SyncSender<T>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    std::thread::scope(|scope| {
        let (send, receive) = sync_channel(0);
        let writer = scope.spawn(move || receive.into_iter().try_for_each(write));
        let made = make_all(&send);
        drop(send);
        let written = writer
            .join()
            .unwrap_or_else(|_| Err(Failure::could_not("a frame could not be written")));
        written.and(made)
    })
}
