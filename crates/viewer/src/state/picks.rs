//! The list of picks.

use super::document::Document;
use super::pick::Pinned;

/// The most picks: each is drawn and listed in every frame.
const LIMIT: usize = 1000;

/// Picks in the order of the clicks; one of them is current.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picks {
    list: Vec<Pinned>,
    /// Less than the length of the list, or 0.
    current: usize,
}

impl Picks {
    /// All of them.
    pub fn list(&self) -> &[Pinned] {
        &self.list
    }

    /// The current pick.
    pub fn current(&self) -> Option<&Pinned> {
        self.list.get(self.current)
    }

    /// The current pick's index.
    pub fn current_index(&self) -> usize {
        self.current
    }

    /// Replaces all picks by this one, or by none.
    pub(super) fn set(&mut self, pinned: Option<Pinned>) {
        self.list.clear();
        self.list.extend(pinned);
        self.current = 0;
    }

    /// Adds a pick; `false` where there are too many.
    pub(super) fn add(&mut self, pinned: Pinned) -> bool {
        let has_room = self.list.len() < LIMIT;
        if has_room {
            self.list.push(pinned);
            self.current = self.list.len() - 1;
        }
        has_room
    }

    /// Makes one the current pick.
    pub(super) fn choose(&mut self, index: usize) {
        if index < self.list.len() {
            self.current = index;
        }
    }

    /// Removes one.
    pub(super) fn remove(&mut self, index: usize) {
        if index < self.list.len() {
            self.keep_each(|number, _| number != index);
        }
    }

    /// Updates the picks to the present scene; those whose triangle no longer exists are removed.
    pub(super) fn renew(&mut self, document: &Document) {
        self.keep_each(|_, pinned| match pinned.renewed(document) {
            Some(renewed) => {
                *pinned = renewed;
                true
            }
            None => false,
        });
    }

    /// Renumbers the picks' objects; those without a new index are removed. Returns whether any index changed.
    pub(super) fn renumber(&mut self, number: impl Fn(usize) -> Option<usize>) -> bool {
        let mut differs = false;
        self.keep_each(|_, pinned| {
            let old = pinned.pick.hit.object;
            let new = number(old as usize).and_then(|new| u32::try_from(new).ok());
            differs |= new != Some(old);
            pinned.pick.hit.object = new.unwrap_or(old);
            new.is_some()
        });
        differs
    }

    /// Keeps some picks; the current one stays current, else the one after it, or the last.
    fn keep_each(&mut self, mut keep: impl FnMut(usize, &mut Pinned) -> bool) {
        let (mut number, mut before) = (0, 0);
        let current = self.current;
        self.list.retain_mut(|pinned| {
            let is_kept = keep(number, pinned);
            before += usize::from(is_kept && number < current);
            number += 1;
            is_kept
        });
        self.current = before.min(self.list.len().saturating_sub(1));
    }
}
