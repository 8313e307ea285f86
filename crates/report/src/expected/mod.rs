//! What a pixel should show, computed independently of the shader: from the oracle's hit, one pixel at a time, by the
//! formulas that the shader documents, in interval arithmetic that covers the shader's rounding. It shares the scene
//! with the shader, but none of its code.
//!
//! Lines along edges are not computed: the colour of a hit under lines is unknown.

mod crease;
mod depth;
mod layers;
mod light;
mod mask;
mod normal;
mod own_color;
mod photograph;
mod pixel;
mod range;
mod reflection;
mod section;
mod srgb;
mod surface_color;
mod texture;

pub(crate) use mask::closest_visible;
pub(crate) use pixel::shows;
pub(crate) use range::Single;

use crate::stage::Stage;
use crate::wrong_answer::{GRAZING, T_BOUND, UV_BOUND, ulp};
use crease::Creased;
use light::Lights;
use normal::ToWorld;
use own_color::Numbers;
use range::{Double, Vector, exactly, exactly_single, minus};
use raycast_core::Cull;
use raycast_core::camera::{Camera, Projection, Rect, StereoKind};
use raycast_core::glam::Vec3;
use raycast_core::scene::Object;
use raycast_core::shade::{Background, Legend, Mode, Shading, Wireframe};
use raycast_oracle::Truth;
use std::sync::Arc;
use texture::Repeat;

/// What the pixels of one picture should show.
#[derive(Clone)]
pub(crate) struct Expected<'a> {
    stage: &'a Stage,
    camera: Camera,
    shading: Shading,
    lights: Lights,
    /// For each object without normals, the normals of the crease angle, if lighting uses them.
    creased: Arc<[Option<Creased<'a>>]>,
    /// For each object, the map of its mesh's normals to world space.
    to_world: Vec<Option<ToWorld>>,
    /// For each object with a texture, the mapping of meshes without texture coordinates.
    repeats: Vec<Option<Repeat>>,
    /// The distance at which the depth mode's greys begin, and one over the range that they cover.
    depth: [Single; 2],
    /// The range of the depth mode's colour map, if it has one.
    depth_map: Option<[Double; 2]>,
    /// The colours of quantities.
    numbers: Numbers,
    /// The rectangle of the legend, in which colours are unknown.
    legend: Option<Rect>,
    /// Whether sections are filled: so where both faces are hit.
    has_sections: bool,
    cull: Cull,
    /// The first row of the eye's picture, and its number of rows, for the background.
    rows: (f64, f64),
}

/// The first row of a camera's part of the whole picture, and its number of rows.
fn rows_of(whole: &Camera, camera: &Camera) -> (f64, f64) {
    let halves = whole.halves().into_iter().flatten();
    let own = halves.into_iter().find(|(half, _)| half == camera);
    own.map_or((0.0, whole.plane().rows.into()), |(_, rect)| {
        (rect.y.into(), rect.height.into())
    })
}

/// Whether neighbouring pixels share an eye.
fn neighbours_share_eye(camera: &Camera) -> bool {
    let stereo = camera.stereo();
    stereo.is_none_or(|stereo| stereo.kind == StereoKind::Pair)
}

/// The normal of a surface, and its texture coordinates.
pub(crate) type Surface = ([Single; 3], [Single; 2]);

/// A hit of the oracle, with the ranges of what the shader computes from it.
struct Hit<'a> {
    object: &'a Object,
    number: u32,
    triangle: u32,
    /// Corners relative to the eye.
    corners: [Vector<53>; 3],
    weights: [Single; 3],
    t: Single,
}

impl<'a> Expected<'a> {
    /// For a camera's picture, which is the whole picture or an eye's half of it.
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
            depth::range(stage, &camera)
        } else {
            [Single::UNKNOWN; 2]
        };
        let numbers = Numbers::new(stage, &camera, &shading);
        let is_mapped = shading.mode == Mode::Depth && shading.scale.is_some();
        let visible_range = || depth::visible_range(stage, &whole, cull);
        let depth_map = is_mapped
            .then(|| numbers.given_range().or_else(visible_range))
            .flatten();
        let plane = camera.plane();
        let has_legend = shading.scale.is_some_and(|scale| scale.legend);
        let legend = has_legend
            .then(|| Legend::rect(plane.columns, plane.rows))
            .flatten();
        let repeat = |object: &Object| object.has_texture().then(|| Repeat::new(&object.mesh));
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
            has_sections: cull == Cull::None && neighbours_share_eye(&whole),
            rows: rows_of(&whole, &camera),
            cull,
        }
    }

    /// The camera of the picture.
    pub(crate) fn camera(&self) -> Camera {
        self.camera
    }

    /// Continues with another eye's camera and the same colours.
    pub(crate) fn set_camera(&mut self, camera: &Camera) {
        self.camera = *camera;
    }

    /// What a picture's layers should contain at a hit.
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
    /// ray hits `truth`: linear light, straight alpha. Unknown where it is undecided.
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
            // Sections behind masks are not computed independently.
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
        if self.shows_through(&hit) {
            // Sections behind translucent surfaces are not computed independently.
            return match is_cut && self.shading.mode != Mode::XRay {
                true => [Single::UNKNOWN; 4],
                false => self.composited(x, y),
            };
        }
        opaque(self.shown(&hit, truth, (x, y)))
    }

    /// The colour of a hit alone: linear light.
    fn shown(&self, hit: &Hit<'_>, truth: &Truth, (x, y): (f64, f64)) -> Vector<24> {
        // A back face is one that culling drops.
        let back = self.shading.back_faces.filter(|_| {
            let ray = self.camera.ray(x, y);
            let numbers = (truth.object, truth.triangle);
            self.stage.intersect(numbers, &ray, Cull::Back).is_none()
        });
        let surface_color = || match back {
            Some(color) => srgb::linear(color),
            None => self.surface_color(hit),
        };
        let lit = |light: Vector<24>| {
            let color = surface_color();
            std::array::from_fn(|i| color[i] * light[i])
        };
        let number = Single::exactly;
        match self.shading.mode {
            Mode::Color => back.map_or_else(|| self.own_color(hit), srgb::linear),
            Mode::Texture => surface_color(),
            Mode::Flat => {
                let normal = normal::flat(&self.camera, hit.corners);
                let to_eye = normal::middle_to_eye(&self.camera, hit.corners);
                lit(self.lights.on(normal, to_eye))
            }
            Mode::Smooth | Mode::XRay => {
                let to_eye = light::to_eye(&self.camera, x, y);
                lit(self.lights.on(self.shown_normal(hit), to_eye))
            }
            Mode::Material => self.reflected(hit, (x, y)),
            Mode::Normals => {
                let half = number(0.5);
                self.shown_normal(hit)
                    .map(|n| srgb::displayed(n * half + half))
            }
            Mode::Depth => match (self.depth_map, self.shading.scale) {
                (Some(range), _) => self.numbers.color(hit.t.to(), range),
                (None, Some(_)) => [Single::UNKNOWN; 3],
                (None, None) => [srgb::displayed(depth::grey(self.depth, hit.t)); 3],
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
            Mode::Wireframe => [Single::UNKNOWN; 3],
        }
    }

    /// The background: a gradient from the picture's top to its bottom.
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

    /// A hit with its corners relative to the eye. Weights and distance are known within the bounds that the project
    /// promises where the ray does not graze the triangle, and unknown elsewhere.
    fn hit(&self, truth: &Truth) -> Option<Hit<'_>> {
        let object = self.stage.scene.objects.get(truth.object as usize)?;
        let triangle = self.stage.oracle.triangle(truth.object, truth.triangle)?;
        let eye = minus(exactly(self.camera.pose().eye), exactly(triangle.base));
        let corners = triangle
            .corners
            .map(|corner| minus(exactly(corner.as_dvec3()), eye));
        let (u, v, t) = if truth.cosine > GRAZING {
            // Colours take parallel rays' distances from functions whose error grows with the triangle.
            let slack = match self.camera.projection() {
                Projection::Orthographic => edge(triangle.corners) * 2f64.powi(-25),
                _ => 0.0,
            };
            let t = Single::around(truth.t, T_BOUND * ulp(truth.t) + slack);
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

    /// The mesh's interpolated normal where it has one, the triangle's own elsewhere.
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

    /// The normal that lighting uses: [`Expected::normal`], or that of the crease angle.
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
}

/// For each object without normals, those of the crease angle; empty where the mode uses no normals.
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

/// The greatest coordinate of a triangle's edges.
fn edge([a, b, c]: [Vec3; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
    let edges = [b - a, c - b, a - c];
    let longest = edges.map(|edge| edge.abs().max_element());
    longest.into_iter().fold(0.0, f64::max)
}

/// Whether a point of the picture lies in a rectangle.
fn is_in(rect: Rect, x: f64, y: f64) -> bool {
    let within = |place: f64, from: u32, to: u32| (f64::from(from)..f64::from(to)).contains(&place);
    within(x, rect.x, rect.right()) && within(y, rect.y, rect.bottom())
}

/// The fractional parts of a range of numbers: 0 to 1 if the range contains an integer.
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
