//! What a pixel should show, worked out on a path of its own: from the oracle's hit, one pixel at a time,
//! by the formulas that the shader documents, as ranges that hold whatever rounding may have made of
//! them. It shares the scene with the shader, and none of its code.
//!
//! Lines along edges are left out: a hit under lines has no known colour.

mod crease;
mod light;
mod mask;
mod normal;
mod own_color;
mod photograph;
mod range;
mod reflection;
mod section;
mod srgb;
mod texture;

pub(crate) use mask::seen;
pub(crate) use range::Single;

use crate::stage::Stage;
use crate::wrong_answer::{GRAZING, T_BOUND, UV_BOUND, WrongAnswer, ulp};
use crease::Creased;
use light::Lights;
use normal::ToWorld;
use own_color::Numbers;
use photograph::Place;
use range::{Double, Vector, exactly, exactly_single, minus, plus};
use raycast_core::Cull;
use raycast_core::camera::{Camera, Projection, Rect, StereoKind};
use raycast_core::glam::DVec3;
use raycast_core::scene::{ColorRule, Object, Opacity, Reflectance, Texture, Wrap};
use raycast_core::shade::{
    Background, Filter, Legend, Mode, Shading, TextureProjection, Wireframe,
};
use raycast_oracle::Truth;
use rayon::prelude::*;
use std::sync::Arc;
use texture::Repeat;

/// sRGB grey at the near and the far end of the depth mode.
const NEAR_GREY: f64 = 0.96;
const FAR_GREY: f64 = 0.08;

/// What pixels of one picture should show.
#[derive(Clone)]
pub(crate) struct Expected<'a> {
    stage: &'a Stage,
    camera: Camera,
    shading: Shading,
    lights: Lights,
    /// For each object without normals, those of the crease angle, where light goes by them.
    creased: Arc<[Option<Creased<'a>>]>,
    /// For each object, what takes its mesh's normals to the world.
    to_world: Vec<Option<ToWorld>>,
    /// For each object with a texture, how that lies on it where it has no place of its own.
    repeats: Vec<Option<Repeat>>,
    /// The distance at which the depth mode begins, and one over how far it reaches.
    depth: [Single; 2],
    /// The range of the depth mode's colours, where it is through a map.
    depth_map: Option<[Double; 2]>,
    /// The colours of numbers.
    numbers: Numbers,
    /// What the legend covers, of which nothing is known.
    legend: Option<Rect>,
    /// Whether sections are filled: fronts and backs are seen.
    has_sections: bool,
    cull: Cull,
    /// The first row of the eye's picture, and how many it has: those of what lies behind everything.
    rows: (f64, f64),
}

/// The first row of a camera's part of the whole picture, and how many it has.
fn rows_of(whole: &Camera, camera: &Camera) -> (f64, f64) {
    let halves = whole.halves().into_iter().flatten();
    let own = halves.into_iter().find(|(half, _)| half == camera);
    own.map_or((0.0, whole.plane().rows.into()), |(_, rect)| {
        (rect.y.into(), rect.height.into())
    })
}

/// Whether neighbouring pixels share an eye.
fn shares_eyes(camera: &Camera) -> bool {
    let stereo = camera.stereo();
    stereo.is_none_or(|stereo| stereo.kind == StereoKind::Pair)
}

/// The direction of a surface, and its texture coordinates.
pub(crate) type Surface = ([Single; 3], [Single; 2]);

/// A hit of the oracle's, with what the shader may know of it.
struct Hit<'a> {
    object: &'a Object,
    number: u32,
    triangle: u32,
    /// Corners as seen from the eye.
    corners: [Vector<53>; 3],
    weights: [Single; 3],
    t: Single,
}

impl<'a> Expected<'a> {
    /// Of what a camera sees, all of a whole picture's or an eye's half of it.
    pub(crate) fn new(
        stage: &'a Stage,
        (whole, camera): (Camera, Camera),
        shading: Shading,
        cull: Cull,
    ) -> Self {
        let to_world = match stage.scene.world_from_objects() {
            Ok(transforms) => transforms.iter().map(ToWorld::new).collect(),
            Err(_) => Vec::new(),
        };
        let depth = if shading.mode == Mode::Depth {
            depth_range(stage, &camera)
        } else {
            [Single::UNKNOWN; 2]
        };
        let numbers = Numbers::new(stage, &camera, &shading);
        let is_mapped = shading.mode == Mode::Depth && shading.scale.is_some();
        let seen = || depths_seen(stage, &whole, cull);
        let depth_map = is_mapped
            .then(|| numbers.given_range().or_else(seen))
            .flatten();
        let plane = camera.plane();
        let has_legend = shading.scale.is_some_and(|scale| scale.legend);
        let legend = has_legend
            .then(|| Legend::place(plane.columns, plane.rows))
            .flatten();
        let repeat = |object: &Object| object.has_texture().then(|| Repeat::of(&object.mesh));
        Self {
            stage,
            camera,
            shading,
            lights: Lights::new(&camera, shading.lights),
            creased: creased(stage, &shading).into(),
            to_world,
            repeats: stage.scene.objects.iter().map(repeat).collect(),
            depth,
            depth_map,
            numbers,
            legend,
            has_sections: cull == Cull::None && shares_eyes(&whole),
            rows: rows_of(&whole, &camera),
            cull,
        }
    }

    /// Whose rays they are.
    pub(crate) fn camera(&self) -> Camera {
        self.camera
    }

    /// From now on of a place that another eye sees, by the same colours.
    pub(crate) fn look_from(&mut self, camera: &Camera) {
        self.camera = *camera;
    }

    /// What a picture's layers should tell of a hit.
    pub(crate) fn surface(&self, truth: &Truth) -> Surface {
        let Some(hit) = self.hit(truth) else {
            return ([Single::UNKNOWN; 3], [Single::UNKNOWN; 2]);
        };
        let uv = match hit.object.mesh.corner_uvs(hit.triangle) {
            None => [Single::exactly(0.0); 2],
            Some(uvs) => texture::blended(uvs, hit.weights),
        };
        (self.normal(&hit), uv)
    }

    /// Whether lines may show where nothing is hit.
    fn has_lines_beyond(&self) -> bool {
        let lines = self.shading.wireframe;
        let is_beyond = |lines: &Wireframe| lines.hidden > 0.0 || lines.edges.silhouette;
        self.shading.ground.is_some() || lines.as_ref().is_some_and(is_beyond)
    }

    /// The colour of the sample at (x, y) of the picture, in pixels from its top left corner, where its
    /// ray hits `truth`: linear light, alpha not multiplied in. Unknown where it is undecided.
    pub(crate) fn color(&self, x: f64, y: f64, truth: Option<&Truth>) -> [Single; 4] {
        let opaque = |[r, g, b]: Vector<24>| [r, g, b, Single::exactly(1.0)];
        if self.legend.is_some_and(|legend| is_in(legend, x, y)) {
            return [Single::UNKNOWN; 4];
        }
        let lines = self.shading.wireframe.is_some()
            || self.shading.mode == Mode::Wireframe
            || self.shading.ground.is_some();
        let section = || section::color(self.stage, &self.camera, self.shading.mode, (x, y), truth);
        let is_cut = self.has_sections && self.stage.clip().enabled().next().is_some();
        if is_cut && self.stage.has_masks() {
            // Sections behind masks are not worked out a second time.
            return [Single::UNKNOWN; 4];
        }
        let cut = self.has_sections.then(section).flatten();
        let Some(truth) = truth else {
            if !self.camera.has_place(x, y) {
                return [Single::exactly(0.0); 4];
            }
            if self.has_lines_beyond() {
                return [Single::UNKNOWN; 4];
            }
            return cut.map_or_else(|| self.backdrop(y), opaque);
        };
        let Some(hit) = self.hit(truth).filter(|_| !lines) else {
            return [Single::UNKNOWN; 4];
        };
        if let Some(cut) = cut {
            return opaque(cut);
        }
        let mesh = &hit.object.mesh;
        let is_blended = matches!(mesh.opacity(hit.triangle), Opacity::Blend(_));
        if is_blended
            && !matches!(
                self.shading.mode,
                Mode::Normals | Mode::Depth | Mode::Barycentric | Mode::Uv
            )
        {
            // Layers are not composited a second time.
            return [Single::UNKNOWN; 4];
        }
        // A back is what culling drops.
        let back = self.shading.back_faces.filter(|_| {
            let ray = self.camera.ray(x, y);
            let numbers = (truth.object, truth.triangle);
            self.stage.intersect(numbers, &ray, Cull::Back).is_none()
        });
        let surface_color = || match back {
            Some(color) => srgb::linear(color),
            None => self.surface_color(&hit),
        };
        let lit = |light: Vector<24>| {
            let color = surface_color();
            std::array::from_fn(|i| color[i] * light[i])
        };
        let number = Single::exactly;
        opaque(match self.shading.mode {
            Mode::Color => back.map_or_else(|| self.own_color(&hit), srgb::linear),
            Mode::Texture => surface_color(),
            Mode::Flat => {
                let normal = normal::flat(&self.camera, hit.corners);
                let to_eye = normal::middle_to_eye(&self.camera, hit.corners);
                lit(self.lights.on(normal, to_eye))
            }
            Mode::Smooth => {
                let to_eye = light::to_eye(&self.camera, x, y);
                lit(self.lights.on(self.shown_normal(&hit), to_eye))
            }
            Mode::Material => self.reflected(&hit, (x, y)),
            Mode::Normals => {
                let half = number(0.5);
                self.shown_normal(&hit)
                    .map(|n| srgb::displayed(n * half + half))
            }
            Mode::Depth => match (self.depth_map, self.shading.scale) {
                (Some(range), _) => self.numbers.color(hit.t.to(), range),
                (None, Some(_)) => [Single::UNKNOWN; 3],
                (None, None) => [srgb::displayed(self.grey(hit.t)); 3],
            },
            Mode::Barycentric => hit.weights.map(srgb::displayed),
            Mode::Uv => {
                let uv = match hit.object.mesh.corner_uvs(hit.triangle) {
                    None => [number(0.0); 2],
                    Some(uvs) => texture::blended(uvs, hit.weights),
                };
                let [u, v] = uv.map(fraction);
                [u, v, number(0.25)].map(srgb::displayed)
            }
            Mode::Wireframe | Mode::XRay => [Single::UNKNOWN; 3],
        })
    }

    /// What lies behind everything: from one colour at the picture's top to another at its bottom.
    fn backdrop(&self, y: f64) -> [Single; 4] {
        let Background::Gradient(top, bottom) = self.shading.background else {
            return [Single::exactly(0.0); 4];
        };
        let (first, rows) = self.rows;
        let down = ((y - first) / rows).clamp(0.0, 1.0);
        let down = Single::exactly(down).rounded();
        let (top, bottom) = (srgb::linear(top), srgb::linear(bottom));
        let [r, g, b]: Vector<24> = std::array::from_fn(|i| top[i] + (bottom[i] - top[i]) * down);
        [r, g, b, Single::exactly(1.0)]
    }

    /// A hit with its corners seen from the eye, and as far as its weights and distance are known: within
    /// the bounds that the project promises, where the ray does not graze the triangle.
    fn hit(&self, truth: &Truth) -> Option<Hit<'_>> {
        let object = self.stage.scene.objects.get(truth.object as usize)?;
        let triangle = self.stage.oracle.triangle(truth.object, truth.triangle)?;
        let eye = minus(exactly(self.camera.placement().eye), exactly(triangle.base));
        let corners = triangle
            .corners
            .map(|corner| minus(exactly(corner.as_dvec3()), eye));
        let (u, v, t) = if truth.cosine > GRAZING {
            let t = Single::around(truth.t, T_BOUND * ulp(truth.t));
            let weight = |weight| Single::around(weight, UV_BOUND).max(0.0).min(1.0);
            (weight(truth.u), weight(truth.v), t)
        } else {
            (Single::UNKNOWN, Single::UNKNOWN, Single::UNKNOWN)
        };
        Some(Hit {
            object,
            number: truth.object,
            triangle: truth.triangle,
            corners,
            weights: normal::weights(u, v),
            t,
        })
    }

    /// The mesh's normal between corners where it has one, the triangle's own elsewhere.
    fn normal(&self, hit: &Hit<'_>) -> Vector<24> {
        let flat = normal::flat(&self.camera, hit.corners);
        match hit.object.mesh.corner_normals(hit.triangle) {
            None => flat,
            Some(normals) => {
                let to_world = self.to_world.get(hit.number as usize);
                let to_world = to_world.and_then(Option::as_ref);
                let normals = normals.map(exactly_single);
                normal::smooth(normals, to_world, hit.weights, flat)
            }
        }
    }

    /// The normal that light goes by: [`Expected::normal`], or that of the crease angle.
    fn shown_normal(&self, hit: &Hit<'_>) -> Vector<24> {
        let Some(Some(creased)) = self.creased.get(hit.number as usize) else {
            return self.normal(hit);
        };
        let flat = normal::flat(&self.camera, hit.corners);
        let to_world = self.to_world.get(hit.number as usize);
        let normals = creased.corner_normals(hit.triangle);
        normal::smooth(
            normals,
            to_world.and_then(Option::as_ref),
            hit.weights,
            flat,
        )
    }

    /// The object's colour at a hit, by its rule.
    fn own_color(&self, hit: &Hit<'_>) -> Vector<24> {
        let to_world = self.to_world.get(hit.number as usize);
        own_color::own_color(
            hit,
            &self.numbers,
            &self.camera,
            self.shading.mode,
            to_world.and_then(Option::as_ref),
        )
    }

    /// The triangle's colour and the texture, mixed in linear light.
    fn surface_color(&self, hit: &Hit<'_>) -> Vector<24> {
        let color = self.own_color(hit);
        let Some(texture) = hit.object.texture_on(hit.triangle) else {
            return color;
        };
        if self.shading.blend <= 0.0 {
            return color;
        }
        let mesh = &hit.object.mesh;
        let filter = self.shading.filter;
        let own = hit.object.mapping.projection;
        let projection = own.unwrap_or(self.shading.projection);
        let by_uv = match projection {
            TextureProjection::Uv => mesh.has_uvs(),
            TextureProjection::Camera => false,
            TextureProjection::Triplanar => false,
            // Not worked out a second time.
            TextureProjection::PerTriangle
            | TextureProjection::Plane
            | TextureProjection::Sphere
            | TextureProjection::Cylinder => return [Single::UNKNOWN; 3],
        };
        let is_photograph = projection == TextureProjection::Camera;
        if texture.wrap() != [Wrap::Repeat; 2] && !is_photograph
            || !matches!(filter, Filter::Nearest | Filter::Bilinear)
        {
            return [Single::UNKNOWN; 3];
        }
        let [r, g, b, a] = if is_photograph {
            let Some(taken) = &hit.object.mapping.photograph else {
                return color;
            };
            let numbers = (hit.number, hit.triangle);
            let stage = (self.stage, self.cull);
            match photograph::place(stage, numbers, hit.weights, taken, texture) {
                Place::None => return color,
                Place::At(place) => texture::sample(texture, place, filter),
                Place::Unknown => return [Single::UNKNOWN; 3],
            }
        } else if !by_uv {
            let Some(Some(repeat)) = self.repeats.get(hit.number as usize) else {
                return [Single::UNKNOWN; 3];
            };
            let surface = (&**mesh, repeat);
            texture::triplanar(surface, hit.triangle, hit.weights, texture, filter)
        } else {
            let Some(uvs) = mesh.corner_uvs(hit.triangle) else {
                return color;
            };
            let [_, u, v] = hit.weights;
            texture::sample(texture, texture::place(uvs, u, v), filter)
        };
        // What a file's material has of both is one colour: the image times that of the vertices.
        let of_material = hit
            .object
            .texture
            .is_none()
            .then(|| mesh.material(hit.triangle));
        let is_tinted = of_material
            .flatten()
            .is_some_and(|material| material.by_vertex);
        let [r, g, b] = match is_tinted {
            true => std::array::from_fn(|i| [r, g, b][i] * color[i]),
            false => [r, g, b],
        };
        let mut blend = Single::exactly(self.shading.blend.into());
        if let Some(numbers) = hit.object.blend_numbers(hit.triangle) {
            if !numbers.iter().all(|number| number.is_finite()) {
                return [Single::UNKNOWN; 3];
            }
            let corners = numbers.map(|number| [Single::exactly(number.into())]);
            let [share] = normal::blend(corners, hit.weights);
            blend = blend * share.max(0.0).min(1.0);
        }
        let rest = Single::exactly(1.0) - a * blend;
        plus(color.map(|c| c * rest), [r, g, b].map(|c| c * blend))
    }

    /// What a material sends back, and its own light.
    fn reflected(&self, hit: &Hit<'_>, (x, y): (f64, f64)) -> Vector<24> {
        let base = self.surface_color(hit);
        let mesh = &hit.object.mesh;
        let by_file = matches!(hit.object.color, ColorRule::File);
        let material = mesh.material(hit.triangle).filter(|_| by_file);
        let usual = Reflectance::default();
        let known = material.and_then(|material| material.reflectance.as_deref());
        let known = known.unwrap_or(&usual);
        if known.is_unlit {
            return base;
        }
        let filter = match self.shading.filter {
            Filter::Nearest => Filter::Nearest,
            _ => Filter::Bilinear,
        };
        let place = mesh.corner_uvs(hit.triangle).map(|uvs| {
            let [_, u, v] = hit.weights;
            texture::place(uvs, u, v)
        });
        let one = Single::exactly(1.0);
        let number = |factor: f32| Single::exactly(factor.into());
        // Images that are wrapped in other ways, or see-through, are not worked out a second time.
        let is_plain = |texture: &Texture| {
            texture.wrap() == [Wrap::Repeat; 2] && texture.texels().iter().all(|t| t[3] == 255)
        };
        let read = |texture: &Option<Arc<Texture>>, of: fn(u8) -> Single| -> Vector<24> {
            match (texture, place) {
                (Some(texture), Some(place)) if is_plain(texture) => {
                    let [r, g, b, a] = texture::sample_of(texture, place, filter, of);
                    [r, g, b].map(|channel| channel / a)
                }
                (Some(_), Some(_)) => [Single::UNKNOWN; 3],
                _ => [one; 3],
            }
        };
        let share = |byte: u8| Single::exactly(f64::from(byte) / 255.0).rounded();
        let [_, rough, metal] = read(&known.texture, share);
        let glow = read(&known.emission_texture, srgb::light_of);
        let shares = [
            number(known.metallic) * metal,
            number(known.roughness) * rough,
        ];
        let shares = shares.map(|share| share.max(0.0).min(1.0));
        let normal = self.shown_normal(hit);
        let to_eye = light::to_eye(&self.camera, x, y);
        let light = reflection::reflected(&self.lights, base, shares, normal, to_eye);
        std::array::from_fn(|i| light[i] + number(known.emission[i]) * glow[i])
    }

    /// Near is light, far is dark.
    fn grey(&self, t: Single) -> Single {
        let [near, per_unit] = self.depth;
        let share = ((t - near) * per_unit).max(0.0).min(1.0);
        let [near, far] = [NEAR_GREY, FAR_GREY].map(|grey| Single::exactly(grey).rounded());
        near + (far - near) * share
    }
}

/// For each object without normals, those of the crease angle; nothing where the mode shows none.
fn creased<'a>(stage: &'a Stage, shading: &Shading) -> Vec<Option<Creased<'a>>> {
    if !shading.is_creased() {
        return Vec::new();
    }
    let objects = stage.scene.objects.iter();
    let normals = objects.map(|object| {
        let has_none = object.visible && !object.mesh.has_normals();
        has_none.then(|| Creased::new(&object.mesh, shading.crease))
    });
    normals.collect()
}

/// Where the depth mode's greys begin, and one over how far they reach: over the scene's box; zero where they
/// reach nowhere.
fn depth_range(stage: &Stage, camera: &Camera) -> [Single; 2] {
    match distances(stage, camera, camera.placement().eye, true) {
        Some([near, far]) if far.low > near.high => {
            [near.to(), (Double::exactly(1.0) / (far - near)).to()]
        }
        _ => [Single::exactly(0.0); 2],
    }
}

/// From the scene's box's nearest point to its farthest corner, seen from a point; from the eye of an orthographic
/// camera along its rays. `None` without a box.
fn distances(stage: &Stage, camera: &Camera, from: DVec3, is_eye: bool) -> Option<[Double; 2]> {
    let bounds = stage.scene.bounds();
    if bounds.is_empty() {
        return None;
    }
    let along_rays = is_eye && camera.projection() == Projection::Orthographic;
    let distances = bounds.corners().map(|corner| match along_rays {
        true => (corner - from).dot(camera.forward()),
        false => corner.distance(from),
    });
    let far = distances.into_iter().fold(0.0, f64::max);
    let near = match along_rays {
        true => distances.into_iter().fold(far, f64::min).max(0.0),
        false => from.clamp(bounds.min, bounds.max).distance(from),
    };
    // Both distances are rounded a few times, each by 2⁻⁵³ of the numbers that went into them.
    let size = from.abs().max_element() + bounds.min.abs().max(bounds.max.abs()).max_element();
    let slack = size * 2f64.powi(-49);
    Some([near, far].map(|distance| Double::around(distance, slack)))
}

/// The nearest and the farthest hit of every 16th ray of the whole picture, both ways: what the depth mode's colours
/// are fitted to.
fn depths_seen(stage: &Stage, camera: &Camera, cull: Cull) -> Option<[Double; 2]> {
    let plane = camera.plane();
    // Every 16th, but no more than 256 along a side.
    let stride = plane.columns.max(plane.rows).div_ceil(256).max(16) as usize;
    let places: Vec<(u32, u32)> = (0..plane.rows)
        .step_by(stride)
        .flat_map(|y| (0..plane.columns).step_by(stride).map(move |x| (x, y)))
        .collect();
    let truths: Vec<f64> = places
        .into_par_iter()
        .filter_map(|(x, y)| {
            let ray = camera.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
            // What is not sure leaves the range open.
            match seen(stage, &ray, cull) {
                Some(truth) => truth.map(|truth| truth.t),
                None => Some(f64::NAN),
            }
        })
        .collect();
    if truths.iter().any(|t| t.is_nan()) {
        return None;
    }
    let near = truths.iter().copied().reduce(f64::min)?;
    let far = truths.into_iter().reduce(f64::max)?;
    Some([near, far].map(|t| Double::around(t, T_BOUND * ulp(t))))
}

/// Whether a place of the picture lies in a rectangle.
fn is_in(rect: Rect, x: f64, y: f64) -> bool {
    let within = |place: f64, from: u32, to: u32| (f64::from(from)..f64::from(to)).contains(&place);
    within(x, rect.x, rect.right()) && within(y, rect.y, rect.bottom())
}

/// What is left of numbers after whole ones: all of 0 to 1 where there is a whole number among them.
fn fraction(range: Single) -> Single {
    if !range.is_known() {
        return Single::UNKNOWN;
    }
    let whole = range.low.floor();
    if range.high.floor() > whole {
        return Single {
            low: 0.0,
            high: 1.0,
        };
    }
    range.each(|number| number - whole).rounded()
}

/// Whether an 8-bit pixel may show light that its samples have sent, alpha multiplied in; `None` where
/// that cannot be told.
pub(crate) fn shows(pixel: [u8; 4], [r, g, b, a]: [Single; 4]) -> Option<Result<(), WrongAnswer>> {
    if ![r, g, b, a].iter().all(|channel| channel.is_known()) {
        return None;
    }
    let check = |channel, found: u8, [low, high]: [u8; 2]| {
        if (low..=high).contains(&found) {
            Ok(())
        } else {
            Err(WrongAnswer::Channel {
                channel,
                found: found.into(),
                low: low.into(),
                high: high.into(),
            })
        }
    };
    let [red, green, blue, alpha] = pixel;
    let alpha_of = |alpha: f64| (alpha.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    if let Err(fault) = check("A", alpha, [alpha_of(a.low), alpha_of(a.high)]) {
        return Some(Err(fault));
    }
    for (channel, found, light) in [("R", red, r), ("G", green, g), ("B", blue, b)] {
        // What cannot be seen has no colour.
        let bytes = match alpha {
            0 => [0, 0],
            _ => srgb::bytes_of(light / a)?,
        };
        if let Err(fault) = check(channel, found, bytes) {
            return Some(Err(fault));
        }
    }
    Some(Ok(()))
}
