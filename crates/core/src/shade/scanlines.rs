//! Rows of samples whose colours follow from the triangles and from functions that are linear over the image plane.
//!
//! A row is shaded in two steps. First each span of samples that show one triangle gets the values of the triangle's
//! functions, eight samples at a time; a span's last eight may reach into the next span, which overwrites them. Then
//! eight samples at a time are coloured by these numbers, whatever triangles they show, but for the texture, which
//! neighbouring spans may share. Each sample has the bits of [`Shader::color`](super::Shader::color).

mod looks;
mod outputs;
mod plain_rows;

use super::eight_colors::{EightSamples, RowColors, Target};
use super::eight_lines::EightLines;
use super::facet::Interpolation;
use super::hit_rows::HitRows;
use super::interpolants::{PlanarRays, eight_along, eight_weights_of};
use super::numbers::Numbers;
use super::row_textures::{ColorTextured, RowTextures, Textured};
use super::short_spans::{self, ShortSpans};
use super::spans::{COLUMNS, Span, spans};
use super::vectors::Vectors;
use super::{Shader, TileShader};
use crate::camera::Lattice;
use crate::num::simd::{F32x8, LANES, Lanes, Work, dispatch};
use crate::{MISS, PrimitiveHit};
use glam::Vec3;
use looks::{
    FlatLight, Greys, Look, NormalColors, OwnColorLook, SmoothLight, TextureCoordinates, Weights,
};
use outputs::{Bytes, Light, Out, Unencoded};
use plain_rows::WritePlainRow;
use std::ops::Range;

/// Numbers of a sample, at most: U, V, W and texture coordinates at the corners.
const NUMBERS: usize = 9;

/// Columns of samples: what all rows of a tile share.
struct Columns {
    x: Numbers<f64>,
    /// The direction to the eye, but for what depends on the row.
    to_eye: [Numbers<f32>; 3],
}

impl Columns {
    /// Those of a lattice from a column on.
    fn new(shader: &Shader<'_>, lattice: &Lattice, column: u32) -> Self {
        let mut columns = Self {
            x: Numbers::all(0.0),
            to_eye: [Numbers::all(0.0); 3],
        };
        let [corner, right, _] = shader.to_eye();
        for (at, x) in columns.x.0.iter_mut().enumerate() {
            (*x, _) = lattice.place(column + at as u32, 0);
            let to_eye = *corner + *right * *x as f32;
            for (numbers, coordinate) in columns.to_eye.iter_mut().zip(to_eye.to_array()) {
                numbers.0[at] = coordinate;
            }
        }
        columns
    }
}

/// The samples at a lattice's rays, row by row.
pub(super) struct ShadeScanlines<'t, 's, 'h, 'p> {
    pub(super) shader: &'t mut TileShader<'s>,
    pub(super) colors: RowColors,
    pub(super) planar: &'s PlanarRays,
    pub(super) lattice: Lattice,
    pub(super) hits: HitRows<'h>,
    pub(super) picture: Target<'t, 'p>,
}

impl Work for ShadeScanlines<'_, '_, '_, '_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self {
            shader: tile,
            colors,
            planar,
            lattice,
            hits,
            mut picture,
        } = self;
        let shader = tile.shader();
        let [_, _, down] = shader.to_eye();
        let width = lattice.columns as usize;
        let mut numbers = [Numbers::all(0.0); NUMBERS];
        let mut to_eye = [Numbers::all(0.0); 3];
        let mut textures = colors.have_textures().then(RowTextures::new);
        let mut coverages = shader.needs().edges.then(|| Numbers::all(0.0));
        let has_normals = matches!(colors, RowColors::Smooth | RowColors::Normals);
        // Nothing else writes these numbers where there are no textures.
        let only_color = shader.only_color().filter(|_| textures.is_none());
        if let Some(only) = only_color {
            for (numbers, color) in numbers[3..].iter_mut().zip(only.to_array()) {
                *numbers = Numbers::all(color);
            }
        }
        let mut short = (has_normals && coverages.is_none()).then_some(ShortSpans::NONE);
        let mut unencoded = Unencoded::new();
        let mut columns = Columns::new(shader, &lattice, 0);
        for row in 0..lattice.rows {
            let begin = row as usize * width;
            let (_, y) = lattice.place(0, row);
            let Some(target) = picture.row(row, width) else {
                break;
            };
            let (mut pixels, mut light) = (target.pixels, target.light);
            let mut left = 0;
            while left < width {
                if width > COLUMNS {
                    columns = Columns::new(shader, &lattice, left as u32);
                }
                let primitives = hits.row(begin + left, (width - left).min(COLUMNS));
                let ahead = hits.row(begin + left, usize::MAX);
                shader.prefetch(lanes, primitives);
                let scanline = Scanline {
                    tile,
                    colors,
                    planar,
                    columns: &columns,
                    numbers: &mut numbers,
                    to_eye: &mut to_eye,
                    textures: textures.as_mut(),
                    coverages: coverages.as_mut(),
                    short: short.as_mut(),
                    textured: None,
                    has_only_color: only_color.is_some(),
                    primitives,
                    ahead,
                    y,
                    down: *down * y as f32,
                };
                let count = primitives.len();
                if pixels.is_empty() {
                    let behind = shader.backdrop(y);
                    let (some, rest) = light.split_at_mut(count.min(light.len()));
                    light = rest;
                    let tables = shader.tables;
                    let mut out = Light {
                        tables,
                        light: some,
                        behind,
                    };
                    scanline.shade(lanes, &mut out);
                } else {
                    let behind = shader.backdrop8(lattice.y + row * lattice.stride);
                    let (some, rest) = pixels.split_at_mut(count.min(pixels.len()));
                    pixels = rest;
                    let tables = shader.tables;
                    let mut out = Bytes {
                        tables,
                        unencoded: &mut unencoded,
                        pixels: some,
                        behind,
                    };
                    scanline.shade(lanes, &mut out);
                }
                left += COLUMNS;
            }
        }
    }
}

/// Samples of a row, at most [`COLUMNS`].
struct Scanline<'r, 's, 'h> {
    tile: &'r mut TileShader<'s>,
    colors: RowColors,
    planar: &'r PlanarRays,
    columns: &'r Columns,
    /// What [`Scanline::interpolate`] has written.
    numbers: &'r mut [Numbers<f32>; NUMBERS],
    /// Unit vectors to the eye, where colours are lit.
    to_eye: &'r mut [Numbers<f32>; 3],
    textures: Option<&'r mut RowTextures>,
    /// How much of each sample lines cover, if there are any: plain ones along all edges.
    coverages: Option<&'r mut Numbers<f32>>,
    /// Samples of short spans that wait for others, in modes that show normals.
    short: Option<&'r mut ShortSpans>,
    /// What the samples that are evaluated and not coloured yet are textured with.
    textured: Option<Textured<'s>>,
    /// Whether all triangles have one colour, which is among the numbers already.
    has_only_color: bool,
    primitives: &'h [u32],
    /// They, and those of the samples after them.
    ahead: &'h [u32],
    y: f64,
    /// What depends on the row of the direction to the eye.
    down: Vec3,
}

impl<'s> Scanline<'_, 's, '_> {
    #[inline(always)]
    fn shade<L: Lanes>(mut self, lanes: L, out: &mut impl Out) {
        let mut first = 0;
        let mut alone = 0u64;
        let count = self.primitives.len();
        let after = Span {
            primitive: MISS,
            first: count,
            end: count,
        };
        let mut spans = spans(lanes, self.primitives);
        if self.colors.are_lit() {
            self.write_to_eye(lanes, spans.shown());
        }
        let are_many = spans.len() >= LANES as u32;
        let is_plain =
            are_many && matches!(self.colors, RowColors::Facets) && self.coverages.is_none();
        if is_plain {
            let work = WritePlainRow {
                tile: self.tile,
                numbers: self.numbers,
                ahead: self.ahead,
                count,
                has_colors: !self.has_only_color,
            };
            dispatch(work.tile.shader().simd(), work);
        }
        if !short_spans::are_worth_it(spans.len(), count) {
            self.short = None;
        }
        loop {
            // Spans are coloured in one place: it is long.
            let span = spans.next().unwrap_or(after);
            let is_miss = span.primitive == MISS;
            let textured = self.textured(span);
            if is_miss || !Textured::are_same(self.textured, textured) {
                alone |= self.interpolate_short(lanes);
                self.color(lanes, (first, span.first), out);
                self.textured = textured;
                first = span.first;
            }
            if is_miss {
                out.misses(span.first, span.end);
                first = span.end;
                if first >= count {
                    break;
                }
            } else if is_plain {
                // Written before.
            } else if self.is_short(span) {
                for at in span.first..span.end {
                    let short = self.short.as_mut();
                    if short.is_some_and(|short| short.add(span.primitive, at)) {
                        alone |= self.interpolate_short(lanes);
                    }
                }
            } else if !self.interpolate(lanes, span) {
                alone |= span.bits();
            }
        }
        if alone != 0 {
            self.color_alone(alone, out);
        }
    }

    /// Writes the unit vectors from some samples to the eye.
    #[inline(always)]
    fn write_to_eye<L: Lanes>(&mut self, lanes: L, samples: Range<usize>) {
        let down = Vectors::splat(lanes, self.down);
        let [x, y, z] = &self.columns.to_eye;
        let mut at = samples.start;
        while at < samples.end {
            let along = [
                lanes.load(x.eight(at)),
                lanes.load(y.eight(at)),
                lanes.load(z.eight(at)),
            ];
            let to_eye = Vectors::new(lanes, along).plus(down).unit();
            store(to_eye.xyz(), self.to_eye, at);
            at += LANES;
        }
    }

    /// Whether a span is so short that its triangle, which is not prepared, is not worth preparing.
    #[inline(always)]
    fn is_short(&self, span: Span) -> bool {
        self.short.is_some()
            && span.end - span.first <= short_spans::LONGEST
            && !self.tile.knows(span.primitive)
    }

    /// Writes the numbers of the samples that wait; those that have no linear functions, a bit each.
    #[inline(always)]
    fn interpolate_short<L: Lanes>(&mut self, lanes: L) -> u64 {
        let Some(short) = &mut self.short else {
            return 0;
        };
        let Some(samples) = short.take() else {
            return 0;
        };
        let shader = self.tile.shader();
        let triangles = samples.triangles(lanes, shader);
        let places = (&samples, &self.columns.x, self.y);
        let normals = triangles.normals(shader, self.planar, places);
        let normals_xyz = Vectors::load(lanes, &normals.xyz).unit().store();
        let mut alone = 0;
        for (lane, at) in samples.places() {
            if !normals.are_linear[lane] {
                alone |= 1 << at;
                continue;
            }
            for (numbers, normals) in self.numbers.iter_mut().zip(&normals_xyz.0) {
                numbers.0[at] = normals[lane];
            }
            if !matches!(self.colors, RowColors::Normals) && !self.has_only_color {
                let color = triangles.color(shader, lane).to_array();
                for (numbers, color) in self.numbers[3..].iter_mut().zip(color) {
                    numbers.0[at] = color;
                }
            }
        }
        alone
    }

    /// What a span's triangle is textured with.
    #[inline(always)]
    fn textured(&mut self, span: Span) -> Option<Textured<'s>> {
        if self.textures.is_none() || span.primitive == MISS {
            return None;
        }
        let shader = self.tile.shader();
        Textured::of(shader, self.tile.facet(span.primitive, 0.0))
    }

    /// Writes the numbers of a span's triangle, and anything into up to seven samples after it. False where it has no
    /// linear functions.
    #[inline(always)]
    fn interpolate<L: Lanes>(&mut self, lanes: L, span: Span) -> bool {
        let width = self.tile.shader().lines.width;
        let facet = self.tile.facet(span.primitive, 0.0);
        let numbers = &mut *self.numbers;
        if let Some(coverages) = &mut self.coverages {
            let mut at = span.first;
            while at < span.end {
                let xs = self.columns.x.eight(at);
                *coverages.eight_mut(at) = match &facet.edges {
                    None => [0.0; LANES],
                    Some(edges) => edges.coverages(xs, self.y, width),
                };
                at += LANES;
            }
        }
        if let Some(textures) = &mut self.textures {
            let place = (self.y, &self.columns.x);
            if !textures.interpolate(lanes, self.textured, facet, place, span) {
                return false;
            }
        }
        match self.colors {
            RowColors::Own => fill(lanes, facet.color.to_array(), &mut numbers[3..], span),
            RowColors::Flat => {
                fill(lanes, facet.light.to_array(), numbers, span);
                fill(lanes, facet.color.to_array(), &mut numbers[3..], span);
            }
            RowColors::Facets => {
                fill(lanes, facet.normal.to_array(), numbers, span);
                if !self.has_only_color {
                    fill(lanes, facet.color.to_array(), &mut numbers[3..], span);
                }
            }
            RowColors::Smooth | RowColors::SmoothTextured | RowColors::Normals => {
                let Some(normal) = &facet.linear_normal else {
                    return false;
                };
                let along = normal.in_row(self.y);
                let side = normal.turns().then_some(facet.normal);
                let mut at = span.first;
                while at < span.end {
                    let xs = self.columns.x.eight(at);
                    let mut normal = eight_along(lanes, &along, xs);
                    if let Some(flat) = side {
                        normal = on_side(lanes, normal, flat);
                    }
                    store(normal.unit().xyz(), numbers, at);
                    at += LANES;
                }
                if !matches!(self.colors, RowColors::Normals) && !self.has_only_color {
                    fill(lanes, facet.color.to_array(), &mut numbers[3..], span);
                }
            }
            RowColors::Depth => {
                let Interpolation::Linear(interpolants) = &facet.interpolation else {
                    return false;
                };
                let [t, w] = interpolants.distances_in_row(self.y);
                let mut at = span.first;
                while at < span.end {
                    let xs = self.columns.x.eight(at);
                    store([t.eight(lanes, xs), w.eight(lanes, xs)], numbers, at);
                    at += LANES;
                }
            }
            RowColors::Barycentric | RowColors::Uv => {
                let Interpolation::Linear(interpolants) = &facet.interpolation else {
                    return false;
                };
                let along = interpolants.weights_in_row(self.y);
                let mut at = span.first;
                while at < span.end {
                    let xs = self.columns.x.eight(at);
                    store(eight_along(lanes, &along, xs).xyz(), numbers, at);
                    at += LANES;
                }
                if matches!(self.colors, RowColors::Uv) {
                    let [a, b, c] = facet.uvs.unwrap_or_default();
                    let corners = [a.x, b.x, c.x, a.y, b.y, c.y];
                    fill(lanes, corners, &mut numbers[3..], span);
                }
            }
        }
        true
    }

    /// Colours samples by their numbers, and any that come after them by anything.
    #[inline(always)]
    fn color<L: Lanes>(&mut self, lanes: L, samples: (usize, usize), out: &mut impl Out) {
        if let (Some(textures), Some(textured)) = (&mut self.textures, self.textured) {
            let shader = self.tile.shader();
            let work = ColorTextured {
                textures,
                textured,
                shader,
                own: &mut self.numbers[3..],
                samples,
            };
            dispatch(shader.simd(), work);
        }
        match self.colors {
            RowColors::Own => self.color_by(lanes, &OwnColorLook, samples, out),
            RowColors::Flat => self.color_by(lanes, &FlatLight, samples, out),
            RowColors::Smooth | RowColors::SmoothTextured => {
                self.color_by(lanes, &SmoothLight, samples, out);
            }
            RowColors::Facets => self.color_by(lanes, &SmoothLight, samples, out),
            RowColors::Normals => self.color_by(lanes, &NormalColors, samples, out),
            RowColors::Depth => self.color_by(lanes, &Greys, samples, out),
            RowColors::Barycentric => self.color_by(lanes, &Weights, samples, out),
            RowColors::Uv => self.color_by(lanes, &TextureCoordinates, samples, out),
        }
    }

    /// [`Scanline::color`] in one mode.
    #[inline(always)]
    fn color_by<L: Lanes>(
        &self,
        lanes: L,
        look: &impl Look,
        (first, end): (usize, usize),
        out: &mut impl Out,
    ) {
        let shader = self.tile.shader();
        let mut at = first;
        while at < end {
            let mut colors = look.eight(lanes, self, at);
            if let Some(coverages) = &self.coverages {
                let coverage = lanes.load(coverages.eight(at));
                let light = colors.light(lanes, shader.tables);
                let lines = EightLines::plain(lanes, &shader.lines, coverage);
                colors = EightSamples::Light(lines.over(lanes, light));
            }
            out.eight(lanes, at, colors);
            at += LANES;
        }
        out.finish(lanes, (first, end));
    }

    /// Colours samples, a bit each, one by one.
    #[inline(never)]
    fn color_alone(&mut self, samples: u64, out: &mut impl Out) {
        for at in (0..self.primitives.len()).filter(|at| samples >> at & 1 == 1) {
            let hit = PrimitiveHit {
                primitive: self.primitives[at],
                ..PrimitiveHit::NONE
            };
            out.one(at, self.tile.color(self.columns.x.0[at], self.y, &hit));
        }
    }

    /// A number of eight samples.
    #[inline(always)]
    fn number<L: Lanes>(&self, lanes: L, number: usize, at: usize) -> L::F32 {
        lanes.load(self.numbers[number].eight(at))
    }

    /// Three numbers of eight samples.
    #[inline(always)]
    fn vectors<L: Lanes>(&self, lanes: L, number: usize, at: usize) -> Vectors<L> {
        let [x, y, z] = [number, number + 1, number + 2];
        let xyz = [
            self.number(lanes, x, at),
            self.number(lanes, y, at),
            self.number(lanes, z, at),
        ];
        Vectors::new(lanes, xyz)
    }

    /// The barycentrics of eight samples.
    #[inline(always)]
    fn weights<L: Lanes>(&self, lanes: L, at: usize) -> [L::F32; 2] {
        eight_weights_of(lanes, self.vectors(lanes, 0, at).xyz())
    }
}

/// A vector of eight lanes for each of some numbers, from a sample on.
#[inline(always)]
fn store<L: F32x8, const N: usize>(all: [L; N], numbers: &mut [Numbers<f32>], at: usize) {
    for (numbers, eight) in numbers.iter_mut().zip(all) {
        eight.store(numbers.eight_mut(at));
    }
}

/// The same numbers for all samples of a span.
#[inline(always)]
fn fill<L: Lanes, const N: usize>(
    lanes: L,
    all: [f32; N],
    numbers: &mut [Numbers<f32>],
    span: Span,
) {
    for (numbers, number) in numbers.iter_mut().zip(all) {
        let number = lanes.splat(number);
        let mut at = span.first;
        while at < span.end {
            number.store(numbers.eight_mut(at));
            at += LANES;
        }
    }
}

/// Normals turned to the side of `flat`.
#[inline(always)]
fn on_side<L: Lanes>(lanes: L, normal: Vectors<L>, flat: Vec3) -> Vectors<L> {
    let is_away = normal.dot(Vectors::splat(lanes, flat)).lt(lanes.splat(0.0));
    normal.replaced(is_away, normal.scaled(lanes.splat(-1.0)))
}
