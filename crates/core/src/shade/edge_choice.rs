//! The edges of a triangle that have lines, and the style of each.

use super::EdgeKinds;
use super::edges::LineStyle;
use crate::camera::Camera;
use crate::health::adjacency;
use crate::math;
use crate::scene::{Across, Adjacency, Mesh, Scene};
use glam::{DAffine3, DVec3};

/// The choice of a picture's edges, where not all edges have lines.
#[derive(Debug)]
pub(super) struct EdgeChoice<'a> {
    kinds: EdgeKinds,
    /// The cosine of the least angle of a feature edge.
    least_turn: f64,
    objects: Vec<ObjectEdges<'a>>,
}

#[derive(Debug)]
struct ObjectEdges<'a> {
    mesh: &'a Mesh,
    /// `None` where the choice does not depend on adjacent triangles.
    adjacency: Option<&'a Adjacency>,
    world_from_object: DAffine3,
}

/// The viewpoint that decides silhouettes.
#[derive(Clone, Copy, Debug)]
pub(super) enum SilhouetteView {
    /// An eye, in world space.
    Eye(DVec3),
    /// The common direction of parallel rays.
    Along(DVec3),
}

impl SilhouetteView {
    pub(super) fn of(camera: &Camera) -> Self {
        if camera.projection().is_parallel() {
            Self::Along(camera.forward())
        } else {
            Self::Eye(camera.pose().eye)
        }
    }

    /// The direction from the viewpoint to a point.
    fn to(self, point: DVec3) -> DVec3 {
        match self {
            Self::Eye(eye) => point - eye,
            Self::Along(direction) => direction,
        }
    }
}

impl<'a> EdgeChoice<'a> {
    /// `None` where every edge has a line, all in one style.
    pub(super) fn new(scene: &'a Scene, kinds: EdgeKinds) -> Option<Self> {
        if kinds == EdgeKinds::ALL {
            return None;
        }
        let transforms = scene
            .world_from_objects()
            .unwrap_or_else(|_| vec![DAffine3::IDENTITY; scene.objects.len()]);
        let objects = scene.objects.iter().zip(transforms);
        let objects = objects.map(|(object, world_from_object)| ObjectEdges {
            mesh: &object.mesh,
            adjacency: (kinds.ask_neighbours() && object.visible).then(|| adjacency(&object.mesh)),
            world_from_object,
        });
        let turn = f64::from(kinds.feature.unwrap_or(EdgeKinds::FEATURE));
        Some(Self {
            kinds,
            least_turn: math::cos(turn.to_radians()),
            objects: objects.collect(),
        })
    }

    /// Whether silhouettes have lines.
    pub(super) fn has_silhouettes(&self) -> bool {
        self.kinds.silhouette
    }

    /// The styles of lines along the edges of an object's triangle, as drawn on the triangles that have the edge;
    /// `None` for an edge without a line. Edge k runs from corner k to the next.
    pub(super) fn styles(&self, number: u32, triangle: u32) -> [Option<LineStyle>; 3] {
        let Some(object) = self.objects.get(number as usize) else {
            return [None; 3];
        };
        let kinds = &self.kinds;
        let diagonals = object.mesh.diagonals().on(triangle);
        let across = object.across(triangle);
        std::array::from_fn(|edge| {
            let is_feature =
                |apex| kinds.feature.is_some() && self.turns(object, triangle, edge, apex);
            match across[edge] {
                Across::NonManifold if kinds.non_manifold => Some(LineStyle::NonManifold),
                Across::Boundary if kinds.boundary => Some(LineStyle::Boundary),
                Across::Face(apex) if is_feature(apex) => Some(LineStyle::Feature),
                _ => {
                    let is_drawn = kinds.all || (kinds.polygon && !diagonals[edge]);
                    is_drawn.then_some(LineStyle::Plain)
                }
            }
        })
    }

    /// Whether the surface turns by a feature's angle at an edge. The result is the same from both triangles.
    fn turns(&self, object: &ObjectEdges<'_>, triangle: u32, edge: usize, apex: u32) -> bool {
        let Some([from, to, own, other]) = object.quad(triangle, edge, apex) else {
            return false;
        };
        // From the edge to each third corner, perpendicular to the edge.
        let along = (to - from).normalize_or_zero();
        let outwards = |corner: DVec3| {
            let outwards = corner - from;
            (outwards - along * outwards.dot(along)).normalize_or_zero()
        };
        let (own, other) = (outwards(own), outwards(other));
        let is_there = own != DVec3::ZERO && other != DVec3::ZERO;
        is_there && -own.dot(other) <= self.least_turn
    }

    /// Which edges of an object's triangle are silhouettes, if silhouettes have lines: both triangles at such an edge
    /// lie on the same side of the plane through it and the viewpoint.
    pub(super) fn silhouettes(
        &self,
        number: u32,
        triangle: u32,
        from: SilhouetteView,
    ) -> [bool; 3] {
        let object = self.objects.get(number as usize);
        let Some(object) = object.filter(|_| self.kinds.silhouette) else {
            return [false; 3];
        };
        let across = object.across(triangle);
        std::array::from_fn(|edge| {
            let Across::Face(apex) = across[edge] else {
                return across[edge] == Across::Boundary;
            };
            let Some([a, b, own, other]) = object.quad(triangle, edge, apex) else {
                return false;
            };
            let normal = (b - a).cross(from.to(a));
            normal.dot(own - a) * normal.dot(other - a) > 0.0
        })
    }
}

impl ObjectEdges<'_> {
    fn across(&self, triangle: u32) -> [Across; 3] {
        let adjacency = self.adjacency;
        adjacency.map_or([Across::NoFace; 3], |adjacency| adjacency.on(triangle))
    }

    /// The ends of an edge in world space, in the same order from either triangle; the triangle's third corner; and
    /// that of the adjacent triangle.
    fn quad(&self, triangle: u32, edge: usize, apex: u32) -> Option<[DVec3; 4]> {
        let corners = self.mesh.corners(triangle)?;
        let (mut from, mut to) = (corners[edge], corners[(edge + 1) % 3]);
        if from.to_array() > to.to_array() {
            (from, to) = (to, from);
        }
        let apex = *self.mesh.positions().get(apex as usize)?;
        let quad = [from, to, corners[(edge + 2) % 3], apex];
        Some(quad.map(|corner| {
            let in_object = self.mesh.offset() + corner.as_dvec3();
            self.world_from_object.transform_point3(in_object)
        }))
    }
}
