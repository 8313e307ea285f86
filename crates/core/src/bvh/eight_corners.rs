//! The corners of eight triangles at once.

use super::Accel;
use crate::num::simd::{F32x8, LANES, Lanes};
use crate::triangle::CornerLanes;
use glam::Vec3;

impl Accel {
    /// [`Accel::corners`] of eight triangles, in structure-of-arrays order.
    #[inline(always)]
    pub(crate) fn eight_corners<const INSTANCES: bool>(
        &self,
        lanes: impl Lanes,
        primitives: &[u32; LANES],
    ) -> CornerLanes {
        let stored = self.stored_corners::<INSTANCES>(primitives);
        let [a, b, c, d, e, f, g, h] = stored;
        let rows = [
            row(lanes, a),
            row(lanes, b),
            row(lanes, c),
            row(lanes, d),
            row(lanes, e),
            row(lanes, f),
            row(lanes, g),
            row(lanes, h),
        ];
        let [ax, ay, az, bx, by, bz, cx, cy] = lanes.transpose(rows);
        let cz = lanes.load(&stored.map(|[_, _, c]| c.z));
        let mut out: CornerLanes = [[0.0; LANES]; 9];
        for (out, corners) in out.iter_mut().zip([ax, ay, az, bx, by, bz, cx, cy, cz]) {
            corners.store(out);
        }
        self.place::<INSTANCES>(primitives, &mut out);
        out
    }

    /// The corners of eight triangles as they are stored; those of instances must still be [placed](Accel::place).
    #[inline(always)]
    fn stored_corners<const INSTANCES: bool>(
        &self,
        primitives: &[u32; LANES],
    ) -> [&[Vec3; 3]; LANES] {
        if INSTANCES && self.triangles.is_empty() {
            self.instances.stored_corners(primitives)
        } else {
            primitives.map(|primitive| &self.triangles[primitive as usize].corners)
        }
    }

    /// Places the stored corners of eight triangles; does nothing without instances.
    #[inline(always)]
    fn place<const INSTANCES: bool>(&self, primitives: &[u32; LANES], corners: &mut CornerLanes) {
        if INSTANCES && self.triangles.is_empty() {
            self.instances.place(primitives, corners);
        }
    }
}

/// The first eight of a triangle's nine coordinates.
#[inline(always)]
fn row<L: Lanes>(lanes: L, [a, b, c]: &[Vec3; 3]) -> L::F32 {
    lanes.load(&[a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y])
}
