use super::fragment::NO_POSITION;
use super::fragment_position::check_rect;
use super::gaps::Gaps;
use super::{Fragment, FragmentError, Picture, Recipe, RowReader};
use crate::camera::Rect;
use std::io::{BufRead, Seek};

/// The most pixels that are in memory while a fragment is checked, in whole rows.
const CHECKED_AT_ONCE: u32 = 1 << 20;

/// A fragment without its pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The file's name, for errors.
    pub name: String,
    /// The rectangle in the full picture.
    pub rect: Rect,
    /// The recipe of the full picture.
    pub recipe: Recipe,
    /// Whether it has layers.
    pub has_layers: bool,
}

impl Part {
    /// The description of a fragment.
    pub fn new(name: &str, fragment: &Fragment) -> Self {
        Self {
            name: name.to_owned(),
            rect: fragment.rect,
            recipe: fragment.recipe,
            has_layers: fragment.picture.layers.is_some(),
        }
    }

    /// Reads a fragment's file to its end, some rows at a time, and checks its pixels.
    ///
    /// # Errors
    /// A file that is no fragment, or damaged; memory.
    pub fn check<R: BufRead + Seek>(
        name: &str,
        reader: &mut RowReader<R>,
    ) -> Result<Self, FragmentError> {
        let not_a_fragment = |reason: String| FragmentError::NotAFragment {
            name: name.to_owned(),
            reason,
        };
        let Some(recipe) = reader.recipe().copied().filter(|_| reader.is_fragment()) else {
            return Err(not_a_fragment(NO_POSITION.to_owned()));
        };
        let part = Self {
            name: name.to_owned(),
            rect: reader.rect(),
            recipe,
            has_layers: reader.has_layers(),
        };
        check_rect(part.full_size(), part.rect).map_err(not_a_fragment)?;
        let most = (CHECKED_AT_ONCE / part.rect.width.max(1)).max(1);
        let mut left = part.rect.height;
        while left > 0 {
            let rows = reader.rows(most);
            left -= rows
                .map_err(|error| not_a_fragment(error.to_string()))?
                .height;
        }
        Ok(part)
    }

    fn full_size(&self) -> (u32, u32) {
        let plane = self.recipe.camera.plane();
        (plane.columns, plane.rows)
    }
}

/// Checks that fragments belong to one picture, and contain each of its pixels once.
///
/// # Errors
/// No fragments, recipes that differ, missing parts, overlapping parts.
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
    let rects: Vec<Rect> = parts.iter().map(|part| part.rect).collect();
    let gaps = Gaps::between(first.full_size(), &rects);
    for (index, part) in parts.iter().enumerate() {
        for before in &parts[..index] {
            if let Some((x, y)) = overlap(part.rect, before.rect) {
                return Err(FragmentError::Overlap {
                    name: part.name.clone(),
                    other: before.name.clone(),
                    x,
                    y,
                    gaps,
                });
            }
        }
    }
    match gaps.is_empty() {
        true => Ok(()),
        false => Err(FragmentError::Gap(gaps)),
    }
}

/// Stitches named fragments to the picture that the full camera would have made.
///
/// # Errors
/// As [`check_parts`]; memory.
pub fn stitch(fragments: &[(String, Fragment)]) -> Result<Picture, FragmentError> {
    for (name, fragment) in fragments {
        fragment
            .check_position()
            .map_err(|reason| FragmentError::NotAFragment {
                name: name.clone(),
                reason,
            })?;
    }
    let parts: Vec<Part> = (fragments.iter())
        .map(|(name, fragment)| Part::new(name, fragment))
        .collect();
    check_parts(&parts)?;
    let Some(first) = parts.first() else {
        return Err(FragmentError::None);
    };
    let (width, height) = first.full_size();
    let mut picture = Picture::try_blank(width, height, first.has_layers)?;
    for (name, fragment) in fragments {
        let (pixels, layers) = (&fragment.picture.pixels, fragment.picture.layers.as_ref());
        if !picture.paste(fragment.rect, pixels, layers) {
            return Err(FragmentError::NotAFragment {
                name: name.clone(),
                reason: "its pixels do not fill its rectangle".to_owned(),
            });
        }
    }
    Ok(picture)
}

/// Why two fragments do not belong to one picture.
fn difference(first: &Part, part: &Part) -> Option<String> {
    let ((width, height), (columns, rows)) = (first.full_size(), part.full_size());
    if (width, height) != (columns, rows) {
        return Some(format!(
            "it is part of a picture of {columns} x {rows}, not {width} x {height}"
        ));
    }
    // Before the recipes, which layers make different ones.
    match (first.has_layers, part.has_layers) {
        (true, false) => Some("it has no layers".to_owned()),
        (false, true) => Some("it has layers".to_owned()),
        _ => first.recipe.difference(&part.recipe),
    }
}

/// The first pixel that two rectangles share.
fn overlap(a: Rect, b: Rect) -> Option<(u32, u32)> {
    let (x, y) = (a.x.max(b.x), a.y.max(b.y));
    let shared = x < a.right().min(b.right()) && y < a.bottom().min(b.bottom());
    shared.then_some((x, y))
}

#[cfg(test)]
mod tests {
    use super::super::fragment::tests::{cut, fragments, sample_picture, three_by_two};
    use super::super::recipe::tests::sample_recipe;
    use super::*;
    use crate::camera::Grid;
    use crate::picture::{Format, Layers};
    use crate::shade::Mode;

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
    fn the_first_difference_of_recipes_is_named() {
        let whole = sample_picture(12, 10, false);
        let parts = fragments(&whole, three_by_two(), Format::Png);
        let refusal = |parts: &[(String, Fragment)]| {
            stitch(parts).expect_err("cannot be stitched").to_string()
        };
        assert_eq!(refusal(&[]), "there are no fragments to stitch");

        let mut gap = parts.clone();
        gap.remove(4);
        let message = refusal(&gap);
        let expected = "20 of 12 x 10 pixels are in no fragment: columns 4..7 of rows 5..9";
        assert_eq!(message, expected);

        let mut twice = parts.clone();
        twice.push(("again".to_owned(), parts[5].1.clone()));
        assert_eq!(refusal(&twice), "again and part-5 both hold pixel (8, 5)");

        let mut misplaced = parts.clone();
        misplaced[4].1 = parts[0].1.clone();
        assert_eq!(
            refusal(&misplaced),
            format!("part-4 and part-0 both hold pixel (0, 0), and {expected}")
        );

        let mut other_view = parts.clone();
        other_view[2].1.recipe.shading.mode = Mode::Flat;
        assert!(
            refusal(&other_view)
                .starts_with("part-2 does not belong with part-0: it was made with other settings")
        );

        let mut other_size = parts.clone();
        other_size[1].1.recipe = sample_recipe(13, 10);
        assert!(refusal(&other_size).contains("part of a picture of 13 x 10, not 12 x 10"));

        let mut with_layers = parts.clone();
        with_layers[3].1.picture.layers = Some(Layers::blank(20));
        assert!(
            refusal(&with_layers).contains("part-3 does not belong with part-0: it has layers")
        );

        let mut outside = parts;
        outside[5].1.rect.x = 11;
        assert!(refusal(&outside).starts_with("part-5: expected a fragment"));
    }

    /// Parts that overlap by as much as is missing elsewhere have as many pixels as the picture.
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
        // More than twice the picture's pixels: nothing wraps around.
        let parts = [part("a", 0, 12), part("b", 0, 12), part("c", 0, 6)];
        assert!(matches!(stitch(&parts), Err(FragmentError::Overlap { .. })));
    }
}
