//! Picture F: how each level of packet traversal reduces the triangles that rays must be tested against.

use super::Section;
use super::chosen_tile::{Chosen, SIZE, choose};
use super::level_figure::LevelFigure;
use crate::subject::Input;
use crate::table::{Cell, ReportError, Table};
use crate::views;
use raycast_core::camera::Lattice;
use raycast_core::{Accel, Simd};
use std::collections::HashSet;

/// The traversal of one tile, as numbers and as a figure.
#[derive(Clone, Debug)]
pub struct TileTraversal {
    name: String,
    table: Table,
    png: Vec<u8>,
}

/// Traces the tile of a picture that has most to show.
///
/// `None` if no ray hits a triangle.
///
/// # Errors
/// A scene that cannot be built, a figure that cannot be drawn.
pub fn measure(input: &Input, simd: Simd) -> Result<Option<TileTraversal>, ReportError> {
    let accel = Accel::build(&input.scene)?.with_simd(simd);
    let camera = views::filling(&input.scene, SIZE, views::FOV, 1.1)?;
    let Some(chosen) = choose(&accel, &camera) else {
        return Ok(None);
    };
    let (center, radius) = input.scene.bounding_sphere();
    let figure = LevelFigure::new(&accel, &camera, &chosen, center, radius)?;
    Ok(Some(TileTraversal {
        name: input.name.clone(),
        table: numbers(&accel, &chosen),
        png: figure.sheet()?,
    }))
}

/// The number of triangles left at each level.
fn numbers(accel: &Accel, chosen: &Chosen) -> Table {
    let Chosen { large, packet, .. } = chosen;
    let count = |count: usize| Cell::from(count as u64);
    let rays = |rays: &Lattice| count(rays.len());
    let listed: usize = large
        .entry_points
        .iter()
        .map(|listed| listed.primitives.len())
        .sum();
    let mut table = Table::new(&[
        "level",
        "rays",
        "nodes tested",
        "subtrees listed",
        "triangles in reach",
        "set up",
        "seen",
    ]);
    table.row(vec![
        "the picture".into(),
        Cell::from(u64::from(SIZE.0) * u64::from(SIZE.1)),
        Cell::Empty,
        Cell::Empty,
        count(accel.len()),
        Cell::Empty,
        Cell::Empty,
    ]);
    let packets = || large.packets.iter();
    table.row(vec![
        "the tile".into(),
        rays(&large.rays),
        large.nodes.into(),
        count(large.entry_points.len()),
        count(listed),
        count(distinct(packets().map(|packet| &packet.set_up))),
        count(chosen.seen),
    ]);
    table.row(vec![
        "the packet".into(),
        rays(&packet.rays),
        packet.nodes.into(),
        Cell::Empty,
        count(packet.reached.len()),
        count(packet.set_up.len()),
        count(packet.seen.len()),
    ]);
    table.row(vec![
        "the cell".into(),
        rays(&chosen.cell),
        Cell::Empty,
        Cell::Empty,
        Cell::Empty,
        Cell::Empty,
        count(chosen.cell_seen),
    ]);
    table
}

fn distinct<'a>(primitives: impl Iterator<Item = &'a Vec<u32>>) -> usize {
    primitives.flatten().collect::<HashSet<_>>().len()
}

/// Adds the figure and the numbers.
pub fn show(section: &mut Section, shown: TileTraversal) {
    section.paragraph("## F. A tile's way down the tree");
    section.paragraph(format!(
        "One tile of a picture of {}, as it is cast. Its frustum walks down the tree until it has a short \
         list of subtrees that it touches; each of its packets starts from that list, and sets up what its \
         own frustum reaches and nothing nearer hides. A large triangle is tested against whole cells of rays before \
         single rows of them.",
        shown.name
    ));
    section.paragraph(
        "![The frusta of a tile, a packet and a cell, and the triangles that each leaves]\
         (f-levels.png)",
    );
    section
        .pictures
        .push(("f-levels.png".to_owned(), shown.png));
    section.paragraph(
        "The packet is one of the tile's, the cell one of the packet's. In reach are all triangles of \
         the scene, those of the tile's subtrees, those of the leaves that the packet comes to. Set up for \
         the tile is what any of its packets sets up.",
    );
    section.table("f-levels", shown.table);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::bumpy_sphere;
    use crate::sections::level_figure::{
        CELL_INK, LEFT_OUT, LISTED, PACKET_INK, SEEN, SET_UP, SHEET, TILE_INK,
    };
    use crate::stage::scene_of;
    use raycast_core::scene::Color;
    use raycast_core::scene::Scene;
    use std::sync::Arc;

    fn input(scene: Scene) -> Input {
        Input {
            name: "ball".to_owned(),
            scene: Arc::new(scene),
            parsing: None,
        }
    }

    #[test]
    fn each_level_leaves_fewer() {
        let input = input(scene_of([bumpy_sphere(2000)]));
        let shown = measure(&input, Simd::best()).expect("a picture");
        let shown = shown.expect("something is seen");
        let column = |name: &str| -> Vec<f64> {
            let at = shown.table.columns.iter().position(|column| column == name);
            let cells = shown
                .table
                .rows
                .iter()
                .map(|row| &row[at.expect("a column")]);
            let numbers = cells.filter_map(|cell| match cell {
                Cell::Number(_, number) => Some(*number),
                _ => None,
            });
            numbers.collect()
        };
        for name in ["rays", "triangles in reach", "set up", "seen"] {
            let numbers = column(name);
            assert!(numbers.len() > 1 && numbers.iter().all(|&number| number > 0.0));
            assert!(
                numbers.windows(2).all(|pair| pair[0] > pair[1]),
                "{name}: {numbers:?}"
            );
        }
        let picture = image::load_from_memory(&shown.png)
            .expect("a PNG")
            .to_rgb8();
        assert_eq!(picture.dimensions(), SHEET);
        // Every colour of the legend occurs in the figure.
        for Color(color) in [
            LEFT_OUT, LISTED, SET_UP, SEEN, TILE_INK, PACKET_INK, CELL_INK,
        ] {
            assert!(picture.pixels().any(|pixel| pixel.0 == color), "{color:?}");
        }
    }

    #[test]
    fn an_empty_scene_has_no_traversal() {
        assert!(
            measure(&input(Scene::default()), Simd::best())
                .expect("no error")
                .is_none()
        );
    }
}
