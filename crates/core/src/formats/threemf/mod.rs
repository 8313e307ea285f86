//! 3MF, with colours, base materials and the production extension.

mod attributes;
mod model;
mod model_reader;
mod package;
mod properties;

use super::length_unit::LengthUnit;
use crate::formats::Progress;
use crate::formats::error::{FormatError, quote};
use crate::formats::limits::{Budget, Share};
use crate::formats::placed_meshes::{NODE_LIMIT, PlacedMesh, PlacedMeshes};
use crate::quote;
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
    let mut loader = Loader {
        package: Package::open(path, bytes, budget)?,
        path,
        budget,
        models: Models::default(),
        share: budget.share(path, "the models", 0)?,
        held: 0,
        triangles: 0,
    };
    let root = loader.package.model()?;
    let root = loader.model(&root)?;
    progress(0.5);
    let mut placed = loader.place(root)?;
    progress(0.9);
    if placed.meshes.iter().all(|mesh| mesh.triangles.is_empty()) {
        let found = match placed.nodes.len() {
            0 => "nothing that is built".to_owned(),
            nodes => format!("none in {nodes} objects"),
        };
        return Err(FormatError::unexpected(path, None, "triangles", found));
    }
    name_the_nameless(path, &mut placed.nodes);
    report(path, &loader.models, root, &mut placed);
    progress(1.0);
    Ok(placed)
}

/// Reads the models of a package, each once.
struct Loader<'a> {
    package: Package<'a>,
    path: &'a Path,
    budget: &'a Budget,
    models: Models,
    /// The memory that models take.
    share: Share<'a>,
    held: u64,
    /// The triangles of all models.
    triangles: u64,
}

impl Loader<'_> {
    /// The number of a model, which is read if it is not known.
    fn model(&mut self, name: &str) -> Result<usize, FormatError> {
        let key = name.trim_start_matches('/').to_ascii_lowercase();
        let models = &mut self.models;
        if let Some(&number) = models.names.get(&key) {
            return Ok(number);
        }
        let part = self.package.part(name)?;
        self.held += bytes_of(&part.text);
        self.share.grow(self.path, "the models", self.held)?;
        let left = self.budget.triangles_left().saturating_sub(self.triangles);
        let model = model_reader::read(&self.package, &part, left)?;
        let meshes = model.objects.values().map(|object| match &object.shape {
            Shape::Mesh(mesh) => mesh.triangles.len() as u64,
            Shape::Components(_) | Shape::Taken(_) => 0,
        });
        self.triangles += meshes.sum::<u64>();
        models.names.insert(key, models.models.len());
        models.models.push(model);
        models.parts.push(part.name);
        Ok(models.models.len() - 1)
    }

    /// The meshes and their nodes that a model's build items lead to.
    fn place(&mut self, root: usize) -> Result<PlacedMeshes, FormatError> {
        let mut placed = PlacedMeshes::default();
        let mut on_the_way: HashSet<(usize, u32)> = HashSet::new();
        let items = self.models.models[root].items.iter().rev();
        let enter = |number, inner, from| Step::Enter(Box::new((number, inner, from)));
        let items = items.map(|item| enter(root, item.clone(), DAffine3::IDENTITY));
        let mut steps: Vec<Step> = items.collect();
        let mut count = 0;
        while let Some(step) = steps.pop() {
            let (named_in, instance, world_from_outer) = match step {
                Step::Enter(enter) => *enter,
                Step::Leave(key) => {
                    on_the_way.remove(&key);
                    continue;
                }
            };
            count += 1;
            if count > NODE_LIMIT {
                let reason = format!("more than {NODE_LIMIT} items and components");
                return Err(self.fault(named_in, &instance, &reason));
            }
            let number = match &instance.part {
                Some(name) => self.model(name)?,
                None => named_in,
            };
            let id = instance.object;
            let world_from_object = product(world_from_outer, instance.outer_from_object);
            if !world_from_object.is_finite() {
                let reason = "expected a placement of finite numbers, found one beyond them";
                return Err(self.fault(named_in, &instance, reason));
            }
            let Some(object) = self.models.models[number].objects.get_mut(&id) else {
                let reason = format!("expected the number of an object, found {id}");
                return Err(self.fault(named_in, &instance, &reason));
            };
            let mesh = match &mut object.shape {
                Shape::Taken(mesh) => *mesh,
                Shape::Mesh(mesh) => {
                    placed.meshes.push(std::mem::take(mesh));
                    object.shape = Shape::Taken(placed.meshes.len() - 1);
                    placed.meshes.len() - 1
                }
                Shape::Components(components) => {
                    if !on_the_way.insert((number, id)) {
                        let reason = format!("object {id} is a part of itself");
                        return Err(self.fault(named_in, &instance, &reason));
                    }
                    steps.push(Step::Leave((number, id)));
                    let inner = components.iter().rev().cloned();
                    steps.extend(inner.map(|inner| enter(number, inner, world_from_object)));
                    continue;
                }
            };
            let name = object.name.as_deref().unwrap_or_default();
            placed.nodes.push(PlacedMesh {
                name: name.chars().take(200).collect(),
                mesh,
                world_from_object,
            });
        }
        Ok(placed)
    }

    /// A fault of an item or a component in a model.
    fn fault(&self, model: usize, instance: &Instance, reason: &str) -> FormatError {
        let part = &self.models.parts[model];
        self.package.fault(part, Some(instance.line), reason)
    }
}

/// The product of two transforms; exactly one of them where the other is the identity.
fn product(outer: DAffine3, inner: DAffine3) -> DAffine3 {
    if inner == DAffine3::IDENTITY {
        outer
    } else if outer == DAffine3::IDENTITY {
        inner
    } else {
        outer * inner
    }
}

/// An upper bound of the memory that a model part's contents take.
fn bytes_of(text: &[u8]) -> u64 {
    let count = |word: &str| memchr::memmem::find_iter(text, word).count() as u64;
    // A vertex of 20 characters becomes 24 bytes, a triangle of 30 as many, in lists that double while the old one
    // exists. Objects, their instances and colours take more than their text, as do triangles with colours of their
    // corners, each of which may become a vertex.
    3 * text.len() as u64 + 1024 * count("object") + 512 * count("color") + 320 * count("p2")
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
            "{}: triangles whose corners have different materials, of which the first is shown: {mixed}",
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
