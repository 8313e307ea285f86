//! A glTF mesh: its primitives as one list of triangles.

use super::data::{Data, TOGETHER};
use super::json::Primitive;
use super::material::{Base, Coordinates, Materials, color};
use crate::formats::error::FormatError;
use crate::formats::limits::Share;
use crate::scene::{Attribute, Color, MeshData, Scalar, ScalarAt};
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;
use std::mem::size_of;
use std::ops::Range;

/// No index.
const NONE: u32 = u32::MAX;

/// Counts of what a file's meshes have and is not shown.
#[derive(Debug, Default)]
pub(super) struct Skipped {
    /// Primitives of points or lines.
    pub(super) points_and_lines: usize,
    /// Primitives without positions.
    pub(super) empty: usize,
    /// Corners after the last whole triangle.
    pub(super) loose_corners: usize,
    /// Meshes with morph targets.
    pub(super) morphs: usize,
}

/// The accessors of a primitive's vertices: primitives that agree in all of them share stored vertices.
#[derive(PartialEq, Eq, Hash)]
struct Key {
    positions: u32,
    normals: Option<u32>,
    uvs: Option<(u32, [u64; 6])>,
    colors: Option<(u32, [u64; 3])>,
    scalars: Vec<(String, u32)>,
}

/// Lists that grow primitive by primitive.
struct Builder<'b, 'm, 'd> {
    data: &'b Data<'d>,
    materials: &'b mut Materials<'m, 'd>,
    share: Share<'d>,
    mesh: MeshData,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    firsts: HashMap<Key, u32>,
    /// Material numbers in the mesh by those in the file, and by whether vertices have colours.
    numbers: HashMap<(u32, bool), u32>,
}

/// A mesh's triangles, in the order of its primitives.
pub(super) fn read<'d>(
    data: &Data<'d>,
    materials: &mut Materials<'_, 'd>,
    index: u32,
    skipped: &mut Skipped,
) -> Result<MeshData, FormatError> {
    let location = format!("meshes[{index}]");
    let json = data.one(&data.root.meshes, index, "nodes", "meshes")?;
    let mut builder = Builder {
        data,
        materials,
        share: data.files.budget().share(data.path, "the mesh", 0)?,
        mesh: MeshData::default(),
        normals: Vec::new(),
        uvs: Vec::new(),
        firsts: HashMap::new(),
        numbers: HashMap::new(),
    };
    for (number, primitive) in json.primitives.iter().enumerate() {
        builder.add(
            &format!("{location}.primitives[{number}]"),
            primitive,
            skipped,
        )?;
    }
    let has_morphs = json.primitives.iter().any(|p| !p.targets.is_empty());
    skipped.morphs += usize::from(has_morphs);
    Ok(builder.finish())
}

impl Builder<'_, '_, '_> {
    fn add(
        &mut self,
        location: &str,
        primitive: &Primitive,
        skipped: &mut Skipped,
    ) -> Result<(), FormatError> {
        let data = self.data;
        let mode = primitive.mode.unwrap_or(4);
        match mode {
            0..=3 => {
                skipped.points_and_lines += 1;
                return Ok(());
            }
            4..=6 => {}
            other => return Err(data.fault(location, "a mode from 0 to 6", &other.to_string())),
        }
        let Some(&positions) = primitive.attributes.get("POSITION") else {
            skipped.empty += 1;
            return Ok(());
        };
        // Such a file asks for the extension without saying so: its accessors alone would be zeros.
        let accessor = data.root.accessors.get(positions as usize);
        if primitive
            .extensions
            .contains_key("KHR_draco_mesh_compression")
            && accessor.is_some_and(|of| of.buffer_view.is_none() && of.sparse.is_none())
        {
            let found = "them under Draco compression alone, which is not read";
            return Err(data.fault(location, "positions in a buffer view", found));
        }
        let base = match primitive.material {
            Some(material) => Some(self.materials.base(material, location)?),
            None => None,
        };
        let named = |name: &str| primitive.attributes.get(name).copied();
        let coordinates = base.and_then(|base| base.placed).map_or_else(
            // Without a texture the coordinates are kept for being shown themselves.
            || named("TEXCOORD_0").map(|uvs| (uvs, Coordinates::PLAIN)),
            |info| {
                let name = format!("TEXCOORD_{}", Coordinates::set(info));
                named(&name).map(|uvs| (uvs, Coordinates::new(info)))
            },
        );
        let colors = named("COLOR_0");
        let (first, count) = self.vertices(
            location,
            positions,
            named("NORMAL"),
            coordinates,
            colors,
            (base, self.scalars(primitive)),
        )?;
        let corners = match primitive.indices {
            None => (0..count).collect(),
            Some(index) => self.corners(location, index, count)?,
        };
        let triangles = match mode {
            4 => corners.len() / 3,
            _ => corners.len().saturating_sub(2),
        };
        skipped.loose_corners += match mode {
            4 => corners.len() % 3,
            _ if triangles == 0 => corners.len(),
            _ => 0,
        };
        let all = self.mesh.triangles.len() + triangles;
        let budget = data.files.budget();
        if all as u64 > budget.triangles_left() {
            budget.add_triangles(data.path, all as u64)?;
        }
        self.count(all)?;
        self.mesh.triangles.reserve_exact(triangles);
        self.append(mode, first, &corners);
        let material = match primitive.material {
            None => NONE,
            Some(material) => self.material(material, coordinates.is_some(), colors.is_some())?,
        };
        self.assign(material, all - triangles..all);
        Ok(())
    }

    /// Gives a range of triangles, the last ones, a material, or [`NONE`]. Without materials there is no list.
    fn assign(&mut self, material: u32, triangles: Range<usize>) {
        let list = &mut self.mesh.material_of_triangle;
        if material != NONE || !list.is_empty() {
            list.resize(triangles.start, NONE);
            list.resize(triangles.end, material);
        }
    }

    /// Appends the triangles of a list (4), a strip (5) or a fan (6) of corners, numbered from `first`.
    fn append(&mut self, mode: u32, first: u32, corners: &[u32]) {
        let triangle = |[a, b, c]: [u32; 3]| [first + a, first + b, first + c];
        let triangles = &mut self.mesh.triangles;
        match mode {
            4 => {
                let (whole, _) = corners.as_chunks();
                let whole = whole.par_iter().with_min_len(TOGETHER);
                triangles.par_extend(whole.map(|corners| triangle(*corners)));
            }
            5 => {
                // Every second triangle is reversed, so that all have one orientation.
                let strip = corners.windows(3).enumerate().map(|(at, c)| match at % 2 {
                    0 => triangle([c[0], c[1], c[2]]),
                    _ => triangle([c[0], c[2], c[1]]),
                });
                triangles.extend(strip);
            }
            _ => {
                let fan = corners.get(1..).unwrap_or_default().windows(2);
                let fan = fan.map(|c| triangle([c[0], c[1], corners[0]]));
                triangles.extend(fan);
            }
        }
    }

    /// Counts the lists' memory against the budget, as it will be with so many more triangles.
    fn count(&mut self, triangles: usize) -> Result<(), FormatError> {
        // For a triangle: its corners in the file's list, in the mesh's, and of its attributes, and its material.
        let triangle = 3 * size_of::<[u32; 3]>() + size_of::<u32>();
        let vertex =
            size_of::<DVec3>() + size_of::<Vec3>() + size_of::<Vec2>() + size_of::<Option<Color>>();
        let bytes = triangle * triangles + 2 * vertex * self.mesh.positions.len();
        self.share.grow(self.data.path, "the mesh", bytes as u64)
    }

    /// The first vertex of a primitive, and the number of its vertices.
    fn vertices(
        &mut self,
        location: &str,
        positions: u32,
        normals: Option<u32>,
        uvs: Option<(u32, Coordinates)>,
        colors: Option<u32>,
        (base, scalars): (Option<Base<'_>>, Vec<(String, u32)>),
    ) -> Result<(u32, u32), FormatError> {
        let data = self.data;
        let found = data.accessor(positions, location, &["VEC3"])?;
        // An image contains the factor already, and is multiplied by vertex colours.
        let untextured = base.filter(|base| base.texture.is_none() || uvs.is_none());
        let [r, g, b, _] = untextured.map_or([1.0; 4], |base| base.factor);
        let key = Key {
            positions,
            normals,
            uvs: uvs.map(|(uvs, coordinates)| (uvs, coordinates.bits())),
            colors: colors.map(|colors| (colors, [r, g, b].map(f64::to_bits))),
            scalars,
        };
        let first = self.mesh.positions.len();
        let count = found.count;
        if let Some(&first) = self.firsts.get(&key) {
            return Ok((first, count as u32));
        }
        let all = first as u64 + count as u64;
        if all >= u64::from(NONE) {
            let expected = format!("fewer than {NONE} vertices in a mesh");
            return Err(data.fault(location, &expected, &all.to_string()));
        }
        let vertex = 2 * (size_of::<DVec3>() + size_of::<Vec3>() + size_of::<Vec2>() + 8)
            + (self.mesh.scalars.len() + key.scalars.len()) * size_of::<f32>();
        self.share
            .grow(data.path, "the mesh", vertex as u64 * all)?;
        let scalars = key.scalars.clone();
        self.firsts.insert(key, first as u32);
        let other = |index: u32, name: &str, shapes: &[&str]| {
            let location = format!("{location}.attributes.{name}");
            let numbers = data.accessor(index, &location, shapes)?;
            if numbers.count != count {
                let expected = format!("as many as positions, {count}");
                return Err(data.fault(&location, &expected, &numbers.count.to_string()));
            }
            Ok(numbers)
        };
        if let Some(normals) = normals {
            let normals = other(normals, "NORMAL", &["VEC3"])?;
            let unit = |normal| DVec3::from_array(normal).normalize_or_zero().as_vec3();
            self.normals.resize(first, Vec3::ZERO);
            append(&mut self.normals, normals.values([0.0; 3], unit));
        }
        if let Some((uvs, coordinates)) = uvs {
            let uvs = other(uvs, "TEXCOORD", &["VEC2"])?;
            self.uvs.resize(first, Vec2::NAN);
            let values = uvs.values([0.0; 2], |uv| coordinates.apply(uv));
            append(&mut self.uvs, values);
        }
        if let Some(colors) = colors {
            let colors = other(colors, "COLOR_0", &["VEC3", "VEC4"])?;
            self.mesh.colors.resize(first, None);
            let mixed = colors.values([0.0, 0.0, 0.0, 1.0], |[x, y, z, a]| {
                Some(color([x * r, y * g, z * b, a]))
            });
            append(&mut self.mesh.colors, mixed);
        }
        for (name, index) in &scalars {
            let numbers = other(*index, name, &["SCALAR"])?;
            let known = self.mesh.scalars.iter().position(|s| s.name == *name);
            let at = known.unwrap_or(self.mesh.scalars.len());
            if known.is_none() {
                self.mesh.scalars.push(Scalar {
                    name: name.clone(),
                    at: ScalarAt::Vertices,
                    values: Vec::new(),
                });
            }
            let values = &mut self.mesh.scalars[at].values;
            values.resize(first, f32::NAN);
            append(values, numbers.values([0.0], |[number]| number as f32));
        }
        let positions = found.values([0.0; 3], DVec3::from_array);
        append(&mut self.mesh.positions, positions);
        Ok((first as u32, count as u32))
    }

    /// The application's own scalar attributes, by name; the standard reserves a leading underscore for them.
    fn scalars(&self, primitive: &Primitive) -> Vec<(String, u32)> {
        let is_number = |index: u32| {
            let accessor = self.data.root.accessors.get(index as usize);
            accessor.is_some_and(|accessor| accessor.shape == "SCALAR")
        };
        let own = primitive.attributes.iter();
        let own = own.filter(|(name, index)| name.starts_with('_') && is_number(**index));
        own.map(|(name, index)| (name.clone(), *index)).collect()
    }

    /// A primitive's indices, checked against the number of vertices.
    fn corners(&self, location: &str, index: u32, count: u32) -> Result<Vec<u32>, FormatError> {
        let data = self.data;
        let location = format!("{location}.indices");
        let numbers = data.accessor(index, &location, &["SCALAR"])?;
        let bytes = numbers.count * size_of::<u32>();
        let _share = data
            .files
            .budget()
            .share(data.path, "the indices", bytes as u64)?;
        let corners = data.indices(&numbers, &location)?;
        let all = corners.par_iter().with_min_len(TOGETHER);
        match all.position_first(|&corner| corner >= count) {
            None => Ok(corners),
            Some(at) => {
                let expected = format!("indices of its {count} vertices");
                let found = format!("{} as number {at}", corners[at]);
                Err(data.fault(&location, &expected, &found))
            }
        }
    }

    /// The number of a material in the mesh.
    fn material(
        &mut self,
        index: u32,
        has_coordinates: bool,
        by_vertex: bool,
    ) -> Result<u32, FormatError> {
        if let Some(&number) = self.numbers.get(&(index, by_vertex)) {
            return Ok(number);
        }
        let material = self.materials.material(index, has_coordinates, by_vertex)?;
        let number = self.mesh.materials.len() as u32;
        self.mesh.materials.push(material);
        // A material without coordinates may be used again with some.
        if has_coordinates {
            self.numbers.insert((index, by_vertex), number);
        }
        Ok(number)
    }

    fn finish(self) -> MeshData {
        let Self {
            mut mesh,
            mut normals,
            mut uvs,
            ..
        } = self;
        let count = mesh.positions.len();
        if !normals.is_empty() {
            normals.resize(count, Vec3::ZERO);
        }
        if !uvs.is_empty() {
            uvs.resize(count, Vec2::NAN);
        }
        for scalar in &mut mesh.scalars {
            scalar.values.resize(count, f32::NAN);
        }
        mesh.normals = attribute(normals, &mesh.triangles, |normal| *normal != Vec3::ZERO);
        mesh.uvs = attribute(uvs, &mesh.triangles, |uv| uv.is_finite());
        mesh
    }
}

/// Appends values to a list. The first ones are not copied: most meshes have one primitive.
fn append<T>(list: &mut Vec<T>, mut values: Vec<T>) {
    if list.is_empty() {
        *list = values;
    } else {
        list.append(&mut values);
    }
}

/// Values of vertices. If all are valid they use the triangles' indices; otherwise a triangle with an invalid value
/// has none.
fn attribute<T>(
    values: Vec<T>,
    triangles: &[[u32; 3]],
    is_good: impl Fn(&T) -> bool,
) -> Option<Attribute<T>> {
    if values.is_empty() {
        return None;
    }
    let indices = (!values.iter().all(&is_good)).then(|| {
        let all_good = |triangle: &&[u32; 3]| {
            let mut corners = triangle.iter();
            corners.all(|&i| values.get(i as usize).is_some_and(&is_good))
        };
        let kept = |triangle| Some(triangle).filter(all_good).map_or([NONE; 3], |t| *t);
        triangles.iter().map(kept).collect()
    });
    Some(Attribute { values, indices })
}
