//! Building over instances: a tree for each mesh, and a top-level tree over the objects. When objects change, only
//! the latter is rebuilt.

use super::build::build_world;
use super::flatten::{World, common_origin};
use super::instances::{Instance, Instances, MeshTree, Opened, PlacedTree, pages_after};
use super::top_level::{Root, TOP_DEPTH, area, top_level};
use super::tree::{Box32, DEPTH_LIMIT, Subtree, TRIANGLE_LIMIT, Tree};
use super::{Accel, Triangle};
use crate::num::simd::Simd;
use crate::scene::{Object, Scene, SceneError};
use glam::{DAffine3, Vec3};
use rayon::prelude::*;
use std::any::Any;
use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashMap, HashSet};
use std::sync::{Arc, Weak};

/// The most objects of a scene for which [`build`] is quick: the top-level tree takes about a microsecond an object. This
/// limit and the next two keep it to some milliseconds: with higher ones a window that waits for it stalls, with lower
/// ones more changes wait for a worker.
const QUICK_OBJECTS: usize = 4096;

/// The most new placements for which [`build`] is quick: finding the bounds of one takes some ten microseconds.
const QUICK_PLACES: usize = 64;

/// The most triangles of a mesh whose tree a quick [`build`] refits to the mesh's own space.
const QUICK_TRIANGLES: usize = 1 << 16;

/// The most triangles of a scene whose corners are all placed once, in 60 MB, instead of by each packet: casting
/// takes 1.2 to 1.9 times as long where packets place them. The corners of a mesh that only one object has are always
/// placed; its tree in its own space is then not kept.
const PLACED_TRIANGLES: usize = 1 << 20;

/// The number of triangles that are stored for a scene: see [`PLACED_TRIANGLES`].
pub(super) fn stored_triangles(scene: &Scene) -> usize {
    let all = scene.triangle_count();
    if all <= PLACED_TRIANGLES {
        return all;
    }
    let meshes: HashMap<_, _> = (scene.objects.iter())
        .map(|object| (address(object), object.mesh.triangles().len()))
        .collect();
    meshes.values().sum()
}

/// The most subtrees of objects below the top-level tree, unless there are more objects. With more, overlapping
/// objects are separated better; with fewer, the top-level tree is built faster.
const ROOTS: usize = 1024;

/// An object's triangles, by their [`address`], and its transform, as bits.
type Key = (usize, [u64; 12]);

/// Trees that the next state of a scene may reuse, by the [`address`] of their triangles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Known {
    /// An address stays a mesh's own as long as a reference to it exists, even a weak one.
    meshes: HashMap<usize, Source>,
    /// Trees in the mesh's own space.
    trees: HashMap<usize, Arc<MeshTree>>,
    placed: HashMap<Key, PlacedTree>,
    /// For each mesh with one, a tree of all its triangles whose corners are placed.
    trees_in_place: HashMap<usize, Arc<MeshTree>>,
}

impl Known {
    fn new(
        meshes: HashMap<usize, Source>,
        trees: HashMap<usize, Arc<MeshTree>>,
        placed: HashMap<Key, PlacedTree>,
    ) -> Self {
        let is_whole = |placed: &PlacedTree| placed.placement.is_none() && !placed.tree.is_placed;
        let whole = placed.iter().filter(|(_, placed)| is_whole(placed));
        let trees_in_place = whole.map(|(key, placed)| (key.0, Arc::clone(&placed.tree)));
        Self {
            trees_in_place: trees_in_place.collect(),
            meshes,
            trees,
            placed,
        }
    }

    /// The known placed meshes among `keys`; and for each other key, the number of an object that has it.
    fn placed_and_missing(&self, keys: &[Key]) -> (HashMap<Key, PlacedTree>, HashMap<Key, usize>) {
        let mut placed = HashMap::with_capacity(keys.len());
        let mut missing = HashMap::new();
        for (number, key) in keys.iter().enumerate() {
            match self.placed.get(key) {
                Some(known) => _ = placed.insert(*key, known.clone()),
                None => _ = missing.insert(*key, number),
            }
        }
        (placed, missing)
    }

    /// Keeps the placed trees of meshes that have no other tree: an object that was removed may come back.
    fn keep_only_trees(
        &self,
        meshes: &HashMap<usize, Source>,
        trees: &HashMap<usize, Arc<MeshTree>>,
        placed: &mut HashMap<Key, PlacedTree>,
    ) {
        let is_only = |key: &Key, known: &PlacedTree| {
            known.placement.is_none() && meshes.contains_key(&key.0) && !trees.contains_key(&key.0)
        };
        for (key, known) in self
            .placed
            .iter()
            .filter(|(key, known)| is_only(key, known))
        {
            placed.entry(*key).or_insert_with(|| known.clone());
        }
    }

    /// Whether a mesh has a tree, in its own space or placed.
    fn has_tree(&self, address: usize) -> bool {
        self.trees.contains_key(&address) || self.trees_in_place.contains_key(&address)
    }

    /// All trees; a tree that is used more than once is repeated.
    pub(super) fn all_trees(&self) -> impl Iterator<Item = &Arc<MeshTree>> {
        let placed = self.placed.values().map(|placed| &placed.tree);
        self.trees.values().chain(placed)
    }

    /// Bytes retained beside the trees.
    pub(super) fn retained_bytes(&self) -> usize {
        fn table<K, V>(map: &HashMap<K, V>) -> usize {
            map.capacity() * size_of::<(K, V)>()
        }
        table(&self.meshes) + table(&self.trees) + table(&self.placed) + table(&self.trees_in_place)
    }
}

/// What a tree's triangles come from.
#[derive(Clone, Debug)]
struct Source {
    reference: Weak<dyn Any + Send + Sync>,
    /// Whether they are all of a mesh's, and none is hidden.
    is_whole: bool,
}

impl Source {
    fn of(object: &Object) -> Self {
        let reference: Arc<dyn Any + Send + Sync> = match object.hidden() {
            Some(hidden) => Arc::clone(hidden) as _,
            None => Arc::clone(&object.mesh) as _,
        };
        Self {
            reference: Arc::downgrade(&reference),
            is_whole: object.hidden().is_none(),
        }
    }

    /// Whether its trees are kept although the scene no longer has it: an object may come back. What hidden groups left
    /// may too, but there may be as many choices of groups as there are steps to undo.
    fn may_return(&self) -> bool {
        self.is_whole && self.reference.strong_count() > 0
    }
}

/// Identifies an object's triangles: the address of its mesh, or of what says which of its groups are hidden.
fn address(object: &Object) -> usize {
    match object.hidden() {
        Some(hidden) => Arc::as_ptr(hidden).addr(),
        None => Arc::as_ptr(&object.mesh).addr(),
    }
}

fn key(object: &Object, world_from_object: &DAffine3) -> Key {
    let bits = world_from_object.to_cols_array().map(f64::to_bits);
    (address(object), bits)
}

/// The tree of a mesh alone; with `is_placed`, of its triangles as they are placed there.
fn mesh_tree(world: World<'_>, is_placed: bool) -> Arc<MeshTree> {
    let accel = build_world(world, DEPTH_LIMIT - TOP_DEPTH);
    Arc::new(MeshTree {
        triangles: accel.triangles,
        tree: accel.tree,
        out_of_range: accel.out_of_range,
        is_placed,
    })
}

/// Builds the structure over a scene, reusing the trees of the one before. With `quick`, `None` where it would take
/// long.
///
/// The origin stays that of the structure before, so that moving an object changes no other's corners.
pub(super) fn build(
    scene: &Scene,
    before: Option<&Accel>,
    quick: bool,
) -> Result<Option<Accel>, SceneError> {
    if quick && scene.objects.len() > QUICK_OBJECTS {
        return Ok(None);
    }
    let transforms = scene.world_from_objects()?;
    let origin = match before {
        Some(before) => before.origin,
        None => common_origin(scene, &transforms),
    };
    let world = World::about(scene, &transforms, origin)?;
    let nothing = Known::default();
    let known = before.and_then(|before| before.known.as_deref());
    let known = known.unwrap_or(&nothing);

    let keys = scene.objects.iter().zip(&transforms);
    let keys: Vec<Key> = keys
        .map(|(object, transform)| key(object, transform))
        .collect();
    let (mut placed, missing) = known.placed_and_missing(&keys);
    let objects = missing.values().map(|&number| &scene.objects[number]);
    let Some(mut trees) = trees(objects, known, quick) else {
        return Ok(None);
    };
    if quick && missing.len() > QUICK_PLACES {
        return Ok(None);
    }
    let uses = uses(&keys);
    let placer = Placer {
        world: &world,
        known,
        trees: &trees,
        uses: &uses,
        is_loaded: before.is_none_or(|before| before.known.is_some()),
        is_small: scene.triangle_count() <= PLACED_TRIANGLES,
        quick,
    };
    if placer.place_all(missing, &mut placed).is_none() {
        return Ok(None);
    }
    if !quick {
        drop_doubles(&mut trees, &placed, &uses);
    }
    let meshes = living_meshes(scene, known);
    trees.retain(|address, _| meshes.contains_key(address));
    known.keep_only_trees(&meshes, &trees, &mut placed);

    let most_roots = keys.len().max(ROOTS);
    let Some((all, out_of_range)) = instances(&keys, &placed, &world, most_roots) else {
        return if quick {
            Ok(None)
        } else {
            Accel::build(scene).map(Some)
        };
    };
    let (top, root) = top_level(&mut roots(&all, most_roots));
    // From the instances: the roots of the top-level tree are wider where instances were opened.
    let bounds = all.iter().map(|instance| instance.placed.bounds);
    let tree = Tree {
        nodes: Vec::new(),
        root: root.map(|(root, _)| root),
        bounds: bounds.fold(Box32::EMPTY, Box32::union),
    };
    Ok(Some(Accel {
        origin,
        triangles: Vec::new(),
        tree,
        instances: Instances::new(top, all),
        simd: before.map_or_else(Simd::best, Accel::simd),
        first_numbers: world.first_numbers,
        out_of_range,
        known: Some(Arc::new(Known::new(meshes, trees, placed))),
    }))
}

/// The number of objects that have each mesh.
fn uses(keys: &[Key]) -> HashMap<usize, usize> {
    let mut uses = HashMap::new();
    for (address, _) in keys {
        *uses.entry(*address).or_default() += 1;
    }
    uses
}

/// Places meshes' trees where no placed tree is known.
struct Placer<'a> {
    world: &'a World<'a>,
    known: &'a Known,
    /// Trees in the meshes' own spaces.
    trees: &'a HashMap<usize, Arc<MeshTree>>,
    uses: &'a HashMap<usize, usize>,
    /// Whether objects were loaded with the scene, and not moved in it.
    is_loaded: bool,
    /// Whether all corners may be placed: see [`PLACED_TRIANGLES`].
    is_small: bool,
    quick: bool,
}

impl Placer<'_> {
    /// Places the missing keys. With `quick`, `None` where it would take long.
    fn place_all(
        &self,
        missing: HashMap<Key, usize>,
        placed: &mut HashMap<Key, PlacedTree>,
    ) -> Option<()> {
        let place = |(key, number): (Key, usize)| Some((key, self.place(key, number)?));
        if self.quick {
            for missing in missing {
                placed.extend([place(missing)?]);
            }
        } else {
            placed.par_extend(missing.into_par_iter().filter_map(place));
        }
        Some(())
    }

    /// The tree of a key's mesh, placed as the object of this number is. With `quick`, `None` where it would take
    /// long.
    fn place(&self, key: Key, number: usize) -> Option<PlacedTree> {
        let object = &self.world.objects[number];
        let tree = self.trees.get(&key.0)?;
        let in_place = PlacedTree::new(Arc::clone(tree), object.placement).or_else(|| {
            if self.quick && tree.triangles.len() > QUICK_TRIANGLES {
                return None;
            }
            // Some triangles may be out of range: builds a tree over the others.
            let tree = mesh_tree(World::alone(*object), true);
            PlacedTree::new(tree, None)
        })?;
        Some(if self.places_corners(key.0) {
            in_place.with_tree_in_place()
        } else {
            in_place
        })
    }

    /// Whether a mesh's corners are placed once. An object that a person moves will be moved again, so its corners
    /// are left to the packets.
    fn places_corners(&self, mesh: usize) -> bool {
        !self.quick
            && self.is_loaded
            && !self.known.has_tree(mesh)
            && (self.is_small || self.uses.get(&mesh) == Some(&1))
    }
}

/// Removes trees of meshes with one object where that object has a placed tree of its own.
fn drop_doubles(
    trees: &mut HashMap<usize, Arc<MeshTree>>,
    placed: &HashMap<Key, PlacedTree>,
    uses: &HashMap<usize, usize>,
) {
    let only = placed
        .iter()
        .filter(|(key, _)| uses.get(&key.0) == Some(&1));
    for (key, placed) in only {
        let is_own = |tree: &Arc<MeshTree>| Arc::ptr_eq(tree, &placed.tree);
        if placed.placement.is_none() && !trees.get(&key.0).is_some_and(is_own) {
            trees.remove(&key.0);
        }
    }
}

/// The meshes, known or of the scene, whose trees are kept.
fn living_meshes(scene: &Scene, known: &Known) -> HashMap<usize, Source> {
    let mut meshes = known.meshes.clone();
    meshes.retain(|_, source| source.may_return());
    for object in &scene.objects {
        meshes
            .entry(address(object))
            .or_insert_with(|| Source::of(object));
    }
    meshes
}

/// The instances of all visible objects, each with its primitive indices, which follow those of the top-level tree;
/// and the number of triangles out of range. `None` where 32 bits do not hold the indices: one tree over all needs
/// fewer, since it has no pages.
fn instances(
    keys: &[Key],
    placed: &HashMap<Key, PlacedTree>,
    world: &World<'_>,
    most_roots: usize,
) -> Option<(Vec<Instance>, u32)> {
    let mut all = Vec::with_capacity(keys.len());
    let (mut next, mut out_of_range) = (pages_after(0, most_roots as u32), 0);
    // Of objects with one mesh and one transform the first wins wherever rays hit them.
    let mut seen = HashSet::with_capacity(keys.len());
    for (object, key) in keys.iter().enumerate() {
        let Some(placed) = placed.get(key).filter(|_| world.objects[object].visible) else {
            continue;
        };
        out_of_range += placed.tree.out_of_range;
        if placed.tree.triangles.is_empty() || !seen.insert(key) {
            continue;
        }
        let first = next?;
        let end = pages_after(first, placed.tree.indices()).filter(|&end| end <= TRIANGLE_LIMIT)?;
        all.push(Instance {
            object: object as u32,
            first_number: world.first_numbers[object],
            first,
            placed: placed.clone(),
        });
        next = Some(end);
    }
    Some((all, out_of_range))
}

/// The known trees, and those of some meshes. With `quick`, `None` where one would have to be built.
fn trees<'m>(
    objects: impl Iterator<Item = &'m Object>,
    known: &Known,
    quick: bool,
) -> Option<HashMap<usize, Arc<MeshTree>>> {
    let mut trees = known.trees.clone();
    let mut missing: HashMap<usize, &Object> = HashMap::new();
    for object in objects {
        let (address, mesh) = (address(object), &object.mesh);
        if trees.contains_key(&address) || missing.contains_key(&address) {
            continue;
        }
        match known.trees_in_place.get(&address) {
            Some(tree) if !quick || tree.triangles.len() <= QUICK_TRIANGLES => {
                let own =
                    |triangle: &Triangle| mesh.corners(triangle.number).unwrap_or([Vec3::NAN; 3]);
                trees.insert(address, Arc::new(tree.refitted(own)));
            }
            _ if quick => return None,
            _ => _ = missing.insert(address, object),
        }
    }
    trees.par_extend(missing.into_par_iter().map(|(address, object)| {
        let tree = mesh_tree(World::of_object(object), false);
        (address, tree)
    }));
    Some(trees)
}

/// The subtrees that the top-level tree is built over: the objects' roots and, while there are fewer than `most`, the
/// children of the largest ones, so that rays distinguish objects that overlap (Benthin, Woop, Wald, Áfra, "Improved
/// Two-Level BVHs using Partial Re-Braiding", 2017).
fn roots(all: &[Instance], most: usize) -> Vec<Root> {
    let roots = all.iter().filter_map(|instance| {
        let root = instance.placed.tree.tree.root?;
        Some(SizedRoot::new(instance, root, instance.placed.bounds))
    });
    let mut roots: BinaryHeap<SizedRoot<'_>> = roots.collect();
    let mut done = Vec::with_capacity(most);
    // A single object overlaps no other.
    while all.len() > 1 && roots.len() + done.len() < most {
        let Some(largest) = roots.pop() else { break };
        match largest.opened() {
            Some(children) => roots.extend(children),
            None => done.push(largest),
        }
    }
    done.extend(roots);
    done.sort_unstable_by_key(|root| (root.instance.first, root.subtree.first));
    let shifted = |root: SizedRoot<'_>| (root.subtree.shifted(root.instance.first), root.around);
    done.into_iter().map(shifted).collect()
}

/// A subtree of an instance, ordered by the area of its box.
struct SizedRoot<'i> {
    area: f64,
    instance: &'i Instance,
    subtree: Subtree,
    around: Box32,
}

impl<'i> SizedRoot<'i> {
    fn new(instance: &'i Instance, subtree: Subtree, around: Box32) -> Self {
        Self {
            area: area(&around),
            instance,
            subtree,
            around,
        }
    }

    /// The children, unless it is a leaf.
    fn opened(&self) -> Option<[Self; 2]> {
        let Opened { boxes, children } = self.instance.placed.open(self.subtree.node()?);
        let [a, b] = children;
        let child = |which, subtree| Self::new(self.instance, subtree, boxes.get(which));
        Some([child(0, a), child(1, b)])
    }
}

impl Ord for SizedRoot<'_> {
    fn cmp(&self, other: &Self) -> Ordering {
        let place = |root: &Self| (root.instance.first, root.subtree.first);
        self.area
            .total_cmp(&other.area)
            .then(place(other).cmp(&place(self)))
    }
}

impl PartialOrd for SizedRoot<'_> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for SizedRoot<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for SizedRoot<'_> {}
