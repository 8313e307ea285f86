/// A part of a texture's image, in its pixels from the top left.
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

/// An sRGB image for a surface; rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    width: u32,
    height: u32,
    texels: Vec<[u8; 4]>,
}

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
        })
    }

    /// The part inside `crop`; `None` if that has no texel or leaves the image.
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
        Self::new(crop.width, crop.height, texels)
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The texels, row by row from the top.
    pub fn texels(&self) -> &[[u8; 4]] {
        &self.texels
    }
}
