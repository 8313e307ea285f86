//! The cost of each texture filter, and the error of its picture.

use super::Section;
use super::density::{render, to_rgb};
use crate::budget::ReportBudget;
use crate::metrics::Difference;
use crate::progress::ReportProgress;
use crate::table::{Cell, ReportError, Table};
use crate::timing::{Spread, interleaved};
use raycast_core::Accel;
use raycast_core::camera::{Camera, PlaneRequest, Pose, Projection, fov_to_frame};
use raycast_core::glam::{DVec3, Vec2};
use raycast_core::render::{Settings, View};
use raycast_core::scene::{Attribute, Mesh, MeshData, Object, Scene, Texture};
use raycast_core::shade::{Filter, Mode, Shading};
use std::sync::Arc;

const FILTERS: [(&str, Filter); 4] = [
    ("nearest", Filter::Nearest),
    ("bilinear", Filter::Bilinear),
    ("trilinear", Filter::Trilinear),
    ("EWA", Filter::Ewa),
];

/// A picture with one sample per pixel and one filter.
#[derive(Clone, Debug)]
pub struct Filtered {
    /// The filter's name.
    pub filter: &'static str,
    /// Milliseconds to render it.
    pub ms: Spread,
    /// The difference from the reference.
    pub difference: Difference,
}

/// Renders a checkerboard that extends to the horizon with each filter, and compares each picture with one of very
/// many bilinear samples per pixel.
///
/// # Errors
/// A scene that cannot be built, an invalid camera.
pub fn measure(
    budget: &ReportBudget,
    progress: &dyn ReportProgress,
) -> Result<Vec<Filtered>, ReportError> {
    let (width, height) = budget.compared;
    let (eye, target) = (DVec3::new(0.3, 1.0, 0.0), DVec3::new(0.0, 0.4, -2.0));
    let plane = PlaneRequest {
        size: Some((width, height)),
        ..PlaneRequest::default()
    }
    .resolve((width, height), fov_to_frame(45.0, eye.distance(target)))?;
    let scene = board();
    let view = |filter: Filter, samples: u32| -> Result<View, ReportError> {
        Ok(View {
            accel: Arc::new(Accel::build(&scene)?.with_simd(budget.simd)),
            scene: Arc::new(scene.clone()),
            camera: Camera::new(Pose::towards(eye, target), Projection::Perspective, plane),
            settings: Settings {
                shading: Shading {
                    mode: Mode::Texture,
                    filter,
                    ..Shading::default()
                },
                samples,
                ..Settings::default()
            },
        })
    };
    let reference = to_rgb(&render(&view(Filter::Bilinear, budget.samples)?));
    let views = FILTERS.map(|(_, filter)| view(filter, 1));
    let views = views.into_iter().collect::<Result<Vec<_>, _>>()?;
    let rounds = budget.rounds;
    progress.begin("texture filters", (views.len() * (rounds + 1)) as u64);
    let mut works: Vec<Box<dyn FnMut() + Send>> = Vec::new();
    for view in &views {
        works.push(Box::new(move || {
            std::hint::black_box(render(view));
        }));
    }
    let times = interleaved(rounds, &mut works, &|| progress.step());
    let each = FILTERS.iter().zip(&views).zip(times);
    each.map(|((&(filter, _), view), seconds)| {
        Ok(Filtered {
            filter,
            ms: seconds.scaled(1e3),
            difference: Difference::between(&to_rgb(&render(view)), &reference)?,
        })
    })
    .collect()
}

/// A square of 200 × 200 units centred on the origin, with 8 × 8 checkers per unit square.
fn board() -> Scene {
    let corners = [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)];
    let mesh = Mesh::new(MeshData {
        positions: corners.map(|(x, z)| DVec3::new(x, 0.0, z) * 100.0).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        uvs: Some(Attribute {
            values: corners
                .map(|(x, z)| Vec2::new(x as f32, -z as f32) * 100.0)
                .to_vec(),
            indices: None,
        }),
        ..MeshData::default()
    });
    let mut object = Object::new("board", Arc::new(mesh));
    let texel = |at: u32| {
        let (x, y) = (at % 128 / 16, at / 128 / 16);
        [[240, 240, 240, 255], [16, 16, 16, 255]][(x + y) as usize % 2]
    };
    object.texture = Texture::new(128, 128, (0..128 * 128).map(texel).collect()).map(Arc::new);
    Scene {
        objects: vec![object],
    }
}

/// Adds the table and its explanation.
pub fn show(section: &mut Section, budget: &ReportBudget, filtered: &[Filtered]) {
    let (width, height) = budget.compared;
    section.paragraph(format!(
        "Texture filters on a checkerboard that reaches to the horizon, {width} × {height} at one ray a \
         pixel, against {} rays a pixel: root mean square of 8-bit values, and FLIP.",
        budget.samples
    ));
    let mut table = Table::new(&["filter", "ms", "deviation", "RMSE", "FLIP"]);
    for one in filtered {
        table.row(vec![
            one.filter.into(),
            Cell::short(one.ms.median),
            Cell::short(one.ms.deviation),
            Cell::short(one.difference.rmse),
            Cell::decimals(one.difference.flip, 4),
        ]);
    }
    section.table("e-filters", table);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_over_footprints_are_nearer_the_reference() {
        let filtered = measure(&ReportBudget::QUICK, &()).expect("a board can be cast at");
        let of = |name: &str| {
            let mut all = filtered.iter();
            let one = all.find(|one| one.filter == name).expect("it is measured");
            one.difference.rmse
        };
        assert!(
            of("EWA") < 0.6 * of("trilinear") && of("EWA") < 0.4 * of("bilinear"),
            "{filtered:?}"
        );
    }
}
