//! Random numbers that are a function of their arguments, the same everywhere.

/// A number from 0 up to 1 for a place on a lattice and a purpose (`seed`).
///
/// The hash is `pcg3d` of M. Jarzynski and M. Olano, "Hash functions for GPU rendering", 2020.
pub(crate) fn random(x: i32, y: i32, seed: u32) -> f64 {
    let step = |v: u32| v.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    let (mut x, mut y, mut z) = (step(x as u32), step(y as u32), step(seed));
    for _ in 0..2 {
        x = x.wrapping_add(y.wrapping_mul(z));
        y = y.wrapping_add(z.wrapping_mul(x));
        z = z.wrapping_add(x.wrapping_mul(y));
        x ^= x >> 16;
        y ^= y >> 16;
        z ^= z >> 16;
    }
    f64::from(x) / 4_294_967_296.0
}
