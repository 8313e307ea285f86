//! A scene, its tree, and the truth about it.

use raycast_core::camera::{Camera, Ray};
use raycast_core::glam::DAffine3;
use raycast_core::render::{Settings, View};
use raycast_core::scene::{
    COORDINATE_LIMIT, ClippingPlane, ClippingPlanes, Masks, Mesh, Object, Scene, SceneError,
};
use raycast_core::shade::{Mode, Shading};
use raycast_core::{Accel, Clipped, Cull};
use raycast_oracle::{HalfSpace, Oracle, Triangle, Truth};
use std::sync::Arc;

/// A scene with its tree and the truth about it.
#[derive(Debug)]
pub struct Stage {
    /// The scene.
    pub scene: Arc<Scene>,
    /// The tree over it.
    pub accel: Arc<Accel>,
    /// The truth about it.
    pub oracle: Oracle,
    /// The clipping planes: the truth is about what they keep.
    clip: ClippingPlanes,
    has_masks: bool,
}

impl Stage {
    /// Builds the tree and the oracle of a scene.
    ///
    /// # Errors
    /// Those of [`Accel::build`].
    pub fn new(scene: Scene) -> Result<Self, SceneError> {
        let accel = Accel::build(&scene)?;
        Self::from_parts(Arc::new(scene), Arc::new(accel))
    }

    /// Builds the oracle of a scene and its tree.
    ///
    /// # Errors
    /// Those of [`Accel::build`].
    pub fn from_parts(scene: Arc<Scene>, accel: Arc<Accel>) -> Result<Self, SceneError> {
        let oracle = Oracle::new(triangles(&scene, &accel)?);
        Ok(Self {
            has_masks: Masks::of(&scene).is_some(),
            scene,
            accel,
            oracle,
            clip: ClippingPlanes::NONE,
        })
    }

    /// The same stage, clipped by these planes.
    #[must_use]
    pub fn clipped(mut self, clip: ClippingPlanes) -> Self {
        self.oracle = (self.oracle).clipped(clip.enabled().map(half_space).collect());
        self.clip = clip;
        self
    }

    /// The clipping planes.
    pub fn clip(&self) -> ClippingPlanes {
        self.clip
    }

    /// The tree's triangles as the planes keep them.
    pub fn clipped_accel(&self) -> Clipped<'_> {
        self.accel.clipped(&self.clip)
    }

    /// The true closest triangle that a ray hits.
    pub fn truth(&self, ray: &Ray, cull: Cull) -> Option<Truth> {
        self.oracle
            .closest_hit(&oracle_ray(ray), cull == Cull::Back)
    }

    /// The closest of a ray's hits for which `accepts` holds.
    pub(crate) fn truth_where(
        &self,
        ray: &Ray,
        cull: Cull,
        accepts: impl Fn(&Truth) -> bool,
    ) -> Option<Truth> {
        (self.oracle).closest_hit_where(&oracle_ray(ray), cull == Cull::Back, accepts)
    }

    /// All triangles that a ray hits, nearest first.
    pub(crate) fn hits_in_order(&self, ray: &Ray, cull: Cull) -> Vec<Truth> {
        (self.oracle).hits_in_order(&oracle_ray(ray), cull == Cull::Back)
    }

    /// Whether any material is a mask.
    pub fn has_masks(&self) -> bool {
        self.has_masks
    }

    /// The true closest triangle that a ray hits, clipped by these planes instead of the stage's.
    pub(crate) fn truth_within(&self, ray: &Ray, planes: &[ClippingPlane]) -> Option<Truth> {
        let half_spaces: Vec<_> = planes.iter().map(half_space).collect();
        self.oracle
            .closest_hit_in(&oracle_ray(ray), false, &half_spaces)
    }

    /// How a ray hits the triangle with these numbers, whether or not others are nearer.
    pub fn intersect(
        &self,
        (object, triangle): (u32, u32),
        ray: &Ray,
        cull: Cull,
    ) -> Option<Truth> {
        self.oracle
            .intersect(object, triangle, &oracle_ray(ray), cull == Cull::Back)
    }

    /// A view with a colour a triangle, and with layers.
    pub fn view(&self, camera: Camera, cull: Cull) -> View {
        View {
            scene: self.scene.clone(),
            accel: self.accel.clone(),
            camera,
            settings: Settings {
                shading: Shading {
                    mode: Mode::Color,
                    ..Shading::default()
                },
                cull,
                clip: self.clip,
                samples: 1,
                layers: true,
                ..Settings::default()
            },
        }
    }
}

/// A scene with an object for each mesh, without transforms.
pub fn scene_of(meshes: impl IntoIterator<Item = Mesh>) -> Scene {
    let objects = meshes
        .into_iter()
        .map(|mesh| Object::new("object", Arc::new(mesh)))
        .collect();
    Scene { objects }
}

/// The half-space that a plane keeps.
fn half_space(plane: &ClippingPlane) -> HalfSpace {
    HalfSpace {
        normal: plane.normal,
        offset: plane.offset,
    }
}

/// The oracle's ray, with the same numbers.
fn oracle_ray(ray: &Ray) -> raycast_oracle::Ray {
    raycast_oracle::Ray {
        origin: ray.origin,
        direction: ray.direction,
        t_min: ray.t_min,
        t_max: ray.t_max,
    }
}

/// A scene's triangles as stored.
///
/// Where no object has a transform, and all meshes share an offset, corners are taken from the meshes. Otherwise they
/// were rounded once, when they were transformed to world space, and are taken from `accel`.
///
/// # Errors
/// A scene whose transforms or parents are invalid.
pub fn triangles(scene: &Scene, accel: &Accel) -> Result<Vec<Triangle>, SceneError> {
    let placed = scene.world_from_objects()?;
    let offsets = || scene.objects.iter().map(|object| object.mesh.offset());
    let is_at_rest = placed.iter().all(|&placed| placed == DAffine3::IDENTITY)
        && offsets().all(|offset| Some(offset) == offsets().next());
    if !is_at_rest {
        let stored = |primitive| {
            let (object, triangle) = accel.identify(primitive);
            Triangle {
                object,
                triangle,
                base: accel.origin(),
                corners: accel.corners(primitive),
            }
        };
        return Ok((0..accel.len() as u32).map(stored).collect());
    }
    let mut triangles = Vec::new();
    for (number, object) in scene.objects.iter().enumerate() {
        let mesh = &object.mesh;
        for triangle in 0..mesh.triangles().len() as u32 {
            let Some(corners) = mesh.corners(triangle) else {
                continue;
            };
            // By contract, a mesh has no triangles at vertices that are not finite or too far. A triangle without
            // area is never hit, and needs no rule. The limit applies to the file's numbers; where rounding may have
            // crossed it, only the mesh knows.
            let is_near = |limit: f64| {
                corners.iter().all(|corner| {
                    let corner = (mesh.offset() + corner.as_dvec3()).abs();
                    corner.is_finite() && corner.max_element() <= limit
                })
            };
            let rounding = f64::from(f32::EPSILON);
            let is_near = is_near(COORDINATE_LIMIT * (1.0 - rounding))
                || is_near(COORDINATE_LIMIT * (1.0 + rounding))
                    && mesh.kept().binary_search(&triangle).is_ok();
            if is_near {
                triangles.push(Triangle {
                    object: number as u32,
                    triangle,
                    base: mesh.offset(),
                    corners,
                });
            }
        }
    }
    Ok(triangles)
}
