use super::file::Tags;
use super::place::{Place, check_place};
use super::{Format, ImageError, ImageFile, OutOfMemory, Picture, Recipe, bands, png};
use crate::camera::Rect;
use crate::digest::Digest;

/// A tile in a file of its own, with what is needed to stitch it back.
#[derive(Clone, Debug, PartialEq)]
pub struct Fragment {
    /// The fragment's place in the full picture.
    pub rect: Rect,
    /// What the full picture is made of: fragments of different recipes do not stitch.
    pub recipe: Recipe,
    /// The rectangle's own pixels, and layers if it has them.
    pub picture: Picture,
}

/// Why fragments cannot be read or stitched.
#[derive(Debug, thiserror::Error)]
pub enum FragmentError {
    /// Not a fragment at all, or a damaged one.
    #[error(
        "{name}: expected a fragment (a PNG or EXR that `raycast render --sub-camera` wrote): {reason}"
    )]
    NotAFragment {
        /// The file's name.
        name: String,
        /// What was found instead.
        reason: String,
    },
    /// A picture for which there is no memory.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
    /// Nothing to stitch.
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
    /// Two fragments in one place.
    #[error("{name} and {other} both hold pixel ({x}, {y})")]
    Overlap {
        /// The file's name.
        name: String,
        /// The name of the file that came before it.
        other: String,
        /// The first column that both hold.
        x: u32,
        /// The first row that both hold.
        y: u32,
    },
    /// Pixels that no fragment holds.
    #[error(
        "{missing} of {width} x {height} pixels are in no fragment, the first of them at ({x}, {y}), up to column {right} of that row: a fragment that starts there is missing"
    )]
    Gap {
        /// How many pixels are missing.
        missing: u64,
        /// Columns of the full picture.
        width: u32,
        /// Rows of the full picture.
        height: u32,
        /// The column of the first missing pixel.
        x: u32,
        /// The row of the first missing pixel.
        y: u32,
        /// The last column of that row before the next pixel that some fragment holds.
        right: u32,
    },
}

impl Fragment {
    /// The bytes of a PNG or an EXR file, which tells in text chunks or attributes its place, the
    /// [`Recipe`] of the full picture, and a checksum of the pixels.
    ///
    /// # Errors
    /// Other kinds of file, which cannot hold a fragment; a rectangle that leaves the full picture;
    /// whatever the encoder refuses.
    pub fn encode(&self, format: Format) -> Result<Vec<u8>, ImageError> {
        self.picture.check()?;
        let place = Place {
            full_size: self.full_size(),
            rect: self.rect,
            recipe: self.recipe.digest(),
            // A PNG holds no layers.
            pixels: match format {
                Format::Png => Digest::of(self.picture.pixels.as_flattened()),
                _ => self.picture.digest(),
            },
        };
        place.check(&self.picture).map_err(ImageError::Encode)?;
        let tags = Tags {
            recipe: Some(&self.recipe),
            place: Some(&place),
        };
        match format {
            Format::Png => png::encode(&self.picture, tags),
            Format::Exr => bands::encode(&self.picture, format, tags),
            Format::Ppm | Format::Jpeg | Format::Tiff => Err(ImageError::NotForFragments),
        }
    }

    /// Reads what [`Fragment::encode`] made. `name` is for the error.
    ///
    /// # Errors
    /// Bytes that are no fragment, or whose pixels, place or recipe are not as they were written.
    pub fn decode(name: &str, bytes: &[u8]) -> Result<Self, FragmentError> {
        let not_a_fragment = |reason: String| FragmentError::NotAFragment {
            name: name.to_owned(),
            reason,
        };
        let ImageFile {
            picture,
            recipe,
            place,
        } = ImageFile::decode(bytes).map_err(|error| not_a_fragment(error.to_string()))?;
        let (Some(place), Some(recipe)) = (place, recipe) else {
            return Err(not_a_fragment(
                "it does not tell its place in a larger picture".to_owned(),
            ));
        };
        let fragment = Self {
            rect: place.rect,
            recipe,
            picture,
        };
        fits(&fragment).map_err(not_a_fragment)?;
        Ok(fragment)
    }

    /// Columns and rows of the full picture.
    pub fn full_size(&self) -> (u32, u32) {
        let plane = self.recipe.camera.plane();
        (plane.columns, plane.rows)
    }
}

/// What a fragment is, without its pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// What its file is called in errors.
    pub name: String,
    /// Its place in the full picture.
    pub rect: Rect,
    /// What the full picture is made of.
    pub recipe: Recipe,
    /// Whether it has layers.
    pub has_layers: bool,
}

impl Part {
    /// What a fragment is.
    pub fn of(name: &str, fragment: &Fragment) -> Self {
        Self {
            name: name.to_owned(),
            rect: fragment.rect,
            recipe: fragment.recipe,
            has_layers: fragment.picture.layers.is_some(),
        }
    }

    fn full_size(&self) -> (u32, u32) {
        let plane = self.recipe.camera.plane();
        (plane.columns, plane.rows)
    }
}

/// Whether fragments are all of one picture, and hold each of its pixels once.
///
/// # Errors
/// None at all, recipes that differ, parts that are missing, or that overlap.
pub fn check_parts(parts: &[Part]) -> Result<(), FragmentError> {
    let Some(first) = parts.first() else {
        return Err(FragmentError::None);
    };
    for part in parts {
        if let Some(reason) = difference(first, part) {
            return Err(FragmentError::Different {
                name: part.name.clone(),
                first: first.name.clone(),
                reason,
            });
        }
    }
    for (index, part) in parts.iter().enumerate() {
        for before in &parts[..index] {
            if let Some((x, y)) = overlap(part.rect, before.rect) {
                return Err(FragmentError::Overlap {
                    name: part.name.clone(),
                    other: before.name.clone(),
                    x,
                    y,
                });
            }
        }
    }
    let (width, height) = first.full_size();
    // Parts lie in the picture, and no two of them overlap: together they hold no more than it has.
    let held: u64 = parts.iter().map(|part| part.rect.area() as u64).sum();
    let missing = (u64::from(width) * u64::from(height)).saturating_sub(held);
    if missing > 0 {
        let (x, y, right) = first_gap((width, height), parts);
        return Err(FragmentError::Gap {
            missing,
            width,
            height,
            x,
            y,
            right,
        });
    }
    Ok(())
}

/// Puts named fragments together into the picture that the full camera would have made.
///
/// # Errors
/// As [`check_parts`]; memory.
pub fn stitch(fragments: &[(String, Fragment)]) -> Result<Picture, FragmentError> {
    for (name, fragment) in fragments {
        fits(fragment).map_err(|reason| FragmentError::NotAFragment {
            name: name.clone(),
            reason,
        })?;
    }
    let parts: Vec<Part> = (fragments.iter())
        .map(|(name, fragment)| Part::of(name, fragment))
        .collect();
    check_parts(&parts)?;
    let Some(first) = parts.first() else {
        return Err(FragmentError::None);
    };
    let (width, height) = first.full_size();
    let mut picture = Picture::try_blank(width, height, first.has_layers)?;
    for (name, fragment) in fragments {
        let (pixels, layers) = (&fragment.picture.pixels, fragment.picture.layers.as_ref());
        if !picture.place(fragment.rect, pixels, layers) {
            return Err(FragmentError::NotAFragment {
                name: name.clone(),
                reason: "its pixels do not fill its rectangle".to_owned(),
            });
        }
    }
    Ok(picture)
}

/// Why two fragments are not of one picture.
fn difference(first: &Part, part: &Part) -> Option<String> {
    let ((width, height), (columns, rows)) = (first.full_size(), part.full_size());
    if (width, height) != (columns, rows) {
        return Some(format!(
            "it is part of a picture of {columns} x {rows}, not {width} x {height}"
        ));
    }
    if let Some(reason) = first.recipe.difference(&part.recipe) {
        return Some(reason);
    }
    match (first.has_layers, part.has_layers) {
        (true, false) => Some("it has no layers".to_owned()),
        (false, true) => Some("it has layers".to_owned()),
        _ => None,
    }
}

/// Whether a fragment lies in its full picture.
fn fits(fragment: &Fragment) -> Result<(), String> {
    check_place(fragment.full_size(), fragment.rect, &fragment.picture)
}

/// The first pixel that two rectangles share.
fn overlap(a: Rect, b: Rect) -> Option<(u32, u32)> {
    let (x, y) = (a.x.max(b.x), a.y.max(b.y));
    let shared = x < a.right().min(b.right()) && y < a.bottom().min(b.bottom());
    shared.then_some((x, y))
}

/// The first pixel, row by row, that no fragment holds, and the last column of that gap in its row.
fn first_gap((width, height): (u32, u32), parts: &[Part]) -> (u32, u32, u32) {
    // What a row holds changes only where a rectangle begins or ends.
    let mut rows: Vec<u32> = parts
        .iter()
        .flat_map(|part| [part.rect.y, part.rect.bottom()])
        .chain([0])
        .filter(|&row| row < height)
        .collect();
    rows.sort_unstable();
    for y in rows {
        let mut spans: Vec<(u32, u32)> = parts
            .iter()
            .map(|part| part.rect)
            .filter(|rect| rect.y <= y && y < rect.bottom())
            .map(|rect| (rect.x, rect.right()))
            .chain([(width, width)])
            .collect();
        spans.sort_unstable();
        let mut x = 0;
        for (left, right) in spans {
            if left > x {
                return (x, y, left - 1);
            }
            x = right;
        }
    }
    (0, 0, 0)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::camera::Grid;
    use crate::picture::Layers;
    use crate::picture::recipe::tests::sample_recipe;
    use crate::shade::{self, Mode};

    /// A picture with something of everything: every channel differs from pixel to pixel, some
    /// pixels are misses, some half transparent.
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

    fn cut<T: Copy>(values: &[T], width: u32, rect: Rect) -> Vec<T> {
        (rect.y..rect.bottom())
            .flat_map(|y| (rect.x..rect.right()).map(move |x| values[(y * width + x) as usize]))
            .collect()
    }

    /// The fragments of a picture, encoded and decoded again.
    fn fragments(picture: &Picture, grid: Grid, format: Format) -> Vec<(String, Fragment)> {
        let width = picture.width;
        grid.tiles(width, picture.height)
            .into_iter()
            .enumerate()
            .map(|(index, rect)| {
                let fragment = Fragment {
                    rect,
                    recipe: sample_recipe(width, picture.height),
                    picture: Picture {
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
                    },
                };
                let name = format!("part-{index}");
                let bytes = fragment.encode(format).expect("encodes");
                let back = Fragment::decode(&name, &bytes).expect("decodes");
                assert_eq!(back, fragment);
                (name, back)
            })
            .collect()
    }

    fn three_by_two() -> Grid {
        Grid::Count {
            columns: 3,
            rows: 2,
        }
    }

    #[test]
    fn stitched_equals_whole() {
        for (format, layers) in [(Format::Png, false), (Format::Exr, true)] {
            let whole = sample_picture(37, 29, layers);
            for grid in [Grid::Size(8), Grid::Size(100), three_by_two()] {
                let mut parts = fragments(&whole, grid, format);
                parts.reverse();
                let stitched = stitch(&parts).expect("stitches");
                assert_eq!(stitched, whole);
                let encode = |picture: &Picture, recipe| {
                    let bytes = picture.encode_with(format, Some(&recipe));
                    bytes.expect("encodes")
                };
                assert_eq!(
                    encode(&stitched, parts[0].1.recipe),
                    encode(&whole, sample_recipe(37, 29))
                );
            }
        }
    }

    #[test]
    fn what_does_not_fit_is_named() {
        let whole = sample_picture(12, 10, false);
        let parts = fragments(&whole, three_by_two(), Format::Png);
        let told = |parts: &[(String, Fragment)]| {
            stitch(parts).expect_err("cannot be stitched").to_string()
        };
        assert_eq!(told(&[]), "there are no fragments to stitch");

        let mut gap = parts.clone();
        gap.remove(4);
        let message = told(&gap);
        assert!(
            message.contains("20 of 12 x 10") && message.contains("(4, 5), up to column 7"),
            "{message}"
        );

        let mut twice = parts.clone();
        twice.push(("again".to_owned(), parts[5].1.clone()));
        assert_eq!(told(&twice), "again and part-5 both hold pixel (8, 5)");

        let mut other_view = parts.clone();
        other_view[2].1.recipe.shading.mode = Mode::Flat;
        assert!(
            told(&other_view)
                .starts_with("part-2 does not belong with part-0: it was made with other settings")
        );

        let mut other_size = parts.clone();
        other_size[1].1.recipe = sample_recipe(13, 10);
        assert!(told(&other_size).contains("part of a picture of 13 x 10, not 12 x 10"));

        let mut with_layers = parts.clone();
        with_layers[3].1.picture.layers = Some(Layers::blank(20));
        assert!(told(&with_layers).contains("part-3 does not belong with part-0: it has layers"));

        let mut outside = parts;
        outside[5].1.rect.x = 11;
        assert!(told(&outside).starts_with("part-5: expected a fragment"));
    }

    /// Parts that overlap by as much as is missing elsewhere hold as many pixels as the picture has.
    #[test]
    fn an_overlap_does_not_make_up_for_a_gap() {
        let whole = sample_picture(12, 10, false);
        let part = |name: &str, x: u32, width: u32| {
            let rect = Rect {
                x,
                y: 0,
                width,
                height: 10,
            };
            let picture = Picture {
                width,
                height: 10,
                pixels: cut(&whole.pixels, 12, rect),
                layers: None,
            };
            let recipe = sample_recipe(12, 10);
            let fragment = Fragment {
                rect,
                recipe,
                picture,
            };
            (name.to_owned(), fragment)
        };
        let [left, middle, right] = [
            part("left", 0, 5),
            part("middle", 4, 4),
            part("right", 9, 3),
        ];
        let orders = [
            [&left, &middle, &right],
            [&right, &middle, &left],
            [&middle, &right, &left],
        ];
        for order in orders {
            let parts = order.map(Clone::clone);
            let error = stitch(&parts).expect_err("pixel (8, 0) is missing");
            assert!(
                matches!(error, FragmentError::Overlap { x: 4, y: 0, .. }),
                "{error}"
            );
        }
        // Twice the picture, and more: nothing wraps round.
        let parts = [part("a", 0, 12), part("b", 0, 12), part("c", 0, 6)];
        assert!(matches!(stitch(&parts), Err(FragmentError::Overlap { .. })));
    }

    /// A byte of a PNG's image changed, and every checksum of PNG's own made right again.
    fn repainted(bytes: &[u8]) -> Vec<u8> {
        let mut decoder = ::png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(::png::Transformations::IDENTITY);
        let mut reader = decoder.read_info().expect("a PNG");
        let mut samples = vec![0; reader.output_buffer_size().expect("a size")];
        reader.next_frame(&mut samples).expect("a PNG");
        let info = reader.info().clone();
        samples[5] ^= 1;
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
        // As a PNG, with valid checksums of its own.
        let png = parts[1].1.encode(Format::Png).expect("encodes");
        assert!(Fragment::decode("part", &png).is_ok());
        let error = Fragment::decode("part", &repainted(&png)).expect_err("it was repainted");
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
            let place = Place {
                full_size: fragment.full_size(),
                rect: fragment.rect,
                recipe: fragment.recipe.digest(),
                pixels: fragment.picture.digest(),
            };
            let mut picture = fragment.picture.clone();
            change(picture.layers.as_mut().expect("layers"));
            let tags = Tags {
                recipe: Some(&fragment.recipe),
                place: Some(&place),
            };
            let bytes = bands::encode(&picture, Format::Exr, tags).expect("encodes");
            let error = Fragment::decode("part", &bytes).expect_err("it was repainted");
            assert!(error.to_string().contains(expected), "{error}");
        }
    }

    /// Another recipe beside the pixels is no better than other pixels.
    #[test]
    fn a_recipe_of_another_picture_is_found() {
        for format in [Format::Png, Format::Exr] {
            let whole = sample_picture(12, 10, format == Format::Exr);
            let fragment = fragments(&whole, three_by_two(), format).remove(0).1;
            let mut other = fragment.recipe;
            other.shading.mode = Mode::Flat;
            let place = Place {
                full_size: fragment.full_size(),
                rect: fragment.rect,
                recipe: fragment.recipe.digest(),
                pixels: fragment.picture.digest(),
            };
            let tags = Tags {
                recipe: Some(&other),
                place: Some(&place),
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
        let told = |bytes: &[u8]| {
            Fragment::decode("file", bytes)
                .expect_err("not a fragment")
                .to_string()
        };
        assert!(told(b"").contains("neither PNG nor EXR"));
        let picture = sample_picture(4, 4, true);
        for format in [Format::Png, Format::Exr] {
            let bytes = picture.encode(format).expect("encodes");
            assert!(
                told(&bytes).contains("does not tell its place"),
                "{format:?}"
            );
            assert!(told(&bytes[..bytes.len() / 2]).starts_with("file: expected a fragment"));
        }
        let (_, fragment) = fragments(&picture, Grid::Size(2), Format::Exr).remove(3);
        for format in [Format::Ppm, Format::Jpeg] {
            let error = fragment.encode(format).expect_err("no place for a place");
            assert!(error.to_string().starts_with("fragments are PNG or EXR"));
        }
    }

    #[test]
    fn places_come_back() {
        let place = Place {
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
        let again: Place = place.to_string().parse().expect("a place");
        assert_eq!(again, place);
        for bad in [
            "",
            "full 1 2",
            "full 1 2 rect 0 0 1 1 recipe 0 pixels 0",
            &place.to_string().replace("full ", "full -"),
            &format!("{place} "),
            // As it was written before fragments told what they are made of.
            "full 1 2 rect 0 0 1 1 view 0123456789abcdef",
        ] {
            assert!(bad.parse::<Place>().is_err(), "{bad}");
        }
    }
}
