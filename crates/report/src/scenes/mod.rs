//! Scenes made in code for measuring: of any number of triangles, and the same every time.

mod bumpy_sphere;
mod interior;
mod made;

pub use bumpy_sphere::bumpy_sphere;
pub use interior::{interior, interior_camera};
pub use made::Made;
