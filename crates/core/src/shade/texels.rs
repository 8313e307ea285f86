//! Texels in linear light: looked up by their bytes, or kept.

use super::srgb::Tables;
use super::vectors::{Rows, Vectors};
use crate::num::simd::{LANES, Lanes};
use crate::scene::{Scene, Texture};
use rayon::prelude::*;
use std::sync::Arc;

/// The most texels of a scene's textures that are kept in linear light, 16 MB. What does not stay in a processor's caches is
/// slower than looking up bytes: on one whose third level has 32 MB, textured pictures took a fifth less time with one
/// texture of 512² texels, a seventh less with 1024², and an eighth more with 2048².
const MOST_TEXELS: usize = 1 << 20;

/// The most textures of such a scene: for each picture, those of all objects are compared with them.
const MOST_TEXTURES: usize = 64;

/// A texel; the one after the last is the first.
pub(super) fn texel(tables: &Tables, texture: &Texture, x: u32, y: u32) -> [f32; 4] {
    let x = if x < texture.width() { x } else { 0 };
    let y = if y < texture.height() { y } else { 0 };
    let index = y as usize * texture.width() as usize + x as usize;
    let [r, g, b, a] = texture.texels()[index];
    let color = [r, g, b].map(|byte| tables.decode(byte));
    if a == u8::MAX {
        return [color[0], color[1], color[2], 1.0];
    }
    let alpha = f32::from(a) / 255.0;
    [color[0] * alpha, color[1] * alpha, color[2] * alpha, alpha]
}

/// Whether texels of eight samples are found at once. Numbers of texels fit 32 bits, and so do columns and rows.
#[inline(always)]
pub(super) fn is_read_at_once(texture: &Texture) -> bool {
    texture.repeats() && i32::try_from(texture.texels().len()).is_ok()
}

/// Eight texels in linear light, alpha multiplied in, and their alphas.
#[inline(always)]
pub(super) fn read_eight<L: Lanes>(
    lanes: L,
    tables: &Tables,
    texture: &Texture,
    at: &[u32; LANES],
) -> (Vectors<L>, L::F32) {
    let texels = texture.texels();
    let mut color = Rows::ZERO;
    let mut alphas = [0; LANES];
    let mut least = u8::MAX;
    for (lane, &at) in at.iter().enumerate() {
        let [r, g, b, a] = texels[at as usize];
        color.0[0][lane] = tables.decode(r);
        color.0[1][lane] = tables.decode(g);
        color.0[2][lane] = tables.decode(b);
        alphas[lane] = a;
        least &= a;
    }
    let color = Vectors::load(lanes, &color);
    if least == u8::MAX {
        return (color, lanes.splat(1.0));
    }
    let mut all = [0.0; LANES];
    for lane in 0..LANES {
        all[lane] = f32::from(alphas[lane]);
    }
    let alpha = lanes.load(&all) / 255.0;
    (color.scaled(alpha), alpha)
}

/// A texture's texels in linear light with premultiplied alpha. Each row ends with its first texel again, so that a texel
/// and the one to its right are neighbours in memory.
#[derive(Clone, Copy)]
pub(super) struct TexelLight<'t> {
    texels: &'t [[f32; 4]],
    /// Texels from one row to the next.
    stride: u32,
}

impl<'t> TexelLight<'t> {
    /// Those of a texture, if they were kept.
    #[inline(always)]
    pub(super) fn of(texture: &'t Texture) -> Option<Self> {
        Some(Self {
            texels: texture.light()?,
            stride: texture.width() + 1,
        })
    }

    /// Texels from one row to the next.
    #[inline(always)]
    pub(super) fn stride(&self) -> u32 {
        self.stride
    }

    /// The texels at eight indices, and those to their right: colours and alphas.
    #[inline(always)]
    pub(super) fn eight_pairs<L: Lanes>(
        &self,
        lanes: L,
        at: &[u32; LANES],
    ) -> [(Vectors<L>, L::F32); 2] {
        let mut pairs = [lanes.splat(0.0); LANES];
        for (pair, &at) in pairs.iter_mut().zip(at) {
            let two = self.texels[at as usize..].first_chunk::<2>();
            let eight = two.and_then(|two| two.as_flattened().first_chunk());
            *pair = lanes.load(eight.unwrap_or(&[0.0; LANES]));
        }
        let [r, g, b, a, right_r, right_g, right_b, right_a] = lanes.transpose(pairs);
        [
            (Vectors::new(lanes, [r, g, b]), a),
            (Vectors::new(lanes, [right_r, right_g, right_b]), right_a),
        ]
    }
}

/// Keeps the texels of a scene's textures in linear light, if they are few enough, from the second picture on that shows
/// them.
pub(super) fn keep(tables: &Tables, scene: &Scene) {
    let mut textures: Vec<&Arc<Texture>> = Vec::new();
    let mut texels = 0;
    for texture in scene.textures() {
        if textures.iter().any(|known| Arc::ptr_eq(known, texture)) {
            continue;
        }
        textures.push(texture);
        texels += texture.texels().len();
        if texels > MOST_TEXELS || textures.len() > MOST_TEXTURES {
            return;
        }
    }
    for texture in textures {
        if is_read_at_once(texture) {
            texture.keep_light(|texture| decoded(tables, texture));
        }
    }
}

/// All texels of a texture, with each row's first again at its end.
pub(super) fn decoded(tables: &Tables, texture: &Texture) -> Vec<[f32; 4]> {
    let (columns, rows) = (texture.width(), texture.height());
    let stride = columns as usize + 1;
    let mut texels = vec![[0.0; 4]; stride * rows as usize];
    let all = texels.par_chunks_mut(stride).zip(0..rows);
    all.for_each(|(row, y)| {
        for (x, light) in (0..).zip(row) {
            *light = texel(tables, texture, x, y);
        }
    });
    texels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Mesh, MeshData, Object, Wrap};
    use crate::shade::srgb::tables;

    fn scene(textures: &[&Arc<Texture>]) -> Scene {
        let mesh = Arc::new(Mesh::new(MeshData::default()));
        let object = |texture: &&Arc<Texture>| {
            let mut object = Object::new("a", Arc::clone(&mesh));
            object.texture = Some(Arc::clone(texture));
            object
        };
        Scene {
            objects: textures.iter().map(object).collect(),
        }
    }

    fn texture(width: u32, height: u32) -> Arc<Texture> {
        let texels = (0..width * height).map(|at| [at as u8, 9, 200, 255]);
        Arc::new(Texture::new(width, height, texels.collect()).expect("a good texture"))
    }

    #[test]
    fn few_texels_are_kept_from_the_second_picture_on() {
        let few = texture(5, 3);
        let scene_of_few = scene(&[&few, &few]);
        keep(tables(), &scene_of_few);
        assert!(few.light().is_none());
        let bytes = few.retained_bytes();
        keep(tables(), &scene_of_few);
        assert_eq!(few.light().map(<[_]>::len), Some(6 * 3));
        assert_eq!(few.retained_bytes(), bytes + 6 * 3 * 16);
        assert_eq!(*few, *texture(5, 3));

        let many = texture(MOST_TEXELS as u32 / 2, 1);
        let scene_of_many = scene(&[&many, &texture(1, 1), &many.clone()]);
        let too_many = scene(&[&many, &texture(MOST_TEXELS as u32 / 2, 1), &texture(1, 1)]);
        for (scene, is_kept) in [(too_many, false), (scene_of_many, true)] {
            (0..3).for_each(|_| keep(tables(), &scene));
            assert_eq!(many.light().is_some(), is_kept);
        }
    }

    #[test]
    fn textures_that_are_read_one_by_one_are_not_kept() {
        let clamped = Arc::new((*texture(4, 4)).clone().wrapped([Wrap::Clamp; 2]));
        let all: Vec<_> = (0..=MOST_TEXTURES).map(|_| texture(1, 1)).collect();
        for textures in [vec![&clamped], all.iter().collect()] {
            let scene = scene(&textures);
            (0..3).for_each(|_| keep(tables(), &scene));
            assert!(textures.iter().all(|texture| texture.light().is_none()));
        }
    }
}
