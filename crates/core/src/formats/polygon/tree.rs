//! A bounding box tree along a face.

use robust::Coord;

/// A corner, projected to a coordinate plane.
pub(super) type Point = Coord<f64>;

/// An axis-aligned rectangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Box2 {
    pub(super) min: Point,
    pub(super) max: Point,
}

impl Box2 {
    const EMPTY: Self = Self {
        min: Point {
            x: f64::INFINITY,
            y: f64::INFINITY,
        },
        max: Point {
            x: f64::NEG_INFINITY,
            y: f64::NEG_INFINITY,
        },
    };

    pub(super) fn around(point: Point) -> Self {
        Self {
            min: point,
            max: point,
        }
    }

    pub(super) fn with(self, point: Point) -> Self {
        self.union(Self::around(point))
    }

    pub(super) fn union(self, other: Self) -> Self {
        Self {
            min: Point {
                x: self.min.x.min(other.min.x),
                y: self.min.y.min(other.min.y),
            },
            max: Point {
                x: self.max.x.max(other.max.x),
                y: self.max.y.max(other.max.y),
            },
        }
    }

    pub(super) fn overlaps(&self, other: &Self) -> bool {
        self.min.x <= other.max.x
            && other.min.x <= self.max.x
            && self.min.y <= other.max.y
            && other.min.y <= self.max.y
    }
}

/// Boxes around runs of consecutive items along a face, halved down to single items: pieces of a curve are close
/// together (Ballard, "Strip trees: a hierarchical representation for curves", 1981). Node `n` has the children `2n`
/// and `2n + 1`; 1 is the root.
#[derive(Debug, Default)]
pub(super) struct Tree {
    pub(super) boxes: Vec<Box2>,
    /// The number of items below each node.
    pub(super) counts: Vec<u32>,
    first_leaf: usize,
}

impl Tree {
    pub(super) fn build(&mut self, count: usize, item: impl Fn(usize) -> Option<Box2>) {
        self.first_leaf = count.next_power_of_two();
        self.boxes.clear();
        self.boxes.resize(2 * self.first_leaf, Box2::EMPTY);
        self.counts.clear();
        self.counts.resize(2 * self.first_leaf, 0);
        for index in 0..count {
            if let Some(box2) = item(index) {
                self.boxes[self.first_leaf + index] = box2;
                self.counts[self.first_leaf + index] = 1;
            }
        }
        for node in (1..self.first_leaf).rev() {
            self.boxes[node] = self.boxes[2 * node].union(self.boxes[2 * node + 1]);
            self.counts[node] = self.counts[2 * node] + self.counts[2 * node + 1];
        }
    }

    /// The item of a leaf; `None` for an inner node.
    pub(super) fn leaf(&self, node: usize) -> Option<usize> {
        node.checked_sub(self.first_leaf)
    }

    /// Removes an item, if it is present.
    pub(super) fn remove(&mut self, index: usize) {
        let mut node = self.first_leaf + index;
        if self.counts.get(node).is_none_or(|count| *count == 0) {
            return;
        }
        while node > 0 {
            self.counts[node] -= 1;
            node /= 2;
        }
    }
}
