//! A symmetric solid's surface as a closed triangle mesh.
//!
//! S. F. F. Gibson, "Constrained elastic surface nets", 1998: a vertex in each grid cell that the
//! surface passes through, joined to quads across the grid's edges, and relaxed to even spacing
//! while it is held to the surface. Only the half at `x ≥ 0` is made; [`HalfShell::mirrored`] adds
//! its exact mirror image.

use std::collections::HashMap;

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use crate::field::onto_surface;

const RELAXATIONS: usize = 5;

/// The half at `x ≥ 0` of a surface that is symmetric about `x = 0`. A vertex with `x == 0` lies
/// on the seam.
pub(crate) struct HalfShell {
    /// The vertices.
    pub positions: Vec<DVec3>,
    /// The triangles, counter-clockwise seen from outside, and a material number for each.
    pub triangles: Vec<([usize; 3], usize)>,
}

/// Samples `field` within `±half_size` on a grid of cubes `cell` wide, and gives all triangles
/// material 0. `field` must be symmetric in x and positive at the bounds.
pub(crate) fn surface_net(
    field: impl Fn(DVec3) -> f64 + Sync,
    half_size: DVec3,
    cell: f64,
) -> HalfShell {
    let count = (half_size / cell).ceil().as_ivec3() + 1;
    // The plane x = 0 halves the cells with x-index 0.
    let corner = |c: IVec3| (c.as_dvec3() - DVec3::new(0.5, 0.0, 0.0)) * cell;
    let depth = (2 * count.z + 1) as usize;
    let height = (2 * count.y + 1) as usize;
    let index = |c: IVec3| {
        (c.x as usize * height + (c.y + count.y) as usize) * depth + (c.z + count.z) as usize
    };
    let mut values = Vec::with_capacity((count.x + 1) as usize * height * depth);
    for x in 0..=count.x {
        for y in -count.y..=count.y {
            for z in -count.z..=count.z {
                values.push(field(corner(IVec3::new(x, y, z))));
            }
        }
    }
    let value = |c: IVec3| values[index(c)];

    let mut positions = Vec::new();
    let mut vertex_of_cell = HashMap::new();
    for x in 0..count.x {
        for y in -count.y..count.y {
            for z in -count.z..count.z {
                let cell_at = IVec3::new(x, y, z);
                if let Some(mut p) = mean_crossing(cell_at, value, corner) {
                    p = onto_surface(&field, p, cell / 2.0);
                    if x == 0 {
                        p.x = 0.0;
                    }
                    vertex_of_cell.insert(cell_at, positions.len());
                    positions.push(p);
                }
            }
        }
    }

    let mut quads = Vec::new();
    // Corners with x-index 0 are the mirror images of those with 1.
    for x in 1..count.x {
        for y in 1 - count.y..count.y {
            for z in 1 - count.z..count.z {
                let start = IVec3::new(x, y, z);
                for axis in 0..3 {
                    let along = IVec3::AXES[axis];
                    let (u, v) = (IVec3::AXES[(axis + 1) % 3], IVec3::AXES[(axis + 2) % 3]);
                    let (from, to) = (value(start), value(start + along));
                    if (from < 0.0) == (to < 0.0) {
                        continue;
                    }
                    let mut quad = [start - u - v, start - v, start, start - u]
                        .map(|cell_at| vertex_of_cell[&cell_at]);
                    if to < 0.0 {
                        quad.reverse();
                    }
                    quads.push(quad);
                }
            }
        }
    }

    relax(&field, &mut positions, &quads, cell);
    let triangles = quads
        .iter()
        .flat_map(|&[a, b, c, d]| {
            let square = |i: usize, j: usize| positions[i].distance_squared(positions[j]);
            if square(a, c) <= square(b, d) {
                [([a, b, c], 0), ([a, c, d], 0)]
            } else {
                [([a, b, d], 0), ([b, c, d], 0)]
            }
        })
        .collect();
    HalfShell {
        positions,
        triangles,
    }
}

/// The mean of the points where a cell's twelve edges pass through the surface.
fn mean_crossing(
    cell_at: IVec3,
    value: impl Fn(IVec3) -> f64,
    corner: impl Fn(IVec3) -> DVec3,
) -> Option<DVec3> {
    let (mut sum, mut crossings) = (DVec3::ZERO, 0);
    for axis in 0..3 {
        let along = IVec3::AXES[axis];
        let (u, v) = (IVec3::AXES[(axis + 1) % 3], IVec3::AXES[(axis + 2) % 3]);
        for offset in [IVec3::ZERO, u, v, u + v] {
            let (start, end) = (cell_at + offset, cell_at + offset + along);
            let (from, to) = (value(start), value(end));
            if (from < 0.0) != (to < 0.0) {
                sum += corner(start).lerp(corner(end), from / (from - to));
                crossings += 1;
            }
        }
    }
    (crossings > 0).then(|| sum / f64::from(crossings))
}

/// Moves vertices towards the mean of their neighbours, and back onto the surface.
fn relax(
    field: impl Fn(DVec3) -> f64 + Sync,
    positions: &mut [DVec3],
    quads: &[[usize; 4]],
    cell: f64,
) {
    for _ in 0..RELAXATIONS {
        let mut sums = vec![(DVec3::ZERO, 0.0); positions.len()];
        for quad in quads {
            for i in 0..4 {
                let (a, b) = (quad[i], quad[(i + 1) % 4]);
                // Each quad across an edge counts it once. A seam vertex's mirrored neighbours would
                // double every term of its sum but those along the seam, which are met from one
                // quad here and from two in the whole: so nothing is lost by leaving them out.
                let mut add = |to: usize, from: usize| {
                    sums[to].0 += positions[from];
                    sums[to].1 += 1.0;
                };
                add(a, b);
                add(b, a);
            }
        }
        let moves = positions.par_iter_mut().zip(sums);
        moves.for_each(|(position, (sum, weight))| {
            let on_seam = position.x == 0.0;
            let target = position.lerp(sum / weight, 0.5);
            *position = onto_surface(&field, target, cell / 2.0);
            if on_seam {
                position.x = 0.0;
            }
        });
    }
}

impl HalfShell {
    /// The whole, closed shell.
    pub(crate) fn mirrored(&self) -> Self {
        let mut positions = self.positions.clone();
        let twin: Vec<usize> = self
            .positions
            .iter()
            .enumerate()
            .map(|(index, &p)| {
                if p.x == 0.0 {
                    return index;
                }
                positions.push(DVec3::new(-p.x, p.y, p.z));
                positions.len() - 1
            })
            .collect();
        let mut triangles = self.triangles.clone();
        triangles.extend(
            self.triangles
                .iter()
                .map(|&([a, b, c], material)| ([twin[a], twin[c], twin[b]], material)),
        );
        Self {
            positions,
            triangles,
        }
    }
}
