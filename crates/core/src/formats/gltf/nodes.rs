//! A glTF file's node tree, depth first.

use super::data::Data;
use super::json::Node;
use crate::formats::error::FormatError;
use crate::formats::placed_meshes::NODE_LIMIT;
use glam::{DAffine3, DMat3, DQuat, DVec3};

/// A node with a mesh.
#[derive(Debug)]
pub(super) struct MeshNode<'d> {
    pub(super) node: &'d Node,
    /// The mesh's index in the file.
    pub(super) mesh: u32,
    pub(super) world_from_node: DAffine3,
}

/// The mesh nodes of the file's default scene, depth first; of all nodes where it has no scene.
///
/// # Errors
/// A node with two parents, or that is its own descendant; an index out of range; a transform that is not an affine
/// map of finite numbers.
pub(super) fn mesh_nodes<'d>(data: &Data<'d>) -> Result<Vec<MeshNode<'d>>, FormatError> {
    let nodes = &data.root.nodes;
    let mut has_parent = vec![false; nodes.len()];
    for (parent, node) in nodes.iter().enumerate() {
        for &child in &node.children {
            let location = format!("nodes[{parent}].children");
            data.one(nodes, child, &location, "nodes")?;
            if std::mem::replace(&mut has_parent[child as usize], true) {
                let found = format!("node {child}, which has another");
                return Err(data.fault(&location, "nodes that have no other parent", &found));
            }
        }
    }
    let roots = match (data.root.scene, data.root.scenes.first()) {
        (Some(number), Some(_)) => data
            .one(&data.root.scenes, number, "scene", "scenes")?
            .nodes
            .clone(),
        (None, Some(first)) => first.nodes.clone(),
        (_, None) => (0..nodes.len() as u32)
            .filter(|&node| !has_parent[node as usize])
            .collect(),
    };
    let mut is_met = vec![false; nodes.len()];
    let mut found = Vec::new();
    let mut next: Vec<(u32, DAffine3)> = roots
        .iter()
        .rev()
        .map(|&root| (root, DAffine3::IDENTITY))
        .collect();
    while let Some((index, world_from_parent)) = next.pop() {
        let location = format!("nodes[{index}]");
        let node = data.one(nodes, index, "scenes", "nodes")?;
        if std::mem::replace(&mut is_met[index as usize], true) {
            let found = "one that is reached twice";
            return Err(data.fault(&location, "a node of a tree", found));
        }
        let parent_from_node = parent_from_node(data, node, &location)?;
        let world_from_node = if parent_from_node == DAffine3::IDENTITY {
            world_from_parent
        } else if world_from_parent == DAffine3::IDENTITY {
            parent_from_node
        } else {
            world_from_parent * parent_from_node
        };
        if !world_from_node.is_finite() {
            return Err(data.fault(
                &location,
                "a placement of finite numbers",
                "one beyond them",
            ));
        }
        if let Some(mesh) = node.mesh {
            data.one(&data.root.meshes, mesh, &location, "meshes")?;
            if found.len() == NODE_LIMIT {
                let expected = format!("at most {NODE_LIMIT} nodes with meshes");
                return Err(data.fault("nodes", &expected, "more"));
            }
            found.push(MeshNode {
                node,
                mesh,
                world_from_node,
            });
        }
        next.extend(
            node.children
                .iter()
                .rev()
                .map(|&child| (child, world_from_node)),
        );
    }
    Ok(found)
}

fn parent_from_node(data: &Data<'_>, node: &Node, location: &str) -> Result<DAffine3, FormatError> {
    if let Some(columns) = node.matrix {
        let [x, y, z, t] = [0, 4, 8, 12].map(|at| DVec3::from_slice(&columns[at..]));
        let last = [3, 7, 11, 15].map(|at| columns[at]);
        if last != [0.0, 0.0, 0.0, 1.0] {
            let found = format!("{last:?}");
            return Err(data.fault(location, "0, 0, 0, 1 as a matrix's last row", &found));
        }
        return Ok(DAffine3 {
            matrix3: DMat3::from_cols(x, y, z),
            translation: t,
        });
    }
    let rotation = match node.rotation {
        None => DQuat::IDENTITY,
        Some(numbers) => {
            let rotation = DQuat::from_array(numbers);
            let length = rotation.length();
            if !(length > 0.0 && length.is_finite()) {
                let found = format!("{numbers:?}");
                return Err(data.fault(location, "a rotation as a quaternion", &found));
            }
            rotation / length
        }
    };
    let vector = |numbers: Option<[f64; 3]>, default| numbers.map_or(default, DVec3::from_array);
    Ok(DAffine3::from_scale_rotation_translation(
        vector(node.scale, DVec3::ONE),
        rotation,
        vector(node.translation, DVec3::ZERO),
    ))
}
