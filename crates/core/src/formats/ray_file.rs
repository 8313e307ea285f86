use crate::hit::Hit;
use crate::ray::Ray;
use glam::DVec3;

/// Bytes of a ray in a ray file: origin x y z, t_min, direction x y z, t_max, each a little-endian
/// 32-bit float.
pub const RAY_BYTES: usize = 32;

/// Bytes of a hit in a hit file: t (float), object, triangle (unsigned), u, v (float), each 32 bits,
/// little-endian.
pub const HIT_BYTES: usize = 20;

/// Decodes a ray of a ray file. Any bits decode to a ray; [`Ray::is_valid`] says whether it can hit anything.
pub fn decode_ray(bytes: &[u8; RAY_BYTES]) -> Ray {
    let [ox, oy, oz, t_min, dx, dy, dz, t_max] =
        bytemuck::cast::<_, [[u8; 4]; 8]>(*bytes).map(|word| f64::from(f32::from_le_bytes(word)));
    Ray {
        origin: DVec3::new(ox, oy, oz),
        t_min,
        direction: DVec3::new(dx, dy, dz),
        t_max,
    }
}

/// Encodes a hit for a hit file, rounded to single precision. A miss has infinity as `t` and `u32::MAX` as its
/// numbers.
pub fn encode_hit(hit: Option<&Hit>) -> [u8; HIT_BYTES] {
    let words = match hit {
        Some(hit) => [
            (hit.t as f32).to_le_bytes(),
            hit.object.to_le_bytes(),
            hit.triangle.to_le_bytes(),
            (hit.u as f32).to_le_bytes(),
            (hit.v as f32).to_le_bytes(),
        ],
        None => [
            f32::INFINITY.to_le_bytes(),
            u32::MAX.to_le_bytes(),
            u32::MAX.to_le_bytes(),
            [0; 4],
            [0; 4],
        ],
    };
    bytemuck::cast(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_and_hits_are_laid_out_as_promised() {
        let numbers: [f32; 8] = [1.0, -2.0, 3.5, 0.25, 0.0, 0.0, -1.0, 100.0];
        let bytes: [u8; RAY_BYTES] = bytemuck::cast(numbers.map(f32::to_le_bytes));
        let ray = decode_ray(&bytes);
        assert_eq!(ray.origin, DVec3::new(1.0, -2.0, 3.5));
        assert_eq!(ray.direction, DVec3::NEG_Z);
        assert_eq!((ray.t_min, ray.t_max), (0.25, 100.0));

        let hit = Hit {
            object: 1,
            triangle: 0x0403_0201,
            t: 2.0,
            u: 0.5,
            v: 0.25,
        };
        let bytes = encode_hit(Some(&hit));
        assert_eq!(bytes[0..4], 2f32.to_le_bytes());
        assert_eq!(bytes[4..12], [1, 0, 0, 0, 1, 2, 3, 4]);
        assert_eq!(bytes[12..16], 0.5f32.to_le_bytes());
        assert_eq!(bytes[16..20], 0.25f32.to_le_bytes());
        let miss = encode_hit(None);
        assert_eq!(miss[0..4], f32::INFINITY.to_le_bytes());
        assert_eq!(miss[4..12], [0xff; 8]);
        assert_eq!(miss[12..20], [0; 8]);
    }
}
