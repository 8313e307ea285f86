//! Whether clustering would take many rounds, and so long: judged by clustering a sample.

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

/// Rounds that search the nearest cluster among direct neighbours alone.
pub(super) const SHORT_ROUNDS: usize = 2;

/// How far other rounds search: obvhs's `PlocSearchDistance::Low`.
const DISTANCE: usize = 6;

/// Whether clusters would be joined a few at a time, in rounds that each search for all: the time is then quadratic in
/// the number of boxes. It is so where each is nearest to one that is nearer to another, as with the triangles of a
/// wide fan, each of which has a larger box than the one before.
pub(super) fn are_many(boxes: &[Aabb]) -> bool {
    if boxes.len() < FEWEST {
        return false;
    }
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
    !ends(&sample, most)
}

/// Whether clustering ends within so many nearest-neighbour searches (Meister and Bittner, "Parallel locally-ordered
/// clustering for bounding volume hierarchy construction", 2018), with the search distances that obvhs is given.
fn ends(boxes: &[Aabb], most: usize) -> bool {
    let corners = |b: &Aabb| Box32 {
        min: b.min.into(),
        max: b.max.into(),
    };
    let in_space: Vec<Box32> = boxes.iter().map(corners).collect();
    let order = Treelets::of(&in_space, 1);
    let mut clusters: Vec<Aabb> = (order.order().iter())
        .map(|&index| boxes[index as usize])
        .collect();
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

    fn boxes(count: usize, of: impl FnMut(usize) -> (Vec3A, Vec3A)) -> Vec<Aabb> {
        let all = (0..count).map(of);
        all.map(|(min, max)| Aabb::new(min, max)).collect()
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
