use crate::meshes::mesh;
use raycast_core::glam::DVec3;
use raycast_core::math::{cos, sin, sin_cos};
use raycast_core::scene::Mesh;
use std::f64::consts::{PI, TAU};

/// A closed ball of radius 1 with bumps of two sizes, of at most so many triangles (and no fewer than
/// 48) as longitudes and latitudes allow: triangles of many shapes, fronts outwards.
pub fn bumpy_sphere(triangles: u32) -> Mesh {
    // Two triangles a cell, one at the poles, and half as many rings as steps around.
    let steps = (f64::from(triangles.max(48)).sqrt() as u32 + 1) & !1;
    let rings = (0..=steps / 2)
        .rev()
        .find(|rings| 2 * steps * (rings.max(&1) - 1) <= triangles.max(48))
        .unwrap_or(2)
        .max(2);
    let point = |ring: u32, step: u32| {
        let (latitude_sin, latitude_cos) = sin_cos(PI * f64::from(ring) / f64::from(rings));
        let (x, z) = sin_cos(TAU * f64::from(step) / f64::from(steps));
        let unit = DVec3::new(x * latitude_sin, latitude_cos, z * latitude_sin);
        let coarse = sin(7.0 * unit.x) * sin(6.0 * unit.y) * cos(5.0 * unit.z);
        let fine = sin(31.0 * unit.x) * cos(29.0 * unit.y) * sin(37.0 * unit.z);
        unit * (1.0 + 0.12 * coarse + 0.02 * fine)
    };
    let mut positions = vec![point(0, 0)];
    for ring in 1..rings {
        positions.extend((0..steps).map(|step| point(ring, step)));
    }
    let bottom = positions.len() as u32;
    positions.push(point(rings, 0));
    let at = |ring: u32, step: u32| 1 + (ring - 1) * steps + step % steps;
    let mut faces = Vec::with_capacity(triangles as usize);
    for step in 0..steps {
        faces.push([0, at(1, step), at(1, step + 1)]);
        for ring in 1..rings - 1 {
            let [a, b] = [at(ring, step), at(ring, step + 1)];
            let [c, d] = [at(ring + 1, step), at(ring + 1, step + 1)];
            faces.push([a, c, d]);
            faces.push([a, d, b]);
        }
        faces.push([at(rings - 1, step), bottom, at(rings - 1, step + 1)]);
    }
    mesh(positions, faces)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn it_is_closed_and_as_large_as_was_asked() {
        for count in [1000, 20_000] {
            let ball = bumpy_sphere(count);
            let made = ball.triangles().len() as u32;
            assert!(made <= count && made * 10 >= count * 8, "{made} of {count}");
            assert_eq!(ball.dropped().total(), 0);
            let edge = |triangle: &[u32; 3]| {
                [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (triangle[a], triangle[b]))
            };
            let edges: HashSet<(u32, u32)> = ball.triangles().iter().flat_map(edge).collect();
            assert_eq!(edges.len(), made as usize * 3);
            assert!(edges.iter().all(|&(a, b)| edges.contains(&(b, a))));
        }
    }
}
