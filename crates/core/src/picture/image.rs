use super::buffers::filled;
use super::{ImageError, OutOfMemory};
use crate::camera::Rect;

/// The most pixels of a file that is decoded at once.
pub(super) const DECODED_LIMIT: u64 = 1 << 30;

/// What a picture stores for each pixel besides its 8-bit colour: row by row, one value a pixel.
///
/// Colours are averaged over a pixel's samples; everything else belongs to the first sample, at the pixel's centre.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layers {
    /// Linear light with premultiplied alpha, as EXR stores it: the weighted mean of the samples. It is unclamped,
    /// except with a pixel filter that has negative weights: then alpha is clamped to 0 to 1, and colours to 0 to
    /// alpha.
    pub color: Vec<[f32; 4]>,
    /// Distance from the eye (orthographic: from the image plane); infinity at a miss.
    pub depth: Vec<f32>,
    /// The object's number; `u32::MAX` at a miss.
    pub object: Vec<u32>,
    /// The triangle's number in its object's mesh; `u32::MAX` at a miss.
    pub triangle: Vec<u32>,
    /// The unit normal in world space, towards the eye; zero at a miss.
    pub normal: Vec<[f32; 3]>,
    /// Texture coordinates; zero at a miss and where there are none.
    pub uv: Vec<[f32; 2]>,
}

impl Layers {
    /// Layers of `pixels` misses.
    pub fn blank(pixels: usize) -> Self {
        Self {
            color: vec![[0.0; 4]; pixels],
            depth: vec![f32::INFINITY; pixels],
            object: vec![u32::MAX; pixels],
            triangle: vec![u32::MAX; pixels],
            normal: vec![[0.0; 3]; pixels],
            uv: vec![[0.0; 2]; pixels],
        }
    }

    /// Makes room for so many pixels; their values are unspecified.
    pub(crate) fn resize(&mut self, pixels: usize) {
        self.color.resize(pixels, [0.0; 4]);
        self.depth.resize(pixels, f32::INFINITY);
        self.object.resize(pixels, u32::MAX);
        self.triangle.resize(pixels, u32::MAX);
        self.normal.resize(pixels, [0.0; 3]);
        self.uv.resize(pixels, [0.0; 2]);
    }

    /// [`Layers::blank`], where memory suffices.
    fn try_blank(pixels: usize) -> Result<Self, OutOfMemory> {
        Ok(Self {
            color: filled([0.0; 4], pixels)?,
            depth: filled(f32::INFINITY, pixels)?,
            object: filled(u32::MAX, pixels)?,
            triangle: filled(u32::MAX, pixels)?,
            normal: filled([0.0; 3], pixels)?,
            uv: filled([0.0; 2], pixels)?,
        })
    }

    /// The length of each layer.
    pub(super) fn lengths(&self) -> [usize; 6] {
        [
            self.color.len(),
            self.depth.len(),
            self.object.len(),
            self.triangle.len(),
            self.normal.len(),
            self.uv.len(),
        ]
    }
}

/// A picture in memory, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// sRGB with straight (not premultiplied) alpha.
    pub pixels: Vec<[u8; 4]>,
    /// The layers, if they were requested.
    pub layers: Option<Layers>,
}

impl Picture {
    /// Whether there are as many pixels as the sides say, and at least one.
    pub(super) fn check(&self) -> Result<(), ImageError> {
        let pixels = self.width as usize * self.height as usize;
        let layers_agree = self
            .layers
            .as_ref()
            .is_none_or(|layers| layers.lengths().iter().all(|&count| count == pixels));
        if pixels == 0 {
            Err(ImageError::Encode("it has no pixels".to_owned()))
        } else if self.pixels.len() != pixels || !layers_agree {
            Err(ImageError::Encode(format!(
                "it should have {} x {} pixels in every layer",
                self.width, self.height
            )))
        } else {
            Ok(())
        }
    }

    /// A transparent picture of misses.
    pub fn blank(width: u32, height: u32, layers: bool) -> Self {
        let pixels = width as usize * height as usize;
        Self {
            width,
            height,
            pixels: vec![[0; 4]; pixels],
            layers: layers.then(|| Layers::blank(pixels)),
        }
    }

    /// [`Picture::blank`], where memory suffices.
    ///
    /// # Errors
    /// An allocation that failed.
    pub fn try_blank(width: u32, height: u32, layers: bool) -> Result<Self, OutOfMemory> {
        let pixels = width as usize * height as usize;
        let layers = layers.then(|| Layers::try_blank(pixels)).transpose()?;
        Ok(Self {
            width,
            height,
            pixels: filled([0; 4], pixels)?,
            layers,
        })
    }

    /// Splits the picture below the first `rows` rows, which stay, and returns the rest. `rows` ≤
    /// [`Picture::height`].
    pub(super) fn split_off_rows(&mut self, rows: u32) -> Result<Self, OutOfMemory> {
        let at = self.width as usize * rows as usize;
        let mut rest = Self::try_blank(self.width, self.height - rows, self.layers.is_some())?;
        rest.pixels.copy_from_slice(&self.pixels[at..]);
        self.pixels.truncate(at);
        if let (Some(from), Some(to)) = (&mut self.layers, &mut rest.layers) {
            let count = to.depth.len();
            to.all().copy(0, from, at, count);
            from.resize(at);
        }
        self.height = rows;
        Ok(rest)
    }

    /// Copies a rectangle's pixels (and layers, where both have them) into the picture.
    ///
    /// Returns `false`, without copying, where the rectangle leaves the picture or a list has a wrong length.
    pub fn paste(&mut self, rect: Rect, pixels: &[[u8; 4]], layers: Option<&Layers>) -> bool {
        let fits = u64::from(rect.x) + u64::from(rect.width) <= u64::from(self.width)
            && u64::from(rect.y) + u64::from(rect.height) <= u64::from(self.height);
        if !fits || !have_pixels(rect, pixels, layers) {
            return false;
        }
        let columns = rect.width as usize;
        let rows = (rect.y..rect.bottom()).map(|y| y as usize * self.width as usize);
        let rows = rows.map(|first| first + rect.x as usize).enumerate();
        for (row, begin) in rows.clone() {
            let pixels = &pixels[row * columns..][..columns];
            self.pixels[begin..begin + columns].copy_from_slice(pixels);
        }
        if let (Some(mine), Some(theirs)) = (&mut self.layers, layers) {
            let mut mine = mine.all();
            for (row, begin) in rows {
                mine.copy(begin, theirs, row * columns, columns);
            }
        }
        true
    }
}

/// Whether lists have as many values as a rectangle has pixels.
pub(super) fn have_pixels(rect: Rect, pixels: &[[u8; 4]], layers: Option<&Layers>) -> bool {
    let mut lengths = layers.iter().flat_map(|layers| layers.lengths());
    pixels.len() == rect.area() && lengths.all(|count| count == rect.area())
}
