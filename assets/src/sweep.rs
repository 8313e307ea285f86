//! Closed round solids along a spine: balls, caps, locks of hair, stems.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use crate::obj::{Corner, Face, Model};

/// A place on the spine, the solid's radius there, and the material of the band that ends there.
/// The first and the last one are poles, with radius 0.
pub(crate) type Station = (DVec3, f64, usize);

/// The solid of `segments` sides around the `stations`. The rings' first vertices, where the
/// texture starts, lie towards `reference`, which the spine must nowhere be parallel to.
pub(crate) fn sweep(stations: &[Station], segments: usize, reference: DVec3) -> Model {
    let mut model = Model::default();
    let last = stations.len() - 1;
    for (i, &(centre, radius, _)) in stations.iter().enumerate() {
        let v = 1.0 - i as f64 / last as f64;
        if i == 0 || i == last {
            model.positions.push(centre);
            model.uvs.push(DVec2::new(0.5, v));
            continue;
        }
        // Where the spine stands still, as it does on a flat end, the way from end to end will do.
        let step = stations[i + 1].0 - stations[i - 1].0;
        let whole = stations[last].0 - stations[0].0;
        let along = step.try_normalize().unwrap_or_else(|| whole.normalize());
        let right = reference.reject_from_normalized(along).normalize();
        let up = along.cross(right);
        for segment in 0..segments {
            let u = segment as f64 / segments as f64;
            let (sin, cos) = libm::sincos(TAU * u);
            model
                .positions
                .push(centre + (right * cos + up * sin) * radius);
            model.uvs.push(DVec2::new(u, v));
        }
    }
    for (band, &(_, _, material)) in stations.iter().enumerate().skip(1) {
        for segment in 0..segments {
            // Ring 0 is the first pole's one vertex, and the last pole comes after all rings.
            let ring = |ring: usize, segment: usize| match ring {
                0 => 0,
                _ if ring == last => (last - 1) * segments + 1,
                _ => (ring - 1) * segments + 1 + segment % segments,
            };
            let mut corners = vec![
                ring(band - 1, segment),
                ring(band - 1, segment + 1),
                ring(band, segment + 1),
                ring(band, segment),
            ];
            corners.dedup();
            model.faces.push(Face {
                material,
                corners: corners.into_iter().map(Corner::all).collect(),
            });
        }
    }
    model.smooth_normals();
    model
}

/// A ball's stations from the pole at `axis`: each ring by its angle from there in degrees.
pub(crate) fn ball(
    centre: DVec3,
    radius: f64,
    axis: DVec3,
    rings: &[(f64, usize)],
) -> Vec<Station> {
    rings
        .iter()
        .map(|&(angle, material)| {
            let (sin, cos) = libm::sincos(angle.to_radians());
            (centre + axis * (radius * cos), radius * sin, material)
        })
        .collect()
}
