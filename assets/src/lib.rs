//! RayCast's demo assets, made from nothing by this program: the same bytes on every machine.
//!
//! [`monkey`] and [`dahlia`] are shapes of scene files too.
//!
//! Meshes are Y up, right-handed, counter-clockwise seen from outside, with normals and texture
//! coordinates. Sines and the like come from `libm`, as those of the standard library may differ
//! in their last digits from one system to another.

mod cube;
mod cut;
mod dahlia;
mod field;
mod leopard;
mod monkey;
mod obj;
mod plinth;
mod random;
mod scene;
mod surface_nets;
mod sweep;
mod torus;

pub use dahlia::{PETALS, dahlia, dahlia_triangles};
pub use monkey::{MONKEY_TRIANGLES, monkey};
pub use obj::{Corner, Face, Material, Model};

/// What the files' comments say of where they come from.
const MADE_BY: &str = "Made by `cargo run -p raycast-assets --release`.";

/// Every file's name and content.
pub fn all() -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<_> = models().iter().flat_map(obj::Model::files).collect();
    files.push(("leopard.png".into(), leopard::leopard()));
    files.push(("demo.raycast.toml".into(), scene::demo().into_bytes()));
    files
}

fn models() -> [obj::Model; 5] {
    [
        cube::cube(),
        monkey(),
        dahlia(PETALS),
        torus::torus(),
        plinth::plinth(),
    ]
}

#[cfg(test)]
mod tests;
