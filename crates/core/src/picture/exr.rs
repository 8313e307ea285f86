//! OpenEXR, by the `exr` crate: one part with every layer of a picture as channels.
//!
//! `R G B A` are linear light with alpha multiplied in, as is the custom of EXR and of
//! [`Layers::color`]: what a fragment holds is stitched as it is.

use super::buffers::collected;
use super::file::Tags;
use super::place::Place;
use super::png::MOST_EXPANSION;
use super::{ImageError, ImageFile, Layers, Picture, Recipe};
use crate::camera::PIXEL_LIMIT;
use crate::shade;
use ::exr::image::{Blocks, Encoding, FlatSamples, Image, Layer};
use ::exr::meta::MetaData;
use ::exr::meta::header::Header;
use ::exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Compression, ImageAttributes, IntegerBounds,
    LayerAttributes, LineOrder, ReadChannels, ReadLayers, Text, Vec2, WritableImage, read,
};
use std::io::Cursor;

/// The attribute that holds a fragment's place.
const FRAGMENT: &str = "raycast-fragment";

/// The attribute that holds a picture's recipe.
const RECIPE: &str = "raycast-recipe";

/// The channels of a picture.
const FLOATS: [&str; 10] = ["R", "G", "B", "A", "Z", "N.X", "N.Y", "N.Z", "uv.U", "uv.V"];
const INTEGERS: [&str; 2] = ["id.object", "id.triangle"];

/// Bytes a pixel, before compression.
const PIXEL_BYTES: u64 = 4 * (FLOATS.len() + INTEGERS.len()) as u64;

/// The bytes of an EXR. A fragment's data window is its rectangle within the full picture, which is
/// the display window.
pub(super) fn encode(picture: &Picture, tags: Tags<'_>) -> Result<Vec<u8>, ImageError> {
    let layers = picture.layers.as_ref().ok_or(ImageError::NoLayers)?;
    let float = |name, value: &dyn Fn(usize) -> f32| {
        let count = picture.pixels.len();
        let values = collected(count, (0..count).map(value))?;
        Ok::<_, ImageError>(AnyChannel::new(name, FlatSamples::F32(values)))
    };
    let integer = |name, values: &[u32]| {
        let values = collected(values.len(), values.iter().copied())?;
        Ok::<_, ImageError>(AnyChannel::new(name, FlatSamples::U32(values)))
    };
    let channels = AnyChannels::sort(
        [
            float("R", &|i| layers.color[i][0])?,
            float("G", &|i| layers.color[i][1])?,
            float("B", &|i| layers.color[i][2])?,
            float("A", &|i| layers.color[i][3])?,
            float("Z", &|i| layers.depth[i])?,
            float("N.X", &|i| layers.normal[i][0])?,
            float("N.Y", &|i| layers.normal[i][1])?,
            float("N.Z", &|i| layers.normal[i][2])?,
            float("uv.U", &|i| layers.uv[i][0])?,
            float("uv.V", &|i| layers.uv[i][1])?,
            integer("id.object", &layers.object)?,
            integer("id.triangle", &layers.triangle)?,
        ]
        .into_iter()
        .collect(),
    );
    let size = Vec2(picture.width as usize, picture.height as usize);
    let mut attributes = LayerAttributes::default();
    let mut shared = ImageAttributes::with_size(size);
    let mut tell = |name: &str, text: String| {
        let text = AttributeValue::Text(Text::from(text.as_str()));
        shared.other.insert(Text::from(name), text);
    };
    if let Some(recipe) = tags.recipe {
        tell(RECIPE, recipe.to_string());
    }
    if let Some(place) = tags.place {
        tell(FRAGMENT, place.to_string());
        let (columns, rows) = place.full_size;
        shared.display_window =
            IntegerBounds::from_dimensions(Vec2(columns as usize, rows as usize));
        attributes.layer_position = Vec2(place.rect.x as i32, place.rect.y as i32);
    }
    let image = Image {
        attributes: shared,
        layer_data: Layer::new(
            size,
            attributes,
            Encoding {
                compression: Compression::ZIP16,
                blocks: Blocks::ScanLines,
                line_order: LineOrder::Increasing,
            },
            channels,
        ),
    };
    let mut bytes = Cursor::new(Vec::new());
    image
        .write()
        .to_buffered(&mut bytes)
        .map_err(|error| ImageError::Encode(error.to_string()))?;
    Ok(bytes.into_inner())
}

/// The picture in an EXR's data window, and what else it tells.
pub(super) fn decode(bytes: &[u8]) -> Result<ImageFile, ImageError> {
    let failed = |error: ::exr::error::Error| ImageError::Decode(error.to_string());
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(failed)?;
    let [header] = meta.headers.as_slice() else {
        return Err(ImageError::Decode("expected one part".to_owned()));
    };
    check(header, bytes.len())?;
    let recipe: Option<Recipe> = text(header, RECIPE)?
        .as_deref()
        .map(str::parse)
        .transpose()?;
    let place = place(header)?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(failed)?;
    let Vec2(width, height) = image.layer_data.size;
    let channels = image.layer_data.channel_data.list;
    let floats = |name: &str| match channels.iter().find(|channel| channel.name.eq(name)) {
        Some(AnyChannel {
            sample_data: FlatSamples::F32(values),
            ..
        }) if values.len() == width * height => Ok(values.as_slice()),
        _ => Err(missing(name, "32-bit float")),
    };
    let integers = |name: &str| match channels.iter().find(|channel| channel.name.eq(name)) {
        Some(AnyChannel {
            sample_data: FlatSamples::U32(values),
            ..
        }) if values.len() == width * height => {
            Ok(collected(values.len(), values.iter().copied())?)
        }
        _ => Err(missing(name, "32-bit unsigned")),
    };
    let [r, g, b, a] = [floats("R")?, floats("G")?, floats("B")?, floats("A")?];
    let [x, y, z] = [floats("N.X")?, floats("N.Y")?, floats("N.Z")?];
    let [u, v] = [floats("uv.U")?, floats("uv.V")?];
    let count = width * height;
    let all = 0..count;
    let layers = Layers {
        color: collected(count, all.clone().map(|i| [r[i], g[i], b[i], a[i]]))?,
        depth: collected(count, floats("Z")?.iter().copied())?,
        object: integers("id.object")?,
        triangle: integers("id.triangle")?,
        normal: collected(count, all.clone().map(|i| [x[i], y[i], z[i]]))?,
        uv: collected(count, all.map(|i| [u[i], v[i]]))?,
    };
    let picture = Picture {
        width: width as u32,
        height: height as u32,
        pixels: collected(
            count,
            layers
                .color
                .iter()
                .map(|&color| shade::encode_premultiplied(color)),
        )?,
        layers: Some(layers),
    };
    ImageFile::checked(picture, recipe, place)
}

fn missing(name: &str, kind: &str) -> ImageError {
    ImageError::Decode(format!("expected a channel {name} of {kind} numbers"))
}

/// Refuses a header that does not tell of RayCast's channels, or tells of more pixels than so many
/// bytes can hold, before anything is made to hold them.
fn check(header: &Header, length: usize) -> Result<(), ImageError> {
    let damaged = |reason: &str| ImageError::Decode(reason.to_owned());
    if header.deep || header.blocks.has_tiles() {
        return Err(damaged("expected scan lines"));
    }
    if !matches!(
        header.compression,
        Compression::Uncompressed | Compression::RLE | Compression::ZIP1 | Compression::ZIP16
    ) {
        return Err(damaged("expected no compression, RLE or ZIP"));
    }
    let Vec2(width, height) = header.layer_size;
    let pixels = width as u64 * height as u64;
    if pixels > PIXEL_LIMIT || pixels * PIXEL_BYTES > length as u64 * MOST_EXPANSION {
        return Err(damaged("it tells of more pixels than it can hold"));
    }
    let channels = &header.channels.list;
    if channels.len() != FLOATS.len() + INTEGERS.len()
        || channels
            .iter()
            .any(|channel| channel.sampling != Vec2(1, 1))
    {
        return Err(damaged("expected RayCast's twelve channels"));
    }
    Ok(())
}

/// The text of an attribute of RayCast's own, where it is there.
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

/// A fragment's place, which must be that of the data window in the display window.
fn place(header: &Header) -> Result<Option<Place>, ImageError> {
    let Some(place) = text(header, FRAGMENT)? else {
        return Ok(None);
    };
    let place: Place = place.parse()?;
    let window = header.shared_attributes.display_window;
    let (columns, rows) = place.full_size;
    let Vec2(x, y) = header.own_attributes.layer_position;
    let agrees = window.position == Vec2(0, 0)
        && window.size == Vec2(columns as usize, rows as usize)
        && (i64::from(x), i64::from(y)) == (place.rect.x.into(), place.rect.y.into());
    if !agrees {
        return Err(ImageError::Decode(
            "its windows are not at the place that it tells".to_owned(),
        ));
    }
    Ok(Some(place))
}

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::fragment::tests::sample_picture;
    use super::*;

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
}
