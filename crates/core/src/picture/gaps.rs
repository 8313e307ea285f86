use crate::camera::Rect;
use std::fmt;

/// The most places that a message names; the others are counted, so that it stays readable.
const NAMED: usize = 4;

/// The pixels of a picture that no fragment contains.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gaps {
    /// Columns of the picture.
    pub width: u32,
    /// Rows of the picture.
    pub height: u32,
    /// Rectangles that together are these pixels, each once, from the top.
    pub rects: Vec<Rect>,
}

impl Gaps {
    /// What rectangles within a picture leave of it.
    pub(super) fn between((width, height): (u32, u32), rects: &[Rect]) -> Self {
        // The rectangles that cover a row change only where one starts or ends.
        let mut rows: Vec<u32> = rects
            .iter()
            .flat_map(|rect| [rect.y, rect.bottom()])
            .chain([0, height])
            .collect();
        rows.sort_unstable();
        rows.dedup();
        let mut gaps: Vec<Rect> = Vec::new();
        for rows in rows.windows(2) {
            let (y, bottom) = (rows[0], rows[1]);
            for (x, right) in gaps_of_row(width, y, rects) {
                let above = gaps
                    .iter_mut()
                    .find(|gap| gap.bottom() == y && (gap.x, gap.right()) == (x, right));
                match above {
                    Some(gap) => gap.height += bottom - y,
                    None => gaps.push(Rect {
                        x,
                        y,
                        width: right - x,
                        height: bottom - y,
                    }),
                }
            }
        }
        Self {
            width,
            height,
            rects: gaps,
        }
    }

    /// Whether every pixel is in a fragment.
    pub fn is_empty(&self) -> bool {
        self.rects.is_empty()
    }

    /// The number of pixels.
    pub fn pixels(&self) -> u64 {
        self.rects.iter().map(|rect| rect.area() as u64).sum()
    }
}

impl fmt::Display for Gaps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { width, height, .. } = self;
        let pixels = self.pixels();
        write!(
            f,
            "{pixels} of {width} x {height} pixels are in no fragment"
        )?;
        for (index, rect) in self.rects.iter().take(NAMED).enumerate() {
            let before = if index == 0 { ':' } else { ';' };
            let (right, bottom) = (rect.right() - 1, rect.bottom() - 1);
            write!(
                f,
                "{before} columns {}..{right} of rows {}..{bottom}",
                rect.x, rect.y
            )?;
        }
        match self.rects.len().saturating_sub(NAMED) {
            0 => Ok(()),
            more => write!(f, "; and {more} more"),
        }
    }
}

/// The columns of a row that no rectangle covers: the first of each run, and the one after its last.
fn gaps_of_row(width: u32, y: u32, rects: &[Rect]) -> Vec<(u32, u32)> {
    let mut spans: Vec<(u32, u32)> = rects
        .iter()
        .filter(|rect| rect.y <= y && y < rect.bottom())
        .map(|rect| (rect.x, rect.right()))
        .chain([(width, width)])
        .collect();
    spans.sort_unstable();
    let mut gaps = Vec::new();
    let mut x = 0;
    for (left, right) in spans {
        if left > x {
            gaps.push((x, left));
        }
        x = x.max(right);
    }
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn gaps_are_the_pixels_that_no_rectangle_covers() {
        let (width, height) = (13, 9);
        let mut random = Random(7);
        for count in 0..40 {
            let mut below = |most: u32| (random.unit() * f64::from(most)) as u32;
            let rects: Vec<Rect> = (0..count / 4)
                .map(|_| {
                    let (x, y) = (below(width), below(height));
                    Rect {
                        x,
                        y,
                        width: 1 + below(width - x),
                        height: 1 + below(height - y),
                    }
                })
                .collect();
            let gaps = Gaps::between((width, height), &rects);
            let covered = |rects: &[Rect], x, y| {
                let has = |rect: &&Rect| {
                    rect.x <= x && x < rect.right() && rect.y <= y && y < rect.bottom()
                };
                rects.iter().filter(has).count()
            };
            for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                let expected = usize::from(covered(&rects, x, y) == 0);
                assert_eq!(covered(&gaps.rects, x, y), expected, "{rects:?} {x} {y}");
            }
        }
    }

    #[test]
    fn a_message_names_some_places_and_counts_the_others() {
        let column = |x| Rect {
            x,
            y: 0,
            width: 1,
            height: 5,
        };
        let gaps = Gaps::between((12, 5), &[0, 2, 4, 6, 8, 10].map(column));
        assert_eq!(
            gaps.to_string(),
            "30 of 12 x 5 pixels are in no fragment: columns 1..1 of rows 0..4; columns 3..3 of rows 0..4; \
             columns 5..5 of rows 0..4; columns 7..7 of rows 0..4; and 2 more"
        );
        assert!(
            Gaps::between(
                (3, 2),
                &[Rect {
                    x: 0,
                    y: 0,
                    width: 3,
                    height: 2
                }]
            )
            .is_empty()
        );
    }
}
