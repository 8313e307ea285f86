//! A mesh: offset (3 f64), positions, triangles, dropped triangles (their ids; counts by reason), normals, texture
//! coordinates, materials, the material of each triangle, vertex colours, scalars, diagonals, groups (names; the first
//! triangle of each run and its name's index), rounding; then its BVH (triangle ids in leaf order; for each inner
//! node, depth first, the number of triangles and of inner nodes below its first child).

use super::decoder::Decoder;
use super::encoder::Encoder;
use super::material::{self, Textures};
use super::texture::{color_from_word, word};
use crate::formats::error::FormatError;
use crate::scene::{
    Attribute, Color, Diagonals, Dropped, Groups, Mesh, Rounding, Run, Scalar, ScalarAt,
    StoredMesh, Texture, TreeTopology,
};
use bytemuck::Pod;
use glam::{DVec3, Vec2, Vec3};
use std::io;
use std::sync::Arc;

/// The least number of bytes of a mesh in the file: one without elements.
pub(super) const MIN_BYTES: usize = 3 * 8 + 4 * 16;

pub(super) fn write(
    mesh: &Mesh,
    tree: &TreeTopology,
    textures: &Textures<'_>,
    to: &mut Encoder<'_>,
) -> io::Result<()> {
    write_point(mesh.offset(), to)?;
    to.list(mesh.positions(), |at| at.to_array().map(f32::to_bits))?;
    to.list(mesh.triangles(), |corners| corners)?;
    to.list(&dropped_numbers(mesh), |number| [number])?;
    let Dropped {
        not_finite,
        too_far,
        bad_index,
        zero_area,
        rounded_away,
    } = mesh.dropped();
    for count in [not_finite, too_far, bad_index, zero_area, rounded_away] {
        to.number(count)?;
    }
    write_attribute(mesh.normals(), Vec3::to_array, to)?;
    write_attribute(mesh.uvs(), Vec2::to_array, to)?;
    to.count(mesh.materials().len())?;
    for material in mesh.materials() {
        material::write(material, textures, to)?;
    }
    to.list(mesh.material_of_triangle(), |number| [number])?;
    to.list(mesh.vertex_colors(), |color| {
        [u32::from(color.is_some()), color.map_or(0, word)]
    })?;
    to.count(mesh.scalars().len())?;
    for Scalar { name, at, values } in mesh.scalars() {
        to.text(name)?;
        to.number(match at {
            ScalarAt::Vertices => 0,
            ScalarAt::Triangles => 1,
        })?;
        to.list(values, |value| [value.to_bits()])?;
    }
    to.list(mesh.diagonals().words(), |word| {
        [word as u32, (word >> 32) as u32]
    })?;
    let groups = mesh.groups();
    to.count(groups.names().len())?;
    for name in groups.names() {
        to.text(name)?;
    }
    to.list(groups.runs(), |run| [run.first, run.group])?;
    let Rounding {
        distance,
        share_of_edge,
        bent,
    } = mesh.rounding();
    to.double(distance)?;
    to.double(share_of_edge)?;
    to.number(bent)?;
    to.list(&tree.order, |number| [number])?;
    to.list(&tree.nodes, |node| node)
}

/// The ids of the dropped triangles.
fn dropped_numbers(mesh: &Mesh) -> Vec<u32> {
    let mut kept = mesh.kept().iter().copied().peekable();
    let all = 0..mesh.triangles().len() as u32;
    all.filter(|number| kept.next_if_eq(number).is_none())
        .collect()
}

fn write_point(point: DVec3, to: &mut Encoder<'_>) -> io::Result<()> {
    let coordinates = point.to_array();
    coordinates.into_iter().try_for_each(|x| to.double(x))
}

fn write_attribute<T: Copy, const N: usize>(
    attribute: Option<&Attribute<T>>,
    numbers: impl Fn(&T) -> [f32; N],
    to: &mut Encoder<'_>,
) -> io::Result<()> {
    to.option(attribute, |to, Attribute { values, indices }| {
        to.list(values, |value| numbers(&value).map(f32::to_bits))?;
        to.option(indices.as_deref(), |to, indices| {
            to.list(indices, |corners| corners)
        })
    })
}

pub(super) fn read(textures: &[Arc<Texture>], from: &mut Decoder<'_>) -> Result<Mesh, FormatError> {
    let mut offset = || from.finite("an offset");
    let offset = DVec3::new(offset()?, offset()?, offset()?);
    let positions = from.words("vertices")?;
    let triangles: Vec<[u32; 3]> = from.words("triangles")?;
    let count = triangles.len();
    if count as u64 > from.budget().triangles_left() {
        from.budget().add_triangles(from.path(), count as u64)?;
    }
    let dropped_numbers = from.words("numbers of dropped triangles")?;
    let mut dropped = || from.number("a count of dropped triangles");
    let dropped = Dropped {
        not_finite: dropped()?,
        too_far: dropped()?,
        bad_index: dropped()?,
        zero_area: dropped()?,
        rounded_away: dropped()?,
    };
    let normals = read_attribute("normals", from)?;
    let uvs = read_attribute("texture coordinates", from)?;
    let materials = from.each("materials", material::MIN_BYTES, |from| {
        material::read(textures, from)
    })?;
    let material_of_triangle = from.words("materials of triangles")?;
    let colors = from.list("colours", |[is, color]: [u32; 2]| -> Option<Color> {
        (is != 0).then(|| color_from_word(color))
    })?;
    let scalars = from.each("scalars", 12, |from| {
        Ok(Scalar {
            name: from.text("a scalar's name")?,
            at: match from.flag("what has a scalar")? {
                false => ScalarAt::Vertices,
                true => ScalarAt::Triangles,
            },
            values: from.words("a scalar's numbers")?,
        })
    })?;
    let diagonals = from.list("diagonals", |[low, high]: [u32; 2]| {
        u64::from(low) | u64::from(high) << 32
    })?;
    let Some(diagonals) = Diagonals::from_words(diagonals, count) else {
        return Err(from.unexpected(&format!("diagonals of {count} triangles"), "others"));
    };
    let names = from.each("groups", 4, |from| from.text("a group's name"))?;
    let runs = from.list("runs of groups", |[first, group]: [u32; 2]| Run {
        first,
        group,
    })?;
    let Some(groups) = Groups::new(names, runs, count) else {
        return Err(from.unexpected(&format!("groups of {count} triangles"), "others"));
    };
    let rounding = Rounding {
        distance: from.double("a distance")?,
        share_of_edge: from.double("a share of an edge")?,
        bent: from.number("a count of triangles")?,
    };
    let order = from.words("triangles in leaf order")?;
    let nodes = from.words("nodes")?;
    // The ids of the triangles that were kept.
    from.hold(4 * count as u64)?;
    let stored = StoredMesh {
        offset,
        positions,
        triangles,
        dropped_numbers,
        dropped,
        normals,
        uvs,
        materials,
        material_of_triangle,
        colors,
        scalars,
        diagonals,
        groups,
        rounding,
    };
    let mesh = stored
        .mesh()
        .map_err(|reason| from.refused("the mesh", reason))?;
    let tree = TreeTopology::checked(&mesh, order, nodes);
    let tree = tree.map_err(|reason| from.refused("the tree", reason))?;
    Ok(mesh.with_tree(tree))
}

fn read_attribute<T: Pod>(
    what: &str,
    from: &mut Decoder<'_>,
) -> Result<Option<Attribute<T>>, FormatError> {
    from.option("whether there are attributes", |from| {
        Ok(Attribute {
            values: from.words(what)?,
            indices: from.option("whether there are indices", |from| from.words("indices"))?,
        })
    })
}
