//! Vertices that are at one place.

use glam::Vec3;
use rayon::prelude::*;

/// For each vertex the lowest one at its place. Places are the same where all three coordinates are; zero has
/// no sign. A vertex that is not finite is a place of its own.
pub(crate) fn weld(positions: &[Vec3]) -> Vec<u32> {
    let mut sorted: Vec<([u32; 3], u32)> = positions
        .par_iter()
        .enumerate()
        // Adding zero takes the sign off a zero.
        .map(|(number, position)| {
            let place = (*position + 0.0).to_array().map(f32::to_bits);
            (place, number as u32)
        })
        .collect();
    sorted.par_sort_unstable();
    let mut lowest = vec![0; sorted.len()];
    let mut first = 0;
    for at in 0..sorted.len() {
        let (place, number) = sorted[at];
        let is_finite = place.iter().all(|bits| f32::from_bits(*bits).is_finite());
        if !is_finite || place != sorted[first].0 {
            first = at;
        }
        lowest[number as usize] = sorted[first].1;
    }
    lowest
}
