use super::Scalar;
use super::crease::LastCreased;
use super::curvature::Curvatures;
use std::sync::OnceLock;

/// What colours can show of a mesh: the file's scalars, and what is worked out when it is first asked for.
#[derive(Clone, Debug, Default)]
pub(super) struct Measures {
    pub(super) scalars: Vec<Scalar>,
    pub(super) scalar_ranges: OnceLock<Vec<Option<[f32; 2]>>>,
    pub(super) area_range: OnceLock<Option<[f32; 2]>>,
    pub(super) curvatures: OnceLock<Curvatures>,
    pub(super) creased: LastCreased,
    pub(super) curvature_ranges: OnceLock<[Option<[f32; 2]>; 2]>,
    /// The vertices that kept triangles have; `None` where those are all.
    pub(super) kept_vertices: OnceLock<Option<Vec<u32>>>,
}

/// Of areas and curvatures, the share at each end that a fitted range leaves out: single slivers and sharp
/// corners are decades away from all else.
pub const OUTLIERS: f64 = 0.02;

impl Measures {
    pub(super) fn new(scalars: Vec<Scalar>) -> Self {
        Self {
            scalars,
            ..Self::default()
        }
    }
}

/// From the value that [`OUTLIERS`] of all lie below to the one that as many lie above.
pub(super) fn without_outliers(mut values: Vec<f32>) -> Option<[f32; 2]> {
    let last = values.len().checked_sub(1)?;
    let low = (last as f64 * OUTLIERS) as usize;
    let mut at = |index: usize| *values.select_nth_unstable_by(index, f32::total_cmp).1;
    Some([at(low), at(last - low)])
}
