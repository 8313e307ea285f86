//! Writing OpenEXR, by the `exr` crate: one part with every layer of a picture as channels.
//!
//! `R G B A` are linear light with premultiplied alpha, as is customary in EXR and as in [`Layers::color`], so
//! fragments stitch without conversion.

use super::band::{Band, BandSizes, Source, length};
use super::buffers::reserved;
use super::file::Tags;
use super::{ImageError, Layers};
use crate::camera::Rect;
use ::exr::block::{BlockIndex, UncompressedBlock};
use ::exr::math::RoundingMode;
use ::exr::meta::attribute::{LevelMode, TileDescription};
use ::exr::meta::header::Header;
use ::exr::meta::{BlockDescription, MetaData, magic_number};
use ::exr::prelude::{
    AttributeValue, ChannelDescription, Compression, ImageAttributes, IntegerBounds,
    LayerAttributes, LineOrder, SampleType, Text, Vec2,
};
use rayon::prelude::*;

/// The attribute that stores a fragment's position.
pub(super) const FRAGMENT: &str = "raycast-fragment";

/// The attribute that stores a picture's recipe.
pub(super) const RECIPE: &str = "raycast-recipe";

/// The channels of a picture.
pub(super) const FLOATS: [&str; 10] =
    ["R", "G", "B", "A", "Z", "N.X", "N.Y", "N.Z", "uv.U", "uv.V"];
pub(super) const INTEGERS: [&str; 2] = ["id.object", "id.triangle"];

/// Bytes a pixel, before compression.
pub(super) const PIXEL_BYTES: u64 = 4 * (FLOATS.len() + INTEGERS.len()) as u64;

/// Columns and rows of a tile, for pictures that are too wide for blocks of rows: a band, which is a whole row of
/// tiles, then has few rows.
const TILE: Vec2<usize> = Vec2(128, 32);

/// The least number of rows of a band: two blocks of rows, or a row of tiles.
pub(super) const BAND_ROWS: u32 = 32;

/// An EXR in bands.
#[derive(Debug)]
pub(super) struct Banded {
    /// The header of the one part, as the crate writes it.
    header: Header,
    /// The bytes before the table of offsets.
    before: Vec<u8>,
}

impl Banded {
    /// A fragment's data window is its rectangle; the display window is the full picture.
    pub(super) fn new(
        (columns, rows): (u32, u32),
        is_tiled: bool,
        tags: Tags<'_>,
    ) -> Result<Self, ImageError> {
        let size = Vec2(columns as usize, rows as usize);
        let mut attributes = LayerAttributes::default();
        let mut shared = ImageAttributes::with_size(size);
        let text = |text: String| AttributeValue::Text(Text::from(text.as_str()));
        if let Some(recipe) = tags.recipe {
            let recipe = text(recipe.to_string());
            shared.other.insert(Text::from(RECIPE), recipe);
        }
        if let Some(position) = tags.position {
            // Fragment and recipe share one attribute list whose order would follow the crate's hash map, so only one
            // of them is stored there.
            let fragment = text(position.to_string());
            attributes.other.insert(Text::from(FRAGMENT), fragment);
            let (columns, rows) = position.full_size;
            shared.display_window =
                IntegerBounds::from_dimensions(Vec2(columns as usize, rows as usize));
            attributes.layer_position = Vec2(position.rect.x as i32, position.rect.y as i32);
        }
        let channel = |(name, kind)| ChannelDescription::named(name, kind);
        let floats = FLOATS.map(|name| (name, SampleType::F32));
        let integers = INTEGERS.map(|name| (name, SampleType::U32));
        let mut channels: Vec<_> = floats.into_iter().chain(integers).collect();
        channels.sort_by_key(|(name, _)| Text::from(*name));
        let blocks = if is_tiled {
            BlockDescription::Tiles(TileDescription {
                tile_size: TILE,
                level_mode: LevelMode::Singular,
                rounding_mode: RoundingMode::Down,
            })
        } else {
            BlockDescription::ScanLines
        };
        let channels = channels.into_iter().map(channel).collect();
        let header = Header::new(Text::from(""), size, channels)
            .with_encoding(Compression::ZIP16, blocks, LineOrder::Increasing)
            .with_attributes(attributes)
            .with_shared_attributes(shared);
        let headers = [header];
        let mut before = Vec::new();
        let write = |before: &mut Vec<u8>| {
            let needs = MetaData::validate(&headers, true)?;
            magic_number::write(before)?;
            needs.write(before)?;
            Header::write_all(&headers, before, needs.is_multilayer())
        };
        write(&mut before).map_err(failed)?;
        let [header] = headers;
        Ok(Self { header, before })
    }

    /// The bytes before the blocks, for blocks of these lengths; without blocks, a placeholder of the same length.
    pub(super) fn head(&self, lengths: &[u32]) -> Vec<u8> {
        let count = self.header.chunk_count;
        let mut head = self.before.clone();
        let mut next = (head.len() + 8 * count) as u64;
        for &length in lengths {
            head.extend(next.to_le_bytes());
            next += u64::from(length);
        }
        head.resize(self.before.len() + 8 * count, 0);
        head
    }

    /// Columns and rows of a block.
    fn block(&self) -> Vec2<usize> {
        self.header.max_block_pixel_size()
    }

    /// The number of blocks of a band.
    pub(super) fn blocks(&self, rect: Rect) -> usize {
        let Vec2(columns, rows) = self.block();
        (rect.width as usize).div_ceil(columns) * (rect.height as usize).div_ceil(rows)
    }

    /// The blocks of a band, row by row.
    pub(super) fn encode(&self, source: Source<'_>) -> Result<Band, ImageError> {
        let layers = source.picture.layers.as_ref().ok_or(ImageError::NoLayers)?;
        let Vec2(columns, rows) = self.block();
        let rect = source.rect;
        let across = (rect.width as usize).div_ceil(columns);
        let blocks: Vec<Vec<u8>> = (0..self.blocks(rect))
            .into_par_iter()
            .map(|block| {
                let (x, y) = (block % across * columns, block / across * rows);
                let part = Rect {
                    x: x as u32,
                    y: rect.y + y as u32,
                    width: columns.min(rect.width as usize - x) as u32,
                    height: rows.min(rect.height as usize - y) as u32,
                };
                self.compressed(part, self.values(part, source, layers)?)
            })
            .collect::<Result<_, ImageError>>()?;
        let parts = blocks
            .iter()
            .map(|block| length(block))
            .collect::<Result<_, _>>()?;
        Ok(Band {
            bytes: blocks.concat(),
            sizes: BandSizes { parts, check: 0 },
        })
    }

    /// A block's values: row by row, and within each row channel by channel.
    fn values(
        &self,
        part: Rect,
        source: Source<'_>,
        layers: &Layers,
    ) -> Result<Vec<u8>, ImageError> {
        let mut bytes: Vec<u8> = reserved(part.area() * PIXEL_BYTES as usize)?;
        for y in part.y..part.bottom() {
            let start = source.at(y) + part.x as usize;
            let all = start..start + part.width as usize;
            for channel in &self.header.channels.list {
                let mut floats = |value: &dyn Fn(usize) -> f32| {
                    bytes.extend(all.clone().flat_map(|i| value(i).to_ne_bytes()));
                };
                match channel.name.to_string().as_str() {
                    "R" => floats(&|i| layers.color[i][0]),
                    "G" => floats(&|i| layers.color[i][1]),
                    "B" => floats(&|i| layers.color[i][2]),
                    "A" => floats(&|i| layers.color[i][3]),
                    "Z" => floats(&|i| layers.depth[i]),
                    "N.X" => floats(&|i| layers.normal[i][0]),
                    "N.Y" => floats(&|i| layers.normal[i][1]),
                    "N.Z" => floats(&|i| layers.normal[i][2]),
                    "uv.U" => floats(&|i| layers.uv[i][0]),
                    "uv.V" => floats(&|i| layers.uv[i][1]),
                    "id.object" => {
                        bytes.extend(
                            layers.object[all.clone()]
                                .iter()
                                .flat_map(|n| n.to_ne_bytes()),
                        );
                    }
                    _ => {
                        bytes.extend(
                            layers.triangle[all.clone()]
                                .iter()
                                .flat_map(|n| n.to_ne_bytes()),
                        );
                    }
                }
            }
        }
        Ok(bytes)
    }

    /// A block as the file stores it.
    fn compressed(&self, part: Rect, data: Vec<u8>) -> Result<Vec<u8>, ImageError> {
        let index = BlockIndex {
            layer: 0,
            pixel_position: Vec2(part.x as usize, part.y as usize),
            pixel_size: Vec2(part.width as usize, part.height as usize),
            level: Vec2(0, 0),
        };
        let block = UncompressedBlock { index, data };
        let headers = std::slice::from_ref(&self.header);
        let mut bytes = Vec::new();
        block
            .compress_to_chunk(headers)
            .and_then(|chunk| chunk.write(&mut bytes, 1))
            .map_err(failed)?;
        Ok(bytes)
    }
}

fn failed(error: ::exr::error::Error) -> ImageError {
    ImageError::Encode(error.to_string())
}
