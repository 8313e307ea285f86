//! The error of pictures by the number of samples, for every scene.

use super::Section;
use super::density::{render, resized, to_rgb, with_samples, with_step};
use crate::budget::ReportBudget;
use crate::chart::{Axis, Better, Chart, Ink, Series};
use crate::metrics::Difference;
use crate::progress::ReportProgress;
use crate::subject::Input;
use crate::table::{Cell, ReportError, Table};
use crate::views;
use raycast_core::Accel;
use raycast_core::math;
use raycast_core::render::{Settings, View};
use std::sync::Arc;

/// Samples per pixel.
const SAMPLES: [u32; 7] = [1, 2, 4, 8, 16, 32, 64];

/// Rays of the reference along each side of a pixel. They form a square lattice, so that none coincides with a
/// sample's position.
const REFERENCE: f64 = 16.0;

/// A scene's errors with increasing numbers of samples.
#[derive(Clone, Debug)]
pub struct SampledScene {
    name: String,
    /// The differences from the reference, by number of samples.
    differences: Vec<(u32, Difference)>,
}

impl SampledScene {
    /// The slope of log error over log samples, by linear least squares. It is the order of convergence.
    fn slope(&self, measure: fn(&Difference) -> f64) -> f64 {
        let points: Vec<(f64, f64)> = (self.differences.iter())
            .map(|(samples, difference)| {
                (
                    math::log2(f64::from(*samples)),
                    math::log2(measure(difference)),
                )
            })
            .collect();
        let count = points.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(|point| point.0), mean(|point| point.1));
        let products: f64 = points
            .iter()
            .map(|point| (point.0 - x) * (point.1 - y))
            .sum();
        let squares: f64 = points.iter().map(|point| (point.0 - x).powi(2)).sum();
        products / squares
    }

    fn error(&self, samples: u32, measure: fn(&Difference) -> f64) -> f64 {
        let found = self.differences.iter().find(|(count, _)| *count == samples);
        found.map_or(f64::NAN, |(_, difference)| measure(difference))
    }
}

/// Renders each scene with increasing numbers of samples, and compares it with the mean of 256 rays per pixel.
///
/// # Errors
/// A scene that cannot be built, an invalid camera.
pub fn measure(
    inputs: &[Input],
    budget: &ReportBudget,
    progress: &dyn ReportProgress,
) -> Result<Vec<SampledScene>, ReportError> {
    progress.begin("samples", inputs.len() as u64);
    let (width, height) = budget.compared;
    let size = (width.div_ceil(2), height.div_ceil(2));
    let scene = |input: &Input| {
        let view = View {
            scene: Arc::clone(&input.scene),
            accel: Arc::new(Accel::build(&input.scene)?.with_simd(budget.simd)),
            camera: views::filling(&input.scene, size, views::FOV, 1.2)?,
            settings: Settings::default(),
        };
        let dense = render(&with_step(&view, 1.0 / REFERENCE)?);
        let reference = resized(&to_rgb(&dense), size);
        let differences = SAMPLES.map(|samples| {
            let picture = to_rgb(&render(&with_samples(&view, samples)));
            Ok((samples, Difference::between(&picture, &reference)?))
        });
        progress.step();
        Ok(SampledScene {
            name: input.name.clone(),
            differences: differences
                .into_iter()
                .collect::<Result<_, ReportError>>()?,
        })
    };
    inputs.iter().map(scene).collect()
}

/// Adds the charts, the numbers, and how to read them.
pub fn show(section: &mut Section, budget: &ReportBudget, scenes: &[SampledScene]) {
    const INKS: [Ink; 7] = [
        Ink::Blue,
        Ink::Vermilion,
        Ink::Green,
        Ink::Purple,
        Ink::Orange,
        Ink::Sky,
        Ink::Grey,
    ];
    type Measure = fn(&Difference) -> f64;
    let measures: [(&str, &str, Measure); 2] = [
        ("rmse", "root mean square error, of 255", |d| d.rmse),
        ("flip", "FLIP, mean: 0 is no visible difference", |d| d.flip),
    ];
    let (width, height) = (budget.compared.0.div_ceil(2), budget.compared.1.div_ceil(2));
    section.paragraph(format!(
        "Samples of a pixel are the same places in all pixels, so that each is cast as a lattice in packets. \
         {width} × {height}, against the mean of 256 rays a pixel on a square lattice, which has none of \
         the samples' places; steps of 8-bit values included."
    ));
    for (short_name, label, measure) in measures {
        let points = |scene: &SampledScene| -> Vec<(f64, f64)> {
            let all = scene.differences.iter();
            all.map(|(samples, it)| (f64::from(*samples), measure(it)))
                .collect()
        };
        let slope = scenes.iter().map(|scene| scene.slope(measure)).sum::<f64>();
        let slope = slope / scenes.len().max(1) as f64;
        let fewer = |scene: &&SampledScene| scene.error(4, measure) < scene.error(1, measure);
        let better = scenes.iter().filter(fewer).count();
        let series = scenes.iter().zip(INKS.into_iter().cycle());
        section.chart(
            &format!("d-samples-{short_name}"),
            Chart {
                title: format!(
                    "four samples do better than one on {better} of {} scenes; slope {slope:.2}",
                    scenes.len()
                ),
                subtitle: "Error against samples a pixel, a line a scene; the slope of both logarithms is their mean."
                    .to_owned(),
                x: Axis::log("samples a pixel", SAMPLES.map(f64::from)),
                y: Axis::log(label, scenes.iter().flat_map(points).map(|point| point.1)),
                series: series
                    .map(|(scene, ink)| Series::line(scene.name.clone(), points(scene), ink))
                    .collect(),
                better: Better::LowerLeft,
            },
        );
    }
    let mut table = Table::new(&[
        "scene", "RMSE: 1", "2", "4", "16", "64", "slope", "FLIP: 1", "2", "4", "16", "64", "slope",
    ]);
    for scene in scenes {
        let mut row: Vec<Cell> = vec![scene.name.as_str().into()];
        for (_, _, measure) in measures {
            for samples in [1, 2, 4, 16, 64] {
                row.push(Cell::short(scene.error(samples, measure)));
            }
            row.push(Cell::decimals(scene.slope(measure), 2));
        }
        table.row(row);
    }
    section.table("d-samples", table);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshes;
    use crate::stage::scene_of;
    use raycast_core::glam::DVec3;

    #[test]
    fn four_samples_are_nearer_the_truth_than_one() {
        let spheres = [0.0, 1.5].map(|x| meshes::sphere(DVec3::new(x, 0.0, -x), 1.0, 12));
        let inputs = [Input {
            name: "spheres".to_owned(),
            scene: Arc::new(scene_of(spheres)),
            parsing: None,
        }];
        let scenes = measure(&inputs, &ReportBudget::QUICK, &()).expect("spheres can be cast at");
        let rmse: fn(&Difference) -> f64 = |d| d.rmse;
        let flip: fn(&Difference) -> f64 = |d| d.flip;
        let scene = &scenes[0];
        assert!(
            scene.error(4, rmse) < 0.6 * scene.error(1, rmse),
            "{scene:?}"
        );
        assert!(scene.error(4, flip) < scene.error(1, flip), "{scene:?}");
        assert!(scene.slope(rmse) < -0.6, "{}", scene.slope(rmse));
    }
}
