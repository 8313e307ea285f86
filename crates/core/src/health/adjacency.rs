//! What lies across the edges of a mesh's triangles.

use super::edges::{by_edge, sides};
use super::report::faces;
use crate::scene::{Across, Adjacency, Mesh, weld};

/// What lies across each edge of a mesh's triangles, by the faces that [`check`](super::check) counts. Computed on
/// first use, with some 100 bytes of memory a triangle; the mesh keeps twelve of them.
pub(crate) fn adjacency(mesh: &Mesh) -> &Adjacency {
    mesh.adjacency(|| {
        let (faces, _) = faces(mesh, &weld(mesh.positions()));
        let mut adjacency = Adjacency::of(mesh.triangles().len());
        for edge in by_edge(&sides(&faces)) {
            for (at, side) in edge.iter().enumerate() {
                let (number, corners) = faces[side.face as usize];
                let is_this = |k: &usize| {
                    let (from, to) = (corners[*k], corners[(*k + 1) % 3]);
                    [from.min(to), from.max(to)] == side.edge
                };
                let Some(k) = (0..3).find(is_this) else {
                    continue;
                };
                let across = match edge {
                    [_] => Across::Boundary,
                    [_, _] => {
                        let (_, other) = faces[edge[1 - at].face as usize];
                        let apex = other.iter().find(|corner| !side.edge.contains(corner));
                        apex.map_or(Across::NoFace, |apex| Across::Face(*apex))
                    }
                    _ => Across::NonManifold,
                };
                adjacency.set(number, k, across);
            }
        }
        adjacency
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::MeshData;
    use glam::DVec3;

    #[test]
    fn each_edge_knows_what_lies_across() {
        // A square of two triangles, the second with vertices of its own, one of them at minus zero; two fins on the
        // edge from 1 to 2; a duplicate of the first triangle; and one with two corners at one position.
        let positions = [
            [0., 0., 0.],
            [1., 0., 0.],
            [1., 1., 0.],
            [-0., 0., 0.],
            [1., 1., 0.],
            [0., 1., 0.],
            [1., 0., 1.],
            [1., 0., 2.],
        ];
        let mesh = Mesh::new(MeshData {
            positions: positions.map(DVec3::from_array).to_vec(),
            triangles: vec![
                [0, 1, 2],
                [3, 4, 5],
                [1, 2, 6],
                [2, 1, 7],
                [2, 0, 1],
                [0, 3, 5],
            ],
            ..MeshData::default()
        });
        use Across::{Boundary, Face, NoFace, NonManifold};
        let expected = [
            [Boundary, NonManifold, Face(5)],
            [Face(1), Boundary, Boundary],
            [NonManifold, Boundary, Boundary],
            [NonManifold, Boundary, Boundary],
            [NoFace; 3],
            [NoFace; 3],
        ];
        for (number, expected) in expected.into_iter().enumerate() {
            assert_eq!(adjacency(&mesh).on(number as u32), expected, "{number}");
        }
        assert_eq!(adjacency(&mesh).on(99), [NoFace; 3]);
    }
}
