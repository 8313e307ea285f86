//! OpenEXR, by the `exr` crate: one part with every layer of a picture as channels.
//!
//! `R G B A` are linear light with alpha multiplied in, as is the custom of EXR and of
//! [`Layers::color`]: what a fragment holds is stitched as it is.

use super::fragment::Place;
use super::png::MOST_EXPANSION;
use super::{ImageError, Layers, Picture};
use crate::camera::{PIXEL_LIMIT, Rect};
use crate::shade;
use ::exr::image::{Blocks, Encoding, FlatSamples, Image, Layer};
use ::exr::meta::MetaData;
use ::exr::meta::header::Header;
use ::exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Compression, ImageAttributes, IntegerBounds,
    LayerAttributes, LineOrder, ReadChannels, ReadLayers, Text, Vec2, WritableImage, read,
};
use std::io::Cursor;

/// The attribute that names a fragment's view.
const VIEW: &str = "raycast-view";

/// The channels of a picture.
const FLOATS: [&str; 10] = ["R", "G", "B", "A", "Z", "N.X", "N.Y", "N.Z", "uv.U", "uv.V"];
const INTEGERS: [&str; 2] = ["id.object", "id.triangle"];

/// Bytes a pixel, before compression.
const PIXEL_BYTES: u64 = 4 * (FLOATS.len() + INTEGERS.len()) as u64;

/// The bytes of an EXR. A fragment's data window is its rectangle within the full picture, which is
/// the display window.
pub(super) fn encode(picture: &Picture, place: Option<&Place>) -> Result<Vec<u8>, ImageError> {
    let layers = picture.layers.as_ref().ok_or(ImageError::NoLayers)?;
    let float = |name, value: &dyn Fn(usize) -> f32| {
        let values = (0..picture.pixels.len()).map(value).collect();
        AnyChannel::new(name, FlatSamples::F32(values))
    };
    let integer = |name, values: &[u32]| AnyChannel::new(name, FlatSamples::U32(values.to_vec()));
    let channels = AnyChannels::sort(
        [
            float("R", &|i| layers.color[i][0]),
            float("G", &|i| layers.color[i][1]),
            float("B", &|i| layers.color[i][2]),
            float("A", &|i| layers.color[i][3]),
            float("Z", &|i| layers.depth[i]),
            float("N.X", &|i| layers.normal[i][0]),
            float("N.Y", &|i| layers.normal[i][1]),
            float("N.Z", &|i| layers.normal[i][2]),
            float("uv.U", &|i| layers.uv[i][0]),
            float("uv.V", &|i| layers.uv[i][1]),
            integer("id.object", &layers.object),
            integer("id.triangle", &layers.triangle),
        ]
        .into_iter()
        .collect(),
    );
    let size = Vec2(picture.width as usize, picture.height as usize);
    let mut attributes = LayerAttributes::default();
    let mut shared = ImageAttributes::with_size(size);
    if let Some(place) = place {
        let (columns, rows) = place.full_size;
        shared.display_window =
            IntegerBounds::from_dimensions(Vec2(columns as usize, rows as usize));
        attributes.layer_position = Vec2(place.rect.x as i32, place.rect.y as i32);
        shared.other.insert(
            Text::from(VIEW),
            AttributeValue::Text(Text::from(format!("{:016x}", place.view).as_str())),
        );
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

/// The picture in an EXR's data window, and its place if it is a fragment.
pub(super) fn decode(bytes: &[u8]) -> Result<(Picture, Option<Place>), ImageError> {
    let failed = |error: ::exr::error::Error| ImageError::Decode(error.to_string());
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(failed)?;
    let [header] = meta.headers.as_slice() else {
        return Err(ImageError::Decode("expected one part".to_owned()));
    };
    let place = check(header, bytes.len())?;
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
        }) if values.len() == width * height => Ok(values.clone()),
        _ => Err(missing(name, "32-bit unsigned")),
    };
    let [r, g, b, a] = [floats("R")?, floats("G")?, floats("B")?, floats("A")?];
    let [x, y, z] = [floats("N.X")?, floats("N.Y")?, floats("N.Z")?];
    let [u, v] = [floats("uv.U")?, floats("uv.V")?];
    let all = 0..width * height;
    let layers = Layers {
        color: all.clone().map(|i| [r[i], g[i], b[i], a[i]]).collect(),
        depth: floats("Z")?.to_vec(),
        object: integers("id.object")?,
        triangle: integers("id.triangle")?,
        normal: all.clone().map(|i| [x[i], y[i], z[i]]).collect(),
        uv: all.map(|i| [u[i], v[i]]).collect(),
    };
    let picture = Picture {
        width: width as u32,
        height: height as u32,
        pixels: layers
            .color
            .iter()
            .map(|&color| shade::encode_premultiplied(color))
            .collect(),
        layers: Some(layers),
    };
    Ok((picture, place))
}

fn missing(name: &str, kind: &str) -> ImageError {
    ImageError::Decode(format!("expected a channel {name} of {kind} numbers"))
}

/// Refuses a header that does not tell of RayCast's channels, or tells of more pixels than so many
/// bytes can hold, before anything is made to hold them; answers with a fragment's place.
fn check(header: &Header, length: usize) -> Result<Option<Place>, ImageError> {
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
    let text = Text::from(VIEW);
    let view = header
        .shared_attributes
        .other
        .get(&text)
        .or_else(|| header.own_attributes.other.get(&text));
    let Some(view) = view else {
        return Ok(None);
    };
    let AttributeValue::Text(view) = view else {
        return Err(damaged("its view is not text"));
    };
    let view = u64::from_str_radix(&view.to_string(), 16)
        .map_err(|_| damaged("its view is not a hexadecimal number"))?;
    let window = header.shared_attributes.display_window;
    let Vec2(x, y) = header.own_attributes.layer_position;
    let (Ok(x), Ok(y), Vec2(0, 0)) = (u32::try_from(x), u32::try_from(y), window.position) else {
        return Err(damaged("its data window lies outside the picture"));
    };
    let side = |length: usize| {
        u32::try_from(length).map_err(|_| damaged("its display window is too large"))
    };
    Ok(Some(Place {
        full_size: (side(window.size.0)?, side(window.size.1)?),
        rect: Rect {
            x,
            y,
            width: side(width)?,
            height: side(height)?,
        },
        view,
    }))
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
