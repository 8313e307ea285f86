use crate::scene::{Color, Crop, Texture, Wrap};
use crate::shade::srgb::{self, Tables};
use glam::DVec2;

/// The most repeats of a triangle along an axis that are drawn.
const MOST_REPEATS: f64 = 16.0;

/// A texture's image with its crop and the triangles that show it drawn over it.
#[derive(Clone, Debug)]
pub struct TextureMap {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 4]>,
    crop: Crop,
    wrap: [Wrap; 2],
    tables: &'static Tables,
}

impl TextureMap {
    /// The image of a whole texture, of which `crop` is used. `None` where the crop is empty or leaves the image.
    pub fn new(texture: &Texture, crop: Option<Crop>) -> Option<Self> {
        let (width, height) = (texture.width(), texture.height());
        let whole = Crop {
            x: 0,
            y: 0,
            width,
            height,
        };
        let crop = crop.unwrap_or(whole);
        let right = crop.x.checked_add(crop.width)?;
        let bottom = crop.y.checked_add(crop.height)?;
        let fits = crop.width > 0 && crop.height > 0 && right <= width && bottom <= height;
        fits.then(|| Self {
            width,
            height,
            pixels: texture.texels().to_vec(),
            crop,
            wrap: texture.wrap(),
            tables: srgb::tables(),
        })
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The pixels, sRGB with straight alpha, row by row from the top.
    pub fn into_pixels(self) -> Vec<[u8; 4]> {
        self.pixels
    }

    /// Draws the border of the crop, `width` pixels wide, around its outermost texels.
    pub fn draw_crop(&mut self, color: Color, width: f64) {
        let (low, high) = self.crop_corners();
        let corners = [
            low,
            DVec2::new(high.x, low.y),
            high,
            DVec2::new(low.x, high.y),
        ];
        let all = (DVec2::ZERO, self.size());
        for i in 0..4 {
            self.draw_line([corners[i], corners[(i + 1) % 4]], all, color, width);
        }
    }

    /// Draws the edges of a triangle with these texture coordinates, `width` pixels wide, within the crop, wherever
    /// the texture's wrapping shows it. Triangles with coordinates that are not finite, and triangles that repeat
    /// more than 16 times along an axis, are not drawn.
    pub fn draw_triangle(&mut self, corners: [DVec2; 3], color: Color, width: f64) {
        let within = self.crop_corners();
        for corners in self.repeats(corners) {
            for i in 0..3 {
                self.draw_line([corners[i], corners[(i + 1) % 3]], within, color, width);
            }
        }
    }

    /// Composites a colour over the pixels whose centres are in a triangle with these texture coordinates; `opacity`
    /// is 0 to 1.
    pub fn fill_triangle(&mut self, corners: [DVec2; 3], color: Color, opacity: f32) {
        let (low, high) = self.crop_corners();
        for [a, b, c] in self.repeats(corners) {
            let from = a.min(b).min(c).max(low).floor();
            let to = a.max(b).max(c).min(high).ceil();
            for y in from.y as u32..to.y.max(0.0) as u32 {
                for x in from.x as u32..to.x.max(0.0) as u32 {
                    let p = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                    let side = |a: DVec2, b: DVec2| (b - a).perp_dot(p - a);
                    let sides = [side(a, b), side(b, c), side(c, a)];
                    let is_in = sides.iter().all(|side| *side >= 0.0)
                        || sides.iter().all(|side| *side <= 0.0);
                    if is_in {
                        self.cover(x, y, color, opacity);
                    }
                }
            }
        }
    }

    fn size(&self) -> DVec2 {
        DVec2::new(self.width.into(), self.height.into())
    }

    fn crop_corners(&self) -> (DVec2, DVec2) {
        let Crop {
            x,
            y,
            width,
            height,
        } = self.crop;
        let low = DVec2::new(x.into(), y.into());
        (low, low + DVec2::new(width.into(), height.into()))
    }

    /// A triangle in pixels from the image's top left, once for each repeat of which a part may lie in the crop.
    fn repeats(&self, corners: [DVec2; 3]) -> Vec<[DVec2; 3]> {
        let [a, b, c] = corners;
        let times = |axis: usize| {
            let coordinates = [a[axis], b[axis], c[axis]];
            let low = coordinates.iter().copied().fold(f64::INFINITY, f64::min);
            let high = coordinates
                .iter()
                .copied()
                .fold(f64::NEG_INFINITY, f64::max);
            let is_good = coordinates.iter().all(|c| c.is_finite()) && high - low <= MOST_REPEATS;
            let (first, last) = match self.wrap[axis] {
                Wrap::Repeat | Wrap::Mirror => (low.floor(), high.ceil().max(low.floor() + 1.0)),
                Wrap::Clamp | Wrap::Border(_) => (0.0, 1.0),
            };
            let count = if is_good { (last - first) as u32 } else { 0 };
            (0..count).map(move |i| first + f64::from(i))
        };
        let moved = |axis: usize, coordinate: f64, tile: f64| {
            let within = coordinate - tile;
            let turned = self.wrap[axis] == Wrap::Mirror && tile.rem_euclid(2.0) == 1.0;
            if turned { 1.0 - within } else { within }
        };
        let (low, high) = self.crop_corners();
        let mut all = Vec::new();
        for v in times(1) {
            for u in times(0) {
                all.push(corners.map(|corner| {
                    let (x, y) = (moved(0, corner.x, u), 1.0 - moved(1, corner.y, v));
                    low + DVec2::new(x, y) * (high - low)
                }));
            }
        }
        all
    }

    /// A line with round ends, antialiased over a pixel, clipped to a rectangle.
    fn draw_line(
        &mut self,
        [a, b]: [DVec2; 2],
        (low, high): (DVec2, DVec2),
        color: Color,
        width: f64,
    ) {
        let reach = width * 0.5 + 0.5;
        let along = b - a;
        let length = along.length();
        let from = (a.min(b) - reach).max(low).floor();
        let to = (a.max(b) + reach).min(high).ceil();
        let distance = |p: DVec2| {
            let share = if length > 0.0 {
                ((p - a).dot(along) / (length * length)).clamp(0.0, 1.0)
            } else {
                0.0
            };
            p.distance(a + along * share)
        };
        for y in from.y.max(0.0) as u32..to.y.max(0.0) as u32 {
            let middle = f64::from(y) + 0.5;
            // The columns of the line's band in this row.
            let (mut left, mut right) = (from.x, to.x);
            if along.y != 0.0 {
                let at = a.x + along.x * ((middle - a.y) / along.y);
                let half = reach * length / along.y.abs() + 0.5;
                left = left.max((at - half).floor());
                right = right.min((at + half).ceil());
            }
            for x in left.max(0.0) as u32..right.max(0.0) as u32 {
                let apart = distance(DVec2::new(f64::from(x) + 0.5, middle));
                let coverage = (reach - apart).clamp(0.0, width.min(1.0)) as f32;
                if coverage > 0.0 {
                    self.cover(x, y, color, coverage);
                }
            }
        }
    }

    /// Composites a colour over a fraction of a pixel, in linear light.
    fn cover(&mut self, x: u32, y: u32, color: Color, coverage: f32) {
        let index = y as usize * self.width as usize + x as usize;
        let Some(pixel) = self.pixels.get_mut(index) else {
            return;
        };
        let [r, g, b, a] = *pixel;
        let below = f32::from(a) / 255.0 * (1.0 - coverage);
        let alpha = coverage + below;
        let tables = self.tables;
        let mix = |over: u8, under: u8| {
            let light = tables.decode(over) * coverage + tables.decode(under) * below;
            tables.encode(light / alpha)
        };
        let [over_r, over_g, over_b] = color.0;
        *pixel = [
            mix(over_r, r),
            mix(over_g, g),
            mix(over_b, b),
            (alpha * 255.0 + 0.5) as u8,
        ];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Color = Color([255, 0, 0]);

    fn map(wrap: Wrap, crop: Option<Crop>) -> TextureMap {
        let texture = Texture::new(40, 30, vec![[0, 0, 0, 255]; 1200]).expect("a good texture");
        TextureMap::new(&texture.wrapped([wrap; 2]), crop).expect("a good crop")
    }

    fn reds(map: TextureMap) -> Vec<(u32, u32, u8)> {
        let width = map.width();
        let pixels = map.into_pixels().into_iter().enumerate();
        pixels
            .filter(|(_, pixel)| pixel[0] > 0)
            .map(|(i, pixel)| (i as u32 % width, i as u32 / width, pixel[0]))
            .collect()
    }

    /// The truth is the distance of each pixel's centre from the segments.
    #[test]
    fn edges_cover_the_pixels_near_them() {
        let corners = [(0.1, 0.1), (0.9, 0.2), (0.4, 0.95)].map(|(u, v)| DVec2::new(u, v));
        let mut drawn = map(Wrap::Repeat, None);
        drawn.draw_triangle(corners, RED, 1.5);
        let found = reds(drawn);
        let places = corners.map(|uv| DVec2::new(uv.x * 40.0, (1.0 - uv.y) * 30.0));
        for y in 0..30 {
            for x in 0..40 {
                let p = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let nearest = (0..3)
                    .map(|i| {
                        let (a, b) = (places[i], places[(i + 1) % 3]);
                        let share = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
                        p.distance(a + (b - a) * share)
                    })
                    .fold(f64::INFINITY, f64::min);
                let red = found.iter().find(|(a, b, _)| (*a, *b) == (x, y));
                match nearest {
                    near if near < 0.25 => assert_eq!(red.map(|r| r.2), Some(255), "{x} {y}"),
                    far if far > 1.25 => assert_eq!(red, None, "{x} {y}"),
                    _ => {}
                }
            }
        }
    }

    #[test]
    fn a_triangle_is_filled_and_repeated_as_its_texture_wraps() {
        let at = |u: f64| {
            [(0.25, 0.125), (0.5, 0.125), (0.25, 0.875)].map(|(x, y)| DVec2::new(x + u, y))
        };
        let fill = |wrap, u, crop| {
            let mut filled = map(wrap, crop);
            filled.fill_triangle(at(u), RED, 1.0);
            reds(filled)
        };
        let once = fill(Wrap::Repeat, 0.0, None);
        // Half of 10 × 22.5 pixels, except those that the slope cuts.
        assert!(once.len().abs_diff(112) <= 12, "{}", once.len());
        assert_eq!(fill(Wrap::Repeat, 1.0, None), once);
        assert_eq!(fill(Wrap::Repeat, -3.0, None), once);
        assert_eq!(fill(Wrap::Clamp, 1.0, None), []);
        let mirrored: Vec<u32> = fill(Wrap::Mirror, 1.0, None).iter().map(|p| p.0).collect();
        assert_eq!(mirrored.iter().max(), Some(&29));
        // Inside the crop, and nowhere else.
        let crop = Crop {
            x: 10,
            y: 5,
            width: 20,
            height: 10,
        };
        let inside = fill(Wrap::Repeat, 0.0, Some(crop));
        assert!(!inside.is_empty());
        assert!(
            inside
                .iter()
                .all(|&(x, y, _)| (15..=19).contains(&x) && (5..15).contains(&y))
        );
        assert_eq!(fill(Wrap::Repeat, f64::NAN, None), []);
        assert_eq!(fill(Wrap::Repeat, f64::INFINITY, None), []);
    }

    #[test]
    fn a_crop_that_leaves_the_image_is_none() {
        let texture = Texture::new(4, 4, vec![[0; 4]; 16]).expect("a good texture");
        let crop = |x, width| {
            let crop = Crop {
                x,
                y: 0,
                width,
                height: 4,
            };
            TextureMap::new(&texture, Some(crop)).is_some()
        };
        assert!(crop(1, 3) && !crop(2, 3) && !crop(0, 0) && !crop(u32::MAX, 1));
    }
}
