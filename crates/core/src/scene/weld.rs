//! Vertices at equal positions.

use glam::Vec3;
use rayon::prelude::*;

/// For each vertex the lowest one with equal coordinates; minus zero equals zero. A vertex that is not finite equals
/// only itself.
pub(crate) fn weld(positions: &[Vec3]) -> Vec<u32> {
    let mut sorted: Vec<([u32; 3], u32)> = positions
        .par_iter()
        .enumerate()
        // Adding zero makes minus zero positive.
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
