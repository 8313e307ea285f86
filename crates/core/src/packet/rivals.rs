//! The rivals of undecided rays: the triangles of which one is the ray's closest hit, if anything is. A single ray
//! tests these alone, and does not traverse the tree.
//!
//! A triangle that is surely further than one that the ray surely hits is no rival. So the nearest sure hit of each
//! undecided ray is known: without it every later triangle would be a rival of a ray once it is undecided, and thousands
//! are where triangles of one plane overlap. A nearer one takes its place among the rivals: else a ray whose hits are
//! found from far to near would have all of them as rivals.

use super::params::SIDE;
use crate::hit::MISS;

/// The most rivals that a packet records: 128 a ray. With more, undecided rays would test as many triangles as
/// traversing the tree does; with fewer, more of them traverse it.
const MOST: usize = 1 << 17;

/// The rivals of a packet's rays.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rivals {
    /// Of all rays, in the order in which they were found.
    found: Vec<Rival>,
    /// Empty before the first undecided ray; entries of rays that are not undecided are meaningless.
    rays: Vec<OfRay>,
    overflowed: bool,
}

#[derive(Clone, Copy, Debug)]
struct Rival {
    primitive: u32,
    /// Where the ray's next one is; [`MISS`] after the last.
    next: u32,
}

/// The list of an undecided ray.
#[derive(Clone, Copy, Debug)]
struct OfRay {
    /// Where the first and the last rival are; [`MISS`] without any.
    first: u32,
    last: u32,
    /// A rival that the ray surely hits, or [`MISS`], and where it is.
    sure_hit: u32,
    sure_hit_at: u32,
}

impl OfRay {
    const NONE: Self = Self {
        first: MISS,
        last: MISS,
        sure_hit: MISS,
        sure_hit_at: MISS,
    };
}

impl Rivals {
    pub(super) fn clear(&mut self) {
        self.found.clear();
        self.overflowed = false;
    }

    /// Records that a triangle may be an undecided ray's closest hit.
    pub(super) fn push(&mut self, ray: usize, primitive: u32) {
        self.overflowed |= self.found.len() == MOST;
        if self.overflowed {
            return;
        }
        let next = self.found.len() as u32;
        let of_ray = &mut self.rays[ray];
        match self.found.get_mut(of_ray.last as usize) {
            Some(last) if last.primitive == primitive => return,
            Some(last) => last.next = next,
            None => of_ray.first = next,
        }
        of_ray.last = next;
        self.found.push(Rival {
            primitive,
            next: MISS,
        });
    }

    /// Begins the list of a ray that was decided until now, with the closest hit that it had, if any.
    pub(super) fn begin(&mut self, ray: usize, before: Option<u32>) {
        if self.rays.is_empty() {
            self.rays.resize(SIDE * SIDE, OfRay::NONE);
        }
        self.rays[ray] = OfRay::NONE;
        if let Some(before) = before {
            self.push_sure_hit(ray, before);
        }
    }

    /// Records a sure hit of an undecided ray that is surely nearer than the one that was known, if any: that is no rival
    /// any more.
    pub(super) fn push_sure_hit(&mut self, ray: usize, primitive: u32) {
        let known = self.rays[ray].sure_hit_at as usize;
        match self.found.get_mut(known) {
            Some(known) => known.primitive = primitive,
            None => self.push(ray, primitive),
        }
        let of_ray = &mut self.rays[ray];
        if of_ray.sure_hit_at == MISS {
            of_ray.sure_hit_at = of_ray.last;
        }
        of_ray.sure_hit = primitive;
    }

    /// The sure hit of an undecided ray, if one is known.
    pub(super) fn sure_hit(&self, ray: usize) -> Option<u32> {
        let sure_hit = self.rays.get(ray).map(|of_ray| of_ray.sure_hit);
        sure_hit.filter(|&primitive| primitive != MISS)
    }

    /// Records that any triangle may be any ray's closest hit.
    pub(super) fn forget(&mut self) {
        self.overflowed = true;
    }

    /// An undecided ray's rivals, in the order in which they were found; `None` where too many were recorded.
    pub(super) fn of(&self, ray: usize) -> Option<impl Iterator<Item = u32>> {
        if self.overflowed {
            return None;
        }
        let rival = |at: u32| self.found.get(at as usize);
        let first = self.rays.get(ray).and_then(|of_ray| rival(of_ray.first));
        let all = std::iter::successors(first, move |last| rival(last.next));
        Some(all.map(|rival| rival.primitive))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(rivals: &Rivals, ray: usize) -> Option<Vec<u32>> {
        rivals.of(ray).map(Iterator::collect)
    }

    #[test]
    fn a_ray_becomes_undecided_with_the_hit_that_it_had() {
        let mut rivals = Rivals::default();
        assert_eq!((rivals.sure_hit(3), of(&rivals, 3)), (None, Some(vec![])));
        rivals.begin(3, Some(8));
        rivals.begin(4, None);
        rivals.push(4, 9);
        assert_eq!((rivals.sure_hit(3), rivals.sure_hit(4)), (Some(8), None));
        assert_eq!(of(&rivals, 3), Some(vec![8]));
        rivals.push_sure_hit(4, 7);
        assert_eq!(rivals.sure_hit(4), Some(7));
        assert_eq!(of(&rivals, 4), Some(vec![9, 7]));
        rivals.begin(4, None);
        assert_eq!((rivals.sure_hit(4), of(&rivals, 4)), (None, Some(vec![])));
    }

    #[test]
    fn a_nearer_sure_hit_takes_the_place_of_the_one_before() {
        let mut rivals = Rivals::default();
        rivals.begin(3, Some(8));
        rivals.push(3, 9);
        rivals.begin(4, None);
        rivals.push(4, 9);
        for primitive in [1, 2] {
            rivals.push_sure_hit(3, primitive);
            rivals.push_sure_hit(4, primitive);
            rivals.push(3, 7);
            assert_eq!(rivals.sure_hit(3), Some(primitive));
            assert_eq!(of(&rivals, 3), Some(vec![primitive, 9, 7]));
            assert_eq!(of(&rivals, 4), Some(vec![9, primitive]));
        }
        rivals.begin(4, None);
        rivals.push(4, 5);
        rivals.push_sure_hit(4, 5);
        assert_eq!(of(&rivals, 4), Some(vec![5]));
    }

    /// The rays' lists lie among one another.
    #[test]
    fn rivals_are_those_of_their_ray_in_the_order_in_which_they_were_found() {
        let mut rivals = Rivals::default();
        for _ in 0..2 {
            for (ray, before) in [(7, None), (2, Some(5)), (0, None)] {
                rivals.begin(ray, before);
            }
            for (ray, primitive) in [(7, 3), (7, 3), (2, 9), (7, 1), (2, 9), (0, 4), (7, 6)] {
                rivals.push(ray, primitive);
            }
            assert_eq!(of(&rivals, 7), Some(vec![3, 1, 6]));
            assert_eq!(of(&rivals, 2), Some(vec![5, 9]));
            assert_eq!(of(&rivals, 0), Some(vec![4]));
            rivals.clear();
        }
        rivals.begin(1, None);
        for primitive in 0..=MOST as u32 {
            assert!(rivals.of(1).is_some());
            rivals.push(1, primitive);
        }
        assert_eq!((of(&rivals, 1), of(&rivals, 2)), (None, None));
        rivals.clear();
        rivals.begin(2, Some(3));
        assert_eq!(of(&rivals, 2), Some(vec![3]));
    }
}
