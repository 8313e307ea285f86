//! The tile of a picture that has most to see, a block of it, and a sub-block of that.

use raycast_core::camera::{Camera, Lattice, Rect};
use raycast_core::packet::{LargeTrace, PacketTrace};
use raycast_core::{Accel, Cull, MISS, Precision};
use std::collections::HashSet;

/// Columns and rows of the picture whose tile is shown: few, so that a tile is large in it.
pub(super) const SIZE: (u32, u32) = (512, 320);

/// Rays along the side of a sub-block: the smallest block of rays that triangles are tested against before single rows.
const SUB_SIDE: u32 = 8;

/// A tile of a picture, a block of it, a sub-block of that.
pub(super) struct Chosen {
    pub(super) large: LargeTrace,
    pub(super) block: PacketTrace,
    pub(super) sub: Lattice,
    /// Distinct triangles that the tile's rays hit, and the sub-block's.
    pub(super) seen: usize,
    pub(super) sub_seen: usize,
}

/// The tile with most to see: many triangles, not all of it covered, near the middle, in the right half,
/// which the figure is seen from.
pub(super) fn choose(accel: &Accel, camera: &Camera) -> Option<Chosen> {
    let (columns, rows) = SIZE;
    let whole = Rect {
        x: 0,
        y: 0,
        width: columns,
        height: rows,
    };
    let lattice = camera.sub_camera(whole).lattice();
    let mut primitives = Vec::new();
    accel.find(&lattice, Cull::None, Precision::Exact, &mut primitives);
    let found = |rays: &Lattice| -> (usize, f64) {
        let rows = rays.y..rays.y + rays.rows;
        let places = rows.flat_map(|y| (rays.x..rays.x + rays.columns).map(move |x| (x, y)));
        let primitives = places.map(|(x, y)| primitives[(y * columns + x) as usize]);
        let met: Vec<u32> = primitives.filter(|&primitive| primitive != MISS).collect();
        let covered = met.len() as f64 / rays.len() as f64;
        (met.into_iter().collect::<HashSet<_>>().len(), covered)
    };
    let worth = |rays: &Lattice| -> f64 {
        let (seen, covered) = found(rays);
        let shows_silhouette = (0.3..0.95).contains(&covered);
        seen as f64 * if shows_silhouette { 2.0 } else { 1.0 }
    };
    let place = |rays: &Lattice| -> f64 {
        let x = f64::from(rays.x) + f64::from(rays.columns) * 0.5 - f64::from(columns) * 0.5;
        let y = f64::from(rays.y) + f64::from(rays.rows) * 0.5 - f64::from(rows) * 0.5;
        let off = (x * x + y * y).sqrt() / f64::from(rows);
        let half = if x > 0.0 { 1.0 } else { 0.25 };
        half / (1.0 + 4.0 * off * off)
    };
    let large = accel
        .levels(&lattice, Cull::None)
        .into_iter()
        .max_by(|a, b| {
            let worth = |large: &LargeTrace| worth(&large.rays) * place(&large.rays);
            worth(a).total_cmp(&worth(b))
        })?;
    let block = large.blocks.iter();
    let block = block.max_by(|a, b| worth(&a.rays).total_cmp(&worth(&b.rays)));
    let block = block?.clone();
    let subs = (0..block.rays.rows).step_by(SUB_SIDE as usize);
    let subs = subs.flat_map(|row| {
        let columns = (0..block.rays.columns).step_by(SUB_SIDE as usize);
        columns.map(move |column| Lattice {
            x: block.rays.x + column,
            y: block.rays.y + row,
            columns: SUB_SIDE.min(block.rays.columns - column),
            rows: SUB_SIDE.min(block.rays.rows - row),
            ..block.rays
        })
    });
    let sub = subs.max_by(|a, b| worth(a).total_cmp(&worth(b)))?;
    let (seen, sub_seen) = (found(&large.rays).0, found(&sub).0);
    (seen > 0).then_some(Chosen {
        block,
        large,
        sub,
        seen,
        sub_seen,
    })
}
