use super::Wrap;
use std::sync::OnceLock;

/// A rectangle of a texture's image, in pixels from the top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// An sRGB image for surfaces, rows from the top.
///
/// Texture coordinates (u, v) are (0, 0) at the image's bottom left and (1, 1) at its top right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    width: u32,
    height: u32,
    texels: Vec<[u8; 4]>,
    wrap: [Wrap; 2],
    /// Whether it repeats along both axes, the common case.
    repeats: bool,
    crop: Option<Crop>,
    is_stand_in: bool,
    derived: Derived,
}

/// Columns, rows and checks of a side of what stands in for an image; the checks' colours.
const STAND_IN: (u32, u32) = (64, 8);
const CHECKS: [[u8; 4]; 2] = [[0xff, 0x00, 0xff, 0xff], [0x20, 0x20, 0x20, 0xff]];

/// What rendering computes of a texture and keeps. It follows from the texture and does not take part in comparisons.
#[derive(Clone, Debug, Default)]
struct Derived {
    levels: OnceLock<Vec<Texture>>,
    light: OnceLock<Vec<[f32; 4]>>,
    was_shown: OnceLock<()>,
}

impl PartialEq for Derived {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Eq for Derived {}

impl Texture {
    /// A texture of `width × height` sRGB texels, rows from the top.
    ///
    /// `None` if a side is zero or the count does not agree.
    pub fn new(width: u32, height: u32, texels: Vec<[u8; 4]>) -> Option<Self> {
        let agrees =
            width > 0 && height > 0 && texels.len() as u64 == u64::from(width) * u64::from(height);
        agrees.then_some(Self {
            width,
            height,
            texels,
            wrap: [Wrap::Repeat; 2],
            repeats: true,
            crop: None,
            is_stand_in: false,
            derived: Derived::default(),
        })
    }

    /// A checkerboard in the place of an image that could not be read, which has what was said of the image.
    pub fn stand_in(crop: Option<Crop>, wrap: [Wrap; 2]) -> Self {
        let (side, checks) = STAND_IN;
        let check = |at: u32| at * checks / side;
        let texel = |at: u32| CHECKS[((check(at % side) + check(at / side)) % 2) as usize];
        let image = Self {
            width: side,
            height: side,
            texels: (0..side * side).map(texel).collect(),
            wrap: [Wrap::Repeat; 2],
            repeats: true,
            crop,
            is_stand_in: true,
            derived: Derived::default(),
        };
        image.wrapped(wrap)
    }

    /// Whether it stands in for an image that could not be read.
    pub fn is_stand_in(&self) -> bool {
        self.is_stand_in
    }

    /// The same image with other wrapping along u and v.
    pub fn wrapped(self, wrap: [Wrap; 2]) -> Self {
        Self {
            wrap,
            repeats: wrap == [Wrap::Repeat; 2],
            derived: Derived::default(),
            ..self
        }
    }

    /// The part inside `crop`, as an image of its own: mapping, wrapping and filters see no other texel. `None` if
    /// the rectangle is empty or leaves the image.
    pub fn cropped(&self, crop: Crop) -> Option<Self> {
        let right = crop.x.checked_add(crop.width)?;
        let bottom = crop.y.checked_add(crop.height)?;
        if right > self.width || bottom > self.height {
            return None;
        }
        let texels = (crop.y..bottom)
            .flat_map(|y| {
                let row = y as usize * self.width as usize;
                &self.texels[row + crop.x as usize..row + right as usize]
            })
            .copied()
            .collect();
        let x = self.crop.map_or(0, |outer| outer.x);
        let y = self.crop.map_or(0, |outer| outer.y);
        Some(Self {
            wrap: self.wrap,
            repeats: self.repeats,
            crop: Some(Crop {
                x: x + crop.x,
                y: y + crop.y,
                ..crop
            }),
            ..Self::new(crop.width, crop.height, texels)?
        })
    }

    /// The mip levels; `make` computes them on first use.
    pub(crate) fn levels(&self, make: impl FnOnce(&Self) -> Vec<Self>) -> &[Self] {
        self.derived.levels.get_or_init(|| make(self))
    }

    /// The texels in linear light, if they were kept.
    #[inline]
    pub(crate) fn light(&self) -> Option<&[[f32; 4]]> {
        self.derived.light.get().map(Vec::as_slice)
    }

    /// Keeps the texels in linear light, which `decode` gives, from the second call on: for one picture it takes longer to
    /// decode all texels than those that are shown.
    pub(crate) fn keep_light(&self, decode: impl FnOnce(&Self) -> Vec<[f32; 4]>) {
        if self.derived.was_shown.set(()).is_err() {
            self.derived.light.get_or_init(|| decode(self));
        }
    }

    /// Columns and rows of the mip levels: halved and rounded down, to one texel.
    pub(crate) fn level_sizes(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let half = |&(width, height): &(u32, u32)| {
            (width.max(height) > 1).then_some(((width / 2).max(1), (height / 2).max(1)))
        };
        std::iter::successors(Some((self.width, self.height)), half).skip(1)
    }

    /// The bytes that the mip levels take once a filter needs them: a third of the image's, more for narrow images.
    pub fn level_bytes(&self) -> u64 {
        let texels = |(width, height)| u64::from(width) * u64::from(height);
        self.level_sizes().map(texels).sum::<u64>() * size_of::<[u8; 4]>() as u64
    }

    /// The bytes of its texels, and of its mip levels and the texels in linear light once they were computed.
    pub fn retained_bytes(&self) -> usize {
        let Derived { levels, light, .. } = &self.derived;
        let levels = levels.get().map_or(&[][..], Vec::as_slice);
        let light = light.get().map_or(&[][..], Vec::as_slice);
        size_of_val(&self.texels[..])
            + size_of_val(light)
            + levels.iter().map(Self::retained_bytes).sum::<usize>()
    }

    /// The rectangle of the file's image that it shows; `None` for the whole image.
    pub fn crop(&self) -> Option<Crop> {
        self.crop
    }

    /// Whether it repeats along both axes.
    #[inline]
    pub(crate) fn repeats(&self) -> bool {
        self.repeats
    }

    /// The wrapping along u and v.
    #[inline]
    pub fn wrap(&self) -> [Wrap; 2] {
        self.wrap
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The alpha of the texel at any column and row, wrapped: 255 for a border's colour, 0 for a border without one.
    pub(crate) fn alpha(&self, column: i64, row: i64) -> u8 {
        let [across, down] = self.wrap;
        match (
            across.texel(column, self.width),
            down.texel(row, self.height),
        ) {
            (Some(x), Some(y)) => self.texels[y as usize * self.width as usize + x as usize][3],
            (None, _) if across == Wrap::Border(None) => 0,
            (Some(_), None) if down == Wrap::Border(None) => 0,
            _ => u8::MAX,
        }
    }

    /// The column and the row from the top of the texel that shows at (u, v). `None` beyond a border, and where a
    /// coordinate is not finite.
    pub fn texel_at(&self, u: f64, v: f64) -> Option<(u32, u32)> {
        if !u.is_finite() || !v.is_finite() {
            return None;
        }
        let [across, down] = self.wrap;
        let x = across.near(u) * f64::from(self.width);
        let y = (1.0 - down.near(v)) * f64::from(self.height);
        // Within two sides of the image.
        let column = across.texel(x.floor() as i64, self.width)?;
        Some((column, down.texel(y.floor() as i64, self.height)?))
    }

    /// The texels, row by row from the top.
    pub fn texels(&self) -> &[[u8; 4]] {
        &self.texels
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Mesh, MeshData, Scene};
    use super::*;
    use std::sync::Arc;

    #[test]
    fn a_shared_textures_levels_are_counted_once() {
        let texture = |side: u32| {
            let texels = vec![[0; 4]; (side * side) as usize];
            Arc::new(Texture::new(side, side, texels).expect("a good texture"))
        };
        let (shared, own) = (texture(4), texture(2));
        let mut scene = Scene::from(Mesh::new(MeshData::default()));
        scene.objects = vec![scene.objects[0].clone(); 3];
        assert_eq!(scene.level_bytes(), 0);
        scene.objects[0].texture = Some(Arc::clone(&shared));
        scene.objects[1].texture = Some(shared);
        scene.objects[2].texture = Some(own);
        // 2 × 2 and 1 × 1 of the one, 1 × 1 of the other.
        assert_eq!(scene.level_bytes(), 4 * (4 + 1 + 1));
    }

    #[test]
    fn a_crop_of_a_crop_counts_the_files_pixels() {
        let texels = (0..12).map(|i| [i, 0, 0, 255]).collect();
        let whole = Texture::new(4, 3, texels).expect("a good texture");
        let wrap = [Wrap::Mirror, Wrap::Clamp];
        let crop = |x, y, width, height| Crop {
            x,
            y,
            width,
            height,
        };
        let outer = whole.wrapped(wrap).cropped(crop(1, 1, 3, 2));
        let outer = outer.expect("within");
        let inner = outer.cropped(crop(1, 0, 2, 1)).expect("within");
        assert_eq!(inner.texels(), [[6, 0, 0, 255], [7, 0, 0, 255]]);
        assert_eq!(inner.crop(), Some(crop(2, 1, 2, 1)));
        assert_eq!(inner.wrap(), wrap);
        assert_eq!(outer.cropped(crop(2, 0, 2, 1)), None);
        assert_eq!(outer.cropped(crop(0, 0, 0, 1)), None);
        assert_eq!(outer.cropped(crop(u32::MAX, 0, 2, 1)), None);
    }

    #[test]
    fn the_texel_at_a_point_is_wrapped_and_counted_from_the_top_left() {
        let whole = Texture::new(4, 2, vec![[0; 4]; 8]).expect("a good texture");
        let at = |wrap: Wrap, u: f64, v: f64| whole.clone().wrapped([wrap; 2]).texel_at(u, v);
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Border(None)] {
            assert_eq!(at(wrap, 0.01, 0.99), Some((0, 0)), "{wrap:?}");
            assert_eq!(at(wrap, 0.6, 0.2), Some((2, 1)), "{wrap:?}");
        }
        assert_eq!(at(Wrap::Repeat, -0.1, 5.2), Some((3, 1)));
        assert_eq!(at(Wrap::Mirror, -0.1, 1.2), Some((0, 0)));
        assert_eq!(at(Wrap::Clamp, 1e300, -7.0), Some((3, 1)));
        assert_eq!(at(Wrap::Border(None), 1.1, 0.5), None);
        assert_eq!(at(Wrap::Repeat, f64::NAN, 0.5), None);
    }
}
