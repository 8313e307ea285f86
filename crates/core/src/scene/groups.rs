//! Named groups of a mesh's triangles.

use std::ops::Range;

/// The groups into which a file divides a mesh's triangles: those of an OBJ file's `o` and `g`, the solids of an ASCII
/// STL.
///
/// Each triangle is in one group or in none. A group's triangles need not be neighbours.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Groups {
    names: Vec<String>,
    /// Ascending by first triangle.
    runs: Vec<Run>,
}

/// Neighbouring triangles of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Run {
    /// The first triangle; the next run's is the end.
    pub(crate) first: u32,
    /// The index of the group's name; [`Run::NONE`] for triangles in no group.
    pub(crate) group: u32,
}

impl Run {
    /// The index of no group.
    pub(crate) const NONE: u32 = u32::MAX;
}

impl Groups {
    /// From names and runs; `None` where runs do not ascend within `triangles`, or name no group.
    pub(crate) fn new(names: Vec<String>, runs: Vec<Run>, triangles: usize) -> Option<Self> {
        let is_one = |run: &Run| {
            (run.first as usize) < triangles
                && (run.group == Run::NONE || (run.group as usize) < names.len())
        };
        let ascend = runs.is_sorted_by(|a, b| a.first < b.first);
        (ascend && runs.iter().all(is_one)).then_some(Self { names, runs })
    }

    /// From names, and for each triangle the index of its group's name, if it is in one; `None` where an index is out of
    /// range.
    pub fn of_triangles(
        names: Vec<String>,
        groups: impl IntoIterator<Item = Option<u32>>,
    ) -> Option<Self> {
        let mut runs: Vec<Run> = Vec::new();
        let mut triangles = 0;
        for group in groups {
            let group = group.unwrap_or(Run::NONE);
            if runs.last().map(|run| run.group) != Some(group) {
                runs.push(Run {
                    first: u32::try_from(triangles).ok()?,
                    group,
                });
            }
            triangles += 1;
        }
        Self::new(names, runs, triangles)
    }

    /// The names, each once, in the order of their first triangles in a file.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Whether the file divides nothing.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// The name of a triangle's group; `None` for triangles in no group, and out of range.
    pub fn of(&self, triangle: u32) -> Option<&str> {
        self.name(self.number_of(triangle)?)
    }

    /// The number of a triangle's group: the index of its name.
    pub fn number_of(&self, triangle: u32) -> Option<u32> {
        let above = self.runs.partition_point(|run| run.first <= triangle);
        let run = self.runs.get(above.checked_sub(1)?)?;
        (run.group != Run::NONE).then_some(run.group)
    }

    /// How many of a mesh's `triangles`, dropped ones too, each group has, in the order of [`Groups::names`].
    pub fn sizes(&self, triangles: usize) -> Vec<usize> {
        let mut sizes = vec![0; self.names.len()];
        for (range, group) in self.ranges(triangles) {
            if let Some(size) = sizes.get_mut(group as usize) {
                *size += range.len();
            }
        }
        sizes
    }

    /// Neighbouring triangles of a mesh of so many, with their group's name, from the first group on; `None` for those
    /// in no group.
    pub(crate) fn named_ranges(
        &self,
        triangles: usize,
    ) -> impl Iterator<Item = (Range<usize>, Option<&str>)> {
        self.ranges(triangles)
            .map(|(range, group)| (range, self.name(group)))
    }

    /// As [`Groups::named_ranges`], with the triangles above the first group.
    pub(super) fn all_ranges(
        &self,
        triangles: usize,
    ) -> impl Iterator<Item = (Range<usize>, Option<&str>)> {
        let first = (self.runs.first()).map_or(triangles, |run| run.first as usize);
        std::iter::once((0..first, None)).chain(self.named_ranges(triangles))
    }

    fn ranges(&self, triangles: usize) -> impl Iterator<Item = (Range<usize>, u32)> {
        let ends = self.runs.iter().skip(1).map(|run| run.first as usize);
        let ends = ends.chain([triangles]).map(move |end| end.min(triangles));
        let runs = self.runs.iter().zip(ends);
        runs.map(|(run, end)| (run.first as usize..end, run.group))
    }

    fn name(&self, group: u32) -> Option<&str> {
        self.names.get(group as usize).map(String::as_str)
    }

    pub(crate) fn runs(&self) -> &[Run] {
        &self.runs
    }

    pub(super) fn bytes(&self) -> usize {
        let names = self.names.iter();
        names
            .map(|name| size_of::<String>() + name.len())
            .sum::<usize>()
            + size_of_val(&self.runs[..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(first: u32, group: u32) -> Run {
        Run { first, group }
    }

    #[test]
    fn every_triangle_has_the_group_of_its_run() {
        let names = ["a".to_owned(), "b".to_owned()];
        let runs = vec![run(2, 0), run(5, Run::NONE), run(6, 1), run(7, 0)];
        let groups = Groups::new(names.to_vec(), runs, 10).expect("ascending");
        let of: Vec<_> = (0..10).map(|at| groups.of(at).unwrap_or("-")).collect();
        assert_eq!(of.concat(), "--aaa-baaa");
        assert_eq!(groups.sizes(10), [6, 1]);
        let ranges: Vec<_> = groups.named_ranges(10).collect();
        assert_eq!(
            ranges,
            [
                (2..5, Some("a")),
                (5..6, None),
                (6..7, Some("b")),
                (7..10, Some("a"))
            ]
        );
        assert_eq!(Groups::default().of(0), None);
        let numbers = (0..10).map(|at| groups.number_of(at));
        let again = Groups::of_triangles(names.to_vec(), numbers).expect("the same");
        assert!((0..10).all(|at| again.of(at) == groups.of(at)));
        assert_eq!(Groups::of_triangles(names.to_vec(), [None, Some(2)]), None);
    }

    #[test]
    fn runs_that_no_file_has_are_refused() {
        let new = |runs: Vec<Run>| Groups::new(vec!["a".to_owned()], runs, 3);
        assert!(new(vec![run(0, 0), run(2, Run::NONE)]).is_some());
        assert_eq!(new(vec![run(0, 1)]), None);
        assert_eq!(new(vec![run(3, 0)]), None);
        assert_eq!(new(vec![run(1, 0), run(1, Run::NONE)]), None);
        assert_eq!(new(vec![run(2, 0), run(1, 0)]), None);
    }
}
