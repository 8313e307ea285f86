//! Chooses the tile of a picture for the figure, a packet of the tile, and a cell of the packet.

use raycast_core::camera::{Camera, Lattice, Rect};
use raycast_core::packet::{LargeTrace, PacketTrace};
use raycast_core::{Accel, Cull, MISS, Precision};
use std::collections::HashSet;

/// Columns and rows of the picture whose tile is shown. It is small, so that a tile is large in it.
pub(super) const SIZE: (u32, u32) = (512, 320);

/// Rays along each side of a cell, the unit in which triangles are tested before single rows of rays.
const CELL_SIDE: u32 = 8;

/// A tile of a picture, a packet of the tile, and a cell of the packet.
pub(super) struct Chosen {
    pub(super) large: LargeTrace,
    pub(super) packet: PacketTrace,
    pub(super) cell: Lattice,
    /// The number of distinct triangles that rays of the tile hit, and of the cell.
    pub(super) seen: usize,
    pub(super) cell_seen: usize,
}

/// The tile with most to show: many visible triangles, a silhouette, near the middle, and in the right half, from
/// which the figure is seen. `None` if no ray hits a triangle.
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
    accel.find_closest(&lattice, Cull::None, Precision::Exact, &mut primitives);
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
        .record_trace(&lattice, Cull::None)
        .into_iter()
        .max_by(|a, b| {
            let worth = |large: &LargeTrace| worth(&large.rays) * place(&large.rays);
            worth(a).total_cmp(&worth(b))
        })?;
    let packet = large.packets.iter();
    let packet = packet.max_by(|a, b| worth(&a.rays).total_cmp(&worth(&b.rays)));
    let packet = packet?.clone();
    let cells = (0..packet.rays.rows).step_by(CELL_SIDE as usize);
    let cells = cells.flat_map(|row| {
        let columns = (0..packet.rays.columns).step_by(CELL_SIDE as usize);
        columns.map(move |column| Lattice {
            x: packet.rays.x + column,
            y: packet.rays.y + row,
            columns: CELL_SIDE.min(packet.rays.columns - column),
            rows: CELL_SIDE.min(packet.rays.rows - row),
            ..packet.rays
        })
    });
    let cell = cells.max_by(|a, b| worth(a).total_cmp(&worth(b)))?;
    let (seen, cell_seen) = (found(&large.rays).0, found(&cell).0);
    (seen > 0).then_some(Chosen {
        packet,
        large,
        cell,
        seen,
        cell_seen,
    })
}
