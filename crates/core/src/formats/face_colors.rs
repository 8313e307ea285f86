//! Face colours, as a material for each colour.

use crate::scene::{Color, Material, MeshData};
use std::collections::HashMap;

/// Gives a mesh's triangles these colours, in order. A material is named after its colour, and materials are in order
/// of first use.
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
    // Neighbouring faces often have the same colour.
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

/// A channel from 0 to 1 as eight bits; clamped, and 0 for NaN.
pub(super) fn byte(share: f64) -> u8 {
    // A cast from float to integer saturates.
    (share * 255.0).round() as u8
}
