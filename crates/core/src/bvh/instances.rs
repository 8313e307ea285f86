//! Objects as instances: each mesh's tree is stored once, and its boxes and corners are mapped by the placement of
//! each object that has the mesh, below a top-level tree over the objects.
//!
//! Node and primitive indices continue beyond the arrays in [`Accel`](super::Accel), which are empty where there are
//! instances. Each instance has a run of whole pages of indices, as many as its mesh's tree has triangles; the run
//! before the first contains the top-level nodes. So every traversal descends from the top-level tree into the trees
//! of meshes, and a primitive index still identifies one triangle of one object.

use super::Triangle;
use super::placement::{BoxPlacement, Placement};
use super::tree::{Box32, BoxPair, Node, Subtree, Tree};
use crate::num::simd::LANES;
use crate::triangle::CornerLanes;
use glam::Vec3;
use std::sync::Arc;

/// Indices in a page, as a power of two. A larger page wastes more of the 2³¹ indices on small meshes; a smaller
/// one makes the table of pages long: ten million triangles have ten thousand pages, which stay in a cache.
const PAGE_BITS: u32 = 10;

/// Stands for a triangle that no instance has.
static NOWHERE: Triangle = Triangle {
    corners: [Vec3::NAN; 3],
    number: u32::MAX,
};

/// The first page boundary after `count` indices from `first` on. `None` beyond 32 bits.
pub(super) fn pages_after(first: u32, count: u32) -> Option<u32> {
    first.checked_add(count.checked_next_multiple_of(1 << PAGE_BITS)?)
}

/// The children of a node, with their boxes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Opened {
    pub(crate) boxes: BoxPair,
    pub(crate) children: [Subtree; 2],
}

/// The triangles of a mesh and the tree over them.
#[derive(Clone, Debug)]
pub(super) struct MeshTree {
    /// Corners in the mesh's space, or placed where no instance is to place them; numbers as in the mesh.
    pub(super) triangles: Vec<Triangle>,
    pub(super) tree: Tree,
    /// Triangles that are left out because their placement moved them out of range.
    pub(super) out_of_range: u32,
    /// Whether it contains only the triangles that are within range under one placement; it then serves no other.
    pub(super) is_placed: bool,
}

impl MeshTree {
    /// How many indices its nodes and primitives need; both start at zero.
    pub(super) fn indices(&self) -> u32 {
        self.triangles.len().max(self.tree.nodes.len()) as u32
    }

    /// The same tree, refitted to other corners.
    pub(super) fn refitted(&self, corners: impl Fn(&Triangle) -> [Vec3; 3]) -> Self {
        let refit = |triangle: &Triangle| Triangle {
            corners: corners(triangle),
            ..*triangle
        };
        let triangles: Vec<Triangle> = self.triangles.iter().map(refit).collect();
        let around = |nodes: &[Node], subtree: Subtree| match subtree.node() {
            Some(node) => {
                let boxes = nodes[node as usize].boxes;
                boxes.get(0).union(boxes.get(1))
            }
            None => {
                let primitives = subtree.primitives();
                let all = primitives.map(|p| Box32::around(&triangles[p as usize].corners));
                all.fold(Box32::EMPTY, Box32::union)
            }
        };
        let mut tree = self.tree.clone();
        // Children have greater indices than their parents.
        for index in (0..tree.nodes.len()).rev() {
            let children = tree.nodes[index].children(index as u32);
            let boxes = children.map(|child| around(&tree.nodes, child));
            tree.nodes[index].boxes = BoxPair::of(boxes);
        }
        let root = tree.root.map(|root| around(&tree.nodes, root));
        tree.bounds = root.unwrap_or(Box32::EMPTY);
        Self {
            triangles,
            tree,
            out_of_range: self.out_of_range,
            is_placed: self.is_placed,
        }
    }

    pub(super) fn retained_bytes(&self) -> usize {
        self.triangles.capacity() * size_of::<Triangle>() + self.tree.retained_bytes()
    }
}

/// A mesh's tree with its placement.
#[derive(Clone, Debug)]
pub(super) struct PlacedTree {
    pub(super) tree: Arc<MeshTree>,
    /// `None` where the tree's corners are in the scene's space already.
    pub(super) placement: Option<(Placement, BoxPlacement)>,
    /// The box around the placed corners.
    pub(super) bounds: Box32,
}

impl PlacedTree {
    /// Places a tree. `None` where a corner may be out of the range in which rays can hit it.
    pub(super) fn new(tree: Arc<MeshTree>, placement: Option<Placement>) -> Option<Self> {
        let around = tree.tree.bounds;
        let placement = placement.map(|placement| {
            let boxes = BoxPlacement::new(&placement, &around);
            (placement, boxes)
        });
        let mut placed = Self {
            tree,
            placement,
            bounds: around,
        };
        if let (Some(root), Some((_, boxes))) = (placed.tree.tree.root, &placed.placement) {
            let loose = boxes.one(around);
            if !super::flatten::in_range(&[loose.min, loose.max, loose.min]) {
                return None;
            }
            placed.bounds = Box32::EMPTY;
            placed.extend_bounds(root, loose);
        }
        Some(placed)
    }

    /// The same with a tree of its own whose corners are placed.
    pub(super) fn with_tree_in_place(self) -> Self {
        let Some((placement, _)) = &self.placement else {
            return self;
        };
        let in_place = |own: &Triangle| own.corners.map(|corner| placement.corner(corner));
        Self {
            tree: Arc::new(self.tree.refitted(in_place)),
            placement: None,
            bounds: self.bounds,
        }
    }

    /// Extends `bounds` to a subtree that lies within `around`, by branch and bound, the larger child first.
    fn extend_bounds(&mut self, subtree: Subtree, around: Box32) {
        let holds = self.bounds.min.cmple(around.min) & self.bounds.max.cmpge(around.max);
        if holds.all() {
            return;
        }
        let Some(index) = subtree.node() else {
            for primitive in subtree.primitives() {
                let corners = self.corners(primitive);
                self.bounds = self.bounds.union(Box32::around(&corners));
            }
            return;
        };
        let Opened { boxes, children } = self.open(index);
        let [a, b] = [0, 1].map(|which| boxes.get(which));
        let excess = |around: &Box32| {
            let below = (self.bounds.min - around.min).max_element();
            below.max((around.max - self.bounds.max).max_element())
        };
        let [first, second] = children;
        if excess(&a) >= excess(&b) {
            self.extend_bounds(first, a);
            self.extend_bounds(second, b);
        } else {
            self.extend_bounds(second, b);
            self.extend_bounds(first, a);
        }
    }

    /// A node of the mesh's tree, with placed boxes.
    pub(super) fn open(&self, index: u32) -> Opened {
        let node = &self.tree.tree.nodes[index as usize];
        Opened {
            boxes: match &self.placement {
                None => node.boxes,
                Some((_, placement)) => placement.boxes(&node.boxes),
            },
            children: node.children(index),
        }
    }

    /// The placed corners of a triangle.
    fn corners(&self, primitive: u32) -> [Vec3; 3] {
        let corners = self.tree.triangles[primitive as usize].corners;
        match &self.placement {
            None => corners,
            Some((placement, _)) => corners.map(|corner| placement.corner(corner)),
        }
    }
}

/// A visible object.
#[derive(Clone, Debug)]
pub(super) struct Instance {
    pub(super) object: u32,
    /// The number, among all triangles of the scene, of the mesh's first one.
    pub(super) first_number: u32,
    /// Its first index.
    pub(super) first: u32,
    pub(super) placed: PlacedTree,
}

/// All instances and the top-level tree over them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Instances {
    /// Top-level nodes, by index.
    pub(super) top: Vec<Opened>,
    pub(super) all: Vec<Instance>,
    /// For each page, the index of its instance.
    pages: Vec<u32>,
}

impl Instances {
    /// From the top-level nodes, and instances by ascending first index; these use the indices `first..end`.
    pub(super) fn new(top: Vec<Opened>, all: Vec<Instance>) -> Self {
        let mut pages = Vec::new();
        for (number, instance) in all.iter().enumerate() {
            let end = pages_after(instance.first, instance.placed.tree.indices());
            let end = end.unwrap_or(u32::MAX) >> PAGE_BITS;
            // The pages before the first instance belong to the top-level nodes.
            pages.resize(end as usize, number as u32);
        }
        Self { top, all, pages }
    }

    /// Whether there are no instances: then the arrays contain all nodes and triangles.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// The instance that an index belongs to, and the index within it.
    #[inline(always)]
    fn of(&self, index: u32) -> Option<(&Instance, u32)> {
        let number = *self.pages.get((index >> PAGE_BITS) as usize)?;
        let instance = &self.all[number as usize];
        Some((instance, index.checked_sub(instance.first)?))
    }

    /// A node's children, with their boxes in the scene's space.
    pub(crate) fn open(&self, index: u32) -> Opened {
        if let Some(opened) = self.top.get(index as usize) {
            return *opened;
        }
        let Some((instance, own)) = self.of(index) else {
            return Opened::default();
        };
        let Opened { boxes, children } = instance.placed.open(own);
        Opened {
            boxes,
            children: children.map(|child| child.shifted(instance.first)),
        }
    }

    /// The children of a top-level node; `None` for a subtree of an instance.
    pub(super) fn top_children(&self, subtree: Subtree) -> Option<[Subtree; 2]> {
        let node = self.top.get(subtree.node()? as usize)?;
        Some(node.children)
    }

    /// A triangle as the mesh's tree stores it.
    #[inline(never)]
    fn stored(&self, primitive: u32) -> &Triangle {
        self.of(primitive)
            .and_then(|(instance, own)| instance.placed.tree.triangles.get(own as usize))
            .unwrap_or(&NOWHERE)
    }

    /// The corners of eight triangles as their meshes' trees store them. Most are of one instance, which is looked up
    /// once.
    #[inline(always)]
    pub(super) fn stored_corners(&self, primitives: &[u32; LANES]) -> [&[Vec3; 3]; LANES] {
        let (first, triangles) = match self.of(primitives[0]) {
            Some((instance, _)) => (instance.first, &instance.placed.tree.triangles[..]),
            None => (0, &[][..]),
        };
        primitives.map(
            |primitive| match triangles.get(primitive.wrapping_sub(first) as usize) {
                Some(triangle) => &triangle.corners,
                None => &self.stored(primitive).corners,
            },
        )
    }

    /// A triangle's corners in the scene's space.
    #[inline(never)]
    pub(crate) fn corners(&self, primitive: u32) -> [Vec3; 3] {
        let corners = self.stored(primitive).corners;
        match self.of(primitive) {
            Some((instance, _)) => match &instance.placed.placement {
                Some((placement, _)) => corners.map(|corner| placement.corner(corner)),
                None => corners,
            },
            None => corners,
        }
    }

    /// Places the stored corners of eight triangles, instance by instance, with the results of
    /// [`Instances::corners`].
    #[inline(always)]
    pub(super) fn place(&self, primitives: &[u32; LANES], corners: &mut CornerLanes) {
        let stored = *corners;
        let mut left = [true; LANES];
        while let Some(lane) = left.iter().position(|&left| left) {
            left[lane] = false;
            let Some((instance, _)) = self.of(primitives[lane]) else {
                continue;
            };
            let PlacedTree {
                tree, placement, ..
            } = &instance.placed;
            let count = tree.triangles.len() as u32;
            let is_same = primitives.map(|p| p.wrapping_sub(instance.first) < count);
            for (left, is_same) in left.iter_mut().zip(is_same) {
                *left &= !is_same;
            }
            let Some((placement, _)) = placement else {
                continue;
            };
            let placed = placement.corners(&stored);
            for (corners, placed) in corners.iter_mut().zip(&placed) {
                for lane in 0..LANES {
                    corners[lane] = if is_same[lane] {
                        placed[lane]
                    } else {
                        corners[lane]
                    };
                }
            }
        }
    }

    /// A triangle's primitive id.
    #[inline(never)]
    pub(crate) fn id(&self, primitive: u32) -> u32 {
        let first = self.of(primitive).map_or(0, |(i, _)| i.first_number);
        first.wrapping_add(self.stored(primitive).number)
    }

    /// The object and the triangle number of a primitive index.
    #[inline(never)]
    pub(super) fn identify(&self, primitive: u32) -> (u32, u32) {
        let object = self.of(primitive).map_or(u32::MAX, |(i, _)| i.object);
        (object, self.stored(primitive).number)
    }

    /// The primitive indices of all triangles.
    pub(super) fn primitives(&self) -> impl Iterator<Item = u32> {
        self.all.iter().flat_map(|instance| {
            instance.first..instance.first + instance.placed.tree.triangles.len() as u32
        })
    }

    pub(super) fn triangle_count(&self) -> usize {
        let triangles = |instance: &Instance| instance.placed.tree.triangles.len();
        self.all.iter().map(triangles).sum()
    }

    /// The instances' trees; a tree that several instances share is repeated.
    pub(super) fn all_trees(&self) -> impl Iterator<Item = &Arc<MeshTree>> {
        self.all.iter().map(|instance| &instance.placed.tree)
    }

    /// Bytes retained beside the trees.
    pub(super) fn retained_bytes(&self) -> usize {
        self.top.capacity() * size_of::<Opened>()
            + self.all.capacity() * size_of::<Instance>()
            + self.pages.capacity() * size_of::<u32>()
    }
}
