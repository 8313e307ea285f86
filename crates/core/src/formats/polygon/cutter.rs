//! Decides how to triangulate one face: as a fan, or by clipping ears.

use super::tree::{Box2, Point, Tree};
use glam::{DVec3, Vec3};
use robust::orient2d;
use std::cmp::Ordering;

/// How to triangulate a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cut {
    /// As a fan.
    Fan,
    /// As the ears that the cutter has found.
    Ears,
    /// As a fan although it is wrong, because the face crosses itself.
    Crossing,
    /// As a fan although it may be wrong, because clipping would take too long.
    Intricate,
}

/// The most steps (tests of boxes, at some nanoseconds each) a corner. Ordinary faces take some 100; a hostile face,
/// each of whose edges lies in the boxes of all others, stops after the time that it takes to load ten triangles a
/// corner.
const STEPS_A_CORNER: usize = 512;

/// The orientation of three points, decided exactly.
///
/// Coordinates are in single precision: no product of their differences overflows or underflows.
fn turn(a: Point, b: Point, c: Point) -> Ordering {
    sign(orient2d(a, b, c))
}

/// By x, then by y: the order of points on a line.
fn order(a: Point, b: Point) -> Ordering {
    let by = |a: f64, b: f64| sign(a - b);
    by(a.x, b.x).then(by(a.y, b.y))
}

/// The sign; both zeros are equal.
fn sign(number: f64) -> Ordering {
    number.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}

#[derive(Debug, Default)]
pub(super) struct Cutter {
    points: Vec<Point>,
    /// The orientation of the face.
    inside: Option<Ordering>,
    tree: Tree,
    next: Vec<u32>,
    previous: Vec<u32>,
    is_clipped: Vec<bool>,
    /// The number of corners that are not clipped.
    left: usize,
    /// Corners to be tested.
    candidates: Vec<u32>,
    /// Corners that may be spikes.
    suspects: Vec<u32>,
    /// Whether a corner is a candidate.
    is_candidate: Vec<bool>,
    /// For each corner, the corners whose ears contained it when they were tested.
    waiting: Vec<Vec<u32>>,
    /// For each corner, the corner that it was last found to wait for.
    waits_for: Vec<u32>,
    /// The triangles, by the numbers of their corners in the face.
    pub(super) ears: Vec<[u32; 3]>,
    steps_left: usize,
}

/// No corner.
const NO_CORNER: u32 = u32::MAX;

/// The limit of steps was reached.
struct OutOfSteps;

impl Cutter {
    /// Decides how to triangulate a face of four or more corners.
    pub(super) fn cut(&mut self, corners: &[Vec3]) -> Cut {
        self.project(corners);
        if self.is_fan() {
            return Cut::Fan;
        }
        self.steps_left = STEPS_A_CORNER * corners.len();
        match self.crosses() {
            Err(OutOfSteps) => return Cut::Intricate,
            Ok(true) => return Cut::Crossing,
            Ok(false) => {}
        }
        match self.clip_ears() {
            Ok(true) => Cut::Ears,
            Ok(false) => Cut::Crossing,
            Err(OutOfSteps) => Cut::Intricate,
        }
    }

    /// Projects along the axis with the largest component of the face's normal. The normal is Newell's, the sum over
    /// the fan (Sutherland, Sproull, Schumacker, "A characterization of ten hidden-surface algorithms", 1974);
    /// rounding may choose between two nearly equal planes. Where the sum cancels to rounding errors, the magnitudes
    /// of its terms decide.
    fn project(&mut self, corners: &[Vec3]) {
        let first = corners[0].as_dvec3();
        let mut normal = DVec3::ZERO;
        let mut parts = DVec3::ZERO;
        for pair in corners.windows(2) {
            let part = (pair[0].as_dvec3() - first).cross(pair[1].as_dvec3() - first);
            normal += part;
            parts += part.abs();
        }
        let normal = normal.abs();
        // The rounding of a sum of products of differences, each within some units in the last place of the sum of
        // magnitudes.
        let rounding = corners.len() as f64 * 2f64.powi(-50);
        let longest = if normal.max_element() <= rounding * parts.max_element() {
            parts
        } else {
            normal
        };
        let dropped = longest.max_position();
        let (x, y) = ((dropped + 1) % 3, (dropped + 2) % 3);
        self.points.clear();
        let flat = |corner: &Vec3| Point {
            x: f64::from(corner[x]),
            y: f64::from(corner[y]),
        };
        self.points.extend(corners.iter().map(flat));
    }

    /// Whether all triangles of the fan have one orientation, and turn around the first corner at most once.
    fn is_fan(&self) -> bool {
        let [apex, first, ref rest @ ..] = self.points[..] else {
            return true;
        };
        let way = turn(apex, first, rest[0]);
        if way == Ordering::Equal {
            return false;
        }
        let mut last = first;
        // Each triangle turns by less than half a circle. So a fan that returns to the near side of the first edge
        // after being beyond it has turned more than once.
        let mut beyond_half = false;
        for &point in rest {
            if turn(apex, last, point) != way {
                return false;
            }
            let side = turn(apex, first, point);
            if beyond_half && side != way.reverse() {
                return false;
            }
            beyond_half |= side != way;
            last = point;
        }
        true
    }

    /// The orientation of a face that does not cross itself: that of its lowest corner which neither coincides with a
    /// neighbour nor is a spike. `None` where all corners that are left lie on a line.
    fn orientation(&self) -> Option<Ordering> {
        let uncut = (0..self.points.len() as u32).filter(|&i| !self.is_clipped[i as usize]);
        let lowest =
            uncut.min_by(|&a, &b| order(self.points[a as usize], self.points[b as usize]))?;
        let [before, here, after] = self.ear_points(lowest);
        let way = turn(before, here, after);
        (way != Ordering::Equal).then_some(way)
    }

    /// Whether two edges cross, each with its ends strictly on both sides of the other.
    fn crosses(&mut self) -> Result<bool, OutOfSteps> {
        let points = &self.points;
        let edge = |index: usize| [points[index], points[(index + 1) % points.len()]];
        self.tree.build(points.len(), |index| {
            let [a, b] = edge(index);
            Some(Box2::around(a).with(b))
        });
        let cross = |a: usize, b: usize| {
            let ([a, b], [c, d]) = (edge(a), edge(b));
            let apart =
                |one: Ordering, other: Ordering| one != Ordering::Equal && one == other.reverse();
            apart(turn(a, b, c), turn(a, b, d)) && apart(turn(c, d, a), turn(c, d, b))
        };
        let tree = &self.tree;
        let mut pairs = vec![(1, 1)];
        while let Some((one, other)) = pairs.pop() {
            self.steps_left = self.steps_left.checked_sub(1).ok_or(OutOfSteps)?;
            if !tree.boxes[one].overlaps(&tree.boxes[other]) {
                continue;
            }
            match (tree.leaf(one), tree.leaf(other)) {
                (Some(a), Some(b)) if a != b && cross(a, b) => return Ok(true),
                (Some(_), Some(_)) => {}
                _ if one == other => {
                    let (left, right) = (2 * one, 2 * one + 1);
                    pairs.extend([(left, left), (right, right), (left, right)]);
                }
                // All leaves are at the same depth.
                _ => {
                    for one in [2 * one, 2 * one + 1] {
                        pairs.extend([(one, 2 * other), (one, 2 * other + 1)]);
                    }
                }
            }
        }
        Ok(false)
    }

    /// Clips ears until nothing is left (Meisters, "Polygons have ears", 1975); returns whether that succeeded. A
    /// corner is an ear where it is convex and its triangle contains no other corner; only reflex corners need to be
    /// tested. A corner that is no ear is tested again when the corner in its triangle is clipped or becomes convex,
    /// or when a neighbour changes.
    fn clip_ears(&mut self) -> Result<bool, OutOfSteps> {
        let count = self.points.len();
        let index = |i: usize| i as u32;
        self.next.clear();
        self.next.extend((0..count).map(|i| index((i + 1) % count)));
        self.previous.clear();
        self.previous
            .extend((0..count).map(|i| index((i + count - 1) % count)));
        self.is_clipped.clear();
        self.is_clipped.resize(count, false);
        self.waiting.iter_mut().for_each(Vec::clear);
        self.waiting
            .resize(count.max(self.waiting.len()), Vec::new());
        self.ears.clear();
        self.tree.build(0, |_| None);
        self.left = count;
        self.inside = None;
        let all = (0..index(count)).rev();
        self.is_candidate.clear();
        self.suspects.clear();
        self.suspects.extend(all.clone());
        self.clip_spikes();
        self.inside = self.orientation();
        if self.inside.is_none() {
            // All corners are on a line: spikes are clipped until three corners are left.
            self.push_last_ear();
            return Ok(true);
        }
        let is_left = |i: u32| !self.is_clipped[i as usize];
        let blocks: Vec<bool> = (0..index(count))
            .map(|i| is_left(i) && !self.is_convex(i))
            .collect();
        self.candidates.clear();
        self.candidates.extend(all.clone());
        self.is_candidate.clear();
        self.is_candidate.resize(count, true);
        self.waits_for.clear();
        self.waits_for.resize(count, NO_CORNER);
        let points = &self.points;
        self.tree
            .build(count, |i| blocks[i].then(|| Box2::around(points[i])));

        // Relaxed rules, when nothing else is left: first ears with a corner on their border, then corners on a
        // straight edge.
        let mut touching = false;
        let mut last_flat = 0;
        while self.left > 3 {
            let Some(corner) = self.candidates.pop() else {
                if touching {
                    let Some(corner) = self.flat_corner(last_flat)? else {
                        return Ok(false);
                    };
                    last_flat = corner;
                    self.clip_ear(corner);
                } else {
                    touching = true;
                    self.candidates.extend(all.clone());
                    self.is_candidate.fill(true);
                }
                continue;
            };
            self.is_candidate[corner as usize] = false;
            if self.is_clipped[corner as usize] || !self.is_convex(corner) {
                continue;
            }
            match self.blocker(corner, touching)? {
                Some(blocker) => {
                    let waits_for = &mut self.waits_for[corner as usize];
                    if *waits_for != blocker {
                        *waits_for = blocker;
                        self.waiting[blocker as usize].push(corner);
                    }
                }
                None => {
                    self.clip_ear(corner);
                    self.clip_spikes();
                }
            }
        }
        self.push_last_ear();
        Ok(true)
    }

    /// Clips corners that coincide with a neighbour, and spikes, where the face turns back on itself: their triangles
    /// have no area, and would make ears of the outside.
    fn clip_spikes(&mut self) {
        while let Some(corner) = self.suspects.pop() {
            if self.left > 3 && !self.is_clipped[corner as usize] && self.is_spike(corner) {
                self.clip_ear(corner);
            }
        }
    }

    fn is_spike(&self, corner: u32) -> bool {
        let [before, here, after] = self.ear_points(corner);
        let (to_before, to_after) = (order(here, before), order(here, after));
        let turns_back = to_before == to_after && turn(before, here, after) == Ordering::Equal;
        turns_back || to_before == Ordering::Equal || to_after == Ordering::Equal
    }

    /// Adds the last triangle.
    fn push_last_ear(&mut self) {
        let last = (0..self.points.len() as u32).find(|&i| !self.is_clipped[i as usize]);
        self.ears.extend(last.map(|corner| self.ear(corner)));
    }

    /// A corner and its neighbours, in the face's order.
    fn ear(&self, corner: u32) -> [u32; 3] {
        let at = corner as usize;
        [self.previous[at], corner, self.next[at]]
    }

    fn ear_points(&self, corner: u32) -> [Point; 3] {
        self.ear(corner).map(|i| self.points[i as usize])
    }

    fn is_convex(&self, corner: u32) -> bool {
        let [a, b, c] = self.ear_points(corner);
        Some(turn(a, b, c)) == self.inside
    }

    /// A corner on a straight edge, searched from this one on.
    fn flat_corner(&mut self, first: u32) -> Result<Option<u32>, OutOfSteps> {
        let count = self.points.len() as u32;
        for corner in (first..count).chain(0..first) {
            self.steps_left = self.steps_left.checked_sub(1).ok_or(OutOfSteps)?;
            let [a, b, c] = self.ear_points(corner);
            if !self.is_clipped[corner as usize] && turn(a, b, c) == Ordering::Equal {
                return Ok(Some(corner));
            }
        }
        Ok(None)
    }

    fn clip_ear(&mut self, corner: u32) {
        let ear = self.ear(corner);
        let [before, _, after] = ear;
        self.ears.push(ear);
        self.next[before as usize] = after;
        self.previous[after as usize] = before;
        self.is_clipped[corner as usize] = true;
        self.left -= 1;
        self.unblock(corner);
        for neighbour in [after, before] {
            self.suspects.push(neighbour);
            if self.is_convex(neighbour) {
                self.unblock(neighbour);
                self.push_candidate(neighbour);
            }
        }
    }

    fn unblock(&mut self, corner: u32) {
        self.tree.remove(corner as usize);
        for waiting in std::mem::take(&mut self.waiting[corner as usize]) {
            // It may wait for another corner by now.
            if self.waits_for[waiting as usize] == corner {
                self.waits_for[waiting as usize] = NO_CORNER;
                self.push_candidate(waiting);
            }
        }
    }

    fn push_candidate(&mut self, corner: u32) {
        if let Some(is_candidate) = self.is_candidate.get_mut(corner as usize)
            && !std::mem::replace(is_candidate, true)
        {
            self.candidates.push(corner);
        }
    }

    /// A corner in an ear's triangle that prevents clipping it; with `touching`, only one strictly inside. A corner
    /// that coincides with one of the ear's does not count: two parts of the face lie side by side there.
    fn blocker(&mut self, corner: u32, touching: bool) -> Result<Option<u32>, OutOfSteps> {
        let [a, b, c] = self.ear_points(corner);
        let inside = self.inside.unwrap_or(Ordering::Greater);
        let around = Box2::around(a).with(b).with(c);
        let tree = &self.tree;
        // A box is beyond an edge if its corner furthest inwards is.
        let beyond = |box2: &Box2, from: Point, to: Point| {
            let inwards = (inside == Ordering::Greater) == (to.y > from.y);
            let rightwards = (inside == Ordering::Greater) == (to.x > from.x);
            let furthest = Point {
                x: if inwards { box2.min.x } else { box2.max.x },
                y: if rightwards { box2.max.y } else { box2.min.y },
            };
            turn(from, to, furthest) == inside.reverse()
        };
        let mut nodes = vec![1];
        while let Some(node) = nodes.pop() {
            self.steps_left = self.steps_left.checked_sub(1).ok_or(OutOfSteps)?;
            let box2 = &tree.boxes[node];
            if tree.counts[node] == 0 || !box2.overlaps(&around) {
                continue;
            }
            let Some(other) = tree.leaf(node) else {
                let outside = beyond(box2, a, b) || beyond(box2, b, c) || beyond(box2, c, a);
                if !outside {
                    nodes.extend([2 * node + 1, 2 * node]);
                }
                continue;
            };
            let point = self.points[other];
            if point == a || point == b || point == c {
                continue;
            }
            let turns = [turn(a, b, point), turn(b, c, point), turn(c, a, point)];
            let blocks = if touching {
                turns.iter().all(|turn| *turn == inside)
            } else {
                turns.iter().all(|turn| *turn != inside.reverse())
            };
            if blocks {
                return Ok(Some(other as u32));
            }
        }
        Ok(None)
    }
}
