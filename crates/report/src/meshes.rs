//! Meshes made in code, with corners at which rays tend to leak.

use raycast_core::glam::DVec3;
use raycast_core::math;
use raycast_core::scene::{Mesh, MeshData};
use raycast_oracle::random::Random;

/// A mesh of these vertices and triangles.
pub fn mesh(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh::new(MeshData {
        positions,
        triangles,
        ..MeshData::default()
    })
}

/// A mesh of triangles that share no vertices.
pub fn soup(corners: &[[DVec3; 3]]) -> Mesh {
    let positions = corners.iter().flatten().copied().collect();
    let triangles = (0..corners.len() as u32)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect();
    mesh(positions, triangles)
}

/// A grid of `columns × rows` quads, two triangles each, with vertices at `point(column, row)`. Counter-clockwise
/// where columns run right and rows run up.
pub fn grid(columns: u32, rows: u32, mut point: impl FnMut(u32, u32) -> DVec3) -> Mesh {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for row in 0..=rows {
        for column in 0..=columns {
            positions.push(point(column, row));
            if row < rows && column < columns {
                let here = row * (columns + 1) + column;
                let above = here + columns + 1;
                triangles.push([here, here + 1, above + 1]);
                triangles.push([here, above + 1, above]);
            }
        }
    }
    mesh(positions, triangles)
}

/// A closed sphere with `steps` of longitude and half as many of latitude, fronts outwards.
pub fn sphere(center: DVec3, radius: f64, steps: u32) -> Mesh {
    let rings = steps / 2;
    let mut positions = vec![center + DVec3::Y * radius];
    for ring in 1..rings {
        let (sin, cos) = math::sin_cos(std::f64::consts::PI * f64::from(ring) / f64::from(rings));
        for step in 0..steps {
            let (x, z) = math::sin_cos(std::f64::consts::TAU * f64::from(step) / f64::from(steps));
            positions.push(center + DVec3::new(x * sin, cos, z * sin) * radius);
        }
    }
    let bottom = positions.len() as u32;
    positions.push(center - DVec3::Y * radius);
    let at = |ring: u32, step: u32| 1 + (ring - 1) * steps + step % steps;
    let mut triangles = Vec::new();
    for step in 0..steps {
        triangles.push([0, at(1, step), at(1, step + 1)]);
        for ring in 1..rings - 1 {
            let [a, b] = [at(ring, step), at(ring, step + 1)];
            let [c, d] = [at(ring + 1, step), at(ring + 1, step + 1)];
            triangles.push([a, c, d]);
            triangles.push([a, d, b]);
        }
        triangles.push([at(rings - 1, step), bottom, at(rings - 1, step + 1)]);
    }
    mesh(positions, triangles)
}

/// The corners of an octahedron at distance 1 along the axes, fronts outwards.
pub fn octahedron() -> Mesh {
    let positions = vec![
        DVec3::X,
        DVec3::NEG_X,
        DVec3::Y,
        DVec3::NEG_Y,
        DVec3::Z,
        DVec3::NEG_Z,
    ];
    let triangles = vec![
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    mesh(positions, triangles)
}

/// An axis-aligned box, two triangles a face, fronts outwards.
pub fn cuboid(low: DVec3, high: DVec3) -> Mesh {
    let (positions, triangles) = cuboid_parts(low, high);
    mesh(positions.to_vec(), triangles.collect())
}

/// A box's corners, and its triangles by their corners.
pub(crate) fn cuboid_parts(
    low: DVec3,
    high: DVec3,
) -> ([DVec3; 8], impl Iterator<Item = [u32; 3]>) {
    let positions = std::array::from_fn(|i| {
        DVec3::new(
            if i & 1 == 0 { low.x } else { high.x },
            if i & 2 == 0 { low.y } else { high.y },
            if i & 4 == 0 { low.z } else { high.z },
        )
    });
    let quads = [
        [4, 5, 7, 6],
        [1, 0, 2, 3],
        [5, 1, 3, 7],
        [0, 4, 6, 2],
        [6, 7, 3, 2],
        [0, 1, 5, 4],
    ];
    let triangles = quads
        .into_iter()
        .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    (positions, triangles)
}

/// Hills with integer heights at integer positions, 0 to `side` along x and y.
pub fn integer_heights(side: u32, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let heights: Vec<f64> = (0..(side + 1) * (side + 1))
        .map(|_| f64::from(random.below(7)))
        .collect();
    grid(side, side, |x, y| {
        let height = heights[(y * (side + 1) + x) as usize];
        DVec3::new(f64::from(x), f64::from(y), height)
    })
}

/// `count` random triangles of `size` (relative to the scale) in the cube `middle ± scale`.
pub fn random_soup(random: &mut Random, count: u32, middle: DVec3, scale: f64, size: f64) -> Mesh {
    let corners: Vec<[DVec3; 3]> = (0..count)
        .map(|_| {
            let place = middle + random.in_cube() * scale;
            std::array::from_fn(|_| place + random.in_cube() * scale * size)
        })
        .collect();
    soup(&corners)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    /// Each edge is used once in each direction, and the volume inside is positive.
    fn assert_closed(mesh: &Mesh) {
        let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
        let mut volume = 0.0;
        for triangle in mesh.triangles() {
            let [a, b, c] = triangle.map(|i| mesh.positions()[i as usize].as_dvec3());
            volume += a.dot(b.cross(c));
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                *edges.entry((triangle[from], triangle[to])).or_default() += 1;
            }
        }
        assert!(volume > 0.0, "fronts inwards");
        for ((from, to), count) in &edges {
            assert_eq!((*count, edges.get(&(*to, *from))), (1, Some(&1)));
        }
        assert_eq!(mesh.dropped().total(), 0);
    }

    #[test]
    fn closed_meshes_are_closed() {
        assert_closed(&sphere(DVec3::ZERO, 2.0, 20));
        assert_closed(&octahedron());
        assert_closed(&cuboid(DVec3::splat(-1.0), DVec3::ONE));
    }
}
