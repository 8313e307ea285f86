use super::MeshData;
use glam::{DAffine3, DMat3, DVec3, Vec3};

/// The axis of a file that points up; in a scene it is y.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum UpAxis {
    /// As in a scene: no rotation.
    #[default]
    Y,
    /// As in much of CAD and scanning: (x, y, z) becomes (x, z, −y). Nothing is rounded.
    Z,
}

impl UpAxis {
    /// The rotation that makes the axis y. Nothing is rounded.
    pub(crate) fn y_up(self) -> DAffine3 {
        match self {
            Self::Y => DAffine3::IDENTITY,
            Self::Z => DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y)),
        }
    }

    /// Rotates a mesh's positions and normals so that y is up.
    pub(crate) fn turn(self, mesh: &mut MeshData) {
        if self == Self::Y {
            return;
        }
        for position in &mut mesh.positions {
            // A difference, so that zero keeps its positive sign.
            *position = DVec3::new(position.x, position.z, 0.0 - position.y);
        }
        for normal in mesh
            .normals
            .iter_mut()
            .flat_map(|normals| &mut normals.values)
        {
            *normal = Vec3::new(normal.x, normal.z, 0.0 - normal.y);
        }
    }
}

impl std::fmt::Display for UpAxis {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Y => "y",
            Self::Z => "z",
        })
    }
}
