//! Colours that a file gives its faces: a material each.

use crate::scene::{Color, Material, MeshData};
use std::collections::HashMap;

/// Gives a mesh's triangles, in their order, these colours; a material is named after its colour, and
/// materials are in the order in which they come.
pub(super) fn set(mesh: &mut MeshData, colors: impl IntoIterator<Item = Option<Color>>) {
    let mut numbers: HashMap<Color, u32> = HashMap::new();
    let materials = &mut mesh.materials;
    let mut number = |color: Color| {
        *numbers.entry(color).or_insert_with(|| {
            let name = color.to_string();
            materials.push(Material::new(name, color));
            materials.len() as u32 - 1
        })
    };
    // Neighbours often have one colour.
    let mut last: Option<(Color, u32)> = None;
    mesh.material_of_triangle = colors
        .into_iter()
        .map(|color| match (color, last) {
            (None, _) => u32::MAX,
            (Some(color), Some((known, number))) if color == known => number,
            (Some(color), _) => {
                let number = number(color);
                last = Some((color, number));
                number
            }
        })
        .collect();
}

/// A channel from 0 to 1 as eight bits; what is out of range is clamped, and what is no number is 0.
pub(super) fn byte(share: f64) -> u8 {
    // A cast to an integer saturates.
    (share * 255.0).round() as u8
}
