//! Patches against the lens's definition: all of Newton's steps for each place.

use super::*;
use crate::camera::lens_region::tests::lenses;
use crate::math;
use crate::random::Random;

const SIDE: usize = 32;

/// Lenses of all kinds, and such that are only decentred: their third and fourth derivatives are zero, those of their
/// inverses are not.
fn all_lenses() -> impl Iterator<Item = BrownConrady> {
    let mut random = Random(54);
    let decentred = (0..100).map(move |_| {
        let [p1, p2] = [(); 2].map(|()| 0.3 * random.signed());
        BrownConrady::new([0.0, 0.0, p1, p2, 0.0]).expect("finite")
    });
    lenses().chain(decentred)
}

/// Places of a rectangle of at most [`SIDE`] columns and rows.
struct Rectangle {
    columns: Vec<f64>,
    width: usize,
    first: f64,
    step: f64,
    height: usize,
}

impl Rectangle {
    fn random(random: &mut Random, step: f64) -> Self {
        let [width, height] = [(); 2].map(|()| match random.unit() < 0.5 {
            true => SIDE,
            false => 2 + random.decades(0.0, 1.5) as usize % (SIDE - 1),
        });
        let (left, first) = (1.2 * random.signed(), 0.8 * random.signed());
        let column = |column: usize| left + step * column as f64;
        Self {
            columns: (0..width + LANES).map(column).collect(),
            width,
            first,
            step,
            height,
        }
    }

    fn places(&self) -> PatchPlaces<'_> {
        PatchPlaces {
            columns: &self.columns,
            width: self.width,
            first: self.first,
            step: self.step,
            height: self.height,
        }
    }

    fn down(&self, row: usize) -> f64 {
        self.first + self.step * row as f64
    }

    fn patch(&self, lens: &BrownConrady, larger: Option<&LensPatch>) -> Option<LensPatch> {
        let across = (self.columns[0], self.columns[self.width - 1]);
        let along = (-self.down(self.height - 1), -self.first);
        LensPatch::new(lens, across, along, self.step, larger)
    }
}

/// Both ways: interpolated, and every row by itself. Without the bound of interpolation this fails.
#[test]
fn places_are_within_the_tolerance_of_their_directions() {
    let mut random = Random(51);
    let (mut found, mut interpolated, mut worst) = (0, 0, 0.0_f64);
    for lens in all_lenses() {
        for _ in 0..40 {
            let step = random.decades(-4.0, -1.0);
            let rectangle = Rectangle::random(&mut random, step);
            let Some(patch) = rectangle.patch(&lens, None) else {
                continue;
            };
            let places = rectangle.places();
            let Some(tolerance) = patch.tolerance(step) else {
                continue;
            };
            // Places are differences from the first direction, so that single precision holds them.
            let corner = lens.direction(places.columns[0], -rectangle.first);
            let corner = corner.expect("a patch has directions");
            let scale = PlaceScale {
                corner: (corner.x, corner.y),
                inverse: 1.0 / step,
                margin: 0.0,
            };
            let [mut xs, mut ys] = [[f32::NAN; SIDE * SIDE]; 2];
            if !patch.find_places::<SIDE>(&places, &scale, (&mut xs, &mut ys)) {
                continue;
            }
            found += 1;
            let smooth = patch.smooth.expect("it has a tolerance");
            let blocks = patch.blocks(&smooth, &places, tolerance);
            interpolated += usize::from(blocks.is_some_and(|blocks| blocks.every == 2));
            for row in 0..rectangle.height {
                for column in 0..rectangle.width {
                    let (a, down) = (rectangle.columns[column], rectangle.down(row));
                    let truth = lens.direction(a, -down).expect("a patch has directions");
                    let at = row * SIDE + column;
                    let truth = [(truth.x - corner.x) / step, (corner.y - truth.y) / step];
                    for (place, truth) in [xs[at], ys[at]].into_iter().zip(truth) {
                        // That of the place, and of the difference above.
                        let rounding = truth.abs() / f64::from(1 << 24) + 1e-15 / step;
                        let off = (f64::from(place) - truth).abs() - rounding;
                        assert!(off * step <= tolerance, "{lens} {a} {down} {step}: {off:e}");
                        worst = worst.max(off * step / tolerance);
                    }
                }
            }
        }
    }
    let tried = found > 1000 && interpolated > 500 && found - interpolated > 100;
    assert!(tried && worst > 0.1, "{found} {interpolated} {worst}");
}

/// Windows contain the directions of patches of any size, and are little wider than these; also of those in a larger one.
#[test]
fn windows_contain_the_directions_of_their_places() {
    let mut random = Random(52);
    let (mut count, mut closest) = (0, 0.0_f64);
    for lens in all_lenses() {
        for _ in 0..40 {
            let step = random.decades(-4.0, -1.0);
            let rectangle = Rectangle::random(&mut random, step);
            let Some(mut patch) = rectangle.patch(&lens, None) else {
                continue;
            };
            if random.unit() < 0.5 {
                let within = rectangle.patch(&lens, Some(&patch));
                patch = within.expect("it is in itself");
            }
            let [xs, ys] = patch.window();
            for _ in 0..20 {
                // Corners, too.
                let mut index = |count: usize| {
                    let most = count as f64 - 1.0;
                    ((0.5 + random.signed()) * most).clamp(0.0, most) as usize
                };
                let (column, row) = (index(rectangle.width), index(rectangle.height));
                let (a, down) = (rectangle.columns[column], rectangle.down(row));
                let at = lens.direction(a, -down).expect("a patch has directions");
                for ((least, most), at) in [(xs, at.x), (ys, at.y)] {
                    assert!((least..=most).contains(&at), "{lens} {a} {down} {step}");
                    let middle = (least + most) * 0.5;
                    closest = closest.max((at - middle).abs() / (most - middle));
                }
                count += 1;
            }
        }
    }
    assert!(count > 20_000 && closest > 0.99, "{count} {closest}");
}

/// The truth is fourth differences of directions down a column.
#[test]
fn fourth_derivatives_are_no_less_than_differences_of_directions() {
    let mut random = Random(53);
    let (mut count, mut closest) = (0, 0.0_f64);
    for lens in all_lenses() {
        for _ in 0..40 {
            // Steps as long as rounding, 2⁴ε/h⁴, leaves something to see.
            let step = random.decades(-2.0, -1.5);
            let (x, y) = (1.2 * random.signed(), 0.8 * random.signed());
            let reach = 2.0 * step;
            let (across, along) = ((x - reach, x + reach), (-y - reach, -y + reach));
            if lens.region(across, along).is_none() {
                continue;
            }
            let middle = lens.direction(x, -y).expect("a region has directions");
            let near = Near::of(&lens.distortion, middle.x, -middle.y, 0.0);
            let Some(smooth) = near.and_then(|near| Smooth::within(&lens.distortion, &near, reach))
            else {
                continue;
            };
            let at = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|along: f64| {
                let y = y + along * step;
                lens.direction(x, -y).expect("a region has directions")
            });
            let fourth = (at[0] + at[4]) - 4.0 * (at[1] + at[3]) + 6.0 * at[2];
            let (bound, rounding) = (smooth.fourth * math::pow(step, 4.0), 1e-13);
            assert!(fourth.length() <= bound + rounding, "{lens} {x} {y} {step}");
            closest = closest.max((fourth.length() - rounding) / bound);
            count += 1;
        }
    }
    assert!(count > 500 && closest > 0.3, "{count} {closest}");
}
