//! What is wrong with a mesh.

use super::GoOn;
use super::edges::{Face, Side, by_edge, sides};
use super::shells::Sets;
use crate::num::roundoff::EPSILON;
use crate::scene::{Mesh, weld};
use glam::{DVec3, Vec3Swizzles as _};
use rayon::prelude::*;
use std::collections::HashSet;

/// How the triangles of a mesh join.
///
/// A *face* is a triangle whose corners are at three different positions; triangles at the same three positions are
/// one face. A face may still have no area. Places, edges and shells are those of faces.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Health {
    /// Distinct positions of faces' corners.
    pub positions: usize,
    /// Distinct edges of faces.
    pub edges: usize,
    /// Number of faces.
    pub faces: usize,
    /// Sets of faces connected by edges.
    pub shells: usize,
    /// Edges of exactly one face, as pairs of vertex numbers: boundaries of the surface, such as rims and holes.
    pub open_edges: Vec<[u32; 2]>,
    /// Edges of more than two faces.
    pub non_manifold_edges: Vec<[u32; 2]>,
    /// Triangles oriented against the majority of their part, a part being faces connected by edges of exactly two
    /// faces. Where the two orientations are equally frequent, that of the lowest number counts as right.
    pub flipped: Vec<u32>,
    /// Triangles that no ray can hit: without area, with a coordinate that is not finite or too large, or with a
    /// vertex index out of range.
    pub degenerate: Vec<u32>,
    /// Triangles at the same three positions as a triangle of a lower number, in either orientation.
    pub duplicates: Vec<u32>,
    /// Vertices that no triangle uses.
    pub unused_vertices: Vec<u32>,
    /// Parts that have one side only, as a Möbius band: nothing in them counts as flipped.
    pub one_sided: usize,
    /// Closed shells whose triangles run clockwise as seen from outside. A shell whose volume is zero within rounding
    /// is not counted.
    pub inside_out: usize,
}

impl Health {
    /// The Euler characteristic: positions − edges + faces. For a closed surface it is 2 − 2g a shell, g its genus
    /// (number of handles).
    pub fn euler_characteristic(&self) -> i64 {
        self.positions as i64 - self.edges as i64 + self.faces as i64
    }

    /// Whether the mesh is watertight: it has faces, and each edge has exactly two.
    pub fn is_closed(&self) -> bool {
        self.faces > 0 && self.open_edges.is_empty() && self.non_manifold_edges.is_empty()
    }

    /// Whether nothing is wrong: a closed, consistently oriented surface without leftovers.
    pub fn is_sound(&self) -> bool {
        self.is_closed()
            && self.flipped.is_empty()
            && self.degenerate.is_empty()
            && self.duplicates.is_empty()
            && self.unused_vertices.is_empty()
            && self.one_sided == 0
            && self.inside_out == 0
    }
}

/// Examines a mesh; `None` if cancelled. It takes some 100 bytes of memory a triangle.
///
/// All but `inside_out` is decided exactly, by vertex numbers and equality of coordinates. A mesh without triangles
/// has no face and is not closed.
pub fn check(mesh: &Mesh, go_on: GoOn<'_>) -> Option<Health> {
    let triangles = mesh.triangles();
    let welded = weld(mesh.positions());
    if !go_on(0.2) {
        return None;
    }
    let (faces, duplicates) = faces(mesh, &welded);
    if !go_on(0.4) {
        return None;
    }
    let sides = sides(&faces);
    if !go_on(0.7) {
        return None;
    }
    let mut is_used = vec![false; mesh.positions().len()];
    for &vertex in triangles.iter().flatten() {
        if let Some(used) = is_used.get_mut(vertex as usize) {
            *used = true;
        }
    }
    let mut is_position = vec![false; mesh.positions().len()];
    for &vertex in faces.iter().flat_map(|(_, corners)| corners) {
        is_position[vertex as usize] = true;
    }
    let mut health = Health {
        positions: is_position.iter().filter(|is| **is).count(),
        faces: faces.len(),
        degenerate: left_out(triangles.len(), mesh.kept()),
        duplicates,
        unused_vertices: numbers(is_used.iter().map(|used| !used)),
        ..Health::default()
    };
    let (shells, whole) = join(&sides, &faces, &mut health);
    if !go_on(0.9) {
        return None;
    }
    health.shells = shells;
    health.inside_out = inside_out(mesh, &faces, &whole);
    go_on(1.0).then_some(health)
}

/// The faces, and the numbers of the triangles that duplicate one.
pub(super) fn faces(mesh: &Mesh, welded: &[u32]) -> (Vec<Face>, Vec<u32>) {
    let position = |vertex: u32| mesh.positions().get(vertex as usize);
    let is_there = |vertex: &u32| position(*vertex).is_some_and(|position| position.is_finite());
    let mut faces: Vec<([u32; 3], Face)> = mesh
        .triangles()
        .par_iter()
        .enumerate()
        .filter(|(_, triangle)| triangle.iter().all(is_there))
        .filter_map(|(number, triangle)| {
            let corners @ [a, b, c] = triangle.map(|vertex| welded[vertex as usize]);
            let mut sorted = corners;
            sorted.sort_unstable();
            (a != b && b != c && c != a).then_some((sorted, (number as u32, corners)))
        })
        .collect();
    faces.par_sort_unstable();
    let mut duplicates = Vec::new();
    let mut last = None;
    faces.retain(|(corners, (number, _))| {
        let is_new = last != Some(*corners);
        last = Some(*corners);
        if !is_new {
            duplicates.push(*number);
        }
        is_new
    });
    duplicates.sort_unstable();
    let mut faces: Vec<Face> = faces.into_iter().map(|(_, face)| face).collect();
    faces.par_sort_unstable();
    (faces, duplicates)
}

/// Joins faces across edges, and counts the edges. Returns the number of shells, and for each face the root of its
/// part where that is a closed, consistently oriented shell.
fn join(sides: &[Side], faces: &[Face], health: &mut Health) -> (usize, Vec<Option<u32>>) {
    // Any edge connects shells; orientation is carried across edges of exactly two faces only.
    let (mut shells, mut parts) = (Sets::new(faces.len()), Sets::new(faces.len()));
    let mut twisted = Vec::new();
    let mut bounded = Vec::new();
    for edge in by_edge(sides) {
        health.edges += 1;
        let first = edge[0];
        for side in &edge[1..] {
            shells.join(first.face, side.face, false);
        }
        match edge {
            [one] => {
                health.open_edges.push(one.edge);
                bounded.push(one.face);
            }
            [one, other] => {
                // Two faces of one orientation traverse their common edge in opposite directions.
                let turned = one.is_forward == other.is_forward;
                if !parts.join(one.face, other.face, turned) {
                    twisted.push(one.face);
                }
            }
            _ => {
                health.non_manifold_edges.push(first.edge);
                bounded.extend(edge.iter().map(|side| side.face));
            }
        }
    }
    let roots = |sets: &mut Sets, of: &[u32]| -> HashSet<u32> {
        of.iter().map(|&face| sets.find(face).0).collect()
    };
    let twisted = roots(&mut parts, &twisted);
    let bounded = roots(&mut parts, &bounded);
    health.one_sided = twisted.len();

    let found: Vec<(u32, bool)> = (0..faces.len() as u32)
        .map(|face| parts.find(face))
        .collect();
    // For each part: how many faces are oriented as the root, how many are not, and whether the lowest face is not.
    let mut counts = vec![(0_u32, 0_u32, None); faces.len()];
    for &(root, turned) in &found {
        let (same, other, lowest) = &mut counts[root as usize];
        *(if turned { other } else { same }) += 1;
        lowest.get_or_insert(turned);
    }
    let mut mixed = HashSet::new();
    for (&(root, turned), &(number, _)) in found.iter().zip(faces) {
        let (same, other, lowest) = counts[root as usize];
        let most = match same.cmp(&other) {
            std::cmp::Ordering::Equal => lowest.unwrap_or(false),
            order => order == std::cmp::Ordering::Less,
        };
        if turned != most && !twisted.contains(&root) {
            health.flipped.push(number);
            mixed.insert(root);
        }
    }
    let whole = found.iter().map(|&(root, _)| {
        let is_whole = ![&twisted, &bounded, &mixed]
            .iter()
            .any(|of| of.contains(&root));
        is_whole.then_some(root)
    });
    let whole = whole.collect();
    let shells: HashSet<u32> = (0..faces.len() as u32)
        .map(|face| shells.find(face).0)
        .collect();
    (shells.len(), whole)
}

/// How many of the closed shells enclose a negative volume.
fn inside_out(mesh: &Mesh, faces: &[Face], whole: &[Option<u32>]) -> usize {
    // For each shell, at its root: six times the volume, the sum of the products' magnitudes, and the number of
    // triangles.
    let mut sums = vec![(0.0_f64, 0.0_f64, 0_u32); faces.len()];
    for (&(number, _), &root) in faces.iter().zip(whole) {
        let (Some(root), Some(corners)) = (root, mesh.corners(number)) else {
            continue;
        };
        let [a, b, c]: [DVec3; 3] = corners.map(|corner| corner.as_dvec3());
        let (plus, minus) = (b.yzx() * c.zxy(), b.zxy() * c.yzx());
        let (volume, magnitude, count) = &mut sums[root as usize];
        *volume += a.dot(plus - minus);
        *magnitude += a.abs().dot(plus.abs() + minus.abs());
        *count += 1;
    }
    let is_negative = |(volume, magnitude, count): &(f64, f64, u32)| {
        // Corners have 24 bits, so the products of b and c are exact. Their difference, the product with a and two
        // sums round once each, and each of the n additions rounds once more: γₙ₊₄ of the sum of magnitudes
        // (lemmas 2 and 3 of docs/error-bounds.md), doubled for the rounding of that sum itself.
        let bound = 2.0 * f64::from(count + 4) * EPSILON * magnitude;
        *count > 0 && *volume < -bound
    };
    sums.iter().filter(|sum| is_negative(sum)).count()
}

/// The numbers below `count` that are not in an ascending list.
fn left_out(count: usize, kept: &[u32]) -> Vec<u32> {
    let mut is_kept = vec![false; count];
    for &number in kept {
        is_kept[number as usize] = true;
    }
    numbers(is_kept.into_iter().map(|kept| !kept))
}

fn numbers(are: impl Iterator<Item = bool>) -> Vec<u32> {
    (0..)
        .zip(are)
        .filter(|(_, is)| *is)
        .map(|(number, _)| number)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{MeshData, Shape};

    fn mesh(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Mesh {
        Mesh::new(MeshData {
            positions: positions.iter().map(|p| DVec3::from_array(*p)).collect(),
            triangles: triangles.to_vec(),
            ..MeshData::default()
        })
    }

    fn healthy(mesh: &Mesh) -> Health {
        check(mesh, &|_| true).expect("it goes on")
    }

    const CORNERS: [[f64; 3]; 4] = [[0.; 3], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
    /// A tetrahedron whose triangles run counter-clockwise as seen from outside.
    const SIDES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    #[test]
    fn a_tetrahedron_is_sound() {
        let health = healthy(&mesh(&CORNERS, &SIDES));
        assert!(health.is_sound(), "{health:?}");
        assert_eq!((health.positions, health.edges, health.faces), (4, 6, 4));
        assert_eq!((health.euler_characteristic(), health.shells), (2, 1));
    }

    #[test]
    fn each_fault_lists_its_edges_or_triangles() {
        // One side missing.
        let open = healthy(&mesh(&CORNERS, &SIDES[..3]));
        assert_eq!(open.open_edges, [[0, 2], [0, 3], [2, 3]]);
        assert!(!open.is_closed() && open.euler_characteristic() == 1);
        // One side flipped.
        let mut sides = SIDES;
        sides[2] = [2, 1, 3];
        let turned = healthy(&mesh(&CORNERS, &sides));
        assert!(turned.is_closed() && turned.flipped == [2] && turned.inside_out == 0);
        // All sides flipped: none differs from the others.
        let inverse = SIDES.map(|[a, b, c]| [c, b, a]);
        let inverse = healthy(&mesh(&CORNERS, &inverse));
        assert!(inverse.flipped.is_empty() && inverse.inside_out == 1);
        // A duplicate of a side, flipped; a triangle of two corners; one with a vertex that does not exist; and a fin
        // on an edge.
        let corners = [&CORNERS[..], &[[5., 5., 5.], [-1., -1., 0.]]].concat();
        let more = [[3, 1, 0], [1, 1, 2], [0, 1, 99], [0, 3, 5]];
        let sides = [&SIDES[..], &more].concat();
        let many = healthy(&mesh(&corners, &sides));
        assert_eq!(many.duplicates, [4]);
        assert_eq!(many.degenerate, [5, 6]);
        assert_eq!(many.unused_vertices, [4]);
        assert_eq!(many.non_manifold_edges, [[0, 3]]);
        assert_eq!(many.open_edges, [[0, 5], [3, 5]]);
        assert_eq!((many.faces, many.shells), (5, 1));
    }

    #[test]
    fn vertices_at_one_position_are_welded_and_shells_are_counted() {
        // Each side with vertices of its own, one of them at minus zero; then all of it once more, elsewhere.
        let soup = |shift: f64| {
            let corners = SIDES
                .iter()
                .flatten()
                .map(|&corner| CORNERS[corner as usize]);
            corners.map(move |[x, y, z]| [x + shift, y, if z == 0.0 { -0.0 } else { z }])
        };
        let positions: Vec<_> = soup(0.0).chain(soup(3.0)).collect();
        let triangles: Vec<_> = (0..8).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let health = healthy(&mesh(&positions, &triangles));
        assert!(health.is_sound(), "{health:?}");
        assert_eq!((health.shells, health.euler_characteristic()), (2, 4));
    }

    #[test]
    fn a_moebius_band_is_one_sided() {
        // A strip of five quads closed to a ring, the last joined with a half twist.
        let positions: Vec<_> = (0..5)
            .flat_map(|i| {
                let (sin, cos) = crate::math::sin_cos(f64::from(i) * std::f64::consts::TAU / 5.0);
                [[cos, sin, 0.0], [2.0 * cos, 2.0 * sin, f64::from(i) * 0.1]]
            })
            .collect();
        let mut triangles: Vec<[u32; 3]> = Vec::new();
        for i in 0..5 {
            let (a, b) = (2 * i, 2 * i + 1);
            let (c, d) = if i == 4 { (1, 0) } else { (a + 2, b + 2) };
            triangles.extend([[a, b, c], [b, d, c]]);
        }
        let health = healthy(&mesh(&positions, &triangles));
        assert_eq!((health.one_sided, health.shells), (1, 1), "{health:?}");
        assert_eq!(health.euler_characteristic(), 0);
        assert!(health.flipped.is_empty() && health.non_manifold_edges.is_empty());
    }

    #[test]
    fn shapes_are_sound_and_a_torus_has_a_handle() {
        let sphere = Shape::Sphere {
            radius: 1.0,
            segments: 24,
            rings: 12,
        };
        let torus = Shape::Torus {
            radius: 1.0,
            tube: 0.25,
            segments: 24,
            rings: 12,
        };
        for (shape, euler) in [(sphere, 2), (torus, 0)] {
            let health = healthy(&Mesh::new(shape.mesh().expect("a good shape")));
            assert!(
                health.is_closed() && health.inside_out == 0,
                "{shape:?} {health:?}"
            );
            assert_eq!(health.euler_characteristic(), euler);
        }
    }

    #[test]
    fn an_empty_mesh_has_no_fault_and_cancelling_gives_nothing() {
        let nothing = healthy(&mesh(&[], &[]));
        assert_eq!(nothing, Health::default());
        assert!(!nothing.is_closed());
        let seen = std::sync::Mutex::new(Vec::new());
        let stop = |share: f32| {
            seen.lock().expect("no panic").push(share);
            share < 0.5
        };
        assert_eq!(check(&mesh(&CORNERS, &SIDES), &stop), None);
        assert_eq!(seen.into_inner().expect("no panic"), [0.2, 0.4, 0.7]);
    }
}
