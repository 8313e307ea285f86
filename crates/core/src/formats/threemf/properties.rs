//! Properties of the triangles of a 3MF file: groups of base materials and colours, and what they give a mesh.

use crate::scene::{Color, Material, MeshData};
use std::collections::{HashMap, HashSet};

/// No number.
pub(super) const NONE: u32 = u32::MAX;

/// The members of a group that a triangle has at its corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Property {
    /// [`NONE`] where it has none.
    pub(super) group: u32,
    pub(super) members: [u32; 3],
}

impl Default for Property {
    fn default() -> Self {
        Self {
            group: NONE,
            members: [0; 3],
        }
    }
}

/// Base materials or colours.
#[derive(Debug, Default)]
pub(super) struct Group {
    pub(super) members: Vec<Material>,
    /// Whether triangles interpolate them from corner to corner: colours, but not materials.
    pub(super) is_interpolated: bool,
}

/// All groups of a model part, by id.
#[derive(Debug, Default)]
pub(super) struct Groups {
    pub(super) shown: HashMap<u32, Group>,
    /// Those of types that are not shown.
    pub(super) others: HashSet<u32>,
}

/// What a property names that the file does not have.
pub(super) enum Missing {
    /// A group of this id.
    Group(u32),
    /// The member of this index, of so many that a group has.
    Member {
        group: u32,
        index: u32,
        members: usize,
    },
}

impl Groups {
    /// Gives a mesh its materials, and colours to the corners of triangles that interpolate them. Returns the number of
    /// triangles whose corners have different base materials, of which they show the first.
    pub(super) fn give(
        &self,
        properties: Vec<Property>,
        mesh: &mut MeshData,
    ) -> Result<usize, Missing> {
        let mut numbers: HashMap<(u32, u32), u32> = HashMap::new();
        let mut of_triangle = Vec::with_capacity(mesh.triangles.len());
        let mut interpolated = Vec::new();
        let mut mixed = 0;
        for (triangle, Property { group, members }) in properties.into_iter().enumerate() {
            if group == NONE || self.others.contains(&group) {
                of_triangle.push(NONE);
                continue;
            }
            let [first, second, third] = members;
            if members != [first; 3] {
                let found = self.group(group)?;
                let [a, b, c] = [
                    found.member(group, first)?,
                    found.member(group, second)?,
                    found.member(group, third)?,
                ];
                if found.is_interpolated {
                    interpolated.push((triangle, [a.color, b.color, c.color]));
                    of_triangle.push(NONE);
                    continue;
                }
                mixed += 1;
            }
            let number = match numbers.get(&(group, first)) {
                Some(&number) => number,
                None => {
                    let number = mesh.materials.len() as u32;
                    let material = self.group(group)?.member(group, first)?;
                    mesh.materials.push(material.clone());
                    numbers.insert((group, first), number);
                    number
                }
            };
            of_triangle.push(number);
        }
        of_triangle.resize(mesh.triangles.len(), NONE);
        mesh.material_of_triangle = of_triangle;
        color_corners(mesh, &interpolated);
        Ok(mixed)
    }

    fn group(&self, id: u32) -> Result<&Group, Missing> {
        self.shown.get(&id).ok_or(Missing::Group(id))
    }
}

impl Group {
    /// A member of the group, which has this id.
    fn member(&self, id: u32, index: u32) -> Result<&Material, Missing> {
        self.members.get(index as usize).ok_or(Missing::Member {
            group: id,
            index,
            members: self.members.len(),
        })
    }
}

/// Colours the corners of some triangles, by ascending number. A vertex that would need several colours, or none for
/// another triangle, is duplicated.
fn color_corners(mesh: &mut MeshData, triangles: &[(usize, [Color; 3])]) {
    if triangles.is_empty() {
        return;
    }
    let mut is_uncolored = vec![false; mesh.positions.len()];
    let mut left = triangles.iter().map(|&(triangle, _)| triangle).peekable();
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        let is_interpolated = left.next_if_eq(&triangle).is_some();
        if !is_interpolated && mesh.material_of_triangle[triangle] == NONE {
            for &vertex in corners {
                is_uncolored[vertex as usize] = true;
            }
        }
    }
    mesh.colors.resize(mesh.positions.len(), None);
    let mut copies: HashMap<(u32, [u8; 3]), u32> = HashMap::new();
    for &(triangle, colors) in triangles {
        for (vertex, color) in mesh.triangles[triangle].iter_mut().zip(colors) {
            let at = *vertex as usize;
            if mesh.colors[at].is_none() && !is_uncolored[at] {
                mesh.colors[at] = Some(color);
            }
            if mesh.colors[at] != Some(color) {
                *vertex = *copies.entry((*vertex, color.0)).or_insert_with(|| {
                    mesh.positions.push(mesh.positions[at]);
                    mesh.colors.push(Some(color));
                    mesh.positions.len() as u32 - 1
                });
            }
        }
    }
}
