//! A cube, each face in a colour of its own.

use glam::{DVec2, DVec3};

use crate::obj::{Corner, Face, Material, Model};

/// The faces: material, outward normal, and the direction in which the texture's `u` grows.
const SIDES: [(Material, DVec3, DVec3); 6] = [
    (
        Material::new("right_coral", 0xe85d4a),
        DVec3::X,
        DVec3::NEG_Z,
    ),
    (Material::new("left_teal", 0x1f9e94), DVec3::NEG_X, DVec3::Z),
    (Material::new("top_cream", 0xf6e3b4), DVec3::Y, DVec3::X),
    (
        Material::new("bottom_plum", 0x7b4a8e),
        DVec3::NEG_Y,
        DVec3::X,
    ),
    (Material::new("front_amber", 0xf4b03e), DVec3::Z, DVec3::X),
    (
        Material::new("back_blue", 0x3a6eb5),
        DVec3::NEG_Z,
        DVec3::NEG_X,
    ),
];

/// The cube from −1 to 1: six quads, the whole texture on each.
pub(crate) fn cube() -> Model {
    let corner_of =
        |p: DVec3| usize::from(p.x > 0.0) + 2 * usize::from(p.y > 0.0) + 4 * usize::from(p.z > 0.0);
    let sign = |index: usize, bit: usize| if index >> bit & 1 == 1 { 1.0 } else { -1.0 };
    let ring = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    Model {
        name: "cube",
        about: "A cube with six face colours",
        materials: SIDES.map(|(material, ..)| material).to_vec(),
        positions: (0..8)
            .map(|i| DVec3::new(sign(i, 0), sign(i, 1), sign(i, 2)))
            .collect(),
        uvs: ring.map(|(u, v)| DVec2::new(u, v) * 0.5 + 0.5).to_vec(),
        normals: SIDES.map(|(_, normal, _)| normal).to_vec(),
        faces: SIDES
            .iter()
            .enumerate()
            .map(|(side, &(_, normal, right))| {
                let up = normal.cross(right);
                let corners = ring
                    .iter()
                    .enumerate()
                    .map(|(uv, &(u, v))| Corner {
                        position: corner_of(normal + right * u + up * v),
                        uv,
                        normal: side,
                    })
                    .collect();
                Face {
                    material: side,
                    corners,
                }
            })
            .collect(),
    }
}
