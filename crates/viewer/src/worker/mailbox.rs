//! A mailbox for the newest request: a new one replaces the waiting one, and cancels the running one, but only after
//! that has something to show. (The window sends no sooner; the last tile may be visible before it is counted here.)

use raycast_core::render::Cancel;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The newest request, and the running one.
#[derive(Debug)]
pub struct Mailbox<T> {
    slot: Mutex<Slot<T>>,
    bell: Condvar,
}

#[derive(Debug)]
struct Slot<T> {
    waiting: Option<T>,
    running: Cancel,
    ripe: bool,
    closed: bool,
}

impl<T> Default for Mailbox<T> {
    fn default() -> Self {
        Self {
            slot: Mutex::new(Slot {
                waiting: None,
                running: Cancel::default(),
                ripe: true,
                closed: false,
            }),
            bell: Condvar::new(),
        }
    }
}

impl<T> Mailbox<T> {
    /// Posts a request. It never waits for the work.
    pub fn post(&self, request: T) {
        let mut slot = self.lock();
        slot.waiting = Some(request);
        if slot.ripe {
            slot.running.cancel();
        }
        drop(slot);
        self.bell.notify_one();
    }

    /// Waits for a request: returns the newest, and its cancel flag. `None` once closed.
    pub fn take(&self) -> Option<(T, Cancel)> {
        let mut slot = self.lock();
        loop {
            if slot.closed {
                return None;
            }
            if let Some(request) = slot.waiting.take() {
                slot.running = Cancel::default();
                slot.ripe = false;
                return Some((request, slot.running.clone()));
            }
            slot = self.bell.wait(slot).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Marks the running request as having something to show: from now on a new one cancels it. Without this a camera
    /// that moves faster than pictures are rendered would never show any.
    pub fn ripen(&self) {
        let mut slot = self.lock();
        slot.ripe = true;
        if slot.waiting.is_some() {
            slot.running.cancel();
        }
    }

    /// Waits for `time`; returns whether nothing was requested meanwhile.
    pub fn is_quiet_for(&self, time: Duration) -> bool {
        let slot = self.lock();
        let goes_on = |slot: &mut Slot<T>| !slot.closed && slot.waiting.is_none();
        let waited = self.bell.wait_timeout_while(slot, time, goes_on);
        let (mut slot, timeout) = waited.unwrap_or_else(PoisonError::into_inner);
        timeout.timed_out() && goes_on(&mut slot)
    }

    /// Cancels everything.
    pub fn close(&self) {
        let mut slot = self.lock();
        slot.closed = true;
        slot.waiting = None;
        slot.running.cancel();
        drop(slot);
        self.bell.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, Slot<T>> {
        // The state is consistent between any two of the steps above: a panic elsewhere leaves it usable.
        self.slot.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn the_newest_request_wins() {
        let mailbox = Mailbox::default();
        for number in 0..5 {
            mailbox.post(number);
        }
        let (request, cancel) = mailbox.take().expect("open");
        assert_eq!(request, 4);
        assert!(!cancel.is_cancelled());
    }

    #[test]
    fn a_request_is_not_ended_before_it_has_something_to_show() {
        let mailbox = Mailbox::default();
        mailbox.post('a');
        let (_, first) = mailbox.take().expect("open");
        mailbox.post('b');
        assert!(!first.is_cancelled());
        mailbox.ripen();
        assert!(first.is_cancelled(), "b waits");
        let (request, second) = mailbox.take().expect("open");
        assert_eq!(request, 'b');
        mailbox.ripen();
        assert!(!second.is_cancelled(), "nothing waits");
        mailbox.post('c');
        assert!(second.is_cancelled());
    }

    #[test]
    fn quiet_ends_with_a_request() {
        let mailbox = Mailbox::default();
        assert!(mailbox.is_quiet_for(Duration::from_millis(1)));
        mailbox.post(());
        assert!(!mailbox.is_quiet_for(Duration::from_secs(60)));
        assert!(mailbox.take().is_some());
        mailbox.close();
        assert!(!mailbox.is_quiet_for(Duration::from_secs(60)));
    }

    #[test]
    fn closing_wakes_who_waits_and_ends_who_runs() {
        let mailbox = Arc::new(Mailbox::default());
        mailbox.post(());
        let (_, cancel) = mailbox.take().expect("open");
        let waiter = {
            let mailbox = Arc::clone(&mailbox);
            std::thread::spawn(move || mailbox.take().is_none())
        };
        mailbox.close();
        assert!(cancel.is_cancelled());
        assert!(waiter.join().expect("no panic"));
    }
}
