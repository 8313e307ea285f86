//! From hits to colours.

mod mode;
mod shader;

pub use mode::{Background, Filter, Mode, Shading, TextureProjection, Wireframe};
pub use shader::Shader;
pub(crate) use shader::encode;
