use super::Scalar;
use super::crease::LastCreased;
use super::curvature::Curvatures;
use std::sync::OnceLock;

/// What colours can show of a mesh: the file's scalars, and quantities that are computed on first use.
#[derive(Clone, Debug, Default)]
pub(super) struct Measures {
    pub(super) scalars: Vec<Scalar>,
    pub(super) scalar_ranges: OnceLock<Vec<Option<[f32; 2]>>>,
    pub(super) area_range: OnceLock<Option<[f32; 2]>>,
    pub(super) curvatures: OnceLock<Curvatures>,
    pub(super) creased: LastCreased,
    pub(super) curvature_ranges: OnceLock<[Option<[f32; 2]>; 2]>,
    /// The vertices that kept triangles use; `None` where that is all of them.
    pub(super) kept_vertices: OnceLock<Option<Vec<u32>>>,
}

/// The fraction of areas and curvatures at each end that a fitted range leaves out. With a smaller one single slivers
/// and sharp corners, decades away from the rest, would stretch the range; with a larger one ordinary values
/// saturate.
pub const OUTLIERS: f64 = 0.02;

impl Measures {
    pub(super) fn new(scalars: Vec<Scalar>) -> Self {
        Self {
            scalars,
            ..Self::default()
        }
    }
}

/// The range without the fraction [`OUTLIERS`] of the values at either end; `None` without values.
pub(super) fn without_outliers(mut values: Vec<f32>) -> Option<[f32; 2]> {
    let last = values.len().checked_sub(1)?;
    let low = (last as f64 * OUTLIERS) as usize;
    let mut at = |index: usize| *values.select_nth_unstable_by(index, f32::total_cmp).1;
    Some([at(low), at(last - low)])
}
