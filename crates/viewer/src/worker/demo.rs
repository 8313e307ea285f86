//! The scene that a window without files opens on.

use raycast_core::formats::SceneFile;
use raycast_core::glam::{DVec3, Vec2};
use raycast_core::scene::{Attribute, Mesh, MeshData, Object, Scene};
use std::sync::Arc;

/// The demo scene.
pub fn scene() -> SceneFile {
    SceneFile {
        scene: Scene {
            objects: vec![Object::new("cube", Arc::new(cube()))],
        },
        ..SceneFile::default()
    }
}

fn cube() -> Mesh {
    let positions = (0..8)
        .map(|corner| {
            let side = |bit: u32| if corner >> bit & 1 == 0 { -0.5 } else { 0.5 };
            DVec3::new(side(0), side(1), side(2))
        })
        .collect();
    let quads: [[u32; 4]; 6] = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles: Vec<_> = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    let uvs = Attribute {
        values: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
        indices: Some(quads.iter().flat_map(|_| [[0, 1, 2], [0, 2, 3]]).collect()),
    };
    Mesh::new(MeshData {
        positions,
        triangles,
        uvs: Some(uvs),
        ..MeshData::default()
    })
}
