//! A mesh of some of another's triangles.

use super::measures::Measures;
use super::{Attribute, Diagonals, Dropped, Groups, Mesh, Run, Scalar, ScalarAt};
use std::sync::OnceLock;

/// Which values of a list are used, renumbered in the order of the list.
struct Used {
    /// The used values' old indices, ascending.
    old: Vec<u32>,
    /// New indices by old ones.
    new: Vec<u32>,
}

impl Used {
    fn by(triangles: &[[u32; 3]], count: usize) -> Self {
        let mut new = vec![u32::MAX; count];
        for &index in triangles.as_flattened() {
            if let Some(new) = new.get_mut(index as usize) {
                *new = 0;
            }
        }
        let mut old = Vec::new();
        for (index, new) in (0..).zip(&mut new).filter(|(_, new)| **new == 0) {
            *new = old.len() as u32;
            old.push(index);
        }
        Self { old, new }
    }

    /// The used values of a list; of a shorter one, those that it has.
    fn of<T: Clone>(&self, all: &[T]) -> Vec<T> {
        let used = self.old.iter();
        used.filter_map(|&index| all.get(index as usize).cloned())
            .collect()
    }

    /// Triangles of new indices; those out of range stay so.
    fn renumber(&self, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let new = |index: u32| self.new.get(index as usize).copied().unwrap_or(u32::MAX);
        triangles.iter().map(|corners| corners.map(new)).collect()
    }
}

impl Mesh {
    /// The mesh of some of its kept triangles, renumbered in their order, without vertices that these do not use. Corners
    /// are the same, bit for bit.
    pub(crate) fn subset(&self, kept: &[u32]) -> Self {
        fn of<T: Copy>(kept: &[u32], all: &[T]) -> Vec<T> {
            let some = kept.iter();
            some.filter_map(|&number| all.get(number as usize).copied())
                .collect()
        }
        let triangles = of(kept, &self.triangles);
        let vertices = Used::by(&triangles, self.positions.len());
        let mut diagonals = match self.diagonals.is_empty() {
            true => Diagonals::default(),
            false => Diagonals::of(kept.len()),
        };
        for (new, &old) in kept.iter().enumerate() {
            diagonals.set(new, self.diagonals.on(old));
        }
        let scalars = self.measures.scalars.iter().map(|scalar| Scalar {
            name: scalar.name.clone(),
            at: scalar.at,
            values: match scalar.at {
                ScalarAt::Vertices => vertices.of(&scalar.values),
                ScalarAt::Triangles => of(kept, &scalar.values),
            },
        });
        Self {
            offset: self.offset,
            positions: vertices.of(&self.positions),
            triangles: vertices.renumber(&triangles),
            kept: (0..kept.len() as u32).collect(),
            dropped: Dropped::default(),
            normals: (self.normals.as_ref()).map(|all| all.subset(kept, &vertices)),
            uvs: (self.uvs.as_ref()).map(|all| all.subset(kept, &vertices)),
            materials: self.materials.clone(),
            material_of_triangle: of(kept, &self.material_of_triangle),
            colors: vertices.of(&self.colors),
            diagonals,
            groups: self.groups.subset(kept),
            rounding: self.rounding,
            bounds: OnceLock::new(),
            adjacency: OnceLock::new(),
            measures: Measures::new(scalars.collect()),
            tree: None,
        }
    }
}

impl<T: Copy> Attribute<T> {
    fn subset(&self, kept: &[u32], vertices: &Used) -> Self {
        let Some(indices) = &self.indices else {
            return Self {
                values: vertices.of(&self.values),
                indices: None,
            };
        };
        let lacking = [u32::MAX; 3];
        let own = |&number: &u32| indices.get(number as usize).copied().unwrap_or(lacking);
        let own: Vec<_> = kept.iter().map(own).collect();
        let used = Used::by(&own, self.values.len());
        Self {
            values: used.of(&self.values),
            indices: Some(used.renumber(&own)),
        }
    }
}

impl Groups {
    /// The groups of some triangles, renumbered in their order. Groups that have none of these are not there.
    fn subset(&self, kept: &[u32]) -> Self {
        let mut numbers = vec![Run::NONE; self.names().len()];
        let mut names = Vec::new();
        let groups: Vec<_> = (kept.iter())
            .map(|&triangle| {
                let old = self.number_of(triangle)? as usize;
                if numbers[old] == Run::NONE {
                    numbers[old] = names.len() as u32;
                    names.push(self.names()[old].clone());
                }
                Some(numbers[old])
            })
            .collect();
        Self::of_triangles(names, groups).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Color, MeshData};
    use super::*;
    use glam::{DVec3, Vec2, Vec3};

    #[test]
    fn what_belongs_to_vertices_and_edges_is_renumbered_with_them() {
        let mut diagonals = Diagonals::of(3);
        diagonals.set(0, [true, false, false]);
        diagonals.set(2, [false, true, true]);
        let number = |n: u8| f32::from(n);
        let mesh = Mesh::new(MeshData {
            positions: (0..5)
                .map(|n| DVec3::from(Vec3::new(number(n), number(n * n), 1.0)))
                .collect(),
            triangles: vec![[0, 1, 2], [1, 2, 3], [4, 2, 1]],
            normals: Some(Attribute {
                values: (0..5).map(|n| Vec3::X * number(n)).collect(),
                indices: None,
            }),
            // A list that is too short lacks those of the last vertex.
            uvs: Some(Attribute {
                values: (0..4).map(|n| Vec2::Y * number(n)).collect(),
                indices: None,
            }),
            colors: (0..5).map(|n| Some(Color([n; 3]))).collect(),
            diagonals,
            ..MeshData::default()
        });
        let subset = mesh.subset(&[1, 2]);
        assert_eq!((subset.kept().len(), subset.positions().len()), (2, 4));
        for (new, old) in [(0, 1), (1, 2)] {
            assert_eq!(subset.corners(new), mesh.corners(old));
            assert_eq!(subset.corner_normals(new), mesh.corner_normals(old));
            assert_eq!(subset.corner_uvs(new), mesh.corner_uvs(old));
            assert_eq!(subset.corner_colors(new), mesh.corner_colors(old));
            assert_eq!(subset.diagonals().on(new), mesh.diagonals().on(old));
        }
        assert!(mesh.corner_uvs(1).is_some() && mesh.corner_uvs(2).is_none());
    }
}
