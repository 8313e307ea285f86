//! Reading the OpenEXR that [`exr`](super::exr) writes, by the `exr` crate.

use super::exr::{FLOATS, FRAGMENT, INTEGERS, PIXEL_BYTES, RECIPE};
use super::fragment_position::FragmentPosition;
use super::image::DECODED_LIMIT;
use super::png::{MAX_EXPANSION, too_many};
use super::{ImageError, ImageFile, Picture, Recipe};
use crate::camera::{Rect, SIDE_LIMIT};
use crate::shade;
use ::exr::block::UncompressedBlock;
use ::exr::block::reader::{AllChunksReader, ChunksReader};
use ::exr::meta::BlockDescription;
use ::exr::meta::attribute::LevelMode;
use ::exr::meta::header::Header;
use ::exr::prelude::{AttributeValue, Compression, LineOrder, SampleType, Text, Vec2};
use std::io::{Cursor, Read, Seek};

/// Reads an EXR from the top, some rows at a time.
pub(super) struct Reader<R> {
    chunks: AllChunksReader<R>,
    size: (u32, u32),
    /// Columns and rows of a block.
    block: (u32, u32),
    /// Rows that were decoded and not yet returned, from the top.
    decoded: Picture,
    /// The row after the decoded ones.
    next: u32,
}

impl<R: Read + Seek> Reader<R> {
    /// Opens a file of `length` bytes.
    pub(super) fn open(read: R, length: u64) -> Result<Self, ImageError> {
        let reader = ::exr::block::read(read, false).map_err(damaged)?;
        let [header] = reader.headers() else {
            return Err(ImageError::Decode("expected one part".to_owned()));
        };
        check(header, length)?;
        // Checked to be within limits.
        let sides = |Vec2(columns, rows)| (columns as u32, rows as u32);
        let (size, block) = (
            sides(header.layer_size),
            sides(header.max_block_pixel_size()),
        );
        let chunks = reader.all_chunks(false).map_err(damaged)?;
        Ok(Self {
            chunks,
            size,
            block,
            decoded: Picture::try_blank(size.0, 0, true)?,
            next: 0,
        })
    }

    fn header(&self) -> &Header {
        &self.chunks.meta_data().headers[0]
    }

    /// Columns and rows.
    pub(super) fn size(&self) -> (u32, u32) {
        self.size
    }

    /// The picture's recipe, where the file stores it.
    pub(super) fn recipe(&self) -> Result<Option<Recipe>, ImageError> {
        let text = text(self.header(), RECIPE)?;
        text.as_deref().map(str::parse).transpose()
    }

    /// A fragment's position; `None` for a whole picture.
    pub(super) fn position(&self) -> Result<Option<FragmentPosition>, ImageError> {
        position(self.header())
    }

    /// The next rows; the file must have them.
    pub(super) fn rows(&mut self, rows: u32) -> Result<Picture, ImageError> {
        let (columns, height) = self.size;
        if self.decoded.height == rows {
            let empty = Picture::try_blank(columns, 0, true)?;
            return Ok(std::mem::replace(&mut self.decoded, empty));
        }
        if self.decoded.height == 0 && rows == self.block.1.min(height - self.next.min(height)) {
            return self.decode();
        }
        let mut picture = Picture::try_blank(columns, rows, true)?;
        let mut done = 0;
        while done < rows {
            if self.decoded.height == 0 {
                self.decoded = self.decode()?;
            }
            let taken = self.decoded.height.min(rows - done);
            let rest = self.decoded.split_off_rows(taken)?;
            let top = std::mem::replace(&mut self.decoded, rest);
            let rect = Rect {
                x: 0,
                y: done,
                width: columns,
                height: taken,
            };
            picture.paste(rect, &top.pixels, top.layers.as_ref());
            done += taken;
        }
        Ok(picture)
    }

    /// Decodes the next blocks that lie side by side.
    fn decode(&mut self) -> Result<Picture, ImageError> {
        let (columns, rows) = self.size;
        let height = self.block.1.min(rows - self.next.min(rows));
        if height == 0 {
            return Err(ImageError::Decode(
                "it has fewer rows than it declares".to_owned(),
            ));
        }
        let mut picture = Picture::try_blank(columns, height, true)?;
        for x in (0..columns).step_by(self.block.0.max(1) as usize) {
            let expected =
                || ImageError::Decode("expected its blocks in order, from the top".to_owned());
            let chunk = self.chunks.next().ok_or_else(expected)?.map_err(damaged)?;
            let meta = self.chunks.meta_data();
            let block = UncompressedBlock::decompress_chunk(chunk, meta, false).map_err(damaged)?;
            if block.index.pixel_position != Vec2(x as usize, self.next as usize) {
                return Err(expected());
            }
            fill(&mut picture, self.next, &block, self.header());
        }
        self.next += height;
        if let Some(layers) = &picture.layers {
            for (pixel, &color) in picture.pixels.iter_mut().zip(&layers.color) {
                *pixel = shade::encode_premultiplied(color);
            }
        }
        Ok(picture)
    }
}

/// Copies a block's values into a picture that starts with row `first`.
fn fill(picture: &mut Picture, first: u32, block: &UncompressedBlock, header: &Header) {
    let width = picture.width as usize;
    let Some(layers) = &mut picture.layers else {
        return;
    };
    for line in block.lines(&header.channels) {
        let Vec2(x, y) = line.location.position;
        let start = (y - first as usize) * width + x;
        let at = start..start + line.location.sample_count;
        // Four bytes each: the header was checked to have no other channels.
        let values = line.value.as_chunks::<4>().0.iter();
        let floats = values.clone().map(|&bytes| f32::from_ne_bytes(bytes));
        let numbers = values.map(|&bytes| u32::from_ne_bytes(bytes));
        let name = header.channels.list[line.location.channel].name.to_string();
        let color = match name.as_str() {
            "R" => 0,
            "G" => 1,
            "B" => 2,
            _ => 3,
        };
        let axis = match name.as_str() {
            "N.X" | "uv.U" => 0,
            "N.Y" | "uv.V" => 1,
            _ => 2,
        };
        match name.as_str() {
            "R" | "G" | "B" | "A" => {
                (layers.color[at].iter_mut().zip(floats)).for_each(|(to, value)| to[color] = value);
            }
            "N.X" | "N.Y" | "N.Z" => {
                (layers.normal[at].iter_mut().zip(floats)).for_each(|(to, value)| to[axis] = value);
            }
            "uv.U" | "uv.V" => {
                (layers.uv[at].iter_mut().zip(floats)).for_each(|(to, value)| to[axis] = value);
            }
            "Z" => (layers.depth[at].iter_mut().zip(floats)).for_each(|(to, value)| *to = value),
            "id.object" => {
                (layers.object[at].iter_mut().zip(numbers)).for_each(|(to, value)| *to = value);
            }
            _ => (layers.triangle[at].iter_mut().zip(numbers)).for_each(|(to, value)| *to = value),
        }
    }
}

fn damaged(error: ::exr::error::Error) -> ImageError {
    ImageError::Decode(error.to_string())
}

/// The picture in an EXR's data window, with recipe and position.
pub(super) fn decode(bytes: &[u8]) -> Result<ImageFile, ImageError> {
    let mut reader = Reader::open(Cursor::new(bytes), bytes.len() as u64)?;
    let (columns, rows) = reader.size();
    if u64::from(columns) * u64::from(rows) > DECODED_LIMIT {
        return Err(too_many());
    }
    let (recipe, position) = (reader.recipe()?, reader.position()?);
    let picture = reader.rows(rows)?;
    ImageFile::checked(picture, recipe, position)
}

/// Refuses a header without RayCast's channels, or with more pixels than a file of `length` bytes can hold, before
/// memory is allocated for them.
fn check(header: &Header, length: u64) -> Result<(), ImageError> {
    let damaged = |reason: &str| ImageError::Decode(reason.to_owned());
    if header.deep || header.line_order == LineOrder::Decreasing {
        return Err(damaged("expected scan lines or tiles from the top"));
    }
    if let BlockDescription::Tiles(tiles) = header.blocks
        && tiles.level_mode != LevelMode::Singular
    {
        return Err(damaged("expected one resolution"));
    }
    if !matches!(
        header.compression,
        Compression::Uncompressed | Compression::RLE | Compression::ZIP1 | Compression::ZIP16
    ) {
        return Err(damaged("expected no compression, RLE or ZIP"));
    }
    let Vec2(width, height) = header.layer_size;
    let pixels = width as u64 * height as u64;
    let is_side = |side: usize| (1..=SIDE_LIMIT as usize).contains(&side);
    if !is_side(width)
        || !is_side(height)
        || pixels * PIXEL_BYTES > length.saturating_mul(MAX_EXPANSION)
    {
        return Err(too_many());
    }
    let channels = &header.channels.list;
    if channels.len() != FLOATS.len() + INTEGERS.len()
        || channels
            .iter()
            .any(|channel| channel.sampling != Vec2(1, 1))
    {
        return Err(damaged("expected RayCast's twelve channels"));
    }
    let is_there = |name: &str, kind| {
        let mut list = channels.iter();
        list.any(|channel| channel.name.eq(name) && channel.sample_type == kind)
    };
    if let Some(name) = FLOATS.iter().find(|name| !is_there(name, SampleType::F32)) {
        return Err(missing(name, "32-bit float"));
    }
    if let Some(name) = INTEGERS
        .iter()
        .find(|name| !is_there(name, SampleType::U32))
    {
        return Err(missing(name, "32-bit unsigned"));
    }
    Ok(())
}

fn missing(name: &str, kind: &str) -> ImageError {
    ImageError::Decode(format!("expected a channel {name} of {kind} numbers"))
}

/// The text of one of RayCast's own attributes, if present.
fn text(header: &Header, name: &str) -> Result<Option<String>, ImageError> {
    let name = Text::from(name);
    let shared = &header.shared_attributes.other;
    match shared
        .get(&name)
        .or_else(|| header.own_attributes.other.get(&name))
    {
        None => Ok(None),
        Some(AttributeValue::Text(text)) => Ok(Some(text.to_string())),
        Some(_) => Err(ImageError::Decode(format!("its {name} is not text"))),
    }
}

/// A fragment's position, which must be that of the data window in the display window.
fn position(header: &Header) -> Result<Option<FragmentPosition>, ImageError> {
    let Some(position) = text(header, FRAGMENT)? else {
        return Ok(None);
    };
    let position: FragmentPosition = position.parse()?;
    let window = header.shared_attributes.display_window;
    let (columns, rows) = position.full_size;
    let Vec2(x, y) = header.own_attributes.layer_position;
    let agrees = window.position == Vec2(0, 0)
        && window.size == Vec2(columns as usize, rows as usize)
        && (i64::from(x), i64::from(y)) == (position.rect.x.into(), position.rect.y.into());
    if !agrees {
        return Err(ImageError::Decode(
            "its windows are not at the position that it declares".to_owned(),
        ));
    }
    Ok(Some(position))
}

#[cfg(test)]
mod tests {
    use super::super::fragment::tests::sample_picture;
    use super::super::recipe::tests::sample_recipe;
    use super::super::{Format, Fragment};
    use super::*;
    use ::exr::meta::MetaData;

    #[test]
    fn comes_back_exactly() {
        for (width, height) in [(37, 41), (1, 1), (5, 16)] {
            let picture = sample_picture(width, height, true);
            let bytes = picture.encode(Format::Exr).expect("encodes");
            assert_eq!(bytes, picture.encode(Format::Exr).expect("encodes"));
            assert_eq!(Picture::decode_exr(&bytes).expect("decodes"), picture);
        }
    }

    #[test]
    fn misses_are_infinity_and_the_last_number() {
        let bytes = Picture::blank(3, 2, true)
            .encode(Format::Exr)
            .expect("encodes");
        let back = Picture::decode_exr(&bytes).expect("decodes");
        assert_eq!(back, Picture::blank(3, 2, true));
        let layers = back.layers.expect("an EXR has layers");
        assert_eq!(layers.depth[0], f32::INFINITY);
        assert_eq!((layers.object[5], layers.triangle[5]), (u32::MAX, u32::MAX));
    }

    #[test]
    fn channels_have_their_names() {
        let bytes = sample_picture(4, 4, true)
            .encode(Format::Exr)
            .expect("encodes");
        let meta = MetaData::read_from_buffered(Cursor::new(&bytes), true).expect("reads");
        let names: Vec<_> = meta.headers[0]
            .channels
            .list
            .iter()
            .map(|channel| channel.name.to_string())
            .collect();
        let expected = "A B G N.X N.Y N.Z R Z id.object id.triangle uv.U uv.V";
        assert_eq!(names.join(" "), expected);
    }

    #[test]
    fn damage_is_an_error() {
        let bytes = sample_picture(9, 20, true)
            .encode(Format::Exr)
            .expect("encodes");
        for length in 0..bytes.len() {
            assert!(Picture::decode_exr(&bytes[..length]).is_err(), "{length}");
        }
        for at in 0..bytes.len() {
            for flip in [0xff, 0x01, 0x80] {
                let mut damaged = bytes.clone();
                damaged[at] ^= flip;
                let _ = Picture::decode_exr(&damaged);
            }
        }
    }

    #[test]
    fn a_fragments_bytes_are_the_same_each_time() {
        let picture = sample_picture(9, 7, true);
        let fragment = Fragment {
            rect: Rect {
                x: 3,
                y: 2,
                width: 9,
                height: 7,
            },
            recipe: sample_recipe(20, 10),
            picture,
        };
        let bytes = fragment.encode(Format::Exr).expect("encodes");
        for _ in 0..20 {
            assert!(fragment.encode(Format::Exr).expect("encodes") == bytes);
        }
        let back = Fragment::decode("a", &bytes).expect("decodes");
        assert_eq!(back, fragment);
    }
}
