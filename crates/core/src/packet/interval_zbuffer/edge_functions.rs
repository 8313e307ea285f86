use crate::num::simd::LANES;
use crate::packet::setup::TriangleSetup;

/// A triangle's edge functions and depth key: value at the first ray, step per column, step per row.
#[derive(Clone, Copy)]
pub(super) struct EdgeFunctions {
    pub(super) primitive: u32,
    pub(super) edges: [[f32; 3]; 3],
    pub(super) edge_error: f32,
    pub(super) depth_key: [f32; 3],
    pub(super) depth_key_error: f32,
}

impl EdgeFunctions {
    /// Those of lane `l` of a set-up.
    #[inline(always)]
    pub(super) fn of(set_up: &TriangleSetup, l: usize, primitive: u32) -> Self {
        let linear = |f: &[[f32; LANES]; 3]| [f[0][l], f[1][l], f[2][l]];
        Self {
            primitive,
            edges: [
                linear(&set_up.edges[0]),
                linear(&set_up.edges[1]),
                linear(&set_up.edges[2]),
            ],
            edge_error: set_up.edge_error[l],
            depth_key: linear(&set_up.depth_key),
            depth_key_error: set_up.depth_key_error[l],
        }
    }
}
