//! The extent of a scene: bounding box and bounding sphere.

use super::{Bounds, Mesh, Object, Scene};
use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;

/// A visible object and its transform.
struct ObjectExtent<'s> {
    object: &'s Object,
    world_from_object: DAffine3,
    /// A conservative box around its points; infinite where they may overflow double precision.
    loose: Bounds,
}

impl<'s> ObjectExtent<'s> {
    /// `None` for an object without triangles.
    fn new(object: &'s Object, world_from_object: DAffine3) -> Option<Self> {
        let own = object.bounds();
        if own.is_empty() {
            return None;
        }
        let corners = own.corners();
        let around = Bounds::around(corners.map(|c| world_from_object.transform_point3(c)));
        let DAffine3 {
            matrix3,
            translation,
        } = world_from_object;
        let reach = own.min.abs().max(own.max.abs());
        let magnitude = matrix3.abs() * reach + translation.abs();
        // A point goes through at most 4 roundings a coordinate, as do the corners that it lies between: 8 units of
        // 2⁻⁵³ times this magnitude. 16 units cover the rounding of the slack itself as well, and the least normal
        // number covers underflow.
        let slack = magnitude * (8.0 * f64::EPSILON) + f64::MIN_POSITIVE;
        let loose = Bounds {
            min: around.min - slack,
            max: around.max + slack,
        };
        let everything = Bounds {
            min: DVec3::NEG_INFINITY,
            max: DVec3::INFINITY,
        };
        let is_finite = loose.min.is_finite() && loose.max.is_finite();
        Some(Self {
            object,
            world_from_object,
            loose: if is_finite { loose } else { everything },
        })
    }

    /// The points in world space, without those that the transform makes infinite or NaN.
    fn points(&self) -> impl Iterator<Item = DVec3> {
        let place = |position: Vec3| {
            let in_object = self.object.mesh.offset() + position.as_dvec3();
            self.world_from_object.transform_point3(in_object)
        };
        let hidden = self.object.hidden();
        let all = hidden.is_none().then(|| self.object.mesh.kept_positions());
        let some = hidden.map(|hidden| hidden.positions());
        let positions = all.into_iter().flatten().chain(some.into_iter().flatten());
        positions.map(place).filter(|point| point.is_finite())
    }

    fn bounds(&self) -> Bounds {
        if self.world_from_object == DAffine3::IDENTITY {
            self.object.bounds()
        } else {
            Bounds::around(self.points())
        }
    }

    /// An upper bound of the squared distance of its points from a point. Rounding is monotone, so no rounded
    /// distance exceeds it.
    fn most_distance_squared(&self, from: DVec3) -> f64 {
        let most = (self.loose.min - from)
            .abs()
            .max((self.loose.max - from).abs());
        most.length_squared()
    }
}

impl Mesh {
    /// For each vertex, whether one of these kept triangles uses it.
    pub(super) fn used_vertices(&self, kept: &[u32]) -> Vec<bool> {
        let mut is_used = vec![false; self.positions().len()];
        let triangles = kept.iter().map(|&n| self.triangles()[n as usize]);
        triangles
            .flatten()
            .for_each(|vertex| is_used[vertex as usize] = true);
        is_used
    }

    /// The positions of the vertices that kept triangles use, each once.
    fn kept_positions(&self) -> impl Iterator<Item = Vec3> {
        let kept = self.measures().kept_vertices.get_or_init(|| {
            let is_kept = self.used_vertices(self.kept());
            let kept = (0..).zip(&is_kept).filter(|(_, is_kept)| **is_kept);
            is_kept
                .contains(&false)
                .then(|| kept.map(|(vertex, _)| vertex).collect())
        });
        let (all, some) = match kept {
            None => (self.positions(), &[][..]),
            Some(kept) => (&[][..], &kept[..]),
        };
        let some = some.iter().map(|&vertex| self.positions()[vertex as usize]);
        all.iter().copied().chain(some)
    }
}

impl Scene {
    /// The visible objects with their transforms; `None` where a transform or parent is invalid.
    fn placed(&self) -> Option<Vec<ObjectExtent<'_>>> {
        let transforms = self.world_from_objects().ok()?;
        let objects = self.objects.iter().zip(transforms);
        let visible = objects.filter(|(object, _)| object.visible);
        let placed = visible.filter_map(|(object, transform)| ObjectExtent::new(object, transform));
        Some(placed.collect())
    }

    /// The box around everything visible, in world space; empty if nothing is visible, or a transform or parent is
    /// invalid.
    pub fn bounds(&self) -> Bounds {
        let placed = self.placed().unwrap_or_default();
        // Objects whose boxes reach furthest first: they contain most others, which then need not be visited.
        let axis = |axis: usize| {
            let low = |p: &&ObjectExtent<'_>| p.loose.min[axis];
            let high = |p: &&ObjectExtent<'_>| p.loose.max[axis];
            let lowest = placed.iter().min_by(|a, b| low(a).total_cmp(&low(b)));
            let highest = placed.iter().max_by(|a, b| high(a).total_cmp(&high(b)));
            [lowest, highest]
        };
        let outermost = (0..3).flat_map(axis).flatten();
        let outermost = outermost
            .map(ObjectExtent::bounds)
            .fold(Bounds::EMPTY, Bounds::union);
        let reaches_out = |placed: &&ObjectExtent<'_>| {
            let Bounds { min, max } = placed.loose;
            !(min.cmpge(outermost.min) & max.cmple(outermost.max)).all()
        };
        let others = placed
            .par_iter()
            .filter(reaches_out)
            .map(ObjectExtent::bounds);
        outermost.union(others.reduce(|| Bounds::EMPTY, Bounds::union))
    }

    /// The smallest sphere around the bounds' middle that contains everything visible: centre and radius.
    ///
    /// The origin and zero for an empty scene.
    pub fn bounding_sphere(&self) -> (DVec3, f64) {
        let center = self.bounds().center();
        let placed = self.placed().unwrap_or_default();
        let mut furthest: Vec<_> = placed
            .iter()
            .map(|placed| (placed.most_distance_squared(center), placed))
            .collect();
        furthest.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        let mut squared: f64 = 0.0;
        for (most, placed) in furthest {
            if most <= squared {
                break;
            }
            let distances = placed.points().map(|point| point.distance_squared(center));
            squared = distances.fold(squared, f64::max);
        }
        (center, squared.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{MeshData, Object};
    use super::*;
    use crate::random::Random;
    use std::sync::Arc;

    /// Bounds and radius from every corner of every kept triangle.
    fn expected(scene: &Scene) -> (Bounds, f64) {
        let transforms = scene.world_from_objects().expect("valid transforms");
        let mut points = Vec::new();
        for (object, transform) in scene.objects.iter().zip(transforms) {
            let mesh = &object.mesh;
            for &number in mesh.kept().iter().filter(|_| object.visible) {
                let corners = mesh.corners(number).expect("a triangle");
                let place = |p: Vec3| transform.transform_point3(mesh.offset() + p.as_dvec3());
                points.extend(corners.map(place).into_iter().filter(|p| p.is_finite()));
            }
        }
        let bounds = Bounds::around(points.iter().copied());
        let center = bounds.center();
        let distances = points.iter().map(|point| point.distance_squared(center));
        (bounds, distances.fold(0.0, f64::max).sqrt())
    }

    #[test]
    fn objects_that_are_skipped_reach_no_further() {
        let mut random = Random(31);
        for round in 0..60 {
            let far = [DVec3::ZERO, DVec3::new(4e6, -1e7, 3.0)][round % 2];
            let meshes: Vec<Arc<Mesh>> = (0..3)
                .map(|_| {
                    // The last vertex belongs to no triangle and is the farthest out; the last triangle has no area.
                    let mut positions: Vec<_> = (0..30).map(|_| far + random.point()).collect();
                    positions.push(far + 50.0);
                    let mut triangles: Vec<_> =
                        (0..10).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
                    triangles.push([30, 30, 0]);
                    Arc::new(Mesh::new(MeshData {
                        positions,
                        triangles,
                        ..MeshData::default()
                    }))
                })
                .collect();
            let mut scene = Scene::default();
            for number in 0..40 {
                let mut object = Object::new("", Arc::clone(&meshes[number % 3]));
                let transform = &mut object.transform;
                transform.rotate = random.point() * 180.0;
                transform.translate = random.point() * 10f64.powi(round as i32 % 9 - 4);
                transform.scale = random.point() * 2.0;
                object.visible = number % 7 != 3;
                match (number, round % 10) {
                    (5, 4) => object.transform.scale = DVec3::splat(1e305),
                    (5, 5) => object.transform.scale = DVec3::ZERO,
                    (5, 6) => object.transform.translate = DVec3::splat(f64::MAX),
                    (0..9, 7) => object.transform = super::super::Transform::IDENTITY,
                    _ => {}
                }
                scene.objects.push(object);
            }
            let (bounds, radius) = expected(&scene);
            assert_eq!(scene.bounds(), bounds, "{round}");
            assert_eq!(
                scene.bounding_sphere(),
                (bounds.center(), radius),
                "{round}"
            );
        }
        assert!(Scene::default().bounds().is_empty());
        assert_eq!(Scene::default().bounding_sphere(), (DVec3::ZERO, 0.0));
    }
}
