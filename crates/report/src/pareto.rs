//! The Pareto front of points.

/// Indices of the points that no other point dominates. Left and up are better: a point dominates another if it is
/// at least as good in both and better in one. In order of x; equal points are all included.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let beats = |a: &(f64, f64), b: &(f64, f64)| a.0 <= b.0 && a.1 >= b.1 && a != b;
    let mut front: Vec<usize> = (0..points.len())
        .filter(|&at| !points.iter().any(|other| beats(other, &points[at])))
        .collect();
    front.sort_by(|&a, &b| points[a].0.total_cmp(&points[b].0));
    front
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_those_that_nobody_beats() {
        let points = [
            (1.0, 10.0),
            (2.0, 30.0),
            (2.0, 20.0), // dominated: as wrong as the one before, and slower
            (5.0, 30.0), // as fast, and more often wrong
            (9.0, 90.0),
            (0.5, 1.0),
            (9.5, 80.0),
        ];
        assert_eq!(front(&points), [5, 0, 1, 4]);
        assert_eq!(front(&[]), [] as [usize; 0]);
        assert_eq!(front(&[(1.0, 1.0), (1.0, 1.0)]), [0, 1]);
    }
}
