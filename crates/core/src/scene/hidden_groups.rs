//! Groups of an object's mesh that rays cannot hit.

use super::{Bounds, Mesh};
use glam::Vec3;
use std::collections::BTreeSet;
use std::sync::{Arc, OnceLock};

/// The groups of a mesh that are hidden, and the triangles that are left.
///
/// Only casting leaves them out. The mesh stays whole: numbers, smooth normals and the ranges of colours do not depend
/// on what is hidden.
#[derive(Clone, Debug)]
pub struct HiddenGroups {
    mesh: Arc<Mesh>,
    names: BTreeSet<String>,
    kept: Vec<u32>,
    bounds: OnceLock<Bounds>,
    vertices: OnceLock<Vec<u32>>,
}

impl PartialEq for HiddenGroups {
    /// Whether both hide the groups of the same names in the same mesh, by address.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.mesh, &other.mesh) && self.names == other.names
    }
}

impl HiddenGroups {
    /// Hides the groups of these names; the empty name is that of triangles in no group. Names that the mesh does not
    /// have hide nothing.
    pub(super) fn new(mesh: Arc<Mesh>, names: BTreeSet<String>) -> Self {
        let kept = mesh.kept();
        let mut left = Vec::with_capacity(kept.len());
        for (range, name) in mesh.groups().all_ranges(mesh.triangles().len()) {
            if !names.contains(name.unwrap_or_default()) {
                let at = |number: usize| kept.partition_point(|&kept| (kept as usize) < number);
                left.extend_from_slice(&kept[at(range.start)..at(range.end)]);
            }
        }
        Self {
            mesh,
            names,
            kept: left,
            bounds: OnceLock::new(),
            vertices: OnceLock::new(),
        }
    }

    /// The mesh whose groups they are.
    pub(super) fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    /// The hidden groups' names.
    pub fn names(&self) -> &BTreeSet<String> {
        &self.names
    }

    /// The numbers of the mesh's kept triangles in other groups, ascending.
    pub fn kept(&self) -> &[u32] {
        &self.kept
    }

    /// The box around the triangles that are left, in the file's coordinates.
    pub(super) fn bounds(&self) -> Bounds {
        *self.bounds.get_or_init(|| {
            let offset = self.mesh.offset();
            Bounds::around(self.positions().map(|p| offset + p.as_dvec3()))
        })
    }

    /// The positions of the vertices of the triangles that are left, each once.
    pub(super) fn positions(&self) -> impl Iterator<Item = Vec3> {
        let positions = self.mesh.positions();
        let vertices = self.vertices.get_or_init(|| {
            let is_used = self.mesh.used_vertices(&self.kept);
            let used = (0..).zip(is_used).filter(|(_, is_used)| *is_used);
            used.map(|(vertex, _)| vertex).collect()
        });
        vertices.iter().map(|&vertex| positions[vertex as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Groups, MeshData, Object};
    use super::*;
    use glam::DVec3;

    /// Seven triangles side by side: in no group, in a, a, b, none, a and b; the third has no area.
    fn row() -> Arc<Mesh> {
        let triangle = |number: usize| {
            let x = number as f64;
            let height = if number == 2 { 0.0 } else { 1.0 };
            [(x, 0.0), (x + 1.0, 0.0), (x, height)].map(|(x, y)| DVec3::new(x, y, 0.0))
        };
        let groups = [None, Some(0), Some(0), Some(1), None, Some(0), Some(1)];
        let names = ["a", "b"].map(str::to_owned).to_vec();
        Arc::new(Mesh::new(MeshData {
            positions: (0..7).flat_map(triangle).collect(),
            triangles: (0..7).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect(),
            groups: Groups::of_triangles(names, groups).expect("two names"),
            ..MeshData::default()
        }))
    }

    #[test]
    fn hidden_groups_leave_the_kept_triangles_of_the_others() {
        let mut object = Object::new("row", row());
        let mut after = |names: &[&str]| {
            object.hide_groups(names.iter().map(|&name| name.to_owned()).collect());
            let bounds = object.bounds();
            (object.kept().to_vec(), bounds.min.x, bounds.max.x)
        };
        assert_eq!(after(&[]), (vec![0, 1, 3, 4, 5, 6], 0.0, 7.0));
        assert_eq!(after(&["a"]), (vec![0, 3, 4, 6], 0.0, 7.0));
        assert_eq!(after(&["b", ""]), (vec![1, 5], 1.0, 6.0));
        assert_eq!(after(&["c"]), (vec![0, 1, 3, 4, 5, 6], 0.0, 7.0));
        let (kept, low, high) = after(&["", "a", "b"]);
        assert!(kept.is_empty() && low > high);
    }

    #[test]
    fn objects_are_hidden_by_themselves_or_by_all_of_their_groups() {
        let mut object = Object::new("row", row());
        let mut after = |visible: bool, names: &[&str]| {
            object.visible = visible;
            object.hide_groups(names.iter().map(|&name| name.to_owned()).collect());
            [object.is_partly_hidden(), object.is_hidden()]
        };
        assert_eq!(after(true, &[]), [false, false]);
        assert_eq!(after(true, &["a"]), [true, false]);
        assert_eq!(after(true, &["", "a", "b"]), [true, true]);
        assert_eq!(after(false, &[]), [true, true]);
        // Nothing is hidden of what has no triangle.
        let empty = Object::new("empty", Arc::new(Mesh::new(MeshData::default())));
        assert!(!empty.is_hidden());
    }

    #[test]
    fn another_mesh_hides_the_groups_of_the_same_names() {
        let mut object = Object::new("row", row());
        object.hide_groups(BTreeSet::from(["a".to_owned()]));
        let again = row();
        object.set_mesh(Arc::clone(&again));
        assert_eq!(object.kept(), [0, 3, 4, 6]);
        // What was computed for another mesh does not count.
        object.mesh = row();
        assert_eq!(object.kept().len(), 6);
    }
}
