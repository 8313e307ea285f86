//! Hashes of triangles by their corners.

/// A hash that is equal for triangles with the same corners, in any order.
pub(super) fn hash(corners: [[f32; 3]; 3]) -> u32 {
    let one = |[x, y, z]: [u32; 3]| {
        let x = u64::from(x).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let y = u64::from(y).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
        let z = u64::from(z).wrapping_mul(0x1656_67b1_9e37_79f9);
        let sum = x ^ y.rotate_left(23) ^ z.rotate_left(41);
        (sum ^ sum >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9)
    };
    let [a, b, c] = bits(corners).map(one);
    (a.wrapping_add(b).wrapping_add(c) >> 32) as u32
}

/// The bits of corners' coordinates, minus zero as zero, so that they are equal where the coordinates are.
pub(super) fn bits(corners: [[f32; 3]; 3]) -> [[u32; 3]; 3] {
    corners.map(|corner| corner.map(|x| (x + 0.0).to_bits()))
}
