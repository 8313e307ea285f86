//! Fetching from memory what neighbouring samples are about to read of large meshes.

use super::Shader;
use crate::MISS;
use crate::num::simd::Lanes;
use crate::scene::Scene;
use crate::shade::facet::Needs;

/// The most triangles of a mesh whose normals and their indices, some 20 bytes a triangle, stay in a core's second-level
/// cache.
const MOST_CACHED: usize = 1 << 16;

/// Whether the normals of some mesh are mostly read from memory.
pub(super) fn is_worth_it(scene: &Scene, needs: &Needs) -> bool {
    let mut objects = scene.objects.iter();
    needs.smooth && objects.any(|object| object.mesh.triangles().len() > MOST_CACHED)
}

impl Shader<'_> {
    /// Fetches the normals of the triangles that some samples of a row show, where [`is_worth_it`]. Where triangles are
    /// smaller than pixels each sample reads other normals, through indices that it reads first: one after the other they
    /// would be waited for twice a sample.
    #[inline(always)]
    pub(in crate::shade) fn prefetch(&self, lanes: impl Lanes, primitives: &[u32]) {
        if self.prefetches {
            self.prefetch_normals(lanes, primitives);
        }
    }

    #[inline(always)]
    fn prefetch_normals(&self, lanes: impl Lanes, primitives: &[u32]) {
        for_each_distinct(primitives, |primitive| {
            let (object, triangle) = self.accel.identify(primitive);
            if let Some((_, indices)) = self.normals_of(object) {
                lanes.prefetch(indices, triangle as usize);
            }
        });
        for_each_distinct(primitives, |primitive| {
            let (object, triangle) = self.accel.identify(primitive);
            let Some((normals, indices)) = self.normals_of(object) else {
                return;
            };
            for &corner in indices.get(triangle as usize).into_iter().flatten() {
                lanes.prefetch(&normals.values, corner as usize);
            }
        });
    }
}

/// Calls `visit` for each primitive index of a row that differs from the one before it.
#[inline(always)]
fn for_each_distinct(primitives: &[u32], mut visit: impl FnMut(u32)) {
    let mut last = MISS;
    for &primitive in primitives {
        if primitive != last && primitive != MISS {
            visit(primitive);
        }
        last = primitive;
    }
}
