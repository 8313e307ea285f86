//! A picture's pixels against the truth, with more pixels where errors are most likely.

use crate::expected::{Expected, Single, closest_visible, shows};
use crate::sample_places::{PlacedSample, sample_places};
use crate::stage::Stage;
use crate::wrong_answer::{GRAZING, WrongAnswer, compare_pixel};
use raycast_core::Cull;
use raycast_core::camera::{Camera, PixelFilter, Rect};
use raycast_core::picture::{Layers, Picture};
use raycast_core::shade::Shading;
use raycast_oracle::Truth;
use raycast_oracle::random::Random;
use rayon::prelude::*;

/// The most wrong pixels that are listed.
const MAX_LISTED: usize = 5;

/// A rectangle of a camera's picture that claims to show a scene.
#[derive(Clone, Copy, Debug)]
pub struct Claim<'a> {
    /// The camera of the whole picture.
    pub camera: Camera,
    /// The rectangle.
    pub rect: Rect,
    /// Which faces its rays hit.
    pub cull: Cull,
    /// Mode, colours, light, textures and lines.
    pub shading: Shading,
    /// Samples a pixel.
    pub samples: u32,
    /// The filter that weighs them.
    pub pixel_filter: PixelFilter,
    /// The claimed pixels, as many as the rectangle has. Without layers only 8-bit colours are checked.
    pub picture: &'a Picture,
}

/// The result of checking a claim.
#[derive(Clone, Debug, Default)]
pub struct Verification {
    /// Pixels in the rectangle.
    pub pixels: usize,
    /// How many of them were checked.
    pub checked: usize,
    /// Checked pixels next to a miss, or to another object.
    pub silhouettes: usize,
    /// Checked pixels next to another triangle of the same object.
    pub edges: usize,
    /// At how many of them each channel was checked.
    pub channels: Channels,
    /// How many were wrong.
    pub wrong: usize,
    /// The first few of them, row by row.
    pub first_wrong: Vec<WrongPixel>,
}

impl std::ops::AddAssign for Verification {
    /// Adds the result of another rectangle of the same picture, further down.
    fn add_assign(&mut self, other: Self) {
        self.pixels += other.pixels;
        self.checked += other.checked;
        self.silhouettes += other.silhouettes;
        self.edges += other.edges;
        self.channels += other.channels;
        self.wrong += other.wrong;
        self.first_wrong.extend(other.first_wrong);
        self.first_wrong.truncate(MAX_LISTED);
    }
}

/// At how many pixels each channel was checked. Not checked are channels that the picture lacks, those that depend on
/// the position in a triangle that the ray grazes (a cosine of 0.1 or less), colours under lines, and colours that
/// rounding makes arbitrary (a texture with more than a texel within a hit's error, layers that are all but hidden).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Channels {
    /// Object and triangle.
    pub numbers: usize,
    /// Distance.
    pub depth: usize,
    /// The surface normal.
    pub normal: usize,
    /// Texture coordinates.
    pub uv: usize,
    /// Colour and alpha: the mean of the pixel's samples.
    pub color: usize,
}

impl std::ops::AddAssign for Channels {
    fn add_assign(&mut self, other: Self) {
        self.numbers += other.numbers;
        self.depth += other.depth;
        self.normal += other.normal;
        self.uv += other.uv;
        self.color += other.color;
    }
}

/// A pixel that does not show what its ray hits.
#[derive(Clone, Copy, Debug)]
pub struct WrongPixel {
    /// Its column in the whole picture.
    pub x: u32,
    /// Its row.
    pub y: u32,
    /// What is wrong.
    pub fault: WrongAnswer,
    /// The object that it shows (`u32::MAX` for none), the triangle, and the distance; `None` in a picture without
    /// layers.
    pub shown: Option<(u32, u32, f32)>,
    /// What its ray truly hits.
    pub truth: Option<Truth>,
}

/// Checks `most` of a claim's pixels, or all if there are fewer: a third at silhouettes, a third at edges between two
/// triangles of one object, and the rest anywhere; in a picture without layers, anywhere. The seed decides which.
/// `done` is called, from several threads, with the number of pixels checked since the last call.
pub fn verify(
    stage: &Stage,
    claim: &Claim<'_>,
    most: usize,
    seed: u64,
    done: &(impl Fn(u64) + Sync),
) -> Verification {
    let chosen = choose_pixels(claim, most, seed);
    let samples = sample_places(claim.samples, claim.pixel_filter);
    // In a picture for two eyes each half has its eye's camera.
    let whole = || vec![(claim.camera, claim.rect)];
    let halves = (claim.camera.halves()).map_or_else(whole, |halves| halves.to_vec());
    let eyes: Vec<_> = (halves.into_iter())
        .map(|(camera, part)| {
            let expected = Expected::new(stage, (claim.camera, camera), claim.shading, claim.cull);
            (part, expected)
        })
        .collect();
    let parts: Vec<(Channels, Vec<WrongPixel>)> = chosen
        .par_chunks(256)
        .map(|chunk| {
            let mut channels = Channels::default();
            let mut eyes = eyes.clone();
            let mut check = |&i: &u32| {
                let (x, y) = claim.pixel(i as usize);
                let is_in = |(part, _): &&mut (Rect, _)| {
                    (part.x..part.right()).contains(&x) && (part.y..part.bottom()).contains(&y)
                };
                let (_, expected) = eyes.iter_mut().find(is_in)?;
                check(
                    (stage, claim),
                    &samples,
                    expected,
                    i as usize,
                    &mut channels,
                )
            };
            let wrong: Vec<WrongPixel> = chunk.iter().filter_map(&mut check).collect();
            done(chunk.len() as u64);
            (channels, wrong)
        })
        .collect();
    let mut channels = Channels::default();
    let mut wrong = Vec::new();
    for (of_part, wrong_of_part) in parts {
        channels += of_part;
        wrong.extend(wrong_of_part);
    }
    wrong.sort_unstable_by_key(|pixel| (pixel.y, pixel.x));
    let count = wrong.len();
    wrong.truncate(MAX_LISTED);
    let count_of = |kind| {
        let is_kind = |i: &&u32| claim.kind(**i as usize) == kind;
        chosen.iter().filter(is_kind).count()
    };
    Verification {
        pixels: claim.rect.area(),
        checked: chosen.len(),
        silhouettes: count_of(PixelKind::Silhouette),
        edges: count_of(PixelKind::Edge),
        channels,
        wrong: count,
        first_wrong: wrong,
    }
}

/// What is adjacent at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PixelKind {
    Silhouette,
    Edge,
    Inside,
}

impl Claim<'_> {
    /// Column and row of a pixel in the whole picture.
    fn pixel(&self, i: usize) -> (u32, u32) {
        let width = self.rect.width as usize;
        let (column, row) = ((i % width) as u32, (i / width) as u32);
        (self.rect.x + column, self.rect.y + row)
    }

    fn kind(&self, i: usize) -> PixelKind {
        let Some(layers) = &self.picture.layers else {
            return PixelKind::Inside;
        };
        let (width, height) = (self.rect.width as usize, self.rect.height as usize);
        let (x, y) = (i % width, i / width);
        let neighbours = [
            (x > 0).then(|| i - 1),
            (x + 1 < width).then(|| i + 1),
            (y > 0).then(|| i - width),
            (y + 1 < height).then(|| i + width),
        ];
        let differs = |ids: &[u32]| neighbours.iter().flatten().any(|&j| ids[j] != ids[i]);
        if differs(&layers.object) {
            PixelKind::Silhouette
        } else if differs(&layers.triangle) {
            PixelKind::Edge
        } else {
            PixelKind::Inside
        }
    }
}

/// The pixels to check, without repetition.
fn choose_pixels(claim: &Claim<'_>, most: usize, seed: u64) -> Vec<u32> {
    let [mut silhouettes, mut edges, mut insides] = [const { Vec::new() }; 3];
    for i in 0..claim.rect.area() {
        match claim.kind(i) {
            PixelKind::Silhouette => silhouettes.push(i as u32),
            PixelKind::Edge => edges.push(i as u32),
            PixelKind::Inside => insides.push(i as u32),
        }
    }
    let mut random = Random::new(seed);
    let mut take = |from: &mut Vec<u32>, count: usize| -> Vec<u32> {
        (0..count.min(from.len()))
            .map(|_| from.swap_remove(random.below(from.len() as u32) as usize))
            .collect()
    };
    let mut chosen = take(&mut silhouettes, most / 3);
    chosen.extend(take(&mut edges, most / 3));
    let mut rest = [silhouettes, edges, insides].concat();
    chosen.extend(take(&mut rest, most - chosen.len()));
    chosen
}

/// What is wrong with a pixel, if anything; counts what was checked.
fn check(
    (stage, claim): (&Stage, &Claim<'_>),
    samples: &[PlacedSample],
    expected: &mut Expected<'_>,
    i: usize,
    channels: &mut Channels,
) -> Option<WrongPixel> {
    let (x, y) = claim.pixel(i);
    let eye = expected.camera();
    let truth_at = |(across, down): (f64, f64)| {
        let place = (f64::from(x) + across, f64::from(y) + down);
        let ray = eye.ray(place.0, place.1);
        (place, closest_visible(stage, &ray, claim.cull))
    };
    // Where rounding may decide what a mask keeps, the truth is unknown.
    let (middle, truth) = truth_at((0.5, 0.5));
    let truth = truth?;
    expected.set_camera(&eye.seen_at(middle.0, middle.1));
    let layers = claim.picture.layers.as_ref();
    let found = layers
        .map_or(Ok(()), |layers| {
            check_layers(layers, i, truth.as_ref(), expected, channels)
        })
        .and_then(|()| {
            let mut sums = [Single::exactly(0.0); 4];
            let mut weights = 0.0;
            for &(place, weight) in samples {
                let ((x, y), truth) = truth_at(place);
                let Some(truth) = truth else { return Ok(()) };
                expected.set_camera(&eye.seen_at(x, y));
                let [r, g, b, a] = expected.color(x, y, truth.as_ref());
                let light = [r * a, g * a, b * a, a];
                sums = std::array::from_fn(|channel| match weight < 0.0 {
                    true => sums[channel] - light[channel],
                    false => sums[channel] + light[channel],
                });
                weights += weight;
                if !sums.iter().all(|sum| sum.is_known()) {
                    return Ok(());
                }
            }
            let share = Single::exactly(1.0 / weights).rounded();
            let mut color = sums.map(|sum| sum * share);
            if samples.iter().any(|sample| sample.1 < 0.0) {
                let alpha = color[3].max(0.0).min(1.0);
                color = color.map(|channel| channel.max(0.0).at_most(alpha));
                color[3] = alpha;
            }
            match layers {
                Some(layers) => {
                    channels.color += 1;
                    let found = layers.color[i].map(f64::from);
                    compare_channels(["R", "G", "B", "A"], found, color)
                }
                None => match shows(claim.picture.pixels[i], color) {
                    None => Ok(()),
                    Some(shown) => {
                        channels.color += 1;
                        shown
                    }
                },
            }
        });
    expected.set_camera(&eye);
    let fault = found.err()?;
    let shown = layers.map(|layers| (layers.object[i], layers.triangle[i], layers.depth[i]));
    Some(WrongPixel {
        x,
        y,
        fault,
        shown,
        truth,
    })
}

/// Checks a pixel's layers, except for the colour, against what its first ray hits.
fn check_layers(
    layers: &Layers,
    i: usize,
    truth: Option<&Truth>,
    expected: &Expected<'_>,
    channels: &mut Channels,
) -> Result<(), WrongAnswer> {
    let (object, triangle, depth) = (layers.object[i], layers.triangle[i], layers.depth[i]);
    channels.numbers += 1;
    channels.depth += usize::from(truth.is_none_or(|truth| truth.cosine > GRAZING));
    compare_pixel(object, triangle, depth, truth)?;
    let (normal, uv) = match truth {
        None => ([Single::exactly(0.0); 3], [Single::exactly(0.0); 2]),
        Some(truth) => expected.surface(truth),
    };
    if normal.iter().all(|normal| normal.is_known()) {
        channels.normal += 1;
        let found = layers.normal[i].map(f64::from);
        compare_channels(["N.X", "N.Y", "N.Z"], found, normal)?;
    }
    if uv.iter().all(|uv| uv.is_known()) {
        channels.uv += 1;
        compare_channels(["uv.U", "uv.V"], layers.uv[i].map(f64::from), uv)?;
    }
    Ok(())
}

fn compare_channels<const N: usize>(
    names: [&'static str; N],
    found: [f64; N],
    expected: [Single; N],
) -> Result<(), WrongAnswer> {
    for ((channel, found), range) in names.into_iter().zip(found).zip(expected) {
        if !range.contains(found) {
            return Err(WrongAnswer::Channel {
                channel,
                found,
                low: range.low,
                high: range.high,
            });
        }
    }
    Ok(())
}

#[cfg(test)]
#[path = "verify_tests.rs"]
mod tests;
