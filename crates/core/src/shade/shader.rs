//! The colours of a picture's samples.

mod needs;
mod prefetch;
mod sample_color;
mod triangles;

use super::depth_colors::DepthColors;
use super::facet::{Facet, Mapping, Needs};
use super::ground::GroundGrid;
use super::interpolants::PlanarRays;
use super::legend::Legend;
use super::light::Lights;
use super::line_overlay::{LineOverlay, Wanted};
use super::lines::Lines;
use super::own_color::{OwnColors, distance_range};
use super::ramp::RampRange;
use super::section::Section;
use super::sides::Sides;
use super::smooth::{self, EightLights};
use super::srgb::{self, Tables};
use super::texture::texturing::Texturing;
use super::texture::triplanar::Triplanar;
use super::translucent::Translucent;
use super::vectors::{Row, Vectors};
use super::{Background, Filter, Mode, Shading, Wireframe};
use crate::bvh::Accel;
use crate::camera::{Camera, Lattice, Projection, Rect};
use crate::hit::{Cull, MISS, PrimitiveHit};
use crate::num::simd::{LANES, Lanes, Simd, Work, dispatch};
use crate::scene::{Attribute, ClippingPlanes, ColorScale, Masks, Scene, Texture};
use glam::{DVec3, Mat3, Vec3};
use needs::needs_of;
use std::sync::Arc;
use triangles::{creased, world_normals};

/// Pixels of a row that are tested together for having rays, where a whole row's are not known to. Longer runs fail the test
/// more often near a lens's end; with shorter ones the tests take as long as those of single pixels.
const RUN: usize = 32;

/// Computes the colours of hits. It holds what all pixels of a picture share: lights, mappings of textures, the background.
///
/// [`Shader::color`] shades one sample; [`Shader::tile`] gives a [`TileShader`](super::TileShader), which shades many with
/// the same results, faster.
#[derive(Debug)]
pub struct Shader<'a> {
    scene: &'a Scene,
    accel: &'a Accel,
    camera: Camera,
    shading: Shading,
    needs: Needs,
    /// The eye, relative to the tree's origin.
    eye: DVec3,
    /// The direction from hits to the eye, not of unit length, is linear in the pixel: its value at the picture's top left
    /// corner, and its derivatives along x and y. Zero in panoramas.
    to_eye: [Vec3; 3],
    /// The rays as linear functions of the place; `None` in panoramas and pictures for two eyes.
    planar: Option<PlanarRays>,
    lights: Lights,
    eight_lights: EightLights,
    /// Whether normals are fetched before they are read.
    prefetches: bool,
    /// Normals by the crease angle of each object that has none of its own; empty where no pixel needs them.
    creased: Vec<Option<Arc<Attribute<Vec3>>>>,
    /// The normal matrix of each object, world from object; `None` where its transform is singular.
    world_normals: Vec<Option<Mat3>>,
    own_colors: OwnColors,
    texturing: Texturing,
    /// The width of a sample's texture footprint, in pixels.
    sample_width: f64,
    depth: DepthColors,
    background: Option<[Vec3; 2]>,
    /// The background's colour in each row of pixels.
    backdrops: Vec<[u8; 4]>,
    pub(super) lines: Lines<'a>,
    ground: Option<GroundGrid>,
    section: Option<Section<'a>>,
    masks: Option<Masks<'a>>,
    translucent: Option<Translucent>,
    /// The test for back faces, and their colour, where they have their own.
    backs: Option<(Sides, Vec3)>,
    pub(super) tables: &'static Tables,
}

impl<'a> Shader<'a> {
    /// A shader for one picture. `accel` must have been built over this `scene`.
    pub fn new(scene: &'a Scene, accel: &'a Accel, camera: Camera, shading: Shading) -> Self {
        let colored = shading.mode.shows().colors;
        let own_colors = OwnColors::new(scene, &camera, &shading, colored);
        let ground = (shading.ground).and_then(|ground| GroundGrid::new(scene, ground, &camera));
        let needs = Needs {
            ground: ground.is_some()
                && !camera.projection().is_parallel()
                && !camera.has_an_eye_a_column(),
            ..needs_of(scene, &shading, &own_colors)
        };
        let lines = shading.wireframe.unwrap_or(Wireframe::ALONE);
        let lights = Lights::new(&camera, shading.lights);
        Self {
            scene,
            accel,
            camera,
            shading,
            needs,
            eye: camera.pose().eye - accel.origin(),
            to_eye: to_eye(&camera),
            planar: PlanarRays::new(&camera, accel.origin()),
            eight_lights: EightLights::new(&lights),
            lights,
            prefetches: prefetch::is_worth_it(scene, &needs),
            creased: creased(scene, &shading),
            world_normals: world_normals(scene),
            own_colors,
            texturing: Texturing::new(scene, shading, accel.origin(), needs.texture),
            sample_width: 1.0,
            depth: if shading.mode == Mode::Depth {
                DepthColors::new(scene, &camera, shading.scale)
            } else {
                DepthColors::NONE
            },
            background: match shading.background {
                Background::Gradient(top, bottom) => {
                    Some([srgb::linear(top), srgb::linear(bottom)])
                }
                Background::Transparent => None,
            },
            backdrops: Vec::new(),
            lines: Lines::new(scene, lines, needs),
            ground,
            section: None,
            masks: Masks::of(scene),
            translucent: Translucent::of(scene, &shading),
            backs: (shading.back_faces.filter(|_| colored)).map(|color| {
                let sides = Sides::new(&camera, accel.origin());
                (sides, srgb::linear(color))
            }),
            tables: srgb::tables(),
        }
        .with_backdrops()
        .with_interpolants()
    }

    /// The shader with triangles' linear functions, where colours can take t, u and v from those.
    fn with_interpolants(mut self) -> Self {
        self.needs.interpolants = self.planar.is_some() && self.can_interpolate();
        self
    }

    /// The shader with the sections that clipping planes make.
    pub(crate) fn with_sections(self, clip: &ClippingPlanes, cull: Cull) -> Self {
        let Self { scene, accel, .. } = self;
        Self {
            section: Section::new(scene, accel, self.camera, self.shading.mode, (clip, cull)),
            ..self
        }
    }

    /// The shader with hidden lines and silhouettes, which lie on pixels whose own triangle does not have them. Only what
    /// clipping planes keep has lines.
    pub(crate) fn with_overlay(mut self, clip: &ClippingPlanes) -> Self {
        if self.needs.edges {
            let wanted = Wanted {
                choice: self.lines.choice.as_ref(),
                width: self.lines.width,
                hidden: self.lines.hidden > 0.0,
                clip,
            };
            self.lines.overlay = LineOverlay::new(self.accel, self.camera, wanted);
        }
        self
    }

    /// Whether lines or the ground may show where nothing is hit.
    pub(crate) fn has_overlay(&self) -> bool {
        self.lines.overlay.is_some() || self.ground.is_some()
    }

    /// For eight places of a row, from left to right, whether lines of the overlay or the ground may show: `false` is
    /// certain.
    #[inline(always)]
    pub(super) fn may_overlay(&self, xs: &[f64; LANES], y: f64) -> [bool; LANES] {
        let mut shown = match &self.ground {
            Some(ground) => ground.may_show(xs, y),
            None => [false; LANES],
        };
        if let Some(lines) = &self.lines.overlay {
            for (shown, reached) in shown.iter_mut().zip(lines.may_reach(xs, y)) {
                *shown |= reached;
            }
        }
        shown
    }

    /// Of samples of a row that show the background, at most eight, draws those over which lines or the ground show;
    /// `encode` makes a sample of a colour in linear light with straight alpha.
    #[inline(always)]
    pub(super) fn overlay<T>(
        &self,
        (xs, y): (&[f64; LANES], f64),
        samples: &mut [T],
        encode: impl Fn([f32; 4]) -> T,
    ) {
        let shown = self.may_overlay(xs, y);
        if shown == [false; LANES] {
            return;
        }
        let behind = self.eight_behind(xs, y, &shown);
        for ((behind, shown), sample) in behind.into_iter().zip(shown).zip(samples) {
            if shown {
                *sample = encode(behind);
            }
        }
    }

    /// [`Shader::behind`] at those of eight places of a row that are wanted; anything at the others.
    #[inline(always)]
    pub(super) fn eight_behind(
        &self,
        xs: &[f64; LANES],
        y: f64,
        wanted: &[bool; LANES],
    ) -> [[f32; 4]; LANES] {
        if let (Some(ground), None) = (&self.ground, &self.lines.overlay)
            && let Some(behind) = ground.over_eight(xs, y, self.backdrop(y))
        {
            return behind;
        }
        let mut all = [[0.0; 4]; LANES];
        for ((&x, &is_wanted), behind) in xs.iter().zip(wanted).zip(&mut all) {
            if is_wanted {
                *behind = self.behind(x, y);
            }
        }
        all
    }

    /// The section that clipping planes make, if any is seen.
    pub(crate) fn section(&self) -> Option<&Section<'a>> {
        self.section.as_ref()
    }

    /// The masks of the scene's materials, which reject hits.
    pub(crate) fn masks(&self) -> Option<&Masks<'a>> {
        self.masks.as_ref()
    }

    /// Which surfaces are translucent, if any are.
    pub(crate) fn translucent(&self) -> Option<&Translucent> {
        self.translucent.as_ref()
    }

    /// The alpha of a hit's material.
    pub(super) fn alpha(&self, hit: &PrimitiveHit) -> f32 {
        let (object, triangle) = self.accel.identify(hit.primitive);
        let mesh = &self.scene.objects[object as usize].mesh;
        match mesh.opacity(triangle).alpha() {
            Some(alpha) => alpha
                .at(mesh.corner_uvs(triangle), hit.u, hit.v)
                .clamp(0.0, 1.0) as f32,
            None => 1.0,
        }
    }

    /// The shader for so many samples a pixel: a sample's texture footprint is √(1 / samples) of a pixel wide, so that all
    /// of them cover the pixel's.
    pub fn with_samples(self, samples: u32) -> Self {
        Self {
            sample_width: 1.0 / f64::from(samples.max(1)).sqrt(),
            ..self
        }
    }

    /// Whether the depth mode's colour map is to be fitted to the distances that are seen.
    pub(crate) fn fits_depth(&self) -> bool {
        let is_fitted = |scale: &ColorScale| scale.range.is_none();
        self.shading.mode == Mode::Depth && self.shading.scale.as_ref().is_some_and(is_fitted)
    }

    /// The shader with the depth mode's colour map fitted to these distances, the least and the greatest that are seen.
    pub(crate) fn with_depths(mut self, seen: [f32; 2]) -> Self {
        if let (DepthColors::Map(_, span), Some(scale)) = (&mut self.depth, &mut self.shading.scale)
        {
            let range = seen.map(f64::from);
            *span = RampRange::of(Some(range));
            scale.range = Some(range);
        }
        self
    }

    /// The legend of the picture's colour scale; `None` where no numbers are shown as colours.
    pub fn legend(&self) -> Option<Legend> {
        match (&self.depth, self.shading.scale) {
            (DepthColors::Map(..), Some(scale)) => Some(Legend {
                title: "distance".to_owned(),
                scale: ColorScale {
                    range: match scale.range {
                        None => distance_range(&self.scene.bounds(), &self.camera, None),
                        range => range,
                    },
                    ..scale
                },
            }),
            _ if self.shading.mode.shows().colors => {
                Legend::of_objects(self.scene, &self.camera, &self.shading)
            }
            _ => None,
        }
    }

    /// The colour of the sample at (x, y) of the picture, in pixels from its top left corner: linear light, straight alpha.
    ///
    /// In planar pictures t, u and v are interpolated over the image plane, and those of `hit` make no difference unless lines,
    /// a ground, translucent surfaces or photographs need them; elsewhere they are the hit's.
    ///
    /// A photograph is shown as if its camera saw the hit; the caller, who can cast rays, tests whether it does.
    pub fn color(&self, x: f64, y: f64, hit: &PrimitiveHit) -> [f32; 4] {
        if hit.primitive == MISS {
            self.behind(x, y)
        } else {
            self.color_on(&self.facet(hit.primitive, self.needs, x), x, y, hit)
        }
    }

    /// [`Shader::color`] as sRGB bytes with straight alpha, which pictures store.
    pub fn shade_pixel8(&self, x: f64, y: f64, hit: &PrimitiveHit) -> [u8; 4] {
        srgb::encode(self.color(x, y, hit))
    }

    /// A picture's layers at a hit: the unit normal in world space, on the side of the eye (the mesh's interpolated normal
    /// where it has any), and the texture coordinates (zero where it has none). Both are zero at a miss.
    pub fn surface(&self, x: f64, _y: f64, hit: &PrimitiveHit) -> ([f32; 3], [f32; 2]) {
        if hit.primitive == MISS {
            return ([0.0; 3], [0.0; 2]);
        }
        self.surface_triangle(hit.primitive, x).at(hit.u, hit.v)
    }

    /// As [`TileShader::shade`](super::TileShader::shade) where no ray hits anything.
    pub fn shade_nothing<'p>(&self, rect: Rect, rows: impl Iterator<Item = &'p mut [[u8; 4]]>) {
        for (y, row) in (rect.y..rect.bottom()).zip(rows) {
            row.fill(self.backdrop8(y));
            if self.has_overlay() {
                let row = OverlaidRow {
                    shader: self,
                    left: rect.x,
                    y: f64::from(y) + 0.5,
                    pixels: &mut *row,
                };
                dispatch(self.simd(), row);
            }
            self.clear_beyond(rect.x, y, row);
        }
    }

    /// What a row shows between two places where no ray hits anything, if that is one colour: linear light, straight alpha.
    pub(crate) fn nothing_between(&self, left: f64, right: f64, y: f64) -> Option<[f32; 4]> {
        let behind = self.backdrop_between(left, right, y);
        behind.filter(|_| !self.has_overlay())
    }

    /// The background in a row of pixels, as sRGB bytes with straight alpha.
    pub(super) fn backdrop8(&self, row: u32) -> [u8; 4] {
        self.backdrops
            .get(row as usize)
            .copied()
            .unwrap_or_else(|| srgb::encode(self.backdrop(f64::from(row) + 0.5)))
    }

    /// Computes the rows of [`Shader::backdrop8`].
    fn with_backdrops(mut self) -> Self {
        let rows = self.camera.plane().rows;
        self.backdrops = (0..rows).map(|row| self.backdrop8(row)).collect();
        self
    }

    /// Whether each column of pixels has an eye of its own.
    pub(super) fn has_many_eyes(&self) -> bool {
        self.camera.has_an_eye_a_column()
    }

    /// The tree whose triangles are shaded.
    pub(super) fn accel(&self) -> &'a Accel {
        self.accel
    }

    /// The eye, relative to the tree's origin.
    pub(super) fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The camera's view axis.
    pub(super) fn forward(&self) -> DVec3 {
        self.camera.forward()
    }

    /// The instruction set to shade with: the tree's.
    pub(super) fn simd(&self) -> Simd {
        self.accel.simd()
    }

    /// sRGB greys of eight distances in the depth mode, 0 to 1.
    #[inline(always)]
    pub(super) fn eight_greys<L: Lanes>(&self, lanes: L, t: L::F32) -> L::F32 {
        self.depth.eight_greys(lanes, t)
    }

    /// The light on eight surfaces with these unit normals.
    #[inline(always)]
    pub(super) fn light<L: Lanes>(
        &self,
        lanes: L,
        normal: Vectors<L>,
        to_eye: Vectors<L>,
    ) -> Vectors<L> {
        self.eight_lights.on(lanes, normal, to_eye)
    }

    /// The rays as linear functions of the place, where colours take t, u and v from those.
    #[inline(always)]
    pub(super) fn planar(&self) -> Option<&PlanarRays> {
        self.planar.as_ref().filter(|_| self.needs.interpolants)
    }

    /// The direction to the eye, not of unit length, at a planar picture's top left corner, and its changes a pixel along x
    /// and y.
    #[inline(always)]
    pub(super) fn to_eye(&self) -> &[Vec3; 3] {
        &self.to_eye
    }

    /// Unit vectors from eight samples of a row to the eye, in a planar picture.
    #[inline(always)]
    pub(super) fn eight_to_eye<L: Lanes>(&self, lanes: L, place: (&Row, f32)) -> Vectors<L> {
        smooth::to_eye(lanes, &self.to_eye, place)
    }

    /// The rays of a rectangle's pixels.
    pub(super) fn lattice(&self, rect: Rect) -> Lattice {
        self.camera.sub_camera(rect).lattice()
    }

    /// How textures are read.
    pub(super) fn filter(&self) -> Filter {
        self.shading.filter
    }

    /// How much of a texture shows, 0 to 1.
    pub(super) fn blend(&self) -> f32 {
        self.shading.blend
    }

    /// The mapping of a triangle from three sides, if that is what its texture has.
    #[inline(always)]
    pub(super) fn triplanar_of(&self, facet: &Facet, mapping: &Mapping) -> Option<&Triplanar> {
        match mapping {
            Mapping::Triplanar(..) => self.texturing.triplanar(facet.object),
            _ => None,
        }
    }

    /// The texture on a triangle that has a mapping.
    #[inline(always)]
    pub(super) fn texture_on(&self, facet: &Facet) -> Option<&'a Texture> {
        self.scene.objects[facet.object as usize].texture_on(facet.triangle)
    }

    /// What the mode needs of each triangle.
    pub(super) fn needs(&self) -> Needs {
        self.needs
    }

    /// Whether the projection is a panorama: pixels do not lie on an image plane.
    pub(super) fn is_panoramic(&self) -> bool {
        self.camera.projection().panorama().is_some()
    }

    /// Clears the pixels of a row that lie outside the panorama's frame to transparent; the first is in column `left`.
    pub(super) fn clear_beyond(&self, left: u32, y: u32, pixels: &mut [[u8; 4]]) {
        if !self.is_panoramic() || pixels.is_empty() {
            return;
        }
        let (first, y) = (f64::from(left) + 0.5, f64::from(y) + 0.5);
        // The first place and the last of some pixels.
        let ends = |at: usize, count: usize| {
            let first = first + at as f64;
            (first, first + (count - 1) as f64)
        };
        let has_all = |(first, last)| self.camera.has_all_between(first, last, y);
        if has_all(ends(0, pixels.len())) {
            return;
        }
        for (run, pixels) in pixels.chunks_mut(RUN).enumerate() {
            if has_all(ends(run * RUN, pixels.len())) {
                continue;
            }
            for (eight, pixels) in pixels.chunks_mut(LANES).enumerate() {
                let (x, _) = ends(run * RUN + eight * LANES, pixels.len());
                let has = self.camera.has_eight_places(x, y);
                for (pixel, has) in pixels.iter_mut().zip(has) {
                    if !has {
                        *pixel = [0; 4];
                    }
                }
            }
        }
    }

    /// The colour of the sample at (x, y) whose ray hits nothing: the background, the ground, and lines over them;
    /// transparent outside a panorama's frame.
    pub(crate) fn behind(&self, x: f64, y: f64) -> [f32; 4] {
        if self.camera.has_place(x, y) {
            let behind = self.grounded(x, y, f32::INFINITY, self.backdrop(y));
            let behind = self.lines.seen_through(x, y, behind);
            self.lines.outlined(x, y, f32::INFINITY, behind)
        } else {
            [0.0; 4]
        }
    }

    /// The background in a row between two places, if the frame surely has all between them. It is what lies behind where
    /// no overlay shows.
    pub(super) fn backdrop_between(&self, left: f64, right: f64, y: f64) -> Option<[f32; 4]> {
        let is_inside = !self.is_panoramic()
            || self.camera.stereo().is_none() && self.camera.has_all_between(left, right, y);
        is_inside.then(|| self.backdrop(y))
    }

    /// The ground's lines, where they are nearer than `t`, over a colour.
    fn grounded(&self, x: f64, y: f64, t: f32, behind: [f32; 4]) -> [f32; 4] {
        match &self.ground {
            Some(ground) => ground.over(&self.camera, (x, y), t, behind),
            None => behind,
        }
    }

    /// The background at a distance y from the picture's top, in pixels.
    pub(super) fn backdrop(&self, y: f64) -> [f32; 4] {
        let Some([top, bottom]) = self.background else {
            return [0.0; 4];
        };
        let (first, rows) = self.camera.own_rows();
        let down = ((y - first) / rows).clamp(0.0, 1.0) as f32;
        opaque(top + (bottom - top) * down)
    }
}

/// A row of pixels that hits nothing, over which lines or the ground may show.
struct OverlaidRow<'s, 'p> {
    shader: &'s Shader<'s>,
    /// The first pixel's column.
    left: u32,
    y: f64,
    pixels: &'p mut [[u8; 4]],
}

impl Work for OverlaidRow<'_, '_> {
    #[inline(always)]
    fn run(self, _: impl Lanes) {
        let Self {
            shader,
            left,
            y,
            pixels,
        } = self;
        for (column, pixels) in (left..).step_by(LANES).zip(pixels.chunks_mut(LANES)) {
            let mut xs = [0.0; LANES];
            for (column, x) in (column..).zip(&mut xs) {
                *x = f64::from(column) + 0.5;
            }
            shader.overlay((&xs, y), pixels, srgb::encode);
        }
    }
}

/// The direction from hits to the eye at the picture's top left corner, and its derivatives along x and y in pixels; zero
/// in panoramas, where it is not linear.
fn to_eye(camera: &Camera) -> [Vec3; 3] {
    let direction = |x, y| -camera.direction(x, y) / camera.distance();
    let corner = match camera.projection() {
        Projection::Perspective => direction(0.0, 0.0),
        Projection::Orthographic => -camera.forward(),
        Projection::Panoramic(_) => DVec3::ZERO,
    };
    let (right, down) = match camera.projection() {
        Projection::Perspective => {
            let pixel = camera.plane().step / camera.distance();
            (camera.right() * -pixel, camera.up() * pixel)
        }
        Projection::Orthographic | Projection::Panoramic(_) => (DVec3::ZERO, DVec3::ZERO),
    };
    [corner, right, down].map(|vector| vector.as_vec3())
}

/// An opaque colour.
fn opaque(color: Vec3) -> [f32; 4] {
    [color.x, color.y, color.z, 1.0]
}
