//! The colours of objects by their rules, computed independently from the rules' documentation.

use super::range::{Double, Single, Vector, cross, exactly, length, minus, to, unit};
use super::{Hit, normal, srgb};
use crate::stage::Stage;
use raycast_core::camera::{Camera, Projection};
use raycast_core::scene::{Color, ColorMap, ColorRule, OUTLIERS, Object, Quantity, ScalarAt};
use raycast_core::shade::{Mode, Shading};

/// The colour where there is no number.
const NO_NUMBER: Color = Color([0x80; 3]);

/// The colours of quantities in one picture.
#[derive(Clone)]
pub(super) struct Numbers {
    /// The colour of triangles without another.
    plain: Color,
    colors: Vec<Vector<24>>,
    given: Option<[f64; 2]>,
    /// For each object whose rule shows a quantity that is checked, the range of its colours.
    ranges: Vec<Option<[Double; 2]>>,
}

impl Numbers {
    pub(super) fn new(stage: &Stage, camera: &Camera, shading: &Shading) -> Self {
        let scale = shading.scale.unwrap_or_default();
        let objects = &stage.scene.objects;
        let range = |object: &Object| match (&object.color, scale.range) {
            (ColorRule::Value(_), Some(range)) => Some(range.map(Double::exactly)),
            (ColorRule::Value(quantity), None) => fitted(stage, camera, quantity),
            _ => None,
        };
        Self {
            plain: shading.plain_color,
            colors: colors(scale.map),
            given: scale.range,
            ranges: objects.iter().map(range).collect(),
        }
    }

    /// The colour of a number in a range.
    pub(super) fn color(&self, number: Double, [low, high]: [Double; 2]) -> Vector<24> {
        if !number.is_known() || !low.is_known() || !high.is_known() {
            return [Single::UNKNOWN; 3];
        }
        if high.high <= low.low {
            // An empty range has its first colour only.
            return self.colors[0];
        }
        if high.low <= low.high {
            return [Single::UNKNOWN; 3];
        }
        let share: Single = ((number - low) / (high - low)).to();
        let place = share.max(0.0).min(1.0) * Single::exactly(255.0);
        if !place.is_known() {
            return [Single::UNKNOWN; 3];
        }
        // Linear between neighbouring entries, the ends included.
        let at = |place: f64| -> Vector<24> {
            let place = place.clamp(0.0, 255.0);
            let step = (place as usize).min(254);
            let along = Single::around(place - step as f64, 255.0 * f64::from(f32::EPSILON));
            let (low, high) = (self.colors[step], self.colors[step + 1]);
            std::array::from_fn(|i| low[i] + (high[i] - low[i]) * along)
        };
        let ends = [at(place.low), at(place.high)];
        let first = place.low.clamp(0.0, 255.0).ceil() as usize;
        let last = place.high.clamp(0.0, 255.0).floor() as usize;
        let between = (first..=last).map(|step| self.colors[step]);
        let all: Vec<Vector<24>> = ends.into_iter().chain(between).collect();
        std::array::from_fn(|i| Single::over(all.iter().flat_map(|c| [c[i].low, c[i].high])))
    }

    /// The range of the depth mode's colour map, where it is given.
    pub(super) fn given_range(&self) -> Option<[Double; 2]> {
        self.given.map(|range| range.map(Double::exactly))
    }
}

fn colors(map: ColorMap) -> Vec<Vector<24>> {
    let (gradient, turned) = match map {
        ColorMap::Viridis => (colorous::VIRIDIS, false),
        ColorMap::Magma => (colorous::MAGMA, false),
        ColorMap::Turbo => (colorous::TURBO, false),
        ColorMap::Cividis => (colorous::CIVIDIS, false),
        ColorMap::Diverging => (colorous::RED_BLUE, true),
    };
    let mut colors: Vec<Vector<24>> = (0..256)
        .map(|step| {
            let color = gradient.eval_rational(step, 256);
            srgb::linear(Color([color.r, color.g, color.b]))
        })
        .collect();
    if turned {
        colors.reverse();
    }
    colors
}

/// The range that a quantity's colours are fitted to; `None` where it is not computed, or does not exist.
fn fitted(stage: &Stage, camera: &Camera, quantity: &Quantity) -> Option<[Double; 2]> {
    if let Quantity::Distance(from) = quantity {
        let point = from.unwrap_or(camera.pose().eye);
        return super::depth::distances(stage, camera, point, from.is_none());
    }
    let shows = |object: &&Object| {
        object.visible && matches!(&object.color, ColorRule::Value(own) if own == quantity)
    };
    let mut range: Option<[f64; 2]> = None;
    for object in stage.scene.objects.iter().filter(shows) {
        let mesh = &object.mesh;
        let mut values: Vec<f64> = match quantity {
            Quantity::Area => {
                let kept = mesh.kept().iter();
                kept.filter_map(|number| area(object, *number)).collect()
            }
            Quantity::Scalar(name) => {
                let scalars = mesh.scalars().iter();
                let mut named = scalars.filter(|scalar| scalar.name == **name);
                let values = named.next().map_or(&[][..], |scalar| &scalar.values);
                let finite = values.iter().filter(|value| value.is_finite());
                finite.map(|value| f64::from(*value)).collect()
            }
            Quantity::Curvature(_) | Quantity::Distance(_) => return None,
        };
        values.sort_unstable_by(f64::total_cmp);
        let Some(last) = values.len().checked_sub(1) else {
            continue;
        };
        let skipped = match quantity {
            Quantity::Area => (last as f64 * OUTLIERS) as usize,
            _ => 0,
        };
        let (low, high) = (values[skipped], values[last - skipped]);
        let [least, most] = range.unwrap_or([low, high]);
        range = Some([least.min(low), most.max(high)]);
    }
    // An area is rounded to single precision, by 2⁻²⁴ of itself, and here a few times in double precision.
    let slack = match quantity {
        Quantity::Area => 2f64.powi(-23),
        _ => 0.0,
    };
    range.map(|range| range.map(|end| Double::around(end, end.abs() * slack)))
}

/// A triangle's area in the mesh's own coordinates, by Lagrange's identity.
fn area(object: &Object, triangle: u32) -> Option<f64> {
    let [a, b, c] = object
        .mesh
        .corners(triangle)?
        .map(|corner| corner.as_dvec3());
    let (ab, ac) = (b - a, c - a);
    let squared = ab.length_squared() * ac.length_squared() - ab.dot(ac).powi(2);
    // The cross product, where that cancels.
    let product = ab.length_squared() * ac.length_squared();
    let area = if squared > 1e-6 * product {
        squared.sqrt()
    } else {
        ab.cross(ac).length()
    };
    Some(area * 0.5)
}

/// The object's own colour at a hit.
pub(super) fn own_color(
    hit: &Hit<'_>,
    numbers: &Numbers,
    camera: &Camera,
    mode: Mode,
    to_world: Option<&normal::ToWorld>,
) -> Vector<24> {
    let object = hit.object;
    match &object.color {
        ColorRule::File => match object.mesh.corner_colors(hit.triangle) {
            Some(colors) if has_vertex_colors(object, hit.triangle) => {
                normal::blend(colors.map(srgb::linear), hit.weights)
            }
            _ => srgb::linear(file_color(hit, numbers.plain, mode)),
        },
        ColorRule::Uniform(color) => srgb::linear(*color),
        rule @ ColorRule::PerTriangle { .. } => rule
            .color(hit.triangle)
            .map_or([Single::UNKNOWN; 3], srgb::linear),
        ColorRule::ByObject => srgb::linear(ColorRule::of_object(hit.number)),
        ColorRule::ByGroup => {
            let group = object.mesh.groups().number_of(hit.triangle);
            srgb::linear(group.map_or(numbers.plain, ColorRule::of_group))
        }
        ColorRule::Normal => {
            let [a, b, c] = hit.corners;
            let shown = |direction: Vector<24>| {
                let half = Single::exactly(0.5);
                direction.map(|d| srgb::displayed(d * half + half))
            };
            match (object.mesh.corner_normals(hit.triangle), to_world) {
                (Some(normals), Some(to_world)) => {
                    let corners = normals.map(|normal| shown(to_world.direction(normal)));
                    normal::blend(corners, hit.weights)
                }
                (Some(_), None) => [Single::UNKNOWN; 3],
                (None, _) => shown(to(unit(cross(minus(b, a), minus(c, a))))),
            }
        }
        ColorRule::Value(quantity) => number_color(hit, numbers, camera, quantity),
    }
}

fn has_vertex_colors(object: &Object, triangle: u32) -> bool {
    let material = object.mesh.material(triangle);
    material.is_none_or(|material| material.by_vertex)
}

/// In unlit pictures, triangles of a file without materials and colours have one each.
fn file_color(hit: &Hit<'_>, plain: Color, mode: Mode) -> Color {
    let (mesh, triangle) = (&hit.object.mesh, hit.triangle);
    let colorless = mesh.materials().is_empty() && mesh.vertex_colors().is_empty();
    let own = ColorRule::PerTriangle { seed: 0 };
    match own.color(triangle) {
        Some(color) if colorless && mode == Mode::Color => color,
        _ => mesh
            .material(triangle)
            .map_or(plain, |material| material.color),
    }
}

fn number_color(
    hit: &Hit<'_>,
    numbers: &Numbers,
    camera: &Camera,
    quantity: &Quantity,
) -> Vector<24> {
    let mesh = &hit.object.mesh;
    let number: Double = match quantity {
        // Not computed independently.
        Quantity::Curvature(_) => return [Single::UNKNOWN; 3],
        Quantity::Area => match area(hit.object, hit.triangle) {
            Some(area) => Double::around(area, area * 2f64.powi(-23)),
            None => return [Single::UNKNOWN; 3],
        },
        Quantity::Distance(from) => {
            let along_rays = from.is_none() && camera.projection() == Projection::Orthographic;
            let to_point = match from {
                Some(from) => camera.pose().eye - *from,
                None => Default::default(),
            };
            // Corners are rounded once to single precision.
            let corners = hit
                .corners
                .map(|corner| -> Vector<24> { to(super::range::plus(corner, exactly(to_point))) });
            let [a, b, c] = corners;
            let point = normal::blend([a, b, c], hit.weights);
            match along_rays {
                false => length(point).to(),
                true => {
                    let forward: Vector<24> = exactly(camera.forward());
                    let along = super::range::dot(point, forward);
                    // The shader rounds other intermediate results: by so much of the numbers involved.
                    let size = corners
                        .iter()
                        .flatten()
                        .fold(0.0, |most: f64, c| most.max(c.low.abs()).max(c.high.abs()));
                    let slack = Single::around(0.0, size * 2f64.powi(-20));
                    (along + slack).to()
                }
            }
        }
        Quantity::Scalar(name) => {
            let scalars = mesh.scalars().iter();
            let Some(scalar) = scalars.clone().find(|scalar| scalar.name == **name) else {
                return srgb::linear(NO_NUMBER);
            };
            let value = |index: u32| {
                let value = scalar.values.get(index as usize).copied();
                f64::from(value.unwrap_or(f32::NAN))
            };
            match scalar.at {
                ScalarAt::Triangles => Double::exactly(value(hit.triangle)),
                ScalarAt::Vertices => {
                    let Some(corners) = mesh.triangles().get(hit.triangle as usize) else {
                        return [Single::UNKNOWN; 3];
                    };
                    let corners = corners.map(value);
                    if corners.iter().any(|value| value.is_nan()) {
                        return srgb::linear(NO_NUMBER);
                    }
                    return interpolated_color(hit, numbers, corners);
                }
            }
        }
    };
    if number.low.is_nan() && matches!(quantity, Quantity::Scalar(_)) {
        return srgb::linear(NO_NUMBER);
    }
    match numbers.ranges.get(hit.number as usize).copied().flatten() {
        Some(range) => numbers.color(number, range),
        None => [Single::UNKNOWN; 3],
    }
}

/// The colour of a number between corners: its positions in the range are interpolated in single precision.
fn interpolated_color(hit: &Hit<'_>, numbers: &Numbers, corners: [f64; 3]) -> Vector<24> {
    let Some([low, high]) = numbers.ranges.get(hit.number as usize).copied().flatten() else {
        return [Single::UNKNOWN; 3];
    };
    if high.high <= low.low {
        return numbers.colors[0];
    }
    let share = |value: f64| -> Vector<24> {
        let share: Single = ((Double::exactly(value) - low) / (high - low)).to();
        [share; 3]
    };
    let [share, ..] = normal::blend(corners.map(share), hit.weights);
    let unit = [Double::exactly(0.0), Double::exactly(1.0)];
    numbers.color(share.to(), unit)
}
