//! What there is to see: meshes, the objects that place them, their colours and textures.

mod bounds;
mod color;
mod color_map;
mod content;
mod curvature;
mod mapping;
mod measures;
mod mesh;
mod object;
mod quantity;
mod scalar;
mod shape;
mod texture;
mod transform;
mod up_axis;
mod values;
mod weld;
mod wrap;

pub use bounds::Bounds;
pub use color::{Color, ColorRule};
pub use color_map::{COLOR_MAP_STEPS, ColorMap, ColorScale};
pub use mapping::{Projector, ProjectorError, TextureMapping, TextureProjection};
pub use measures::OUTLIERS;
pub use mesh::{Attribute, BENT, COORDINATE_LIMIT, Dropped, Material, Mesh, MeshData, Rounding};
pub(crate) use mesh::{is_storable, recentring_offset};
pub use object::{Object, Scene, SceneError};
pub use quantity::{Curvature, Quantity};
pub use scalar::{Scalar, ScalarAt};
pub use shape::{Shape, ShapeError};
pub use texture::{Crop, Texture};
pub use transform::Transform;
pub use up_axis::UpAxis;
pub use values::TriangleValues;
pub(crate) use weld::weld;
pub use wrap::Wrap;
