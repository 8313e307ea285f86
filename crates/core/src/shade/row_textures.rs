//! Textures on rows of samples.

use super::facet::{Facet, Interpolation, Mapping};
use super::interpolants::{eight_along, eight_weights_of};
use super::numbers::Numbers;
use super::sample::{TexelsAround, bilinear, nearest_of_eight, sample_eight};
use super::spans::{COLUMNS, Span};
use super::srgb::Tables;
use super::texels::{TexelLight, is_read_at_once};
use super::texture::triplanar::Triplanar;
use super::vectors::{Row, Vectors};
use super::{Filter, Shader};
use crate::num::simd::{F32x8, LANES, Lanes, Mask8, Work};
use crate::scene::Texture;
use glam::{DVec2, Vec2, Vec3};

/// What samples share whose textures are read at once.
#[derive(Clone, Copy)]
pub(super) struct Textured<'s> {
    pub(super) texture: &'s Texture,
    /// The mapping from three sides; `None` where it is by texture coordinates.
    pub(super) triplanar: Option<&'s Triplanar>,
    /// Whether texels are multiplied by the triangles' own colours.
    pub(super) is_tinted: bool,
}

impl<'s> Textured<'s> {
    /// What a triangle is textured with; `None` where it shows no texture.
    #[inline(always)]
    pub(super) fn of(shader: &'s Shader<'_>, facet: &Facet) -> Option<Self> {
        let mapping = facet.texture.as_ref()?;
        Some(Self {
            texture: shader.texture_on(facet)?,
            triplanar: shader.triplanar_of(facet, mapping),
            is_tinted: facet.is_tinted,
        })
    }

    /// Whether two triangles are textured with the same.
    #[inline(always)]
    pub(super) fn are_same(one: Option<Self>, other: Option<Self>) -> bool {
        match (one, other) {
            (None, None) => true,
            (Some(one), Some(other)) => {
                let is_same_mapping = match (one.triplanar, other.triplanar) {
                    (None, None) => true,
                    (Some(one), Some(other)) => std::ptr::eq(one, other),
                    _ => false,
                };
                is_same_mapping
                    && std::ptr::eq(one.texture, other.texture)
                    && one.is_tinted == other.is_tinted
            }
            _ => false,
        }
    }
}

/// Where the samples of a row read their textures: at one place each, or at one a side.
pub(super) struct RowTextures {
    uv: [[Numbers<f64>; 2]; 3],
    weights: [Numbers<f32>; 3],
    /// Indices of the texels that each sample is mixed of: of all four, or of the left ones.
    at: [Numbers<u32>; 4],
    texels: [RowTexels; 4],
    /// How far samples lie from texels on their left to those on their right, and from those above to those below.
    fractions: [Numbers<f32>; 2],
}

/// A texel for each sample of a row.
#[derive(Clone, Copy)]
struct RowTexels {
    /// Linear light, and alpha, which is not multiplied in.
    color: [Numbers<f32>; 3],
    alpha: Numbers<u8>,
}

impl RowTexels {
    const NONE: Self = Self {
        color: [Numbers([0.0; COLUMNS + LANES]); 3],
        alpha: Numbers([0; COLUMNS + LANES]),
    };

    /// Reads the texels of samples, and of up to seven after them. A loop of its own: numbers that are stored one by one
    /// are loaded as eight much later.
    #[inline(always)]
    fn read(
        &mut self,
        tables: &Tables,
        texture: &Texture,
        indices: &Numbers<u32>,
        (first, end): (usize, usize),
    ) {
        let texels = texture.texels();
        let [r, g, b] = &mut self.color;
        for at in (first..end).step_by(LANES) {
            let indices = indices.eight(at);
            let (r, g, b) = (r.eight_mut(at), g.eight_mut(at), b.eight_mut(at));
            let alpha = self.alpha.eight_mut(at);
            for lane in 0..LANES {
                let [red, green, blue, opacity] = texels[indices[lane] as usize];
                r[lane] = tables.decode(red);
                g[lane] = tables.decode(green);
                b[lane] = tables.decode(blue);
                alpha[lane] = opacity;
            }
        }
    }

    /// Eight texels, alpha multiplied in, and their alphas.
    #[inline(always)]
    fn eight<L: Lanes>(&self, lanes: L, at: usize) -> (Vectors<L>, L::F32) {
        let color = load_three(lanes, &self.color, at);
        let alpha = self.alpha.eight(at);
        if *alpha == [u8::MAX; LANES] {
            return (color, lanes.splat(1.0));
        }
        let mut all = [0.0; LANES];
        for lane in 0..LANES {
            all[lane] = f32::from(alpha[lane]);
        }
        let alpha = lanes.load(&all) / 255.0;
        (color.scaled(alpha), alpha)
    }
}

/// A texture, and how its texels are read.
#[derive(Clone, Copy)]
struct Image<'s> {
    tables: &'s Tables,
    texture: &'s Texture,
    light: Option<TexelLight<'s>>,
    filter: Filter,
}

impl<'s> Image<'s> {
    #[inline(always)]
    fn new(shader: &'s Shader<'_>, texture: &'s Texture) -> Self {
        let filter = shader.filter();
        Self {
            tables: shader.tables,
            texture,
            light: TexelLight::of(texture).filter(|_| filter == Filter::Bilinear),
            filter,
        }
    }
}

impl RowTextures {
    pub(super) fn new() -> Self {
        Self {
            uv: [[Numbers::all(0.0); 2]; 3],
            weights: [Numbers::all(0.0); 3],
            at: [Numbers::all(0); 4],
            texels: [RowTexels::NONE; 4],
            fractions: [Numbers::all(0.0); 2],
        }
    }

    /// Writes where the samples of a span read their texture, if they have one. False where the triangle has no linear
    /// functions, or its texture is not read at once.
    #[inline(always)]
    pub(super) fn interpolate<L: Lanes>(
        &mut self,
        lanes: L,
        textured: Option<Textured<'_>>,
        facet: &Facet,
        (y, xs): (f64, &Numbers<f64>),
        span: Span,
    ) -> bool {
        let (Some(textured), Some(mapping)) = (textured, &facet.texture) else {
            return true;
        };
        let Interpolation::Linear(interpolants) = &facet.interpolation else {
            return false;
        };
        if facet.blends.is_some() {
            return false;
        }
        let along = interpolants.weights_in_row(y);
        match (mapping, textured.triplanar) {
            (Mapping::Uv(uvs), _) => {
                for at in eights((span.first, span.end)) {
                    let weights = eight_along(lanes, &along, xs.eight(at)).xyz();
                    self.set_uv(*uvs, at, eight_weights_of(lanes, weights));
                }
            }
            (Mapping::Triplanar(corners, normals), Some(triplanar)) => {
                let between = [splat(lanes, corners), splat(lanes, normals)];
                for at in eights((span.first, span.end)) {
                    let weights = eight_along(lanes, &along, xs.eight(at)).xyz();
                    let weights = eight_weights_of(lanes, weights);
                    self.set_sides(lanes, triplanar, between, at, weights);
                }
            }
            _ => return false,
        }
        true
    }

    /// Between texture coordinates at the corners, as [`Texturing::sampled`](super::texture::texturing::Texturing::sampled) has it.
    #[inline(always)]
    fn set_uv<F: F32x8>(&mut self, uvs: [Vec2; 3], at: usize, weights: [F; 2]) {
        let (mut u, mut v): (Row, Row) = ([0.0; LANES], [0.0; LANES]);
        weights[0].store(&mut u);
        weights[1].store(&mut v);
        let [a, b, c] = uvs.map(|uv| uv.as_dvec2());
        let (to_b, to_c): (DVec2, DVec2) = (b - a, c - a);
        let [[x, y], ..] = &mut self.uv;
        let (x, y) = (x.eight_mut(at), y.eight_mut(at));
        for lane in 0..LANES {
            let (u, v) = (f64::from(u[lane]), f64::from(v[lane]));
            x[lane] = a.x + to_b.x * u + to_c.x * v;
            y[lane] = a.y + to_b.y * u + to_c.y * v;
        }
    }

    /// [`Triplanar::sides`] between corners and normals.
    #[inline(always)]
    fn set_sides<L: Lanes>(
        &mut self,
        lanes: L,
        triplanar: &Triplanar,
        [corners, normals]: [[[L::F32; 3]; 3]; 2],
        at: usize,
        weights: [L::F32; 2],
    ) {
        let (weights, sides) = triplanar.eight_sides(lanes, corners, normals, weights);
        for (numbers, weights) in self.weights.iter_mut().zip(weights.xyz()) {
            weights.store(numbers.eight_mut(at));
        }
        for (numbers, side) in self
            .uv
            .as_flattened_mut()
            .iter_mut()
            .zip(sides.as_flattened())
        {
            *numbers.eight_mut(at) = *side;
        }
    }

    /// The next run of eights in which some sample shows a side; the range keeps what comes after it. A box's walls show
    /// one side each.
    #[inline(always)]
    fn next_lit(
        &self,
        lanes: impl Lanes,
        side: usize,
        (first, end): &mut (usize, usize),
    ) -> Option<(usize, usize)> {
        let is_lit = |at: usize| {
            let weights = lanes.load(self.weights[side].eight(at));
            lanes.splat(0.0).lt(weights).bits() != 0
        };
        let start = eights((*first, *end)).find(|&at| is_lit(at))?;
        let after = eights((start, *end)).find(|&at| !is_lit(at));
        *first = after.unwrap_or(*end);
        Some((start, *first))
    }

    /// Reads the texels of a side that samples are mixed of.
    #[inline(always)]
    fn read(&mut self, image: Image<'_>, side: usize, samples: (usize, usize)) {
        let Image {
            tables,
            texture,
            light,
            filter,
        } = image;
        if !is_read_at_once(texture) {
            return;
        }
        let [xs, ys] = &self.uv[side];
        let is_nearest = filter == Filter::Nearest;
        for at in eights(samples) {
            let uv = [*xs.eight(at), *ys.eight(at)];
            if is_nearest {
                *self.at[0].eight_mut(at) = nearest_of_eight(texture, &uv);
                continue;
            }
            let around = TexelsAround::of_eight(texture, &uv);
            match light {
                Some(light) => set(&mut self.at, at, around.lefts(light.stride())),
                None => set(&mut self.at, at, around.all(texture.width())),
            }
            let [across, down] = &mut self.fractions;
            *across.eight_mut(at) = around.across;
            *down.eight_mut(at) = around.down;
        }
        if light.is_some() {
            return;
        }
        let count = if is_nearest { 1 } else { 4 };
        for (texels, indices) in self.texels[..count].iter_mut().zip(&self.at) {
            texels.read(tables, texture, indices, samples);
        }
    }

    /// What eight samples see of a side's texture, and its alphas.
    #[inline(always)]
    fn texel<L: Lanes>(
        &self,
        lanes: L,
        image: Image<'_>,
        (side, at): (usize, usize),
    ) -> (Vectors<L>, L::F32) {
        let Image {
            tables,
            texture,
            light,
            filter,
        } = image;
        if !is_read_at_once(texture) {
            let [xs, ys] = &self.uv[side];
            let uv = [*xs.eight(at), *ys.eight(at)];
            return sample_eight(lanes, tables, texture, &uv, filter);
        }
        if filter == Filter::Nearest {
            return self.texels[0].eight(lanes, at);
        }
        let texels = match light {
            Some(light) => {
                let [above, below, ..] = &self.at;
                let [a, b] = light.eight_pairs(lanes, above.eight(at));
                let [c, d] = light.eight_pairs(lanes, below.eight(at));
                [a, b, c, d]
            }
            None => {
                let [a, b, c, d] = &self.texels;
                [
                    a.eight(lanes, at),
                    b.eight(lanes, at),
                    c.eight(lanes, at),
                    d.eight(lanes, at),
                ]
            }
        };
        let [across, down] = &self.fractions;
        bilinear(lanes, texels, [across.eight(at), down.eight(at)])
    }
}

/// Mixes samples' own colours with their texture, in linear light, and those of up to seven after them with anything.
pub(super) struct ColorTextured<'r> {
    pub(super) textures: &'r mut RowTextures,
    pub(super) textured: Textured<'r>,
    pub(super) shader: &'r Shader<'r>,
    pub(super) own: &'r mut [Numbers<f32>],
    pub(super) samples: (usize, usize),
}

impl Work for ColorTextured<'_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self {
            textures,
            textured,
            shader,
            own,
            samples,
        } = self;
        let image = Image::new(shader, textured.texture);
        if textured.triplanar.is_none() {
            textures.read(image, 0, samples);
            for at in eights(samples) {
                let texel = textures.texel(lanes, image, (0, at));
                mix(lanes, textured, shader.blend(), texel, own, at);
            }
            return;
        }
        let mut sums = [Numbers::all(0.0); 4];
        for side in 0..3 {
            let mut rest = samples;
            while let Some(lit) = textures.next_lit(lanes, side, &mut rest) {
                textures.read(image, side, lit);
                for at in eights(lit) {
                    let (color, alpha) = textures.texel(lanes, image, (side, at));
                    let weight = lanes.load(textures.weights[side].eight(at));
                    let [x, y, z] = color.scaled(weight).xyz();
                    for (sum, part) in sums.iter_mut().zip([x, y, z, alpha * weight]) {
                        let sum = sum.eight_mut(at);
                        (lanes.load(sum) + part).store(sum);
                    }
                }
            }
        }
        let [x, y, z, alphas] = &sums;
        for at in eights(samples) {
            let texel = [
                lanes.load(x.eight(at)),
                lanes.load(y.eight(at)),
                lanes.load(z.eight(at)),
            ];
            let texel = (Vectors::new(lanes, texel), lanes.load(alphas.eight(at)));
            mix(lanes, textured, shader.blend(), texel, own, at);
        }
    }
}

/// Writes eight samples' indices.
#[inline(always)]
fn set<const N: usize>(all: &mut [Numbers<u32>], at: usize, indices: [[u32; LANES]; N]) {
    for (all, indices) in all.iter_mut().zip(indices) {
        *all.eight_mut(at) = indices;
    }
}

/// The first of each eight of some samples.
#[inline(always)]
fn eights((first, end): (usize, usize)) -> impl Iterator<Item = usize> {
    (first..end).step_by(LANES)
}

/// Mixes eight samples' own colours with what they see of a texture.
#[inline(always)]
fn mix<L: Lanes>(
    lanes: L,
    textured: Textured<'_>,
    blend: f32,
    (texel, alpha): (Vectors<L>, L::F32),
    own: &mut [Numbers<f32>],
    at: usize,
) {
    let Some(colors) = own.first_chunk_mut::<3>() else {
        return;
    };
    let own = load_three(lanes, colors, at);
    let texel = match textured.is_tinted {
        true => texel.times(own),
        false => texel,
    };
    let blend = lanes.splat(blend);
    let rest = lanes.splat(1.0) - alpha * blend;
    let mixed = own.scaled(rest).plus(texel.scaled(blend));
    for (color, mixed) in colors.iter_mut().zip(mixed.xyz()) {
        mixed.store(color.eight_mut(at));
    }
}

/// Eight vectors.
#[inline(always)]
fn load_three<L: Lanes>(lanes: L, [x, y, z]: &[Numbers<f32>; 3], at: usize) -> Vectors<L> {
    let xyz = [
        lanes.load(x.eight(at)),
        lanes.load(y.eight(at)),
        lanes.load(z.eight(at)),
    ];
    Vectors::new(lanes, xyz)
}

/// Each coordinate of three vectors, in all lanes. A loop: compilers do not inline closures in all of
/// [`array::map`](std::array).
#[inline(always)]
fn splat<L: Lanes>(lanes: L, vectors: &[Vec3; 3]) -> [[L::F32; 3]; 3] {
    let mut all = [[lanes.splat(0.0); 3]; 3];
    for (all, vector) in all.iter_mut().zip(vectors) {
        let [x, y, z] = vector.to_array();
        *all = [lanes.splat(x), lanes.splat(y), lanes.splat(z)];
    }
    all
}
