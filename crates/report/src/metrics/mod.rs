//! Measures of the difference between two pictures.

mod flip;

pub use flip::flip;

use crate::table::ReportError;
use image::RgbImage;

/// The difference of a picture from a reference, by several measures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Difference {
    /// Root mean square error of 8-bit sRGB values, 0 to 255.
    pub rmse: f64,
    /// Peak signal-to-noise ratio in decibels: 20 log₁₀(255 / rmse). Infinite for equal pictures.
    pub psnr: f64,
    /// Structural similarity, 1 for equal pictures: Wang, Bovik, Sheikh and Simoncelli, "Image Quality Assessment:
    /// From Error Visibility to Structural Similarity", 2004. Computed by the crate `image-compare` over windows of
    /// 8 × 8 pixels.
    pub ssim: f64,
    /// The mean [`flip`] error, 0 for equal pictures.
    pub flip: f64,
}

impl Difference {
    /// Compares two pictures of the same size.
    ///
    /// # Errors
    /// Pictures of different sizes.
    pub fn between(picture: &RgbImage, reference: &RgbImage) -> Result<Self, ReportError> {
        let algorithm = image_compare::Algorithm::MSSIMSimple;
        let ssim = image_compare::rgb_similarity_structure(&algorithm, picture, reference)
            .map_err(|error| ReportError::Compare(error.to_string()))?
            .score;
        let rmse = rmse(picture, reference);
        Ok(Self {
            rmse,
            psnr: 20.0 * (255.0 / rmse).log10(),
            ssim,
            flip: flip(picture, reference),
        })
    }
}

fn rmse(picture: &RgbImage, reference: &RgbImage) -> f64 {
    let pairs = picture.as_raw().iter().zip(reference.as_raw());
    let squares: f64 = pairs
        .map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2))
        .sum();
    (squares / picture.as_raw().len().max(1) as f64).sqrt()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use image::Rgb;

    /// A smooth test picture with an amount of noise. Integer arithmetic makes it the same on every machine.
    pub(crate) fn hills(width: u32, height: u32, noise: u32) -> RgbImage {
        RgbImage::from_fn(width, height, |x, y| {
            let hash = (x * 7919 + y * 104_729) % 251;
            let wave = |at: u32, length: u32| {
                let phase = at % (2 * length);
                phase.min(2 * length - phase) * 255 / length
            };
            let value = |channel: u32| {
                let base = (wave(x + 5 * channel, 17) + wave(y, 11 + 3 * channel)) / 2;
                (base + (hash * (channel + 1)) % 29 * noise / 4).min(255) as u8
            };
            Rgb([value(0), value(1), value(2)])
        })
    }

    #[test]
    fn equal_pictures_do_not_differ() {
        let picture = hills(40, 30, 1);
        let difference = Difference::between(&picture, &picture).expect("one size");
        assert_eq!((difference.rmse, difference.flip), (0.0, 0.0));
        assert_eq!(difference.psnr, f64::INFINITY);
        assert!((difference.ssim - 1.0).abs() < 1e-9);
    }

    /// An error of 1 in every value gives 20 log₁₀ 255 = 48.1308 dB.
    #[test]
    fn one_step_everywhere_is_48_decibels() {
        let (a, b) = ([100, 100, 100], [101, 99, 101]);
        let a = RgbImage::from_pixel(16, 16, Rgb(a));
        let b = RgbImage::from_pixel(16, 16, Rgb(b));
        let difference = Difference::between(&a, &b).expect("one size");
        assert_eq!(difference.rmse, 1.0);
        assert!((difference.psnr - 48.1308).abs() < 1e-4);
    }

    #[test]
    fn more_noise_is_further_away_by_every_measure() {
        let reference = hills(64, 48, 0);
        let distance =
            |noise| Difference::between(&hills(64, 48, noise), &reference).expect("one size");
        let (near, far) = (distance(1), distance(4));
        assert!(near.rmse < far.rmse && near.psnr > far.psnr);
        assert!(near.ssim > far.ssim && near.flip < far.flip);
    }

    #[test]
    fn sizes_must_agree() {
        let error = Difference::between(&hills(8, 9, 0), &hills(9, 8, 0)).expect_err("two sizes");
        assert!(matches!(error, ReportError::Compare(_)));
    }
}
