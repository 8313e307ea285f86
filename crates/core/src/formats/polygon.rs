//! Triangulation of faces with more than three corners: fans where a fan is correct, ear clipping elsewhere.

mod cutter;
mod tree;

use crate::quote;
use crate::scene::{Diagonals, MeshData, is_storable};
use cutter::{Cut, Cutter};
use std::path::Path;

/// A face of more than three corners, given by the fan that represents it in a mesh until it is triangulated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polygon {
    /// The number of its first triangle.
    pub(super) first: u32,
    /// The number of its triangles: its corners less two.
    pub(super) triangles: u32,
}

/// Counts of faces that could not be triangulated properly, and stay fans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Uncut {
    /// Faces that cross themselves.
    pub(super) crossing: usize,
    /// Faces that would take too long.
    pub(super) intricate: usize,
}

impl Uncut {
    /// A warning for each reason.
    pub(super) fn warnings(self, path: &Path) -> Vec<String> {
        let path = quote::path(path);
        let kinds = [
            (
                self.crossing,
                "faces that cross or touch themselves, which are cut as fans",
            ),
            (
                self.intricate,
                "faces too intricate for the time that there is, which are cut as fans",
            ),
        ];
        let counted = kinds.iter().filter(|(count, _)| *count > 0);
        counted
            .map(|(count, what)| format!("{path}: {what}: {count}"))
            .collect()
    }
}

/// Triangulates the polygons of a mesh whose faces are all fans. Each polygon keeps its triangle numbers; positions,
/// texture coordinates and normals are triangulated alike, and the mesh records the diagonals.
///
/// Corners are tested as they will be stored, in single precision relative to the mesh's offset, projected along an
/// axis to the coordinate plane that shows the face largest. A face stays a fan where all triangles of the fan have
/// one exact orientation there and turn around the first corner at most once, or where a corner cannot be stored.
pub(super) fn cut(mesh: &mut MeshData, polygons: &[Polygon]) -> Uncut {
    if polygons.is_empty() {
        return Uncut::default();
    }
    let mut diagonals = Diagonals::of(mesh.triangles.len());
    let offset = mesh.offset();
    let mut uncut = Uncut::default();
    let mut cutter = Cutter::default();
    let mut stored = Vec::new();
    let mut fan = Vec::new();
    for polygon in polygons {
        let range = polygon.first as usize..(polygon.first + polygon.triangles) as usize;
        corners(&mesh.triangles[range.clone()], &mut fan);
        let last = polygon.triangles as usize - 1;
        for at in 0..=last {
            diagonals.set(range.start + at, [at > 0, false, at < last]);
        }
        stored.clear();
        stored.extend(fan.iter().filter_map(|&corner| {
            let position = *mesh.positions.get(corner as usize)?;
            is_storable(position).then(|| (position - offset).as_vec3())
        }));
        if stored.len() < fan.len() {
            continue;
        }
        match cutter.cut(&stored) {
            Cut::Fan => continue,
            Cut::Crossing => uncut.crossing += 1,
            Cut::Intricate => uncut.intricate += 1,
            Cut::Ears => {
                let attributes = [
                    mesh.uvs.as_mut().and_then(|uvs| uvs.indices.as_mut()),
                    mesh.normals.as_mut().and_then(|n| n.indices.as_mut()),
                ];
                let all = attributes
                    .into_iter()
                    .flatten()
                    .chain([&mut mesh.triangles]);
                for (number, &[a, b, c]) in range.clone().zip(&cutter.ears) {
                    let is_diagonal = |(from, to)| !are_neighbours(from, to, fan.len());
                    diagonals.set(number, [(a, b), (b, c), (c, a)].map(is_diagonal));
                }
                for triangles in all {
                    let triangles = &mut triangles[range.clone()];
                    corners(triangles, &mut fan);
                    for (triangle, ear) in triangles.iter_mut().zip(&cutter.ears) {
                        *triangle = ear.map(|corner| fan[corner as usize]);
                    }
                }
            }
        }
    }
    mesh.diagonals = diagonals;
    uncut
}

/// Whether two corners of a face with `count` corners are neighbours.
fn are_neighbours(a: u32, b: u32, count: usize) -> bool {
    let apart = a.abs_diff(b) as usize;
    apart == 1 || apart + 1 == count
}

/// The corners of a fan, in order.
fn corners(fan: &[[u32; 3]], corners: &mut Vec<u32>) {
    corners.clear();
    corners.extend(fan.first().iter().flat_map(|first| &first[..2]));
    corners.extend(fan.iter().map(|triangle| triangle[2]));
}

#[cfg(test)]
mod tests;
