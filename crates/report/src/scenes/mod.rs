//! Scenes made in code for measuring: of any number of triangles, and the same every time.

mod bumpy_sphere;

pub use bumpy_sphere::bumpy_sphere;
