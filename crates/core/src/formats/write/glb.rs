//! Binary glTF 2.0 (Khronos Group, "glTF 2.0 Specification", 2021).

use super::glb_materials::Materials;
use super::parts::{JoinedMesh, Part, Parts};
use super::written::{WriteError, Written};
use crate::scene::{Color, Material, TextureProjection};
use crate::shade::srgb::linear;
use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::io::{self, Write};

/// The most primitives of an object. Triangles keep their order, so each run of triangles of one material is a
/// primitive, which would be too many with random colours.
const PRIMITIVE_LIMIT: usize = 4096;

const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Writes GLB: a node and a mesh for each object. Positions are in single precision, relative to the node's
/// translation where the object is far from the origin.
pub(super) fn write(
    parts: &Parts<'_>,
    out: &mut dyn Write,
    written: &mut Written,
) -> Result<(), WriteError> {
    let objects: Vec<Object<'_, '_>> = parts.parts.iter().map(Object::new).collect();
    written.vertices = objects
        .iter()
        .map(|object| object.join_attributes.vertices.len() as u64)
        .sum();
    if objects.iter().any(|object| object.lost_colors) {
        written
            .lost
            .push("colours of vertices, which not all have".to_owned());
    }
    if objects.iter().any(|object| object.lost_materials) {
        written
            .lost
            .push("materials that change too often".to_owned());
    }
    let mut tables = Tables::default();
    let mut materials = Materials::default();
    for object in &objects {
        object.describe(&mut tables, &mut materials)?;
    }
    written.lost.extend(materials.lost());
    let images = std::mem::take(&mut materials.images);
    let image_list = images.iter().map(|image| {
        let view = tables.image_view(image.len() as u64);
        json!({ "bufferView": view, "mimeType": "image/png" })
    });
    let image_list = image_list.collect();
    let Tables {
        bytes,
        views,
        accessors,
        meshes,
        nodes,
    } = tables;
    let mut json = json!({
        "asset": { "version": "2.0", "generator": "RayCast" },
        "scene": 0,
        "scenes": [{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }],
        "nodes": nodes,
    });
    // glTF's lists must not be empty.
    for (name, list) in [
        ("meshes", meshes),
        ("materials", materials.materials),
        ("textures", materials.textures),
        ("samplers", materials.samplers),
        ("images", image_list),
        ("accessors", accessors),
        ("bufferViews", views),
    ] {
        if !list.is_empty() {
            json[name] = list.into();
        }
    }
    if bytes > 0 {
        json["buffers"] = json!([{ "byteLength": bytes }]);
    }
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + json.len() as u64 + if bytes > 0 { 8 + bytes } else { 0 };
    let length = u32::try_from(total).map_err(|_| WriteError::TooMany {
        what: format!("{total} bytes"),
        format: "GLB",
    })?;
    out.write_all(b"glTF")?;
    out.write_all(&2u32.to_le_bytes())?;
    out.write_all(&length.to_le_bytes())?;
    out.write_all(&(json.len() as u32).to_le_bytes())?;
    out.write_all(b"JSON")?;
    out.write_all(&json)?;
    if bytes > 0 {
        // The file's length was checked to fit 32 bits.
        out.write_all(&(bytes as u32).to_le_bytes())?;
        out.write_all(b"BIN\0")?;
        for object in &objects {
            object.write(out)?;
        }
        for image in &images {
            out.write_all(image)?;
            out.write_all(&[0; 3][..image.len().next_multiple_of(4) - image.len()])?;
        }
    }
    parts.count_moves(written, |part, position| {
        part.offset + (position - part.offset).as_vec3().as_dvec3()
    });
    Ok(())
}

/// The JSON's lists, and the buffer's length so far.
#[derive(Default)]
struct Tables {
    bytes: u64,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
}

impl Tables {
    /// Adds a view of the buffer's next bytes; returns its index.
    fn view(&mut self, bytes: u64, target: u32) -> usize {
        self.views.push(json!({
            "buffer": 0,
            "byteOffset": self.bytes,
            "byteLength": bytes,
            "target": target,
        }));
        self.bytes += bytes;
        self.views.len() - 1
    }

    /// Adds a view of an image's bytes, and padding to four; returns its index.
    fn image_view(&mut self, bytes: u64) -> usize {
        self.views.push(json!({
            "buffer": 0,
            "byteOffset": self.bytes,
            "byteLength": bytes,
        }));
        self.bytes += bytes.next_multiple_of(4);
        self.views.len() - 1
    }

    /// Adds an accessor; returns its index.
    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

/// An object, converted for writing.
struct Object<'p, 's> {
    part: &'p Part<'s>,
    join_attributes: JoinedMesh,
    colors: Option<Vec<Color>>,
    lost_colors: bool,
    lost_materials: bool,
    /// Runs of triangles of one material: the first triangle, and the material.
    runs: Vec<(usize, Option<u32>)>,
}

impl<'p, 's> Object<'p, 's> {
    fn new(part: &'p Part<'s>) -> Self {
        let colors = part.vertex_colors();
        let materials = part.mesh.materials().len();
        let material = |number: usize| {
            let material = part.mesh.material_of_triangle().get(number).copied();
            material.filter(|&material| (material as usize) < materials)
        };
        let mut runs: Vec<(usize, Option<u32>)> = Vec::new();
        for number in 0..part.triangles.len() {
            let material = material(number);
            if runs.last().is_none_or(|(_, last)| *last != material) {
                runs.push((number, material));
                if runs.len() > PRIMITIVE_LIMIT {
                    break;
                }
            }
        }
        let lost_materials = runs.len() > PRIMITIVE_LIMIT;
        if lost_materials {
            runs = vec![(0, None)];
        }
        Self {
            part,
            join_attributes: part.join_attributes(),
            lost_colors: colors.is_none() && !part.mesh.vertex_colors().is_empty(),
            lost_materials,
            colors,
            runs,
        }
    }

    fn position(&self, vertex: &[u32; 3]) -> Vec3 {
        let position = self.part.positions[vertex[0] as usize];
        (position - self.part.offset).as_vec3()
    }

    /// Adds the description of the bytes that [`Object::write`] writes.
    fn describe(&self, tables: &mut Tables, materials: &mut Materials) -> Result<(), WriteError> {
        let part = self.part;
        let mut node = json!({ "name": part.name });
        if part.offset != DVec3::ZERO {
            node["translation"] = json!(part.offset.to_array());
        }
        if part.triangles.is_empty() {
            tables.nodes.push(node);
            return Ok(());
        }
        let vertices = &self.join_attributes.vertices;
        let count = vertices.len();
        let mut attributes = json!({});
        let mut attribute =
            |tables: &mut Tables, name: &str, kind: &str, size: u64, float: bool| {
                let view = tables.view(size * count as u64, ARRAY_BUFFER);
                let mut accessor = json!({
                    "bufferView": view,
                    "componentType": if float { FLOAT } else { UNSIGNED_SHORT },
                    "count": count,
                    "type": kind,
                });
                if name == "POSITION" {
                    let positions = vertices.iter().map(|vertex| self.position(vertex));
                    let ends = positions
                        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), p| {
                            (min.min(p), max.max(p))
                        });
                    accessor["min"] = json!(ends.0.to_array());
                    accessor["max"] = json!(ends.1.to_array());
                }
                if !float {
                    accessor["normalized"] = true.into();
                }
                attributes[name] = tables.accessor(accessor).into();
            };
        attribute(tables, "POSITION", "VEC3", 12, true);
        if part.normals.is_some() {
            attribute(tables, "NORMAL", "VEC3", 12, true);
        }
        if part.mesh.has_uvs() {
            attribute(tables, "TEXCOORD_0", "VEC2", 8, true);
        }
        if self.colors.is_some() {
            attribute(tables, "COLOR_0", "VEC4", 8, false);
        }
        let triangles = self.join_attributes.triangles.len();
        let view = tables.view(12 * triangles as u64, ELEMENT_ARRAY_BUFFER);
        let ends = self.runs.iter().skip(1).map(|run| run.0).chain([triangles]);
        let mut primitives = Vec::new();
        let mut written: HashMap<Option<u32>, Option<usize>> = HashMap::new();
        for (&(first, material), end) in self.runs.iter().zip(ends) {
            let indices = tables.accessor(json!({
                "bufferView": view,
                "byteOffset": 12 * first,
                "componentType": UNSIGNED_INT,
                "count": 3 * (end - first),
                "type": "SCALAR",
            }));
            let index = match written.get(&material) {
                Some(index) => *index,
                None => {
                    let index = self.material(materials, material)?;
                    written.insert(material, index);
                    index
                }
            };
            let mut primitive = json!({ "attributes": attributes, "indices": indices });
            if let Some(index) = index {
                primitive["material"] = index.into();
            }
            let own = material.and_then(|material| self.own_material(material));
            let is_textured = part.object.texture.is_some();
            if is_textured || own.is_some_and(|own| own.texture.is_some() && !own.by_vertex) {
                // glTF would multiply the image by them.
                primitive["attributes"]
                    .as_object_mut()
                    .map(|attributes| attributes.remove("COLOR_0"));
            }
            primitives.push(primitive);
        }
        tables
            .meshes
            .push(json!({ "name": part.name, "primitives": primitives }));
        node["mesh"] = (tables.meshes.len() - 1).into();
        tables.nodes.push(node);
        Ok(())
    }

    fn own_material(&self, index: u32) -> Option<&Material> {
        self.part.mesh.materials().get(index as usize)
    }

    /// Adds the material of a run of triangles; `None` where nothing is to be said of it.
    fn material(
        &self,
        materials: &mut Materials,
        index: Option<u32>,
    ) -> Result<Option<usize>, WriteError> {
        let object = self.part.object;
        let own = index.and_then(|index| self.own_material(index));
        if own.is_none() && object.texture.is_none() {
            return Ok(None);
        }
        let projection = object.mapping.projection.unwrap_or_default();
        let has_uvs = self.part.mesh.has_uvs() && projection == TextureProjection::Uv;
        materials.add(object, own, has_uvs).map(Some)
    }

    /// Writes the object's part of the buffer.
    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let part = self.part;
        if part.triangles.is_empty() {
            return Ok(());
        }
        let vertices = &self.join_attributes.vertices;
        let mut floats = |numbers: &[f32]| {
            let mut numbers = numbers.iter();
            numbers.try_for_each(|number| out.write_all(&number.to_le_bytes()))
        };
        for vertex in vertices {
            floats(&self.position(vertex).to_array())?;
        }
        if part.normals.is_some() {
            for &[_, normal, _] in vertices {
                floats(&part.normal(normal).to_array())?;
            }
        }
        if part.mesh.has_uvs() {
            for &[.., uv] in vertices {
                let uv = part.uv(uv);
                // glTF's origin is the top left.
                floats(&[uv.x, 1.0 - uv.y])?;
            }
        }
        if let Some(colors) = &self.colors {
            for &[position, ..] in vertices {
                let [r, g, b] = linear(colors[position as usize]).to_array();
                for channel in [r, g, b, 1.0] {
                    let channel = (channel * f32::from(u16::MAX)).round() as u16;
                    out.write_all(&channel.to_le_bytes())?;
                }
            }
        }
        for index in self.join_attributes.triangles.as_flattened() {
            out.write_all(&index.to_le_bytes())?;
        }
        Ok(())
    }
}
