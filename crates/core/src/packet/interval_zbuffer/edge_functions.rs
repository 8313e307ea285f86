use crate::num::simd::LANES;
use crate::packet::setup::TriangleSetup;

/// A triangle's edge functions and depth key: value at the first ray, step per column, step per row.
#[derive(Clone, Copy)]
pub(in crate::packet) struct EdgeFunctions {
    pub(in crate::packet) primitive: u32,
    pub(in crate::packet) edges: [[f32; 3]; 3],
    pub(in crate::packet) edge_error: f32,
    pub(in crate::packet) depth_key: [f32; 3],
    pub(in crate::packet) depth_key_error: f32,
}

impl EdgeFunctions {
    /// Those of lane `l` of a set-up.
    #[inline(always)]
    pub(in crate::packet) fn of(set_up: &TriangleSetup, l: usize, primitive: u32) -> Self {
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
    /// Whether a ray so many columns and rows from the first may hit the triangle: whether the signs of its edge functions do
    /// not surely differ. For ill-conditioned triangles, of which it is not known which side the ray sees.
    pub(in crate::packet) fn may_be_hit_at(&self, x: f32, y: f32) -> bool {
        let values = self.edges.map(|f| (f[0] + f[2] * y) + f[1] * x);
        let below = values.iter().any(|&value| value < -self.edge_error);
        let above = values.iter().any(|&value| value > self.edge_error);
        !(below & above)
    }
}
