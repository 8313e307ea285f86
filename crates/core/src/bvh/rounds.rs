//! Whether clustering would take many rounds, and so long: judged by clustering samples.

use super::tree::Box32;
use super::treelet::Treelets;
use obvhs::aabb::Aabb;

/// The fewest boxes that are judged. Fewer take 50 ms at the worst.
const FEWEST: usize = 1 << 12;

/// The fewest boxes of a sample, and how many boxes one of a larger sample stands for: judging takes less
/// than a hundredth of what clustering does.
const FEWEST_SAMPLED: usize = 1 << 10;
const BOXES_A_SAMPLE: usize = 64;

/// The most nearest-neighbour searches for each box of a sample. Meshes need 3 to 4, as a round leaves some seven in ten
/// clusters; with fewer, meshes would be built by halving.
const SAMPLE_SEARCHES: usize = 8;

/// The most nearest-neighbour searches for each box of the whole, on average. At this clustering takes fifty times as
/// long as usual. With more, hostile meshes take longer to build; with fewer, more meshes are built by median splits.
const MOST_SEARCHES: usize = 200;

/// The fewest runs of neighbours that are judged, and the fewest and most boxes of one. Chains shorter than a run are not
/// seen, and take a round for each of few boxes; longer runs take longer to judge.
const FEWEST_RUNS: usize = 8;
const RUN: [usize; 2] = [1 << 7, 1 << 10];

/// The most nearest-neighbour searches for each box of a run, at least, and as a share of its boxes. Meshes' runs need 3
/// to 5, long quads around a cylinder 11; where one pair is joined a round it is a third of the boxes, and a ninth where
/// only some areas are equal. With fewer, meshes are built by halving.
const RUN_SEARCHES: usize = 16;
const BOXES_A_RUN_SEARCH: usize = 16;

/// Rounds that search the nearest cluster among direct neighbours alone.
pub(super) const SHORT_ROUNDS: usize = 2;

/// How far other rounds search: obvhs's `PlocSearchDistance::Low`.
const DISTANCE: usize = 6;

/// Whether clusters would be joined a few at a time, in rounds that each search for all: the time is then quadratic in
/// the number of boxes. It is so where each is nearest to one that is nearer to another, as with the triangles of a
/// wide fan, each of which has a larger box than the one before; and where single precision gives many neighbours equal
/// areas, as with layers closer than it tells apart.
///
/// The boxes are in the order of a Morton curve: neighbours on it are close in space.
pub(super) fn are_many(boxes: &[Aabb]) -> bool {
    boxes.len() >= FEWEST && (are_many_among_all(boxes) || are_many_among_neighbors(boxes))
}

/// Whether a sample of boxes that lie far apart takes many rounds: the order of all is what makes them many.
fn are_many_among_all(boxes: &[Aabb]) -> bool {
    let sampled = (boxes.len() / BOXES_A_SAMPLE).max(FEWEST_SAMPLED);
    let stride = boxes.len() / sampled;
    // One box of every `stride`, at a scattered position: even steps through a regular grid would leave lines of equal
    // boxes, all equally near to one another.
    let elsewhere =
        |index: usize| ((index as u32).wrapping_mul(0x9e37_79b9) >> 16) as usize % stride;
    let sample: Vec<Aabb> = (0..boxes.len() / stride)
        .map(|index| boxes[index * stride + elsewhere(index)])
        .collect();
    // Rounds that join few clusters are as many more as there are more boxes, and as much longer.
    let most = sample.len() * (SAMPLE_SEARCHES + MOST_SEARCHES / stride);
    let corners = |b: &Aabb| Box32 {
        min: b.min.into(),
        max: b.max.into(),
    };
    let in_space: Vec<Box32> = sample.iter().map(corners).collect();
    let order = Treelets::of(&in_space, 1);
    let in_order = order.order().iter().map(|&index| sample[index as usize]);
    !ends(in_order.collect(), most)
}

/// Whether runs of neighbours take a round for every few boxes, in so large a share of all boxes that their rounds are
/// many: a sample of boxes that lie far apart does not show which neighbours are equally near.
fn are_many_among_neighbors(boxes: &[Aabb]) -> bool {
    let [fewest, most] = RUN;
    let length = (boxes.len() / BOXES_A_SAMPLE).clamp(fewest, most);
    let count = (boxes.len() / (BOXES_A_SAMPLE * length)).max(FEWEST_RUNS);
    let is_chain = |run: usize| {
        let start = run * (boxes.len() - length) / (count - 1);
        let most = RUN_SEARCHES.max(length / BOXES_A_RUN_SEARCH);
        !ends(boxes[start..][..length].to_vec(), length * most)
    };
    let chains = (0..count).filter(|&run| is_chain(run)).count();
    // The boxes of all chains, in one, take half of their number's square.
    let boxes_in_chains = (boxes.len() * chains / count) as u64;
    boxes_in_chains * boxes_in_chains / 2 > (boxes.len() * MOST_SEARCHES) as u64
}

/// Whether clustering ends within so many nearest-neighbour searches (Meister and Bittner, "Parallel locally-ordered
/// clustering for bounding volume hierarchy construction", 2018), with the search distances that obvhs is given.
fn ends(mut clusters: Vec<Aabb>, most: usize) -> bool {
    let mut searches = 0;
    let mut round = 0;
    let mut nearest = Vec::new();
    while clusters.len() > 1 {
        searches += clusters.len();
        if searches > most {
            return false;
        }
        let distance = if round < SHORT_ROUNDS { 1 } else { DISTANCE };
        nearest.clear();
        nearest.extend((0..clusters.len()).map(|of| nearest_of(&clusters, of, distance)));
        let mut kept = 0;
        for index in 0..clusters.len() {
            let other = nearest[index];
            let mut cluster = clusters[index];
            if nearest[other] == index {
                if other < index {
                    continue;
                }
                cluster = cluster.union(&clusters[other]);
            }
            clusters[kept] = cluster;
            kept += 1;
        }
        clusters.truncate(kept);
        round += 1;
    }
    true
}

/// The cluster with which one has the smallest box; of several the last.
fn nearest_of(clusters: &[Aabb], of: usize, distance: usize) -> usize {
    let end = (of + distance + 1).min(clusters.len());
    let mut nearest = of;
    let mut least = f32::INFINITY;
    for other in of.saturating_sub(distance)..end {
        if other == of {
            continue;
        }
        let area = clusters[of].union(&clusters[other]).half_area();
        if area <= least {
            (nearest, least) = (other, area);
        }
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use glam::Vec3A;

    /// Boxes, along the curve.
    fn boxes(count: usize, of: impl FnMut(usize) -> (Vec3A, Vec3A)) -> Vec<Aabb> {
        let all: Vec<Box32> = (0..count)
            .map(of)
            .map(|(min, max)| Box32 {
                min: min.into(),
                max: max.into(),
            })
            .collect();
        let order = Treelets::of(&all, 1);
        let in_order = order.order().iter().map(|&index| all[index as usize]);
        in_order
            .map(|b| Aabb::new(b.min.into(), b.max.into()))
            .collect()
    }

    /// Small boxes anywhere, and `fan` boxes each larger than the one before, among each other.
    fn with_fan(count: usize, fan: usize) -> Vec<Aabb> {
        let mut random = Random(7);
        let mut all = boxes(count, |_| {
            let at = random.point().as_vec3a();
            (at, at + 1e-3)
        });
        for index in 0..fan {
            let end = (index + 1) as f32 / fan as f32;
            all[index * count / fan] = Aabb::new(Vec3A::ZERO, Vec3A::new(end, 1.0, 0.0));
        }
        all
    }

    #[test]
    fn rounds_are_many_where_each_box_is_larger_than_the_one_before() {
        for count in [20_000, 200_000, 2_000_000] {
            assert!(!are_many(&with_fan(count, 0)), "{count}");
            assert!(!are_many(&with_fan(count, 500)), "{count}");
            assert!(are_many(&with_fan(count, count / 2)), "{count}");
            assert!(are_many(&with_fan(count, count)), "{count}");
        }
    }

    #[test]
    fn rounds_are_many_where_areas_of_neighbors_are_equal_but_for_rounding() {
        // Layers closer than areas tell apart, as a part of all boxes.
        let with_layers = |count: usize, layers: usize| {
            let mut random = Random(9);
            boxes(count, |index| match index.checked_sub(layers) {
                None => {
                    let height = 0.25 + index as f32 * 3e-8;
                    let corner = |side: f32| Vec3A::new(side, side * 0.7, height + 0.4 * side);
                    (corner(0.0), corner(1.0))
                }
                Some(_) => {
                    let at = random.point().as_vec3a();
                    (at, at + 1e-3)
                }
            })
        };
        for count in [5_000, 17_005, 200_000] {
            assert!(are_many(&with_layers(count, count)), "{count}");
            assert!(are_many(&with_layers(count, count / 2)), "{count}");
            assert!(!are_many(&with_layers(count, 200)), "{count}");
        }
    }

    #[test]
    fn surfaces_and_solids_take_few_rounds() {
        let sheet = boxes(1 << 18, |index| {
            let (x, y) = (index % 512, index / 512);
            let at = Vec3A::new(x as f32, y as f32, 0.0) / 512.0;
            (at, at + Vec3A::new(1.0, 1.0, 0.0) / 512.0)
        });
        assert!(!are_many(&sheet));
        let mut random = Random(3);
        let mut at = Vec3A::ZERO;
        let walk = boxes(1 << 17, |_| {
            let last = at;
            at += random.point().as_vec3a();
            (last.min(at), last.max(at))
        });
        assert!(!are_many(&walk));
    }
}
