//! The colours of objects by their rules, before lighting and textures.

use super::facet::{Varied, blend, unit};
use super::ramp::{Ramp, RampRange};
use super::{Mode, Shading, srgb};
use crate::camera::{Camera, Projection};
use crate::hit::Hit;
use crate::scene::{Bounds, Color, ColorRule, Object, Quantity, Scene, TriangleValues};
use glam::{DAffine3, DMat3, DVec3, Mat3, Vec3};

/// Every object's colour rule, prepared for one picture.
#[derive(Debug)]
pub(super) struct OwnColors {
    /// For each object whose rule shows numbers, the span of the colours.
    spans: Vec<Option<RampRange>>,
    ramp: Option<Box<Ramp>>,
    /// In unlit pictures a file without materials would be one flat patch, so each triangle gets a colour of its own.
    colorless_differ: bool,
    /// The colour of triangles to which neither their file nor a rule gives one.
    plain: Color,
    /// Whether colours may vary within a triangle.
    pub(super) vary: bool,
    /// The colour of all triangles, where rules give all of them one; `None` where they may not.
    pub(super) only: Option<Vec3>,
}

/// A triangle's position, as far as rules need it.
pub(super) struct PlacedCorners {
    /// Relative to the eye.
    pub(super) corners: [DVec3; 3],
    pub(super) camera: Camera,
    /// The map of the object's own normals to world space.
    pub(super) world_normals: Option<Mat3>,
}

/// The colour of a hit by its object's rule, before lights, textures and the colour of backs, as it is displayed.
///
/// `None` where the scene has no such triangle, and where a picture would first compute curvatures or the range of the
/// colours, which takes long: those that were computed before are used.
pub fn own_color(scene: &Scene, camera: &Camera, shading: &Shading, hit: &Hit) -> Option<Color> {
    let Hit {
        object, triangle, ..
    } = *hit;
    let index = object as usize;
    let of = scene.objects.get(index)?;
    let corners = of.mesh.corners(triangle)?;
    let world_from_object = scene.world_from_object(index).ok()?;
    let scale = shading.scale.unwrap_or_default();
    let mut spans = Vec::new();
    if let ColorRule::Value(quantity) = &of.color {
        let is_known = of.mesh.knows_values(quantity)
            && (scale.range.is_some() || knows_range(scene, quantity));
        if !is_known {
            return None;
        }
        let fitted = || fitted_range(scene, camera, quantity);
        spans.resize(index, None);
        spans.push(Some(RampRange::of(scale.range.or_else(fitted))));
    }
    let colors = OwnColors {
        ramp: (!spans.is_empty()).then(|| Box::new(Ramp::new(scale.map))),
        spans,
        colorless_differ: shading.mode == Mode::Color,
        plain: shading.plain_color,
        vary: true,
        only: None,
    };
    let eye = camera.pose().eye;
    let offset = of.mesh.offset();
    let placed = || PlacedCorners {
        corners: corners
            .map(|corner| world_from_object.transform_point3(offset + corner.as_dvec3()) - eye),
        camera: *camera,
        world_normals: normals_to_world(&world_from_object),
    };
    let (u, v) = (hit.u as f32, hit.v as f32);
    let color = match colors.within(object, of, triangle, placed) {
        Varied::No => colors.of_triangle(object, of, triangle, placed),
        Varied::Colors(corners) => blend(corners, u, v),
        varied => colors.of_number(object, &varied, u, v),
    };
    let [r, g, b, _] = srgb::encode([color.x, color.y, color.z, 1.0]);
    Some(Color([r, g, b]))
}

/// The colour of all triangles of some objects, where their rules give all of them one.
fn only_color(objects: &[Object], shading: &Shading) -> Option<Color> {
    let of_object = |object: &Object| match object.color {
        ColorRule::Uniform(color) => Some(color),
        ColorRule::File => {
            let mesh = &object.mesh;
            let is_plain = mesh.materials().is_empty() && mesh.vertex_colors().is_empty();
            (is_plain && shading.mode != Mode::Color).then_some(shading.plain_color)
        }
        _ => None,
    };
    let (first, others) = objects.split_first()?;
    let color = of_object(first)?;
    let is_only = |object: &Object| of_object(object) == Some(color);
    others.iter().all(is_only).then_some(color)
}

impl OwnColors {
    pub(super) fn new<'s>(
        scene: &'s Scene,
        camera: &Camera,
        shading: &Shading,
        colored: bool,
    ) -> Self {
        let objects = if colored { &scene.objects[..] } else { &[] };
        let rules = || objects.iter().map(|object| &object.color);
        let values = rules().any(|rule| matches!(rule, ColorRule::Value(_)));
        let scale = shading.scale.unwrap_or_default();
        // Of a thousand objects most show the same quantity.
        let mut known: Vec<(&Quantity, RampRange)> = Vec::new();
        let mut span = |rule: &'s ColorRule| {
            let ColorRule::Value(quantity) = rule else {
                return None;
            };
            if let Some((_, span)) = known.iter().find(|(known, _)| *known == quantity) {
                return Some(*span);
            }
            let fitted = || fitted_range(scene, camera, quantity);
            let span = RampRange::of(scale.range.or_else(fitted));
            known.push((quantity, span));
            Some(span)
        };
        let within = |object: &Object| match &object.color {
            ColorRule::File => !object.mesh.vertex_colors().is_empty(),
            ColorRule::Uniform(_)
            | ColorRule::PerTriangle { .. }
            | ColorRule::ByObject
            | ColorRule::ByGroup => false,
            ColorRule::Normal => object.mesh.has_normals(),
            ColorRule::Value(Quantity::Distance(_)) => true,
            ColorRule::Value(quantity) => {
                let first = object.mesh.kept().first();
                let values = first.and_then(|first| object.mesh.values(quantity, *first));
                matches!(values, Some(TriangleValues::Corners(_)))
            }
        };
        Self {
            spans: match values {
                true => rules().map(&mut span).collect(),
                false => Vec::new(),
            },
            ramp: values.then(|| Box::new(Ramp::new(scale.map))),
            plain: shading.plain_color,
            colorless_differ: shading.mode == Mode::Color,
            vary: objects.iter().any(within),
            only: only_color(objects, shading).map(srgb::linear),
        }
    }

    /// A triangle's own colour in linear light; `place` gives its position.
    #[inline]
    pub(super) fn of_triangle(
        &self,
        number: u32,
        object: &Object,
        triangle: u32,
        place: impl FnOnce() -> PlacedCorners,
    ) -> Vec3 {
        if let Some(only) = self.only {
            return only;
        }
        match &object.color {
            ColorRule::File => srgb::linear(self.of_file(object, triangle)),
            ColorRule::Uniform(color) => srgb::linear(*color),
            rule @ ColorRule::PerTriangle { .. } => {
                srgb::linear(rule.color(triangle).unwrap_or(Color::DEFAULT))
            }
            ColorRule::ByObject => srgb::linear(ColorRule::of_object(number)),
            ColorRule::ByGroup => {
                let group = object.mesh.groups().number_of(triangle);
                srgb::linear(group.map_or(self.plain, ColorRule::of_group))
            }
            ColorRule::Normal => {
                let [a, b, c] = place().corners;
                displayed(unit((b - a).cross(c - a)).as_vec3())
            }
            ColorRule::Value(quantity) => self.of_value(number, object, quantity, triangle),
        }
    }

    fn of_file(&self, object: &Object, triangle: u32) -> Color {
        let mesh = &object.mesh;
        let colorless = mesh.materials().is_empty() && mesh.vertex_colors().is_empty();
        if colorless && self.colorless_differ {
            let rule = ColorRule::PerTriangle { seed: 0 };
            rule.color(triangle).unwrap_or(Color::DEFAULT)
        } else {
            mesh.material(triangle)
                .map_or(self.plain, |material| material.color)
        }
    }

    #[inline(never)]
    fn of_value(&self, number: u32, object: &Object, quantity: &Quantity, triangle: u32) -> Vec3 {
        let value = match object.mesh.values(quantity, triangle) {
            Some(TriangleValues::One(value)) => f64::from(value),
            // Quantities with values at corners have no single value.
            _ => f64::NAN,
        };
        match (&self.ramp, self.span(number)) {
            (Some(ramp), Some(span)) => ramp.at(span.share(value)),
            _ => srgb::linear(Color::DEFAULT),
        }
    }

    fn span(&self, number: u32) -> Option<RampRange> {
        self.spans.get(number as usize).copied().flatten()
    }

    /// How a triangle's colours vary within it.
    pub(super) fn within(
        &self,
        number: u32,
        object: &Object,
        triangle: u32,
        place: impl FnOnce() -> PlacedCorners,
    ) -> Varied {
        match &object.color {
            ColorRule::File => match object.corner_colors(triangle) {
                Some(colors) => Varied::Colors(colors.map(srgb::linear)),
                None => Varied::No,
            },
            ColorRule::Uniform(_)
            | ColorRule::PerTriangle { .. }
            | ColorRule::ByObject
            | ColorRule::ByGroup => Varied::No,
            ColorRule::Normal => {
                let normals = object.mesh.corner_normals(triangle);
                match normals.zip(place().world_normals) {
                    Some((normals, to_world)) => Varied::Colors(
                        normals.map(|normal| displayed((to_world * normal).normalize_or_zero())),
                    ),
                    None => Varied::No,
                }
            }
            ColorRule::Value(Quantity::Distance(from)) => self.distances(number, *from, place()),
            ColorRule::Value(quantity) => {
                let span = self.span(number);
                match (object.mesh.values(quantity, triangle), span) {
                    (Some(TriangleValues::Corners(values)), Some(span)) => {
                        Varied::Shares(values.map(|value| span.share(value.into())))
                    }
                    _ => Varied::No,
                }
            }
        }
    }

    fn distances(&self, number: u32, from: Option<DVec3>, place: PlacedCorners) -> Varied {
        let PlacedCorners {
            corners, camera, ..
        } = place;
        match (from, camera.projection()) {
            (None, Projection::Orthographic) => {
                let span = self.span(number).unwrap_or(RampRange::of(None));
                let forward = camera.forward();
                Varied::Shares(corners.map(|corner| span.share(corner.dot(forward))))
            }
            (from, _) => {
                let eye = camera.pose().eye;
                let to_point = from.map_or(DVec3::ZERO, |from| eye - from);
                Varied::Distances(corners.map(|corner| (corner + to_point).as_vec3()))
            }
        }
    }

    /// The colour at barycentrics (u, v) of a triangle in which a ramp shows numbers.
    #[inline(never)]
    pub(super) fn of_number(&self, number: u32, varied: &Varied, u: f32, v: f32) -> Vec3 {
        let Some(ramp) = &self.ramp else {
            return srgb::linear(Color::DEFAULT);
        };
        ramp.at(match *varied {
            Varied::Shares(shares) => blend(shares, u, v),
            Varied::Distances(corners) => {
                let distance = blend(corners, u, v).length();
                self.span(number)
                    .map_or(f32::NAN, |span| span.share(distance.into()))
            }
            Varied::No | Varied::Colors(_) => f32::NAN,
        })
    }
}

/// A direction as a colour, as in [`Mode::Normals`]: linear light.
fn displayed(direction: Vec3) -> Vec3 {
    let tables = srgb::tables();
    let shown = (direction * 0.5 + 0.5).to_array();
    shown.map(|value| tables.display(value)).into()
}

/// The range that the colours of a quantity are fitted to, over all visible objects that show it; `None` where none
/// has values. Distances are fitted to the scene's box.
pub(super) fn fitted_range(
    scene: &Scene,
    camera: &Camera,
    quantity: &Quantity,
) -> Option<[f64; 2]> {
    if let Quantity::Distance(from) = quantity {
        return distance_range(&scene.bounds(), camera, *from);
    }
    let ranges = showing(scene, quantity).filter_map(|object| object.mesh.value_range(quantity));
    ranges
        .map(|range| range.map(f64::from))
        .reduce(|[low, high], [less, more]| [low.min(less), high.max(more)])
}

/// Whether the range that a quantity's colours are fitted to was computed before.
pub(super) fn knows_range(scene: &Scene, quantity: &Quantity) -> bool {
    showing(scene, quantity).all(|object| object.mesh.knows_range(quantity))
}

/// The visible objects that show a quantity.
fn showing<'s>(scene: &'s Scene, quantity: &'s Quantity) -> impl Iterator<Item = &'s Object> {
    scene.objects.iter().filter(move |object| {
        object.visible && matches!(&object.color, ColorRule::Value(own) if own == quantity)
    })
}

/// The distances to a box's nearest point and to its farthest corner; `None` for an empty box.
pub(super) fn distance_range(
    bounds: &Bounds,
    camera: &Camera,
    from: Option<DVec3>,
) -> Option<[f64; 2]> {
    if bounds.is_empty() {
        return None;
    }
    let along_rays = from.is_none() && camera.projection() == Projection::Orthographic;
    let from = from.unwrap_or(camera.pose().eye);
    let distances = bounds.corners().map(|corner| match along_rays {
        false => corner.distance(from),
        true => (corner - from).dot(camera.forward()),
    });
    let far = distances.into_iter().fold(0.0, f64::max);
    let near = match along_rays {
        false => from.clamp(bounds.min, bounds.max).distance(from),
        true => distances.into_iter().fold(far, f64::min).max(0.0),
    };
    Some([near, far])
}

/// The normal matrix of a transform, the inverse transpose; `None` where it is singular.
pub(super) fn normals_to_world(world_from_object: &DAffine3) -> Option<Mat3> {
    // Its scale does not matter: normals are made unit length. Dividing by the largest entry keeps it in the range of
    // single precision.
    let normal_matrix = world_from_object.matrix3.inverse().transpose();
    let largest = normal_matrix
        .to_cols_array()
        .into_iter()
        .fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
    (normal_matrix.is_finite() && largest > 0.0)
        .then(|| DMat3::as_mat3(&(normal_matrix * (1.0 / largest))))
}
