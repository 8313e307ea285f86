//! What must hold of any bytes at all, a target a file.
//!
//! A target takes bytes and says what is wrong, if anything. `fuzz/` feeds the targets with bytes that
//! a fuzzer makes up, and `tests/tests/seeds.rs` with all that is kept in `fuzz/seeds`: what a fuzzer
//! found stays found.
//!
//! Readers must do more than not panic. What they refuse they refuse in one line; what they accept is
//! sound, shows a sound picture, and reads again as the same once it is written (by the program where
//! it can write that kind of file, by the target where it cannot).

pub mod fragment_exr;
pub mod fragment_png;
pub mod gltf;
pub mod mesh;
pub mod mtl;
pub mod obj;
pub mod off;
pub mod picture;
pub mod picture_tiff;
pub mod placed;
pub mod ply;
pub mod prepared;
pub mod rays;
pub mod reading;
pub mod scene;
pub mod stl;
pub mod texture;
pub mod threemf;
pub mod triangle_text;

/// What must hold of bytes; in one line what does not.
pub type Target = fn(&[u8]) -> Result<(), String>;

/// All targets, by the names of their folders in `fuzz/seeds`.
pub const TARGETS: [(&str, Target); 16] = [
    ("fragment_exr", fragment_exr::check),
    ("fragment_png", fragment_png::check),
    ("gltf", gltf::check),
    ("kernel", raycast_report::fuzz_kernel::check),
    ("mtl", mtl::check),
    ("obj", obj::check),
    ("off", off::check),
    ("picture_tiff", picture_tiff::check),
    ("ply", ply::check),
    ("prepared", prepared::check),
    ("rays", rays::check),
    ("scene", scene::check),
    ("stl", stl::check),
    ("texture", texture::check),
    ("threemf", threemf::check),
    ("triangle_text", triangle_text::check),
];
