//! Plot D: the cost and the benefit of denser rays and of more samples.

use super::Section;
use crate::budget::ReportBudget;
use crate::chart::{Axis, Better, Chart, Ink, Series, captioned};
use crate::metrics::Difference;
use crate::progress::ReportProgress;
use crate::table::{Cell, ReportError, Table, short};
use crate::timing::{Spread, interleaved};
use crate::views;
use image::{Rgb, RgbImage};
use raycast_core::Accel;
use raycast_core::camera::{Camera, Grid, ImagePlane};
use raycast_core::math;
use raycast_core::picture::Picture;
use raycast_core::render::{Cancel, Settings, View};
use raycast_core::scene::Scene;
use raycast_core::shade::{Background, Shading};
use std::sync::Arc;
use std::time::Duration;

/// Distances of neighbouring rays in pixels, from sparse to dense.
const STEPS: [f64; 7] = [8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125];

/// Samples per pixel.
const SAMPLES: [u32; 7] = [1, 2, 4, 8, 16, 32, 64];

/// A picture made with one step and one number of samples.
#[derive(Clone, Debug)]
pub struct DensePicture {
    /// The distance of neighbouring rays in pixels.
    pub step: f64,
    /// Samples per pixel of the picture as it was rendered.
    pub samples: u32,
    /// Milliseconds to render it.
    pub ms: Spread,
    /// The difference from the reference.
    pub difference: Difference,
    /// Resampled to the reference's size.
    picture: RgbImage,
}

/// Pictures by step, pictures by samples, and the reference.
#[derive(Clone, Debug)]
pub struct Pictures {
    by_step: Vec<DensePicture>,
    by_samples: Vec<DensePicture>,
    reference: RgbImage,
    samples: u32,
    name: String,
}

/// Renders a scene with sparse and with dense rays, and compares each picture with one of very many samples.
///
/// # Errors
/// A scene that cannot be built, an invalid camera.
pub fn measure(
    name: &str,
    scene: &Arc<Scene>,
    budget: &ReportBudget,
    progress: &dyn ReportProgress,
) -> Result<Pictures, ReportError> {
    let camera = views::filling(scene, budget.compared, views::FOV, 1.2)?;
    let view = View {
        scene: Arc::clone(scene),
        accel: Arc::new(Accel::build(scene)?.with_simd(budget.simd)),
        camera,
        settings: Settings {
            shading: Shading {
                background: Background::default(),
                ..Shading::default()
            },
            samples: 1,
            ..Settings::default()
        },
    };
    progress.begin("reference", 1);
    let reference = to_rgb(&render(&with_samples(&view, budget.samples)));
    progress.step();
    let steps = STEPS.map(|step| with_step(&view, step));
    let steps = steps.into_iter().collect::<Result<Vec<_>, _>>()?;
    let samples = SAMPLES.map(|samples| with_samples(&view, samples));
    let rounds = budget.rounds.div_ceil(2);
    progress.begin(
        "density",
        ((STEPS.len() + SAMPLES.len()) * (rounds + 1)) as u64,
    );
    let mut works: Vec<Box<dyn FnMut() + Send>> = Vec::new();
    for view in steps.iter().chain(&samples) {
        works.push(Box::new(move || {
            std::hint::black_box(render(view));
        }));
    }
    let times = interleaved(rounds, &mut works, &|| progress.step());
    let (step_times, sample_times) = times.split_at(STEPS.len());
    let made = |view: &View, step: f64, seconds: Spread| -> Result<DensePicture, ReportError> {
        let picture = resized(&to_rgb(&render(view)), budget.compared);
        Ok(DensePicture {
            step,
            samples: view.settings.samples,
            ms: seconds.scaled(1e3),
            difference: Difference::between(&picture, &reference)?,
            picture,
        })
    };
    let by_step = steps.iter().zip(STEPS).zip(step_times);
    let by_step = by_step.map(|((view, step), &time)| made(view, step, time));
    let by_samples = samples.iter().zip(sample_times);
    let by_samples = by_samples.map(|(view, &time)| made(view, 1.0, time));
    Ok(Pictures {
        by_step: by_step.collect::<Result<_, _>>()?,
        by_samples: by_samples.collect::<Result<_, _>>()?,
        reference: reference.clone(),
        samples: budget.samples,
        name: name.to_owned(),
    })
}

pub(super) fn with_samples(view: &View, samples: u32) -> View {
    View {
        settings: Settings {
            samples,
            ..view.settings
        },
        ..view.clone()
    }
}

/// The same frame with rays `step` pixels apart.
pub(super) fn with_step(view: &View, step: f64) -> Result<View, ReportError> {
    let plane = view.camera.plane();
    let count = |pixels: u32| (f64::from(pixels) / step).round().max(1.0) as u32;
    let dense = ImagePlane::new(count(plane.columns), count(plane.rows), plane.step * step)?;
    let camera: Camera = view.camera.with_plane(dense);
    Ok(View {
        camera,
        ..view.clone()
    })
}

/// Renders a view.
pub(super) fn render(view: &View) -> Picture {
    let picture = view.render(
        Grid::default(),
        &|| Duration::ZERO,
        &Cancel::default(),
        &|_| (),
    );
    // Nothing cancels it.
    picture.unwrap_or_else(|| Picture::blank(1, 1, false))
}

/// The colours without alpha.
pub(super) fn to_rgb(picture: &Picture) -> RgbImage {
    RgbImage::from_fn(picture.width, picture.height, |x, y| {
        let [r, g, b, _] = picture.pixels[(y * picture.width + x) as usize];
        Rgb([r, g, b])
    })
}

/// Resamples a picture: repeats pixels, or averages them in linear light.
pub(super) fn resized(picture: &RgbImage, (width, height): (u32, u32)) -> RgbImage {
    let linear = |value: u8| {
        let value = f64::from(value) / 255.0;
        if value <= 0.04045 {
            value / 12.92
        } else {
            math::pow((value + 0.055) / 1.055, 2.4)
        }
    };
    let encoded = |value: f64| {
        let value = if value <= 0.003_130_8 {
            value * 12.92
        } else {
            1.055 * math::pow(value, 1.0 / 2.4) - 0.055
        };
        (value * 255.0).round() as u8
    };
    let span = |at: u32, pixels: u32, from: u32| {
        let first = (u64::from(at) * u64::from(from) / u64::from(pixels)) as u32;
        let end = (u64::from(at + 1) * u64::from(from)).div_ceil(u64::from(pixels)) as u32;
        first..end.max(first + 1).min(from)
    };
    RgbImage::from_fn(width, height, |x, y| {
        let (xs, ys) = (
            span(x, width, picture.width()),
            span(y, height, picture.height()),
        );
        // Enlarging takes the source pixel at the middle of the target pixel.
        if picture.width() <= width {
            let middle = |at: u32, pixels: u32, from: u32| {
                ((u64::from(at) * 2 + 1) * u64::from(from) / (2 * u64::from(pixels))) as u32
            };
            return *picture.get_pixel(
                middle(x, width, picture.width()),
                middle(y, height, picture.height()),
            );
        }
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for y in ys {
            for x in xs.clone() {
                let pixel = picture.get_pixel(x, y).0;
                sum = std::array::from_fn(|channel| sum[channel] + linear(pixel[channel]));
                count += 1.0;
            }
        }
        Rgb(sum.map(|sum| encoded(sum / count)))
    })
}

/// Adds the charts, the crops, the numbers, and the conclusions.
pub fn show(section: &mut Section, pictures: &Pictures) -> Result<(), ReportError> {
    let Pictures {
        by_step,
        by_samples,
        samples,
        name,
        ..
    } = pictures;
    type Measure = fn(&Difference) -> f64;
    let measures: [(&str, &str, Measure, Better); 4] = [
        (
            "rmse",
            "root mean square error, of 255",
            |d| d.rmse,
            Better::LowerLeft,
        ),
        (
            "flip",
            "FLIP, mean: 0 is no visible difference",
            |d| d.flip,
            Better::LowerLeft,
        ),
        (
            "ssim",
            "1 - SSIM: 0 is the same structure",
            |d| 1.0 - d.ssim,
            Better::LowerLeft,
        ),
        ("psnr", "PSNR, decibels", |d| d.psnr, Better::HigherLeft),
    ];
    for (short_name, label, measure, better) in measures {
        let points = |made: &[DensePicture]| -> Vec<(f64, f64)> {
            made.iter()
                .map(|made| (made.ms.median, measure(&made.difference)))
                .collect()
        };
        let (steps, many) = (points(by_step), points(by_samples));
        let all = || steps.iter().chain(&many).copied();
        let mut series = vec![
            Series::line("", steps.clone(), Ink::Blue),
            Series::line("", many.clone(), Ink::Vermilion),
        ];
        for (made, point) in by_step.iter().zip(&steps) {
            series.push(Series::dot(step_words(made.step), *point, Ink::Blue));
        }
        for (made, point) in by_samples.iter().zip(&many).skip(1) {
            let label = format!("{} samples", made.samples);
            series.push(Series::dot(label, *point, Ink::Vermilion));
        }
        let y = if better == Better::LowerLeft {
            Axis::log(label, all().map(|point| point.1))
        } else {
            let most = all().map(|point| point.1).filter(|y| y.is_finite());
            Axis::linear(label, most)
        };
        let chart = Chart {
            title: format!("{name}: {}", conclusion(pictures, measure, better)),
            subtitle: format!(
                "The same frame against {samples} samples a pixel. Blue: rays so many pixels apart. Red: \
                 so many rays in each pixel."
            ),
            x: Axis::log("milliseconds a picture", all().map(|point| point.0)),
            y,
            series,
            better,
        };
        section.chart(&format!("d-{short_name}"), chart);
    }
    let crops = crops(pictures)?;
    section.paragraph(format!(
        "Where the picture changes most, magnified: few rays to the left, {samples} samples a pixel to \
         the right.\n\n![Crops of the same place with more and more rays](d-crops.png)"
    ));
    section.pictures.push(("d-crops.png".to_owned(), crops));
    section.table("d-density", numbers(pictures));
    Ok(())
}

fn step_words(step: f64) -> String {
    if step < 1.0 {
        format!("step 1/{}", (1.0 / step).round())
    } else {
        format!("step {step}")
    }
}

/// Which of step and samples has the lower error in the time of the densest step.
fn conclusion(pictures: &Pictures, measure: fn(&Difference) -> f64, better: Better) -> String {
    let Some(densest) = pictures.by_step.last() else {
        return "no pictures".to_owned();
    };
    let affordable = pictures.by_samples.iter();
    let mut affordable = affordable.filter(|made| made.ms.median <= densest.ms.median * 1.1);
    let Some(best) = affordable.next_back() else {
        return "samples cost more than steps".to_owned();
    };
    let (step, samples) = (measure(&densest.difference), measure(&best.difference));
    let steps_win = (step < samples) == (better == Better::LowerLeft);
    if steps_win {
        format!(
            "{} does better than {} samples a pixel",
            step_words(densest.step),
            best.samples
        )
    } else {
        format!(
            "{} samples a pixel do better than {}",
            best.samples,
            step_words(densest.step)
        )
    }
}

/// Crops of the same rectangle of each picture by step, side by side, with captions.
fn crops(pictures: &Pictures) -> Result<Vec<u8>, ReportError> {
    const SIDE: u32 = 32;
    const MAGNIFIED: u32 = 7;
    let reference = &pictures.reference;
    let (width, height) = reference.dimensions();
    let side = SIDE.min(width).min(height);
    // The rectangle in which the picture with one sample per pixel differs most from the reference.
    let plain = pictures
        .by_samples
        .first()
        .map_or(reference, |made| &made.picture);
    let off = |left: u32, top: u32| -> u64 {
        let pixels = (0..side * side).map(|at| (left + at % side, top + at / side));
        pixels
            .map(|(x, y)| {
                let (a, b) = (plain.get_pixel(x, y).0, reference.get_pixel(x, y).0);
                (0..3)
                    .map(|c| u64::from(a[c].abs_diff(b[c])).pow(2))
                    .sum::<u64>()
            })
            .sum()
    };
    let places = (0..=height - side).step_by(8);
    let places = places.flat_map(|top| (0..=width - side).step_by(8).map(move |left| (left, top)));
    let (left, top) = places
        .max_by_key(|&(left, top)| off(left, top))
        .unwrap_or((0, 0));
    let cut = |picture: &RgbImage| {
        RgbImage::from_fn(side * MAGNIFIED, side * MAGNIFIED, |x, y| {
            *picture.get_pixel(left + x / MAGNIFIED, top + y / MAGNIFIED)
        })
    };
    let mut strip: Vec<(String, RgbImage)> = pictures
        .by_step
        .iter()
        .map(|made| {
            let words = format!("{}: {} ms", step_words(made.step), short(made.ms.median));
            (words, cut(&made.picture))
        })
        .collect();
    strip.push((
        format!("{} samples a pixel", pictures.samples),
        cut(reference),
    ));
    Ok(captioned(&strip, 4)?)
}

fn numbers(pictures: &Pictures) -> Table {
    let mut table = Table::new(&[
        "step, pixels",
        "samples",
        "ms",
        "deviation",
        "RMSE, of 255",
        "PSNR, dB",
        "SSIM",
        "FLIP",
    ]);
    for made in pictures.by_step.iter().chain(&pictures.by_samples) {
        let d = &made.difference;
        table.row(vec![
            Cell::Number(made.step.to_string(), made.step),
            u64::from(made.samples).into(),
            Cell::short(made.ms.median),
            Cell::short(made.ms.deviation),
            Cell::short(d.rmse),
            Cell::decimals(d.psnr, 2),
            Cell::decimals(d.ssim, 5),
            Cell::decimals(d.flip, 5),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_keep_their_light_at_any_size() {
        let grey = RgbImage::from_pixel(8, 8, Rgb([90, 160, 230]));
        assert_eq!(
            resized(&grey, (4, 4)),
            RgbImage::from_pixel(4, 4, Rgb([90, 160, 230]))
        );
        assert_eq!(resized(&grey, (32, 32)).get_pixel(31, 31).0, [90, 160, 230]);
        // The mean of black and white in linear light is 188 in sRGB, not 128.
        let stripes = RgbImage::from_fn(8, 8, |x, _| Rgb([if x % 2 == 0 { 255 } else { 0 }; 3]));
        assert_eq!(resized(&stripes, (4, 4)).get_pixel(1, 1).0, [188; 3]);
        let ramp = RgbImage::from_fn(3, 1, |x, _| Rgb([x as u8; 3]));
        let wide = resized(&ramp, (9, 3));
        let row: Vec<u8> = (0..9).map(|x| wide.get_pixel(x, 1).0[0]).collect();
        assert_eq!(row, [0, 0, 0, 1, 1, 1, 2, 2, 2]);
    }
}
