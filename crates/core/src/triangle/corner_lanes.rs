use crate::num::simd::LANES;
use glam::Vec3;

/// Corner coordinates of eight triangles in structure-of-arrays order: x, y and z of the first corner, of the second, of
/// the third.
pub(crate) type CornerLanes = [[f32; LANES]; 9];

/// The three vectors in a lane.
#[inline(always)]
pub(crate) fn vectors_in_lane(all: &CornerLanes, lane: usize) -> [Vec3; 3] {
    let [ax, ay, az, bx, by, bz, cx, cy, cz] = all;
    [
        Vec3::new(ax[lane], ay[lane], az[lane]),
        Vec3::new(bx[lane], by[lane], bz[lane]),
        Vec3::new(cx[lane], cy[lane], cz[lane]),
    ]
}
