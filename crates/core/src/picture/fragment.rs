use super::file::Tags;
use super::fragment_position::{FragmentPosition, check_rect, check_size};
use super::gaps::Gaps;
use super::{Bands, Format, ImageError, ImageFile, OutOfMemory, Picture, Recipe, png};
use crate::camera::Rect;
use crate::digest::Digest;

/// What is wrong with a whole picture.
pub(super) const NO_POSITION: &str = "it does not say its position in a larger picture";

/// A tile in a file of its own, with all that stitching needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Fragment {
    /// The fragment's rectangle in the full picture.
    pub rect: Rect,
    /// The recipe of the full picture: fragments of different recipes do not stitch.
    pub recipe: Recipe,
    /// The rectangle's own pixels, and layers if it has them.
    pub picture: Picture,
}

/// Why fragments cannot be read or stitched.
#[derive(Debug, thiserror::Error)]
pub enum FragmentError {
    /// A file that is no fragment, or damaged.
    #[error(
        "{name}: expected a fragment (a PNG or EXR that `raycast render --sub-camera` wrote): {reason}"
    )]
    NotAFragment {
        /// The file's name.
        name: String,
        /// What was found instead.
        reason: String,
    },
    /// An allocation that failed.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
    /// No fragments.
    #[error("there are no fragments to stitch")]
    None,
    /// A fragment of another picture.
    #[error("{name} does not belong with {first}: {reason}")]
    Different {
        /// The file's name.
        name: String,
        /// The name of the first file.
        first: String,
        /// What differs.
        reason: String,
    },
    /// Two fragments that overlap.
    #[error("{name} and {other} both hold pixel ({x}, {y}){}", also(gaps))]
    Overlap {
        /// The file's name.
        name: String,
        /// The name of the file that came before it.
        other: String,
        /// The first column that both contain.
        x: u32,
        /// The first row that both contain.
        y: u32,
        /// The pixels that no fragment contains: one of the two may be at the wrong position.
        gaps: Gaps,
    },
    /// Pixels that no fragment contains.
    #[error("{0}")]
    Gap(Gaps),
}

/// What is missing as well.
fn also(gaps: &Gaps) -> String {
    match gaps.is_empty() {
        true => String::new(),
        false => format!(", and {gaps}"),
    }
}

impl Fragment {
    /// The bytes of a PNG or EXR file whose text chunks or attributes store its position, the [`Recipe`] of the full
    /// picture, and a checksum of the pixels.
    ///
    /// # Errors
    /// Other formats, which cannot store fragments; a rectangle outside the full picture; errors of the encoder.
    pub fn encode(&self, format: Format) -> Result<Vec<u8>, ImageError> {
        self.picture.check()?;
        check_size(self.rect, (self.picture.width, self.picture.height))
            .map_err(ImageError::Encode)?;
        let bands = Bands::of_fragment(format, self.rect, &self.recipe)?;
        if format == Format::Exr || format.is_banded(self.rect.width, self.rect.height) {
            return bands.encode_all(&self.picture);
        }
        let position = FragmentPosition {
            full_size: self.full_size(),
            rect: self.rect,
            recipe: self.recipe.digest(),
            // A PNG stores no layers.
            pixels: Digest::of(self.picture.pixels.as_flattened()),
        };
        let tags = Tags {
            recipe: Some(&self.recipe),
            position: Some(&position),
        };
        png::encode(&self.picture, tags)
    }

    /// Decodes what [`Fragment::encode`] made. `name` is used in errors.
    ///
    /// # Errors
    /// Bytes that are no fragment, or whose pixels, position or recipe do not match their checksums.
    pub fn decode(name: &str, bytes: &[u8]) -> Result<Self, FragmentError> {
        let not_a_fragment = |reason: String| FragmentError::NotAFragment {
            name: name.to_owned(),
            reason,
        };
        let ImageFile {
            picture,
            recipe,
            position,
        } = ImageFile::decode(bytes).map_err(|error| not_a_fragment(error.to_string()))?;
        let (Some(position), Some(recipe)) = (position, recipe) else {
            return Err(not_a_fragment(NO_POSITION.to_owned()));
        };
        let fragment = Self {
            rect: position.rect,
            recipe,
            picture,
        };
        fragment.check_position().map_err(not_a_fragment)?;
        Ok(fragment)
    }

    /// Whether it lies inside its full picture.
    pub(super) fn check_position(&self) -> Result<(), String> {
        check_size(self.rect, (self.picture.width, self.picture.height))?;
        check_rect(self.full_size(), self.rect)
    }

    /// Columns and rows of the full picture.
    pub fn full_size(&self) -> (u32, u32) {
        let plane = self.recipe.camera.plane();
        (plane.columns, plane.rows)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::camera::Grid;
    use crate::picture::recipe::tests::sample_recipe;
    use crate::picture::{Layers, PixelDigest, bands};
    use crate::shade::{self, Mode};

    /// A picture in which every channel differs from pixel to pixel, with misses and half transparent pixels.
    pub(in crate::picture) fn sample_picture(width: u32, height: u32, layers: bool) -> Picture {
        let mut picture = Picture::blank(width, height, true);
        if let Some(all) = &mut picture.layers {
            fill(all);
            for (pixel, color) in picture.pixels.iter_mut().zip(&all.color) {
                *pixel = shade::encode_premultiplied(*color);
            }
        }
        if !layers {
            picture.layers = None;
        }
        picture
    }

    fn fill(layers: &mut Layers) {
        for i in 0..layers.depth.len() {
            if i % 5 == 0 {
                continue;
            }
            let value = |salt: u32| {
                let bits = (i as u32 + salt).wrapping_mul(0x9e37_79b9) >> 8;
                bits as f32 / (1 << 24) as f32
            };
            let alpha = if i % 3 == 0 { value(1) } else { 1.0 };
            layers.color[i] = [value(2) * alpha, value(3) * alpha, value(4) * alpha, alpha];
            layers.depth[i] = value(5) * 1e3;
            layers.object[i] = i as u32;
            layers.triangle[i] = u32::MAX - i as u32;
            layers.normal[i] = [value(6) - 0.5, value(7) - 0.5, value(8) - 0.5];
            layers.uv[i] = [value(9) * 10.0, -value(10)];
        }
    }

    pub(in crate::picture) fn cut<T: Copy>(values: &[T], width: u32, rect: Rect) -> Vec<T> {
        (rect.y..rect.bottom())
            .flat_map(|y| (rect.x..rect.right()).map(move |x| values[(y * width + x) as usize]))
            .collect()
    }

    /// A rectangle of a picture.
    pub(in crate::picture) fn cut_picture(picture: &Picture, rect: Rect) -> Picture {
        let width = picture.width;
        Picture {
            width: rect.width,
            height: rect.height,
            pixels: cut(&picture.pixels, width, rect),
            layers: picture.layers.as_ref().map(|layers| Layers {
                color: cut(&layers.color, width, rect),
                depth: cut(&layers.depth, width, rect),
                object: cut(&layers.object, width, rect),
                triangle: cut(&layers.triangle, width, rect),
                normal: cut(&layers.normal, width, rect),
                uv: cut(&layers.uv, width, rect),
            }),
        }
    }

    /// The fragments of a picture, after encoding and decoding.
    pub(in crate::picture) fn fragments(
        picture: &Picture,
        grid: Grid,
        format: Format,
    ) -> Vec<(String, Fragment)> {
        let width = picture.width;
        grid.tiles(width, picture.height)
            .into_iter()
            .enumerate()
            .map(|(index, rect)| {
                let fragment = Fragment {
                    rect,
                    recipe: sample_recipe(width, picture.height),
                    picture: cut_picture(picture, rect),
                };
                let name = format!("part-{index}");
                let bytes = fragment.encode(format).expect("encodes");
                let back = Fragment::decode(&name, &bytes).expect("decodes");
                assert_eq!(back, fragment);
                (name, back)
            })
            .collect()
    }

    pub(in crate::picture) fn three_by_two() -> Grid {
        Grid::Count {
            columns: 3,
            rows: 2,
        }
    }

    fn reader(bytes: &[u8]) -> ::png::Reader<std::io::Cursor<&[u8]>> {
        let mut decoder = ::png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(::png::Transformations::IDENTITY);
        decoder.read_info().expect("a PNG")
    }

    /// The samples of a PNG.
    fn samples(bytes: &[u8]) -> Vec<u8> {
        let mut reader = reader(bytes);
        let mut samples = vec![0; reader.output_buffer_size().expect("a size")];
        reader.next_frame(&mut samples).expect("a PNG");
        samples
    }

    /// A PNG whose samples were changed, and PNG's own checksums corrected.
    fn repainted(bytes: &[u8], change: impl Fn(&mut [u8])) -> Vec<u8> {
        let mut samples = samples(bytes);
        change(&mut samples);
        let info = reader(bytes).info().clone();
        let mut changed = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut changed, info.width, info.height);
        encoder.set_color(info.color_type);
        encoder.set_depth(info.bit_depth);
        for chunk in &info.uncompressed_latin1_text {
            let (keyword, text) = (chunk.keyword.clone(), chunk.text.clone());
            encoder.add_text_chunk(keyword, text).expect("text");
        }
        let mut writer = encoder.write_header().expect("writes");
        writer.write_image_data(&samples).expect("writes");
        writer.finish().expect("writes");
        changed
    }

    #[test]
    fn a_pixel_that_was_changed_is_found() {
        let whole = sample_picture(12, 10, true);
        let expected = "its pixels are not those that were written";
        let parts = fragments(&whole, three_by_two(), Format::Exr);
        // As a PNG, with valid PNG checksums.
        let png = parts[1].1.encode(Format::Png).expect("encodes");
        assert!(Fragment::decode("part", &png).is_ok());
        let damaged = repainted(&png, |samples| samples[5] ^= 1);
        let error = Fragment::decode("part", &damaged).expect_err("it was repainted");
        assert!(error.to_string().contains(expected), "{error}");
        // As an EXR: each channel counts.
        let changes: [fn(&mut Layers); 7] = [
            |layers| layers.color[3][1] += 1e-7,
            |layers| layers.color[3][3] *= 0.5,
            |layers| layers.depth[3] += 1.0,
            |layers| layers.object[3] ^= 1,
            |layers| layers.triangle[3] ^= 1,
            |layers| layers.normal[3][2] = -layers.normal[3][2],
            |layers| layers.uv[3][0] += 1.0,
        ];
        for change in changes {
            let fragment = &parts[1].1;
            let position = FragmentPosition {
                full_size: fragment.full_size(),
                rect: fragment.rect,
                recipe: fragment.recipe.digest(),
                pixels: PixelDigest::of(&fragment.picture),
            };
            let mut picture = fragment.picture.clone();
            change(picture.layers.as_mut().expect("layers"));
            let tags = Tags {
                recipe: Some(&fragment.recipe),
                position: Some(&position),
            };
            let bytes = bands::encode(&picture, Format::Exr, tags).expect("encodes");
            let error = Fragment::decode("part", &bytes).expect_err("it was repainted");
            assert!(error.to_string().contains(expected), "{error}");
        }
    }

    /// PNG's checksum of a chunk's name and data (PNG specification, annex D).
    fn crc(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(u32::MAX, |mut crc, &byte| {
            crc ^= u32::from(byte);
            for _ in 0..8 {
                crc = if crc & 1 == 1 {
                    0xedb8_8320 ^ (crc >> 1)
                } else {
                    crc >> 1
                };
            }
            crc
        })
    }

    /// A PNG whose chunks all have the checksums of what they hold; `None` where a length leads beyond the end.
    pub(in crate::picture) fn with_checksums(mut bytes: Vec<u8>) -> Option<Vec<u8>> {
        let mut at = 8;
        while at < bytes.len() {
            let length = u32::from_be_bytes(*bytes.get(at..)?.first_chunk()?) as usize;
            let end = at + 8 + length;
            let sum = crc(bytes.get(at + 4..end)?);
            bytes
                .get_mut(end..end + 4)?
                .copy_from_slice(&sum.to_be_bytes());
            at = end + 4;
        }
        Some(bytes)
    }

    /// Every bit of a file, also where the format's own checksums are corrected afterwards: a fragment with one bit
    /// flipped is refused, or has the same pixels at the same position in the same picture.
    #[test]
    fn every_flipped_bit_of_a_fragment_is_refused_or_harmless() {
        let whole = sample_picture(11, 40, true);
        let grid = Grid::Count {
            columns: 2,
            rows: 2,
        };
        let (_, mut part) = fragments(&whole, grid, Format::Exr).remove(3);
        let exr = part.encode(Format::Exr).expect("encodes");
        let with_layers = part.clone();
        part.picture.layers = None;
        let png = part.encode(Format::Png).expect("encodes");
        assert_eq!(with_checksums(png.clone()), Some(png.clone()));
        for (bytes, whole) in [(&png, &part), (&exr, &with_layers)] {
            let (mut refused, mut harmless) = (0, 0);
            for bit in 0..8 * bytes.len() {
                let mut damaged = bytes.clone();
                damaged[bit / 8] ^= 1 << (bit % 8);
                let corrected = with_checksums(damaged.clone()).filter(|_| bytes == &png);
                for damaged in [Some(damaged), corrected].into_iter().flatten() {
                    match Fragment::decode("part", &damaged) {
                        Err(_) => refused += 1,
                        Ok(read) => {
                            assert!(read == *whole, "bit {bit} of {}", bytes.len());
                            harmless += 1;
                        }
                    }
                }
            }
            assert!(
                refused > 4 * bytes.len(),
                "{refused} refused, {harmless} harmless"
            );
        }
    }

    /// Every bit of the samples that are compressed in a PNG, under checksums that agree with them: zlib's own and
    /// the chunk's.
    #[test]
    fn every_flipped_bit_of_the_samples_is_refused() {
        let whole = sample_picture(11, 7, false);
        let (_, part) = fragments(&whole, Grid::Size(6), Format::Png).remove(0);
        let png = part.encode(Format::Png).expect("encodes");
        for bit in 0..8 * samples(&png).len() {
            let damaged = repainted(&png, |samples| samples[bit / 8] ^= 1 << (bit % 8));
            let error = Fragment::decode("part", &damaged).expect_err("it was repainted");
            let expected = "its pixels are not those that were written";
            assert!(error.to_string().contains(expected), "bit {bit}: {error}");
        }
    }

    /// A changed recipe is detected just as changed pixels are.
    #[test]
    fn a_recipe_of_another_picture_is_found() {
        for format in [Format::Png, Format::Exr] {
            let whole = sample_picture(12, 10, format == Format::Exr);
            let fragment = fragments(&whole, three_by_two(), format).remove(0).1;
            let mut other = fragment.recipe;
            other.shading.mode = Mode::Flat;
            let position = FragmentPosition {
                full_size: fragment.full_size(),
                rect: fragment.rect,
                recipe: fragment.recipe.digest(),
                pixels: PixelDigest::of(&fragment.picture),
            };
            let tags = Tags {
                recipe: Some(&other),
                position: Some(&position),
            };
            let bytes = match format {
                Format::Png => png::encode(&fragment.picture, tags),
                _ => bands::encode(&fragment.picture, Format::Exr, tags),
            };
            let error = Fragment::decode("part", &bytes.expect("encodes")).expect_err("another");
            assert!(error.to_string().contains("what it was made of"), "{error}");
        }
    }

    #[test]
    fn only_fragments_are_read() {
        let message = |bytes: &[u8]| {
            Fragment::decode("file", bytes)
                .expect_err("not a fragment")
                .to_string()
        };
        assert!(message(b"").contains("neither PNG nor EXR nor TIFF"));
        let picture = sample_picture(4, 4, true);
        for format in [Format::Png, Format::Exr] {
            let bytes = picture.encode(format).expect("encodes");
            assert!(
                message(&bytes).contains("does not say its position"),
                "{format:?}"
            );
            assert!(message(&bytes[..bytes.len() / 2]).starts_with("file: expected a fragment"));
        }
        let (_, fragment) = fragments(&picture, Grid::Size(2), Format::Exr).remove(3);
        for format in [Format::Ppm, Format::Jpeg] {
            let error = fragment.encode(format).expect_err("no position");
            assert!(error.to_string().starts_with("fragments are PNG or EXR"));
        }
    }

    #[test]
    fn positions_parse_to_themselves() {
        let position = FragmentPosition {
            full_size: (65_536, 1),
            rect: Rect {
                x: 1,
                y: 0,
                width: 7,
                height: 1,
            },
            recipe: Digest::of(b"a recipe"),
            pixels: Digest::of(b"pixels"),
        };
        let again: FragmentPosition = position.to_string().parse().expect("a position");
        assert_eq!(again, position);
        for bad in [
            "",
            "full 1 2",
            "full 1 2 rect 0 0 1 1 recipe 0 pixels 0",
            &position.to_string().replace("full ", "full -"),
            &format!("{position} "),
            &format!("{} check {}", position.text(), Digest::of(b"")),
            &position.text(),
            // The text that was written before fragments had recipes.
            "full 1 2 rect 0 0 1 1 view 0123456789abcdef",
        ] {
            assert!(bad.parse::<FragmentPosition>().is_err(), "{bad}");
        }
    }
}
