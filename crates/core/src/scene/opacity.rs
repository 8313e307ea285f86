use super::Texture;
use glam::Vec2;
use std::sync::Arc;

/// Whether a material's surface is opaque, masked or blended.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Opacity {
    /// Opaque everywhere.
    #[default]
    Opaque,
    /// Points whose alpha is at least `cutoff` are opaque. Rays pass through the others: they are no hits.
    Mask {
        /// The alpha that is compared.
        alpha: Alpha,
        /// The least alpha of a hit.
        cutoff: f32,
    },
    /// A surface that covers what lies behind it by its alpha.
    Blend(Alpha),
}

/// A material's alpha: a factor, times an image's where it has one.
#[derive(Clone, Debug, PartialEq)]
pub struct Alpha {
    /// 0 to 1.
    pub factor: f32,
    /// The image whose fourth channel counts, by the mesh's texture coordinates.
    pub image: Option<Arc<Texture>>,
}

impl Opacity {
    /// The cutoff of masks where the file gives none (glTF's default).
    pub const CUTOFF: f32 = 0.5;

    /// Its alpha; `None` where it is opaque.
    pub fn alpha(&self) -> Option<&Alpha> {
        match self {
            Self::Opaque => None,
            Self::Mask { alpha, .. } | Self::Blend(alpha) => Some(alpha),
        }
    }
}

impl Alpha {
    /// The alpha at barycentrics (u, v) of a triangle with these texture coordinates at its corners a, b and c.
    ///
    /// In double precision, rounded after each operation: the texture coordinate is a + (b − a)·u + (c − a)·v, and
    /// alpha is interpolated bilinearly between the four nearest texels of the full image (their centres lie half a
    /// texel from the image's edges), whatever the picture's filter, divided by 255 and multiplied by the factor. It
    /// is the factor alone where there is no image, or no texture coordinates, or none that are finite.
    pub fn at(&self, uvs: Option<[Vec2; 3]>, u: f32, v: f32) -> f64 {
        let factor = f64::from(self.factor);
        let (Some(image), Some(uvs)) = (&self.image, uvs) else {
            return factor;
        };
        let [a, b, c] = uvs.map(Vec2::as_dvec2);
        let place = a + (b - a) * f64::from(u) + (c - a) * f64::from(v);
        if !place.is_finite() {
            return factor;
        }
        let [wrap_across, wrap_down] = image.wrap();
        let x = wrap_across.near(place.x) * f64::from(image.width()) - 0.5;
        let y = (1.0 - wrap_down.near(place.y)) * f64::from(image.height()) - 0.5;
        let (left, top) = (x.floor(), y.floor());
        let (right, below) = (x - left, y - top);
        let mut sum = 0.0;
        for (row, high) in [(top, 1.0 - below), (top + 1.0, below)] {
            for (column, wide) in [(left, 1.0 - right), (left + 1.0, right)] {
                sum += f64::from(image.alpha(column as i64, row as i64)) * (wide * high);
            }
        }
        sum / 255.0 * factor
    }
}

#[cfg(test)]
mod tests {
    use super::super::Wrap;
    use super::*;

    const SQUARE: [Vec2; 3] = [Vec2::ZERO, Vec2::X, Vec2::Y];

    fn image(columns: u32, rows: u32, alphas: &[u8]) -> Texture {
        let texels = alphas.iter().map(|&alpha| [9, 9, 9, alpha]).collect();
        Texture::new(columns, rows, texels).expect("as many texels")
    }

    #[test]
    fn alpha_is_interpolated_between_texels_and_wrapped() {
        let alpha = |wrap: Wrap, u: f32, v: f32| {
            let image = image(2, 2, &[255, 0, 0, 51]).wrapped([wrap; 2]);
            let alpha = Alpha {
                factor: 0.5,
                image: Some(Arc::new(image)),
            };
            alpha.at(Some(SQUARE), u, v)
        };
        // Rows run from the top, v from the bottom.
        assert_eq!(alpha(Wrap::Repeat, 0.25, 0.75), 0.5);
        assert_eq!(alpha(Wrap::Repeat, 0.75, 0.25), 0.1);
        assert_eq!(alpha(Wrap::Repeat, 0.5, 0.75), 0.25);
        assert_eq!(alpha(Wrap::Repeat, 0.5, 0.5), 0.5 * 306.0 / 4.0 / 255.0);
        // At the corner the four repeats join; clamped, only the corner's own texel counts.
        assert_eq!(alpha(Wrap::Repeat, 0.0, 0.0), 0.5 * 306.0 / 4.0 / 255.0);
        assert_eq!(alpha(Wrap::Clamp, 0.0, 1.0), 0.5);
        assert_eq!(alpha(Wrap::Mirror, 0.0, 1.0), 0.5);
    }

    #[test]
    fn without_image_or_coordinates_the_factor_counts() {
        let mut alpha = Alpha {
            factor: 0.25,
            image: None,
        };
        assert_eq!(alpha.at(Some(SQUARE), 0.1, 0.1), 0.25);
        alpha.image = Some(Arc::new(image(1, 1, &[0])));
        assert_eq!(alpha.at(Some(SQUARE), 0.1, 0.1), 0.0);
        assert_eq!(alpha.at(None, 0.1, 0.1), 0.25);
        assert_eq!(alpha.at(Some([Vec2::NAN; 3]), 0.1, 0.1), 0.25);
    }
}
