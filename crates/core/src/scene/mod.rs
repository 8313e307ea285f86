//! What there is to see: meshes, the objects that place them, their colours and textures.

mod bounds;
mod clipping;
mod color;
mod content;
mod mapping;
mod mesh;
mod object;
mod shape;
mod texture;
mod transform;
mod up_axis;
mod wrap;

pub use bounds::Bounds;
pub use clipping::{CLIPPING_PLANES, ClippingError, ClippingPlane, ClippingPlanes};
pub use color::{Color, ColorRule};
pub use mapping::{Projector, ProjectorError, TextureMapping, TextureProjection};
pub use mesh::{Attribute, BENT, COORDINATE_LIMIT, Dropped, Material, Mesh, MeshData, Rounding};
pub(crate) use mesh::{is_storable, recentring_offset};
pub use object::{Object, Scene, SceneError};
pub use shape::{Shape, ShapeError};
pub use texture::{Crop, Texture};
pub use transform::Transform;
pub use up_axis::UpAxis;
pub use wrap::Wrap;
