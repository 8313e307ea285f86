use super::{Color, ColorRule, Mesh, ScalarAt, Shape, Texture, TextureMapping, Transform, UpAxis};
use crate::quote::shorten;
use glam::DAffine3;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// A mesh in its place, with its colours.
#[derive(Clone, Debug)]
pub struct Object {
    /// What a person calls it.
    pub name: String,
    /// Its triangles.
    pub mesh: Arc<Mesh>,
    /// Where it stands in its parent, or in the world.
    pub transform: Transform,
    /// The object, by index, that it moves with.
    pub parent: Option<usize>,
    /// How its triangles get their colours.
    pub color: ColorRule,
    /// An image for its surface.
    pub texture: Option<Arc<Texture>>,
    /// How its texture lies on it, where that is its own.
    pub mapping: TextureMapping,
    /// The mesh's scalar that says how much of the texture shows, from 0 to 1, times the picture's blend; where it has
    /// no number, all. `None`: all of it everywhere.
    pub blend_by: Option<String>,
    /// The file that its mesh was read from, for saving the scene: absolute, or relative where the
    /// mesh came from a caller's own store of files.
    pub source: Option<PathBuf>,
    /// Which axis of that file was taken to be up: its mesh was turned when it was read.
    pub up_axis: UpAxis,
    /// The file that its texture was read from, likewise.
    pub texture_source: Option<PathBuf>,
    /// Which of that file's mesh nodes it is, from 0, depth first; `None` where it is the whole file.
    pub node: Option<u32>,
    /// Whether rays can meet it. A hidden object keeps its number, and its triangles theirs; what moves
    /// with it stays where it is.
    pub visible: bool,
    /// The numbers that its mesh was made from, where it came from no file.
    pub shape: Option<Shape>,
}

impl Object {
    /// An object at rest in the file's own coordinates and colours.
    pub fn new(name: impl Into<String>, mesh: Arc<Mesh>) -> Self {
        Self {
            name: name.into(),
            mesh,
            transform: Transform::IDENTITY,
            parent: None,
            color: ColorRule::File,
            texture: None,
            mapping: TextureMapping::default(),
            blend_by: None,
            source: None,
            up_axis: UpAxis::Y,
            texture_source: None,
            node: None,
            visible: true,
            shape: None,
        }
    }

    /// The image on one of its triangles: the object's own, else, in the file's colours, that of the
    /// triangle's material.
    #[inline]
    pub fn texture_on(&self, triangle: u32) -> Option<&Texture> {
        let texture = match &self.texture {
            None if self.color.is_file() => self.mesh.material(triangle)?.texture.as_ref(),
            texture => texture.as_ref(),
        };
        texture.map(|texture| &**texture)
    }

    /// The number of a triangle's material in its mesh, where that says how it reflects light: where the object shows
    /// the file's own colours.
    pub(crate) fn reflecting_material(&self, triangle: u32) -> Option<u32> {
        let of_triangle = self.mesh.material_of_triangle().get(triangle as usize);
        let number = *of_triangle.filter(|_| self.color.is_file())?;
        let material = self.mesh.materials().get(number as usize)?;
        material.reflectance.is_some().then_some(number)
    }

    /// Whether the image on a triangle is multiplied by the colours of its corners: where both are its material's.
    pub(crate) fn is_tinted(&self, triangle: u32) -> bool {
        let is_own = self.texture.is_none() && self.color.is_file();
        is_own && (self.mesh.material(triangle)).is_some_and(|material| material.by_vertex)
    }

    /// The numbers at a triangle's corners that say how much of the texture shows, where the object has any.
    pub fn blend_numbers(&self, triangle: u32) -> Option<[f32; 3]> {
        let scalar = self.mesh.scalar(self.blend_by.as_deref()?)?;
        let at = |index: u32| scalar.values.get(index as usize).copied();
        match scalar.at {
            ScalarAt::Triangles => Some([at(triangle)?; 3]),
            ScalarAt::Vertices => {
                let corners = self.mesh.triangles().get(triangle as usize)?;
                let [a, b, c] = corners.map(at);
                Some([a?, b?, c?])
            }
        }
    }

    /// Whether any triangle may have an image.
    pub fn has_texture(&self) -> bool {
        let mut materials = self.mesh.materials().iter();
        self.texture.is_some() || (self.color.is_file() && materials.any(|m| m.texture.is_some()))
    }

    /// The sRGB colours that the file gives a triangle's corners, where they are its own: no rule
    /// and no material goes before them.
    pub fn corner_colors(&self, triangle: u32) -> Option<[Color; 3]> {
        let material = self.mesh.material(triangle);
        if !self.color.is_file() || material.is_some_and(|m| !m.by_vertex) {
            return None;
        }
        self.mesh.corner_colors(triangle)
    }

    /// The sRGB colour of one of its triangles, where its rule gives triangles colours, or its file does;
    /// else [`Color::DEFAULT`].
    pub fn triangle_color(&self, triangle: u32) -> Color {
        let by_file = || {
            let material = self
                .mesh
                .material(triangle)
                .filter(|_| self.color.is_file());
            material.map_or(Color::DEFAULT, |material| material.color)
        };
        self.color.color(triangle).unwrap_or_else(by_file)
    }
}

/// Why a scene cannot be cast at.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SceneError {
    /// A parent index that no object has.
    #[error("object {object:?} names a parent that the scene does not have")]
    NoSuchParent {
        /// The object's name.
        object: String,
    },
    /// An object that is its own ancestor.
    #[error("object {object:?} is its own ancestor")]
    ParentCycle {
        /// The object's name.
        object: String,
    },
    /// A transform with a number that is not finite.
    #[error("object {object:?} has a transform that is not finite")]
    BadTransform {
        /// The object's name.
        object: String,
    },
    /// More triangles than 32-bit numbers can name.
    #[error("the scene has {triangles} triangles; at most {limit} can be numbered")]
    TooManyTriangles {
        /// How many there are.
        triangles: u64,
        /// How many there may be.
        limit: u32,
    },
}

/// Objects, numbered by their order.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The objects; an object's number is its index.
    pub objects: Vec<Object>,
}

impl From<Mesh> for Scene {
    /// One object, at rest in the file's own coordinates and colours.
    fn from(mesh: Mesh) -> Self {
        Self {
            objects: vec![Object::new("mesh", Arc::new(mesh))],
        }
    }
}

impl Scene {
    /// Each object's map from its own space to the world's, parents included.
    ///
    /// # Errors
    /// A parent that does not exist, a cycle of parents, a transform that is not finite.
    pub fn world_from_objects(&self) -> Result<Vec<DAffine3>, SceneError> {
        (0..self.objects.len())
            .map(|index| self.world_from_object(index))
            .collect()
    }

    fn world_from_object(&self, index: usize) -> Result<DAffine3, SceneError> {
        let mut world_from_object = DAffine3::IDENTITY;
        let mut next = Some(index);
        for _ in 0..=self.objects.len() {
            let Some(ancestor) = next else {
                return if world_from_object.is_finite() {
                    Ok(world_from_object)
                } else {
                    Err(SceneError::BadTransform {
                        object: shorten(&self.objects[index].name),
                    })
                };
            };
            let Some(object) = self.objects.get(ancestor) else {
                return Err(SceneError::NoSuchParent {
                    object: shorten(&self.objects[index].name),
                });
            };
            world_from_object = object.transform.parent_from_object() * world_from_object;
            next = object.parent;
        }
        Err(SceneError::ParentCycle {
            object: shorten(&self.objects[index].name),
        })
    }

    /// All triangles, dropped ones included.
    pub fn triangle_count(&self) -> usize {
        self.objects
            .iter()
            .map(|object| object.mesh.triangles().len())
            .sum()
    }

    /// Bytes that it takes at most, while they are worked out, to give the meshes without normals those of a crease
    /// angle; a mesh that several objects have is counted once.
    pub fn crease_bytes(&self) -> u64 {
        // A triangle's corners by place, their normals, and both again in parts; a vertex' place, sorted.
        const TRIANGLE: u64 = 24 + 12 + 36 + 12 + 36;
        const VERTEX: u64 = 16 + 4 + 8 + 8;
        let bytes = |mesh: &Mesh| match mesh.has_normals() {
            true => 0,
            false => {
                let (triangles, vertices) = (mesh.triangles().len(), mesh.positions().len());
                TRIANGLE * triangles as u64 + VERTEX * vertices as u64
            }
        };
        let meshes = self.objects.iter().map(|object| &object.mesh);
        let distinct: BTreeMap<_, _> = meshes
            .map(|mesh| (Arc::as_ptr(mesh), bytes(mesh)))
            .collect();
        distinct.values().sum()
    }

    /// Bytes that the smaller versions of its textures take once a filter needs them; a texture that several
    /// objects or materials share is counted once.
    pub fn level_bytes(&self) -> u64 {
        let objects = self.objects.iter();
        let textures = objects.flat_map(|object| {
            let materials = object.mesh.materials().iter();
            let of_materials = materials.filter_map(|material| material.texture.as_ref());
            object.texture.iter().chain(of_materials)
        });
        let distinct: BTreeMap<_, _> = textures
            .map(|texture| (Arc::as_ptr(texture), texture.level_bytes()))
            .collect();
        distinct.values().sum()
    }
}
