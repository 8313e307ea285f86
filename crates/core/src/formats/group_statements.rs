//! Groups of triangles, from the statements between them.

use crate::quote;
use crate::scene::{Groups, Run};
use std::collections::BTreeMap;

/// What a file says, so far, about the groups of its triangles.
#[derive(Debug, Default)]
pub(super) struct GroupStatements {
    names: Vec<String>,
    numbers: BTreeMap<String, u32>,
    runs: Vec<Run>,
    /// The name after the last statement, until a triangle follows. A group without triangles is none.
    next: Option<String>,
    bytes: usize,
}

impl GroupStatements {
    /// The triangles that follow are in this group; in none where its name is empty. Names are displayed: a name longer
    /// than messages quote is cut, and control characters are escaped.
    pub(super) fn begin(&mut self, name: &str) {
        self.next = Some(quote::shorten(name));
    }

    /// There is a triangle, the first after others.
    #[inline]
    pub(super) fn add_triangle(&mut self, number: usize) {
        if let Some(name) = self.next.take() {
            self.add_run(number as u32, name);
        }
    }

    fn add_run(&mut self, first: u32, name: String) {
        let group = match self.numbers.get(&name) {
            _ if name.is_empty() => Run::NONE,
            Some(&number) => number,
            None => {
                let number = self.names.len() as u32;
                // Twice in each list, and an entry of the table.
                self.bytes += 2 * (name.len() + 3 * size_of::<String>());
                self.names.push(name.clone());
                self.numbers.insert(name, number);
                number
            }
        };
        // In a piece of a file, a first run without a name ends the group of the lines above.
        if self.runs.last().map(|run| run.group) != Some(group) {
            self.runs.push(Run { first, group });
        }
    }

    /// Appends those of the piece of the file that follows: of so many triangles, the first of which is `first`.
    pub(super) fn append(&mut self, piece: Self, first: usize, triangles: usize) {
        if triangles > 0 && piece.runs.first().is_none_or(|run| run.first > 0) {
            self.add_triangle(first);
        }
        for run in &piece.runs {
            let name = piece.names.get(run.group as usize);
            self.next = Some(name.cloned().unwrap_or_default());
            self.add_triangle(first + run.first as usize);
        }
        if piece.next.is_some() {
            self.next = piece.next;
        }
    }

    /// A bound of the bytes that names and runs occupy.
    pub(super) fn bytes(&self) -> usize {
        self.bytes + self.runs.len() * size_of::<Run>()
    }

    /// The groups of a mesh of so many triangles.
    pub(super) fn groups(self, triangles: usize) -> Groups {
        match self.names.is_empty() {
            true => Groups::default(),
            false => Groups::new(self.names, self.runs, triangles).unwrap_or_default(),
        }
    }
}
