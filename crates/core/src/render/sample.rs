/// The place of a pixel's `index`-th sample, from its top left corner.
///
/// The first is the pixel's middle; the rest follow it evenly, whatever their number (Roberts, "The
/// Unreasonable Effectiveness of Quasirandom Sequences", 2018: multiples of the powers of the
/// plastic number's inverse).
pub(super) fn sample_offset(index: u32) -> (f64, f64) {
    const ACROSS: f64 = 0.754_877_666_246_692_7;
    const DOWN: f64 = 0.569_840_290_998_053_2;
    let along = |share: f64| (0.5 + f64::from(index) * share).fract();
    (along(ACROSS), along(DOWN))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_start_in_the_middle_and_spread_evenly() {
        assert_eq!(sample_offset(0), (0.5, 0.5));
        let mut cells = [0; 16];
        for index in 0..256 {
            let (x, y) = sample_offset(index);
            assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y));
            cells[(y * 4.0) as usize * 4 + (x * 4.0) as usize] += 1;
        }
        assert!(
            cells.iter().all(|count| (12..=20).contains(count)),
            "{cells:?}"
        );
    }
}
