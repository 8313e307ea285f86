//! A torus.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use crate::obj::{Corner, Face, Material, Model};

const SEGMENTS: usize = 64;
const SIDES: usize = 32;
const MAJOR_RADIUS: f64 = 1.0;
const MINOR_RADIUS: f64 = 0.4;

/// How often a texture goes round the ring while it goes once round the tube: near the ratio of
/// the two girths, so that a square texture stays square.
const TEXTURE_REPEATS: f64 = 3.0;

/// The torus around the Y axis: 64 × 32 quads.
pub(crate) fn torus() -> Model {
    let mut model = Model {
        name: "torus",
        about: "A torus; a texture repeats three times around it",
        materials: vec![Material::new("torus", 0xd9a45b)],
        ..Model::default()
    };
    for segment in 0..SEGMENTS {
        let (sin_u, cos_u) = libm::sincos(TAU * segment as f64 / SEGMENTS as f64);
        for side in 0..SIDES {
            let (sin_v, cos_v) = libm::sincos(TAU * side as f64 / SIDES as f64);
            // Sideways round the ring as u grows seen from above, upwards on the outside as v does.
            let normal = DVec3::new(sin_u * cos_v, sin_v, cos_u * cos_v);
            model.normals.push(normal);
            model
                .positions
                .push(DVec3::new(sin_u, 0.0, cos_u) * MAJOR_RADIUS + normal * MINOR_RADIUS);
        }
    }
    // The texture's last column and row lie on the first ones, with coordinates of their own.
    for segment in 0..=SEGMENTS {
        for side in 0..=SIDES {
            let u = TEXTURE_REPEATS * segment as f64 / SEGMENTS as f64;
            model.uvs.push(DVec2::new(u, side as f64 / SIDES as f64));
        }
    }
    for segment in 0..SEGMENTS {
        for side in 0..SIDES {
            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
                .map(|(right, up)| {
                    let (segment, side) = (segment + right, side + up);
                    let vertex = segment % SEGMENTS * SIDES + side % SIDES;
                    Corner {
                        position: vertex,
                        uv: segment * (SIDES + 1) + side,
                        normal: vertex,
                    }
                })
                .to_vec();
            model.faces.push(Face {
                material: 0,
                corners,
            });
        }
    }
    model
}
