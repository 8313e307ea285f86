//! 3MF, with colours, base materials and the production extension.

mod attributes;
mod model;
mod model_reader;
mod package;

use super::length_unit::LengthUnit;
use crate::formats::Progress;
use crate::formats::error::{FormatError, quote};
use crate::formats::limits::Budget;
use crate::formats::placed_meshes::{NODE_LIMIT, PlacedMesh, PlacedMeshes};
use crate::quote;
use crate::scene::MeshData;
use glam::DAffine3;
use model::{Instance, Model, Shape};
use package::Package;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

#[cfg(test)]
mod tests;

/// The model parts, in order of first use.
#[derive(Default)]
struct Models {
    names: HashMap<String, usize>,
    models: Vec<Model>,
    /// The parts' names.
    parts: Vec<String>,
}

/// A step of traversing the tree of components.
enum Step {
    /// Enters an object: the part that names it, the instance, and the transform outside it.
    Enter(Box<(usize, Instance, DAffine3)>),
    /// Leaves an object of a part.
    Leave((usize, u32)),
}

/// Reads a 3MF file.
///
/// Build items are placed depth first; an object that is built twice becomes two nodes of one mesh. Coordinates are
/// in the file's unit.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    budget: &Budget,
    progress: Progress<'_>,
) -> Result<PlacedMeshes, FormatError> {
    let mut package = Package::open(path, bytes, budget)?;
    let root = package.model()?;
    let mut models = Models::default();
    let mut share = budget.share(path, "the models", 0)?;
    let mut held = 0;
    let mut triangles = 0;
    let mut model = |package: &mut Package<'_>, models: &mut Models, name: &str| {
        let key = name.trim_start_matches('/').to_ascii_lowercase();
        if let Some(&number) = models.names.get(&key) {
            return Ok(number);
        }
        let part = package.part(name)?;
        held += bytes_of(&part.text);
        share.grow(path, "the models", held)?;
        let left = budget.triangles_left().saturating_sub(triangles);
        let model = model_reader::read(package, &part, left)?;
        let meshes = model.objects.values().map(|object| match &object.shape {
            Shape::Mesh(mesh) => mesh.triangles.len() as u64,
            Shape::Components(_) | Shape::Taken(_) => 0,
        });
        triangles += meshes.sum::<u64>();
        models.names.insert(key, models.models.len());
        models.models.push(model);
        models.parts.push(part.name);
        Ok::<_, FormatError>(models.models.len() - 1)
    };
    let root = model(&mut package, &mut models, &root)?;
    progress(0.5);

    let mut placed = PlacedMeshes::default();
    let mut on_the_way: HashSet<(usize, u32)> = HashSet::new();
    let mut steps: Vec<Step> = Vec::new();
    let mut count = 0;
    let items = models.models[root].items.iter().rev();
    steps.extend(items.map(|item| Step::Enter(Box::new((root, item.clone(), DAffine3::IDENTITY)))));
    while let Some(step) = steps.pop() {
        let (named_in, instance, world_from_outer) = match step {
            Step::Enter(enter) => *enter,
            Step::Leave(key) => {
                on_the_way.remove(&key);
                continue;
            }
        };
        let place = |models: &Models, reason: &str| {
            let line = Some(instance.line);
            package.fault(&models.parts[named_in], line, reason)
        };
        count += 1;
        if count > NODE_LIMIT {
            let reason = format!("more than {NODE_LIMIT} items and components");
            return Err(place(&models, &reason));
        }
        let number = match &instance.part {
            Some(name) => model(&mut package, &mut models, name)?,
            None => named_in,
        };
        let id = instance.object;
        let world_from_object = if instance.outer_from_object == DAffine3::IDENTITY {
            world_from_outer
        } else if world_from_outer == DAffine3::IDENTITY {
            instance.outer_from_object
        } else {
            world_from_outer * instance.outer_from_object
        };
        let fault =
            |reason: &str| package.fault(&models.parts[named_in], Some(instance.line), reason);
        if !world_from_object.is_finite() {
            return Err(fault(
                "expected a place of finite numbers, found one beyond them",
            ));
        }
        let Some(object) = models.models[number].objects.get_mut(&id) else {
            let reason = format!("expected the number of an object, found {id}");
            return Err(fault(&reason));
        };
        let mesh = match &mut object.shape {
            Shape::Taken(mesh) => *mesh,
            Shape::Mesh(mesh) => {
                let data: MeshData = std::mem::take(mesh);
                placed.meshes.push(data);
                object.shape = Shape::Taken(placed.meshes.len() - 1);
                placed.meshes.len() - 1
            }
            Shape::Components(components) => {
                if !on_the_way.insert((number, id)) {
                    return Err(fault(&format!("object {id} is a part of itself")));
                }
                steps.push(Step::Leave((number, id)));
                let inner = components.iter().rev().cloned();
                steps.extend(
                    inner.map(|inner| Step::Enter(Box::new((number, inner, world_from_object)))),
                );
                continue;
            }
        };
        placed.nodes.push(PlacedMesh {
            name: object
                .name
                .as_ref()
                .map_or_else(String::new, |name| name.chars().take(200).collect()),
            mesh,
            world_from_object,
        });
    }
    progress(0.9);
    if placed.meshes.iter().all(|mesh| mesh.triangles.is_empty()) {
        let found = match placed.nodes.len() {
            0 => "nothing that is built".to_owned(),
            nodes => format!("none in {nodes} objects"),
        };
        return Err(FormatError::unexpected(path, None, "triangles", found));
    }
    name_the_nameless(path, &mut placed.nodes);
    report(path, &models, root, &mut placed);
    progress(1.0);
    Ok(placed)
}

/// An upper bound of the memory that a model part's contents take.
fn bytes_of(text: &[u8]) -> u64 {
    let count = |word: &str| memchr::memmem::find_iter(text, word).count() as u64;
    // A vertex of 20 characters becomes 24 bytes, a triangle of 30 as many, in lists that double while the old one
    // exists. Objects, their instances and colours take more than their text.
    3 * text.len() as u64 + 1024 * count("object") + 512 * count("color")
}

/// Names objects without a name after the file.
fn name_the_nameless(path: &Path, nodes: &mut [PlacedMesh]) {
    let file = path.file_stem().unwrap_or_default().to_string_lossy();
    let count = nodes.len();
    for (number, node) in nodes.iter_mut().enumerate() {
        if node.name.is_empty() {
            node.name = match count {
                1 => file.to_string(),
                _ => format!("{file} {}", number + 1),
            };
        }
    }
}

/// Adds warnings about contents that are not shown, and notes about metadata.
fn report(path: &Path, models: &Models, root: usize, placed: &mut PlacedMeshes) {
    let mixed: usize = models.models.iter().map(|model| model.mixed).sum();
    if mixed > 0 {
        placed.warnings.push(format!(
            "{}: triangles whose corners have different colours, of which the first is shown: {mixed}",
            quote::path(path)
        ));
    }
    let unit = &models.models[root].unit;
    placed.unit = LengthUnit::from_threemf(unit);
    let unit = quote(unit);
    placed
        .notes
        .push(format!("unit: {}; up axis: Z", unit.trim_matches('"')));
    let mut unused: BTreeMap<&str, usize> = BTreeMap::new();
    for (what, count) in models.models.iter().flat_map(|model| &model.unused) {
        *unused.entry(what).or_default() += count;
    }
    let hidden = models
        .models
        .iter()
        .flat_map(|model| model.objects.values());
    let hidden = hidden
        .filter(|object| matches!(object.shape, Shape::Mesh(_)))
        .count();
    if hidden > 0 {
        unused.insert("meshes that are not built", hidden);
    }
    if !unused.is_empty() {
        let unused = unused
            .iter()
            .map(|(what, count)| format!("{what} ({count})"));
        let unused: Vec<String> = unused.collect();
        placed
            .notes
            .push(format!("not used: {}", unused.join(", ")));
    }
}
