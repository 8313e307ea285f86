//! glTF 2.0, as JSON or as GLB.
//!
//! Every index, offset, stride and count is checked before use. Accessors are read here because libraries refuse
//! `KHR_mesh_quantization`.

mod data;
mod json;
mod material;
mod mesh;
mod nodes;

use super::length_unit::LengthUnit;
use crate::formats::Progress;
use crate::formats::error::{FormatError, quote};
use crate::formats::files::Files;
use crate::formats::kind::GLB_SIGNATURE;
use crate::formats::lines::without_mark;
use crate::formats::parsed::BLENDED;
use crate::formats::placed_meshes::{PlacedMesh, PlacedMeshes};
use crate::quote;
use data::Data;
use json::Root;
use material::Materials;
use mesh::Skipped;
use nodes::MeshNode;
use std::collections::HashMap;
use std::path::Path;

#[cfg(test)]
mod material_tests;
#[cfg(test)]
mod refusal_tests;
#[cfg(test)]
mod tests;

/// Extensions that do not affect what is shown, or that are supported.
const KNOWN: [&str; 6] = [
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_technique_webgl",
    "KHR_techniques_webgl",
    "KHR_texture_transform",
    "KHR_xmp_json_ld",
];

/// Extensions that are supported completely.
const READ: [&str; 5] = [
    "KHR_materials_emissive_strength",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Reads a glTF file or a GLB, and through `files` its buffers and images.
///
/// Meshes are in their own spaces. Skinned and morphed meshes are in their rest pose, placed by their node.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    files: &dyn Files,
    progress: Progress<'_>,
) -> Result<PlacedMeshes, FormatError> {
    let (json, binary) = match bytes.starts_with(GLB_SIGNATURE) {
        true => chunks(path, bytes)?,
        false => (without_mark(bytes), None),
    };
    let is_binary = bytes.starts_with(GLB_SIGNATURE);
    let (root, _share) = json::parse(path, json, is_binary, files.budget())?;
    check_version(path, &root)?;
    let data = Data::new(path, &root, binary, files);
    data.name_files();
    let mesh_nodes = nodes::mesh_nodes(&data)?;
    let mut materials = Materials::new(&data);
    materials.decode_ahead(mesh_nodes.iter().map(|node| node.mesh));
    let mut skipped = Skipped::default();
    let mut placed = PlacedMeshes::default();
    let mut meshes: HashMap<u32, usize> = HashMap::new();
    for (done, node) in mesh_nodes.iter().enumerate() {
        progress(done as f32 / mesh_nodes.len() as f32);
        let mesh = match meshes.get(&node.mesh) {
            Some(&mesh) => mesh,
            None => {
                let mesh = mesh::read(&data, &mut materials, node.mesh, &mut skipped)?;
                placed.meshes.push(mesh);
                meshes.insert(node.mesh, placed.meshes.len() - 1);
                placed.meshes.len() - 1
            }
        };
        placed.nodes.push(PlacedMesh {
            name: name(path, &root, node, done, mesh_nodes.len()),
            mesh,
            world_from_object: node.world_from_node,
        });
    }
    if placed.meshes.iter().all(|mesh| mesh.triangles.is_empty()) {
        let found = match mesh_nodes.len() {
            0 => "no node with a mesh".to_owned(),
            _ if skipped.points_and_lines > 0 => "points and lines alone".to_owned(),
            count => format!("none in {count} nodes"),
        };
        return Err(FormatError::unexpected(path, None, "triangles", found));
    }
    placed.unit = Some(LengthUnit::Metre);
    placed.notes = notes(&root, &materials);
    placed.warnings = warnings(path, &mesh_nodes, &skipped, materials.blended);
    placed.warnings.append(&mut materials.warnings);
    Ok(placed)
}

/// Warnings about features that are not shown, or not as the file has them.
fn warnings(path: &Path, nodes: &[MeshNode<'_>], skipped: &Skipped, blended: usize) -> Vec<String> {
    let path = quote::path(path);
    let skinned = nodes.iter().filter(|node| node.node.skin.is_some()).count();
    let counts = [
        (
            skipped.points_and_lines,
            "primitives of points or lines, which are not shown",
        ),
        (
            skipped.empty,
            "primitives without positions, which are not shown",
        ),
        (
            skipped.loose_corners,
            "corners behind the last whole triangle, which are passed over",
        ),
        (skinned, "nodes with skins, which are shown at rest"),
        (
            skipped.morphs,
            "meshes with morph targets, which are shown at rest",
        ),
        (blended, BLENDED),
    ];
    let counted = counts.iter().filter(|(count, _)| *count > 0);
    counted
        .map(|(count, what)| format!("{path}: {what}: {count}"))
        .collect()
}

/// Notes about the file's metadata, and about unused contents.
fn notes(root: &Root<'_>, materials: &Materials<'_, '_>) -> Vec<String> {
    let mut unused = materials.unused();
    let lists = [
        (root.animations.len(), "animations"),
        (root.cameras.len(), "cameras"),
        (root.scenes.len().saturating_sub(1), "other scenes"),
    ];
    let lists = lists.iter().filter(|(count, _)| *count > 0);
    unused.extend(lists.map(|(count, what)| format!("{what} ({count})")));
    /// The most extensions that a message lists by name.
    const MAX_LISTED: usize = 8;
    let unread = |name: &&String| !READ.contains(&name.as_str());
    let extensions: Vec<&String> = root.extensions_used.iter().filter(unread).collect();
    unused.extend(extensions.iter().take(MAX_LISTED).map(|name| quote(name)));
    if extensions.len() > MAX_LISTED {
        unused.push(format!("{} more extensions", extensions.len() - MAX_LISTED));
    }
    let mut notes = vec!["unit: metre; up axis: Y".to_owned()];
    if !unused.is_empty() {
        notes.push(format!("not used: {}", unused.join(", ")));
    }
    notes
}

/// An object's name: that of its node, its mesh, or the file.
fn name(path: &Path, root: &Root<'_>, node: &MeshNode<'_>, number: usize, count: usize) -> String {
    let mesh = root.meshes.get(node.mesh as usize);
    let given = node.node.name.as_ref();
    let given = given.or_else(|| mesh.and_then(|mesh| mesh.name.as_ref()));
    match given.filter(|name| !name.is_empty()) {
        // Lists show names, so overlong ones are cut.
        Some(name) => name.chars().take(200).collect(),
        None => {
            let file = path.file_stem().unwrap_or_default().to_string_lossy();
            match count {
                1 => file.into_owned(),
                _ => format!("{file} {}", number + 1),
            }
        }
    }
}

/// # Errors
/// Another version than 2; unsupported extensions that the file requires, by name.
fn check_version(path: &Path, root: &Root<'_>) -> Result<(), FormatError> {
    let version = &root.asset.version;
    if version != "2" && !version.starts_with("2.") {
        let found = quote(version);
        return Err(FormatError::unexpected(path, None, "glTF version 2", found));
    }
    // Extensions about materials change how a surface looks, but not its shape.
    let is_known =
        |name: &String| KNOWN.contains(&name.as_str()) || name.starts_with("KHR_materials_");
    let mut unknown = root
        .extensions_required
        .iter()
        .filter(|name| !is_known(name));
    let Some(first) = unknown.next() else {
        return Ok(());
    };
    let mut found = match first.as_str() {
        "KHR_draco_mesh_compression" => "Draco compression".to_owned(),
        "EXT_meshopt_compression" | "KHR_meshopt_compression" => "meshopt compression".to_owned(),
        "EXT_texture_webp" => "WebP images".to_owned(),
        "KHR_texture_basisu" => "KTX2 images".to_owned(),
        "EXT_mesh_gpu_instancing" => "instancing on the GPU".to_owned(),
        _ => "one that is not known".to_owned(),
    };
    found = format!("{} ({found})", quote(first));
    let more = unknown.count();
    if more > 0 {
        found.push_str(&format!(" and {more} more"));
    }
    let expected = "no extensions that it needs but those that are read";
    Err(FormatError::unexpected(path, None, expected, found))
}

/// A chunk's type, its bytes, and the offset of the next chunk.
type Chunk<'b> = (&'b [u8], &'b [u8], usize);

/// A GLB's JSON, and its binary chunk.
fn chunks<'b>(path: &Path, bytes: &'b [u8]) -> Result<(&'b [u8], Option<&'b [u8]>), FormatError> {
    const JSON: &[u8] = b"JSON";
    const BINARY: &[u8] = b"BIN\0";
    let fault = |at: usize, expected: &str, found: String| {
        let reason = format!("byte {at}: expected {expected}, found {found}");
        FormatError::refused(path, None, &reason)
    };
    let number = |at: usize| match bytes.get(at..at + 4) {
        Some(&[a, b, c, d]) => Ok(u32::from_le_bytes([a, b, c, d])),
        _ => Err(fault(at, "a GLB's header", "the file's end".to_owned())),
    };
    let version = number(4)?;
    if version != 2 {
        return Err(fault(4, "GLB version 2", version.to_string()));
    }
    let length = number(8)? as usize;
    if length > bytes.len() {
        let found = format!("{}: it is cut short", bytes.len());
        return Err(fault(8, &format!("a file of {length} bytes"), found));
    }
    let chunk = |at: usize| -> Result<Option<Chunk<'b>>, FormatError> {
        if length.saturating_sub(at) < 8 {
            return Ok(None);
        }
        let size = number(at)? as usize;
        let left = length - at - 8;
        if size > left {
            let expected = format!("a chunk of at most {left} bytes");
            return Err(fault(at, &expected, size.to_string()));
        }
        let behind = at + 8 + size;
        Ok(Some((
            &bytes[at + 4..at + 8],
            &bytes[at + 8..behind],
            behind,
        )))
    };
    let Some((JSON, json, mut at)) = chunk(12)? else {
        return Err(fault(12, "a chunk of JSON", "none".to_owned()));
    };
    while let Some((kind, content, behind)) = chunk(at)? {
        if kind == BINARY {
            return Ok((json, Some(content)));
        }
        at = behind;
    }
    Ok((json, None))
}
