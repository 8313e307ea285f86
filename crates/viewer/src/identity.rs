//! A number that names a view, for fragments: the same picture, the same number, in any process.

use raycast_core::render::View;
use raycast_core::scene::{Mesh, Object};

/// A number that follows from everything that decides a picture's colours; not from how it is
/// split, on how many threads, or with how many layers it is made.
pub fn of_view(view: &View) -> u64 {
    let mut hash = Fnv::new();
    let settings = &view.settings;
    hash.text(&format!("{:?}", view.camera));
    hash.text(&format!(
        "{:?} {:?} {:?} {}",
        settings.shading, settings.cull, settings.precision, settings.samples
    ));
    for object in &view.scene.objects {
        add_object(&mut hash, object);
    }
    hash.0
}

fn add_object(hash: &mut Fnv, object: &Object) {
    hash.text(&format!(
        "{:?} {:?} {:?}",
        object.transform, object.parent, object.color
    ));
    add_mesh(hash, &object.mesh);
    if let Some(texture) = &object.texture {
        hash.word(texture.width());
        hash.word(texture.height());
        for texel in texture.texels() {
            hash.word(u32::from_le_bytes(*texel));
        }
    }
}

fn add_mesh(hash: &mut Fnv, mesh: &Mesh) {
    hash.text(&format!("{:?} {:?}", mesh.offset(), mesh.materials()));
    for position in mesh.positions() {
        for coordinate in position.to_array() {
            hash.word(coordinate.to_bits());
        }
    }
    for color in mesh.vertex_colors() {
        let [r, g, b] = color.map_or([0; 3], |color| color.0);
        hash.word(u32::from_le_bytes([r, g, b, color.is_some().into()]));
    }
    for index in mesh.triangles().iter().flatten() {
        hash.word(*index);
    }
}

/// The hash of Fowler, Noll and Vo (FNV-1a, 64 bits), over words instead of bytes: stable, which
/// the standard library's is not, and nobody gains by a collision.
struct Fnv(u64);

impl Fnv {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn word(&mut self, word: u32) {
        self.0 = (self.0 ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3);
    }

    fn text(&mut self, text: &str) {
        for byte in text.bytes() {
            self.word(byte.into());
        }
    }
}
