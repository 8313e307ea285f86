//! Edges, and the faces that share them.

use rayon::prelude::*;

/// A face: its triangle's number, and the welded vertices of its corners, all different.
pub(super) type Face = (u32, [u32; 3]);

/// A face at an edge. The edge's lower vertex comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    pub(super) edge: [u32; 2],
    /// The face's index in the list of faces.
    pub(super) face: u32,
    /// Whether the face runs along the edge from the lower vertex to the higher.
    pub(super) is_forward: bool,
}

/// All sides of all faces, those of one edge next to one another.
pub(super) fn sides(faces: &[Face]) -> Vec<Side> {
    let mut sides: Vec<Side> = faces
        .par_iter()
        .enumerate()
        .flat_map_iter(|(face, (_, [a, b, c]))| {
            [[*a, *b], [*b, *c], [*c, *a]].map(|[from, to]| Side {
                edge: [from.min(to), from.max(to)],
                face: face as u32,
                is_forward: from < to,
            })
        })
        .collect();
    sides.par_sort_unstable();
    sides
}

/// The sides grouped by edge.
pub(super) fn by_edge(sides: &[Side]) -> impl Iterator<Item = &[Side]> {
    sides.chunk_by(|a, b| a.edge == b.edge)
}
