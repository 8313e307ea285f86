use super::depth_colors::DepthColors;
use super::edges::EdgeLines;
use super::eight_colors::EightColors;
use super::facet::{Facet, Mapping, Needs, SurfaceTriangle, Varied, blend, facing_normal, unit};
use super::ground::GroundGrid;
use super::legend::Legend;
use super::light::Lights;
use super::line_overlay::{LineOverlay, Wanted};
use super::lines::Lines;
use super::own_color::{OwnColors, Placed, distance_range};
use super::ramp::Span;
use super::reflection::{self, PlainReflectance, Surface, Surfaces};
use super::section::Section;
use super::sides::Sides;
use super::slopes::slopes;
use super::smooth::{self, Facets, Row, Vectors};
use super::srgb::{self, Tables};
use super::texturing::Texturing;
use super::translucent::Translucent;
use super::{Background, Filter, Mode, Shading, Wireframe};
use crate::bvh::Accel;
use crate::camera::{Camera, Lattice, Projection, Rect};
use crate::hit::{Cull, Detail, HitNumbers, MISS, PrimitiveHit};
use crate::num::simd::{LANES, Lanes, Simd};
use crate::scene::{
    Attribute, ClippingPlanes, ColorScale, Masks, Object, Reflectance, Scene, Texture,
};
use glam::{DAffine3, DMat3, DVec3, Mat3, Vec2, Vec3};
use std::sync::Arc;

/// Gives hits their colours: everything about a picture that does not change from pixel to pixel,
/// worked out once.
///
/// [`Shader::tile`] is the fast way for many pixels; [`Shader::color`] answers for one.
#[derive(Debug)]
pub struct Shader<'a> {
    scene: &'a Scene,
    accel: &'a Accel,
    camera: Camera,
    shading: Shading,
    needs: Needs,
    /// The eye, relative to the tree's origin.
    eye: DVec3,
    /// From hits to the eye: through the picture's corner, and what a pixel to the right and down
    /// adds.
    to_eye: [Vec3; 3],
    lights: Lights,
    /// For each object without normals, those that its crease angle gives it; empty where no pixel needs them.
    creased: Vec<Option<Arc<Attribute<Vec3>>>>,
    /// For each object, world-space normals from its own; `None` for one that is squashed flat.
    world_normals: Vec<Option<Mat3>>,
    own_colors: OwnColors,
    texturing: Texturing,
    /// Of a pixel's width, how much a sample stands for.
    sample_width: f64,
    depth: DepthColors,
    background: Option<[Vec3; 2]>,
    /// The background at the middle of each row.
    backdrops: Vec<[u8; 4]>,
    pub(super) lines: Lines<'a>,
    ground: Option<GroundGrid>,
    section: Option<Section<'a>>,
    masks: Option<Masks<'a>>,
    translucent: Option<Translucent>,
    /// Which sides of triangles are seen, and the colour of backs, where they have their own.
    backs: Option<(Sides, Vec3)>,
    pub(super) tables: &'static Tables,
}

impl<'a> Shader<'a> {
    /// A shader for one picture. `accel` must have been built over this `scene`.
    pub fn new(scene: &'a Scene, accel: &'a Accel, camera: Camera, shading: Shading) -> Self {
        let colored = is_colored(shading.mode);
        let own_colors = OwnColors::new(scene, &camera, &shading, colored);
        let ground = (shading.ground).and_then(|ground| GroundGrid::new(scene, ground));
        let needs = Needs {
            ground: ground.is_some()
                && !camera.projection().is_parallel()
                && !camera.has_an_eye_a_column(),
            ..needs(scene, &shading, &own_colors)
        };
        let lines = shading.wireframe.unwrap_or(Wireframe::ALONE);
        Self {
            scene,
            accel,
            camera,
            shading,
            needs,
            eye: camera.placement().eye - accel.origin(),
            to_eye: to_eye(&camera),
            lights: Lights::new(&camera, shading.lights),
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
    }

    /// Of a picture that clipping planes cut.
    pub(crate) fn with_sections(self, clip: &ClippingPlanes, cull: Cull) -> Self {
        let Self { scene, accel, .. } = self;
        Self {
            section: Section::new(scene, accel, self.camera, self.shading.mode, (clip, cull)),
            ..self
        }
    }

    /// With lines where no triangle at a pixel has them: hidden ones, and silhouettes, of what clipping planes keep.
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

    /// Whether there may be lines where nothing is hit.
    pub(super) fn has_overlay(&self) -> bool {
        self.lines.overlay.is_some() || self.ground.is_some()
    }

    /// The section that clipping planes make, if any is seen.
    pub(crate) fn section(&self) -> Option<&Section<'a>> {
        self.section.as_ref()
    }

    /// Which hits count: the masks of the scene's materials.
    pub(crate) fn masks(&self) -> Option<&Masks<'a>> {
        self.masks.as_ref()
    }

    /// Which surfaces let through what lies behind them, if any do.
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

    /// Of a picture with so many samples a pixel: each stands for its part of what the pixel sees of a
    /// texture, √(1 / samples) of its width.
    pub fn with_samples(self, samples: u32) -> Self {
        Self {
            sample_width: 1.0 / f64::from(samples.max(1)).sqrt(),
            ..self
        }
    }

    /// Whether distances are shown through a colour map whose range is to be fitted to what is seen.
    pub(crate) fn fits_depth(&self) -> bool {
        let is_fitted = |scale: &ColorScale| scale.range.is_none();
        self.shading.mode == Mode::Depth && self.shading.scale.as_ref().is_some_and(is_fitted)
    }

    /// With the depth mode's colours over the distances that were seen, the nearest and the farthest.
    pub(crate) fn with_depths(mut self, seen: [f32; 2]) -> Self {
        if let (DepthColors::Map(_, span), Some(scale)) = (&mut self.depth, &mut self.shading.scale)
        {
            let range = seen.map(f64::from);
            *span = Span::of(Some(range));
            scale.range = Some(range);
        }
        self
    }

    /// What the picture's colour scale shows; `None` where it shows no numbers as colours.
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
            _ if is_colored(self.shading.mode) => {
                Legend::of_objects(self.scene, &self.camera, &self.shading)
            }
            _ => None,
        }
    }

    /// How much the picture asks of hits: colours of triangles alone need no weights.
    pub fn detail(&self) -> Detail {
        let needs = self.needs;
        let weighs = needs.smooth || needs.texture || needs.uvs || needs.varied;
        let weighs = weighs || (needs.edges && self.lines.has_silhouettes());
        let weighs = weighs || self.ground.is_some();
        if weighs || matches!(self.shading.mode, Mode::Barycentric | Mode::Depth) {
            Detail::Full
        } else {
            Detail::Triangle
        }
    }

    /// Which of a hit's numbers the picture asks for.
    pub(crate) fn hit_numbers(&self) -> HitNumbers {
        let has_lines = self.needs.edges || self.ground.is_some();
        match self.shading.mode {
            _ if has_lines || self.has_photographs() || self.translucent.is_some() => {
                HitNumbers::All
            }
            Mode::Depth => HitNumbers::T,
            _ => HitNumbers::Weights,
        }
    }

    /// The colour of the sample at (x, y) of the picture, in pixels from its top left corner:
    /// linear light, alpha not multiplied in. A texture that was taken by a camera shows as if that saw the hit:
    /// whether it does is for who casts rays.
    pub fn color(&self, x: f64, y: f64, hit: &PrimitiveHit) -> [f32; 4] {
        if hit.primitive == MISS {
            self.behind(x, y)
        } else {
            self.color_on(&self.facet(hit.primitive, self.needs, x), x, y, hit)
        }
    }

    /// [`Shader::color`] as a picture holds it: sRGB, alpha not multiplied in.
    pub fn shade_pixel8(&self, x: f64, y: f64, hit: &PrimitiveHit) -> [u8; 4] {
        srgb::encode(self.color(x, y, hit))
    }

    /// The unit surface normal in world space, towards the eye (the mesh's own, between corners,
    /// where it has normals), and the texture coordinates (zero where there are none): the
    /// picture's layers. Both zero at a miss.
    pub fn surface(&self, x: f64, _y: f64, hit: &PrimitiveHit) -> ([f32; 3], [f32; 2]) {
        if hit.primitive == MISS {
            return ([0.0; 3], [0.0; 2]);
        }
        self.surface_triangle(hit.primitive, x).at(hit.u, hit.v)
    }

    /// A triangle made ready for [`Shader::surface`] of pixels at `x` or, where they have one eye, of all.
    pub(super) fn surface_triangle(&self, primitive: u32, x: f64) -> SurfaceTriangle {
        let (object, triangle) = self.accel.identify(primitive);
        let mesh = &self.scene.objects[object as usize].mesh;
        let needs = Needs {
            normal: true,
            ..Needs::default()
        };
        let mut facet = self.facet(primitive, needs, x);
        if mesh.has_normals() {
            facet.normals = self.normals_in_world(object, mesh.corner_normals(triangle));
        }
        facet.uvs = mesh.corner_uvs(triangle);
        SurfaceTriangle {
            object,
            triangle,
            facet,
        }
    }

    /// As [`TileShader::shade`](super::TileShader::shade) where no ray hits anything.
    pub fn shade_nothing<'p>(&self, rect: Rect, rows: impl Iterator<Item = &'p mut [[u8; 4]]>) {
        for (y, row) in (rect.y..rect.bottom()).zip(rows) {
            if self.has_overlay() {
                for (x, pixel) in (rect.x..).zip(&mut *row) {
                    let (x, y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
                    *pixel = srgb::encode(self.behind(x, y));
                }
                continue;
            }
            row.fill(self.backdrop8(y));
            self.clear_beyond(rect.x, y, row);
        }
    }

    /// What lies behind everything at the middle of a row of the picture, as a picture holds it.
    pub(super) fn backdrop8(&self, row: u32) -> [u8; 4] {
        self.backdrops
            .get(row as usize)
            .copied()
            .unwrap_or_else(|| srgb::encode(self.backdrop(f64::from(row) + 0.5)))
    }

    /// Makes [`Shader::backdrop8`] ready.
    fn with_backdrops(mut self) -> Self {
        let rows = self.camera.plane().rows;
        self.backdrops = (0..rows).map(|row| self.backdrop8(row)).collect();
        self
    }

    /// Whether all pixels of a triangle have one colour.
    pub(super) fn is_constant(&self) -> bool {
        let is_flat = match self.shading.mode {
            Mode::Color | Mode::Flat | Mode::Texture => true,
            Mode::Normals => !self.needs.smooth,
            _ => false,
        };
        is_flat
            && !self.needs.texture
            && !self.needs.varied
            && !self.needs.edges
            && self.ground.is_none()
            && !self.has_many_eyes()
    }

    /// Whether pixels beside each other are seen from eyes of their own.
    pub(super) fn has_many_eyes(&self) -> bool {
        self.camera.has_an_eye_a_column()
    }

    /// The eye of the pixels at `x`, relative to the tree's origin.
    #[inline(always)]
    fn eye_at(&self, x: f64) -> DVec3 {
        if self.has_many_eyes() {
            self.camera.seen_at(x, 0.0).placement().eye - self.accel.origin()
        } else {
            self.eye
        }
    }

    /// The instruction set to shade with: the tree's.
    pub(super) fn simd(&self) -> Simd {
        self.accel.simd()
    }

    /// Whether eight pixels' colours depend on where the eye is.
    pub(super) fn looks_at_eyes(&self) -> bool {
        let colors = self.eight_colors();
        matches!(colors, Some(EightColors::Smooth | EightColors::Material))
    }

    /// What pixels are coloured by where eight are shaded at once; `None` where they are shaded one by one.
    pub(super) fn eight_colors(&self) -> Option<EightColors> {
        let is_parallel = self.camera.projection().is_parallel();
        let shows_ground = self.ground.is_some() && is_parallel;
        let bends_lines = self.needs.edges && self.is_panoramic();
        if shows_ground || bends_lines || self.lines.overlay.is_some() || self.has_many_eyes() {
            return None;
        }
        match self.shading.mode {
            Mode::Color | Mode::Texture => Some(EightColors::Own),
            Mode::Flat => Some(EightColors::Flat),
            Mode::Smooth => Some(EightColors::Smooth),
            // Images of metal and roughness are read one by one.
            Mode::Material if !self.needs.uvs => Some(EightColors::Material),
            Mode::Normals => Some(EightColors::Normals),
            Mode::Depth if self.depth.are_grey() => Some(EightColors::Depth),
            Mode::Barycentric => Some(EightColors::Barycentric),
            Mode::Uv => Some(EightColors::Uv),
            Mode::Wireframe if self.background.is_some() => Some(EightColors::Lines),
            _ => None,
        }
    }

    /// sRGB greys of eight distances in the depth mode, 0 to 1.
    #[inline(always)]
    pub(super) fn eight_greys<L: Lanes>(&self, lanes: L, t: L::F32) -> L::F32 {
        self.depth.eight_greys(lanes, t)
    }

    /// The light on eight pixels of a row whose triangles and weights are known.
    #[inline(always)]
    pub(super) fn light<L: Lanes>(
        &self,
        lanes: L,
        facets: &Facets<L>,
        weights: Option<(&Row, &Row)>,
        to_eye: Vectors<L>,
    ) -> Vectors<L> {
        smooth::light(lanes, facets, &self.lights, weights, to_eye)
    }

    /// Unit vectors to the eye from what eight pixels of a row of a planar picture show.
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

    /// How much of textures shows on objects that do not set it.
    pub(super) fn blend(&self) -> f32 {
        self.shading.blend
    }

    /// The texture on a triangle that has a mapping.
    #[inline(always)]
    pub(super) fn texture_on(&self, facet: &Facet) -> Option<&'a Texture> {
        self.scene.objects[facet.object as usize].texture_on(facet.triangle)
    }

    /// What the mode asks of each triangle.
    pub(super) fn needs(&self) -> Needs {
        self.needs
    }

    /// Whether the picture is no plane.
    pub(super) fn is_panoramic(&self) -> bool {
        self.camera.projection().panorama().is_some()
    }

    /// Makes the pixels of a row that the picture has no place for transparent; the first is in column `left`.
    pub(super) fn clear_beyond(&self, left: u32, y: u32, pixels: &mut [[u8; 4]]) {
        if !self.is_panoramic() || pixels.is_empty() {
            return;
        }
        let (first, y) = (f64::from(left) + 0.5, f64::from(y) + 0.5);
        let last = first + (pixels.len() - 1) as f64;
        if self.camera.has_all_between(first, last, y) {
            return;
        }
        for (number, pixels) in pixels.chunks_mut(LANES).enumerate() {
            let x = first + (number * LANES) as f64;
            let has = self.camera.has_eight_places(x, y);
            for (pixel, has) in pixels.iter_mut().zip(has) {
                if !has {
                    *pixel = [0; 4];
                }
            }
        }
    }

    /// What shows at a place of the picture whose ray hits nothing: what lies behind everything, and lines over it;
    /// nothing where it has no such place.
    pub(crate) fn behind(&self, x: f64, y: f64) -> [f32; 4] {
        if self.camera.has_place(x, y) {
            let behind = self.grounded(x, y, f32::INFINITY, self.backdrop(y));
            let behind = self.lines.seen_through(x, y, behind);
            self.lines.outlined(x, y, f32::INFINITY, behind)
        } else {
            [0.0; 4]
        }
    }

    /// [`Shader::behind`] at a height in the picture, where that is the same in all of its width.
    pub(crate) fn behind_row(&self, y: f64) -> Option<[f32; 4]> {
        (!self.has_overlay() && !self.is_panoramic()).then(|| self.backdrop(y))
    }

    /// The ground over what lies behind it, at `t`.
    fn grounded(&self, x: f64, y: f64, t: f32, behind: [f32; 4]) -> [f32; 4] {
        match &self.ground {
            Some(ground) => ground.over(&self.camera, (x, y), t, behind),
            None => behind,
        }
    }

    /// What lies behind everything at a height in the picture.
    pub(super) fn backdrop(&self, y: f64) -> [f32; 4] {
        let Some([top, bottom]) = self.background else {
            return [0.0; 4];
        };
        let (first, rows) = self.camera.own_rows();
        let down = ((y - first) / rows).clamp(0.0, 1.0) as f32;
        opaque(top + (bottom - top) * down)
    }

    /// A triangle made ready for its pixels, at `x`.
    fn facet(&self, primitive: u32, needs: Needs, x: f64) -> Facet {
        let mut facet = Facet::NONE;
        self.make_ready(&mut facet, primitive, needs, x);
        facet
    }

    /// Makes a triangle ready in the place of another with the same needs, for pixels at `x` or, where they have one eye,
    /// for all: what the needs do not ask for is not touched.
    pub(super) fn make_ready(&self, facet: &mut Facet, primitive: u32, needs: Needs, x: f64) {
        let (number, triangle) = self.accel.identify(primitive);
        let object = &self.scene.objects[number as usize];
        facet.object = number;
        if needs.normal || needs.middle || needs.edges || needs.ground {
            let corners = self.corners(primitive, x);
            if needs.normal {
                facet.normal = self.normal(corners);
            }
            if needs.middle {
                facet.to_eye = self.middle_to_eye(corners);
            }
            if let (true, Some(ground)) = (needs.ground, &self.ground) {
                let origin = self.accel.origin().y;
                facet.shows_ground = !ground.is_hidden_by(self.eye.y, origin, corners);
            }
            if needs.edges {
                // Where the picture is no plane, `color_on` has them at each place.
                let edges = EdgeLines::new(&self.camera, corners);
                facet.edges = Some(match &self.lines.choice {
                    None => edges,
                    Some(choice) => edges.chosen(choice.styles(number, triangle)),
                });
            }
        }
        if needs.smooth {
            facet.normals = self.smooth_normals(number, object, triangle);
        }
        if needs.color {
            let place = || self.placed(number, primitive, x);
            facet.color = self.own_colors.of_triangle(number, object, triangle, place);
        }
        if needs.varied {
            let place = || self.placed(number, primitive, x);
            facet.varied = self.own_colors.within(number, object, triangle, place);
        }
        if needs.texture {
            facet.triangle = triangle;
            facet.is_tinted = object.is_tinted(triangle);
            facet.texture = object.texture_on(triangle).and_then(|_| {
                let in_world = || self.accel.corners(primitive);
                self.texturing.mapping(number, object, triangle, in_world)
            });
            facet.blends = object.blend_numbers(triangle);
        }
        if needs.reflectance {
            facet.material = object.reflecting_material(triangle);
        }
        if needs.uvs {
            facet.uvs = object.mesh.corner_uvs(triangle);
        }
        if let Some(color) = self.back_color(primitive, x) {
            facet.color = color;
            facet.varied = Varied::No;
            facet.texture = None;
        }
    }

    /// The colour of a triangle that is seen from behind, where backs have their own.
    #[inline(always)]
    fn back_color(&self, primitive: u32, x: f64) -> Option<Vec3> {
        let (sides, color) = self.backs.as_ref()?;
        let of_column = (self.has_many_eyes())
            .then(|| Sides::new(&self.camera.seen_at(x, 0.0), self.accel.origin()));
        let sides = of_column.as_ref().unwrap_or(sides);
        let is_back = sides.is_back(self.accel.corners(primitive));
        is_back.then_some(*color)
    }

    /// A triangle's corners, relative to the eye of the pixels at `x`.
    fn corners(&self, primitive: u32, x: f64) -> [DVec3; 3] {
        let [a, b, c] = self.accel.corners(primitive);
        let eye = self.eye_at(x);
        let from_eye = |corner: Vec3| corner.as_dvec3() - eye;
        [from_eye(a), from_eye(b), from_eye(c)]
    }

    /// A triangle in its place, for rules that ask for it.
    fn placed(&self, number: u32, primitive: u32, x: f64) -> Placed {
        Placed {
            corners: self.corners(primitive, x),
            camera: self.camera.seen_at(x, 0.0),
            world_normals: self.world_normals.get(number as usize).copied().flatten(),
        }
    }

    /// The unit normal of a triangle with these corners, relative to the eye; of one without area, the
    /// way back to the eye.
    #[inline(always)]
    fn normal(&self, corners: [DVec3; 3]) -> Vec3 {
        let forward = self.camera.forward();
        let orthographic = self.camera.projection().is_parallel();
        let normal = facing_normal(corners, orthographic.then_some(forward));
        if normal == Vec3::ZERO {
            -forward.as_vec3()
        } else {
            normal
        }
    }

    /// The unit vector to the eye from the middle of a triangle with these corners, relative to the eye.
    #[inline(always)]
    fn middle_to_eye(&self, [a, b, c]: [DVec3; 3]) -> Vec3 {
        match self.camera.projection() {
            Projection::Orthographic => -self.camera.forward().as_vec3(),
            Projection::Perspective | Projection::Panoramic(_) => {
                -unit((a + b + c) / 3.0).as_vec3()
            }
        }
    }

    /// [`Shader::color`] where all pixels of a triangle have one colour: the same, with nothing made
    /// ready that a single answer does not need.
    pub(super) fn constant_color(&self, primitive: u32) -> [f32; 4] {
        if self.shading.mode == Mode::Normals {
            let normal = self.normal(self.corners(primitive, 0.0));
            return self.displayed(normal * 0.5 + 0.5);
        }
        let (number, triangle) = self.accel.identify(primitive);
        let object = &self.scene.objects[number as usize];
        let place = || self.placed(number, primitive, 0.0);
        let color = match self.back_color(primitive, 0.0) {
            Some(color) => color,
            None => (self.own_colors).of_triangle(number, object, triangle, place),
        };
        if matches!(self.shading.mode, Mode::Color | Mode::Texture) {
            return opaque(color);
        }
        let corners = self.corners(primitive, 0.0);
        let light = self
            .lights
            .on(self.normal(corners), self.middle_to_eye(corners));
        opaque(color * light)
    }

    /// The normals between which light is worked out, at a triangle's corners, in world space.
    fn smooth_normals(&self, number: u32, object: &Object, triangle: u32) -> Option<[Vec3; 3]> {
        let normals = match self.creased.get(number as usize) {
            Some(Some(creased)) => creased.corners(triangle, [u32::MAX; 3]),
            _ => object.mesh.corner_normals(triangle),
        };
        self.normals_in_world(number, normals)
    }

    /// An object's normals in world space.
    fn normals_in_world(&self, number: u32, normals: Option<[Vec3; 3]>) -> Option<[Vec3; 3]> {
        let world_from_object = self.world_normals.get(number as usize).copied().flatten()?;
        Some(normals?.map(|normal| (world_from_object * normal).normalize_or_zero()))
    }

    /// The colour of a sample on a triangle: linear light, alpha not multiplied in.
    pub(super) fn color_on(&self, facet: &Facet, x: f64, y: f64, hit: &PrimitiveHit) -> [f32; 4] {
        let color = self.with_lines(facet, x, y, hit);
        // Where surfaces let through what lies behind them, the ground lies behind all.
        if self.translucent.is_some() {
            color
        } else {
            self.grounded(x, y, hit.t, color)
        }
    }

    /// The colour of a sample on a triangle and the lines over it.
    fn with_lines(&self, facet: &Facet, x: f64, y: f64, hit: &PrimitiveHit) -> [f32; 4] {
        let inside = self.inside(facet, x, y, hit);
        let Some(edges) = &facet.edges else {
            return inside;
        };
        let lines = &self.lines;
        if self.is_panoramic() {
            let corners = self.corners(hit.primitive, x);
            let edges = EdgeLines::at(&self.camera, corners, (x, y)).chosen_as(edges);
            return lines.over(edges.coverage(x, y, lines.width), inside);
        }
        let inside = lines.seen_through(x, y, inside);
        let lined = lines.over(edges.coverage(x, y, lines.width), inside);
        lines.outlined(x, y, hit.t, lined)
    }

    /// The colour of a sample on a triangle, without lines.
    fn inside(&self, facet: &Facet, x: f64, y: f64, hit: &PrimitiveHit) -> [f32; 4] {
        match self.shading.mode {
            Mode::Color => opaque(self.own_color(facet, hit.u, hit.v)),
            Mode::Texture => opaque(self.surface_color(facet, || (x, y), hit)),
            Mode::Flat => {
                opaque(self.surface_color(facet, || (x, y), hit) * self.flat_light(facet))
            }
            Mode::Smooth | Mode::XRay => {
                let to_eye = self.to_eye_at(x, y);
                let light = self.lights.on(facet.normal_at(hit.u, hit.v), to_eye);
                opaque(self.surface_color(facet, || (x, y), hit) * light)
            }
            Mode::Material => opaque(self.reflected(facet, (x, y), hit)),
            Mode::Normals => self.displayed(facet.normal_at(hit.u, hit.v) * 0.5 + 0.5),
            Mode::Depth => opaque(self.depth.at(hit.t, self.tables)),
            Mode::Barycentric => self.displayed(Vec3::new(1.0 - hit.u - hit.v, hit.u, hit.v)),
            Mode::Uv => {
                let uv = facet.uvs.map_or(Vec2::ZERO, |uvs| blend(uvs, hit.u, hit.v));
                let uv = uv - uv.floor();
                self.displayed(Vec3::new(uv.x, uv.y, 0.25))
            }
            Mode::Wireframe => self.backdrop(y),
        }
    }

    /// The light on all of a triangle.
    pub(super) fn flat_light(&self, facet: &Facet) -> Vec3 {
        self.lights.on(facet.normal, facet.to_eye)
    }

    /// A colour that is meant as sRGB, 0 to 1.
    fn displayed(&self, value: Vec3) -> [f32; 4] {
        opaque(value.to_array().map(|v| self.tables.display(v)).into())
    }

    /// What a material sends back, and its own light.
    fn reflected(&self, facet: &Facet, (x, y): (f64, f64), hit: &PrimitiveHit) -> Vec3 {
        let base = self.surface_color(facet, || (x, y), hit);
        let PlainReflectance {
            mut factors,
            mut emission,
            is_unlit,
        } = self.plain_reflectance(facet);
        if is_unlit {
            return base;
        }
        if let Some(material) = self.reflectance(facet) {
            (factors, emission) = self.texturing.reflectance(material, facet.uvs, hit);
        }
        let [metallic, roughness] = factors;
        let surface = Surface {
            base,
            metallic,
            roughness,
        };
        let to_eye = self.to_eye_at(x, y);
        let normal = facet.normal_at(hit.u, hit.v);
        reflection::reflected(&self.lights, surface, normal, to_eye) + emission
    }

    /// How a triangle's material reflects light, where the mesh says it.
    fn reflectance(&self, facet: &Facet) -> Option<&Reflectance> {
        let materials = self.scene.objects[facet.object as usize].mesh.materials();
        let material = materials.get(facet.material? as usize)?;
        material.reflectance.as_deref()
    }

    /// How a triangle's material reflects light, without its images.
    pub(super) fn plain_reflectance(&self, facet: &Facet) -> PlainReflectance {
        let default = Reflectance::default();
        let material = self.reflectance(facet);
        let &Reflectance {
            metallic,
            roughness,
            emission,
            is_unlit,
            ..
        } = material.unwrap_or(&default);
        PlainReflectance {
            // What a mesh says is held to its range; the default is within it.
            factors: [metallic, roughness].map(|factor| factor.clamp(0.0, 1.0)),
            emission: match material {
                Some(_) => Vec3::from(emission),
                None => Vec3::ZERO,
            },
            is_unlit,
        }
    }

    /// What eight surfaces send back.
    #[inline(always)]
    pub(super) fn eight_reflected<L: Lanes>(
        &self,
        lanes: L,
        surfaces: &Surfaces<L>,
        normal: Vectors<L>,
        to_eye: Vectors<L>,
    ) -> Vectors<L> {
        reflection::eight_reflected(lanes, &self.lights, surfaces, normal, to_eye)
    }

    /// The unit vector from a sample to the eye.
    fn to_eye_at(&self, x: f64, y: f64) -> Vec3 {
        if self.is_panoramic() {
            return -unit(self.camera.direction(x, y)).as_vec3();
        }
        let [corner, right, down] = self.to_eye;
        let to_eye = corner + right * x as f32 + down * y as f32;
        to_eye * (1.0 / to_eye.length())
    }

    /// The triangle's own colour at barycentrics (u, v): linear light.
    #[inline(always)]
    pub(super) fn own_color(&self, facet: &Facet, u: f32, v: f32) -> Vec3 {
        match &facet.varied {
            Varied::No => facet.color,
            Varied::Colors(colors) => blend(*colors, u, v),
            varied => self.own_colors.of_number(facet.object, varied, u, v),
        }
    }

    /// The triangle's colour and its texture, mixed in linear light, at the sample that `place` gives.
    #[inline]
    pub(super) fn surface_color(
        &self,
        facet: &Facet,
        place: impl FnOnce() -> (f64, f64),
        hit: &PrimitiveHit,
    ) -> Vec3 {
        let color = self.own_color(facet, hit.u, hit.v);
        let Some(mapping) = &facet.texture else {
            return color;
        };
        let Some(texture) = self.texture_on(facet) else {
            return color;
        };
        let texture = (facet.object, texture);
        let [r, g, b, a] = if self.shading.filter.has_footprint() {
            self.filtered(texture, mapping, place(), hit)
        } else {
            self.texturing.sampled(texture, mapping, hit)
        };
        let blend = self.shading.blend * facet.blend_at(hit.u, hit.v);
        let texel = Vec3::new(r, g, b);
        let texel = if facet.is_tinted {
            texel * color
        } else {
            texel
        };
        color * (1.0 - a * blend) + texel * blend
    }

    /// Whether any hit's colour depends on [`TileShader::taken_from`](super::TileShader::taken_from).
    pub(crate) fn has_photographs(&self) -> bool {
        self.texturing.has_photographs()
    }

    /// Where the texture was taken that a hit on a triangle shows if it is seen from there.
    pub(super) fn taken_from(&self, facet: &Facet, hit: &PrimitiveHit) -> Option<DVec3> {
        let mapping = facet.texture.as_ref()?;
        let texture = self.texture_on(facet)?;
        self.texturing
            .taken_from((facet.object, texture), mapping, hit)
    }

    /// The texture's colour over what the sample at a place sees of it.
    #[inline(never)]
    fn filtered(
        &self,
        texture: (u32, &Texture),
        mapping: &Mapping,
        place: (f64, f64),
        hit: &PrimitiveHit,
    ) -> [f32; 4] {
        let corners = self.corners(hit.primitive, place.0);
        let slopes = slopes(&self.camera, corners, place, (hit.u, hit.v));
        let slopes = slopes.map(|slope| slope * self.sample_width);
        self.texturing.filtered(texture, mapping, hit, slopes)
    }
}

/// Whether a mode shows the objects' own colours.
fn is_colored(mode: Mode) -> bool {
    matches!(
        mode,
        Mode::Color | Mode::Flat | Mode::Smooth | Mode::Material | Mode::Texture | Mode::XRay
    )
}

/// What a picture's mode asks of triangles.
fn needs(scene: &Scene, shading: &Shading, own_colors: &OwnColors) -> Needs {
    let colored = is_colored(shading.mode);
    let has_normals = || {
        let mut objects = scene.objects.iter();
        shading.is_creased() || objects.any(|object| object.mesh.has_normals())
    };
    let reflects = shading.mode == Mode::Material;
    let has_images = || {
        let mut objects = scene.objects.iter();
        objects.any(|object| {
            let mut materials = object.mesh.materials().iter();
            let has_images = |known: &Arc<Reflectance>| known.has_textures();
            materials.any(|material| material.reflectance.as_ref().is_some_and(has_images))
        })
    };
    let has_texture = || scene.objects.iter().any(Object::has_texture);
    Needs {
        normal: shading.mode == Mode::Flat || shading.mode.shows_normals(),
        middle: shading.mode == Mode::Flat,
        smooth: shading.mode.shows_normals() && has_normals(),
        color: colored,
        varied: colored && own_colors.vary,
        texture: colored && shading.mode != Mode::Color && shading.blend > 0.0 && has_texture(),
        uvs: shading.mode == Mode::Uv || reflects && has_images(),
        reflectance: reflects,
        edges: shading.wireframe.is_some() || shading.mode == Mode::Wireframe,
        ground: false,
    }
}

/// For each object without normals, those of the crease angle; nothing where the mode or the angle asks for none.
fn creased(scene: &Scene, shading: &Shading) -> Vec<Option<Arc<Attribute<Vec3>>>> {
    if !shading.is_creased() {
        return Vec::new();
    }
    let normals = |object: &Object| {
        let has_none = object.visible && !object.mesh.has_normals();
        has_none.then(|| object.mesh.creased(shading.crease))
    };
    scene.objects.iter().map(normals).collect()
}

/// For each object, world-space normals from its own: the inverse transpose.
fn world_normals(scene: &Scene) -> Vec<Option<Mat3>> {
    let transforms = scene
        .world_from_objects()
        .unwrap_or_else(|_| vec![DAffine3::IDENTITY; scene.objects.len()]);
    transforms
        .iter()
        .map(|world_from_object| {
            // Its scale does not matter: normals are made unit length. Dividing by the largest
            // entry keeps it in the range of single precision.
            let normal_matrix = world_from_object.matrix3.inverse().transpose();
            let largest = normal_matrix
                .to_cols_array()
                .into_iter()
                .fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
            (normal_matrix.is_finite() && largest > 0.0)
                .then(|| DMat3::as_mat3(&(normal_matrix * (1.0 / largest))))
        })
        .collect()
}

/// From hits to the eye: through the picture's corner, and what a pixel to the right and down adds. Nothing where the
/// picture is no plane.
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
