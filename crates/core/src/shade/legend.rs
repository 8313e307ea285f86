//! Legends of colour scales, as values and drawn into the picture.

use super::own_color::{fitted_range, knows_range};
use super::{Shading, srgb};
use crate::camera::{Camera, Rect};
use crate::scene::{COLOR_MAP_STEPS, ColorRule, ColorScale, Curvature, Object, Quantity, Scene};
use ab_glyph::{Font, FontRef, GlyphId, PxScale, ScaleFont, point};
use glam::Vec3;

/// The legend of a picture's colour scale: the quantity, its colours and its range.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// The name of the quantity: `distance`, `area`, a scalar's name.
    pub title: String,
    /// The scale; its range is set.
    pub scale: ColorScale,
}

/// The most marks along a legend.
const MARKS: f64 = 5.0;

/// In pixels at 720 rows; scales with the picture, but stays large enough for its numbers to be readable.
const WIDTH: f32 = 150.0;
const HEIGHT: f32 = 252.0;
const MARGIN: f32 = 16.0;
const PADDING: f32 = 12.0;
const BAR: f32 = 18.0;
const TEXT: f32 = 15.0;

/// The opacity of the dark background: light text on it is readable over anything.
const GLASS: f32 = 0.72;
const GLASS_LIGHT: Vec3 = Vec3::new(0.010, 0.012, 0.015);
const INK: Vec3 = Vec3::new(0.84, 0.86, 0.88);

impl Legend {
    /// The legend of the first visible object whose rule shows numbers.
    pub(super) fn of_objects(scene: &Scene, camera: &Camera, shading: &Shading) -> Option<Self> {
        let mut objects = scene.objects.iter().filter(|object| object.visible);
        let quantity = objects.find_map(shown_quantity)?;
        Self::of_quantity(quantity, scene, camera, shading)
    }

    /// The legend of one object's numbers, in a mode that shows objects' colours; `None` where its rule shows none, and where a
    /// picture would first compute their range.
    pub fn of_object(
        number: usize,
        scene: &Scene,
        camera: &Camera,
        shading: &Shading,
    ) -> Option<Self> {
        let object = scene.objects.get(number).filter(|object| object.visible)?;
        let quantity = shown_quantity(object)?;
        let is_fitted = shading.scale.unwrap_or_default().range.is_none();
        if is_fitted && !knows_range(scene, quantity) {
            return None;
        }
        Self::of_quantity(quantity, scene, camera, shading)
    }

    fn of_quantity(
        quantity: &Quantity,
        scene: &Scene,
        camera: &Camera,
        shading: &Shading,
    ) -> Option<Self> {
        let scale = shading.scale.unwrap_or_default();
        let fitted = || fitted_range(scene, camera, quantity);
        Some(Self {
            title: match quantity {
                Quantity::Distance(_) => "distance".to_owned(),
                Quantity::Scalar(name) => name.to_string(),
                Quantity::Area => "area".to_owned(),
                Quantity::Curvature(Curvature::Mean) => "mean curvature".to_owned(),
                Quantity::Curvature(Curvature::Gaussian) => "Gaussian curvature".to_owned(),
            },
            scale: ColorScale {
                range: Some(scale.range.or_else(fitted)?),
                ..scale
            },
        })
    }

    /// The numbers at the scale's ends.
    pub fn range(&self) -> [f64; 2] {
        self.scale.range.unwrap_or_default()
    }

    /// Round numbers within the range, ascending, each with its position between the low end (0) and the high end
    /// (1). They are one, two or five times a power of ten apart.
    pub fn marks(&self) -> Vec<(f64, String)> {
        let [low, high] = self.range();
        let length = high - low;
        if !(length > 0.0 && length.is_finite()) {
            return vec![(0.0, plain(low, None))];
        }
        // By formatting as text, since logarithms differ from machine to machine.
        let text = format!("{:e}", length / MARKS);
        let Some((mantissa, power)) = text.split_once('e') else {
            return Vec::new();
        };
        let (mantissa, power) = (
            mantissa.parse().unwrap_or(1.0),
            power.parse::<i32>().unwrap_or(0),
        );
        let (digit, power) = match [1.0, 2.0, 5.0].into_iter().find(|round| *round >= mantissa) {
            Some(round) => (round, power),
            None => (1.0, power + 1),
        };
        let step: f64 = format!("{digit}e{power}").parse().unwrap_or(length);
        let first = (low / step).ceil();
        let count = ((high / step).floor() - first) as usize;
        (0..=count.min(12))
            .map(|index| {
                let times = first + index as f64;
                // Parsed from decimals, so that it is the nearest double to the mark's number.
                let number = format!("{}e{power}", times * digit).parse().unwrap_or(0.0);
                ((number - low) / length, plain(number, Some(power)))
            })
            .collect()
    }

    /// The rectangle of the legend in a picture of this size; `None` if the picture is too small.
    pub fn rect(columns: u32, rows: u32) -> Option<Rect> {
        let zoom = zoom(rows);
        let [width, height, margin] =
            [WIDTH, HEIGHT, MARGIN].map(|length| (length * zoom).round() as u32);
        let fits = columns >= 2 * (width + margin) && rows >= height + 2 * margin;
        fits.then(|| Rect {
            x: columns - width - margin,
            y: (rows - height) / 2,
            width,
            height,
        })
    }
}

fn shown_quantity(object: &Object) -> Option<&Quantity> {
    match &object.color {
        ColorRule::Value(quantity) => Some(quantity),
        _ => None,
    }
}

fn zoom(rows: u32) -> f32 {
    (rows as f32 / 720.0).max(0.72)
}

/// A number with as few digits as its marks need.
fn plain(number: f64, power: Option<i32>) -> String {
    match power {
        _ if number == 0.0 => "0".to_owned(),
        Some(power @ -5..=5) if number.abs() < 1e7 => {
            format!("{number:.*}", power.min(0).unsigned_abs() as usize)
        }
        None if (1e-4..1e7).contains(&number.abs()) => format!("{number}"),
        _ => format!("{number:.2e}"),
    }
}

/// A drawn legend: linear light with premultiplied alpha, over a rectangle of the picture.
#[derive(Clone, Debug)]
pub(crate) struct DrawnLegend {
    rect: Rect,
    pixels: Vec<[f32; 4]>,
}

impl DrawnLegend {
    /// `None` if the picture is too small.
    pub(crate) fn new(legend: &Legend, columns: u32, rows: u32) -> Option<Self> {
        let rect = Legend::rect(columns, rows)?;
        let glass = GLASS_LIGHT * GLASS;
        let mut drawn = Self {
            rect,
            pixels: vec![[glass.x, glass.y, glass.z, GLASS]; rect.area()],
        };
        let zoom = zoom(rows);
        let [padding, bar, text] = [PADDING, BAR, TEXT].map(|length| (length * zoom).round());
        drawn.text(
            padding,
            padding,
            text,
            rect.width as f32 - 2.0 * padding,
            &legend.title,
        );
        let top = (padding + 1.6 * text).round();
        let bottom = rect.height as f32 - padding - (0.4 * text).round();
        let colors = legend.scale.map.colors();
        for y in top as u32..bottom as u32 {
            let share = (bottom - 1.0 - y as f32) / (bottom - 1.0 - top).max(1.0);
            let step = (share * (COLOR_MAP_STEPS - 1) as f32).round() as usize;
            let color = srgb::linear(colors[step.min(COLOR_MAP_STEPS - 1)]);
            for x in padding as u32..(padding + bar) as u32 {
                drawn.cover(x, y, color, 1.0);
            }
        }
        let right = (padding + bar) as u32;
        for (share, number) in legend.marks() {
            let y = bottom - 1.0 - share as f32 * (bottom - 1.0 - top);
            for x in right..right + (4.0 * zoom) as u32 {
                drawn.cover(x, y.round() as u32, INK, 1.0);
            }
            let left = right as f32 + 8.0 * zoom;
            let width = rect.width as f32 - left - 4.0;
            drawn.text(left, y - 0.5 * text, text, width, &number);
        }
        Some(drawn)
    }

    /// Composites a colour over a fraction of a pixel.
    fn cover(&mut self, x: u32, y: u32, color: Vec3, part: f32) {
        if x >= self.rect.width || y >= self.rect.height {
            return;
        }
        let pixel = &mut self.pixels[(y * self.rect.width + x) as usize];
        let color = color * part;
        *pixel = over([color.x, color.y, color.z, part], *pixel);
    }

    /// A line of text below `top`, truncated at `width`.
    fn text(&mut self, left: f32, top: f32, size: f32, width: f32, text: &str) {
        let Ok(font) = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT) else {
            return;
        };
        let scaled = font.as_scaled(PxScale::from(size));
        let base = top + scaled.ascent();
        let mut x = left;
        let mut last: Option<GlyphId> = None;
        for character in text.chars() {
            let id = font.glyph_id(character);
            x += last.map_or(0.0, |last| scaled.kern(last, id));
            if x + scaled.h_advance(id) > left + width {
                return;
            }
            let glyph = id.with_scale_and_position(size, point(x, base));
            if let Some(outline) = font.outline_glyph(glyph) {
                let bounds = outline.px_bounds();
                outline.draw(|column, row, part| {
                    let at = (bounds.min.x + column as f32, bounds.min.y + row as f32);
                    if at.0 >= 0.0 && at.1 >= 0.0 {
                        self.cover(at.0 as u32, at.1 as u32, INK, part.clamp(0.0, 1.0));
                    }
                });
            }
            x += scaled.h_advance(id);
            last = Some(id);
        }
    }

    /// Composites the legend over a part of the picture: its 8-bit pixels row by row, and its colours in linear light
    /// with premultiplied alpha, if there are any.
    pub(crate) fn over(&self, part: Rect, pixels: &mut [[u8; 4]], colors: Option<&mut [[f32; 4]]>) {
        let top = self.rect.y.max(part.y);
        let bottom = self.rect.bottom().min(part.bottom());
        let left = self.rect.x.max(part.x);
        let right = self.rect.right().min(part.right());
        let mut colors = colors;
        for y in top..bottom {
            for x in left..right {
                let mine = (y - self.rect.y) as usize * self.rect.width as usize;
                let mine = self.pixels[mine + (x - self.rect.x) as usize];
                let at = (y - part.y) as usize * part.width as usize + (x - part.x) as usize;
                let pixel = &mut pixels[at];
                *pixel = srgb::encode_premultiplied(over(mine, srgb::decode_premultiplied(*pixel)));
                if let Some(color) = colors.as_mut().and_then(|colors| colors.get_mut(at)) {
                    *color = over(mine, *color);
                }
            }
        }
    }
}

/// One colour over another, with premultiplied alpha (Porter, Duff, "Compositing Digital Images", 1984).
fn over(above: [f32; 4], below: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|channel| above[channel] + below[channel] * (1.0 - above[3]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn legend(low: f64, high: f64) -> Legend {
        Legend {
            title: "height".to_owned(),
            scale: ColorScale {
                range: Some([low, high]),
                ..ColorScale::default()
            },
        }
    }

    #[test]
    fn marks_are_round_and_within() {
        let told = |low, high| -> Vec<String> {
            let marks = legend(low, high).marks();
            for (share, _) in &marks {
                assert!((0.0..=1.0).contains(share), "{low} {high} {share}");
            }
            marks.into_iter().map(|(_, text)| text).collect()
        };
        assert_eq!(told(0.0, 1.0), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(told(-3.0, 12.0), ["0", "5", "10"]);
        assert_eq!(
            told(1234.0, 1236.5),
            ["1234.0", "1234.5", "1235.0", "1235.5", "1236.0", "1236.5"]
        );
        assert_eq!(told(2.0, 2.0), ["2"]);
        assert!(told(1e-12, 3e-12).len() >= 3);
        assert!(told(-1e300, 1e300).len() >= 3);
    }

    #[test]
    fn a_legend_is_drawn_the_same_whole_and_in_parts() {
        assert_eq!(Legend::rect(200, 100), None);
        let rect = Legend::rect(640, 480).expect("it fits");
        let drawn = DrawnLegend::new(&legend(0.0, 1.0), 640, 480).expect("it fits");
        let whole = Rect {
            x: 0,
            y: 0,
            width: 640,
            height: 480,
        };
        let mut picture = vec![[9, 90, 200, 255]; whole.area()];
        drawn.over(whole, &mut picture, None);
        let changed =
            |pixels: &[[u8; 4]]| pixels.iter().filter(|p| **p != [9, 90, 200, 255]).count();
        assert_eq!(changed(&picture), rect.area());
        // The ends of the bar.
        let colors = ColorScale::default().map.colors();
        for end in [colors[0], colors[255]] {
            let [r, g, b] = end.0;
            assert!(picture.contains(&[r, g, b, 255]), "{end}");
        }
        let part = Rect {
            x: 500,
            y: 200,
            width: 140,
            height: 100,
        };
        let mut pixels = vec![[9, 90, 200, 255]; part.area()];
        drawn.over(part, &mut pixels, None);
        for (at, pixel) in pixels.iter().enumerate() {
            let (x, y) = (part.x as usize + at % 140, part.y as usize + at / 140);
            assert_eq!(*pixel, picture[y * 640 + x]);
        }
    }
}
