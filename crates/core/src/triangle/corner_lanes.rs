use crate::num::simd::LANES;

/// Corner coordinates of eight triangles in structure-of-arrays order: x, y and z of the first corner, of the second, of
/// the third.
pub(crate) type CornerLanes = [[f32; LANES]; 9];
